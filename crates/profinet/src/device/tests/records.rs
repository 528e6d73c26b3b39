//! Records: those of the engine, those of the application, written one by one or together.

use super::*;
use crate::wire::alarm::ChannelDiagnosis;
use crate::wire::block::{WriteItems, WriteResponse};
use crate::wire::record::{
    Identification, Im0, ImText, InterfaceReal, RecordInput, decode_apis, encode_im, index,
};

const NIL: Uuid = Uuid::NIL;

fn refused(code1: u8) -> PnioStatus {
    PnioStatus::read(code1)
}

#[test]
fn identification_is_read_without_an_ar() {
    let mut rig = Rig::new(config());
    let im0 = Im0::decode(Reader::new(&rig.read(NIL, 0, 0, 1, 0xAFF0).unwrap())).unwrap();
    assert_eq!(
        (im0.vendor_id, im0.hardware_revision, im0.supported),
        (0x105, 7, 0x1E)
    );
    assert_eq!(&im0.order_id, b"AKD-P00306          ");
    assert_eq!((im0.software_prefix, im0.software_revision), (b'V', [1, 11, 2]));
    assert_eq!((im0.profile_id, im0.version), (0x3A00, (1, 1)));
    for subslot in [0x8000, 0x8001] {
        assert!(rig.read(NIL, 0, 0, subslot, 0xAFF0).is_ok());
    }
    // subslot 0 is not a submodule, contrary to the AKD manual (3.6)
    assert_eq!(rig.read(NIL, 0, 0, 0, 0xAFF0), Err(refused(0xB2)));
    assert_eq!(
        decode_apis(Reader::new(&rig.read(NIL, 0, 0, 0, 0xF821).unwrap())),
        Ok(vec![0, DRIVE_API])
    );
    let real = rig.read(NIL, DRIVE_API, 0, 0, 0xF000).unwrap();
    let real = Identification::decode(&mut Reader::new(&real), BlockType::REAL_IDENTIFICATION).unwrap();
    assert_eq!(real.modules.len(), 1);
    assert_eq!((real.modules[0].slot, real.modules[0].ident), (1, TELEGRAM_1));
    let filter = rig.read(NIL, 0, 0, 0, 0xF840).unwrap();
    let mut reader = Reader::new(&filter);
    let own = Identification::decode(&mut reader, BlockType::IM0_FILTER_SUBMODULE).unwrap();
    assert_eq!(own.modules.len(), 2);
    let device = Identification::decode(&mut reader, BlockType::IM0_FILTER_DEVICE).unwrap();
    assert_eq!(
        (device.modules[0].slot, device.modules[0].submodules[0].subslot),
        (0, 1)
    );
    let interface = rig.read(NIL, 0, 0, 0x8000, 0x8080).unwrap();
    assert_eq!(
        InterfaceReal::decode(Reader::new(&interface)).unwrap().name,
        b"drive-1"
    );
}

#[test]
fn every_listed_record_is_answered() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    rig.exchange(&wish);
    let ar = wish.ar.ar_uuid;
    let empty: &[(u32, u16, u16, u16)] = &[
        (0, 0, 1, 0x800A),
        (0, 0, 1, 0x800B),
        (0, 0, 1, 0x800C),
        (0, 0, 1, 0xC00C),
        (0, 0, 0, 0xE00C),
        (0, 0, 0, 0xF00C),
        (0, 0, 0, 0xF80C),
        (0, 0, 1, 0x8010),
        (0, 0, 1, 0xC013),
        (0, 0, 0, 0xE010),
        (0, 0, 0, 0xF013),
        (0, 0, 0, 0xE002),
        (0, 0, 0, 0xF842),
        (0, 0, 0, 0xFBFF),
    ];
    for (api, slot, subslot, index) in empty {
        assert_eq!(
            rig.read(ar, *api, *slot, *subslot, *index),
            Ok(vec![]),
            "{index:#x}"
        );
    }
    let full: &[(u32, u16, u16, u16, u16)] = &[
        (0, 0, 1, 0x8000, 0x0012),
        (DRIVE_API, 1, 1, 0xC000, 0x0012),
        (0, 0, 0, 0xE000, 0x0012),
        (0, 0, 1, 0x8001, 0x0013),
        (0, 0, 1, 0xC001, 0x0013),
        (0, 0, 0, 0xE001, 0x0013),
        (DRIVE_API, 1, 1, 0x8028, 0x0015),
        (DRIVE_API, 1, 1, 0x8029, 0x0016),
        (0, 0, 0x8001, 0x802A, 0x020F),
        (0, 0, 0x8001, 0x8072, 0x0251),
        (0, 0, 0, 0xF020, 0x0018),
        (0, 0, 0, 0xF820, 0x0018),
        (0, 0, 0, 0xF830, 0x0019),
        (0, 0, 0, 0xF841, 0x0400),
    ];
    for (api, slot, subslot, index, block) in full {
        let record = rig.read(ar, *api, *slot, *subslot, *index).unwrap();
        assert_eq!(record[..2], block.to_be_bytes(), "{index:#x}");
        for block in crate::wire::block::Blocks::new(Reader::new(&record)) {
            block.unwrap();
        }
    }
    let live = rig.read(ar, DRIVE_API, 1, 1, 0x8028).unwrap();
    assert_eq!(
        RecordInput::decode(Reader::new(&live)),
        Ok(RecordInput {
            iocs: 0x80,
            iops: 0,
            data: &[0; 4]
        })
    );
}

