//! Every rule of a connect, broken one at a time, with the exact error.

use super::*;

type Spoil = fn(&mut Wish);

/// What is spoiled, and ErrorCode1 and ErrorCode2 of the answer.
const RULES: &[(&str, Spoil, u8, u8)] = &[
    ("AR type", |w| w.ar.ar_type = ArType(0x10), 1, 4),
    (
        "supervisor with cyclic data",
        |w| w.ar.ar_type = ArType::SUPERVISOR,
        1,
        4,
    ),
    ("nil ARUUID", |w| w.ar.ar_uuid = Uuid::NIL, 1, 5),
    (
        "multicast MAC",
        |w| w.ar.initiator_mac = MacAddress([1, 0, 0, 0, 0, 0]),
        1,
        7,
    ),
    ("object UUID", |w| w.ar.initiator_object = Uuid([3; 16]), 1, 8),
    ("state", |w| w.ar.properties = ArProperties(0x4000_0012), 1, 9),
    (
        "parameter server",
        |w| w.ar.properties = ArProperties(0x4000_0001),
        1,
        9,
    ),
    ("companion", |w| w.ar.properties = ArProperties(0x4000_0211), 1, 9),
    (
        "device access of a controller",
        |w| w.ar.properties = ArProperties(0x111),
        1,
        9,
    ),
    ("activity 0", |w| w.ar.activity_timeout_factor = 0, 1, 10),
    ("activity 1001", |w| w.ar.activity_timeout_factor = 1001, 1, 10),
    (
        "no name",
        |w| (w.ar.station_name, w.ar.station_name_length) = (vec![], 0),
        1,
        12,
    ),
    (
        "name longer than its block",
        |w| w.ar.station_name_length = 4,
        1,
        1,
    ),
    (
        "name with a blank",
        |w| w.ar.station_name = b"a b".to_vec(),
        1,
        13,
    ),
    (
        "IOCR type",
        |w| w.iocrs[0].iocr_type = IocrType::MULTICAST_CONSUMER,
        2,
        4,
    ),
    ("IOCR reference", |w| w.iocrs[1].reference = 1, 2, 5),
    ("LT", |w| w.iocrs[0].lt = 0x0800, 2, 6),
    (
        "class 1 in advanced start-up",
        |w| w.iocrs[0].properties = 1,
        2,
        7,
    ),
    ("class 3", |w| w.iocrs[0].properties = 3, 2, 7),
    ("data length 39", |w| w.iocrs[0].data_length = 39, 2, 8),
    ("data length 1441", |w| w.iocrs[1].data_length = 1441, 2, 8),
    ("input FrameID left open", |w| w.iocrs[0].frame_id = 0xFFFF, 2, 9),
    ("FrameID of class 1", |w| w.iocrs[1].frame_id = 0xC000, 2, 9),
    ("send clock", |w| w.iocrs[0].send_clock_factor = 33, 2, 10),
    ("ratio", |w| w.iocrs[0].reduction_ratio = 3, 2, 11),
    ("ratio 1024", |w| w.iocrs[0].reduction_ratio = 1024, 2, 11),
    ("phase 0", |w| w.iocrs[0].phase = 0, 2, 12),
    ("phase 17", |w| w.iocrs[0].phase = 17, 2, 12),
    (
        "offset beyond the clock",
        |w| w.iocrs[0].frame_send_offset = 1_000_000,
        2,
        14,
    ),
    ("watchdog 0", |w| w.iocrs[0].watchdog_factor = 0, 2, 15),
    ("hold 0", |w| w.iocrs[1].data_hold_factor = 0, 2, 16),
    ("hold 1.936 s", |w| w.iocrs[1].data_hold_factor = 121, 2, 16),
    ("tag", |w| w.iocrs[0].tag_header = 0xC001, 2, 17),
    ("multicast", |w| w.iocrs[0].multicast = CONTROLLER, 2, 18),
    ("no API", |w| w.iocrs[0].apis.clear(), 2, 19),
    ("API twice", |w| w.iocrs[0].apis[1].api = 0, 2, 20),
    ("API not expected", |w| w.iocrs[0].apis[1].api = 7, 2, 20),
    (
        "data of an unknown slot",
        |w| w.iocrs[0].apis[1].data[0].slot = 9,
        2,
        22,
    ),
    (
        "data of an unknown subslot",
        |w| w.iocrs[0].apis[1].data[0].subslot = 9,
        2,
        23,
    ),
    (
        "data on other data",
        |w| w.iocrs[0].apis[1].data[0].offset = 0,
        2,
        24,
    ),
    (
        "data behind the end",
        |w| w.iocrs[0].apis[1].data[0].offset = 36,
        2,
        24,
    ),
    (
        "IOCS of an unknown slot",
        |w| w.iocrs[0].apis[1].status[0].slot = 9,
        2,
        26,
    ),
    (
        "IOCS of an unknown subslot",
        |w| w.iocrs[0].apis[1].status[0].subslot = 9,
        2,
        27,
    ),
    ("IOCS on data", |w| w.iocrs[0].apis[1].status[0].offset = 3, 2, 28),
    ("slot 0x8000", |w| w.modules[1].slot = 0x8000, 3, 6),
    (
        "slot twice",
        |w| (w.modules[1].api, w.modules[1].slot) = (0, 0),
        3,
        6,
    ),
    ("module ident 0", |w| w.modules[0].ident = 0, 3, 7),
    ("module properties", |w| w.modules[0].properties = 1, 3, 8),
    ("no submodule", |w| w.modules[1].submodules.clear(), 3, 9),
    ("subslot 0", |w| w.modules[1].submodules[0].subslot = 0, 3, 10),
    (
        "subslot 0xA000",
        |w| w.modules[0].submodules[0].subslot = 0xA000,
        3,
        10,
    ),
    ("subslot twice", |w| w.modules[0].submodules[1].subslot = 1, 3, 10),
    (
        "interface in the drive's API",
        |w| w.modules[1].submodules[0].subslot = 0x8000,
        3,
        10,
    ),
    (
        "discarded status",
        |w| w.modules[0].submodules[0].properties = 0x20,
        3,
        12,
    ),
    (
        "direction",
        |w| w.modules[1].submodules[0].data[1].direction = 1,
        3,
        13,
    ),
    (
        "data of none",
        |w| w.modules[0].submodules[0].data[0].length = 1,
        3,
        14,
    ),
    (
        "length 1440",
        |w| w.modules[1].submodules[0].data[0].length = 1440,
        3,
        14,
    ),
    (
        "IOPS length",
        |w| w.modules[1].submodules[0].data[0].iops_length = 2,
        3,
        15,
    ),
    (
        "IOCS length",
        |w| w.modules[1].submodules[0].data[0].iocs_length = 0,
        3,
        16,
    ),
    ("alarm type", |w| w.alarm_crs[0].alarm_cr_type = 2, 4, 4),
    ("alarm LT", |w| w.alarm_crs[0].lt = 0x800, 4, 5),
    ("alarms over UDP", |w| w.alarm_crs[0].properties = 2, 4, 6),
    ("RTA time 0", |w| w.alarm_crs[0].rta_timeout_factor = 0, 4, 7),
    ("RTA time 101", |w| w.alarm_crs[0].rta_timeout_factor = 101, 4, 7),
    ("RTA retries 2", |w| w.alarm_crs[0].rta_retries = 2, 4, 8),
    ("RTA retries 16", |w| w.alarm_crs[0].rta_retries = 16, 4, 8),
    (
        "alarm length 199",
        |w| w.alarm_crs[0].max_alarm_data_length = 199,
        4,
        10,
    ),
    (
        "alarm length 1433",
        |w| w.alarm_crs[0].max_alarm_data_length = 1433,
        4,
        10,
    ),
    ("alarm tag high", |w| w.alarm_crs[0].tag_high = 0, 4, 11),
    ("alarm tag low", |w| w.alarm_crs[0].tag_low = 0, 4, 12),
    ("no output", |w| drop(w.iocrs.pop()), 0x40, 2),
    ("no alarms", |w| w.alarm_crs.clear(), 0x40, 3),
    ("two alarms", |w| w.alarm_crs.push(w.alarm_crs[0]), 0x40, 3),
];

