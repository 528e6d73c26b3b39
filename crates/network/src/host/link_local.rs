//! A link-local address of a station (AutoIP): chosen, probed and defended. Source: RFC 3927.

use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::{Instant, IpSuite, MacAddress};

/// Probes before an address is used.
const PROBES: u8 = 3;
/// The first probe waits up to this.
const PROBE_WAIT: Duration = Duration::from_secs(1);
/// Shortest and longest pause between two probes.
const PROBE_PAUSE: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(2)];
/// From the last probe to the first use.
const ANNOUNCE_WAIT: Duration = Duration::from_secs(2);
/// After so many conflicts a new address is tried once in [`RATE_LIMIT`].
const MOST_CONFLICTS: u32 = 10;
const RATE_LIMIT: Duration = Duration::from_secs(60);
/// A second conflict within this time gives the address up.
const DEFEND_INTERVAL: Duration = Duration::from_secs(10);

const MASK: Ipv4Addr = Ipv4Addr::new(255, 255, 0, 0);

/// What the owner has to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    /// Send an ARP probe for this address: sender 0.0.0.0.
    Probe(Ipv4Addr),
    /// Use this address, and announce it.
    Use(IpSuite),
    /// Announce the address in use once: another station has it too.
    Defend(Ipv4Addr),
    /// Another station has the address: stop using it.
    GiveUp,
}

/// Contents of a received ARP packet.
#[derive(Debug, Clone, Copy)]
pub(super) struct ArpAddresses {
    /// Ethernet address of the sender.
    pub mac: MacAddress,
    /// Address of the sender; 0.0.0.0 for a probe.
    pub sender: Ipv4Addr,
    /// Address that is looked for.
    pub target: Ipv4Addr,
}

/// The address of one station.
#[derive(Debug)]
pub(super) struct LinkLocal {
    mac: MacAddress,
    random: u64,
    address: Ipv4Addr,
    /// Probes sent for this address.
    probes: u8,
    in_use: bool,
    conflicts: u32,
    defended: Option<Instant>,
    due: Option<Instant>,
    /// What a received packet requests.
    pending: Option<Step>,
}

impl LinkLocal {
    /// Starts to look for an address; the same station tries the same ones.
    pub fn new(now: Instant, mac: MacAddress) -> Self {
        let random = mac.0.iter().fold(0xCBF2_9CE4_8422_2325, |hash: u64, octet| {
            (hash ^ u64::from(*octet)).wrapping_mul(0x0100_0000_01B3)
        });
        let mut new = Self {
            mac,
            random: random | 1,
            address: Ipv4Addr::UNSPECIFIED,
            probes: 0,
            in_use: false,
            conflicts: 0,
            defended: None,
            due: None,
            pending: None,
        };
        new.choose(now);
        new
    }

    /// Takes a received ARP packet.
    pub fn receive(&mut self, now: Instant, packet: ArpAddresses) {
        if packet.mac == self.mac {
            return;
        }
        let probes_too = packet.sender.is_unspecified() && packet.target == self.address;
        let has_it = packet.sender == self.address;
        if self.in_use && has_it {
            let again = self.defended.is_some_and(|last| now - last < DEFEND_INTERVAL);
            self.defended = Some(now);
            if again {
                self.conflict(now);
                self.pending = Some(Step::GiveUp);
            } else {
                self.pending = Some(Step::Defend(self.address));
            }
        } else if !self.in_use && (has_it || probes_too) {
            self.conflict(now);
        }
    }

    /// Returns the actions that are due now.
    pub fn poll(&mut self, now: Instant) -> Option<Step> {
        if let Some(step) = self.pending.take() {
            return Some(step);
        }
        if self.in_use || self.due.is_none_or(|due| due > now) {
            return None;
        }
        if self.probes == PROBES {
            self.in_use = true;
            self.due = None;
            return Some(Step::Use(IpSuite {
                address: self.address,
                mask: MASK,
                gateway: Ipv4Addr::UNSPECIFIED,
            }));
        }
        self.probes += 1;
        let pause = if self.probes == PROBES {
            ANNOUNCE_WAIT
        } else {
            let [least, most] = PROBE_PAUSE;
            least + self.part_of(most - least)
        };
        self.due = Some(now + pause);
        Some(Step::Probe(self.address))
    }

    /// Returns the time when [`poll`](Self::poll) has something to do.
    pub const fn poll_timeout(&self) -> Option<Instant> {
        if self.pending.is_some() {
            Some(Instant::ZERO)
        } else {
            self.due
        }
    }

