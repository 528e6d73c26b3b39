//! Expectations of a plant at the command line: exit codes, messages, files.

#![allow(clippy::unwrap_used)]

mod binary;

use std::path::PathBuf;

use binary::{profidrive, stderr, stdout};

/// A file for one test.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str, text: &str) -> Self {
        let path = std::env::temp_dir().join(format!("profidrive-expect-{}-{name}", std::process::id()));
        std::fs::write(&path, text).unwrap();
        Self(path)
    }

    fn path(&self) -> &str {
        self.0.to_str().unwrap()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

const PRESS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plants/press.toml");

fn press(more: &[&str]) -> std::process::Output {
    profidrive(&[&["simulate", PRESS, "--virtual-time"], more].concat())
}

#[test]
fn expectations_that_hold_end_with_success_and_a_trace_of_typed_events() {
    let trace = Scratch::new("trace", "");
    let output = press(&["--trace", trace.path()]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(
        stderr(&output).ends_with("5 expectations: all met\n"),
        "{output:?}"
    );
    let text = std::fs::read_to_string(&trace.0).unwrap();
    let events: Vec<serde_json::Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(events.len(), stdout(&output).lines().count());
    let fault = events
        .iter()
        .find(|event| event["event"] == "fault_raised")
        .unwrap();
    assert_eq!(
        (&fault["drive"], &fault["fault"]["number"]),
        (&"press-1".into(), &702.into())
    );
    let lost = events
        .iter()
        .find(|event| event["event"] == "connection_lost")
        .unwrap();
    assert_eq!(lost["time_ns"], fault["time_ns"]);
    assert!(
        events
            .iter()
            .any(|event| event["event"] == "restored" && event["action"] == "cable=plugged")
    );
    assert!(
        events
            .iter()
            .any(|event| event["event"] == "fault_cleared" && event["fault"]["number"] == 702)
    );
}

#[test]
fn a_lost_expectation_is_exit_code_5_with_what_was_there_instead() {
    let more = Scratch::new(
        "lost.toml",
        "expect = [\n{ name = \"fast\", within = \"700ms\", after = \"1.5s\", drive = \"press-1\", speed = \"130rpm\", tolerance = \"1%\" },\n\
         { name = \"late\", at = \"40s\", drive = \"press-1\", state = \"S1\" },\n\
         { name = \"no start\", within = \"1s\", after = { drive = \"feeder-1\", fault = 439 }, drive = \"feeder-1\", state = \"S1\" },\n]\n",
    );
    let junit = Scratch::new("lost.xml", "");
    let output = press(&["--expect", more.path(), "--junit", junit.path()]);
    assert_eq!(output.status.code(), Some(5), "{output:?}");
    let text = stderr(&output);
    for part in [
        "error: 3 of 8 expectations lost\n",
        "lost.toml, line 2: press-1: fast: not met\n",
        "expected: within = \"700ms\", after = \"1.5s\", drive = \"press-1\", speed = \"130rpm\", tolerance = \"1%\"\n",
        "actual:   speed 120.",
        "nearest:  speed 120.2",
        "S2 ready for switching on -> S4 operation\n",
        "line 3: press-1: late: the run ended before its time\n",
        "line 4: feeder-1: no start: its time never started\n",
        "seed 7\n",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let report = std::fs::read_to_string(&junit.0).unwrap();
    assert!(
        report.contains("tests=\"8\" failures=\"1\" errors=\"2\""),
        "{report}"
    );
}

#[test]
fn mistakes_end_before_the_run() {
    let wrong = Scratch::new("wrong.toml", "\nexpect = [{ at = \"1s\", speed = \"1rpm\" }]");
    let nothing = Scratch::new("nothing.toml", "duration = \"1s\"\n[[drive]]\nname = \"a\"\n");
    let output = press(&["--expect", wrong.path()]);
    assert_eq!(
        (output.status.code(), stdout(&output)),
        (Some(2), String::new()),
        "{output:?}"
    );
    assert!(
        stderr(&output).contains("wrong.toml, line 2: speed: "),
        "{output:?}"
    );
    let output = press(&["--junit", "/no/such/folder/x.xml"]);
    assert_eq!(
        (output.status.code(), stdout(&output)),
        (Some(1), String::new()),
        "{output:?}"
    );
    let output = profidrive(&["simulate", nothing.path(), "--virtual-time", "--junit", "x.xml"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(
        stderr(&output).contains("the plant has no expectations"),
        "{output:?}"
    );
    let output = profidrive(&["simulate", PRESS, "--expect", wrong.path(), "-i", "none0"]);
    assert_eq!(
        output.status.code(),
        Some(2),
        "before the interface is looked for: {output:?}"
    );
    let output = profidrive(&["simulate", "--expect", wrong.path(), "-i", "none0"]);
    assert_eq!(output.status.code(), Some(2), "without a plant: {output:?}");
}
