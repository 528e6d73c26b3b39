//! PNIO status: the result of a service in four octets.

mod words;

use core::fmt;

use words::{ABORT_WORDS, PROTOCOL_WORDS, RECORD_WORDS};

use super::{DecodeError, Reader, Writer};

/// Result of a PROFINET service: error code, error decode, error code 1 and 2; all zero is success.
///
/// IEC 61158-6-10, coding of the field PNIOStatus.
///
/// ```
/// use profidrive_profinet::wire::PnioStatus;
/// let status = PnioStatus::from_u32(0xDE80_B000);
/// assert_eq!(status.to_string(), "DE 80 B0 00: read refused, invalid index");
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct PnioStatus {
    /// ErrorCode: which service.
    pub code: u8,
    /// ErrorDecode: how to read the next two (0x80 record access, 0x81 protocol, 0x82 manufacturer).
    pub decode: u8,
    /// ErrorCode1.
    pub code1: u8,
    /// ErrorCode2.
    pub code2: u8,
}

/// ErrorDecode of record access errors (PNIORW).
pub const DECODE_RECORD: u8 = 0x80;
/// ErrorDecode of protocol errors (PNIO).
pub const DECODE_PROTOCOL: u8 = 0x81;
/// ErrorCode1 of the RTA protocol class, used with [`Service::Rta`].
pub const RTA_ERROR_CLASS: u8 = 0xFD;

/// ErrorCode: the service a status belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Service {
    /// No error.
    Ok,
    /// Another PROFINET error, 0x81.
    Pnio,
    /// ERR-RTA PDU, 0xCF.
    Rta,
    /// Alarm acknowledgement, 0xDA.
    AlarmAck,
    /// Connect, 0xDB.
    Connect,
    /// Release, 0xDC.
    Release,
    /// Control, 0xDD.
    Control,
    /// Record read, 0xDE.
    Read,
    /// Record write, 0xDF.
    Write,
    /// A code without a name here.
    Other(u8),
}

/// Code and words of every service.
const SERVICES: &[(u8, Service, &str)] = &[
    (0x00, Service::Ok, "ok"),
    (0x81, Service::Pnio, "service refused"),
    (0xCF, Service::Rta, "connection aborted"),
    (0xDA, Service::AlarmAck, "alarm acknowledged with an error"),
    (0xDB, Service::Connect, "connect refused"),
    (0xDC, Service::Release, "release refused"),
    (0xDD, Service::Control, "control refused"),
    (0xDE, Service::Read, "read refused"),
    (0xDF, Service::Write, "write refused"),
];

impl Service {
    /// Returns the number on the wire.
    #[must_use]
    pub fn code(self) -> u8 {
        match self {
            Self::Other(code) => code,
            named => SERVICES.iter().find(|row| row.1 == named).map_or(0, |row| row.0),
        }
    }

    /// Returns the service of a number; every number has one.
    #[must_use]
    pub fn from_code(code: u8) -> Self {
        SERVICES
            .iter()
            .find(|row| row.0 == code)
            .map_or(Self::Other(code), |row| row.1)
    }
}

/// ErrorCode1 of record access ([`DECODE_RECORD`]): class in the high, code in the low half.
pub mod record {
    /// Application could not read.
    pub const READ_ERROR: u8 = 0xA0;
    /// Application could not write.
    pub const WRITE_ERROR: u8 = 0xA1;
    /// Module failure.
    pub const MODULE_FAILURE: u8 = 0xA2;
    /// Application busy.
    pub const BUSY: u8 = 0xA7;
    /// Version conflict.
    pub const VERSION_CONFLICT: u8 = 0xA8;
    /// Feature not supported.
    pub const NOT_SUPPORTED: u8 = 0xA9;
    /// The index is not known.
    pub const INVALID_INDEX: u8 = 0xB0;
    /// The length of the written record is wrong.
    pub const LENGTH: u8 = 0xB1;
    /// No such slot or subslot.
    pub const INVALID_SLOT: u8 = 0xB2;
    /// Type conflict.
    pub const TYPE_CONFLICT: u8 = 0xB3;
    /// No such API.
    pub const INVALID_AREA: u8 = 0xB4;
    /// Not in this state: wrong phase of the connection, parameter channel busy or empty.
    pub const STATE_CONFLICT: u8 = 0xB5;
    /// Access denied.
    pub const ACCESS_DENIED: u8 = 0xB6;
    /// Value out of range.
    pub const INVALID_RANGE: u8 = 0xB7;
    /// Invalid parameter.
    pub const INVALID_PARAMETER: u8 = 0xB8;
    /// Invalid type.
    pub const INVALID_TYPE: u8 = 0xB9;
    /// The connection is a backup.
    pub const BACKUP: u8 = 0xBA;
    /// Resource busy.
    pub const RESOURCE_BUSY: u8 = 0xC2;
    /// Resource unavailable.
    pub const RESOURCE_UNAVAILABLE: u8 = 0xC3;
}

