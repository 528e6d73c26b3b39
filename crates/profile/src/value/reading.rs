//! A value as it came from the drive, with everything known about it.

use alloc::borrow::ToOwned;
use alloc::string::String;
use alloc::vec::Vec;

use crate::catalogue::{Access, Parameter, WordKind};
use crate::notation::{Notation, Shown};
use crate::parameter::{CodeSpace, Format, Kind};
use crate::state::{Mode, Profile};

use super::check::sign_extend;
use super::{Parameters, Selection};
use crate::model::Model;

/// One value of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Parameter number.
    pub pnu: u16,
    /// Element, where elements are distinguished.
    pub index: Option<u16>,
    /// How its number is written.
    pub notation: Notation,
    /// The vendor's name, where known.
    pub name: Option<&'static str>,
    /// Whether it can be written, where known.
    pub writable: Option<bool>,
    /// Format code as it came.
    pub format: u8,
    /// The octets as they came.
    pub octets: Vec<u8>,
    /// What they mean.
    pub content: Content,
    /// Unit of the number, empty for none.
    pub unit: &'static str,
    /// Digits behind the decimal point that show every step.
    pub decimals: u8,
    /// Text of the value of an enumeration.
    pub choice: Option<&'static str>,
    /// Texts of the bits of a word, see [`Word::describe`](crate::catalogue::Word::describe). `None` for other
    /// parameters.
    pub word: Option<Vec<String>>,
    /// Name of the 64-bit value whose high half this is.
    pub high_half_of: Option<&'static str>,
}

/// Which end of its numbers a measured signal is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beyond {
    /// The value may be higher than what is reported.
    Above,
    /// The value may be lower.
    Below,
}

impl Beyond {
    /// Returns the end that a signal of 16 bits is at.
    #[must_use]
    pub const fn of(raw: i16) -> Option<Self> {
        match raw {
            i16::MAX => Some(Self::Above),
            i16::MIN => Some(Self::Below),
            _ => None,
        }
    }

    /// `>` or `<`.
    #[must_use]
    pub const fn sign(self) -> &'static str {
        match self {
            Self::Above => ">",
            Self::Below => "<",
        }
    }
}

/// Meaning of the octets of a value.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// A whole number and what it is in engineering units.
    Number {
        /// Transmitted number; covers eight octets, signed or unsigned.
        raw: i128,
        /// In the unit of the reading.
        engineering: f64,
    },
    /// A floating point number.
    Float(f64),
    /// Text.
    Text(String),
    /// Anything else.
    Octets,
}

impl Content {
    fn raw(&self) -> Option<i64> {
        match self {
            Self::Number { raw, .. } => i64::try_from(*raw).ok(),
            _ => None,
        }
    }
}

/// How a format code is to be read: short form of PROFIdrive's format table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpretation {
    /// Two's complement.
    Signed,
    /// Without sign.
    Unsigned,
    /// As the parameter's own table gives it, else unsigned (byte, word, double word).
    Plain,
    /// IEEE 754.
    Float,
    /// Characters.
    Text,
    /// Octets.
    Octets,
}

impl Interpretation {
    /// Returns the layout of the octets that a format code stands for.
    #[must_use]
    pub fn of(format: Format, space: CodeSpace) -> Self {
        match format {
            Format::BYTE | Format::WORD | Format::DOUBLE_WORD => Self::Plain,
            _ => match format.info(space).map(|row| row.kind) {
                Some(Kind::Signed) => Self::Signed,
                Some(Kind::Unsigned) => Self::Unsigned,
                Some(Kind::Float) => Self::Float,
                Some(Kind::Text) => Self::Text,
                Some(Kind::Octets | Kind::None) | None => Self::Octets,
            },
        }
    }
}

impl Reading {
    /// Returns the number, in the unit of the reading; `None` for text and octets.
    #[must_use]
    pub const fn number(&self) -> Option<f64> {
        match self.content {
            Content::Number { engineering, .. } => Some(engineering),
            Content::Float(value) => Some(value),
            Content::Text(_) | Content::Octets => None,
        }
    }

