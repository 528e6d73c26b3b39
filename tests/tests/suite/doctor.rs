//! What `doctor` finds on this computer and on its network.

use std::time::Duration;

use serde_json::Value;
use system_tests::{Finished, Lab, Side, built, client, simulate};

/// The findings of a check, as severity and text.
fn found(finished: &Finished, check: &str) -> Vec<(String, String)> {
    let document: Value = serde_json::from_str(&finished.out).unwrap();
    let findings = document["findings"].as_array().unwrap().iter();
    let of_check = findings.filter(|one| one["check"] == check);
    let text = |one: &Value, field: &str| one[field].as_str().unwrap_or_default().to_owned();
    let with_drive = |one: &Value| format!("{} {}", text(one, "drive"), text(one, "found"));
    of_check
        .map(|one| (text(one, "severity"), with_drive(one)))
        .collect()
}

/// The only finding of a check.
#[track_caller]
fn only(finished: &Finished, check: &str) -> (String, String) {
    let found = found(finished, check);
    assert_eq!(found.len(), 1, "{check}: {finished:?}");
    found.into_iter().next().unwrap()
}

#[test]
fn an_interface_that_is_down_or_without_a_carrier_is_an_error_with_its_remedy() {
    let lab = Lab::new("doctor-down");
    lab.link(Side::Device, false);
    let without = client(&lab, &["doctor", "--json"]);
    assert_eq!(without.code, Some(1), "{without:?}");
    assert_eq!(only(&without, "carrier").0, "error");
    assert_eq!(only(&without, "stations").0, "error");
    lab.link(Side::Controller, false);
    let down = client(&lab, &["doctor", "--json"]);
    assert_eq!(only(&down, "interface").0, "error");
    assert!(down.out.contains("ip link set ctl0 up"), "{down:?}");
    // the timers of this computer are measured all the same
    assert!(!found(&down, "timers").is_empty(), "{down:?}");
}

#[test]
fn a_drive_in_another_subnet_is_an_error() {
    let lab = Lab::new("doctor-subnet");
    let plant = r#"
        [[drive]]
        name = "akd-1"
        ip = "192.168.77.51/24"
        [[drive]]
        name = "akd-far"
        ip = "192.168.5.52/24"
    "#;
    let file = lab.folder().join("plant.toml");
    std::fs::write(&file, plant).unwrap();
    let _drives = simulate(&lab, &[file.to_str().unwrap()]);
    let examined = client(&lab, &["doctor", "--json"]);
    assert_eq!(examined.code, Some(1), "{examined:?}");
    let (severity, text) = only(&examined, "reach");
    assert_eq!(severity, "error");
    assert!(
        text.starts_with("akd-far other subnet: 192.168.5.52/24"),
        "{text}"
    );
}

#[test]
fn a_port_that_another_process_has_is_named_with_the_process() {
    let lab = Lab::new("doctor-port");
    let _drives = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.51/24"]);
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
            "--may-run-on",
        ],
    );
    run.wait_for("S4 operation", Duration::from_secs(20));
    let examined = client(&lab, &["doctor", "akd-1", "--json"]);
    let (severity, text) = only(&examined, "port");
    assert_eq!(severity, "warning");
    assert!(text.contains("by profidrive (process "), "{text}");
    run.interrupt(Duration::from_secs(20)).ok();
    let free = client(&lab, &["doctor", "akd-1", "--json"]);
    assert_eq!(only(&free, "port").0, "ok");
}

#[test]
fn loss_is_measured_and_named() {
    let lab = Lab::new("doctor-loss");
    let _drives = simulate(
        &lab,
        &["--name", "akd", "--count", "2", "--ip", "192.168.77.51/24"],
    );
    client(&lab, &["inject", "akd-2", "loss=40%"]).ok();
    let examined = client(&lab, &["doctor", "--json"]);
    assert_eq!(examined.code, Some(1), "{examined:?}");
    let lossy = found(&examined, "loss");
    let of = |name: &str| lossy.iter().find(|(_, text)| text.starts_with(name)).unwrap();
    let (severity, text) = of("akd-2");
    assert!(severity == "error" && text.contains("packet loss: "), "{lossy:?}");
    assert!(of("akd-1").1.contains("40 requests"), "{lossy:?}");
}

#[test]
fn two_stations_of_one_name_are_an_error() {
    let lab = Lab::new("doctor-name");
    let drive = |ip, mac| simulate(&lab, &["--name", "akd-1", "--ip", ip, "--mac", mac]);
    let _first = drive("192.168.77.51/24", "02:50:4e:00:00:71");
    let mut second = drive("192.168.77.52/24", "02:50:4e:00:00:72");
    second.wait_for("the name akd-1 is taken", Duration::from_secs(20));
    let examined = client(&lab, &["doctor", "--json"]);
    assert_eq!(examined.code, Some(1), "{examined:?}");
    let (severity, text) = only(&examined, "duplicates");
    assert_eq!(severity, "error");
    assert!(text.contains("2 stations have the name akd-1"), "{text}");
}
