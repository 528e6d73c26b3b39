//! Remote procedure calls: connects, control services and records.

use profinet::wire::block::{
    AlarmCrRequest, ArRequest, Block, BlockType, ConnectResponse, ControlBlock, ExpectedModule, IocrRequest,
    MULTIPLE_WRITE, ModuleDiff, ReadRequest, ReadResponse, WriteItems, WriteRequest, WriteResponse,
};
use profinet::wire::rpc::{Header, NdrRequest, NdrResponse, PacketType, operation};
use profinet::wire::{DecodeError, Reader, Uuid};

use super::Notes;
use crate::capture::jobs::is_parameter_record;
use crate::capture::udp::Datagram;
use crate::capture::{Walker, contents};
use crate::job::{self, JobDrive, Side};

/// A datagram: a call of PROFINET, or data of another protocol.
pub fn datagram<'a>(
    walker: &Walker,
    datagram: &Datagram<'a>,
    notes: &mut Notes<'a>,
) -> Result<(), DecodeError> {
    let known = [Uuid::DEVICE_INTERFACE, Uuid::CONTROLLER_INTERFACE];
    let is_call = |header: &Header| known.contains(&header.interface);
    if !Header::decode(datagram.payload).is_ok_and(|(header, _)| is_call(&header)) {
        notes.reader(datagram.payload).rest("data");
        return Ok(());
    }
    let (header, body) = Header::read(notes.reader(datagram.payload))?;
    let head = datagram.payload.len().saturating_sub(body.len());
    notes.add(
        "RPC",
        datagram.payload.get(..head).unwrap_or_default(),
        packet(&header),
    );
    if header.flags.is_fragment() {
        // the whole is in several frames
        return Ok(());
    }
    let mut reader = notes.reader(body);
    match header.packet_type {
        PacketType::Request => {
            NdrRequest::decode(&mut reader, header.order)?;
            let drive = walker.names.drives.known(*datagram.destination.ip());
            request(&drive, &header, reader, notes)
        }
        PacketType::Response => {
            let ndr = NdrResponse::decode(&mut reader, header.order)?;
            if !ndr.status.is_ok() && reader.is_empty() {
                return Ok(());
            }
            let drive = walker.names.drives.known(*datagram.source.ip());
            response(walker, &drive, &header, reader, notes)
        }
        _ => Ok(()),
    }
}

fn packet(header: &Header) -> String {
    let name = crate::capture::services::operation_name(header);
    match header.packet_type {
        PacketType::Request => format!("{name} request"),
        PacketType::Response => format!("{name} response"),
        other => format!("{other:?} of {name}"),
    }
}

fn request<'a>(
    drive: &JobDrive,
    header: &Header,
    mut reader: Reader<'a>,
    notes: &mut Notes<'a>,
) -> Result<(), DecodeError> {
    match header.operation {
        operation::READ | operation::READ_IMPLICIT => ReadRequest::decode(&mut reader).map(|_| ()),
        operation::WRITE => {
            let (first, data) = WriteRequest::decode(&mut reader)?;
            if first.index != MULTIPLE_WRITE {
                record(drive, first.index, data, Side::Request, None, notes);
                return Ok(());
            }
            for item in WriteItems::new(notes.reader(data)) {
                let (write, data) = item?;
                record(drive, write.index, data, Side::Request, None, notes);
            }
            Ok(())
        }
        _ => blocks(reader),
    }
}

fn response<'a>(
    walker: &Walker,
    drive: &JobDrive,
    header: &Header,
    mut reader: Reader<'a>,
    notes: &mut Notes<'a>,
) -> Result<(), DecodeError> {
    match header.operation {
        operation::CONNECT => ConnectResponse::decode(reader).map(|_| ()),
        operation::READ | operation::READ_IMPLICIT => {
            let (read, data) = ReadResponse::decode(&mut reader)?;
            let asked = walker.calls.answered();
            record(drive, read.index, data, Side::Response, asked, notes);
            Ok(())
        }
        operation::WRITE => {
            while !reader.is_empty() {
                WriteResponse::decode(&mut reader)?;
            }
            Ok(())
        }
        _ => blocks(reader),
    }
}

/// The blocks of a connect or of a control service. What is in a block of another kind is not known here.
fn blocks(mut reader: Reader<'_>) -> Result<(), DecodeError> {
    while !reader.is_empty() {
        let block = Block::decode(&mut reader)?;
        let mut body = block.body;
        match block.block_type {
            BlockType::AR_REQUEST => ArRequest::decode(body).map(|_| ())?,
            BlockType::IOCR_REQUEST => IocrRequest::decode(body).map(|_| ())?,
            BlockType::ALARM_CR_REQUEST => AlarmCrRequest::decode(body).map(|_| ())?,
            BlockType::EXPECTED_SUBMODULE => ExpectedModule::decode_block(body).map(|_| ())?,
            BlockType::MODULE_DIFF => ModuleDiff::decode(body).map(|_| ())?,
            kind if matches!(kind.0 & 0x7FFF, 0x0110..=0x0118) => {
                ControlBlock::decode(kind, body).map(|_| ())?;
            }
            _ => {
                body.rest("data");
            }
        }
    }
    Ok(())
}

/// The content of a record: a parameter job, or a record of PROFINET.
fn record<'a>(
    drive: &JobDrive,
    index: u16,
    data: &'a [u8],
    side: Side,
    asked: Option<&[u8]>,
    notes: &mut Notes<'a>,
) {
    if is_parameter_record(index) {
        for part in job::parts(drive, data, side, asked) {
            notes.add_part(data, part);
        }
    } else {
        contents::describe(index, notes.reader(data));
    }
}
