//! A device scripted by a test, also with protocol errors.

use alloc::collections::VecDeque;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::net::{Ipv4Addr, SocketAddrV4};
use core::time::Duration;

use crate::alarm::{AlarmConfig, AlarmEvent, Alarms};
use crate::cyclic::{
    Consumer, Direction, Layout, ObjectPlace, Provider, ProviderConfig, SubmoduleSize, Timing,
};
use crate::rpc::{Call, Client, ClientConfig, Interface, Server, ServerLimits};
use crate::wire::block::{
    AlarmCrRequest, AlarmCrResponse, ArRequest, ArResponse, ArType, Block, BlockType, Blocks,
    ConnectResponse, ControlBlock, ControlCommand, ExpectedModule, IocrRequest, IocrResponse, IocrType,
    ModuleDiff, ReadRequest, WriteItems, WriteRequest,
};
use crate::wire::dcp::{BlockError, BlockInfo, DcpOption, Pdu, PduWriter, ServiceId, ServiceType, Value};
use crate::wire::ethernet::{self, Frame, FrameId, FrameKind, Tag};
use crate::wire::rpc::{Header, NdrRequest, NdrResponse, operation};
use crate::wire::rt::{DataStatus, Iops};
use crate::wire::{ByteOrder, PnioStatus, Reader, SliceWriter, Uuid, UuidSource, Writer};
use crate::{Endpoint, Instant, IpSuite, MacAddress, RPC_PORT, Transmit};

/// What the device does wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Fault {
    /// Refuses the connect.
    pub connect: Option<PnioStatus>,
    /// Changes this octet of the blocks of every answer.
    pub octet: Option<usize>,
    /// Cuts the blocks of every answer to this length.
    pub cut: Option<usize>,
    /// Answers nothing by RPC.
    pub mute: bool,
    /// Never becomes ready.
    pub never_ready: bool,
    /// Becomes ready in front of the answer to PrmEnd.
    pub early_ready: bool,
    /// Sends no cyclic frames.
    pub no_frames: bool,
    /// Rejects every record request as of an unknown connection.
    pub forgot: bool,
    /// Refuses record writes.
    pub write: Option<PnioStatus>,
    /// Answers a DCP Set with this error.
    pub set: Option<BlockError>,
}

pub(super) struct Fake {
    pub mac: MacAddress,
    pub ip: IpSuite,
    pub name: String,
    pub device: (u16, u16),
    pub fault: Fault,
    /// Reads of 0xB02E that answer "not ready" first.
    pub not_ready: u32,
    pub writes: Vec<(u16, Vec<u8>)>,
    pub reads: Vec<u16>,
    pub provider: Option<Provider>,
    pub consumer: Option<Consumer>,
    pub alarms: Option<Alarms>,
    pub aborted: Option<PnioStatus>,
    pub released: bool,
    pub last_output: Vec<(DataStatus, Iops, Vec<u8>)>,
    pub diff: Option<ModuleDiff>,
    answer: Option<Vec<u8>>,
    polls: u32,
    pub ar: Option<ArRequest>,
    pub iocrs: Vec<IocrRequest>,
    server: Server,
    client: Client,
    controller: Ipv4Addr,
    frames: VecDeque<Vec<u8>>,
    uuids: UuidSource,
}

impl Fake {
    pub(super) fn new(mac: MacAddress, ip: IpSuite, name: &str) -> Self {
        let interface = Interface {
            uuid: Uuid::DEVICE_INTERFACE,
            operations: 6,
        };
        Self {
            mac,
            ip,
            name: name.into(),
            device: (0x0105, 1),
            fault: Fault::default(),
            not_ready: 0,
            writes: vec![],
            reads: vec![],
            provider: None,
            consumer: None,
            alarms: None,
            aborted: None,
            released: false,
            last_output: vec![],
            diff: None,
            answer: None,
            polls: 0,
            ar: None,
            iocrs: vec![],
            server: Server::new(vec![interface], ServerLimits::default()),
            client: Client::new(ClientConfig::default()),
            controller: Ipv4Addr::UNSPECIFIED,
            frames: VecDeque::new(),
            uuids: UuidSource::new(99),
        }
    }

