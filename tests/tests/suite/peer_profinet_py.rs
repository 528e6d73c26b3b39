//! An independent controller (profinet-py, Python) in its own namespace.

use std::time::Duration;

use profile::catalogue::AKD;
use profile::parameter::Dialect;
use system_tests::profinetpy::{controller, slots};
use system_tests::{Lab, Side, built, compare, judge, simulate, step};

/// The virtual AKD and an independent controller, from a drive without name and address to 60 rpm and back.
#[test]
fn the_virtual_drive_serves_profinet_py() {
    let lab = Lab::new("profinetpy-akd");
    let device = &AKD.device;
    let slots = slots(device, 1);
    let capture = lab.capture("traffic");
    // no name and no address: as it comes out of its box
    let drive = simulate(&lab, &["--model", "akd", "--mac", Side::Device.mac()]);
    let set_mode = "05 02 00 01 10 01 03 A2 00 00 42 01 00 02";
    let set_mode_back = "06 02 00 01 10 01 03 A2 00 00 42 01 00 01";
    let read_mode = "07 01 00 01 10 01 03 A2 00 00";
    let two = "08 01 00 02 10 01 03 A2 00 00 10 06 03 C4 00 00";
    let unknown = "09 01 00 01 10 01 FF F0 00 00";
    let arguments = [
        "--name",
        "drive-one",
        "--ip",
        "192.168.77.50",
        "--slots",
        &slots,
        "--seconds",
        "10",
        "--ratio",
        "16",
        "--watchdog",
        "6",
        "--job",
        set_mode,
        "--job",
        read_mode,
        "--job",
        set_mode_back,
        "--job",
        two,
        "--job",
        unknown,
        "--job-running",
        read_mode,
        "--steps",
        "discover,name,ip,signal,find,im0,connect,im0_connected,records,exchange,drive,release",
    ];
    let finished = controller(&lab, &arguments, 120);
    let file = capture.stop();
    let steps = finished.ok().json_lines();

    let found = step(&steps, "discover");
    assert_eq!(
        (&found["vendor"], &found["device"]),
        (&device.vendor_id.into(), &device.device_id.into())
    );
    assert_eq!((&found["name"], &found["ip"]), (&"".into(), &"0.0.0.0".into()));
    assert_eq!(step(&steps, "find")["name"], "drive-one");
    assert_eq!(step(&steps, "find")["ip"], "192.168.77.50");
    let im0 = step(&steps, "im0_connected");
    assert_eq!(
        (&im0["vendor"], &im0["order"]),
        (&device.vendor_id.into(), &device.order_id.into())
    );

    let answers: Vec<(u64, &str, &str)> = steps
        .iter()
        .filter(|s| s["step"] == "record")
        .map(|s| {
            (
                s["index"].as_u64().unwrap(),
                s["request"].as_str().unwrap(),
                s["answer"].as_str().unwrap(),
            )
        })
        .collect();
    for (request, answer) in [
        ("01 01 00 01 10 01 03 c5 00 00", Some("01010001 4201 0329")),
        (set_mode, Some("050200010000")),
        (read_mode, Some("07010001 4201 0002")),
        (set_mode_back, Some("060200010000")),
        (unknown, Some("09810001 4401 0000")),
    ] {
        let plain = |text: &str| text.to_lowercase().replace(' ', "");
        for index in [0x002F, 0xB02E] {
            let given = answers
                .iter()
                .find(|(i, r, _)| *i == index && plain(r) == plain(request))
                .unwrap_or_else(|| panic!("no answer to {request} on {index:#06x}: {answers:?}"))
                .2;
            assert!(
                answer.is_none_or(|answer| given == plain(answer)),
                "{request} on {index:#06x}: {given}"
            );
        }
    }

    in_order(step(&steps, "exchange"), 10.0, 16.0);
    for what in [
        "ready to switch on",
        "operation",
        "speed reached",
        "running",
        "stopped",
    ] {
        assert!(
            steps.iter().any(|s| s["what"] == what),
            "{what} missing: {steps:?}"
        );
    }
    step(&steps, "done");

    let verdict = judge::judge(&file);
    verdict
        .clean()
        .saw("pn_dcp", 8)
        .saw("pn_io", 20)
        .saw("pn_rt", 600);
    assert!(verdict.warnings.is_empty(), "{:?}", verdict.warnings);
    assert!(compare::same_parameters(&file, &Dialect::AKD) >= 26);
    drive.interrupt(Duration::from_secs(5)).ok();
}

/// The script itself against the other independent peer: what it finds wrong later is then our fault, not its own.
#[test]
fn the_script_works_with_another_device() {
    let lab = Lab::new("profinetpy-pnio");
    lab.address(Side::Device, "192.168.77.50/24");
    let mut device = lab.spawn(
        Side::Device,
        built("pnio-device"),
        ["dev0", "pnio-dev", "192.168.77.50"],
    );
    device.wait_for("ready", Duration::from_secs(5));
    let capture = lab.capture("traffic");
    let slots = "0:1:0:0x1:0x1:0:0,0:0x8000:0:0x1:0x8000:0:0,0:0x8001:0:0x1:0x8001:0:0,\
        1:1:0:0x101:0x1:64:0,2:1:0:0x102:0x1:4:0,3:1:0:0x103:0x1:0:64,4:1:0:0x104:0x1:0:4";
    let arguments = [
        "--name",
        "pnio-dev",
        "--ip",
        "192.168.77.50",
        "--slots",
        slots,
        "--seconds",
        "3",
        "--input-frame-id",
        "0x8001",
        "--steps",
        "discover,find,connect,im0_connected,exchange,mirror,release",
    ];
    let finished = controller(&lab, &arguments, 60);
    let file = capture.stop();
    let steps = finished.ok().json_lines();
    assert_eq!(step(&steps, "discover")["vendor"], 0xFFFF);
    assert_eq!(step(&steps, "im0_connected")["order"], "PNIO-PEER");
    in_order(step(&steps, "exchange"), 3.0, 32.0);
    step(&steps, "done");
    judge::judge(&file).clean().saw("pn_rt", 150).saw("pn_io", 10);
}

/// The controller's own counters: nothing invalid, nothing out of order, no connection lost, and not more frames than cycles.
/// How many cycles a busy machine leaves out is a figure of `make bench`.
#[track_caller]
fn in_order(exchange: &serde_json::Value, seconds: f64, cycle_ms: f64) {
    for counter in ["invalid", "duplicate", "disordered", "timeouts"] {
        assert_eq!(exchange[counter], 0, "{counter}: {exchange}");
    }
    assert_eq!(exchange["state"], "RUNNING", "{exchange}");
    assert_eq!(exchange["errors"], serde_json::json!([]), "{exchange}");
    let expected = seconds * 1000.0 / cycle_ms;
    let received = exchange["received"].as_f64().unwrap();
    assert!(
        received >= expected / 2.0 && received <= expected * 1.03 + 1.0,
        "{received} of {expected} frames: {exchange}"
    );
}
