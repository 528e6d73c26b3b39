//! Events of a device for its application.

use alloc::string::String;
use alloc::vec::Vec;

use super::config::{ImRecords, ResetMode};
use crate::wire::PnioStatus;
use crate::wire::alarm::AlarmType;
use crate::wire::block::RecordAddress;
use crate::wire::dcp::DcpOption;
use crate::{IpSuite, MacAddress};

/// Identifies an application relationship (AR) while it exists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ArKey(pub(super) u32);

/// Names a record access that waits for the application's answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Token(pub(super) u32);

/// Kind of an application AR.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ArKind {
    /// A controller with cyclic data.
    IoController,
    /// A tool that accesses records only.
    DeviceAccess,
}

/// Why a DCP Set was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SetRefusal {
    /// The source sends too many requests; they are ignored until it was silent for some seconds. Reported once per
    /// flood.
    TooMany,
    /// The application [operates](super::Device::set_operating) under a controller: block error 6.
    InOperation(DcpOption),
    /// An IO connection runs: block error 6.
    Connected(DcpOption),
}

/// An event that the application must handle or may report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// DCP changed the name of station.
    NameChanged {
        /// The new one, empty for none.
        name: String,
        /// Store it; else the stored one is to be cleared.
        permanent: bool,
    },
    /// DCP changed the address.
    IpChanged {
        /// The new one.
        suite: IpSuite,
        /// Store it; else the stored one is to be cleared.
        permanent: bool,
    },
    /// A DCP Set was refused, and changed nothing.
    SetRefused {
        /// Who sent it.
        source: MacAddress,
        /// Why.
        refusal: SetRefusal,
    },
    /// DCP request to blink for three seconds.
    Signal,
    /// DCP request for a reset. Name, address and I&M are already reset if the mode includes them.
    FactoryReset {
        /// How far.
        mode: ResetMode,
    },
    /// I&M1 to 4 were written and are to be stored.
    ImChanged(ImRecords),
    /// An AR was opened.
    Connected {
        /// Its name from now on.
        ar: ArKey,
        /// What it is.
        kind: ArKind,
        /// Name of the initiator's station.
        station: String,
    },
    /// The controller has written all parameters: set the inputs, then call
    /// [`application_ready`](super::Device::application_ready).
    ParameterEnd {
        /// The AR.
        ar: ArKey,
    },
    /// Start-up is over: the first valid outputs came after ApplicationReady.
    DataExchange {
        /// The AR.
        ar: ArKey,
    },
    /// The controller's provider changed between run and stop.
    ProviderState {
        /// The AR.
        ar: ArKey,
        /// True: run.
        run: bool,
    },
    /// An AR ended.
    Disconnected {
        /// The AR.
        ar: ArKey,
        /// Why: CF 81 FD xx.
        cause: PnioStatus,
    },
    /// A record is read that the engine does not implement; answer with [`answer_read`](super::Device::answer_read).
    RecordRead {
        /// Names the access.
        token: Token,
        /// AR of the client; `None` without an AR.
        ar: Option<ArKey>,
        /// Which record.
        address: RecordAddress,
        /// Maximum number of octets.
        length: usize,
    },
    /// A record is written that the engine does not implement; answer with
    /// [`answer_write`](super::Device::answer_write).
    RecordWrite {
        /// Names the access.
        token: Token,
        /// Who writes.
        ar: ArKey,
        /// Which record.
        address: RecordAddress,
        /// Its content.
        data: Vec<u8>,
    },
    /// The controller answered an alarm.
    AlarmAcknowledged {
        /// The AR.
        ar: ArKey,
        /// Which alarm.
        alarm_type: AlarmType,
        /// Number given by [`raise_alarm`](super::Device::raise_alarm).
        sequence: u16,
        /// How the controller took it.
        status: PnioStatus,
    },
}
