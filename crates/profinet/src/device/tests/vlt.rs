//! A Connect of a real Danfoss VLT with PROFINET option, field by field, and the answer that it gave: ModuleDiffBlock
//! although nothing differs, its own FrameID for the outputs. Source: captures of cisagov/icsnpp-profinet-io-cm.

use super::*;
use crate::wire::block::{DiffModule, DiffSubmodule, ModuleDiff, ModuleState, SubmoduleState};
use crate::wire::rpc::NdrRequest;
use crate::wire::{ByteOrder, Reader};

/// Returns the modules of the drive; the telegram is PPO type 4.
fn vlt() -> DeviceConfig {
    let plain = |subslot, ident| SubmoduleDescription {
        subslot,
        ident,
        api: 0,
        input_length: 0,
        output_length: 0,
    };
    let drive = |subslot, ident, octets| SubmoduleDescription {
        api: DRIVE_API,
        input_length: octets,
        output_length: octets,
        ..plain(subslot, ident)
    };
    let modules = vec![
        ModuleDescription {
            ident: 2,
            slots: vec![0],
            submodules: vec![plain(1, 1), plain(0x8000, 2), plain(0x8001, 3), plain(0x8002, 3)],
        },
        ModuleDescription {
            ident: 0x100,
            slots: vec![1],
            submodules: vec![drive(1, 0xFFFF, 0), drive(2, 0x68, 12)],
        },
    ];
    let identity = Identity {
        vendor_id: 0x80,
        device_id: 1,
        ..identity()
    };
    let mut config = DeviceConfig::new(DEVICE, identity, modules);
    config.neighbourhood = false;
    config.min_device_interval = 128;
    config.output_frame_ids[1] = 0x8010;
    config.max_alarm_data = 1432;
    config.always_listed = vec![1];
    config.ready_order = ByteOrder::Little;
    config.ready_arguments = 120;
    config
}

/// Returns the request of the controller.
fn wish() -> Wish {
    let mut wish = Wish::controller(7);
    let submodule = |subslot, ident, octets| ExpectedSubmodule::new(subslot, ident, octets, octets);
    wish.modules = vec![
        ExpectedModule {
            api: 0,
            slot: 0,
            ident: 2,
            properties: 0,
            submodules: vec![
                submodule(1, 1, 0),
                submodule(0x8000, 2, 0),
                submodule(0x8001, 3, 0),
                submodule(0x8002, 3, 0),
            ],
        },
        ExpectedModule {
            api: DRIVE_API,
            slot: 1,
            ident: 0x100,
            properties: 0,
            submodules: vec![submodule(1, 0xFFFF, 0), submodule(2, 0x68, 12)],
        },
    ];
    let at = |slot, subslot, offset| FrameObject {
        slot,
        subslot,
        offset,
    };
    let slot_0 = || {
        (0..)
            .zip([1, 0x8000, 0x8001, 0x8002])
            .map(|(offset, subslot)| at(0, subslot, offset))
    };
    let apis = |data: Vec<FrameObject>, status: Vec<FrameObject>, drive_data, drive_status| {
        vec![
            IocrApi { api: 0, data, status },
            IocrApi {
                api: DRIVE_API,
                data: drive_data,
                status: drive_status,
            },
        ]
    };
    for iocr in &mut wish.iocrs {
        iocr.data_length = 40;
        iocr.send_clock_factor = 128;
        iocr.reduction_ratio = 1;
    }
    wish.iocrs[0].frame_id = 0x8061;
    wish.iocrs[0].apis = apis(
        slot_0().collect(),
        vec![],
        vec![at(1, 1, 4), at(1, 2, 5)],
        vec![at(1, 2, 18)],
    );
    wish.iocrs[1].apis = apis(
        vec![],
        slot_0().collect(),
        vec![at(1, 2, 6)],
        vec![at(1, 1, 4), at(1, 2, 5)],
    );
    wish.alarm_crs[0].max_alarm_data_length = 256;
    wish
}

