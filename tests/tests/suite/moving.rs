//! The commands that move an axis at both ends of a cable, and what happens when they are killed.

use std::time::Duration;

use serde_json::Value;
use system_tests::{Finished, Lab, Running, Side, built, judge, wait_until};

const SHORT: Duration = Duration::from_secs(20);

fn simulate(lab: &Lab) -> Running {
    system_tests::simulate(lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"])
}

/// A busy machine may pause for longer than three update times, which is not tested here.
fn patient<'a>(verb: &[&'a str]) -> Vec<&'a str> {
    let mut all = verb.to_vec();
    if matches!(verb[0], "run" | "move" | "home" | "task" | "ack" | "jog") {
        all.extend(["--watchdog", "15"]);
    }
    all
}

fn client(lab: &Lab, verb: &[&str]) -> Finished {
    system_tests::client(lab, &patient(verb))
}

fn start(lab: &Lab, verb: &[&str]) -> Running {
    let all = [&["-i", Side::Controller.interface()], patient(verb).as_slice()].concat();
    lab.spawn(Side::Controller, built("profidrive"), all)
}

/// Returns the sentence of `status`, and its cause; exit code 5 when something keeps the drive from running.
#[track_caller]
fn cause(lab: &Lab) -> String {
    let finished = client(lab, &["status", "akd-1", "--json"]);
    let first = finished.out.lines().next().unwrap_or_default();
    let status: Value = serde_json::from_str(first).unwrap_or_else(|e| panic!("{e}: {finished:?}"));
    let held = status["verdict"] == "held";
    assert_eq!(finished.code, Some(if held { 5 } else { 0 }), "{finished:?}");
    status["cause"].as_str().unwrap_or_default().to_owned()
}

#[track_caller]
fn number(lab: &Lab, name: &str) -> f64 {
    let finished = client(lab, &["read", "akd-1", name, "--json"]).ok();
    let found: Value = serde_json::from_str(&finished.out).unwrap();
    found["parameters"][0]["value"]
        .as_f64()
        .unwrap_or_else(|| panic!("{found}"))
}

