//! Connect to data exchange, release, and every way an AR ends.

use super::*;
use crate::wire::block::{ModuleState, SubmoduleState};

#[test]
fn a_controller_comes_up_exchanges_data_and_leaves() {
    for (order, legacy) in [
        (ByteOrder::Big, false),
        (ByteOrder::Little, false),
        (ByteOrder::Little, true),
    ] {
        let mut rig = Rig::new(config());
        rig.order = order;
        let wish = if legacy {
            Wish::controller(1).legacy()
        } else {
            Wish::controller(1)
        };
        let response = rig.connect(&wish).unwrap();
        assert_eq!(response.ar.ar_uuid, wish.ar.ar_uuid);
        assert_eq!(response.ar.responder_mac, DEVICE);
        let frame_ids: Vec<u16> = response.iocrs.iter().map(|iocr| iocr.frame_id).collect();
        assert_eq!(
            frame_ids,
            if legacy {
                [0xC010, 0xC000]
            } else {
                [0x8010, 0x8000]
            }
        );
        assert_eq!(response.diff, None);
        assert_eq!(
            response.server.as_ref().map(|server| server.station_name.clone()),
            (!legacy).then(|| b"drive-1".to_vec())
        );
        assert_eq!(response.alarm_cr.unwrap().max_alarm_data_length, 200);
        let ar = rig.device.controller().unwrap();
        let kind = ArKind::IoController;
        assert_eq!(
            rig.events(),
            [Event::Connected {
                ar,
                kind,
                station: "plc".into()
            }]
        );
        assert_eq!(rig.device.send_interval().unwrap().as_millis(), 16);
        assert_eq!(rig.device.watchdog().unwrap().as_millis(), 48);

        // input frames go out from now on: first at once, then every 16 ms
        assert_eq!(rig.device.next_cycle(), Some(Instant::ZERO));
        let frames = rig.pass(40);
        assert_eq!(frames.len(), 3);
        let Sent::Frame(frame) = &frames[0] else {
            panic!("no frame")
        };
        let frame = Frame::parse(frame).unwrap();
        assert_eq!((frame.destination, frame.frame_id.0), (CONTROLLER, frame_ids[0]));
        // access point good, telegram bad until the application reports otherwise, its outputs can be used
        assert_eq!(frame.payload[..10], [0x80, 0x80, 0x80, 0, 0, 0, 0, 0, 0x80, 0]);

        let mut provider = outputs(&wish, &response, rig.now);
        if !legacy {
            assert!(rig.device.output(1, 1).is_none());
        }
        rig.output(&mut provider);
        assert_eq!(rig.events(), [Event::ProviderState { ar, run: true }]);
        assert_eq!(rig.device.output(1, 1), Some((&[0, 0, 0, 0][..], Iops::GOOD)));
        assert!(!rig.device.application_ready(rig.now, ar));
        assert_eq!(rig.prm_end(&wish), PnioStatus::OK);
        assert_eq!(rig.events(), [Event::ParameterEnd { ar }]);
        assert_eq!(rig.prm_end(&wish), PnioStatus::control(0x3D, 0));
        assert!(rig.device.set_input(1, 1, &[1, 2, 3, 4], Iops::GOOD));
        assert!(!rig.device.set_input(1, 1, &[1, 2, 3], Iops::GOOD));
        assert!(rig.device.application_ready(rig.now, ar));
        assert!(!rig.device.application_ready(rig.now, ar));
        let sent = rig.drain();
        let (header, body) = ready_request(&sent).unwrap();
        assert_eq!(header.interface, Uuid::CONTROLLER_INTERFACE);
        assert_eq!(header.object, wish.ar.initiator_object);
        assert_eq!((header.operation, header.sequence), (operation::CONTROL, 0));
        assert_eq!(body.len(), 20 + 32);
        rig.confirm(&wish, &sent);
        assert!(!rig.device.is_exchanging());
        rig.output(&mut provider);
        assert_eq!(rig.events(), [Event::DataExchange { ar }]);

        // the CMI time no longer runs; stop and run of the controller are reported
        for _ in 0..2000 {
            rig.device.handle_timeout(rig.now);
            rig.drain();
            rig.output(&mut provider);
        }
        assert!(rig.device.is_exchanging());
        provider.set_status(crate::wire::rt::DataStatus::STOP);
        rig.output(&mut provider);
        assert_eq!(rig.events(), [Event::ProviderState { ar, run: false }]);
        assert!(!rig.device.provider_running());

        assert_eq!(rig.release(&wish), PnioStatus::OK);
        let cause = PnioStatus::aborted(abort::RELEASED);
        assert_eq!(rig.events(), [Event::Disconnected { ar, cause }]);
        assert_eq!((rig.device.controller(), rig.device.next_cycle()), (None, None));
        assert_eq!(rig.release(&wish), PnioStatus::release(0x40, 5));
    }
}

