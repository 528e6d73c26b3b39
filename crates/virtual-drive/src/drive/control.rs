//! The profile's state machine as the drive uses it.

use super::State;

/// What the machine sees.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub control: u16,
    pub standing: bool,
    pub fault: bool,
    pub coast: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Decision {
    pub state: State,
    /// Bits 0 to 6 of the status word.
    pub status: u16,
    pub pulses: bool,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Control {
    state: State,
}

impl Control {
    pub fn step(&mut self, seen: &Seen) -> Decision {
        let bit = |n: u16| seen.control & (1 << n) != 0;
        let (on, no_coast, no_quick, enable) = (bit(0), bit(1) && !seen.coast, bit(2), bit(3));
        let next = match self.state {
            State::S1 if !on && no_coast && no_quick && !seen.fault => State::S2,
            State::S1 => State::S1,
            State::S2 | State::S3 if !no_coast || !no_quick || seen.fault => State::S1,
            State::S2 if on => State::S3,
            State::S2 => State::S2,
            State::S3 if !on => State::S2,
            State::S3 if enable => State::S4,
            State::S3 => State::S3,
            _ if !no_coast => State::S1,
            State::S4 | State::S5RampStop if !no_quick || seen.fault => State::S5QuickStop,
            State::S4 if !on => State::S5RampStop,
            State::S4 if !enable => State::S3,
            State::S4 => State::S4,
            State::S5RampStop if seen.standing || !enable => State::S2,
            State::S5RampStop if on => State::S4,
            State::S5RampStop => State::S5RampStop,
            State::S5QuickStop if seen.standing || !enable && !seen.fault => State::S1,
            State::S5QuickStop => State::S5QuickStop,
        };
        self.state = next;
        let (mut status, pulses) = match next {
            State::S1 => (0x0040, false),
            State::S2 => (0x0001, false),
            State::S3 => (0x0003, false),
            State::S4 => (0x0007, true),
            State::S5RampStop | State::S5QuickStop => (0x0003, true),
        };
        if no_coast {
            status |= 0x0010;
        }
        if no_quick && next != State::S5QuickStop {
            status |= 0x0020;
        }
        if seen.fault {
            status |= 0x0008;
        }
        Decision {
            state: next,
            status,
            pulses,
        }
    }
}
