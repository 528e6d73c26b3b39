//! UUIDs of interfaces, objects, activities and application ARs.

use core::fmt;

use super::{ByteOrder, DecodeError, Reader, Writer};

/// A UUID, octets in the order in which it is written down.
///
/// In an RPC header the first three fields follow the header's byte order; in PNIO blocks they are big-endian.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Uuid(pub [u8; 16]);

/// The last ten octets shared by all PROFINET interface UUIDs, from the second field on.
const PNIO_TAIL: [u8; 12] = [
    0x6C, 0x97, 0x11, 0xD1, 0x82, 0x71, 0x00, 0xA0, 0x24, 0x42, 0xDF, 0x7D,
];

const fn pnio(first: u32) -> Uuid {
    let mut octets = [0; 16];
    let head = first.to_be_bytes();
    let mut i = 0;
    while i < 16 {
        octets[i] = if i < 4 { head[i] } else { PNIO_TAIL[i - 4] };
        i += 1;
    }
    Uuid(octets)
}

impl Uuid {
    /// All zero.
    pub const NIL: Self = Self([0; 16]);
    /// Interface served by an IO device: DEA00001-6C97-11D1-8271-00A02442DF7D.
    pub const DEVICE_INTERFACE: Self = pnio(0xDEA0_0001);
    /// Interface served by an IO controller (ApplicationReady): DEA00002-….
    pub const CONTROLLER_INTERFACE: Self = pnio(0xDEA0_0002);
    /// Interface served by an IO supervisor: DEA00003-….
    pub const SUPERVISOR_INTERFACE: Self = pnio(0xDEA0_0003);
    /// Interface served by a parameter server: DEA00004-….
    pub const PARAMETER_SERVER_INTERFACE: Self = pnio(0xDEA0_0004);
    /// Endpoint mapper interface, version 3: E1AF8308-5D1F-11C9-91A4-08002B14A0FA.
    pub const ENDPOINT_MAPPER: Self = Self([
        0xE1, 0xAF, 0x83, 0x08, 0x5D, 0x1F, 0x11, 0xC9, 0x91, 0xA4, 0x08, 0x00, 0x2B, 0x14, 0xA0, 0xFA,
    ]);
    /// NDR transfer syntax, version 2: 8A885D04-1CEB-11C9-9FE8-08002B104860.
    pub const NDR: Self = Self([
        0x8A, 0x88, 0x5D, 0x04, 0x1C, 0xEB, 0x11, 0xC9, 0x9F, 0xE8, 0x08, 0x00, 0x2B, 0x10, 0x48, 0x60,
    ]);

    /// Object UUID of a station: DEA00000-6C97-11D1-8271-iiiiddddvvvv.
    ///
    /// ```
    /// use profidrive_profinet::wire::Uuid;
    /// let object = Uuid::object(1, 0x0002, 0x0493);
    /// assert_eq!(object.to_string(), "dea00000-6c97-11d1-8271-000100020493");
    /// ```
    #[must_use]
    pub const fn object(instance: u16, device_id: u16, vendor_id: u16) -> Self {
        let Self(mut octets) = pnio(0xDEA0_0000);
        let tail = [
            instance.to_be_bytes(),
            device_id.to_be_bytes(),
            vendor_id.to_be_bytes(),
        ];
        let mut i = 0;
        while i < 6 {
            octets[10 + i] = tail[i / 2][i % 2];
            i += 1;
        }
        Self(octets)
    }

    /// Instance, device id and vendor id of an object UUID; `None` for any other UUID.
    #[must_use]
    pub fn object_parts(&self) -> Option<(u16, u16, u16)> {
        let [head @ .., i1, i0, d1, d0, v1, v0] = self.0;
        let own = Self::object(0, 0, 0).0;
        (own.get(..10) == Some(&head[..])).then(|| {
            (
                u16::from_be_bytes([i1, i0]),
                u16::from_be_bytes([d1, d0]),
                u16::from_be_bytes([v1, v0]),
            )
        })
    }

    /// Returns true when all octets are zero.
    #[must_use]
    pub fn is_nil(&self) -> bool {
        *self == Self::NIL
    }

