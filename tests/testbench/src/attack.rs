//! A station that attacks: it sends what it has seen on the network, changed, repeated and in another order, under
//! the addresses of another station. The same seed gives the same attack.

use std::collections::VecDeque;
use std::net::Ipv4Addr;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use network::host::Station;
use network::segment::Tap;
use profinet::{Instant, MAX_FRAME, MacAddress};

/// Address of the attacker's own port; it belongs to no connection.
pub const ATTACKER: MacAddress = MacAddress([2, 0x66, 0, 0, 0, 0xFF]);
/// The first octets of the addresses of foreign stations.
const FOREIGN: [u8; 5] = [2, 0x66, 0, 0, 7];
/// Most frames that are recorded.
const MOST_SEEN: usize = 4000;
/// Most frames that are held back to be sent later.
const MOST_HELD: usize = 8;
/// Longest pause between two frames.
const LONGEST_PAUSE: u64 = 2000;

const ETHERNET: usize = 14;
const IPV4: u16 = 0x0800;
const ARP: u16 = 0x0806;
const VLAN: u16 = 0x8100;
const PROFINET: u16 = 0x8892;
/// `FrameId` and service of a DCP Get or Set.
const GET_SET: u16 = 0xFEFD;
const SET: u8 = 4;

/// Small, fast, the same in each run.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// Starts a sequence.
    pub fn new(seed: u64) -> Self {
        let mut random = Self(seed ^ 0x9E37_79B9_7F4A_7C15);
        random.below(1);
        random
    }

    /// Returns a number from 0 to `limit` - 1; 0 when `limit` is 0.
    pub fn below(&mut self, limit: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33).checked_rem(limit).unwrap_or(0)
    }

    /// Returns an index into something of this length.
    fn index(&mut self, length: usize) -> usize {
        self.below(length as u64) as usize
    }

    /// Returns true once in so many times.
    fn once_in(&mut self, times: u64) -> bool {
        self.below(times) == 0
    }

    fn octet(&mut self) -> u8 {
        self.below(256) as u8
    }

    fn pick<'a, T>(&mut self, of: &'a [T]) -> Option<&'a T> {
        of.get(self.index(of.len()))
    }
}

/// Records the frames of a segment until it is stopped, then counts answers to foreign stations.
#[derive(Debug, Default)]
pub struct Recorder {
    frames: Vec<Vec<u8>>,
    stopped: bool,
    answers: u64,
}

impl Recorder {
    /// Returns a recorder for [`Segment::add_tap`](network::segment::Segment::add_tap), which the test keeps too.
    pub fn shared() -> Arc<Mutex<Self>> {
        Arc::default()
    }

    /// Returns what was recorded and records no more.
    pub fn stop(&mut self) -> Vec<Vec<u8>> {
        self.stopped = true;
        std::mem::take(&mut self.frames)
    }

    /// Returns how many frames were sent to a [`foreign`] station since then: what the others made of the attack.
    pub fn answers(&self) -> u64 {
        self.answers
    }
}

impl Tap for Recorder {
    fn frame(&mut self, _: Instant, frame: &[u8]) {
        if self.stopped {
            let answer = frame.get(..5) == Some(&FOREIGN[..]) && frame.get(6..11) != Some(&FOREIGN[..]);
            self.answers += u64::from(answer);
        }
        if self.stopped || self.frames.len() >= MOST_SEEN {
            return;
        }
        // cyclic frames would leave no room for the others: of equal ones in a row a few are enough
        let equal = |seen: &&Vec<u8>| seen.get(..16) == frame.get(..16);
        let repeated = self.frames.iter().rev().take(12).filter(equal).count();
        if repeated < 3 {
            self.frames.push(frame.to_vec());
        }
    }
}

/// A station by its addresses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Party {
    /// Ethernet address.
    pub mac: MacAddress,
    /// IP address.
    pub ip: Ipv4Addr,
}

/// Returns a station that no other one knows.
pub const fn foreign(number: u8) -> Party {
    let [a, b, c, d, e] = FOREIGN;
    Party {
        mac: MacAddress([a, b, c, d, e, number]),
        ip: Ipv4Addr::new(10, 0, 0, 100 + number),
    }
}

