//! Connectionless DCE RPC, version 4, as PROFINET uses it over UDP.
//!
//! C706 "DCE 1.1: Remote Procedure Call" chapter 12; IEC 61158-6-10.

mod epm;
mod ndr;

pub use epm::{
    EPM_LOOKUP, EPM_LOOKUP_FREE, EPM_NOT_REGISTERED, EpmEntry, EpmHandle, LookupRequest, LookupResponse,
    MAX_ENTRIES, MAX_TOWER,
};
pub use ndr::{NDR_LENGTH, NdrRequest, NdrResponse};

use super::{ByteOrder, DecodeError, Problem, Reader, Uuid, Writer};

/// Octets of the RPC header.
pub const HEADER_LENGTH: usize = 80;
/// Largest RPC PDU, header included, that is sent or taken.
pub const MAX_PDU: usize = 1464;
/// Largest body of one PDU.
pub const MAX_BODY: usize = MAX_PDU - HEADER_LENGTH;

/// Operations of the device interface; [`CONTROL`](operation::CONTROL) is also the controller's only one.
pub mod operation {
    /// Opens an application AR.
    pub const CONNECT: u16 = 0;
    /// Closes it.
    pub const RELEASE: u16 = 1;
    /// Reads a record.
    pub const READ: u16 = 2;
    /// Writes one or more records.
    pub const WRITE: u16 = 3;
    /// PrmEnd, ApplicationReady and the like.
    pub const CONTROL: u16 = 4;
    /// Reads a record without an application AR.
    pub const READ_IMPLICIT: u16 = 5;
    /// How many operations the device interface has.
    pub const COUNT: u16 = 6;
}

/// Status words of reject and fault PDUs.
pub mod reject {
    /// Operation number out of range.
    pub const OP_RANGE: u32 = 0x1C01_0002;
    /// Unknown interface.
    pub const UNKNOWN_INTERFACE: u32 = 0x1C01_0003;
    /// RPC version mismatch.
    pub const VERSION_MISMATCH: u32 = 0x1C00_0008;
    /// Unspecified reject.
    pub const UNSPECIFIED: u32 = 0x1C00_0009;
    /// Wrong boot time.
    pub const WRONG_BOOT_TIME: u32 = 0x1C01_0006;
    /// Protocol error, for example a PDU that is too long.
    pub const PROTOCOL_ERROR: u32 = 0x1C01_000B;
    /// Server too busy.
    pub const TOO_BUSY: u32 = 0x1C01_0014;
    /// Words of a status.
    const WORDS: &[(u32, &str)] = &[
        (OP_RANGE, "operation out of range"),
        (UNKNOWN_INTERFACE, "unknown interface"),
        (VERSION_MISMATCH, "RPC version mismatch"),
        (UNSPECIFIED, "unspecified reject"),
        (WRONG_BOOT_TIME, "wrong boot time"),
        (0x1C01_0009, "the server restarted"),
        (PROTOCOL_ERROR, "protocol error"),
        (0x1C01_0013, "answer too long"),
        (TOO_BUSY, "server too busy"),
        (0x1C01_0017, "unsupported type"),
        (0x16C9_A0D6, "endpoint not registered"),
    ];

    /// Meaning of a reject or fault status, if it is a known one.
    #[must_use]
    pub fn words(status: u32) -> Option<&'static str> {
        WORDS.iter().find(|row| row.0 == status).map(|row| row.1)
    }
}

/// Kind of an RPC PDU.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PacketType {
    /// A call.
    Request,
    /// Requests the state of a call.
    Ping,
    /// The answer to a call.
    Response,
    /// The call was executed and failed.
    Fault,
    /// Still busy with the call.
    Working,
    /// The server never received the call.
    NoCall,
    /// The call was not executed.
    Reject,
    /// The client got the response.
    Ack,
    /// The client gives up.
    Cancel,
    /// Acknowledges a fragment.
    Fack,
    /// Answer to a cancel.
    CancelAck,
    /// Anything else (low five bits).
    Other(u8),
}

/// Numbers of the packet types.
const PACKET_TYPES: [PacketType; 11] = [
    PacketType::Request,
    PacketType::Ping,
    PacketType::Response,
    PacketType::Fault,
    PacketType::Working,
    PacketType::NoCall,
    PacketType::Reject,
    PacketType::Ack,
    PacketType::Cancel,
    PacketType::Fack,
    PacketType::CancelAck,
];

