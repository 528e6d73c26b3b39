//! Every cyclic sample of a motion, beside its events.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use client::axis::Sample;
use client::{Axis, Samples};
use profinet::Instant;

use super::error::{MotionError, TapError};

/// Receives every cyclic sample of a motion, with the stop at its end. See [`Observer::tapped_by`](super::Observer::tapped_by).
pub trait SampleTap: Send {
    /// The axis is taken and does not move yet.
    ///
    /// # Errors
    /// When samples cannot be received: the motion does not begin then.
    fn begin(&mut self, axis: &Axis) -> Result<(), TapError>;

    /// Receives a sample. `now` is the present time on its clock.
    fn take(&mut self, sample: &Sample, now: Instant);
}

/// A tap of its caller.
pub(super) type SharedTap = Arc<Mutex<dyn SampleTap>>;

/// Samples that wait: some four seconds of the shortest cycle.
const WAITING: usize = 4096;

/// A tap at an axis. Clones take the same samples.
#[derive(Clone)]
pub(super) struct Tapped(Arc<Mutex<Open>>);

struct Open {
    samples: Option<Samples>,
    tap: SharedTap,
}

impl std::fmt::Debug for Tapped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Tapped")
    }
}

impl Tapped {
    pub(super) fn begin(axis: &Axis, tap: SharedTap) -> Result<Self, MotionError> {
        let samples = axis.samples(WAITING);
        let begun = tap.lock().unwrap_or_else(PoisonError::into_inner).begin(axis);
        begun.map_err(|error| MotionError::NotRecorded {
            drive: axis.drive().label(),
            error,
        })?;
        let samples = Some(samples);
        Ok(Self(Arc::new(Mutex::new(Open { samples, tap }))))
    }

    /// Passes on what came.
    pub(super) fn take(&self) {
        let Open { samples, tap } = &mut *self.open();
        let Some(samples) = samples else { return };
        let mut tap = tap.lock().unwrap_or_else(PoisonError::into_inner);
        while let Some(sample) = samples.take() {
            tap.take(&sample, samples.now());
        }
    }

    /// Passes on what came, and nothing later.
    pub(super) fn end(&self) {
        self.take();
        self.open().samples = None;
    }

    fn open(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
