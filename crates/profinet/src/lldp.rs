//! Neighbours: stations whose LLDP frames were received from the other end of the cable, with their time to live.
//!
//! Source: IEEE 802.1AB, receive machine. Memory is bounded: [`MAX_NEIGHBOURS`] entries of at most
//! [`lldp::MAX_LENGTH`] octets; who comes later finds no room until one is too old.

use alloc::string::String;
use alloc::vec::Vec;
use core::time::Duration;

use crate::wire::Reader;
use crate::wire::lldp::{self, Lldpdu};
use crate::{Instant, MacAddress};

/// Maximum number of neighbours stored for one port. A cable has one other end; behind a hub or a simple switch there
/// are more.
pub const MAX_NEIGHBOURS: usize = 16;

/// A neighbour: the station at the other end of the cable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Neighbour {
    /// Number given on arrival, never given twice.
    pub index: u32,
    /// Ethernet address the frames come from.
    pub source: MacAddress,
    /// Time of the last change of its content.
    pub since: Instant,
    expires: Instant,
    payload: Vec<u8>,
}

impl Neighbour {
    /// Returns its LLDPDU.
    #[must_use]
    pub fn lldpdu(&self) -> Option<Lldpdu<'_>> {
        // only valid payloads are stored
        Lldpdu::decode(Reader::new(&self.payload)).ok()
    }

    /// Returns its Ethernet address: that of its interface if the LLDPDU has it, else the source address of its frames.
    #[must_use]
    pub fn mac(&self) -> MacAddress {
        self.lldpdu()
            .and_then(|lldpdu| lldpdu.chassis_mac)
            .unwrap_or(self.source)
    }

    /// Returns the name that a station has which is found by its neighbour: port and name of the neighbour,
    /// `port-001.plc1`. `None` if the neighbour has no name.
    #[must_use]
    pub fn alias(&self) -> Option<String> {
        let lldpdu = self.lldpdu()?;
        let (port, station) = lldpdu.profinet_names();
        if station.is_empty() {
            return None;
        }
        let name = [port, b".", station].concat();
        String::from_utf8(name).ok()
    }
}

/// What was counted since the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// LLDP frames received.
    pub frames: u32,
    /// LLDP frames sent.
    pub sent: u32,
    /// Frames discarded for an error.
    pub errors: u32,
    /// TLVs of known types discarded.
    pub tlvs_discarded: u32,
    /// TLVs of unknown types.
    pub tlvs_unknown: u32,
    /// Neighbours that appeared or changed their content.
    pub inserts: u32,
    /// Neighbours that went.
    pub deletes: u32,
    /// Neighbours for which there was no room.
    pub drops: u32,
    /// Neighbours removed because their time to live expired.
    pub ageouts: u32,
}

/// The neighbours of one port.
///
/// ```
/// use profidrive_profinet::lldp::Neighbours;
/// use profidrive_profinet::wire::lldp::{Id, LOCALLY_ASSIGNED, Lldpdu};
/// use profidrive_profinet::{Instant, MacAddress};
/// let own = |value| Id { subtype: LOCALLY_ASSIGNED, value };
/// let mut payload = Vec::new();
/// Lldpdu { ttl: 20, ..Lldpdu::new(own(b"plc1"), own(b"port-001")) }.encode(&mut payload);
/// let mut neighbours = Neighbours::default();
/// neighbours.receive(Instant::ZERO, MacAddress([2, 0, 0, 0, 0, 1]), &payload);
/// assert_eq!(neighbours.iter().next().unwrap().alias().as_deref(), Some("port-001.plc1"));
/// neighbours.handle_timeout(Instant::from_millis(20_000));
/// assert_eq!(neighbours.iter().count(), 0);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Neighbours {
    list: Vec<Neighbour>,
    last_index: u32,
    changed: Instant,
    counts: Counts,
}

impl Neighbours {
    /// Takes the LLDPDU of a frame from `source`. A repetition costs no memory.
    pub fn receive(&mut self, now: Instant, source: MacAddress, payload: &[u8]) {
        let counts = &mut self.counts;
        counts.frames = counts.frames.wrapping_add(1);
        let payload = payload.get(..lldp::MAX_LENGTH).unwrap_or(payload);
        let lldpdu = match Lldpdu::decode(Reader::new(payload)) {
            Ok(lldpdu) if !source.is_multicast() => lldpdu,
            _ => {
                counts.errors = counts.errors.wrapping_add(1);
                return;
            }
        };
        counts.tlvs_discarded = counts.tlvs_discarded.wrapping_add(lldpdu.discarded.into());
        counts.tlvs_unknown = counts.tlvs_unknown.wrapping_add(lldpdu.unknown.into());
        let same = |neighbour: &Neighbour| {
            neighbour
                .lldpdu()
                .is_some_and(|old| (old.chassis, old.port) == (lldpdu.chassis, lldpdu.port))
        };
        let known = self.list.iter().position(same);
        let expires = now + Duration::from_secs(lldpdu.ttl.into());
        if lldpdu.ttl == 0 {
            if let Some(at) = known {
                self.list.remove(at);
                self.counts.deletes = self.counts.deletes.wrapping_add(1);
                self.changed = now;
            }
            return;
        }
        let full = self.list.len() >= MAX_NEIGHBOURS;
        if let Some(neighbour) = known.and_then(|at| self.list.get_mut(at)) {
            neighbour.expires = expires;
            if neighbour.payload == payload && neighbour.source == source {
                return;
            }
            neighbour.payload.clear();
            neighbour.payload.extend_from_slice(payload);
            (neighbour.source, neighbour.since) = (source, now);
        } else if full {
            self.counts.drops = self.counts.drops.wrapping_add(1);
            return;
        } else {
            self.last_index = self.last_index % 0x7FFF_FFFF + 1;
            self.list.push(Neighbour {
                index: self.last_index,
                source,
                since: now,
                expires,
                payload: payload.to_vec(),
            });
        }
        self.counts.inserts = self.counts.inserts.wrapping_add(1);
        self.changed = now;
    }