    fn identified(&mut self, source: MacAddress, pdu: &Pdu<'_>) {
        let asked = pdu.blocks().next().unwrap().unwrap().filter().unwrap();
        if asked != Value::ALL && asked != Value::Name(self.name.as_bytes()) {
            return;
        }
        let (vendor, device) = self.device;
        let info = if self.ip.is_set() {
            BlockInfo::IP_SET
        } else {
            BlockInfo::NONE
        };
        let name = self.name.clone();
        let values = [
            Value::Ip(self.ip),
            Value::StationType(b"fake"),
            Value::Name(name.as_bytes()),
            Value::DeviceId { vendor, device },
            Value::Role(1),
            Value::Instance(1),
        ];
        self.dcp(source, FrameId::DCP_IDENTIFY_RESPONSE, pdu, |out| {
            for value in &values {
                let info = if matches!(value, Value::Ip(_)) {
                    info
                } else {
                    BlockInfo::NONE
                };
                out.info(info, value);
            }
        });
    }

    fn dcp(
        &mut self,
        to: MacAddress,
        id: FrameId,
        request: &Pdu<'_>,
        fill: impl FnOnce(&mut PduWriter<'_, SliceWriter<'_>>),
    ) {
        let mut buffer = [0; 1518];
        let header = ethernet::emit_header(&mut buffer, to, self.mac, None, id).unwrap();
        let mut out = SliceWriter::new(&mut buffer[header..]);
        let mut pdu = PduWriter::new(&mut out, request.service, ServiceType::Success, request.xid, 0);
        fill(&mut pdu);
        pdu.finish();
        let length = header + out.finish().unwrap();
        let length = ethernet::pad(&mut buffer, length);
        self.frames.push_back(buffer[..length].to_vec());
    }

    fn set(&mut self, source: MacAddress, pdu: &Pdu<'_>) {
        let (_, value) = pdu.blocks().next().unwrap().unwrap().set().unwrap();
        let error = self.fault.set.unwrap_or(BlockError::Ok);
        if error == BlockError::Ok {
            match value {
                Value::Ip(suite) => self.ip = suite,
                Value::Name(name) => self.name = String::from_utf8(name.to_vec()).unwrap(),
                _ => {}
            }
        }
        self.dcp(source, FrameId::DCP_GET_SET, pdu, |out| {
            out.result(value.option(), error)
        });
    }

    fn serve(&mut self, now: Instant, call: &Call) {
        let mut reader = Reader::new(&call.stub);
        let ndr = NdrRequest::decode(&mut reader, call.order).unwrap();
        self.controller = *call.source.ip();
        let (status, mut blocks) = match call.operation {
            operation::CONNECT => self.connect(now, reader),
            operation::CONTROL | operation::RELEASE => self.control(now, reader),
            operation::READ | operation::READ_IMPLICIT => self.read(reader),
            _ => self.write(reader),
        };
        if self.fault.mute {
            return;
        }
        if let Some(octet) = self.fault.octet.and_then(|at| blocks.get_mut(at)) {
            *octet ^= 0xFF;
        }
        if let Some(cut) = self.fault.cut {
            blocks.truncate(cut);
        }
        let mut stub = vec![];
        let args_length = u32::try_from(blocks.len()).unwrap();
        NdrResponse {
            status,
            args_length,
            args_maximum: ndr.args_maximum,
        }
        .encode(&mut stub, ByteOrder::Big);
        stub.bytes(&blocks);
        let stub = if call.order == ByteOrder::Big {
            stub
        } else {
            panic!("the controller sends big-endian")
        };
        self.server.respond(now, call.key, stub);
    }

