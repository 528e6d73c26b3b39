//! The historic log (VLT 15-20 to 15-22): which of a few words changed, to what, and when.
//!
//! Source: FC 300 programming guide 15-2*, from memory. It begins again with each power on, which is ours.

use std::time::Duration;

use profile::catalogue::Part;
use profinet::Instant;

use super::Drive;
use crate::model::{Model, numbered};

/// Entries that are kept.
const LENGTH: usize = 50;

/// Words at most.
const MOST: usize = 8;

/// One change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Change {
    /// Number of the event.
    pub event: u8,
    /// Value of the word.
    pub value: u32,
    /// Since power on.
    pub at: Duration,
}

/// A word that is watched.
#[derive(Debug, Clone, Copy)]
struct Watched {
    event: u8,
    position: usize,
    last: Option<i64>,
}

/// The log, the newest entry first.
#[derive(Debug, Clone)]
pub(super) struct History {
    watched: Vec<Watched>,
    changes: [Change; LENGTH],
    /// Place of the newest.
    newest: usize,
}

impl History {
    pub fn new(model: &Model) -> Self {
        let words: [u16; MOST] = model.catalogue.part_numbers(Part::HistoryWord);
        let watched = (1..).zip(words).filter_map(|(event, number)| {
            Some(Watched {
                event,
                position: numbered(model.catalogue, number)?,
                last: None,
            })
        });
        Self {
            watched: watched.collect(),
            changes: [Change::default(); LENGTH],
            newest: 0,
        }
    }

    /// Returns an entry, 0 the newest.
    pub fn at(&self, place: usize) -> Change {
        let index = (self.newest + place) % LENGTH;
        let change = self.changes.get(index).filter(|_| place < LENGTH);
        change.copied().unwrap_or_default()
    }

    fn push(&mut self, change: Change) {
        self.newest = (self.newest + LENGTH - 1) % LENGTH;
        if let Some(place) = self.changes.get_mut(self.newest) {
            *place = change;
        }
    }
}

impl Drive {
    /// Looks which words have changed. Allocates nothing.
    pub(super) fn watch_history(&mut self) {
        for place in 0..self.history.watched.len() {
            let Some(watched) = self.history.watched.get(place).copied() else {
                return;
            };
            let value = self.element(watched.position, 0).unwrap_or(0);
            if watched.last == Some(value) {
                continue;
            }
            if let Some(known) = self.history.watched.get_mut(place) {
                known.last = Some(value);
            }
            if watched.last.is_some() {
                self.history.push(Change {
                    event: watched.event,
                    value: value as u32,
                    at: self.last - Instant::ZERO,
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::VLT;

    #[test]
    fn the_newest_fifty_changes_are_known() {
        let mut history = History::new(&VLT);
        for value in 1..=60 {
            history.push(Change {
                value,
                ..Change::default()
            });
        }
        let values: Vec<u32> = (0..52).map(|place| history.at(place).value).collect();
        let newest: Vec<u32> = (11..=60).rev().collect();
        assert_eq!(values, [&newest[..], &[0, 0]].concat());
    }
}
