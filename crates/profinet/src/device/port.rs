//! The port of the device: sent and received LLDP frames and its traffic counters.
//!
//! The device has one Ethernet connection, so one port is modelled: the first of its port submodules.

use alloc::vec::Vec;
use core::fmt::Write as _;
use core::time::Duration;

use super::Device;
use super::config::Identity;
use crate::endpoint::Traffic;
use crate::lldp::Neighbours;
use crate::wire::lldp::{
    CHASSIS_MAC, ETHERTYPE, GROUP, Id, LOCALLY_ASSIGNED, Lldpdu, MacPhy, Management, STATION_ONLY,
};
use crate::wire::{SliceWriter, Writer};
use crate::{Instant, MacAddress};

/// Pause between two LLDP frames.
pub(super) const INTERVAL: Duration = Duration::from_secs(5);
/// The first pause is shorter by up to 63 of these.
const SPREAD: Duration = Duration::from_millis(50);
/// Number of intervals after which the neighbour removes the entry.
pub(super) const HOLD: u16 = 4;
/// MAUType: 100BASE-TX full duplex.
pub(super) const MAU_TYPE: u16 = 16;
/// Advertised abilities: 10BASE-T and 100BASE-TX, half and full duplex.
const ABILITIES: u16 = 0x6C00;
/// Longest frame, tag and FCS included.
const MAX_FRAME: u16 = 1522;
/// ifIndex of the only interface.
pub(super) const IF_INDEX: u32 = 1;
/// 1.3.6.1.4.1.24686, the PROFIBUS user organisation: what manages this station.
pub(super) const OBJECT: [u32; 7] = [1, 3, 6, 1, 4, 1, 24686];
const OBJECT_OCTETS: [u8; 8] = [0x2B, 0x06, 0x01, 0x04, 0x01, 0x81, 0xC0, 0x6E];
/// Bit of MultipleInterfaceMode: port ids carry the station's name.
const NAME_OF_DEVICE: u8 = 1;
/// Longest text that names a station or a port.
const MAX_NAME: usize = 255;

/// Frames and octets of one direction, as the MIB for interfaces counts them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DirectionCounts {
    /// Octets, FCS not included.
    pub octets: u64,
    /// Frames to one station.
    pub unicast: u64,
    /// Frames to groups.
    pub multicast: u64,
    /// Frames to all.
    pub broadcast: u64,
}

impl DirectionCounts {
    fn count(&mut self, frame: &[u8]) {
        self.octets += frame.len() as u64;
        match frame.first_chunk::<6>().map(|mac| MacAddress(*mac)) {
            Some(MacAddress::BROADCAST) => self.broadcast += 1,
            Some(mac) if mac.is_multicast() => self.multicast += 1,
            _ => self.unicast += 1,
        }
    }
}

/// A short text without allocation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Text<const N: usize> {
    octets: [u8; N],
    length: usize,
}

impl<const N: usize> Text<N> {
    pub(super) const fn new() -> Self {
        Self {
            octets: [0; N],
            length: 0,
        }
    }

    pub(super) fn as_bytes(&self) -> &[u8] {
        self.octets.get(..self.length).unwrap_or_default()
    }
}

impl<const N: usize> core::fmt::Write for Text<N> {
    /// Appends `text`; what does not fit is left out.
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for octet in text.bytes() {
            if let Some(place) = self.octets.get_mut(self.length) {
                *place = octet;
                self.length += 1;
            }
        }
        Ok(())
    }
}

/// `port-001` for subslot 0x8001.
pub(super) fn port_name(subslot: u16) -> Text<8> {
    let mut name = Text::new();
    // a name of this length always fits
    let _ = write!(name, "port-{:03}", subslot & 0xFF);
    name
}

/// Returns a description of the station in one line: product, order number, serial number, hardware and software
/// revision in columns.
///
/// Source: IEC 61158-6-10, SystemIdentification; the value of sysDescr.
pub(super) fn system_identification(identity: &Identity) -> Text<MAX_NAME> {
    let mut text = Text::new();
    let [a, b, c] = identity.software_revision;
    // what is too long is cut off
    let _ = write!(
        text,
        "{:<25.25} {:<20.20} {:<16.16} {:>5} {}{a:>3}{b:>3}{c:>3}",
        identity.station_type,
        identity.order_id,
        identity.serial_number,
        identity.hardware_revision,
        identity.software_prefix,
    );
    text
}

/// What is known and counted at the port.
#[derive(Debug, Default)]
pub(super) struct Port {
    pub(super) neighbours: Neighbours,
    pub(super) received: DirectionCounts,
    pub(super) sent: DirectionCounts,
    /// When the next LLDP frame is due.
    next: Instant,
    /// An LLDP frame goes out as soon as possible.
    due: bool,
    /// Chassis id and port id sent last: withdrawn when they change.
    lldpdu: Vec<u8>,
}

impl Port {
    pub(super) fn handle_timeout(&mut self, now: Instant, mac: MacAddress) {
        if now >= self.next {
            // stations that start together must not send together for ever
            let early = if self.lldpdu.is_empty() {
                SPREAD * u32::from(mac.0[5] % 64)
            } else {
                Duration::ZERO
            };
            (self.due, self.next) = (true, now + (INTERVAL - early));
        }
        self.neighbours.handle_timeout(now);
    }

