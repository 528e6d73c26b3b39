//! The bits of control and status words; those of STW1 and ZSW1 in velocity and in position mode (`data/profile/words.csv`).

use super::generated_bits;
use crate::telegram::Telegram;

/// Operating mode of the axis, which determines the meaning of some bits.
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
        Mode::Velocity => &generated_bits::STW1_VELOCITY,
        Mode::Position => &generated_bits::STW1_POSITION,
    }
}

/// Returns the bits of ZSW1 in this mode.
#[must_use]
pub const fn zsw1(mode: Mode) -> &'static [Bit; 16] {
    match mode {
        Mode::Velocity => &generated_bits::ZSW1_VELOCITY,
        Mode::Position => &generated_bits::ZSW1_POSITION,
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

/// Short text of a word: the bits that are set by their name; an inverse bit by its meaning, and only where it
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

#[cfg(test)]
mod tests {
    use super::super::{Stw1, Zsw1};
    use super::*;
    use alloc::vec::Vec;

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
        assert_eq!(
            differing(stw1(Mode::Velocity), stw1(Mode::Position)),
            [4, 5, 6, 11, 12, 13]
        );
        assert_eq!(
            differing(zsw1(Mode::Velocity), zsw1(Mode::Position)),
            [8, 10, 11, 12, 13, 14]
        );
    }
}
