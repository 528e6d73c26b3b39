//! The program at both ends of a cable: what a user does, in the order a user does it.

use std::time::Duration;

use profile::parameter::Dialect;
use serde_json::Value;
use system_tests::{Lab, Side, built, client, compare, judge, memory, simulate, wait_until};

const SHORT: Duration = Duration::from_secs(20);

#[track_caller]
fn json(lab: &Lab, arguments: &[&str]) -> Value {
    let mut all = vec!["--json"];
    all.extend(arguments);
    let finished = client(lab, &all).ok();
    serde_json::from_str(&finished.out).unwrap_or_else(|e| panic!("{e}: {}", finished.out))
}

/// The demo needs no network; its frames are not checked elsewhere.
#[test]
fn the_dissector_accepts_the_traffic_of_the_demo() {
    let file = memory::scratch("demo.pcapng");
    let _ = std::fs::remove_file(&file);
    let output = std::process::Command::new(built("profidrive"))
        .args(["demo", "--fast", "--pcap"])
        .arg(&file)
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    judge::judge(&file).clean().saw("pn_dcp", 2).saw("pn_io", 500);
    assert!(compare::same_parameters(&file, &Dialect::AKD) >= 30);
}

#[test]
fn from_an_unnamed_drive_to_a_turning_axis_and_over_a_restart() {
    let lab = Lab::new("command-line");
    let state = lab.folder().join("state");
    let state = ["--state", state.to_str().unwrap()];
    let capture = lab.capture("traffic");
    let mac = "02:50:4e:00:00:01";
    let mut drive = simulate(&lab, &[&["--mac", mac], &state[..]].concat());

    let found = json(&lab, &["scan"]).to_string();
    assert!(found.contains(mac), "{found}");
    client(&lab, &["name", mac, "akd-1"]).ok();
    client(&lab, &["ip", "akd-1", "192.168.77.50/24"]).ok();
    lab.run(
        Side::Controller,
        "ping",
        ["-c", "1", "-W", "2", "192.168.77.50"],
        SHORT,
    )
    .ok();
    client(&lab, &["blink", "akd-1", "--for", "1s"]).ok();
    let info = client(&lab, &["info", "akd-1"]).ok().out;
    assert!(info.contains("AKD-P00306"), "{info}");
    assert!(info.contains("none: no controller is connected"), "{info}");

    for address in ["akd-1", "192.168.77.50", mac] {
        let read = client(&lab, &["read", address, "DRV.ACC", "p930", "r947[0]"])
            .ok()
            .out;
        assert!(read.contains("DRV.ACC"), "{read}");
    }
    client(&lab, &["write", "akd-1", "DRV.ACC=5000rpm/s"]).ok();
    let read = client(&lab, &["read", "akd-1", "DRV.ACC"]).ok().out;
    assert!(read.contains("5000"), "{read}");
    client(&lab, &["list", "akd-1", "--filter", "DRV."]).ok();
    client(&lab, &["describe", "akd-1", "DRV.ACC"]).ok();
    client(&lab, &["write", "akd-1", "DRV.NVSAVE=1"]).ok();

    let run = client(&lab, &["run", "akd-1", "--velocity", "60rpm", "--for", "2s"]).ok();
    assert!(run.out.contains("S4") || run.err.contains("S4"), "{run:?}");

    // killed without a chance to say anything: name, address and saved parameters are still there
    drive.kill();
    let _drive = simulate(&lab, &[&["--mac", mac], &state[..]].concat());
    let read = client(&lab, &["read", "akd-1", "DRV.ACC"]).ok().out;
    assert!(read.contains("5000"), "{read}");

    let file = capture.stop();
    judge::judge(&file).clean().saw("pn_dcp", 10).saw("pn_io", 30);
    assert!(compare::same_parameters(&file, &Dialect::AKD) >= 10);
}

