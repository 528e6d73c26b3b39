//! Two endpoints and the wire between them in virtual time, for tests.

use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;
use core::net::SocketAddrV4;
use core::time::Duration;

use crate::{Endpoint, Instant, MAX_FRAME, Transmit};

/// Something on its way.
#[derive(Debug, Clone)]
pub(crate) enum Packet {
    Frame(Vec<u8>),
    Datagram {
        source: SocketAddrV4,
        destination: SocketAddrV4,
        payload: Vec<u8>,
    },
}

/// The wire: latency, and seeded loss and duplication in parts per thousand.
#[derive(Debug, Clone)]
pub(crate) struct Wire {
    pub latency: Duration,
    pub loss: u32,
    pub duplication: u32,
    /// Part of the packets that takes up to 10 ms longer.
    pub reordering: u32,
    pub cut: bool,
    seed: u64,
    number: u64,
    under_way: BTreeMap<(Instant, u64), (usize, Packet)>,
}

impl Wire {
    fn chance(&mut self, parts: u32) -> bool {
        self.random() % 1000 < u64::from(parts)
    }

    /// xorshift64*
    fn random(&mut self) -> u64 {
        self.seed ^= self.seed >> 12;
        self.seed ^= self.seed << 25;
        self.seed ^= self.seed >> 27;
        self.seed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 16
    }

    fn put(&mut self, now: Instant, to: usize, packet: Packet) {
        if self.cut || self.chance(self.loss) {
            return;
        }
        let copies = 1 + u64::from(self.chance(self.duplication));
        for copy in 0..copies {
            self.number += 1;
            let late = if self.chance(self.reordering) {
                self.random() % 10_000_000
            } else {
                0
            };
            let at = now + self.latency + Duration::from_nanos(late + copy * 50_000);
            self.under_way.insert((at, self.number), (to, packet.clone()));
        }
    }
}

/// The two ends, the wire and the time.
pub(crate) struct Pair<A, B> {
    pub a: A,
    pub b: B,
    pub wire: Wire,
    pub now: Instant,
    pub sent: Vec<Vec<u8>>,
}

impl<A: Endpoint, B: Endpoint> Pair<A, B> {
    pub(crate) fn new(a: A, b: B, seed: u64) -> Self {
        let wire = Wire {
            latency: Duration::from_micros(100),
            loss: 0,
            duplication: 0,
            reordering: 0,
            cut: false,
            seed: seed.wrapping_mul(2).wrapping_add(1),
            number: 0,
            under_way: BTreeMap::new(),
        };
        Self {
            a,
            b,
            wire,
            now: Instant::ZERO,

            sent: vec![],
        }
    }

    fn drain(&mut self) {
        let mut buffer = [0; MAX_FRAME];
        for side in 0..2 {
            let endpoint: &mut dyn Endpoint = if side == 0 { &mut self.a } else { &mut self.b };
            for count in 0.. {
                assert!(count < 10_000, "an endpoint sends without end");
                let Some(transmit) = endpoint.poll_transmit(self.now, &mut buffer) else {
                    break;
                };
                let packet = match transmit {
                    Transmit::Frame { length } => {
                        assert!((60..=MAX_FRAME).contains(&length));
                        self.sent.push(buffer[..length].to_vec());
                        Packet::Frame(buffer[..length].to_vec())
                    }
                    Transmit::Datagram {
                        destination,
                        source_port,
                        length,
                    } => Packet::Datagram {
                        source: SocketAddrV4::new(endpoint.ip().address, source_port),
                        destination,
                        payload: buffer[..length].to_vec(),
                    },
                };
                self.wire.put(self.now, 1 - side, packet);
            }
        }
    }

    fn deliver(&mut self, to: usize, packet: &Packet) {
        let now = self.now;
        let endpoint: &mut dyn Endpoint = if to == 0 { &mut self.a } else { &mut self.b };
        match packet {
            Packet::Frame(frame) => endpoint.handle_frame(now, frame),
            Packet::Datagram {
                source,
                destination,
                payload,
            } => {
                // as a host would: not for another address
                if *destination.ip() == endpoint.ip().address {
                    endpoint.handle_datagram(now, *source, destination.port(), payload);
                }
            }
        }
    }

    /// Goes to the next arrival or deadline, but not past `until`; false when `until` is reached.
    pub(crate) fn step(&mut self, until: Instant) -> bool {
        self.drain();
        let arrival = self.wire.under_way.first_key_value().map(|(key, _)| key.0);
        let next = Instant::earliest([arrival, self.a.poll_timeout(), self.b.poll_timeout()]);
        let Some(next) = next.filter(|next| *next < until) else {
            self.now = self.now.max(until);
            return false;
        };
        self.now = self.now.max(next);
        while let Some(entry) = self.wire.under_way.first_entry() {
            if entry.key().0 > self.now {
                break;
            }
            let (to, packet) = entry.remove();
            self.deliver(to, &packet);
            self.drain();
        }
        if self.a.poll_timeout().is_some_and(|due| due <= self.now) {
            self.a.handle_timeout(self.now);
            self.drain();
        }
        if self.b.poll_timeout().is_some_and(|due| due <= self.now) {
            self.b.handle_timeout(self.now);
            self.drain();
        }
        for endpoint in [&self.a as &dyn Endpoint, &self.b] {
            let due = endpoint.poll_timeout();
            assert!(
                due.is_none_or(|due| due > self.now),
                "a deadline stays in the past: {due:?} at {:?}",
                self.now
            );
        }
        true
    }

    /// Lets time pass.
    pub(crate) fn run(&mut self, duration: Duration) {
        let until = self.now + duration;
        while self.step(until) {}
    }

    /// Lets time pass until `what` gives something, for at most `limit`.
    pub(crate) fn until<T>(
        &mut self,
        limit: Duration,
        mut what: impl FnMut(&mut Self) -> Option<T>,
    ) -> Option<T> {
        let until = self.now + limit;
        loop {
            self.drain();
            if let Some(value) = what(self) {
                return Some(value);
            }
            if !self.step(until) {
                return what(self);
            }
        }
    }
}

mod fleet;
mod station;
mod tests;
