//! What `simulate` shows of many drives.

use std::time::Duration;

use serde_json::Value;
use system_tests::{Lab, Side, built, peer, python, wait_until};

const URL: &str = "http://127.0.0.1:9464/metrics";

/// Reads the figures with an independent parser.
fn figures(lab: &Lab) -> Value {
    let script = peer("metrics.py");
    let line = [script.to_str().unwrap(), URL];
    let finished = lab.run(Side::Device, python(), line, Duration::from_secs(20));
    finished.ok().json_lines().remove(0)
}

#[test]
fn many_drives_are_shown_as_a_summary_and_to_prometheus() {
    let lab = Lab::new("fleet");
    let line =
        "simulate --model akd -i dev0 --name akd --count 40 --ip 192.168.77.101/24 --metrics 127.0.0.1:9464";
    let mut drives = lab.spawn(Side::Device, built("profidrive"), line.split(' '));
    drives.wait_for("40 drives", Duration::from_secs(5));
    let before = figures(&lab);
    assert_eq!(before["profidrive_drives_exchanging"], 0.0, "{before}");

    let names: Vec<String> = (1..=40).map(|n| format!("akd-{n}")).collect();
    let names = names.join(",");
    let line = ["ctl0", "akd", &names, "cycle_us=16000", "seconds=4", "hold=30"];
    let controller = lab.spawn(Side::Controller, built("test-controller"), line);
    let summary = "40 of 40 drives exchange data every 16 ms; frames per second";
    assert!(
        wait_until(Duration::from_secs(20), || drives.err().contains(summary)),
        "{}",
        drives.err()
    );
    let first = figures(&lab);
    let second = {
        let later = |now: &Value| {
            now["profidrive_uptime_seconds"].as_f64() > first["profidrive_uptime_seconds"].as_f64()
        };
        let mut now = figures(&lab);
        assert!(wait_until(Duration::from_secs(5), || {
            now = figures(&lab);
            later(&now)
        }));
        now
    };
    let number = |of: &Value, name: &str| of[format!("profidrive_{name}")].as_f64().unwrap();
    for (name, value) in [
        ("drives", 40.0),
        ("drives_exchanging", 40.0),
        ("connections_total", 40.0),
        ("shortest_cycle_seconds", 0.016),
        ("longest_cycle_seconds", 0.016),
        ("frames_unsent_total", 0.0),
    ] {
        assert_eq!(number(&first, name), value, "{name}: {first}");
    }
    let passed = |name: &str| number(&second, name) - number(&first, name);
    // each drive sends and receives a frame every 16 ms; a process that was held up leaves some out
    let cycles = 40.0 * passed("uptime_seconds") / 0.016;
    for name in ["frames_sent_total", "frames_received_total"] {
        assert!(
            (0.3..1.1).contains(&(passed(name) / cycles)),
            "{name}: {first} {second}"
        );
    }
    assert!(passed("processor_seconds_total") > 0.0, "{first} {second}");

    controller.finish(Duration::from_secs(30)).ok();
    let gone = wait_until(Duration::from_secs(10), || drives.err().contains("; 40 faults"));
    let last = figures(&lab);
    assert!(!gone || number(&last, "faults_total") == 40.0, "{last}");
    assert_eq!(number(&last, "disconnections_total"), 40.0, "{last}");
    let ended = drives.interrupt(Duration::from_secs(5)).ok();
    assert_eq!(ended.out, "", "no line for each drive");
}
