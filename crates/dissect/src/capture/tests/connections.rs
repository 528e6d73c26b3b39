//! Calls, connects, cyclic data.

use profinet::wire::block::{
    BlockType, ControlBlock, ControlCommand, DiffModule, DiffSubmodule, ModuleDiff, ModuleState,
    SubmoduleState,
};
use profinet::wire::rt::DataStatus;

use super::*;

const GOOD: u8 = DataStatus::GOOD.0;
/// STW1 0x047E with provider status good.
const STW1: [u8; 5] = [0x04, 0x7E, 0, 0, 0x80];

fn control(command: ControlCommand, block: BlockType) -> Vec<u8> {
    let mut blocks = Vec::new();
    ControlBlock::new(block, Uuid([9; 16]), 1, command).encode(&mut blocks);
    blocks
}

fn release() -> Vec<u8> {
    control(ControlCommand::RELEASE, BlockType::RELEASE)
}

#[test]
fn the_same_call_a_minute_later_is_another_connection() {
    let mut capture = Capture::default();
    let call = Call::new(operation::CONNECT);
    let (request, response) = (
        call.request(&connect_blocks(9)),
        call.response(0, &connected_blocks(9, None)),
    );
    let first = capture.at(0, &request).len() + capture.at(10, &response).len();
    assert_eq!(first, 5, "{:?}", capture.events);
    assert_eq!(capture.at(60_000, &request).len(), 4);
    assert_eq!(capture.at(60_010, &response).len(), 1);
    assert_eq!(capture.trouble(), [""; 0]);
}

#[test]
fn another_request_with_the_number_of_a_call_is_no_repetition() {
    let mut capture = Capture::default();
    let call = Call::new(operation::CONNECT);
    capture.at(0, &call.request(&connect_blocks(9)));
    capture.at(10, &call.response(0, &connected_blocks(9, None)));
    assert_eq!(capture.at(500, &call.request(&connect_blocks(8))).len(), 4);
}

#[test]
fn a_repetition_is_reported_with_the_answer_and_without_one() {
    let mut capture = Capture::default();
    let call = Call::new(operation::RELEASE);
    assert_eq!(capture.at(0, &call.request(&release())), ["release"]);
    assert_eq!(capture.at(2000, &call.request(&release())), [""; 0]);
    assert_eq!(
        capture.at(2500, &call.response(0, &release())),
        ["release: answered after 2.5 s, sent 2 times"]
    );
    let other = Call { sequence: 1, ..call };
    capture.at(10_000, &other.request(&release()));
    capture.at(12_000, &other.request(&release()));
    assert_eq!(capture.wait(21_999), [""; 0]);
    assert_eq!(
        capture.wait(22_000),
        ["release: no answer within 12 s, sent 2 times"]
    );
    let event = capture.last();
    assert_eq!(
        (event.frame, event.weight),
        (4, Weight::Error),
        "the frame of the request"
    );
    let expected = Trouble::Unanswered {
        what: "release".into(),
        sent: 2,
        waited: Duration::from_secs(12),
    };
    assert_eq!(event.detail, Detail::Trouble(expected));
}

#[test]
fn the_end_of_a_capture_leaves_requests_without_an_answer() {
    let mut capture = Capture::default();
    capture.at(0, &Call::new(operation::RELEASE).request(&release()));
    let second = Call {
        sequence: 1,
        ..Call::new(operation::RELEASE)
    };
    capture.at(990, &second.request(&release()));
    capture.wait(1000);
    // the answer to the second may have come right after
    assert_eq!(capture.end(), ["release: no answer within 1 s"]);
}

#[test]
fn an_answer_without_its_request_is_reported_with_its_status() {
    let mut capture = Capture::default();
    let call = Call::new(operation::CONNECT);
    let texts = capture.at(0, &call.response(0xDB81_0104, &[]));
    assert_eq!(texts[0], "answer to a connect that is not in the capture");
    assert!(texts[1].starts_with("connect refused: "), "{texts:?}");
}

