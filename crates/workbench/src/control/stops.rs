//! Stops of single drives that are under way.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use profidrive::motion::StopReport;
use tokio::sync::watch;

use crate::problem::Problem;

/// How a stop ended; `None` while it is under way.
pub(crate) type Outcome = Option<Result<StopReport, Problem>>;

/// The stops of single drives that are under way, one of each drive: who stops it too waits for the same one.
#[derive(Debug, Default)]
pub(crate) struct Stops(Mutex<BTreeMap<String, watch::Receiver<Outcome>>>);

impl Stops {
    /// Returns the stop of this drive that is under way; `begin` begins one where there is none.
    pub fn join(&self, drive: &str, begin: impl FnOnce(watch::Sender<Outcome>)) -> watch::Receiver<Outcome> {
        let mut stops = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        stops.retain(|_, stop| is_under_way(stop));
        if let Some(stop) = stops.get(drive) {
            return stop.clone();
        }
        let (sender, stop) = watch::channel(None);
        stops.insert(drive.to_owned(), stop.clone());
        begin(sender);
        stop
    }

    /// Returns whether any is under way.
    pub fn is_any(&self) -> bool {
        let stops = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        stops.values().any(is_under_way)
    }
}

/// One whose task has panicked reports no end.
fn is_under_way(stop: &watch::Receiver<Outcome>) -> bool {
    stop.borrow().is_none() && stop.has_changed().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_has_one_stop_at_a_time() {
        let stops = Stops::default();
        let mut begun = Vec::new();
        for drive in ["axis-1", "axis-1", "axis-2"] {
            stops.join(drive, |sender| begun.push(sender));
        }
        assert_eq!(begun.len(), 2);
        // one ended, the other one was given up
        begun.remove(0).send_replace(Some(Err(Problem::defect())));
        drop(begun.remove(0));
        for drive in ["axis-1", "axis-2", "axis-2"] {
            stops.join(drive, |sender| begun.push(sender));
        }
        assert_eq!(begun.len(), 2);
        assert!(stops.is_any());
        begun.clear();
        assert!(!stops.is_any());
    }
}
