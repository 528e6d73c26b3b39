//! Records of known layouts, and parameter jobs without their other half.

use profinet::wire::alarm::ChannelDiagnosis;
use profinet::wire::block::{ReadRequest, WriteRequest};
use profinet::wire::record::{
    DiagnosisHeader, Im0, InterfaceReal, PortPeer, PortReal, encode_im, encode_multiple,
};
use profinet::{IpSuite, MacAddress};

use super::*;

/// Decodes a read of a record and its answer; returns the text and the numbers of the answer.
fn read(index: u16, record: &[u8]) -> (String, serde_json::Value, Weight) {
    let request = ReadRequest {
        sequence: 1,
        ar_uuid: Uuid::NIL,
        api: 0,
        slot: 0,
        subslot: 1,
        index,
        length: 4096,
        target_ar_uuid: Uuid::NIL,
    };
    let (mut asked, mut answered) = (Vec::new(), Vec::new());
    request.encode(&mut asked);
    request
        .response(u32::try_from(record.len()).expect("short"))
        .encode(&mut answered);
    answered.extend(record);
    let call = Call::new(operation::READ_IMPLICIT);
    let mut capture = Capture::default();
    assert_eq!(capture.at(0, &call.request(&asked)), [""; 0]);
    capture.at(1, &call.response(0, &answered));
    let event = capture.last();
    let detail = serde_json::to_value(&event.detail).expect("JSON");
    assert_eq!(detail["data"]["request_frame"], 1);
    (
        event.text.clone(),
        detail["data"]["content"].clone(),
        event.weight,
    )
}

#[test]
fn diagnosis_records_are_decoded() {
    let mut record = Vec::new();
    let header = DiagnosisHeader {
        api: 0x3A00,
        slot: 1,
        subslot: 2,
        usi: ChannelDiagnosis::USI_EXTENDED,
    };
    header.encode(&mut record, |out| {
        for channel in [4, 0x8000] {
            ChannelDiagnosis {
                channel,
                properties: 0x0800,
                error_type: 2,
                extended: Some((1, 7)),
                qualifier: None,
            }
            .encode(out);
        }
    });
    for index in [0x800C, 0xF80C, 0xE00A] {
        let (text, content, weight) = read(index, &record);
        assert!(
            text.ends_with(
                "slot 0/1: slot 1/2 API 0x3A00 channel 4: undervoltage (0x0002) appears, extended error 0x0001, value \
                 0x00000007; slot 1/2 API 0x3A00 whole submodule: undervoltage (0x0002) appears, extended error 0x0001, \
                 value 0x00000007"
            ),
            "{text}"
        );
        assert_eq!(weight, Weight::Warning);
        assert_eq!(content["places"][0]["diagnosis"][0]["channel"], 4);
        assert_eq!(content["places"][0]["diagnosis"][1]["ext_error_type"], 1);
    }
    assert_eq!(
        read(0x800C, &[]).0,
        "diagnosis, maintenance and status (0x800C) slot 0/1: nothing pending"
    );
}

#[test]
fn identification_and_maintenance_are_decoded() {
    let mut record = Vec::new();
    let mut im0 = Im0 {
        vendor_id: 0x0105,
        software_revision: [1, 17, 0],
        profile_id: 0x3A00,
        supported: 0x1E,
        ..Im0::default()
    };
    im0.order_id[..4].copy_from_slice(b"AKD-");
    im0.serial_number[..3].copy_from_slice(b"S-1");
    im0.encode(&mut record);
    let (text, content, _) = read(0xAFF0, &record);
    assert_eq!(
        text,
        "I&M0 (0xAFF0) slot 0/1: vendor 0x0105, order number AKD-, serial number S-1, hardware 0, software V1.17.0, \
         profile 0x3A00/0x0000, I&M supported 0x001E"
    );
    assert_eq!(
        (&content["vendor"], &content["serial"]),
        (&0x0105.into(), &"S-1".into())
    );
    let mut record = Vec::new();
    let mut body = [b' '; 54];
    body[..5].copy_from_slice(b"press");
    body[32..36].copy_from_slice(b"hall");
    encode_im(1, &body, &mut record);
    let (text, content, _) = read(0xAFF1, &record);
    assert!(text.ends_with("function \"press\", location \"hall\""), "{text}");
    assert_eq!(content["location"], "hall");
    record.truncate(40);
    let (text, _, weight) = read(0xAFF1, &record);
    assert!(text.contains("malformed"), "{text}");
    assert_eq!(weight, Weight::Warning);
}

