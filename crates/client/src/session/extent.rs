//! How many elements a parameter of a drive has: makes differ, and a read past the end is refused as a whole.

use profile::notation::Notation;
use profile::parameter::Identifier;

use super::Session;
use crate::{Drive, Error, Wire};
use profile::value::Selection;

/// What one request can carry: a parameter that has an element behind that is read up to here.
const MOST: u16 = 234;

impl<M: Wire> Session<M> {
    /// The elements of these parameters, 0 for one that is not there: as the tables say, else as the drive describes
    /// itself, else found out by asking for single elements.
    pub(super) fn extents(&mut self, drive: &Drive, pnus: &[u16]) -> Result<Vec<u16>, Error> {
        let row = |pnu| drive.model.catalogue.and_then(|tables| tables.by_pnu(pnu));
        if drive.model.learned_or_none().is_none() {
            let rows = pnus.iter().map(|&pnu| row(pnu));
            return Ok(rows.map(|row| row.map_or(0, |row| row.elements.max(1))).collect());
        }
        let described = self.descriptions(drive, pnus)?;
        let mut extents = Vec::with_capacity(pnus.len());
        for (&pnu, description) in pnus.iter().zip(described) {
            extents.push(match description {
                Some(one) if one.identifier.has(Identifier::ARRAY) => one.elements.max(1),
                Some(_) => 1,
                None => probed(|element| self.has_element(drive, pnu, element))?,
            });
        }
        Ok(extents)
    }

    /// Whole parameters by number, with all their elements; those that are not there are left out.
    pub(super) fn whole(&mut self, drive: &Drive, pnus: &[u16]) -> Result<Vec<Selection>, Error> {
        let extents = self.extents(drive, pnus)?;
        let there = pnus.iter().zip(extents).filter(|(_, extent)| *extent > 0);
        let selections = there.map(|(&pnu, extent)| match drive.parameters.at(pnu, 0) {
            Some(row) => Selection::of(row, drive.parameters.notation()),
            None => Selection {
                count: extent,
                indexed: extent > 1,
                ..Selection::number(pnu, Notation::Name)
            },
        });
        Ok(selections.collect())
    }

    fn has_element(&mut self, drive: &Drive, pnu: u16, element: u16) -> Result<bool, Error> {
        let selection = Selection {
            first: element,
            indexed: true,
            ..Selection::number(pnu, Notation::Name)
        };
        let answers = self.read_plain(drive, &[selection])?;
        Ok(answers.first().is_some_and(Result::is_ok))
    }
}

/// Doubles the element asked for until one is refused, then halves what is left between.
fn probed<E>(mut has: impl FnMut(u16) -> Result<bool, E>) -> Result<u16, E> {
    let (mut there, mut missing) = (0, 1);
    while has(missing - 1)? {
        there = missing;
        if there == MOST {
            return Ok(MOST);
        }
        missing = missing.saturating_mul(2).min(MOST);
    }
    while missing - there > 1 {
        let middle = u16::midpoint(there, missing);
        if has(middle - 1)? {
            there = middle;
        } else {
            missing = middle;
        }
    }
    Ok(there)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_of_any_size_are_found_out_in_few_requests() {
        for size in 0..300_u16 {
            let mut asked = 0;
            let found = probed(|element| {
                asked += 1;
                Ok::<_, ()>(element < size)
            });
            assert_eq!(found, Ok(size.min(MOST)));
            assert!(asked <= 16, "{asked} for {size}");
        }
        assert_eq!(probed(|_| Err("gone")), Err("gone"));
    }
}
