//! Reads a payload with our decoders and encodes the result with our builders. Equal octets mean that nothing was
//! misread, lost or invented.

use profinet::wire::alarm::{Alarm, RtaPdu, RtaType};
use profinet::wire::block::{
    AlarmCrRequest, AlarmCrResponse, ArRequest, ArResponse, ArServer, Block, BlockType, ControlBlock,
    ExpectedModule, IocrRequest, IocrResponse, ModuleDiff, ReadRequest, ReadResponse, WriteRequest,
    WriteResponse, write_block,
};
use profinet::wire::dcp::{DcpOption, Pdu, PduWriter, ServiceId, ServiceType};
use profinet::wire::rpc::{Header, NdrRequest, NdrResponse, PacketType};
use profinet::wire::{DecodeError, Reader, Writer};

/// Returns a DCP PDU, the octets behind the FrameID without the padding of the frame.
///
/// # Errors
/// Whatever our decoder found wrong.
pub fn dcp(bytes: &[u8]) -> Result<Vec<u8>, DecodeError> {
    let pdu = Pdu::parse(bytes)?;
    let mut out = Vec::new();
    let mut writer = PduWriter::new(&mut out, pdu.service, pdu.kind, pdu.xid, pdu.delay_factor);
    let request = pdu.kind == ServiceType::Request;
    if request && pdu.service == ServiceId::Get {
        for option in pdu.requested() {
            writer.request(option?);
        }
    } else {
        for block in pdu.blocks() {
            let block = block?;
            if block.option == DcpOption::RESPONSE {
                let (option, error) = block.result()?;
                writer.result(option, error);
            } else if request && pdu.service == ServiceId::Identify {
                writer.filter(&block.filter()?);
            } else if request && pdu.service == ServiceId::Set {
                let (qualifier, value) = block.set()?;
                writer.set(qualifier, &value);
            } else {
                let (info, value) = block.info()?;
                writer.info(info, &value);
            }
        }
    }
    writer.finish();
    Ok(out)
}

/// Returns a PROFINET RPC PDU of the device or controller interface: header, NDR header, blocks.
///
/// # Errors
/// Whatever our decoders found wrong.
pub fn rpc(bytes: &[u8]) -> Result<Vec<u8>, DecodeError> {
    let (header, body) = Header::decode(bytes)?;
    let mut stub = Vec::new();
    let mut reader = Reader::new(body);
    match header.packet_type {
        PacketType::Request => NdrRequest::decode(&mut reader, header.order)?.encode(&mut stub, header.order),
        PacketType::Response => {
            NdrResponse::decode(&mut reader, header.order)?.encode(&mut stub, header.order)
        }
        _ => stub.extend_from_slice(reader.rest("data")),
    }
    blocks(&mut reader, &mut stub)?;
    let mut out = Vec::new();
    header.encode(&mut out, stub.len());
    out.extend_from_slice(&stub);
    Ok(out)
}

/// Returns an RTA PDU with its alarm, the octets behind the FrameID.
///
/// # Errors
/// Whatever our decoder found wrong.
pub fn alarm(bytes: &[u8]) -> Result<Vec<u8>, DecodeError> {
    let pdu = RtaPdu::parse(bytes)?;
    let mut data = Vec::new();
    match pdu.kind {
        RtaType::Data => {
            let alarm = pdu.alarm()?;
            if let Alarm::Notification(notification) = &alarm {
                for item in notification.items() {
                    let _ = item?;
                }
            }
            alarm.encode(&mut data);
        }
        RtaType::Err => {
            pdu.error()?.encode(&mut data);
            data.bytes(&pdu.data[4..]);
        }
        _ => data.bytes(pdu.data),
    }
    let mut out = Vec::new();
    RtaPdu { data: &data, ..pdu }.encode(&mut out);
    Ok(out)
}

/// All blocks that `reader` has left, record headers with their data included.
///
/// # Errors
/// Whatever our decoders found wrong.
pub fn blocks(reader: &mut Reader<'_>, out: &mut Vec<u8>) -> Result<(), DecodeError> {
    while !reader.is_empty() {
        let mut look = *reader;
        match BlockType(look.u16("BlockType")?) {
            BlockType::READ_REQUEST => ReadRequest::decode(reader)?.encode(out),
            BlockType::READ_RESPONSE => {
                let (header, data) = ReadResponse::decode(reader)?;
                header.encode(out);
                out.bytes(data);
            }
            BlockType::WRITE_REQUEST => {
                let (header, data) = WriteRequest::decode(reader)?;
                header.encode(out);
                out.bytes(data);
            }
            BlockType::WRITE_RESPONSE => WriteResponse::decode(reader)?.encode(out),
            _ => block(Block::decode(reader)?, out)?,
        }
    }
    Ok(())
}

fn block(block: Block<'_>, out: &mut Vec<u8>) -> Result<(), DecodeError> {
    let body = block.body;
    match block.block_type {
        BlockType::AR_REQUEST => ArRequest::decode(body)?.encode(out),
        BlockType::AR_RESPONSE => ArResponse::decode(body)?.encode(out),
        BlockType::IOCR_REQUEST => IocrRequest::decode(body)?.encode(out),
        BlockType::IOCR_RESPONSE => IocrResponse::decode(body)?.encode(out),
        BlockType::ALARM_CR_REQUEST => AlarmCrRequest::decode(body)?.encode(out),
        BlockType::ALARM_CR_RESPONSE => AlarmCrResponse::decode(body)?.encode(out),
        BlockType::EXPECTED_SUBMODULE => {
            ExpectedModule::encode_block(&ExpectedModule::decode_block(body)?, out)
        }
        BlockType::MODULE_DIFF => ModuleDiff::decode(body)?.encode(out),
        BlockType::AR_SERVER => ArServer::decode(body)?.encode(out),
        kind if is_control(kind) => ControlBlock::decode(kind, body)?.encode(out),
        kind => {
            let mut body = body;
            write_block(out, kind, block.version.1, |out| out.bytes(body.rest("data")));
        }
    }
    Ok(())
}

fn is_control(kind: BlockType) -> bool {
    matches!(kind.0 & 0x7FFF, 0x0110..=0x0114 | 0x0116..=0x0118)
}
