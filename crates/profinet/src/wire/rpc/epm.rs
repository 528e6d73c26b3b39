//! Bodies of the endpoint mapper lookup: which RPC servers a station has.
//!
//! C706 appendix O; numbers in the byte order of the RPC header, tower ports big-endian.

use alloc::vec::Vec;
use core::net::Ipv4Addr;

use crate::wire::{ByteOrder, DecodeError, Problem, Reader, Uuid, Writer};

/// Operation "lookup".
pub const EPM_LOOKUP: u16 = 2;
/// Operation "free the lookup handle".
pub const EPM_LOOKUP_FREE: u16 = 4;
/// Return code when no (further) endpoint is registered.
pub const EPM_NOT_REGISTERED: u32 = 0x16C9_A0D6;
/// Maximum number of entries decoded of one answer.
pub const MAX_ENTRIES: u32 = 64;
/// Octets of a tower of five floors.
pub const MAX_TOWER: usize = 75;

/// A lookup handle: attributes and a UUID, all zero on the first call and after the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EpmHandle {
    /// Attributes, 0.
    pub attributes: u32,
    /// Identity of the enumeration.
    pub uuid: Uuid,
}

impl EpmHandle {
    /// Reads 20 octets.
    ///
    /// # Errors
    /// When fewer are left.
    pub fn decode(r: &mut Reader<'_>, order: ByteOrder) -> Result<Self, DecodeError> {
        Ok(Self {
            attributes: r.u32_in(order, "handle attributes")?,
            uuid: Uuid::decode(r, order, "handle")?,
        })
    }

    /// Writes 20 octets.
    pub fn encode(&self, out: &mut impl Writer, order: ByteOrder) {
        out.u32_in(order, self.attributes);
        self.uuid.encode(out, order);
    }
}

/// Body of a lookup request, 76 octets, no NDR header of PROFINET before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LookupRequest {
    /// 0 all, 1 by interface, 2 by object, 3 by both.
    pub inquiry: u32,
    /// Object requested.
    pub object: Uuid,
    /// Interface requested.
    pub interface: Uuid,
    /// Version requested, major and minor.
    pub version: (u16, u16),
    /// How the version is compared, 1 = all.
    pub version_option: u32,
    /// Where the enumeration stands.
    pub handle: EpmHandle,
    /// Maximum number of entries requested.
    pub max_entries: u32,
}

impl LookupRequest {
    /// Requests everything, one entry per answer.
    #[must_use]
    pub const fn all(handle: EpmHandle) -> Self {
        Self {
            inquiry: 0,
            object: Uuid::NIL,
            interface: Uuid::NIL,
            version: (0, 0),
            version_option: 1,
            handle,
            max_entries: 1,
        }
    }

    /// Reads a body.
    ///
    /// # Errors
    /// When it is too short.
    pub fn decode(r: &mut Reader<'_>, order: ByteOrder) -> Result<Self, DecodeError> {
        let inquiry = r.u32_in(order, "inquiry type")?;
        // a null pointer has nothing behind it
        let object = match r.u32_in(order, "object referent")? {
            0 => Uuid::NIL,
            _ => Uuid::decode(r, order, "object")?,
        };
        let (interface, version) = match r.u32_in(order, "interface referent")? {
            0 => (Uuid::NIL, (0, 0)),
            _ => (
                Uuid::decode(r, order, "interface")?,
                (
                    r.u16_in(order, "version major")?,
                    r.u16_in(order, "version minor")?,
                ),
            ),
        };
        let version_option = r.u32_in(order, "version option")?;
        let handle = EpmHandle::decode(r, order)?;
        let max_entries = r.u32_in(order, "max entries")?;
        Ok(Self {
            inquiry,
            object,
            interface,
            version,
            version_option,
            handle,
            max_entries,
        })
    }

    /// Writes a body.
    pub fn encode(&self, out: &mut impl Writer, order: ByteOrder) {
        out.u32_in(order, self.inquiry);
        out.u32_in(order, 1);
        self.object.encode(out, order);
        out.u32_in(order, 2);
        self.interface.encode(out, order);
        out.u16_in(order, self.version.0);
        out.u16_in(order, self.version.1);
        out.u32_in(order, self.version_option);
        self.handle.encode(out, order);
        out.u32_in(order, self.max_entries);
    }
}

/// One registered endpoint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EpmEntry {
    /// Object the endpoint serves, nil for the mapper itself.
    pub object: Uuid,
    /// Words about the station, 64 octets with the closing NUL.
    pub annotation: [u8; 64],
    /// Interface, major and minor version.
    pub interface: (Uuid, u16, u16),
    /// UDP port.
    pub port: u16,
    /// IP address.
    pub address: Ipv4Addr,
}

