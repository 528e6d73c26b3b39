//! Blocks that open an application AR: AR, AlarmCR, ARServer.

use alloc::vec::Vec;

use super::{Block, BlockType, Blocks, IocrResponse, ModuleDiff, write_block};
use crate::MacAddress;
use crate::wire::{ByteOrder, DecodeError, Problem, Reader, Uuid, Writer};

/// Kind of an application AR.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ArType(pub u16);

impl ArType {
    /// IO controller with cyclic data.
    pub const IO_CONTROLLER: Self = Self(0x0001);
    /// Supervisor; with [`ArProperties::DEVICE_ACCESS`] a parameter tool without cyclic data.
    pub const SUPERVISOR: Self = Self(0x0006);
    /// IO controller with isochronous real time.
    pub const IRT: Self = Self(0x0010);
    /// Redundant IO controller.
    pub const REDUNDANT: Self = Self(0x0020);
}

/// ARProperties.
///
/// IEC 61158-6-10, field ARProperties.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ArProperties(pub u32);

impl ArProperties {
    /// State active, the only value of the lowest three bits.
    pub const ACTIVE: u32 = 1;
    /// Supervisor may take over.
    pub const TAKEOVER_ALLOWED: u32 = 1 << 3;
    /// The initiator parameterises itself.
    pub const PARAMETERIZED_BY_INITIATOR: u32 = 1 << 4;
    /// Record access only.
    pub const DEVICE_ACCESS: u32 = 1 << 8;
    /// Advanced start-up.
    pub const ADVANCED: u32 = 1 << 30;

    /// State field, 1 = active.
    #[must_use]
    pub const fn state(self) -> u32 {
        self.0 & 7
    }

    /// Returns true when the initiator parameterises the device itself.
    #[must_use]
    pub const fn parameterized_by_initiator(self) -> bool {
        self.0 & Self::PARAMETERIZED_BY_INITIATOR != 0
    }

    /// Returns true for record access only.
    #[must_use]
    pub const fn device_access(self) -> bool {
        self.0 & Self::DEVICE_ACCESS != 0
    }

    /// CompanionAR field, 0 = single.
    #[must_use]
    pub const fn companion(self) -> u32 {
        self.0 >> 9 & 3
    }

    /// Returns true for advanced start-up, false for legacy.
    #[must_use]
    pub const fn advanced(self) -> bool {
        self.0 & Self::ADVANCED != 0
    }
}

/// ARBlockReq: who opens which AR.
///
/// IEC 61158-6-10, ARBlockReq, block 0x0101.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArRequest {
    /// Kind of AR.
    pub ar_type: ArType,
    /// Its identity, new for every connect.
    pub ar_uuid: Uuid,
    /// Counter of the initiator, echoed in control blocks.
    pub session_key: u16,
    /// Where the responder sends cyclic and alarm frames.
    pub initiator_mac: MacAddress,
    /// Object UUID of the initiator.
    pub initiator_object: Uuid,
    /// Properties.
    pub properties: ArProperties,
    /// CMInitiatorActivityTimeoutFactor in units of 100 ms, 1 to 1000.
    pub activity_timeout_factor: u16,
    /// InitiatorUDPRTPort.
    pub udp_rt_port: u16,
    /// StationNameLength as sent; equals the length of the name in a sound block.
    pub station_name_length: u16,
    /// CMInitiatorStationName: what the block holds behind the length.
    pub station_name: Vec<u8>,
}

impl ArRequest {
    /// Reads the body.
    ///
    /// # Errors
    /// When it is too short.
    pub fn decode(mut r: Reader<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            ar_type: ArType(r.u16("ARType")?),
            ar_uuid: Uuid::decode(&mut r, ByteOrder::Big, "ARUUID")?,
            session_key: r.u16("SessionKey")?,
            initiator_mac: MacAddress(r.array("CMInitiatorMacAdd")?),
            initiator_object: Uuid::decode(&mut r, ByteOrder::Big, "CMInitiatorObjectUUID")?,
            properties: ArProperties(r.u32("ARProperties")?),
            activity_timeout_factor: r.u16("CMInitiatorActivityTimeoutFactor")?,
            udp_rt_port: r.u16("InitiatorUDPRTPort")?,
            station_name_length: r.u16("StationNameLength")?,
            station_name: r.bytes(r.remaining(), "CMInitiatorStationName")?.to_vec(),
        })
    }

    /// Writes the whole block.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::AR_REQUEST, 0, |out| {
            out.u16(self.ar_type.0);
            self.ar_uuid.encode(out, ByteOrder::Big);
            out.u16(self.session_key);
            out.bytes(&self.initiator_mac.0);
            self.initiator_object.encode(out, ByteOrder::Big);
            out.u32(self.properties.0);
            out.u16(self.activity_timeout_factor);
            out.u16(self.udp_rt_port);
            out.u16(self.station_name_length);
            out.bytes(&self.station_name);
        });
    }
}