#[test]
fn the_same_activity_towards_two_devices_is_two_calls() {
    let mut capture = Capture::default();
    let call = Call::new(operation::RELEASE);
    for server in [2, 2, 3] {
        capture.at(0, &Call { server, ..call }.request(&release()));
    }
    let to: Vec<_> = capture.events.iter().map(|event| event.to.as_str()).collect();
    assert_eq!(to, ["10.0.0.2", "10.0.0.3"], "a repetition is one call");
}

#[test]
fn inputs_before_the_answer_belong_to_the_connect() {
    let mut capture = Capture::default();
    let call = Call::new(operation::CONNECT);
    capture.at(0, &call.request(&connect_blocks(9)));
    let input = |counter| cyclic(DRIVE, PLC, INPUTS, &[0x02, 0x40, 0, 0, 0x80], counter, GOOD);
    let texts = capture.at(1, &input(0));
    assert_eq!(texts[0], "first cyclic data: RUN, valid");
    assert!(texts[1].starts_with("ZSW1 0x0240 "), "{texts:?}");
    capture.at(2, &call.response(0, &connected_blocks(9, None)));
    assert_eq!(capture.at(5, &input(128)), [""; 0], "the same connection");
    capture.at(6, &cyclic(PLC, DRIVE, OUTPUTS, &STW1, 0, GOOD));
    let counts = capture.walker.counts();
    assert_eq!((counts.cyclic, counts.cyclic_unknown), (3, 0));
    assert_eq!(capture.walker.summary()[0].restarts, 0);
}

#[test]
fn data_that_are_bad_until_a_station_is_ready_are_no_trouble_and_lasting_or_later_ones_are() {
    let input = |at: u64, iops: u8| {
        let counter = u16::try_from(at * 32 % 65_536).expect("small");
        cyclic(DRIVE, PLC, INPUTS, &[0x02, 0x40, 0, 0, iops], counter, GOOD)
    };
    // each 4 ms, bad until `ready`
    let marked = |ready: u64, end: u64| {
        let mut capture = Capture::default();
        connect(&mut capture, 0);
        let mut texts = Vec::new();
        for at in (4..end).step_by(4) {
            let iops = if at < ready { 0 } else { 0x80 };
            let found = capture.at(at, &input(at, iops));
            texts.extend(found.into_iter().filter(|text| text.starts_with("slot 1: data")));
        }
        (capture, texts)
    };
    let (mut capture, texts) = marked(2000, 4000);
    assert_eq!(texts, [""; 0]);
    // later in the connection it is reported at once
    let texts = capture.at(4000, &input(4000, 0));
    assert_eq!(texts.len(), 1, "{texts:?}");
    assert!(texts[0].starts_with("slot 1: data marked "), "{texts:?}");
    assert_eq!(capture.last().weight, Weight::Warning);
    assert_eq!(capture.at(4004, &input(4004, 0)), [""; 0], "once");
    assert_eq!(capture.at(4008, &input(4008, 0x80)), ["slot 1: data good"]);
    // and where no data are good for long
    let (_, texts) = marked(3500, 4000);
    assert_eq!(texts.len(), 2, "{texts:?}");
    assert!(
        texts[0].contains("marked") && texts[1] == "slot 1: data good",
        "{texts:?}"
    );
}

#[test]
fn frames_belong_to_their_sender_and_to_none_after_release() {
    let mut capture = Capture::default();
    connect(&mut capture, 0);
    let input = |from| cyclic(from, PLC, INPUTS, &[0x02, 0x40, 0, 0, 0x80], 0, GOOD);
    assert_eq!(capture.at(2, &input(DRIVE)).len(), 2);
    assert_eq!(capture.at(3, &input(3)), [""; 0], "another device");
    assert_eq!(capture.walker.counts().cyclic_unknown, 1);
    let call = Call {
        sequence: 1,
        ..Call::new(operation::RELEASE)
    };
    capture.at(4, &call.request(&release()));
    capture.at(5, &call.response(0, &release()));
    assert_eq!(capture.at(6, &cyclic(DRIVE, PLC, INPUTS, &[], 128, 0)), [""; 0]);
    assert_eq!(capture.wait(2000), [""; 0], "its silence is no loss");
}

