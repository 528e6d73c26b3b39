//! Errors of a controller.

use alloc::string::String;
use alloc::vec::Vec;
use core::net::Ipv4Addr;
use core::time::Duration;

use crate::MacAddress;
use crate::cyclic::IocrError;
use crate::rpc::{CallError, PathCount};
use crate::wire::dcp::{BlockError, DcpOption, IpRule, NameRule};
use crate::wire::{DecodeError, PnioStatus};

/// An invalid request of the caller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Misuse {
    /// The name breaks a rule.
    #[error("illegal name of station: {0}")]
    Name(#[from] NameRule),
    /// The IP configuration breaks a rule.
    #[error("illegal IP configuration: {0}")]
    Ip(#[from] IpRule),
    /// Cyclic settings break a rule.
    #[error("illegal cyclic settings: {0}")]
    Cyclic(#[from] IocrError),
    /// An address that is not a single station's.
    #[error("{0} is not the address of one station")]
    Address(MacAddress),
    /// A setting out of its range.
    #[error("{0} is out of range")]
    Range(&'static str),
    /// Class 1 frames need legacy start-up.
    #[error("class 1 frames need legacy start-up")]
    ClassAndStartUp,
    /// No connection of this number is open.
    #[error("no such connection")]
    UnknownConnection,
    /// The connection takes no records yet, or no longer.
    #[error("the connection takes no records now")]
    NotOpenYet,
    /// Too many connections or requests at once.
    #[error("too many {0} at once")]
    TooMany(&'static str),
    /// No name of station although it is to be looked up, or no address although it is not.
    #[error("the target has no {0}")]
    Incomplete(&'static str),
    /// Data of another length than agreed, or a submodule that is not part of the connection.
    #[error("no such data in the connection, or another length")]
    NoSuchData,
}

/// Why a service of a device failed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ServiceError {
    /// The device refused it.
    #[error("{what}: {status}")]
    Refused {
        /// The service.
        what: &'static str,
        /// Its reason.
        status: PnioStatus,
    },
    /// No answer, or none in time.
    #[error("{what}: no answer in time{path}")]
    Timeout {
        /// The service.
        what: &'static str,
        /// What became of the requests before: whether frames are lost on the way.
        path: PathCount,
    },
    /// The device's RPC layer did not execute it.
    #[error("{what}: {error}")]
    Call {
        /// The service.
        what: &'static str,
        /// Reason.
        error: CallError,
    },
    /// The answer cannot be decoded.
    #[error("{what}: malformed answer: {error}")]
    Malformed {
        /// The service.
        what: &'static str,
        /// What and where.
        error: DecodeError,
    },
    /// The answer does not belong to the request.
    #[error("{what}: the answer's {field} is not that of the request")]
    Mismatch {
        /// The service.
        what: &'static str,
        /// The field that differs.
        field: &'static str,
    },
    /// The connection ended first.
    #[error("{what}: the connection ended")]
    Closed {
        /// The service.
        what: &'static str,
    },
    /// The parameter channel was busy, or its answer not ready, for the whole time allowed.
    #[error("parameter access: not ready within {} ms ({status})", limit.as_millis())]
    NotReady {
        /// Time allowed.
        limit: Duration,
        /// Last status from the device.
        status: PnioStatus,
    },
}

/// Why a DCP request failed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DcpError {
    /// No answer.
    #[error("no answer from {mac} after {sends} DCP requests")]
    Timeout {
        /// Address of the station.
        mac: MacAddress,
        /// How often.
        sends: u8,
    },
    /// The station refused.
    #[error("{option}: {error}")]
    Refused {
        /// What was requested.
        option: DcpOption,
        /// Reason.
        error: BlockError,
    },
    /// The station does not support the service.
    #[error("the station does not support this DCP service")]
    NotSupported,
    /// The answer cannot be decoded.
    #[error("malformed DCP answer: {0}")]
    Malformed(#[from] DecodeError),
    /// The answer lacks the requested option.
    #[error("the DCP answer has no result for {0}")]
    Missing(DcpOption),
}

/// Why a connection was not made, or ended.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LostCause {
    /// No station of this name answered.
    #[error("no station named {name:?} answered")]
    NoStation {
        /// The name.
        name: String,
    },
    /// Several stations have this name.
    #[error("{} stations are named {name:?}: {macs:?}", macs.len())]
    SeveralStations {
        /// The name.
        name: String,
        /// Their addresses.
        macs: Vec<MacAddress>,
    },
    /// The station is another device than expected.
    #[error("{name:?} is vendor 0x{:04X} device 0x{:04X}, expected vendor 0x{:04X} device 0x{:04X}", found.0, found.1, expected.0, expected.1)]
    WrongDevice {
        /// The name.
        name: String,
        /// Vendor and device expected.
        expected: (u16, u16),
        /// Vendor and device found.
        found: (u16, u16),
    },
    /// The station of this name has another Ethernet address than expected.
    #[error("{name:?} is {found}, expected {expected}")]
    OtherMac {
        /// The name.
        name: String,
        /// Expected.
        expected: MacAddress,
        /// Found.
        found: MacAddress,
    },
    /// The station has no IP address and none was to be set.
    #[error("{name:?} has no IP address")]
    NoIp {
        /// The name.
        name: String,
    },
    /// The station has another IP address and none was to be set.
    #[error("{name:?} has the address {found}, expected {expected}")]
    OtherIp {
        /// The name.
        name: String,
        /// Expected.
        expected: Ipv4Addr,
        /// Found.
        found: Ipv4Addr,
    },
    /// The address could not be set.
    #[error("setting the IP address: {0}")]
    SetIp(DcpError),
    /// A service of the start-up failed.
    #[error(transparent)]
    Service(#[from] ServiceError),
    /// A start-up record was refused.
    #[error("record 0x{index:04X} of slot {slot} subslot 0x{subslot:X}: {error}")]
    StartupRecord {
        /// Slot.
        slot: u16,
        /// Subslot.
        subslot: u16,
        /// Index.
        index: u16,
        /// Reason.
        error: ServiceError,
    },
    /// The device did not become ready.
    #[error("the device did not become ready within {} s", limit.as_secs())]
    ReadyTimeout {
        /// Time allowed.
        limit: Duration,
    },
    /// No cyclic data for too long.
    #[error("no cyclic data for {} ms", hold.as_millis())]
    Watchdog {
        /// Time allowed.
        hold: Duration,
    },
    /// The device ended the connection.
    #[error("ended by the device: {0}")]
    AbortedByPeer(PnioStatus),
    /// The device acknowledges no alarm PDUs any more.
    #[error("the device does not acknowledge alarms")]
    AlarmChannel,
    /// Ended by the caller without release.
    #[error("aborted")]
    Aborted,
}