    fn connect(&mut self, now: Instant, reader: Reader<'_>) -> (PnioStatus, Vec<u8>) {
        if let Some(status) = self.fault.connect {
            return (status, vec![]);
        }
        let (mut iocrs, mut modules, mut alarm) = (vec![], vec![], None);
        let mut ar = None;
        for block in Blocks::new(reader) {
            let block = block.unwrap();
            match block.block_type {
                BlockType::AR_REQUEST => ar = Some(ArRequest::decode(block.body).unwrap()),
                BlockType::IOCR_REQUEST => iocrs.push(IocrRequest::decode(block.body).unwrap()),
                BlockType::EXPECTED_SUBMODULE => {
                    modules.extend(ExpectedModule::decode_block(block.body).unwrap());
                }
                BlockType::ALARM_CR_REQUEST => alarm = Some(AlarmCrRequest::decode(block.body).unwrap()),
                other => panic!("{other}"),
            }
        }
        let ar = ar.unwrap();
        let mut response = ConnectResponse {
            ar: ArResponse {
                ar_type: ar.ar_type,
                ar_uuid: ar.ar_uuid,
                session_key: ar.session_key,
                responder_mac: self.mac,
                udp_rt_port: 0x8892,
            },
            iocrs: vec![],
            alarm_cr: None,
            diff: self.diff.clone(),
            server: None,
        };
        if ar.ar_type == ArType::IO_CONTROLLER {
            self.open(now, &ar, &iocrs, &modules, alarm.unwrap());
            for iocr in &iocrs {
                let input = iocr.iocr_type == IocrType::INPUT;
                let frame_id = if input { iocr.frame_id } else { 0x8123 };
                response.iocrs.push(IocrResponse {
                    iocr_type: iocr.iocr_type,
                    reference: iocr.reference,
                    frame_id,
                });
            }
            response.alarm_cr = Some(AlarmCrResponse {
                alarm_cr_type: 1,
                local_alarm_reference: 77,
                max_alarm_data_length: 200,
            });
        }
        self.ar = Some(ar);
        self.iocrs = iocrs;
        let mut out = vec![];
        response.encode(&mut out);
        (PnioStatus::OK, out)
    }

    fn open(
        &mut self,
        now: Instant,
        ar: &ArRequest,
        iocrs: &[IocrRequest],
        modules: &[ExpectedModule],
        alarm: AlarmCrRequest,
    ) {
        let mut sizes = vec![];
        for module in modules {
            for s in &module.submodules {
                sizes.push(SubmoduleSize::new(
                    module.api,
                    module.slot,
                    s.subslot,
                    s.input_length(),
                    s.output_length(),
                ));
            }
        }
        let layout = |iocr: &IocrRequest, direction| {
            let (mut data, mut status) = (vec![], vec![]);
            for api in &iocr.apis {
                let place = |o: &crate::wire::block::FrameObject| ObjectPlace {
                    api: api.api,
                    slot: o.slot,
                    subslot: o.subslot,
                    offset: o.offset,
                };
                data.extend(api.data.iter().map(place));
                status.extend(api.status.iter().map(place));
            }
            Layout::new(direction, iocr.data_length, &data, &status, &sizes).unwrap()
        };
        let timing = |iocr: &IocrRequest| Timing {
            send_clock_factor: iocr.send_clock_factor,
            reduction_ratio: iocr.reduction_ratio,
            phase: iocr.phase,
        };
        for iocr in iocrs {
            timing(iocr)
                .check(iocr.watchdog_factor, iocr.data_hold_factor, 0)
                .unwrap();
            if iocr.iocr_type == IocrType::INPUT {
                let config = ProviderConfig {
                    destination: ar.initiator_mac,
                    source: self.mac,
                    tag: Some(Tag::PRIORITY_6),
                    frame_id: FrameId(iocr.frame_id),
                    timing: timing(iocr),
                    origin: now,
                };
                let mut provider = Provider::new(config, layout(iocr, Direction::Input), now);
                provider.set_all_iops(Iops::GOOD);
                provider.set_all_iocs(Iops::GOOD);
                self.provider = Some(provider);
            } else {
                let layout = layout(iocr, Direction::Output);
                self.consumer = Some(Consumer::new(
                    ar.initiator_mac,
                    FrameId(0x8123),
                    timing(iocr),
                    iocr.data_hold_factor,
                    layout,
                ));
            }
        }
        self.alarms = Some(Alarms::new(AlarmConfig {
            local: self.mac,
            peer: ar.initiator_mac,
            local_reference: 77,
            peer_reference: alarm.local_alarm_reference,
            timeout: Duration::from_millis(100) * u32::from(alarm.rta_timeout_factor),
            retries: alarm.rta_retries,
            tag_high: Tag(alarm.tag_high),
            tag_low: Tag(alarm.tag_low),
            max_length: 200,
            low_only: false,
        }));
    }

