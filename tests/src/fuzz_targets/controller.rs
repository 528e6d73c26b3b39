//! A controller that connects to a device which answers anything.

use std::net::SocketAddrV4;
use std::time::Duration;

use profile::catalogue::AKD;
use profinet::controller::{
    ConnectConfig, Controller, ControllerConfig, Event, ModuleConfig, Resolve, SubmoduleConfig, Target,
};
use profinet::cyclic::Timing;
use profinet::wire::Uuid;
use profinet::wire::rpc::{Header, PacketType, operation};
use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, RPC_PORT, Transmit};

use super::steps::{Step, Steps};

const DEVICE: MacAddress = MacAddress([2, 0x50, 0x4E, 0, 0, 1]);
const OWN: MacAddress = MacAddress([2, 0x50, 0x4E, 0, 0, 2]);
/// Where the ARUUID stands in every body, behind NDR header, block header and two more octets; in all but records the
/// session key follows.
const AR_UUID: usize = 28;

fn ip(last: u8) -> IpSuite {
    IpSuite {
        address: [192, 168, 77, last].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0; 4].into(),
    }
}

fn config(resolve: Resolve) -> ConnectConfig {
    let device = &AKD.device;
    let telegram = device.telegram(1).unwrap();
    let module = |api, slot, ident, submodules: &[(u16, u32, u16)]| ModuleConfig {
        api,
        slot,
        ident,
        submodules: submodules
            .iter()
            .map(|&(subslot, ident, length)| SubmoduleConfig {
                subslot,
                ident,
                input_length: length,
                output_length: length,
            })
            .collect(),
    };
    let access_point = [
        (1, device.access_point_submodule, 0),
        (0x8000, device.interface_submodule, 0),
        (0x8001, device.port_submodule, 0),
    ];
    let modules = vec![
        module(0, 0, device.access_point_module, &access_point),
        module(
            device.api.into(),
            1,
            telegram.module,
            &[(1, telegram.submodule, 4)],
        ),
    ];
    let mut config = ConnectConfig::new(modules, Timing::for_interval(Duration::from_millis(16)).unwrap());
    config.resolve = resolve;
    config
}

/// State of the device at the other end.
#[derive(Default)]
struct Peer {
    /// Header of the latest request.
    asked: Option<Header>,
    /// ARUUID and session key.
    ar: Option<[u8; 18]>,
}

impl Peer {
    fn hears(&mut self, datagram: &[u8]) {
        let Ok((header, body)) = Header::decode(datagram) else {
            return;
        };
        if header.packet_type == PacketType::Request {
            if header.operation == operation::CONNECT {
                let ar = body.get(AR_UUID..).and_then(|ar| ar.first_chunk());
                self.ar = ar.copied().or(self.ar);
            }
            self.asked = Some(header);
        }
    }

    /// Returns a datagram that fits the present call, as far as the fuzzed octets select it: the first one selects the
    /// kind.
    fn says(&self, mode: u8, content: &[u8]) -> Vec<u8> {
        let header = match (mode % 4, &self.asked) {
            (1, Some(asked)) => asked.reply(PacketType::Response),
            (2, Some(asked)) => asked.reply(PacketType::from_code(mode >> 4)),
            (3, _) => Header::request(
                Uuid::object(1, AKD.device.device_id, AKD.device.vendor_id),
                Uuid::CONTROLLER_INTERFACE,
                Uuid([9; 16]),
                u32::from(mode >> 4),
                operation::CONTROL,
            ),
            _ => return content.to_vec(),
        };
        let mut body = content.to_vec();
        let record = matches!(header.operation, operation::READ | operation::WRITE);
        let known = if record { 16 } else { 18 };
        if let (Some(place), Some(ar)) = (body.get_mut(AR_UUID..AR_UUID + known), self.ar) {
            place.copy_from_slice(&ar[..known]);
        }
        let mut datagram = Vec::new();
        header.encode(&mut datagram, body.len());
        datagram.extend_from_slice(&body);
        datagram
    }
}

/// The first octet says whether the name is looked up before; the rest are steps. The first octet of a datagram says what
/// it is: 0 modulo 4 as it stands, 1 the answer to the latest call, 2 another PDU to it, 3 a control call of the device.
pub fn controller(data: &[u8]) {
    let Some((mode, steps)) = data.split_first() else {
        return;
    };
    let settings = ControllerConfig::new(OWN, ip(11), "plc", 7);
    let client_port = settings.client_port;
    let mut controller = Controller::new(settings);
    let resolve = match mode % 3 {
        0 => Resolve::Trust,
        1 => Resolve::Check,
        _ => Resolve::SetIp,
    };
    let target = Target {
        name: "akd-1".into(),
        mac: Some(DEVICE),
        ip: ip(50),
        vendor_id: AKD.device.vendor_id,
        device_id: AKD.device.device_id,
        instance: 1,
    };
    let mut now = Instant::ZERO;
    let ar = controller.connect(now, target, config(resolve)).unwrap();
    let mut peer = Peer::default();
    let mut lost = 0;
    settle(&mut controller, now, &mut peer, &mut lost);
    let device = SocketAddrV4::new(ip(50).address, RPC_PORT);
    for step in Steps(steps) {
        match step {
            Step::Frame(frame) => controller.handle_frame(now, frame),
            Step::Datagram(content) => {
                let (mode, content) = content.split_first().unwrap_or((&0, &[]));
                let port = if mode % 4 == 3 { RPC_PORT } else { client_port };
                controller.handle_datagram(now, device, port, &peer.says(*mode, content));
            }
            Step::Wait(time) => now += time,
        }
        settle(&mut controller, now, &mut peer, &mut lost);
    }
    // nothing more comes: within its own time limits the connection has ended, and reported it once
    let end = now + Duration::from_secs(1000);
    for _ in 0..20_000 {
        if lost > 0 || now > end {
            break;
        }
        now = controller.poll_timeout().unwrap_or(end + Duration::from_secs(1));
        settle(&mut controller, now, &mut peer, &mut lost);
    }
    assert_eq!(
        lost,
        1,
        "the end of the connection, phase {:?}",
        controller.phase(ar)
    );
}

/// Time passes, everything is sent, all events are taken.
fn settle(controller: &mut Controller, now: Instant, peer: &mut Peer, lost: &mut usize) {
    controller.handle_timeout(now);
    let mut buffer = [0; MAX_FRAME];
    for round in 0.. {
        match controller.poll_transmit(now, &mut buffer) {
            Some(Transmit::Datagram { length, .. }) => peer.hears(&buffer[..length]),
            Some(Transmit::Frame { .. }) => {}
            None => break,
        }
        assert!(round < 1000, "it never stops sending");
    }
    for round in 0.. {
        match controller.poll_event() {
            Some(Event::Lost { .. }) => *lost += 1,
            Some(_) => {}
            None => break,
        }
        assert!(round < 1000, "it never stops emitting events");
    }
}
