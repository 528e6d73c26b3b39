//! LLDP: what a station tells the other end of its cable about itself.
//!
//! Source: IEEE 802.1AB for the frame, IEEE 802.3 annex F for the group of OUI 00-12-0F, IEC 61158-6-10 for that of
//! OUI 00-0E-CF. Anybody may send such frames, so everything is read with tolerance for what is not known and none for
//! what does not add up.

use core::net::Ipv4Addr;

use super::{DecodeError, Problem, Reader, Writer};
use crate::MacAddress;

/// EtherType of LLDP.
pub const ETHERTYPE: u16 = 0x88CC;
/// Group address of the nearest bridge: goes to the other end of the cable and no further.
pub const GROUP: MacAddress = MacAddress([0x01, 0x80, 0xC2, 0, 0, 0x0E]);
/// Longest LLDPDU.
pub const MAX_LENGTH: usize = 1500;
/// OUI of the PROFIBUS user organisation.
pub const OUI_PROFINET: [u8; 3] = [0x00, 0x0E, 0xCF];
/// OUI of IEEE 802.3.
pub const OUI_ETHERNET: [u8; 3] = [0x00, 0x12, 0x0F];
/// Subtype of chassis and port ids whose text the station chose itself.
pub const LOCALLY_ASSIGNED: u8 = 7;
/// Subtype of a chassis id that is an Ethernet address.
pub const CHASSIS_MAC: u8 = 4;
/// Capability bit: a station, not a bridge.
pub const STATION_ONLY: u16 = 0x0080;

/// Chassis id or port id: a subtype that says what the octets are, and the octets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Id<'a> {
    /// What the value is; 7 is text of the station's own choice.
    pub subtype: u8,
    /// 1 to 255 octets.
    pub value: &'a [u8],
}

/// A management address.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Management<'a> {
    /// IANA address family, 1 is IPv4.
    pub family: u8,
    /// The address, 1 to 31 octets.
    pub address: &'a [u8],
    /// Numbering of the interface: 1 unknown, 2 ifIndex, 3 system port number.
    pub numbering: u8,
    /// Number of the interface.
    pub interface: u32,
    /// Object identifier in its BER form, may be empty.
    pub object: &'a [u8],
}

impl Management<'_> {
    /// The address if it is an IPv4 address.
    #[must_use]
    pub fn ipv4(&self) -> Option<Ipv4Addr> {
        match *self.address {
            [a, b, c, d] if self.family == 1 => Some(Ipv4Addr::new(a, b, c, d)),
            _ => None,
        }
    }
}

/// Kind of the cable's end: IEEE 802.3 MAC/PHY configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct MacPhy {
    /// Autonegotiation: bit 0 supported, bit 1 in use.
    pub autonegotiation: u8,
    /// Advertised abilities.
    pub advertised: u16,
    /// MAUType in use: 16 is 100BASE-TX full duplex.
    pub mau_type: u16,
}

/// Delays of a port in nanoseconds, 0 where not measured: receive local and remote, transmit local and remote, cable.
pub type Delays = [u32; 5];

/// One LLDPDU. Decoding borrows from the frame; encoding writes the known parts in the usual order.
///
/// ```
/// use profinet::wire::Reader;
/// use profinet::wire::lldp::{Id, LOCALLY_ASSIGNED, Lldpdu};
/// let own = |value| Id { subtype: LOCALLY_ASSIGNED, value };
/// let told = Lldpdu { ttl: 20, ..Lldpdu::new(own(b"akd-1"), own(b"port-001")) };
/// let mut octets = Vec::new();
/// told.encode(&mut octets);
/// assert_eq!(Lldpdu::decode(Reader::new(&octets)), Ok(told));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lldpdu<'a> {
    /// Who it is.
    pub chassis: Id<'a>,
    /// Which of its ports.
    pub port: Id<'a>,
    /// Seconds for which this holds; 0 takes everything back.
    pub ttl: u16,
    /// Port description.
    pub port_description: Option<&'a [u8]>,
    /// System name.
    pub system_name: Option<&'a [u8]>,
    /// System description.
    pub system_description: Option<&'a [u8]>,
    /// Capabilities: those there are, those in use.
    pub capabilities: Option<(u16, u16)>,
    /// The first management address.
    pub management: Option<Management<'a>>,
    /// PROFINET: measured delays.
    pub delays: Option<Delays>,
    /// PROFINET: port status of RT class 2 and 3.
    pub port_status: Option<(u16, u16)>,
    /// PROFINET: Ethernet address of the interface.
    pub chassis_mac: Option<MacAddress>,
    /// Ethernet: kind of the cable's end.
    pub mac_phy: Option<MacPhy>,
    /// Ethernet: longest frame.
    pub max_frame: Option<u16>,
    /// TLVs of known types whose content does not add up; they are passed over.
    pub discarded: u16,
    /// TLVs of unknown types; they are passed over too.
    pub unknown: u16,
}

