//! Frames of neighbours (LLDP) and requests about them (SNMP).

use std::net::SocketAddrV4;

use profinet::device::Stored;
use profinet::lldp::{MAX_NEIGHBOURS, Neighbours};
use profinet::snmp::MAX_ANSWER;
use profinet::wire::Reader;
use profinet::wire::lldp::{GROUP, Lldpdu};
use profinet::wire::snmp::{Message, PORT};
use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Transmit};
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

use super::steps::{Step, Steps};

const NEIGHBOUR: MacAddress = MacAddress([2, 0, 0, 0, 0, 9]);

/// LLDPDUs: decoded ones decode again after encoding, and the stored neighbours are bounded.
pub fn lldp(data: &[u8]) {
    if let Ok(lldpdu) = Lldpdu::decode(Reader::new(data)) {
        let mut again = Vec::new();
        lldpdu.encode(&mut again);
        let plain = Lldpdu {
            discarded: 0,
            unknown: 0,
            ..lldpdu
        };
        assert_eq!(Lldpdu::decode(Reader::new(&again)), Ok(plain));
    }
    let mut neighbours = Neighbours::default();
    let mut now = Instant::ZERO;
    neighbours.receive(now, NEIGHBOUR, data);
    for step in Steps(data) {
        match step {
            Step::Frame(payload) | Step::Datagram(payload) => neighbours.receive(now, NEIGHBOUR, payload),
            Step::Wait(time) => now += time,
        }
        neighbours.handle_timeout(now);
        assert!(neighbours.iter().count() <= MAX_NEIGHBOURS);
        assert!(
            neighbours.poll_timeout().is_none_or(|at| at > now),
            "a deadline that passed stays"
        );
        for neighbour in neighbours.iter() {
            assert!(neighbour.lldpdu().is_some());
            let _ = (neighbour.alias(), neighbour.mac());
        }
    }
}

/// SNMP messages, and a virtual drive that is reported things by its neighbour (frames) and asked about them
/// (datagrams).
pub fn snmp(data: &[u8]) {
    if let Ok(message) = Message::decode(Reader::new(data)) {
        let mut again = Vec::new();
        message.encode(&mut again);
        // lengths are written with a fixed number of octets, which has an end
        if again.len() < 60_000 {
            assert_eq!(Message::decode(Reader::new(&again)), Ok(message));
        }
    }
    let mac = MacAddress([2, 0x50, 0x4E, 0, 0, 1]);
    let mut config = StationConfig::new(&model::AKD, mac);
    config.network = Stored {
        name: "akd-1".into(),
        ip: IpSuite {
            address: [192, 168, 77, 50].into(),
            mask: [255, 255, 255, 0].into(),
            gateway: [0; 4].into(),
        },
        ..Stored::default()
    };
    let mut station = Station::new(config);
    let mut now = Instant::ZERO;
    ask(&mut station, now, data);
    for step in Steps(data) {
        match step {
            Step::Frame(payload) => {
                let frame = [&GROUP.0[..], &NEIGHBOUR.0, &[0x88, 0xCC], payload].concat();
                station.handle_frame(now, &frame);
            }
            Step::Datagram(request) => ask(&mut station, now, request),
            Step::Wait(time) => now += time,
        }
        station.handle_timeout(now);
    }
}

/// One question, at most one answer, which is a message that can be read.
fn ask(station: &mut Station, now: Instant, request: &[u8]) {
    let from = SocketAddrV4::new([192, 168, 77, 11].into(), 40_000);
    station.handle_datagram(now, from, PORT, request);
    let mut buffer = [0; MAX_FRAME];
    let mut answers = 0;
    for round in 0.. {
        let Some(transmit) = station.poll_transmit(now, &mut buffer) else {
            break;
        };
        if let Transmit::Datagram {
            destination,
            source_port: PORT,
            length,
        } = transmit
        {
            assert_eq!(destination, from);
            assert!(length <= MAX_ANSWER);
            assert!(Message::decode(Reader::new(&buffer[..length])).is_ok());
            answers += 1;
        }
        assert!(round < 1000, "it never stops sending");
    }
    assert!(answers <= 1);
}
