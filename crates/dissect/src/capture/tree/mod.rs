//! One frame of a capture as a tree: the decoders of the wire note where they read, and what belongs to a drive is added
//! with what the capture showed before.

mod cyclic;
mod rpc;

use profinet::wire::alarm::{Alarm, DiagnosisItems, RtaPdu, RtaType};
use profinet::wire::dcp::{self, DcpOption, ServiceId, ServiceType};
use profinet::wire::ethernet::{self, Frame, FrameKind};
use profinet::wire::lldp::{self, Lldpdu};
use profinet::wire::{DecodeError, PnioStatus, Reader, Trace};

use super::{Walker, arp, diagnosis, udp};
use crate::job::Part;
use crate::tree::{self, Node};

/// Nodes of one frame.
pub struct Notes<'a> {
    trace: &'a Trace<'a>,
    /// What the decoders of the wire do not note.
    nodes: Vec<Node>,
}

impl<'a> Notes<'a> {
    /// Reads a part of the frame with a note of every field.
    pub const fn reader(&self, octets: &'a [u8]) -> Reader<'a> {
        Reader::new(octets).traced(self.trace)
    }

    /// Adds a node for octets of the frame.
    pub fn add(&mut self, name: impl Into<String>, octets: &[u8], value: impl Into<String>) {
        if let Some(place) = self.trace.place(octets) {
            self.nodes.push(Node::new(name, place, value));
        }
    }

    /// Adds a part of data that is in the frame, by its place in the data.
    pub fn add_part(&mut self, data: &[u8], part: Part) {
        let place = self.trace.place(data).filter(|_| part.octets.end <= data.len());
        if let Some(place) = place {
            let octets = place.start + part.octets.start..place.start + part.octets.end;
            self.nodes.push(Node {
                weight: part.weight,
                ..Node::new(part.name, octets, part.text)
            });
        }
    }
}

/// Returns a frame as a tree.
pub fn of(walker: &Walker, frame: &[u8]) -> Node {
    let trace = Trace::new(frame);
    let mut notes = Notes {
        trace: &trace,
        nodes: Vec::new(),
    };
    // what is malformed is in the notes
    let _ = descend(walker, frame, &mut notes);
    let mut nodes = std::mem::take(&mut notes.nodes);
    let fields = trace.fields();
    // parts of a drive are inside of the fields of the wire
    nodes.splice(0..0, fields.iter().map(|field| tree::field(field, frame)));
    let mut tree = Node::new("frame", 0..frame.len(), format!("{} octets", frame.len())).with(nodes);
    tree.show_octets(frame);
    tree
}

fn descend<'a>(walker: &Walker, frame: &'a [u8], notes: &mut Notes<'a>) -> Result<(), DecodeError> {
    let mut reader = notes.reader(frame);
    reader.array::<6>("destination")?;
    reader.array::<6>("source")?;
    if reader.u16("EtherType")? == ethernet::TPID {
        reader.u16("VLAN tag")?;
        reader.u16("EtherType")?;
    }
    reader.enclose("Ethernet", 0);
    if let Some(parsed) = Frame::parse(frame) {
        reader.u16("FrameID")?;
        profinet(walker, &parsed, notes)
    } else if let Some((_, payload)) = lldp::payload(frame) {
        Lldpdu::decode(notes.reader(payload)).map(|_| ())
    } else if arp::frame(frame).is_some() {
        address_resolution(reader)
    } else if let Some(datagram) = udp::datagram(frame) {
        internet(reader)?;
        rpc::datagram(walker, &datagram, notes)
    } else {
        reader.rest("data");
        Ok(())
    }
}

fn address_resolution(mut reader: Reader<'_>) -> Result<(), DecodeError> {
    let start = reader.position();
    reader.u16("hardware type")?;
    reader.u16("protocol type")?;
    reader.u8("hardware length")?;
    reader.u8("protocol length")?;
    reader.u16("operation")?;
    for who in ["sender", "target"] {
        reader.array::<6>(who)?;
        reader.array::<4>(if who == "sender" {
            "sender IP address"
        } else {
            "target IP address"
        })?;
    }
    reader.enclose("ARP", start);
    Ok(())
}

