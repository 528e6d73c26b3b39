//! A client is killed, frozen or cut off at a random moment of a motion, on the wire: what `status` recommends afterwards
//! works and brings the axis to rest. A failure prints its case and its seed. The many cases are in virtual time, in a test
//! of the same name beside the command; a client killed at a serial line is in `serial_vlt`.

use std::time::{Duration, SystemTime};

use serde_json::Value;
use system_tests::{Finished, Lab, Running, Side, built, client, simulate, wait_until};

const SHORT: Duration = Duration::from_secs(30);
/// The latest moment of an accident, after the axis came into operation.
const LATEST: u64 = 1000;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Accident {
    Killed,
    Frozen,
    CableOut,
    /// The interface of the client is switched off.
    InterfaceDown,
}

struct Case {
    model: &'static str,
    /// What it does without its controller, and what else the motion needs.
    settings: &'static [&'static str],
    motion: &'static [&'static str],
    accident: Accident,
    /// What the message of the lost connection must say, by these settings.
    message: &'static str,
}

/// Commands that move an axis; `home` has no trial.
const MOTIONS: [&str; 3] = ["run", "move", "jog"];

const RUN: &[&str] = &["run", "drive-1", "--velocity", "600rpm", "--may-run-on"];

const CASES: [Case; 5] = [
    Case {
        model: "akd",
        settings: &["930=2"],
        motion: &["move", "drive-1", "--to", "1000rev", "--velocity", "300rpm"],
        accident: Accident::Killed,
        message: "",
    },
    Case {
        model: "vacon",
        settings: &["ID733=0"],
        motion: &["jog", "drive-1", "--for", "60s", "--may-run-on"],
        accident: Accident::Killed,
        message: "",
    },
    Case {
        model: "vlt",
        settings: &["8-04=5"],
        motion: RUN,
        accident: Accident::CableOut,
        message: "the drive stops after 1 s (8-04 is Stop and trip)",
    },
    Case {
        model: "vlt",
        settings: &["8-04=0"],
        motion: RUN,
        accident: Accident::InterfaceDown,
        message: "network interface `ctl0` is down; the drive keeps turning (8-04 is Off)",
    },
    Case {
        model: "vacon",
        settings: &["ID733=0"],
        motion: RUN,
        accident: Accident::Frozen,
        message: "it is not known whether the drive stops (ID 733 is No action)",
    },
];

/// Returns the report of `status`, once the drive can be reached again and has no owner.
fn report(lab: &Lab, at: &str) -> Value {
    let mut last = None;
    let found = wait_until(SHORT, || {
        let finished = client(lab, &["status", "drive-1", "--json"]);
        let line = finished.out.lines().next().unwrap_or_default();
        let report: Option<Value> = serde_json::from_str(line).ok();
        let report = report.filter(|report| report["controller"]["connected"] == false);
        let found = report.filter(|_| matches!(finished.code, Some(0 | 5)));
        let done = found.is_some();
        last = Some((finished, found));
        done
    });
    match last {
        Some((_, Some(report))) if found => report,
        other => panic!("{at}: no report: {other:?}"),
    }
}

/// Returns the commands that a report recommends, in its actions and in its text. What begins a motion is tried without
/// one.
fn advice(report: &Value) -> Vec<String> {
    let list = |name: &str| report[name].as_array().cloned().unwrap_or_default();
    let mut texts: Vec<Value> = list("notes").iter().map(|note| note["next"].clone()).collect();
    texts.push(report["next"].clone());
    let quoted = texts.iter().filter_map(Value::as_str).flat_map(|text| {
        let quoted = text.split('`').skip(1).step_by(2);
        quoted.map(str::to_owned).collect::<Vec<_>>()
    });
    let actions = list("actions");
    let actions = actions.iter().filter_map(|action| action["command"].as_str());
    let mut all: Vec<String> = Vec::new();
    for command in actions.map(str::to_owned).chain(quoted) {
        let Some(command) = command.strip_prefix("profidrive ") else {
            continue;
        };
        let verb = command.split(' ').next().unwrap_or_default();
        let command = if MOTIONS.contains(&verb) {
            let tried = command.replace("SPEED", "60rpm").replace("POSITION", "1rev");
            format!("{tried} --may-run-on --dry-run")
        } else {
            command.to_owned()
        };
        if !all.contains(&command) {
            all.push(command);
        }
    }
    all
}

/// The client ended by itself with a lost connection: exit code 4, the drive, and what the drive does.
fn lost(run: Running, message: &str, at: &str) {
    let ended: Finished = run.finish(SHORT);
    assert_eq!(ended.code, Some(4), "{at}: {ended:?}");
    let said = ended.err.contains("drive-1: connection lost: ") && ended.err.contains(message);
    assert!(said, "{at}: {ended:?}");
}

fn try_out(case: &Case, moment: Duration, at: &str) {
    let lab = Lab::new("campaign");
    let name = ["--name", "drive-1", "--ip", "192.168.77.50/24"];
    let _drive = simulate(&lab, &[&["--model", case.model], &name[..]].concat());
    client(&lab, &[&["write", "drive-1"], case.settings].concat()).ok();
    // a machine at work may pause for longer than three update times; what is tested here is not that
    let patient = ["--watchdog", "15"];
    if case.motion[0] == "move" {
        client(&lab, &[&["home", "drive-1"], &patient[..]].concat()).ok();
    }
    let line = [&["-i", "ctl0"], case.motion, &patient].concat();
    let mut run = lab.spawn(Side::Controller, built("profidrive"), line);
    run.wait_for("S4 operation", SHORT);
    // any moment will do
    std::thread::sleep(moment);
    match case.accident {
        Accident::Killed => run.signal("KILL"),
        Accident::Frozen => {
            run.signal("STOP");
            // the drive counts it as lost; then it wakes up to that
            report(&lab, at);
            run.signal("CONT");
            lost(run, case.message, at);
        }
        Accident::CableOut | Accident::InterfaceDown => {
            let side = match case.accident {
                Accident::CableOut => Side::Device,
                _ => Side::Controller,
            };
            lab.link(side, false);
            lost(run, case.message, at);
            lab.link(side, true);
        }
    }
    let mut found = Value::Null;
    let rests = wait_until(SHORT, || {
        found = report(&lab, at);
        let commands = advice(&found);
        for command in &commands {
            let done = client(&lab, &command.split(' ').collect::<Vec<_>>());
            // its exit code is that of what it finds
            let reads = command.starts_with("status");
            assert!(
                done.code == Some(0) || reads,
                "{at}: `{command}` of {found}: {done:?}"
            );
        }
        let speed = found["speed_actual"]["value"].as_f64().unwrap_or(f64::MAX);
        let tried = |command: &String| command.ends_with("--dry-run");
        commands.iter().all(tried) && speed.abs() < 1.0
    });
    assert!(rests, "{at}: {found}");
    assert_eq!(found["cause"], "no-controller", "{at}: {found}");
}

#[test]
fn advice_of_status_stops_an_ownerless_axis() {
    let clock = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    let seed = clock.map_or(1, |time| u64::from(time.subsec_nanos()));
    let mut random = seed;
    for case in &CASES {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let moment = Duration::from_millis((random >> 33) % LATEST);
        let (model, settings, accident) = (case.model, case.settings, case.accident);
        let at = format!("seed {seed}: {model} {settings:?} {accident:?} after {moment:?}");
        eprintln!("{at}");
        try_out(case, moment, &at);
    }
}