/// Types of TLVs.
mod kind {
    pub(super) const END: u8 = 0;
    pub(super) const CHASSIS: u8 = 1;
    pub(super) const PORT: u8 = 2;
    pub(super) const TTL: u8 = 3;
    pub(super) const PORT_DESCRIPTION: u8 = 4;
    pub(super) const SYSTEM_NAME: u8 = 5;
    pub(super) const SYSTEM_DESCRIPTION: u8 = 6;
    pub(super) const CAPABILITIES: u8 = 7;
    pub(super) const MANAGEMENT: u8 = 8;
    pub(super) const ORGANISATION: u8 = 127;
}

/// Reads type and content of the next TLV.
fn tlv<'a>(r: &mut Reader<'a>) -> Result<(u8, Reader<'a>), DecodeError> {
    let head = r.u16("TLV")?;
    let content = r.sub(usize::from(head & 0x01FF), "TLV content")?;
    Ok(((head >> 9) as u8, content))
}

/// Reads one of the three TLVs that stand in front.
fn mandatory<'a>(r: &mut Reader<'a>, wanted: u8, what: &'static str) -> Result<Reader<'a>, DecodeError> {
    let start = *r;
    let (found, content) = tlv(r)?;
    if found == wanted {
        Ok(content)
    } else {
        let (expected, found) = (wanted.into(), found.into());
        Err(start.error(what, 0, Problem::Expected { expected, found }))
    }
}

fn id<'a>(mut r: Reader<'a>, what: &'static str) -> Result<Id<'a>, DecodeError> {
    let subtype = r.u8(what)?;
    let value = r.rest();
    if (1..=255).contains(&value.len()) {
        Ok(Id { subtype, value })
    } else {
        Err(r.error(
            what,
            value.len(),
            Problem::Invalid {
                found: value.len() as u64,
            },
        ))
    }
}

impl<'a> Lldpdu<'a> {
    /// A station's port without anything more; taken back as it stands, since its time is 0.
    #[must_use]
    pub const fn new(chassis: Id<'a>, port: Id<'a>) -> Self {
        Self {
            chassis,
            port,
            ttl: 0,
            port_description: None,
            system_name: None,
            system_description: None,
            capabilities: None,
            management: None,
            delays: None,
            port_status: None,
            chassis_mac: None,
            mac_phy: None,
            max_frame: None,
            discarded: 0,
            unknown: 0,
        }
    }

    /// Reads an LLDPDU, the payload of an Ethernet frame. What stands behind its end is padding.
    ///
    /// # Errors
    /// When one of the first three TLVs is not what it must be or comes twice, or a TLV runs past the end: 802.1AB
    /// discards the whole LLDPDU then.
    pub fn decode(mut r: Reader<'a>) -> Result<Self, DecodeError> {
        let chassis = id(mandatory(&mut r, kind::CHASSIS, "chassis id")?, "chassis id")?;
        let port = id(mandatory(&mut r, kind::PORT, "port id")?, "port id")?;
        let ttl = mandatory(&mut r, kind::TTL, "time to live")?.u16("time to live")?;
        let mut told = Self {
            ttl,
            ..Self::new(chassis, port)
        };
        while !r.is_empty() {
            let start = r;
            let (found, content) = tlv(&mut r)?;
            match found {
                kind::END => break,
                kind::CHASSIS | kind::PORT | kind::TTL => {
                    let found = found.into();
                    return Err(start.error("second mandatory TLV", 0, Problem::Invalid { found }));
                }
                _ => told.take(found, content),
            }
        }
        Ok(told)
    }

