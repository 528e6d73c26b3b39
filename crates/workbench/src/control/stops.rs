//! Stops of single drives that are under way.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use profidrive::motion::StopReport;
use tokio::sync::watch;

use crate::problem::Problem;

/// How a stop ended; `None` while it is under way.
pub(crate) type Outcome = Option<Result<StopReport, Problem>>;

/// A stop of a single drive that is under way.
#[derive(Debug)]
struct Stop {
    outcome: watch::Receiver<Outcome>,
    /// It was wanted once more: what remains of its ramp is a quick stop.
    again: Arc<AtomicBool>,
}

/// The stops of single drives that are under way, one of each drive: who stops it too waits for the same one, and makes it a quick one.
#[derive(Debug, Default)]
pub(crate) struct Stops(Mutex<BTreeMap<String, Stop>>);

impl Stops {
    /// Returns the stop of this drive that is under way, which is wanted once more then; `begin` begins one where there is none. It
    /// gets what becomes true once it is wanted again.
    pub fn join(
        &self,
        drive: &str,
        begin: impl FnOnce(watch::Sender<Outcome>, Arc<AtomicBool>),
    ) -> watch::Receiver<Outcome> {
        let mut stops = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        stops.retain(|_, stop| stop.is_under_way());
        if let Some(stop) = stops.get(drive) {
            stop.again.store(true, Ordering::Relaxed);
            return stop.outcome.clone();
        }
        let (sender, outcome) = watch::channel(None);
        let again = Arc::<AtomicBool>::default();
        let stop = Stop {
            outcome: outcome.clone(),
            again: Arc::clone(&again),
        };
        stops.insert(drive.to_owned(), stop);
        begin(sender, again);
        outcome
    }

    /// Returns whether any is under way.
    pub fn is_any(&self) -> bool {
        let stops = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        stops.values().any(Stop::is_under_way)
    }
}

impl Stop {
    /// One whose task has panicked reports no end.
    fn is_under_way(&self) -> bool {
        self.outcome.borrow().is_none() && self.outcome.has_changed().is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_has_one_stop_at_a_time_and_who_wants_it_again_is_in_a_hurry() {
        let stops = Stops::default();
        let mut begun = Vec::new();
        for drive in ["axis-1", "axis-1", "axis-2"] {
            stops.join(drive, |sender, again| begun.push((sender, again)));
        }
        let again: Vec<_> = begun
            .iter()
            .map(|(_, again)| again.load(Ordering::Relaxed))
            .collect();
        assert_eq!(again, [true, false]);
        // one ended, the other one was given up
        begun.remove(0).0.send_replace(Some(Err(Problem::defect())));
        drop(begun.remove(0));
        for drive in ["axis-1", "axis-2", "axis-2"] {
            stops.join(drive, |sender, again| begun.push((sender, again)));
        }
        assert_eq!(begun.len(), 2);
        assert!(stops.is_any());
        begun.clear();
        assert!(!stops.is_any());
    }
}
