//! A parameter as written by a person.

use alloc::string::{String, ToString};
use core::fmt;
use core::str::FromStr;

/// Which parameter, and which of its elements, as a person wrote it.
///
/// A name is not looked up here: the catalogue of the drive does that, so that the same text can mean the parameter of
/// another vendor.
///
/// ```
/// use profidrive_profile::notation::{ParameterReference, Target};
/// let fault: ParameterReference = "r947[0..7]".parse()?;
/// assert_eq!(fault.target, Target::Number(947));
/// let elements = fault.elements.unwrap_or_default();
/// assert_eq!((elements.first, elements.count), (0, 8));
/// assert_eq!(fault.to_string(), "r0947[0..7]");
/// # Ok::<(), profidrive_profile::notation::ReferenceError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct ParameterReference {
    /// The parameter.
    pub target: Target,
    /// The elements, where the text has them.
    pub elements: Option<Elements>,
    /// The letter in front of the number, where there was one.
    pub prefix: Option<Prefix>,
}

/// A parameter by number or by the vendor's name.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Target {
    /// Parameter number (PNU), 1 to 65535.
    Number(u16),
    /// The vendor's name, as written.
    Name(String),
}

/// A run of array elements; the first element of an array is number 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Elements {
    /// Subindex of the first element.
    pub first: u16,
    /// How many, at least 1.
    pub count: u16,
}

impl Default for Elements {
    fn default() -> Self {
        Self { first: 0, count: 1 }
    }
}

/// `p` (writable) or `r` (read-only) in front of a number. The description from the drive takes precedence over the
/// letter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Prefix {
    /// `p`: can be written.
    Writable,
    /// `r`: read-only.
    ReadOnly,
    /// `PNU`: a parameter number of the profile in any case, also where bare numbers mean something else.
    Number,
}

/// How the vendor of a drive writes the numbers of its parameters.
///
/// ```
/// use profidrive_profile::catalogue::{AKD, VACON, VLT};
/// use profidrive_profile::notation::Notation;
/// assert_eq!((AKD.notation, VLT.notation), (Notation::Name, Notation::GroupIndex));
/// assert_eq!(VACON.notation, Notation::Id { pnu: 10001 });
/// assert_eq!(VLT.notation.example(), "1-20 (also 120 or p120), 15-30[1] for an element");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Notation {
    /// By name, `DRV.ACC`; the number is the PNU.
    #[default]
    Name,
    /// Group and index, `1-20`: PNU 120. Danfoss.
    GroupIndex,
    /// Application id, `ID 103`: element 103 of one PNU. Vacon.
    Id {
        /// The PNU whose elements they are.
        pnu: u16,
    },
}

impl Notation {
    /// Returns the notations of a parameter, for messages.
    #[must_use]
    pub const fn example(self) -> &'static str {
        match self {
            Self::Name => "DRV.ACC, or a number: 930, p930, r947[0]",
            Self::GroupIndex => "1-20 (also 120 or p120), 15-30[1] for an element",
            Self::Id { .. } => "ID 103 (also 103), or a profile number: p930, r947[0]",
        }
    }
}

/// Why a text is not a parameter, with what to write instead.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// Nothing there.
    #[error("no parameter given: write a name (DRV.ACC) or a number (930, p930, r947[0], 1-20, ID 103)")]
    Empty,
    /// PNU 0 or above 65535.
    #[error("`{text}`: parameter numbers run from 1 to 65535")]
    NumberRange {
        /// The text as given.
        text: String,
    },
    /// The bracket is not closed or has something else in it.
    #[error("`{text}`: write one element as 947[0] and several as 947[0..7]")]
    Elements {
        /// The text as given.
        text: String,
    },
    /// An element number above 65535, or a range that runs backwards.
    #[error("`{text}`: elements run from 0 to 65535, the first of a range before the last")]
    ElementRange {
        /// The text as given.
        text: String,
    },
    /// Group and index of a Danfoss parameter that are none.
    #[error("`{text}`: write group and index with a dash, the index with at most two digits: 1-20, 15-30[1]")]
    GroupIndex {
        /// The text as given.
        text: String,
    },
    /// An application id of a Vacon that is none.
    #[error("`{text}`: application ids run from 0 to 65535 and have no elements: write ID 103")]
    Id {
        /// The text as given.
        text: String,
    },
    /// A character that is in no parameter name.
    #[error("`{text}`: `{character}` is in no parameter name")]
    Character {
        /// The text as given.
        text: String,
        /// The first character that does not fit.
        character: char,
    },
}

