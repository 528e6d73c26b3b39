//! The state of the drive, decoded from its telegram.

use profile::state::{State, Stw1, Zsw1};

/// Input data of an axis; what its telegram does not carry is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Seen {
    /// Status word 1, in the bits of the profile whatever words the model has.
    pub zsw1: Zsw1,
    /// The status word as it came.
    pub word: u16,
    /// Speed actual value A (N2).
    pub nist_a: Option<i16>,
    /// Position actual value A in increments.
    pub xist_a: Option<i32>,
    /// AKTSATZ: the traversing task under way.
    pub aktsatz: Option<u16>,
    /// Position error in increments (AKD signal 104).
    pub xist_error: Option<i32>,
}

/// Returns a state for a sentence; `None` is a drive that is not ready, in its self test for example.
pub(super) fn state_words(state: Option<State>) -> String {
    state.map_or_else(|| "no state yet (not ready)".into(), |state| state.to_string())
}

impl Seen {
    /// Returns the state, read with the control word that the drive was sent; see [`Zsw1::state`].
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

    /// ZSW1 bit 9: the drive requests control by the PLC.
    #[must_use]
    pub const fn control_requested(self) -> bool {
        self.zsw1.has(Zsw1::CONTROL_REQUESTED)
    }

    /// The power stage may be on (S3, S4): bit 1 or 2 is 1.
    #[must_use]
    pub const fn power_is_on(self) -> bool {
        self.zsw1.has(Zsw1::READY_TO_OPERATE) || self.zsw1.has(Zsw1::OPERATION_ENABLED)
    }

    /// ZSW1 bit 1 is 0: the pulses are off for certain (S1, S2, fault).
    #[must_use]
    pub const fn pulses_off(self) -> bool {
        !self.zsw1.has(Zsw1::READY_TO_OPERATE)
    }

    /// Returns whether the speed is at most `threshold` (as NIST_A); a telegram without speed does not say so.
    #[must_use]
    pub const fn stands(self, threshold: u16) -> bool {
        match self.nist_a {
            Some(speed) => speed.unsigned_abs() <= threshold,
            None => false,
        }
    }

    /// ZSW1 bit 13, position mode: the axis stands.
    #[must_use]
    pub const fn stopped(self) -> bool {
        self.zsw1.has(Zsw1::STOPPED)
    }

    /// ZSW1 bit 11, position mode: the home position is set.
    #[must_use]
    pub const fn homed(self) -> bool {
        self.zsw1.has(Zsw1::HOMED)
    }

    /// ZSW1 bit 12, position mode: the traversing task is accepted.
    #[must_use]
    pub const fn task_acknowledged(self) -> bool {
        self.zsw1.has(Zsw1::TASK_ACKNOWLEDGED)
    }

    /// ZSW1 bit 10: target position or comparison speed reached.
    #[must_use]
    pub const fn reached(self) -> bool {
        self.zsw1.has(Zsw1::REACHED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_faults_and_standstill() {
        let seen = |zsw1, nist_a| Seen {
            zsw1: Zsw1(zsw1),
            nist_a: Some(nist_a),
            ..Seen::default()
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
        assert!(!Seen::default().stands(3), "no speed, no standstill");
        assert!(seen(0x0231, -3).stands(3) && !seen(0x0231, -4).stands(3));
        assert!(seen(0x0231, 0).pulses_off() && !seen(0x0233, 0).pulses_off());
        assert!(seen(0x0231, 0).control_requested() && !seen(0x0031, 0).control_requested());
        assert_eq!(state_words(Some(State::S4)), "S4 operation");
        assert_eq!(state_words(None), "no state yet (not ready)");
    }
}
