//! The life of some drives, their network and their clients, in virtual time: frames that are lost, doubled and overtaken,
//! cables that are pulled, clients that are killed or frozen, disks that are full, power that goes while a save is under way.
//! The same seed gives the same life. What must be true is compared with the drives themselves, after each step and after
//! each call of a client:
//!
//! - a value that was read is one that this parameter of this drive had meanwhile: no answer reaches another request;
//! - a value that is reported as written was there, one that is reported as saved survives the loss of power;
//! - what a drive finds after the loss of power is what was saved last or what was just being saved, never a mixture;
//! - a connection ends within its watchdog when the controller is away;
//! - no axis turns faster than it was ever commanded to, and none turns before it was commanded to;
//! - an axis without a controller comes to rest where its settings say so;
//! - what is reported as at rest is at rest;
//! - when all is repaired, everything can be read again.

use std::collections::VecDeque;
use std::fmt;
use std::ops::AddAssign;
use std::time::Duration;

use client::axis::Purpose;
use client::{Client, Engine};
use client::{Drive, DriveAddress, Error, ErrorKind, Network, Session, StopWay, Wait, Wire, WriteMode};
use futures::future::join_all;
use network::host::{Host, StationId};
use network::segment::{Conditions, Pace, Segment, SegmentMedium};
use profile::parameter::{Keep, ParameterAccess, SaveId};
use profinet::controller::ControllerConfig;
use profinet::device::Stored;
use profinet::{Instant, IpSuite, MacAddress, Medium};
use virtual_drive::drive::Drive as VirtualDrive;
use virtual_drive::model::{self, Model as Virtual};
use virtual_drive::station::{Station, StationConfig, StationEvent};
use virtual_drive::store::{CrashingStorage, save};

use crate::attack::Random;
use crate::shared::{On, Shared};
use crate::world::Gone;
use crate::{ip, running_on};

const SECOND: Duration = Duration::from_secs(1);
const CLIENT: MacAddress = MacAddress([2, 0, 0, 0, 1, 0]);
/// All axes are commanded to turn at this, rpm.
const SPEED: f64 = 600.0;
/// A controlled speed may exceed its setpoint by so much for a moment.
const OVERSHOOT: f64 = 1.1;
/// A connection may end so much later than its watchdog: frames under way, and the next look.
const LATE: Duration = Duration::from_millis(60);
/// From the last accident until a call has to succeed.
const SETTLED: Duration = Duration::from_secs(8);
/// How long an axis may need to come to rest without anybody.
const COASTING: Duration = Duration::from_secs(60);
/// Values that a pair of parameters gets, in steps of the drive.
const LOWEST: i64 = 100;
const HIGHEST: i64 = 30_000;

/// Something was not as it must be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Broken {
    /// Repeats it.
    pub seed: u64,
    /// Virtual time.
    pub at: Instant,
    /// What was expected, and what was there.
    pub what: String,
    /// What happened before.
    pub story: Vec<String>,
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for line in &self.story {
            writeln!(f, "{line}")?;
        }
        let at = self.at - Instant::ZERO;
        write!(f, "seed {} at {at:?}: {}", self.seed, self.what)
    }
}

/// What happened in some lives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Virtual time.
    pub time: Duration,
    /// Calls of clients that succeeded.
    pub answered: u64,
    /// Calls that failed.
    pub failed: u64,
    /// Motions that ended as they should.
    pub motions: u64,
    /// Saves that reached the disk.
    pub saves: u64,
    /// Accidents of all kinds.
    pub accidents: u64,
    /// Clients that were killed.
    pub kills: u64,
    /// Drives that lost their power.
    pub power_cuts: u64,
    /// Cyclic connections that ended.
    pub connections: u64,
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.time += other.time;
        self.answered += other.answered;
        self.failed += other.failed;
        self.motions += other.motions;
        self.saves += other.saves;
        self.accidents += other.accidents;
        self.kills += other.kills;
        self.power_cuts += other.power_cuts;
        self.connections += other.connections;
    }
}

/// What happens at a moment.
#[derive(Debug, Clone, Copy)]
enum Act {
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
    /// Somebody at the drive sets this value.
    Panel {
        place: usize,
        which: usize,
        value: i64,
    },
    Fault {
        place: usize,
    },
}

/// What a value was, and when.
#[derive(Debug)]
struct Log<T>(Vec<(Instant, T)>);