    /// Takes an optional TLV; the first of a kind counts.
    fn take(&mut self, found: u8, mut r: Reader<'a>) {
        let taken = match found {
            kind::PORT_DESCRIPTION => keep(&mut self.port_description, text(r)),
            kind::SYSTEM_NAME => keep(&mut self.system_name, text(r)),
            kind::SYSTEM_DESCRIPTION => keep(&mut self.system_description, text(r)),
            kind::CAPABILITIES => keep(&mut self.capabilities, pair(r)),
            kind::MANAGEMENT => match management(r) {
                // several addresses are allowed; the others are not needed here
                Some(_) if self.management.is_some() => true,
                other => keep(&mut self.management, other),
            },
            kind::ORGANISATION => match (r.array("OUI"), r.u8("subtype")) {
                (Ok(oui), Ok(subtype)) => return self.take_special(oui, subtype, r),
                _ => false,
            },
            _ => {
                self.unknown = self.unknown.saturating_add(1);
                return;
            }
        };
        if !taken {
            self.discarded = self.discarded.saturating_add(1);
        }
    }

    fn take_special(&mut self, oui: [u8; 3], subtype: u8, mut r: Reader<'a>) {
        let taken = match (oui, subtype) {
            (OUI_PROFINET, 1) => keep(&mut self.delays, delays(r)),
            (OUI_PROFINET, 2) => keep(&mut self.port_status, pair(r)),
            (OUI_PROFINET, 5) => {
                let mac = r.array("chassis MAC").ok().filter(|_| r.is_empty());
                keep(&mut self.chassis_mac, mac.map(MacAddress))
            }
            (OUI_ETHERNET, 1) => keep(&mut self.mac_phy, mac_phy(r)),
            (OUI_ETHERNET, 4) => {
                let length = r.u16("frame length").ok().filter(|_| r.is_empty());
                keep(&mut self.max_frame, length)
            }
            _ => {
                self.unknown = self.unknown.saturating_add(1);
                return;
            }
        };
        if !taken {
            self.discarded = self.discarded.saturating_add(1);
        }
    }

    /// Writes chassis id and port id: what names a port among all ports.
    pub fn encode_ids(&self, out: &mut impl Writer) {
        for (kind, id) in [(kind::CHASSIS, self.chassis), (kind::PORT, self.port)] {
            write_tlv(out, kind, |out| {
                out.u8(id.subtype);
                out.bytes(id.value);
            });
        }
    }

    /// Writes the LLDPDU.
    pub fn encode(&self, out: &mut impl Writer) {
        self.encode_ids(out);
        write_tlv(out, kind::TTL, |out| out.u16(self.ttl));
        for (kind, text) in [
            (kind::PORT_DESCRIPTION, self.port_description),
            (kind::SYSTEM_NAME, self.system_name),
            (kind::SYSTEM_DESCRIPTION, self.system_description),
        ] {
            if let Some(text) = text {
                write_tlv(out, kind, |out| out.bytes(text));
            }
        }
        if let Some((there, used)) = self.capabilities {
            write_tlv(out, kind::CAPABILITIES, |out| {
                out.u16(there);
                out.u16(used);
            });
        }
        if let Some(management) = &self.management {
            write_tlv(out, kind::MANAGEMENT, |out| {
                out.u8(octet(management.address.len() + 1));
                out.u8(management.family);
                out.bytes(management.address);
                out.u8(management.numbering);
                out.u32(management.interface);
                out.u8(octet(management.object.len()));
                out.bytes(management.object);
            });
        }
        if let Some(delays) = self.delays {
            special(out, OUI_PROFINET, 1, |out| {
                delays.iter().for_each(|delay| out.u32(*delay))
            });
        }
        if let Some((class2, class3)) = self.port_status {
            special(out, OUI_PROFINET, 2, |out| {
                out.u16(class2);
                out.u16(class3);
            });
        }
        if let Some(mac) = self.chassis_mac {
            special(out, OUI_PROFINET, 5, |out| out.bytes(&mac.0));
        }
        if let Some(mac_phy) = self.mac_phy {
            special(out, OUI_ETHERNET, 1, |out| {
                out.u8(mac_phy.autonegotiation);
                out.u16(mac_phy.advertised);
                out.u16(mac_phy.mau_type);
            });
        }
        if let Some(length) = self.max_frame {
            special(out, OUI_ETHERNET, 4, |out| out.u16(length));
        }
        out.u16(0);
    }