#[test]
fn wrong_places_have_their_errors() {
    let mut rig = Rig::new(config());
    assert_eq!(rig.read(NIL, 7, 0, 1, 0xAFF0), Err(refused(0xB4)));
    assert_eq!(rig.read(NIL, DRIVE_API, 0, 1, 0xB02E), Err(refused(0xB4)));
    assert_eq!(rig.read(NIL, 0, 5, 1, 0xAFF0), Err(refused(0xB2)));
    assert_eq!(rig.read(NIL, 0, 0, 9, 0x002F), Err(refused(0xB2)));
    assert_eq!(rig.read(NIL, 0, 0, 1, 0xAFF5), Err(refused(0xB0)));
    assert_eq!(rig.read(NIL, 0, 0, 1, 0x8050), Err(refused(0xB0)));
    assert_eq!(rig.read(NIL, 0, 0, 1, 0x8080), Err(refused(0xB0)));
    assert_eq!(rig.read(NIL, DRIVE_API, 1, 1, 0xAFF1), Err(refused(0xB0)));
    assert_eq!(rig.read(NIL, 7, 0, 0, 0xF000), Err(refused(0xB4)));
    assert_eq!(
        rig.read(Uuid([5; 16]), 0, 0, 1, 0xAFF0),
        Err(PnioStatus::from_u32(0xDE81_4005))
    );
    // a read without an AR must be marked as such, and one with an AR must not
    let request = ReadRequest {
        sequence: 0,
        ar_uuid: NIL,
        api: 0,
        slot: 0,
        subslot: 1,
        index: 0xAFF0,
        length: 100,
        target_ar_uuid: NIL,
    };
    let mut blocks = Vec::new();
    request.encode(&mut blocks);
    assert_eq!(
        rig.call(operation::READ, &blocks).0,
        PnioStatus::from_u32(0xDE81_0805)
    );
    rig.connect(&Wish::tool(1)).unwrap();
    let mut blocks = Vec::new();
    ReadRequest {
        ar_uuid: Uuid([1; 16]),
        ..request
    }
    .encode(&mut blocks);
    assert_eq!(
        rig.call(operation::READ_IMPLICIT, &blocks).0,
        PnioStatus::from_u32(0xDE81_4005)
    );
    for (at, value, code2) in [(1, 7, 0), (3, 59, 1), (4, 2, 2)] {
        let mut blocks = blocks.clone();
        blocks[at] = value;
        let status = PnioStatus::new(0xDE, 0x81, 8, code2);
        assert_eq!(rig.call(operation::READ, &blocks).0, status);
    }
    // another client cannot use the AR
    rig.from = SocketAddrV4::new(STRANGER, 1);
    assert_eq!(
        rig.read(Uuid([1; 16]), 0, 0, 1, 0xAFF0),
        Err(PnioStatus::from_u32(0xDE81_4005))
    );
}

