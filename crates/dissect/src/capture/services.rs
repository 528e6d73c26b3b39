//! Requests and responses of the context management services: connects, records, control, release.

use std::net::Ipv4Addr;

use profinet::wire::block::{
    BlockType, Blocks, ConnectResponse, ControlBlock, ControlCommand, MULTIPLE_WRITE, ModuleDiff,
    ReadRequest, ReadResponse, WriteItems, WriteRequest, WriteResponse,
};
use profinet::wire::rpc::{Header, NdrRequest, NdrResponse, operation};
use profinet::wire::{DecodeError, PnioStatus, Reader, Uuid};
use serde_json::Value;

use super::calls::Scene;
use super::event::{Connect, Detail, Record, Sink};
use super::jobs::is_parameter_record;
use super::udp::Datagram;
use super::{connect, contents, diff, records};
use crate::Weight;

/// Data of a request needed to decode its response.
#[derive(Debug, Default)]
pub enum Context {
    #[default]
    None,
    /// Which drive, and for what.
    Connect(Ipv4Addr, Box<connect::Asked>),
    /// Of which drive, and what.
    Read(Ipv4Addr, ReadRequest),
    Write(Ipv4Addr, Vec<WriteRequest>),
    Control(&'static str),
    /// Of which drive, and which connection.
    Release(Ipv4Addr, Uuid),
}

/// Returns the name of an operation.
pub const fn operation_name(header: &Header) -> &'static str {
    match header.operation {
        operation::CONNECT => "connect",
        operation::RELEASE => "release",
        operation::READ | operation::READ_IMPLICIT => "read",
        operation::WRITE => "write",
        operation::CONTROL => "control",
        _ => "call",
    }
}

/// Reports a request. Returns it in words and what its answer needs.
pub fn request(
    header: &Header,
    body: &[u8],
    datagram: &Datagram<'_>,
    scene: &mut Scene<'_>,
    sink: &mut Sink<'_>,
) -> Result<(String, Context), DecodeError> {
    let drive = *datagram.destination.ip();
    if matches!(
        header.operation,
        operation::CONNECT | operation::READ | operation::READ_IMPLICIT | operation::WRITE
    ) {
        scene.names.drives.called(drive, &header.object);
    }
    let mut reader = Reader::new(body);
    NdrRequest::decode(&mut reader, header.order)?;
    let name = operation_name(header).to_owned();
    Ok(match header.operation {
        operation::CONNECT => {
            let asked = connect::request(reader)?;
            for (text, detail) in asked.words(scene.names.drives.at(drive)) {
                sink.report(Weight::Normal, "connect", text, Detail::Connect(detail));
            }
            if let Some(ar) = &asked.ar {
                let source = Some(*datagram.source.ip());
                scene
                    .names
                    .seen(ar.initiator_mac, source, Some(&ar.station_name), sink);
            }
            if let Some(mac) = sink.target.mac {
                let model = scene.names.drives.at(drive);
                scene.ars.announce(&asked, mac, drive, model);
            }
            (name, Context::Connect(drive, Box::new(asked)))
        }
        operation::READ | operation::READ_IMPLICIT => {
            let read = ReadRequest::decode(&mut reader)?;
            let place = records::place(read.api, read.slot, read.subslot);
            let what = format!("read of {} {place}", records::name(read.index));
            (what, Context::Read(drive, read))
        }
        operation::WRITE => {
            let writes = writes(&mut reader, drive, scene, sink)?;
            let what = match writes.as_slice() {
                [one] => {
                    let place = records::place(one.api, one.slot, one.subslot);
                    format!("write of {} {place}", records::name(one.index))
                }
                many => format!("write of {} records", many.len()),
            };
            (what, Context::Write(drive, writes))
        }
        operation::RELEASE | operation::CONTROL => control(reader, drive, sink, name)?,
        other => {
            let text = format!("unknown operation {other}");
            let trouble = super::event::Trouble::Unknown { service: other };
            sink.report(Weight::Warning, "RPC", text, Detail::Trouble(trouble));
            (name, Context::None)
        }
    })
}

