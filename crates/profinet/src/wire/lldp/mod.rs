//! LLDP: information about a station for the other end of its cable.
//!
//! Source: IEEE 802.1AB for the frame, IEEE 802.3 annex F for the group of OUI 00-12-0F, IEC 61158-6-10 for that of OUI
//! 00-0E-CF. Any station may send such frames, so decoding tolerates unknown elements and rejects inconsistent ones.

use core::net::Ipv4Addr;

use crate::MacAddress;

mod read;
mod write;

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

/// Chassis id or port id: a subtype that defines the format of the octets, and the octets.
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
    /// Returns the address if it is an IPv4 address.
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
/// use profidrive_profinet::wire::Reader;
/// use profidrive_profinet::wire::lldp::{Id, LOCALLY_ASSIGNED, Lldpdu};
/// let own = |value| Id { subtype: LOCALLY_ASSIGNED, value };
/// let lldpdu = Lldpdu { ttl: 20, ..Lldpdu::new(own(b"akd-1"), own(b"port-001")) };
/// let mut octets = Vec::new();
/// lldpdu.encode(&mut octets);
/// assert_eq!(Lldpdu::decode(Reader::new(&octets)), Ok(lldpdu));
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
    pub const END: u8 = 0;
    pub const CHASSIS: u8 = 1;
    pub const PORT: u8 = 2;
    pub const TTL: u8 = 3;
    pub const PORT_DESCRIPTION: u8 = 4;
    pub const SYSTEM_NAME: u8 = 5;
    pub const SYSTEM_DESCRIPTION: u8 = 6;
    pub const CAPABILITIES: u8 = 7;
    pub const MANAGEMENT: u8 = 8;
    pub const ORGANISATION: u8 = 127;

    /// Returns the name of a kind.
    pub const fn name(kind: u8) -> &'static str {
        match kind {
            END => "end of the LLDPDU",
            CHASSIS => "chassis identifier",
            PORT => "port identifier",
            TTL => "time to live",
            PORT_DESCRIPTION => "port description",
            SYSTEM_NAME => "system name",
            SYSTEM_DESCRIPTION => "system description",
            CAPABILITIES => "system capabilities",
            MANAGEMENT => "management address",
            ORGANISATION => "TLV of an organisation",
            _ => "reserved TLV",
        }
    }
}

impl<'a> Lldpdu<'a> {
    /// Creates a station's port without further content; withdraws it as its TTL is 0.
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

    /// Returns the name of the neighbour's port and of its station as PROFINET uses them: either the port id holds both
    /// (`port-001.akd-1`), or the port id is the port's and the chassis id the station's name. The station is empty
    /// where the chassis has no name.
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

/// Returns the LLDPDU in an Ethernet frame and who sent it; `None` for any other frame.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Reader;
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

    fn encoded(lldpdu: &Lldpdu<'_>) -> Vec<u8> {
        let mut out = Vec::new();
        lldpdu.encode(&mut out);
        out
    }

    #[test]
    fn the_octets_are_those_of_the_standard() {
        let lldpdu = Lldpdu {
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
        assert_eq!(encoded(&lldpdu), expected);
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
            if let Ok(lldpdu) = Lldpdu::decode(Reader::new(&octets[..end])) {
                // only right behind a TLV
                whole += 1;
                assert_eq!(
                    (lldpdu.chassis, lldpdu.ttl, lldpdu.discarded),
                    (own(b"akd-1"), 20, 0)
                );
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
        let lldpdu = Lldpdu::decode(Reader::new(&octets)).unwrap();
        assert_eq!((lldpdu.discarded, lldpdu.unknown), (4, 2));
        assert_eq!(lldpdu.capabilities, None);
        octets.extend(vec![0x0A, 1, b'x', 0x0A, 1, b'y']);
        let lldpdu = Lldpdu::decode(Reader::new(&octets)).unwrap();
        assert_eq!((lldpdu.system_name, lldpdu.discarded), (Some(&b"x"[..]), 5));
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
        fn decoded_frames_round_trip(octets in collection::vec(any::<u8>(), 0..200)) {
            let mut all = encoded(&Lldpdu::new(own(b"a"), own(b"b")));
            all.truncate(12);
            all.extend(octets);
            if let Ok(lldpdu) = Lldpdu::decode(Reader::new(&all)) {
                let again = encoded(&lldpdu);
                let plain = Lldpdu { discarded: 0, unknown: 0, ..lldpdu };
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