/// Body of a lookup response.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LookupResponse {
    /// Handle for the next call.
    pub handle: EpmHandle,
    /// Entries, at most [`MAX_ENTRIES`].
    pub entries: Vec<EpmEntry>,
    /// 0, or for example [`EPM_NOT_REGISTERED`].
    pub status: u32,
}

/// Floor protocol: a UUID with version.
const FLOOR_UUID: u8 = 0x0D;
/// Floor protocol: connectionless RPC.
const FLOOR_RPC: u8 = 0x0A;
/// Floor protocol: UDP.
const FLOOR_UDP: u8 = 0x08;
/// Floor protocol: IPv4.
const FLOOR_IP: u8 = 0x09;

fn encode_tower(entry: &EpmEntry, out: &mut impl Writer) {
    let little = ByteOrder::Little;
    out.u16_in(little, 5);
    for (uuid, major, minor) in [entry.interface, (Uuid::NDR, 2, 0)] {
        out.u16_in(little, 19);
        out.u8(FLOOR_UUID);
        uuid.encode(out, little);
        out.u16_in(little, major);
        out.u16_in(little, 2);
        out.u16_in(little, minor);
    }
    for (protocol, data) in [
        (FLOOR_RPC, &[0, 0][..]),
        (FLOOR_UDP, &entry.port.to_be_bytes()[..]),
        (FLOOR_IP, &entry.address.octets()[..]),
    ] {
        out.u16_in(little, 1);
        out.u8(protocol);
        out.u16_in(little, data.len() as u16);
        out.bytes(data);
    }
}

fn decode_tower(mut r: Reader<'_>, entry: &mut EpmEntry) -> Result<(), DecodeError> {
    let little = ByteOrder::Little;
    let floors = r.u16_in(little, "floor count")?;
    if floors > 8 {
        return Err(r.error("floor count", 2, Problem::TooMany { limit: 8 }));
    }
    for floor in 0..floors {
        let left = r.u16_in(little, "floor left side")?;
        let mut left = r.sub(left.into(), "floor protocol")?;
        let right = r.u16_in(little, "floor right side")?;
        let mut right = r.sub(right.into(), "floor data")?;
        match left.u8("floor protocol")? {
            FLOOR_UUID if floor == 0 => {
                let uuid = Uuid::decode(&mut left, little, "floor interface")?;
                let major = left.u16_in(little, "floor version")?;
                entry.interface = (uuid, major, right.u16_in(little, "floor minor version")?);
            }
            FLOOR_UDP => entry.port = right.u16("floor port")?,
            FLOOR_IP => entry.address = Ipv4Addr::from(right.u32("floor address")?),
            _ => {}
        }
    }
    Ok(())
}

impl LookupResponse {
    /// Reads a body.
    ///
    /// # Errors
    /// When it is too short, has more than [`MAX_ENTRIES`], or its lengths do not agree.
    pub fn decode(r: &mut Reader<'_>, order: ByteOrder) -> Result<Self, DecodeError> {
        let start = r.position();
        let handle = EpmHandle::decode(r, order)?;
        let count = r.u32_in(order, "num_entries")?;
        if count > MAX_ENTRIES {
            return Err(r.error(
                "num_entries",
                4,
                Problem::TooMany {
                    limit: MAX_ENTRIES as usize,
                },
            ));
        }
        r.skip(8, "entries array")?;
        let actual = r.u32_in(order, "ActualCount")?;
        if actual != count {
            return Err(r.error(
                "ActualCount",
                4,
                Problem::Expected {
                    expected: count.into(),
                    found: actual.into(),
                },
            ));
        }
        let mut entries = Vec::new();
        let mut towers = Vec::new();
        for _ in 0..count {
            let object = Uuid::decode(r, order, "object")?;
            towers.push(r.u32_in(order, "tower referent")? != 0);
            r.skip(4, "annotation offset")?;
            let length = r.u32_in(order, "annotation length")?;
            if length > 64 {
                return Err(r.error("annotation length", 4, Problem::TooMany { limit: 64 }));
            }
            let mut annotation = [0; 64];
            let text = r.bytes(length as usize, "annotation")?;
            for (place, byte) in annotation.iter_mut().zip(text) {
                *place = *byte;
            }
            skip_to(r, start, 4)?;
            let interface = (Uuid::NIL, 0, 0);
            entries.push(EpmEntry {
                object,
                annotation,
                interface,
                port: 0,
                address: Ipv4Addr::UNSPECIFIED,
            });
        }
        for (entry, _) in entries.iter_mut().zip(towers).filter(|(_, present)| *present) {
            let maximum = r.u32_in(order, "tower length")?;
            let length = r.u32_in(order, "tower length")?;
            if length != maximum {
                return Err(r.error(
                    "tower length",
                    4,
                    Problem::Expected {
                        expected: maximum.into(),
                        found: length.into(),
                    },
                ));
            }
            let tower = r.sub(usize::try_from(length).unwrap_or(usize::MAX), "tower")?;
            decode_tower(tower, entry)?;
            skip_to(r, start, 4)?;
        }
        let status = r.u32_in(order, "return code")?;
        Ok(Self {
            handle,
            entries,
            status,
        })
    }

