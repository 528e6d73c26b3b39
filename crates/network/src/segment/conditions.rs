//! What goes wrong on the way to a station.

use std::time::Duration;

/// The faults on the way from the switch to one station. A frame meets the conditions of its receiver, once.
///
/// Frames keep their order, whatever the delays, except those that `reorder` picks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Share of frames lost, 0 to 1.
    pub loss: f64,
    /// Share of frames that arrive twice, 0 to 1.
    pub duplicate: f64,
    /// Share of frames that arrive `reorder_by` later than they should and let others overtake, 0 to 1.
    pub reorder: f64,
    /// How late frames picked by `reorder` are.
    pub reorder_by: Duration,
    /// Delay of every frame; less than 1 us counts as 1 us.
    pub delay: Duration,
    /// Further delay, evenly spread from zero to this.
    pub jitter: Duration,
}

impl Default for Conditions {
    /// Creates a good link: 10 us, no faults.
    fn default() -> Self {
        Self {
            loss: 0.0,
            duplicate: 0.0,
            reorder: 0.0,
            reorder_by: Duration::from_millis(1),
            delay: Duration::from_micros(10),
            jitter: Duration::ZERO,
        }
    }
}

impl Conditions {
    /// Nothing can happen by chance, so no random number is needed.
    pub(super) fn certain(&self) -> bool {
        self.loss <= 0.0 && self.duplicate <= 0.0 && self.reorder <= 0.0 && self.jitter.is_zero()
    }
}