    /// Removes neighbours whose time to live has expired.
    pub fn handle_timeout(&mut self, now: Instant) {
        let before = self.list.len();
        self.list.retain(|neighbour| neighbour.expires > now);
        let gone = u32::try_from(before - self.list.len()).unwrap_or(0);
        if gone > 0 {
            self.counts.ageouts = self.counts.ageouts.wrapping_add(gone);
            self.counts.deletes = self.counts.deletes.wrapping_add(gone);
            self.changed = now;
        }
    }

    /// Returns the time at which the next neighbour expires.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Instant> {
        self.list.iter().map(|neighbour| neighbour.expires).min()
    }

    /// All, in the order in which they came.
    pub fn iter(&self) -> impl Iterator<Item = &Neighbour> {
        self.list.iter()
    }

    /// Returns the counters.
    #[must_use]
    pub const fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Returns the time at which a neighbour last appeared, left or changed.
    #[must_use]
    pub const fn changed(&self) -> Instant {
        self.changed
    }

    /// Counts a frame that was sent.
    pub(crate) const fn note_sent(&mut self) {
        self.counts.sent = self.counts.sent.wrapping_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::lldp::{Id, LOCALLY_ASSIGNED};
    use alloc::string::ToString;

    fn payload(name: &str, ttl: u16, description: Option<&[u8]>) -> Vec<u8> {
        let own = |value| Id {
            subtype: LOCALLY_ASSIGNED,
            value,
        };
        let mut out = Vec::new();
        Lldpdu {
            ttl,
            system_description: description,
            ..Lldpdu::new(own(name.as_bytes()), own(b"port-002"))
        }
        .encode(&mut out);
        out
    }

    const FROM: MacAddress = MacAddress([2, 0, 0, 0, 0, 7]);

    fn at(seconds: u64) -> Instant {
        Instant::from_millis(seconds * 1000)
    }

    #[test]
    fn a_neighbour_stays_until_its_ttl_or_shutdown() {
        let mut neighbours = Neighbours::default();
        neighbours.receive(at(0), FROM, &payload("plc", 20, None));
        let index = neighbours.iter().next().unwrap().index;
        for now in 1..10 {
            neighbours.handle_timeout(at(now * 15));
            neighbours.receive(at(now * 15), FROM, &payload("plc", 20, None));
            assert_eq!(neighbours.poll_timeout(), Some(at(now * 15 + 20)));
        }
        let kept = neighbours.iter().next().unwrap();
        assert_eq!((kept.index, kept.since), (index, at(0)));
        neighbours.receive(at(140), FROM, &payload("plc", 20, Some(b"other")));
        let kept = neighbours.iter().next().unwrap();
        assert_eq!((kept.index, kept.since), (index, at(140)));
        neighbours.receive(at(141), FROM, &payload("plc", 0, None));
        assert_eq!(neighbours.iter().count(), 0);
        assert_eq!(neighbours.poll_timeout(), None);
        let counts = *neighbours.counts();
        assert_eq!((counts.inserts, counts.deletes, counts.ageouts), (2, 1, 0));
        assert_eq!(neighbours.changed(), at(141));
    }

    #[test]
    fn a_flood_of_neighbours_is_bounded_and_does_not_push_out_those_there_are() {
        let mut neighbours = Neighbours::default();
        neighbours.receive(at(0), FROM, &payload("plc", 20, None));
        for number in 0..1000 {
            let name = number.to_string();
            neighbours.receive(at(1), FROM, &payload(&name, 65535, Some(&[b'x'; 255])));
        }
        assert_eq!(neighbours.iter().count(), MAX_NEIGHBOURS);
        assert!(
            neighbours
                .iter()
                .any(|n| n.alias().as_deref() == Some("port-002.plc"))
        );
        assert_eq!(neighbours.counts().drops, 1001 - 16);
    }

    #[test]
    fn what_cannot_be_read_is_counted_only() {
        let mut neighbours = Neighbours::default();
        let good = payload("plc", 20, None);
        for end in 0..good.len() - 2 {
            neighbours.receive(at(0), FROM, &good[..end]);
        }
        neighbours.receive(at(0), MacAddress::BROADCAST, &good);
        assert_eq!(neighbours.iter().count(), 0);
        assert_eq!(neighbours.counts().errors as usize, good.len() - 1);
    }
}
