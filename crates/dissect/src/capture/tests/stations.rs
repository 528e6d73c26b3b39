//! Names, addresses, discovery, ARP.

use profinet::IpSuite;
use profinet::wire::dcp::{
    BlockError, BlockInfo, DcpOption, PduWriter, Qualifier, ServiceId, ServiceType, Value,
};

use super::*;

fn suite(last: u8) -> IpSuite {
    IpSuite {
        address: [10, 0, 0, last].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0, 0, 0, 0].into(),
    }
}

fn dcp(
    from: u8,
    to: MacAddress,
    id: FrameId,
    (service, kind): (ServiceId, ServiceType),
    build: impl FnOnce(&mut PduWriter<'_, Vec<u8>>),
) -> Vec<u8> {
    let mut payload = Vec::new();
    let mut pdu = PduWriter::new(&mut payload, service, kind, 5, 1);
    build(&mut pdu);
    pdu.finish();
    frame(from, to, id, &payload)
}

/// Returns a station reports its name and address.
fn here(from: u8, name: &[u8], ip: u8) -> Vec<u8> {
    let kind = (ServiceId::Identify, ServiceType::Success);
    dcp(from, mac(PLC), FrameId::DCP_IDENTIFY_RESPONSE, kind, |pdu| {
        pdu.info(BlockInfo::NONE, &Value::Name(name));
        pdu.info(BlockInfo::IP_SET, &Value::Ip(suite(ip)));
    })
}

/// Lets the controller search for a name.
fn who(name: &[u8]) -> Vec<u8> {
    let kind = (ServiceId::Identify, ServiceType::Request);
    dcp(
        PLC,
        ethernet::DCP_IDENTIFY,
        FrameId::DCP_IDENTIFY_REQUEST,
        kind,
        |pdu| {
            pdu.filter(&Value::Name(name));
        },
    )
}

fn set_name(name: &[u8]) -> Vec<u8> {
    let kind = (ServiceId::Set, ServiceType::Request);
    dcp(PLC, mac(DRIVE), FrameId::DCP_GET_SET, kind, |pdu| {
        pdu.set(Qualifier::PERMANENT, &Value::Name(name));
    })
}

fn set_result(error: BlockError) -> Vec<u8> {
    let kind = (ServiceId::Set, ServiceType::Success);
    dcp(DRIVE, mac(PLC), FrameId::DCP_GET_SET, kind, |pdu| {
        pdu.result(DcpOption::NAME, error);
    })
}

fn arp(from: u8, sender_ip: u8, target_ip: u8) -> Vec<u8> {
    let mut frame = vec![0xFF; 6];
    frame.extend(mac(from).0);
    frame.extend([8, 6, 0, 1, 8, 0, 6, 4, 0, 1]);
    frame.extend(mac(from).0);
    frame.extend([10, 0, 0, sender_ip]);
    frame.extend([0; 6]);
    frame.extend([10, 0, 0, target_ip]);
    frame.resize(60, 0);
    frame
}

#[test]
fn a_duplicate_name_is_reported_with_both_holders() {
    let mut capture = Capture::default();
    capture.at(0, &who(b"akd-1"));
    capture.at(1, &here(2, b"akd-1", 2));
    capture.at(2, &here(3, b"akd-1", 3));
    let event = capture.last();
    assert_eq!(
        event.text,
        "duplicate name akd-1: 02:00:00:00:00:03 has it, and 02:00:00:00:00:02 had it 1 ms before"
    );
    assert_eq!((event.weight, event.frame), (Weight::Error, 3));
    let expected = Trouble::DuplicateName {
        name: "akd-1".into(),
        mac: mac(3),
        other: mac(2),
        ago: Duration::from_millis(1),
    };
    assert_eq!(event.detail, Detail::Trouble(expected));
    // both are shown with their address from now on, and the conflict is reported once
    capture.at(3, &here(2, b"akd-1", 2));
    assert_eq!(capture.last().from, "akd-1 (02:00:00:00:00:02)");
    assert_eq!(capture.trouble().len(), 1);
}

#[test]
fn a_replaced_device_is_no_error() {
    let mut capture = Capture::default();
    capture.at(0, &who(b"akd-1"));
    capture.at(1, &here(2, b"akd-1", 2));
    capture.at(60_000, &who(b"akd-1"));
    capture.at(60_001, &here(3, b"akd-1", 3));
    assert_eq!(capture.last().weight, Weight::Warning);
    assert!(
        capture.last().text.contains("moved to 02:00:00:00:00:03"),
        "{}",
        capture.last().text
    );
}

#[test]
fn a_refused_name_renames_no_station() {
    let mut capture = Capture::default();
    capture.at(0, &set_name(b"akd-9"));
    assert_eq!(capture.last().to, "02:00:00:00:00:02", "not confirmed yet");
    capture.at(1, &set_result(BlockError::InOperation));
    assert_eq!(capture.last().from, "02:00:00:00:00:02");
    assert_eq!(capture.last().weight, Weight::Error);
    capture.at(2, &set_name(b"akd-9"));
    capture.at(3, &set_result(BlockError::Ok));
    assert_eq!(capture.last().from, "akd-9", "confirmed");
}

#[test]
fn discovery_without_an_answer_is_reported_once() {
    let mut capture = Capture::default();
    for second in 0..5 {
        capture.at(second * 2000, &who(b"akd-7"));
    }
    capture.end();
    assert_eq!(
        capture.trouble(),
        ["no answer to \"who is name akd-7?\" within 1.01 s"]
    );
    let missing = capture
        .events
        .iter()
        .find(|event| event.is_trouble())
        .expect("one");
    assert_eq!((missing.frame, missing.from.as_str()), (1, "02:00:00:00:00:01"));
}

#[test]
fn an_answer_without_its_request_is_reported() {
    let mut capture = Capture::default();
    capture.at(0, &set_result(BlockError::Ok));
    assert_eq!(
        capture.trouble(),
        ["answer to a DCP set that is not in the capture"]
    );
}

#[test]
fn address_conflicts_are_found_in_arp_and_in_dcp() {
    let mut capture = Capture::default();
    capture.at(0, &arp(2, 20, 1));
    // a probe has no address of its own
    capture.at(1, &arp(4, 0, 20));
    assert_eq!(capture.at(2, &arp(2, 20, 1)), [""; 0]);
    let reported = capture.at(3, &arp(3, 20, 1));
    assert_eq!(
        reported,
        ["duplicate IP address 10.0.0.20: 02:00:00:00:00:03 and 02:00:00:00:00:02 both use it"]
    );
    assert_eq!(capture.at(4, &arp(2, 20, 1)), [""; 0], "reported once");
    capture.at(5, &who(b"akd-4"));
    let reported = capture.at(6, &here(4, b"akd-4", 20));
    assert!(
        reported[1].starts_with("duplicate IP address 10.0.0.20"),
        "{reported:?}"
    );

    // identification reported by a device
    let kind = (ServiceId::Identify, ServiceType::Success);
    let conflict = dcp(5, mac(PLC), FrameId::DCP_IDENTIFY_RESPONSE, kind, |pdu| {
        pdu.info(BlockInfo(0x81), &Value::Ip(suite(5)));
    });
    let reported = capture.at(7, &conflict);
    assert!(
        reported.contains(&"reports that another station uses its IP address 10.0.0.5".to_owned()),
        "{reported:?}"
    );
}

#[test]
fn an_arp_flood_is_reported_once_and_normal_arp_never() {
    let mut capture = Capture::default();
    for frame in 0..1000_u64 {
        capture.at(frame * 10, &arp(2, 2, 1));
    }
    assert_eq!(capture.trouble(), [""; 0], "100 a second");
    for frame in 0..5000_u64 {
        capture.at(10_000 + frame, &arp(3, 3, 1));
    }
    assert_eq!(capture.trouble(), ["ARP flood: 300 frames within 1 s"]);
    assert_eq!(capture.last().from, "02:00:00:00:00:03");
}

#[test]
fn a_station_is_found_by_each_of_its_names_and_addresses() {
    let mut capture = Capture::default();
    capture.at(0, &who(b"akd-1"));
    capture.at(1, &here(2, b"akd-1", 2));
    capture.at(2, &who(b"akd-3"));
    capture.at(3, &here(3, b"akd-3", 3));
    for station in ["akd-1", "10.0.0.2", "02:00:00:00:00:02"] {
        let about = capture
            .events
            .iter()
            .filter(|event| capture.walker.is_about(event, station));
        let frames: Vec<u64> = about.map(|event| event.frame).collect();
        // the question for its name is about it too
        let expected: &[u64] = if station == "akd-1" { &[1, 2] } else { &[2] };
        assert_eq!(frames, expected, "{station}");
    }
}

#[test]
fn reports_of_stations_that_do_not_answer_are_bounded() {
    let mut capture = Capture::default();
    for second in 0..1100_u64 {
        let name = format!("akd-{second}");
        capture.at(second * 2000, &who(name.as_bytes()));
    }
    capture.end();
    let trouble = capture.trouble();
    assert_eq!(trouble.len(), 1024);
    assert!(trouble[1023].contains("akd-1023?"), "{}", trouble[1023]);
}
