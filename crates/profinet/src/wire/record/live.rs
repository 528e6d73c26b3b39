//! Live data of a subslot, and the head of a diagnosis record.

use crate::wire::block::{Block, BlockType, write_block};
use crate::wire::{DecodeError, Reader, Writer};

/// RecordInputDataObjectElement: what a submodule sends at present.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RecordInput<'a> {
    /// Status of the consumer.
    pub iocs: u8,
    /// Status of the provider.
    pub iops: u8,
    /// The data.
    pub data: &'a [u8],
}

impl<'a> RecordInput<'a> {
    /// Reads the record; status fields have one octet.
    ///
    /// # Errors
    /// When it is another block, or its lengths do not fit.
    pub fn decode(mut reader: Reader<'a>) -> Result<Self, DecodeError> {
        let mut r = Block::expect(&mut reader, BlockType::RECORD_INPUT)?;
        let length = r.u8("LengthIOCS")?;
        let iocs = r.bytes(length.into(), "IOCS")?;
        let length = r.u8("LengthIOPS")?;
        let iops = r.bytes(length.into(), "IOPS")?;
        let length = r.u16("LengthData")?;
        let data = r.bytes(length.into(), "data")?;
        let first = |status: &[u8]| status.first().copied().unwrap_or(0);
        Ok(Self {
            iocs: first(iocs),
            iops: first(iops),
            data,
        })
    }

    /// Writes the record.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::RECORD_INPUT, 0, |out| {
            out.bytes(&[1, self.iocs, 1, self.iops]);
            out.u16(u16::try_from(self.data.len()).unwrap_or(u16::MAX));
            out.bytes(self.data);
        });
    }
}

/// Writes RecordOutputDataObjectElement: what a submodule receives at present, and its substitute value, zero.
pub fn encode_record_output(substitute_active: bool, iocs: u8, iops: u8, data: &[u8], out: &mut impl Writer) {
    write_block(out, BlockType::RECORD_OUTPUT, 0, |out| {
        out.u16(substitute_active.into());
        out.bytes(&[1, 1]);
        out.u16(u16::try_from(data.len()).unwrap_or(u16::MAX));
        out.u8(iocs);
        out.bytes(data);
        out.u8(iops);
        write_block(out, BlockType::SUBSTITUTE_VALUE, 0, |out| {
            out.u16(0);
            out.u8(iocs);
            out.zeros(data.len());
            out.u8(iops);
        });
    });
}

/// DiagnosisData (version 1.1): where a diagnosis is pending; items of one user structure follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DiagnosisHeader {
    /// API.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// UserStructureIdentifier of the items.
    pub usi: u16,
}

impl DiagnosisHeader {
    /// Writes the block around the items that `items` writes.
    pub fn encode<W: Writer>(&self, out: &mut W, items: impl FnOnce(&mut W)) {
        write_block(out, BlockType::DIAGNOSIS_DATA, 1, |out| {
            out.u32(self.api);
            out.u16(self.slot);
            out.u16(self.subslot);
            out.u16(0x8000);
            out.u16(0x0800);
            out.u16(self.usi);
            items(out);
        });
    }

    /// Reads the next block of a diagnosis record and its items.
    ///
    /// # Errors
    /// When it is another block or too short.
    pub fn decode<'a>(reader: &mut Reader<'a>) -> Result<(Self, &'a [u8]), DecodeError> {
        let mut r = Block::expect(reader, BlockType::DIAGNOSIS_DATA)?;
        let api = r.u32("API")?;
        let slot = r.u16("SlotNumber")?;
        let subslot = r.u16("SubslotNumber")?;
        r.skip(4, "ChannelNumber and ChannelProperties")?;
        let usi = r.u16("UserStructureIdentifier")?;
        Ok((
            Self {
                api,
                slot,
                subslot,
                usi,
            },
            r.rest("diagnosis data"),
        ))
    }
}