/// Whom a frame seems to come from, and whom it reaches.
#[derive(Debug, Clone, Copy)]
pub struct Role {
    /// The sender that is claimed.
    pub from: Party,
    /// The receiver.
    pub to: Party,
    /// Frames to many stay frames to many.
    pub to_all: bool,
}

/// What an attack consists of.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Determines everything that happens.
    pub seed: u64,
    /// The frames to begin with, in the order in which they were seen.
    pub frames: Vec<Vec<u8>>,
    /// Senders and receivers, one of them for some frames in a row.
    pub roles: Vec<Role>,
    /// A station whose name and address stay: a Set would be a command that it has to obey.
    pub spared: Party,
    /// When the first frame is sent.
    pub start: Instant,
    /// How many frames are sent, beside repetitions.
    pub count: u32,
}

/// The attacker, as a station on a segment.
#[derive(Debug)]
pub struct Attacker {
    plan: Plan,
    random: Random,
    role: Option<Role>,
    /// The next frame of the plan.
    cursor: usize,
    left: u32,
    due: Instant,
    held: Vec<Vec<u8>>,
    ready: VecDeque<Vec<u8>>,
    sent: u64,
}

impl Attacker {
    /// Creates an attacker.
    pub fn new(plan: Plan) -> Self {
        Self {
            random: Random::new(plan.seed),
            role: None,
            cursor: 0,
            left: plan.count,
            due: plan.start,
            held: Vec::new(),
            ready: VecDeque::new(),
            sent: 0,
            plan,
        }
    }

    /// Returns how many frames were sent.
    pub fn sent(&self) -> u64 {
        self.sent
    }

    /// Makes the next frames ready.
    fn attack(&mut self) {
        let random = &mut self.random;
        // some frames in a row are a conversation, perhaps with a repetition or a gap; then comes another one
        if self.role.is_none() || random.once_in(12) {
            self.role = random.pick(&self.plan.roles).copied();
            self.cursor = random.index(self.plan.frames.len());
        }
        let (Some(role), Some(seen)) = (self.role, self.plan.frames.get(self.cursor)) else {
            self.cursor = 0;
            return;
        };
        self.cursor += 1 + usize::from(random.once_in(8));
        let mut frame = seen.clone();
        if random.once_in(2) {
            for _ in 0..=random.below(3) {
                let other = random.pick(&self.plan.frames).map_or(&[][..], Vec::as_slice);
                mutate(&mut frame, other, random);
            }
        }
        address(&mut frame, role, random, self.plan.spared);
        frame.truncate(MAX_FRAME);
        if random.once_in(8) {
            self.ready.push_back(frame.clone());
        }
        if random.once_in(8) && self.held.len() < MOST_HELD {
            self.held.push(frame);
        } else {
            self.ready.push_back(frame);
        }
        if random.once_in(8) && !self.held.is_empty() {
            let index = random.index(self.held.len());
            self.ready.push_back(self.held.swap_remove(index));
        }
    }
}

impl Station for Attacker {
    fn mac(&self) -> MacAddress {
        ATTACKER
    }

    fn handle_frame(&mut self, _: Instant, _: &[u8]) {}

    fn handle_timeout(&mut self, now: Instant) {
        while self.left > 0 && self.due <= now {
            self.left -= 1;
            self.attack();
            self.due += Duration::from_micros(1 + self.random.below(LONGEST_PAUSE));
        }
    }

    fn poll_transmit(&mut self, _: Instant, buffer: &mut [u8]) -> Option<usize> {
        let frame = self.ready.pop_front()?;
        buffer.get_mut(..frame.len())?.copy_from_slice(&frame);
        self.sent += 1;
        Some(frame.len())
    }

    fn poll_timeout(&self) -> Option<Instant> {
        (self.left > 0).then_some(self.due)
    }
}