    /// Returns the number as it travels; `None` for everything else, and for a 64-bit number without sign from 2^63 on.
    #[must_use]
    pub fn raw(&self) -> Option<i64> {
        self.content.raw()
    }

    /// Returns the end of the numbers of a measured signal: the value is at least, or at most, what is reported. `None`
    /// for a value that is reported as it is.
    ///
    /// NIST_A of an AKD ends at 200 % (N2, N4), though the motor may turn faster.
    #[must_use]
    pub fn beyond(&self) -> Option<Beyond> {
        if self.writable != Some(false) || !matches!(self.unit, "rpm" | "A" | "%") {
            return None;
        }
        match (self.octets.len(), self.raw()?) {
            (2, 0x7FFF) | (4, 0x7FFF_FFFF) => Some(Beyond::Above),
            (2, -0x8000) | (4, -0x8000_0000) => Some(Beyond::Below),
            _ => None,
        }
    }

    /// `p2108`, `r0947[0]`.
    #[must_use]
    pub const fn shown(&self) -> Shown {
        Shown {
            pnu: self.pnu,
            index: self.index,
            writable: self.writable,
            notation: self.notation,
        }
    }
}

impl Parameters {
    /// Returns the meaning of the `octets` of element `offset` of a selection.
    #[must_use]
    pub fn reading(
        &self,
        selection: &Selection,
        offset: u16,
        format: u8,
        interpretation: Interpretation,
        octets: &[u8],
    ) -> Reading {
        let shown = selection.shown(offset);
        // several elements of a number that collects parameters
        let parameter = selection
            .parameter
            .or_else(|| self.at(selection.pnu, shown.index.unwrap_or(0)));
        let content = self.content(parameter, interpretation, octets);
        let raw = content.raw();
        Reading {
            pnu: selection.pnu,
            index: shown.index,
            notation: selection.notation,
            name: parameter.map(|parameter| parameter.name),
            writable: parameter.map(|parameter| parameter.access != Access::ReadOnly),
            format,
            octets: octets.to_vec(),
            content,
            unit: parameter.map_or("", |parameter| parameter.unit_in(&self.scaling)),
            decimals: parameter.map_or(0, Parameter::decimals),
            choice: parameter
                .zip(raw)
                .and_then(|(parameter, raw)| parameter.choice(raw)),
            word: raw.and_then(|_| self.word(selection.pnu, shown.index, octets, None, Mode::default())),
            high_half_of: self
                .catalogue
                .and_then(|tables| tables.by_high(selection.pnu))
                .map(|whole| whole.name),
        }
    }

    /// Returns the same reading of a drive with these control words, `None`: not known, and in this mode, which decides
    /// over some bits of STW1 and ZSW1.
    #[must_use]
    pub fn in_words(&self, mut reading: Reading, profile: Option<Profile>, mode: Mode) -> Reading {
        if reading.raw().is_some() {
            reading.word = self.word(reading.pnu, reading.index, &reading.octets, profile, mode);
        }
        reading
    }

    /// Returns true for a control or status word: what its bits are called depends on the drive's telegram and mode.
    #[must_use]
    pub fn is_word_of_state(&self, reading: &Reading) -> bool {
        let parameter = self.at(reading.pnu, reading.index.unwrap_or(0));
        let word = parameter.zip(self.catalogue);
        let word = word.and_then(|(found, tables)| tables.word_at(found.pnu, found.base));
        word.is_some_and(|word| word.kind != WordKind::Own)
    }

    fn word(
        &self,
        pnu: u16,
        index: Option<u16>,
        octets: &[u8],
        profile: Option<Profile>,
        mode: Mode,
    ) -> Option<Vec<String>> {
        let tables = self.catalogue?;
        let base = tables.at(pnu, index.unwrap_or(0))?.base;
        let word = tables.word_at(pnu, base)?;
        let words = Model::by_name(tables.model).map(|model| model.words);
        // a model with one kind of words has these
        let profile = profile.or_else(|| {
            let one = words.map_or(Some(Profile::default()), |words| words.only());
            one.or_else(|| (word.kind == WordKind::Own).then(Profile::default))
        });
        Some(word.describe(whole(octets), profile?, mode))
    }

