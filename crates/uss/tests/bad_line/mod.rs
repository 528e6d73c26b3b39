//! Master, drives, and all that can go wrong between them.

mod drive;
mod job;

use std::time::Duration;

use profidrive_uss::{
    Address, Event, Layout, MAX_DATA, MAX_TELEGRAM, Master, MasterConfig, Parts, Protocol, Slave,
    SlaveConfig, SlaveId,
};
use profile::pkw::{Client, ClientTiming, MAX_BLOCK, PkwDialect, Server};

use drive::Named;
use job::Asked;

const BAUD: u32 = 19_200;
/// Octets of one telegram may come so far apart.
const GAP: Duration = Duration::from_millis(5);
/// The latest that an adapter hands a reply over, in milliseconds; on a line that echoes it is still waited for.
const LATEST: u64 = 150;
const LATEST_WITH_ECHO: u64 = 20;
/// How long a line is bad, and how long it is well then.
const BAD: Duration = Duration::from_secs(6);
const WELL: Duration = Duration::from_secs(7);
const DRIVES: usize = 2;

/// A small generator: the run follows from its seed.
pub struct Dice(u64);

impl Dice {
    pub fn roll(&mut self, below: u64) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) % below
    }

    pub fn chance(&mut self, percent: u64) -> bool {
        self.roll(100) < percent
    }

    fn millis(&mut self, below: u64) -> Duration {
        Duration::from_millis(self.roll(below))
    }
}

/// What a run is like.
#[derive(Debug, Clone, Copy)]
pub struct Run {
    pub seed: u64,
    pub protocol: Protocol,
    /// Telegrams in a hundred that are damaged or lost.
    pub damage: u64,
    /// Replies in a hundred that are handed over late.
    pub late: u64,
    /// Either side stops and starts again.
    pub stops: bool,
    /// The master hears itself.
    pub echo: bool,
    pub timing: ClientTiming,
}

#[derive(Debug, Default)]
pub struct Tally {
    pub answered: u32,
    pub texts: u32,
    pub refused: u32,
    pub failed: u32,
    /// Answers that were another's.
    pub wrong: u32,
    /// Answers from before the question.
    pub old: u32,
    /// Jobs that took longer than they may.
    pub late: u32,
    /// Values written more than once although no drive was off.
    pub twice: u32,
    /// Answers of each drive after the line was well again.
    pub at_the_end: [u32; DRIVES],
}

/// One drive at the line.
struct Station {
    slave: Slave,
    server: Server,
    drive: Named,
    off_until: Duration,
}

/// What the master's program knows of a drive.
struct Known {
    id: SlaveId,
    client: Client,
    asked: Option<Asked>,
}

pub struct Line {
    run: Run,
    dialect: PkwDialect,
    layout: Layout,
    dice: Dice,
    now: Duration,
    master: Master,
    known: Vec<Known>,
    stations: Vec<Station>,
    stopped_until: Duration,
    /// Octets on the wire: when, from whom (the master has the number `DRIVES`).
    wire: Vec<(Duration, usize, u8)>,
    /// Octets in the master's adapter.
    adapter: Vec<(Duration, u8)>,
    serial: u32,
    restarts: u32,
    tally: Tally,
}

impl Line {
    pub fn new(run: Run) -> Self {
        let dialect = match run.protocol {
            Protocol::Fc => PkwDialect::DANFOSS_FC,
            Protocol::Uss => PkwDialect::SIEMENS_USS,
        };
        let stations = (0..DRIVES).map(|place| Station {
            slave: slave(run.protocol, place),
            server: Server::new(dialect),
            drive: Named::new(place as u32 + 1),
            off_until: Duration::ZERO,
        });
        let (master, known) = program(run, dialect);
        Self {
            run,
            dialect,
            layout: layout(run.protocol),
            dice: Dice(run.seed | 1),
            now: Duration::from_secs(1),
            master,
            known,
            stations: stations.collect(),
            stopped_until: Duration::ZERO,
            wire: Vec::new(),
            adapter: Vec::new(),
            serial: 0,
            restarts: 0,
            tally: Tally::default(),
        }
    }

    /// Returns a bad time, then a good one.
    pub fn run(mut self) -> Tally {
        let begin = self.now;
        let well = begin + BAD;
        while self.now < well + WELL {
            if self.now >= well {
                self.run.damage = 0;
                self.run.late = 0;
                self.run.stops = false;
            }
            self.step(well);
        }
        if self.restarts == 0 {
            for station in &self.stations {
                let mut seen = station.drive.written.clone();
                seen.sort_unstable();
                seen.dedup();
                self.tally.twice += (station.drive.written.len() - seen.len()) as u32;
            }
        }
        self.tally
    }