/// PrmEnd, ApplicationReady, Release and the like, and what ApplicationReady says of modules.
fn control(
    reader: Reader<'_>,
    drive: Ipv4Addr,
    sink: &mut Sink<'_>,
    name: String,
) -> Result<(String, Context), DecodeError> {
    let mut found = (name, Context::Control("control"));
    for block in Blocks::new(reader) {
        let block = block?;
        if block.block_type == BlockType::MODULE_DIFF {
            for (weight, text, detail) in diff::lines(&ModuleDiff::decode(block.body)?) {
                sink.report(weight, "connect", text, Detail::Connect(detail));
            }
        } else if let Ok(control) = ControlBlock::decode(block.block_type, block.body) {
            let what = command(control.command, block.block_type);
            let detail = Connect {
                step: match control.command {
                    ControlCommand::RELEASE => "release",
                    _ => "control",
                },
                ar_uuid: Some(control.ar_uuid.to_string()),
                session: Some(control.session_key),
                command: Some(control.command.0),
                ..Connect::default()
            };
            sink.report(Weight::Normal, "connect", what, Detail::Connect(detail));
            let context = match control.command {
                ControlCommand::RELEASE => Context::Release(drive, control.ar_uuid),
                _ => Context::Control(what),
            };
            found = (what.to_owned(), context);
        }
    }
    Ok(found)
}

fn command(command: ControlCommand, block: BlockType) -> &'static str {
    match command {
        ControlCommand::PRM_END => "end of parameters (PrmEnd)",
        ControlCommand::APPLICATION_READY => "application ready",
        ControlCommand::RELEASE => "release",
        ControlCommand::PRM_BEGIN => "begin of parameters (PrmBegin)",
        ControlCommand::READY_FOR_COMPANION => "ready for companion",
        ControlCommand::READY_FOR_RTC3 => "ready for RT class 3",
        _ => block.name().unwrap_or("unknown control"),
    }
}

/// One write, or the many of a multiple write.
fn writes(
    reader: &mut Reader<'_>,
    drive: Ipv4Addr,
    scene: &mut Scene<'_>,
    sink: &mut Sink<'_>,
) -> Result<Vec<WriteRequest>, DecodeError> {
    let mut writes = Vec::new();
    let (first, data) = WriteRequest::decode(reader)?;
    if first.index == MULTIPLE_WRITE {
        for item in WriteItems::new(Reader::new(data)) {
            let (write, data) = item?;
            note_write(drive, &write, data, scene, sink);
            writes.push(write);
        }
    } else {
        note_write(drive, &first, data, scene, sink);
        writes.push(first);
    }
    Ok(writes)
}

fn note_write(at: Ipv4Addr, write: &WriteRequest, data: &[u8], scene: &mut Scene<'_>, sink: &mut Sink<'_>) {
    let drive = scene.names.drives.at(at);
    if is_parameter_record(write.index) {
        scene.jobs.request(at, drive, write, data, sink);
        return;
    }
    let place = records::place(write.api, write.slot, write.subslot);
    let content = contents::describe(write.index, Reader::new(data));
    let text = match records::parameter(drive, write.slot, write.subslot, write.index) {
        Some(record) => format!("write {} {place} = {}", record.name, record.content(drive, data)),
        None => {
            let name = records::name(write.index);
            match &content {
                Some(content) => format!("write {name} {place}: {}", content.text),
                None => format!("write {name} {place}, {} octets", data.len()),
            }
        }
    };
    let detail = Record {
        service: "write",
        api: write.api,
        slot: write.slot,
        subslot: write.subslot,
        index: write.index,
        octets: data.len(),
        content: content.map_or(Value::Null, |content| content.fields),
        ..Record::default()
    };
    sink.report(Weight::Normal, "record", text, Detail::Record(detail));
}