fn expected_diff() -> ModuleDiff {
    let submodule = |subslot, ident| DiffSubmodule {
        subslot,
        ident,
        state: SubmoduleState(0x8800),
    };
    ModuleDiff {
        modules: vec![DiffModule {
            api: DRIVE_API,
            slot: 1,
            ident: 0x100,
            state: ModuleState(2),
            submodules: vec![submodule(1, 0xFFFF), submodule(2, 0x68)],
        }],
    }
}

#[test]
fn the_connect_of_a_real_vlt_gets_its_answer() {
    let mut rig = Rig::new(vlt());
    let wish = wish();
    let response = rig.connect(&wish).unwrap();
    let frame_ids: Vec<u16> = response.iocrs.iter().map(|iocr| iocr.frame_id).collect();
    assert_eq!(frame_ids, [0x8061, 0x8010]);
    assert_eq!(response.alarm_cr.unwrap().max_alarm_data_length, 1432);
    assert_eq!(response.diff, Some(expected_diff()));
    // the block reports a substitute, and data is exchanged anyway
    let state = expected_diff().modules[0].submodules[0].state;
    assert_eq!(
        (state, state.ident_info(), state.is_usable()),
        (SubmoduleState::SUBSTITUTE, 1, true)
    );
    assert_eq!(rig.device.send_interval().unwrap().as_millis(), 4);
    assert_eq!(rig.device.watchdog().unwrap().as_millis(), 12);

    // The block lists no errors: all submodules are good and data goes both ways.
    let mut provider = outputs(&wish, &response, rig.now);
    let mut frame = None;
    for sent in rig.drain() {
        if let Sent::Frame(sent) = sent {
            frame = Some(sent);
        }
    }
    rig.output(&mut provider);
    assert_eq!(rig.prm_end(&wish), PnioStatus::OK);
    let ar = rig.device.controller().unwrap();
    assert!(rig.device.set_input(1, 2, &[7; 12], Iops::GOOD));
    assert!(rig.device.application_ready(rig.now, ar));
    let sent = rig.drain();
    let (header, body) = ready_request(&sent).unwrap();
    assert_eq!(header.order, ByteOrder::Little);
    let ndr = NdrRequest::decode(&mut Reader::new(&body), header.order).unwrap();
    assert_eq!(ndr.args_maximum, 120);
    // NDR header, control block, and the same difference again
    let mut diff = Vec::new();
    expected_diff().encode(&mut diff);
    assert_eq!(body[20 + 32..], diff);
    rig.confirm(&wish, &sent);
    rig.output(&mut provider);
    assert!(rig.device.is_exchanging());
    assert_eq!(
        rig.device.output(1, 2).map(|(data, iops)| (data.len(), iops)),
        Some((12, Iops::GOOD))
    );
    let frames = rig.pass(4);
    let last = frames.iter().rev().find_map(|sent| match sent {
        Sent::Frame(frame) => Some(frame),
        Sent::Datagram(..) => None,
    });
    let last = last.or(frame.as_ref()).unwrap();
    let last = Frame::parse(last).unwrap();
    assert_eq!(last.frame_id.0, 0x8061);
    assert_eq!(last.payload[..5], [0x80; 5]);
    assert_eq!(last.payload[5..17], [7; 12]);
    assert_eq!(last.payload[17..19], [0x80, 0x80]);
}

#[test]
fn a_wrong_telegram_is_reported_as_wrong() {
    let mut rig = Rig::new(vlt());
    let mut wish = wish();
    wish.modules[1].submodules[1].ident = 0x69;
    let response = rig.connect(&wish).unwrap();
    let mut expected_diff = expected_diff();
    expected_diff.modules[0].submodules[1].state = SubmoduleState::WRONG;
    assert_eq!(response.diff, Some(expected_diff));
}
