//! What differs between two backups.

use super::{Backup, key};
use crate::Refusal;
use profile::value::Reading;

/// One side of a difference.
#[derive(Debug, Clone, PartialEq)]
pub enum Side {
    /// The parameter is not there.
    Missing,
    /// The drive refused the read.
    Refused(Refusal),
    /// The value.
    Value(Reading),
}

/// A parameter whose values differ.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The first side.
    pub left: Side,
    /// The second side.
    pub right: Side,
}

impl Difference {
    /// Returns a side that has a value.
    #[must_use]
    pub const fn reading(&self) -> Option<&Reading> {
        match (&self.left, &self.right) {
            (Side::Value(reading), _) | (_, Side::Value(reading)) => Some(reading),
            _ => None,
        }
    }

    /// Returns the name of the parameter, where known.
    #[must_use]
    pub fn name(&self) -> Option<&'static str> {
        self.reading().and_then(|reading| reading.name)
    }
}

/// Every parameter that is not the same on both sides, by number. Values count as they are in units: when two drives
/// scale the same speed in different steps, the speeds are compared.
#[must_use]
pub fn compare(left: &Backup, right: &Backup) -> Vec<Difference> {
    let mut keys: Vec<_> = left.readings.iter().chain(&right.readings).map(key).collect();
    keys.sort_unstable();
    keys.dedup();
    keys.into_iter()
        .filter_map(|(pnu, index)| {
            let (a, b) = (left.reading(pnu, index), right.reading(pnu, index));
            if let (Some(a), Some(b)) = (a, b)
                && same(left, a, right, b)
            {
                return None;
            }
            Some(Difference {
                left: side(left, pnu, index),
                right: side(right, pnu, index),
            })
        })
        .collect()
}

fn side(backup: &Backup, pnu: u16, index: Option<u16>) -> Side {
    if let Some(reading) = backup.reading(pnu, index) {
        return Side::Value(reading.clone());
    }
    let refused = |refusal: &&Refusal| {
        refusal.shown.pnu == pnu && (refusal.shown.index == index || refusal.shown.index.is_none())
    };
    backup
        .refused
        .iter()
        .find(refused)
        .map_or(Side::Missing, |refusal| Side::Refused(*refusal))
}

fn same(left: &Backup, a: &Reading, right: &Backup, b: &Reading) -> bool {
    let parameter = right.parameters.at(b.pnu, b.index.unwrap_or(0));
    match (a.raw(), b.raw(), parameter) {
        (Some(raw), Some(other), Some(parameter)) => {
            right
                .parameters
                .converted(parameter, raw, &left.parameters.scaling)
                == other
        }
        _ => a.octets == b.octets,
    }
}
