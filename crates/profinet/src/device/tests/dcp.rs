//! Found, named, addressed, reset.

use core::time::Duration;

use super::*;
use crate::wire::dcp::{BlockError, DcpOption, Pdu, PduWriter, Qualifier, ServiceId, ServiceType, Value};
use crate::wire::ethernet;

const TOOL: MacAddress = MacAddress([2, 0, 0, 0, 0, 7]);
const OTHER_TOOL: MacAddress = MacAddress([2, 0, 0, 0, 0, 8]);

fn frame(from: MacAddress, to: MacAddress, id: FrameId, payload: &[u8]) -> Vec<u8> {
    let mut frame = vec![0; 1518];
    let length = ethernet::emit(&mut frame, to, from, None, id, payload).unwrap();
    frame.truncate(length);
    frame
}

/// Sends a PDU; gives the payload of the answer that is sent at once.
fn ask(rig: &mut Rig, from: MacAddress, to: MacAddress, id: FrameId, payload: &[u8]) -> Option<Vec<u8>> {
    rig.device.handle_frame(rig.now, &frame(from, to, id, payload));
    answer(&rig.drain(), from)
}

fn answer(sent: &[Sent], to: MacAddress) -> Option<Vec<u8>> {
    sent.iter().find_map(|sent| {
        let Sent::Frame(bytes) = sent else { return None };
        let frame = Frame::parse(bytes).unwrap();
        let dcp = matches!(
            frame.frame_id,
            FrameId::DCP_GET_SET | FrameId::DCP_IDENTIFY_RESPONSE
        );
        (dcp && frame.destination == to).then(|| frame.payload.to_vec())
    })
}