#[test]
fn a_repeated_connect_is_answered_from_the_cache() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    let pdu = rig.request(operation::CONNECT, &wish.blocks());
    rig.send(&pdu);
    let first = rig.response();
    assert!(first.0.is_ok());
    rig.send(&pdu);
    assert_eq!(rig.response(), first);
    assert_eq!(rig.events().len(), 1);
}

#[test]
fn blocks_behind_the_first_come_in_any_order() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    let mut blocks = Vec::new();
    wish.ar.encode(&mut blocks);
    ExpectedModule::encode_block(&wish.modules, &mut blocks);
    wish.alarm_crs[0].encode(&mut blocks);
    wish.iocrs[1].encode(&mut blocks);
    wish.iocrs[0].encode(&mut blocks);
    let (status, blocks) = rig.call(operation::CONNECT, &blocks);
    assert_eq!(status, PnioStatus::OK);
    let response = ConnectResponse::decode(Reader::new(&blocks)).unwrap();
    // the answers keep the order of the request
    assert_eq!(response.iocrs[0].reference, 2);
}

#[test]
fn the_controller_decides_what_is_plugged() {
    let mut rig = Rig::new(config());
    assert_eq!(rig.device.plugged(1), Some(TELEGRAM_1));
    let mut wish = Wish::controller(1);
    wish.modules[1].ident = TELEGRAM_2;
    wish.modules[1].submodules[0] = ExpectedSubmodule::new(1, 0x12, 8, 8);
    let (input, output) = pack(&sizes(&wish.modules)).unwrap();
    wish.iocrs[0].apis = apis(&input);
    wish.iocrs[1].apis = apis(&output);
    assert_eq!(rig.connect(&wish).unwrap().diff, None);
    assert_eq!(rig.device.plugged(1), Some(TELEGRAM_2));
    assert!(rig.device.set_input(1, 1, &[0; 8], Iops::GOOD));
}

#[test]
fn a_wrong_module_is_reported_not_refused() {
    let mut rig = Rig::new(config());
    let mut wish = Wish::controller(1);
    wish.modules[1].ident = 0x999;
    wish.modules[0].submodules[2].ident = 0x77;
    let diff = rig.connect(&wish).unwrap().diff.unwrap();
    assert_eq!(diff.modules.len(), 2);
    let (dap, drive) = (&diff.modules[0], &diff.modules[1]);
    assert_eq!((dap.slot, dap.ident, dap.state), (0, 1, ModuleState::PROPER));
    let port = dap.submodules[0];
    assert_eq!(
        (port.subslot, port.ident, port.state),
        (0x8001, 3, SubmoduleState::WRONG)
    );
    assert_eq!(
        (drive.slot, drive.ident, drive.state),
        (1, TELEGRAM_1, ModuleState::WRONG)
    );
    assert!(drive.submodules.is_empty());
    // neither provided nor consumed
    assert!(!rig.device.set_input(1, 1, &[0; 4], Iops::GOOD));
    let Sent::Frame(frame) = &rig.pass(0)[0] else {
        panic!("no frame")
    };
    let frame = Frame::parse(frame).unwrap();
    assert_eq!(frame.payload[..9], [0x80, 0x80, 0, 0, 0, 0, 0, 0, 0]);
    // the difference is read back and goes out with ApplicationReady too
    let ar = rig.device.controller().unwrap();
    let record = rig.read(wish.ar.ar_uuid, 0, 0, 0, 0xE002).unwrap();
    assert_eq!(record[..2], [0x81, 0x04]);
    assert_eq!(rig.prm_end(&wish), PnioStatus::OK);
    assert!(rig.device.application_ready(rig.now, ar));
    let (_, body) = ready_request(&rig.drain()).unwrap();
    assert_eq!(body[52..], record);
}

