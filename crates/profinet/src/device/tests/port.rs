//! The port: LLDP sent and received, SNMP, records and the alias.

use super::*;
use crate::lldp::MAX_NEIGHBOURS;
use crate::snmp::MAX_ANSWER;
use crate::wire::dcp::{DcpOption, Pdu, PduWriter, ServiceId, ServiceType, Value as DcpValue};
use crate::wire::ethernet;
use crate::wire::lldp::{CHASSIS_MAC, GROUP, Id, LOCALLY_ASSIGNED, Lldpdu, Management};
use crate::wire::record::{PortPeer, PortReal, index};
use crate::wire::snmp::{Binding, Message, Oid, PduKind, Value, Version};

const PLC: MacAddress = MacAddress([2, 0, 0, 0, 0, 0x11]);
const PLC_INTERFACE: MacAddress = MacAddress([2, 0, 0, 0, 0, 0x10]);

fn speaking() -> Rig {
    let mut config = config();
    config.neighbourhood = true;
    Rig::new(config)
}

fn own(value: &[u8]) -> Id<'_> {
    Id {
        subtype: LOCALLY_ASSIGNED,
        value,
    }
}

fn lldp_frame(from: MacAddress, lldpdu: &Lldpdu<'_>) -> Vec<u8> {
    let mut frame = [&GROUP.0[..], &from.0, &[0x88, 0xCC]].concat();
    lldpdu.encode(&mut frame);
    frame
}

fn plc(port: &[u8], ttl: u16) -> Vec<u8> {
    let lldpdu = Lldpdu {
        ttl,
        chassis_mac: Some(PLC_INTERFACE),
        ..Lldpdu::new(own(b"plc1"), own(port))
    };
    lldp_frame(PLC, &lldpdu)
}