fn identify(rig: &mut Rig, factor: u16, filters: &[Value<'_>]) -> Option<Vec<u8>> {
    let mut payload = Vec::new();
    let mut pdu = PduWriter::new(
        &mut payload,
        ServiceId::Identify,
        ServiceType::Request,
        77,
        factor,
    );
    for filter in filters {
        pdu.filter(filter);
    }
    pdu.finish();
    ask(rig, TOOL, DCP_IDENTIFY, FrameId::DCP_IDENTIFY_REQUEST, &payload)
}

fn set_from(rig: &mut Rig, from: MacAddress, qualifier: Qualifier, values: &[Value<'_>]) -> Vec<BlockError> {
    let mut payload = Vec::new();
    let mut pdu = PduWriter::new(&mut payload, ServiceId::Set, ServiceType::Request, 3, 0);
    for value in values {
        pdu.set(qualifier, value);
    }
    pdu.finish();
    let Some(answer) = ask(rig, from, DEVICE, FrameId::DCP_GET_SET, &payload) else {
        return vec![];
    };
    let pdu = Pdu::parse(&answer).unwrap();
    assert_eq!(
        (pdu.service, pdu.kind, pdu.xid),
        (ServiceId::Set, ServiceType::Success, 3)
    );
    let results = pdu.blocks().zip(values).map(|(block, value)| {
        let (option, error) = block.unwrap().result().unwrap();
        assert_eq!(option, value.option());
        error
    });
    results.collect()
}

fn set(rig: &mut Rig, qualifier: Qualifier, value: Value<'_>) -> BlockError {
    rig.now += Duration::from_secs(4);
    set_from(rig, TOOL, qualifier, &[value])[0]
}

fn suite(last: u8) -> IpSuite {
    IpSuite {
        address: Ipv4Addr::new(10, 0, 0, last),
        mask: Ipv4Addr::new(255, 255, 255, 0),
        gateway: Ipv4Addr::UNSPECIFIED,
    }
}

#[test]
fn identify_answers_when_every_filter_fits() {
    let mut rig = Rig::new(config());
    let name = Value::Name(b"drive-1");
    let (vendor, device) = (0x105, 1);
    let ip = Value::Ip(rig.device.ip);
    let fitting: &[&[Value<'_>]] = &[
        &[Value::ALL],
        &[name],
        &[name, Value::DeviceId { vendor, device }],
        &[Value::Mac(DEVICE)],
        &[Value::StationType(b"AKD")],
        &[Value::Role(1), Value::Instance(1)],
        &[ip, name],
    ];
    for filters in fitting {
        let answer = identify(&mut rig, 1, filters).expect("an answer");
        let pdu = Pdu::parse(&answer).unwrap();
        assert_eq!((pdu.kind, pdu.xid), (ServiceType::Success, 77));
        let options: Vec<DcpOption> = pdu.blocks().map(|block| block.unwrap().option).collect();
        for must in [
            DcpOption::IP,
            DcpOption::STATION_TYPE,
            DcpOption::NAME,
            DcpOption::DEVICE_ID,
            DcpOption::ROLE,
        ] {
            assert!(options.contains(&must));
        }
    }
    let silent: &[&[Value<'_>]] = &[
        &[],
        &[Value::Name(b"drive-11")],
        &[Value::Name(b"drive-")],
        &[Value::Name(b"")],
        &[name, Value::DeviceId { vendor, device: 2 }],
        &[name, Value::ALL],
        &[Value::ALL, name],
        &[name, Value::Alias(b"port-001.plc")],
        &[Value::Other(DcpOption::new(9, 9), b"xx")],
        &[Value::Signal(0x100)],
    ];
    for filters in silent {
        assert_eq!(identify(&mut rig, 1, filters), None, "{filters:?}");
    }
}

#[test]
fn identify_of_the_reference_and_delay_by_mac() {
    let mut rig = Rig::new(config());
    let golden = b"\x05\x00\x00\x00\x00\x02\x00\x01\x00\x0c\x02\x02\x00\x07drive-1\x00";
    assert!(
        ask(
            &mut rig,
            TOOL,
            DCP_IDENTIFY,
            FrameId::DCP_IDENTIFY_REQUEST,
            golden
        )
        .is_some()
    );
    for end in 0..golden.len() - 1 {
        // what is declared must be there; padding of the frame does not count as content
        let mut bytes = vec![0; 60];
        bytes[..6].copy_from_slice(&DCP_IDENTIFY.0);
        bytes[6..12].copy_from_slice(&TOOL.0);
        bytes[12..16].copy_from_slice(&[0x88, 0x92, 0xFE, 0xFE]);
        bytes.truncate(16);
        bytes.extend_from_slice(&golden[..end]);
        rig.device.handle_frame(rig.now, &bytes);
        assert!(rig.drain().is_empty());
    }
    let mut last = config();
    last.mac = MacAddress([2, 0, 0, 0, 0x01, 0x05]);
    let mut rig = Rig::new(last);
    assert_eq!(identify(&mut rig, 100, &[Value::ALL]), None);
    // (0x0105 mod 100) x 10 ms
    assert_eq!(rig.device.poll_timeout(), Some(Instant::from_millis(610)));
    assert!(answer(&rig.pass(609), TOOL).is_none());
    assert!(answer(&rig.pass(1), TOOL).is_some());
    for _ in 0..50 {
        identify(&mut rig, 6400, &[Value::ALL]);
    }
    // all of them wait for their time; who requests an answer at once still gets it
    assert!(identify(&mut rig, 1, &[Value::Name(b"drive-1")]).is_some());
    assert!(rig.pass(64_000).len() <= 8);
}

#[test]
fn get_gives_values_and_refusals_in_order() {
    let mut rig = Rig::new(config());
    let mut payload = Vec::new();
    let mut pdu = PduWriter::new(&mut payload, ServiceId::Get, ServiceType::Request, 1, 0);
    for option in [
        DcpOption::NAME,
        DcpOption::FULL_IP,
        DcpOption::SIGNAL,
        DcpOption::new(9, 1),
        DcpOption::NAME,
    ] {
        pdu.request(option);
    }
    pdu.finish();
    let answer = ask(&mut rig, TOOL, DEVICE, FrameId::DCP_GET_SET, &payload).unwrap();
    let blocks: Vec<_> = Pdu::parse(&answer)
        .unwrap()
        .blocks()
        .map(Result::unwrap)
        .collect();
    assert_eq!(blocks.len(), 4);
    assert_eq!(blocks[0].info().unwrap().1, Value::Name(b"drive-1"));
    assert!(matches!(blocks[1].info().unwrap().1, Value::FullIp { suite, .. } if suite == rig.device.ip));
    assert_eq!(
        blocks[2].result(),
        Ok((DcpOption::SIGNAL, BlockError::SuboptionUnsupported))
    );
    assert_eq!(
        blocks[3].result(),
        Ok((DcpOption::new(9, 1), BlockError::OptionUnsupported))
    );
}

#[test]
fn names_and_addresses_are_set_for_good_or_for_now() {
    let mut rig = Rig::new(config());
    let (permanent, temporary) = (Qualifier::PERMANENT, Qualifier::TEMPORARY);
    assert_eq!(set(&mut rig, permanent, Value::Name(b"akd-2")), BlockError::Ok);
    assert_eq!(set(&mut rig, permanent, Value::Name(b"akd-2")), BlockError::Ok);
    assert_eq!(set(&mut rig, temporary, Value::Name(b"akd-2")), BlockError::Ok);
    let renamed = |permanent| Event::NameChanged {
        name: "akd-2".into(),
        permanent,
    };
    assert_eq!(rig.events(), [renamed(true), renamed(false)]);
    for bad in [
        &b"Akd"[..],
        b"a_b",
        b"-a",
        b"a..b",
        b"1.2.3.4",
        b"port-001",
        &[b'a'; 64],
    ] {
        assert_eq!(set(&mut rig, permanent, Value::Name(bad)), BlockError::NotSet);
    }
    assert_eq!(rig.device.name(), "akd-2");
    assert_eq!(set(&mut rig, permanent, Value::Name(b"")), BlockError::Ok);
    assert_eq!(rig.device.name(), "");
    rig.events();

    assert_eq!(set(&mut rig, temporary, Value::Ip(suite(2))), BlockError::Ok);
    assert_eq!(
        rig.events(),
        [Event::IpChanged {
            suite: suite(2),
            permanent: false
        }]
    );
    let own_gateway = IpSuite {
        gateway: suite(3).address,
        ..suite(3)
    };
    let full = Value::FullIp {
        suite: own_gateway,
        dns: [Ipv4Addr::UNSPECIFIED; 4],
    };
    assert_eq!(set(&mut rig, permanent, full), BlockError::Ok);
    assert_eq!(rig.device.ip(), suite(3));
    let foreign = IpSuite {
        gateway: Ipv4Addr::new(10, 0, 1, 1),
        ..suite(3)
    };
    let hole = IpSuite {
        mask: Ipv4Addr::new(255, 0, 255, 0),
        ..suite(3)
    };
    for bad in [suite(0), suite(255), foreign, hole] {
        assert_eq!(set(&mut rig, permanent, Value::Ip(bad)), BlockError::NotSet);
    }
    let short = Value::Other(DcpOption::IP, &[1, 2, 3]);
    assert_eq!(set(&mut rig, permanent, short), BlockError::NotSet);
    assert_eq!(
        set(&mut rig, permanent, Value::Mac(TOOL)),
        BlockError::SuboptionUnsupported
    );
    assert_eq!(set(&mut rig, permanent, Value::Ip(IpSuite::NONE)), BlockError::Ok);
    assert!(!rig.device.ip().is_set());
    let both = set_from(
        &mut rig,
        TOOL,
        permanent,
        &[Value::Name(b"x"), Value::Ip(suite(9))],
    );
    assert_eq!(both, [BlockError::Ok; 2]);
}

/// Option 3: a DHCP client of the station is nothing that DCP sets here, by MAC address, name or client id (61).
#[test]
fn dhcp_is_not_set_by_dcp() {
    let mut rig = Rig::new(config());
    let before = (rig.device.name.clone(), rig.device.ip);
    for octets in [&[0][..], &[2], b"\x01client"] {
        let dhcp = Value::Other(DcpOption::new(3, 61), octets);
        let result = set(&mut rig, Qualifier::PERMANENT, dhcp);
        assert_eq!(result, BlockError::SuboptionUnsupported, "{octets:02X?}");
    }
    assert_eq!((rig.device.name.clone(), rig.device.ip), before);
}

#[test]
fn an_io_connection_keeps_its_address_and_tools_are_disconnected() {
    let mut rig = Rig::new(config());
    rig.connect(&Wish::tool(1)).unwrap();
    rig.connect(&Wish::tool(2)).unwrap();
    rig.events();
    assert_eq!(
        set(&mut rig, Qualifier::PERMANENT, Value::Ip(suite(2))),
        BlockError::Ok
    );
    assert_eq!(rig.device.ip(), suite(2));
    let closed = PnioStatus::aborted(abort::CLOSED);
    let events = rig.events();
    let ended = |event: &&Event| matches!(event, Event::Disconnected { cause, .. } if *cause == closed);
    assert_eq!(events.iter().filter(ended).count(), 2, "{events:?}");
    let kept = Event::IpChanged {
        suite: suite(2),
        permanent: true,
    };
    assert!(events.contains(&kept), "{events:?}");

    rig.connect(&Wish::controller(3)).unwrap();
    rig.connect(&Wish::tool(4)).unwrap();
    let same = rig.device.ip;
    assert_eq!(
        set(&mut rig, Qualifier::PERMANENT, Value::Ip(suite(5))),
        BlockError::InOperation
    );
    assert_eq!(rig.device.tools.len(), 1, "a refused address ends no connection");
    let refused = |event: &Event| matches!(event, Event::SetRefused { refusal: SetRefusal::Connected(option), .. } if *option == DcpOption::IP);
    assert_eq!(rig.events().iter().filter(|event| refused(event)).count(), 1);
    assert_eq!(
        set(&mut rig, Qualifier::PERMANENT, Value::Ip(same)),
        BlockError::Ok
    );
    assert_eq!(
        set(&mut rig, Qualifier::PERMANENT, Value::Name(b"drive-1")),
        BlockError::Ok
    );
}

#[test]
fn another_name_ends_a_running_connection() {
    let mut rig = Rig::new(config());
    rig.exchange(&Wish::controller(1));
    let mut payload = Vec::new();
    let mut pdu = PduWriter::new(&mut payload, ServiceId::Set, ServiceType::Request, 3, 0);
    pdu.set(Qualifier::PERMANENT, &Value::Name(b"other"));
    pdu.finish();
    rig.device
        .handle_frame(rig.now, &frame(TOOL, DEVICE, FrameId::DCP_GET_SET, &payload));
    let cause = PnioStatus::aborted(abort::NAME_CHANGED);
    assert_eq!(last_word(&rig.drain()), Some(cause));
    assert_eq!(disconnected(&rig.events()), Some(cause));
}

#[test]
fn one_client_at_a_time_is_served() {
    let mut rig = Rig::new(config());
    let name = [Value::Name(b"one")];
    assert_eq!(set_from(&mut rig, TOOL, Qualifier::PERMANENT, &name).len(), 1);
    assert_eq!(
        set_from(&mut rig, OTHER_TOOL, Qualifier::PERMANENT, &[Value::Name(b"two")]).len(),
        0
    );
    assert_eq!(rig.device.name(), "one");
    // finding is not held
    assert!(identify(&mut rig, 1, &[Value::ALL]).is_some());
    rig.now += Duration::from_secs(3);
    assert_eq!(
        set_from(&mut rig, OTHER_TOOL, Qualifier::PERMANENT, &[Value::Name(b"two")]).len(),
        1
    );
    // requests for all or for another station get no answer either
    let mut payload = Vec::new();
    PduWriter::new(&mut payload, ServiceId::Get, ServiceType::Request, 1, 0).finish();
    for to in [DCP_IDENTIFY, MacAddress::BROADCAST, TOOL] {
        assert_eq!(
            ask(&mut rig, OTHER_TOOL, to, FrameId::DCP_GET_SET, &payload),
            None
        );
    }
}

#[test]
fn invalid_frames_are_ignored_and_block_no_other_client() {
    let mut rig = Rig::new(config());
    let cut_off = |service, data: &[u8]| {
        let mut payload = Vec::new();
        PduWriter::new(&mut payload, service, ServiceType::Request, 1, 0).finish();
        payload.extend_from_slice(data);
        payload[9] = u8::try_from(data.len()).unwrap();
        payload
    };
    for garbage in [
        cut_off(ServiceId::Get, &[2, 2, 2]),
        cut_off(ServiceId::Set, &[2, 2, 0, 9, 0, 0]),
    ] {
        assert_eq!(
            ask(&mut rig, OTHER_TOOL, DEVICE, FrameId::DCP_GET_SET, &garbage),
            None
        );
    }
    let results = set_from(&mut rig, TOOL, Qualifier::TEMPORARY, &[Value::FLASH]);
    assert_eq!(results, [BlockError::Ok]);
}

#[test]
fn signal_blinks_once_and_unknown_services_are_rejected() {
    let mut rig = Rig::new(config());
    for _ in 0..3 {
        let results = set_from(&mut rig, TOOL, Qualifier::TEMPORARY, &[Value::FLASH]);
        assert_eq!(results, [BlockError::Ok]);
    }
    assert_eq!(rig.events(), [Event::Signal]);
    assert_eq!(set(&mut rig, Qualifier::TEMPORARY, Value::FLASH), BlockError::Ok);
    assert_eq!(rig.events(), [Event::Signal]);
    let mut payload = Vec::new();
    PduWriter::new(&mut payload, ServiceId::Other(9), ServiceType::Request, 5, 0).finish();
    let answer = ask(&mut rig, TOOL, DEVICE, FrameId::DCP_GET_SET, &payload).unwrap();
    let pdu = Pdu::parse(&answer).unwrap();
    assert_eq!(
        (pdu.service, pdu.kind, pdu.data.len()),
        (ServiceId::Other(9), ServiceType::NotSupported, 0)
    );
}

#[test]
fn resets_answer_first_and_clear_by_mode() {
    let reset = Value::Empty(DcpOption::RESET_TO_FACTORY);
    let mut rig = Rig::new(config());
    assert_eq!(
        set(&mut rig, Qualifier::reset(3), reset),
        BlockError::SuboptionUnsupported
    );
    assert_eq!(rig.device.name(), "drive-1");
    rig.exchange(&Wish::controller(1));
    let mut payload = Vec::new();
    let mut pdu = PduWriter::new(&mut payload, ServiceId::Set, ServiceType::Request, 3, 0);
    pdu.set(Qualifier::reset(2), &reset);
    pdu.finish();
    rig.device
        .handle_frame(rig.now, &frame(TOOL, DEVICE, FrameId::DCP_GET_SET, &payload));
    let sent = rig.drain();
    let cause = PnioStatus::aborted(abort::FACTORY_RESET);
    assert!(answer(&sent[..1], TOOL).is_some());
    assert_eq!(last_word(&sent[1..]), Some(cause));
    let events = rig.events();
    assert_eq!(disconnected(&events), Some(cause));
    assert_eq!(
        events.last(),
        Some(&Event::FactoryReset {
            mode: ResetMode::Communication
        })
    );
    assert_eq!((rig.device.name(), rig.device.ip()), ("", IpSuite::NONE));
    let everything = Value::Empty(DcpOption::FACTORY_RESET);
    assert_eq!(set(&mut rig, Qualifier(0), everything), BlockError::Ok);
    assert_eq!(
        rig.events(),
        [Event::FactoryReset {
            mode: ResetMode::Device
        }]
    );
}

#[test]
fn a_reset_of_the_communication_forgets_what_was_written_about_the_interface() {
    use crate::wire::record::index::INTERFACE_ADJUST;
    let mut rig = Rig::new(config());
    let wish = Wish::tool(1);
    rig.connect(&wish).unwrap();
    let adjust = [2, 0x50, 0, 8, 1, 0, 0, 0, 0, 0, 0, 1];
    assert_eq!(
        rig.write(wish.ar.ar_uuid, 0, (0, 0x8000, INTERFACE_ADJUST), &adjust),
        PnioStatus::OK
    );
    let read = |rig: &mut Rig| rig.read(Uuid::NIL, 0, 0, 0x8000, INTERFACE_ADJUST);
    assert_eq!(read(&mut rig), Ok(adjust.to_vec()));
    let mode = Value::Empty(DcpOption::RESET_TO_FACTORY);
    assert_eq!(set(&mut rig, Qualifier(0x0004), mode), BlockError::Ok);
    assert_eq!(read(&mut rig), Ok(vec![]));
}

#[test]
fn name_and_reset_are_refused_while_something_moves_under_a_controller() {
    let reset = Value::Empty(DcpOption::RESET_TO_FACTORY);
    let everything = Value::Empty(DcpOption::FACTORY_RESET);
    let changes = [
        (Qualifier::PERMANENT, Value::Name(b"other"), DcpOption::NAME),
        (Qualifier::reset(2), reset, DcpOption::RESET_TO_FACTORY),
        (Qualifier(0), everything, DcpOption::FACTORY_RESET),
    ];
    for (qualifier, value, option) in changes {
        let mut rig = Rig::new(config());
        rig.exchange(&Wish::controller(1));
        rig.device.set_operating(true);
        rig.events();
        let results = set_from(&mut rig, TOOL, qualifier, &[value]);
        assert_eq!(results, [BlockError::InOperation]);
        let refusal = SetRefusal::InOperation(option);
        let source = TOOL;
        assert_eq!(rig.events(), [Event::SetRefused { source, refusal }]);
        assert_eq!(rig.device.name(), "drive-1");
        // what changes nothing is not a danger
        let same = [Value::Name(b"drive-1"), Value::Signal(0x0100)];
        let results = set_from(&mut rig, TOOL, Qualifier::PERMANENT, &same);
        assert_eq!(results, [BlockError::Ok; 2]);
        rig.device.set_operating(false);
        assert_eq!(set_from(&mut rig, TOOL, qualifier, &[value]), [BlockError::Ok]);
    }
}

#[test]
fn a_device_may_take_a_name_in_operation_and_without_a_controller_always_does() {
    let name = Value::Name(b"other");
    let mut rig = Rig::new(config());
    rig.device.set_operating(true);
    assert_eq!(set(&mut rig, Qualifier::PERMANENT, name), BlockError::Ok);
    let config = DeviceConfig {
        refuses_in_operation: false,
        ..config()
    };
    let mut rig = Rig::new(config);
    rig.exchange(&Wish::controller(1));
    rig.device.set_operating(true);
    let results = set_from(&mut rig, TOOL, Qualifier::PERMANENT, &[name]);
    assert_eq!(results, [BlockError::Ok]);
}

#[test]
fn a_flood_of_changes_is_ignored_and_leaves_room_for_an_engineer() {
    let mut rig = Rig::new(config());
    let mut changed = 0;
    let mut flood = |rig: &mut Rig, requests: u32| {
        for request in 0..requests {
            rig.now += Duration::from_micros(111);
            let name = alloc::format!("name-{request}");
            set_from(rig, TOOL, Qualifier::PERMANENT, &[Value::Name(name.as_bytes())]);
            changed += rig
                .events()
                .iter()
                .filter(|event| matches!(event, Event::NameChanged { .. }))
                .count();
        }
        changed
    };
    assert_eq!(flood(&mut rig, 20_000), 100);
    // the client served last has three seconds of its own; a flood is ignored by then
    assert_eq!(flood(&mut rig, 10_000), 100);
    let engineer = set_from(
        &mut rig,
        OTHER_TOOL,
        Qualifier::PERMANENT,
        &[Value::Name(b"mine")],
    );
    assert_eq!(engineer, [BlockError::Ok]);
}

/// A value that could not be stored is not set: the answer reports it, and the same request again is a change again.
#[test]
fn the_answer_to_a_set_waits_until_it_is_stored() {
    let mut rig = Rig::new(config());
    let ip_before = rig.device.ip;
    rig.device.confirm_stores();
    let both = [Value::Name(b"other"), Value::Ip(suite(9)), Value::Signal(0x0100)];
    for stored in [false, true] {
        rig.now += Duration::from_secs(4);
        assert_eq!(set_from(&mut rig, TOOL, Qualifier::PERMANENT, &both), []);
        assert_eq!((rig.device.name(), rig.device.ip), ("other", suite(9)));
        // the repeat of a request that is being executed is not another one
        assert_eq!(set_from(&mut rig, TOOL, Qualifier::PERMANENT, &both), []);
        rig.device.answer_set(rig.now, stored);
        let payload = answer(&rig.drain(), TOOL).expect("an answer");
        let pdu = Pdu::parse(&payload).unwrap();
        let results: Vec<BlockError> = pdu
            .blocks()
            .map(|block| block.unwrap().result().unwrap().1)
            .collect();
        let expected = if stored {
            BlockError::Ok
        } else {
            BlockError::Resource
        };
        assert_eq!(results, [expected, expected, BlockError::Ok]);
        let now = if stored {
            ("other", suite(9))
        } else {
            ("drive-1", ip_before)
        };
        assert_eq!((rig.device.name(), rig.device.ip), now);
    }
    // nothing changes: nothing is stored, and nothing waits
    rig.now += Duration::from_secs(4);
    let again = set_from(&mut rig, TOOL, Qualifier::PERMANENT, &both[..1]);
    assert_eq!(again, [BlockError::Ok]);
    rig.device.answer_set(rig.now, false);
    assert_eq!(rig.device.name(), "other");
}

#[test]
fn a_flood_of_identify_requests_leaves_few_answers_waiting() {
    let mut rig = Rig::new(config());
    for _ in 0..100 {
        // the end of the MAC address makes the answer wait
        assert_eq!(identify(&mut rig, 6400, &[Value::Name(b"drive-1")]), None);
    }
    assert_eq!(rig.device.delayed.len(), 8);
}

#[test]
fn a_set_of_very_many_blocks_is_ignored() {
    let mut rig = Rig::new(config());
    let values = vec![Value::Signal(0x0100); 65];
    let set = |rig: &mut Rig, values: &[Value<'_>]| set_from(rig, TOOL, Qualifier::PERMANENT, values).len();
    assert_eq!(set(&mut rig, &values), 0);
    assert_eq!(set(&mut rig, &values[..64]), 64);
}

#[test]
fn a_get_of_very_many_options_is_answered_as_far_as_a_frame_goes() {
    let mut rig = Rig::new(config());
    let mut payload = Vec::new();
    let mut pdu = PduWriter::new(&mut payload, ServiceId::Get, ServiceType::Request, 1, 0);
    for number in 1..=200 {
        pdu.request(DcpOption::new(9, number));
    }
    pdu.finish();
    let answer = ask(&mut rig, TOOL, DEVICE, FrameId::DCP_GET_SET, &payload).unwrap();
    let refused = |number| (DcpOption::new(9, number), BlockError::OptionUnsupported);
    let answered: Vec<_> = Pdu::parse(&answer)
        .unwrap()
        .blocks()
        .map(|block| block.unwrap().result().unwrap())
        .collect();
    assert_eq!(answered, (1..=64).map(refused).collect::<Vec<_>>());
}

#[test]
fn a_name_of_240_octets_is_the_longest() {
    let mut rig = Rig::new(config());
    let label = "a".repeat(63);
    let longest = [&label[..], &label, &label, &label[..48]].join(".");
    assert_eq!(longest.len(), 240);
    let mut set = |name: &str| set(&mut rig, Qualifier::PERMANENT, Value::Name(name.as_bytes()));
    assert_eq!(set(&longest), BlockError::Ok);
    assert_eq!(set(&alloc::format!("{longest}a")), BlockError::NotSet);
    assert_eq!(rig.device.name(), longest);
}