    pub(super) fn poll_timeout(&self) -> Option<Instant> {
        let next = Some(self.next);
        Instant::earliest([next, self.neighbours.poll_timeout()])
    }

    /// Sends a changed announcement to the neighbour at once.
    pub(super) const fn announce(&mut self) {
        self.due = true;
    }
}

impl Device {
    /// Returns the neighbours at the other end of the cable.
    #[must_use]
    pub const fn neighbours(&self) -> &Neighbours {
        &self.port.neighbours
    }

    /// Returns frames and octets at the port, received and sent, as reported by the carrier
    /// ([`Endpoint::note_traffic`](crate::Endpoint::note_traffic)).
    #[must_use]
    pub const fn traffic(&self) -> (DirectionCounts, DirectionCounts) {
        (self.port.received, self.port.sent)
    }

    pub(super) fn count(&mut self, traffic: Traffic, frame: &[u8]) {
        match traffic {
            Traffic::Received => self.port.received.count(frame),
            Traffic::Sent => self.port.sent.count(frame),
        }
    }

    /// Subslot of the port.
    pub(super) fn port_subslot(&self) -> u16 {
        let submodules = self.slots.iter(&self.config.modules);
        submodules
            .flat_map(|(_, module)| module.submodules.iter().map(|s| s.subslot))
            .find(|subslot| *subslot > 0x8000)
            .unwrap_or(0x8001)
    }

    /// Passes the LLDPDU of this station to `write`.
    ///
    /// PDInterfaceAdjust selects the format: the name of the station as chassis id and the bare name of the port, or
    /// the identification of the system as chassis id and the name of the station behind that of the port. A station
    /// without a name sends its Ethernet address instead.
    pub(super) fn with_lldpdu<T>(&self, write: impl FnOnce(&Lldpdu<'_>) -> T) -> T {
        let identification = system_identification(&self.config.identity);
        let port = port_name(self.port_subslot());
        let mac = self.config.mac;
        let long = self
            .interface_adjust
            .last()
            .is_some_and(|bits| bits & NAME_OF_DEVICE != 0);
        let own = |value| Id {
            subtype: LOCALLY_ASSIGNED,
            value,
        };
        let mut full = Text::<MAX_NAME>::new();
        let _ = core::str::from_utf8(port.as_bytes()).map(|port| write!(full, "{port}."));
        let [a, b, c, d, e, f] = mac.0;
        let _ = if self.name.is_empty() {
            write!(full, "{a:02X}-{b:02X}-{c:02X}-{d:02X}-{e:02X}-{f:02X}")
        } else {
            full.write_str(&self.name)
        };
        let (chassis, port) = match (long, self.name.is_empty()) {
            (true, _) => (own(identification.as_bytes()), own(full.as_bytes())),
            (false, false) => (own(self.name.as_bytes()), own(port.as_bytes())),
            (false, true) => {
                let chassis = Id {
                    subtype: CHASSIS_MAC,
                    value: &mac.0,
                };
                (chassis, own(port.as_bytes()))
            }
        };
        let address = self.ip.address.octets();
        let management = Management {
            family: 1,
            address: &address,
            numbering: 2,
            interface: IF_INDEX,
            object: &OBJECT_OCTETS,
        };
        let lldpdu = Lldpdu {
            ttl: INTERVAL.as_secs() as u16 * HOLD,
            system_name: Some(self.name.as_bytes()).filter(|name| !name.is_empty()),
            system_description: Some(identification.as_bytes()),
            capabilities: Some((STATION_ONLY, STATION_ONLY)),
            management: self.ip.is_set().then_some(management),
            delays: Some([0; 5]),
            port_status: Some((0, 0)),
            chassis_mac: Some(mac),
            mac_phy: Some(MacPhy {
                autonegotiation: 3,
                advertised: ABILITIES,
                mau_type: MAU_TYPE,
            }),
            max_frame: Some(MAX_FRAME),
            ..Lldpdu::new(chassis, port)
        };
        write(&lldpdu)
    }

    /// Writes the LLDP frame that is due: first a frame that withdraws the old identity, then one with the new.
    pub(super) fn emit_lldp(&mut self, buffer: &mut [u8]) -> Option<usize> {
        if !core::mem::take(&mut self.port.due) {
            return None;
        }
        let mut ids = Text::<{ 2 * MAX_NAME + 8 }>::new();
        self.with_lldpdu(|lldpdu| {
            let mut out = SliceWriter::new(&mut ids.octets);
            lldpdu.encode_ids(&mut out);
            ids.length = out.position();
        });
        let mut out = SliceWriter::new(buffer);
        out.bytes(&GROUP.0);
        out.bytes(&self.config.mac.0);
        out.u16(ETHERTYPE);
        if self.port.lldpdu.is_empty() || self.port.lldpdu == ids.as_bytes() {
            self.with_lldpdu(|lldpdu| lldpdu.encode(&mut out));
        } else {
            // no time to live, then the end
            out.bytes(&self.port.lldpdu);
            out.bytes(&[0x06, 2, 0, 0, 0, 0]);
            self.port.due = true;
        }
        let length = out.finish().ok()?;
        self.port.lldpdu.clear();
        if !self.port.due {
            self.port.lldpdu.extend_from_slice(ids.as_bytes());
        }
        self.port.neighbours.note_sent();
        Some(crate::wire::ethernet::pad(buffer, length))
    }
}
