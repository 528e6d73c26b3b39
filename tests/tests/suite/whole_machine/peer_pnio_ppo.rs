//! An independent device (the pnio crate) with the modules of a converter, the parameter channel among them: our
//! controller exchanges data with it, and the words of the parameter channel go both ways as printed.

use std::time::Duration;

use serde_json::Value;
use system_tests::{Lab, Side, built, judge, step};

/// What is asked, what comes of it, and the words of the reply.
const EXPECTED: [(&str, &str, &str); 8] = [
    ("double", "Value(DoubleWord(1000))", "20cf0000000003e8"),
    ("changed", "Value(DoubleWord(66051))", "20cf000000010203"),
    ("again", "Value(DoubleWord(66051))", "20cf000000010203"),
    ("mode", "Value(DoubleWord(2))", "23a2000000000002"),
    ("element", "Value(Word(14))", "45fa01000000000e"),
    ("limit", "2 ", "7000000000000002"),
    ("below", "Value(Word(1000))", "119e0000000003e8"),
    ("missing", "0 ", "77d0000000000000"),
];

#[test]
fn ppo_modules_of_another_stack() {
    let lab = Lab::alone("pnio-ppo");
    lab.address(Side::Device, "192.168.77.50/24");
    let mut device = lab.spawn(
        Side::Device,
        built("pnio-device"),
        ["dev0", "pnio-dev", "192.168.77.50", "ppo"],
    );
    device.wait_for("ready", Duration::from_secs(5));
    let capture = lab.capture("traffic");
    let finished = lab
        .run(
            Side::Controller,
            built("ppo-controller"),
            ["ctl0", "pnio-dev"],
            Duration::from_secs(90),
        )
        .ok();
    let file = capture.stop();
    let steps = finished.json_lines();
    assert_eq!(step(&steps, "connected")["diff"], false);
    step(&steps, "done");
    device.wait_for("Idle", Duration::from_secs(3));
    for slot in 1..=3_u16 {
        let job = |name: &str| {
            let found = steps
                .iter()
                .find(|step| step["slot"] == slot && step["name"] == name);
            found.unwrap_or_else(|| panic!("slot {slot} has no {name}"))
        };
        let text = |value: &Value| value.as_str().unwrap().to_owned();
        for (name, outcome, words) in EXPECTED {
            let job = job(name);
            assert!(text(&job["outcome"]).contains(outcome), "{job}");
            assert_eq!(job["words"], words, "{job}");
        }
        // a value of its own each time
        let number = |name: &str| u64::from_str_radix(&text(&job(name)["words"])[8..], 16).unwrap();
        assert!(number("later") > number("actual"));
        for round in 0..4 {
            for (name, outcome) in [
                ("double", "DoubleWord(66051)"),
                ("element", "Word(14)"),
                ("missing", "0 "),
            ] {
                let job = job(&format!("{name} in round {round}"));
                assert!(text(&job["outcome"]).contains(outcome), "{job}");
            }
        }
        if slot == 2 {
            continue;
        }
        // process data beside it: stopped, and at 50 % of the reference
        let behind = if slot == 3 { "1112131415161718" } else { "" };
        assert_eq!(job("double")["process"], format!("06030000{behind}"));
        let running = job("double while it runs");
        assert_eq!(running["process"], format!("0f072000{behind}"));
        assert_eq!(running["words"], "20cf000000010203");
        let refused = job("mode while it runs");
        assert_eq!(refused["words"], "73a2000000000011");
        assert!(text(&refused["outcome"]).contains("17 "), "{refused}");
    }
    let verdict = judge::judge(&file);
    verdict
        .clean()
        .saw("pn_dcp", 2)
        .saw("pn_io", 10)
        .saw("pn_rt", 500);
    assert!(verdict.warnings.is_empty(), "{:?}", verdict.warnings);
}
