//! How many elements a parameter of a drive has: makes differ, and a read past the end is refused as a whole.

use profile::notation::Notation;
use profile::parameter::Identifier;

use super::Session;
use crate::{Drive, Error};
use profile::value::Selection;

/// What one request can carry: a parameter that has an element behind that is read up to here.
const MOST: u16 = 234;

impl Session {
    /// Returns the elements of these parameters, 0 for one that is not there: as the tables say, else as the drive
    /// describes itself, else found out by requesting single elements.
    pub(super) async fn extents(&mut self, drive: &Drive, pnus: &[u16]) -> Result<Vec<u16>, Error> {
        let row = |pnu| drive.model.catalogue.and_then(|tables| tables.by_pnu(pnu));
        if drive.model.learned_or_none().is_none() {
            let rows = pnus.iter().map(|&pnu| row(pnu));
            return Ok(rows.map(|row| row.map_or(0, |row| row.elements.max(1))).collect());
        }
        let described = self.descriptions(drive, pnus).await?;
        let mut extents = Vec::with_capacity(pnus.len());
        for (&pnu, description) in pnus.iter().zip(described) {
            extents.push(match description {
                Some(one) if one.identifier.has(Identifier::ARRAY) => one.elements.max(1),
                Some(_) => 1,
                None => {
                    let mut search = Search::new();
                    while let Some(element) = search.next() {
                        search.take(self.has_element(drive, pnu, element).await?);
                    }
                    search.there
                }
            });
        }
        Ok(extents)
    }

    /// Whole parameters by number, with all their elements; those that are not there are left out.
    pub(super) async fn whole(&mut self, drive: &Drive, pnus: &[u16]) -> Result<Vec<Selection>, Error> {
        let extents = self.extents(drive, pnus).await?;
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

    async fn has_element(&mut self, drive: &Drive, pnu: u16, element: u16) -> Result<bool, Error> {
        let selection = Selection {
            first: element,
            indexed: true,
            ..Selection::number(pnu, Notation::Name)
        };
        let answers = self.read_plain(drive, &[selection]).await?;
        Ok(answers.first().is_some_and(Result::is_ok))
    }
}

/// A search for the number of elements: it doubles the element requested until one is missing, then halves what is left
/// between.
struct Search {
    /// So many are there.
    there: u16,
    /// So many are not, or were not requested yet.
    most: u16,
    halving: bool,
}

impl Search {
    const fn new() -> Self {
        Self {
            there: 0,
            most: 1,
            halving: false,
        }
    }

    /// Returns the element to request next; `None` once their number is known.
    const fn next(&self) -> Option<u16> {
        if self.there >= MOST || self.halving && self.most - self.there <= 1 {
            None
        } else if self.halving {
            Some(u16::midpoint(self.there, self.most) - 1)
        } else {
            Some(self.most - 1)
        }
    }

    /// Takes the answer for [`next`](Self::next).
    fn take(&mut self, is_there: bool) {
        let number = self.next().map_or(self.there, |element| element + 1);
        if is_there {
            self.there = number;
            if !self.halving {
                self.most = number.saturating_mul(2).min(MOST);
            }
        } else {
            self.most = number;
            self.halving = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_of_any_size_are_found_out_in_few_requests() {
        for size in 0..300_u16 {
            let mut search = Search::new();
            let mut asked = 0;
            while let Some(element) = search.next() {
                asked += 1;
                assert!(asked <= 16, "{asked} for {size}");
                search.take(element < size);
            }
            assert_eq!(search.there, size.min(MOST));
        }
    }
}
