//! The connection that a real Danfoss VLT with PROFINET option was seen to have, with the virtual one: PPO type 4 in subslot
//! 2, every 4 ms; a ModuleDiffBlock that says substitute, an alarm data length and a FrameID of its own, an
//! ApplicationReady in little-endian with ArgsMaximum 120. The dissector
//! reads every frame of it. Source: captures of cisagov/icsnpp-profinet-io-cm.

use client::modules_of;
use profinet::wire::block::{DiffModule, DiffSubmodule, ModuleState, SubmoduleState};
use system_tests::bus::Bus;
use system_tests::judge;
use virtual_drive::model::VLT;

const DRIVE_API: u32 = 0x3A00;

#[test]
fn the_frames_of_a_vlt_connection_are_read_by_the_dissector_as_they_are_meant() {
    let device = &VLT.catalogue.device;
    let mut bus = Bus::of(&VLT);
    let modules = modules_of(device, device.telegram(104).expect("PPO type 4"));
    let of_drive = modules.iter().find(|module| module.api == DRIVE_API);
    let of_drive = of_drive.expect("slot 1").clone();
    let wanted = of_drive.submodules.iter();
    let wanted: Vec<_> = wanted
        .map(|one| (one.subslot, one.ident, one.input_length, one.output_length))
        .collect();
    assert_eq!(wanted, [(1, 0xFFFF, 0, 0), (2, 0x68, 12, 12)]);

    let (diff, running) = bus.connect_as(modules);
    assert!(running, "data is exchanged though a block lists differences");
    let submodule = |subslot, ident| DiffSubmodule {
        subslot,
        ident,
        state: SubmoduleState(0x8800),
    };
    let expected = DiffModule {
        api: DRIVE_API,
        slot: 1,
        ident: of_drive.ident,
        state: ModuleState(2),
        submodules: vec![submodule(1, 0xFFFF), submodule(2, 0x68)],
    };
    assert_eq!(diff.map(|diff| diff.modules), Some(vec![expected]));
    assert_eq!(
        bus.station()
            .device()
            .send_interval()
            .map(|time| time.as_millis()),
        Some(4)
    );
    bus.release();

    let file = bus.judged("vlt-connect");
    // its response to Connect, and its ApplicationReady
    let names = [
        "dcerpc.pkt_type",
        "pn_io.module_state",
        "pn_io.submodule_state",
        "pn_io.module_ident_number",
        "pn_io.submodule_ident_number",
        "pn_io.maxalarmdatalength",
        "pn_io.frame_id",
        "dcerpc.drep.byteorder",
        "pn_io.args_max",
        "pn_io.submodule_state.ident_info",
    ];
    let rows = judge::fields(&file, "pn_io.module_state", &names);
    let expected = ["0x0002", "0x8800,0x8800", "0x00000100", "0x0000ffff,0x00000068"];
    let kinds: Vec<_> = rows.iter().map(|row| row[0].as_str()).collect();
    assert_eq!(kinds, ["2", "0"], "{rows:?}");
    for row in &rows {
        assert_eq!(row[1..5], expected, "{row:?}");
    }
    assert_eq!(rows[0][5], "1432");
    assert!(rows[0][6].contains("0x8010"), "{rows:?}");
    for row in &rows {
        assert_eq!(row[9], "0x0001,0x0001", "substitute: {row:?}");
    }
    // ApplicationReady as the real drive sends it
    assert_eq!(rows[1][7..9], ["1", "120"], "{rows:?}");
}
