//! Remote procedure calls: fragments put together, answers matched with their requests.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::net::Ipv4Addr;

use profinet::wire::block::{
    BlockType, Blocks, ControlBlock, ControlCommand, MULTIPLE_WRITE, ReadRequest, ReadResponse, WriteItems,
    WriteRequest, WriteResponse,
};
use profinet::wire::rpc::{Header, NdrRequest, NdrResponse, PacketType, operation, reject};
use profinet::wire::{DecodeError, PnioStatus, Reader, Uuid};

use super::cyclic::Relations;
use super::jobs::{Jobs, is_parameter_record};
use super::names::Names;
use super::udp::Datagram;
use super::{Sink, Weight, connect, records};

/// Most calls remembered at a time.
const MAX_CALLS: usize = 1024;
/// Largest request or answer put together.
const MAX_BODY: usize = 1 << 20;

/// Who asks whom, and the call: activities are told apart by their client, and a client may use one towards several.
type Key = (Ipv4Addr, Ipv4Addr, Uuid, u32);

/// All calls of a capture that may still be answered.
#[derive(Debug, Default)]
pub struct Calls {
    open: HashMap<Key, Call>,
    order: VecDeque<Key>,
    jobs: Jobs,
    seen: u64,
}

#[derive(Debug, Default)]
struct Call {
    request: Assembly,
    response: Assembly,
    context: Context,
}

/// What an answer needs to know of its request.
#[derive(Debug, Default)]
enum Context {
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

/// A body in pieces.
#[derive(Debug, Default)]
struct Assembly {
    fragments: BTreeMap<u16, Vec<u8>>,
    last: Option<u16>,
    octets: usize,
    done: bool,
}

impl Assembly {
    /// Takes a piece; gives the whole once, when the last piece is there.
    fn add(&mut self, header: &Header, body: &[u8]) -> Option<Vec<u8>> {
        if self.done {
            return None;
        }
        if !header.flags.is_fragment() {
            self.done = true;
            return Some(body.to_vec());
        }
        if self.octets + body.len() > MAX_BODY {
            return None;
        }
        if header.flags.is_last() {
            self.last = Some(header.fragment);
        }
        if self.fragments.insert(header.fragment, body.to_vec()).is_none() {
            self.octets += body.len();
        }
        let last = self.last?;
        if self.fragments.len() != usize::from(last) + 1 || self.fragments.keys().next_back() != Some(&last) {
            return None;
        }
        self.done = true;
        Some(
            std::mem::take(&mut self.fragments)
                .into_values()
                .flatten()
                .collect(),
        )
    }
}

impl Calls {
    /// RPC packets seen.
    pub const fn seen(&self) -> u64 {
        self.seen
    }

    /// Looks at one datagram; other protocols are passed over.
    pub fn datagram(
        &mut self,
        datagram: &Datagram<'_>,
        relations: &mut Relations,
        names: &mut Names,
        sink: &mut Sink<'_>,
    ) -> Result<(), DecodeError> {
        let Ok((header, body)) = Header::decode(datagram.payload) else {
            return Ok(());
        };
        let known = [
            Uuid::DEVICE_INTERFACE,
            Uuid::CONTROLLER_INTERFACE,
            Uuid::ENDPOINT_MAPPER,
        ];
        if !known.contains(&header.interface) {
            return Ok(());
        }
        self.seen += 1;
        if header.interface == Uuid::ENDPOINT_MAPPER {
            return Ok(());
        }
        let (source, destination) = (*datagram.source.ip(), *datagram.destination.ip());
        let (client, server) = match header.packet_type {
            PacketType::Request | PacketType::Ping | PacketType::Ack | PacketType::Cancel => {
                (source, destination)
            }
            _ => (destination, source),
        };
        let key = (client, server, header.activity, header.sequence);
        match header.packet_type {
            PacketType::Request => {
                let call = self.call(key);
                if let Some(whole) = call.request.add(&header, body) {
                    let context = request(&header, &whole, datagram, &mut self.jobs, names, sink)?;
                    self.call(key).context = context;
                }
            }
            PacketType::Response => {
                let call = self.call(key);
                if let Some(whole) = call.response.add(&header, body) {
                    let context = std::mem::take(&mut call.context);
                    response(&header, &whole, context, &mut self.jobs, relations, names, sink)?;
                }
            }
            PacketType::Fault | PacketType::Reject => {
                let status = Reader::new(body).u32_in(header.order, "reject status")?;
                let words = reject::words(status).unwrap_or("unknown reason");
                sink.note(
                    Weight::Error,
                    "RPC",
                    format!("call refused: {words} (0x{status:08X})"),
                );
            }
            PacketType::NoCall => sink.note(Weight::Warning, "RPC", "call is not known there"),
            _ => {}
        }
        Ok(())
    }

