//! The bits of STW1 and ZSW1 in position mode (AKD PROFINET manual 5.4 and 5.5), as each command that reads a drive names
//! them while another program has control.

use std::time::Duration;

use serde_json::Value;
use system_tests::{Lab, Side, built, client, simulate, wait_until};

const SHORT: Duration = Duration::from_secs(20);

#[test]
fn every_command_names_the_bits_of_position_mode() {
    let lab = Lab::new("position-words");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    client(&lab, &["write", "akd-1", "930=2"]).ok();
    let jog = [
        "jog",
        "akd-1",
        "--velocity",
        "60rpm",
        "--real-time",
        "--for",
        "60s",
    ];
    let jog = [&["-i", Side::Controller.interface()], &jog[..]].concat();
    let mut jog = lab.spawn(Side::Controller, built("profidrive"), jog);
    // a command that reads takes UDP port 34964 where it is free: the axis comes first
    jog.wait_for("S4", SHORT);
    let status = || client(&lab, &["status", "akd-1"]).out;
    let jogs = wait_until(SHORT, || status().contains("RT_JOG]"));
    assert!(jogs, "{} {} {}", status(), jog.out(), jog.err());

    for line in [
        &["info", "akd-1"][..],
        &["status", "akd-1"],
        &["read", "akd-1", "STW1", "ZSW1"],
    ] {
        let text = client(&lab, line).out;
        for part in [
            "ON, EN_OP, NO_REJECT, NO_INT_STOP, CTRL_PLC, RT_JOG",
            "OPERATION, IN_TOLERANCE, CTRL_REQ",
        ] {
            assert!(text.contains(part), "{line:?}: {text}");
        }
        assert!(!text.contains("BIT1"), "{line:?}: {text}");
    }
    let watched = client(&lab, &["monitor", "akd-1", "--for", "10ms"]).ok().out;
    assert!(watched.contains("  position "), "{watched}");
    let json = client(&lab, &["monitor", "akd-1", "--for", "10ms", "--json"])
        .ok()
        .out;
    let json: Value = serde_json::from_str(json.lines().next().unwrap()).unwrap();
    let set = json["stw1"]["bits"].as_array().unwrap();
    assert!(set.contains(&"RT_JOG".into()), "{json}");
    let position = &json["position"];
    assert_eq!(
        (&json["mode"], position.is_null()),
        (&"position".into(), false),
        "{json}"
    );
    // manual 8.1: a controller that is gone, with all causes and remedies
    jog.kill();
    let faults = || client(&lab, &["faults", "akd-1"]).out;
    assert!(wait_until(SHORT, || faults().contains("F702")), "{}", faults());
    for text in [faults(), status()] {
        for part in [
            "subnet",
            "PROFINET switch",
            "run time of the PLC",
            "PN.TIMEOUTFTHRESH",
            "device discovery of WorkBench",
            "FBUS.PARAM02 bit 0",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}