#[test]
fn a_controller_that_never_confirms_is_given_up() {
    let mut rig = Rig::new(config());
    let mut wish = Wish::controller(1);
    wish.ar.activity_timeout_factor = 1000;
    rig.connect(&wish).unwrap();
    rig.prm_end(&wish);
    let ar = rig.device.controller().unwrap();
    rig.device.application_ready(rig.now, ar);
    let sent = rig.pass(7000);
    let sends = sent
        .iter()
        .filter(|s| matches!(s, Sent::Datagram(_, CLIENT_PORT, _)))
        .count();
    assert_eq!(sends, 3);
    let cause = PnioStatus::aborted(abort::CONTROL_ERROR);
    assert_eq!(last_word(&sent), Some(cause));
    assert_eq!(disconnected(&rig.events()), Some(cause));
}

#[test]
fn an_answer_without_confirmation_ends_the_ar() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    rig.connect(&wish).unwrap();
    rig.prm_end(&wish);
    let ar = rig.device.controller().unwrap();
    rig.device.application_ready(rig.now, ar);
    let sent = rig.drain();
    rig.confirm(&Wish::controller(2), &sent);
    assert_eq!(
        disconnected(&rig.events()),
        Some(PnioStatus::aborted(abort::CONTROL_ERROR))
    );
}

#[test]
fn start_up_that_stands_still_times_out() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    rig.connect(&wish).unwrap();
    rig.pass(9_000);
    // a read is activity
    rig.read(wish.ar.ar_uuid, 0, 0, 1, 0xAFF0).unwrap();
    rig.pass(9_000);
    assert!(rig.device.controller().is_some());
    let sent = rig.pass(1_100);
    let cause = PnioStatus::aborted(abort::ACTIVITY_TIMEOUT);
    assert_eq!(last_word(&sent), Some(cause));
    assert_eq!(disconnected(&rig.events()), Some(cause));
}

#[test]
fn outputs_may_pause_in_advanced_start_up_but_not_in_legacy() {
    for legacy in [false, true] {
        let mut rig = Rig::new(config());
        let wish = if legacy {
            Wish::controller(1).legacy()
        } else {
            Wish::controller(1)
        };
        let response = rig.connect(&wish).unwrap();
        let mut provider = outputs(&wish, &response, rig.now);
        rig.output(&mut provider);
        rig.pass(100);
        let expected = legacy.then(|| PnioStatus::aborted(abort::DATA_HOLD));
        assert_eq!(disconnected(&rig.events()), expected);
        if !legacy {
            rig.output(&mut provider);
            assert!(rig.device.output(1, 1).is_some());
        }
    }
}

#[test]
fn a_lost_controller_is_noticed_after_the_data_hold_time() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    rig.exchange(&wish);
    rig.pass(47);
    assert!(rig.device.is_exchanging());
    let sent = rig.pass(1);
    let cause = PnioStatus::aborted(abort::DATA_HOLD);
    assert_eq!(last_word(&sent), Some(cause));
    assert_eq!(disconnected(&rig.events()), Some(cause));
    assert!(rig.device.output(1, 1).is_none());
    // it stays where it was and can be connected again
    assert_eq!(rig.device.name(), "drive-1");
    assert!(rig.connect(&Wish::controller(2)).is_ok());
    let log = rig.read(Uuid::NIL, 0, 0, 0, 0xF830).unwrap();
    let log = crate::wire::record::LogData::decode(Reader::new(&log)).unwrap();
    assert_eq!(log.entries.len(), 1);
    assert_eq!(
        (log.entries[0].status, log.entries[0].ar_uuid),
        (cause, wish.ar.ar_uuid)
    );
}