/// ARBlockRes, block 0x8101.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArResponse {
    /// Echo.
    pub ar_type: ArType,
    /// Echo.
    pub ar_uuid: Uuid,
    /// Echo.
    pub session_key: u16,
    /// Address of the responder's frames.
    pub responder_mac: MacAddress,
    /// ResponderUDPRTPort.
    pub udp_rt_port: u16,
}

impl ArResponse {
    /// Reads the body.
    ///
    /// # Errors
    /// When it is too short.
    pub fn decode(mut r: Reader<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            ar_type: ArType(r.u16("ARType")?),
            ar_uuid: Uuid::decode(&mut r, ByteOrder::Big, "ARUUID")?,
            session_key: r.u16("SessionKey")?,
            responder_mac: MacAddress(r.array("CMResponderMacAdd")?),
            udp_rt_port: r.u16("ResponderUDPRTPort")?,
        })
    }

    /// Writes the whole block.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::AR_RESPONSE, 0, |out| {
            out.u16(self.ar_type.0);
            self.ar_uuid.encode(out, ByteOrder::Big);
            out.u16(self.session_key);
            out.bytes(&self.responder_mac.0);
            out.u16(self.udp_rt_port);
        });
    }
}

/// AlarmCRBlockReq, block 0x0103.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AlarmCrRequest {
    /// AlarmCRType, 1.
    pub alarm_cr_type: u16,
    /// LT, EtherType 0x8892.
    pub lt: u16,
    /// Bit 0: low priority only; bit 1: over UDP.
    pub properties: u32,
    /// RTATimeoutFactor in units of 100 ms, 1 to 100.
    pub rta_timeout_factor: u16,
    /// RTARetries, 3 to 15.
    pub rta_retries: u16,
    /// Endpoint of the initiator.
    pub local_alarm_reference: u16,
    /// Longest alarm the initiator takes, 200 to 1432.
    pub max_alarm_data_length: u16,
    /// 0xC000.
    pub tag_high: u16,
    /// 0xA000.
    pub tag_low: u16,
}

impl AlarmCrRequest {
    /// Reads the body.
    ///
    /// # Errors
    /// When it has another length.
    pub fn decode(mut r: Reader<'_>) -> Result<Self, DecodeError> {
        let block = Self {
            alarm_cr_type: r.u16("AlarmCRType")?,
            lt: r.u16("LT")?,
            properties: r.u32("AlarmCRProperties")?,
            rta_timeout_factor: r.u16("RTATimeoutFactor")?,
            rta_retries: r.u16("RTARetries")?,
            local_alarm_reference: r.u16("LocalAlarmReference")?,
            max_alarm_data_length: r.u16("MaxAlarmDataLength")?,
            tag_high: r.u16("AlarmCRTagHeaderHigh")?,
            tag_low: r.u16("AlarmCRTagHeaderLow")?,
        };
        r.finish("AlarmCRBlockReq")?;
        Ok(block)
    }

    /// Writes the whole block.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::ALARM_CR_REQUEST, 0, |out| {
            out.u16(self.alarm_cr_type);
            out.u16(self.lt);
            out.u32(self.properties);
            for field in [
                self.rta_timeout_factor,
                self.rta_retries,
                self.local_alarm_reference,
                self.max_alarm_data_length,
                self.tag_high,
                self.tag_low,
            ] {
                out.u16(field);
            }
        });
    }
}

/// AlarmCRBlockRes, block 0x8103.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AlarmCrResponse {
    /// Echo.
    pub alarm_cr_type: u16,
    /// Endpoint of the responder.
    pub local_alarm_reference: u16,
    /// Longest alarm the responder takes.
    pub max_alarm_data_length: u16,
}

