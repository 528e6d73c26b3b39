//! Values of attributes: lists of numbers and schema versions.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use core::str::FromStr;

/// Most ranges of one list.
const MOST_RANGES: usize = 4096;

/// A list of numbers as `0..4 7`: blanks between numbers and ranges.
///
/// Ranges are kept as they are, so that `0..65535` costs no more than `0`.
///
/// ```
/// use profidrive_gsdml::ValueList;
/// let slots: ValueList = "0..4 7".parse().unwrap();
/// assert!(slots.contains(3) && slots.contains(7) && !slots.contains(5));
/// assert_eq!(slots.iter().collect::<Vec<_>>(), [0, 1, 2, 3, 4, 7]);
/// assert_eq!(slots.to_string(), "0..4 7");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ValueList {
    ranges: Vec<(u32, u32)>,
}

impl ValueList {
    /// Without any number.
    pub const EMPTY: Self = Self { ranges: Vec::new() };

    /// With one number.
    #[must_use]
    pub fn one(number: u32) -> Self {
        [number].into_iter().collect()
    }

    /// Returns whether a number is in it.
    #[must_use]
    pub fn contains(&self, number: u32) -> bool {
        self.ranges
            .iter()
            .any(|(first, last)| (*first..=*last).contains(&number))
    }

    /// Returns whether it has no number.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// Returns all numbers in the order they are written. The file determines their count: take only as many as are
    /// needed.
    pub fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        self.ranges.iter().flat_map(|(first, last)| *first..=*last)
    }

    /// Returns the ranges in the order they are written, first and last number of each.
    #[must_use]
    pub fn ranges(&self) -> &[(u32, u32)] {
        &self.ranges
    }

    /// Returns the first number.
    #[must_use]
    pub fn first(&self) -> Option<u32> {
        self.ranges.first().map(|(first, _)| *first)
    }

    /// Returns the largest number.
    #[must_use]
    pub fn max(&self) -> Option<u32> {
        self.ranges.iter().map(|(_, last)| *last).max()
    }
}

impl FromIterator<u32> for ValueList {
    /// Numbers that follow each other become ranges of three and more.
    fn from_iter<I: IntoIterator<Item = u32>>(numbers: I) -> Self {
        let mut ranges: Vec<(u32, u32)> = Vec::new();
        for number in numbers {
            match ranges.last_mut() {
                Some((_, last)) if last.checked_add(1) == Some(number) => *last = number,
                _ => ranges.push((number, number)),
            }
        }
        let pair = |(first, last): (u32, u32)| {
            let two = first.checked_add(1) == Some(last);
            let second = two.then_some((last, last));
            [Some((first, if two { first } else { last })), second]
        };
        Self {
            ranges: ranges.into_iter().flat_map(pair).flatten().collect(),
        }
    }
}

impl fmt::Display for ValueList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, (first, last)) in self.ranges.iter().enumerate() {
            let blank = if at > 0 { " " } else { "" };
            if first == last {
                write!(f, "{blank}{first}")?;
            } else {
                write!(f, "{blank}{first}..{last}")?;
            }
        }
        Ok(())
    }
}

/// A text that is not a list of numbers.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a list of numbers such as `0..4 7`")]
pub struct NoList(String);

impl FromStr for ValueList {
    type Err = NoList;

    fn from_str(text: &str) -> Result<Self, NoList> {
        let wrong = || NoList(shortened(text));
        let mut ranges = Vec::new();
        for part in text.split_ascii_whitespace() {
            let (first, last) = match part.split_once("..") {
                Some((first, last)) => (number(first), number(last)),
                None => (number(part), number(part)),
            };
            match (first, last) {
                (Some(first), Some(last)) if first <= last && ranges.len() < MOST_RANGES => {
                    ranges.push((first, last));
                }
                _ => return Err(wrong()),
            }
        }
        Ok(Self { ranges })
    }
}

/// Returns a number: hexadecimal with `0x`, else decimal.
pub(crate) fn number(text: &str) -> Option<u32> {
    let digits = |text: &str, radix| {
        text.bytes()
            .all(|c| c.is_ascii_alphanumeric())
            .then(|| u32::from_str_radix(text, radix).ok())?
    };
    match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(hex) => digits(hex, 16),
        None => digits(text, 10),
    }
}

/// Foreign text for a message: not longer than a line.
pub(crate) fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    let mut short: String = text.chars().take(MOST).collect();
    if text.chars().nth(MOST).is_some() {
        short.push_str("..");
    }
    short
}