#[test]
fn errors_are_printed() {
    let lab = Lab::new("command-line-errors");
    let drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    for (arguments, code, words) in [
        (&["read", "akd-2", "DRV.ACC"][..], 4, "akd-1"),
        (&["read", "akd-1", "DRV.AC"], 2, "DRV.ACC"),
        (&["write", "akd-1", "DRV.ACC=1e9rpm/s"], 2, "rpm/s"),
        (&["write", "akd-1", "p964[0]=1"], 2, "read"),
        (&["ip", "akd-1", "192.168.77.11/24"], 3, "this machine's own"),
        (
            &["run", "akd-1", "--velocity", "60rpm", "--cycle", "5ms"],
            2,
            "5 ms does not exist",
        ),
        (
            &["run", "akd-1", "--velocity", "60rpm", "--cycle", "4ms"],
            3,
            "does not offer this update time",
        ),
        (&["run", "akd-1", "--velocity", "3001rpm"], 6, "3000 rpm"),
        (
            &["run", "akd-1", "--velocity", "60rpm", "--for", "-1s"],
            2,
            "a time is 0 or longer",
        ),
        (
            &["reset", "akd-1", "--mode", "engineering", "--yes"],
            3,
            "`--mode communication` is offered by every drive",
        ),
        (
            &["reset", "akd-1", "--mode", "application"],
            6,
            "no terminal to confirm on",
        ),
    ] {
        let finished = client(&lab, arguments);
        assert_eq!(finished.code, Some(code), "{arguments:?}: {}", finished.err);
        assert!(finished.err.contains(words), "{arguments:?}: {}", finished.err);
    }
    let listened = client(&lab, &["scan", "--for", "200ms"]).ok();
    assert!(listened.out.contains("akd-1"), "{}", listened.out);
    drop(drive);
    let no_device = client(&lab, &["scan", "--for", "200ms"]);
    assert_eq!(no_device.code, Some(4), "{}", no_device.err);
    assert!(no_device.err.contains("no station answered"), "{}", no_device.err);
    let finished = lab.run(
        Side::Controller,
        built("profidrive"),
        ["-i", "nosuch0", "scan"],
        SHORT,
    );
    assert!(finished.err.contains("ctl0"), "{}", finished.err);
}

/// A setting that has its value is left alone, what acts is not, nor what stands behind something that may change it.
#[test]
fn what_the_drive_has_already_is_not_written() {
    let lab = Lab::new("command-line-same");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    let write = |assignments: &[&str]| json(&lab, &[&["write", "akd-1"], assignments].concat());
    let column = |written: &Value, name: &str| -> Vec<bool> {
        let changes = written["changes"].as_array().unwrap();
        changes
            .iter()
            .map(|change| change[name].as_bool().unwrap())
            .collect()
    };
    let first = write(&["DRV.ACC=5000rpm/s", "DRV.DEC=3000rpm/s"]);
    assert_eq!(column(&first, "written"), [true, false], "{first}");
    assert_eq!(column(&first, "same"), [false, true], "{first}");
    let table = client(&lab, &["write", "akd-1", "DRV.ACC=5000rpm/s"]).ok().out;
    assert!(table.contains("already 5000"), "{table}");
    let window = write(&["MT.NUM=1", "MT.LOAD=1", "MT.P=0", "MT.SET=1"]);
    assert_eq!(column(&window, "written"), [true; 4], "{window}");
    let again = write(&["DRV.CLRFAULTS=1"]);
    assert_eq!(column(&again, "written"), [true], "{again}");
}

#[test]
fn simulate_outlives_its_interface() {
    let lab = Lab::new("command-line-link");
    let mut drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    client(&lab, &["write", "akd-1", "DRV.ACC=5000rpm/s"]).ok();
    for round in 1..=2 {
        lab.link(Side::Device, false);
        let down = wait_until(SHORT, || drive.err().matches("is down").count() == round);
        assert!(down, "{}", drive.err());
        assert_eq!(client(&lab, &["read", "akd-1", "DRV.ACC"]).code, Some(4));
        lab.link(Side::Device, true);
        let back = wait_until(SHORT, || drive.err().matches("dev0 is back").count() == round);
        assert!(back, "{}", drive.err());
        // the same drive, not a new one
        let read = client(&lab, &["read", "akd-1", "DRV.ACC"]).ok().out;
        assert!(read.contains("5000"), "{read}");
    }
    assert!(drive.status().is_none());
    drive.interrupt(Duration::from_secs(5)).ok();
}

