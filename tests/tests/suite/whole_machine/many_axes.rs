//! Many axes at once in one process, on a wire: each ends in its own way and the others keep their speed. And the same process
//! ended at any moment, in every way there is: all drives are at rest afterwards.

use std::path::PathBuf;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use serde_json::Value;
use system_tests::{Lab, Running, Side, built, client, simulate, wait_until};

const SHORT: Duration = Duration::from_secs(20);
const LONG: Duration = Duration::from_secs(120);
/// How far an axis that keeps its speed may be away from it, as a share of it.
const NEAR: f64 = 0.05;

/// Returns a plant of so many drives of each model, and their names.
fn plant(lab: &Lab, models: &[(&str, usize)]) -> (PathBuf, Vec<String>) {
    let each = models
        .iter()
        .flat_map(|(model, count)| (1..=*count).map(move |number| (*model, number)));
    let mut text = String::new();
    let mut names = Vec::new();
    for (last, (model, number)) in (51..).zip(each) {
        let name = format!("{model}-{number}");
        text +=
            &format!("[[drive]]\nmodel = \"{model}\"\nname = \"{name}\"\nip = \"192.168.77.{last}/24\"\n");
        names.push(name);
    }
    let file = lab.folder().join("plant.toml");
    std::fs::write(&file, text).unwrap();
    (file, names)
}

fn start(lab: &Lab, arguments: &[&str], names: &[String]) -> Running {
    let names = names.iter().map(String::as_str);
    let all: Vec<&str> = arguments.iter().copied().chain(names).collect();
    lab.spawn(Side::Controller, built("many-axes"), all)
}

/// Returns the report of `status` on an ownerless drive at rest, with its power stage off.
#[track_caller]
fn at_rest(lab: &Lab, name: &str, when: &str) -> Value {
    let mut last = None;
    let found = wait_until(SHORT, || {
        let finished = client(lab, &["status", name, "--json"]);
        let line = finished.out.lines().next().unwrap_or_default();
        let report: Option<Value> = serde_json::from_str(line).ok();
        let rests = report.as_ref().is_some_and(|report| {
            let speed = report["speed_actual"]["value"].as_f64();
            report["controller"]["connected"] == false
                && report["state"]
                    .as_str()
                    .is_some_and(|state| state != "S4" && state != "S5")
                && speed.is_none_or(|speed| speed.abs() < 0.5)
        });
        last = Some((finished, report));
        rests
    });
    match last {
        Some((_, Some(report))) if found => report,
        other => panic!("{when}: {name} is not at rest: {other:?}"),
    }
}

/// One line of what the program reported of an axis.
#[track_caller]
fn end_of<'l>(lines: &'l [Value], axis: &str, end: &str) -> &'l Value {
    let line = lines
        .iter()
        .find(|line| line["axis"] == axis && line["end"] == end);
    line.unwrap_or_else(|| panic!("{axis} did not end as {end}: {lines:?}"))
}

