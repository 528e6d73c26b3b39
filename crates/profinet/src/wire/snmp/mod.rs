//! SNMP version 1 and 2c: messages, variable bindings, values.
//!
//! Source: RFC 1157 and RFC 3416. Object identifiers and values are owned: a request is small and rare.

mod ber;

use alloc::vec::Vec;
use core::net::Ipv4Addr;

pub use ber::{MAX_NUMBERS, Oid, tag};

use super::{DecodeError, Problem, Reader, Writer};
use ber::{element, expect, short, signed, unsigned, wrap, write_signed, write_unsigned};

/// UDP port of an agent.
pub const PORT: u16 = 161;

/// Version of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Version {
    /// SNMPv1, 0 on the wire.
    V1,
    /// SNMPv2c, 1 on the wire.
    V2c,
    /// Anything else; 3 is SNMPv3.
    Other(i32),
}

impl Version {
    const fn from_number(number: i32) -> Self {
        match number {
            0 => Self::V1,
            1 => Self::V2c,
            other => Self::Other(other),
        }
    }

    const fn number(self) -> i32 {
        match self {
            Self::V1 => 0,
            Self::V2c => 1,
            Self::Other(other) => other,
        }
    }
}

/// Kind of a PDU: its tag.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PduKind(pub u8);

impl PduKind {
    /// Get.
    pub const GET: Self = Self(0xA0);
    /// GetNext.
    pub const GET_NEXT: Self = Self(0xA1);
    /// Response.
    pub const RESPONSE: Self = Self(0xA2);
    /// Set.
    pub const SET: Self = Self(0xA3);
    /// GetBulk, version 2c only.
    pub const GET_BULK: Self = Self(0xA5);
}

/// error-status of a response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ErrorStatus(pub i32);

impl ErrorStatus {
    /// No error.
    pub const NONE: Self = Self(0);
    /// The answer would be too long.
    pub const TOO_BIG: Self = Self(1);
    /// There is no such variable (version 1).
    pub const NO_SUCH_NAME: Self = Self(2);
    /// The variable cannot be set (version 2c).
    pub const NO_ACCESS: Self = Self(6);
}

/// A value of a variable.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Value {
    /// Signed number.
    Integer(i32),
    /// Octets or text.
    Octets(Vec<u8>),
    /// Nothing: in a request.
    Null,
    /// Object identifier.
    Oid(Oid),
    /// IPv4 address.
    IpAddress(Ipv4Addr),
    /// Counter of 32 bits.
    Counter(u32),
    /// Gauge.
    Gauge(u32),
    /// Hundredths of a second.
    Ticks(u32),
    /// Counter of 64 bits (version 2c).
    Counter64(u64),
    /// There is no such object (version 2c).
    NoSuchObject,
    /// The object has no such instance (version 2c).
    NoSuchInstance,
    /// There is nothing behind it (version 2c).
    EndOfMib,
    /// Another tag with its content.
    Other(u8, Vec<u8>),
}

impl Value {
    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        const WHAT: &str = "value";
        let (found, mut content) = element(r, WHAT)?;
        let number = |content| -> Result<u32, DecodeError> {
            let value = unsigned(content, WHAT)?;
            u32::try_from(value).map_err(|_| content.error(WHAT, 0, Problem::Invalid { found: value }))
        };
        Ok(match found {
            tag::INTEGER => Self::Integer(signed(content, WHAT)?),
            tag::OCTETS => Self::Octets(content.rest("octets").to_vec()),
            tag::NULL => Self::Null,
            tag::OID => Self::Oid(Oid::decode(content)?),
            tag::IP_ADDRESS => Self::IpAddress(content.array::<4>(WHAT)?.into()),
            tag::COUNTER => Self::Counter(number(content)?),
            tag::GAUGE => Self::Gauge(number(content)?),
            tag::TICKS => Self::Ticks(number(content)?),
            tag::COUNTER_64 => Self::Counter64(unsigned(content, WHAT)?),
            tag::NO_SUCH_OBJECT => Self::NoSuchObject,
            tag::NO_SUCH_INSTANCE => Self::NoSuchInstance,
            tag::END_OF_MIB => Self::EndOfMib,
            other => Self::Other(other, content.rest("octets").to_vec()),
        })
    }

    fn encode(&self, out: &mut impl Writer) {
        match self {
            Self::Integer(value) => write_signed(out, tag::INTEGER, *value),
            Self::Octets(octets) => short(out, tag::OCTETS, octets),
            Self::Null => short(out, tag::NULL, &[]),
            Self::Oid(oid) => oid.encode(out),
            Self::IpAddress(address) => short(out, tag::IP_ADDRESS, &address.octets()),
            Self::Counter(value) => write_unsigned(out, tag::COUNTER, (*value).into()),
            Self::Gauge(value) => write_unsigned(out, tag::GAUGE, (*value).into()),
            Self::Ticks(value) => write_unsigned(out, tag::TICKS, (*value).into()),
            Self::Counter64(value) => write_unsigned(out, tag::COUNTER_64, *value),
            Self::NoSuchObject => short(out, tag::NO_SUCH_OBJECT, &[]),
            Self::NoSuchInstance => short(out, tag::NO_SUCH_INSTANCE, &[]),
            Self::EndOfMib => short(out, tag::END_OF_MIB, &[]),
            Self::Other(tag, octets) => short(out, *tag, octets),
        }
    }
}

