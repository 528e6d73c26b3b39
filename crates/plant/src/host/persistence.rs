//! Saves the state of drives in a thread of its own: a slow disk must not hold up a cycle.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::spawn;
use std::time::Duration;

use network::files::StateFileError;
use network::system::Bell;
use profile::parameter::SaveId;
use profinet::Instant;
use virtual_drive::station::{Station, StationEvent};

use super::HostedDrive;
use super::event::{DriveEvent, Event, EventSender, SaveResult, Saved};
use super::save_queue::{Job, Network, Parameters, Queue};

/// How long the end waits for the disk.
const TIMEOUT: Duration = Duration::from_secs(5);

/// What became of a save, which responses of the drive wait for.
pub struct SaveReport {
    pub drive: Arc<HostedDrive>,
    pub what: Kind,
    pub save: SaveId,
    pub stored: bool,
}

impl SaveReport {
    /// Gives it to its station.
    pub fn deliver(&self, station: &mut Station, now: Instant) {
        match self.what {
            Kind::Network => station.report_network(now, self.save, self.stored),
            Kind::Parameters => station.report_save(now, self.save, self.stored),
        }
    }
}

/// What a save is of; each has numbers of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Network,
    Parameters,
}

/// The thread that saves.
pub struct Persistence {
    queue: Arc<Queue>,
    reports: Receiver<SaveReport>,
    events: EventSender,
}

impl Persistence {
    /// Starts the thread; `bell` rings for every report.
    pub fn new(events: EventSender, bell: Bell) -> Self {
        let queue = Arc::new(Queue::default());
        let (sender, reports) = channel();
        let writer = Writer {
            queue: Arc::clone(&queue),
            reports: sender,
            events: events.clone(),
            bell,
        };
        spawn(move || writer.run());
        Self {
            queue,
            reports,
            events,
        }
    }

    /// Saves what the event has to be saved, and reports every other event.
    pub fn handle(&self, drive: &Arc<HostedDrive>, at: Duration, event: StationEvent) {
        match event {
            StationEvent::PersistNetwork { network, save } => {
                self.queue.network(drive, at, Network { network, save });
            }
            StationEvent::PersistParameters { text, asked, save } => {
                self.queue.parameters(drive, at, Parameters { text, asked, save });
            }
            other => self
                .events
                .drive(&drive.key, at, DriveEvent::Station(drive.model, other)),
        }
    }

    /// Returns the next report of a save. Only drives with a state folder wait for theirs.
    pub fn report(&self) -> Option<SaveReport> {
        self.reports.try_recv().ok()
    }

    /// Waits until everything is saved, but not for ever: a disk may take nothing.
    pub fn finish(self) {
        let drives = self.queue.close(TIMEOUT);
        if !drives.is_empty() {
            let waited = TIMEOUT;
            self.events.send(Event::Unsaved { drives, waited });
        }
    }
}

impl Drop for Persistence {
    fn drop(&mut self) {
        self.queue.close(Duration::ZERO);
    }
}

/// What the thread has.
struct Writer {
    queue: Arc<Queue>,
    reports: Sender<SaveReport>,
    events: EventSender,
    bell: Bell,
}

impl Writer {
    fn run(&self) {
        while let Some(job) = self.queue.next() {
            let Job {
                drive,
                at,
                network,
                parameters,
            } = job;
            if let Some(Network { network, save }) = network {
                let result = drive.state.write_network(&network);
                self.report(&drive, Kind::Network, save, result.is_ok());
                let saved = Saved::Network(network.name, network.ip);
                self.publish(&drive, at, saved, result);
            }
            if let Some(Parameters { text, asked, save }) = parameters {
                let result = drive.state.write_parameters(&text);
                self.report(&drive, Kind::Parameters, save, result.is_ok());
                if result.is_err() || asked {
                    self.publish(&drive, at, Saved::Parameters, result);
                }
            }
        }
    }

    fn report(&self, drive: &Arc<HostedDrive>, what: Kind, save: SaveId, stored: bool) {
        // the end of the simulation does not wait for it
        let _ = self.reports.send(SaveReport {
            drive: Arc::clone(drive),
            what,
            save,
            stored,
        });
        self.bell.ring();
    }

    fn publish(&self, drive: &HostedDrive, at: Duration, saved: Saved, result: Result<(), StateFileError>) {
        let result = match result {
            Ok(()) if drive.state.is_kept() => SaveResult::Stored,
            Ok(()) => SaveResult::NoFolder,
            Err(error) => SaveResult::Failed(error.to_string()),
        };
        self.events
            .drive(&drive.key, at, DriveEvent::Saved(saved, result));
    }
}
