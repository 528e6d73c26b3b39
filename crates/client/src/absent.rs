//! What a drive has reported not to have.

use std::collections::{BTreeMap, BTreeSet};
use std::net::Ipv4Addr;
use std::time::Duration;

use profile::parameter::ErrorNumber;
use profile::value::{Reading, Selection};
use profinet::{Instant, MacAddress};

use crate::{Drive, Refusal};

/// After this time a drive is asked once more: it may have another firmware by now.
const AGE: Duration = Duration::from_secs(600);

/// Drives that are known at most: stations that are not there can be reported by anyone on the network.
const DRIVES: usize = 1024;

/// The station, and what it is: another one may take its place.
type Key = (MacAddress, Ipv4Addr, u16, u16);

/// Parameters that drives refused as not there. Whoever leaves out what a drive does not have does not read them again.
#[derive(Debug, Default)]
pub(crate) struct Absent(BTreeMap<Key, OfDrive>);

/// Parameters that were read to see whether a drive has them.
#[derive(Debug, Default)]
pub(crate) struct Looks(BTreeMap<Ipv4Addr, BTreeSet<u16>>);

impl Looks {
    /// Notes what is read of the drive at an address; another one makes room for it.
    pub fn note(&mut self, drive: Ipv4Addr, pnus: impl Iterator<Item = u16>) {
        if self.0.len() >= DRIVES && !self.0.contains_key(&drive) {
            self.0.pop_first();
        }
        self.0.entry(drive).or_default().extend(pnus);
    }

    /// Returns whether this parameter of the drive at this address was read so.
    pub fn has(&self, drive: Ipv4Addr, pnu: u16) -> bool {
        self.0.get(&drive).is_some_and(|known| known.contains(&pnu))
    }
}

#[derive(Debug)]
struct OfDrive {
    /// Number, first element and count, as they were requested.
    selections: BTreeSet<(u16, u16, u16)>,
    /// When the first one was noted.
    since: Instant,
}

fn of(drive: &Drive) -> Key {
    let station = &drive.station;
    (
        station.mac,
        station.ip.address,
        station.vendor_id,
        station.device_id,
    )
}

const fn key(selection: &Selection) -> (u16, u16, u16) {
    (selection.pnu, selection.first, selection.count)
}

impl Absent {
    /// Returns what of this may be there.
    pub fn left(&mut self, drive: &Drive, selections: &[Selection], now: Instant) -> Vec<Selection> {
        self.0.retain(|_, known| now.saturating_since(known.since) < AGE);
        let known = self.0.get(&of(drive));
        let may_be_there =
            |selection: &&Selection| known.is_none_or(|known| !known.selections.contains(&key(selection)));
        selections.iter().filter(may_be_there).copied().collect()
    }

    /// Notes what was refused as not there. A drive that refuses everything has another reason than that.
    pub fn note(
        &mut self,
        drive: &Drive,
        selections: &[Selection],
        answers: &[Result<Reading, Refusal>],
        now: Instant,
    ) {
        if answers.iter().all(Result::is_err) {
            return;
        }
        for selection in selections {
            let own = selection.first..selection.first.saturating_add(selection.count);
            let is = |pnu, index: Option<u16>| {
                selection.pnu == pnu && own.contains(&index.unwrap_or(selection.first))
            };
            let there = answers
                .iter()
                .flatten()
                .any(|reading| is(reading.pnu, reading.index));
            let refused = answers
                .iter()
                .filter_map(|answer| answer.as_ref().err())
                .any(|refusal| {
                    refusal.channel.is_none()
                        && refusal.number == ErrorNumber::UNKNOWN_PARAMETER
                        && is(refusal.shown.pnu, refusal.shown.index)
                });
            if refused && !there {
                self.known(of(drive), now).selections.insert(key(selection));
            }
        }
    }

    /// Returns what is known of a drive; the one that is known for the longest time makes room for it.
    fn known(&mut self, drive: Key, now: Instant) -> &mut OfDrive {
        if self.0.len() >= DRIVES && !self.0.contains_key(&drive) {
            let oldest = self.0.iter().min_by_key(|(_, known)| known.since);
            let oldest = oldest.map(|(key, _)| *key);
            oldest.map(|key| self.0.remove(&key));
        }
        self.0.entry(drive).or_insert_with(|| OfDrive {
            selections: BTreeSet::new(),
            since: now,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_drive_known_longest_makes_room() {
        let mut absent = Absent::default();
        let station = |number: usize| {
            let address = Ipv4Addr::from(u32::try_from(number).unwrap());
            (MacAddress([2, 0, 0, 0, 0, 1]), address, 1, 2)
        };
        for number in 0..=DRIVES {
            absent.known(
                station(number),
                Instant::ZERO + Duration::from_secs(number as u64),
            );
        }
        assert_eq!(absent.0.len(), DRIVES);
        assert!(!absent.0.contains_key(&station(0)));
        // one that is known already needs no room
        absent.known(station(1), Instant::ZERO);
        assert!(absent.0.contains_key(&station(1)) && absent.0.len() == DRIVES);
    }

    #[test]
    fn drives_that_were_looked_at_are_bounded() {
        let mut looks = Looks::default();
        let drive = |number: u32| Ipv4Addr::from(number);
        for number in 0..=u32::try_from(DRIVES).unwrap() {
            looks.note(drive(number), [927, 928].into_iter());
        }
        assert_eq!(looks.0.len(), DRIVES);
        assert!(!looks.has(drive(0), 927) && looks.has(drive(1), 928) && !looks.has(drive(1), 929));
        // one that is known already needs no room
        looks.note(drive(1), std::iter::once(929));
        assert!(looks.has(drive(2), 927) && looks.has(drive(1), 929));
    }
}
