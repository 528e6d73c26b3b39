//! Events of a controller for its application.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use super::error::{DcpError, LostCause, ServiceError};
use crate::wire::PnioStatus;
use crate::wire::alarm::Notification;
use crate::wire::block::ModuleDiff;
use crate::wire::dcp::DcpOption;
use crate::{IpSuite, MacAddress};

/// Names an application AR of a controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ArId {
    pub(super) slot: u16,
    pub(super) generation: u16,
}

impl fmt::Display for ArId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AR {}.{}", self.slot, self.generation)
    }
}

/// Names a DCP request of a controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct DcpId(pub(super) u32);

/// Names a record request of a controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CallId(pub(super) u32);

/// A station as described by its DCP answer. Missing values are empty or 0.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Station {
    /// Ethernet address.
    pub mac: MacAddress,
    /// Name of station; empty while it has none.
    pub name: String,
    /// IP configuration.
    pub ip: IpSuite,
    /// The station reports that another one has the same address.
    pub ip_conflict: bool,
    /// The address came by DHCP.
    pub ip_by_dhcp: bool,
    /// Vendor.
    pub vendor_id: u16,
    /// Device.
    pub device_id: u16,
    /// Instance.
    pub instance: u16,
    /// Bits of [`role`](crate::wire::dcp::role).
    pub role: u8,
    /// Type of station in the vendor's words.
    pub station_type: String,
    /// Alias, when it was requested.
    pub alias: String,
    /// Vendor and device of the OEM.
    pub oem: Option<(u16, u16)>,
    /// Options it supports.
    pub options: Vec<DcpOption>,
}

/// Result of a DCP request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DcpReply {
    /// Set: done.
    Done,
    /// Get: what was requested.
    Values(Station),
}

/// What happened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// A station answered an Identify request; every station once.
    Identified {
        /// The request.
        id: DcpId,
        /// The station.
        station: Station,
    },
    /// The time to answer an Identify request is over.
    IdentifyDone {
        /// The request.
        id: DcpId,
        /// How many stations answered and were taken.
        count: usize,
        /// Whether more stations answered than are taken of one request.
        more: bool,
    },
    /// A station announced itself.
    Hello {
        /// The station.
        station: Station,
    },
    /// A DCP Get or Set ended.
    DcpDone {
        /// The request.
        id: DcpId,
        /// How.
        result: Result<DcpReply, DcpError>,
    },
    /// The device accepted the connect. Records can be read and written from here on.
    Connected {
        /// The connection.
        ar: ArId,
        /// Where the device differs from what was expected.
        diff: Option<ModuleDiff>,
    },
    /// The device is ready and that was confirmed; outputs are valid from the next frame on.
    Ready {
        /// The connection.
        ar: ArId,
        /// Where the device still differs from what was expected.
        diff: Option<ModuleDiff>,
    },
    /// The first valid input frame after (or before) the device became ready.
    Running {
        /// The connection.
        ar: ArId,
    },
    /// The state the device shows in its frames changed.
    ProviderState {
        /// The connection.
        ar: ArId,
        /// It runs.
        run: bool,
        /// It reports a problem.
        problem: bool,
    },
    /// The connection could not be made, or ended without a request.
    Lost {
        /// The connection.
        ar: ArId,
        /// Why.
        cause: LostCause,
    },
    /// The connection was released as requested.
    Released {
        /// The connection.
        ar: ArId,
    },
    /// The device raised an alarm. It was acknowledged already.
    Alarm {
        /// The connection.
        ar: ArId,
        /// The alarm.
        alarm: Notification<'static>,
    },
    /// A record request ended. For writes the data is empty.
    RecordDone {
        /// The request.
        call: CallId,
        /// Data, or why there is none.
        result: Result<Vec<u8>, ServiceError>,
    },
    /// A multiple write ended.
    WritesDone {
        /// The request.
        call: CallId,
        /// Result of each record, in the order written; `None` for those without a result from the device.
        result: Result<Vec<Option<PnioStatus>>, ServiceError>,
    },
}