#[test]
fn every_broken_rule_has_its_error() {
    for (what, spoil, code1, code2) in RULES {
        let mut rig = Rig::new(config());
        let mut wish = Wish::controller(1);
        spoil(&mut wish);
        assert_eq!(
            rig.connect(&wish),
            Err(PnioStatus::connect(*code1, *code2)),
            "{what}"
        );
        assert!(
            rig.device.controller().is_none() && rig.events().is_empty(),
            "{what}"
        );
    }
}

#[test]
fn limits_themselves_are_good() {
    let good: &[Spoil] = &[
        |w| w.ar.activity_timeout_factor = 1000,
        |w| w.iocrs[1].data_hold_factor = 120,
        |w| w.iocrs[0].frame_send_offset = 999_999,
        |w| w.iocrs[0].phase = 16,
        |w| w.iocrs[1].frame_id = 0x8123,
        |w| w.iocrs[0].data_length = 1440,
        |w| w.alarm_crs[0].max_alarm_data_length = 1432,
        |w| w.ar.properties = ArProperties(0x11),
    ];
    for spoil in good {
        let mut wish = Wish::controller(1);
        spoil(&mut wish);
        assert!(Rig::new(config()).connect(&wish).is_ok());
    }
    // a faster cycle than the device can do
    let mut slow = config();
    slow.min_device_interval = 512;
    assert!(Rig::new(slow.clone()).connect(&Wish::controller(1)).is_ok());
    let mut wish = Wish::controller(1);
    wish.iocrs[0].reduction_ratio = 8;
    assert_eq!(Rig::new(slow).connect(&wish), Err(PnioStatus::connect(2, 11)));
}

