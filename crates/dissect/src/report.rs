//! Shapes of reports that need no drive: words of bits, states and values of parameters. Every command uses these.

mod decode;

use profile::state::bits::{self, Bit};
use profile::state::{State, Stw1, Zsw1};
use profile::value::{Content, Reading};
use serde::Serialize;
use serde_json::Number;

use crate::{hex_bytes, hex16, value, words};

pub use decode::DecodeReport;

/// A word of bits: a control or status word, or a parameter whose bits have names.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Word {
    /// The word as it travels.
    pub number: u64,
    /// The same in hexadecimal: `0x047F`.
    pub hex: String,
    /// Names of the bits that are set; of an inverse bit (OFF2, OFF3) what it says while it is 0.
    pub bits: Vec<String>,
    /// What the whole word commands or reports.
    pub meaning: Option<String>,
}

impl Word {
    /// Returns a word that travels as `wire` and says in the bits of `table` what `word` says.
    #[must_use]
    pub fn of(table: &'static [Bit; 16], word: u16, wire: u16, meaning: Option<String>) -> Self {
        Self {
            number: wire.into(),
            hex: hex16(wire),
            bits: bits::texts(table, word).map(str::to_owned).collect(),
            meaning,
        }
    }

    /// Returns the word as it is shown to a person: `0x043F [ON, EN_OP, CTRL_PLC]`.
    #[must_use]
    pub fn shown(&self) -> String {
        format!("{} {}", self.hex, words::bracketed(&self.bits))
    }
}

/// State of a drive in the general state machine of PROFIdrive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum DriveState {
    /// Switching on inhibited.
    S1,
    /// Ready for switching on.
    S2,
    /// Switched on.
    S3,
    /// Operation.
    S4,
    /// Switching off.
    S5,
}

impl DriveState {
    /// Returns the state that a status word reports, with the control word that it answers; `None` for a word that no
    /// state has.
    #[must_use]
    pub fn of(zsw1: u16, sent: Option<u16>) -> Option<Self> {
        Some(match Zsw1(zsw1).state(Stw1(sent.unwrap_or(0)))? {
            State::S1 => Self::S1,
            State::S2 => Self::S2,
            State::S3 => Self::S3,
            State::S4 => Self::S4,
            State::S5Ramp | State::S5Quick => Self::S5,
        })
    }
}

/// What a parameter contains.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ParameterContent {
    /// A number in the unit of the parameter.
    Number(f64),
    /// Text, or octets in hexadecimal.
    Text(String),
}

/// One value of a parameter, or why it was not read.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Parameter {
    /// Parameter number.
    pub pnu: u16,
    /// Element of an array.
    pub index: Option<u16>,
    /// The number as the vendor writes it: `p2108`, `1-20`, `ID 103`.
    pub number: String,
    /// The vendor's name.
    pub name: Option<String>,
    /// The value in `unit`.
    pub value: Option<ParameterContent>,
    /// The value as it is shown to a person, without its unit.
    pub text: Option<String>,
    /// Unit of the value, empty for none.
    pub unit: String,
    /// What the value says: the choice of a list, the bits of a word.
    pub meaning: Option<String>,
    /// The bits, where the parameter is a word of bits.
    pub word: Option<Word>,
    /// `>` or `<` where a measured value may be higher or lower: its signal has no number beyond.
    pub beyond: Option<String>,
    /// The whole number that was received.
    pub raw: Option<Number>,
    /// The octets that were received.
    pub hex: Option<String>,
    /// Format code of the value (PROFIdrive data types).
    pub format: Option<u8>,
    /// Whether the parameter can be written, where that is known.
    pub writable: Option<bool>,
    /// Why there is no value.
    pub error: Option<ParameterError>,
}

