//! What each bit of STW1 and ZSW1 is called and means, in velocity and in position mode.
//!
//! Source: AKD manual 5.4 and 5.5; profile 6.3.1 by way of Eaton MN040010EN and ABB FENA.

use crate::telegram::Telegram;

/// What the axis is for, which decides over the meaning of some bits.
/// Source: PNU 930; AKD manual 5.4.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Mode {
    /// Speed control, application class 1.
    #[default]
    Velocity,
    /// Positioning, application class 3.
    Position,
}

impl Mode {
    /// Returns the mode that decides over the words of a drive: PNU 930, which is all that the drive goes by. Where it is
    /// not known, a telegram that selects traversing tasks ([`Telegram::positions`]) is taken as position mode.
    ///
    /// ```
    /// use profidrive_profile::state::Mode;
    /// use profidrive_profile::telegram::{KOLLMORGEN, Telegram};
    /// let telegram = |number| Telegram::find(number, KOLLMORGEN);
    /// assert_eq!(Mode::of(None, telegram(9)), Mode::Position);
    /// assert_eq!(Mode::of(None, telegram(400)), Mode::Position);
    /// assert_eq!(Mode::of(Some(2), telegram(1)), Mode::Position);
    /// assert_eq!(Mode::of(Some(1), telegram(9)), Mode::Velocity);
    /// ```
    #[must_use]
    pub fn of(operating_mode: Option<i64>, telegram: Option<&Telegram>) -> Self {
        let position = operating_mode.map_or_else(
            || telegram.is_some_and(Telegram::positions),
            |operating_mode| operating_mode == 2,
        );
        if position { Self::Position } else { Self::Velocity }
    }

    /// Returns the word for people: `velocity` or `position`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Position => "position",
        }
    }
}

/// One bit of a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bit {
    /// Number, 0 to 15.
    pub number: u8,
    /// Short name, for example `EN_OP`; for an inverse bit the name of what it holds off, for example `OFF2`.
    pub name: &'static str,
    /// Meaning of 1.
    pub on: &'static str,
    /// Meaning of 0.
    pub off: &'static str,
    /// True when 1 is the quiet state: to be shown by its meaning, never by its name.
    pub inverse: bool,
}

/// One bit of a word with its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BitMeaning {
    /// Number, 0 to 15.
    pub number: u8,
    /// Short name, see [`Bit::name`].
    pub name: &'static str,
    /// Value.
    pub set: bool,
    /// What the value means, for example `OFF2 not active`.
    pub meaning: &'static str,
    /// True when 1 is the quiet state.
    pub inverse: bool,
}

/// Returns the bits of STW1 in this mode.
#[must_use]
pub const fn stw1(mode: Mode) -> &'static [Bit; 16] {
    match mode {
        Mode::Velocity => &STW1_VELOCITY,
        Mode::Position => &STW1_POSITION,
    }
}

/// Returns the bits of ZSW1 in this mode.
#[must_use]
pub const fn zsw1(mode: Mode) -> &'static [Bit; 16] {
    match mode {
        Mode::Velocity => &ZSW1_VELOCITY,
        Mode::Position => &ZSW1_POSITION,
    }
}

/// Each bit of a word with its meaning, bit 0 first.
pub fn describe(table: &'static [Bit; 16], word: u16) -> impl Iterator<Item = BitMeaning> {
    table.iter().map(move |bit| {
        let set = word & (1 << bit.number) != 0;
        BitMeaning {
            number: bit.number,
            name: bit.name,
            set,
            meaning: if set { bit.on } else { bit.off },
            inverse: bit.inverse,
        }
    })
}