impl PacketType {
    /// Returns the kind of a number (low five bits count).
    #[must_use]
    pub fn from_code(code: u8) -> Self {
        let code = code & 0x1F;
        PACKET_TYPES
            .get(usize::from(code))
            .copied()
            .unwrap_or(Self::Other(code))
    }

    /// Returns the number.
    #[must_use]
    pub fn code(self) -> u8 {
        match self {
            Self::Request => 0,
            Self::Ping => 1,
            Self::Response => 2,
            Self::Fault => 3,
            Self::Working => 4,
            Self::NoCall => 5,
            Self::Reject => 6,
            Self::Ack => 7,
            Self::Cancel => 8,
            Self::Fack => 9,
            Self::CancelAck => 10,
            Self::Other(code) => code & 0x1F,
        }
    }
}

/// First flag octet of an RPC header.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Flags(pub u8);

impl Flags {
    /// Last fragment.
    pub const LAST_FRAGMENT: u8 = 0x02;
    /// The PDU is a fragment.
    pub const FRAGMENT: u8 = 0x04;
    /// The receiver need not acknowledge the fragment.
    pub const NO_FACK: u8 = 0x08;
    /// No answer requested.
    pub const MAYBE: u8 = 0x10;
    /// May be executed twice.
    pub const IDEMPOTENT: u8 = 0x20;
    /// Broadcast.
    pub const BROADCAST: u8 = 0x40;

    /// Returns true when the PDU is one of several.
    #[must_use]
    pub const fn is_fragment(self) -> bool {
        self.0 & Self::FRAGMENT != 0
    }

    /// Returns true for the last fragment.
    #[must_use]
    pub const fn is_last(self) -> bool {
        self.0 & Self::LAST_FRAGMENT != 0
    }

    /// Returns true when the sender does not wait for an acknowledgement of the fragment.
    #[must_use]
    pub const fn no_fack(self) -> bool {
        self.0 & Self::NO_FACK != 0
    }
}

/// The RPC header.
///
/// IEC 61158-6-10, RPC-PDU; 80 octets. `order` is the byte order of the numbers and UUIDs.
///
/// ```
/// use profidrive_profinet::wire::rpc::{Header, PacketType, operation};
/// use profidrive_profinet::wire::Uuid;
/// let header = Header::request(Uuid::object(1, 1, 0x0105), Uuid::DEVICE_INTERFACE, Uuid::NIL, 0, operation::READ);
/// let mut pdu = Vec::new();
/// header.encode(&mut pdu, 0);
/// let (back, body) = Header::decode(&pdu).unwrap();
/// assert_eq!(back.packet_type, PacketType::Request);
/// assert!(body.is_empty());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Header {
    /// Kind of PDU.
    pub packet_type: PacketType,
    /// First flag octet.
    pub flags: Flags,
    /// Second flag octet.
    pub flags2: u8,
    /// Byte order of the sender.
    pub order: ByteOrder,
    /// Counts the PDUs sent, repetitions included.
    pub serial: u16,
    /// Target object.
    pub object: Uuid,
    /// Interface.
    pub interface: Uuid,
    /// The client's activity.
    pub activity: Uuid,
    /// Start of the server, 0 if unknown.
    pub server_boot: u32,
    /// Version of the interface: 1, endpoint mapper 3.
    pub interface_version: u32,
    /// Number of the call in the activity.
    pub sequence: u32,
    /// Operation, see [`operation`].
    pub operation: u16,
    /// Interface hint, 0xFFFF for none.
    pub interface_hint: u16,
    /// Activity hint, 0xFFFF for none.
    pub activity_hint: u16,
    /// Number of the fragment, from 0.
    pub fragment: u16,
    /// Authentication protocol, 0.
    pub authentication: u8,
}

impl Header {
    /// Header of a request in big-endian order and of interface version 1.
    #[must_use]
    pub const fn request(
        object: Uuid,
        interface: Uuid,
        activity: Uuid,
        sequence: u32,
        operation: u16,
    ) -> Self {
        Self {
            packet_type: PacketType::Request,
            flags: Flags(Flags::IDEMPOTENT),
            flags2: 0,
            order: ByteOrder::Big,
            serial: 0,
            object,
            interface,
            activity,
            server_boot: 0,
            interface_version: 1,
            sequence,
            operation,
            interface_hint: 0xFFFF,
            activity_hint: 0xFFFF,
            fragment: 0,
            authentication: 0,
        }
    }

