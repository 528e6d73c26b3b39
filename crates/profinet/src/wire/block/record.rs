//! Headers of record read and write, and the container of a multiple write.

use super::{Block, BlockType, write_block};
use crate::wire::{ByteOrder, DecodeError, PnioStatus, Problem, Reader, Uuid, Writer};

/// Octets of a record header, block header included.
pub const RECORD_HEADER: usize = 64;
/// Index of the container of several writes.
pub const MULTIPLE_WRITE: u16 = 0xE040;

/// Which record of which submodule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RecordAddress {
    /// Application process identifier.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Index.
    pub index: u16,
}

/// IODReadReqHeader, block 0x0009.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadRequest {
    /// Number of the access in the AR, echoed.
    pub sequence: u16,
    /// The AR; nil for an implicit read.
    pub ar_uuid: Uuid,
    /// API.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Record.
    pub index: u16,
    /// Maximum number of octets.
    pub length: u32,
    /// AR that an implicit read refers to.
    pub target_ar_uuid: Uuid,
}

/// IODReadResHeader, block 0x8009.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadResponse {
    /// Echo.
    pub sequence: u16,
    /// Echo.
    pub ar_uuid: Uuid,
    /// Echo.
    pub api: u32,
    /// Echo.
    pub slot: u16,
    /// Echo.
    pub subslot: u16,
    /// Echo.
    pub index: u16,
    /// Octets of data that follow the header.
    pub length: u32,
    /// AdditionalValue1 and 2.
    pub additional: (u16, u16),
}

/// IODWriteReqHeader, block 0x0008.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WriteRequest {
    /// Number of the access in the AR, echoed.
    pub sequence: u16,
    /// The AR.
    pub ar_uuid: Uuid,
    /// API.
    pub api: u32,
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// Record.
    pub index: u16,
    /// Octets of data that follow the header.
    pub length: u32,
}

/// IODWriteResHeader, block 0x8008.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WriteResponse {
    /// Echo.
    pub sequence: u16,
    /// Echo.
    pub ar_uuid: Uuid,
    /// Echo.
    pub api: u32,
    /// Echo.
    pub slot: u16,
    /// Echo.
    pub subslot: u16,
    /// Echo.
    pub index: u16,
    /// RecordDataLength, 0.
    pub length: u32,
    /// AdditionalValue1 and 2.
    pub additional: (u16, u16),
    /// How this write ended.
    pub status: PnioStatus,
}

/// The fields all four headers begin with.
struct Common {
    sequence: u16,
    ar_uuid: Uuid,
    api: u32,
    slot: u16,
    subslot: u16,
    index: u16,
    length: u32,
}

impl Common {
    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let sequence = r.u16("SeqNumber")?;
        let ar_uuid = Uuid::decode(r, ByteOrder::Big, "ARUUID")?;
        let api = r.u32("API")?;
        let slot = r.u16("SlotNumber")?;
        let subslot = r.u16("SubslotNumber")?;
        r.skip(2, "padding")?;
        let index = r.u16("Index")?;
        let length = r.u32("RecordDataLength")?;
        Ok(Self {
            sequence,
            ar_uuid,
            api,
            slot,
            subslot,
            index,
            length,
        })
    }

    fn encode(&self, out: &mut impl Writer) {
        out.u16(self.sequence);
        self.ar_uuid.encode(out, ByteOrder::Big);
        out.u32(self.api);
        out.u16(self.slot);
        out.u16(self.subslot);
        out.u16(0);
        out.u16(self.index);
        out.u32(self.length);
    }
}

macro_rules! common {
    ($self:ident) => {
        Common {
            sequence: $self.sequence,
            ar_uuid: $self.ar_uuid,
            api: $self.api,
            slot: $self.slot,
            subslot: $self.subslot,
            index: $self.index,
            length: $self.length,
        }
    };
}

/// Reads the fixed body of a record header of type `block_type`.
fn header<'a>(r: &mut Reader<'a>, block_type: BlockType) -> Result<Reader<'a>, DecodeError> {
    let body = Block::expect(r, block_type)?;
    if body.remaining() != RECORD_HEADER - 6 {
        let problem = Problem::Expected {
            expected: 60,
            found: body.remaining() as u64 + 2,
        };
        return Err(body.error("BlockLength", 4, problem));
    }
    Ok(body)
}

