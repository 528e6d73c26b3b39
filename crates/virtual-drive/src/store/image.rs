//! The saved state as text that a person can read and a program can trust:
//!
//! ```text
//! profidrive state 1
//! model AKD
//! DRV.ACC = 3000.000 # rpm/s
//! PN.VELSCALING = 1638
//! checksum 5b1c2d3e
//! ```
//!
//! Values that travel in thousandths are written as decimals in their unit, all others as the number on the wire. The
//! last line is the CRC-32 of everything before it. Text behind `#` and empty lines say nothing.

use core::fmt::Write as _;

use profidrive::catalogue::{Parameter, Scale, Scaling};

/// Version of the format, the number in the first line.
pub const FORMAT: u32 = 1;

/// Longest text that is looked at: far more than any model needs.
const LONGEST: usize = 1 << 20;

/// Saved values by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    model: String,
    entries: Vec<(String, String, String)>,
}

/// Why a saved state is not taken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ImageError {
    /// Not text, or far too long.
    #[error("the saved state is not a text of this program")]
    NotText,
    /// The first line names another version.
    #[error("the saved state has format {found:?}, this program reads format {FORMAT}")]
    Version {
        /// The first line.
        found: String,
    },
    /// The checksum is missing or does not fit: the text is cut or changed.
    #[error("the saved state is damaged: checksum {found:?}, computed {computed:08x}")]
    Checksum {
        /// The last line.
        found: String,
        /// The checksum of the lines before it.
        computed: u32,
    },
    /// A line is neither empty nor `NAME = value`.
    #[error("line {line} of the saved state is no assignment: {text:?}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// The line.
        text: String,
    },
    /// The state belongs to another model.
    #[error("the saved state is of a {found}, not of a {expected}")]
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
            entries: Vec::new(),
        }
    }

    /// Name of the model.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// Name and text of each value.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries
            .iter()
            .map(|(name, text, _)| (name.as_str(), text.as_str()))
    }

    /// Adds the number of a parameter.
    pub fn push(&mut self, parameter: &Parameter, raw: i64) {
        let (text, comment) = print(parameter, raw);
        self.entries.push((parameter.name.to_owned(), text, comment));
    }

    /// Adds a value as text.
    pub fn push_text(&mut self, name: &str, text: &str) {
        self.entries
            .push((name.to_owned(), text.to_owned(), String::new()));
    }

    /// The text, checksum included.
    #[must_use]
    pub fn encode(&self) -> String {
        let mut text = format!("profidrive state {FORMAT}\nmodel {}\n", self.model);
        for (name, value, comment) in &self.entries {
            let mark = if comment.is_empty() { "" } else { " # " };
            // Writing into a String does not fail.
            let _ = writeln!(text, "{name} = {value}{mark}{comment}");
        }
        let checksum = crc32(text.as_bytes());
        let _ = writeln!(text, "checksum {checksum:08x}");
        text
    }

    /// Reads a text back; comments are not kept.
    ///
    /// # Errors
    /// When it is of another version, damaged, or holds a line that is no assignment.
    pub fn decode(bytes: &[u8]) -> Result<Self, ImageError> {
        if bytes.len() > LONGEST {
            return Err(ImageError::NotText);
        }
        let text = core::str::from_utf8(bytes).map_err(|_| ImageError::NotText)?;
        let first = text.lines().next().unwrap_or_default();
        if first != format!("profidrive state {FORMAT}") {
            return Err(ImageError::Version {
                found: first.chars().take(80).collect(),
            });
        }
        let body_end = text
            .strip_suffix('\n')
            .and_then(|text| text.rfind('\n'))
            .map_or(0, |end| end + 1);
        let (body, last) = text.split_at(body_end);
        let computed = crc32(body.as_bytes());
        if last != format!("checksum {computed:08x}\n") {
            return Err(ImageError::Checksum {
                found: last.trim_end().chars().take(80).collect(),
                computed,
            });
        }
        let mut image = Self::new("");
        for (number, line) in body.lines().enumerate().skip(1) {
            let content = line.split_once('#').map_or(line, |(content, _)| content).trim();
            if content.is_empty() {
                continue;
            }
            if let Some(model) = content.strip_prefix("model ") {
                model.trim().clone_into(&mut image.model);
                continue;
            }
            let Some((name, value)) = content.split_once('=') else {
                return Err(ImageError::Line {
                    line: number + 1,
                    text: line.chars().take(80).collect(),
                });
            };
            image.push_text(name.trim(), value.trim());
        }
        Ok(image)
    }
}

/// Value and comment of a parameter.
fn print(parameter: &Parameter, raw: i64) -> (String, String) {
    match parameter.scale {
        Scale::Raw => (
            raw.to_string(),
            parameter
                .choice(raw)
                .map_or_else(|| parameter.unit.to_owned(), str::to_owned),
        ),
        Scale::Milli => {
            let sign = if raw < 0 { "-" } else { "" };
            let whole = raw.unsigned_abs();
            (
                format!("{sign}{}.{:03}", whole / 1000, whole % 1000),
                parameter.unit.to_owned(),
            )
        }
        _ => {
            let value = parameter.engineering(raw, &Scaling::default());
            (
                raw.to_string(),
                format!(
                    "steps, {value:.3} {} with the scaling as delivered",
                    parameter.unit
                ),
            )
        }
    }
}

