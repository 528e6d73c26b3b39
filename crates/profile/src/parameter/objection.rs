//! What a dialect forbids in a request.

use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

use super::access::{Attributes, Keep, ParameterAccess};
use super::address::{Attribute, DecodeError, MAX_ELEMENTS, ParameterAddress};
use super::block::ValueBlock;
use super::description::Description;
use super::dialect::Dialect;
use super::error::ErrorNumber;
use super::format::Format;
use super::request::Request;
use super::serve::{Span, serve_each, whole};

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
    /// An attribute that does not exist.
    Attribute(u8),
    /// Texts of values (attribute 0x30), which the drive does not have or which nobody can change.
    Texts,
    /// A change of the description (attribute 0x20), or one that the drive does not have.
    Description,
    /// More than 234 elements, or none of an array.
    Elements(u8),
    /// Elements that the array does not have.
    Members {
        /// The first of them.
        subindex: u16,
        /// Number of elements.
        elements: u8,
    },
    /// A change of a parameter that can only be read.
    ReadOnly,
    /// A format that no value has.
    Format(u8),
    /// A format that is not one of the parameter.
    Type(u8),
    /// A number that the type of the parameter does not have.
    Range,
    /// More values than one job carries.
    Long,
    /// Several elements, or another than the first, of a parameter that is not an array.
    NoArray {
        /// Number of elements.
        elements: u8,
        /// The first of them.
        subindex: u16,
    },
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
    /// Something else.
    Other,
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
}

impl fmt::Display for Objection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.what {
            Forbidden::Reference => f.write_str("reference 0 is reserved"),
            Forbidden::Request(id) => write!(f, "request ID 0x{id:02X} does not exist"),
            Forbidden::Axis { found, allowed } => {
                write!(f, "axis {found} does not exist, only {allowed}")
            }
            Forbidden::Parameters { found, allowed } => {
                write!(f, "{found} parameters, 1 to {allowed} are allowed")
            }
            Forbidden::Attribute(code) => write!(f, "attribute 0x{code:02X} does not exist"),
            Forbidden::Texts => f.write_str("texts (attribute 0x30) are not supported"),
            Forbidden::Description => {
                f.write_str("a description (attribute 0x20) that cannot be changed or read")
            }
            Forbidden::Members { subindex, elements } => {
                write!(
                    f,
                    "the array does not have {elements} elements from subindex {subindex} on"
                )
            }
            Forbidden::ReadOnly => f.write_str("the parameter can only be read"),
            Forbidden::Format(code) => write!(f, "0x{code:02X} is not the format of a value"),
            Forbidden::Type(code) => write!(f, "the parameter does not have the format 0x{code:02X}"),
            Forbidden::Range => f.write_str("the type of the parameter does not have this number"),
            Forbidden::Long => f.write_str("more values than one job carries"),
            Forbidden::Short => f.write_str("the request ends too early"),
            Forbidden::Other => f.write_str("this is not possible"),
            Forbidden::Elements(elements) => {
                write!(f, "{elements} elements, 1 to {MAX_ELEMENTS} are allowed")
            }
            Forbidden::NoArray {
                elements,
                subindex: 0,
            } => {
                write!(
                    f,
                    "{elements} elements of a parameter that is not an array, 0 or 1 are allowed"
                )
            }
            Forbidden::NoArray { subindex, .. } => {
                write!(f, "subindex {subindex} of a parameter that is not an array")
            }
            Forbidden::Values { found, expected } => {
                write!(f, "number of values {found}, the address means {expected}")
            }
            Forbidden::Trailing(octets) => write!(f, "{octets} octets too many at the end"),
        }?;
        match self.answer {
            Some(number) => write!(f, ": answered with error 0x{:02X}", number.0),
            None => f.write_str(": the record write is refused"),
        }
    }
}

/// Lists what `dialect` forbids in a request, with the error numbers that a drive with these rules answers: the request is
/// served as [`serve`](super::serve()) does it. Where the request as a whole is refused, its parameters are not looked at.
/// `facts` gives what is known of a parameter, `None` for an unknown one. Whether a parameter exists and whether its limits
/// and its state allow a value is not looked at.
#[must_use]
pub fn objections(
    request: &Request<'_>,
    dialect: &Dialect,
    facts: impl Fn(ParameterAddress) -> Option<Attributes>,
) -> Vec<Objection> {
    if let Err((what, answer)) = whole(request.bytes(), dialect) {
        return vec![Objection {
            parameter: None,
            what,
            answer,
        }];
    }
    let mut values = request.values();
    let parameters: Vec<Asked<'_>> = request
        .addresses()
        .map(|address| {
            let block = values.next().filter(|_| request.id().is_change());
            let facts = facts(address).unwrap_or_else(|| fitting(address, block.as_ref()));
            Asked {
                address,
                block,
                facts,
            }
        })
        .collect();
    let mut drive = Willing {
        parameters: &parameters,
        place: 0,
    };
    let mut found = Vec::new();
    let mut out = vec![0; dialect.max_block];
    // without room for an answer nothing is found
    let _ = serve_each(
        request.bytes(),
        dialect,
        &mut drive,
        &mut out,
        |drive, _, answer| {
            if let (Err(error), Some(asked)) = (answer, parameters.get(drive.place)) {
                found.push(Objection {
                    parameter: Some(drive.place),
                    what: asked.forbidden(error.number),
                    answer: Some(error.number),
                });
            }
            drive.place += 1;
        },
    );
    found
}

