//! The program on devices that refuse ways to their records, and on a device of another stack that serves no parameters.

use std::time::Duration;

use system_tests::{Finished, Lab, Running, Side, built, client, judge, simulate};

const SHORT: Duration = Duration::from_secs(20);

#[track_caller]
fn says(finished: &Finished, code: i32, words: &[&str]) {
    assert_eq!(finished.code, Some(code), "{finished:?}");
    for words in words {
        let found = finished.err.contains(words) || finished.out.contains(words);
        assert!(found, "{words}: {finished:?}");
    }
}

fn devices(lab: &Lab) -> Running {
    let mut devices = lab.spawn(Side::Device, built("stubborn-devices"), ["dev0"]);
    devices.wait_for("ready", Duration::from_secs(5));
    devices
}

#[test]
fn the_program_uses_each_path_to_the_records() {
    let lab = Lab::new("reach-ways");
    let _devices = devices(&lab);
    let capture = lab.capture("traffic");

    // no device access: records implicitly, parameters over a connection as IO controller
    let ways = [
        "vlt-1: no device access: connect: ",
        "vlt-1: records by implicit reads",
        "vlt-1: parameters over a connection as IO controller with invalid outputs: slot 0 ",
    ];
    says(&client(&lab, &["read", "vlt-1", "3-41", "-v"]), 0, &ways);
    client(&lab, &["write", "vlt-1", "3-41=5s"]).ok();
    let read = client(&lab, &["read", "vlt-1", "3-41"]).ok();
    assert!(read.out.contains('5') && read.err.is_empty(), "{read:?}");
    let info = client(&lab, &["info", "vlt-1", "--json"]).ok();
    let info: serde_json::Value = serde_json::from_str(&info.out).unwrap();
    assert_eq!(
        (&info["route"], &info["controller"]["connected"]),
        (&"implicit reads".into(), &serde_json::Value::Bool(false))
    );
    assert_eq!(info["modules"].as_array().map(Vec::len), Some(2), "{info}");

    // as a controller it is run all the same, and a second program leaves that one alone
    let arguments = ["-i", "ctl0", "run", "vlt-1", "--velocity", "20%", "--for", "4s"];
    let calm = ["--cycle", "16ms", "--watchdog", "15", "--may-run-on"];
    let all: Vec<&str> = arguments.into_iter().chain(calm).collect();
    let mut run = lab.spawn(Side::Controller, built("profidrive"), all);
    run.wait_for("S4", Duration::from_secs(10));
    says(
        &client(&lab, &["read", "vlt-1", "3-41"]),
        3,
        &[
            "parameters can be neither read nor written: controller \"profidrive\" has its only connection",
            "can be read beside the controller",
        ],
    );
    let beside = client(&lab, &["info", "vlt-1"]).ok();
    assert!(beside.out.contains("controller \"profidrive\""), "{beside:?}");
    run.finish(SHORT).ok();

    // an AlarmCR is wanted in every connect, and data before any job
    says(
        &client(&lab, &["read", "akd-1", "DRV.ACC", "-v"]),
        0,
        &[
            "akd-1: no device access",
            "start-up ended, outputs stay invalid",
            "3000",
        ],
    );
    let status = client(&lab, &["status", "akd-1", "--json"]);
    assert!(!status.out.contains("702"), "{status:?}");

    // nothing at all
    says(
        &client(&lab, &["read", "vacon-1", "ID103"]),
        4,
        &[
            "vacon-1: no way to its records (device access: connect: ",
            "; implicit reads: ",
            "; connection as IO controller: connect: ",
        ],
    );
    client(&lab, &["info", "vacon-1"]).ok();

    judge::judge(&capture.stop()).clean().saw("pn_io", 60);
}

#[test]
fn a_device_that_is_no_drive_is_described_and_blinks_only_once_it_answers() {
    let lab = Lab::new("reach-other");
    let _devices = devices(&lab);
    let info = client(&lab, &["info", "rio-1"]).ok();
    for words in [
        "rio-1",
        "(not a drive)",
        "RIO-16",
        "4711",
        "slot 2: module 0x00000031, subslots 1: 0x00000032",
    ] {
        assert!(info.out.contains(words), "{words}: {info:?}");
    }
    says(
        &client(&lab, &["read", "rio-1", "930"]),
        1,
        &["rio-1 is not a drive: no module of the drive profile"],
    );
    let blink = client(&lab, &["blink", "rio-1", "--for", "1s"]);
    says(&blink, 4, &["no answer"]);
    assert!(!blink.err.contains("blinks"), "{blink:?}");
    let blink = client(&lab, &["blink", "vlt-1", "--for", "1s"]).ok();
    assert!(
        blink.err.contains("vlt-1") && blink.err.contains("blinks"),
        "{blink:?}"
    );
}

/// The pnio crate refuses ARType 6, and serves identification without a connection.
#[test]
fn a_device_of_another_stack_shows_its_identity() {
    let lab = Lab::new("reach-pnio");
    lab.address(Side::Device, "192.168.77.50/24");
    let mut device = lab.spawn(
        Side::Device,
        built("pnio-device"),
        ["dev0", "pnio-dev", "192.168.77.50"],
    );
    device.wait_for("ready", Duration::from_secs(5));
    says(
        &client(&lab, &["info", "pnio-dev", "-v"]),
        0,
        &[
            "pnio-dev: no device access: connect: ",
            "pnio-dev: records by implicit reads",
            "PNIO-PEER",
        ],
    );
    says(
        &client(&lab, &["read", "pnio-dev", "930"]),
        4,
        &["no way to its records", "the plugged modules are not known"],
    );
}

/// What the device description declares is believed, by the virtual drive and by the client.
#[test]
fn a_device_description_without_device_access_saves_the_attempt() {
    let lab = Lab::new("reach-gsdml");
    let folder = lab.folder().join("gsdml");
    let export = [
        "gsdml",
        "export",
        "--model",
        "akd",
        "-o",
        folder.to_str().unwrap(),
    ];
    lab.run(Side::Controller, built("profidrive"), export, SHORT).ok();
    let files = std::fs::read_dir(&folder).unwrap();
    let file = files
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|ending| ending == "xml"))
        .unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    let changed = text.replace(
        r#"DeviceAccessSupported="true""#,
        r#"DeviceAccessSupported="false""#,
    );
    assert_ne!(text, changed);
    std::fs::write(&file, changed).unwrap();
    let file = file.to_str().unwrap();
    let _drive = simulate(
        &lab,
        &["--gsdml", file, "--name", "akd-1", "--ip", "192.168.77.50/24"],
    );
    says(
        &client(&lab, &["read", "akd-1", "DRV.ACC", "-v"]),
        0,
        &["akd-1: no device access: connect: ", "3000"],
    );
    says(
        &client(&lab, &["read", "akd-1", "DRV.ACC", "-v", "--gsdml", file]),
        0,
        &[
            "akd-1: no device access: its device description declares none",
            "3000",
        ],
    );
    // without the right to raw sockets, by UDP alone
    let program = built("profidrive");
    let read = ["-i", "ctl0", "read", "192.168.77.50", "DRV.ACC"];
    let mut all = vec!["--bounding-set", "-net_raw", program.to_str().unwrap()];
    all.extend(read);
    let read = lab.run(Side::Controller, "setpriv", all, SHORT);
    says(&read, 0, &["3000", "going by UDP alone"]);
}
