//! Virtual drives behind slaves of a serial line, in virtual time, with everything a line does to octets.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::time::Duration;

use client::{Drive, DriveAddress, Engine, Error, LineConfig, Network, Wait, Wire};
use profinet::Instant;
use uss::{Protocol, SlaveConfig};
use virtual_drive::model::{self, Model as Virtual};
use virtual_drive::serial::{SerialConfig, SerialStation};

use crate::shared::{On, Shared};

/// What a line does to the octets of both sides.
#[derive(Clone, Copy, Default)]
pub struct Line {
    /// Nothing arrives.
    pub cut: bool,
    /// The client hears itself.
    pub echo: bool,
    /// So many telegrams in a hundred lose their last octets.
    pub halved: u64,
    /// So many have an octet changed.
    pub changed: u64,
    /// So many have noise in front.
    pub noisy: u64,
    /// The parameter channel of the drives never has an answer (AK 0).
    pub mute: bool,
}

/// The wire that the session has, and what is at the other end of it.
pub struct Bus {
    /// Virtual time.
    pub now: Instant,
    /// What the line does to octets.
    pub line: Line,
    /// State of the random numbers.
    pub random: u64,
    /// The drives at the line.
    pub drives: Vec<SerialStation>,
    /// Octets on their way to the client, with the time of arrival.
    pub to_client: VecDeque<(Instant, Vec<u8>)>,
    /// Process data that the client sent, each time it changed.
    pub words: Vec<Vec<u8>>,
}

#[derive(Clone)]
/// The end of the line that the client has.
pub struct AtLine(pub Shared<Bus>);

/// A client at a serial line, with the line.
pub type Bench = On<AtLine>;

impl Bus {
    /// Returns a number from 0 to 99, the same in each run.
    fn dice(&mut self) -> u64 {
        self.random = self
            .random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.random >> 33) % 100
    }

    /// Returns a reply without what the parameter channel has to say.
    fn reply(&self, octets: &[u8]) -> Vec<u8> {
        let mut octets = octets.to_vec();
        if let (true, [_, _, _, pkw @ .., _, _, _, _, _]) = (self.line.mute, octets.as_mut_slice()) {
            pkw.fill(0);
            let check = octets
                .pop()
                .map(|_| octets.iter().fold(0, |sum, octet| sum ^ octet));
            octets.extend(check);
        }
        octets
    }

    fn spoil(&mut self, mut octets: Vec<u8>) -> Vec<u8> {
        if self.dice() < self.line.halved {
            octets.truncate(octets.len() / 2);
        }
        if self.dice() < self.line.changed {
            let place = self.dice() as usize % octets.len().max(1);
            if let Some(octet) = octets.get_mut(place) {
                *octet ^= 0x11;
            }
        }
        if self.dice() < self.line.noisy {
            octets.splice(0..0, [0xFF, 0x02, 0x00]);
        }
        octets
    }
}

impl Wire for AtLine {
    type Error = Infallible;

    fn now(&self) -> Instant {
        self.0.borrow().now
    }

    fn step(&mut self, client: &mut Engine, until: Instant) -> Result<(), Infallible> {
        let mut bus = self.0.borrow_mut();
        let bus = &mut *bus;
        let mut buffer = [0; uss::MAX_TELEGRAM];
        let character = Duration::from_micros(1146);
        while let Some(length) = client.poll_octets(bus.now, &mut buffer) {
            let words = buffer[length - 5..length - 1].to_vec();
            if bus.words.last() != Some(&words) {
                bus.words.push(words);
            }
            let arrived = bus.now + character * u32::try_from(length).expect("short");
            if bus.line.echo {
                bus.to_client.push_back((arrived, buffer[..length].to_vec()));
            }
            let octets = bus.spoil(buffer[..length].to_vec());
            for drive in bus.drives.iter_mut().filter(|_| !bus.line.cut) {
                drive.handle_octets(arrived, &octets);
            }
        }
        for from in 0..bus.drives.len() {
            while let Some(length) = bus.drives[from].poll_transmit(bus.now, &mut buffer) {
                let reply = bus.reply(&buffer[..length]);
                let octets = bus.spoil(reply);
                for to in (0..bus.drives.len()).filter(|&to| to != from) {
                    bus.drives[to].handle_octets(bus.now, &octets);
                }
                if !bus.line.cut {
                    let arrived = bus.now + character * u32::try_from(length).expect("short");
                    bus.to_client.push_back((arrived, octets));
                }
            }
        }
        let due = bus.drives.iter().filter_map(SerialStation::poll_timeout);
        let due = due.chain(client.poll_line_timeout());
        let due = due.chain(bus.to_client.front().map(|(at, _)| *at));
        let next = due
            .min()
            .unwrap_or(until)
            .max(bus.now + Duration::from_micros(50));
        bus.now = next.min(until).max(bus.now);
        while bus.to_client.front().is_some_and(|(at, _)| *at <= bus.now) {
            if let Some((_, octets)) = bus.to_client.pop_front() {
                client.handle_octets(bus.now, &octets);
            }
        }
        for drive in &mut bus.drives {
            drive.handle_timeout(bus.now);
        }
        client.handle_line_timeout(bus.now);
        Ok(())
    }
}

/// AKDs with these addresses at a line, and a client.
pub fn bench(protocol: Protocol, numbers: &[u8], line: Line) -> (Bench, AtLine) {
    bench_of(&model::AKD, protocol, numbers, line)
}

/// Drives of a model at a line, and a client.
pub fn bench_of(model: &'static Virtual, protocol: Protocol, numbers: &[u8], line: Line) -> (Bench, AtLine) {
    let config = |&number| {
        let slave = match protocol {
            Protocol::Fc => SlaveConfig::fc(number, 9600),
            Protocol::Uss => SlaveConfig::uss(number, 9600),
        };
        SerialStation::new(SerialConfig::new(model, slave))
    };
    let bus = AtLine(Shared::new(Bus {
        now: Instant::from_millis(1000),
        line,
        random: 7,
        drives: numbers.iter().map(config).collect(),
        to_client: VecDeque::new(),
        words: Vec::new(),
    }));
    (
        On::new(Network::on_line(bus.clone(), LineConfig::new(protocol, 9600))),
        bus,
    )
}

/// Finds a drive as a person calls it.
pub fn find(session: &mut Bench, text: &str) -> Result<Drive, Error> {
    session
        .find(&text.parse::<DriveAddress>().expect("an address"))
        .wait()
}
