//! What a dialect forbids in a request.

use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

use super::access::{Attributes, Keep, ParameterAccess};
use super::address::{DecodeError, MAX_ELEMENTS, ParameterAddress};
use super::block::ValueBlock;
use super::description::Description;
use super::dialect::Dialect;
use super::error::{ErrorNumber, ParameterError};
use super::format::Format;
use super::serve::{serve_each, whole};

/// Something that is not allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Forbidden {
    /// The reserved reference 0.
    Reference,
    /// A request ID that does not exist.
    Request(u8),
    /// An axis that does not exist.
    Axis {
        /// In the header.
        found: u8,
        /// The only one.
        allowed: u8,
    },
    /// A number of parameters outside 1 to the limit.
    Parameters {
        /// In the header.
        found: u8,
        /// At most.
        allowed: u8,
    },
    /// The parameter number 0, which no drive has.
    NumberZero,
    /// A parameter that is not in the tables of the drive.
    Unknown,
    /// An attribute that does not exist.
    Attribute(u8),
    /// Texts of values (attribute 0x30) of a drive that has none.
    Texts,
    /// Texts that the parameter does not have.
    NoText {
        /// The first of them.
        subindex: u16,
        /// Number of texts.
        elements: u8,
    },
    /// A change of texts.
    TextChange,
    /// The description (attribute 0x20) of a parameter that has none.
    NoDescription,
    /// An element of the description that does not exist.
    DescriptionElement(u16),
    /// Several elements of a description at once.
    DescriptionElements {
        /// Number of elements.
        elements: u8,
        /// The first of them.
        subindex: u16,
    },
    /// A change of the description.
    DescriptionChange,
    /// More than 234 elements, or none of an array.
    Elements(u8),
    /// Elements that the array does not have.
    Members {
        /// The first of them.
        subindex: u16,
        /// Number of elements.
        elements: u8,
    },
    /// Several elements, or another than the first, of a parameter that is not an array.
    NoArray {
        /// Number of elements.
        elements: u8,
        /// The first of them.
        subindex: u16,
    },
    /// A change of a parameter that can only be read.
    ReadOnly,
    /// A format that no value has.
    Format(u8),
    /// A format that is not one of the parameter.
    Type(u8),
    /// A request for double words, of a parameter that has none.
    NoDoubleWord,
    /// A number that the type of the parameter does not have.
    Range,
    /// More values than one job carries.
    Long,
    /// Fewer or more values than elements.
    Values {
        /// In the value block.
        found: u8,
        /// Elements of the address, or octets of the string.
        expected: u16,
    },
    /// Octets behind the last value, or behind the addresses of a read.
    Trailing(usize),
    /// Addresses or values that the request ends before.
    Short,
    /// Something that the drive itself refuses: its state, its limits, the rights of the interface.
    Other,
}

impl Forbidden {
    /// Returns the reason where a drive does not have this parameter.
    pub(super) const fn unknown(pnu: u16) -> Self {
        match pnu {
            0 => Self::NumberZero,
            _ => Self::Unknown,
        }
    }

    /// Returns the refusal for this reason.
    pub(super) fn refused(self, error: impl Into<ParameterError>) -> Denial {
        Denial {
            what: self,
            error: error.into(),
        }
    }
}

/// Why a parameter of a request is refused, and the error of the answer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Denial {
    pub(super) what: Forbidden,
    pub(super) error: ParameterError,
}

impl<E: Into<ParameterError>> From<E> for Denial {
    fn from(error: E) -> Self {
        Forbidden::Other.refused(error)
    }
}

/// Something that a dialect forbids in a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Objection {
    /// Place of the parameter, from 0; `None` for the request as a whole.
    pub parameter: Option<usize>,
    /// What is not allowed.
    pub what: Forbidden,
    /// Error number of the answer; `None` where the record write is refused.
    pub answer: Option<ErrorNumber>,
    /// True where no table lists the parameter, and another number is the answer if it does not.
    pub assumed: bool,
}

