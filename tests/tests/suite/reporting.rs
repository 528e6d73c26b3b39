//! Reports of the commands: roundings, warnings, advice, objections and failed writes.

use std::time::Duration;

use serde_json::{Value, json};
use system_tests::{Finished, Lab, Running, Side, built};

const SHORT: Duration = Duration::from_secs(20);

fn simulate(lab: &Lab) -> Running {
    system_tests::simulate(lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"])
}

fn client(lab: &Lab, verb: &[&str]) -> Finished {
    system_tests::client(lab, verb)
}

/// Returns the counter of changes of the fault buffer and the telegram, which shows whether a client took control
/// since.
fn counter(lab: &Lab) -> Value {
    let read = client(lab, &["read", "akd-1", "944", "922", "DRV.ACTIVE", "--json"]).ok();
    serde_json::from_str(&read.out).unwrap_or_else(|error| panic!("{error}: {read:?}"))
}

#[test]
fn roundings_are_reported_and_other_values_refused() {
    let lab = Lab::new("roundings");
    let _drive = simulate(&lab);
    let written = client(&lab, &["write", "akd-1", "1004=99rpm"]).ok();
    assert!(
        written
            .err
            .contains("Jog v1 (p1004): 99 rpm -> 98.877 rpm, rounded to the nearest representable value"),
        "{written:?}"
    );
    let json = client(&lab, &["write", "akd-1", "1004=1.65rps", "--json"]).ok();
    let json: Value = serde_json::from_str(&json.out).unwrap();
    assert_eq!(
        (&json["changes"][0]["asked"], &json["changes"][0]["rounded"]),
        (&99.0.into(), &true.into())
    );
    for line in [
        &["write", "akd-1", "1004=0.001rpm"][..],
        &["jog", "akd-1", "--velocity", "0.001rpm"],
        &["run", "akd-1", "--velocity", "0.001rpm"],
        &["run", "akd-1", "--velocity", "0.5rpm", "--for", "1s"],
    ] {
        let refused = client(&lab, line);
        assert_eq!(refused.code, Some(2), "{line:?}: {refused:?}");
        assert!(refused.err.contains("the nearest "), "{line:?}: {refused:?}");
        assert!(
            !refused.err.contains("this moves the axis"),
            "{line:?}: {refused:?}"
        );
        assert!(!refused.err.contains("DRIVE"), "{line:?}: {refused:?}");
    }
    let limit = client(&lab, &["write", "192.168.77.50", "DRV.ACC=8e9rpm/s"]);
    assert!(
        limit
            .err
            .contains("`profidrive describe 192.168.77.50 DRV.ACC` shows unit and limits"),
        "{limit:?}"
    );
    let jog = client(
        &lab,
        &[
            "jog",
            "akd-1",
            "--velocity",
            "30rpm",
            "--for",
            "300ms",
            "--watchdog",
            "15",
        ],
    )
    .ok();
    assert!(jog.err.contains("(p1004) is 98.877 rpm again"), "{jog:?}");
}

#[test]
fn nothing_to_acknowledge_takes_no_control() {
    let lab = Lab::new("nothing");
    let _drive = simulate(&lab);
    let before = counter(&lab);
    let none = client(&lab, &["ack", "akd-1"]).ok();
    assert_eq!(none.err.trim(), "no fault: nothing to acknowledge", "{none:?}");
    assert_eq!(none.out, "", "no state was shown: no connection");
    let none = client(&lab, &["ack", "akd-1", "--json"]).ok();
    let none: Value = serde_json::from_str(&none.out).unwrap();
    assert_eq!(
        (&none["end"], &none["faults"]),
        (&true.into(), &Value::Array(Vec::new()))
    );
    assert_eq!(counter(&lab), before);
    client(&lab, &["inject", "akd-1", "fault=439"]).ok();
    let one = client(&lab, &["ack", "akd-1", "--watchdog", "15"]).ok();
    assert!(
        one.err.contains("F439 ") && one.err.contains("axis at rest"),
        "{one:?}"
    );
}

#[test]
fn what_only_a_restart_clears_is_not_acknowledged() {
    let lab = Lab::new("trip-lock");
    let _drive = system_tests::simulate(
        &lab,
        &["--model", "vlt", "--name", "vlt-1", "--ip", "192.168.77.50/24"],
    );
    client(&lab, &["inject", "vlt-1", "fault=13"]).ok();
    let refused = client(&lab, &["ack", "vlt-1"]);
    assert_eq!(refused.code, Some(1), "{refused:?}");
    assert!(
        refused.err.contains("F13 ") && refused.err.contains("switch the drive off and on"),
        "{refused:?}"
    );
    assert_eq!(refused.out, "", "no state was shown: no connection");
}

#[test]
fn a_warning_during_a_good_run_is_put_in_words() {
    let lab = Lab::new("warned");
    let _drive = simulate(&lab);
    let call = [
        "-i",
        "ctl0",
        "run",
        "akd-1",
        "--velocity",
        "60rpm",
        "--for",
        "3s",
        "--watchdog",
        "15",
    ];
    let mut run = lab.spawn(Side::Controller, built("profidrive"), call);
    run.wait_for("S4 operation", SHORT);
    client(&lab, &["inject", "akd-1", "warning=107", "--for", "1s"]).ok();
    let ended = run.finish(SHORT);
    assert_eq!(ended.code, Some(0), "{ended:?}");
    assert_eq!(
        ended.err.matches("warning: n107 Positive limit").count(),
        1,
        "{ended:?}"
    );
}

#[test]
fn a_speed_that_is_never_reached_ends_the_run() {
    let lab = Lab::new("never");
    let _drive = simulate(&lab);
    // a current that the drive bears for ever
    client(&lab, &["write", "akd-1", "IL.LIMITP=1A", "IL.LIMITN=-1A"]).ok();
    client(&lab, &["inject", "akd-1", "block=on"]).ok();
    let ended = client(
        &lab,
        &["run", "akd-1", "--velocity", "600rpm", "--watchdog", "15"],
    );
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(
        ended
            .err
            .contains("600 rpm not reached within 5.4 s, the highest speed was "),
        "{ended:?}"
    );
    let read = client(&lab, &["read", "akd-1", "VL.FB_32", "r947[0]", "--json"]).ok();
    let read: Value = serde_json::from_str(&read.out).unwrap();
    assert!(
        read["parameters"][0]["value"].as_f64().unwrap().abs() < 1.0,
        "{read}"
    );
    assert_eq!(read["parameters"][1]["value"], 0.0, "no F702");
}

#[test]
fn what_cannot_be_written_fails_with_a_drive_too() {
    let lab = Lab::new("full");
    let _drive = simulate(&lab);
    for line in [
        "scan",
        "info akd-1",
        "read akd-1 DRV.ACC",
        "write akd-1 DRV.ACC=5000",
        "list akd-1 --filter DRV",
        "list akd-1 --filter DRV --values",
        "describe akd-1 DRV.ACC",
        "status akd-1",
        "faults akd-1",
        "backup akd-1",
        "monitor akd-1",
        "run akd-1 --velocity 60rpm --watchdog 15",
        "jog akd-1 --watchdog 15",
    ] {
        for more in ["", " --json"] {
            let script = format!(
                "{} -i ctl0 {line}{more} >/dev/full",
                built("profidrive").display()
            );
            let ended = lab.run(Side::Controller, "bash", ["-c", &script], SHORT);
            assert_eq!(ended.code, Some(1), "{line}{more}: {ended:?}");
            assert!(
                ended.err.contains("the output cannot be written: No space left"),
                "{line}{more}: {ended:?}"
            );
        }
    }
    let read = client(&lab, &["read", "akd-1", "VL.FB_32", "r947[0]", "--json"]).ok();
    let read: Value = serde_json::from_str(&read.out).unwrap();
    assert!(
        read["parameters"][0]["value"].as_f64().unwrap().abs() < 1.0,
        "{read}"
    );
    assert_eq!(read["parameters"][1]["value"], 0.0, "no F702");
}

#[test]
fn write_reports_the_save_that_is_not_sent() {
    let lab = Lab::new("save-not-sent");
    let _drive = simulate(&lab);
    // a virtual drive has no analogue input to zero
    let line = ["write", "akd-1", "DRV.ACC=5000rpm/s", "AIN.ZERO=1", "--save"];
    let refused = client(&lab, &line);
    assert_eq!(refused.code, Some(3), "{refused:?}");
    let why = "not saved: the save command was not sent because not every value is as planned, DRV.ACC (p2108) is lost";
    assert!(refused.err.contains(why), "{refused:?}");
    assert!(!refused.err.contains("saved in the drive"), "{refused:?}");
    let row = refused.out.lines().find(|line| line.starts_with("DRV.NVSAVE"));
    assert!(row.is_some_and(|row| row.ends_with("not sent")), "{refused:?}");
    let refused = client(&lab, &[&line[..], &["--json"]].concat());
    assert_eq!(refused.code, Some(3), "{refused:?}");
    let document: Value = serde_json::from_str(&refused.out).expect("a document");
    let changes = document["changes"].as_array().expect("changes").iter();
    let said =
        changes.map(|change| json!([change["name"], change["sent"], change["written"], change["saved"]]));
    let expected = [
        json!(["DRV.ACC", true, true, false]),
        json!(["AIN.ZERO", true, false, false]),
        json!(["DRV.NVSAVE", false, false, false]),
    ];
    assert_eq!(said.collect::<Vec<_>>(), expected);
}