    fn step(&mut self, well: Duration) {
        self.stop_and_start();
        self.serve();
        if self.now >= self.stopped_until {
            self.work(well);
        }
        self.advance();
        let due = self.wire.iter().take_while(|octet| octet.0 <= self.now).count();
        for (at, from, octet) in self.wire.drain(..due).collect::<Vec<_>>() {
            for (place, station) in self.stations.iter_mut().enumerate() {
                if place != from && at >= station.off_until {
                    station.slave.handle_octets(at, &[octet]);
                }
            }
        }
        let due = self
            .adapter
            .iter()
            .take_while(|octet| octet.0 <= self.now)
            .count();
        for (at, octet) in self.adapter.drain(..due) {
            // the line is not read while the program is stopped
            if at >= self.stopped_until {
                self.master.handle_octets(at, &[octet]);
            }
        }
        self.master.handle_timeout(self.now);
        for station in &mut self.stations {
            station.slave.handle_timeout(self.now);
        }
    }

    /// To the next time at which something is due.
    fn advance(&mut self) {
        let due = [
            self.wire.first().map(|octet| octet.0),
            self.adapter.first().map(|octet| octet.0),
        ];
        let due = due.into_iter().flatten();
        let due = due.chain(
            self.stations
                .iter()
                .filter_map(|station| station.slave.poll_timeout()),
        );
        let due = due.chain(self.master.poll_timeout().map(|due| due.max(self.stopped_until)));
        let soonest = self.now + Duration::from_micros(20);
        self.now = due
            .min()
            .unwrap_or(soonest)
            .clamp(soonest, self.now + Duration::from_millis(20));
    }

    fn stop_and_start(&mut self) {
        if !self.run.stops {
            return;
        }
        for place in 0..DRIVES {
            let station = &mut self.stations[place];
            // some steps to a telegram: now and then in a second
            if self.now < station.off_until || self.dice.roll(1500) != 0 {
                continue;
            }
            station.off_until = self.now + self.dice.millis(2500);
            if self.dice.chance(60) {
                station.slave = slave(self.run.protocol, place);
                station.server = Server::new(self.dialect);
                station.drive.now = self.now;
                station.drive.restart();
                self.restarts += 1;
            }
        }
        if self.now >= self.stopped_until && self.dice.roll(2000) == 0 {
            self.stopped_until = self.now + self.dice.millis(1200);
            if self.dice.chance(50) {
                // another program takes over and drops the old jobs
                let (master, known) = program(self.run, self.dialect);
                (self.master, self.known) = (master, known);
            }
        }
    }

    /// The drives answer.
    fn serve(&mut self) {
        let mut out = [0; MAX_TELEGRAM];
        for place in 0..DRIVES {
            let station = &mut self.stations[place];
            if self.now < station.off_until {
                continue;
            }
            station.drive.now = self.now;
            if let Some(request) = station.slave.poll_request() {
                let parts = self.layout.split(request.data).unwrap();
                let (mut block, mut data) = ([0; MAX_BLOCK], [0; MAX_DATA]);
                let pkw = match parts.pkw {
                    [] => Ok(0),
                    pkw => station.server.handle_block(pkw, &mut station.drive, &mut block),
                };
                if let Ok(length) = pkw {
                    let pzd = &[0x06, 0x03, 0, place as u8 + 1];
                    let parts = Parts {
                        pkw: &block[..length],
                        pzd,
                    };
                    let length = self.layout.join(parts, &mut data).unwrap();
                    station.slave.respond(&data[..length]).unwrap();
                }
            }
            if let Some(length) = self.stations[place].slave.poll_transmit(self.now, &mut out) {
                self.send(place, &out[..length]);
            }
        }
    }