    fn call(&mut self, key: Key) -> &mut Call {
        if !self.open.contains_key(&key) {
            if self.order.len() >= MAX_CALLS
                && let Some(oldest) = self.order.pop_front()
            {
                self.open.remove(&oldest);
            }
            self.order.push_back(key);
        }
        self.open.entry(key).or_default()
    }
}

fn request(
    header: &Header,
    body: &[u8],
    datagram: &Datagram<'_>,
    jobs: &mut Jobs,
    names: &mut Names,
    sink: &mut Sink<'_>,
) -> Result<Context, DecodeError> {
    let drive = *datagram.destination.ip();
    if matches!(
        header.operation,
        operation::CONNECT | operation::READ | operation::READ_IMPLICIT | operation::WRITE
    ) {
        names.drives.called(drive, &header.object);
    }
    let mut reader = Reader::new(body);
    NdrRequest::decode(&mut reader, header.order)?;
    Ok(match header.operation {
        operation::CONNECT => {
            let asked = connect::request(reader)?;
            if let Some(ar) = &asked.ar {
                names.learn(
                    Some(ar.initiator_mac),
                    Some(*datagram.source.ip()),
                    &ar.station_name,
                );
                sink.from = names.ip(*datagram.source.ip());
            }
            for line in asked.words(names.drives.at(drive)) {
                sink.note(Weight::Normal, "connect", line);
            }
            Context::Connect(drive, Box::new(asked))
        }
        operation::READ | operation::READ_IMPLICIT => Context::Read(drive, ReadRequest::decode(&mut reader)?),
        operation::WRITE => {
            let mut writes = Vec::new();
            let (first, data) = WriteRequest::decode(&mut reader)?;
            if first.index == MULTIPLE_WRITE {
                for item in WriteItems::new(Reader::new(data)) {
                    let (write, data) = item?;
                    note_write(drive, &write, data, jobs, names, sink);
                    writes.push(write);
                }
            } else {
                note_write(drive, &first, data, jobs, names, sink);
                writes.push(first);
            }
            Context::Write(drive, writes)
        }
        operation::RELEASE | operation::CONTROL => {
            let mut context = Context::Control("control");
            for block in Blocks::new(reader) {
                let block = block?;
                if let Ok(control) = ControlBlock::decode(block.block_type, block.body) {
                    let what = command(control.command, block.block_type);
                    sink.note(Weight::Normal, "connect", what);
                    context = match control.command {
                        ControlCommand::RELEASE => Context::Release(drive, control.ar_uuid),
                        _ => Context::Control(what),
                    };
                    break;
                }
            }
            context
        }
        other => {
            sink.note(Weight::Warning, "RPC", format!("unknown operation {other}"));
            Context::None
        }
    })
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

fn note_write(
    at: Ipv4Addr,
    write: &WriteRequest,
    data: &[u8],
    jobs: &mut Jobs,
    names: &mut Names,
    sink: &mut Sink<'_>,
) {
    let drive = names.drives.at(at);
    if is_parameter_record(write.index) {
        jobs.request(at, drive, write, data, sink);
    } else {
        let place = records::place(write.api, write.slot, write.subslot);
        let text = match records::parameter(drive, write.slot, write.subslot, write.index) {
            Some(record) => format!("write {} {place} = {}", record.name, record.content(drive, data)),
            None => format!(
                "write {} {place}, {} octets",
                records::name(write.index),
                data.len()
            ),
        };
        sink.note(Weight::Normal, "record", text);
    }
}

fn response(
    header: &Header,
    body: &[u8],
    context: Context,
    jobs: &mut Jobs,
    relations: &mut Relations,
    names: &mut Names,
    sink: &mut Sink<'_>,
) -> Result<(), DecodeError> {
    let mut reader = Reader::new(body);
    let ndr = NdrResponse::decode(&mut reader, header.order)?;
    match context {
        Context::Connect(drive, asked) if ndr.status.is_ok() => {
            let response = profinet::wire::block::ConnectResponse::decode(reader)?;
            for (weight, line) in asked.answer(&response) {
                sink.note(weight, "connect", line);
            }
            if let Some(server) = &response.server {
                names.learn(Some(response.ar.responder_mac), None, &server.station_name);
            }
            relations.open(&asked, &response, drive, names.drives.at(drive));
        }
        Context::Connect(..) => refused("connect", ndr.status, sink),
        Context::Read(drive, read) if is_parameter_record(read.index) => {
            let data = if ndr.status.is_ok() {
                Some(ReadResponse::decode(&mut reader)?.1)
            } else {
                None
            };
            jobs.answer(drive, names.drives.at(drive), &read, data, ndr.status, sink);
        }
        Context::Read(drive, read) => {
            let drive = names.drives.at(drive);
            let record = records::parameter(drive, read.slot, read.subslot, read.index);
            let what = record
                .as_ref()
                .map_or_else(|| records::name(read.index), |record| record.name.clone());
            let place = records::place(read.api, read.slot, read.subslot);
            if ndr.status.is_ok() {
                let (_, data) = ReadResponse::decode(&mut reader)?;
                let text = match record {
                    Some(record) => format!("{what} {place} = {}", record.content(drive, data)),
                    None => format!("{what} {place}: {}", records::content(data)),
                };
                sink.note(Weight::Normal, "record", text);
            } else {
                refused(&format!("read of {what} {place}"), ndr.status, sink);
            }
        }
        Context::Write(drive, writes) => {
            for write in &writes {
                let status = match WriteResponse::decode(&mut reader) {
                    Ok(response) if !response.status.is_ok() => response.status,
                    _ => ndr.status,
                };
                if !status.is_ok() {
                    let drive = names.drives.at(drive);
                    let what = records::parameter(drive, write.slot, write.subslot, write.index)
                        .map_or_else(|| records::name(write.index), |record| record.name);
                    let place = records::place(write.api, write.slot, write.subslot);
                    refused(&format!("write of {what} {place}"), status, sink);
                }
            }
        }
        Context::Release(drive, ar) if ndr.status.is_ok() => relations.close(drive, ar),
        Context::Release(..) => refused("release", ndr.status, sink),
        Context::Control(what) if !ndr.status.is_ok() => refused(what, ndr.status, sink),
        Context::Control(_) | Context::None => {}
    }
    Ok(())
}

fn refused(what: &str, status: PnioStatus, sink: &mut Sink<'_>) {
    sink.note(Weight::Error, "refused", format!("{what} refused: {status}"));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decode::{Walker, udp};
    use profinet::wire::rpc::Flags;

    fn fragment(number: u16, last: bool) -> Header {
        let mut header = Header::request(Uuid::NIL, Uuid::DEVICE_INTERFACE, Uuid::NIL, 0, operation::WRITE);
        header.flags = Flags(Flags::FRAGMENT | if last { Flags::LAST_FRAGMENT } else { 0 });
        header.fragment = number;
        header
    }

    #[test]
    fn fragments_in_any_order_and_twice() {
        let mut assembly = Assembly::default();
        assert_eq!(assembly.add(&fragment(2, true), b"c"), None);
        assert_eq!(assembly.add(&fragment(0, false), b"a"), None);
        assert_eq!(assembly.add(&fragment(0, false), b"a"), None);
        assert_eq!(assembly.add(&fragment(1, false), b"b"), Some(b"abc".to_vec()));
        assert_eq!(
            assembly.add(&fragment(1, false), b"b"),
            None,
            "a repetition is not told twice"
        );
    }

    #[test]
    fn memory_is_bounded() {
        let mut calls = Calls::default();
        for sequence in 0..5000 {
            calls.call((Ipv4Addr::LOCALHOST, Ipv4Addr::LOCALHOST, Uuid::NIL, sequence));
        }
        assert_eq!((calls.open.len(), calls.order.len()), (MAX_CALLS, MAX_CALLS));
    }

    /// A controller that begins with the same identifiers towards each device: both releases are told.
    #[test]
    fn the_same_activity_towards_two_devices_is_two_calls() {
        let mut blocks = Vec::new();
        let release = ControlBlock::new(BlockType::RELEASE, Uuid([9; 16]), 1, ControlCommand::RELEASE);
        release.encode(&mut blocks);
        let length = u32::try_from(blocks.len()).unwrap();
        let ndr = NdrRequest {
            args_maximum: length,
            args_length: length,
        };
        let mut body = Vec::new();
        ndr.encode(&mut body, profinet::wire::ByteOrder::Big);
        body.extend(blocks);
        let mut frame = udp::tests::rpc_frame(operation::RELEASE.try_into().unwrap(), &body);
        let mut walker = Walker::default();
        let mut told = Vec::new();
        for last in [2, 2, 3] {
            frame[33] = last;
            let notes = walker.frame(std::time::Duration::ZERO, &frame);
            told.extend(notes.into_iter().map(|note| (note.to, note.text)));
        }
        let expected = ["10.0.0.2", "10.0.0.3"].map(|to| (to.to_owned(), "release".to_owned()));
        assert_eq!(told, expected, "a repetition is told once");
    }
}