/// Why a parameter was not read or written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterError {
    /// Error number that was received.
    pub number: Option<u16>,
    /// What it means.
    pub meaning: String,
    /// Further information that was received with it.
    pub information: Option<u16>,
    /// What to do.
    pub remedy: Option<String>,
    /// Channel that the parameter was requested on: `records`, `fc` or `uss`.
    pub channel: &'static str,
    /// False where the channel cannot carry the parameter and nothing was sent.
    pub sent: bool,
}

impl From<&Reading> for Parameter {
    fn from(reading: &Reading) -> Self {
        let content = match &reading.content {
            Content::Number { engineering, .. } => ParameterContent::Number(*engineering),
            Content::Float(value) => ParameterContent::Number(*value),
            Content::Text(text) => ParameterContent::Text(text.clone()),
            Content::Octets => ParameterContent::Text(hex_bytes(&reading.octets)),
        };
        let raw = match reading.content {
            Content::Number { raw, .. } => Number::from_i128(raw),
            _ => None,
        };
        Self {
            pnu: reading.pnu,
            index: reading.index,
            number: reading.shown().to_string(),
            name: reading.name.map(str::to_owned),
            value: Some(content),
            text: Some(value::value(reading)),
            unit: reading.unit.to_owned(),
            meaning: Some(value::meaning(reading)).filter(|meaning| !meaning.is_empty()),
            word: reading.word.as_ref().map(|bits| Word {
                number: reading
                    .octets
                    .iter()
                    .fold(0, |number, &octet| number << 8 | u64::from(octet)),
                hex: words::hex(&reading.octets),
                bits: bits.clone(),
                meaning: None,
            }),
            beyond: reading.beyond().map(|end| end.sign().to_owned()),
            raw,
            hex: Some(hex_bytes(&reading.octets)),
            format: Some(reading.format),
            writable: reading.writable,
            error: None,
        }
    }
}

impl Parameter {
    /// Returns value and unit, and what the value says: `0x0270 [INHIBIT, CTRL_REQ]`, `1 (velocity)`, `3000 rpm/s`.
    #[must_use]
    pub fn full(&self) -> String {
        let mut text = self.text.clone().unwrap_or_default();
        if !self.unit.is_empty() {
            text = format!("{text} {}", self.unit);
        }
        match (&self.word, &self.meaning) {
            (Some(word), _) => format!("{text} {}", words::bracketed(&word.bits)),
            (None, None) => text,
            (None, Some(meaning)) => format!("{text} ({meaning})"),
        }
    }

    /// Returns the octets as one number where they are one: `0x002DC6C0`.
    #[must_use]
    pub fn octets(&self) -> String {
        let hex = self.hex.as_deref().unwrap_or_default();
        if matches!(self.value, Some(ParameterContent::Text(_))) {
            hex.to_owned()
        } else {
            format!("0x{}", hex.replace(' ', ""))
        }
    }
}

#[cfg(test)]
mod tests {
    use profile::state::Mode;

    use super::*;

    #[test]
    fn a_word_names_its_bits_and_its_stops() {
        let table = bits::stw1(Mode::Velocity);
        let word = Word::of(table, 0x047D, 0x047D, None);
        assert_eq!((word.number, word.hex.as_str()), (0x047D, "0x047D"));
        assert_eq!(word.bits[..2], ["ON", "OFF2: coast stop, pulses off at once"]);
        let converter = Word::of(table, 0x047F, 0x047C, None);
        assert_eq!((converter.number, converter.hex.as_str()), (0x047C, "0x047C"));
        assert!(
            converter.shown().starts_with("0x047C [ON, EN_OP"),
            "{}",
            converter.shown()
        );
    }

    #[test]
    fn a_status_word_has_a_state_under_its_control_word() {
        assert_eq!(DriveState::of(0x0233, Some(0x047F)), Some(DriveState::S3));
        assert_eq!(DriveState::of(0x0233, Some(0x047E)), Some(DriveState::S5));
        assert_eq!(DriveState::of(0, None), None);
    }
}