#[test]
fn a_controller_that_restarts_takes_its_place_again() {
    let mut rig = Rig::new(config());
    rig.exchange(&Wish::controller(1));
    let pdu = rig.request(operation::CONNECT, &Wish::controller(2).blocks());
    rig.send(&pdu);
    let sent = rig.drain();
    let cause = PnioStatus::aborted(abort::RERUN);
    assert_eq!(last_word(&sent), Some(cause));
    assert_eq!(disconnected(&rig.events()), Some(cause));
    assert!(rig.device.controller().is_some());
}

#[test]
fn a_second_controller_finds_no_place() {
    let mut rig = Rig::new(config());
    let mut provider = rig.exchange(&Wish::controller(1));
    let mut other = Wish::controller(2);
    other.ar.initiator_mac = MacAddress([2, 9, 9, 9, 9, 9]);
    assert_eq!(rig.connect(&other), Err(PnioStatus::connect(0x40, 4)));
    // nor does one that pretends to be the first from elsewhere
    rig.from = SocketAddrV4::new(STRANGER, 50_000);
    assert_eq!(
        rig.connect(&Wish::controller(2)),
        Err(PnioStatus::connect(0x40, 4))
    );
    assert_eq!(
        rig.connect(&Wish::controller(1)),
        Err(PnioStatus::connect(0x3D, 0))
    );
    rig.output(&mut provider);
    assert!(rig.device.is_exchanging());
    // the first itself, in a new call with its old UUID, has lost count
    rig.from = SocketAddrV4::new(HOST, 50_000);
    assert_eq!(
        rig.connect(&Wish::controller(1)),
        Err(PnioStatus::connect(0x3D, 0))
    );
    assert_eq!(
        disconnected(&rig.events()),
        Some(PnioStatus::aborted(abort::RERUN))
    );
    assert!(rig.connect(&Wish::controller(3)).is_ok());
}

#[test]
fn tools_come_beside_the_controller_up_to_the_limit() {
    let mut rig = Rig::new(config());
    let mut provider = rig.exchange(&Wish::controller(1));
    for uuid in 10..14 {
        let response = rig.connect(&Wish::tool(uuid)).unwrap();
        assert!(response.iocrs.is_empty() && response.alarm_cr.is_none());
    }
    assert_eq!(rig.connect(&Wish::tool(14)), Err(PnioStatus::connect(0x40, 4)));
    assert_eq!(rig.prm_end(&Wish::tool(10)), PnioStatus::control(0x3D, 0));
    assert_eq!(rig.release(&Wish::tool(10)), PnioStatus::OK);
    assert_eq!(rig.events().len(), 5);
    // three expire silently, the fourth is kept alive by its trigger
    assert!(rig.connect(&Wish::tool(14)).is_ok());
    rig.events();
    for _ in 0..3 {
        for _ in 0..250 {
            rig.device.handle_timeout(rig.now);
            rig.drain();
            rig.output(&mut provider);
        }
        assert_eq!(rig.read(Uuid([14; 16]), 0, 0, 0, 0xFBFF), Ok(vec![]));
    }
    let events = rig.events();
    assert_eq!(events.len(), 3);
    assert_eq!(
        disconnected(&events),
        Some(PnioStatus::aborted(abort::ACTIVITY_TIMEOUT))
    );
    assert_eq!(rig.release(&Wish::tool(14)), PnioStatus::OK);
    assert!(rig.device.is_exchanging());
}