    fn swapped(self) -> Self {
        let [a, b, c, d, e, f, g, h, tail @ ..] = self.0;
        let mut octets = [0; 16];
        octets[..8].copy_from_slice(&[d, c, b, a, f, e, h, g]);
        octets[8..].copy_from_slice(&tail);
        Self(octets)
    }

    /// Reads sixteen octets whose first three fields are in `order`.
    ///
    /// # Errors
    /// When fewer are left.
    pub fn decode(
        reader: &mut Reader<'_>,
        order: ByteOrder,
        what: &'static str,
    ) -> Result<Self, DecodeError> {
        let uuid = Self(reader.array(what)?);
        let uuid = match order {
            ByteOrder::Big => uuid,
            ByteOrder::Little => uuid.swapped(),
        };
        reader.number(u128::from_be_bytes(uuid.0));
        Ok(uuid)
    }

    /// Writes sixteen octets, the first three fields in `order`.
    pub fn encode(self, out: &mut impl Writer, order: ByteOrder) {
        match order {
            ByteOrder::Big => out.bytes(&self.0),
            ByteOrder::Little => out.bytes(&self.swapped().0),
        }
    }
}

impl fmt::Display for Uuid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, octet) in self.0.iter().enumerate() {
            if matches!(i, 4 | 6 | 8 | 10) {
                f.write_str("-")?;
            }
            write!(f, "{octet:02x}")?;
        }
        Ok(())
    }
}

impl fmt::Debug for Uuid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Makes UUIDs from a seed: the same seed gives the same row.
///
/// The engines have no source of randomness; their creator passes a seed that differs from run to run.
#[derive(Debug, Clone)]
pub struct UuidSource {
    state: u64,
}

impl UuidSource {
    /// Starts a row.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Mixes in a value that differs from run to run even if the seed does not, for example a peer's UUID.
    pub fn stir(&mut self, uuid: &Uuid) {
        for chunk in uuid.0.chunks_exact(8) {
            let mut octets = [0; 8];
            octets.copy_from_slice(chunk);
            self.state ^= u64::from_be_bytes(octets);
            self.bits();
        }
    }

    /// Returns the next 64 bits (splitmix64).
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Returns the next UUID, marked as version 4.
    pub fn uuid(&mut self) -> Uuid {
        let mut octets = [0; 16];
        octets[..8].copy_from_slice(&self.bits().to_be_bytes());
        octets[8..].copy_from_slice(&self.bits().to_be_bytes());
        octets[6] = octets[6] & 0x0F | 0x40;
        octets[8] = octets[8] & 0x3F | 0x80;
        Uuid(octets)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;
    use alloc::vec::Vec;

    #[test]
    fn known_uuids_read_as_written_down() {
        assert_eq!(
            Uuid::DEVICE_INTERFACE.to_string(),
            "dea00001-6c97-11d1-8271-00a02442df7d"
        );
        assert_eq!(
            Uuid::ENDPOINT_MAPPER.to_string(),
            "e1af8308-5d1f-11c9-91a4-08002b14a0fa"
        );
        assert_eq!(
            Uuid::object(0x1064, 0x010E, 0x002A).object_parts(),
            Some((0x1064, 0x010E, 0x002A))
        );
        assert_eq!(Uuid::DEVICE_INTERFACE.object_parts(), None);
    }

    #[test]
    fn little_endian_turns_three_fields() {
        let mut out = Vec::new();
        Uuid::DEVICE_INTERFACE.encode(&mut out, ByteOrder::Little);
        assert_eq!(
            out,
            *b"\x01\x00\xa0\xde\x97\x6c\xd1\x11\x82\x71\x00\xa0\x24\x42\xdf\x7d"
        );
        assert_eq!(
            Uuid::decode(&mut Reader::new(&out), ByteOrder::Little, "u"),
            Ok(Uuid::DEVICE_INTERFACE)
        );
    }

    #[test]
    fn a_source_repeats_itself_only_with_its_seed() {
        let (mut a, mut b, mut c) = (UuidSource::new(1), UuidSource::new(1), UuidSource::new(2));
        let first = a.uuid();
        assert_eq!(first, b.uuid());
        assert_ne!(first, c.uuid());
        assert_ne!(first, a.uuid());
        a.stir(&Uuid([7; 16]));
        b.uuid();
        assert_ne!(a.uuid(), b.uuid());
    }
}
