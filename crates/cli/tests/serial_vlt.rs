//! A VLT at a serial port, by the binary: every command that a user has for it, over the FC protocol and over USS, on a
//! line that spoils what passes too.
#![cfg(unix)] // pseudo-terminals

mod binary;
mod cable;

use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use binary::{profidrive, stderr, stdout};
use cable::{Cable, Simulated};

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("profidrive-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        Self(folder)
    }

    fn file(&self, name: &str) -> String {
        self.0.join(name).to_str().expect("text").into()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[track_caller]
fn ok(line: &[&str]) -> Output {
    let output = profidrive(line);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{line:?}: {}{}",
        stdout(&output),
        stderr(&output)
    );
    output
}

/// The values of a `read --json`.
#[track_caller]
fn values(drive: &str, parameters: &[&str]) -> Vec<serde_json::Value> {
    let output = ok(&[&["--json", "read", drive], parameters].concat());
    let document: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("a document");
    let read = document["parameters"].as_array().expect("parameters").iter();
    read.map(|one| one["value"].clone()).collect()
}

/// Fails the test unless this comes true in time.
#[track_caller]
fn wait_until(what: &str, mut done: impl FnMut() -> bool) {
    let limit = Instant::now() + Duration::from_secs(20);
    while !done() {
        assert!(Instant::now() < limit, "{what}: not in time");
    }
}

