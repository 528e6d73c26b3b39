//! Words: numbers of which each bit, or a few bits together, have a meaning of their own.

use alloc::borrow::ToOwned;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use super::Meaning;
use crate::state::{Mode, Profile, bits};

/// Whose bits a word has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum WordKind {
    /// The control word: bits of STW1, which depend on the mode, or of the profile that a vendor has in its place.
    Control,
    /// The status word: the same of ZSW1.
    Status,
    /// The vendor's own.
    Own,
}

/// A few bits of a word that are one small number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    /// Lowest bit.
    pub first: u8,
    /// Highest bit.
    pub last: u8,
    /// What the number is.
    pub name: &'static str,
    /// Texts of its values.
    pub choices: &'static [Meaning],
}

/// Meanings of the bits of one parameter.
///
/// ```
/// use profidrive_profile::catalogue::{AKD, VLT};
/// use profidrive_profile::state::{Mode, Profile};
/// let word = AKD.word(2120).unwrap(); // DRV.DISSOURCES
/// assert_eq!(word.describe(0x0003, Profile::Profidrive, Mode::Velocity), ["Software disable", "Fault present"]);
/// let word = AKD.word(2).unwrap(); // ZSW1
/// assert_eq!(word.describe(0x0231, Profile::Profidrive, Mode::Velocity), ["READY_ON", "CTRL_REQ"]);
/// let word = VLT.word(1603).unwrap(); // 16-03, while a PPO type carries the FC profile
/// assert_eq!(word.describe(0x0603, Profile::DanfossFc, Mode::Velocity), ["CTRL_READY", "DRIVE_READY", "BUS_CTRL", "FREQ_OK"]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    /// Number of the parameter.
    pub pnu: u16,
    /// Its subindex where it is an element of a collecting number.
    pub base: Option<u16>,
    /// Whose bits these are.
    pub kind: WordKind,
    /// Texts of the vendor's own bits.
    pub bits: &'static [Meaning],
    /// Bits that belong together.
    pub fields: &'static [Field],
}

impl Field {
    /// Returns its number in a word.
    #[must_use]
    pub const fn of(&self, word: u64) -> u64 {
        let width = self.last.saturating_sub(self.first) as u32 + 1;
        let mask = if width >= 64 { u64::MAX } else { (1 << width) - 1 };
        (word >> self.first) & mask
    }

    const fn has(&self, bit: u8) -> bool {
        self.first <= bit && bit <= self.last
    }

    fn describe(&self, word: u64) -> String {
        let number = self.of(word);
        let choice = self
            .choices
            .iter()
            .find(|choice| u64::try_from(choice.value) == Ok(number));
        match choice {
            Some(choice) => format!("{}: {}", self.name, choice.text),
            None => format!("{}: {number}", self.name),
        }
    }
}

impl Word {
    /// Returns the text of a value: the bits that are set by their name, an inverse bit by its meaning and only where it
    /// stops something, a few bits that are a number by its text. Empty when no bit has a text. `profile`
    /// contains the words that the drive has now.
    #[must_use]
    pub fn describe(&self, value: u64, profile: Profile, mode: Mode) -> Vec<String> {
        let table = match self.kind {
            WordKind::Control => profile.control_bits(mode),
            WordKind::Status => profile.status_bits(mode),
            WordKind::Own => return self.own(value),
        };
        let low = u16::try_from(value & 0xFFFF).unwrap_or_default();
        bits::texts(table, low).map(ToOwned::to_owned).collect()
    }

    fn own(&self, value: u64) -> Vec<String> {
        let mut texts: Vec<String> = self.fields.iter().map(|field| field.describe(value)).collect();
        for bit in (0..64).filter(|bit| value >> bit & 1 == 1) {
            if self.fields.iter().any(|field| field.has(bit)) {
                continue;
            }
            let text = self.bits.iter().find(|row| row.value == i32::from(bit));
            texts.push(text.map_or_else(|| format!("bit {bit}"), |row| row.text.to_owned()));
        }
        texts
    }
}

#[cfg(test)]
mod tests {
    use super::super::AKD;
    use super::*;

    fn describe(name: &str, value: u64) -> Vec<String> {
        let pnu = AKD.by_name(name).unwrap().pnu;
        AKD.word(pnu)
            .unwrap()
            .describe(value, Profile::Profidrive, Mode::Position)
    }

    #[test]
    fn words_are_in_order_and_their_bits_those_of_the_parameter() {
        assert!(AKD.words.windows(2).all(|pair| pair[0].pnu < pair[1].pnu));
        for word in AKD.words {
            let parameter = AKD.by_pnu(word.pnu).unwrap();
            assert_eq!(parameter.bits, word.bits, "{}", parameter.name);
            let bits = 8 * u8::try_from(parameter.octets()).unwrap();
            assert!(
                word.fields
                    .iter()
                    .all(|field| field.first <= field.last && field.last < bits)
            );
        }
        for parameter in AKD
            .parameters
            .iter()
            .filter(|parameter| !parameter.bits.is_empty())
        {
            assert!(AKD.word(parameter.pnu).is_some(), "{}", parameter.name);
        }
    }

    #[test]
    fn bits_fields_and_unnamed_bits() {
        assert_eq!(
            describe("MT.CNTL", 0x0_0011),
            [
                "Task type: Relative to PL.CMD",
                "Start of the following task: At once after stopping",
                "Acceleration type: Trapezoidal",
                "A following task is executed"
            ]
        );
        assert_eq!(
            describe("MT.CNTL", 0x0204)[..2],
            [
                "Task type: 4",
                "Start of the following task: Change on the fly, reaches the target at the present speed"
            ]
        );
        assert_eq!(describe("DRV.DISSOURCES", 0x8002), ["Fault present", "bit 15"]);
        assert_eq!(describe("DRV.MOTIONDISSOURCES", 1), ["bit 0"]);
        assert!(describe("DRV.MOTIONSTAT", 0).is_empty());
        assert_eq!(describe("DRIVE_MOTION_STATUS", 1), describe("DRV.MOTIONSTAT", 1));
        assert_eq!(describe("DRIVE_INPUTS", 0x40), ["Torque allowed (STO.STATE)"]);
        assert_eq!(
            describe("SATZANW", 0x8005),
            [
                "Motion task: 5",
                "MDI: the task is that of the MDI signals, bits 0 to 14 do not count"
            ]
        );
        assert_eq!(
            describe("AKTSATZ", 0x8000),
            ["Motion task that runs: none of 1 to 128", "The MDI task runs"]
        );
        assert_eq!(
            describe("AKTSATZ", 0),
            ["Motion task that runs: none of 1 to 128"]
        );
        assert_eq!(describe("AKTSATZ", 5), ["Motion task that runs: 5"]);
        assert_eq!(
            describe("MDI_MOD", 0x8001),
            ["Absolute positioning, else relative", "Reserved"]
        );
        let mode = AKD.by_pnu(930).unwrap();
        assert!(
            mode.choice(0x8000)
                .is_some_and(|text| text.starts_with("current control"))
        );
    }

    #[test]
    fn inverse_bits_are_listed_when_they_stop_something() {
        let position = ["ON", "EN_OP", "NO_REJECT", "NO_INT_STOP", "CTRL_PLC"];
        assert_eq!(describe("STW1", 0x043F), position);
        assert!(describe("STW1", 0x043D).contains(&"OFF2: coast stop, pulses off at once".into()));
    }
}
