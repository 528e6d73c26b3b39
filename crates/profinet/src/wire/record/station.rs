//! Log book and application ARs of a station.

use alloc::vec::Vec;

use crate::wire::block::{Block, BlockType, write_block};
use crate::wire::{ByteOrder, DecodeError, PnioStatus, Reader, Uuid, Writer};

/// One entry of the log book.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LogEntry {
    /// When, in the device's own time.
    pub time: u64,
    /// Which AR.
    pub ar_uuid: Uuid,
    /// What happened.
    pub status: PnioStatus,
    /// Detail, free.
    pub detail: u32,
}

/// LogData, block 0x0019.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LogData {
    /// Now, in the device's own time.
    pub time: u64,
    /// Entries, oldest first.
    pub entries: Vec<LogEntry>,
}

impl LogData {
    /// Reads the record.
    ///
    /// # Errors
    /// When it is another block, or its length does not fit its count.
    pub fn decode(mut reader: Reader<'_>) -> Result<Self, DecodeError> {
        let mut r = Block::expect(&mut reader, BlockType::LOG_DATA)?;
        let time = r.u64("ActualLocalTimeStamp")?;
        let count = r.u16("NumberOfLogEntries")?;
        let mut entries = Vec::new();
        for _ in 0..count {
            entries.push(LogEntry {
                time: r.u64("LocalTimeStamp")?,
                ar_uuid: Uuid::decode(&mut r, ByteOrder::Big, "ARUUID")?,
                status: PnioStatus::decode(&mut r)?,
                detail: r.u32("EntryDetail")?,
            });
        }
        r.finish("LogData")?;
        Ok(Self { time, entries })
    }

    /// Writes the record.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::LOG_DATA, 0, |out| {
            out.u64(self.time);
            out.u16(u16::try_from(self.entries.len()).unwrap_or(u16::MAX));
            for entry in &self.entries {
                out.u64(entry.time);
                entry.ar_uuid.encode(out, ByteOrder::Big);
                entry.status.encode(out);
                out.u32(entry.detail);
            }
        });
    }
}

/// One cyclic connection in ARData.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArDataIocr {
    /// IOCRProperties.
    pub properties: u32,
    /// IOCRType.
    pub iocr_type: u16,
    /// FrameID.
    pub frame_id: u16,
    /// CycleCounter, DataStatus and TransferStatus of the latest frame.
    pub apdu_status: [u8; 4],
}

/// One AR in ARData.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArData<'a> {
    /// ARUUID.
    pub ar_uuid: Uuid,
    /// CMInitiatorObjectUUID.
    pub initiator_object: Uuid,
    /// ARProperties.
    pub properties: u32,
    /// ARType.
    pub ar_type: u16,
    /// AlarmCRType, 0 without alarms.
    pub alarm_cr_type: u16,
    /// Own and the peer's LocalAlarmReference.
    pub alarm_references: (u16, u16),
    /// Name of the initiator.
    pub station_name: &'a [u8],
    /// Cyclic connections.
    pub iocrs: Vec<ArDataIocr>,
    /// APIs.
    pub apis: Vec<u32>,
}

/// Writes ARData, block 0x0018 version 1.1.
pub fn encode_ar_data(ars: &[ArData<'_>], out: &mut impl Writer) {
    let start = out.position();
    write_block(out, BlockType::AR_DATA, 1, |out| {
        out.u16(u16::try_from(ars.len()).unwrap_or(u16::MAX));
        for ar in ars {
            ar.ar_uuid.encode(out, ByteOrder::Big);
            ar.initiator_object.encode(out, ByteOrder::Big);
            Uuid::NIL.encode(out, ByteOrder::Big);
            out.u32(ar.properties);
            out.u16(ar.ar_type);
            out.u16(ar.alarm_cr_type);
            out.u16(ar.alarm_references.0);
            out.u16(ar.alarm_references.1);
            out.u16(0x8892);
            out.u16(0x8892);
            out.u16(u16::try_from(ar.station_name.len()).unwrap_or(u16::MAX));
            out.bytes(ar.station_name);
            out.align(start, 4);
            out.u16(0);
            out.align(start, 4);
            out.u16(u16::try_from(ar.iocrs.len()).unwrap_or(u16::MAX));
            out.u16(0);
            for iocr in &ar.iocrs {
                out.u32(iocr.properties);
                out.u16(iocr.iocr_type);
                out.u16(iocr.frame_id);
                out.bytes(&iocr.apdu_status);
            }
            out.u16(u16::try_from(ar.apis.len()).unwrap_or(u16::MAX));
            out.u16(0);
            for api in &ar.apis {
                out.u32(*api);
            }
            out.u16(0);
            out.u16(0);
        }
    });
}

/// Who has an AR with a device, out of ARData.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArListEntry<'a> {
    /// ARUUID.
    pub ar_uuid: Uuid,
    /// ARType: 1 an IO controller, 6 device access.
    pub ar_type: u16,
    /// Name of the initiator.
    pub station_name: &'a [u8],
}

/// Reads the ARs of ARData, block version 1.1; `None` for another block or version.
///
/// # Errors
/// When the data end before an AR does.
pub fn decode_ar_list<'a>(r: &mut Reader<'a>) -> Result<Option<Vec<ArListEntry<'a>>>, DecodeError> {
    const OBJECTS: usize = 2 * 16;
    let start = r.position();
    let block = Block::decode(r)?;
    let mut ars = Vec::new();
    if block.block_type != BlockType::AR_DATA || block.version != (1, 1) {
        return Ok(None);
    }
    let mut r = block.body;
    let align = |r: &mut Reader<'a>| r.skip((4 - (r.position() - start) % 4) % 4, "padding");
    for _ in 0..r.u16("NumberOfARs")? {
        let ar_uuid = Uuid::decode(&mut r, ByteOrder::Big, "ARUUID")?;
        r.skip(OBJECTS + 4, "identifiers of the AR")?;
        let ar_type = r.u16("ARType")?;
        r.skip(10, "alarm channel and ports")?;
        let length = r.u16("InitiatorStationNameLength")?;
        let station_name = r.bytes(length.into(), "CMInitiatorStationName")?;
        ars.push(ArListEntry {
            ar_uuid,
            ar_type,
            station_name,
        });
        align(&mut r)?;
        let length = r.u16("ParameterServerStationNameLength")?;
        r.skip(length.into(), "ParameterServerStationName")?;
        align(&mut r)?;
        let iocrs = r.u16("NumberOfIOCRs")?;
        r.skip(2, "padding")?;
        for _ in 0..iocrs {
            r.u32("IOCRProperties")?;
            r.u16("IOCRType")?;
            r.u16("FrameID")?;
            r.skip(4, "APDU_Status")?;
        }
        let apis = r.u16("NumberOfAPIs")?;
        r.skip(2, "padding")?;
        for _ in 0..apis {
            r.u32("API")?;
        }
        r.skip(4, "numbers of dynamic frames and of further items")?;
    }
    Ok(Some(ars))
}
