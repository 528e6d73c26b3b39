//! Which Ethernet address belongs to an IPv4 address, and what waits until that is known (RFC 826).

use std::collections::BTreeMap;
use std::collections::VecDeque;
use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::{Instant, MacAddress};

/// Default maximum of stored neighbours; a further one replaces the least recently used.
pub(super) const MAX_NEIGHBOURS: usize = 512;
/// Most frames waiting for one neighbour; the oldest makes room.
pub(super) const MAX_WAITING_EACH: usize = 4;
/// Most frames waiting in all; beyond, new ones are dropped.
pub(super) const MAX_WAITING: usize = 128;
/// Pause between two requests for one neighbour.
pub(super) const REQUEST_INTERVAL: Duration = Duration::from_millis(200);
/// Requests sent before what waits is given up.
pub(super) const REQUESTS: u8 = 5;
/// Age at which an address in use is requested again.
pub(super) const REFRESH_AFTER: Duration = Duration::from_secs(60);
/// Age at which an unconfirmed address is no longer used.
pub(super) const EXPIRE_AFTER: Duration = Duration::from_secs(120);

#[derive(Debug)]
struct Neighbour {
    /// The address, once known.
    mac: Option<MacAddress>,
    /// When the address was last confirmed.
    confirmed: Instant,
    /// When the entry was last requested.
    used: Instant,
    /// Requests sent since the address was last confirmed.
    requests: u8,
    /// When the next request goes out, or the waiting frames are given up.
    due: Option<Instant>,
    /// Whole frames, destination address still to be filled in.
    waiting: VecDeque<Vec<u8>>,
}

/// What [`Neighbours::resolve`] found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Resolution {
    /// Send now, to this address.
    Known(MacAddress),
    /// Give the frame to [`Neighbours::wait`].
    Unknown,
}

/// What is due at a neighbour.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Due {
    /// Send an ARP request for this address.
    Request(Ipv4Addr),
    /// No answer: this many waiting frames are lost.
    GivenUp(usize),
}

/// The ARP cache and the frames that wait for an answer.
#[derive(Debug)]
pub(super) struct Neighbours {
    entries: BTreeMap<Ipv4Addr, Neighbour>,
    /// Most entries.
    limit: usize,
    waiting: usize,
    /// The earliest `due` of all entries.
    next_due: Option<Instant>,
}

impl Default for Neighbours {
    fn default() -> Self {
        Self {
            entries: BTreeMap::new(),
            limit: MAX_NEIGHBOURS,
            waiting: 0,
            next_due: None,
        }
    }
}

impl Neighbours {
    /// Sets the maximum number of stored neighbours, at least [`MAX_NEIGHBOURS`].
    pub(super) fn set_limit(&mut self, limit: usize) {
        self.limit = limit.max(MAX_NEIGHBOURS);
    }

    /// Removes all neighbours. Returns the number of waiting frames that are lost.
    pub(super) fn clear(&mut self) -> usize {
        self.entries.clear();
        self.next_due = None;
        std::mem::take(&mut self.waiting)
    }

    /// Looks `ip` up for sending. An unknown address is requested at once, an old one again.
    pub(super) fn resolve(&mut self, now: Instant, ip: Ipv4Addr) -> Resolution {
        if !self.entries.contains_key(&ip) {
            self.make_room();
        }
        let entry = self.entries.entry(ip).or_insert_with(|| Neighbour {
            mac: None,
            confirmed: now,
            used: now,
            requests: 0,
            due: Some(now),
            waiting: VecDeque::new(),
        });
        entry.used = now;
        let age = now - entry.confirmed;
        if entry.mac.is_some() && age >= EXPIRE_AFTER {
            entry.mac = None;
            entry.requests = 0;
            entry.due = Some(now);
        } else if entry.mac.is_some() && age >= REFRESH_AFTER && entry.due.is_none() && entry.requests == 0 {
            entry.due = Some(now);
        }
        if let Some(due) = entry.due {
            self.next_due = Some(self.next_due.map_or(due, |next| next.min(due)));
        }
        entry.mac.map_or(Resolution::Unknown, Resolution::Known)
    }

