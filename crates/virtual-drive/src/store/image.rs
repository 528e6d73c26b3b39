//! The saved state as readable text with a checksum:
//!
//! ```text
//! profidrive state 2
//! model AKD
//! DRV.ACC = 3000.000 # rpm/s
//! Jog v1 = 60.04 # rpm
//! PN.VELSCALING = 1638
//! checksum 5b1c2d3e
//! ```
//!
//! One parameter a line, in the order of its numbers, in its unit; a number without an exact decimal in its unit stands
//! there as `raw 123`. The last line is the CRC-32 of everything before it. Text behind `#` and empty lines are
//! ignored. A text of version 1 is read too: there only values in thousandths are in their unit, all others are raw.

use profile::catalogue::{Parameter, Scale, Scaling};
use profile::notation::setting::{Entry, Form, Problem, shorten};

/// The text of a saved state. Version 1 is read too, and written for a state that was read from it.
const FORM: Form = Form {
    kind: "state",
    oldest: FORMER,
    version: 2,
    sealed: true,
    comment_column: 0,
    comment_gap: 1,
};

/// Version in which values of scaled parameters are raw.
const FORMER: u32 = 1;

/// Saved values by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    model: String,
    version: u32,
    entries: Vec<(String, String, String)>,
}

/// Why a saved state is not taken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ImageError {
    /// It is not the text of a saved state, or it is damaged.
    #[error("the saved state is not readable: {0}")]
    Text(#[from] Problem),
    /// The state belongs to another model.
    #[error("the saved state is of model {found}, not of model {expected}")]
    Model {
        /// Model in the text.
        found: String,
        /// Model of this drive.
        expected: &'static str,
    },
}

impl Image {
    /// Without values.
    #[must_use]
    pub fn new(model: &str) -> Self {
        Self {
            model: model.to_owned(),
            version: FORM.version,
            entries: Vec::new(),
        }
    }

    /// Returns the name of the model.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// Returns the name and text of each value.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries
            .iter()
            .map(|(name, text, _)| (name.as_str(), text.as_str()))
    }

    /// Adds the number of a parameter, in its unit.
    pub fn push(&mut self, parameter: &Parameter, raw: i64, scaling: &Scaling) {
        self.push_as(parameter.name, parameter, raw, scaling);
    }

    /// Adds the number of a parameter, in its unit, under another name than its own.
    pub fn push_as(&mut self, name: &str, parameter: &Parameter, raw: i64, scaling: &Scaling) {
        let (text, comment) = print(parameter, raw, scaling);
        self.entries.push((name.to_owned(), text, comment));
    }

    /// Puts the number of a parameter in the place of the one that stands there, or behind all others; true when that
    /// changed anything.
    pub fn set(&mut self, parameter: &Parameter, raw: i64, scaling: &Scaling) -> bool {
        self.set_as(parameter.name, parameter, raw, scaling)
    }

    /// As [`set`](Self::set), under another name than its own.
    pub fn set_as(&mut self, name: &str, parameter: &Parameter, raw: i64, scaling: &Scaling) -> bool {
        let (text, comment) = print(parameter, raw, scaling);
        match self.entries.iter_mut().find(|(known, ..)| known == name) {
            Some((_, present, _)) if *present == text => false,
            Some((_, present, remark)) => {
                (*present, *remark) = (text, comment);
                true
            }
            None => {
                self.entries.push((name.to_owned(), text, comment));
                true
            }
        }
    }

    /// Returns the number that a text of this image is for a parameter; `None` when it is none, or outside its size.
    #[must_use]
    pub fn number(&self, parameter: &Parameter, text: &str, scaling: &Scaling) -> Option<i64> {
        let scaled = !matches!(parameter.scale, Scale::Raw | Scale::Milli);
        if self.version == FORMER && scaled {
            text.parse().ok().filter(|raw| parameter.range().contains(raw))
        } else {
            parse(parameter, text, scaling)
        }
    }

    /// Adds a value as text.
    pub fn push_text(&mut self, name: &str, text: &str) {
        self.entries
            .push((name.to_owned(), text.to_owned(), String::new()));
    }

    /// Puts a value as text in the place of the one that stands there, or behind all others.
    pub fn set_text(&mut self, name: &str, text: &str) {
        match self.entries.iter_mut().find(|(known, ..)| known == name) {
            Some((_, present, _)) => text.clone_into(present),
            None => self.push_text(name, text),
        }
    }

    /// Returns the text, checksum included.
    #[must_use]
    pub fn encode(&self) -> String {
        let mut text = FORM.begin(self.version);
        text.words(&format!("model {}", self.model));
        for (name, value, comment) in &self.entries {
            text.setting(name, value, comment);
        }
        text.finish()
    }

    /// Reads a text back; comments are not kept.
    ///
    /// # Errors
    /// When it is of another version, damaged, or holds a line that is not an assignment.
    pub fn decode(bytes: &[u8]) -> Result<Self, ImageError> {
        let settings = FORM.read(bytes)?;
        let mut image = Self {
            version: settings.version,
            ..Self::new("")
        };
        for line in settings.lines {
            let other = match line.entry {
                Entry::Setting { name, value } => {
                    image.push_text(&name, &value);
                    continue;
                }
                Entry::Words(words) => words,
                Entry::Head { key, .. } => format!("{key}:"),
            };
            match other.strip_prefix("model ") {
                Some(model) => model.trim().clone_into(&mut image.model),
                None => {
                    let what = format!("`{}` is not NAME = value", shorten(&other));
                    return Err(Problem::new(line.number, what).into());
                }
            }
        }
        Ok(image)
    }
}

