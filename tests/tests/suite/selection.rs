//! One command for a machine of eight drives of three vendors.

use std::time::Duration;

use serde_json::Value;
use system_tests::{Finished, Lab, Side, built, client, simulate};

const PLANT: &str = r#"
    [[drive]]
    name = "akd-1"
    ip = "192.168.77.51/24"
    [[drive]]
    name = "akd-2"
    ip = "192.168.77.52/24"
    event = [{ at = "0s", do = "fault=439" }]
    [[drive]]
    name = "akd-3"
    ip = "192.168.77.53/24"
    [[drive]]
    name = "akd-10"
    ip = "192.168.77.54/24"
    [[drive]]
    name = "vlt-1"
    model = "vlt"
    ip = "192.168.77.61/24"
    [[drive]]
    name = "vlt-2"
    model = "vlt"
    ip = "192.168.77.62/24"
    [[drive]]
    name = "vacon-1"
    model = "vacon"
    ip = "192.168.77.71/24"
    [[drive]]
    name = "vacon-2"
    model = "vacon"
    ip = "192.168.77.72/24"
"#;

/// The first words of the lines of a table, without its headings.
fn first_words(finished: &Finished) -> Vec<&str> {
    let lines = finished.out.lines().skip(1);
    lines.filter_map(|line| line.split_whitespace().next()).collect()
}

#[test]
fn a_machine_in_one_command_each() {
    let lab = Lab::new("selection");
    let plant = lab.folder().join("plant.toml");
    std::fs::write(&plant, PLANT).unwrap();
    let _drives = simulate(&lab, &[plant.to_str().unwrap()]);

    // the one that does not run, before all others
    let status = client(&lab, &["status", "--short"]);
    assert_eq!(status.code, Some(5), "{status:?}");
    let names = first_words(&status);
    assert_eq!((names[0], names.len()), ("akd-2", 8), "{status:?}");
    assert!(
        status.err.contains("kept from running: akd-2 (1 of 8)"),
        "{status:?}"
    );
    let faults = client(&lab, &["faults", "model=akd"]).ok();
    assert_eq!(first_words(&faults), ["akd-2", "akd-1", "akd-3", "akd-10"]);
    client(&lab, &["ack", "akd-2,akd-3"]).ok();
    client(&lab, &["status"]).ok();

    // ramps on four, after a plan that could not be carried out on all
    let refused = client(&lab, &["write", "akd-*,vlt-1", "DRV.ACC=4000", "--yes"]);
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(
        refused
            .err
            .contains("nothing was written; failed: vlt-1 (1 of 5)"),
        "{refused:?}"
    );
    let unasked = client(&lab, &["write", "akd-*", "DRV.ACC=4000"]);
    assert_eq!(unasked.code, Some(6), "{unasked:?}");
    let before = client(&lab, &["read", "akd-*", "DRV.ACC", "--json"]).ok();
    let values = |read: &Finished| -> Vec<f64> {
        let document: Value = serde_json::from_str(&read.out).unwrap();
        let drives = document["drives"].as_array().unwrap().iter();
        drives
            .map(|one| one["report"]["parameters"][0]["value"].as_f64().unwrap())
            .collect()
    };
    assert_eq!(values(&before), [3000.0; 4]);
    let written = client(&lab, &["write", "akd-*", "DRV.ACC=4000", "--yes"]).ok();
    assert_eq!(first_words(&written), ["akd-1", "akd-2", "akd-3", "akd-10"]);
    let after = client(&lab, &["read", "akd-*", "DRV.ACC", "--json"]).ok();
    assert_eq!(values(&after), [4000.0; 4]);

    // backups of all, each of which is a backup of its drive
    let folder = lab.folder().join("backups");
    let folder = folder.to_str().unwrap();
    let saved = client(&lab, &["backup", "all", "-o", folder]).ok();
    assert_eq!(first_words(&saved).len(), 8);
    let same = client(&lab, &["diff", &format!("{folder}/vlt-2.backup"), "vlt-2"]).ok();
    assert!(same.out.is_empty(), "{same:?}");
    client(&lab, &["diff", folder, "all"]).ok();
    client(&lab, &["write", "akd-2", "DRV.ACC=4100"]).ok();
    std::fs::copy(format!("{folder}/akd-1.backup"), format!("{folder}/gone.backup")).unwrap();
    let drift = client(&lab, &["diff", folder, "all"]);
    assert_eq!(
        (drift.code, first_words(&drift)),
        (Some(5), vec!["akd-2"]),
        "{drift:?}"
    );
    assert!(
        drift.err.contains("not as in the backup: akd-2 (1 of 8)")
            && drift.err.contains("gone.backup: no drive of this name answers"),
        "{drift:?}"
    );
    client(&lab, &["write", "akd-2", "DRV.ACC=4000"]).ok();
    let again = client(&lab, &["backup", "all", "-o", folder]).ok();
    assert_eq!(again.out.matches("unchanged").count(), 8, "{again:?}");
    client(&lab, &["write", "akd-1", "DRV.ACC=4500"]).ok();
    let newer = client(&lab, &["backup", "all", "-o", folder]).ok();
    assert_eq!(newer.out.matches("older one replaced").count(), 1, "{newer:?}");
}

#[test]
fn stop_all_brings_every_axis_to_rest_beside_its_controller() {
    let lab = Lab::new("stop-all");
    let plant = lab.folder().join("plant.toml");
    std::fs::write(&plant, PLANT).unwrap();
    let _drives = simulate(&lab, &[plant.to_str().unwrap()]);
    let arguments = ["run", "akd-1", "--velocity", "300rpm", "--for", "60s", "--json"];
    let mut running = lab.spawn(Side::Controller, built("profidrive"), arguments);
    running.wait_for(r#""state":"S4""#, Duration::from_secs(20));
    let stopped = client(&lab, &["stop", "all", "--json"]).ok();
    let document: Value = serde_json::from_str(&stopped.out).unwrap();
    let drives = document["drives"].as_array().unwrap();
    assert_eq!(drives.len(), 8, "{document}");
    assert!(
        drives.iter().all(|one| one["report"]["at_rest"] == true),
        "{document}"
    );
    let sent: Vec<&str> = drives
        .iter()
        .filter_map(|one| one["report"]["sent"].as_str())
        .collect();
    assert_eq!(sent, ["DRV.STOP"], "{document}");
    // the one who runs the axis reads so
    let ended = running.finish(Duration::from_secs(20));
    assert_ne!(ended.code, Some(0), "{ended:?}");
}
