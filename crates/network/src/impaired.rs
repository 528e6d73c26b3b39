//! A station behind a bad cable: frames get lost, late or doubled, or nothing passes at all.

use std::collections::VecDeque;

use profinet::{Instant, MacAddress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use crate::host::{Interest, Station};
use crate::segment::{Conditions, chance, jitter};

/// Most frames that wait in one direction; beyond, new ones are lost.
const MOST_WAITING: usize = 4096;

/// Any station, with a cable that can be pulled and spoiled while it runs, on a real interface as well as on a
/// segment in memory. Both directions meet the same [`Conditions`]; a frame that `reorder` picks is overtaken by others.
///
/// While nothing is wrong frames pass straight through, without a copy and without a random number.
///
/// ```
/// # use profidrive_network::host::{Host, Station};
/// # use profidrive_network::impaired::Impaired;
/// # use profidrive_network::segment::Conditions;
/// # use profinet::{Endpoint, Instant, IpSuite, MacAddress, Transmit};
/// # use std::net::{Ipv4Addr, SocketAddrV4};
/// # struct Engine;
/// # impl Endpoint for Engine {
/// #     fn mac(&self) -> MacAddress { MacAddress([2, 0x50, 0x4e, 0, 0, 1]) }
/// #     fn ip(&self) -> IpSuite {
/// #         IpSuite { address: Ipv4Addr::new(10, 0, 0, 1), mask: Ipv4Addr::new(255, 255, 255, 0), gateway: Ipv4Addr::UNSPECIFIED }
/// #     }
/// #     fn handle_frame(&mut self, _: Instant, _: &[u8]) {}
/// #     fn handle_datagram(&mut self, _: Instant, _: SocketAddrV4, _: u16, _: &[u8]) {}
/// #     fn handle_timeout(&mut self, _: Instant) {}
/// #     fn poll_transmit(&mut self, _: Instant, _: &mut [u8]) -> Option<Transmit> { None }
/// #     fn poll_timeout(&self) -> Option<Instant> { None }
/// # }
/// let mut station = Impaired::new(Host::new(Engine), 42);
/// station.pull_cable(true);
/// let mut buffer = [0; profinet::MAX_FRAME];
/// // Its announcement by ARP goes nowhere.
/// assert_eq!(station.poll_transmit(Instant::ZERO, &mut buffer), None);
/// assert_eq!(station.lost(), 1);
/// ```
#[derive(Debug)]
pub struct Impaired<S> {
    inner: S,
    conditions: Conditions,
    /// The conditions do nothing.
    clean: bool,
    pulled: bool,
    random: Pcg64Mcg,
    inward: Lane,
    outward: Lane,
    lost: u64,
}

/// Frames on their way in one direction, the one that arrives next in front.
#[derive(Debug, Default)]
struct Lane {
    waiting: VecDeque<(Instant, Vec<u8>)>,
    /// Nothing in order arrives before this.
    last: Instant,
}

impl Lane {
    fn push(&mut self, at: Instant, frame: &[u8]) -> bool {
        if self.waiting.len() >= MOST_WAITING {
            return false;
        }
        let place = self.waiting.partition_point(|(other, _)| *other <= at);
        self.waiting.insert(place, (at, frame.to_vec()));
        true
    }

    fn next(&self) -> Option<Instant> {
        self.waiting.front().map(|(at, _)| *at)
    }

    fn pop(&mut self, now: Instant) -> Option<Vec<u8>> {
        self.next().filter(|at| *at <= now)?;
        self.waiting.pop_front().map(|(_, frame)| frame)
    }
}

impl<S: Station> Impaired<S> {
    /// Creates a good cable; `seed` determines all random faults.
    #[must_use]
    pub fn new(inner: S, seed: u64) -> Self {
        Self {
            inner,
            conditions: GOOD,
            clean: true,
            pulled: false,
            random: Pcg64Mcg::seed_from_u64(seed),
            inward: Lane::default(),
            outward: Lane::default(),
            lost: 0,
        }
    }

    /// Returns the station behind the cable.
    #[must_use]
    pub const fn inner(&self) -> &S {
        &self.inner
    }

    /// Returns the station behind the cable, to give it work.
    #[must_use]
    pub const fn inner_mut(&mut self) -> &mut S {
        &mut self.inner
    }

    /// Pulls the cable or plugs it in again: what is under way is lost.
    pub fn pull_cable(&mut self, pulled: bool) {
        self.pulled = pulled;
        if pulled {
            self.lost += (self.inward.waiting.len() + self.outward.waiting.len()) as u64;
            self.inward.waiting.clear();
            self.outward.waiting.clear();
        }
    }

    /// Returns true while the cable is pulled.
    #[must_use]
    pub const fn is_pulled(&self) -> bool {
        self.pulled
    }

    /// What happens to frames from now on; what is under way arrives as it would have.
    pub fn set_conditions(&mut self, conditions: Conditions) {
        self.clean = conditions == GOOD;
        self.conditions = conditions;
    }

    /// Returns the impairments of frames.
    #[must_use]
    pub const fn conditions(&self) -> Conditions {
        self.conditions
    }

    /// Frames lost here, both directions.
    #[must_use]
    pub const fn lost(&self) -> u64 {
        self.lost
    }

    /// Decides the fate of a frame; true if it passes at once.
    fn meet(&mut self, now: Instant, frame: &[u8], inward: bool) -> bool {
        if self.pulled || chance(&mut self.random, self.conditions.loss) {
            self.lost += 1;
            return false;
        }
        let copies = 1 + usize::from(chance(&mut self.random, self.conditions.duplicate));
        let mut at = now + self.conditions.delay + jitter(&mut self.random, self.conditions.jitter);
        let late = chance(&mut self.random, self.conditions.reorder);
        let lane = if inward {
            &mut self.inward
        } else {
            &mut self.outward
        };
        if late {
            at += self.conditions.reorder_by;
        } else {
            at = at.max(lane.last);
            lane.last = at;
        }
        if copies == 1 && at <= now && lane.waiting.is_empty() {
            return true;
        }
        for _ in 0..copies {
            self.lost += u64::from(!lane.push(at, frame));
        }
        false
    }

    fn passes_freely(&self) -> bool {
        self.clean && !self.pulled
    }
}

/// No delay and no fault.
const GOOD: Conditions = Conditions {
    loss: 0.0,
    duplicate: 0.0,
    reorder: 0.0,
    reorder_by: std::time::Duration::from_millis(1),
    delay: std::time::Duration::ZERO,
    jitter: std::time::Duration::ZERO,
};

impl<S: Station> Station for Impaired<S> {
    fn mac(&self) -> MacAddress {
        self.inner.mac()
    }

    fn interest(&self) -> Interest {
        self.inner.interest()
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        if self.passes_freely() && self.inward.waiting.is_empty() || self.meet(now, frame, true) {
            self.inner.handle_frame(now, frame);
        }
    }

    fn handle_timeout(&mut self, now: Instant) {
        while let Some(frame) = self.inward.pop(now) {
            self.inner.handle_frame(now, &frame);
        }
        self.inner.handle_timeout(now);
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        for _ in 0..MOST_WAITING {
            if let Some(frame) = self.outward.pop(now) {
                buffer.get_mut(..frame.len())?.copy_from_slice(&frame);
                return Some(frame.len());
            }
            let length = self.inner.poll_transmit(now, buffer)?;
            if self.passes_freely() && self.outward.waiting.is_empty() {
                return Some(length);
            }
            let frame = buffer.get(..length)?.to_vec();
            if self.meet(now, &frame, false) {
                return Some(length);
            }
        }
        None
    }

    fn poll_timeout(&self) -> Option<Instant> {
        Instant::earliest([self.inner.poll_timeout(), self.inward.next(), self.outward.next()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// Gives back every frame it gets.
    #[derive(Debug, Default)]
    struct Echo {
        received: Vec<Vec<u8>>,
        to_send: VecDeque<Vec<u8>>,
    }

    impl Station for Echo {
        fn mac(&self) -> MacAddress {
            MacAddress([2, 0, 0, 0, 0, 1])
        }
        fn handle_frame(&mut self, _: Instant, frame: &[u8]) {
            self.received.push(frame.to_vec());
            self.to_send.push_back(frame.to_vec());
        }
        fn handle_timeout(&mut self, _: Instant) {}
        fn poll_transmit(&mut self, _: Instant, buffer: &mut [u8]) -> Option<usize> {
            let frame = self.to_send.pop_front()?;
            buffer[..frame.len()].copy_from_slice(&frame);
            Some(frame.len())
        }
        fn poll_timeout(&self) -> Option<Instant> {
            None
        }
    }

    fn at(millis: u64) -> Instant {
        Instant::from_millis(millis)
    }

    /// Everything the station sends up to `until`, with its time.
    fn sent(station: &mut Impaired<Echo>, until: Instant) -> Vec<(Instant, u8)> {
        let mut buffer = [0; 64];
        let mut all = Vec::new();
        let mut now = at(0);
        loop {
            station.handle_timeout(now);
            while let Some(length) = station.poll_transmit(now, &mut buffer) {
                all.push((now, buffer[..length][0]));
            }
            match station.poll_timeout() {
                Some(next) if next <= until && next > now => now = next,
                _ => return all,
            }
        }
    }

    #[test]
    fn a_good_cable_changes_nothing() {
        let mut station = Impaired::new(Echo::default(), 1);
        for n in 0..10 {
            station.handle_frame(at(0), &[n]);
        }
        assert_eq!(
            sent(&mut station, at(9)),
            (0..10).map(|n| (at(0), n)).collect::<Vec<_>>()
        );
        assert_eq!(station.lost(), 0);
    }

    #[test]
    fn a_delay_counts_in_both_directions_and_keeps_the_order() {
        let mut station = Impaired::new(Echo::default(), 1);
        station.set_conditions(Conditions {
            delay: Duration::from_millis(5),
            ..GOOD
        });
        station.handle_frame(at(0), &[1]);
        station.handle_frame(at(0), &[2]);
        // a better cable does not let later frames overtake
        station.set_conditions(GOOD);
        station.handle_frame(at(0), &[3]);
        assert!(station.inner().received.is_empty());
        assert_eq!(sent(&mut station, at(20)), [(at(5), 1), (at(5), 2), (at(5), 3)]);
        station.set_conditions(Conditions {
            delay: Duration::from_millis(5),
            ..GOOD
        });
        station.handle_frame(at(0), &[4]);
        assert_eq!(sent(&mut station, at(20)), [(at(10), 4)]);
    }

    #[test]
    fn chance_follows_its_share_and_its_seed() {
        let run = |seed| {
            let mut station = Impaired::new(Echo::default(), seed);
            station.set_conditions(Conditions {
                loss: 0.25,
                duplicate: 0.1,
                reorder: 0.1,
                ..GOOD
            });
            for n in 0..200_u8 {
                station.handle_frame(at(0), &[n]);
            }
            sent(&mut station, at(100))
        };
        let first = run(7);
        assert_eq!(first, run(7), "the same seed gives the same faults");
        assert_ne!(first, run(8));
        assert!((100..170).contains(&first.len()), "{}", first.len());
        assert!(
            first.windows(2).any(|pair| pair[0].1 > pair[1].1),
            "some overtake"
        );
    }

    #[test]
    fn a_pulled_cable_loses_what_is_under_way() {
        let mut station = Impaired::new(Echo::default(), 1);
        station.set_conditions(Conditions {
            delay: Duration::from_millis(5),
            ..GOOD
        });
        station.handle_frame(at(0), &[1]);
        station.pull_cable(true);
        station.handle_frame(at(0), &[2]);
        station.pull_cable(false);
        assert_eq!(sent(&mut station, at(20)), []);
        assert_eq!(station.lost(), 2);
        station.handle_frame(at(0), &[3]);
        assert_eq!(sent(&mut station, at(20)), [(at(10), 3)]);
    }

    #[test]
    fn waiting_frames_are_bounded() {
        let mut station = Impaired::new(Echo::default(), 1);
        station.set_conditions(Conditions {
            delay: Duration::from_secs(5),
            ..GOOD
        });
        for _ in 0..MOST_WAITING + 10 {
            station.handle_frame(at(0), &[0]);
        }
        assert_eq!(station.lost(), 10);
    }
}
