//! What the drive says about its state, read from telegram 1.

use core::fmt;

/// Input data of telegram 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Seen {
    /// Status word 1.
    pub zsw1: u16,
    /// Speed actual value A (N2).
    pub nist_a: i16,
}

/// State of the drive as far as ZSW1 tells it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Bits 0, 1, 2 and 6 all zero: self test, or no data yet.
    NotReady,
    /// Switching on inhibited.
    S1,
    /// Ready for switching on.
    S2,
    /// Switched on.
    S3,
    /// Operation.
    S4,
    /// Switching off: a ramp stop or a quick stop is under way.
    S5,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotReady => "not ready",
            Self::S1 => "S1 switching on inhibited",
            Self::S2 => "S2 ready for switching on",
            Self::S3 => "S3 switched on",
            Self::S4 => "S4 operation",
            Self::S5 => "S5 switching off",
        })
    }
}

impl Seen {
    /// The state. S3 and a ramp stop look alike in bits 0 to 6; the speed tells them apart only for a moving axis,
    /// which is why the control does not rely on seeing S5.
    #[must_use]
    pub fn phase(self) -> Phase {
        let bit = |n: u16| self.zsw1 & (1 << n) != 0;
        if bit(6) {
            Phase::S1
        } else if bit(0) && bit(1) && bit(2) && bit(5) && bit(4) {
            Phase::S4
        } else if bit(0) && bit(1) && !bit(5) {
            Phase::S5
        } else if bit(0) && bit(1) {
            Phase::S3
        } else if bit(0) {
            Phase::S2
        } else {
            Phase::NotReady
        }
    }

    /// ZSW1 bit 3: a fault waits to be acknowledged.
    #[must_use]
    pub const fn fault(self) -> bool {
        self.zsw1 & (1 << 3) != 0
    }

    /// ZSW1 bit 7: a warning is present.
    #[must_use]
    pub const fn warning(self) -> bool {
        self.zsw1 & (1 << 7) != 0
    }

    /// ZSW1 bit 9: the drive asks the PLC to take control.
    #[must_use]
    pub const fn control_requested(self) -> bool {
        self.zsw1 & (1 << 9) != 0
    }

    /// ZSW1 bit 1 is 0: the pulses are off for certain (S1, S2, fault).
    #[must_use]
    pub const fn pulses_off(self) -> bool {
        self.zsw1 & (1 << 1) == 0
    }

    /// The speed is at most `threshold` (as NIST_A).
    #[must_use]
    pub const fn stands(self, threshold: u16) -> bool {
        self.nist_a.unsigned_abs() <= threshold
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_of_the_typical_words() {
        for (zsw1, phase) in [
            (0x0240, Phase::S1),
            (0x0270, Phase::S1),
            (0x0278, Phase::S1),
            (0x0231, Phase::S2),
            (0x0233, Phase::S3),
            (0x0237, Phase::S4),
            (0x0213, Phase::S5),
            (0x0217, Phase::S5),
            (0x0000, Phase::NotReady),
        ] {
            assert_eq!(Seen { zsw1, nist_a: 0 }.phase(), phase, "{zsw1:#06x}");
        }
        assert!(
            Seen {
                zsw1: 0x0278,
                nist_a: 0
            }
            .fault()
        );
        assert!(
            Seen {
                zsw1: 0x0231,
                nist_a: -3
            }
            .stands(3)
        );
    }
}
