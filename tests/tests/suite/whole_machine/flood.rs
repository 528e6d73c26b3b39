//! A flood of requests beside the work of drives.

use std::fs;
use std::time::Duration;

use system_tests::{Lab, Running, Side, built, client, peer, simulate};

const SHORT: Duration = Duration::from_secs(20);

/// Most memory that the program has had so far, in octets.
fn peak_memory(program: &Running) -> u64 {
    let status = fs::read_to_string(format!("/proc/{}/status", program.pid())).unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    let kibibytes: u64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    kibibytes * 1024
}

#[test]
fn a_flood_of_names_and_resets_costs_neither_memory_nor_the_connection_of_another_drive() {
    let lab = Lab::alone("hostile-flood");
    let state = lab.folder().join("kept");
    let _ = fs::remove_dir_all(&state);
    let drives = ["--name", "akd", "--count", "2", "--ip", "192.168.77.50/24"];
    let drives = simulate(
        &lab,
        &[&drives[..], &["--state", state.to_str().unwrap()]].concat(),
    );
    let before = peak_memory(&drives);
    let found = client(&lab, &["--json", "scan"]).ok().out;
    let found: serde_json::Value = serde_json::from_str(&found).unwrap();
    let stations = found["stations"].as_array().unwrap();
    let target = stations
        .iter()
        .find(|station| station["name"] == "akd-1")
        .unwrap();
    let target = target["mac"].as_str().unwrap();

    let other = ["-i", "ctl0", "run", "akd-2", "--velocity", "60rpm", "--for", "4s"];
    let calm = ["--cycle", "32ms", "--watchdog", "31"];
    let mut run = lab.spawn(
        Side::Controller,
        built("profidrive"),
        [&other[..], &calm].concat(),
    );
    run.wait_for("S4", SHORT);
    let script = peer("dcp_flood.py");
    let flood = [script.to_str().unwrap(), "ctl0", target, "3", "9000"];
    let flood = lab.run(Side::Controller, "python3", flood, SHORT).ok();
    assert!(flood.out.contains("sent"), "{flood:?}");
    run.finish(SHORT).ok();

    let grown = peak_memory(&drives).saturating_sub(before);
    assert!(grown < 16 << 20, "{grown} octets more");
    let printed = drives.out();
    assert!(printed.contains("come too fast and are ignored"), "{printed}");
    assert!(
        printed.lines().count() < 1000,
        "{} lines",
        printed.lines().count()
    );
    // an engineer is served again, and the end does not wait for abandoned requests
    client(&lab, &["name", target, "mine"]).ok();
    drives.interrupt(SHORT).ok();
    let kept = fs::read_to_string(state.join("akd-1.network.json")).unwrap();
    assert!(kept.contains(r#""name": "mine""#), "{kept}");
}