impl fmt::Display for Forbidden {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Reference => f.write_str("reference 0 is reserved"),
            Self::Request(id) => write!(f, "request ID 0x{id:02X} does not exist"),
            Self::Axis { found, allowed } => write!(f, "axis {found} does not exist, only {allowed}"),
            Self::Parameters { found, allowed } => {
                write!(f, "{found} parameters, 1 to {allowed} are allowed")
            }
            Self::NumberZero => f.write_str("parameter number 0 does not exist"),
            Self::Unknown => f.write_str("not in the tables"),
            Self::Attribute(code) => write!(f, "attribute 0x{code:02X} does not exist"),
            Self::Texts => f.write_str("texts (attribute 0x30) are not supported"),
            Self::NoText { subindex, elements } => {
                write!(
                    f,
                    "the parameter does not have {elements} texts from number {subindex} on"
                )
            }
            Self::TextChange => f.write_str("texts (attribute 0x30) cannot be changed"),
            Self::NoDescription => f.write_str("the parameter has no description (attribute 0x20)"),
            Self::DescriptionElement(number) => write!(f, "a description does not have the element {number}"),
            Self::DescriptionElements { elements, subindex } => write!(
                f,
                "{elements} elements of a description from element {subindex} on, only one is read at once"
            ),
            Self::DescriptionChange => f.write_str("a description (attribute 0x20) cannot be changed"),
            Self::Members { subindex, elements } => write!(
                f,
                "the array does not have {elements} elements from subindex {subindex} on"
            ),
            Self::ReadOnly => f.write_str("the parameter can only be read"),
            Self::Format(code) => write!(f, "0x{code:02X} is not the format of a value"),
            Self::Type(code) => write!(f, "the parameter does not have the format 0x{code:02X}"),
            Self::NoDoubleWord => f.write_str("the value does not fit a double word"),
            Self::Range => f.write_str("the type of the parameter does not have this number"),
            Self::Long => f.write_str("more values than one job carries"),
            Self::Short => f.write_str("the request ends too early"),
            Self::Other => f.write_str("this is not possible"),
            Self::Elements(elements) => write!(f, "{elements} elements, 1 to {MAX_ELEMENTS} are allowed"),
            Self::NoArray {
                elements,
                subindex: 0,
            } => write!(
                f,
                "{elements} elements of a parameter that is not an array, 0 or 1 are allowed"
            ),
            Self::NoArray { subindex, .. } => {
                write!(f, "subindex {subindex} of a parameter that is not an array")
            }
            Self::Values { found, expected } => {
                write!(f, "number of values {found}, the address means {expected}")
            }
            Self::Trailing(octets) => write!(f, "{octets} octets too many at the end"),
        }
    }
}

impl fmt::Display for Objection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.what.fmt(f)?;
        match self.answer {
            Some(number) => write!(f, ": answered with error 0x{:02X}", number.0),
            None => f.write_str(": the record write is refused"),
        }?;
        match self.what {
            Forbidden::Unknown => f.write_str(" unless the drive has the parameter"),
            _ if self.assumed => f.write_str(" if the drive has the parameter"),
            _ => Ok(()),
        }
    }
}

/// Lists what a drive with this dialect answers with an error number: the request is served as
/// [`serve`](super::serve()) does it, by `tables`, a drive that has the parameters of a kind of drive and refuses nothing by
/// its state. Without tables every parameter is assumed to be one that the request fits, as far as one can. Where the
/// request as a whole is refused, its parameters are not looked at.
#[must_use]
pub fn objections(
    request: &[u8],
    dialect: &Dialect,
    tables: Option<&mut dyn ParameterAccess>,
) -> Vec<Objection> {
    let parsed = match whole(request, dialect) {
        Ok(parsed) => parsed,
        Err((what, answer)) => {
            return vec![Objection {
                parameter: None,
                what,
                answer,
                assumed: false,
            }];
        }
    };
    if let Some(drive) = tables {
        return denied(request, dialect, drive, |_| {});
    }
    let mut values = parsed.values();
    let parameters = parsed.addresses().map(|address| {
        let block = values.next().filter(|_| parsed.id().is_change());
        (address, fitting(address, block.as_ref()))
    });
    let mut drive = Willing {
        parameters: parameters.collect(),
        place: 0,
    };
    let mut found = denied(request, dialect, &mut drive, |drive| drive.place += 1);
    let none = &mut Willing {
        parameters: Vec::new(),
        place: 0,
    };
    let absent = denied(request, dialect, none, |_| {});
    for objection in &mut found {
        let mut absent = absent.iter();
        let same = |one: &&Objection| (one.parameter, one.answer) == (objection.parameter, objection.answer);
        objection.assumed = !absent.any(|one| same(&one));
    }
    found
}

/// Returns the objections of `drive` to a request; `next` is called behind each parameter.
fn denied<D: ParameterAccess + ?Sized>(
    request: &[u8],
    dialect: &Dialect,
    drive: &mut D,
    mut next: impl FnMut(&mut D),
) -> Vec<Objection> {
    let mut found = Vec::new();
    let mut out = vec![0; dialect.max_block];
    // without room for an answer nothing is found
    let _ = serve_each(request, dialect, drive, &mut out, |drive, place, answer| {
        if let Err(Denial { what, error }) = answer {
            found.push(Objection {
                parameter: usize::try_from(place).ok(),
                what,
                answer: Some(error.number),
                assumed: false,
            });
        }
        next(drive);
    });
    found
}