/// Value and comment of a parameter.
fn print(parameter: &Parameter, raw: i64, scaling: &Scaling) -> (String, String) {
    let unit = || parameter.unit.to_owned();
    let text = match parameter.scale {
        Scale::Raw => {
            return (
                raw.to_string(),
                parameter.choice(raw).map_or_else(unit, str::to_owned),
            );
        }
        Scale::Milli => {
            let sign = if raw < 0 { "-" } else { "" };
            let whole = raw.unsigned_abs();
            format!("{sign}{}.{:03}", whole / 1000, whole % 1000)
        }
        // The fewest decimals that identify the number.
        _ => {
            let value = parameter.engineering(raw, scaling);
            let says = |text: &String| parse(parameter, text, scaling) == Some(raw);
            let texts = (0..=9).map(|decimals| format!("{value:.decimals$}"));
            texts.into_iter().find(says).unwrap_or_default()
        }
    };
    if parse(parameter, &text, scaling) == Some(raw) {
        (text, unit())
    } else {
        (format!("{RAW}{raw}"), unit())
    }
}

/// Stands before a number on the wire without an exact decimal in its unit.
const RAW: &str = "raw ";

/// Returns the number for a text; `None` when it is not a number of this parameter or outside its size.
fn parse(parameter: &Parameter, text: &str, scaling: &Scaling) -> Option<i64> {
    let raw = match (text.strip_prefix(RAW), parameter.scale) {
        (Some(raw), _) => raw.parse().ok()?,
        (None, Scale::Raw) => text.parse().ok()?,
        (None, Scale::Milli) => thousandths(text)?,
        (None, _) => {
            let value: f64 = text.parse().ok()?;
            let raw = parameter.raw(value, scaling);
            // Not a number, or cut to what fits: not this value.
            let step = parameter.engineering(1, scaling).abs();
            let near = (parameter.engineering(raw, scaling) - value).abs() <= step;
            near.then_some(raw)?
        }
    };
    parameter.range().contains(&raw).then_some(raw)
}

fn thousandths(text: &str) -> Option<i64> {
    let (sign, digits) = text.strip_prefix('-').map_or((1, text), |digits| (-1, digits));
    let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if part.len() > 3 || !is_digits(part) || !is_digits(whole) {
        return None;
    }
    let part: i64 = format!("{part:0<3}").parse().ok()?;
    let raw = i128::from(whole.parse::<i64>().ok()?) * 1000 + i128::from(part);
    i64::try_from(sign * raw).ok()
}

#[cfg(test)]
mod tests {
    use super::super::Values;
    use super::*;
    use profile::catalogue::{AKD, Catalogue, VACON, VLT};
    use profile::notation::setting::crc32;
    use proptest::prelude::*;

    #[test]
    fn the_text_is_readable() {
        let text = Values::new(&AKD).image(&Scaling::default()).encode();
        assert!(text.starts_with("profidrive state 2\nmodel AKD\n"));
        assert!(text.contains("\nDRV.ACC = 3000.000 # rpm/s\n"), "{text}");
        assert!(text.contains("\nDRV.OPMODE = 1 # Velocity\n"));
        assert!(
            text.contains("\nJog v1 = 60 # rpm\n") && text.contains("\nSWLS.LIMIT1 = 68719476736 # counts\n"),
            "{text}"
        );
    }

    #[test]
    fn the_former_version_is_read() {
        let body = "profidrive state 1\nmodel AKD\nDRV.ACC = 3500.000 # rpm/s\nJog v1 = 164\n";
        let text = format!("{body}checksum {:08x}\n", crc32(body.as_bytes()));
        let image = Image::decode(text.as_bytes()).unwrap();
        let mut values = Values::new(&AKD);
        assert_eq!(values.restore(&image, |_| Scaling::default()), Ok(0));
        assert_eq!((values.get(2108), values.get(1004)), (3_500_000, 164));
    }

    #[test]
    fn decimals() {
        let acc = AKD.by_pnu(2108).unwrap();
        let offset = AKD.by_pnu(2003).unwrap();
        for (text, raw) in [("3000.000", 3_000_000), ("0.5", 500), ("7", 7000), ("0.001", 1)] {
            assert_eq!(parse(acc, text, &Scaling::default()), Some(raw), "{text}");
        }
        assert_eq!(parse(offset, "-0.5", &Scaling::default()), Some(-500));
        assert_eq!(parse(offset, "-10", &Scaling::default()), Some(-10_000));
        for text in [
            "",
            "-",
            ".",
            "1.2345",
            "1e3",
            "+1",
            "-1",
            "9999999999999999",
            "99999999999999999999",
        ] {
            assert_eq!(parse(acc, text, &Scaling::default()), None, "{text}");
        }
    }