#[test]
fn interface_and_ports_are_decoded() {
    let mut record = Vec::new();
    encode_multiple(&mut record, 0, 0, 0x8000, |out| {
        InterfaceReal {
            name: b"akd-1",
            mac: mac(DRIVE),
            ip: IpSuite {
                address: [10, 0, 0, 2].into(),
                mask: [255, 255, 255, 0].into(),
                gateway: [0, 0, 0, 0].into(),
            },
        }
        .encode(out);
    });
    encode_multiple(&mut record, 0, 0, 0x8001, |out| {
        PortReal {
            slot: 0,
            subslot: 0x8001,
            name: b"port-001",
            peers: vec![PortPeer {
                port: b"port-003",
                station: b"switch",
                line_delay: 0,
                mac: MacAddress([2, 0, 0, 0, 0, 9]),
            }],
            mau_type: 16,
            link_up: true,
        }
        .encode(out);
    });
    let (text, content, _) = read(0xF841, &record);
    assert_eq!(
        text,
        "PDRealData (0xF841) slot 0/1: interface akd-1, 02:00:00:00:00:02, 10.0.0.2/24; port-001 link up, 100 Mbit/s full \
         duplex, neighbour port-003 of switch (02:00:00:00:00:09)"
    );
    assert_eq!(content["blocks"][1]["peers"][0]["station"], "switch");
}

/// Writes a parameter request of ten octets, and gives the write.
fn request_job(capture: &mut Capture, job: [u8; 10]) -> WriteRequest {
    let write = WriteRequest {
        sequence: 1,
        ar_uuid: Uuid([9; 16]),
        api: 0x3A00,
        slot: 1,
        subslot: 1,
        index: 0xB02E,
        length: 10,
    };
    let mut blocks = Vec::new();
    write.encode(&mut blocks);
    blocks.extend(job);
    capture.at(0, &Call::new(operation::WRITE).request(&blocks));
    write
}

/// Reads an answer of eight octets; returns the frame of the answer and its texts.
fn answer_job(capture: &mut Capture, at: u64, job: [u8; 8]) -> (Vec<u8>, Vec<String>) {
    let request = ReadRequest {
        sequence: 2,
        ar_uuid: Uuid([9; 16]),
        api: 0x3A00,
        slot: 1,
        subslot: 1,
        index: 0xB02E,
        length: 240,
        target_ar_uuid: Uuid::NIL,
    };
    let (mut asked, mut answer) = (Vec::new(), Vec::new());
    request.encode(&mut asked);
    request.response(8).encode(&mut answer);
    answer.extend(job);
    let call = Call {
        sequence: 1,
        ..Call::new(operation::READ)
    };
    capture.at(at, &call.request(&asked));
    let frame = call.response(0, &answer);
    let texts = capture.at(at + 1, &frame);
    (frame, texts)
}

/// The name of the parameter, which only the request has, stands in the tree of the answer, at the octets of its value.
#[test]
fn the_tree_of_an_answer_has_the_names_of_its_request() {
    let mut capture = Capture::default();
    request_job(&mut capture, [7, 1, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0]);
    let (frame, _) = answer_job(&mut capture, 1, [7, 1, 0, 1, 0x42, 1, 0, 2]);
    let tree = capture.walker.tree(&frame);
    let path = tree.path(frame.len() - 1);
    let names: Vec<String> = path
        .iter()
        .map(|node| format!("{} {}", node.name, node.value).trim().to_owned())
        .collect();
    assert_eq!(
        names[1..],
        [
            "body",
            "record data",
            "value Operating mode (p0930) = 2 (positioning)   [Word 00 02]",
            "octets 00 02"
        ]
    );
}

#[test]
fn a_parameter_request_without_a_read_is_reported() {
    let mut capture = Capture::default();
    let write = request_job(&mut capture, [0x2A, 1, 1, 1, 0x10, 1, 3, 0xC4, 0, 0]);
    let call = Call::new(operation::WRITE);
    let event = serde_json::to_value(&capture.last().detail).expect("JSON");
    assert_eq!(
        (&event["kind"], &event["data"]["reference"]),
        (&"job".into(), &42.into())
    );
    assert_eq!(event["data"]["parameters"][0]["pnu"], 964);
    let mut answered = Vec::new();
    write.response(PnioStatus::OK).encode(&mut answered);
    capture.at(1, &call.response(0, &answered));
    assert_eq!(
        capture.wait(10_000),
        ["parameter request 42: no answer was read within 10 s"]
    );

    // the other way round: an answer whose request is not in the capture
    let (_, texts) = answer_job(&mut capture, 10_001, [0x2B, 1, 1, 1, 6, 1, 4, 0x93]);
    assert_eq!(
        texts[1],
        "answer to a parameter request that is not in the capture"
    );
}
