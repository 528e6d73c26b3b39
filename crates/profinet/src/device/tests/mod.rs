//! A device fed with whole PDUs by a scripted controller.

mod data;
mod dcp;
mod golden;
mod port;
mod records;
mod refusals;
mod robust;
mod start_up;
mod vlt;

use alloc::vec;
use alloc::vec::Vec;
use core::net::{Ipv4Addr, SocketAddrV4};

use super::*;
use crate::cyclic::{Layout, Provider, ProviderConfig, SubmoduleSize, pack};
use crate::wire::ByteOrder;
use crate::wire::block::{
    AlarmCrRequest, ArProperties, ArRequest, ArType, BlockType, ConnectResponse, ControlBlock,
    ControlCommand, ExpectedModule, ExpectedSubmodule, FrameObject, IocrApi, IocrRequest, IocrType,
    ReadRequest, ReadResponse, WriteRequest,
};
use crate::wire::ethernet::Tag;
use crate::wire::rpc::{Header, NdrResponse, PacketType};
use crate::wire::rt::Iops;

pub(super) const DEVICE: MacAddress = MacAddress([2, 0x50, 0x4E, 0, 0, 1]);
pub(super) const CONTROLLER: MacAddress = MacAddress([2, 0x50, 0x4E, 0, 0, 2]);
pub(super) const HOST: Ipv4Addr = Ipv4Addr::new(192, 168, 77, 11);
pub(super) const STRANGER: Ipv4Addr = Ipv4Addr::new(192, 168, 77, 66);
pub(super) const DRIVE_API: u32 = 0x3A00;
pub(super) const TELEGRAM_1: u32 = 0x101;
pub(super) const TELEGRAM_2: u32 = 0x102;

pub(super) fn identity() -> Identity {
    Identity {
        vendor_id: 0x0105,
        device_id: 1,
        instance: 1,
        station_type: "AKD".into(),
        order_id: "AKD-P00306".into(),
        serial_number: "S-0001".into(),
        hardware_revision: 7,
        software_prefix: 'V',
        software_revision: [1, 11, 2],
        profile_id: 0x3A00,
        profile_specific_type: 0,
    }
}

pub(super) fn config() -> DeviceConfig {
    let submodule = |subslot, ident, api, input_length, output_length| SubmoduleDescription {
        subslot,
        ident,
        api,
        input_length,
        output_length,
    };
    let modules = vec![
        ModuleDescription {
            ident: 1,
            slots: vec![0],
            submodules: vec![
                submodule(1, 1, 0, 0, 0),
                submodule(0x8000, 2, 0, 0, 0),
                submodule(0x8001, 3, 0, 0, 0),
            ],
        },
        ModuleDescription {
            ident: TELEGRAM_1,
            slots: vec![1],
            submodules: vec![submodule(1, 0x11, DRIVE_API, 4, 4)],
        },
        ModuleDescription {
            ident: TELEGRAM_2,
            slots: vec![1],
            submodules: vec![submodule(1, 0x12, DRIVE_API, 8, 8)],
        },
    ];
    let mut config = DeviceConfig::new(DEVICE, identity(), modules);
    // what comes unasked has tests of its own
    config.neighbourhood = false;
    config.reset_modes = vec![ResetMode::Communication, ResetMode::AllStored];
    config
}

/// The blocks of a connect, to be spoiled by a test before they are sent.
#[derive(Clone)]
pub(super) struct Wish {
    pub(super) ar: ArRequest,
    pub(super) iocrs: Vec<IocrRequest>,
    pub(super) alarm_crs: Vec<AlarmCrRequest>,
    pub(super) modules: Vec<ExpectedModule>,
}

fn apis(layout: &Layout) -> Vec<IocrApi> {
    let mut list: Vec<IocrApi> = Vec::new();
    let mut at = |api: u32| match list.iter().position(|a| a.api == api) {
        Some(i) => i,
        None => {
            list.push(IocrApi {
                api,
                data: vec![],
                status: vec![],
            });
            list.len() - 1
        }
    };
    let data: Vec<_> = layout.data_objects().iter().map(|d| (at(d.api), *d)).collect();
    let status: Vec<_> = layout.status_objects().iter().map(|s| (at(s.api), *s)).collect();
    for (i, d) in data {
        list[i].data.push(FrameObject {
            slot: d.slot,
            subslot: d.subslot,
            offset: d.offset,
        });
    }
    for (i, s) in status {
        list[i].status.push(FrameObject {
            slot: s.slot,
            subslot: s.subslot,
            offset: s.offset,
        });
    }
    list
}

