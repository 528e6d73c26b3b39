//! What happens to the drive from outside, and what its inputs tell of it.

use super::Drive;

/// Inputs of the drive that are not the axis's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Outside {
    /// The enable input is taken away.
    pub hardware_disable: bool,
    /// The input for the controlled stop is active.
    pub controlled_stop: bool,
}

/// Bits of DRV.DISSOURCES. Source: AKD Parameter Guide 12/2009.
const SOFTWARE: i64 = 1;
const FAULT: i64 = 1 << 1;
const HARDWARE: i64 = 1 << 2;
const CONTROLLED_STOP: i64 = 1 << 5;

impl Drive {
    /// Makes a fault happen, as if the drive had found it. A lasting one cannot be acknowledged before
    /// [`remove_cause`](Self::remove_cause) ends its cause.
    pub fn inject_fault(&mut self, number: u16, lasting: bool) {
        self.raise_from_outside(number, lasting);
    }

    /// Ends the cause of a lasting fault; it can be acknowledged then.
    pub fn remove_cause(&mut self, number: u16) {
        self.end_cause(number);
    }

    /// DRV.DISSOURCES: why the power stage is off.
    pub(super) fn disable_sources(&self) -> i64 {
        let bit = |set: bool, bit: i64| if set { bit } else { 0 };
        bit(!self.is_enabled(), SOFTWARE)
            | bit(self.has_fault(), FAULT)
            | bit(self.outside.hardware_disable, HARDWARE)
            | bit(self.outside.controlled_stop, CONTROLLED_STOP)
    }
}