impl ParameterReference {
    /// Returns the parameter `pnu` without elements.
    #[must_use]
    pub const fn number(pnu: u16) -> Self {
        Self {
            target: Target::Number(pnu),
            elements: None,
            prefix: None,
        }
    }
}

impl FromStr for ParameterReference {
    type Err = ReferenceError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let whole = text.trim();
        if whole.is_empty() {
            return Err(ReferenceError::Empty);
        }
        let (head, bracket) = match whole.rsplit_once('[') {
            None => (whole, None),
            Some((head, rest)) => {
                let form = || ReferenceError::Elements {
                    text: whole.to_string(),
                };
                let inner = rest.strip_suffix(']').ok_or_else(form);
                match inner.and_then(|inner| parse_elements(inner, whole)) {
                    Ok(elements) => (head.trim_end(), Some(elements)),
                    // `Motor Power [kW]`
                    Err(_) if is_title(head) => (whole, None),
                    Err(error) => return Err(error),
                }
            }
        };
        let (target, dotted, prefix) = parse_head(head, whole)?;
        let elements = match (dotted, bracket) {
            (Some(_), Some(_)) if strip_word(head, "ID").is_some() => {
                return Err(ReferenceError::Id {
                    text: whole.to_string(),
                });
            }
            (Some(_), Some(_)) => {
                return Err(ReferenceError::Elements {
                    text: whole.to_string(),
                });
            }
            (dotted, bracket) => dotted.or(bracket),
        };
        Ok(Self {
            target,
            elements,
            prefix,
        })
    }
}

/// Returns true for a name in words, as Danfoss and Vacon have them.
fn is_title(text: &str) -> bool {
    text.contains(' ') && text.starts_with(|first: char| first.is_ascii_alphabetic())
}

/// What stands in such names beside letters, digits and dashes.
const TITLE_CHARACTERS: &str = " ,:/&#%()[]'";

type Head = (Target, Option<Elements>, Option<Prefix>);

fn parse_head(head: &str, whole: &str) -> Result<Head, ReferenceError> {
    if let Some(rest) = strip_word(head, "PNU") {
        let (pnu, elements) = parse_numeric(rest, whole)?;
        return Ok((Target::Number(pnu), elements, Some(Prefix::Number)));
    }
    if let Some(rest) = strip_word(head, "ID") {
        // a Vacon application id is element `id` of the one parameter that carries them all
        const VACON_DRIVE_PARAMETER: u16 = 10001;
        let id = rest.parse().map_err(|_| ReferenceError::Id {
            text: whole.to_string(),
        })?;
        return Ok((
            Target::Number(VACON_DRIVE_PARAMETER),
            Some(Elements { first: id, count: 1 }),
            None,
        ));
    }
    let starts_with_digit = |text: &str| text.bytes().next().is_some_and(|b| b.is_ascii_digit());
    if starts_with_digit(head) {
        let (pnu, elements) = parse_numeric(head, whole)?;
        return Ok((Target::Number(pnu), elements, None));
    }
    let prefix = match head.bytes().next() {
        Some(b'p' | b'P') => Some(Prefix::Writable),
        Some(b'r' | b'R') => Some(Prefix::ReadOnly),
        _ => None,
    };
    if let (Some(_), Some(rest)) = (prefix, head.get(1..))
        && starts_with_digit(rest)
    {
        let (pnu, elements) = parse_numeric(rest, whole)?;
        return Ok((Target::Number(pnu), elements, prefix));
    }
    if head.is_empty() {
        return Err(ReferenceError::Empty);
    }
    let title = is_title(head);
    let in_name = |c: char| {
        c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '-') || (title && TITLE_CHARACTERS.contains(c))
    };
    match head.chars().find(|&c| !in_name(c)) {
        Some(character) => Err(ReferenceError::Character {
            text: whole.to_string(),
            character,
        }),
        None => Ok((Target::Name(head.to_string()), None, None)),
    }
}