#[test]
fn long_data_is_truncated_to_the_requested_length() {
    let mut rig = Rig::new(config());
    let mut blocks = Vec::new();
    let request = ReadRequest {
        sequence: 3,
        ar_uuid: NIL,
        api: 0,
        slot: 0,
        subslot: 1,
        index: 0xAFF0,
        length: 10,
        target_ar_uuid: NIL,
    };
    request.encode(&mut blocks);
    let pdu = rig.request(operation::READ_IMPLICIT, &blocks);
    rig.send(&pdu);
    assert_eq!(rig.read_response(&request).unwrap().len(), 10);
}

#[test]
fn maintenance_records_are_written_read_and_reported() {
    let mut rig = Rig::new(config());
    rig.connect(&Wish::tool(1)).unwrap();
    rig.events();
    let ar = Uuid([1; 16]);
    for number in 1..=4u8 {
        let place = (0, 1, 0xAFF0 + u16::from(number));
        let body = if number == 2 {
            &b"2026-11-21 04:00"[..]
        } else {
            &[b'0' + number; 54][..]
        };
        let mut record = Vec::new();
        encode_im(number, body, &mut record);
        assert_eq!(rig.write(ar, 0, place, &record), PnioStatus::OK);
        let events = rig.events();
        assert!(matches!(events[..], [Event::ImChanged(_)]), "{events:?}");
        assert_eq!(rig.write(ar, 0, place, &record), PnioStatus::OK);
        assert!(rig.events().is_empty());
        let back = rig.read(ar, 0, 0, 0x8000, place.2).unwrap();
        assert_eq!(ImText::decode(Reader::new(&back), number).unwrap().body, body);
        assert_eq!(rig.write(ar, 0, place, &record[1..]), PnioStatus::write(0xB1));
        record[1] ^= 1;
        assert_eq!(rig.write(ar, 0, place, &record), PnioStatus::write(0xB8));
        assert_eq!(
            rig.write(ar, DRIVE_API, (1, 1, place.2), &record),
            PnioStatus::write(0xB0)
        );
    }
    assert_eq!(
        rig.write(ar, 0, (0, 1, 0xAFF0), &[0; 60]),
        PnioStatus::write(0xB6)
    );
    assert_eq!(
        rig.write(ar, 0, (0, 1, 0xAFF5), &[0; 60]),
        PnioStatus::write(0xB0)
    );
    assert_eq!(rig.write(ar, 0, (0, 0, 0xF830), &[]), PnioStatus::write(0xB6));
    assert_eq!(
        rig.write(NIL, 0, (0, 1, 1), &[]),
        PnioStatus::from_u32(0xDF81_0805)
    );
    assert_eq!(
        rig.write(Uuid([2; 16]), 0, (0, 1, 1), &[]),
        PnioStatus::from_u32(0xDF81_4005)
    );
    // the port and interface settings of a start-up
    let adjust = b"\x02\x50\x00\x08\x01\x00\x00\x00\x00\x00\x00\x01";
    assert_eq!(
        rig.write(ar, 0, (0, 0x8000, index::INTERFACE_ADJUST), adjust),
        PnioStatus::OK
    );
    assert_eq!(
        rig.read(ar, 0, 0, 0x8000, index::INTERFACE_ADJUST).unwrap(),
        adjust
    );
    let check = b"\x02\x00\x00\x08\x01\x00\x00\x00\x00\x00\x80\x01";
    assert_eq!(
        rig.write(ar, 0, (0, 0x8001, index::PORT_CHECK), check),
        PnioStatus::OK
    );
    assert_eq!(rig.read(ar, 0, 0, 0, 0xF842).unwrap().len(), 16 + check.len());
}

/// A block of this type with so many octets in all.
fn block_of(block_type: BlockType, octets: u16) -> Vec<u8> {
    let [high, low] = (octets - 4).to_be_bytes();
    let [first, second] = block_type.0.to_be_bytes();
    let mut block = vec![0; octets.into()];
    block[..6].copy_from_slice(&[first, second, high, low, 1, 0]);
    block
}

