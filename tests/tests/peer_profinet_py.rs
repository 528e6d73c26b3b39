//! An independent controller (profinet-py, Python) in its own namespace.

use std::time::Duration;

use system_tests::{Finished, Lab, Side, built, judge, peer, python};

const DEVICE_MAC: &str = "02:50:4e:00:00:01";

fn controller(lab: &Lab, arguments: &[&str], limit: u64) -> Finished {
    let script = peer("profinetpy_controller.py");
    let mut line = vec![
        script.to_str().unwrap(),
        "--interface",
        Side::Controller.interface(),
    ];
    line.extend(arguments);
    lab.run(Side::Controller, python(), line, Duration::from_secs(limit))
}

fn step<'a>(steps: &'a [serde_json::Value], name: &str) -> &'a serde_json::Value {
    steps
        .iter()
        .find(|s| s["step"] == name)
        .unwrap_or_else(|| panic!("step {name} did not happen: {steps:?}"))
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
        "--mac",
        DEVICE_MAC,
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
    lost_nothing(step(&steps, "exchange"), 3.0, 32.0);
    step(&steps, "done");
    judge::judge(&file).clean().saw("pn_rt", 150).saw("pn_io", 10);
}

/// The controller's own counters: nothing missed, nothing invalid, nothing out of order, and as many frames as cycles.
#[track_caller]
fn lost_nothing(exchange: &serde_json::Value, seconds: f64, cycle_ms: f64) {
    for counter in ["missed", "invalid", "duplicate", "disordered", "timeouts"] {
        assert_eq!(exchange[counter], 0, "{counter}: {exchange}");
    }
    assert_eq!(exchange["state"], "RUNNING", "{exchange}");
    assert_eq!(exchange["errors"], serde_json::json!([]), "{exchange}");
    let expected = seconds * 1000.0 / cycle_ms;
    let received = exchange["received"].as_f64().unwrap();
    assert!(
        (received - expected).abs() <= expected * 0.03 + 1.0,
        "{received} of {expected} frames: {exchange}"
    );
}