impl Wish {
    /// Creates a controller that expects the access point and telegram 1, 16 ms, advanced start-up.
    pub(super) fn controller(uuid: u8) -> Self {
        let submodule = |subslot, ident, length| ExpectedSubmodule::new(subslot, ident, length, length);
        let modules = vec![
            ExpectedModule {
                api: 0,
                slot: 0,
                ident: 1,
                properties: 0,
                submodules: vec![
                    submodule(1, 1, 0),
                    submodule(0x8000, 2, 0),
                    submodule(0x8001, 3, 0),
                ],
            },
            ExpectedModule {
                api: DRIVE_API,
                slot: 1,
                ident: TELEGRAM_1,
                properties: 0,
                submodules: vec![submodule(1, 0x11, 4)],
            },
        ];
        let (input, output) = pack(&sizes(&modules)).unwrap();
        let iocr = |iocr_type, reference, frame_id, layout: &Layout| IocrRequest {
            iocr_type,
            reference,
            lt: 0x8892,
            properties: 2,
            data_length: layout.data_length(),
            frame_id,
            send_clock_factor: 32,
            reduction_ratio: 16,
            phase: 1,
            sequence: 0,
            frame_send_offset: u32::MAX,
            watchdog_factor: 3,
            data_hold_factor: 3,
            tag_header: 0xC000,
            multicast: MacAddress([0; 6]),
            apis: apis(layout),
        };
        Self {
            ar: ArRequest {
                ar_type: ArType::IO_CONTROLLER,
                ar_uuid: Uuid([uuid; 16]),
                session_key: 5,
                initiator_mac: CONTROLLER,
                initiator_object: Uuid::object(1, 2, 3),
                properties: ArProperties(0x4000_0011),
                activity_timeout_factor: 100,
                udp_rt_port: 0x8892,
                station_name_length: 3,
                station_name: b"plc".to_vec(),
            },
            iocrs: vec![
                iocr(IocrType::INPUT, 1, 0x8010, &input),
                iocr(IocrType::OUTPUT, 2, 0xFFFF, &output),
            ],
            alarm_crs: vec![AlarmCrRequest {
                alarm_cr_type: 1,
                lt: 0x8892,
                properties: 0,
                rta_timeout_factor: 1,
                rta_retries: 3,
                local_alarm_reference: 9,
                max_alarm_data_length: 200,
                tag_high: 0xC000,
                tag_low: 0xA000,
            }],
            modules,
        }
    }

    /// Creates a tool.
    pub(super) fn tool(uuid: u8) -> Self {
        let mut wish = Self::controller(uuid);
        wish.ar.ar_type = ArType::SUPERVISOR;
        wish.ar.properties = ArProperties(0x111);
        wish.ar.initiator_object = Uuid::object(9, 9, 9);
        wish.iocrs.clear();
        wish.alarm_crs.clear();
        wish.modules.clear();
        wish
    }

    /// Returns the same with legacy start-up and class 1.
    pub(super) fn legacy(mut self) -> Self {
        self.ar.properties = ArProperties(0x11);
        self.iocrs[0].frame_id = 0xC010;
        for iocr in &mut self.iocrs {
            iocr.properties = 1;
        }
        self
    }

    pub(super) fn blocks(&self) -> Vec<u8> {
        let mut out = Vec::new();
        self.ar.encode(&mut out);
        for iocr in &self.iocrs {
            iocr.encode(&mut out);
        }
        for alarm_cr in &self.alarm_crs {
            alarm_cr.encode(&mut out);
        }
        for module in &self.modules {
            ExpectedModule::encode_block(core::slice::from_ref(module), &mut out);
        }
        out
    }
}

