//! Files of recordings, read by another library; a full disk; steps; a plot on a terminal.

use std::path::Path;
use std::time::Duration;

use serde_json::Value;
use system_tests::{Finished, Lab, Running, Side, built, client, peer, python, simulate};

const SHORT: Duration = Duration::from_secs(20);
pub const DRIVES: usize = 8;

/// Starts drives with 16 cyclic signals each.
pub fn drives(lab: &Lab) -> Running {
    // ZSW1, NIST_A, XIST_A, XIST_ERROR, DRIVE_MOTION_STATUS, DRIVE_INPUTS, AKTSATZ, ZSW2
    let words = [2, 6, 28, 28, 104, 104, 105, 105, 106, 33, 4, 0];
    let words: Vec<String> = words
        .iter()
        .enumerate()
        .map(|(at, word)| format!("\"916[{at}]\" = {word}"))
        .collect();
    let words = words.join(", ");
    let mut plant = String::new();
    for number in 1..=DRIVES {
        plant += &format!(
            "[[drive]]\nname = \"akd-{number}\"\nip = \"192.168.77.{}/24\"\nparameters = {{ 922 = 400, {words} }}\n",
            50 + number
        );
    }
    let file = lab.folder().join("plant.toml");
    std::fs::write(&file, plant).unwrap();
    let mut drives = lab.spawn(
        Side::Device,
        built("profidrive"),
        ["simulate", file.to_str().unwrap(), "-i", "dev0"],
    );
    drives.wait_for("Ctrl-C ends", SHORT);
    drives
}

pub fn record(lab: &Lab, arguments: &[&str]) -> Finished {
    client(lab, &[&["record"], arguments].concat())
}

pub fn path(lab: &Lab, name: &str) -> String {
    lab.folder().join(name).to_str().unwrap().to_owned()
}

#[test]
fn another_library_reads_the_files() {
    let lab = Lab::new("record-files");
    let _drives = drives(&lab);
    for end in ["parquet", "arrow", "arrows"] {
        let file = path(&lab, &format!("table.{end}"));
        let done = record(
            &lab,
            &[
                "akd-1,akd-2",
                "all",
                "--every",
                "cycle",
                "--for",
                "500ms",
                "-o",
                &file,
                "--json",
            ],
        );
        let report: Value = serde_json::from_str(&done.ok().out).unwrap();
        let script = peer("read_table.py");
        let read = lab
            .run(
                Side::Controller,
                python(),
                [script.as_os_str(), file.as_ref()],
                SHORT,
            )
            .ok();
        let read: Value = serde_json::from_str(&read.out).unwrap();
        let rows = report["rows"].as_u64().unwrap() + report["gaps"].as_u64().unwrap();
        assert!(
            rows > 30 && read["rows"] == rows && read["gaps"] == report["gaps"],
            "{read} {report}"
        );
        assert_eq!(read["drives"], serde_json::json!(["akd-1", "akd-2"]));
        assert_eq!(read["schema"], "profidrive/1");
        assert_eq!(
            (&read["units"]["NIST_A"], &read["units"]["XIST_A"]),
            (&"rpm".into(), &"rev".into())
        );
        let columns = read["columns"].as_array().unwrap();
        assert_eq!(columns.len(), 4 + 16, "{read}");
        let of = |name: &str| columns.iter().position(|column| column == name).unwrap();
        assert_eq!(read["types"][of("ZSW1")], "uint16");
        assert_eq!(read["types"][of("t")], "duration[ns]");
        assert_eq!(read["types"][of("wall")], "timestamp[ns, tz=UTC]");
    }
}

/// Not even the names of the columns can be written: nothing moves.
#[test]
fn a_full_disk_keeps_a_motion_that_is_to_be_recorded_from_beginning() {
    let lab = Lab::new("record-none");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    let script = format!(
        "mkdir -p /run/none && mount -t tmpfs -o size=4k none /run/none && head -c 4096 /dev/zero >/run/none/filler; \
         {} run akd-1 --velocity 60rpm --for 1s --record /run/none/run.csv -i {} --watchdog 15; code=$?; \
         ls /run/none; exit $code",
        built("profidrive").display(),
        Side::Controller.interface()
    );
    let arguments = ["-c", script.as_str()];
    let refused = lab.run(Side::Controller, "sh", arguments, Duration::from_secs(30));
    assert_eq!(refused.code, Some(1), "{refused:?}");
    assert!(refused.err.contains("No space left"), "{refused:?}");
    assert!(!refused.err.contains("this moves the axis"), "{refused:?}");
    assert_eq!(refused.out.trim(), "filler", "no empty file stays: {refused:?}");
}