/// A variable and its value.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Binding {
    /// The variable.
    pub name: Oid,
    /// Its value; null in most requests.
    pub value: Value,
}

impl Binding {
    /// Writes it.
    pub fn encode(&self, out: &mut impl Writer) {
        wrap(out, tag::SEQUENCE, |out| {
            self.name.encode(out);
            self.value.encode(out);
        });
    }
}

/// A message with its PDU.
///
/// ```
/// use profidrive_profinet::wire::Reader;
/// use profidrive_profinet::wire::snmp::{Binding, Message, Oid, PduKind, Value, Version};
/// let name = Oid::from([1, 3, 6, 1, 2, 1, 1, 5, 0]);
/// let asked = Message {
///     version: Version::V2c, community: b"public".to_vec(), kind: PduKind::GET, request: 7, first: 0, second: 0,
///     bindings: vec![Binding { name, value: Value::Null }],
/// };
/// let mut octets = Vec::new();
/// asked.encode(&mut octets);
/// assert_eq!(Message::decode(Reader::new(&octets)), Ok(asked));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Message {
    /// Version.
    pub version: Version,
    /// Community, a password that is readable on the wire.
    pub community: Vec<u8>,
    /// Kind of the PDU.
    pub kind: PduKind,
    /// request-id, echoed by the response.
    pub request: i32,
    /// error-status; non-repeaters of a GetBulk.
    pub first: i32,
    /// error-index; max-repetitions of a GetBulk.
    pub second: i32,
    /// The variables.
    pub bindings: Vec<Binding>,
}

impl Message {
    /// Reads a message, the payload of a datagram.
    ///
    /// # Errors
    /// When it is not one of version 1 or 2c with a PDU of the common form, or its lengths are inconsistent.
    pub fn decode(mut r: Reader<'_>) -> Result<Self, DecodeError> {
        let mut message = expect(&mut r, tag::SEQUENCE, "message")?;
        r.finish("message")?;
        let version =
            Version::from_number(signed(expect(&mut message, tag::INTEGER, "version")?, "version")?);
        if let Version::Other(found) = version {
            let found = found.unsigned_abs().into();
            return Err(message.error("version", 0, Problem::Invalid { found }));
        }
        let community = expect(&mut message, tag::OCTETS, "community")?
            .rest("octets")
            .to_vec();
        let (kind, mut pdu) = element(&mut message, "PDU")?;
        message.finish("message")?;
        if !(0xA0..=0xA8).contains(&kind) || kind == 0xA4 {
            return Err(pdu.error("PDU", 0, Problem::Invalid { found: kind.into() }));
        }
        let mut number = |what| signed(expect(&mut pdu, tag::INTEGER, what)?, what);
        let (request, first, second) = (
            number("request-id")?,
            number("error-status")?,
            number("error-index")?,
        );
        let mut list = expect(&mut pdu, tag::SEQUENCE, "variable bindings")?;
        pdu.finish("PDU")?;
        let mut bindings = Vec::new();
        while !list.is_empty() {
            let mut binding = expect(&mut list, tag::SEQUENCE, "variable binding")?;
            let name = Oid::decode(expect(&mut binding, tag::OID, "name")?)?;
            let value = Value::decode(&mut binding)?;
            binding.finish("variable binding")?;
            bindings.push(Binding { name, value });
        }
        Ok(Self {
            version,
            community,
            kind: PduKind(kind),
            request,
            first,
            second,
            bindings,
        })
    }