    /// Name of the neighbour's port and of its station as PROFINET uses them: either the port id holds both
    /// (`port-001.akd-1`), or the port id is the port's and the chassis id the station's name. The station is empty where
    /// the chassis has no name.
    #[must_use]
    pub fn profinet_names(&self) -> (&'a [u8], &'a [u8]) {
        let port = self.port.value;
        match port.iter().position(|octet| *octet == b'.') {
            Some(dot) => (
                port.get(..dot).unwrap_or_default(),
                port.get(dot + 1..).unwrap_or_default(),
            ),
            None if self.chassis.subtype == LOCALLY_ASSIGNED => (port, self.chassis.value),
            None => (port, &[]),
        }
    }
}

/// The LLDPDU in an Ethernet frame and who sent it; `None` for any other frame.
#[must_use]
pub fn payload(frame: &[u8]) -> Option<(MacAddress, &[u8])> {
    let (head, rest) = frame.split_first_chunk::<14>()?;
    let [d0, d1, d2, d3, d4, d5, s0, s1, s2, s3, s4, s5, t0, t1] = *head;
    if MacAddress([d0, d1, d2, d3, d4, d5]) != GROUP {
        return None;
    }
    let payload = match u16::from_be_bytes([t0, t1]) {
        ETHERTYPE => rest,
        // priority-tagged
        super::ethernet::TPID => rest.get(2..)?.strip_prefix(&ETHERTYPE.to_be_bytes())?,
        _ => return None,
    };
    Some((MacAddress([s0, s1, s2, s3, s4, s5]), payload))
}

/// Keeps the first value of a kind; false if there is nothing to keep or it is a second one.
fn keep<T>(place: &mut Option<T>, value: Option<T>) -> bool {
    let first = place.is_none() && value.is_some();
    if first {
        *place = value;
    }
    first
}

fn text(mut r: Reader<'_>) -> Option<&[u8]> {
    Some(r.rest()).filter(|text| text.len() <= 255)
}

fn pair(mut r: Reader<'_>) -> Option<(u16, u16)> {
    let pair = (r.u16("first").ok()?, r.u16("second").ok()?);
    r.is_empty().then_some(pair)
}

fn delays(mut r: Reader<'_>) -> Option<Delays> {
    let mut delays = [0; 5];
    for delay in &mut delays {
        *delay = r.u32("delay").ok()?;
    }
    r.is_empty().then_some(delays)
}

fn mac_phy(mut r: Reader<'_>) -> Option<MacPhy> {
    let mac_phy = MacPhy {
        autonegotiation: r.u8("autonegotiation").ok()?,
        advertised: r.u16("abilities").ok()?,
        mau_type: r.u16("MAU type").ok()?,
    };
    r.is_empty().then_some(mac_phy)
}

fn management<'a>(mut r: Reader<'a>) -> Option<Management<'a>> {
    let length = usize::from(r.u8("address length").ok()?);
    let mut address = r.sub(length, "address").ok()?;
    let family = address.u8("address family").ok()?;
    let address = address.rest();
    let numbering = r.u8("interface numbering").ok()?;
    let interface = r.u32("interface number").ok()?;
    let length = usize::from(r.u8("object length").ok()?);
    let object = r.bytes(length, "object").ok()?;
    let fits = (1..=31).contains(&address.len()) && object.len() <= 128 && r.is_empty();
    fits.then_some(Management {
        family,
        address,
        numbering,
        interface,
        object,
    })
}