#[test]
fn records_of_ports_and_interface_are_bounded_in_number_and_length() {
    let mut rig = Rig::new(config());
    let wish = Wish::tool(1);
    rig.connect(&wish).unwrap();
    let mut write = |place, record: Vec<u8>| rig.write(wish.ar.ar_uuid, 0, place, &record);
    let ports = [
        (index::PORT_CHECK, BlockType::PD_PORT_CHECK),
        (index::PORT_ADJUST, BlockType::PD_PORT_ADJUST),
    ];
    for octets in [12, 511, 512] {
        for (index, block_type) in ports {
            let place = (0, 0x8001, index);
            assert_eq!(write(place, block_of(block_type, octets)), PnioStatus::OK);
            assert_eq!(write(place, block_of(block_type, 513)), PnioStatus::write(0xB1));
        }
    }
    let interface = (0, 0x8000, index::INTERFACE_ADJUST);
    for (octets, status) in [
        (11, PnioStatus::write(0xB1)),
        (12, PnioStatus::OK),
        (13, PnioStatus::write(0xB1)),
    ] {
        let record = block_of(BlockType::PD_INTERFACE_ADJUST, octets);
        assert_eq!(write(interface, record), status, "{octets}");
    }
    // the last of each is stored
    assert_eq!(rig.device.port_records.len(), ports.len());
    let stored = [
        (0x8001, index::PORT_CHECK, 512),
        (0x8001, index::PORT_ADJUST, 512),
        (0x8000, index::INTERFACE_ADJUST, 12),
    ];
    for (subslot, index, length) in stored {
        assert_eq!(rig.read(NIL, 0, 0, subslot, index).unwrap().len(), length);
    }
}

#[test]
fn the_application_answers_when_it_is_ready() {
    let mut rig = Rig::new(config());
    let wish = Wish::tool(1);
    rig.connect(&wish).unwrap();
    let Some(Event::Connected { ar, .. }) = rig.device.poll_event() else {
        panic!("not connected")
    };
    let address = RecordAddress {
        api: DRIVE_API,
        slot: 1,
        subslot: 1,
        index: 0xB02E,
    };
    let job = b"\x01\x01\x01\x01\x10\x01\x03\xc4\x00\x00";
    let pdu = rig.write_pdu(wish.ar.ar_uuid, DRIVE_API, (1, 1, 0xB02E), job);
    rig.send(&pdu);
    let Some(Event::RecordWrite {
        token,
        ar: by,
        address: at,
        data,
    }) = rig.device.poll_event()
    else {
        panic!("no write")
    };
    assert_eq!((by, at, &data[..]), (ar, address, &job[..]));
    // a repetition meanwhile is commanded to wait and not executed again
    rig.send(&pdu);
    let working = rig.drain();
    assert!(
        matches!(&working[..], [Sent::Datagram(_, _, pdu)] if pdu[1] == 4),
        "{working:?}"
    );
    assert!(rig.device.poll_event().is_none());
    assert!(rig.device.answer_write(rig.now, token, Ok(())));
    assert!(!rig.device.answer_write(rig.now, token, Ok(())));
    assert!(rig.response().0.is_ok());
    for result in [
        Err(PnioStatus::from_u32(0xDE80_B500)),
        Ok(&b"\x01\x01\x01\x01\x06\x01\x04\x93"[..]),
    ] {
        let request = ReadRequest {
            sequence: 1,
            ar_uuid: wish.ar.ar_uuid,
            api: DRIVE_API,
            slot: 1,
            subslot: 1,
            index: 0xB02E,
            length: 4096,
            target_ar_uuid: NIL,
        };
        let mut blocks = Vec::new();
        request.encode(&mut blocks);
        let pdu = rig.request(operation::READ, &blocks);
        rig.send(&pdu);
        let event = rig.device.poll_event();
        let Some(Event::RecordRead {
            token,
            ar: Some(by),
            address: at,
            length: 4096,
        }) = event
        else {
            panic!("no read: {event:?}")
        };
        assert_eq!((by, at), (ar, address));
        rig.device.answer_read(rig.now, token, result);
        assert_eq!(rig.read_response(&request), result.map(<[u8]>::to_vec));
    }
}