/// Facts of a parameter that a request fits, as far as one can.
fn fitting(address: ParameterAddress, block: Option<&Result<ValueBlock<'_>, DecodeError>>) -> Attributes {
    let block = block.and_then(|block| block.as_ref().ok());
    let (format, octets) = block.map_or((Format::UNSIGNED8, 1), |block| (block.format, block.width()));
    let simple = Attributes {
        first: address.subindex,
        ..Attributes::simple(format, octets, true)
    };
    let elements = match block {
        Some(block) if address.elements <= 1 && simple.is_string() => block.count.into(),
        _ if address.elements <= 1 => 0,
        _ => address.elements.into(),
    };
    Attributes { elements, ..simple }
}

/// A drive that has the parameters of a request and refuses nothing by itself.
struct Willing {
    parameters: Vec<(ParameterAddress, Attributes)>,
    /// Which of them is served.
    place: usize,
}

impl ParameterAccess for Willing {
    fn attributes(&self, pnu: u16, _: u16) -> Option<Attributes> {
        let (_, facts) = self.parameters.get(self.place).filter(|_| pnu != 0)?;
        Some(*facts)
    }

    fn read(&mut self, _: u16, _: u16) -> Result<u64, ErrorNumber> {
        Ok(0)
    }

    fn write(&mut self, _: u16, _: u16, _: u64, _: Keep) -> Result<(), ErrorNumber> {
        Ok(())
    }

    fn description(&self, pnu: u16) -> Option<Description> {
        self.attributes(pnu, 0).map(|_| Description::default())
    }

