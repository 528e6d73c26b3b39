//! An independent device (the pnio crate) and our controller.

use std::time::Duration;

use system_tests::{Lab, Running, Side, built, judge, step, traffic};

fn device(lab: &Lab) -> Running {
    let mut device = lab.spawn(
        Side::Device,
        built("pnio-device"),
        ["dev0", "pnio-dev", "192.168.77.50"],
    );
    device.wait_for("ready", Duration::from_secs(5));
    device
}

/// How many cycles a busy machine leaves out is a figure of `make bench`; here no frame may be wrong or out of order.
#[test]
fn ten_seconds_of_data_in_order() {
    let lab = Lab::alone("pnio-exchange");
    lab.address(Side::Device, "192.168.77.50/24");
    let mut device = device(&lab);
    let capture = lab.capture("traffic");
    let arguments = [
        "ctl0",
        "pnio",
        "pnio-dev",
        "cycle_us=8000",
        "seconds=10",
        "hold=12",
    ];
    let finished = lab
        .run(
            Side::Controller,
            built("test-controller"),
            arguments,
            Duration::from_secs(60),
        )
        .ok();
    let file = capture.stop();
    let steps = finished.json_lines();
    let exchange = step(&steps, "exchange");
    assert_eq!(
        (&exchange["rejected"], &exchange["disordered"]),
        (&0.into(), &0.into()),
        "{exchange}"
    );
    let count = |field: &str| exchange[field].as_u64().unwrap();
    // 1,250 cycles, of which a machine that is held up leaves some out
    assert!((600..=1260).contains(&count("received")), "{exchange}");
    assert_eq!(exchange["mirrored"], true, "{exchange}");
    assert_eq!(exchange["good"], true, "{exchange}");
    let order: String = "PNIO-PEER".bytes().map(|b| format!("{b:02x}")).collect();
    assert!(step(&steps, "im0")["data"].as_str().unwrap().contains(&order));
    step(&steps, "released");
    device.wait_for("Idle", Duration::from_secs(3));

    judge::judge(&file)
        .clean()
        .saw("pn_dcp", 2)
        .saw("pn_io", 10)
        .saw("pn_rt", 1200);
    let streams = traffic::streams(&file, 256);
    assert_eq!(streams.len(), 2, "{streams:?}");
}

#[test]
fn a_killed_device_is_noticed_and_found_again() {
    let lab = Lab::alone("pnio-killed");
    lab.address(Side::Device, "192.168.77.50/24");
    let mut first = device(&lab);
    let capture = lab.capture("traffic");
    let arguments = [
        "ctl0",
        "pnio",
        "pnio-dev",
        "cycle_us=8000",
        "seconds=3",
        "reconnect=1",
        "hold=12",
    ];
    let mut controller = lab.spawn(Side::Controller, built("test-controller"), arguments);
    controller.wait_for("exchanging", Duration::from_secs(20));
    first.kill();
    controller.wait_for("lost", Duration::from_secs(3));
    // it looked for the device in vain
    controller.wait_for("absent", Duration::from_secs(20));
    let _second = device(&lab);
    let steps = controller.finish(Duration::from_secs(60)).ok().json_lines();
    let file = capture.stop();
    let cause = step(&steps, "lost")["cause"].as_str().unwrap();
    assert!(cause.contains("no cyclic data for 96 ms"), "{cause}");
    assert_eq!(
        steps.iter().filter(|s| s["step"] == "running").count(),
        2,
        "{steps:?}"
    );
    // the second connection carries data to its end
    let exchange = step(&steps, "exchange");
    let received = exchange["received"].as_u64().unwrap();
    let missed = exchange["missed"].as_u64().unwrap();
    assert!(
        exchange["good"] == true && received > 50 * missed.max(1),
        "{steps:?}"
    );
    step(&steps, "released");
    judge::judge(&file).clean();
}
