//! Control of axes: who has one, what keeps a motion going, and STOP.
//!
//! All deadlines are those of the engine: a motion goes on as long as beats of its page put its end off. A runtime that hangs, a
//! full queue or a lost page therefore ends a motion and never makes it longer. STOP goes through no queue.

mod axis;
mod denied;
mod fresh;
mod ledger;
mod messages;
#[cfg(test)]
mod model;
mod running;
mod socket;
mod stopping;
mod stops;
mod taking;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::watch;

use denied::Denied;
use ledger::Ledger;
use running::{Picture, Running};
use stopping::StopNews;
use stops::Stops;

pub(crate) use socket::{__path_control, control};
pub(crate) use stopping::{StopFrame, Stopped, Stopping};

/// A motion that a button keeps going ends this long after the last beat.
pub(crate) const HOLD: Duration = Duration::from_millis(200);
/// Every other motion, and control itself, end this long after the last beat.
pub(crate) const LEASE: Duration = Duration::from_secs(1);

/// What a server controls.
#[derive(Debug)]
pub(crate) struct Control {
    ledger: Mutex<Ledger>,
    axes: Mutex<BTreeMap<String, Arc<Running>>>,
    /// The last STOP, and whether it was reset: a flood of them is no flood for other pages.
    stop_news: watch::Sender<StopNews>,
    sockets: AtomicU64,
    /// Stops of single drives.
    pub stops: Stops,
}

impl Control {
    pub fn new() -> Self {
        Self {
            ledger: Mutex::default(),
            axes: Mutex::default(),
            stop_news: watch::Sender::new(StopNews::default()),
            sockets: AtomicU64::new(0),
            stops: Stops::default(),
        }
    }

    fn ledger(&self) -> MutexGuard<'_, Ledger> {
        self.ledger.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns whether any page has an axis, or takes one.
    pub(crate) fn has_axes(&self) -> bool {
        self.ledger().has_axes()
    }

    fn axes(&self) -> MutexGuard<'_, BTreeMap<String, Arc<Running>>> {
        self.axes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the axes that are controlled, as they are called in paths.
    pub fn drives(&self) -> Vec<String> {
        self.axes().keys().cloned().collect()
    }

    /// Returns how often STOP was pressed.
    pub fn stops(&self) -> u64 {
        self.ledger().epoch()
    }

    /// Stops every axis by its quick stop (OFF3), or along its ramp (OFF1) or by coasting (OFF2) where its page has chosen that, and
    /// lets nothing be enabled or moved before it is reset. Does not wait.
    pub fn stop(&self, by: &str, claimed_name: Option<String>) -> Stopping {
        // first: what is requested from now on comes too late
        let epoch = self.ledger().stop();
        let axes = self.axes();
        Stopping {
            epoch,
            by: by.to_owned(),
            claimed_name,
            axes: axes
                .iter()
                .map(|(drive, running)| (drive.clone(), running.stop()))
                .collect(),
        }
    }

    /// Ends the control of every axis: each is brought to rest along its ramp and given back. Does not wait.
    pub fn end(&self) {
        self.ledger().end_requests(&Denied::ServerEnds);
        for running in self.axes().values() {
            self.let_go(running);
        }
    }

    /// Lets an axis be ramped down and given back, or waits for it no more.
    fn let_go(&self, running: &Running) {
        self.ledger().leave(&running.drive, running.lease);
        running.end();
    }

    /// Returns how each axis is, and who waits for it.
    fn pictures(&self) -> Vec<Picture> {
        let axes = self.axes();
        let ledger = self.ledger();
        let now = Instant::now();
        let picture = |running: &Arc<Running>| {
            let drive = &running.drive;
            running.picture(ledger.wanted(drive, now), ledger.is_confirmed(drive))
        };
        axes.values().map(picture).collect()
    }

    fn next_socket(&self) -> u64 {
        self.sockets.fetch_add(1, Ordering::Relaxed) + 1
    }
}