#[test]
fn every_command_over_both_protocols() {
    for (protocol, address) in [("fc", 126), ("uss", 5)] {
        let cable = Cable::lay();
        let number = address.to_string();
        let line = ["--protocol", protocol, "--address", &number, "--baud", "115200"];
        let _drives = Simulated::start_model(&cable, "vlt", &line);
        let drive = format!("{},baud=115200", cable.drive(protocol, address));
        let folder = Folder::new(&format!("vlt-{protocol}"));

        let info = stdout(&ok(&["info", &drive]));
        assert!(info.starts_with(&format!("{drive} (VLT)")), "{info}");
        let printed = values(&drive, &["1-20", "341", "p342", "15-30[0..2]"]);
        assert_eq!(
            (printed[0].as_f64(), printed[1].as_f64()),
            (Some(0.75), Some(3.0)),
            "{printed:?}"
        );
        if protocol == "fc" {
            // USS has no texts
            assert_eq!(values(&drive, &["15-40"])[0], "FC-302");
        }
        let listed = stdout(&ok(&["list", &drive]));
        assert!(listed.contains("Ramp 1 Ramp up Time"), "{listed}");
        let described = stdout(&ok(&["describe", &drive, "3-41"]));
        assert!(
            described.contains("limits     0.01 s to 3600 s, reported by the drive\n"),
            "{described}"
        );
        let described = stdout(&ok(&["describe", &drive, "8-10"]));
        assert!(
            described.contains("limits     none known; limits of the type: 0 to 255\n")
                && described.contains("choice     1 PROFIdrive profile\n"),
            "{described}"
        );

        // backup, a change, what differs, and back
        let file = folder.file("line.backup");
        let backup = profidrive(&["backup", &drive, "-o", &file]);
        let printed = stderr(&backup);
        if protocol == "fc" {
            assert_eq!(backup.status.code(), Some(0), "{printed}");
        } else {
            // the texts 0-37 to 0-39 are missing; all else is there
            assert_eq!(backup.status.code(), Some(1), "{printed}");
            let missing =
                format!("the backup of {drive} is incomplete: 3 settings missing: Display Text 1, ");
            let why = "(cannot be carried by this channel: it has no request for text)";
            assert!(printed.contains(&missing) && printed.contains(why), "{printed}");
            assert!(!printed.contains("refused"), "{printed}");
        }
        let saved = std::fs::read_to_string(&file).expect("a backup");
        assert!(saved.contains("device: 0x0001"), "{saved}"); // as at a network
        ok(&["diff", &file, &drive]);
        ok(&["write", &drive, "3-41=5s"]);
        let differs = profidrive(&["diff", &file, &drive]);
        assert_eq!(differs.status.code(), Some(5), "{}", stderr(&differs));
        assert!(stdout(&differs).contains("3-41"), "{}", stdout(&differs));
        let restored = ok(&["restore", &drive, &file]);
        // how this model saves values
        assert!(
            stderr(&restored).contains("not saved: lost at the next power cycle (use --save)"),
            "{}",
            stderr(&restored)
        );
        ok(&["diff", &file, &drive]);
        assert_eq!(values(&drive, &["3-41"])[0].as_f64(), Some(3.0));
        // what cannot be
        let refused = profidrive(&["write", &drive, "3-41=9999s"]);
        assert_ne!(refused.status.code(), Some(0));
        assert!(stderr(&refused).contains("3600"), "{}", stderr(&refused));

        // a telegram of the network changes nothing here
        ok(&["write", &drive, "9-22=1"]);
        assert_eq!(values(&drive, &["9-22"])[0].as_f64(), Some(1.0));
        let ran = ok(&[
            "run",
            &drive,
            "--velocity",
            "300rpm",
            "--for",
            "500ms",
            "--may-run-on",
        ]);
        assert!(!stderr(&ran).contains("telegram"), "{}", stderr(&ran));
        assert!(
            stderr(&ran).contains("axis at rest, control released"),
            "{}",
            stderr(&ran)
        );
        // temporary changes of a jog are restored; the axis already stands when another client stops it
        let before = values(&drive, &["3-19"]);
        let jogged = ok(&[
            "jog",
            &drive,
            "--velocity",
            "200rpm",
            "--for",
            "500ms",
            "--may-run-on",
        ]);
        let printed = format!("{}{}", stdout(&jogged), stderr(&jogged));
        assert!(
            printed.contains("STW1 0x053C"),
            "the word of the FC profile, as it is sent: {printed}"
        );
        assert!(printed.contains("axis at rest, control released"), "{printed}");
        assert_eq!(values(&drive, &["3-19"]), before, "{printed}");
        let stopped = stdout(&ok(&["stop", &drive]));
        assert!(
            stopped.contains("is at rest, the power stage is off"),
            "{stopped}"
        );
        ok(&["ack", &drive]);
        let refused = profidrive(&["ack", &drive, "--by-parameter"]);
        assert_eq!(refused.status.code(), Some(1));
        assert!(
            stderr(&refused).contains("model VLT has no parameter that clears its faults")
                && stderr(&refused).contains("takes control and does it by STW1 bit 7"),
            "{}",
            stderr(&refused)
        );
        let faults = ok(&["faults", &drive]);
        assert!(stdout(&faults).contains("no fault") || stderr(&faults).contains("no fault"));
        let status = stdout(&profidrive(&["status", &drive]));
        assert!(status.contains("Danfoss FC"), "{status}");
    }
}

/// The error of the first parameter that `read --json` or `write --json` names.
#[track_caller]
fn error_of(output: &Output) -> serde_json::Value {
    let document: serde_json::Value = serde_json::from_str(&stdout(output)).expect("a document");
    let refused = match document["command"].as_str() {
        Some("write") => &document["changes"][0],
        _ => &document["parameters"][0],
    };
    refused["error"].clone()
}