#[test]
fn a_connection_that_began_before_the_capture_is_described() {
    let mut capture = Capture::default();
    let input = |at: u64| {
        let counter = u16::try_from(at / 16 * 512 % 65_536).expect("small");
        cyclic(DRIVE, PLC, 0x8003, &[], counter, 0x15)
    };
    for at in [0, 16] {
        assert_eq!(capture.at(at, &input(at)), [""; 0]);
    }
    assert_eq!(
        capture.at(32, &input(32)),
        [
            "connection that began before the capture: FrameID 0x8003, at most 40 octets of data every 16 ms; RUN, valid, \
             station reports a problem"
        ]
    );
    assert!(matches!(&capture.last().detail, Detail::Connect(connect) if connect.step == "earlier"));
    assert_eq!(capture.at(48, &input(48)), [""; 0]);
    // it is accepted again: that is a restart
    connect(&mut capture, 60);
    capture.at(62, &cyclic(DRIVE, PLC, INPUTS, &[], 0, GOOD));
    let summary = capture.walker.summary();
    assert_eq!(
        (summary[0].restarts, summary[0].streams[0].cycle),
        (1, Duration::from_millis(4))
    );
}

#[test]
fn what_the_capturing_computer_missed_is_not_lost_nor_silence() {
    let mut capture = Capture::default();
    connect(&mut capture, 0);
    let frame = |cycle: u16| {
        let counter = cycle.wrapping_mul(128);
        cyclic(DRIVE, PLC, INPUTS, &[0x02, 0x40, 0, 0, 0x80], counter, GOOD)
    };
    for cycle in 0..20 {
        capture.at(4 + 4 * u64::from(cycle), &frame(cycle));
    }
    // frames of a second are not there
    capture.walker.skip_to(Duration::from_millis(1000));
    for cycle in 249..260 {
        capture.at(4 + 4 * u64::from(cycle), &frame(cycle));
    }
    assert_eq!(capture.trouble(), [""; 0]);
    let summary = capture.walker.summary();
    let stream = &summary[0].streams[0];
    assert_eq!((stream.frames, stream.lost), (31, 0));
    assert_eq!(stream.longest_gap, Duration::from_millis(4));
    // from then on silence counts again
    capture.wait(1500);
    assert_eq!(capture.trouble().len(), 1, "{:?}", capture.trouble());
}

#[test]
fn lost_frames_and_silence_are_reported_and_summed_up() {
    let mut capture = Capture::default();
    connect(&mut capture, 0);
    // 4 ms each, then two are missing, then nothing for longer than the watchdog
    let mut at = 4;
    for cycle in 0..200_u16 {
        if [50, 51].contains(&cycle) {
            at += 4;
            continue;
        }
        at += if cycle == 150 { 40 } else { 4 };
        let counter = cycle.wrapping_mul(128);
        capture.at(
            at,
            &cyclic(DRIVE, PLC, INPUTS, &[0x02, 0x40, 0, 0, 0x80], counter, GOOD),
        );
    }
    assert_eq!(
        capture.trouble(),
        [
            "2 cyclic frames lost",
            "no cyclic data for 40 ms since frame 150, watchdog 12 ms"
        ]
    );
    capture.wait(at + 500);
    assert_eq!(
        capture.last().text,
        "no cyclic data for 500 ms since frame 200, watchdog 12 ms"
    );
    assert_eq!(capture.last().frame, 200, "the last frame");
    let summary = capture.walker.summary();
    let stream = &summary[0].streams[0];
    assert_eq!((summary[0].mac, summary[0].connection_losses), (mac(DRIVE), 2));
    assert_eq!((stream.frames, stream.lost, stream.direction), (198, 2, "input"));
    assert_eq!(stream.longest_gap, Duration::from_millis(40));
    assert_eq!(stream.jitter_p50, Some(Duration::ZERO));
    capture.walker.restart_summary();
    assert!(capture.walker.summary().is_empty());
}