/// `rest` of `PNU 922`, `pnu922`: the word, spaces or none, then a digit.
fn strip_word<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    let (start, rest) = text.split_at_checked(word.len())?;
    let rest = rest.trim_start();
    (start.eq_ignore_ascii_case(word) && rest.bytes().next().is_some_and(|b| b.is_ascii_digit()))
        .then_some(rest)
}

/// `922`, `922.0`, `0x39A`, `8-10`.
fn parse_numeric(text: &str, whole: &str) -> Result<(u16, Option<Elements>), ReferenceError> {
    let range = || ReferenceError::NumberRange {
        text: whole.to_string(),
    };
    let valid = |pnu: u16| if pnu == 0 { Err(range()) } else { Ok(pnu) };
    if let Some(hex) = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        check_digits(hex, whole, |c| c.is_ascii_hexdigit())?;
        return Ok((valid(u16::from_str_radix(hex, 16).map_err(|_| range())?)?, None));
    }
    if let Some((group, index)) = text.split_once('-') {
        // Danfoss group and number: 8-10 is PNU 810
        let form = || ReferenceError::GroupIndex {
            text: whole.to_string(),
        };
        let digits = |text: &str| {
            let plain = matches!(text.len(), 1..=5) && text.bytes().all(|byte| byte.is_ascii_digit());
            plain.then(|| text.parse::<u16>().ok()).flatten()
        };
        let (index, element) = match index.split_once('.') {
            Some((index, element)) => (index, Some(element)),
            None => (index, None),
        };
        let (group, place) = digits(group).zip(digits(index)).ok_or_else(form)?;
        let pnu = group
            .checked_mul(100)
            .and_then(|n| n.checked_add(place))
            .filter(|pnu| *pnu > 0 && index.len() <= 2)
            .ok_or_else(form)?;
        let elements = element
            .map(|element| parse_elements(element, whole))
            .transpose()?;
        return Ok((pnu, elements));
    }
    let (pnu, index) = match text.split_once('.') {
        Some((pnu, index)) => (pnu, Some(index)),
        None => (text, None),
    };
    check_digits(pnu, whole, |c| c.is_ascii_digit())?;
    let pnu = valid(pnu.parse().map_err(|_| range())?)?;
    let elements = index.map(|index| parse_elements(index, whole)).transpose()?;
    Ok((pnu, elements))
}

fn check_digits(text: &str, whole: &str, allowed: impl Fn(char) -> bool) -> Result<(), ReferenceError> {
    match text.chars().find(|&c| !allowed(c)) {
        Some(character) => Err(ReferenceError::Character {
            text: whole.to_string(),
            character,
        }),
        None if text.is_empty() => Err(ReferenceError::NumberRange {
            text: whole.to_string(),
        }),
        None => Ok(()),
    }
}

fn parse_elements(inner: &str, whole: &str) -> Result<Elements, ReferenceError> {
    let form = || ReferenceError::Elements {
        text: whole.to_string(),
    };
    let range = || ReferenceError::ElementRange {
        text: whole.to_string(),
    };
    let number = |text: &str| {
        let text = text.trim();
        if text.is_empty() || !text.bytes().all(|b| b.is_ascii_digit()) {
            return Err(form());
        }
        text.parse::<u16>().map_err(|_| range())
    };
    let Some((first, last)) = inner.split_once("..") else {
        return Ok(Elements {
            first: number(inner)?,
            count: 1,
        });
    };
    let (first, last) = (number(first)?, number(last)?);
    let count = last
        .checked_sub(first)
        .and_then(|n| n.checked_add(1))
        .ok_or_else(range)?;
    Ok(Elements { first, count })
}