#[test]
fn an_error_number_of_the_channel_reaches_the_user_as_received() {
    for (protocol, address) in [("fc", 1), ("uss", 1)] {
        let cable = Cable::lay();
        let line = ["--protocol", protocol, "--baud", "115200"];
        let _drives = Simulated::start_model(&cable, "vlt", &line);
        let drive = format!("{},baud=115200", cable.drive(protocol, address));
        let inject = |what: &str| profidrive(&["inject", &cable.far_drive(protocol, address), what]);
        for (number, meaning, remedy) in [
            (
                131,
                "131 change not possible, the factory setup is selected",
                "select another setup to edit, then write",
            ),
            (
                130,
                "130 no bus access to the parameter",
                "read or set it at the drive's own panel",
            ),
        ] {
            let injected = inject(&format!("answers=error {number}"));
            assert_eq!(injected.status.code(), Some(0), "{}", stderr(&injected));
            for (command, parameter, verb) in [("write", "3-41=5s", "writing"), ("read", "3-41", "reading")] {
                // over USS the model is known by a parameter, which is refused too
                let line = [command, &drive, parameter, "--model", "vlt"];
                let refused = profidrive(&line);
                assert_eq!(refused.status.code(), Some(3), "{}", stderr(&refused));
                let words = format!("{drive}: {verb} Ramp 1 Ramp up Time (3-41) refused: {meaning}");
                let printed = stderr(&refused);
                assert!(printed.contains(&words) && printed.contains(remedy), "{printed}");
                let error = error_of(&profidrive(&[&["--json"], &line[..]].concat()));
                let expected = serde_json::json!({
                    "number": number, "meaning": meaning, "information": error["information"],
                    "remedy": remedy, "channel": protocol, "sent": true,
                });
                assert_eq!(error, expected);
            }
        }
        // what only records can do
        let silent = inject("answers=silent");
        assert_ne!(silent.status.code(), Some(0));
        assert!(
            stderr(&silent).contains("`answers=silent` is of a network"),
            "{}",
            stderr(&silent)
        );
        let well = inject("answers=none");
        assert_eq!(well.status.code(), Some(0), "{}", stderr(&well));
        assert_eq!(
            values(&drive, &["3-41"])[0].as_f64(),
            Some(3.0),
            "nothing was done"
        );
    }
}

#[test]
fn the_factory_set_up_refuses_a_write_with_its_own_number() {
    let cable = Cable::lay();
    let _drives = Simulated::start_model(&cable, "vlt", &["--baud", "115200"]);
    let drive = format!("{},baud=115200", cable.drive("fc", 1));
    ok(&["write", &drive, "0-11=0"]);
    let refused = profidrive(&["write", &drive, "3-41=5s"]);
    assert_eq!(refused.status.code(), Some(3));
    let printed = stderr(&refused);
    assert!(
        printed.contains("refused: 131 change not possible, the factory setup is selected")
            && !printed.contains("axis at rest")
            && !printed.contains("0x11"),
        "{printed}"
    );
}

/// Its application ids are elements of one number that is not an array: there is no request for them.
#[test]
fn a_parameter_that_the_channel_cannot_carry_is_not_refused() {
    for protocol in ["fc", "uss"] {
        let cable = Cable::lay();
        let line = ["--protocol", protocol, "--baud", "115200"];
        let _drives = Simulated::start_model(&cable, "vacon", &line);
        let drive = format!("{},baud=115200", cable.drive(protocol, 1));
        for (command, parameter) in [("read", "ID103"), ("write", "ID103=5s")] {
            let output = profidrive(&[command, &drive, parameter, "--model", "vacon"]);
            let printed = stderr(&output);
            assert_eq!(output.status.code(), Some(1), "{printed}");
            assert!(
                printed.contains(
                    "(ID 103) cannot be carried by this channel: it has no request for the parameters"
                ) && !printed.contains("refused")
                    && !printed.contains("information"),
                "{printed}"
            );
            let output = profidrive(&["--json", command, &drive, parameter, "--model", "vacon"]);
            let error = error_of(&output);
            assert_eq!(error["sent"], false, "{error}");
            assert_eq!(error["channel"], protocol, "{error}");
            assert!(
                error["number"].is_null() && error["information"].is_null(),
                "{error}"
            );
        }
    }
}

