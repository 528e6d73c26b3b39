//! Control word 1 and status word 1 as numbers with named bits.

use core::fmt;
use core::ops::{BitAnd, BitOr};

use super::State;
use super::bits::{self, BitMeaning, Mode};

/// Control word 1 (STW1, signal 1): commands of the controller to the axis.
/// Source: profile 6.3.1; AKD manual 5.4.
///
/// ```
/// use profidrive_profile::state::{Mode, Stw1};
/// assert_eq!(Stw1::RUN.to_string(), "0x047F");
/// assert!(Stw1::RUN.has(Stw1::ON | Stw1::CONTROL_BY_PLC));
/// let off2 = Stw1::COAST_STOP.describe(Mode::Velocity).nth(1).unwrap();
/// assert_eq!((off2.name, off2.meaning), ("OFF2", "OFF2: coast stop, pulses off at once"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Stw1(pub u16);

/// Status word 1 (ZSW1, signal 2): status reported by the axis.
/// Source: profile 6.3.1; AKD manual 5.5.
///
/// ```
/// use profidrive_profile::state::{State, Stw1, Zsw1};
/// let word = Zsw1(0x0337);
/// assert_eq!(word.state(Stw1::RUN), Some(State::S4));
/// assert!(word.has(Zsw1::IN_TOLERANCE) && !word.has(Zsw1::FAULT));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Zsw1(pub u16);

impl Stw1 {
    /// Bit 0: ON; 0 is OFF (OFF1), a ramp stop.
    pub const ON: Self = Self(1 << 0);
    /// Bit 1: no coast stop; 0 is OFF2, pulses off at once.
    pub const NO_COAST_STOP: Self = Self(1 << 1);
    /// Bit 2: no quick stop; 0 is OFF3.
    pub const NO_QUICK_STOP: Self = Self(1 << 2);
    /// Bit 3: enable operation.
    pub const ENABLE_OPERATION: Self = Self(1 << 3);
    /// Bit 4, velocity: enable the ramp generator; 0 forces its output to 0.
    pub const ENABLE_RAMP: Self = Self(1 << 4);
    /// Bit 4, position: do not reject the traversing task.
    pub const NO_REJECT: Self = Self(1 << 4);
    /// Bit 5, velocity: unfreeze the ramp generator.
    pub const UNFREEZE_RAMP: Self = Self(1 << 5);
    /// Bit 5, position: no intermediate stop.
    pub const NO_INTERMEDIATE_STOP: Self = Self(1 << 5);
    /// Bit 6, velocity: enable the setpoint; 0 makes the input of the ramp generator 0.
    pub const ENABLE_SETPOINT: Self = Self(1 << 6);
    /// Bit 6, position: the edge from 0 to 1 activates the traversing task.
    pub const ACTIVATE_TASK: Self = Self(1 << 6);
    /// Bit 7: the edge from 0 to 1 acknowledges faults.
    pub const ACKNOWLEDGE_FAULT: Self = Self(1 << 7);
    /// Bit 8: jog 1.
    pub const JOG_1: Self = Self(1 << 8);
    /// Bit 9: jog 2.
    pub const JOG_2: Self = Self(1 << 9);
    /// Bit 10: control by PLC; with 0 the drive ignores the word and the setpoints.
    pub const CONTROL_BY_PLC: Self = Self(1 << 10);
    /// Bit 11, position: start homing; 0 stops it.
    pub const START_HOMING: Self = Self(1 << 11);
    /// Bit 12, position: real-time jogging with the MDI values. AKD only, manual 5.4.
    pub const REAL_TIME_JOG: Self = Self(1 << 12);
    /// Bit 13, position: real-time jogging counter-clockwise. AKD only, manual 5.4.
    pub const REAL_TIME_JOG_REVERSE: Self = Self(1 << 13);

