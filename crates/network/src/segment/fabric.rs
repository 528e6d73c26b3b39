//! The switch: who gets a frame, when, and how often.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap, VecDeque};
use std::io;
use std::time::Duration;

use profinet::{Instant, MAX_FRAME, MacAddress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::conditions::Conditions;
use super::frames::{FrameId, Frames};
use super::tap::{Tap, finish_all};
use crate::host::addresses;

/// Most frames under way; beyond, new ones are lost.
const MAX_UNDER_WAY: usize = 1 << 16;
/// Most frames kept for a guest that is away; beyond, the oldest are lost.
const MAX_KEPT: usize = 1024;
const SHORTEST_DELAY: Duration = Duration::from_micros(1);

/// What a segment has counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SegmentStatistics {
    /// Frames that reached the switch.
    pub sent: u64,
    /// Octets of these.
    pub octets: u64,
    /// Frames delivered, counted per receiver.
    pub delivered: u64,
    /// Frames lost by chance, counted per receiver.
    pub lost: u64,
    /// Frames delivered twice.
    pub duplicated: u64,
    /// Frames that were held back so that others could overtake.
    pub reordered: u64,
    /// Frames lost because a cable was cut, a place was empty or too much was under way.
    pub discarded: u64,
}

/// A frame on its way to one port.
#[derive(Debug)]
pub(super) struct Delivery {
    pub(super) at: Instant,
    /// Breaks ties: who was sent first arrives first.
    order: u64,
    pub(super) port: usize,
    frame: FrameId,
}

impl PartialEq for Delivery {
    fn eq(&self, other: &Self) -> bool {
        (self.at, self.order) == (other.at, other.order)
    }
}
impl Eq for Delivery {}
impl PartialOrd for Delivery {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Delivery {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.at, self.order).cmp(&(other.at, other.order))
    }
}

#[derive(Debug)]
struct Link {
    mac: MacAddress,
    conditions: Conditions,
    cut: bool,
    /// Nothing in order arrives before this.
    last_arrival: Instant,
    /// Deliveries kept for a guest that is away; `None` for a station's place.
    kept: Option<VecDeque<Delivery>>,
}

/// Ports, frames under way, chance and taps.
pub(super) struct Fabric {
    links: Vec<Link>,
    by_mac: BTreeMap<MacAddress, usize>,
    conditions: Conditions,
    under_way: BinaryHeap<Reverse<Delivery>>,
    order: u64,
    frames: Frames,
    random: Pcg64Mcg,
    taps: Vec<Box<dyn Tap>>,
    statistics: SegmentStatistics,
    hash: u64,
}

impl Fabric {
    pub(super) fn new(seed: u64) -> Self {
        Self {
            links: Vec::new(),
            by_mac: BTreeMap::new(),
            conditions: Conditions::default(),
            under_way: BinaryHeap::with_capacity(256),
            order: 0,
            frames: Frames::new(),
            random: Pcg64Mcg::seed_from_u64(seed),
            taps: Vec::new(),
            statistics: SegmentStatistics::default(),
            hash: 0x9E37_79B9_7F4A_7C15,
        }
    }

    pub(super) fn add_port(&mut self, mac: MacAddress) {
        let port = self.links.len();
        self.links.push(Link {
            mac,
            conditions: self.conditions,
            cut: false,
            last_arrival: Instant::ZERO,
            kept: None,
        });
        self.set_mac(port, mac);
    }

    pub(super) fn set_mac(&mut self, port: usize, mac: MacAddress) {
        if let Some(link) = self.links.get_mut(port) {
            if self.by_mac.get(&link.mac) == Some(&port) {
                self.by_mac.remove(&link.mac);
            }
            link.mac = mac;
            self.by_mac.insert(mac, port);
        }
    }

    pub(super) fn keep_for_guest(&mut self, port: usize) {
        if let Some(link) = self.links.get_mut(port) {
            link.kept = Some(VecDeque::new());
        }
    }

    pub(super) fn set_conditions(&mut self, port: usize, conditions: Conditions) {
        if let Some(link) = self.links.get_mut(port) {
            link.conditions = conditions;
        }
    }

    pub(super) fn set_all_conditions(&mut self, conditions: Conditions) {
        self.conditions = conditions;
        for link in &mut self.links {
            link.conditions = conditions;
        }
    }

    pub(super) fn set_cut(&mut self, port: usize, cut: bool) {
        if let Some(link) = self.links.get_mut(port) {
            link.cut = cut;
        }
    }

    pub(super) fn add_tap(&mut self, tap: Box<dyn Tap>) {
        self.taps.push(tap);
    }

    pub(super) fn finish_taps(&mut self) -> io::Result<()> {
        finish_all(&mut self.taps)
    }

    pub(super) fn statistics(&self) -> SegmentStatistics {
        self.statistics
    }

    pub(super) fn trace_hash(&self) -> u64 {
        self.hash
    }

    pub(super) fn next_delivery(&self) -> Option<Instant> {
        self.under_way.peek().map(|Reverse(delivery)| delivery.at)
    }

    /// Returns the next frame that has arrived at `now` at a port whose cable is in place.
    pub(super) fn pop_delivery(&mut self, now: Instant) -> Option<Delivery> {
        while self.next_delivery().is_some_and(|at| at <= now) {
            let Reverse(delivery) = self.under_way.pop()?;
            if self.links.get(delivery.port).is_some_and(|link| !link.cut) {
                self.statistics.delivered += 1;
                self.note(&delivery);
                return Some(delivery);
            }
            self.statistics.discarded += 1;
            self.frames.release(delivery.frame);
        }
        None
    }