#[test]
fn headers_and_order_of_blocks_are_checked() {
    let wish = Wish::controller(1);
    let good = wish.blocks();
    let ar_length = 4 + 54 + 3 + 2 - 2;
    let spoiled = |at: usize, value: u8| {
        let mut blocks = good.clone();
        blocks[at] = value;
        blocks
    };
    let mut behind = good[ar_length..].to_vec();
    behind.extend_from_slice(&good[..ar_length]);
    let mut twice = good.clone();
    twice.extend_from_slice(&good[..ar_length]);
    let mut unknown = good.clone();
    unknown.extend_from_slice(&[0x01, 0x09, 0, 2, 1, 0]);
    let mut tool_with_data = Wish::tool(2);
    tool_with_data.alarm_crs = wish.alarm_crs.clone();
    for (blocks, code1, code2) in [
        (spoiled(4, 2), 1, 2),
        (spoiled(5, 1), 1, 3),
        (spoiled(3, 20), 1, 1),
        (spoiled(ar_length + 4, 2), 2, 2),
        (good[..good.len() - 1].to_vec(), 3, 1),
        (behind, 1, 0),
        (twice, 1, 0),
        (unknown, 0x40, 1),
        (vec![], 1, 0),
        (tool_with_data.blocks(), 0x40, 1),
    ] {
        let mut rig = Rig::new(config());
        let (status, answer) = rig.call(operation::CONNECT, &blocks);
        assert_eq!(status, PnioStatus::connect(code1, code2));
        assert!(answer.is_empty());
    }
}

/// Requests near the longest that is taken, each of another shape that could cost much work.
fn huge() -> Vec<(&'static str, Vec<u8>, PnioStatus)> {
    let wish = Wish::controller(1);
    let module = |slot: u16, submodules: Vec<ExpectedSubmodule>| ExpectedModule {
        api: 0,
        slot,
        ident: 1,
        properties: 0,
        submodules,
    };
    let none = |subslot| ExpectedSubmodule::new(subslot, 1, 0, 0);
    let resources = PnioStatus::connect(0x40, 7);
    let memory = PnioStatus::connect(0x40, 8);
    let with = |wish: Wish| wish.blocks();
    let mut one_block = Wish {
        modules: vec![],
        ..wish.clone()
    }
    .blocks();
    let modules: Vec<_> = (0..2_200).map(|slot| module(slot, vec![none(1)])).collect();
    ExpectedModule::encode_block(&modules, &mut one_block);
    let many_blocks = Wish {
        modules: (0..1_800).map(|slot| module(slot, vec![none(1)])).collect(),
        ..wish.clone()
    };
    let many_subslots = Wish {
        modules: vec![module(0, (1..4_300).map(none).collect())],
        ..wish.clone()
    };
    let mut many_apis = wish.clone();
    let one = |api| IocrApi {
        api,
        data: vec![],
        status: vec![FrameObject {
            slot: 0,
            subslot: 1,
            offset: 0,
        }],
    };
    many_apis.iocrs[0].apis = (0..4_500).map(one).collect();
    let mut many_objects = wish.clone();
    many_objects.iocrs[1].apis[0].status = (0..9_000)
        .map(|slot| FrameObject {
            slot,
            subslot: 1,
            offset: slot,
        })
        .collect();
    let mut many_iocrs = wish.clone();
    many_iocrs.iocrs = (0..700)
        .map(|reference| IocrRequest {
            reference,
            ..wish.iocrs[0].clone()
        })
        .collect();
    let mut many_vendors = wish.blocks();
    for _ in 0..4_500 {
        many_vendors.extend_from_slice(&[0x01, 0x08, 0, 8, 1, 0, 0, 0, 0, 0, 0, 0]);
    }
    vec![
        ("modules in one block", one_block, memory),
        ("modules in many blocks", with(many_blocks), memory),
        ("submodules of one module", with(many_subslots), memory),
        ("APIs of an IOCR", with(many_apis), resources),
        ("objects of an IOCR", with(many_objects), resources),
        ("IOCRs", with(many_iocrs), resources),
        ("vendor blocks", many_vendors, memory),
    ]
}