    /// Header of an answer to this PDU: everything echoed but kind, flags, fragment and serial number.
    #[must_use]
    pub const fn reply(&self, packet_type: PacketType) -> Self {
        Self {
            packet_type,
            flags: Flags(0),
            flags2: 0,
            fragment: 0,
            serial: 0,
            authentication: 0,
            ..*self
        }
    }

    /// Reads a PDU: its header and the body the header announces. Octets behind the body are ignored.
    ///
    /// # Errors
    /// When the data is shorter than the length in the header, or the RPC version is not 4.
    pub fn decode(pdu: &[u8]) -> Result<(Self, &[u8]), DecodeError> {
        Self::read(Reader::new(pdu))
    }

    /// The same from a reader.
    ///
    /// # Errors
    /// When the data is shorter than the length in the header, or the RPC version is not 4.
    pub fn read(mut r: Reader<'_>) -> Result<(Self, &[u8]), DecodeError> {
        let version = r.u8("rpc_vers")?;
        if version != 4 {
            let problem = Problem::Expected {
                expected: 4,
                found: version.into(),
            };
            return Err(r.error("rpc_vers", 1, problem));
        }
        let packet_type = PacketType::from_code(r.u8("ptype")?);
        let flags = Flags(r.u8("flags1")?);
        let flags2 = r.u8("flags2")?;
        let drep = r.array::<3>("drep")?;
        let order = match drep[0] >> 4 {
            0 => ByteOrder::Big,
            1 => ByteOrder::Little,
            found => return Err(r.error("drep", 3, Problem::Invalid { found: found.into() })),
        };
        let serial_high = r.u8("serial_hi")?;
        let object = Uuid::decode(&mut r, order, "object")?;
        let interface = Uuid::decode(&mut r, order, "interface")?;
        let activity = Uuid::decode(&mut r, order, "activity")?;
        let server_boot = r.u32_in(order, "server_boot")?;
        let interface_version = r.u32_in(order, "if_vers")?;
        let sequence = r.u32_in(order, "seqnum")?;
        let operation = r.u16_in(order, "opnum")?;
        let interface_hint = r.u16_in(order, "ihint")?;
        let activity_hint = r.u16_in(order, "ahint")?;
        let length = r.u16_in(order, "len")?;
        let fragment = r.u16_in(order, "fragnum")?;
        let authentication = r.u8("auth_proto")?;
        let serial = u16::from_be_bytes([serial_high, r.u8("serial_lo")?]);
        let body = r.bytes(length.into(), "body")?;
        let header = Self {
            packet_type,
            flags,
            flags2,
            order,
            serial,
            object,
            interface,
            activity,
            server_boot,
            interface_version,
            sequence,
            operation,
            interface_hint,
            activity_hint,
            fragment,
            authentication,
        };
        Ok((header, body))
    }

    /// Writes the header of a PDU whose body has `length` octets (at most [`MAX_BODY`]).
    pub fn encode(&self, out: &mut impl Writer, length: usize) {
        let order = self.order;
        let [serial_high, serial_low] = self.serial.to_be_bytes();
        out.bytes(&[4, self.packet_type.code(), self.flags.0, self.flags2]);
        out.u8(match order {
            ByteOrder::Big => 0x00,
            ByteOrder::Little => 0x10,
        });
        out.bytes(&[0, 0, serial_high]);
        self.object.encode(out, order);
        self.interface.encode(out, order);
        self.activity.encode(out, order);
        out.u32_in(order, self.server_boot);
        out.u32_in(order, self.interface_version);
        out.u32_in(order, self.sequence);
        out.u16_in(order, self.operation);
        out.u16_in(order, self.interface_hint);
        out.u16_in(order, self.activity_hint);
        out.u16_in(order, u16::try_from(length).unwrap_or(u16::MAX));
        out.u16_in(order, self.fragment);
        out.bytes(&[self.authentication, serial_low]);
    }
}