    /// Writes a body.
    pub fn encode(&self, out: &mut impl Writer, order: ByteOrder) {
        let start = out.position();
        let count = self.entries.len() as u32;
        self.handle.encode(out, order);
        out.u32_in(order, count);
        out.u32_in(order, count);
        out.u32_in(order, 0);
        out.u32_in(order, count);
        for (i, entry) in self.entries.iter().enumerate() {
            entry.object.encode(out, order);
            out.u32_in(order, 3 + i as u32);
            out.u32_in(order, 0);
            out.u32_in(order, 64);
            out.bytes(&entry.annotation);
        }
        for entry in &self.entries {
            out.u32_in(order, MAX_TOWER as u32);
            out.u32_in(order, MAX_TOWER as u32);
            encode_tower(entry, out);
            out.align(start, 4);
        }
        out.u32_in(order, self.status);
    }
}

fn skip_to(r: &mut Reader<'_>, start: usize, multiple: usize) -> Result<(), DecodeError> {
    match (r.position() - start) % multiple {
        0 => Ok(()),
        over => r.skip(multiple - over, "padding"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn entry() -> EpmEntry {
        EpmEntry {
            object: Uuid::object(1, 2, 0x493),
            annotation: [b'a'; 64],
            interface: (Uuid::DEVICE_INTERFACE, 1, 0),
            port: 34964,
            address: Ipv4Addr::new(192, 168, 77, 50),
        }
    }

    /// A request as sent by profinet-py: null pointers, and octets behind the end.
    #[test]
    fn a_lookup_with_null_pointers() {
        let mut body = [0; 52];
        body[48] = 0x64;
        let mut reader = Reader::new(&body);
        let request = LookupRequest::decode(&mut reader, ByteOrder::Little).unwrap();
        assert_eq!(
            (request.inquiry, request.object, request.interface),
            (0, Uuid::NIL, Uuid::NIL)
        );
        assert_eq!((request.version, request.max_entries), ((0, 0), 0));
        assert_eq!(reader.remaining(), 12);
    }

    #[test]
    fn a_tower_has_75_octets() {
        let mut out = Vec::new();
        encode_tower(&entry(), &mut out);
        assert_eq!(out.len(), MAX_TOWER);
        assert_eq!(out[..5], [5, 0, 19, 0, 0x0D]);
        let tail = [1, 0, 8, 2, 0, 0x88, 0x94, 1, 0, 9, 4, 0, 192, 168, 77, 50];
        assert_eq!(out[MAX_TOWER - 16..], tail);
    }

    #[test]
    fn a_request_has_76_octets() {
        for order in [ByteOrder::Big, ByteOrder::Little] {
            let request = LookupRequest::all(EpmHandle {
                attributes: 0,
                uuid: Uuid([7; 16]),
            });
            let mut out = Vec::new();
            request.encode(&mut out, order);
            assert_eq!(out.len(), 76);
            assert_eq!(LookupRequest::decode(&mut Reader::new(&out), order), Ok(request));
            for end in 0..out.len() {
                assert!(LookupRequest::decode(&mut Reader::new(&out[..end]), order).is_err());
            }
        }
    }

    #[test]
    fn a_response_has_at_most_64_entries() {
        for (count, accepted) in [(64, true), (65, false)] {
            let response = LookupResponse {
                handle: EpmHandle::default(),
                entries: alloc::vec![entry(); count],
                status: 0,
            };
            let mut out = Vec::new();
            response.encode(&mut out, ByteOrder::Little);
            let decoded = LookupResponse::decode(&mut Reader::new(&out), ByteOrder::Little);
            assert_eq!(decoded.is_ok(), accepted, "{count}");
        }
    }

    proptest! {
        #[test]
        fn responses_survive_and_damage_is_never_a_panic(
            little: bool, count in 0usize..3, status: u32, at in 0usize..300, bit in 0u8..8,
        ) {
            let order = if little { ByteOrder::Little } else { ByteOrder::Big };
            let response = LookupResponse {
                handle: EpmHandle::default(), entries: alloc::vec![entry(); count], status,
            };
            let mut out = Vec::new();
            response.encode(&mut out, order);
            prop_assert_eq!(LookupResponse::decode(&mut Reader::new(&out), order), Ok(response));
            for end in 0..out.len() {
                prop_assert!(LookupResponse::decode(&mut Reader::new(&out[..end]), order).is_err());
            }
            if let Some(byte) = out.get_mut(at) {
                *byte ^= 1 << bit;
            }
            let _ = LookupResponse::decode(&mut Reader::new(&out), order);
        }
    }
}
