//! IOCR blocks: one direction of cyclic data.

use alloc::vec::Vec;

use super::{BlockType, write_block};
use crate::MacAddress;
use crate::wire::{DecodeError, Reader, Writer};

/// Direction and kind of a cyclic connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct IocrType(pub u16);

impl IocrType {
    /// Device to controller.
    pub const INPUT: Self = Self(1);
    /// Controller to device.
    pub const OUTPUT: Self = Self(2);
    /// Multicast provider.
    pub const MULTICAST_PROVIDER: Self = Self(3);
    /// Multicast consumer.
    pub const MULTICAST_CONSUMER: Self = Self(4);
}

/// One entry of the object lists: a subslot and where its octets start in the frame's data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct FrameObject {
    /// Slot.
    pub slot: u16,
    /// Subslot.
    pub subslot: u16,
    /// IODataObjectFrameOffset or IOCSFrameOffset.
    pub offset: u16,
}

/// The objects of one API.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IocrApi {
    /// Application process identifier.
    pub api: u32,
    /// Data of this direction.
    pub data: Vec<FrameObject>,
    /// IOCS of the data that flows the other way.
    pub status: Vec<FrameObject>,
}

/// IOCRBlockReq, block 0x0102.
///
/// IEC 61158-6-10, IOCRBlockReq.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IocrRequest {
    /// Direction.
    pub iocr_type: IocrType,
    /// Number of the connection in the AR.
    pub reference: u16,
    /// LT, EtherType 0x8892.
    pub lt: u16,
    /// Bits 0 to 3: RTClass.
    pub properties: u32,
    /// Octets of data with all status and gaps.
    pub data_length: u16,
    /// FrameID, 0xFFFF in an output request: the device chooses.
    pub frame_id: u16,
    /// SendClockFactor, unit 31.25 us.
    pub send_clock_factor: u16,
    /// ReductionRatio.
    pub reduction_ratio: u16,
    /// Phase, from 1.
    pub phase: u16,
    /// Sequence, 0.
    pub sequence: u16,
    /// FrameSendOffset in nanoseconds, 0xFFFFFFFF best effort.
    pub frame_send_offset: u32,
    /// WatchdogFactor.
    pub watchdog_factor: u16,
    /// DataHoldFactor.
    pub data_hold_factor: u16,
    /// IOCRTagHeader, 0xC000.
    pub tag_header: u16,
    /// IOCRMulticastMACAdd, zero for unicast.
    pub multicast: MacAddress,
    /// Objects by API.
    pub apis: Vec<IocrApi>,
}

fn objects(r: &mut Reader<'_>, what: &'static str) -> Result<Vec<FrameObject>, DecodeError> {
    let count = r.u16(what)?;
    let mut list = Vec::new();
    for _ in 0..count {
        list.push(FrameObject {
            slot: r.u16("SlotNumber")?,
            subslot: r.u16("SubslotNumber")?,
            offset: r.u16("frame offset")?,
        });
    }
    Ok(list)
}

fn write_objects(out: &mut impl Writer, list: &[FrameObject]) {
    out.u16(u16::try_from(list.len()).unwrap_or(u16::MAX));
    for object in list {
        out.u16(object.slot);
        out.u16(object.subslot);
        out.u16(object.offset);
    }
}

impl IocrRequest {
    /// RTClass of the properties.
    #[must_use]
    pub const fn rt_class(&self) -> u8 {
        (self.properties & 0xF) as u8
    }

    /// Reads the body.
    ///
    /// # Errors
    /// When its length does not fit its counts.
    pub fn decode(mut r: Reader<'_>) -> Result<Self, DecodeError> {
        let mut block = Self {
            iocr_type: IocrType(r.u16("IOCRType")?),
            reference: r.u16("IOCRReference")?,
            lt: r.u16("LT")?,
            properties: r.u32("IOCRProperties")?,
            data_length: r.u16("DataLength")?,
            frame_id: r.u16("FrameID")?,
            send_clock_factor: r.u16("SendClockFactor")?,
            reduction_ratio: r.u16("ReductionRatio")?,
            phase: r.u16("Phase")?,
            sequence: r.u16("Sequence")?,
            frame_send_offset: r.u32("FrameSendOffset")?,
            watchdog_factor: r.u16("WatchdogFactor")?,
            data_hold_factor: r.u16("DataHoldFactor")?,
            tag_header: r.u16("IOCRTagHeader")?,
            multicast: MacAddress(r.array("IOCRMulticastMACAdd")?),
            apis: Vec::new(),
        };
        let apis = r.u16("NumberOfAPIs")?;
        for _ in 0..apis {
            block.apis.push(IocrApi {
                api: r.u32("API")?,
                data: objects(&mut r, "NumberOfIODataObjects")?,
                status: objects(&mut r, "NumberOfIOCS")?,
            });
        }
        r.finish("IOCRBlockReq")?;
        Ok(block)
    }

