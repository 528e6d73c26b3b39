//! A client of a serial line is killed or frozen at a random moment of a motion, over a pseudo-terminal: what `status`
//! recommends afterwards works and brings the axis to rest. A failure prints its case and its seed.
#![cfg(unix)] // pseudo-terminals

mod binary;
mod cable;

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

use binary::{profidrive, stderr, stdout};
use cable::{Cable, Simulated};
use serde_json::Value;

const SHORT: Duration = Duration::from_secs(30);
/// The latest moment of an accident, after the axis came into operation.
const LATEST: u64 = 1000;

/// A motion of a drive; ends with the test.
struct Moving(Child);

impl Moving {
    /// Begins a motion and waits until the drive is in operation.
    fn begin(line: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_profidrive"))
            .args(line)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the binary runs");
        let lines = BufReader::new(process.stdout.take().expect("piped")).lines();
        let mut lines = lines.map_while(Result::ok);
        let moving = Self(process);
        let operates = lines.any(|line| {
            let event: Value = serde_json::from_str(&line).expect("an event");
            event["state"] == "S4"
        });
        assert!(operates, "{line:?} ended");
        // it goes on talking
        std::thread::spawn(move || lines.for_each(drop));
        moving
    }

    fn signal(&self, name: &str) {
        let number = self.0.id().to_string();
        let sent = Command::new("kill").args([&format!("-{name}"), &number]).status();
        assert!(sent.expect("kill runs").success());
    }
}

impl Drop for Moving {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The commands of a report, those that begin a motion as a trial that begins none.
fn advice(report: &Value, speed: &str) -> Vec<(String, bool)> {
    let actions = report["actions"].as_array().cloned().unwrap_or_default();
    let actions = actions.iter().filter_map(|action| action["command"].as_str());
    let next = report["next"].as_str().unwrap_or_default();
    let commands = actions.chain(next.split('`').skip(1).step_by(2));
    let commands = commands.filter_map(|command| command.strip_prefix("profidrive "));
    let command = |command: &str| {
        if ["run", "move", "jog"].contains(&command.split(' ').next().unwrap_or_default()) {
            let tried = command.replace("SPEED", speed).replace("POSITION", "1rev");
            (format!("{tried} --dry-run --may-run-on"), false)
        } else {
            (command.to_owned(), true)
        }
    };
    commands.map(command).collect()
}

/// Carries out what `status` says until that is nothing more and the axis stands.
fn to_rest(drive: &str, speed: &str, at: &str) {
    let end = Instant::now() + SHORT;
    loop {
        let output = profidrive(&["status", "--json", drive]);
        assert!(
            matches!(output.status.code(), Some(0 | 5)),
            "{at}: {}",
            stderr(&output)
        );
        let report: Value = serde_json::from_str(&stdout(&output)).expect("a document");
        let mut acted = false;
        for (command, acts) in advice(&report, speed) {
            let done = profidrive(&command.split(' ').collect::<Vec<_>>());
            let said = stderr(&done);
            assert_eq!(
                done.status.code(),
                Some(0),
                "{at}: `{command}` of {report}: {said}"
            );
            acted |= acts;
        }
        // in percent where no parameter has it in rpm
        let speed = report["speed_actual"]["value"].as_f64().unwrap_or(f64::MAX);
        if !acted && speed.abs() < 1.0 {
            assert_eq!(report["cause"], "no-controller", "{at}: {report}");
            return;
        }
        assert!(Instant::now() < end, "{at}: {report}");
        sleep(Duration::from_millis(100));
    }
}

#[test]
fn advice_of_status_stops_an_ownerless_axis_on_a_serial_line() {
    let clock = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    let seed = clock.map_or(1, |time| u64::from(time.subsec_nanos()));
    let mut random = seed;
    for (model, speed) in [("akd", "60rpm"), ("vlt", "60rpm"), ("vacon", "20%")] {
        // the control word of a Vacon at a line has no jog
        let motions: &[&str] = if model == "vacon" {
            &["run"]
        } else {
            &["run", "jog"]
        };
        for &motion in motions {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let moment = Duration::from_millis((random >> 33) % LATEST);
            let at = format!("seed {seed}: {model} {motion} killed after {moment:?}");
            eprintln!("{at}");
            let cable = Cable::lay();
            let _drives = Simulated::start_model(&cable, model, &["--baud", "115200"]);
            let drive = format!("{},baud=115200", cable.drive("fc", 1));
            let line: &[&str] = match motion {
                "run" => &[
                    "run",
                    "--may-run-on",
                    "--json",
                    "--model",
                    model,
                    &drive,
                    "--velocity",
                    speed,
                ],
                _ => &[
                    "jog",
                    "--may-run-on",
                    "--json",
                    "--model",
                    model,
                    &drive,
                    "--for",
                    "20s",
                ],
            };
            let moving = Moving::begin(line);
            // any moment will do
            sleep(moment);
            moving.signal("KILL");
            drop(moving);
            to_rest(&drive, speed, &at);
        }
    }
}

/// A line belongs to one program: who has it is said, and that it has to end first.
#[test]
fn a_frozen_client_is_named_with_what_to_do() {
    let cable = Cable::lay();
    let _drives = Simulated::start_model(&cable, "vlt", &["--baud", "115200"]);
    let drive = format!("{},baud=115200", cable.drive("fc", 1));
    let moving = Moving::begin(&["run", "--may-run-on", "--json", &drive, "--velocity", "300rpm"]);
    moving.signal("STOP");
    let number = moving.0.id();
    for command in ["status", "stop"] {
        let output = profidrive(&[command, &drive]);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(4), "{said}");
        for words in [
            format!("in use by process {number} (profidrive)"),
            format!("kill -KILL {number} "),
            format!("then `profidrive stop {drive}`"),
        ] {
            assert!(said.contains(&words), "{words}: {said}");
        }
    }
    moving.signal("KILL");
    drop(moving);
    to_rest(&drive, "60rpm", "after it was ended");
}