#[test]
fn a_diagnosis_in_a_module_difference_is_not_another_module() {
    let diff = |module, state| ModuleDiff {
        modules: vec![DiffModule {
            api: 0x3A00,
            slot: 1,
            ident: 5,
            state: module,
            submodules: vec![DiffSubmodule {
                subslot: 2,
                ident: 7,
                state,
            }],
        }],
    };
    let call = Call::new(operation::CONNECT);
    for (module, state, weight, text) in [
        (
            ModuleState::PROPER,
            SubmoduleState(0x8040),
            Weight::Warning,
            "slot 1 API 0x3A00: proper module 0x00000005; subslot 2 diagnosis pending (0x8040)",
        ),
        (
            ModuleState::PROPER,
            SubmoduleState::READY_PENDING,
            Weight::Normal,
            "slot 1 API 0x3A00: proper module 0x00000005; subslot 2 application ready pending (0x8080)",
        ),
        (
            ModuleState::PROPER,
            SubmoduleState::WRONG,
            Weight::Warning,
            "slot 1 API 0x3A00 differs: proper module, plugged is 0x00000005; subslot 2 wrong submodule (0x9000), plugged \
             is 0x7",
        ),
        // FormatIndicator 0: one number
        (
            ModuleState::PROPER,
            SubmoduleState(0x0001),
            Weight::Warning,
            "slot 1 API 0x3A00 differs: proper module, plugged is 0x00000005; subslot 2 wrong submodule (0x0001), plugged \
             is 0x7",
        ),
        (
            ModuleState::PROPER,
            SubmoduleState(0x0004),
            Weight::Normal,
            "slot 1 API 0x3A00: proper module 0x00000005; subslot 2 application ready pending (0x0004)",
        ),
        (
            ModuleState::PROPER,
            SubmoduleState::LOCKED_BY_CONTROLLER,
            Weight::Warning,
            "slot 1 API 0x3A00: proper module 0x00000005; subslot 2 locked by another controller (0x8180)",
        ),
    ] {
        let mut capture = Capture::default();
        capture.at(0, &call.request(&connect_blocks(9)));
        capture.at(
            1,
            &call.response(0, &connected_blocks(9, Some(diff(module, state)))),
        );
        assert_eq!(
            (capture.last().text.as_str(), capture.last().weight),
            (text, weight)
        );
    }

    // the same block in ApplicationReady
    let mut blocks = control(ControlCommand::APPLICATION_READY, BlockType(0x0112));
    diff(ModuleState::SUBSTITUTE, SubmoduleState::SUBSTITUTE).encode(&mut blocks);
    let ready = Call {
        client: DRIVE,
        server: PLC,
        ..Call::new(operation::CONTROL)
    };
    let mut capture = Capture::default();
    let texts = capture.at(0, &ready.request(&blocks));
    assert_eq!(texts[0], "application ready");
    assert!(
        texts[1].starts_with("slot 1 API 0x3A00 differs: substitute module"),
        "{texts:?}"
    );
}

#[test]
fn the_apis_of_a_connect_are_shown_and_its_numbers_are_typed() {
    let mut capture = Capture::default();
    let texts = capture.at(0, &Call::new(operation::CONNECT).request(&connect_blocks(9)));
    assert_eq!(
        texts[3],
        "expects slot 1 API 0x3A00 module 0x00000001, AKD telegram 1: subslot 1 0x1 (4 in, 4 out)"
    );
    let iocr = serde_json::to_value(&capture.events[1].detail).expect("JSON");
    assert_eq!(iocr["kind"], "connect");
    assert_eq!(
        (&iocr["data"]["cycle"], &iocr["data"]["watchdog"]),
        (&0.004.into(), &0.012.into())
    );
}