/// Changes a frame behind its addresses.
fn mutate(frame: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let length = frame.len().saturating_sub(ETHERNET);
    if length == 0 {
        return;
    }
    let at = ETHERNET + random.index(length);
    match random.below(8) {
        0 => frame[at] ^= 1 << random.below(8),
        1 => frame[at] = random.octet(),
        // numbers and lengths at their ends
        2 => frame[at] = *random.pick(&[0, 1, 0x7F, 0x80, 0xFE, 0xFF]).unwrap_or(&0),
        3 => {
            let number = *random
                .pick(&[0, 1, 0x7FFF, 0x8000, 0xFFFE, 0xFFFF_u16])
                .unwrap_or(&0);
            let end = frame.len().min(at + 2);
            frame[at..end].copy_from_slice(&number.to_be_bytes()[..end - at]);
        }
        4 => frame.truncate(at),
        5 => {
            let more = random.index(600);
            frame.resize(frame.len() + more, random.octet());
        }
        // the beginning of one, the end of another one
        6 => {
            frame.truncate(at);
            frame.extend_from_slice(other.get(at..).unwrap_or_default());
        }
        _ => {
            let end = frame.len().min(at + 1 + random.index(16));
            let part = frame[at..end].to_vec();
            frame.splice(at..at, part);
        }
    }
}

/// Gives a frame its sender and receiver, and most of the time lengths and checksums that fit.
fn address(frame: &mut Vec<u8>, mut role: Role, random: &mut Random, spared: Party) {
    if frame.len() < ETHERNET {
        frame.resize(ETHERNET, 0);
    }
    let to_many = frame[0] & 1 == 1 && role.to_all;
    if (to_many || role.to == spared) && is_set(frame) {
        // back to its sender, which reads nothing
        role.to = role.from;
        frame[..6].copy_from_slice(&role.to.mac.0);
    } else if !to_many {
        frame[..6].copy_from_slice(&role.to.mac.0);
    }
    frame[6..12].copy_from_slice(&role.from.mac.0);
    let kind = u16::from_be_bytes([frame[12], frame[13]]);
    if kind == ARP && frame.len() >= ETHERNET + 28 {
        frame[22..28].copy_from_slice(&role.from.mac.0);
        frame[28..32].copy_from_slice(&role.from.ip.octets());
        frame[38..42].copy_from_slice(&role.to.ip.octets());
    }
    if kind == IPV4 && frame.len() >= ETHERNET + 28 {
        frame[26..30].copy_from_slice(&role.from.ip.octets());
        frame[30..34].copy_from_slice(&role.to.ip.octets());
        if !random.once_in(8) {
            fit(frame);
        }
    }
}

/// Returns true for a DCP Set, with a priority tag or without.
fn is_set(frame: &[u8]) -> bool {
    let word = |at: usize| {
        let octets = frame.get(at..at + 2)?;
        Some(u16::from_be_bytes([octets[0], octets[1]]))
    };
    let at = if word(12) == Some(VLAN) { 16 } else { 12 };
    word(at) == Some(PROFINET) && word(at + 2) == Some(GET_SET) && frame.get(at + 4) == Some(&SET)
}

/// Makes the lengths and checksums of IPv4 and UDP fit; the UDP checksum is left out, as UDP allows.
fn fit(frame: &mut [u8]) {
    let length = u16::try_from(frame.len() - ETHERNET).unwrap_or(u16::MAX);
    let (_, packet) = frame.split_at_mut(ETHERNET);
    packet[0] = 0x45;
    packet[2..4].copy_from_slice(&length.to_be_bytes());
    packet[24..26].copy_from_slice(&(length - 20).to_be_bytes());
    packet[26..28].fill(0);
    packet[10..12].fill(0);
    let words = packet[..20].chunks(2);
    let sum: u32 = words
        .map(|word| u32::from(u16::from_be_bytes([word[0], word[1]])))
        .sum();
    let sum = (sum & 0xFFFF) + (sum >> 16);
    let sum = !((sum & 0xFFFF) + (sum >> 16)) as u16;
    packet[10..12].copy_from_slice(&sum.to_be_bytes());
}