    /// Keeps `frame` until `ip` is known; returns the number of frames dropped for lack of space.
    pub(super) fn wait(&mut self, ip: Ipv4Addr, frame: Vec<u8>) -> usize {
        let Some(entry) = self.entries.get_mut(&ip) else {
            return 1;
        };
        let mut lost = 0;
        if entry.waiting.len() >= MAX_WAITING_EACH {
            entry.waiting.pop_front();
            self.waiting -= 1;
            lost = 1;
        }
        if self.waiting >= MAX_WAITING {
            return lost + 1;
        }
        entry.waiting.push_back(frame);
        self.waiting += 1;
        lost
    }

    /// Takes note that `ip` is at `mac`. With `create` also if it was not requested. Returns the frames that waited.
    pub(super) fn learn(
        &mut self,
        now: Instant,
        ip: Ipv4Addr,
        mac: MacAddress,
        create: bool,
    ) -> VecDeque<Vec<u8>> {
        if !self.entries.contains_key(&ip) {
            if !create {
                return VecDeque::new();
            }
            self.make_room();
            let fresh = Neighbour {
                mac: Some(mac),
                confirmed: now,
                used: now,
                requests: 0,
                due: None,
                waiting: VecDeque::new(),
            };
            self.entries.insert(ip, fresh);
            return VecDeque::new();
        }
        let Some(entry) = self.entries.get_mut(&ip) else {
            return VecDeque::new();
        };
        entry.mac = Some(mac);
        entry.confirmed = now;
        entry.requests = 0;
        entry.due = None;
        let waited = std::mem::take(&mut entry.waiting);
        self.waiting -= waited.len();
        self.refresh_due();
        waited
    }

    /// Takes note of the sender of a datagram. Never changes a known address, so that a forged datagram cannot
    /// divert anything; confirms it if it is the same.
    pub(super) fn confirm(&mut self, now: Instant, ip: Ipv4Addr, mac: MacAddress) -> VecDeque<Vec<u8>> {
        match self.entries.get_mut(&ip) {
            Some(Neighbour {
                mac: Some(known),
                confirmed,
                requests,
                due,
                ..
            }) if *known == mac => {
                *confirmed = now;
                *requests = 0;
                if due.take().is_some() {
                    self.refresh_due();
                }
                VecDeque::new()
            }
            Some(Neighbour { mac: Some(_), .. }) => VecDeque::new(),
            _ => self.learn(now, ip, mac, true),
        }
    }

    /// Returns the time when [`poll_due`](Self::poll_due) has something.
    pub(super) fn next_due(&self) -> Option<Instant> {
        self.next_due
    }

    /// Returns the next thing due at `now`.
    pub(super) fn poll_due(&mut self, now: Instant) -> Option<Due> {
        if self.next_due.is_none_or(|due| due > now) {
            return None;
        }
        let (&ip, entry) = self
            .entries
            .iter_mut()
            .find(|(_, entry)| entry.due.is_some_and(|due| due <= now))?;
        let due = if entry.requests < REQUESTS {
            entry.requests += 1;
            entry.due = Some(now + REQUEST_INTERVAL);
            Due::Request(ip)
        } else if entry.mac.is_some() {
            // A refresh without an answer: keep using the address until it expires.
            entry.due = None;
            Due::GivenUp(0)
        } else {
            let lost = entry.waiting.len();
            self.waiting -= lost;
            self.entries.remove(&ip);
            Due::GivenUp(lost)
        };
        self.refresh_due();
        Some(due)
    }

    fn make_room(&mut self) {
        if self.entries.len() < self.limit {
            return;
        }
        let oldest = self
            .entries
            .iter()
            .min_by_key(|(_, entry)| entry.used)
            .map(|(ip, _)| *ip);
        if let Some(gone) = oldest.and_then(|ip| self.entries.remove(&ip)) {
            self.waiting -= gone.waiting.len();
        }
        self.refresh_due();
    }