    fn text(&self, pnu: u16, _: u16) -> Option<[u8; 16]> {
        self.attributes(pnu, 0).map(|_| [b' '; 16])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{Catalogue, Tables, VACON, VLT};
    use alloc::string::{String, ToString};

    fn octets(hex: &str) -> Vec<u8> {
        let octets = hex.split_whitespace();
        octets
            .map(|octet| u8::from_str_radix(octet, 16).unwrap())
            .collect()
    }

    fn found(catalogue: &'static Catalogue, dialect: &Dialect, hex: &str) -> Vec<String> {
        let found = objections(&octets(hex), dialect, Some(&mut Tables(catalogue)));
        found.iter().map(ToString::to_string).collect()
    }

    /// The table of the OPTEA manual p. 119, each line broken once.
    #[test]
    fn what_a_vacon_forbids() {
        let many = String::from("01 01 01 28") + &" 10 01 03 9A 00 00".repeat(40);
        for (hex, words) in [
            ("01 01 01 01 10 01 27 11 00 67", &[][..]),
            (
                "01 01 00 01 10 01 03 9A 00 00",
                &["axis 0 does not exist, only 1: answered with error 0x19"],
            ),
            (
                "01 01 05 01 10 01 03 9A 00 00",
                &["axis 5 does not exist, only 1: answered with error 0x19"],
            ),
            (
                "01 01 01 00",
                &["0 parameters, 1 to 39 are allowed: answered with error 0x68"],
            ),
            (
                &many,
                &["40 parameters, 1 to 39 are allowed: answered with error 0x68"],
            ),
            (
                "01 01 01 01 10 EB 03 B3 00 00",
                &["235 elements, 1 to 234 are allowed: answered with error 0x16"],
            ),
            (
                "01 01 01 01 30 01 03 9A 00 00",
                &["texts (attribute 0x30) are not supported: answered with error 0x0F"],
            ),
            (
                "01 02 01 01 30 01 03 9A 00 00 42 01 00 01",
                &["texts (attribute 0x30) cannot be changed: answered with error 0x20"],
            ),
            (
                "01 01 01 01 10 03 03 9A 00 00",
                &[
                    "3 elements of a parameter that is not an array, 0 or 1 are allowed: answered with error 0x16",
                ],
            ),
            (
                "01 01 01 01 10 01 03 9A 00 02",
                &["subindex 2 of a parameter that is not an array: answered with error 0x04"],
            ),
            (
                "01 02 01 01 10 02 03 93 00 00 42 01 00 01",
                &["number of values 1, the address means 2: answered with error 0x18"],
            ),
            (
                "01 02 01 01 10 01 27 11 00 67 42 01 00 32 AA BB",
                &["2 octets too many at the end: answered with error 0x6D"],
            ),
            (
                "01 01 01 01 10 01 03 9A 00 00 AA",
                &["1 octets too many at the end: the record write is refused"],
            ),
            (
                "01 01 01 01 10 01 00 00 00 00",
                &["parameter number 0 does not exist: answered with error 0x00"],
            ),
            (
                "01 01 01 01 10 01 27 11 FF FF",
                &["not in the tables: answered with error 0x6C unless the drive has the parameter"],
            ),
            (
                "09 01 01 01 20 EA 27 11 13 88",
                &["the parameter has no description (attribute 0x20): answered with error 0x09"],
            ),
            (
                "01 01 01 01 20 FF 03 A2 00 00",
                &[
                    "255 elements of a parameter that is not an array, 0 or 1 are allowed: answered with error 0x16",
                ],
            ),
            (
                "01 01 01 01 20 02 03 A2 00 00",
                &[
                    "2 elements of a parameter that is not an array, 0 or 1 are allowed: answered with error 0x16",
                ],
            ),
            (
                "01 02 01 01 10 01 27 11 00 67 42 03 00 01",
                &["the request ends too early: answered with error 0x6B"],
            ),
            (
                "01 01 01 02 10 01 27 11 00 67",
                &["the request ends too early: answered with error 0x6B"],
            ),
            (
                "01 01 01",
                &["the request ends too early: the record write is refused"],
            ),
            (
                "00 07 01 01 50 01 03 9A 00 00",
                &["request ID 0x07 does not exist: answered with error 0x21"],
            ),
            (
                "00 01 01 01 50 01 03 9A 00 00",
                &["reference 0 is reserved: answered with error 0x65"],
            ),
            (
                "01 01 01 01 50 01 03 9A 00 00",
                &["attribute 0x50 does not exist: answered with error 0x69"],
            ),
        ] {
            assert_eq!(found(&VACON, &Dialect::VACON, hex), words, "{hex}");
        }
    }

    #[test]
    fn what_a_vlt_forbids() {
        for (hex, words) in [
            ("01 42 00 01 10 01 01 55 00 00 07 01 00 00 01 F4", &[][..]),
            ("01 01 00 01 10 01 00 25 00 00", &[]),
            ("01 01 00 01 30 01 00 01 00 00", &[]),
            (
                "01 02 00 01 10 01 01 55 00 00 07 01 00 00 01 F4 00 00",
                &["2 octets too many at the end: answered with error 0x18"],
            ),
            (
                "01 02 00 01 10 01 00 25 00 00 09 02 41 42",
                &["number of values 2, the address means 25: answered with error 0x18"],
            ),
        ] {
            assert_eq!(found(&VLT, &Dialect::VLT, hex), words, "{hex}");
        }
    }

    /// Nothing is said of a parameter that no tables have, but what is wrong with every parameter, or with this one if it
    /// exists.
    #[test]
    fn without_tables_a_parameter_is_assumed_to_fit() {
        for (hex, words) in [
            ("01 01 01 01 10 01 4E 20 FF FF", &[][..]),
            ("01 01 01 01 10 EA 4E 20 FF 00", &[]),
            ("01 02 01 01 10 01 4E 20 FF FF 42 01 00 01", &[]),
            ("01 02 01 01 10 02 4E 20 00 07 42 02 00 01 00 02", &[]),
            ("01 02 01 01 10 01 4E 20 00 00 09 03 41 42 43 00", &[]),
            ("09 01 01 01 20 01 4E 20 00 05", &[]),
            (
                "05 01 00 01 10 01 00 00 00 00",
                &["parameter number 0 does not exist: answered with error 0x00"],
            ),
            (
                "05 02 00 01 10 01 00 00 00 00 42 01 00 01",
                &["parameter number 0 does not exist: answered with error 0x00"],
            ),
            (
                "05 01 00 01 20 01 00 00 00 00",
                &["parameter number 0 does not exist: answered with error 0x00"],
            ),
            (
                "09 01 01 01 20 EA 4E 20 13 88",
                &[
                    "234 elements of a description from element 5000 on, only one is read at once: \
                   answered with error 0x16 if the drive has the parameter",
                ],
            ),
            (
                "01 01 01 01 10 EB 4E 20 00 00",
                &[
                    "235 elements, 1 to 234 are allowed: answered with error 0x16 if the drive has the parameter",
                ],
            ),
            (
                "01 01 01 01 50 01 4E 20 00 00",
                &["attribute 0x50 does not exist: answered with error 0x16"],
            ),
            (
                "01 02 01 02 10 01 4E 20 00 00 10 01 4E 21 00 00 42 01 00 01",
                &["the request ends too early: answered with error 0x18 if the drive has the parameter"],
            ),
        ] {
            let found = objections(&octets(hex), &Dialect::STANDARD, None);
            let found: Vec<String> = found.iter().map(ToString::to_string).collect();
            assert_eq!(found, words, "{hex}");
        }
    }
}
