//! What the drive says about its state, read from telegram 1.

use profidrive::state::{State, Stw1, Zsw1};

/// Input data of telegram 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Seen {
    /// Status word 1.
    pub zsw1: Zsw1,
    /// Speed actual value A (N2).
    pub nist_a: i16,
}

/// A state for a sentence; `None` is a drive that is not ready, in its self test for example.
pub(super) fn state_words(state: Option<State>) -> String {
    state.map_or_else(|| "no state yet (not ready)".into(), |state| state.to_string())
}

impl Seen {
    /// The state, read with the control word that the drive was sent; see [`Zsw1::state`].
    #[must_use]
    pub const fn state(self, sent: Stw1) -> Option<State> {
        self.zsw1.state(sent)
    }

    /// ZSW1 bit 3: a fault waits to be acknowledged.
    #[must_use]
    pub const fn fault(self) -> bool {
        self.zsw1.has(Zsw1::FAULT)
    }

    /// ZSW1 bit 7: a warning is present.
    #[must_use]
    pub const fn warning(self) -> bool {
        self.zsw1.has(Zsw1::WARNING)
    }

    /// ZSW1 bit 9: the drive asks the PLC to take control.
    #[must_use]
    pub const fn control_requested(self) -> bool {
        self.zsw1.has(Zsw1::CONTROL_REQUESTED)
    }

    /// ZSW1 bit 1 is 0: the pulses are off for certain (S1, S2, fault).
    #[must_use]
    pub const fn pulses_off(self) -> bool {
        !self.zsw1.has(Zsw1::READY_TO_OPERATE)
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
    fn states_faults_and_standstill() {
        let seen = |zsw1, nist_a| Seen {
            zsw1: Zsw1(zsw1),
            nist_a,
        };
        for (zsw1, sent, state) in [
            (0x0240, Stw1::READY, Some(State::S1)),
            (0x0270, Stw1::READY, Some(State::S1)),
            (0x0278, Stw1::READY, Some(State::S1)),
            (0x0231, Stw1::RUN, Some(State::S2)),
            (0x0233, Stw1::RUN, Some(State::S3)),
            (0x0233, Stw1::READY, Some(State::S5Ramp)),
            (0x0237, Stw1::RUN, Some(State::S4)),
            (0x0213, Stw1::RUN, Some(State::S5Quick)),
            (0x0217, Stw1::RUN, Some(State::S5Quick)),
            (0x0000, Stw1::RUN, None),
        ] {
            assert_eq!(seen(zsw1, 0).state(sent), state, "{zsw1:#06x}");
        }
        assert!(seen(0x0278, 0).fault() && !seen(0x0278, 0).warning());
        assert!(seen(0x0231, -3).stands(3) && !seen(0x0231, -4).stands(3));
        assert!(seen(0x0231, 0).pulses_off() && !seen(0x0233, 0).pulses_off());
        assert!(seen(0x0231, 0).control_requested() && !seen(0x0031, 0).control_requested());
        assert_eq!(state_words(Some(State::S4)), "S4 operation");
        assert_eq!(state_words(None), "no state yet (not ready)");
    }
}