impl ReadRequest {
    /// Reads the header.
    ///
    /// # Errors
    /// When it is another block or has another length.
    pub fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let mut body = header(r, BlockType::READ_REQUEST)?;
        let Common {
            sequence,
            ar_uuid,
            api,
            slot,
            subslot,
            index,
            length,
        } = Common::decode(&mut body)?;
        let target_ar_uuid = Uuid::decode(&mut body, ByteOrder::Big, "TargetARUUID")?;
        Ok(Self {
            sequence,
            ar_uuid,
            api,
            slot,
            subslot,
            index,
            length,
            target_ar_uuid,
        })
    }

    /// Writes the header, 64 octets.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::READ_REQUEST, 0, |out| {
            common!(self).encode(out);
            self.target_ar_uuid.encode(out, ByteOrder::Big);
            out.zeros(8);
        });
    }

    /// Returns the header of the answer with `length` octets of data.
    #[must_use]
    pub const fn response(&self, length: u32) -> ReadResponse {
        ReadResponse {
            sequence: self.sequence,
            ar_uuid: self.ar_uuid,
            api: self.api,
            slot: self.slot,
            subslot: self.subslot,
            index: self.index,
            length,
            additional: (0, 0),
        }
    }
}

impl ReadResponse {
    /// Reads the header and the data it announces.
    ///
    /// # Errors
    /// When it is another block, or its data is shorter than its length field.
    pub fn decode<'a>(r: &mut Reader<'a>) -> Result<(Self, &'a [u8]), DecodeError> {
        let mut body = header(r, BlockType::READ_RESPONSE)?;
        let Common {
            sequence,
            ar_uuid,
            api,
            slot,
            subslot,
            index,
            length,
        } = Common::decode(&mut body)?;
        let additional = (body.u16("AdditionalValue1")?, body.u16("AdditionalValue2")?);
        let data = r.bytes(usize::try_from(length).unwrap_or(usize::MAX), "record data")?;
        Ok((
            Self {
                sequence,
                ar_uuid,
                api,
                slot,
                subslot,
                index,
                length,
                additional,
            },
            data,
        ))
    }

    /// Writes the header, 64 octets; the data follow it.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::READ_RESPONSE, 0, |out| {
            common!(self).encode(out);
            out.u16(self.additional.0);
            out.u16(self.additional.1);
            out.zeros(20);
        });
    }
}

impl WriteRequest {
    /// Reads the header and the data it announces.
    ///
    /// # Errors
    /// When it is another block, or its data is shorter than its length field.
    pub fn decode<'a>(r: &mut Reader<'a>) -> Result<(Self, &'a [u8]), DecodeError> {
        let mut body = header(r, BlockType::WRITE_REQUEST)?;
        let Common {
            sequence,
            ar_uuid,
            api,
            slot,
            subslot,
            index,
            length,
        } = Common::decode(&mut body)?;
        let data = r.bytes(usize::try_from(length).unwrap_or(usize::MAX), "record data")?;
        Ok((
            Self {
                sequence,
                ar_uuid,
                api,
                slot,
                subslot,
                index,
                length,
            },
            data,
        ))
    }

    /// Writes the header, 64 octets; the data follow it.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::WRITE_REQUEST, 0, |out| {
            common!(self).encode(out);
            out.zeros(24);
        });
    }

    /// Returns the header of the answer.
    #[must_use]
    pub const fn response(&self, status: PnioStatus) -> WriteResponse {
        WriteResponse {
            sequence: self.sequence,
            ar_uuid: self.ar_uuid,
            api: self.api,
            slot: self.slot,
            subslot: self.subslot,
            index: self.index,
            length: 0,
            additional: (0, 0),
            status,
        }
    }

    /// Returns the header around a multiple write of `length` octets: API, slot and subslot all ones, index 0xE040.
    #[must_use]
    pub const fn multiple(sequence: u16, ar_uuid: Uuid, length: u32) -> Self {
        Self {
            sequence,
            ar_uuid,
            api: 0xFFFF_FFFF,
            slot: 0xFFFF,
            subslot: 0xFFFF,
            index: MULTIPLE_WRITE,
            length,
        }
    }
}

impl WriteResponse {
    /// Reads the header.
    ///
    /// # Errors
    /// When it is another block.
    pub fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let mut body = header(r, BlockType::WRITE_RESPONSE)?;
        let Common {
            sequence,
            ar_uuid,
            api,
            slot,
            subslot,
            index,
            length,
        } = Common::decode(&mut body)?;
        let additional = (body.u16("AdditionalValue1")?, body.u16("AdditionalValue2")?);
        let status = PnioStatus::decode(&mut body)?;
        Ok(Self {
            sequence,
            ar_uuid,
            api,
            slot,
            subslot,
            index,
            length,
            additional,
            status,
        })
    }

    /// Writes the header, 64 octets.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::WRITE_RESPONSE, 0, |out| {
            common!(self).encode(out);
            out.u16(self.additional.0);
            out.u16(self.additional.1);
            self.status.encode(out);
            out.zeros(16);
        });
    }
}