    /// Writes the message.
    pub fn encode(&self, out: &mut impl Writer) {
        wrap(out, tag::SEQUENCE, |out| {
            write_signed(out, tag::INTEGER, self.version.number());
            short(out, tag::OCTETS, &self.community);
            wrap(out, self.kind.0, |out| {
                write_signed(out, tag::INTEGER, self.request);
                write_signed(out, tag::INTEGER, self.first);
                write_signed(out, tag::INTEGER, self.second);
                wrap(out, tag::SEQUENCE, |out| {
                    self.bindings.iter().for_each(|binding| binding.encode(out));
                });
            });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use proptest::prelude::*;

    // `snmpget -v1 -c public 192.168.77.50 1.3.6.1.2.1.1.5.0` as net-snmp sends it
    const GET_NAME: [u8; 43] = [
        0x30, 0x29, 0x02, 0x01, 0x00, 0x04, 0x06, b'p', b'u', b'b', b'l', b'i', b'c', 0xA0, 0x1C, 0x02, 0x04,
        0x25, 0x7B, 0xEB, 0x01, 0x02, 0x01, 0x00, 0x02, 0x01, 0x00, 0x30, 0x0E, 0x30, 0x0C, 0x06, 0x08, 0x2B,
        0x06, 0x01, 0x02, 0x01, 0x01, 0x05, 0x00, 0x05, 0x00,
    ];

    #[test]
    fn a_request_of_another_stack() {
        let message = Message::decode(Reader::new(&GET_NAME)).unwrap();
        assert_eq!((message.version, message.kind), (Version::V1, PduKind::GET));
        assert_eq!(message.community, b"public");
        assert_eq!(message.request, 0x257B_EB01);
        assert_eq!(
            message.bindings,
            [Binding {
                name: Oid::from([1, 3, 6, 1, 2, 1, 1, 5, 0]),
                value: Value::Null
            }]
        );
    }

    #[test]
    fn whatever_is_cut_or_too_long_is_refused() {
        for end in 0..GET_NAME.len() {
            assert!(Message::decode(Reader::new(&GET_NAME[..end])).is_err(), "{end}");
        }
        let more = [&GET_NAME[..], &[0]].concat();
        assert!(Message::decode(Reader::new(&more)).is_err());
        for (at, value) in [(4, 3), (13, 0xA4), (13, 0x30), (29, 0x31)] {
            let mut other = GET_NAME;
            other[at] = value;
            assert!(Message::decode(Reader::new(&other)).is_err(), "{at}");
        }
    }

    fn values() -> impl Strategy<Value = Value> {
        prop_oneof![
            any::<i32>().prop_map(Value::Integer),
            proptest::collection::vec(any::<u8>(), 0..300).prop_map(Value::Octets),
            Just(Value::Null),
            proptest::collection::vec(any::<u32>(), 0..20)
                .prop_map(|rest| Value::Oid(Oid::from([1, 3]).with(&rest))),
            any::<u32>().prop_map(|a| Value::IpAddress(a.into())),
            any::<u32>().prop_map(Value::Counter),
            any::<u32>().prop_map(Value::Gauge),
            any::<u32>().prop_map(Value::Ticks),
            any::<u64>().prop_map(Value::Counter64),
            Just(Value::NoSuchObject),
            Just(Value::NoSuchInstance),
            Just(Value::EndOfMib),
            proptest::collection::vec(any::<u8>(), 0..9).prop_map(|o| Value::Other(tag::OPAQUE, o)),
        ]
    }

    proptest! {
        #[test]
        fn messages_come_back(
            request: i32, first: i32, second: i32, values in proptest::collection::vec(values(), 0..6),
            community in proptest::collection::vec(any::<u8>(), 0..20), v1: bool,
        ) {
            let bindings = values.into_iter().zip(0..)
                .map(|(value, n)| Binding { name: Oid::from([1, 3, 6, n]), value }).collect();
            let version = if v1 { Version::V1 } else { Version::V2c };
            let message = Message { version, community, kind: PduKind::RESPONSE, request, first, second, bindings };
            let mut octets = vec![];
            message.encode(&mut octets);
            prop_assert_eq!(Message::decode(Reader::new(&octets)), Ok(message));
            for end in 0..octets.len() {
                prop_assert!(Message::decode(Reader::new(&octets[..end])).is_err());
            }
        }

        #[test]
        fn flipped_bits_are_survived(at in 0..GET_NAME.len(), bit in 0u8..8) {
            let mut octets = GET_NAME;
            octets[at] ^= 1 << bit;
            let _ = Message::decode(Reader::new(&octets));
        }
    }
}