#[test]
fn sixteen_axes_of_three_vendors_end_each_in_its_own_way() {
    let lab = Lab::alone("many-axes");
    let (plant, mut names) = plant(&lab, &[("akd", 6), ("vlt", 5), ("vacon", 5)]);
    let _drives = simulate(&lab, &[plant.to_str().unwrap()]);
    let special = ["akd-1", "vlt-1", "vacon-1", "vlt-2"];
    names.retain(|name| !special.contains(&name.as_str()));
    let names: Vec<String> = special.into_iter().map(String::from).chain(names).collect();

    let finished = start(&lab, &["ends", "ctl0"], &names).finish(LONG).ok();
    let lines = finished.json_lines();
    // reported by the drives while the other axes turned: the end of the process had no part in it
    for (axis, end) in special.iter().zip(["dropped", "panic", "lease", "stopped"]) {
        let at = |line: &Value| lines.iter().position(|other| other == line);
        let released = names[4..].iter().map(|name| end_of(&lines, name, "released"));
        assert!(
            at(end_of(&lines, axis, end)) < released.filter_map(at).min(),
            "{lines:?}"
        );
    }
    end_of(&lines, "vlt-1", "panicked");
    let measured = |key: &str| {
        let line = lines.iter().find(|line| !line[key].is_null());
        line.and_then(|line| line[key].as_f64())
    };
    assert!(measured("waiting") > Some(900.0), "{lines:?}");
    // not a promise: the process has sixteen axes and a thousand threads on a few processors. A stop in the queue of the jobs
    // would come after seconds
    let ramp = measured("ramp_after_ms").expect("a ramp");
    assert!(ramp < 200.0, "{ramp} ms");
    // all jobs got their answer all the same
    let answers = lines.iter().find(|line| !line["answered"].is_null());
    let answers = answers.unwrap_or_else(|| panic!("no jobs: {lines:?}"));
    assert_eq!(answers["answered"], answers["readers"]);
    assert_eq!(answers["refused"], Value::Array(Vec::new()), "{answers}");
    for name in &names[4..] {
        let course = &end_of(&lines, name, "released")["course"];
        assert!(course["samples"].as_u64() > Some(50), "{name}: {course}");
        assert_eq!(course["dropped"], 0, "{name}: {course}");
        assert_eq!(course["out_of_operation"], 0, "{name}: {course}");
        assert!(
            course["farthest"].as_f64().is_some_and(|far| far < NEAR),
            "{name}: {course}"
        );
    }
    for name in &names {
        let report = at_rest(&lab, name, "at the end");
        assert_eq!(report["faults"], Value::Array(Vec::new()), "{name}: {report}");
    }
}

/// Moments of one run of the test; the same seed gives the same ones.
struct Moments(u64);

impl Moments {
    fn new() -> Self {
        let given = std::env::var("PROFIDRIVE_SEED")
            .ok()
            .and_then(|seed| seed.parse().ok());
        let now = || {
            SystemTime::now()
                .duration_since(UNIX_EPOCH)
                .unwrap()
                .subsec_nanos()
        };
        let seed = given.unwrap_or_else(|| u64::from(now()));
        println!("PROFIDRIVE_SEED={seed}");
        Self(seed)
    }

    /// In milliseconds, somewhere in here.
    fn within(&mut self, from: u64, to: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        from + (self.0 >> 33) % (to - from)
    }
}

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Interrupted,
    Terminated,
    Quit,
    Panic,
    Return,
    Aborted,
    Killed,
}

impl End {
    const ALL: [Self; 7] = [
        Self::Interrupted,
        Self::Terminated,
        Self::Quit,
        Self::Panic,
        Self::Return,
        Self::Aborted,
        Self::Killed,
    ];

    const fn argument(self) -> &'static str {
        match self {
            Self::Interrupted | Self::Terminated | Self::Quit | Self::Killed => "wait",
            Self::Panic => "panic",
            Self::Return => "return",
            Self::Aborted => "abort",
        }
    }

    /// True when nothing of the program runs any more, so that only the drives can stop their axes.
    const fn at_once(self) -> bool {
        matches!(self, Self::Aborted | Self::Killed)
    }

    /// Ends the program at this moment and checks how it ended; what it printed.
    #[track_caller]
    fn of(self, lab: &Lab, names: &[String], moment: u64) -> String {
        let mut program = start(lab, &[self.argument(), "ctl0", &moment.to_string()], names);
        program.wait_for("opened", SHORT);
        let signal = match self {
            Self::Interrupted => Some("INT"),
            Self::Terminated => Some("TERM"),
            Self::Quit => Some("QUIT"),
            Self::Killed => Some("KILL"),
            Self::Panic | Self::Return | Self::Aborted => None,
        };
        if let Some(signal) = signal {
            std::thread::sleep(Duration::from_millis(moment));
            program.signal(signal);
        }
        let finished = program.finish(SHORT);
        let code = match self {
            Self::Interrupted | Self::Terminated | Self::Quit => Some(130),
            Self::Panic => Some(101),
            Self::Return => Some(0),
            // the tool around it ends by the same signal, or reports it by its code
            Self::Aborted => finished.code.filter(|&code| code == 128 + 6),
            Self::Killed => finished.code.filter(|&code| code == 128 + 9),
        };
        assert_eq!(finished.code, code, "{self:?} after {moment} ms: {finished:?}");
        finished.out
    }
}