pub(super) fn sizes(modules: &[ExpectedModule]) -> Vec<SubmoduleSize> {
    let of = |module: &ExpectedModule| {
        let (api, slot) = (module.api, module.slot);
        let size = move |s: &ExpectedSubmodule| {
            SubmoduleSize::new(api, slot, s.subslot, s.input_length(), s.output_length())
        };
        module.submodules.iter().map(size).collect::<Vec<_>>()
    };
    modules.iter().flat_map(of).collect()
}

/// What the device sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Sent {
    Frame(Vec<u8>),
    Datagram(SocketAddrV4, u16, Vec<u8>),
}

/// A device and the clock.
pub(super) struct Rig {
    pub(super) device: Device,
    pub(super) now: Instant,
    pub(super) order: ByteOrder,
    pub(super) from: SocketAddrV4,
    calls: u32,
}

impl Rig {
    pub(super) fn new(config: DeviceConfig) -> Self {
        let ip = IpSuite {
            address: Ipv4Addr::new(192, 168, 77, 50),
            mask: Ipv4Addr::new(255, 255, 255, 0),
            gateway: Ipv4Addr::UNSPECIFIED,
        };
        let stored = Stored {
            name: "drive-1".into(),
            ip,
            ..Stored::default()
        };
        Self {
            device: Device::new(config, stored),
            now: Instant::ZERO,
            order: ByteOrder::Big,
            from: SocketAddrV4::new(HOST, 50_000),
            calls: 0,
        }
    }

    pub(super) fn drain(&mut self) -> Vec<Sent> {
        let mut buffer = [0; crate::MAX_FRAME];
        let mut all = Vec::new();
        while let Some(transmit) = self.device.poll_transmit(self.now, &mut buffer) {
            all.push(match transmit {
                Transmit::Frame { length } => Sent::Frame(buffer[..length].to_vec()),
                Transmit::Datagram {
                    destination,
                    source_port,
                    length,
                } => Sent::Datagram(destination, source_port, buffer[..length].to_vec()),
            });
            assert!(all.len() < 1000);
        }
        all
    }

    pub(super) fn events(&mut self) -> Vec<Event> {
        core::iter::from_fn(|| self.device.poll_event()).collect()
    }

    /// Lets time pass deadline by deadline; gives everything sent.
    pub(super) fn pass(&mut self, millis: u64) -> Vec<Sent> {
        let end = self.now + core::time::Duration::from_millis(millis);
        let mut sent = self.drain();
        for _ in 0..100_000 {
            match self.device.poll_timeout().filter(|at| *at <= end) {
                Some(at) => self.now = self.now.max(at),
                None => {
                    self.now = end;
                    return sent;
                }
            }
            self.device.handle_timeout(self.now);
            sent.extend(self.drain());
        }
        panic!("deadlines without end");
    }

    /// Returns a request PDU of a new call in an activity of its own.
    pub(super) fn request(&mut self, operation: u16, blocks: &[u8]) -> Vec<u8> {
        self.calls += 1;
        let mut activity = [7; 16];
        activity[..4].copy_from_slice(&self.calls.to_be_bytes());
        let mut header = Header::request(
            Uuid::object(1, 1, 0x105),
            Uuid::DEVICE_INTERFACE,
            Uuid(activity),
            0,
            operation,
        );
        header.order = self.order;
        let mut pdu = Vec::new();
        header.encode(&mut pdu, 20 + blocks.len());
        let args_length = blocks.len() as u32;
        NdrRequest {
            args_maximum: 32_832,
            args_length,
        }
        .encode(&mut pdu, self.order);
        pdu.extend_from_slice(blocks);
        pdu
    }

    pub(super) fn send(&mut self, pdu: &[u8]) {
        self.device.handle_datagram(self.now, self.from, RPC_PORT, pdu);
    }

    /// Makes a call that is answered at once in one PDU.
    pub(super) fn call(&mut self, operation: u16, blocks: &[u8]) -> (PnioStatus, Vec<u8>) {
        let pdu = self.request(operation, blocks);
        self.send(&pdu);
        self.response()
    }