    fn control(&mut self, now: Instant, mut reader: Reader<'_>) -> (PnioStatus, Vec<u8>) {
        let block = Block::decode(&mut reader).unwrap();
        let block = ControlBlock::decode(block.block_type, block.body).unwrap();
        let mut out = vec![];
        block.done().encode(&mut out);
        match block.command {
            ControlCommand::RELEASE => {
                self.released = true;
                self.provider = None;
                self.consumer = None;
            }
            ControlCommand::PRM_END if !self.fault.never_ready => self.ready(now, &block),
            _ => {}
        }
        (PnioStatus::OK, out)
    }

    fn ready(&mut self, now: Instant, prm_end: &ControlBlock) {
        let block_type = if prm_end.block_type == BlockType::PRM_END {
            BlockType::APPLICATION_READY
        } else {
            BlockType::APPLICATION_READY_PLUG
        };
        let block = ControlBlock {
            block_type,
            command: ControlCommand::APPLICATION_READY,
            ..*prm_end
        };
        let mut blocks = vec![];
        block.encode(&mut blocks);
        if let Some(diff) = &self.diff {
            diff.encode(&mut blocks);
        }
        let mut stub = vec![];
        let args_length = u32::try_from(blocks.len()).unwrap();
        NdrRequest {
            args_maximum: 4096,
            args_length,
        }
        .encode(&mut stub, ByteOrder::Big);
        stub.bytes(&blocks);
        let object = self.ar.as_ref().unwrap().initiator_object;
        let header = Header::request(
            object,
            Uuid::CONTROLLER_INTERFACE,
            self.uuids.uuid(),
            0,
            operation::CONTROL,
        );
        self.client
            .call(now, SocketAddrV4::new(self.controller, RPC_PORT), header, stub);
    }

    fn read(&mut self, mut reader: Reader<'_>) -> (PnioStatus, Vec<u8>) {
        let request = ReadRequest::decode(&mut reader).unwrap();
        self.reads.push(request.index);
        if self.fault.forgot {
            return (PnioStatus::new(0xDE, 0x81, 0x40, 5), vec![]);
        }
        let data = match request.index {
            0xAFF0 => vec![0x20; 60],
            0x1000 => vec![0x5A; 20_000],
            0xFBFF => vec![],
            0xB02E => match self.answer.take() {
                Some(answer) if self.polls >= self.not_ready => answer,
                answer => {
                    self.answer = answer;
                    self.polls += 1;
                    return (PnioStatus::read(0xB5), vec![]);
                }
            },
            _ => return (PnioStatus::read(0xB0), vec![]),
        };
        let mut out = vec![];
        request
            .response(u32::try_from(data.len()).unwrap())
            .encode(&mut out);
        out.bytes(&data);
        (PnioStatus::OK, out)
    }

    fn write(&mut self, mut reader: Reader<'_>) -> (PnioStatus, Vec<u8>) {
        let (request, data) = WriteRequest::decode(&mut reader).unwrap();
        let status = self.fault.write.unwrap_or(PnioStatus::OK);
        let mut out = vec![];
        request.response(status).encode(&mut out);
        if request.index == 0xE040 {
            for item in WriteItems::new(Reader::new(data)) {
                let (inner, data) = item.unwrap();
                self.writes.push((inner.index, data.to_vec()));
                let status = if inner.index == 9 {
                    PnioStatus::write(0xB0)
                } else {
                    PnioStatus::OK
                };
                inner.response(status).encode(&mut out);
            }
        } else {
            self.writes.push((request.index, data.to_vec()));
            if request.index == 0xB02E {
                self.answer = Some([data, b"!"].concat());
                self.polls = 0;
            }
        }
        (status, out)
    }
}