    fn content(
        &self,
        parameter: Option<&'static Parameter>,
        interpretation: Interpretation,
        octets: &[u8],
    ) -> Content {
        match interpretation {
            Interpretation::Float => match *octets {
                [a, b, c, d] => Content::Float(f64::from(f32::from_be_bytes([a, b, c, d]))),
                [a, b, c, d, e, f, g, h] => Content::Float(f64::from_be_bytes([a, b, c, d, e, f, g, h])),
                _ => Content::Octets,
            },
            Interpretation::Text => {
                let text = String::from_utf8_lossy(octets);
                Content::Text(text.trim_end_matches(['\0', ' ']).to_owned())
            }
            Interpretation::Octets => Content::Octets,
            _ if octets.is_empty() || octets.len() > 8 => Content::Octets,
            Interpretation::Signed | Interpretation::Unsigned | Interpretation::Plain => {
                let unsigned = whole(octets);
                let signed = match interpretation {
                    Interpretation::Plain => parameter.is_some_and(|parameter| parameter.signed),
                    other => other == Interpretation::Signed,
                };
                let bits = 8 * u32::try_from(octets.len()).unwrap_or(8);
                let raw = if signed {
                    sign_extend(unsigned, bits).into()
                } else {
                    i128::from(unsigned)
                };
                let engineering = match (parameter, i64::try_from(raw)) {
                    (Some(parameter), Ok(raw)) => parameter.engineering(raw, &self.scaling),
                    // A scale is a factor: from 2^63 on the half is scaled.
                    (Some(parameter), Err(_)) => {
                        2.0 * parameter.engineering((unsigned >> 1).cast_signed(), &self.scaling)
                    }
                    #[expect(clippy::cast_precision_loss, reason = "`raw` beside it is exact")]
                    (None, _) => raw as f64,
                };
                Content::Number { raw, engineering }
            }
        }
    }
}