    /// Returns the answer among what the device sends now.
    pub(super) fn response(&mut self) -> (PnioStatus, Vec<u8>) {
        for sent in self.drain() {
            if let Sent::Datagram(to, port, pdu) = sent {
                let (header, body) = Header::decode(&pdu).unwrap();
                if header.packet_type == PacketType::Response {
                    assert_eq!((to, port, header.order), (self.from, RPC_PORT, self.order));
                    let mut reader = Reader::new(body);
                    let ndr = NdrResponse::decode(&mut reader, header.order).unwrap();
                    return (ndr.status, reader.rest("blocks").to_vec());
                }
            }
        }
        panic!("no answer");
    }

    pub(super) fn connect(&mut self, wish: &Wish) -> Result<ConnectResponse, PnioStatus> {
        let (status, blocks) = self.call(operation::CONNECT, &wish.blocks());
        if status.is_ok() {
            Ok(ConnectResponse::decode(Reader::new(&blocks)).unwrap())
        } else {
            Err(status)
        }
    }

    pub(super) fn control(
        &mut self,
        operation: u16,
        block_type: BlockType,
        wish: &Wish,
        command: ControlCommand,
    ) -> PnioStatus {
        let control = ControlBlock::new(block_type, wish.ar.ar_uuid, wish.ar.session_key, command);
        let mut blocks = Vec::new();
        control.encode(&mut blocks);
        let (status, answer) = self.call(operation, &blocks);
        if status.is_ok() {
            let mut done = Vec::new();
            control.done().encode(&mut done);
            assert_eq!(answer, done);
        }
        status
    }

    pub(super) fn prm_end(&mut self, wish: &Wish) -> PnioStatus {
        self.control(
            operation::CONTROL,
            BlockType::PRM_END,
            wish,
            ControlCommand::PRM_END,
        )
    }

    pub(super) fn release(&mut self, wish: &Wish) -> PnioStatus {
        self.control(
            operation::RELEASE,
            BlockType::RELEASE,
            wish,
            ControlCommand::RELEASE,
        )
    }

    pub(super) fn read(
        &mut self,
        ar: Uuid,
        api: u32,
        slot: u16,
        subslot: u16,
        index: u16,
    ) -> Result<Vec<u8>, PnioStatus> {
        let request = ReadRequest {
            sequence: 1,
            ar_uuid: ar,
            api,
            slot,
            subslot,
            index,
            length: 4096,
            target_ar_uuid: Uuid::NIL,
        };
        let mut blocks = Vec::new();
        request.encode(&mut blocks);
        let operation = if ar.is_nil() {
            operation::READ_IMPLICIT
        } else {
            operation::READ
        };
        let pdu = self.request(operation, &blocks);
        self.send(&pdu);
        self.read_response(&request)
    }

    pub(super) fn read_response(&mut self, request: &ReadRequest) -> Result<Vec<u8>, PnioStatus> {
        let (status, blocks) = self.response();
        let (header, data) = ReadResponse::decode(&mut Reader::new(&blocks)).unwrap();
        assert_eq!(header, request.response(data.len() as u32));
        assert!(status.is_ok() || data.is_empty());
        if status.is_ok() {
            Ok(data.to_vec())
        } else {
            Err(status)
        }
    }

    pub(super) fn write_pdu(&mut self, ar: Uuid, api: u32, place: (u16, u16, u16), data: &[u8]) -> Vec<u8> {
        let mut blocks = Vec::new();
        write_request(ar, api, place, data).encode(&mut blocks);
        blocks.extend_from_slice(data);
        self.request(operation::WRITE, &blocks)
    }

    pub(super) fn write(&mut self, ar: Uuid, api: u32, place: (u16, u16, u16), data: &[u8]) -> PnioStatus {
        let pdu = self.write_pdu(ar, api, place, data);
        self.send(&pdu);
        let (status, blocks) = self.response();
        let response = crate::wire::block::WriteResponse::decode(&mut Reader::new(&blocks)).unwrap();
        assert_eq!(response.status, status);
        status
    }