/// Version of the schema, ordered as published: 2.2 < 2.25 < 2.3 < 2.31 < 2.4.
///
/// ```
/// use profidrive_gsdml::SchemaVersion;
/// let version: SchemaVersion = "V2.35".parse().unwrap();
/// assert!(version > "V2.3".parse().unwrap() && version < "V2.4".parse().unwrap());
/// assert_eq!(version.to_string(), "V2.35");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SchemaVersion {
    major: u8,
    /// Fraction in hundredths; `short` distinguishes 2.3 from 2.30.
    hundredths: u8,
    short: bool,
}

impl SchemaVersion {
    /// The version this crate writes.
    pub const WRITTEN: Self = Self {
        major: 2,
        hundredths: 35,
        short: false,
    };
    /// From here on several features are mandatory.
    pub const V2_31: Self = Self {
        major: 2,
        hundredths: 31,
        short: false,
    };

    /// Returns the number before the point.
    #[must_use]
    pub const fn major(self) -> u8 {
        self.major
    }

    /// Not older than another version, whatever way that is written.
    #[must_use]
    pub const fn at_least(self, other: Self) -> bool {
        self.major > other.major || (self.major == other.major && self.hundredths >= other.hundredths)
    }
}

impl fmt::Display for SchemaVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.short {
            write!(f, "V{}.{}", self.major, self.hundredths / 10)
        } else {
            write!(f, "V{}.{:02}", self.major, self.hundredths)
        }
    }
}

/// A text that is not a version.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a version such as V2.35")]
pub struct NoVersion(String);

impl FromStr for SchemaVersion {
    type Err = NoVersion;

    fn from_str(text: &str) -> Result<Self, NoVersion> {
        let parsed = || {
            let digits = text.strip_prefix('V').or_else(|| text.strip_prefix('v'))?;
            let (major, minor) = digits.split_once('.')?;
            let plain = |text: &str| !text.is_empty() && text.bytes().all(|c| c.is_ascii_digit());
            if !plain(major) || !plain(minor) || minor.len() > 2 {
                return None;
            }
            let short = minor.len() == 1;
            let minor: u8 = minor.parse().ok()?;
            Some(Self {
                major: major.parse().ok()?,
                hundredths: if short { minor * 10 } else { minor },
                short,
            })
        };
        parsed().ok_or_else(|| NoVersion(shortened(text)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;
    use proptest::prelude::*;

    #[test]
    fn lists_that_are_none() {
        for text in [
            "1..",
            "..",
            "4..1",
            "-1",
            "1,2",
            "+1",
            "4294967296",
            "0x",
            "1...2",
            "a",
        ] {
            assert!(text.parse::<ValueList>().is_err(), "{text}");
        }
        assert!("".parse::<ValueList>().unwrap().is_empty());
        assert_eq!(
            "0..4294967295".parse::<ValueList>().unwrap().max(),
            Some(u32::MAX)
        );
        assert!("1 ".repeat(5000).parse::<ValueList>().is_err());
    }

    #[test]
    fn versions() {
        let version = |text: &str| text.parse::<SchemaVersion>();
        for text in [
            "2.3", "V2", "V2.", "V.3", "V2.345", "V-2.3", "V2.+3", "V999.1", "",
        ] {
            assert!(version(text).is_err(), "{text}");
        }
        let ordered = [
            "V1.0", "V2.0", "V2.1", "V2.2", "V2.25", "V2.3", "V2.31", "V2.35", "V2.4", "V2.41",
        ];
        assert!(
            ordered
                .windows(2)
                .all(|pair| version(pair[0]).unwrap() < version(pair[1]).unwrap())
        );
        assert!(version("V2.30").unwrap().at_least(version("V2.3").unwrap()));
        assert!(version("V2.3").unwrap().at_least(version("V2.30").unwrap()));
        assert!(!version("V2.3").unwrap().at_least(SchemaVersion::V2_31));
        for text in ordered {
            assert_eq!(version(text).unwrap().to_string(), text);
        }
    }

    proptest! {
        #[test]
        fn lists_come_back(numbers in prop::collection::vec(0_u32..100_000, 0..40)) {
            let list: ValueList = numbers.iter().copied().collect();
            prop_assert_eq!(list.iter().collect::<Vec<_>>(), numbers.clone());
            prop_assert_eq!(&list.to_string().parse::<ValueList>().unwrap(), &list);
            prop_assert!(numbers.iter().all(|number| list.contains(*number)));
        }
    }
}