/// At a serial line the drive saves text with every write, numbers only when it is asked to.
#[test]
fn restore_reports_whether_texts_and_numbers_are_saved() {
    let cable = Cable::lay();
    let _drives = Simulated::start_model(&cable, "vlt", &["--baud", "115200"]);
    let drive = format!("{},baud=115200", cable.drive("fc", 1));
    let folder = Folder::new("vlt-texts");
    let file = folder.file("before.backup");
    ok(&["backup", &drive, "-o", &file]);
    let text = "(at a serial line it saves text with every write)";
    let lost = "not saved: lost at the next power cycle (use --save)";
    for (changed, texts, others) in [
        (
            &["0-37=PUMP"][..],
            Some("saved in the drive: Display Text 1 (0-37)"),
            None,
        ),
        (&["3-41=5s"], None, Some(lost)),
        (
            &["0-37=PUMP", "3-41=5s"],
            Some("saved in the drive: Display Text 1 (0-37)"),
            Some("not saved: Ramp 1 Ramp up Time (3-41) is lost at the next power cycle (use --save)"),
        ),
    ] {
        ok(&[&["write", &drive], changed].concat());
        let printed = stderr(&ok(&["restore", &drive, &file]));
        assert_eq!(printed.contains(text), texts.is_some(), "{printed}");
        assert!(texts.is_none_or(|words| printed.contains(words)), "{printed}");
        assert_eq!(
            printed.contains("lost at the next power cycle"),
            others.is_some(),
            "{printed}"
        );
        assert!(others.is_none_or(|words| printed.contains(words)), "{printed}");
    }
}

/// Carries out what `status` recommends: its actions, and the commands in its text that begin no motion.
#[track_caller]
fn follow_advice(drive: &str) {
    let output = profidrive(&["status", "--json", drive]);
    let report: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("a document");
    let actions = report["actions"].as_array().cloned().unwrap_or_default();
    let actions = actions.iter().filter_map(|action| action["command"].as_str());
    let next = report["next"].as_str().unwrap_or_default();
    let commands: Vec<&str> = actions.chain(next.split('`').skip(1).step_by(2)).collect();
    assert!(!commands.is_empty(), "{report}");
    for command in commands {
        let words: Vec<&str> = command.split(' ').skip(1).collect();
        match words.first() {
            Some(&"status") => {}
            // what begins a motion is not begun, but it could be
            Some(&"run" | &"jog" | &"move") => {
                let line = command.replace("SPEED", "60rpm").replace("POSITION", "1rev");
                let words: Vec<&str> = line
                    .split(' ')
                    .skip(1)
                    .chain(["--dry-run", "--may-run-on"])
                    .collect();
                ok(&words);
            }
            _ => {
                ok(&words);
            }
        }
    }
}