    fn conflict(&mut self, now: Instant) {
        self.conflicts = self.conflicts.saturating_add(1);
        self.choose(now);
        if self.conflicts >= MOST_CONFLICTS {
            self.due = Some(now + RATE_LIMIT);
        }
    }

    /// Takes another address of 169.254.1.0 to 169.254.254.255.
    fn choose(&mut self, now: Instant) {
        let number = self.next() % (254 * 256);
        let [_, _, third, fourth] = (0x100 + number as u32).to_be_bytes();
        self.address = Ipv4Addr::new(169, 254, third, fourth);
        self.probes = 0;
        self.in_use = false;
        self.defended = None;
        self.due = Some(now + self.part_of(PROBE_WAIT));
    }

    /// Returns a part of this time by chance.
    fn part_of(&mut self, time: Duration) -> Duration {
        time.mul_f64((self.next() % 1000) as f64 / 1000.0)
    }

    /// xorshift: chance that is the same for the same station.
    fn next(&mut self) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random >> 16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAC: MacAddress = MacAddress([2, 0, 0, 0, 0, 1]);
    const OTHER: MacAddress = MacAddress([2, 0, 0, 0, 0, 9]);

    /// Runs until an address is in use; returns the probes, the address and the time.
    fn settle(auto: &mut LinkLocal, mut now: Instant) -> (Vec<Ipv4Addr>, IpSuite, Instant) {
        let mut probes = Vec::new();
        loop {
            now = auto.poll_timeout().unwrap().max(now);
            match auto.poll(now) {
                Some(Step::Probe(address)) => probes.push(address),
                Some(Step::Use(suite)) => return (probes, suite, now),
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn three_probes_then_the_address_is_used() {
        let mut auto = LinkLocal::new(Instant::ZERO, MAC);
        let (probes, suite, at) = settle(&mut auto, Instant::ZERO);
        assert_eq!(probes, [suite.address; 3]);
        assert!((1..=254).contains(&suite.address.octets()[2]), "{suite:?}");
        assert!((4000..=7000).contains(&at.as_millis()), "{at:?}");
        let again = settle(&mut LinkLocal::new(Instant::ZERO, MAC), Instant::ZERO);
        assert_eq!(again.1, suite, "the same station takes the same address");
        assert_eq!((auto.poll_timeout(), auto.poll(at)), (None, None));
    }

    #[test]
    fn an_address_in_use_is_not_chosen() {
        let mut auto = LinkLocal::new(Instant::ZERO, MAC);
        let first = auto.address;
        let probe = ArpAddresses {
            mac: OTHER,
            sender: Ipv4Addr::UNSPECIFIED,
            target: first,
        };
        auto.receive(Instant::ZERO, probe);
        let second = auto.address;
        let owner = ArpAddresses {
            mac: OTHER,
            sender: second,
            target: first,
        };
        auto.receive(Instant::ZERO, owner);
        let (_, suite, _) = settle(&mut auto, Instant::ZERO);
        assert!(suite.address != first && suite.address != second);
        // its own echo is none
        let own = ArpAddresses {
            mac: MAC,
            sender: suite.address,
            target: suite.address,
        };
        auto.receive(Instant::ZERO, own);
        assert_eq!(auto.poll(Instant::ZERO), None);
    }

    #[test]
    fn an_address_in_use_is_defended_once_and_then_given_up() {
        let mut auto = LinkLocal::new(Instant::ZERO, MAC);
        let (_, suite, mut now) = settle(&mut auto, Instant::ZERO);
        let owner = ArpAddresses {
            mac: OTHER,
            sender: suite.address,
            target: suite.address,
        };
        auto.receive(now, owner);
        assert_eq!(auto.poll(now), Some(Step::Defend(suite.address)));
        now += DEFEND_INTERVAL;
        auto.receive(now, owner);
        assert_eq!(auto.poll(now), Some(Step::Defend(suite.address)));
        now += Duration::from_secs(1);
        auto.receive(now, owner);
        assert_eq!(auto.poll(now), Some(Step::GiveUp));
        assert_ne!(settle(&mut auto, now).1.address, suite.address);
    }

    #[test]
    fn many_conflicts_slow_the_search_down() {
        let mut auto = LinkLocal::new(Instant::ZERO, MAC);
        for _ in 0..MOST_CONFLICTS {
            let packet = ArpAddresses {
                mac: OTHER,
                sender: auto.address,
                target: auto.address,
            };
            auto.receive(Instant::ZERO, packet);
        }
        assert_eq!(auto.poll_timeout(), Some(Instant::ZERO + RATE_LIMIT));
    }
}