impl AlarmCrResponse {
    /// Reads the body.
    ///
    /// # Errors
    /// When it is too short.
    pub fn decode(mut r: Reader<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            alarm_cr_type: r.u16("AlarmCRType")?,
            local_alarm_reference: r.u16("LocalAlarmReference")?,
            max_alarm_data_length: r.u16("MaxAlarmDataLength")?,
        })
    }

    /// Writes the whole block.
    pub fn encode(&self, out: &mut impl Writer) {
        write_block(out, BlockType::ALARM_CR_RESPONSE, 0, |out| {
            out.u16(self.alarm_cr_type);
            out.u16(self.local_alarm_reference);
            out.u16(self.max_alarm_data_length);
        });
    }
}

/// ARServerBlock, block 0x8106: the name of the responder; last block of an answer in advanced start-up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArServer {
    /// Name of station.
    pub station_name: Vec<u8>,
}

impl ArServer {
    /// Reads the body.
    ///
    /// # Errors
    /// When it is too short.
    pub fn decode(mut r: Reader<'_>) -> Result<Self, DecodeError> {
        let length = r.u16("StationNameLength")?;
        Ok(Self {
            station_name: r.bytes(length.into(), "CMResponderStationName")?.to_vec(),
        })
    }

    /// Writes the whole block, padded to a multiple of 4; the padding counts in the length.
    pub fn encode(&self, out: &mut impl Writer) {
        let start = out.position();
        write_block(out, BlockType::AR_SERVER, 0, |out| {
            out.u16(u16::try_from(self.station_name.len()).unwrap_or(u16::MAX));
            out.bytes(&self.station_name);
            out.align(start, 4);
        });
    }
}

/// All blocks of a positive Connect.res.
///
/// ```
/// use profidrive_profinet::wire::block::{ArResponse, ArType, ConnectResponse};
/// use profidrive_profinet::wire::{Reader, Uuid};
/// use profidrive_profinet::MacAddress;
/// let ar = ArResponse {
///     ar_type: ArType::SUPERVISOR,
///     ar_uuid: Uuid([1; 16]),
///     session_key: 1,
///     responder_mac: MacAddress([2, 0, 0, 0, 0, 1]),
///     udp_rt_port: 0x8892,
/// };
/// let response = ConnectResponse { ar, iocrs: vec![], alarm_cr: None, diff: None, server: None };
/// let mut out = Vec::new();
/// response.encode(&mut out);
/// assert_eq!(ConnectResponse::decode(Reader::new(&out)), Ok(response));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConnectResponse {
    /// First block.
    pub ar: ArResponse,
    /// One for each IOCR of the request, in its order.
    pub iocrs: Vec<IocrResponse>,
    /// Alarm channel, absent in an AR for record access.
    pub alarm_cr: Option<AlarmCrResponse>,
    /// What differs from what was expected; absent if nothing does.
    pub diff: Option<ModuleDiff>,
    /// Name of the responder.
    pub server: Option<ArServer>,
}

impl ConnectResponse {
    /// Reads all blocks `reader` has left; unknown ones are skipped.
    ///
    /// # Errors
    /// When a known block is malformed or the first is not an ARBlockRes.
    pub fn decode(mut reader: Reader<'_>) -> Result<Self, DecodeError> {
        let ar = ArResponse::decode(Block::expect(&mut reader, BlockType::AR_RESPONSE)?)?;
        let mut response = Self {
            ar,
            iocrs: Vec::new(),
            alarm_cr: None,
            diff: None,
            server: None,
        };
        for block in Blocks::new(reader) {
            let block = block?;
            let body = block.body;
            match block.block_type {
                BlockType::IOCR_RESPONSE if response.iocrs.len() >= 16 => {
                    return Err(body.error("IOCRBlockRes", 0, Problem::TooMany { limit: 16 }));
                }
                BlockType::IOCR_RESPONSE => response.iocrs.push(IocrResponse::decode(body)?),
                BlockType::ALARM_CR_RESPONSE => response.alarm_cr = Some(AlarmCrResponse::decode(body)?),
                BlockType::MODULE_DIFF => response.diff = Some(ModuleDiff::decode(body)?),
                BlockType::AR_SERVER => response.server = Some(ArServer::decode(body)?),
                _ => {}
            }
        }
        Ok(response)
    }