#[test]
fn an_application_that_never_answers_is_answered_for() {
    let mut rig = Rig::new(config());
    let mut wish = Wish::tool(1);
    wish.ar.activity_timeout_factor = 1000;
    rig.connect(&wish).unwrap();
    let pdu = rig.write_pdu(wish.ar.ar_uuid, DRIVE_API, (1, 1, 0x002F), b"1234");
    rig.send(&pdu);
    assert!(rig.pass(29_999).is_empty());
    rig.now += core::time::Duration::from_millis(1);
    rig.device.handle_timeout(rig.now);
    assert_eq!(rig.response().0, PnioStatus::write(0xA7));
}

#[test]
fn a_multiple_write_answers_every_record() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    rig.connect(&wish).unwrap();
    rig.events();
    let ar = wish.ar.ar_uuid;
    let mut im3 = Vec::new();
    encode_im(3, &[b'x'; 54], &mut im3);
    let mut inner = Vec::new();
    type Item<'a> = (u32, (u16, u16, u16), &'a [u8]);
    let items: [Item<'_>; 5] = [
        (0, (0, 1, 0xAFF3), &im3),
        (DRIVE_API, (1, 1, 0x0010), b"abcde"),
        (0, (0, 1, 0x8055), b"x"),
        (DRIVE_API, (1, 1, 0x0011), b""),
        (0, (0, 1, 0xAFF0), b"yz"),
    ];
    for (api, place, data) in items {
        write_request(ar, api, place, data).encode(&mut inner);
        inner.extend_from_slice(data);
        crate::wire::Writer::align(&mut inner, 0, 4);
    }
    assert_eq!(WriteItems::new(Reader::new(&inner)).count(), 5);
    let mut blocks = Vec::new();
    WriteRequest::multiple(9, ar, inner.len() as u32).encode(&mut blocks);
    blocks.extend_from_slice(&inner);
    let pdu = rig.request(operation::WRITE, &blocks);
    rig.send(&pdu);
    let mut given = Vec::new();
    let answers = [Err(PnioStatus::write(0xB7)), Ok(())];
    for result in answers {
        assert!(rig.drain().is_empty());
        let events = rig.events();
        let Some(Event::RecordWrite {
            token, address, data, ..
        }) = events.last().cloned()
        else {
            panic!("no write: {events:?}")
        };
        given.push((address.index, data));
        rig.device.answer_write(rig.now, token, result);
    }
    assert_eq!(given, [(0x10, b"abcde".to_vec()), (0x11, vec![])]);
    let (status, blocks) = rig.response();
    assert_eq!(status, PnioStatus::OK);
    let mut reader = Reader::new(&blocks);
    let mut statuses = Vec::new();
    while !reader.is_empty() {
        let response = WriteResponse::decode(&mut reader).unwrap();
        statuses.push((response.index, response.status.to_u32()));
    }
    let expected = [
        (0xE040, 0),
        (0xAFF3, 0),
        (0x0010, 0xDF80_B700),
        (0x8055, 0xDF80_B000),
        (0x0011, 0),
        (0xAFF0, 0xDF80_B600),
    ];
    assert_eq!(statuses, expected);
    // between PrmEnd and ApplicationReady nothing is written
    rig.prm_end(&wish);
    assert_eq!(rig.write(ar, DRIVE_API, (1, 1, 1), b"z"), PnioStatus::write(0xB5));
    assert!(rig.read(ar, 0, 0, 1, 0xAFF0).is_ok());
}

/// A controller may begin as soon as it has been reported that the device is ready, before its first valid output.
#[test]
fn records_are_written_between_application_ready_and_the_first_output() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    let ar = wish.ar.ar_uuid;
    let location = |rig: &mut Rig, text: &[u8; 54]| {
        let mut record = Vec::new();
        encode_im(1, text, &mut record);
        rig.write(ar, 0, (0, 1, 0xAFF1), &record)
    };
    rig.connect(&wish).unwrap();
    rig.prm_end(&wish);
    assert_eq!(location(&mut rig, &[b'a'; 54]), PnioStatus::write(0xB5));
    let key = rig.device.controller().unwrap();
    assert!(rig.device.application_ready(rig.now, key));
    let sent = rig.drain();
    assert_eq!(
        location(&mut rig, &[b'b'; 54]),
        PnioStatus::OK,
        "sent, not confirmed"
    );
    rig.confirm(&wish, &sent);
    assert!(!rig.device.is_exchanging());
    assert_eq!(location(&mut rig, &[b'c'; 54]), PnioStatus::OK, "no output yet");
    assert_eq!(rig.device.im().im1, [b'c'; 54]);
}