fn octet(length: usize) -> u8 {
    u8::try_from(length).unwrap_or(u8::MAX)
}

/// Writes a TLV around what `content` writes.
fn write_tlv<W: Writer>(out: &mut W, kind: u8, content: impl FnOnce(&mut W)) {
    let start = out.position();
    out.u16(0);
    content(out);
    let length = u16::try_from(out.position() - start - 2)
        .unwrap_or(u16::MAX)
        .min(0x01FF);
    out.patch(start, &(u16::from(kind) << 9 | length).to_be_bytes());
}

fn special<W: Writer>(out: &mut W, oui: [u8; 3], subtype: u8, content: impl FnOnce(&mut W)) {
    write_tlv(out, kind::ORGANISATION, |out| {
        out.bytes(&oui);
        out.u8(subtype);
        content(out);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use alloc::vec::Vec;
    use proptest::collection;
    use proptest::prelude::*;

    fn own(value: &[u8]) -> Id<'_> {
        Id {
            subtype: LOCALLY_ASSIGNED,
            value,
        }
    }

    fn full() -> Lldpdu<'static> {
        Lldpdu {
            ttl: 20,
            port_description: Some(b"port"),
            system_name: Some(b"drive"),
            system_description: Some(b"AKD"),
            capabilities: Some((STATION_ONLY, STATION_ONLY)),
            management: Some(Management {
                family: 1,
                address: &[192, 168, 77, 50],
                numbering: 2,
                interface: 1,
                object: &[0x2B, 6, 1],
            }),
            delays: Some([1, 2, 3, 4, 5]),
            port_status: Some((0, 0)),
            chassis_mac: Some(MacAddress([2, 0x50, 0x4E, 0, 0, 1])),
            mac_phy: Some(MacPhy {
                autonegotiation: 3,
                advertised: 0x6C00,
                mau_type: 16,
            }),
            max_frame: Some(1522),
            ..Lldpdu::new(own(b"akd-1"), own(b"port-001"))
        }
    }

    fn encoded(told: &Lldpdu<'_>) -> Vec<u8> {
        let mut out = Vec::new();
        told.encode(&mut out);
        out
    }

    #[test]
    fn the_octets_are_those_of_the_standard() {
        let told = Lldpdu {
            ttl: 20,
            chassis_mac: Some(MacAddress([2, 0x50, 0x4E, 0, 0, 1])),
            ..Lldpdu::new(own(b"akd-1"), own(b"port-001"))
        };
        let expected = [
            &[0x02, 6, 7][..],
            b"akd-1",
            &[0x04, 9, 7],
            b"port-001",
            &[0x06, 2, 0, 20],
            &[0xFE, 10, 0, 0x0E, 0xCF, 5, 2, 0x50, 0x4E, 0, 0, 1],
            &[0, 0],
        ]
        .concat();
        assert_eq!(encoded(&told), expected);
    }

    #[test]
    fn everything_comes_back_and_padding_is_passed_over() {
        let mut octets = encoded(&full());
        assert_eq!(Lldpdu::decode(Reader::new(&octets)), Ok(full()));
        octets.extend_from_slice(&[0xA5; 30]);
        assert_eq!(Lldpdu::decode(Reader::new(&octets)), Ok(full()));
        assert_eq!(
            full().management.unwrap().ipv4(),
            Some(Ipv4Addr::new(192, 168, 77, 50))
        );
    }

    #[test]
    fn what_is_cut_off_is_discarded_as_a_whole() {
        let octets = encoded(&full());
        let mut whole = 0;
        for end in 0..octets.len() {
            if let Ok(told) = Lldpdu::decode(Reader::new(&octets[..end])) {
                // only right behind a TLV
                whole += 1;
                assert_eq!((told.chassis, told.ttl, told.discarded), (own(b"akd-1"), 20, 0));
            }
        }
        assert_eq!(whole, 11);
    }

    #[test]
    fn the_first_three_must_be_there_in_order_and_once() {
        let good = encoded(&Lldpdu::new(own(b"a"), own(b"b")));
        assert!(Lldpdu::decode(Reader::new(&good)).is_ok());
        let (chassis, port, ttl) = (&good[..4], &good[4..8], &good[8..12]);
        for wrong in [
            [port, chassis, ttl].concat(),
            [chassis, port].concat(),
            [chassis, port, ttl, ttl].concat(),
            [chassis, port, ttl, chassis].concat(),
            [&[0x02, 1, 7][..], port, ttl].concat(),
            [chassis, port, &[0x06, 1, 0]].concat(),
            [chassis, port, ttl, &[0xFF, 0xFF, 1]].concat(),
        ] {
            assert!(Lldpdu::decode(Reader::new(&wrong)).is_err(), "{wrong:02x?}");
        }
    }

    #[test]
    fn strange_tlvs_are_counted_and_passed_over() {
        let mut octets = encoded(&Lldpdu::new(own(b"a"), own(b"b")));
        octets.truncate(12);
        let strange: [&[u8]; 6] = [
            &[0x0E, 3, 0, 1, 0],             // capabilities of 3 octets
            &[0x10, 4, 9, 1, 1, 2],          // management address that is not there
            &[0xFE, 2, 0, 1],                // half an OUI
            &[0xFE, 5, 0, 0x0E, 0xCF, 5, 1], // chassis MAC of one octet
            &[0x12, 0],                      // reserved type 9
            &[0xFE, 4, 0, 0x80, 0xC2, 1],    // another organisation
        ];
        octets.extend(strange.concat());
        let told = Lldpdu::decode(Reader::new(&octets)).unwrap();
        assert_eq!((told.discarded, told.unknown), (4, 2));
        assert_eq!(told.capabilities, None);
        octets.extend(vec![0x0A, 1, b'x', 0x0A, 1, b'y']);
        let told = Lldpdu::decode(Reader::new(&octets)).unwrap();
        assert_eq!((told.system_name, told.discarded), (Some(&b"x"[..]), 5));
    }

    #[test]
    fn names_in_both_forms() {
        let names = |chassis, port| Lldpdu::new(chassis, port).profinet_names();
        let mac = Id {
            subtype: CHASSIS_MAC,
            value: &[2, 0, 0, 0, 0, 1],
        };
        assert_eq!(
            names(own(b"plc1"), own(b"port-001")),
            (&b"port-001"[..], &b"plc1"[..])
        );
        let text = own(b"S7-1500        6ES7 511-1AK01-0AB0");
        assert_eq!(
            names(text, own(b"port-002.plc.line")),
            (&b"port-002"[..], &b"plc.line"[..])
        );
        assert_eq!(names(mac, own(b"port-001")), (&b"port-001"[..], &b""[..]));
    }

    #[test]
    fn frames_with_and_without_tag() {
        let mut frame = [&GROUP.0[..], &[2, 0, 0, 0, 0, 9], &[0x88, 0xCC, 1, 2]].concat();
        let source = MacAddress([2, 0, 0, 0, 0, 9]);
        assert_eq!(payload(&frame), Some((source, &[1, 2][..])));
        frame.splice(12..12, [0x81, 0, 0, 0]);
        assert_eq!(payload(&frame), Some((source, &[1, 2][..])));
        assert_eq!(payload(&frame[..16]), None);
        frame[16] = 0x08;
        assert_eq!(payload(&frame), None);
    }

    proptest! {
        #[test]
        fn whatever_is_understood_is_understood_again(octets in collection::vec(any::<u8>(), 0..200)) {
            let mut all = encoded(&Lldpdu::new(own(b"a"), own(b"b")));
            all.truncate(12);
            all.extend(octets);
            if let Ok(told) = Lldpdu::decode(Reader::new(&all)) {
                let again = encoded(&told);
                let plain = Lldpdu { discarded: 0, unknown: 0, ..told };
                prop_assert_eq!(Lldpdu::decode(Reader::new(&again)), Ok(plain));
            }
        }

        #[test]
        fn flipped_bits_are_survived(at: usize, bit in 0u8..8) {
            let mut octets = encoded(&full());
            let at = at % octets.len();
            octets[at] ^= 1 << bit;
            let _ = Lldpdu::decode(Reader::new(&octets));
        }
    }
}