/// ErrorCode2 of the RTA protocol class: why a connection was aborted.
pub mod abort {
    /// Sequence error.
    pub const SEQUENCE: u8 = 0x01;
    /// Instance closed.
    pub const CLOSED: u8 = 0x02;
    /// Data hold time or watchdog expired.
    pub const DATA_HOLD: u8 = 0x05;
    /// CMI activity time-out during start-up.
    pub const ACTIVITY_TIMEOUT: u8 = 0x06;
    /// Alarm could not be sent.
    pub const ALARM_SEND: u8 = 0x08;
    /// Alarm acknowledgement could not be sent.
    pub const ALARM_ACK_SEND: u8 = 0x09;
    /// AR abort request.
    pub const ABORT_REQUEST: u8 = 0x0D;
    /// A new connect of the same controller ended the old AR.
    pub const RERUN: u8 = 0x0E;
    /// Release received.
    pub const RELEASED: u8 = 0x0F;
    /// Protocol violation.
    pub const PROTOCOL_VIOLATION: u8 = 0x12;
    /// No confirmation of ApplicationReady.
    pub const CONTROL_ERROR: u8 = 0x18;
    /// Name of station changed by DCP.
    pub const NAME_CHANGED: u8 = 0x1F;
    /// Reset to factory by DCP.
    pub const FACTORY_RESET: u8 = 0x20;
    /// The controller waited in vain for ApplicationReady.
    pub const READY_TIMEOUT: u8 = 0x28;
    /// Abort requested by the user.
    pub const USER: u8 = 0xFF;
}

impl PnioStatus {
    /// Success.
    pub const OK: Self = Self {
        code: 0,
        decode: 0,
        code1: 0,
        code2: 0,
    };

    /// From its four octets in the order of the standard.
    #[must_use]
    pub const fn new(code: u8, decode: u8, code1: u8, code2: u8) -> Self {
        Self {
            code,
            decode,
            code1,
            code2,
        }
    }

    /// From a number whose most significant octet is the error code.
    #[must_use]
    pub const fn from_u32(value: u32) -> Self {
        let [code, decode, code1, code2] = value.to_be_bytes();
        Self {
            code,
            decode,
            code1,
            code2,
        }
    }

    /// As a number whose most significant octet is the error code.
    #[must_use]
    pub const fn to_u32(self) -> u32 {
        u32::from_be_bytes([self.code, self.decode, self.code1, self.code2])
    }

    /// Creates a record read refused: DE 80 `code1` 00, see [`record`].
    #[must_use]
    pub const fn read(code1: u8) -> Self {
        Self::new(0xDE, DECODE_RECORD, code1, 0)
    }

    /// Creates a record write refused: DF 80 `code1` 00, see [`record`].
    #[must_use]
    pub const fn write(code1: u8) -> Self {
        Self::new(0xDF, DECODE_RECORD, code1, 0)
    }

    /// Creates a connect refused: DB 81 `code1` `code2`.
    #[must_use]
    pub const fn connect(code1: u8, code2: u8) -> Self {
        Self::new(0xDB, DECODE_PROTOCOL, code1, code2)
    }

    /// Creates a control service refused: DD 81 `code1` `code2`.
    #[must_use]
    pub const fn control(code1: u8, code2: u8) -> Self {
        Self::new(0xDD, DECODE_PROTOCOL, code1, code2)
    }

    /// Creates a release refused: DC 81 `code1` `code2`.
    #[must_use]
    pub const fn release(code1: u8, code2: u8) -> Self {
        Self::new(0xDC, DECODE_PROTOCOL, code1, code2)
    }

    /// Returns the status of an aborted connection: CF 81 FD `cause`, see [`abort`].
    #[must_use]
    pub const fn aborted(cause: u8) -> Self {
        Self::new(0xCF, DECODE_PROTOCOL, RTA_ERROR_CLASS, cause)
    }