/// The headers of IP and UDP.
fn internet(mut reader: Reader<'_>) -> Result<(), DecodeError> {
    let start = reader.position();
    let length = usize::from(reader.u8("version and header length")? & 0xF) * 4;
    reader.u8("type of service")?;
    reader.u16("total length")?;
    reader.u16("identification")?;
    reader.u16("flags and fragment offset")?;
    reader.u8("time to live")?;
    reader.u8("protocol")?;
    reader.u16("header checksum")?;
    reader.array::<4>("source address")?;
    reader.array::<4>("destination address")?;
    reader.bytes(length.saturating_sub(20), "options")?;
    reader.enclose("IP", start);
    let start = reader.position();
    reader.u16("source port")?;
    reader.u16("destination port")?;
    reader.u16("length")?;
    reader.u16("checksum")?;
    reader.enclose("UDP", start);
    Ok(())
}

fn profinet<'a>(walker: &Walker, frame: &Frame<'a>, notes: &mut Notes<'a>) -> Result<(), DecodeError> {
    match frame.frame_id.kind() {
        FrameKind::DcpHello
        | FrameKind::DcpGetSet
        | FrameKind::DcpIdentifyRequest
        | FrameKind::DcpIdentifyResponse => discovery(frame.payload, notes),
        FrameKind::AlarmHigh | FrameKind::AlarmLow => alarm(frame.payload, notes),
        _ if frame.frame_id.is_cyclic() => {
            cyclic::data(walker, frame, notes);
            Ok(())
        }
        _ => {
            notes.reader(frame.payload).rest("data");
            Ok(())
        }
    }
}

fn discovery<'a>(payload: &'a [u8], notes: &mut Notes<'a>) -> Result<(), DecodeError> {
    let pdu = dcp::Pdu::decode(notes.reader(payload))?;
    let request = pdu.kind == ServiceType::Request;
    let mut reader = notes.reader(pdu.data);
    if pdu.service == ServiceId::Get && request {
        while !reader.is_empty() {
            let octets = reader.peek_rest();
            let [option, suboption] = reader.array("DCP requested option")?;
            let name = DcpOption { option, suboption }.to_string();
            notes.add(name, octets.get(..2).unwrap_or_default(), "");
        }
        return Ok(());
    }
    for block in dcp::Blocks::new(reader) {
        let block = block?;
        let mut value = notes.reader(block.body);
        if let Some(whole) = notes.trace.place(block.body)
            && let Some(start) = whole.start.checked_sub(dcp::BLOCK_HEADER)
        {
            let node = Node::new("DCP block", start..whole.end, block.option.to_string());
            notes.nodes.push(node);
        }
        if block.option == DcpOption::RESPONSE {
            value.u8("DCP Option")?;
            value.u8("DCP Suboption")?;
            value.u8("DCP BlockError")?;
            continue;
        }
        match pdu.service {
            ServiceId::Identify if request => {}
            ServiceId::Set => {
                value.u16("DCP BlockQualifier")?;
            }
            _ => {
                value.u16("DCP BlockInfo")?;
            }
        }
        dcp::Value::decode(block.option, value)?;
    }
    Ok(())
}

fn alarm<'a>(payload: &'a [u8], notes: &mut Notes<'a>) -> Result<(), DecodeError> {
    let pdu = RtaPdu::decode(notes.reader(payload))?;
    let mut reader = notes.reader(pdu.data);
    match pdu.kind {
        RtaType::Err => PnioStatus::decode(&mut reader).map(|_| ()),
        RtaType::Data => {
            if let Alarm::Notification(alarm) = Alarm::decode(reader)?
                && let std::borrow::Cow::Borrowed(data) = alarm.data
            {
                for item in DiagnosisItems::new(alarm.usi, data).flatten() {
                    let item = diagnosis::item(&item);
                    let part = Part::new("diagnosis", 0..data.len(), item.text);
                    notes.add_part(data, part.weighing(item.weight));
                }
            }
            Ok(())
        }
        _ => Ok(()),
    }
}