/// The number for a text; `None` when it is no number of this parameter or outside its size.
pub(super) fn parse(parameter: &Parameter, text: &str) -> Option<i64> {
    let raw = match parameter.scale {
        Scale::Milli => {
            let (sign, digits) = text.strip_prefix('-').map_or((1, text), |digits| (-1, digits));
            let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
            if part.len() > 3
                || !part
                    .bytes()
                    .chain(whole.bytes())
                    .all(|byte| byte.is_ascii_digit())
            {
                return None;
            }
            let part: i64 = format!("{part:0<3}").parse().ok()?;
            sign * whole.parse::<i64>().ok()?.checked_mul(1000)?.checked_add(part)?
        }
        _ => text.parse().ok()?,
    };
    parameter.range().contains(&raw).then_some(raw)
}

/// CRC-32 as in Ethernet and ZIP (reflected, 0xEDB88320).
#[must_use]
pub fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                (crc >> 1) ^ 0xEDB8_8320
            } else {
                crc >> 1
            };
        }
    }
    !crc
}

#[cfg(test)]
mod tests {
    use super::super::Values;
    use super::*;
    use profidrive::catalogue::AKD;
    use proptest::prelude::*;

    #[test]
    fn known_checksum() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn the_text_is_readable() {
        let text = Values::new(&AKD).image().encode();
        assert!(text.starts_with("profidrive state 1\nmodel AKD\n"));
        assert!(text.contains("\nDRV.ACC = 3000.000 # rpm/s\n"), "{text}");
        assert!(text.contains("\nDRV.OPMODE = 1 # Velocity\n"));
        assert!(
            text.contains("\nJog v1 = 164 # steps, 60.044 rpm with the scaling as delivered\n"),
            "{text}"
        );
    }

    #[test]
    fn decimals() {
        let acc = AKD.by_pnu(2108).unwrap();
        let offset = AKD.by_pnu(2003).unwrap();
        for (text, raw) in [("3000.000", 3_000_000), ("0.5", 500), ("7", 7000), ("0.001", 1)] {
            assert_eq!(parse(acc, text), Some(raw), "{text}");
        }
        assert_eq!(parse(offset, "-0.5"), Some(-500));
        assert_eq!(parse(offset, "-10"), Some(-10_000));
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
            assert_eq!(parse(acc, text), None, "{text}");
        }
    }

    #[test]
    fn damage_is_told() {
        let text = Values::new(&AKD).image().encode();
        assert!(matches!(Image::decode(b"\xFF"), Err(ImageError::NotText)));
        assert!(matches!(Image::decode(b""), Err(ImageError::Version { .. })));
        assert!(matches!(
            Image::decode(b"profidrive state 2\n"),
            Err(ImageError::Version { .. })
        ));
        assert!(matches!(
            Image::decode(b"profidrive state 1\n"),
            Err(ImageError::Checksum { .. })
        ));
        let other = text.replace("3000.000", "3000.001");
        assert!(matches!(
            Image::decode(other.as_bytes()),
            Err(ImageError::Checksum { .. })
        ));
        let body = "profidrive state 1\nnonsense\n";
        let damaged = format!("{body}checksum {:08x}\n", crc32(body.as_bytes()));
        assert!(matches!(
            Image::decode(damaged.as_bytes()),
            Err(ImageError::Line { line: 2, .. })
        ));
    }

    #[test]
    fn every_cut_is_noticed() {
        let text = Values::new(&AKD).image().encode();
        for end in 0..text.len() {
            assert!(Image::decode(&text.as_bytes()[..end]).is_err(), "cut at {end}");
        }
    }

    proptest! {
        #[test]
        fn every_value_survives_the_text(pick in 0..800_usize, raw in any::<i64>()) {
            let parameter = &AKD.parameters[pick];
            let range = parameter.size.range(parameter.signed);
            let raw = range.start() + raw.rem_euclid(range.end() - range.start() + 1);
            let (text, _) = print(parameter, raw);
            prop_assert_eq!(parse(parameter, &text), Some(raw));
        }

        #[test]
        fn whole_states_survive_the_text(seed in any::<u64>()) {
            let mut values = Values::new(&AKD);
            let mut state = seed | 1;
            for position in 0..AKD.parameters.len() {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                values.set_at(position, (state >> 20) as i64 - (1 << 43));
            }
            let image = values.image();
            let decoded = Image::decode(image.encode().as_bytes()).unwrap();
            let mut other = Values::new(&AKD);
            prop_assert_eq!(other.restore(&decoded).unwrap(), 0);
            prop_assert_eq!(other.image(), image);
        }

        #[test]
        fn flipped_bits_are_noticed(at in 0..8000_usize, bit in 0..8_u32) {
            let mut text = Values::new(&AKD).image().encode().into_bytes();
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
