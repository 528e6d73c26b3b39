//! Blocks: the typed, counted pieces that connects, control services and records are made of.
//!
//! IEC 61158-6-10, BlockHeader. Always big-endian, one behind the other without gaps.

mod ar;
mod control;
mod expected;
mod iocr;
mod record;

pub use ar::{
    AlarmCrRequest, AlarmCrResponse, ArProperties, ArRequest, ArResponse, ArServer, ArType, ConnectResponse,
};
pub use control::{ControlBlock, ControlCommand};
pub use expected::{
    DataDescription, DiffModule, DiffSubmodule, ExpectedModule, ExpectedSubmodule, ModuleDiff, ModuleState,
    SubmoduleState,
};
pub use iocr::{FrameObject, IocrApi, IocrRequest, IocrResponse, IocrType};
pub use record::{
    MULTIPLE_WRITE, RECORD_HEADER, ReadRequest, ReadResponse, RecordAddress, WriteItems, WriteRequest,
    WriteResponse,
};

use core::fmt;

use super::{DecodeError, Problem, Reader, Writer};

/// Octets of a block header.
pub const BLOCK_HEADER: usize = 6;

/// Kind of a block.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct BlockType(pub u16);

macro_rules! block_types {
    ($($name:ident = $code:literal, $words:literal;)*) => {
        impl BlockType {
            $(#[doc = concat!($words, ", `", stringify!($code), "`.")]
            pub const $name: Self = Self($code);)*
        }
        /// Number and name of every block type known by name.
        const NAMES: &[(u16, &str)] = &[$(($code, $words)),*];
    };
}

block_types! {
    ALARM_HIGH = 0x0001, "AlarmNotification high";
    ALARM_LOW = 0x0002, "AlarmNotification low";
    WRITE_REQUEST = 0x0008, "IODWriteReqHeader";
    READ_REQUEST = 0x0009, "IODReadReqHeader";
    DIAGNOSIS_DATA = 0x0010, "DiagnosisData";
    EXPECTED_IDENTIFICATION = 0x0012, "ExpectedIdentificationData";
    REAL_IDENTIFICATION = 0x0013, "RealIdentificationData";
    SUBSTITUTE_VALUE = 0x0014, "SubstituteValue";
    RECORD_INPUT = 0x0015, "RecordInputDataObjectElement";
    RECORD_OUTPUT = 0x0016, "RecordOutputDataObjectElement";
    AR_DATA = 0x0018, "ARData";
    LOG_DATA = 0x0019, "LogData";
    API_DATA = 0x001A, "APIData";
    IM0 = 0x0020, "I&M0";
    IM1 = 0x0021, "I&M1";
    IM2 = 0x0022, "I&M2";
    IM3 = 0x0023, "I&M3";
    IM4 = 0x0024, "I&M4";
    IM0_FILTER_SUBMODULE = 0x0030, "I&M0FilterDataSubmodule";
    IM0_FILTER_MODULE = 0x0031, "I&M0FilterDataModule";
    IM0_FILTER_DEVICE = 0x0032, "I&M0FilterDataDevice";
    AR_REQUEST = 0x0101, "ARBlockReq";
    IOCR_REQUEST = 0x0102, "IOCRBlockReq";
    ALARM_CR_REQUEST = 0x0103, "AlarmCRBlockReq";
    EXPECTED_SUBMODULE = 0x0104, "ExpectedSubmoduleBlockReq";
    PRM_SERVER_REQUEST = 0x0105, "PrmServerBlockReq";
    MCR_REQUEST = 0x0106, "MCRBlockReq";
    AR_RPC_REQUEST = 0x0107, "ARRPCBlockReq";
    AR_VENDOR_REQUEST = 0x0108, "ARVendorBlockReq";
    IR_INFO = 0x0109, "IRInfoBlock";
    SR_INFO = 0x010A, "SRInfoBlock";
    AR_FSU = 0x010B, "ARFSUBlock";
    RS_INFO = 0x010C, "RSInfoBlock";
    PRM_END = 0x0110, "IODControlReq PrmEnd (connect)";
    PRM_END_PLUG = 0x0111, "IODControlReq PrmEnd (plug)";
    APPLICATION_READY = 0x0112, "IOXControlReq ApplicationReady (connect)";
    APPLICATION_READY_PLUG = 0x0113, "IOXControlReq ApplicationReady (plug)";
    RELEASE = 0x0114, "ReleaseBlock";
    READY_FOR_COMPANION = 0x0116, "IOXControlReq ReadyForCompanion";
    READY_FOR_RTC3 = 0x0117, "IOXControlReq ReadyForRTC3";
    PRM_BEGIN = 0x0118, "PrmBegin";
    SUBMODULE_LIST = 0x0119, "SubmoduleListBlock";
    PD_PORT_CHECK = 0x0200, "PDPortDataCheck";
    PD_PORT_ADJUST = 0x0202, "PDPortDataAdjust";
    PD_PORT_REAL = 0x020F, "PDPortDataReal";
    PD_INTERFACE_REAL = 0x0240, "PDInterfaceDataReal";
    PD_INTERFACE_ADJUST = 0x0250, "PDInterfaceAdjust";
    PD_PORT_STATISTIC = 0x0251, "PDPortStatistic";
    MULTIPLE_BLOCK = 0x0400, "MultipleBlockHeader";
    MAINTENANCE = 0x0F00, "MaintenanceItem";
    ALARM_ACK_HIGH = 0x8001, "AlarmAck high";
    ALARM_ACK_LOW = 0x8002, "AlarmAck low";
    WRITE_RESPONSE = 0x8008, "IODWriteResHeader";
    READ_RESPONSE = 0x8009, "IODReadResHeader";
    AR_RESPONSE = 0x8101, "ARBlockRes";
    IOCR_RESPONSE = 0x8102, "IOCRBlockRes";
    ALARM_CR_RESPONSE = 0x8103, "AlarmCRBlockRes";
    MODULE_DIFF = 0x8104, "ModuleDiffBlock";
    AR_RPC_RESPONSE = 0x8105, "ARRPCBlockRes";
    AR_SERVER = 0x8106, "ARServerBlock";
    AR_VENDOR_RESPONSE = 0x8108, "ARVendorBlockRes";
    PRM_END_DONE = 0x8110, "IODControlRes PrmEnd (connect)";
    PRM_END_PLUG_DONE = 0x8111, "IODControlRes PrmEnd (plug)";
    APPLICATION_READY_DONE = 0x8112, "IOXControlRes ApplicationReady (connect)";
    APPLICATION_READY_PLUG_DONE = 0x8113, "IOXControlRes ApplicationReady (plug)";
    RELEASE_DONE = 0x8114, "ReleaseBlockRes";
    PRM_BEGIN_DONE = 0x8118, "PrmBegin response";
}