    /// Answers the ApplicationReady request found in `sent` positively.
    pub(super) fn confirm(&mut self, wish: &Wish, sent: &[Sent]) {
        let (header, body) = ready_request(sent).expect("an ApplicationReady request");
        let mut reader = Reader::new(&body);
        let _ = NdrRequest::decode(&mut reader, header.order).unwrap();
        let mut answer = Vec::new();
        header.reply(PacketType::Response).encode(&mut answer, 20 + 32);
        let status = PnioStatus::OK;
        NdrResponse {
            status,
            args_length: 32,
            args_maximum: 1024,
        }
        .encode(&mut answer, header.order);
        ControlBlock::new(
            BlockType::APPLICATION_READY,
            wish.ar.ar_uuid,
            wish.ar.session_key,
            ControlCommand::APPLICATION_READY,
        )
        .done()
        .encode(&mut answer);
        self.device
            .handle_datagram(self.now, SocketAddrV4::new(HOST, RPC_PORT), CLIENT_PORT, &answer);
    }

    /// Runs the whole start-up; gives the controller's provider of outputs.
    pub(super) fn exchange(&mut self, wish: &Wish) -> Provider {
        let response = self.connect(wish).unwrap();
        let mut provider = outputs(wish, &response, self.now);
        assert_eq!(self.prm_end(wish), PnioStatus::OK);
        let ar = self.device.controller().unwrap();
        assert!(self.device.application_ready(self.now, ar));
        let sent = self.drain();
        self.confirm(wish, &sent);
        self.output(&mut provider);
        assert!(self.device.is_exchanging());
        self.events();
        provider
    }

    /// Sends the controller's next output frame.
    pub(super) fn output(&mut self, provider: &mut Provider) {
        self.now = self.now.max(provider.next_send());
        let mut frame = [0; crate::MAX_FRAME];
        let length = provider.emit(self.now, &mut frame).unwrap();
        self.device.handle_frame(self.now, &frame[..length]);
    }
}

pub(super) fn write_request(ar: Uuid, api: u32, place: (u16, u16, u16), data: &[u8]) -> WriteRequest {
    let (slot, subslot, index) = place;
    WriteRequest {
        sequence: 2,
        ar_uuid: ar,
        api,
        slot,
        subslot,
        index,
        length: data.len() as u32,
    }
}

pub(super) fn ready_request(sent: &[Sent]) -> Option<(Header, Vec<u8>)> {
    sent.iter().find_map(|sent| match sent {
        Sent::Datagram(to, CLIENT_PORT, pdu) if *to == SocketAddrV4::new(HOST, RPC_PORT) => {
            let (header, body) = Header::decode(pdu).unwrap();
            Some((header, body.to_vec()))
        }
        _ => None,
    })
}

/// Returns the controller's side of the output connection.
pub(super) fn outputs(wish: &Wish, response: &ConnectResponse, now: Instant) -> Provider {
    let (_, layout) = pack(&sizes(&wish.modules)).unwrap();
    let frame_id = response
        .iocrs
        .iter()
        .find(|iocr| iocr.iocr_type == IocrType::OUTPUT)
        .unwrap()
        .frame_id;
    let config = ProviderConfig {
        destination: DEVICE,
        source: wish.ar.initiator_mac,
        tag: Some(Tag::PRIORITY_6),
        frame_id: FrameId(frame_id),
        timing: Timing {
            send_clock_factor: 32,
            reduction_ratio: 16,
            phase: 1,
        },
        origin: now,
    };
    let mut provider = Provider::new(config, layout, now);
    provider.set_all_iops(Iops::GOOD);
    provider.set_all_iocs(Iops::GOOD);
    provider
}

/// Status of an ERR-RTA frame among what was sent.
pub(super) fn last_word(sent: &[Sent]) -> Option<PnioStatus> {
    sent.iter().find_map(|sent| match sent {
        Sent::Frame(bytes) => {
            let frame = Frame::parse(bytes)?;
            let pdu = crate::wire::alarm::RtaPdu::parse(frame.payload).ok()?;
            (frame.frame_id == FrameId::ALARM_LOW && frame.destination == CONTROLLER).then_some(())?;
            pdu.error().ok()
        }
        Sent::Datagram(..) => None,
    })
}

pub(super) fn disconnected(events: &[Event]) -> Option<PnioStatus> {
    events.iter().find_map(|event| match event {
        Event::Disconnected { cause, .. } => Some(*cause),
        _ => None,
    })
}