#[test]
fn a_full_disk_ends_a_recording_and_loses_nothing_that_was_recorded() {
    let lab = Lab::new("record-full");
    let _drives = drives(&lab);
    for (name, readable) in [("full.csv", "full.csv"), ("full.parquet", "full.parquet.part")] {
        let script = format!(
            "mkdir -p /run/full && mount -t tmpfs -o size=64k full /run/full && \
             {} record 'akd-*' all --every cycle --for 60s -i {} -o /run/full/{name} --json -q; code=$?; \
             cp /run/full/{readable} {}; exit $code",
            built("profidrive").display(),
            Side::Controller.interface(),
            lab.folder().display(),
        );
        let done = lab.run(
            Side::Controller,
            "sh",
            ["-c", script.as_str()],
            Duration::from_secs(60),
        );
        assert_eq!(done.code, Some(1), "{done:?}");
        let report: Value = serde_json::from_str(done.out.lines().next().unwrap()).unwrap();
        let error = &report["error"];
        assert_eq!(error["kind"], "local", "{report}");
        let message = error["message"].as_str().unwrap();
        assert!(
            message.contains("No space left") && message.contains(readable),
            "{message}"
        );
        let said: usize = message
            .split_once("; the ")
            .and_then(|(_, rest)| rest.split(' ').next()?.parse().ok())
            .unwrap();
        assert_eq!(report["written"].as_u64(), Some(said as u64), "{report}");
        assert!(report["rows"].as_u64() > Some(said as u64), "{report}");
        let copy = lab.folder().join(readable);
        let there = if name.ends_with("csv") {
            let text = std::fs::read_to_string(&copy).unwrap();
            assert!(text.ends_with('\n'));
            text.lines().count() - 1
        } else {
            let script = peer("read_table.py");
            let read = lab.run(
                Side::Controller,
                python(),
                [script.as_os_str(), copy.as_os_str()],
                SHORT,
            );
            let read: Value = serde_json::from_str(&read.ok().out).unwrap();
            usize::try_from(read["rows"].as_u64().unwrap()).unwrap()
        };
        assert!(there > 100 && there == said, "{there} of {said}: {message}");
    }
}

#[test]
fn a_step_is_measured_drawn_and_compared() {
    let lab = Lab::new("record-step");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    let (file, plot) = (path(&lab, "step.csv"), path(&lab, "step.html"));
    let step = |more: &[&str]| {
        let line = [
            "step",
            "akd-1",
            "--velocity",
            "0:300rpm",
            "--for",
            "600ms",
            "--json",
        ];
        let done = client(&lab, &[&line[..], more].concat()).ok();
        let last = done.json_lines().pop().unwrap();
        assert_eq!(last["command"], "step");
        last
    };
    let fast = step(&["-o", &file]);
    client(&lab, &["write", "akd-1", "DRV.ACC=1000rpm/s"]).ok();
    let slow = step(&["--before", &file, "--plot", &plot]);
    let rise = |of: &Value| of["rise_time"].as_f64().unwrap();
    // 80 % of 300 rpm with 3000 and 1000 rpm/s
    assert!((rise(&fast["response"]) - 0.08).abs() < 0.04, "{fast}");
    assert!((rise(&slow["response"]) - 0.24).abs() < 0.06, "{slow}");
    assert!(
        (rise(&slow["before"]) - rise(&fast["response"])).abs() < 1e-3,
        "{slow}"
    );
    let page = std::fs::read_to_string(&plot).unwrap();
    assert!(page.contains("before: speed") && page.contains("akd-1 speed"));
}