    pub(super) fn bytes(&self, delivery: &Delivery) -> &[u8] {
        self.frames.bytes(delivery.frame)
    }

    pub(super) fn release(&mut self, delivery: Delivery) {
        self.frames.release(delivery.frame);
    }

    /// Keeps a delivery for a guest that is away; drops it if the place is simply empty.
    pub(super) fn keep_or_drop(&mut self, delivery: Delivery) {
        let kept = self
            .links
            .get_mut(delivery.port)
            .and_then(|link| link.kept.as_mut());
        let gone = match kept {
            Some(kept) => {
                kept.push_back(delivery);
                if kept.len() > MAX_KEPT {
                    kept.pop_front()
                } else {
                    None
                }
            }
            None => Some(delivery),
        };
        if let Some(gone) = gone {
            self.statistics.discarded += 1;
            self.statistics.delivered -= 1;
            self.frames.release(gone.frame);
        }
    }

    /// Returns the oldest delivery kept for a guest.
    pub(super) fn pop_kept(&mut self, port: usize) -> Option<Delivery> {
        self.links.get_mut(port)?.kept.as_mut()?.pop_front()
    }

    /// Takes a frame from `from` (`None`: from outside) and sends it on.
    pub(super) fn send(&mut self, now: Instant, from: Option<usize>, frame: &[u8]) {
        let Some((destination, _)) = addresses(frame).filter(|_| frame.len() <= MAX_FRAME) else {
            self.statistics.discarded += 1;
            return;
        };
        if from
            .and_then(|port| self.links.get(port))
            .is_some_and(|link| link.cut)
        {
            self.statistics.discarded += 1;
            return;
        }
        self.statistics.sent += 1;
        self.statistics.octets += frame.len() as u64;
        for tap in &mut self.taps {
            tap.frame(now, frame);
        }
        let single = self.by_mac.get(&destination).copied();
        if is_for_the_next_bridge(destination) {
            // a switch does not forward these (IEEE 802.1D 7.12.6): LLDP reaches only the other end of a cable
        } else if destination.is_multicast() {
            let Some(id) = self.frames.put(frame) else { return };
            for port in (0..self.links.len()).filter(|port| Some(*port) != from) {
                self.send_to(now, port, id);
            }
            self.frames.release(id);
        } else if let Some(port) = single.filter(|port| Some(*port) != from) {
            let Some(id) = self.frames.put(frame) else { return };
            self.send_to(now, port, id);
            self.frames.release(id);
        }
    }

    fn send_to(&mut self, now: Instant, port: usize, frame: FrameId) {
        let Some(link) = self.links.get_mut(port) else {
            return;
        };
        if link.cut || self.under_way.len() >= MAX_UNDER_WAY {
            self.statistics.discarded += 1;
            return;
        }
        let conditions = link.conditions;
        let mut arrival = now + conditions.delay.max(SHORTEST_DELAY);
        let mut copies = 1;
        let mut late = false;
        if !conditions.certain() {
            if chance(&mut self.random, conditions.loss) {
                self.statistics.lost += 1;
                return;
            }
            if chance(&mut self.random, conditions.duplicate) {
                self.statistics.duplicated += 1;
                copies = 2;
            }
            arrival += jitter(&mut self.random, conditions.jitter);
            late = chance(&mut self.random, conditions.reorder);
        }
        if late {
            self.statistics.reordered += 1;
            arrival += conditions.reorder_by;
        } else {
            arrival = arrival.max(link.last_arrival);
            link.last_arrival = arrival;
        }
        for _ in 0..copies {
            self.frames.share(frame);
            self.order += 1;
            self.under_way.push(Reverse(Delivery {
                at: arrival,
                order: self.order,
                port,
                frame,
            }));
        }
    }

    /// Adds a delivery to the trace hash.
    fn note(&mut self, delivery: &Delivery) {
        let mut hash = self.hash;
        let mut mix = |word: u64| hash = (hash ^ word).wrapping_mul(0xFF51_AFD7_ED55_8CCD).rotate_left(29);
        mix(delivery.at.as_nanos());
        mix(delivery.port as u64);
        let bytes = self.frames.bytes(delivery.frame);
        mix(bytes.len() as u64);
        let (words, rest) = bytes.as_chunks::<8>();
        words.iter().for_each(|word| mix(u64::from_le_bytes(*word)));
        rest.iter().for_each(|octet| mix(u64::from(*octet)));
        self.hash = hash;
    }

    /// Buffers in use, for tests.
    #[cfg(test)]
    pub(super) fn buffers_in_use(&self) -> usize {
        self.frames.in_use()
    }
}

/// Returns true for the group addresses that no bridge passes on, 01-80-C2-00-00-00 to 0F.
const fn is_for_the_next_bridge(destination: MacAddress) -> bool {
    matches!(destination.0, [0x01, 0x80, 0xC2, 0, 0, 0x00..=0x0F])
}

/// Returns true with probability `share`.
pub(crate) fn chance(random: &mut Pcg64Mcg, share: f64) -> bool {
    // 53 random bits are a number from 0 to below 1 that f64 holds exactly.
    share > 0.0 && ((random.next_u64() >> 11) as f64) < share * (1u64 << 53) as f64
}

/// Evenly spread from zero to `most`.
pub(crate) fn jitter(random: &mut Pcg64Mcg, most: Duration) -> Duration {
    let nanos = u64::try_from(most.as_nanos()).unwrap_or(u64::MAX);
    if nanos == 0 {
        return Duration::ZERO;
    }
    // The high half of a wide product: no division, no bias that matters.
    let wide = u128::from(random.next_u64()) * (u128::from(nanos) + 1);
    Duration::from_nanos((wide >> 64) as u64)
}