/// Waits until the axis stands, as read from it.
#[track_caller]
fn at_rest(lab: &Lab) {
    for _ in 0..50 {
        if number(lab, "VL.FB_32").abs() < 0.5 && number(lab, "DRV.ACTIVE") == 0.0 {
            return;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("{} rpm", number(lab, "VL.FB_32"));
}

#[test]
fn a_killed_client_leaves_the_stop_to_the_watchdog() {
    let lab = Lab::new("moving-killed");
    let capture = lab.capture("traffic");
    let _drive = simulate(&lab);
    let mut run = start(&lab, &["run", "akd-1", "--velocity", "300rpm"]);
    run.wait_for("actual   299", SHORT);
    run.signal("KILL");
    at_rest(&lab);
    assert_eq!(number(&lab, "r947[0]"), 702.0);
    assert_eq!(cause(&lab), "fault");
    client(&lab, &["ack", "akd-1"]).ok();
    assert_eq!(cause(&lab), "no-controller");
    judge::judge(&capture.stop())
        .clean()
        .saw("pn_dcp", 2)
        .saw("pn_io", 10);
}

/// A suspended client keeps the UDP port on which a drive calls its controller. Its drive must be stopped all the same.
#[test]
fn a_drive_is_stopped_while_its_suspended_client_has_the_port_of_the_controller() {
    let lab = Lab::new("moving-suspended");
    let _drive = system_tests::simulate(
        &lab,
        &["--model", "vlt", "--name", "vlt-1", "--ip", "192.168.77.50/24"],
    );
    let status = || -> Value {
        let status = client(&lab, &["status", "vlt-1", "--json"]);
        let first = status.out.lines().next().unwrap_or_default();
        serde_json::from_str(first).unwrap_or_else(|error| panic!("{error}: {status:?}"))
    };
    let mut run = start(&lab, &["run", "vlt-1", "--velocity", "20%", "--may-run-on"]);
    run.wait_for("set    20.00 %", SHORT);
    run.signal("STOP");
    while status()["controller"]["connected"] != false {}
    assert_eq!(status()["cause"], "turns-alone");
    let stop = client(&lab, &["stop", "vlt-1"]).ok();
    assert!(stop.out.contains("it is at rest"), "{stop:?}");
    run.signal("CONT");
    assert_eq!(run.finish(SHORT).code, Some(4));
    assert_eq!(status()["cause"], "no-controller");
}

/// A command that reads may be there first: it has the port where it is free, and shares it. A foreign program does not,
/// which is said before anything is commanded. Parameters are not needed for a stop.
#[test]
fn a_stop_needs_the_port_of_the_controller_and_no_parameters() {
    let lab = Lab::new("moving-port");
    let _drive = system_tests::simulate(
        &lab,
        &["--model", "vlt", "--name", "vlt-1", "--ip", "192.168.77.50/24"],
    );
    client(&lab, &["write", "vlt-1", "8-04=0"]).ok();
    let mut monitor = start(&lab, &["monitor", "vlt-1", "--json"]);
    monitor.wait_for("vlt-1", SHORT);
    let mut run = start(&lab, &["run", "vlt-1", "--velocity", "20%", "--may-run-on"]);
    run.wait_for("set    20.00 %", SHORT);
    monitor.signal("INT");
    run.signal("KILL");
    // until its watchdog has elapsed the drive has a controller
    let ownerless = || {
        let status = client(&lab, &["status", "vlt-1", "--json"]);
        status.out.contains("\"connected\":false")
    };
    assert!(wait_until(SHORT, ownerless), "the connection is not lost");

    let bound = "import socket, time; s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); \
                 s.bind(('', 34964)); print('bound', flush=True); time.sleep(600)";
    let mut foreign = lab.spawn(Side::Controller, "python3", ["-c", bound]);
    foreign.wait_for("bound", SHORT);
    let refused = client(&lab, &["stop", "vlt-1"]);
    assert_eq!(refused.code, Some(4), "{refused:?}");
    for words in [
        "UDP port 34964",
        "in use by another program",
        "it is held by python3",
        "nothing was commanded",
    ] {
        assert!(refused.err.contains(words), "{words}: {refused:?}");
    }
    foreign.signal("KILL");
    foreign.finish(SHORT);

    client(&lab, &["inject", "vlt-1", "answers=silent"]).ok();
    let stop = client(&lab, &["stop", "vlt-1"]).ok();
    assert!(stop.out.contains("it is at rest"), "{stop:?}");
    assert!(
        stop.err.contains("parameters of vlt-1 cannot be read"),
        "{stop:?}"
    );
}

/// The speed that `jog` sets for its time is noted: after a kill it is reported, and the next jog puts it back.
#[test]
fn a_jog_that_is_killed_leaves_a_note_of_the_speed_before() {
    let lab = Lab::new("moving-jog-killed");
    let _drive = simulate(&lab);
    let before = number(&lab, "1004");
    let jog = ["jog", "akd-1", "--velocity", "90rpm", "--for"];
    let mut killed = start(&lab, &[jog.as_slice(), &["20s"]].concat());
    killed.wait_for("actual    9", SHORT);
    killed.signal("KILL");
    at_rest(&lab);
    assert!((number(&lab, "1004") - 90.0).abs() < 0.2);
    client(&lab, &["ack", "akd-1"]).ok();
    let status = client(&lab, &["status", "akd-1", "--short"]).ok();
    assert!(
        status.out.contains("of a jog whose program was killed")
            && status.out.contains("write akd-1 1004=60rpm"),
        "{status:?}"
    );
    let again = client(&lab, &[jog.as_slice(), &["100ms"]].concat()).ok();
    assert!(again.err.contains("was killed"), "{again:?}");
    assert_eq!(number(&lab, "1004"), before);
    // with the value that the drive has nothing is written, and nothing is to be put back
    let speed = format!("{before}rpm");
    let same = client(&lab, &["jog", "akd-1", "--velocity", &speed, "--for", "100ms"]).ok();
    assert!(!same.err.contains("again"), "{same:?}");
    let status = client(&lab, &["status", "akd-1", "--short"]).ok();
    assert!(!status.out.contains("killed"), "{status:?}");
}

/// What a note says that is cut is not known; `status` and every jog say so, and the note stays.
#[test]
fn a_note_of_the_jog_speed_that_is_cut_is_reported() {
    let lab = Lab::new("moving-jog-note");
    let _drive = simulate(&lab);
    let speed = ["--velocity", "90rpm"];
    let jog = |more: &[&str]| {
        let arguments = ["jog", "akd-1", "--for"];
        client(&lab, &[arguments.as_slice(), more].concat())
    };
    let mut killed = start(&lab, &["jog", "akd-1", "--for", "20s", speed[0], speed[1]]);
    killed.wait_for("actual    9", SHORT);
    killed.signal("KILL");
    at_rest(&lab);
    client(&lab, &["ack", "akd-1"]).ok();
    let notes = std::fs::read_dir(lab.folder().join("state/profidrive")).unwrap();
    let mut notes = notes.map(|entry| entry.unwrap().path());
    let note = notes
        .find(|path| path.to_string_lossy().ends_with("-1004"))
        .unwrap();
    let whole = std::fs::read_to_string(&note).unwrap();
    let cut = &whole[..whole.len() / 2];
    std::fs::write(&note, cut).unwrap();

    let file = note.display().to_string();
    let reported =
        |words: &str| words.contains("may have left another value in PNU 1004") && words.contains(&file);
    let status = client(&lab, &["status", "akd-1", "--short"]).ok();
    assert!(reported(&status.out), "{status:?}");
    assert!(status.out.contains(&format!("remove {file}")), "{status:?}");
    let status = client(&lab, &["status", "akd-1", "--json"]).ok();
    assert!(status.out.contains("\"note-unreadable\""), "{status:?}");
    for more in [
        &["100ms", "--dry-run"][..],
        &["100ms"],
        &["100ms", speed[0], "60rpm"],
    ] {
        let jog = jog(more).ok();
        assert!(reported(&jog.err), "{more:?}: {jog:?}");
        assert_eq!(std::fs::read_to_string(&note).unwrap(), cut, "{more:?}");
    }
}

#[test]
fn status_and_stop_beside_a_client_that_runs() {
    let lab = Lab::new("moving-stop");
    let capture = lab.capture("traffic");
    let _drive = simulate(&lab);
    assert_eq!(cause(&lab), "no-controller");
    let mut run = start(&lab, &["run", "akd-1", "--velocity", "300rpm"]);
    run.wait_for("actual   299", SHORT);
    assert_eq!(cause(&lab), "moves");
    let stop = client(&lab, &["stop", "akd-1"]).ok();
    assert!(stop.out.contains("it is at rest"), "{stop:?}");
    assert!(stop.err.contains("goes on commanding"), "{stop:?}");
    assert!(number(&lab, "VL.FB_32").abs() < 1.0);
    assert_eq!(number(&lab, "DRV.ACTIVE"), 1.0);
    // off: the drive reports it to its client, which does not switch it on again
    let stop = client(&lab, &["stop", "akd-1", "--disable"]).ok();
    assert!(stop.out.contains("the power stage is off"), "{stop:?}");
    let ended = run.finish(SHORT);
    assert_eq!(ended.code, Some(3), "{ended:?}");
    assert!(
        ended.err.contains("left operation without a command"),
        "{}",
        ended.err
    );
    at_rest(&lab);
    judge::judge(&capture.stop())
        .clean()
        .saw("pn_dcp", 2)
        .saw("pn_io", 10);
}

#[test]
fn from_velocity_mode_to_a_position_and_back() {
    let lab = Lab::new("moving-position");
    let capture = lab.capture("traffic");
    let _drive = simulate(&lab);
    let order = ["move", "akd-1", "--to", "5rev", "--velocity", "600rpm"];
    for verb in [&order[..], &["home", "akd-1"], &["task", "akd-1", "1"]] {
        let refused = client(&lab, verb);
        assert_eq!(refused.code, Some(6), "{refused:?}");
        assert!(
            refused.err.contains("profidrive write akd-1 930=2"),
            "{}",
            refused.err
        );
    }
    for verb in [&order[..], &["task", "akd-1", "1"]] {
        let refused = client(&lab, &[verb, &["--set-mode"]].concat());
        assert_eq!(refused.code, Some(6), "{refused:?}");
        assert!(refused.err.contains("not homed"), "{}", refused.err);
        assert!(!refused.err.contains("this moves the axis"), "{refused:?}");
    }
    assert_eq!(number(&lab, "930"), 1.0, "not changed without a request");

    // homed and moved with the mode lent and given back
    let homed = client(&lab, &["home", "akd-1", "--set-mode"]).ok();
    assert!(homed.err.contains("homed (ZSW1 bit 11)"), "{homed:?}");
    assert!(homed.err.contains("PNU 930 is 1 again"), "{homed:?}");
    assert!(homed.err.contains("PNU 922 is 1 again"), "{homed:?}");
    assert_eq!((number(&lab, "930"), number(&lab, "922")), (1.0, 1.0));

    client(&lab, &["write", "akd-1", "930=2"]).ok();
    client(&lab, &["home", "akd-1"]).ok();
    let dry = client(&lab, &[&order[..], &["--dry-run"]].concat()).ok();
    assert!(dry.err.contains("nothing moves"), "{dry:?}");
    let moved = client(&lab, &order).ok();
    assert!(
        moved.err.contains("telegram 9") && moved.err.contains("target reached (ZSW1 bit 10): 5 rev"),
        "{moved:?}"
    );
    let target = number(&lab, "PL.FB");
    assert!((target - 327_680.0).abs() < 700.0, "{target}");
    at_rest(&lab);
    assert_eq!(number(&lab, "r947[0]"), 0.0);

    let refused = client(&lab, &["move", "akd-1", "--to", "5rev", "--velocity", "4000rpm"]);
    assert_eq!(refused.code, Some(6), "{refused:?}");
    let refused = client(&lab, &["task", "akd-1", "9"]);
    assert_eq!(refused.code, Some(6), "{refused:?}");
    assert!(refused.err.contains("motion task 9 is empty"), "{refused:?}");
    assert!(!refused.err.contains("this moves the axis"), "{refused:?}");
    at_rest(&lab);
    let file = capture.stop();
    // it may last one cycle, which who looks from time to time can miss
    let arguments = ["decode".as_ref(), file.as_os_str()];
    let decoded = lab
        .run(Side::Controller, built("profidrive"), arguments, SHORT)
        .ok();
    assert!(
        decoded.out.contains("STW1 0x047F"),
        "the edge of the handshake: {}",
        decoded.out
    );
    judge::judge(&file).clean().saw("pn_dcp", 2).saw("pn_io", 10);
}

#[test]
fn a_move_that_is_interrupted_or_killed_ends_at_rest() {
    let lab = Lab::new("moving-doors");
    let capture = lab.capture("traffic");
    let _drive = simulate(&lab);
    client(&lab, &["write", "akd-1", "930=2"]).ok();
    client(&lab, &["home", "akd-1"]).ok();
    let order = ["move", "akd-1", "--to", "1000rev", "--velocity", "300rpm"];
    let mut moving = start(&lab, &order);
    moving.wait_for("ZSW1 0x4", SHORT);
    assert_eq!(cause(&lab), "moves");
    let ended = moving.interrupt(SHORT);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(
        ended
            .err
            .contains("stopped by Ctrl-C or a signal, the target was not reached"),
        "{ended:?}"
    );
    at_rest(&lab);
    assert_eq!(number(&lab, "r947[0]"), 0.0, "a ramp stop, no fault");

    let mut moving = start(&lab, &order);
    moving.wait_for("ZSW1 0x4", SHORT);
    moving.signal("KILL");
    at_rest(&lab);
    assert_eq!(number(&lab, "r947[0]"), 702.0);
    client(&lab, &["ack", "akd-1"]).ok();
    assert_eq!(cause(&lab), "no-controller");
    judge::judge(&capture.stop())
        .clean()
        .saw("pn_dcp", 2)
        .saw("pn_io", 10);
}

#[test]
fn a_signal_that_comes_twice_still_ends_in_a_ramp_stop() {
    let lab = Lab::new("twice");
    let capture = lab.capture("traffic");
    let _drive = simulate(&lab);
    let program = built("profidrive");
    let program = program.to_str().unwrap();
    for signal in ["TERM", "INT"] {
        let shown = lab.folder().join(format!("{signal}.out"));
        let shown = shown.display();
        // both at once to the whole group, as `timeout` and an impatient hand do
        let script = format!(
            "setsid {program} -i ctl0 run akd-1 --velocity 600rpm --for 20s --watchdog 15 >{shown} & \
             for _ in $(seq 300); do grep -q 'actual   600' {shown} && break; sleep 0.05; done; \
             kill -{signal} $!; kill -{signal} $!; sleep 0.05; kill -{signal} $!; wait $!"
        );
        let ended = lab.run(Side::Controller, "bash", ["-c", &script], SHORT);
        assert!(ended.err.contains("axis at rest"), "{signal}: {ended:?}");
        assert!(
            ended.err.contains("stopped before the end"),
            "{signal}: {ended:?}"
        );
        assert_eq!(number(&lab, "r947[0]"), 0.0, "{signal}: no F702");
    }
    judge::judge(&capture.stop())
        .clean()
        .saw("pn_dcp", 2)
        .saw("pn_io", 10);
}

/// A long ramp: the second signal, more than a second after the first, is a quick stop and no sudden end (F702).
#[test]
fn a_second_signal_during_a_long_ramp_is_a_quick_stop() {
    let lab = Lab::new("second-signal");
    let _drive = simulate(&lab);
    client(&lab, &["write", "akd-1", "DRV.DEC=40rpm/s"]).ok();
    for signal in ["TERM", "INT"] {
        let run = ["run", "akd-1", "--velocity", "600rpm", "--for", "60s"];
        let mut run = start(&lab, &run);
        run.wait_for("set   600.07 rpm  actual   600", SHORT);
        run.signal(signal);
        std::thread::sleep(Duration::from_millis(1300));
        run.wait_for("still stopping along the ramp", SHORT);
        run.signal(signal);
        let ended = run.finish(Duration::from_secs(5));
        assert_eq!(ended.code, Some(1), "{signal}: not finished: {ended:?}");
        assert!(
            ended.err.contains("second signal: quick stop (OFF3)"),
            "{signal}: {ended:?}"
        );
        assert!(ended.err.contains("axis at rest"), "{signal}: {ended:?}");
        assert_eq!(number(&lab, "r947[0]"), 0.0, "{signal}: no F702");
        at_rest(&lab);
    }
}

/// Programs see that a run has not had its time, and what taking the axis has changed.
#[test]
fn a_run_that_a_signal_ends_early_is_no_success_for_programs() {
    let lab = Lab::new("early");
    let _drive = simulate(&lab);
    client(&lab, &["write", "akd-1", "922=9"]).ok();
    let call = ["run", "akd-1", "--velocity", "60rpm", "--for", "30s", "--json"];
    let mut run = start(&lab, &call);
    run.wait_for("\"state\":\"S4\"", SHORT);
    let ended = run.interrupt(SHORT);
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(ended.out.contains("\"interrupted\":true"), "{ended:?}");
    assert!(
        ended
            .out
            .contains("\"telegram_changed\":{\"before\":9,\"kept\":true,\"now\":1}"),
        "{ended:?}"
    );
    at_rest(&lab);
}

/// `timeout` of the coreutils sends its signal to the program and to its whole group.
#[test]
fn timeout_ends_a_run_along_its_ramp_however_long() {
    let lab = Lab::new("timeout");
    let _drive = simulate(&lab);
    client(&lab, &["write", "akd-1", "DRV.DEC=200rpm/s"]).ok();
    let program = built("profidrive");
    let mut call = vec!["4", program.to_str().unwrap(), "-i", Side::Controller.interface()];
    call.extend(patient(&["run", "akd-1", "--velocity", "600rpm"]));
    let ended = lab.run(Side::Controller, "timeout", &call, SHORT);
    assert!(ended.err.contains("axis at rest"), "{ended:?}");
    assert!(!ended.err.contains("quick stop used"), "{ended:?}");
    assert_eq!(number(&lab, "r947[0]"), 0.0, "no F702");
    at_rest(&lab);
}

/// `| head`: nothing runs on unseen.
#[test]
fn a_reader_that_goes_away_stops_the_axis_along_its_ramp() {
    let lab = Lab::new("head");
    let _drive = simulate(&lab);
    let program = built("profidrive");
    let script = format!(
        "{} -i ctl0 run akd-1 --velocity 600rpm --for 60s --watchdog 15 | head -n 2",
        program.display()
    );
    let ended = lab.run(Side::Controller, "bash", ["-c", &script], SHORT);
    assert_eq!(ended.out.lines().count(), 2, "{ended:?}");
    assert!(
        ended.err.contains("the output has no reader any more: stopped"),
        "{ended:?}"
    );
    assert!(ended.err.contains("axis at rest, control released"), "{ended:?}");
    assert_eq!(number(&lab, "r947[0]"), 0.0, "no F702");
    at_rest(&lab);
}

#[test]
fn a_run_stopped_before_its_speed_is_reported() {
    let lab = Lab::new("unreached");
    let _drive = simulate(&lab);
    client(&lab, &["write", "akd-1", "DRV.ACC=20rpm/s"]).ok();
    let mut run = start(&lab, &["run", "akd-1", "--velocity", "600rpm"]);
    run.wait_for("S4 operation", SHORT);
    let ended = run.interrupt(SHORT);
    assert!(
        ended
            .err
            .contains("600 rpm was not reached when the stop came, it was "),
        "{ended:?}"
    );
    assert!(ended.err.contains("axis at rest"), "{ended:?}");
    at_rest(&lab);
}

/// Enabled by its service channel: whatever moves an axis refuses before it takes control.
#[test]
fn local_operation_is_respected() {
    let lab = Lab::new("local");
    let _drive = simulate(&lab);
    client(&lab, &["write", "akd-1", "DRV.CMDSOURCE=0", "DRV.EN=1"]).ok();
    let orders = [
        &["run", "akd-1", "--velocity", "60rpm", "--for", "300ms"][..],
        &["jog", "akd-1", "--velocity", "60rpm"],
        &[
            "move",
            "akd-1",
            "--to",
            "1rev",
            "--velocity",
            "60rpm",
            "--set-mode",
        ],
        &["home", "akd-1", "--set-mode"],
        &["task", "akd-1", "1", "--set-mode"],
    ];
    for order in orders {
        let refused = client(&lab, order);
        assert_eq!(refused.code, Some(6), "{order:?}: {refused:?}");
        assert!(
            refused
                .err
                .contains("is in local operation (ZSW1 bit 9 is 0): its service channel has enabled it")
                && refused.err.contains("`profidrive stop akd-1 --disable`"),
            "{order:?}: {refused:?}"
        );
        assert!(!refused.err.contains("this moves the axis"), "{refused:?}");
    }
    assert_eq!(number(&lab, "DRV.ACTIVE"), 1.0, "left alone");
    assert_eq!(number(&lab, "r947[0]"), 0.0);
    assert_eq!(number(&lab, "930"), 1.0);
}

/// 4 mm for a turn of the motor, by the machine file.
#[test]
fn a_move_in_the_unit_of_the_load() {
    let lab = Lab::new("moving-units");
    let _drive = simulate(&lab);
    client(&lab, &["write", "akd-1", "930=2"]).ok();
    client(&lab, &["home", "akd-1"]).ok();
    let file = system_tests::memory::scratch("units.toml");
    let machine = "[[drive]]\nname = \"akd-1\"\nmodel = \"akd\"\npitch = \"20mm\"\ngear = \"5:1\"\n";
    std::fs::write(&file, machine).unwrap();
    let file = file.display().to_string();
    let order = [
        "move",
        "akd-1",
        "--to",
        "10mm",
        "--velocity",
        "20mm/s",
        "--machine",
        &file,
    ];
    let moved = client(&lab, &order).ok();
    for line in [
        "10 mm is 2.5 rev (4 mm for a turn of the motor)",
        "20 mm/s is 300 rpm",
        "the load is at 10 mm",
    ] {
        assert!(moved.err.contains(line), "{line}: {moved:?}");
    }
    let beyond = client(
        &lab,
        &[
            "move",
            "akd-1",
            "--to",
            "10cm",
            "--velocity",
            "300rpm",
            "--machine",
            &file,
        ],
    );
    assert_eq!(beyond.code, Some(2), "{beyond:?}");
    at_rest(&lab);
}

/// A load pulls the axis away as soon as the power stage is off: the target was reached all the same.
#[test]
fn a_move_reports_its_positions() {
    let lab = Lab::new("moving-load");
    let _drive = simulate(&lab);
    client(&lab, &["write", "akd-1", "930=2"]).ok();
    client(&lab, &["home", "akd-1"]).ok();
    let order = ["move", "akd-1", "--to", "20rev", "--velocity", "300rpm"];
    let mut moving = start(&lab, &order);
    moving.wait_for("ZSW1 0x4", SHORT);
    client(&lab, &["inject", "akd-1", "load=1.0Nm"]).ok();
    let moved = moving.finish(SHORT);
    let reached = ["20 rev", "20.00", "19.99"].map(|at| format!("target reached (ZSW1 bit 10): {at}"));
    assert!(reached.iter().any(|text| moved.err.contains(text)), "{moved:?}");
    assert!(moved.err.contains("it has left the target since"), "{moved:?}");
    assert_eq!(moved.code, Some(6), "{moved:?}");
}

/// What a command lends it gives back.
#[test]
fn a_jog_leaves_the_jog_speed_as_it_was() {
    let lab = Lab::new("jog-back");
    let _drive = simulate(&lab);
    client(&lab, &["write", "akd-1", "1004=12rpm"]).ok();
    let before = number(&lab, "1004");
    let jog = ["jog", "akd-1", "--velocity", "120rpm", "--for", "500ms"];
    let jogged = client(&lab, &jog).ok();
    assert!(jogged.err.contains("jogs at 120."), "{jogged:?}");
    assert!(jogged.err.contains("(p1004) is 12"), "{jogged:?}");
    assert_eq!(number(&lab, "1004"), before);
    at_rest(&lab);
}

#[test]
fn a_real_time_jog_changes_no_parameter() {
    let lab = Lab::new("jog-real-time");
    let _drive = simulate(&lab);
    let jog = [
        "jog",
        "akd-1",
        "--velocity=-120rpm",
        "--real-time",
        "--for",
        "500ms",
    ];
    let refused = client(&lab, &jog);
    assert_eq!(refused.code, Some(6), "velocity mode: {refused:?}");
    client(&lab, &["write", "akd-1", "930=2"]).ok();
    let before = number(&lab, "1004");
    let jogged = client(&lab, &jog).ok();
    assert!(jogged.out.contains("STW1 0x343F"), "{jogged:?}");
    assert!(jogged.err.contains("telegram 1 -> 9 (PNU 922)"), "{jogged:?}");
    assert_eq!(number(&lab, "1004"), before);
    assert!(number(&lab, "PL.FB") < -40_000.0);
    at_rest(&lab);
}

/// AKD manual 6.5: 11,997 rpm is the most that NSOLL_A carries as delivered, whatever --limit says.
#[test]
fn a_speed_above_the_range_of_the_setpoint_names_its_scaling() {
    let lab = Lab::new("moving-range");
    let _drive = simulate(&lab);
    let run = |speed: &str| {
        let speed = format!("--velocity={speed}");
        client(
            &lab,
            &["run", "akd-1", &speed, "--limit", "20000rpm", "--dry-run"],
        )
    };
    for (speed, highest) in [("12000rpm", "11996.7"), ("-12000rpm", "-11996.7")] {
        let refused = run(speed);
        assert_eq!(refused.code, Some(6), "{refused:?}");
        let words = format!(
            "beyond what the speed setpoint carries, {highest} rpm (NSOLL_A with PN.VELSCALING = 1638)"
        );
        assert!(refused.err.contains(&words), "{refused:?}");
        assert!(
            refused
                .err
                .contains("`profidrive describe akd-1 PN.VELSCALING` shows the range"),
            "{refused:?}"
        );
        assert!(!refused.err.contains("--limit"), "{refused:?}");
    }
    client(&lab, &["write", "akd-1", "PN.VELSCALING=2000"]).ok();
    let refused = run("12000rpm");
    assert!(
        refused.err.contains("limit of the drive"),
        "VL.LIMITP: {refused:?}"
    );
}

/// A jog that moves nothing is a failure: along a ramp of 1 rpm/s, and against a blocked shaft, which the drive reports.
#[test]
fn a_jog_that_does_not_move_the_axis_fails() {
    let lab = Lab::new("moving-jog-still");
    let _drive = simulate(&lab);
    let jog = ["jog", "akd-1", "--velocity", "120rpm", "--for", "1s"];
    client(&lab, &jog).ok();
    client(&lab, &["write", "akd-1", "1008=1"]).ok();
    client(&lab, &["write", "akd-1", "1006=1rpm/s"]).ok();
    let still = client(&lab, &jog);
    assert_eq!(still.code, Some(1), "{still:?}");
    assert!(still.err.contains("for 1.0 s did not move the axis"), "{still:?}");
    assert!(still.err.contains("its ramps (AKD: 1006, 1007)"), "{still:?}");
    client(&lab, &["write", "akd-1", "1008=763"]).ok();
    client(&lab, &["write", "akd-1", "1006=3052rpm/s"]).ok();
    client(&lab, &["inject", "akd-1", "block=on"]).ok();
    let blocked = client(&lab, &jog);
    assert_eq!(blocked.code, Some(1), "{blocked:?}");
    assert!(blocked.err.contains("did not move the axis"), "{blocked:?}");
    at_rest(&lab);
}