    /// The program at the master's end.
    fn work(&mut self, well: Duration) {
        let now = self.now;
        let mut outcomes = Vec::new();
        while let Some(event) = self.master.poll_event() {
            let (Event::Reply(id) | Event::Lost(id)) = event;
            let place = self.known.iter().position(|known| known.id == id).unwrap();
            let known = &mut self.known[place];
            outcomes.push((
                place,
                match event {
                    Event::Lost(_) => known.client.lost(),
                    Event::Reply(_) => {
                        let parts = self.layout.split(self.master.reply(id)).unwrap();
                        assert_eq!(
                            parts.pzd.last(),
                            Some(&(place as u8 + 1)),
                            "process data of another drive"
                        );
                        known.client.handle(now, parts.pkw)
                    }
                },
            ));
        }
        for (place, known) in self.known.iter_mut().enumerate() {
            outcomes.push((place, known.client.handle_timeout(now)));
        }
        for (place, outcome) in outcomes {
            let Some(outcome) = outcome else { continue };
            let known = &mut self.known[place];
            let asked = known.asked.take().unwrap();
            let limit = (self.run.timing.reply + self.run.timing.round_trip) * 2 + Duration::from_millis(20);
            // a stopped program looks later
            self.tally.late += u32::from(!self.run.stops && asked.begun >= well && now - asked.begun > limit);
            let answers = self.tally.answered;
            asked.judge(
                outcome,
                &known.client,
                &self.stations[place].drive,
                &mut self.tally,
            );
            if now >= well {
                self.tally.at_the_end[place] += self.tally.answered - answers;
            }
        }
        for (number, known) in (1..).zip(&mut self.known) {
            if known.asked.is_none() && self.dice.chance(50) {
                self.serial += 1;
                let next = Asked::new(&mut self.dice, self.run.protocol, now, number, self.serial);
                next.start(&mut known.client);
                known.asked = Some(next);
            }
            let mut data = [0; MAX_DATA];
            let parts = Parts {
                pkw: known.client.request(now),
                pzd: &[0x04, 0x7C, 0, 0],
            };
            let length = self.layout.join(parts, &mut data).unwrap();
            self.master.set_data(known.id, &data[..length]).unwrap();
        }
        let mut out = [0; MAX_TELEGRAM];
        if let Some(length) = self.master.poll_transmit(now, &mut out) {
            self.send(DRIVES, &out[..length]);
        }
    }

    /// A telegram goes onto the wire, perhaps not as it was.
    fn send(&mut self, from: usize, octets: &[u8]) {
        let character = slave(self.run.protocol, 0).config().timing.character;
        let mut octets = octets.to_vec();
        if self.dice.chance(self.run.damage) {
            self.damage(&mut octets);
        }
        let late = from != DRIVES && self.dice.chance(self.run.late);
        let delay = if late {
            self.dice
                .millis(if self.run.echo { LATEST_WITH_ECHO } else { LATEST })
        } else {
            Duration::ZERO
        };
        // an adapter keeps the order and lets telegrams be distinguished
        let free = self
            .adapter
            .last()
            .map_or(Duration::ZERO, |last| last.0 + 2 * GAP);
        let begin = (self.now + delay).max(if late { free } else { Duration::ZERO });
        for (number, octet) in (1..).zip(octets) {
            self.wire.push((self.now + character * number, from, octet));
            if from != DRIVES || self.run.echo {
                self.adapter.push((begin.max(free) + character * number, octet));
            }
        }
        self.wire.sort_by_key(|octet| octet.0);
        self.adapter.sort_by_key(|octet| octet.0);
    }

    /// One kind of damage to a telegram, so that no check octet can be right by chance.
    fn damage(&mut self, octets: &mut Vec<u8>) {
        let length = octets.len() as u64;
        match self.dice.roll(5) {
            0 => octets.clear(),
            1 => octets.truncate(self.dice.roll(length) as usize),
            2 => drop(octets.remove(self.dice.roll(length) as usize)),
            3 => {
                let place = self.dice.roll(length) as usize;
                octets[place] ^= 1 << self.dice.roll(8);
            }
            _ => {
                let strange = self.dice.roll(256) as u8;
                let place = if self.dice.chance(50) { 0 } else { octets.len() };
                octets.insert(place, strange);
            }
        }
    }
}

const fn layout(protocol: Protocol) -> Layout {
    match protocol {
        Protocol::Fc => Layout::FC,
        Protocol::Uss => Layout::USS,
    }
}

fn address(protocol: Protocol, place: usize) -> Address {
    let number = place as u8 + 1;
    match protocol {
        Protocol::Fc => Address::fc(number).unwrap(),
        Protocol::Uss => Address::uss(number).unwrap(),
    }
}

fn slave(protocol: Protocol, place: usize) -> Slave {
    let number = place as u8 + 1;
    let config = match protocol {
        Protocol::Fc => SlaveConfig::fc(number, BAUD),
        Protocol::Uss => SlaveConfig::uss(number, BAUD),
    };
    Slave::new(SlaveConfig {
        timing: config.timing.with_gap(GAP),
        ..config
    })
}

/// Returns a master that has just started, with a client for each drive.
fn program(run: Run, dialect: PkwDialect) -> (Master, Vec<Known>) {
    let config = match run.protocol {
        Protocol::Fc => MasterConfig::fc(BAUD),
        Protocol::Uss => MasterConfig::uss(BAUD),
    };
    let mut master = Master::new(MasterConfig {
        timing: config.timing.with_gap(GAP),
        ..config
    });
    let known = (0..DRIVES).map(|place| Known {
        id: master.add(address(run.protocol, place), &[0; 12]).unwrap(),
        client: Client::new(dialect, run.timing),
        asked: None,
    });
    let known = known.collect();
    (master, known)
}