/// Body of a fragment acknowledgement; peers may also send none.
///
/// C706 chapter 12, fack body; 16 octets without selective acknowledgements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FackBody {
    /// Fragments the receiver takes before the next acknowledgement.
    pub window: u16,
    /// Largest datagram of the receiver.
    pub max_tsdu: u32,
    /// Largest fragment of the receiver.
    pub max_fragment: u32,
    /// Serial number of the PDU being acknowledged.
    pub serial: u16,
}

impl FackBody {
    /// Fragmentation of this implementation: one fragment at a time, up to [`MAX_PDU`].
    #[must_use]
    pub const fn new(serial: u16) -> Self {
        Self {
            window: 1,
            max_tsdu: MAX_PDU as u32,
            max_fragment: MAX_PDU as u32,
            serial,
        }
    }

    /// Reads a body; selective acknowledgements behind it are ignored.
    ///
    /// # Errors
    /// When it is too short or of another version.
    pub fn decode(body: &[u8], order: ByteOrder) -> Result<Self, DecodeError> {
        let mut r = Reader::with_base(body, HEADER_LENGTH);
        let version = r.u8("fack version")?;
        if version != 0 {
            return Err(r.error(
                "fack version",
                1,
                Problem::Expected {
                    expected: 0,
                    found: version.into(),
                },
            ));
        }
        r.skip(1, "fack padding")?;
        let window = r.u16_in(order, "window_size")?;
        let max_tsdu = r.u32_in(order, "max_tsdu")?;
        let max_fragment = r.u32_in(order, "max_frag_size")?;
        let serial = r.u16_in(order, "serial_num")?;
        r.skip(2, "selack_len")?;
        Ok(Self {
            window,
            max_tsdu,
            max_fragment,
            serial,
        })
    }

    /// Writes 16 octets.
    pub fn encode(&self, out: &mut impl Writer, order: ByteOrder) {
        out.bytes(&[0, 0]);
        out.u16_in(order, self.window);
        out.u32_in(order, self.max_tsdu);
        out.u32_in(order, self.max_fragment);
        out.u16_in(order, self.serial);
        out.u16_in(order, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    fn uuid() -> impl Strategy<Value = Uuid> {
        any::<[u8; 16]>().prop_map(Uuid)
    }

    prop_compose! {
        fn header()(
            code in 0u8..32, flags: u8, flags2: u8, little: bool, serial: u16, object in uuid(),
            interface in uuid(), activity in uuid(), server_boot: u32, (interface_version, sequence) in any::<(u32, u32)>(),
            (operation, interface_hint, activity_hint, fragment) in any::<(u16, u16, u16, u16)>(), authentication: u8,
        ) -> Header {
            Header {
                packet_type: PacketType::from_code(code), flags: Flags(flags), flags2,
                order: if little { ByteOrder::Little } else { ByteOrder::Big },
                serial, object, interface, activity, server_boot, interface_version, sequence, operation,
                interface_hint, activity_hint, fragment, authentication,
            }
        }
    }

    proptest! {
        #[test]
        fn headers_survive_the_wire(header in header(), body in proptest::collection::vec(any::<u8>(), 0..40)) {
            let mut pdu = Vec::new();
            header.encode(&mut pdu, body.len());
            prop_assert_eq!(pdu.len(), HEADER_LENGTH);
            pdu.extend_from_slice(&body);
            prop_assert_eq!(Header::decode(&pdu), Ok((header, &body[..])));
            for end in 0..pdu.len() {
                prop_assert!(Header::decode(&pdu[..end]).is_err());
            }
        }

        #[test]
        fn facks_survive_the_wire(window: u16, max_tsdu: u32, max_fragment: u32, serial: u16, little: bool) {
            let order = if little { ByteOrder::Little } else { ByteOrder::Big };
            let fack = FackBody { window, max_tsdu, max_fragment, serial };
            let mut out = Vec::new();
            fack.encode(&mut out, order);
            prop_assert_eq!(FackBody::decode(&out, order), Ok(fack));
            for end in 0..out.len() {
                prop_assert!(FackBody::decode(&out[..end], order).is_err());
            }
        }
    }

    #[test]
    fn packet_types_keep_their_number() {
        for code in 0..32 {
            assert_eq!(PacketType::from_code(code).code(), code);
        }
    }
}