/// Returns the LLDPDUs among what was sent, passed to `look`.
fn lldpdu(sent: &[Sent], mut look: impl FnMut(&Lldpdu<'_>)) -> usize {
    let mut count = 0;
    for sent in sent {
        let Sent::Frame(frame) = sent else { continue };
        if let Some((source, payload)) = lldp::payload(frame) {
            assert_eq!(source, DEVICE);
            assert!(frame.len() >= 60);
            look(&Lldpdu::decode(Reader::new(payload)).unwrap());
            count += 1;
        }
    }
    count
}

#[test]
fn it_announces_itself_every_five_seconds() {
    let mut rig = speaking();
    let sent = rig.pass(60_000);
    let count = lldpdu(&sent, |lldpdu| {
        assert_eq!((lldpdu.chassis, lldpdu.port), (own(b"drive-1"), own(b"port-001")));
        assert_eq!((lldpdu.ttl, lldpdu.chassis_mac), (20, Some(DEVICE)));
        assert_eq!(
            lldpdu.management.unwrap().ipv4(),
            Some(Ipv4Addr::new(192, 168, 77, 50))
        );
        let description = lldpdu.system_description.unwrap();
        assert_eq!(
            core::str::from_utf8(description).unwrap(),
            "AKD                       AKD-P00306           S-0001               7 V  1 11  2"
        );
        assert_eq!(lldpdu.mac_phy.unwrap().mau_type, 16);
        assert_eq!((lldpdu.delays, lldpdu.port_status), (Some([0; 5]), Some((0, 0))));
        assert_eq!(
            (lldpdu.max_frame, lldpdu.discarded, lldpdu.unknown),
            (Some(1522), 0, 0)
        );
    });
    assert_eq!(count, 13);
}

#[test]
fn a_name_change_withdraws_the_old_announcement() {
    let mut rig = speaking();
    rig.pass(1);
    let wish = Wish::tool(1);
    rig.connect(&wish).unwrap();
    // the new way of naming, chosen by the controller
    let adjust = [2, 0x50, 0, 8, 1, 0, 0, 0, 0, 0, 0, 1];
    let pdu = rig.write_pdu(wish.ar.ar_uuid, 0, (0, 0x8000, index::INTERFACE_ADJUST), &adjust);
    rig.send(&pdu);
    let mut seen = vec![];
    lldpdu(&rig.drain(), |lldpdu| {
        seen.push((
            lldpdu.chassis.value.to_vec(),
            lldpdu.port.value.to_vec(),
            lldpdu.ttl,
        ));
    });
    assert_eq!(seen[0], (b"drive-1".to_vec(), b"port-001".to_vec(), 0));
    assert_eq!(seen[1].1, b"port-001.drive-1");
    assert!(seen[1].0.starts_with(b"AKD   "));
    assert_eq!((seen[1].2, seen.len()), (20, 2));
    // without a name the address takes its place
    let mut rig = Rig {
        device: Device::new(
            DeviceConfig {
                neighbourhood: true,
                ..config()
            },
            Stored::default(),
        ),
        ..rig
    };
    let count = lldpdu(&rig.pass(1), |lldpdu| {
        assert_eq!(
            (lldpdu.chassis.subtype, lldpdu.chassis.value),
            (CHASSIS_MAC, &DEVICE.0[..])
        );
        assert_eq!((lldpdu.management, lldpdu.system_name), (None, None));
    });
    assert_eq!(count, 1);
}

#[test]
fn neighbours_come_change_and_go() {
    let mut rig = speaking();
    rig.device.handle_frame(rig.now, &plc(b"port-002", 20));
    assert_eq!(rig.device.neighbours().iter().count(), 1);
    rig.pass(19_000);
    rig.device.handle_frame(rig.now, &plc(b"port-002", 20));
    rig.pass(19_999);
    assert_eq!(rig.device.neighbours().iter().count(), 1);
    rig.pass(2);
    assert_eq!(rig.device.neighbours().iter().count(), 0);
    // its own words, and words to another group, are not a neighbour's
    let mut echo = plc(b"port-002", 20);
    echo[6..12].copy_from_slice(&DEVICE.0);
    rig.device.handle_frame(rig.now, &echo);
    let mut other = plc(b"port-002", 20);
    other[5] = 0;
    rig.device.handle_frame(rig.now, &other);
    assert_eq!(rig.device.neighbours().iter().count(), 0);
}

#[test]
fn the_records_of_the_port_name_the_neighbour() {
    let mut rig = speaking();
    rig.device.handle_frame(rig.now, &plc(b"port-002", 20));
    rig.device.note_traffic(Traffic::Received, &plc(b"port-002", 20));
    rig.device.note_traffic(Traffic::Sent, &[0xFF; 60]);
    let record = rig.read(Uuid::NIL, 0, 0, 0x8001, index::PORT_REAL).unwrap();
    let port = PortReal::decode(Reader::new(&record)).unwrap();
    assert_eq!(
        (port.name, port.mau_type, port.link_up),
        (&b"port-001"[..], 16, true)
    );
    let peer = PortPeer {
        port: b"port-002",
        station: b"plc1",
        line_delay: 0,
        mac: PLC_INTERFACE,
    };
    assert_eq!(port.peers, [peer]);
    let all = rig.read(Uuid::NIL, 0, 0, 0, index::PD_REAL).unwrap();
    assert!(all.windows(record.len()).any(|window| window == record));
    let statistic = rig.read(Uuid::NIL, 0, 0, 0x8001, index::PORT_STATISTIC).unwrap();
    let octets = plc(b"port-002", 20).len() as u32;
    assert_eq!(statistic[8..12], octets.to_be_bytes());
    assert_eq!(statistic[12..16], 60u32.to_be_bytes());
}

/// Requests the station with this alias; returns the alias in the answer.
fn identify_alias(rig: &mut Rig, alias: &[u8]) -> Option<Vec<u8>> {
    let mut payload = Vec::new();
    let mut pdu = PduWriter::new(&mut payload, ServiceId::Identify, ServiceType::Request, 77, 1);
    pdu.filter(&DcpValue::Alias(alias));
    pdu.finish();
    let mut frame = vec![0; 1518];
    let id = FrameId::DCP_IDENTIFY_REQUEST;
    let length = ethernet::emit(&mut frame, DCP_IDENTIFY, PLC, None, id, &payload).unwrap();
    rig.device.handle_frame(rig.now, &frame[..length]);
    rig.drain().iter().find_map(|sent| {
        let Sent::Frame(frame) = sent else { return None };
        let frame = Frame::parse(frame)?;
        let pdu = Pdu::parse(frame.payload).ok()?;
        let block = pdu.blocks().flatten().find(|b| b.option == DcpOption::ALIAS)?;
        // behind the BlockInfo
        Some(block.body[2..].to_vec())
    })
}

#[test]
fn a_station_is_found_by_the_alias_its_neighbour_gives() {
    let mut rig = speaking();
    assert_eq!(identify_alias(&mut rig, b"port-002.plc1"), None);
    rig.device.handle_frame(rig.now, &plc(b"port-002", 20));
    assert_eq!(
        identify_alias(&mut rig, b"port-002.plc1"),
        Some(b"port-002.plc1".to_vec())
    );
    assert_eq!(identify_alias(&mut rig, b"port-001.plc1"), None);
    assert_eq!(identify_alias(&mut rig, b"port-002.plc"), None);
    // the other way of naming
    let text = own(b"S7-1500    6ES7 511-1AK01-0AB0");
    let lldpdu = Lldpdu {
        ttl: 20,
        ..Lldpdu::new(text, own(b"port-001.plc2"))
    };
    rig.device.handle_frame(rig.now, &lldp_frame(PLC, &lldpdu));
    assert!(identify_alias(&mut rig, b"port-001.plc2").is_some());
}

fn snmp(rig: &mut Rig, kind: PduKind, name: &[u32], second: i32) -> Option<Message> {
    let asked = Message {
        version: Version::V2c,
        community: COMMUNITY.to_vec(),
        kind,
        request: 5,
        first: 0,
        second,
        bindings: vec![Binding {
            name: Oid(name.to_vec()),
            value: Value::Null,
        }],
    };
    let mut octets = Vec::new();
    asked.encode(&mut octets);
    let from = SocketAddrV4::new(HOST, 40_000);
    assert!(rig.device.serves(161));
    rig.device.handle_datagram(rig.now, from, 161, &octets);
    rig.drain().iter().find_map(|sent| match sent {
        Sent::Datagram(to, 161, octets) => {
            assert_eq!(*to, from);
            assert!(octets.len() <= MAX_ANSWER);
            Some(Message::decode(Reader::new(octets)).unwrap())
        }
        _ => None,
    })
}

fn walk(rig: &mut Rig, from: &[u32], kind: PduKind, repetitions: i32) -> Vec<(Oid, Value)> {
    let mut all: Vec<(Oid, Value)> = vec![];
    let mut at = Oid(from.to_vec());
    for _ in 0..1000 {
        for binding in snmp(rig, kind, &at.0, repetitions).unwrap().bindings {
            if binding.value == Value::EndOfMib || binding.name.behind(from).is_none() {
                return all;
            }
            assert!(binding.name > at, "{} after {at}", binding.name);
            at = binding.name.clone();
            all.push((binding.name, binding.value));
        }
    }
    panic!("a walk without end");
}

#[test]
fn a_walk_over_everything_agrees_with_get() {
    let mut rig = speaking();
    rig.pass(12_340);
    rig.device.handle_frame(rig.now, &plc(b"port-002", 20));
    let with_address = Lldpdu {
        ttl: 20,
        management: Some(Management {
            family: 1,
            address: &[192, 168, 77, 11],
            numbering: 2,
            interface: 3,
            object: &[],
        }),
        ..Lldpdu::new(own(b"switch"), own(b"port-007"))
    };
    rig.device.handle_frame(rig.now, &lldp_frame(PLC, &with_address));
    let all = walk(&mut rig, &[1], PduKind::GET_NEXT, 0);
    assert_eq!(all, walk(&mut rig, &[1], PduKind::GET_BULK, 50));
    assert_eq!(all.len(), 8 + 12 + 13 + 2 * 9 + 2 + 7 + 23 + 4 + 19);
    for (name, value) in &all {
        let got = snmp(&mut rig, PduKind::GET, &name.0, 0).unwrap();
        assert_eq!(&got.bindings[0].value, value, "{name}");
        let longer = name.with(&[1]);
        let got = snmp(&mut rig, PduKind::GET, &longer.0, 0).unwrap();
        assert_eq!(got.bindings[0].value, Value::NoSuchInstance, "{longer}");
    }
    let octets = |name: &[u32]| match &all.iter().find(|(n, _)| n.0 == name).unwrap().1 {
        Value::Octets(octets) => octets.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!(octets(&[1, 3, 6, 1, 2, 1, 1, 5, 0]), b"drive-1");
    assert_eq!(octets(&[1, 3, 6, 1, 2, 1, 2, 2, 1, 6, 1]), DEVICE.0);
    assert_eq!(octets(&[1, 0, 8802, 1, 1, 2, 1, 3, 2, 0]), b"drive-1");
    assert_eq!(octets(&[1, 0, 8802, 1, 1, 2, 1, 3, 7, 1, 3, 1]), b"port-001");
    assert_eq!(octets(&[1, 0, 8802, 1, 1, 2, 1, 4, 1, 1, 5, 1234, 1, 1]), b"plc1");
    assert_eq!(
        octets(&[1, 0, 8802, 1, 1, 2, 1, 4, 1, 1, 7, 1234, 1, 2]),
        b"port-007"
    );
    assert!(all.contains(&(
        Oid::from([
            1, 0, 8802, 1, 1, 2, 1, 4, 2, 1, 4, 1234, 1, 2, 1, 4, 192, 168, 77, 11
        ]),
        Value::Integer(3)
    )));
    assert!(all.contains(&(Oid::from([1, 3, 6, 1, 2, 1, 1, 3, 0]), Value::Ticks(1234))));
    // between groups and behind the end
    for name in [&[1, 3, 6, 1, 2, 1, 3][..], &[1, 3, 6, 1, 2, 1, 2, 2, 2], &[2, 0]] {
        let got = snmp(&mut rig, PduKind::GET, name, 0).unwrap();
        assert_eq!(got.bindings[0].value, Value::NoSuchObject, "{name:?}");
    }
    let end = snmp(&mut rig, PduKind::GET_NEXT, &[2, 0], 0).unwrap();
    assert_eq!(end.bindings[0].value, Value::EndOfMib);
}

#[test]
fn many_neighbours_and_many_questions_are_bounded() {
    let mut rig = speaking();
    for number in 0..100u8 {
        let name = [b'n', b'0' + number / 10, b'0' + number % 10];
        let lldpdu = Lldpdu {
            ttl: 20,
            system_description: Some(&[b'x'; 255]),
            ..Lldpdu::new(own(&name), own(b"port-001"))
        };
        rig.device.handle_frame(rig.now, &lldp_frame(PLC, &lldpdu));
    }
    assert_eq!(rig.device.neighbours().iter().count(), MAX_NEIGHBOURS);
    let rows = walk(&mut rig, &[1, 0, 8802, 1, 1, 2, 1, 4], PduKind::GET_BULK, 1000);
    assert_eq!(rows.len(), MAX_NEIGHBOURS * 9);
    // the record about the port still fits what a controller requests
    let record = rig.read(Uuid::NIL, 0, 0, 0x8001, index::PORT_REAL).unwrap();
    assert_eq!(
        PortReal::decode(Reader::new(&record)).unwrap().peers.len(),
        MAX_NEIGHBOURS
    );
    let mut octets = Vec::new();
    snmp(&mut rig, PduKind::GET, &[1, 3], 0).unwrap();
    Message {
        version: Version::V2c,
        community: COMMUNITY.to_vec(),
        kind: PduKind::GET_BULK,
        request: 5,
        first: 0,
        second: i32::MAX,
        bindings: vec![
            Binding {
                name: Oid::from([1, 0]),
                value: Value::Null
            };
            40
        ],
    }
    .encode(&mut octets);
    for _ in 0..1000 {
        let from = SocketAddrV4::new(HOST, 40_000);
        rig.device.handle_datagram(rig.now, from, 161, &octets);
    }
    assert!(rig.drain().len() <= 10);
}

#[test]
fn a_quiet_device_is_quiet() {
    let mut rig = Rig::new(config());
    assert_eq!(rig.device.poll_timeout(), None);
    rig.device.handle_frame(rig.now, &plc(b"port-002", 20));
    assert!(!rig.device.serves(161));
    assert_eq!(rig.device.neighbours().iter().count(), 0);
    assert!(rig.pass(30_000).is_empty());
}
