//! Alarm frames: the RTA header, notifications and their acknowledgement, diagnosis items.
//!
//! Source: IEC 61158-6-10, RTA-PDU and alarm blocks. Everything here starts behind the FrameID 0xFC01 or 0xFE01.

mod diagnosis;
mod notification;

pub use diagnosis::{ChannelDiagnosis, DiagnosisItem, DiagnosisItems, Severity, Specifier};
pub use notification::{Alarm, AlarmAck, AlarmSpecifier, AlarmType, Notification, Priority};

use super::{DecodeError, Problem, Reader, Writer};
use crate::wire::PnioStatus;

/// Octets of the RTA header.
pub const HEADER: usize = 12;

/// PDUType.Type: what an RTA PDU is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RtaType {
    /// Carries a notification or an acknowledgement, 1.
    Data,
    /// The sequence number was not the expected one, 2.
    Nack,
    /// Received, 3.
    Ack,
    /// Ends the connection, 4.
    Err,
    /// Any other number.
    Other(u8),
}

impl From<u8> for RtaType {
    fn from(code: u8) -> Self {
        match code {
            1 => Self::Data,
            2 => Self::Nack,
            3 => Self::Ack,
            4 => Self::Err,
            other => Self::Other(other),
        }
    }
}

impl From<RtaType> for u8 {
    fn from(kind: RtaType) -> Self {
        match kind {
            RtaType::Data => 1,
            RtaType::Nack => 2,
            RtaType::Ack => 3,
            RtaType::Err => 4,
            RtaType::Other(other) => other,
        }
    }
}

/// One RTA PDU.
///
/// ```
/// use profidrive_profinet::wire::alarm::{RtaPdu, RtaType};
/// let bytes = [0, 1, 0, 1, 0x13, 0x01, 0xFF, 0xFE, 0xFF, 0xFF, 0, 0];
/// let pdu = RtaPdu::parse(&bytes).unwrap();
/// assert_eq!((pdu.kind, pdu.send_sequence, pdu.ack_sequence), (RtaType::Ack, 0xFFFE, 0xFFFF));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RtaPdu<'a> {
    /// LocalAlarmReference of the receiver.
    pub destination: u16,
    /// LocalAlarmReference of the sender.
    pub source: u16,
    /// What it is.
    pub kind: RtaType,
    /// Version in the high half of PDUType; 1.
    pub version: u8,
    /// AddFlags: window size 1 and, for data, bit 4 "acknowledge".
    pub flags: u8,
    /// SendSeqNum.
    pub send_sequence: u16,
    /// AckSeqNum.
    pub ack_sequence: u16,
    /// The variable part.
    pub data: &'a [u8],
}

impl<'a> RtaPdu<'a> {
    /// AddFlags of data: window 1, acknowledge.
    pub const FLAGS_DATA: u8 = 0x11;
    /// AddFlags of everything else: window 1.
    pub const FLAGS: u8 = 0x01;

    /// Reads header and variable part; what follows is padding of the frame.
    ///
    /// # Errors
    /// When the octets end too early.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, DecodeError> {
        Self::decode(Reader::new(bytes))
    }

    /// The same from a reader.
    ///
    /// # Errors
    /// When the octets end too early.
    pub fn decode(mut r: Reader<'a>) -> Result<Self, DecodeError> {
        let destination = r.u16("AlarmDstEndpoint")?;
        let source = r.u16("AlarmSrcEndpoint")?;
        let kind = r.u8("RTA PDUType")?;
        let flags = r.u8("RTA AddFlags")?;
        let send_sequence = r.u16("RTA SendSeqNum")?;
        let ack_sequence = r.u16("RTA AckSeqNum")?;
        let length = r.u16("RTA VarPartLen")?;
        let data = r.bytes(usize::from(length), "RTA variable part")?;
        Ok(Self {
            destination,
            source,
            kind: RtaType::from(kind & 0x0F),
            version: kind >> 4,
            flags,
            send_sequence,
            ack_sequence,
            data,
        })
    }

    /// Writes header and variable part.
    pub fn encode(&self, out: &mut impl Writer) {
        out.u16(self.destination);
        out.u16(self.source);
        out.u8(u8::from(self.kind) & 0x0F | self.version << 4);
        out.u8(self.flags);
        out.u16(self.send_sequence);
        out.u16(self.ack_sequence);
        out.u16(u16::try_from(self.data.len()).unwrap_or(u16::MAX));
        out.bytes(self.data);
    }

    /// Returns the status of an ERR PDU.
    ///
    /// # Errors
    /// When this is not an ERR PDU or its variable part has fewer than four octets.
    pub fn error(&self) -> Result<PnioStatus, DecodeError> {
        if self.kind != RtaType::Err {
            return Err(DecodeError {
                what: "RTA PDUType",
                offset: 4,
                problem: Problem::Expected {
                    expected: 4,
                    found: u64::from(u8::from(self.kind)),
                },
            });
        }
        PnioStatus::decode(&mut Reader::with_base(self.data, HEADER))
    }

    /// Returns the alarm of a data PDU.
    ///
    /// # Errors
    /// When the variable part is not a complete alarm block.
    pub fn alarm(&self) -> Result<Alarm<'a>, DecodeError> {
        Alarm::decode(Reader::with_base(self.data, HEADER))
    }
}

#[cfg(test)]
mod tests;
