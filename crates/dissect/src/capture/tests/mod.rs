//! Generated captures: frames made by our own encoders and by hand, and what is reported of them.

mod alarms;
mod connections;
mod records;
mod stations;

use std::time::Duration;

use profinet::wire::block::{
    ArProperties, ArRequest, ArResponse, ArType, ConnectResponse, DataDescription, ExpectedModule,
    ExpectedSubmodule, FrameObject, IocrApi, IocrRequest, IocrResponse, IocrType,
};
use profinet::wire::ethernet::{self, FrameId};
use profinet::wire::rpc::{Header, NdrRequest, NdrResponse, PacketType, operation};
use profinet::wire::{ByteOrder, PnioStatus, Uuid};
use proptest::prelude::*;

use super::*;

/// Last octets of the addresses of the controller and of the device.
const PLC: u8 = 1;
const DRIVE: u8 = 2;

/// A capture that is made frame by frame.
#[derive(Default)]
struct Capture {
    walker: Walker,
    events: Vec<Event>,
}

impl Capture {
    /// Adds a frame at a time in milliseconds; gives the texts of its events.
    fn at(&mut self, millis: u64, frame: &[u8]) -> Vec<String> {
        let events = self.walker.frame(Duration::from_millis(millis), frame);
        self.take(events)
    }

    /// Lets time pass with a frame that means nothing.
    fn wait(&mut self, millis: u64) -> Vec<String> {
        self.at(millis, &[0xFF; 60])
    }

    /// Ends the capture.
    fn end(&mut self) -> Vec<String> {
        let events = self.walker.end();
        self.take(events)
    }

    fn take(&mut self, events: Vec<Event>) -> Vec<String> {
        let texts = events.iter().map(|event| event.text.clone()).collect();
        self.events.extend(events);
        texts
    }

    /// Returns the last event.
    fn last(&self) -> &Event {
        self.events.last().expect("an event")
    }

    /// Returns the texts of everything that points to a fault.
    fn trouble(&self) -> Vec<&str> {
        let events = self.events.iter().filter(|event| event.is_trouble());
        events.map(|event| event.text.as_str()).collect()
    }
}

const fn mac(last: u8) -> MacAddress {
    MacAddress([2, 0, 0, 0, 0, last])
}

/// Makes a frame one of a station with a larger number.
fn sent_by(number: u16, frame: &mut [u8]) {
    let [high, low] = number.to_be_bytes();
    frame[6..12].copy_from_slice(&[2, 0, 0, 1, high, low]);
}

/// Returns a PROFINET frame between two stations.
fn frame(from: u8, to: MacAddress, id: FrameId, payload: &[u8]) -> Vec<u8> {
    let mut buffer = [0; 1600];
    let length = ethernet::emit(&mut buffer, to, mac(from), None, id, payload).expect("room");
    buffer[..length].to_vec()
}

/// Cyclic data with a cycle counter; `status` is the DataStatus.
fn cyclic(from: u8, to: u8, id: u16, data: &[u8], counter: u16, status: u8) -> Vec<u8> {
    let mut payload = data.to_vec();
    payload.resize(40, 0);
    payload.extend(counter.to_be_bytes());
    payload.extend([status, 0]);
    frame(from, mac(to), FrameId(id), &payload)
}

/// An RPC call of the device interface.
#[derive(Clone, Copy)]
struct Call {
    client: u8,
    server: u8,
    activity: u8,
    sequence: u32,
    operation: u16,
}

impl Call {
    const fn new(operation: u16) -> Self {
        Self {
            client: PLC,
            server: DRIVE,
            activity: 7,
            sequence: 0,
            operation,
        }
    }

    fn header(&self) -> Header {
        let activity = Uuid([self.activity; 16]);
        let object = Uuid::object(1, 1, 0x0105);
        Header::request(
            object,
            Uuid::DEVICE_INTERFACE,
            activity,
            self.sequence,
            self.operation,
        )
    }

    fn request(&self, blocks: &[u8]) -> Vec<u8> {
        let length = u32::try_from(blocks.len()).expect("short");
        let ndr = NdrRequest {
            args_maximum: 16_384,
            args_length: length,
        };
        let mut body = Vec::new();
        ndr.encode(&mut body, ByteOrder::Big);
        body.extend(blocks);
        packet(self.client, self.server, &self.header(), &body)
    }

    fn response(&self, status: u32, blocks: &[u8]) -> Vec<u8> {
        let length = u32::try_from(blocks.len()).expect("short");
        let ndr = NdrResponse {
            status: PnioStatus::from_u32(status),
            args_length: length,
            args_maximum: 16_384,
        };
        let mut body = Vec::new();
        ndr.encode(&mut body, ByteOrder::Big);
        body.extend(blocks);
        let header = self.header().reply(PacketType::Response);
        packet(self.server, self.client, &header, &body)
    }
}

fn packet(from: u8, to: u8, header: &Header, body: &[u8]) -> Vec<u8> {
    let mut pdu = Vec::new();
    header.encode(&mut pdu, body.len());
    pdu.extend(body);
    udp::tests::frame_between(from, to, &pdu)
}

/// FrameIDs of the connection below.
const INPUTS: u16 = 0x8000;
const OUTPUTS: u16 = 0x8001;