    /// Writes the whole block.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::IOCR_REQUEST, 0, |out| {
            out.u16(self.iocr_type.0);
            out.u16(self.reference);
            out.u16(self.lt);
            out.u32(self.properties);
            for field in [
                self.data_length,
                self.frame_id,
                self.send_clock_factor,
                self.reduction_ratio,
                self.phase,
                self.sequence,
            ] {
                out.u16(field);
            }
            out.u32(self.frame_send_offset);
            out.u16(self.watchdog_factor);
            out.u16(self.data_hold_factor);
            out.u16(self.tag_header);
            out.bytes(&self.multicast.0);
            out.u16(u16::try_from(self.apis.len()).unwrap_or(u16::MAX));
            for api in &self.apis {
                out.u32(api.api);
                write_objects(out, &api.data);
                write_objects(out, &api.status);
            }
        });
    }
}

/// IOCRBlockRes, block 0x8102.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IocrResponse {
    /// Echo.
    pub iocr_type: IocrType,
    /// Echo.
    pub reference: u16,
    /// The FrameID in force.
    pub frame_id: u16,
}

impl IocrResponse {
    /// Reads the body.
    ///
    /// # Errors
    /// When it is too short.
    pub fn decode(mut r: Reader<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            iocr_type: IocrType(r.u16("IOCRType")?),
            reference: r.u16("IOCRReference")?,
            frame_id: r.u16("FrameID")?,
        })
    }

    /// Writes the whole block.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::IOCR_RESPONSE, 0, |out| {
            out.u16(self.iocr_type.0);
            out.u16(self.reference);
            out.u16(self.frame_id);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::Block;
    use super::*;
    use proptest::collection::vec;
    use proptest::prelude::*;

    fn list() -> impl Strategy<Value = Vec<FrameObject>> {
        vec(any::<(u16, u16, u16)>(), 0..5).prop_map(|list| {
            list.into_iter()
                .map(|(slot, subslot, offset)| FrameObject {
                    slot,
                    subslot,
                    offset,
                })
                .collect()
        })
    }

    fn request() -> impl Strategy<Value = IocrRequest> {
        let apis = vec((any::<u32>(), list(), list()), 0..4);
        let numbers = (
            any::<[u16; 10]>(),
            any::<(u32, u32)>(),
            any::<[u16; 2]>(),
            any::<[u8; 6]>(),
        );
        (numbers, apis).prop_map(
            |((n, (properties, offset), [hold, tag], mac), apis)| IocrRequest {
                iocr_type: IocrType(n[0]),
                reference: n[1],
                lt: n[2],
                properties,
                data_length: n[3],
                frame_id: n[4],
                send_clock_factor: n[5],
                reduction_ratio: n[6],
                phase: n[7],
                sequence: n[8],
                frame_send_offset: offset,
                watchdog_factor: n[9],
                data_hold_factor: hold,
                tag_header: tag,
                multicast: MacAddress(mac),
                apis: apis
                    .into_iter()
                    .map(|(api, data, status)| IocrApi { api, data, status })
                    .collect(),
            },
        )
    }

    proptest! {
        #[test]
        fn requests_survive_and_damage_never_panics(request in request(), at: u16, bit in 0u8..8) {
            let mut out = Vec::new();
            request.encode(&mut out);
            let objects: usize = request.apis.iter().map(|a| 8 + 6 * (a.data.len() + a.status.len())).sum();
            prop_assert_eq!(out.len(), 4 + 42 + objects);
            let body = Block::expect(&mut Reader::new(&out), BlockType::IOCR_REQUEST).unwrap();
            prop_assert_eq!(IocrRequest::decode(body), Ok(request));
            for end in 6..out.len() {
                prop_assert!(IocrRequest::decode(Reader::new(&out[6..end])).is_err());
            }
            let at = usize::from(at) % out.len();
            out[at] ^= 1 << bit;
            if let Ok(block) = Block::decode(&mut Reader::new(&out)) {
                let _ = IocrRequest::decode(block.body);
            }
        }
    }
}