    /// Returns true for success.
    #[must_use]
    pub const fn is_ok(self) -> bool {
        self.to_u32() == 0
    }

    /// Returns the service the status belongs to.
    #[must_use]
    pub fn service(self) -> Service {
        Service::from_code(self.code)
    }

    /// Returns true when a record access was refused for its state (code1 0xB5), for example a parameter answer that is
    /// not ready yet.
    #[must_use]
    pub const fn is_state_conflict(self) -> bool {
        self.decode == DECODE_RECORD && self.code1 == record::STATE_CONFLICT
    }

    /// Meaning of the service code in words.
    #[must_use]
    pub fn service_words(self) -> Option<&'static str> {
        SERVICES.iter().find(|row| row.0 == self.code).map(|row| row.2)
    }

    /// Meaning of ErrorCode1 in words.
    #[must_use]
    pub fn cause_words(self) -> Option<&'static str> {
        match (self.decode, self.code1) {
            (DECODE_RECORD, code1) => RECORD_WORDS.iter().find(|row| row.0 == code1).map(|row| row.1),
            (DECODE_PROTOCOL, RTA_ERROR_CLASS) => ABORT_WORDS
                .iter()
                .find(|row| row.0 == self.code2)
                .map(|row| row.1),
            (DECODE_PROTOCOL, code1) => PROTOCOL_WORDS.iter().find(|row| row.0 == code1).map(|row| row.1),
            _ => None,
        }
    }

    /// Meaning of ErrorCode2 in words, where ErrorCode1 gives it one.
    #[must_use]
    pub fn detail_words(self) -> Option<&'static str> {
        if self.decode != DECODE_PROTOCOL || self.code1 == RTA_ERROR_CLASS {
            return None;
        }
        let row = PROTOCOL_WORDS.iter().find(|row| row.0 == self.code1)?;
        row.2
            .get(usize::from(self.code2))
            .copied()
            .filter(|words| !words.is_empty())
    }

    /// Reads four octets, error code first.
    ///
    /// # Errors
    /// When fewer than four are left.
    pub fn decode(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        Ok(Self::from_u32(reader.u32("PNIOStatus")?))
    }

    /// Writes four octets, error code first.
    pub fn encode(self, out: &mut impl Writer) {
        out.u32(self.to_u32());
    }
}

impl fmt::Display for PnioStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            code,
            decode,
            code1,
            code2,
        } = *self;
        if self.is_ok() {
            return f.write_str("ok");
        }
        write!(f, "{code:02X} {decode:02X} {code1:02X} {code2:02X}")?;
        if let Some(service) = self.service_words() {
            write!(f, ": {service}")?;
        }
        if let Some(cause) = self.cause_words() {
            write!(f, ", {cause}")?;
        }
        if let Some(detail) = self.detail_words() {
            write!(f, ": {detail}")?;
        }
        Ok(())
    }
}

impl fmt::Debug for PnioStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;
    use alloc::vec::Vec;

    #[test]
    fn every_status_survives_the_wire() {
        for value in [0, 0xDE80_B500, 0xDB81_0207, 0xCF81_FD05, 0x1234_5678] {
            let status = PnioStatus::from_u32(value);
            let mut out = Vec::new();
            status.encode(&mut out);
            assert_eq!(out, value.to_be_bytes());
            assert_eq!(PnioStatus::decode(&mut Reader::new(&out)), Ok(status));
        }
    }

    #[test]
    fn services_keep_their_number() {
        for code in 0..=255 {
            assert_eq!(Service::from_code(code).code(), code);
        }
    }

    #[test]
    fn words_are_found() {
        let words = |value| PnioStatus::from_u32(value).to_string();
        assert_eq!(words(0), "ok");
        assert_eq!(words(0xDE80_B500), "DE 80 B5 00: read refused, state conflict");
        assert_eq!(
            words(0xDB81_0207),
            "DB 81 02 07: connect refused, faulty IOCRBlockReq: IOCRProperties"
        );
        assert_eq!(
            words(0xDB81_4004),
            "DB 81 40 04: connect refused, RPC: out of AR resources"
        );
        assert_eq!(
            words(0xCF81_FD05),
            "CF 81 FD 05: connection aborted, data hold time expired"
        );
        assert_eq!(words(0x1122_3344), "11 22 33 44");
    }
}