    fn refresh_due(&mut self) {
        self.next_due = self.entries.values().filter_map(|entry| entry.due).min();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const IP: Ipv4Addr = Ipv4Addr::new(10, 0, 0, 2);
    const MAC: MacAddress = MacAddress([2, 0, 0, 0, 0, 2]);

    fn at(millis: u64) -> Instant {
        Instant::from_millis(millis)
    }

    #[test]
    fn sends_five_requests_then_gives_up() {
        let mut table = Neighbours::default();
        assert_eq!(table.resolve(at(0), IP), Resolution::Unknown);
        assert_eq!(table.wait(IP, vec![1]), 0);
        let mut asked = Vec::new();
        let end = loop {
            let due = table.next_due().unwrap();
            match table.poll_due(due).unwrap() {
                Due::Request(ip) => asked.push((due.as_millis(), ip)),
                Due::GivenUp(lost) => break (due.as_millis(), lost),
            }
        };
        assert_eq!(asked, [0, 200, 400, 600, 800].map(|t| (t, IP)));
        assert_eq!(end, (1000, 1));
        assert_eq!(table.next_due(), None);
        assert!(table.entries.is_empty());
    }

    #[test]
    fn an_answer_releases_in_order_and_the_oldest_make_room() {
        let mut table = Neighbours::default();
        assert_eq!(table.resolve(at(0), IP), Resolution::Unknown);
        let lost: usize = (0..6).map(|n| table.wait(IP, vec![n])).sum();
        assert_eq!(lost, 2);
        assert_eq!(table.learn(at(1), IP, MAC, false), [[2], [3], [4], [5]]);
        assert_eq!(table.waiting, 0);
        assert_eq!(table.resolve(at(2), IP), Resolution::Known(MAC));
        assert_eq!(table.next_due(), None);
    }

    #[test]
    fn unknown_hosts_are_not_learnt_and_known_ones_not_redirected() {
        let mut table = Neighbours::default();
        assert!(table.learn(at(0), IP, MAC, false).is_empty());
        assert!(table.entries.is_empty());
        table.confirm(at(0), IP, MAC);
        table.confirm(at(1), IP, MacAddress([2, 0, 0, 0, 0, 9]));
        assert_eq!(table.resolve(at(2), IP), Resolution::Known(MAC));
    }

    #[test]
    fn an_old_address_is_refreshed_then_expires() {
        let mut table = Neighbours::default();
        table.confirm(at(0), IP, MAC);
        assert_eq!(table.resolve(at(59_999), IP), Resolution::Known(MAC));
        assert_eq!(table.next_due(), None);
        assert_eq!(table.resolve(at(60_000), IP), Resolution::Known(MAC));
        assert_eq!(table.poll_due(at(60_000)), Some(Due::Request(IP)));
        assert_eq!(table.resolve(at(119_999), IP), Resolution::Known(MAC));
        assert_eq!(table.resolve(at(120_000), IP), Resolution::Unknown);
        table.confirm(at(120_001), IP, MAC);
        assert_eq!(table.resolve(at(120_002), IP), Resolution::Known(MAC));
    }

    #[test]
    fn the_table_and_its_queues_are_bounded() {
        let mut table = Neighbours::default();
        let ip = |n: usize| Ipv4Addr::from(0x0A00_0000 + n as u32);
        for n in 0..MAX_NEIGHBOURS + 10 {
            table.resolve(at(n as u64), ip(n));
            for _ in 0..3 {
                table.wait(ip(n), vec![0; 10]);
            }
        }
        assert_eq!(table.entries.len(), MAX_NEIGHBOURS);
        assert!(table.waiting <= MAX_WAITING);
        assert!(
            !table.entries.contains_key(&ip(0)),
            "the longest unused makes room"
        );
        let held: usize = table.entries.values().map(|entry| entry.waiting.len()).sum();
        assert_eq!(held, table.waiting);
    }

    #[test]
    fn a_controller_of_a_large_plant_remembers_all_of_it() {
        let mut table = Neighbours::default();
        table.set_limit(2_000);
        let ip = |n: u32| Ipv4Addr::from(0x0A00_0000 + n);
        for n in 0..2_100 {
            table.learn(at(u64::from(n)), ip(n), MAC, true);
        }
        assert_eq!(table.entries.len(), 2_000);
        assert_eq!(
            table.resolve(at(2_100), ip(2_099)),
            Resolution::Known(MAC),
            "the last is remembered"
        );
    }
}