#[test]
fn services_that_the_device_refuses_are_answered_with_its_status() {
    let mut config = config();
    config.refusals = Refusals {
        device_access: Some(PnioStatus::connect(0x40, 3)),
        implicit_read: Some(PnioStatus::new(0xDE, 0x81, 0x40, 5)),
        controller: None,
        start_up_write: Some(PnioStatus::write(0xB5)),
    };
    let mut rig = Rig::new(config.clone());
    assert_eq!(
        rig.connect(&Wish::tool(1)).map(|_| ()),
        Err(PnioStatus::connect(0x40, 3))
    );
    assert_eq!(
        rig.read(NIL, 0, 0, 1, 0xAFF0),
        Err(PnioStatus::new(0xDE, 0x81, 0x40, 5))
    );
    let wish = Wish::controller(2);
    rig.connect(&wish).unwrap();
    let ar = wish.ar.ar_uuid;
    assert!(
        rig.read(ar, 0, 0, 1, 0xAFF0).is_ok(),
        "over the relation it is read"
    );
    let record = rig.write(ar, DRIVE_API, (1, 1, 1), b"z");
    assert_eq!(record, PnioStatus::write(0xB5));
    assert_eq!(rig.release(&wish), PnioStatus::OK);
    rig.exchange(&Wish::controller(3));
    let mut im1 = Vec::new();
    encode_im(1, &[b'x'; 54], &mut im1);
    assert_eq!(
        rig.write(Uuid([3; 16]), 0, (0, 1, 0xAFF1), &im1),
        PnioStatus::OK,
        "once data is exchanged"
    );
    config.refusals.controller = Some(PnioStatus::connect(0x3D, 1));
    let mut rig = Rig::new(config);
    assert_eq!(
        rig.connect(&Wish::controller(4)).map(|_| ()),
        Err(PnioStatus::connect(0x3D, 1))
    );
}

#[test]
fn a_device_without_device_access_ars_rejects_their_type() {
    let mut config = config();
    config.max_device_access = 0;
    let mut rig = Rig::new(config);
    assert_eq!(
        rig.connect(&Wish::tool(1)).map(|_| ()),
        Err(PnioStatus::connect(1, 4)),
        "faulty ARBlockReq: ARType"
    );
    assert!(rig.connect(&Wish::controller(2)).is_ok());
}

#[test]
fn a_pending_diagnosis_is_read_everywhere() {
    let mut rig = Rig::new(config());
    let item = ChannelDiagnosis {
        channel: ChannelDiagnosis::WHOLE_SUBMODULE,
        properties: 0,
        error_type: 0x9001,
        extended: Some((5, 702)),
        qualifier: None,
    };
    assert!(rig.device.set_diagnosis(rig.now, 1, 1, item, true));
    assert!(!rig.device.set_diagnosis(rig.now, 7, 1, item, true));
    for (api, slot, subslot, index) in [
        (DRIVE_API, 1, 1, 0x800C),
        (DRIVE_API, 1, 1, 0xC00B),
        (DRIVE_API, 0, 0, 0xF00A),
        (0, 0, 0, 0xF80C),
    ] {
        let record = rig.read(NIL, api, slot, subslot, index).unwrap();
        let (header, items) =
            crate::wire::record::DiagnosisHeader::decode(&mut Reader::new(&record)).unwrap();
        assert_eq!(
            (header.api, header.slot, header.subslot, header.usi),
            (DRIVE_API, 1, 1, 0x8002)
        );
        assert_eq!(items, b"\x80\x00\x08\x00\x90\x01\x00\x05\x00\x00\x02\xbe");
    }
    assert_eq!(rig.read(NIL, 0, 0, 1, 0x800C), Ok(vec![]));
    assert!(rig.device.set_diagnosis(rig.now, 1, 1, item, false));
    assert!(!rig.device.set_diagnosis(rig.now, 1, 1, item, false));
    assert_eq!(rig.read(NIL, 0, 0, 0, 0xF80C), Ok(vec![]));
}