#[test]
fn a_tool_that_crashed_does_not_keep_its_next_life_out() {
    let mut rig = Rig::new(config());
    let from = |station: &str, uuid| {
        let mut wish = Wish::tool(uuid);
        wish.ar.station_name = station.as_bytes().to_vec();
        wish.ar.station_name_length = station.len() as u16;
        wish
    };
    for uuid in 10..14 {
        rig.connect(&from("tool", uuid)).unwrap();
        rig.pass(500);
    }
    // 500 ms ago the youngest was made, 2 s ago the oldest
    rig.events();
    assert!(rig.connect(&from("tool", 14)).is_ok());
    assert_eq!(
        disconnected(&rig.events()),
        Some(PnioStatus::aborted(abort::RERUN))
    );
    assert_eq!(rig.read(Uuid([10; 16]), 0, 0, 0, 0xFBFF), Err(UNKNOWN_AR));
    for uuid in 11..15 {
        assert_eq!(rig.read(Uuid([uuid; 16]), 0, 0, 0, 0xFBFF), Ok(vec![]));
    }
    // all of them gave a sign of life just now
    assert_eq!(rig.connect(&from("tool", 15)), Err(PnioStatus::connect(0x40, 4)));
}

#[test]
fn a_tool_that_was_silent_for_half_its_time_makes_room_for_another_one() {
    let mut rig = Rig::new(config());
    for uuid in 10..14 {
        rig.connect(&Wish::tool(uuid)).unwrap();
    }
    let mut other = Wish::tool(20);
    other.ar.initiator_mac = MacAddress([2, 0, 0, 0, 0, 99]);
    // the activity time is 10 s; three of four keep themselves alive
    rig.pass(4_900);
    assert_eq!(rig.connect(&other), Err(PnioStatus::connect(0x40, 4)));
    for uuid in [10, 11, 13] {
        assert_eq!(rig.read(Uuid([uuid; 16]), 0, 0, 0, 0xFBFF), Ok(vec![]));
    }
    rig.pass(200);
    rig.events();
    assert!(rig.connect(&other).is_ok());
    assert_eq!(
        disconnected(&rig.events()),
        Some(PnioStatus::aborted(abort::ACTIVITY_TIMEOUT))
    );
    assert_eq!(rig.read(Uuid([12; 16]), 0, 0, 0, 0xFBFF), Err(UNKNOWN_AR));
    other.ar.ar_uuid = Uuid([21; 16]);
    assert_eq!(rig.connect(&other), Err(PnioStatus::connect(0x40, 4)));
}

#[test]
fn a_tool_whose_record_is_worked_on_is_not_pushed_out() {
    let mut config = config();
    config.max_device_access = 1;
    let mut rig = Rig::new(config);
    let wish = Wish::tool(1);
    rig.connect(&wish).unwrap();
    let pdu = rig.write_pdu(wish.ar.ar_uuid, DRIVE_API, (1, 1, 0xB02E), b"0123456789");
    rig.send(&pdu);
    rig.pass(6_000);
    assert_eq!(rig.connect(&Wish::tool(2)), Err(PnioStatus::connect(0x40, 4)));
}

/// DE 81 40 05.
const UNKNOWN_AR: PnioStatus = PnioStatus::new(0xDE, 0x81, 0x40, 5);

#[test]
fn an_error_of_the_controller_ends_the_ar_without_an_answer() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    rig.exchange(&wish);
    let config = *rig.device.controller.as_ref().unwrap().alarms.config();
    let cause = PnioStatus::aborted(0x11);
    let mut frame = [0; 100];
    let theirs = crate::alarm::AlarmConfig {
        local: config.peer,
        peer: config.local,
        local_reference: config.peer_reference,
        peer_reference: config.local_reference,
        ..config
    };
    // a station that claims to be the controller but lacks its AR
    for spoiled in [
        crate::alarm::AlarmConfig {
            local: MacAddress([2, 9, 9, 9, 9, 9]),
            ..theirs
        },
        crate::alarm::AlarmConfig {
            peer_reference: theirs.peer_reference + 1,
            ..theirs
        },
    ] {
        let length = crate::alarm::emit_error(&mut frame, &spoiled, cause).unwrap();
        rig.device.handle_frame(rig.now, &frame[..length]);
        assert!(rig.device.is_exchanging());
    }
    let length = crate::alarm::emit_error(&mut frame, &theirs, cause).unwrap();
    rig.device.handle_frame(rig.now, &frame[..length]);
    assert_eq!(disconnected(&rig.events()), Some(cause));
    assert!(rig.drain().is_empty());
}