/// A motor that is operated meanwhile goes on turning when the recording ends, by Ctrl-C or by a closed output.
#[test]
fn the_end_of_a_recording_does_not_stop_a_motor() {
    let lab = Lab::new("record-end");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    let program = built("profidrive");
    let line = format!(
        "{} record akd-1 ZSW1 --every cycle -i {} -o -",
        program.display(),
        Side::Controller.interface()
    );
    for (script, ends_itself) in [
        (format!("exec {line}"), false),
        (format!("{line} | head -500"), true),
    ] {
        let mut recording = lab.spawn(Side::Controller, "sh", ["-c", script.as_str()]);
        recording.wait_for("records 1 signal", SHORT);
        client(
            &lab,
            &["write", "akd-1", "DRV.CMDSOURCE=0", "DRV.EN=1", "VL.CMDU=300rpm"],
        )
        .ok();
        recording.wait_for("its power stage is on", SHORT);
        if !ends_itself {
            recording.signal("INT");
        }
        recording.wait_for("a second Ctrl-C closes it now", SHORT);
        let read = client(&lab, &["read", "akd-1", "VL.FB", "--json"]).ok();
        let speed = read.json_lines()[0]["parameters"][0]["value"].as_f64();
        assert!(speed.is_some_and(|speed| speed > 290.0), "{read:?}");
        client(&lab, &["write", "akd-1", "DRV.DIS=1"]).ok();
        let done = recording.finish(SHORT);
        assert!(
            done.code == Some(0) && !done.err.contains("second signal"),
            "{done:?}"
        );
    }
}

/// The program draws on a pseudo terminal and gives it back with `q` and with Ctrl-C.
#[test]
fn a_recording_is_drawn_on_a_terminal_that_is_restored() {
    let lab = Lab::new("record-live");
    let _drives = drives(&lab);
    let record = |text: &str, keys: &str, more: &[&str]| -> Value {
        let script = peer("terminal.py");
        let program = built("profidrive");
        let line = [
            script.to_str().unwrap(),
            text,
            keys,
            program.to_str().unwrap(),
            "record",
            "akd-1,akd-2",
            "speed",
            "ZSW1",
            "--every",
            "cycle",
            "--live",
            "-i",
            Side::Controller.interface(),
        ];
        let done = lab
            .run(Side::Controller, python(), [&line[..], more].concat(), SHORT)
            .ok();
        serde_json::from_str(done.out.lines().last().unwrap()).unwrap()
    };
    let file = path(&lab, "live.csv");
    for (keys, more) in [("q", &["-o", file.as_str()][..]), ("\\x03", &[])] {
        let seen = record("ZSW1", keys, more);
        assert_eq!(
            (&seen["code"], &seen["restored"]),
            (&0.into(), &true.into()),
            "{seen}"
        );
        assert_eq!(
            (&seen["sent"], &seen["left"]),
            (&true.into(), &true.into()),
            "{seen}"
        );
        assert!(
            seen["rest"].as_str().unwrap().contains("akd-2"),
            "the summary: {seen}"
        );
    }
    assert!(std::fs::read_to_string(&file).unwrap().lines().count() > 2);
    let refused = record_without_terminal(&lab);
    assert!(
        refused.code == Some(2) && refused.err.contains("--live draws on a terminal"),
        "{refused:?}"
    );
}

/// Runs a program whose stdout is a terminal that is not its own: no keys can be read.
const FOREIGN_TERMINAL: &str = "
import os, pty, subprocess, sys
own, other = pty.openpty()
done = subprocess.run(sys.argv[1:], stdin=subprocess.DEVNULL, stdout=other, stderr=subprocess.PIPE, start_new_session=True)
sys.stderr.buffer.write(done.stderr)
sys.exit(done.returncode)
";

#[test]
fn a_terminal_that_cannot_be_used_leaves_no_file() {
    let lab = Lab::new("record-foreign-terminal");
    let file = path(&lab, "live.csv");
    let program = built("profidrive");
    let line = ["-c", FOREIGN_TERMINAL, program.to_str().unwrap()];
    let more = ["record", "akd-1", "speed", "--live", "-o", &file];
    let refused = lab.run(Side::Controller, python(), [&line[..], &more].concat(), SHORT);
    assert!(
        refused.code == Some(2) && refused.err.contains("this one cannot be used"),
        "{refused:?}"
    );
    assert!(!Path::new(&file).exists());
}

fn record_without_terminal(lab: &Lab) -> Finished {
    record(lab, &["akd-1", "speed", "--every", "cycle", "--live"])
}