    /// Writes all blocks.
    pub fn encode(&self, out: &mut impl Writer) {
        self.ar.encode(out);
        for iocr in &self.iocrs {
            iocr.encode(out);
        }
        if let Some(alarm_cr) = &self.alarm_cr {
            alarm_cr.encode(out);
        }
        if let Some(diff) = &self.diff {
            diff.encode(out);
        }
        if let Some(server) = &self.server {
            server.encode(out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection::vec;
    use proptest::prelude::*;

    /// Connect.res of the S7-1500 capture, ARUUID and MAC replaced.
    const GOLDEN: &[u8] = b"\x81\x01\x00\x1e\x01\x00\x00\x01AAAAAAAAAAAAAAAA\x00\x02MMMMMM\x88\x92\
        \x81\x02\x00\x08\x01\x00\x00\x01\x00\x01\x80\x00\x81\x02\x00\x08\x01\x00\x00\x02\x00\x02\x80\x01\
        \x81\x03\x00\x08\x01\x00\x00\x01\x00\x00\x00\xc8\
        \x81\x06\x00\x10\x01\x00\x00\x0brt-labs-dev\x00";

    #[test]
    fn golden_connect_response() {
        let response = ConnectResponse::decode(Reader::new(GOLDEN)).unwrap();
        assert_eq!(response.ar.session_key, 2);
        assert_eq!(response.iocrs.len(), 2);
        assert_eq!(response.iocrs[1].frame_id, 0x8001);
        assert_eq!(response.alarm_cr.unwrap().max_alarm_data_length, 200);
        assert!(response.diff.is_none());
        assert_eq!(response.server.as_ref().unwrap().station_name, b"rt-labs-dev");
        let mut out = Vec::new();
        response.encode(&mut out);
        assert_eq!(out, GOLDEN);
    }

    fn request() -> impl Strategy<Value = ArRequest> {
        let numbers = any::<(u16, [u8; 16], u16, [u8; 6], [u8; 16])>();
        (numbers, any::<(u32, u16, u16, u16)>(), vec(any::<u8>(), 0..240)).prop_map(|(a, b, name)| {
            ArRequest {
                ar_type: ArType(a.0),
                ar_uuid: Uuid(a.1),
                session_key: a.2,
                initiator_mac: MacAddress(a.3),
                initiator_object: Uuid(a.4),
                properties: ArProperties(b.0),
                activity_timeout_factor: b.1,
                udp_rt_port: b.2,
                station_name_length: b.3,
                station_name: name,
            }
        })
    }

    proptest! {
        #[test]
        fn ar_requests_survive_the_wire(request in request()) {
            let mut out = Vec::new();
            request.encode(&mut out);
            let body = Block::expect(&mut Reader::new(&out), BlockType::AR_REQUEST).unwrap();
            prop_assert_eq!(ArRequest::decode(body), Ok(request));
            for end in 0..out.len() {
                prop_assert!(Block::decode(&mut Reader::new(&out[..end])).is_err());
            }
        }

        #[test]
        fn alarm_crs_survive_the_wire(a in any::<(u16, u16, u32, u16, u16)>(), b in any::<(u16, u16, u16, u16)>()) {
            let request = AlarmCrRequest {
                alarm_cr_type: a.0, lt: a.1, properties: a.2, rta_timeout_factor: a.3, rta_retries: a.4,
                local_alarm_reference: b.0, max_alarm_data_length: b.1, tag_high: b.2, tag_low: b.3,
            };
            let mut out = Vec::new();
            request.encode(&mut out);
            prop_assert_eq!(out.len(), 26);
            let body = Block::expect(&mut Reader::new(&out), BlockType::ALARM_CR_REQUEST).unwrap();
            prop_assert_eq!(AlarmCrRequest::decode(body), Ok(request));
        }

        #[test]
        fn damage_is_an_error_or_other_content(at in 0..GOLDEN.len(), bit in 0u8..8, end in 0..GOLDEN.len()) {
            let mut bytes = GOLDEN.to_vec();
            bytes[at] ^= 1 << bit;
            let _ = ConnectResponse::decode(Reader::new(&bytes));
            let _ = ConnectResponse::decode(Reader::new(&bytes[..end]));
        }
    }
}
