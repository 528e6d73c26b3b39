//! What a dialect forbids in a request.

use alloc::vec::Vec;
use core::fmt;

use super::access::Attributes;
use super::address::{Attribute, MAX_ELEMENTS, ParameterAddress};
use super::dialect::Dialect;
use super::error::ErrorNumber;
use super::request::Request;

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
    /// Texts of values (attribute 0x30), which the drive does not have.
    Texts,
    /// More than 234 elements, or none of an array.
    Elements(u8),
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

/// Lists what `dialect` forbids in a request; `facts` gives what is known of a parameter, `None` for an unknown one. Whether
/// a parameter exists, takes the value or may be written is not looked at.
#[must_use]
pub fn objections(
    request: &Request<'_>,
    dialect: &Dialect,
    facts: impl Fn(ParameterAddress) -> Option<Attributes>,
) -> Vec<Objection> {
    let mut found = Vec::new();
    let mut add = |parameter, what, answer| {
        found.push(Objection {
            parameter,
            what,
            answer,
        });
    };
    let (id, axis, parameters) = (request.id(), request.axis(), request.parameters());
    if let (0, Some(number)) = (request.reference(), dialect.bad_reference) {
        add(None, Forbidden::Reference, Some(number));
    }
    if !dialect.knows(id) {
        add(None, Forbidden::Request(id.octet()), Some(dialect.bad_request.1));
    }
    if dialect.axis_checked && axis != dialect.axis {
        let what = Forbidden::Axis {
            found: axis,
            allowed: dialect.axis,
        };
        add(None, what, Some(dialect.bad_axis));
    }
    if parameters == 0 || parameters > dialect.max_parameters {
        let what = Forbidden::Parameters {
            found: parameters,
            allowed: dialect.max_parameters,
        };
        add(None, what, dialect.bad_count);
    }
    let mut values = request.values();
    for (place, address) in request.addresses().enumerate() {
        let here = Some(place);
        let ParameterAddress {
            attribute,
            elements,
            subindex,
            ..
        } = address;
        match attribute {
            Attribute::Other(code) => add(here, Forbidden::Attribute(code), Some(dialect.bad_attribute)),
            Attribute::Text if !dialect.texts => {
                let answer = if id.is_change() {
                    ErrorNumber::TEXT_FIXED
                } else {
                    ErrorNumber::NO_TEXT
                };
                add(here, Forbidden::Texts, Some(answer));
            }
            _ => {}
        }
        let facts = facts(address).filter(|_| attribute == Attribute::Value);
        if elements > MAX_ELEMENTS {
            add(here, Forbidden::Elements(elements), Some(ErrorNumber::ADDRESS));
        } else if let Some(facts) = facts {
            let offset = subindex.saturating_sub(facts.first);
            match (facts.is_array(), elements) {
                (false, _) if offset > 0 => {
                    add(
                        here,
                        Forbidden::NoArray { elements, subindex },
                        Some(ErrorNumber::NO_ARRAY),
                    );
                }
                (false, 2..) => add(
                    here,
                    Forbidden::NoArray {
                        elements,
                        subindex: 0,
                    },
                    Some(ErrorNumber::ADDRESS),
                ),
                (true, 0) if !facts.is_string() => {
                    add(here, Forbidden::Elements(0), Some(ErrorNumber::ADDRESS));
                }
                _ => {}
            }
        }
        if id.is_change()
            && let Some(Ok(block)) = values.next()
        {
            let one = facts.map_or(1, |facts| match facts.string_octets() {
                octets if octets > 0 && elements <= 1 => octets,
                _ => 1,
            });
            let expected = u16::from(elements.max(1)).saturating_mul(one);
            if u16::from(block.count) != expected {
                let what = Forbidden::Values {
                    found: block.count,
                    expected,
                };
                add(here, what, Some(ErrorNumber::VALUE_COUNT));
            }
        }
    }
    let exact = dialect.exact_length && id.is_change();
    let behind = if exact {
        request.behind().len()
    } else {
        request.trailing()
    };
    if behind > 0 {
        let answer = dialect.trailing.filter(|_| id.is_change());
        add(None, Forbidden::Trailing(behind), answer);
    }
    found
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
                "01 01 01 01 10 EB 03 AF 00 00",
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
                &[
                    "reference 0 is reserved: answered with error 0x65",
                    "request ID 0x07 does not exist: answered with error 0x21",
                    "attribute 0x50 does not exist: answered with error 0x69",
                ],
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