#[test]
fn a_connect_that_asks_for_much_is_refused_before_it_costs_much() {
    for (what, blocks, expected) in huge() {
        assert!(
            (30_000..66_000).contains(&blocks.len()),
            "{what}: {}",
            blocks.len()
        );
        let found = check::check(Reader::new(&blocks), 32).map(|_| ());
        assert_eq!(found, Err(expected), "{what}");
    }
}

#[test]
fn as_many_submodules_as_may_be_expected_are_checked() {
    let submodule = |subslot| ExpectedSubmodule::new(subslot, 1, 0, 0);
    let largest = |count: u16| {
        let modules = vec![ExpectedModule {
            api: 0,
            slot: 0,
            ident: 1,
            properties: 0,
            submodules: (1..=count).map(submodule).collect(),
        }];
        let (input, output) = pack(&sizes(&modules)).unwrap();
        let mut wish = Wish::controller(1);
        for (iocr, layout) in wish.iocrs.iter_mut().zip([&input, &output]) {
            (iocr.apis, iocr.data_length) = (apis(layout), layout.data_length());
        }
        wish.modules = modules;
        wish
    };
    let check = |wish: Wish| check::check(Reader::new(&wish.blocks()), 32).map(|_| ());
    assert_eq!(check(largest(256)), Ok(()));
    assert_eq!(check(largest(257)), Err(PnioStatus::connect(0x40, 8)));
}

#[test]
fn an_ndr_header_that_lies_is_refused_in_every_service() {
    let codes = [0xDB, 0xDC, 0xDE, 0xDF, 0xDD, 0xDE];
    for (operation, code) in (0..).zip(codes) {
        let mut rig = Rig::new(config());
        let mut pdu = rig.request(operation, &[1, 2, 3, 4]);
        pdu[80 + 7] = 5;
        rig.send(&pdu);
        assert_eq!(rig.response().0, PnioStatus::new(code, 0x81, 0x40, 0));
    }
}

#[test]
fn an_answer_that_does_not_fit_leaves_no_ar() {
    let mut rig = Rig::new(config());
    let mut pdu = rig.request(operation::CONNECT, &Wish::controller(1).blocks());
    for at in [80, 88] {
        pdu[at..at + 4].copy_from_slice(&20u32.to_be_bytes());
    }
    rig.send(&pdu);
    assert_eq!(rig.response().0, PnioStatus::connect(0x40, 0));
    assert!(rig.device.controller().is_none());
}

#[test]
fn control_and_release_need_the_right_words_from_the_right_place() {
    let mut rig = Rig::new(config());
    let wish = Wish::controller(1);
    rig.connect(&wish).unwrap();
    let unknown = Wish::controller(2);
    assert_eq!(rig.prm_end(&unknown), PnioStatus::control(0x40, 5));
    assert_eq!(rig.release(&unknown), PnioStatus::release(0x40, 5));
    let mut stale = wish.clone();
    stale.ar.session_key = 4;
    assert_eq!(rig.prm_end(&stale), PnioStatus::control(0x14, 6));
    assert_eq!(rig.release(&stale), PnioStatus::release(0x28, 6));
    let (control, release) = (operation::CONTROL, operation::RELEASE);
    let ready = ControlCommand::APPLICATION_READY;
    assert_eq!(
        rig.control(control, BlockType::PRM_END, &wish, ready),
        PnioStatus::control(0x14, 8)
    );
    assert_eq!(
        rig.control(release, BlockType::RELEASE, &wish, ready),
        PnioStatus::release(0x28, 8)
    );
    let prm_end = ControlCommand::PRM_END;
    assert_eq!(
        rig.control(control, BlockType::PRM_END_PLUG, &wish, prm_end),
        PnioStatus::control(0x3D, 0)
    );
    assert_eq!(
        rig.control(control, BlockType::PRM_BEGIN, &wish, prm_end),
        PnioStatus::control(0x40, 1)
    );
    assert_eq!(
        rig.control(release, BlockType::PRM_END, &wish, prm_end),
        PnioStatus::release(0x28, 0)
    );
    rig.from = SocketAddrV4::new(STRANGER, 50_000);
    assert_eq!(rig.prm_end(&wish), PnioStatus::control(0x40, 5));
    assert_eq!(rig.release(&wish), PnioStatus::release(0x40, 5));
    assert!(rig.device.controller().is_some());
}
