//! What a device tells its application.

use alloc::string::String;
use alloc::vec::Vec;

use super::config::{ImRecords, ResetMode};
use crate::wire::PnioStatus;
use crate::wire::alarm::AlarmType;
use crate::wire::block::RecordAddress;
use crate::wire::dcp::DcpOption;
use crate::{IpSuite, MacAddress};

/// Names an application relation as long as it lives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ArKey(pub(super) u32);

/// Names a record access that waits for the application's answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Token(pub(super) u32);

/// Kind of an application relation.
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
    /// The source sends more than anybody needs; its requests are ignored until it is silent for some seconds.
    /// Reported once for each flood.
    TooMany,
    /// The application [operates](super::Device::set_operating) under a controller: block error 6.
    InOperation(DcpOption),
    /// An IO connection runs: block error 6.
    Connected(DcpOption),
}

/// Something the application should know or do.
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
    /// DCP asks to blink for three seconds.
    Signal,
    /// DCP asks for a reset. Name, address and I&M are already reset where the mode says so.
    FactoryReset {
        /// How far.
        mode: ResetMode,
    },
    /// I&M1 to 4 were written and are to be stored.
    ImChanged(ImRecords),
    /// A relation was opened.
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
        /// The relation.
        ar: ArKey,
    },
    /// Start-up is over: the first valid outputs came after ApplicationReady.
    DataExchange {
        /// The relation.
        ar: ArKey,
    },
    /// The controller's provider changed between run and stop.
    ProviderState {
        /// The relation.
        ar: ArKey,
        /// True: run.
        run: bool,
    },
    /// A relation ended.
    Disconnected {
        /// The relation.
        ar: ArKey,
        /// Why: CF 81 FD xx.
        cause: PnioStatus,
    },
    /// A record is read that the engine does not know; answer with
    /// [`answer_read`](super::Device::answer_read).
    RecordRead {
        /// Names the access.
        token: Token,
        /// Who asks; `None` without a relation.
        ar: Option<ArKey>,
        /// Which record.
        address: RecordAddress,
        /// Most octets wanted.
        length: usize,
    },
    /// A record is written that the engine does not know; answer with
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
        /// The relation.
        ar: ArKey,
        /// Which alarm.
        alarm_type: AlarmType,
        /// Number given by [`raise_alarm`](super::Device::raise_alarm).
        sequence: u16,
        /// How the controller took it.
        status: PnioStatus,
    },
}