/// While the axes are taken, come up and turn.
const SPANS: [(u64, u64); 3] = [(0, 800), (800, 1600), (1600, 3000)];

/// The fault of each drive when its controller is lost: AKD 702, VLT F17 (control word timeout, with 8-04 = 5), Vacon 53.
const WATCHDOGS: [(&str, u64); 3] = [("akd-1", 702), ("vlt-1", 17), ("vacon-1", 53)];

/// Whether the program reported that this axis turned.
fn turned(out: &str, name: &str) -> bool {
    out.contains(&format!("{{\"axis\":\"{name}\",\"turning\""))
}

#[test]
fn a_program_that_ends_at_any_moment_leaves_all_drives_at_rest() {
    let lab = Lab::alone("many-axes-end");
    let (plant, names) = plant(&lab, &[("akd", 1), ("vlt", 1), ("vacon", 1)]);
    let _drives = simulate(&lab, &[plant.to_str().unwrap()]);
    // by default nothing stops a VLT without its controller
    client(&lab, &["write", "vlt-1", "8-04=5"]).ok();
    let mut moments = Moments::new();
    for end in End::ALL {
        for (from, to) in SPANS {
            let moment = moments.within(from, to);
            let out = end.of(&lab, &names, moment);
            let when = format!("{end:?} after {moment} ms");
            println!("{when}: {} lines", out.lines().count());
            for name in &names {
                let report = at_rest(&lab, name, &when);
                let faults = report["faults"].as_array().expect("a list");
                if !end.at_once() {
                    assert!(faults.is_empty(), "{when}: {name}: {report}");
                    continue;
                }
                if turned(&out, name) {
                    // the watchdog of the drive stopped it
                    let (_, watchdog) = WATCHDOGS.iter().find(|(drive, _)| drive == name).unwrap();
                    assert_eq!(faults[0]["number"], *watchdog, "{when}: {report}");
                }
                if !faults.is_empty() {
                    client(&lab, &["ack", name]).ok();
                }
            }
        }
    }
}

/// As delivered nothing stops a VLT without its controller (8-04 is 0): only who consents to that may enable it.
#[test]
fn a_drive_without_a_watchdog_is_enabled_with_consent_only() {
    let lab = Lab::new("many-axes-consent");
    let (plant, names) = plant(&lab, &[("vlt", 1)]);
    let _drives = simulate(&lab, &[plant.to_str().unwrap()]);
    let refused = start(&lab, &["wait", "ctl0", "0"], &names).finish(SHORT);
    assert_eq!(refused.code, Some(1), "{refused:?}");
    assert!(!turned(&refused.out, "vlt-1"), "{refused:?}");
    for words in ["vlt-1", "8-04"] {
        assert!(refused.err.contains(words), "{words}: {refused:?}");
    }
    at_rest(&lab, "vlt-1", "without consent");

    let mut program = start(&lab, &["consent", "ctl0", "0"], &names);
    program.wait_for("turning", SHORT);
    program.signal("KILL");
    let _ = program.finish(SHORT);
    // what was consented to: the drive turns on, until it is stopped
    let status = client(&lab, &["status", "vlt-1", "--json"]);
    let report: Value = serde_json::from_str(status.out.lines().next().unwrap()).unwrap();
    assert_eq!(report["state"], "S4", "{report}");
    assert!(report["speed_actual"]["value"].as_f64() > Some(100.0), "{report}");
    client(&lab, &["stop", "vlt-1"]).ok();
    at_rest(&lab, "vlt-1", "after its stop");
}
