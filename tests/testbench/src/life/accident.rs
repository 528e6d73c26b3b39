//! What happens to drives, network and clients.

use std::time::Duration;

use network::segment::Conditions;
use profinet::Instant;
use virtual_drive::drive::Drive as VirtualDrive;
use virtual_drive::store::{CrashingStorage, save};

use super::drives::{drive_of, set_value, started};
use super::state::State;
use super::{HIGHEST, LOWEST, SECOND, SETTLED};

/// What happens at a moment.
#[derive(Debug, Clone, Copy)]
pub(super) enum Act {
    Kill,
    Freeze(Duration),
    Cable {
        place: usize,
        out: bool,
    },
    Power {
        place: usize,
        off: bool,
    },
    Disk {
        place: usize,
        full: bool,
    },
    Line(Conditions),
    /// A person at the drive sets this value.
    Panel {
        place: usize,
        which: usize,
        value: i64,
    },
    Fault {
        place: usize,
    },
}

impl State {
    /// Decides what happens to the next client.
    pub(super) fn plan(&mut self) {
        let mut plan: Vec<(Instant, Act)> = Vec::new();
        for _ in 0..=self.random.below(4) {
            let begin = self.now() + self.time(SECOND * 12);
            let end = begin + self.time(SECOND * 4);
            let place = self.random.below(self.places.len() as u64) as usize;
            let which = self.random.below(2) as usize;
            let value = LOWEST + self.random.below((HIGHEST - LOWEST) as u64) as i64;
            let (first, last) = match self.random.below(9) {
                0 => (Act::Kill, None),
                1 => (Act::Freeze(end - begin), None),
                2 => (
                    Act::Cable { place, out: true },
                    Some(Act::Cable { place, out: false }),
                ),
                3 => (
                    Act::Power { place, off: true },
                    Some(Act::Power { place, off: false }),
                ),
                4 => (
                    Act::Disk { place, full: true },
                    Some(Act::Disk { place, full: false }),
                ),
                5 | 6 => (Act::Line(self.bad_line()), Some(Act::Line(Conditions::default()))),
                7 => (Act::Panel { place, which, value }, None),
                _ => (Act::Fault { place }, None),
            };
            plan.push((begin, first));
            plan.extend(last.map(|last| (end, last)));
            self.tally.accidents += 1;
        }
        plan.extend(self.plan.drain(..));
        plan.sort_by_key(|(at, _)| *at);
        self.plan = plan.into();
    }

    pub(super) fn bad_line(&mut self) -> Conditions {
        let mut share = |most: u64| self.random.below(most) as f64 / 1000.0;
        let (loss, duplicate, reorder) = (share(300), share(300), share(300));
        Conditions {
            loss,
            duplicate,
            reorder,
            reorder_by: self.time(Duration::from_millis(20)),
            delay: self.time(Duration::from_millis(2)),
            jitter: self.time(Duration::from_millis(5)),
        }
    }

    /// Takes the next act that is due.
    pub(super) fn due(&mut self) -> Option<Act> {
        let now = self.now();
        self.plan.front().filter(|(at, _)| *at <= now)?;
        self.plan.pop_front().map(|(_, act)| act)
    }

    pub(super) fn happen(&mut self, act: Act) {
        let now = self.now();
        self.well = now + SETTLED;
        self.note(act);
        match act {
            // of clients: not here
            Act::Kill | Act::Freeze(_) => {}
            Act::Cable { place, out } => {
                let id = self.places[place].id;
                self.places[place].cut = out;
                let segment = self.medium.segment_mut();
                if out {
                    segment.cut(id);
                } else {
                    segment.uncut(id);
                }
            }
            Act::Power { place, off: true } => self.power_off(place),
            Act::Power { place, off: false } => self.power_on(place),
            Act::Disk { place, full } => self.places[place].disk.full = full,
            Act::Line(conditions) => self.medium.segment_mut().set_all_conditions(conditions),
            Act::Panel { place, which, value } => {
                let number = self.places[place].kind.pair[which].1;
                if let Some(station) = self.station(place) {
                    set_value(drive_of(station), number, value);
                }
            }
            Act::Fault { place } => {
                let fault = self.places[place].kind.fault;
                if let Some(station) = self.station(place) {
                    drive_of(station).inject_fault(fault, false);
                }
            }
        }
    }

    /// The power goes in the middle of whatever is done.
    pub(super) fn power_off(&mut self, number: usize) {
        let place = &mut self.places[number];
        if !place.powered {
            return;
        }
        place.powered = false;
        place.exchanging = false;
        self.medium.segment_mut().detach(place.id);
        self.tally.power_cuts += 1;
        let disk = &mut place.disk;
        let Some((_, _, text, _)) = disk.writing.front().filter(|_| !disk.full) else {
            return;
        };
        let steps = self.random.below(text.len() as u64 + 8) as usize;
        let mut storage = CrashingStorage::new(disk.stored.take(), steps, self.random.below(u64::MAX));
        // it is killed on the way
        let _ = save(&mut storage, text);
        disk.stored = virtual_drive::store::load(&mut storage.restart(usize::MAX)).expect("readable");
    }

    pub(super) fn power_on(&mut self, number: usize) {
        let place = &mut self.places[number];
        if place.powered {
            return;
        }
        place.powered = true;
        place.config.parameters = place.disk.stored.clone();
        let mut station = started(&place.config);
        let found = place.kind.pair_of(drive_of(&mut station));
        let delivered = place.kind.pair_of(&mut VirtualDrive::new(place.kind.model));
        let last = place.disk.pair.unwrap_or(delivered);
        let begun = place.disk.writing.front().map(|(_, _, _, pair)| *pair);
        if found != last && Some(found) != begun {
            let what = format!(
                "{}: after the loss of power {found:?}, saved was {last:?}, begun {begun:?}",
                place.config.network.name
            );
            self.breaks(what);
            return;
        }
        place.disk.pair = place.disk.stored.is_some().then_some(found);
        place.disk.writing.clear();
        let inserted = self.medium.segment_mut().insert(place.id, station);
        if inserted.is_err() {
            self.breaks("the place of the drive is taken".to_owned());
        }
    }
}