#[test]
fn a_drive_at_work_is_renamed_addressed_and_reset_by_force_only() {
    let lab = Lab::new("command-line-owner");
    // a device that leaves the refusal to the client
    let accepts = ["--dcp-in-operation", "accept"];
    let _drive = simulate(
        &lab,
        &[&["--name", "akd-1", "--ip", "192.168.77.50/24"][..], &accepts].concat(),
    );
    let run = [
        "-i",
        "ctl0",
        "run",
        "akd-1",
        "--velocity",
        "60rpm",
        "--for",
        "60s",
    ];
    let mut owner = lab.spawn(Side::Controller, built("profidrive"), run);
    owner.wait_for("S4", SHORT);
    for line in [
        &["name", "akd-1", "akd-2"][..],
        &["ip", "akd-1", "192.168.77.51/24"],
        &["reset", "akd-1", "--mode", "communication", "--yes"],
    ] {
        let refused = client(&lab, line);
        assert_eq!(refused.code, Some(6), "{line:?}: {}", refused.err);
        assert!(
            refused.err.contains("controller \"profidrive\" is running it"),
            "{}",
            refused.err
        );
        assert!(refused.err.contains("--force"), "{}", refused.err);
    }
    // a parameter is written beside it, and whose axis that concerns is said
    let written = client(&lab, &["write", "akd-1", "DRV.ACC=7000"]).ok();
    let words = "controller \"profidrive\" is connected to akd-1";
    assert!(written.err.contains(words), "{written:?}");
    let same = client(&lab, &["write", "akd-1", "DRV.ACC=7000"]).ok();
    assert!(!same.err.contains(words), "nothing was written: {same:?}");
    assert!(owner.status().is_none(), "{}", owner.err());
    client(&lab, &["name", "akd-1", "akd-2", "--force"]).ok();
    let finished = owner.finish(SHORT);
    assert_ne!(finished.code, Some(0), "its connection was cut: {}", finished.err);
    client(&lab, &["read", "akd-2", "DRV.ACC"]).ok();
}

/// Without a controller too: a reset while the power stage is on would take the parameters from under a motor.
#[test]
fn a_drive_that_is_on_or_turns_is_reset_by_force_only() {
    let lab = Lab::new("command-line-reset");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    let reset = ["reset", "akd-1", "--mode", "application", "--yes"];
    client(
        &lab,
        &["write", "akd-1", "DRV.ACC=7000", "DRV.CMDSOURCE=0", "DRV.EN=1"],
    )
    .ok();
    for (change, words) in [
        ("DRV.ACC=8000", "akd-1 is not reset: its power stage is on"),
        ("DRV.DIS=1", "akd-1 is not reset: its axis turns at"),
    ] {
        client(&lab, &["write", "akd-1", change]).ok();
        if change == "DRV.DIS=1" {
            client(&lab, &["inject", "akd-1", "load=0.5Nm"]).ok();
        }
        let refused = client(&lab, &reset);
        assert_eq!(refused.code, Some(6), "{refused:?}");
        assert!(refused.err.contains(words), "{refused:?}");
        assert!(
            refused.err.contains("profidrive stop akd-1 --disable"),
            "{refused:?}"
        );
        let kept = client(&lab, &["read", "akd-1", "DRV.ACC"]).ok();
        assert!(kept.out.contains("8000"), "{kept:?}");
    }
    client(&lab, &[&reset[..], &["--force"]].concat()).ok();
    let reset = client(&lab, &["read", "akd-1", "DRV.ACC"]).ok();
    assert!(reset.out.contains("3000"), "{reset:?}");
}