/// Reports a response. `asked` is the frame number of its request.
pub fn response(
    header: &Header,
    body: &[u8],
    context: Context,
    asked: u64,
    scene: &mut Scene<'_>,
    sink: &mut Sink<'_>,
) -> Result<(), DecodeError> {
    let mut reader = Reader::new(body);
    let ndr = NdrResponse::decode(&mut reader, header.order)?;
    match context {
        Context::Connect(drive, request) if ndr.status.is_ok() => {
            let response = ConnectResponse::decode(reader)?;
            for (weight, text, detail) in request.answer(&response) {
                sink.report(weight, "connect", text, Detail::Connect(detail));
            }
            if let Some(server) = &response.server {
                let mac = response.ar.responder_mac;
                scene.names.seen(mac, None, Some(&server.station_name), sink);
            }
            let station = scene.names.drives.at(drive);
            scene.ars.open(&request, &response, drive, station);
        }
        Context::Connect(_, request) => {
            if let Some(ar) = &request.ar {
                scene.ars.withdraw(ar.ar_uuid);
            }
            refused_connect("connect", ndr.status, sink);
        }
        Context::Read(drive, read) if is_parameter_record(read.index) => {
            let data = if ndr.status.is_ok() {
                Some(ReadResponse::decode(&mut reader)?.1)
            } else {
                None
            };
            let station = scene.names.drives.at(drive);
            scene.jobs.answer(drive, station, &read, data, ndr.status, sink);
        }
        Context::Read(drive, read) => {
            let data = if ndr.status.is_ok() {
                Ok(ReadResponse::decode(&mut reader)?.1)
            } else {
                Err(ndr.status)
            };
            note_read(drive, &read, data, asked, scene, sink);
        }
        Context::Write(drive, writes) => {
            for write in &writes {
                let status = match WriteResponse::decode(&mut reader) {
                    Ok(response) if !response.status.is_ok() => response.status,
                    _ => ndr.status,
                };
                if !status.is_ok() {
                    refused_write(drive, write, status, asked, scene, sink);
                }
            }
        }
        Context::Release(drive, ar) if ndr.status.is_ok() => scene.ars.close(drive, ar),
        Context::Release(..) => refused_connect("release", ndr.status, sink),
        Context::Control(what) if !ndr.status.is_ok() => refused_connect(what, ndr.status, sink),
        // a response without its request contains only a status
        Context::None if !ndr.status.is_ok() => {
            refused_connect(operation_name(header), ndr.status, sink);
        }
        Context::Control(_) | Context::None => {}
    }
    Ok(())
}

fn note_read(
    at: Ipv4Addr,
    read: &ReadRequest,
    data: Result<&[u8], PnioStatus>,
    asked: u64,
    scene: &mut Scene<'_>,
    sink: &mut Sink<'_>,
) {
    let drive = scene.names.drives.at(at);
    let record = records::parameter(drive, read.slot, read.subslot, read.index);
    let what = record
        .as_ref()
        .map_or_else(|| records::name(read.index), |record| record.name.clone());
    let place = records::place(read.api, read.slot, read.subslot);
    let mut detail = Record {
        service: "read",
        api: read.api,
        slot: read.slot,
        subslot: read.subslot,
        index: read.index,
        request_frame: (asked > 0).then_some(asked),
        ..Record::default()
    };
    let data = match data {
        Ok(data) => data,
        Err(status) => {
            detail.status = Some(records::number(status));
            refused(&format!("read of {what} {place}"), status, detail, sink);
            return;
        }
    };
    detail.octets = data.len();
    let mut weight = Weight::Normal;
    let text = match record {
        Some(record) => format!("{what} {place} = {}", record.content(drive, data)),
        None => match contents::describe(read.index, Reader::new(data)) {
            Some(content) => {
                weight = content.weight;
                detail.content = content.fields;
                format!("{what} {place}: {}", content.text)
            }
            None => format!("{what} {place}: {}", records::content(data)),
        },
    };
    sink.report(weight, "record", text, Detail::Record(detail));
}

fn refused_write(
    at: Ipv4Addr,
    write: &WriteRequest,
    status: PnioStatus,
    asked: u64,
    scene: &mut Scene<'_>,
    sink: &mut Sink<'_>,
) {
    let drive = scene.names.drives.at(at);
    let what = records::parameter(drive, write.slot, write.subslot, write.index)
        .map_or_else(|| records::name(write.index), |record| record.name);
    let place = records::place(write.api, write.slot, write.subslot);
    let detail = Record {
        service: "write",
        api: write.api,
        slot: write.slot,
        subslot: write.subslot,
        index: write.index,
        status: Some(records::number(status)),
        request_frame: (asked > 0).then_some(asked),
        ..Record::default()
    };
    refused(&format!("write of {what} {place}"), status, detail, sink);
}

fn refused(what: &str, status: PnioStatus, detail: Record, sink: &mut Sink<'_>) {
    let text = format!("{what} refused: {status}");
    sink.report(Weight::Error, "refused", text, Detail::Record(detail));
}

fn refused_connect(what: &str, status: PnioStatus, sink: &mut Sink<'_>) {
    let detail = Connect {
        step: "refused",
        status: Some(records::number(status)),
        ..Connect::default()
    };
    let text = format!("{what} refused: {status}");
    sink.report(Weight::Error, "refused", text, Detail::Connect(detail));
}
