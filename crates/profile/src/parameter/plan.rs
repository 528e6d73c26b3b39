//! Packing many parameters into few requests.

use alloc::vec::Vec;
use core::ops::Range;

use super::address::{ADDRESS, HEADER, MAX_ELEMENTS, ParameterAddress};
use super::dialect::Dialect;

/// Octets assumed for an element without tables.
const UNKNOWN_OCTETS: usize = 4;

/// Groups reads so that each group is one request: not more parameters and values than the drive takes, and neither request nor
/// response longer than its largest block. Each item is an address and the octets of one element, if known.
///
/// Gives ranges of the items, in order and without gaps.
///
/// ```
/// use profidrive_profile::parameter::{Dialect, ParameterAddress, plan_reads};
/// let items: Vec<_> = (2000..2100).map(|pnu| (ParameterAddress::value(pnu, 0), Some(4))).collect();
/// let plan = plan_reads(&items, &Dialect::AKD);
/// assert_eq!(plan, [0..39, 39..78, 78..100]);
/// ```
#[must_use]
pub fn plan_reads(items: &[(ParameterAddress, Option<usize>)], dialect: &Dialect) -> Vec<Range<usize>> {
    pack(items.len(), dialect, |index| {
        let (address, octets) = items
            .get(index)
            .copied()
            .unwrap_or((ParameterAddress::value(0, 0), None));
        let data = octets.unwrap_or(UNKNOWN_OCTETS) * usize::from(address.elements.max(1));
        let answer = match address.attribute {
            super::Attribute::Description => 48,
            super::Attribute::Text => 2 + 16 * usize::from(address.elements.max(1)),
            _ => 2 + data + data % 2,
        };
        let values = match address.attribute {
            super::Attribute::Value => usize::from(address.elements.max(1)),
            _ => 0,
        };
        Cost {
            request: ADDRESS,
            response: answer.max(6),
            values,
        }
    })
}

/// Groups changes so that each group is one request. Each item is the number of value octets of one address; where the
/// number of values is limited, each octet counts as one.
#[must_use]
pub fn plan_changes(octets: &[usize], dialect: &Dialect) -> Vec<Range<usize>> {
    pack(octets.len(), dialect, |index| {
        let data = octets.get(index).copied().unwrap_or(0);
        Cost {
            request: ADDRESS + 2 + data + data % 2,
            response: 6,
            values: data,
        }
    })
}

/// What one address takes: octets of the request, octets of the response, values.
#[derive(Debug, Clone, Copy, Default)]
struct Cost {
    request: usize,
    response: usize,
    values: usize,
}

fn pack(items: usize, dialect: &Dialect, cost: impl Fn(usize) -> Cost) -> Vec<Range<usize>> {
    const HEAD: Cost = Cost {
        request: HEADER,
        response: HEADER,
        values: 0,
    };
    let mut groups = Vec::new();
    let (mut start, mut sum) = (0, HEAD);
    for index in 0..items {
        let one = cost(index);
        let full = index - start >= usize::from(dialect.max_parameters)
            || sum.request + one.request > dialect.max_block
            || sum.response + one.response > dialect.max_block
            || sum.values + one.values > usize::from(dialect.max_values);
        if full && index > start {
            groups.push(start..index);
            (start, sum) = (index, HEAD);
        }
        sum.request += one.request;
        sum.response += one.response;
        sum.values += one.values;
    }
    if start < items {
        groups.push(start..items);
    }
    groups
}

/// Splits `elements` elements of an array into addresses whose answers fit the largest block and the number of values of
/// one frame.
#[must_use]
pub fn split_array(
    pnu: u16,
    first: u16,
    elements: u16,
    octets: usize,
    dialect: &Dialect,
) -> Vec<ParameterAddress> {
    let fit =
        (dialect.max_block.saturating_sub(HEADER + 2) / octets.max(1)).clamp(1, usize::from(MAX_ELEMENTS));
    let step = u16::try_from(fit)
        .unwrap_or(u16::from(MAX_ELEMENTS))
        .min(dialect.max_values);
    let mut addresses = Vec::new();
    let mut done = 0;
    while done < elements {
        let part = step.min(elements - done);
        let Some(subindex) = first.checked_add(done) else {
            break;
        };
        addresses.push(ParameterAddress::values(
            pnu,
            subindex,
            u8::try_from(part).unwrap_or(MAX_ELEMENTS),
        ));
        done += part;
    }
    addresses
}