#[test]
fn words_and_speeds_are_numbers() {
    let mut capture = Capture::default();
    connect(&mut capture, 0);
    let fault = [0x02, 0x78, 0x20, 0x00, 0x80];
    capture.at(2, &cyclic(DRIVE, PLC, INPUTS, &[0x02, 0x40, 0, 0, 0x80], 0, GOOD));
    capture.at(6, &cyclic(DRIVE, PLC, INPUTS, &fault, 128, GOOD));
    let event = capture.last();
    let Detail::Fault(state) = &event.detail else {
        panic!("{event:?}");
    };
    assert_eq!(
        (state.word, state.before, state.value),
        ("ZSW1", Some(0x0240), 0x0278)
    );
    assert_eq!(event.weight, Weight::Error);
    assert_eq!(capture.walker.summary()[0].faults, 1);
}

/// Most frames of a capture are cyclic data in which nothing happens but a speed that moves.
#[test]
fn cyclic_data_without_an_event_is_decoded_without_allocation() {
    let mut capture = Capture::default();
    connect(&mut capture, 0);
    let frame = |cycle: u16| {
        let [high, low] = cycle.to_be_bytes();
        let data = [0x02, 0x40, high, low, 0x80];
        cyclic(DRIVE, PLC, INPUTS, &data, cycle.wrapping_mul(128), GOOD)
    };
    let frames: Vec<_> = (1..500_u16)
        .map(|cycle| (u64::from(cycle) * 4, frame(cycle)))
        .collect();
    let (first, rest) = frames.split_at(5);
    for (at, frame) in first {
        capture.at(*at, frame);
    }
    let mut events = 0;
    let made = allocations::made_by(|| {
        for (at, frame) in rest {
            events += capture.walker.frame(Duration::from_millis(*at), frame).len();
        }
    });
    assert_eq!((events, made), (0, 0));
}

/// Device and interface have no data: what stands for them in the cyclic data is their status.
#[test]
fn the_octets_of_submodules_without_data_are_named_by_their_status() {
    let mut asked = connect::request(profinet::wire::Reader::new(&connect_blocks(9))).expect("a connect");
    for iocr in &mut asked.iocrs {
        let object = |slot, subslot, offset| FrameObject {
            slot,
            subslot,
            offset,
        };
        iocr.apis[0].data.extend([object(0, 1, 5), object(0, 0x8000, 6)]);
        iocr.apis[0].status.push(object(1, 1, 7));
    }
    let mut blocks = Vec::new();
    asked.ar.as_ref().expect("an AR").encode(&mut blocks);
    asked.iocrs.iter().for_each(|iocr| iocr.encode(&mut blocks));
    ExpectedModule::encode_block(&asked.modules, &mut blocks);
    let mut capture = Capture::default();
    let call = Call::new(operation::CONNECT);
    capture.at(0, &call.request(&blocks));
    capture.at(1, &call.response(0, &connected_blocks(9, None)));
    let data = [&STW1[..], &[0x80, 0x80, 0x80]].concat();
    let frame = cyclic(DRIVE, PLC, INPUTS, &data, 1, GOOD);
    let tree = capture.walker.tree(&frame);
    let begin = 16;
    for (octet, name) in [
        (4, "IOPS of slot 1/1"),
        (5, "IOPS of slot 0/1"),
        (6, "IOPS of slot 0/0x8000"),
        (7, "IOCS of slot 1/1"),
    ] {
        let path = tree.path(begin + octet);
        let field = path.last().expect("a field");
        assert_eq!(
            (field.name.as_str(), field.octets()),
            (name, begin + octet..begin + octet + 1)
        );
        assert!(
            field.children.is_empty() && field.value.contains("good"),
            "{field:?}"
        );
    }
}