    #[test]
    fn damage_is_reported_with_its_line() {
        let text = Values::new(&AKD).image(&Scaling::default()).encode();
        let sealed = |body: &str| format!("{body}checksum {:08x}\n", crc32(body.as_bytes()));
        for (text, expected) in [
            ("\u{fffd}".into(), "line 1: not a state"),
            (String::new(), "line 1: not a state"),
            ("profidrive state 3\n".into(), "line 1: a state of form 3"),
            (
                "profidrive state 2\n".into(),
                "line 1: the end of the text is missing",
            ),
            (text.replace("3000.000", "3000.001"), "the text was changed"),
            (
                sealed("profidrive state 2\nnonsense\n"),
                "line 2: `nonsense` is not NAME = value",
            ),
            (
                sealed("profidrive state 2\n\nDRV.ACC: 1\n"),
                "line 3: `DRV.ACC:` is not NAME = value",
            ),
        ] {
            let error = Image::decode(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(expected), "{expected}: {error}");
        }
        let cut = Image::decode(&text.as_bytes()[..text.len() / 2]).unwrap_err();
        assert!(!cut.to_string().contains('='), "no line of the file: {cut}");
    }

    /// The files in `tests/data` were written by the program before the form was shared with other files.
    #[test]
    fn files_of_former_programs_read_back_and_are_written_the_same() {
        let check = |tables: &'static Catalogue, text: &str, others: usize| {
            let image = Image::decode(text.as_bytes()).unwrap();
            let plain = |line: &str| line.split(" # ").next().unwrap().to_owned();
            let (written, former) = (image.encode(), text.lines().map(plain));
            assert!(
                written
                    .lines()
                    .zip(former)
                    .filter(|(one, other)| one != other)
                    .count()
                    <= 1
            );
            let mut values = Values::new(tables);
            assert_eq!(values.restore(&image, |_| tables.scaling), Ok(others));
            if others == 0 {
                assert_eq!(values.image(&tables.scaling).encode(), text);
            }
            values
        };
        let akd = check(&AKD, include_str!("../../tests/data/akd.parameters"), 0);
        assert_eq!(akd.get(2108), 5_000_000);
        let vlt = check(&VLT, include_str!("../../tests/data/vlt.parameters"), 6); // counters
        assert_eq!(vlt.get(341), 500);
        let vacon = check(&VACON, include_str!("../../tests/data/vacon.parameters"), 0);
        assert_eq!(vacon.get(103), 60);
    }

    #[test]
    fn every_cut_is_noticed() {
        let text = Values::new(&AKD).image(&Scaling::default()).encode();
        for end in 0..text.len() {
            assert!(Image::decode(&text.as_bytes()[..end]).is_err(), "cut at {end}");
        }
    }

    proptest! {
        #[test]
        fn every_value_survives_the_text(pick in 0..800_usize, raw in any::<i64>()) {
            let parameter = &AKD.parameters[pick];
            let range = parameter.range();
            let (low, high) = (i128::from(*range.start()), i128::from(*range.end()));
            let raw = i64::try_from(low + i128::from(raw).rem_euclid(high - low + 1)).unwrap();
            let scaling = Scaling {
                velocity: 1 + (raw as u16 & 0x7FF),
                acceleration: 1 + (raw >> 3) as u16 % 14_000,
                position: 1 + (raw >> 5) as u32 % 1_000_000,
                singleturn_bits: 8 + (raw as u16 & 7),
                ..Scaling::default()
            };
            let (text, _) = print(parameter, raw, &scaling);
            prop_assert_eq!(parse(parameter, &text, &scaling), Some(raw));
        }

        #[test]
        fn whole_states_survive_the_text(seed in any::<u64>()) {
            let mut values = Values::new(&AKD);
            let mut state = seed | 1;
            for (position, parameter) in AKD.parameters.iter().enumerate() {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                let (low, high) = parameter.raw_limits(&Scaling::default().kept());
                values.set_at(position, ((state >> 20) as i64 - (1 << 43)).clamp(low, high));
            }
            let image = values.image(&Scaling::default());
            let decoded = Image::decode(image.encode().as_bytes()).unwrap();
            let mut other = Values::new(&AKD);
            prop_assert_eq!(other.restore(&decoded, |_| Scaling::default()).unwrap(), 0);
            prop_assert_eq!(other.image(&Scaling::default()), image);
        }

        #[test]
        fn flipped_bits_are_noticed(at in 0..8000_usize, bit in 0..8_u32) {
            let mut text = Values::new(&AKD).image(&Scaling::default()).encode().into_bytes();
            let at = at % text.len();
            text[at] ^= 1_u8 << bit;
            prop_assert!(Image::decode(&text).is_err());
        }

        #[test]
        fn garbage_is_harmless(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            let _ = Image::decode(&bytes);
        }
    }
}