/// What a word says in short: the bits that are set by their name; an inverse bit by its meaning, and only where it
/// stops something.
///
/// ```
/// use profidrive_profile::state::{Mode, bits};
/// let texts: Vec<_> = bits::texts(bits::stw1(Mode::Velocity), 0x047D).collect();
/// assert_eq!(texts[..2], ["ON", "OFF2: coast stop, pulses off at once"]);
/// ```
pub fn texts(table: &'static [Bit; 16], word: u16) -> impl Iterator<Item = &'static str> {
    describe(table, word).filter_map(|bit| match (bit.inverse, bit.set) {
        (false, true) => Some(bit.name),
        (true, false) => Some(bit.meaning),
        _ => None,
    })
}

pub(super) const fn bit(number: u8, name: &'static str, on: &'static str, off: &'static str) -> Bit {
    Bit {
        number,
        name,
        on,
        off,
        inverse: false,
    }
}

pub(super) const fn inverse(number: u8, name: &'static str, on: &'static str, off: &'static str) -> Bit {
    Bit {
        number,
        name,
        on,
        off,
        inverse: true,
    }
}

const fn free(number: u8, name: &'static str) -> Bit {
    bit(number, name, "device specific", "-")
}

const ON: Bit = bit(0, "ON", "ON", "OFF (OFF1): ramp stop, then S2");
const NO_OFF2: Bit = inverse(
    1,
    "OFF2",
    "OFF2 not active",
    "OFF2: coast stop, pulses off at once",
);
const NO_OFF3: Bit = inverse(2, "OFF3", "OFF3 not active", "OFF3: quick stop");
const EN_OP: Bit = bit(3, "EN_OP", "operation enabled", "operation disabled");
const ACK: Bit = bit(
    7,
    "ACK",
    "acknowledge fault (the 0 to 1 edge counts)",
    "no acknowledge",
);
const JOG1: Bit = bit(8, "JOG1", "jog 1", "no jog 1");
const JOG2: Bit = bit(9, "JOG2", "jog 2", "no jog 2");
const CTRL_PLC: Bit = bit(
    10,
    "CTRL_PLC",
    "control by PLC: process data valid",
    "process data not valid, the drive ignores them",
);
const BIT14: Bit = free(14, "BIT14");
const BIT15: Bit = free(15, "BIT15");

static STW1_VELOCITY: [Bit; 16] = [
    ON,
    NO_OFF2,
    NO_OFF3,
    EN_OP,
    bit(
        4,
        "EN_RAMP",
        "ramp generator enabled",
        "ramp generator output forced to 0",
    ),
    bit(5, "UNFREEZE", "ramp generator runs", "ramp generator frozen"),
    bit(
        6,
        "EN_SETPOINT",
        "setpoint enabled",
        "setpoint 0: brakes along the ramp",
    ),
    ACK,
    JOG1,
    JOG2,
    CTRL_PLC,
    free(11, "BIT11"),
    free(12, "BIT12"),
    free(13, "BIT13"),
    BIT14,
    BIT15,
];

static STW1_POSITION: [Bit; 16] = [
    ON,
    NO_OFF2,
    NO_OFF3,
    EN_OP,
    bit(
        4,
        "NO_REJECT",
        "traversing task not rejected",
        "reject traversing task: brakes with maximum deceleration, task lost",
    ),
    bit(
        5,
        "NO_INT_STOP",
        "no intermediate stop",
        "intermediate stop: brakes along the ramp, task stays",
    ),
    bit(
        6,
        "START_TASK",
        "activate traversing task (the 0 to 1 edge counts)",
        "no new traversing task",
    ),
    ACK,
    JOG1,
    JOG2,
    CTRL_PLC,
    bit(11, "HOMING", "start homing", "no homing: a running one stops"),
    bit(
        12,
        "RT_JOG",
        "real-time jogging with the MDI values (AKD)",
        "no real-time jogging",
    ),
    bit(
        13,
        "RT_JOG_CCW",
        "real-time jogging counter-clockwise (AKD)",
        "real-time jogging clockwise",
    ),
    BIT14,
    BIT15,
];

const READY_ON: Bit = bit(
    0,
    "READY_ON",
    "ready for switching on",
    "not ready for switching on",
);
const READY_OP: Bit = bit(1, "READY_OP", "ready for operation", "not ready for operation");
const OPERATION: Bit = bit(
    2,
    "OPERATION",
    "operation enabled, the drive follows the setpoint",
    "operation disabled",
);
const FAULT: Bit = bit(3, "FAULT", "fault present", "no fault");
const OFF2: Bit = inverse(4, "OFF2", "OFF2 not active", "OFF2 active: coast stop");
const OFF3: Bit = inverse(5, "OFF3", "OFF3 not active", "OFF3 active: quick stop");
const INHIBIT: Bit = bit(
    6,
    "INHIBIT",
    "switching on inhibited: OFF first, then ON",
    "switching on not inhibited",
);
const WARNING: Bit = bit(7, "WARNING", "warning present", "no warning");
const CTRL_REQ: Bit = bit(
    9,
    "CTRL_REQ",
    "control requested from the PLC",
    "no control requested: local operation",
);

static ZSW1_VELOCITY: [Bit; 16] = [
    READY_ON,
    READY_OP,
    OPERATION,
    FAULT,
    OFF2,
    OFF3,
    INHIBIT,
    WARNING,
    bit(
        8,
        "IN_TOLERANCE",
        "speed error within tolerance",
        "speed error out of tolerance",
    ),
    CTRL_REQ,
    bit(
        10,
        "REACHED",
        "comparison speed reached",
        "comparison speed not reached",
    ),
    free(11, "BIT11"),
    free(12, "BIT12"),
    free(13, "BIT13"),
    BIT14,
    BIT15,
];

static ZSW1_POSITION: [Bit; 16] = [
    READY_ON,
    READY_OP,
    OPERATION,
    FAULT,
    OFF2,
    OFF3,
    INHIBIT,
    WARNING,
    bit(
        8,
        "IN_TOLERANCE",
        "following error in the window",
        "following error out of the window",
    ),
    CTRL_REQ,
    bit(
        10,
        "REACHED",
        "target position reached",
        "target position not reached",
    ),
    bit(11, "HOMED", "home position set", "home position not set"),
    bit(
        12,
        "TASK_ACK",
        "traversing task acknowledged",
        "no traversing task acknowledged",
    ),
    bit(13, "STOPPED", "axis stands still", "axis moves"),
    bit(
        14,
        "TASK_ACTIVE",
        "motion task active (AKD)",
        "no motion task active",
    ),
    BIT15,
];

#[cfg(test)]
mod tests {
    use super::super::{Stw1, Zsw1};
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn every_bit_once_in_order_with_its_own_name() {
        for mode in [Mode::Velocity, Mode::Position] {
            for table in [stw1(mode), zsw1(mode)] {
                for (number, bit) in table.iter().enumerate() {
                    assert_eq!(usize::from(bit.number), number);
                    assert_eq!(table.iter().filter(|other| other.name == bit.name).count(), 1);
                }
            }
        }
    }

    #[test]
    fn run_by_name() {
        let names: Vec<_> = Stw1::RUN
            .describe(Mode::Velocity)
            .filter(|bit| bit.set && !bit.inverse)
            .map(|bit| bit.name)
            .collect();
        assert_eq!(
            names,
            ["ON", "EN_OP", "EN_RAMP", "UNFREEZE", "EN_SETPOINT", "CTRL_PLC"]
        );
    }

    #[test]
    fn inverse_bits_by_meaning() {
        let meaning = |word: Zsw1, number| word.describe(Mode::Velocity).nth(number).unwrap().meaning;
        assert_eq!(meaning(Zsw1(0x0237), 4), "OFF2 not active");
        assert_eq!(meaning(Zsw1(0x0213), 5), "OFF3 active: quick stop");
        let stop = Stw1(0x046F).describe(Mode::Position).nth(4).unwrap();
        assert!(!stop.set && stop.meaning.starts_with("reject"));
    }

    #[test]
    fn modes_differ_as_in_the_manual() {
        let differing = |a: &[Bit; 16], b: &[Bit; 16]| -> Vec<u8> {
            a.iter()
                .zip(b)
                .filter(|(a, b)| a != b)
                .map(|(a, _)| a.number)
                .collect()
        };
        assert_eq!(differing(&STW1_VELOCITY, &STW1_POSITION), [4, 5, 6, 11, 12, 13]);
        assert_eq!(differing(&ZSW1_VELOCITY, &ZSW1_POSITION), [8, 10, 11, 12, 13, 14]);
    }
}