impl<T: PartialEq + Copy> Log<T> {
    fn note(&mut self, now: Instant, value: T) {
        if self.0.last().is_none_or(|(_, last)| *last != value) {
            self.0.push((now, value));
        }
    }

    /// True if it was this at some time from `from` on until `to`.
    fn had(&self, from: Instant, to: Instant, value: T) -> bool {
        let ends = self.0.iter().skip(1).map(|(end, _)| *end).chain([Instant::MAX]);
        let mut spans = self.0.iter().zip(ends);
        spans.any(|((begin, is), end)| *is == value && *begin <= to && end >= from)
    }
}

/// What is known of a model.
struct Kind {
    model: &'static Virtual,
    /// Two parameters that are free, and saved: how people and the vendor call them.
    pair: [(&'static str, u16); 2],
    /// Decimal places of both.
    decimals: usize,
    fault: u16,
    /// What decides what the drive does without its controller, the values that are tried, and those with which it stops.
    loss: Option<(u16, &'static [u64], &'static [i64])>,
}

const KINDS: [Kind; 3] = [
    Kind {
        model: &model::AKD,
        pair: [("USER.INT1", 2497), ("USER.INT2", 2498)],
        decimals: 0,
        fault: 439,
        loss: None,
    },
    Kind {
        model: &model::VLT,
        pair: [("3-61", 361), ("3-62", 362)],
        decimals: 2,
        fault: 14,
        // 8-04: off, freeze output, stop, stop and trip
        loss: Some((804, &[0, 1, 2, 5], &[2, 5])),
    },
    Kind {
        model: &model::VACON,
        pair: [("id502", 502), ("id503", 503)],
        decimals: 1,
        fault: 14,
        // ID 733: no action, warning, fault with stop, fault with coasting
        loss: Some((733, &[0, 1, 2, 3], &[2, 3])),
    },
];

type Pair = [i64; 2];

/// The disk behind a drive: one save at a time, each needs a while.
#[derive(Default)]
struct Disk {
    stored: Option<Vec<u8>>,
    /// The pair in it, where something is stored.
    pair: Option<Pair>,
    /// When each is stored, its number, text and pair.
    writing: VecDeque<(Instant, SaveId, String, Pair)>,
    full: bool,
}

struct Place {
    kind: &'static Kind,
    id: StationId,
    config: StationConfig,
    disk: Disk,
    powered: bool,
    cut: bool,
    values: [Log<i64>; 2],
    enabled: Log<bool>,
    /// When a client could last send to it.
    carried: Instant,
    exchanging: bool,
}

struct State {
    seed: u64,
    medium: Box<SegmentMedium>,
    places: Vec<Place>,
    plan: VecDeque<(Instant, Act)>,
    random: Random,
    killed: bool,
    /// When all was well again after the last accident; in the future while one lasts.
    well: Instant,
    /// Highest speed that any axis was commanded, rpm.
    commanded: f64,
    tally: Tally,
    /// What happened: for whoever has to find out why something broke.
    story: Vec<String>,
    broken: Option<Broken>,
}

/// Drives and the wire to them; each client has a clone.
#[derive(Clone)]
struct Life(Shared<State>);

fn drive_of(station: &mut Host<Station>) -> &mut VirtualDrive {
    station.endpoint_mut().drive_mut()
}

fn value_of(drive: &mut VirtualDrive, number: u16) -> i64 {
    let parameter = drive.model().numbered(number).expect("known");
    let index = parameter.base.unwrap_or(0);
    let pnu = parameter.pnu;
    let raw = ParameterAccess::read(drive, pnu, index).expect("readable");
    raw as i64
}

fn set_value(drive: &mut VirtualDrive, number: u16, value: i64) {
    let parameter = drive.model().numbered(number).expect("known");
    let index = parameter.base.unwrap_or(0);
    ParameterAccess::write(drive, parameter.pnu, index, value as u64, Keep::Volatile).expect("taken");
}

impl Kind {
    fn pair_of(&self, drive: &mut VirtualDrive) -> Pair {
        self.pair.map(|(_, number)| value_of(drive, number))
    }

    /// Returns true if the drive, by its settings, stops without a controller.
    fn stops(&self, drive: &mut VirtualDrive) -> bool {
        self.loss
            .is_none_or(|(number, _, stopping)| stopping.contains(&value_of(drive, number)))
    }
}

impl State {
    fn new(seed: u64) -> Self {
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

    fn now(&self) -> Instant {
        Medium::now(&*self.medium)
    }

    fn breaks(&mut self, what: String) {
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

    fn note(&mut self, what: impl fmt::Debug) {
        let at = self.now() - Instant::ZERO;
        self.story.push(format!("{at:?} {what:?}"));
    }

    fn time(&mut self, limit: Duration) -> Duration {
        Duration::from_micros(self.random.below(limit.as_micros() as u64))
    }

    fn station(&mut self, place: usize) -> Option<&mut Host<Station>> {
        let place = &self.places[place];
        self.medium.segment_mut().station_mut::<Host<Station>>(place.id)
    }

    /// Decides what happens to the next client.
    fn plan(&mut self) {
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

    fn bad_line(&mut self) -> Conditions {
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
    fn due(&mut self) -> Option<Act> {
        let now = self.now();
        self.plan.front().filter(|(at, _)| *at <= now)?;
        self.plan.pop_front().map(|(_, act)| act)
    }

    fn happen(&mut self, act: Act) {
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
    fn power_off(&mut self, number: usize) {
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

    fn power_on(&mut self, number: usize) {
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

    /// Lets one thing happen; `carried` when it is a client that carries the network.
    fn go(&mut self, endpoint: &mut Engine, until: Instant, carried: bool) {
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
    fn look(&mut self, number: usize, carried: bool) {
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

/// The drive as it comes up.
fn started(config: &StationConfig) -> Box<Host<Station>> {
    let mut station = Station::new(config.clone());
    station.confirm_saves();
    Box::new(Host::new(station))
}

impl Wire for Life {
    type Error = Gone;

    fn now(&self) -> Instant {
        self.0.borrow().now()
    }

    fn step(&mut self, client: &mut Engine, until: Instant) -> Result<(), Gone> {
        loop {
            let due = self.0.borrow_mut().due();
            match due {
                Some(Act::Kill) => {
                    let mut state = self.0.borrow_mut();
                    state.killed = true;
                    state.tally.kills += 1;
                }
                Some(Act::Freeze(time)) => self.pass(time),
                Some(act) => self.0.borrow_mut().happen(act),
                None => break,
            }
        }
        let mut state = self.0.borrow_mut();
        // nothing is to be learned from what comes after
        if state.killed || state.broken.is_some() {
            return Err(Gone);
        }
        let next = state.plan.front().map_or(until, |(at, _)| until.min(*at));
        state.go(client, next, true);
        Ok(())
    }
}

impl Life {
    /// Lets time pass without a client.
    fn pass(&self, time: Duration) {
        let until = Wire::now(self) + time;
        let idle = ControllerConfig::new(CLIENT, IpSuite::NONE, "idle", 99);
        let mut idle = Engine::new(Client::new(idle));
        let mut state = self.0.borrow_mut();
        // whoever is frozen or gone has to begin anew
        state.well = state.well.max(until + SETTLED);
        while state.now() < until && state.broken.is_none() {
            while let Some(act) = state.due() {
                state.happen(act);
            }
            let next = state.plan.front().map_or(until, |(at, _)| until.min(*at));
            state.go(&mut idle, next, false);
        }
    }

    fn client(&self, number: u64) -> On<Self> {
        self.0.borrow_mut().killed = false;
        let seed = self.0.borrow().seed ^ number << 56;
        let mut config = ControllerConfig::new(CLIENT, ip(200), "client", seed);
        config.client_port = 0xC000 + number as u16 * 0x100;
        On::new(Network::on(self.clone(), config))
    }

    fn below(&self, limit: usize) -> usize {
        self.0.borrow_mut().random.below(limit as u64) as usize
    }

    fn time(&self, limit: Duration) -> Duration {
        self.0.borrow_mut().time(limit)
    }

    fn breaks(&self, what: String) {
        self.0.borrow_mut().breaks(what);
    }

    /// Takes the end of a call to a drive. One that `must` succeed fails only while not all is well.
    fn ended<T>(
        &self,
        call: &str,
        place: usize,
        begun: Instant,
        must: bool,
        result: Result<T, Error>,
    ) -> Option<T> {
        let mut state = self.0.borrow_mut();
        let report = match &result {
            Ok(_) => format!("drive-{}: {call}", place + 1),
            Err(error) => format!("drive-{}: {call}: {error}", place + 1),
        };
        state.note(&report);
        match result {
            Ok(value) => {
                state.tally.answered += 1;
                Some(value)
            }
            Err(error) => {
                state.tally.failed += 1;
                let well = begun > state.well && !state.killed && state.plan.is_empty();
                let defect = matches!(error, Error::Misuse(_)) || error.kind() == ErrorKind::Internal;
                if defect || must && well {
                    state.breaks(report);
                }
                None
            }
        }
    }
}

/// A client with the drives that it has found.
struct Caller<'a> {
    life: &'a Life,
    network: On<Life>,
    drives: Vec<Option<Drive>>,
}

impl Caller<'_> {
    fn find(&mut self, place: usize) -> Option<Drive> {
        if self.drives[place].is_none() {
            let address: DriveAddress = format!("drive-{}", place + 1).parse().expect("an address");
            let begun = self.network.now();
            let found = self.network.find(&address).wait();
            self.drives[place] = self.life.ended("find", place, begun, true, found);
        }
        self.drives[place].clone()
    }

    /// Reads the pairs of all drives at the same time.
    fn read(&mut self) {
        let places: Vec<usize> = (0..self.drives.len()).collect();
        let mut calls = Vec::new();
        for place in places {
            let Some(drive) = self.find(place) else { continue };
            let kind = self.life.0.borrow().places[place].kind;
            for (which, (name, _)) in kind.pair.into_iter().enumerate() {
                let (mut session, mut drive) = (Session::clone(&self.network), drive.clone());
                let life = self.life;
                calls.push(async move {
                    let begun = session.now();
                    let selection = drive.select(name).expect("known");
                    let answer = session.read_one(&mut drive, &selection).await;
                    let Some(reading) = life.ended("read", place, begun, true, answer) else {
                        return;
                    };
                    let raw = reading.raw().expect("a number");
                    let ended = session.now();
                    let had = life.0.borrow().places[place].values[which].had(begun, ended, raw);
                    if !had {
                        life.breaks(format!(
                            "{}: {name} was read as {raw}, which it never was then",
                            drive.label()
                        ));
                    }
                });
            }
        }
        join_all(calls).wait();
    }

    fn write(&mut self, place: usize, mode: WriteMode) {
        let Some(mut drive) = self.find(place) else { return };
        let kind = self.life.0.borrow().places[place].kind;
        let value = LOWEST + self.life.below((HIGHEST - LOWEST) as usize) as i64;
        let text = |name: &str| {
            let scale = 10_i64.pow(kind.decimals as u32);
            let (whole, part) = (value / scale, value % scale);
            let text = match kind.decimals {
                0 => format!("{name}={whole}"),
                decimals => format!("{name}={whole}.{part:0decimals$}"),
            };
            text.parse().expect("an assignment")
        };
        let assignments = kind.pair.map(|(name, _)| text(name));
        let begun = self.network.now();
        let result = self.network.write(&mut drive, &assignments, mode).wait();
        let result = result.and_then(|set| set.accepted());
        // what the disk refuses, the drive refuses
        let refused = mode == WriteMode::Save && matches!(result, Err(Error::Refused { .. }));
        let is_full = self.life.0.borrow().places[place].disk.full;
        if refused && is_full || self.life.ended("write", place, begun, true, result).is_none() {
            return;
        }
        let ended = self.network.now();
        let state = self.life.0.borrow();
        let values = &state.places[place].values;
        let written = values.iter().all(|log| log.had(begun, ended, value));
        // the panel may have changed one of both
        let saved = state.places[place].disk.pair;
        let saved = saved.is_some_and(|pair| pair.contains(&value));
        drop(state);
        if !written {
            self.life.breaks(format!(
                "{}: {value} was reported as written and never there",
                drive.label()
            ));
        }
        if mode == WriteMode::Save && !saved {
            self.life.breaks(format!(
                "{}: {value} was reported as saved and is not on the disk",
                drive.label()
            ));
        }
    }

    fn is_enabled(&mut self, place: usize) {
        let Some(mut drive) = self.find(place) else { return };
        let begun = self.network.now();
        let answer = self.network.is_enabled(&mut drive).wait();
        let Some(Some(enabled)) = self.life.ended("is enabled", place, begun, true, answer) else {
            return;
        };
        let ended = self.network.now();
        let had = self.life.0.borrow().places[place]
            .enabled
            .had(begun, ended, enabled);
        if !had {
            self.life.breaks(format!(
                "{}: enabled {enabled}, which it never was then",
                drive.label()
            ));
        }
    }

    /// The drive that is reported as at rest.
    fn rests(&self, place: usize, after: &str) {
        let mut state = self.life.0.borrow_mut();
        let Some(station) = state.station(place) else {
            return;
        };
        let drive = drive_of(station);
        let (speed, enabled) = (drive.axis().speed(), drive.is_enabled());
        if speed.abs() > 1.0 || enabled {
            state.breaks(format!("{speed} rpm, enabled {enabled} after {after}"));
        }
    }

    fn run(&mut self, place: usize) {
        let Some(mut drive) = self.find(place) else { return };
        let time = self.life.time(SECOND * 4);
        let leaves = self.life.below(3) == 0;
        self.life.0.borrow_mut().commanded = SPEED;
        let network = &mut self.network;
        let motion = async {
            let mut axis = network.take_axis(&mut drive, running_on(Purpose::Speed)).await?;
            axis.ready_or_fault().await?;
            let seen = axis.status().and_then(|status| status.view.seen);
            if seen.is_some_and(|seen| seen.fault()) {
                axis.acknowledge().await?;
            }
            let mut enabled = axis.enable().await?;
            enabled.reach_speed(SPEED, None).await?;
            enabled.keep_speed(SPEED, time).await?;
            if leaves {
                return Ok(false);
            }
            enabled.disable().await?;
            axis.release().await.map(|()| true)
        };
        let begun = Wire::now(self.life);
        let result: Result<bool, Error> = motion.wait();
        let Some(released) = self.life.ended("run", place, begun, false, result) else {
            return;
        };
        self.life.0.borrow_mut().tally.motions += 1;
        if released {
            self.rests(place, "the axis was released");
        }
    }

    fn stop(&mut self, place: usize) {
        let Some(mut drive) = self.find(place) else { return };
        let begun = self.network.now();
        let outcome = self
            .network
            .stop_drive(&mut drive, StopWay::Disable, SECOND * 15)
            .wait();
        let outcome = self.life.ended("stop", place, begun, false, outcome);
        if outcome.is_some_and(|outcome| outcome.at_rest) {
            self.rests(place, "it was reported to be at rest");
        }
    }

    fn act(&mut self) {
        let place = self.life.below(self.drives.len());
        match self.life.below(8) {
            0 | 1 => self.read(),
            2 => self.write(place, WriteMode::Write),
            3 => self.write(place, WriteMode::Save),
            4 => self.is_enabled(place),
            5 | 6 => self.run(place),
            _ => self.stop(place),
        }
        let pause = self.life.time(SECOND);
        // a killed client has no time left
        let _ = self.network.pass(pause).wait();
    }
}

/// Lives through everything that this seed brings.
///
/// # Errors
/// What was not as it must be.
pub fn live(seed: u64) -> Result<Tally, Broken> {
    let life = Life(Shared::new(State::new(seed)));
    let count = life.0.borrow().places.len();
    let none = || vec![None; count];
    let clients = 1 + life.below(3) as u64;
    for number in 0..clients {
        life.0.borrow_mut().plan();
        let network = life.client(number);
        let mut caller = Caller {
            life: &life,
            network,
            drives: none(),
        };
        for _ in 0..3 + life.below(5) {
            caller.act();
            let state = life.0.borrow();
            if state.killed || state.broken.is_some() {
                break;
            }
        }
        drop(caller);
        life.pass(life.time(SECOND * 3));
    }
    // all is repaired, and no client is there
    life.pass(SECOND * 20);
    let stops = |place: usize| {
        let mut state = life.0.borrow_mut();
        let kind = state.places[place].kind;
        state
            .station(place)
            .is_some_and(|station| kind.stops(drive_of(station)))
    };
    let stopping: Vec<usize> = (0..count).filter(|place| stops(*place)).collect();
    life.pass(COASTING);
    let network = life.client(clients);
    let mut caller = Caller {
        life: &life,
        network,
        drives: none(),
    };
    for place in stopping {
        caller.rests(place, "a minute without a controller");
    }
    life.0.borrow_mut().well = Instant::ZERO;
    caller.read();
    for place in 0..count {
        caller.write(place, WriteMode::Save);
    }
    caller.read();
    drop(caller);
    let mut state = life.0.borrow_mut();
    state.tally.time = state.now() - Instant::ZERO;
    match state.broken.take() {
        Some(broken) => Err(broken),
        None => Ok(state.tally),
    }
}