fn whole(octets: &[u8]) -> u64 {
    octets
        .iter()
        .fold(0, |number, &octet| number << 8 | u64::from(octet))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{AKD, Scaling, VLT};
    use alloc::string::ToString;
    use alloc::vec;

    fn read(text: &str, interpretation: Interpretation, octets: &[u8]) -> Reading {
        let drive = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let selection = drive.select(&text.parse().unwrap()).unwrap();
        drive.reading(&selection, 0, 0x43, interpretation, octets)
    }

    #[test]
    fn numbers_by_table() {
        let reading = read("DRV.ACC", Interpretation::Plain, &[0x00, 0x2D, 0xC6, 0xC0]);
        assert_eq!(
            reading.content,
            Content::Number {
                raw: 3_000_000,
                engineering: 3000.0
            }
        );
        assert_eq!(
            (reading.unit, reading.shown().to_string().as_str()),
            ("rpm/s", "p2108")
        );
        let reading = read("VL.FB_32", Interpretation::Plain, &[0xFF, 0xFF, 0xFF, 0xFF]);
        assert_eq!(reading.number(), Some(-0.001));
        let reading = read("DRV.OPMODE", Interpretation::Plain, &[1]);
        assert!(
            reading
                .choice
                .is_some_and(|text| text.to_lowercase().contains("velocity")),
            "{reading:?}"
        );
    }

    #[test]
    fn words_by_their_bits() {
        let word_of = |text, octets: &[u8]| read(text, Interpretation::Plain, octets).word;
        assert_eq!(
            word_of("ZSW1", &[0x02, 0x71]),
            Some(vec!["READY_ON".into(), "INHIBIT".into(), "CTRL_REQ".into()])
        );
        assert_eq!(word_of("DRV.MOTIONSTAT", &[0, 0, 0, 0]), Some(vec![]));
        assert_eq!(word_of("DRV.ACC", &[0, 0, 0, 1]), None);
        let drive = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let reading = read("STW1", Interpretation::Plain, &[0x04, 0x5F]);
        let reading = drive.in_words(reading, None, Mode::Position);
        let names = reading.word.as_ref().unwrap();
        assert!(names.contains(&"NO_REJECT".into()), "{reading:?}");
        assert!(!names.contains(&"NO_INT_STOP".into()), "{reading:?}");
        // whose words a VLT has its telegram and 8-10 say
        let vlt = Parameters {
            catalogue: Some(&VLT),
            scaling: VLT.scaling,
        };
        let selection = vlt.select(&"16-03".parse().unwrap()).unwrap();
        let reading = vlt.reading(&selection, 0, 0x23, Interpretation::Unsigned, &[0x0F, 0x07]);
        assert!(reading.word.is_none() && vlt.is_word_of_state(&reading));
        for (profile, first) in [
            (Profile::DanfossFc, "CTRL_READY"),
            (Profile::DanfossProfidrive, "CTRL_READY"),
        ] {
            let word = vlt
                .in_words(reading.clone(), Some(profile), Mode::Velocity)
                .word
                .unwrap();
            assert_eq!(word[0], first);
            assert!(word.contains(&"RUNNING".to_owned()), "{word:?}");
            let stopped = word.iter().any(|text| text.starts_with("OFF 2"));
            assert_eq!(stopped, profile == Profile::DanfossProfidrive, "{word:?}");
        }
        let upper = read("2109", Interpretation::Plain, &[0, 0, 0, 1]);
        assert_eq!((upper.name, upper.high_half_of), (None, Some("DRV.ACC")));
        let error = read("PL.ERR", Interpretation::Plain, &[0xFF, 0xFF, 0xFF, 0xFE]);
        assert_eq!(error.number(), Some(-2.0));
    }

    #[test]
    fn positions_and_voltages_have_a_sign() {
        let command = read("PL.CMD", Interpretation::Plain, &(-3_i64 << 16).to_be_bytes());
        assert_eq!(
            (command.raw(), command.number()),
            (Some(-196_608), Some(-196_608.0))
        );
        for input in ["AIN.VALUE", "AIN2.VALUE"] {
            let reading = read(input, Interpretation::Plain, &(-12_500_i16).to_be_bytes());
            assert_eq!((reading.number(), reading.unit), (Some(-12.5), "V"), "{input}");
        }
    }

    #[test]
    fn a_number_from_2_to_the_63rd_on_is_read_as_it_is() {
        let of = |text, octets: u64| read(text, Interpretation::Unsigned, &octets.to_be_bytes());
        let unknown = of("9999", u64::MAX - 3);
        let Content::Number { raw, engineering } = unknown.content else {
            panic!("{unknown:?}");
        };
        assert_eq!(raw, i128::from(u64::MAX) - 3);
        assert!((engineering / 2.0_f64.powi(64) - 1.0).abs() < 1e-12);
        assert_eq!(unknown.raw(), None);
        // in thousandths
        let scaled = of("DRV.ACC", 1 << 63).number().unwrap();
        assert!(
            (scaled * 1000.0 / 2.0_f64.powi(63) - 1.0).abs() < 1e-12,
            "{scaled}"
        );
    }

    #[test]
    fn numbers_by_format() {
        let reading = read("9999", Interpretation::Signed, &[0xFF, 0xFE]);
        assert_eq!((reading.raw(), reading.name), (Some(-2), None));
        let reading = read("9999", Interpretation::Float, &1.5_f32.to_be_bytes());
        assert_eq!(reading.number(), Some(1.5));
        let reading = read("9999", Interpretation::Text, b"akd-1  ");
        assert_eq!(reading.content, Content::Text("akd-1".into()));
        assert_eq!(
            read("9999", Interpretation::Plain, &[0; 9]).content,
            Content::Octets
        );
    }
}