impl Endpoint for Fake {
    fn mac(&self) -> MacAddress {
        self.mac
    }

    fn ip(&self) -> IpSuite {
        self.ip
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        let frame = Frame::parse(frame).unwrap();
        match frame.frame_id.kind() {
            FrameKind::DcpIdentifyRequest => {
                let pdu = Pdu::parse(frame.payload).unwrap();
                self.identified(frame.source, &pdu);
            }
            FrameKind::DcpGetSet => {
                let pdu = Pdu::parse(frame.payload).unwrap();
                match pdu.service {
                    ServiceId::Set => self.set(frame.source, &pdu),
                    _ => {
                        let name = self.name.clone();
                        self.dcp(frame.source, FrameId::DCP_GET_SET, &pdu, |out| {
                            for option in pdu.requested() {
                                match option.unwrap() {
                                    DcpOption::NAME => {
                                        out.info(BlockInfo::NONE, &Value::Name(name.as_bytes()))
                                    }
                                    other => out.result(other, BlockError::SuboptionUnsupported),
                                }
                            }
                        });
                    }
                }
            }
            FrameKind::AlarmHigh | FrameKind::AlarmLow => {
                let event = self.alarms.as_mut().and_then(|a| a.handle_frame(now, &frame));
                if let Some(AlarmEvent::AbortedByPeer(status)) = event {
                    self.aborted = Some(status);
                    self.provider = None;
                    self.consumer = None;
                }
            }
            _ => {
                if let Some(consumer) = &mut self.consumer
                    && consumer.handle(now, &frame).is_ok()
                    && let Some((data, iops)) = consumer.data(1, 1)
                {
                    self.last_output.push((consumer.status(), iops, data.to_vec()));
                }
            }
        }
    }

    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, port: u16, payload: &[u8]) {
        if port == RPC_PORT {
            if let Some(call) = self.server.handle(now, source, payload) {
                self.serve(now, &call);
            }
        } else {
            self.client.handle(now, source, payload);
        }
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.server.handle_timeout(now);
        self.client.handle_timeout(now);
        if let Some(alarms) = &mut self.alarms {
            let _ = alarms.handle_timeout(now);
        }
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        if let Some(frame) = self.frames.pop_front() {
            buffer[..frame.len()].copy_from_slice(&frame);
            return Some(Transmit::Frame { length: frame.len() });
        }
        if let Some(length) = self.alarms.as_mut().and_then(|a| a.poll_transmit(now, buffer)) {
            return Some(Transmit::Frame { length });
        }
        if let Some(length) = self.provider.as_mut().and_then(|p| p.emit(now, buffer))
            && !self.fault.no_frames
        {
            return Some(Transmit::Frame { length });
        }
        let first = if self.fault.early_ready {
            self.client
                .poll_transmit(now, buffer)
                .map(|datagram| (49152, datagram))
        } else {
            None
        };
        let (source_port, (destination, length)) = match first {
            Some(first) => first,
            None => match self.server.poll_transmit(now, buffer) {
                Some(datagram) => (RPC_PORT, datagram),
                None => (49152, self.client.poll_transmit(now, buffer)?),
            },
        };
        Some(Transmit::Datagram {
            destination,
            source_port,
            length,
        })
    }

    fn poll_timeout(&self) -> Option<Instant> {
        [
            self.server.poll_timeout(),
            self.client.poll_timeout(),
            self.alarms.as_ref().and_then(Alarms::poll_timeout),
            self.provider.as_ref().map(Provider::next_send),
        ]
        .into_iter()
        .flatten()
        .min()
    }
}