/// Blocks of a connect with telegram 1 in slot 1, 4 ms, watchdog 12 ms.
pub(super) fn connect_blocks(ar: u8) -> Vec<u8> {
    let mut blocks = Vec::new();
    ArRequest {
        ar_type: ArType::IO_CONTROLLER,
        ar_uuid: Uuid([ar; 16]),
        session_key: 1,
        initiator_mac: mac(PLC),
        initiator_object: Uuid::object(1, 1, 0x0105),
        properties: ArProperties(0x4000_0011),
        activity_timeout_factor: 200,
        udp_rt_port: 0x8892,
        station_name_length: 3,
        station_name: b"plc".to_vec(),
    }
    .encode(&mut blocks);
    for (kind, reference, id) in [(IocrType::INPUT, 1, INPUTS), (IocrType::OUTPUT, 2, 0xFFFF)] {
        IocrRequest {
            iocr_type: kind,
            reference,
            lt: 0x8892,
            properties: 2,
            data_length: 40,
            frame_id: id,
            send_clock_factor: 32,
            reduction_ratio: 4,
            phase: 1,
            sequence: 0,
            frame_send_offset: u32::MAX,
            watchdog_factor: 3,
            data_hold_factor: 3,
            tag_header: 0xC000,
            multicast: MacAddress::default(),
            apis: vec![IocrApi {
                api: 0x3A00,
                data: vec![FrameObject {
                    slot: 1,
                    subslot: 1,
                    offset: 0,
                }],
                status: Vec::new(),
            }],
        }
        .encode(&mut blocks);
    }
    let data = |direction| DataDescription {
        direction,
        length: 4,
        iocs_length: 1,
        iops_length: 1,
    };
    let module = ExpectedModule {
        api: 0x3A00,
        slot: 1,
        ident: 1,
        properties: 0,
        submodules: vec![ExpectedSubmodule {
            subslot: 1,
            ident: 1,
            properties: 3,
            data: vec![data(1), data(2)],
        }],
    };
    ExpectedModule::encode_block(&[module], &mut blocks);
    blocks
}

/// Blocks of the answer to it.
pub(super) fn connected_blocks(ar: u8, diff: Option<profinet::wire::block::ModuleDiff>) -> Vec<u8> {
    let answer = |iocr_type, reference, frame_id| IocrResponse {
        iocr_type,
        reference,
        frame_id,
    };
    let mut blocks = Vec::new();
    ConnectResponse {
        ar: ArResponse {
            ar_type: ArType::IO_CONTROLLER,
            ar_uuid: Uuid([ar; 16]),
            session_key: 1,
            responder_mac: mac(DRIVE),
            udp_rt_port: 0x8892,
        },
        iocrs: vec![
            answer(IocrType::INPUT, 1, INPUTS),
            answer(IocrType::OUTPUT, 2, OUTPUTS),
        ],
        alarm_cr: None,
        diff,
        server: None,
    }
    .encode(&mut blocks);
    blocks
}

/// The connect and its answer.
fn connect(capture: &mut Capture, at: u64) {
    let call = Call::new(operation::CONNECT);
    capture.at(at, &call.request(&connect_blocks(9)));
    capture.at(at + 1, &call.response(0, &connected_blocks(9, None)));
}

/// The octets of each node are within those of its parent.
fn check_tree(node: &Node, end: usize) {
    assert!(node.start <= node.end && node.end <= end, "{node:?}");
    for child in &node.children {
        assert!(
            child.start >= node.start && child.weight <= node.weight,
            "{node:?}"
        );
        check_tree(child, node.end);
    }
}

proptest! {
    #[test]
    fn any_frame_gives_an_answer(bytes in proptest::collection::vec(any::<u8>(), 0..200), ether in 0..4_usize) {
        let mut frame = vec![2, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 2];
        frame.extend([[0x88, 0x92], [0x08, 0x00], [0x81, 0x00], [0x08, 0x06]][ether]);
        frame.extend(&bytes);
        let mut walker = Walker::default();
        for frame in [&frame, &bytes] {
            walker.frame(Duration::ZERO, frame);
            check_tree(&walker.tree(frame), frame.len());
        }
        walker.end();
    }

    #[test]
    fn any_rpc_packet_gives_an_answer(bytes in proptest::collection::vec(any::<u8>(), 0..300), operation in 0..7_u8) {
        let mut walker = Walker::default();
        let frame = udp::tests::rpc_frame(operation, &bytes);
        walker.frame(Duration::ZERO, &frame);
        check_tree(&walker.tree(&frame), frame.len());
        walker.end();
    }

    #[test]
    fn any_record_and_any_alarm_gives_an_answer(bytes in proptest::collection::vec(any::<u8>(), 0..200), index: u16) {
        for index in [index, 0x800C, 0x8001, 0xE002, 0x802A, 0x8080, 0xF841, 0xF821, 0xF830, 0xF840, 0xF820, 0xAFF0, 0xAFF1] {
            let _ = contents::describe(index, profinet::wire::Reader::new(&bytes));
        }
        let mut walker = Walker::default();
        walker.frame(Duration::ZERO, &frame(PLC, mac(DRIVE), FrameId::ALARM_LOW, &bytes));
        walker.end();
    }
}
