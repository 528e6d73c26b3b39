//! Contents of the standard records (index 0x8000 and up): identification, I&M, diagnosis, live data, ports, log.
//!
//! IEC 61158-6-10, record data. A record is one or more blocks; profile and user records have no block header and
//! are not here.

mod identification;
mod im;
mod live;
mod port;
mod station;

pub use identification::{
    Identification, IdentifiedModule, IdentifiedSubmodule, decode_apis, encode_apis, encode_filter,
};
pub use im::{Im0, ImText, encode_im};
pub use live::{DiagnosisHeader, RecordInput, encode_record_output};
pub use port::{InterfaceReal, PortPeer, PortReal, PortStatistic, encode_multiple};
pub use station::{ArData, ArDataIocr, ArListEntry, LogData, LogEntry, decode_ar_list, encode_ar_data};

/// Index numbers of the standard records.
pub mod index {
    /// ExpectedIdentificationData of a subslot; +0x4000 slot, +0x6000 AR.
    pub const EXPECTED_IDENTIFICATION: u16 = 0x8000;
    /// RealIdentificationData of a subslot.
    pub const REAL_IDENTIFICATION: u16 = 0x8001;
    /// RealIdentificationData of an API.
    pub const REAL_IDENTIFICATION_API: u16 = 0xF000;
    /// ModuleDiffBlock of an AR.
    pub const MODULE_DIFF: u16 = 0xE002;
    /// RecordInputDataObjectElement.
    pub const RECORD_INPUT: u16 = 0x8028;
    /// RecordOutputDataObjectElement.
    pub const RECORD_OUTPUT: u16 = 0x8029;
    /// PDPortDataReal.
    pub const PORT_REAL: u16 = 0x802A;
    /// PDPortDataCheck.
    pub const PORT_CHECK: u16 = 0x802B;
    /// PDPortDataAdjust.
    pub const PORT_ADJUST: u16 = 0x802F;
    /// PDInterfaceAdjust.
    pub const INTERFACE_ADJUST: u16 = 0x8071;
    /// PDPortStatistic.
    pub const PORT_STATISTIC: u16 = 0x8072;
    /// PDInterfaceDataReal.
    pub const INTERFACE_REAL: u16 = 0x8080;
    /// I&M0; I&M1 to 4 follow.
    pub const IM0: u16 = 0xAFF0;
    /// PROFIdrive parameter access, local.
    pub const PARAMETER_LOCAL: u16 = 0xB02E;
    /// PROFIdrive parameter access, global.
    pub const PARAMETER_GLOBAL: u16 = 0xB02F;
    /// Data set 47, the older parameter access.
    pub const DATA_SET_47: u16 = 0x002F;
    /// ARData of an API.
    pub const AR_DATA_API: u16 = 0xF020;
    /// DiagnosisData of the device.
    pub const DIAGNOSIS_DEVICE: u16 = 0xF80C;
    /// ARData of the device.
    pub const AR_DATA: u16 = 0xF820;
    /// APIData.
    pub const API_DATA: u16 = 0xF821;
    /// LogBookData.
    pub const LOG: u16 = 0xF830;
    /// I&M0FilterData.
    pub const IM0_FILTER: u16 = 0xF840;
    /// PDRealData.
    pub const PD_REAL: u16 = 0xF841;
    /// PDExpectedData.
    pub const PD_EXPECTED: u16 = 0xF842;
    /// Trigger of the connection monitoring: keeps a DeviceAccess AR alive.
    pub const KEEP_ALIVE: u16 = 0xFBFF;
}

#[cfg(test)]
mod tests;