impl BlockType {
    /// Returns the name in the standard, if known here.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        NAMES.iter().find(|row| row.0 == self.0).map(|row| row.1)
    }

    /// Returns the type of the answer to a request block.
    #[must_use]
    pub const fn response(self) -> Self {
        Self(self.0 | 0x8000)
    }
}

impl fmt::Display for BlockType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            Some(name) => f.write_str(name),
            None => write!(f, "block {:#06x}", self.0),
        }
    }
}

impl fmt::Debug for BlockType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:#06x} {}", self.0, self.name().unwrap_or("?"))
    }
}

/// One block: type, version and a reader over its body.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// Kind.
    pub block_type: BlockType,
    /// BlockVersionHigh and BlockVersionLow.
    pub version: (u8, u8),
    /// What follows the header.
    pub body: Reader<'a>,
}

impl<'a> Block<'a> {
    /// Reads the next block.
    ///
    /// # Errors
    /// When the data end before the block does, or its length does not cover the version.
    pub fn decode(r: &mut Reader<'a>) -> Result<Self, DecodeError> {
        let start = r.position();
        let block_type = BlockType(r.u16("BlockType")?);
        let length = r.u16("BlockLength")?;
        if length < 2 {
            return Err(r.error("BlockLength", 2, Problem::Invalid { found: length.into() }));
        }
        let mut body = r.sub(length.into(), "block")?;
        let version = (body.u8("BlockVersionHigh")?, body.u8("BlockVersionLow")?);
        r.enclose(block_type.name().unwrap_or("block"), start);
        Ok(Self {
            block_type,
            version,
            body,
        })
    }

    /// Reads the next block, which must be of this type and of version 1.x.
    ///
    /// # Errors
    /// When it is another one, or too short.
    pub fn expect(r: &mut Reader<'a>, block_type: BlockType) -> Result<Reader<'a>, DecodeError> {
        let before = *r;
        let block = Self::decode(r)?;
        if block.block_type != block_type {
            let problem = Problem::Expected {
                expected: block_type.0.into(),
                found: block.block_type.0.into(),
            };
            return Err(before.error("BlockType", 0, problem));
        }
        if block.version.0 != 1 {
            let problem = Problem::Expected {
                expected: 1,
                found: block.version.0.into(),
            };
            return Err(block.body.error("BlockVersionHigh", 2, problem));
        }
        Ok(block.body)
    }
}

/// Walks over blocks; stops behind the first that is cut off.
#[derive(Debug, Clone)]
pub struct Blocks<'a> {
    reader: Reader<'a>,
}

impl<'a> Blocks<'a> {
    /// Walks over what `reader` has left.
    #[must_use]
    pub const fn new(reader: Reader<'a>) -> Self {
        Self { reader }
    }
}

impl<'a> Iterator for Blocks<'a> {
    type Item = Result<Block<'a>, DecodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.reader.is_empty() {
            return None;
        }
        let block = Block::decode(&mut self.reader);
        if block.is_err() {
            self.reader.rest("blocks");
        }
        Some(block)
    }
}

/// Writes a block of version 1.`version_low` whose body `content` writes; the length follows from it.
pub fn write_block<W: Writer>(
    out: &mut W,
    block_type: BlockType,
    version_low: u8,
    content: impl FnOnce(&mut W),
) {
    let start = out.position();
    out.u16(block_type.0);
    out.u16(0);
    out.bytes(&[1, version_low]);
    content(out);
    let length = out.position() - start - 4;
    out.patch(
        start + 2,
        &u16::try_from(length).unwrap_or(u16::MAX).to_be_bytes(),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn blocks_are_walked_until_one_is_cut_off() {
        let mut out = Vec::new();
        write_block(&mut out, BlockType::IM2, 0, |out| out.zeros(16));
        write_block(&mut out, BlockType(0x7777), 1, |_| {});
        assert_eq!(out[..6], [0, 0x22, 0, 18, 1, 0]);
        out.extend_from_slice(&[0, 1, 0, 9, 1]);
        let blocks: Vec<_> = Blocks::new(Reader::new(&out)).collect();
        assert_eq!(blocks.len(), 3);
        assert_eq!(blocks[0].as_ref().unwrap().block_type.name(), Some("I&M2"));
        assert_eq!(blocks[1].as_ref().unwrap().version, (1, 1));
        assert_eq!(blocks[2].as_ref().unwrap_err().offset, 22 + 6 + 4);
    }

    #[test]
    fn a_length_without_version_is_refused() {
        let error = Block::decode(&mut Reader::new(&[0, 1, 0, 1, 1, 0])).unwrap_err();
        assert_eq!((error.what, error.offset), ("BlockLength", 2));
    }
}