/// Walks over the writes in a multiple write: each a header, its data, and padding to a multiple of 4 that may be
/// missing behind the last.
#[derive(Debug, Clone)]
pub struct WriteItems<'a> {
    reader: Reader<'a>,
}

impl<'a> WriteItems<'a> {
    /// Walks over the data of a container.
    #[must_use]
    pub const fn new(reader: Reader<'a>) -> Self {
        Self { reader }
    }
}

impl<'a> Iterator for WriteItems<'a> {
    type Item = Result<(WriteRequest, &'a [u8]), DecodeError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.reader.is_empty() {
            return None;
        }
        let item = WriteRequest::decode(&mut self.reader);
        match &item {
            Ok((_, data)) => {
                let padding = (4 - data.len() % 4) % 4;
                let padding = padding.min(self.reader.remaining());
                let _ = self.reader.bytes(padding, "padding");
            }
            Err(_) => {
                self.reader.rest("blocks");
            }
        }
        Some(item)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    #[test]
    fn golden_parameter_write() {
        let request = WriteRequest {
            sequence: 5,
            ar_uuid: Uuid([b'A'; 16]),
            api: 0x3A00,
            slot: 1,
            subslot: 1,
            index: 0xB02E,
            length: 10,
        };
        let mut golden = b"\x00\x08\x00\x3c\x01\x00\x00\x05AAAAAAAAAAAAAAAA\x00\x00\x3a\x00\x00\x01\x00\x01\x00\x00\xb0\x2e\x00\x00\x00\x0a".to_vec();
        golden.resize(64, 0);
        golden.extend_from_slice(b"\x01\x01\x01\x01\x10\x01\x03\xc4\x00\x00");
        let mut out = Vec::new();
        request.encode(&mut out);
        assert_eq!(out, golden[..64]);
        let (back, data) = WriteRequest::decode(&mut Reader::new(&golden)).unwrap();
        assert_eq!((back, data.len()), (request, 10));
        for end in 0..golden.len() {
            assert!(WriteRequest::decode(&mut Reader::new(&golden[..end])).is_err());
        }
    }

    #[test]
    fn padding_behind_the_last_item_may_be_missing() {
        for padded in [false, true] {
            let mut out = Vec::new();
            for (index, data) in [(1, &b"abcde"[..]), (2, b"xy")] {
                let request = WriteRequest {
                    index,
                    ..WriteRequest::multiple(0, Uuid::NIL, data.len() as u32)
                };
                request.encode(&mut out);
                out.extend_from_slice(data);
                if index == 1 || padded {
                    out.align(0, 4);
                }
            }
            let items: Vec<_> = WriteItems::new(Reader::new(&out))
                .map(|item| item.unwrap().1)
                .collect();
            assert_eq!(items, [&b"abcde"[..], b"xy"]);
        }
    }

    proptest! {
        #[test]
        fn headers_survive(n in any::<(u16, [u8; 16], u32, u16, u16, u16)>(), target: [u8; 16], status: u32) {
            let request = ReadRequest {
                sequence: n.0, ar_uuid: Uuid(n.1), api: n.2, slot: n.3, subslot: n.4, index: n.5, length: status,
                target_ar_uuid: Uuid(target),
            };
            let mut out = Vec::new();
            request.encode(&mut out);
            prop_assert_eq!(out.len(), 64);
            prop_assert_eq!(ReadRequest::decode(&mut Reader::new(&out)), Ok(request));
            let write = WriteRequest {
                sequence: n.0, ar_uuid: Uuid(n.1), api: n.2, slot: n.3, subslot: n.4, index: n.5, length: 0,
            };
            let response = write.response(PnioStatus::from_u32(status));
            out.clear();
            response.encode(&mut out);
            prop_assert_eq!(out.len(), 64);
            prop_assert_eq!(WriteResponse::decode(&mut Reader::new(&out)), Ok(response));
            for end in 0..64 {
                prop_assert!(WriteResponse::decode(&mut Reader::new(&out[..end])).is_err());
            }
            let response = request.response(3);
            out.clear();
            response.encode(&mut out);
            out.extend_from_slice(b"abc");
            prop_assert_eq!(ReadResponse::decode(&mut Reader::new(&out)), Ok((response, &b"abc"[..])));
            for end in 0..out.len() {
                prop_assert!(ReadResponse::decode(&mut Reader::new(&out[..end])).is_err());
            }
        }
    }
}