    /// `0x047E`: ready, everything but ON. From S1 it leads to S2, from S4 it is a ramp stop.
    pub const READY: Self = Self(0x047E);
    /// `0x047F`: run, from S2 through S3 to S4.
    pub const RUN: Self = Self(0x047F);
    /// `0x04FE`: ready, and acknowledge faults.
    pub const ACKNOWLEDGE: Self = Self(0x04FE);
    /// `0x047B`: quick stop (OFF3).
    pub const QUICK_STOP: Self = Self(0x047B);
    /// `0x047D`: coast stop (OFF2).
    pub const COAST_STOP: Self = Self(0x047D);

    /// True when more than one bit commands a jog: then none of them moves the axis.
    #[must_use]
    pub const fn jogs_at_once(self, mode: Mode) -> bool {
        let bits = match mode {
            Mode::Velocity => Self::JOG_1.0 | Self::JOG_2.0,
            Mode::Position => Self::JOG_1.0 | Self::JOG_2.0 | Self::REAL_TIME_JOG.0,
        };
        (self.0 & bits).count_ones() > 1
    }
}

impl Zsw1 {
    /// Bit 0: ready for switching on.
    pub const READY_TO_SWITCH_ON: Self = Self(1 << 0);
    /// Bit 1: ready for operation.
    pub const READY_TO_OPERATE: Self = Self(1 << 1);
    /// Bit 2: operation enabled, the axis follows the setpoint.
    pub const OPERATION_ENABLED: Self = Self(1 << 2);
    /// Bit 3: a fault is not acknowledged.
    pub const FAULT: Self = Self(1 << 3);
    /// Bit 4: no coast stop commanded.
    pub const NO_COAST_STOP: Self = Self(1 << 4);
    /// Bit 5: no quick stop commanded or running.
    pub const NO_QUICK_STOP: Self = Self(1 << 5);
    /// Bit 6: switching on inhibited.
    pub const INHIBITED: Self = Self(1 << 6);
    /// Bit 7: warning present.
    pub const WARNING: Self = Self(1 << 7);
    /// Bit 8: speed error or following error within tolerance.
    pub const IN_TOLERANCE: Self = Self(1 << 8);
    /// Bit 9: the drive requests control by the controller; 0 is local operation.
    pub const CONTROL_REQUESTED: Self = Self(1 << 9);
    /// Bit 10: comparison speed or target position reached.
    pub const REACHED: Self = Self(1 << 10);
    /// Bit 11, position: home position set.
    pub const HOMED: Self = Self(1 << 11);
    /// Bit 12, position: traversing task acknowledged.
    pub const TASK_ACKNOWLEDGED: Self = Self(1 << 12);
    /// Bit 13, position: the axis stands still.
    pub const STOPPED: Self = Self(1 << 13);
    /// Bit 14, position: motion task active. AKD only, manual 5.5.
    pub const TASK_ACTIVE: Self = Self(1 << 14);

    /// Bits that encode the state: 0, 1, 2, 4, 5 and 6.
    pub const STATE_BITS: Self = Self(0x0077);
    /// The bits that the state machine leaves to the application: 7, 8 and 10 to 15.
    pub const APPLICATION_BITS: Self = Self(0xFD80);

    /// Returns the state encoded in the word; `None` for a drive that is not ready (self test).
    ///
    /// S3 and a ramp stop have the same bits. A drive that was sent OFF, or that has a fault, is in the ramp stop. Bit
    /// 2 is not looked at while a stop runs, vendors differ. The separate fault state of some vendors (bit 6 is 0) is
    /// S1.
    #[must_use]
    pub const fn state(self, sent: Stw1) -> Option<State> {
        let fault = self.has(Self::FAULT);
        if self.has(Self::INHIBITED) {
            return Some(State::S1);
        }
        if self.has(Self::READY_TO_OPERATE) {
            return Some(if !self.has(Self::NO_QUICK_STOP) {
                State::S5Quick
            } else if fault || (sent.has(Stw1::CONTROL_BY_PLC) && !sent.has(Stw1::ON)) {
                State::S5Ramp
            } else if self.has(Self::OPERATION_ENABLED) {
                State::S4
            } else {
                State::S3
            });
        }
        match (self.has(Self::READY_TO_SWITCH_ON), fault) {
            (true, _) => Some(State::S2),
            (false, true) => Some(State::S1),
            (false, false) => None,
        }
    }
}

