//! State of drives that waits for the disk: of each drive only the newest.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use profile::parameter::SaveId;
use profinet::device::Stored;

use super::HostedDrive;

/// Parameters to be kept.
#[derive(Debug)]
pub struct Parameters {
    /// Their text.
    pub text: String,
    /// A client requested it.
    pub asked: bool,
    /// Number of the save, which counts for those before it too.
    pub save: SaveId,
}

/// Name, address and I&M data to be kept.
#[derive(Debug)]
pub struct Network {
    /// All of it.
    pub network: Stored,
    /// Number of the save, which counts for those before it too.
    pub save: SaveId,
}

/// The newest state of one drive that is not on the disk yet.
#[derive(Debug)]
pub struct Job {
    pub drive: Arc<HostedDrive>,
    /// When the newest part came.
    pub at: Duration,
    pub network: Option<Network>,
    pub parameters: Option<Parameters>,
}

#[derive(Debug, Default)]
struct Waiting {
    /// At most one for each drive, the oldest first.
    jobs: VecDeque<Job>,
    /// Drive of the job that is being written.
    busy: Option<Arc<HostedDrive>>,
    closed: bool,
}

/// The jobs that wait, for the thread that saves.
#[derive(Debug, Default)]
pub struct Queue {
    waiting: Mutex<Waiting>,
    changed: Condvar,
}

impl Queue {
    /// Keeps name and address of a drive, instead of those that wait.
    pub fn network(&self, drive: &Arc<HostedDrive>, at: Duration, network: Network) {
        self.put(drive, at, |job| job.network = Some(network));
    }

    /// Keeps the parameters of a drive, instead of those that wait.
    pub fn parameters(&self, drive: &Arc<HostedDrive>, at: Duration, mut parameters: Parameters) {
        self.put(drive, at, |job| {
            parameters.asked |= job.parameters.as_ref().is_some_and(|earlier| earlier.asked);
            job.parameters = Some(parameters);
        });
    }

    fn put(&self, drive: &Arc<HostedDrive>, at: Duration, change: impl FnOnce(&mut Job)) {
        let mut waiting = self.lock();
        let place = waiting.jobs.iter().position(|job| Arc::ptr_eq(&job.drive, drive));
        let place = place.unwrap_or_else(|| {
            waiting.jobs.push_back(Job {
                drive: Arc::clone(drive),
                at,
                network: None,
                parameters: None,
            });
            waiting.jobs.len() - 1
        });
        if let Some(job) = waiting.jobs.get_mut(place) {
            job.at = at;
            change(job);
        }
        drop(waiting);
        self.changed.notify_all();
    }

    /// Waits for a job; `None` when there is none and none will come. The job before counts as done.
    pub fn next(&self) -> Option<Job> {
        let mut waiting = self.lock();
        waiting.busy = None;
        self.changed.notify_all();
        loop {
            if let Some(job) = waiting.jobs.pop_front() {
                waiting.busy = Some(Arc::clone(&job.drive));
                return Some(job);
            }
            if waiting.closed {
                return None;
            }
            waiting = self.changed.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Accepts no more and waits until everything is saved, but not longer than `limit`; returns the drives whose newest
    /// state is not on the disk then.
    pub fn close(&self, limit: Duration) -> Vec<Arc<str>> {
        let mut waiting = self.lock();
        waiting.closed = true;
        self.changed.notify_all();
        let open = |waiting: &mut Waiting| !waiting.jobs.is_empty() || waiting.busy.is_some();
        let (waiting, _) = self
            .changed
            .wait_timeout_while(waiting, limit, open)
            .unwrap_or_else(PoisonError::into_inner);
        let drives = waiting
            .busy
            .iter()
            .chain(waiting.jobs.iter().map(|job| &job.drive));
        let mut keys: Vec<Arc<str>> = drives.map(|drive| Arc::clone(&drive.key)).collect();
        keys.dedup();
        keys
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::state_folder::DriveState;

    fn drive(key: &str) -> Arc<HostedDrive> {
        Arc::new(HostedDrive {
            model: &virtual_drive::model::AKD,
            key: key.into(),
            state: DriveState::default(),
        })
    }

    fn named(name: String) -> Network {
        let network = Stored {
            name,
            ..Stored::default()
        };
        let save = SaveId(1);
        Network { network, save }
    }

    #[test]
    fn of_each_drive_only_the_newest_state_waits() {
        let queue = Queue::default();
        let (one, two) = (drive("akd-1"), drive("akd-2"));
        for number in 0..100_000_u32 {
            let at = Duration::from_millis(number.into());
            queue.network(&one, at, named(format!("name-{number}")));
            let parameters = Parameters {
                text: number.to_string(),
                asked: number == 7,
                save: SaveId(number.into()),
            };
            queue.parameters(&two, at, parameters);
        }
        assert_eq!(queue.lock().jobs.len(), 2);
        let job = queue.next().unwrap();
        assert_eq!((&*job.drive.key, job.at.as_millis()), ("akd-1", 99_999));
        assert_eq!(job.network.unwrap().network.name, "name-99999");
        assert!(job.parameters.is_none());
        let parameters = queue.next().unwrap().parameters.unwrap();
        assert_eq!((parameters.text.as_str(), parameters.asked), ("99999", true));
        assert_eq!(parameters.save, SaveId(99_999));
    }

    #[test]
    fn a_drive_that_never_stops_changing_does_not_keep_the_others_waiting() {
        let queue = Queue::default();
        let (busy, calm) = (drive("busy"), drive("calm"));
        queue.network(&busy, Duration::ZERO, named(String::new()));
        queue.network(&calm, Duration::ZERO, named(String::new()));
        assert_eq!(queue.next().unwrap().drive.key.as_ref(), "busy");
        queue.network(&busy, Duration::ZERO, named(String::new()));
        assert_eq!(queue.next().unwrap().drive.key.as_ref(), "calm");
    }

    #[test]
    fn the_end_waits_no_longer_than_its_limit_and_names_what_is_not_saved() {
        let queue = Queue::default();
        queue.network(&drive("akd-1"), Duration::ZERO, named(String::new()));
        queue.network(&drive("akd-2"), Duration::ZERO, named(String::new()));
        let _being_written = queue.next();
        assert_eq!(queue.close(Duration::ZERO), ["akd-1".into(), "akd-2".into()]);
        assert!(queue.next().is_some() && queue.next().is_none());
        assert_eq!(queue.close(Duration::MAX), Vec::<Arc<str>>::new());
    }
}