/// Saved, changed, compared, restored, saved again; interrupted; faults.
#[test]
fn settings_are_saved_compared_and_brought_back() {
    let lab = Lab::new("command-line-backup");
    let mut drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    let path = |name: &str| lab.folder().join(name).to_str().unwrap().to_owned();
    let (first, second) = (path("press.backup"), path("again.backup"));
    let start = std::time::Instant::now();
    client(&lab, &["backup", "akd-1", "-o", &first]).ok();
    // the promise is 1 s; a machine at work with other tests gets more
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
    let saved = std::fs::read_to_string(&first).unwrap();
    assert!(saved.contains("\np2108 DRV.ACC = 3000 rpm/s "), "{saved}");
    client(&lab, &["backup", "akd-1", "-o", &first]).ok();
    assert_eq!(std::fs::read_to_string(&first).unwrap(), saved);
    client(&lab, &["diff", &first, "akd-1"]).ok();

    client(
        &lab,
        &[
            "write",
            "akd-1",
            "DRV.ACC=5000rpm/s",
            "USER.INT1=7",
            "PN.VELSCALING=1000",
        ],
    )
    .ok();
    // a file name without a folder could be the name of a drive
    let neither = client(&lab, &["diff", "akd-2.backup", "akd-1"]);
    assert_eq!(neither.code, Some(4), "{neither:?}");
    assert!(
        neither.err.contains("there is no file akd-2.backup either"),
        "{neither:?}"
    );
    let differs = client(&lab, &["diff", &first, "akd-1"]);
    assert_eq!(differs.code, Some(5), "{differs:?}");
    for words in ["DRV.ACC", "3000", "5000", "rpm/s", "USER.INT1"] {
        assert!(differs.out.contains(words), "{differs:?}");
    }
    let found = client(&lab, &["--json", "diff", "akd-1", &first]);
    let found: Value = serde_json::from_str(&found.out).unwrap_or_else(|e| panic!("{e}: {}", found.out));
    let found = found["differences"].as_array().unwrap();
    let names: Vec<&str> = found.iter().filter_map(|one| one["name"].as_str()).collect();
    assert_eq!(names, ["DRV.ACC", "USER.INT1", "PN.VELSCALING"]);
    assert_eq!(found[0]["left"]["value"], 5000.0, "{found:?}");

    // shown, not done
    let plan = client(&lab, &["restore", "akd-1", &first, "--dry-run"]).ok();
    assert!(
        plan.out.contains("DRV.ACC") && plan.err.contains("dry run"),
        "{plan:?}"
    );
    let part = client(&lab, &["restore", "akd-1", &first, "--only", "USER.*"]).ok();
    assert!(part.err.contains("1 of 1 written and read back"), "{part:?}");
    assert_eq!(client(&lab, &["diff", &first, "akd-1"]).code, Some(5));
    let whole = client(&lab, &["restore", "akd-1", &first, "--save"]).ok();
    assert!(whole.err.contains("saved in the drive"), "{whole:?}");
    client(&lab, &["backup", "akd-1", "-o", &second]).ok();
    assert_eq!(std::fs::read_to_string(&second).unwrap(), saved);
    // the way back leads to what was there before
    let back = path("press.backup.before-2");
    let text = std::fs::read_to_string(&back).unwrap();
    assert!(
        text.contains("p2108 DRV.ACC = 5000 rpm/s") && text.contains("# complete"),
        "{text}"
    );
    client(&lab, &["restore", "akd-1", &back]).ok();
    let read = client(&lab, &["read", "akd-1", "DRV.ACC"]).ok().out;
    assert!(read.contains("5000"), "{read}");

    // what cannot be used is reported, with its line, and nothing happens
    std::fs::write(&second, saved.replace("DRV.ACC = 3000 rpm/s", "DRV.ACC = 3000 A")).unwrap();
    let line = 1 + saved.lines().position(|line| line.starts_with("p2108 ")).unwrap();
    std::fs::write(path("letter"), "Dear Sir or Madam\n").unwrap();
    std::fs::write(path("cut"), saved.trim_end()).unwrap();
    for (arguments, code, words) in [
        (
            vec!["restore", "akd-1", &second],
            1,
            format!("line {line}: DRV.ACC (p2108): `A` is a unit of current"),
        ),
        (
            vec!["restore", "akd-1", &path("nothing")],
            1,
            "there is no such file".into(),
        ),
        (
            vec!["diff", "akd-1", &path("letter")],
            1,
            "line 1: not a backup".into(),
        ),
        (
            vec!["restore", "akd-1", &path("cut")],
            1,
            "if the file is complete, end its last line with a line break".into(),
        ),
        (
            vec!["backup", "akd-1", "-o", &path("letter")],
            1,
            "is not a backup and is not replaced".into(),
        ),
        (
            vec!["restore", "akd-1", &first, "--only", "NOSUCH*"],
            2,
            "nothing in the file fits".into(),
        ),
    ] {
        let finished = client(&lab, &arguments);
        assert_eq!(finished.code, Some(code), "{arguments:?}: {}", finished.err);
        assert!(finished.err.contains(&words), "{arguments:?}: {}", finished.err);
    }
    assert_eq!(
        std::fs::read_to_string(path("letter")).unwrap(),
        "Dear Sir or Madam\n"
    );

    // what the drive cannot have is reported by the exit code, after the rest was done
    std::fs::write(
        &second,
        saved
            .replace("DRV.ACC = 3000 rpm/s", "DRV.ACC = 900000000 rpm/s")
            .replace("DRV.DEC = 3000 rpm/s", "DRV.DEC = 2000 rpm/s"),
    )
    .unwrap();
    for arguments in [vec!["--dry-run"], vec![]] {
        let line = [vec!["restore", "akd-1", &second], arguments].concat();
        let refused = client(&lab, &line);
        assert_eq!(refused.code, Some(5), "{refused:?}");
        assert!(
            refused
                .err
                .contains("1 value of the file cannot be written (DRV.ACC)"),
            "{refused:?}"
        );
    }
    let read = client(&lab, &["read", "akd-1", "DRV.DEC"]).ok().out;
    assert!(read.contains("2000"), "{read}");
    // by the tables of another model the drive has none of these settings
    let none = path("none.backup");
    let nothing = client(&lab, &["backup", "akd-1", "--model", "vacon", "-o", &none]);
    assert_eq!(nothing.code, Some(5), "{nothing:?}");
    assert!(
        nothing.err.contains("reports none of its settings"),
        "{nothing:?}"
    );
    assert!(!std::path::Path::new(&none).exists());

    let faults = client(&lab, &["faults", "akd-1", "--history"]).ok();
    assert!(faults.out.contains("no fault is present"), "{faults:?}");
    assert_eq!(
        json(&lab, &["faults", "akd-1"])["faults"],
        Value::Array(Vec::new())
    );
    client(&lab, &["ack", "akd-1", "--by-parameter"]).ok();

    // while the axis turns nothing is written, and the controller is named
    let mut run = lab.spawn(
        Side::Controller,
        built("profidrive"),
        [
            "-i",
            "ctl0",
            "run",
            "akd-1",
            "--velocity",
            "60rpm",
            "--for",
            "20s",
        ],
    );
    run.wait_for("S4", SHORT);
    let refused = client(&lab, &["restore", "akd-1", &first]);
    assert_eq!(refused.code, Some(6), "{refused:?}");
    assert!(refused.err.contains("is running it"), "{refused:?}");
    let refused = client(&lab, &["restore", "akd-1", &first, "--force"]);
    assert_eq!(refused.code, Some(6), "{refused:?}");
    assert!(
        refused.err.contains("the power stage is on, nothing is written"),
        "{refused:?}"
    );
    run.kill();
    // killed without a word: the drive finds out by its watchdog
    assert!(wait_until(SHORT, || {
        json(&lab, &["faults", "akd-1"])["faults"][0]["number"] == 702
    }));
    let faults = client(&lab, &["faults", "akd-1"]).ok();
    assert!(
        faults.out.contains("F702 ") && faults.out.contains("remedy"),
        "{faults:?}"
    );
    client(&lab, &["ack", "akd-1", "--by-parameter"]).ok();
    let faults = client(&lab, &["faults", "akd-1", "--history"]).ok();
    assert!(faults.out.contains("situation 1 (acknowledged)"), "{faults:?}");
    drive.kill();
}