/// One parameter of a request.
struct Asked<'a> {
    address: ParameterAddress,
    block: Option<Result<ValueBlock<'a>, DecodeError>>,
    facts: Attributes,
}

impl Asked<'_> {
    /// What of the address or the values an error number is about.
    fn forbidden(&self, number: ErrorNumber) -> Forbidden {
        let ParameterAddress {
            attribute,
            elements,
            subindex,
            ..
        } = self.address;
        let block = self.block.as_ref().and_then(|block| block.as_ref().ok());
        let format = block.map_or(0, |block| block.format.0);
        match (attribute, number) {
            (_, ErrorNumber::TOO_LONG) => Forbidden::Long,
            (_, ErrorNumber::SUBINDEX) => Forbidden::Members { subindex, elements },
            (Attribute::Other(code), _) => Forbidden::Attribute(code),
            (Attribute::Text, _) => Forbidden::Texts,
            (_, ErrorNumber::ADDRESS) if elements > MAX_ELEMENTS || self.facts.is_array() => {
                Forbidden::Elements(elements)
            }
            (Attribute::Description, _) => Forbidden::Description,
            (_, ErrorNumber::ADDRESS) => Forbidden::NoArray {
                elements,
                subindex: 0,
            },
            (_, ErrorNumber::NO_ARRAY) => Forbidden::NoArray { elements, subindex },
            (_, ErrorNumber::NOT_CHANGEABLE) => Forbidden::ReadOnly,
            (_, ErrorNumber::FORMAT) => Forbidden::Format(format),
            (_, ErrorNumber::DATA_TYPE) => Forbidden::Type(format),
            (_, ErrorNumber::LIMIT) => Forbidden::Range,
            _ => match (block, Span::of(&self.facts, elements, subindex)) {
                (None, _) if self.block.is_some() => Forbidden::Short,
                (Some(block), Ok(span)) if block.count != span.count => Forbidden::Values {
                    found: block.count,
                    expected: span.count.into(),
                },
                _ => Forbidden::Other,
            },
        }
    }
}

/// Facts of an unknown parameter that a request fits, as far as one can.
fn fitting(address: ParameterAddress, block: Option<&Result<ValueBlock<'_>, DecodeError>>) -> Attributes {
    let block = block.and_then(|block| block.as_ref().ok());
    let (format, octets) = block.map_or((Format::UNSIGNED8, 1), |block| (block.format, block.width()));
    let simple = Attributes::simple(format, octets, true);
    let is_simple = address.elements <= 1 && address.subindex == 0;
    let elements = match block {
        Some(block) if is_simple && simple.is_string() => block.count.into(),
        _ if is_simple => 0,
        _ => u16::MAX,
    };
    Attributes { elements, ..simple }
}

/// A drive that has the parameters of a request and refuses nothing by itself.
struct Willing<'a> {
    parameters: &'a [Asked<'a>],
    /// Which of them is served.
    place: usize,
}

impl ParameterAccess for Willing<'_> {
    fn attributes(&self, _: u16, _: u16) -> Option<Attributes> {
        self.parameters.get(self.place).map(|asked| asked.facts)
    }

    fn read(&mut self, _: u16, _: u16) -> Result<u64, ErrorNumber> {
        Ok(0)
    }

    fn write(&mut self, _: u16, _: u16, _: u64, _: Keep) -> Result<(), ErrorNumber> {
        Ok(())
    }

    /// The parameters that one number collects have none.
    fn description(&self, pnu: u16) -> Option<Description> {
        let facts = self.attributes(pnu, 0)?;
        (facts.first == 0).then(Description::default)
    }

    fn text(&self, _: u16, _: u16) -> Option<[u8; 16]> {
        Some([b' '; 16])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{Catalogue, VACON, VLT};
    use alloc::string::{String, ToString};

    fn found(catalogue: &Catalogue, dialect: &Dialect, hex: &str) -> Vec<String> {
        let octets: Vec<u8> = hex
            .split_whitespace()
            .map(|octet| u8::from_str_radix(octet, 16).unwrap())
            .collect();
        let request = Request::parse(&octets, dialect.code_space).unwrap();
        let facts = |address: ParameterAddress| {
            let parameter = catalogue.at(address.pnu, address.subindex);
            parameter.map(crate::catalogue::Parameter::attributes)
        };
        let found = objections(&request, dialect, facts);
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
                &["texts (attribute 0x30) are not supported: answered with error 0x20"],
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
}
