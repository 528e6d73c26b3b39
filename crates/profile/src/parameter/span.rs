//! What elements and subindex of an address mean for a parameter.

use super::access::Attributes;
use super::address::MAX_ELEMENTS;
use super::error::{ErrorNames, ErrorNumber, ParameterError};
use super::objection::{Denial, Forbidden};

/// Returns the number with the subindex as additional information, where the profile defines it.
pub(super) fn at(number: ErrorNumber, subindex: u16) -> ParameterError {
    let has_subindex = number.info(ErrorNames::Profile).is_some_and(|info| info.subindex);
    ParameterError {
        number,
        info: (has_subindex && subindex != 0).then_some(subindex),
    }
}

/// What elements and subindex of an address really mean.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    /// First element as the drive counts them.
    pub(super) first: u16,
    /// Values of the block.
    pub(super) count: u8,
    /// Octets of one string where whole strings are meant.
    pub(super) whole: Option<u16>,
}

impl Span {
    /// Source: SINAMICS DCM p. 199, ABB RETA-02 p. 84, Vacon OPTEA p. 119; 0 elements of an array is the special
    /// function that no client may send, it is refused like any impossible address. Strings as a whole and arrays of
    /// them are our reading.
    pub(super) fn of(facts: &Attributes, elements: u8, subindex: u16) -> Result<Self, Denial> {
        let relative = subindex.saturating_sub(facts.first);
        if facts.elements == 0 {
            let plain = Forbidden::NoArray {
                elements,
                subindex: relative,
            };
            return match (relative, elements) {
                (0, 0 | 1) => Ok(Self {
                    first: subindex,
                    count: 1,
                    whole: None,
                }),
                (0, _) => Err(plain.refused(ErrorNumber::ADDRESS)),
                _ => Err(plain.refused(ErrorNumber::NO_ARRAY)),
            };
        }
        let is_plain_string = facts.is_string() && facts.string == 0;
        let (size, elements, members) = match (relative, elements) {
            (0, 0 | 1) if is_plain_string => (facts.elements, 1, 1),
            _ if facts.string > 0 => (facts.string, elements, facts.elements / facts.string),
            _ => (1, elements, facts.elements),
        };
        if elements == 0 || elements > MAX_ELEMENTS {
            return Err(Forbidden::Elements(elements).refused(ErrorNumber::ADDRESS));
        }
        let missing =
            |first| Forbidden::Members { subindex, elements }.refused(at(ErrorNumber::SUBINDEX, first));
        if relative >= members {
            return Err(missing(subindex));
        }
        if u16::from(elements) > members - relative {
            return Err(missing(facts.first.saturating_add(members)));
        }
        let octets = u16::from(elements).saturating_mul(size);
        let count = u8::try_from(octets).ok().filter(|&count| count <= MAX_ELEMENTS);
        Ok(Self {
            first: facts.first.saturating_add(relative.saturating_mul(size)),
            count: count.ok_or(Forbidden::Long.refused(ErrorNumber::TOO_LONG))?,
            whole: facts.is_string().then_some(size).filter(|&size| size > 1),
        })
    }
}

/// Checks the elements of an address that requests a description. Their number says as much of the parameter as in an
/// address of its value: 0 or 1 of a single value, 1 to 234 of an array. An element of the description (subindex 1 to
/// 12) is read alone. Source: Vacon OPTEA p. 119, whose numbers hold for every attribute.
pub(super) fn check_description(facts: &Attributes, elements: u8, subindex: u16) -> Result<(), Denial> {
    let is_plain = facts.elements == 0 || facts.string_octets() == facts.elements;
    let what = match elements {
        0 if is_plain => return Ok(()),
        2.. if facts.elements == 0 => Forbidden::NoArray {
            elements,
            subindex: 0,
        },
        0 | 235.. => Forbidden::Elements(elements),
        2.. if subindex != 0 => Forbidden::DescriptionElements { elements, subindex },
        _ => return Ok(()),
    };
    Err(what.refused(ErrorNumber::ADDRESS))
}