/// The reaction of a drive to a killed `run` is its own setting; a drive that runs on is reported beforehand.
#[test]
fn after_a_killed_run_the_drive_acts_per_parameter_8_04() {
    let cable = Cable::lay();
    let mut drives = Simulated::start_model(&cable, "vlt", &["--baud", "115200"]);
    let drive = format!("{},baud=115200", cable.drive("fc", 1));
    let speed = || values(&drive, &["16-17"])[0].as_f64().expect("a speed");
    for (function, warned) in [("5", false), ("0", true)] {
        ok(&["write", &drive, &format!("8-04={function}"), "8-03=1s"]);
        let mut run = Command::new(env!("CARGO_BIN_EXE_profidrive"))
            .args(["run", "--json", &drive, "--velocity", "300rpm", "--may-run-on"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary runs");
        let mut printed = BufReader::new(run.stdout.take().expect("piped")).lines();
        let mut events = Vec::new();
        let at_speed = printed.by_ref().map_while(Result::ok).find(|line| {
            let event: serde_json::Value = serde_json::from_str(line).expect("an event");
            events.push(event.clone());
            event["speed_actual"]["value"]
                .as_f64()
                .is_some_and(|speed| speed > 290.0)
        });
        assert!(at_speed.is_some(), "{events:?}");
        run.kill().expect("it runs");
        let mut said = String::new();
        let mut errors = run.stderr.take().expect("piped");
        errors.read_to_string(&mut said).expect("text");
        run.wait().expect("it ends");
        let advice = format!("`profidrive write {drive} 8-04=5`");
        assert_eq!(
            said.contains("8-04 is Off: should this program be killed"),
            warned,
            "{said}"
        );
        assert_eq!(said.contains(&advice), warned, "{said}");
        let first = &events[0]["goes_on_alone"];
        assert_eq!(
            first["parameter"].as_str(),
            warned.then_some("8-04"),
            "{events:?}"
        );
        // a read puts the time-out off
        if warned {
            // longer than it: there is nothing to wait for
            sleep(Duration::from_secs(3));
            assert!((speed() - 300.0).abs() < 10.0, "8-04={function}: {} rpm", speed());
        } else {
            let printed = drives.output_until("F17");
            assert!(printed.contains("F17"), "{printed}");
            wait_until("the motor stands", || speed().abs() < 10.0);
        }
        let status = profidrive(&["status", &drive]);
        if warned {
            let status = stdout(&status);
            assert!(
                // the word is not reported once another master has sent a request
                status.contains("is still in force"),
                "{status}"
            );
            follow_advice(&drive);
            assert_eq!(speed(), 0.0);
        } else {
            assert_eq!(status.status.code(), Some(5));
            assert!(stdout(&status).contains("F17"), "{}", stdout(&status));
            follow_advice(&drive);
            let status = ok(&["status", &drive]);
            assert!(!stdout(&status).contains("F17"), "{}", stdout(&status));
        }
    }
}

/// Blanks in front of a text are written where quotation marks keep them; else they are left out, which is said.
#[test]
fn blanks_in_quotation_marks_are_part_of_a_text() {
    let cable = Cable::lay();
    let _drives = Simulated::start_model(&cable, "vlt", &[]);
    let drive = cable.drive("fc", 1);
    let quoted = ok(&["write", &drive, "0-37=\"  x \""]);
    assert!(
        stdout(&quoted).contains("written, read back"),
        "{}",
        stdout(&quoted)
    );
    assert!(!stderr(&quoted).contains("left out"), "{}", stderr(&quoted));
    assert_eq!(values(&drive, &["0-37"])[0], "  x");
    let bare = ok(&["write", &drive, "0-38=  y"]);
    let said = "Display Text 2 (0-38): blanks before the text are left out; to write them use quotation marks: \" y\"";
    assert!(stderr(&bare).contains(said), "{}", stderr(&bare));
    assert_eq!(values(&drive, &["0-38"])[0], "y");
}

/// What is kept is there after the power was off, what is not is as delivered.
#[test]
fn the_eeprom_survives_a_restart() {
    let cable = Cable::lay();
    let folder = Folder::new("vlt-eeprom");
    let state = folder.file("state");
    let drive = cable.drive("fc", 1);
    {
        let _drives = Simulated::start_model(&cable, "vlt", &["--state", &state]);
        ok(&["write", &drive, "3-41=5s"]);
        ok(&["write", "--save", &drive, "3-42=7s"]);
        // text has no request for the RAM alone: what is said of it is true
        let text =
            "saved in the drive: Display Text 1 (0-37) (at a serial line it saves text with every write)";
        let printed = stderr(&ok(&["write", &drive, "0-37=PUMP"]));
        assert!(printed.contains(text) && !printed.contains("--save"), "{printed}");
        let printed = stderr(&ok(&["write", &drive, "0-37=HELLO", "3-41=4s"]));
        let number = "not saved: Ramp 1 Ramp up Time (3-41) is lost at the next power cycle (use --save)";
        assert!(printed.contains(text) && printed.contains(number), "{printed}");
        let described = stdout(&ok(&["describe", &drive, "0-37"]));
        assert!(described.contains("with every write"), "{described}");
        ok(&["write", &drive, "3-41=5s"]);
        let printed = values(&drive, &["3-41", "3-42"]);
        assert_eq!((printed[0].as_f64(), printed[1].as_f64()), (Some(5.0), Some(7.0)));
    }
    let _drives = Simulated::start_model(&cable, "vlt", &["--state", &state]);
    let printed = values(&drive, &["3-41", "3-42"]);
    assert_eq!((printed[0].as_f64(), printed[1].as_f64()), (Some(3.0), Some(7.0)));
    assert_eq!(values(&drive, &["0-37"])[0], "HELLO");
    // 9-72 does the same without the power
    ok(&["write", &drive, "3-41=5s"]);
    let reset = ok(&["write", &drive, "9-72=1"]);
    assert!(stdout(&reset).contains("executed"), "{}", stdout(&reset));
    wait_until("the drive has restarted with what it saved", || {
        let printed = values(&drive, &["3-41", "3-42", "9-72"]);
        let numbers: Vec<_> = printed.iter().map(|value| value.as_f64()).collect();
        numbers == [3.0, 7.0, 0.0].map(Some)
    });
}

/// An orderly shutdown writes the counters of the drive to the folder, and no other unsaved values.
#[test]
fn an_orderly_end_keeps_what_the_drive_counted() {
    let cable = Cable::lay();
    let folder = Folder::new("vlt-counted");
    let state = folder.file("state");
    let drive = cable.drive("fc", 1);
    let line = ["--state", state.as_str()];
    let counted = |name: &str| -> u32 {
        let files = std::fs::read_dir(&state).expect("the folder");
        let texts = files.filter_map(|file| std::fs::read_to_string(file.expect("a file").path()).ok());
        let text: String = texts.collect();
        let mut lines = text.lines();
        let value = lines.find_map(|line| line.strip_prefix(&format!("{name} = ")).map(str::to_owned));
        let value = value.unwrap_or_else(|| panic!("{name}: {text}"));
        value.trim_end_matches('s').parse().expect("a number")
    };

    let drives = Simulated::start_model(&cable, "vlt", &line);
    assert_eq!(values(&drive, &["15-03"])[0].as_f64(), Some(1.0));
    ok(&["write", &drive, "3-42=7s"]);
    ok(&[
        "run",
        &drive,
        "--velocity",
        "200rpm",
        "--for",
        "2s",
        "--may-run-on",
    ]);
    drives.end_in_order();
    let running = counted("counter running");
    assert!((2..60).contains(&running), "{running}");
    let on = counted("counter power on");
    assert!((running..120).contains(&on), "{on}");

    let drives = Simulated::start_model(&cable, "vlt", &line);
    let printed = values(&drive, &["15-03", "3-42"]);
    assert_eq!(
        (printed[0].as_f64(), printed[1].as_f64()),
        (Some(2.0), Some(3.0)),
        "{printed:?}"
    );
    drives.end_in_order();
    assert_eq!(
        (counted("counter running"), counted("counter power-ups")),
        (running, 2)
    );
}

#[test]
fn noise_wrong_checks_halves_and_echo_are_borne() {
    for (protocol, echo) in [("fc", true), ("uss", false)] {
        let cable = Cable::lay();
        let _drives = Simulated::start_model(&cable, "vlt", &["--protocol", protocol]);
        let drive = cable.drive(protocol, 1);
        let parameters = ["1-20", "3-41", "3-42", "8-10", "15-30[0..9]", "16-13"];
        let clean = values(&drive, &parameters);
        cable.echo(echo);
        cable.spoil_every(9);
        assert_eq!(values(&drive, &parameters), clean);
        ok(&["write", &drive, "3-41=4s"]);
        assert_eq!(values(&drive, &["3-41"])[0].as_f64(), Some(4.0));
        ok(&[
            "run",
            &drive,
            "--velocity",
            "200rpm",
            "--for",
            "1s",
            "--may-run-on",
        ]);
        assert!(cable.spoiled() > 3, "{}", cable.spoiled());
    }
}
