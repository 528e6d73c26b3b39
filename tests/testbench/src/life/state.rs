//! The world of a life, and what must be true of it after each step.

use std::collections::VecDeque;
use std::fmt;
use std::time::Duration;

use client::Engine;
use network::host::Host;
use network::segment::{Pace, Segment, SegmentMedium};
use profinet::device::Stored;
use profinet::{Instant, MacAddress, Medium};
use virtual_drive::drive::Drive as VirtualDrive;
use virtual_drive::station::{Station, StationConfig, StationEvent};

use super::accident::Act;
use super::drives::{Disk, KINDS, Log, Place, drive_of, set_value, started, value_of};
use super::{Broken, LATE, OVERSHOOT, SECOND, Tally};
use crate::attack::Random;
use crate::ip;

pub(super) struct State {
    pub(super) seed: u64,
    pub(super) medium: Box<SegmentMedium>,
    pub(super) places: Vec<Place>,
    pub(super) plan: VecDeque<(Instant, Act)>,
    pub(super) random: Random,
    pub(super) killed: bool,
    /// When all was well again after the last accident; in the future while one lasts.
    pub(super) well: Instant,
    /// Highest speed that any axis was commanded, rpm.
    pub(super) commanded: f64,
    pub(super) tally: Tally,
    /// What happened: for whoever has to find out why something broke.
    pub(super) story: Vec<String>,
    pub(super) broken: Option<Broken>,
}

impl State {
    pub(super) fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut segment = Segment::new(seed);
        let first = random.below(3) as usize;
        let places = (0..=random.below(3) as usize).map(|number| {
            let kind = &KINDS[(first + number) % KINDS.len()];
            let last = number as u8 + 1;
            let mut config = StationConfig::new(kind.model, MacAddress([2, 0, 0, 0, 0, last]));
            config.network = Stored {
                name: format!("drive-{last}"),
                ip: ip(last),
                ..Stored::default()
            };
            let mut station = started(&config);
            if let Some((setting, values, _)) = kind.loss {
                let value = values[random.below(values.len() as u64) as usize];
                set_value(drive_of(&mut station), setting, value as i64);
            }
            Place {
                kind,
                id: segment.attach(station),
                config,
                disk: Disk::default(),
                powered: true,
                cut: false,
                values: [Log(Vec::new()), Log(Vec::new())],
                enabled: Log(Vec::new()),
                carried: Instant::ZERO,
                exchanging: false,
            }
        });
        let places = places.collect();
        Self {
            seed,
            medium: Box::new(SegmentMedium::new(segment, Pace::Virtual)),
            places,
            plan: VecDeque::new(),
            random,
            killed: false,
            well: Instant::ZERO,
            commanded: 0.0,
            tally: Tally::default(),
            story: Vec::new(),
            broken: None,
        }
    }

    pub(super) fn now(&self) -> Instant {
        Medium::now(&*self.medium)
    }

    pub(super) fn breaks(&mut self, what: String) {
        let at = self.now();
        let seed = self.seed;
        let story = std::mem::take(&mut self.story);
        self.broken.get_or_insert(Broken {
            seed,
            at,
            what,
            story,
        });
    }

    pub(super) fn note(&mut self, what: impl fmt::Debug) {
        let at = self.now() - Instant::ZERO;
        self.story.push(format!("{at:?} {what:?}"));
    }

    pub(super) fn time(&mut self, limit: Duration) -> Duration {
        Duration::from_micros(self.random.below(limit.as_micros() as u64))
    }

    pub(super) fn station(&mut self, place: usize) -> Option<&mut Host<Station>> {
        let place = &self.places[place];
        self.medium.segment_mut().station_mut::<Host<Station>>(place.id)
    }

    /// Lets one thing happen; `carried` when it is a client that carries the network.
    pub(super) fn go(&mut self, endpoint: &mut Engine, until: Instant, carried: bool) {
        let powered = self.places.iter().filter(|place| place.powered);
        let disks = powered.filter_map(|place| place.disk.writing.front());
        let until = disks.map(|(due, ..)| *due).fold(until, Instant::min);
        let until = until.max(self.now());
        let Ok(()) = Medium::step(&mut *self.medium, endpoint, until);
        for number in 0..self.places.len() {
            self.look(number, carried);
        }
    }

    /// Looks after a drive and compares it with what must be.
    pub(super) fn look(&mut self, number: usize, carried: bool) {
        let now = self.now();
        let latency = self.time(SECOND / 5);
        let place = &mut self.places[number];
        let Some(station) = self.medium.segment_mut().station_mut::<Host<Station>>(place.id) else {
            return;
        };
        let mut trouble = None;
        if let Some((due, save, ..)) = place.disk.writing.front()
            && *due <= now
        {
            let save = *save;
            let full = place.disk.full;
            station.endpoint_mut().report_save(now, save, !full);
            if let Some((_, _, text, pair)) = place.disk.writing.pop_front()
                && !full
            {
                place.disk.stored = Some(text.into_bytes());
                place.disk.pair = Some(pair);
                self.tally.saves += 1;
            }
        }
        while let Some(event) = station.endpoint_mut().poll_event() {
            match event {
                StationEvent::PersistParameters { text, save, .. } => {
                    // not what the drive has: a value may be written and not saved
                    let mut next = VirtualDrive::new(place.kind.model);
                    if let Err(error) = next.start_with(text.as_bytes()) {
                        trouble = Some(format!("what is saved cannot be used: {error}"));
                    }
                    let pair = place.kind.pair_of(&mut next);
                    let before = place.disk.writing.back().map_or(now, |(due, ..)| *due);
                    place.disk.writing.push_back((before + latency, save, text, pair));
                }
                StationEvent::PersistNetwork { save, .. } => {
                    station.endpoint_mut().report_network(now, save, true);
                }
                StationEvent::ParametersIgnored(error) => {
                    trouble = Some(format!("saved values cannot be used: {error}"));
                }
                _ => {}
            }
        }
        for (log, (_, parameter)) in place.values.iter_mut().zip(place.kind.pair) {
            log.note(now, value_of(drive_of(station), parameter));
        }
        place.enabled.note(now, drive_of(station).is_enabled());
        let speed = drive_of(station).axis().speed().abs();
        if speed > self.commanded * OVERSHOOT + 1.0 {
            trouble = Some(format!(
                "{speed} rpm, commanded was {} rpm at most",
                self.commanded
            ));
        }
        let exchanging = station.endpoint().device().is_exchanging();
        let watchdog = station.endpoint().device().watchdog().unwrap_or_default();
        if carried && !place.cut {
            place.carried = now;
        } else if exchanging && now > place.carried + watchdog + LATE {
            trouble = Some(format!(
                "exchanges data {:?} after its controller went, its watchdog is {watchdog:?}",
                now - place.carried
            ));
        }
        if place.exchanging && !exchanging {
            self.tally.connections += 1;
        }
        place.exchanging = exchanging;
        if let Some(trouble) = trouble {
            let what = format!("{}: {trouble}", place.config.network.name);
            self.breaks(what);
        }
    }
}