impl fmt::Display for ParameterReference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.target {
            Target::Name(name) => f.write_str(name)?,
            Target::Number(pnu) => match self.prefix {
                Some(Prefix::Writable) => write!(f, "p{pnu:04}")?,
                Some(Prefix::ReadOnly) => write!(f, "r{pnu:04}")?,
                Some(Prefix::Number) => write!(f, "PNU {pnu}")?,
                None => write!(f, "{pnu}")?,
            },
        }
        self.elements.map_or(Ok(()), |elements| elements.fmt(f))
    }
}

impl fmt::Display for Elements {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.count {
            0 | 1 => write!(f, "[{}]", self.first),
            count => write!(
                f,
                "[{}..{}]",
                self.first,
                u32::from(self.first) + u32::from(count) - 1
            ),
        }
    }
}

/// A parameter number as it is printed: `p0922`, `r0947[0]`, and `0922` while it is not known whether it can be
/// written; as its vendor writes it where that is another way: `1-20`, `ID 103`.
///
/// ```
/// use profidrive_profile::notation::{Notation, Shown};
/// let shown = Shown { pnu: 947, index: Some(0), writable: Some(false), notation: Notation::Name };
/// assert_eq!(shown.to_string(), "r0947[0]");
/// assert_eq!(Shown { notation: Notation::GroupIndex, ..shown }.to_string(), "9-47[0]");
/// let id = Shown { pnu: 10001, index: Some(103), notation: Notation::Id { pnu: 10001 }, ..shown };
/// assert_eq!(id.to_string(), "ID 103");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Shown {
    /// Parameter number.
    pub pnu: u16,
    /// Element, for arrays; of a number that collects parameters always.
    pub index: Option<u16>,
    /// From the description or the table of the drive.
    pub writable: Option<bool>,
    /// How its vendor writes it.
    pub notation: Notation,
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.notation, self.index) {
            (Notation::Id { pnu }, Some(id)) if pnu == self.pnu => return write!(f, "ID {id}"),
            (Notation::GroupIndex, _) => write!(f, "{}-{:02}", self.pnu / 100, self.pnu % 100)?,
            _ => {
                match self.writable {
                    Some(true) => f.write_str("p")?,
                    Some(false) => f.write_str("r")?,
                    None => {}
                }
                write!(f, "{:04}", self.pnu)?;
            }
        }
        self.index.map_or(Ok(()), |index| write!(f, "[{index}]"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::format;
    use proptest::prelude::*;

    fn number(text: &str) -> (u16, Option<(u16, u16)>) {
        let reference: ParameterReference = text.parse().unwrap();
        let Target::Number(pnu) = reference.target else {
            panic!("{text} read as a name")
        };
        (pnu, reference.elements.map(|e| (e.first, e.count)))
    }

    #[test]
    fn every_spelling_of_the_field() {
        for text in [
            "922", "p922", "P0922", "r922", "0922", "PNU 922", "pnu922", "0x39A", "0X39a", " 922 ",
        ] {
            assert_eq!(number(text), (922, None), "{text}");
        }
        for text in [
            "922.0",
            "PNU 922.0",
            "p922[0]",
            "922[0]",
            "P0922.0",
            "922 [0]",
            "922[ 0 ]",
        ] {
            assert_eq!(number(text), (922, Some((0, 1))), "{text}");
        }
        assert_eq!(number("947[0..7]"), (947, Some((0, 8))));
        assert_eq!(number("947[8..8]"), (947, Some((8, 1))));
        assert_eq!(number("8-10"), (810, None));
        for text in ["1-20", "01-20", "120", "p120", "PNU 120"] {
            assert_eq!(number(text), (120, None), "{text}");
        }
        assert_eq!(number("0-1"), (1, None));
        assert_eq!(number("15-30[1]"), (1530, Some((1, 1))));
        assert_eq!(number("1-20.0"), (120, Some((0, 1))));
        assert_eq!(number("9-15[0..9]"), (915, Some((0, 10))));
        for text in ["ID103", "id103", "ID 103", "10001[103]"] {
            assert_eq!(number(text), (10001, Some((103, 1))), "{text}");
        }
        assert_eq!(number("ID 1805"), (10001, Some((1805, 1))));
        assert_eq!(number("65535"), (65535, None));
    }

    #[test]
    fn names_keep_their_spelling() {
        for text in [
            "DRV.ACC",
            "drv.acc",
            "VL.CMD_32",
            "PN.STW1",
            "R.X",
            "P",
            "IDENT",
            "PNUX",
        ] {
            let reference: ParameterReference = text.parse().unwrap();
            assert_eq!(reference.target, Target::Name(text.into()), "{text}");
        }
        let reference: ParameterReference = "MT.P[2..3]".parse().unwrap();
        assert_eq!(reference.elements, Some(Elements { first: 2, count: 2 }));
        assert_eq!(reference.to_string(), "MT.P[2..3]");
    }

    #[test]
    fn names_of_words_are_accepted_in_vendor_spelling() {
        use crate::catalogue::{VACON, VLT};
        let mut seen = 0;
        for tables in [&VLT, &VACON] {
            for parameter in tables.parameters {
                let name = parameter.name;
                if !name.starts_with(|first: char| first.is_ascii_alphabetic()) {
                    continue;
                }
                let reference: ParameterReference =
                    name.parse().unwrap_or_else(|error| panic!("{name}: {error}"));
                assert_eq!(reference.target, Target::Name(name.into()));
                assert_eq!(reference.elements, None);
                seen += 1;
            }
        }
        assert!(seen > 400, "{seen}");
        let element: ParameterReference = "Fault Log: Error Code[3]".parse().unwrap();
        assert_eq!(element.elements, Some(Elements { first: 3, count: 1 }));
    }

    #[test]
    fn mistakes_are_explained() {
        for (text, words) in [
            ("", "no parameter given"),
            ("0", "1 to 65535"),
            ("65536", "1 to 65535"),
            ("0x10000", "1 to 65535"),
            ("0x", "1 to 65535"),
            ("947[", "947[0]"),
            ("947[]", "947[0]"),
            ("947[a]", "947[0]"),
            ("947[7..0]", "before the last"),
            ("947[70000]", "0 to 65535"),
            ("947.0[1]", "947[0]"),
            ("8-100", "1-20"),
            ("0-00", "1-20"),
            ("1-", "1-20"),
            ("1-2x", "1-20"),
            ("900-00", "1-20"),
            ("15-30[1", "947[0]"),
            ("ID 70000", "ID 103"),
            ("ID 103[0]", "ID 103"),
            ("id103x", "ID 103"),
            ("93O", "`O`"),
            ("DRV ACC!", "`!`"),
            ("1-20.x", "947[0]"),
            ("DRV.ACC=5", "`=`"),
            ("[0]", "no parameter given"),
        ] {
            let error = text.parse::<ParameterReference>().unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    proptest! {
        #[test]
        fn printed_form_reads_back(pnu in 1u16.., first in 0u16..1000, count in 1u16..300, letter in 0usize..4) {
            let prefix = [None, Some(Prefix::Writable), Some(Prefix::ReadOnly), Some(Prefix::Number)][letter];
            let reference = ParameterReference {
                target: Target::Number(pnu), elements: Some(Elements { first, count }), prefix,
            };
            prop_assert_eq!(format!("{reference}").parse::<ParameterReference>().unwrap(), reference);
        }

        /// A Danfoss number is one parameter in each of its spellings.
        #[test]
        fn group_and_index_are_the_number(group in 0u16..=654, index in 0u16..100, element in 0u16..1000) {
            prop_assume!(group + index > 0);
            let pnu = 100 * group + index;
            for text in [format!("{group}-{index:02}"), format!("{pnu}"), format!("p{pnu}"), format!("PNU {pnu}")] {
                prop_assert_eq!(number(&text), (pnu, None));
                prop_assert_eq!(number(&format!("{text}[{element}]")), (pnu, Some((element, 1))));
            }
        }

        #[test]
        fn any_text_gives_an_answer(text in ".{0,24}") {
            let _ = text.parse::<ParameterReference>();
        }
    }
}