macro_rules! word {
    ($name:ident, $table:path) => {
        impl $name {
            /// Returns true when all of these bits are 1.
            #[must_use]
            pub const fn has(self, bits: Self) -> bool {
                self.0 & bits.0 == bits.0
            }

            /// Returns the word with these bits 1.
            #[must_use]
            pub const fn with(self, bits: Self) -> Self {
                Self(self.0 | bits.0)
            }

            /// Returns the word with these bits 0.
            #[must_use]
            pub const fn without(self, bits: Self) -> Self {
                Self(self.0 & !bits.0)
            }

            /// Number, short name and meaning of each bit, bit 0 first. An inverse bit is reported by what it holds
            /// off.
            pub fn describe(self, mode: Mode) -> impl Iterator<Item = BitMeaning> {
                bits::describe($table(mode), self.0)
            }
        }

        impl BitOr for $name {
            type Output = Self;

            fn bitor(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }

        impl BitAnd for $name {
            type Output = Self;

            fn bitand(self, other: Self) -> Self {
                Self(self.0 & other.0)
            }
        }

        impl From<u16> for $name {
            fn from(word: u16) -> Self {
                Self(word)
            }
        }

        impl From<$name> for u16 {
            fn from(word: $name) -> Self {
                word.0
            }
        }

        impl fmt::Display for $name {
            /// `0x047F`
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "0x{:04X}", self.0)
            }
        }
    };
}

word!(Stw1, bits::stw1);
word!(Zsw1, bits::zsw1);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_control_and_status_words() {
        let held = Stw1::NO_COAST_STOP | Stw1::NO_QUICK_STOP | Stw1::ENABLE_OPERATION;
        let channel = Stw1::ENABLE_RAMP | Stw1::UNFREEZE_RAMP | Stw1::ENABLE_SETPOINT;
        let ready = held | channel | Stw1::CONTROL_BY_PLC;
        assert_eq!(Stw1::READY, ready);
        assert_eq!(Stw1::RUN, ready.with(Stw1::ON));
        assert_eq!(Stw1::ACKNOWLEDGE, ready.with(Stw1::ACKNOWLEDGE_FAULT));
        assert_eq!(Stw1::QUICK_STOP, Stw1::RUN.without(Stw1::NO_QUICK_STOP));
        assert_eq!(Stw1::COAST_STOP, Stw1::RUN.without(Stw1::NO_COAST_STOP));
    }

    #[test]
    fn states_out_of_typical_words() {
        let state = |zsw1, stw1| Zsw1(zsw1).state(stw1);
        for s1 in [0x0240, 0x0270, 0x0278, 0x0238, 0x0208] {
            assert_eq!(state(s1, Stw1::READY), Some(State::S1), "{s1:04X}");
        }
        assert_eq!(state(0x0231, Stw1::RUN), Some(State::S2));
        assert_eq!(state(0x0233, Stw1::RUN), Some(State::S3));
        assert_eq!(state(0x0737, Stw1::RUN), Some(State::S4));
        assert_eq!(state(0x0233, Stw1::READY), Some(State::S5Ramp));
        assert_eq!(state(0x0237, Stw1::READY), Some(State::S5Ramp)); // Lenze
        assert_eq!(state(0x023B, Stw1::RUN), Some(State::S5Ramp)); // stop after a fault
        assert_eq!(state(0x0213, Stw1::RUN), Some(State::S5Quick));
        assert_eq!(state(0x0217, Stw1::QUICK_STOP), Some(State::S5Quick));
        assert_eq!(state(0x0200, Stw1::RUN), None);
        // A word without control by PLC is not an OFF command.
        assert_eq!(state(0x0237, Stw1(0)), Some(State::S4));
    }

    #[test]
    fn bits_of_the_state_machine_and_of_the_application_are_all_bits() {
        let own = Zsw1::STATE_BITS | Zsw1::FAULT | Zsw1::CONTROL_REQUESTED;
        assert_eq!(own.0 ^ Zsw1::APPLICATION_BITS.0, 0xFFFF);
    }
}
