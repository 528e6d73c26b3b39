//! A plant of three vendors on a wire, each drive what its vendor's tables say, and drives under the name of a device
//! description.

use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use system_tests::{Lab, Side, built, client, judge, simulate};

const PLANT: &str = r#"
    [[drive]]
    model = "vacon"
    name = "vacon-1"
    ip = "192.168.77.51/24"
    [[drive]]
    model = "vlt"
    name = "vlt-1"
    ip = "192.168.77.52/24"
    [[drive]]
    name = "akd-1"
    ip = "192.168.77.53/24"
"#;

/// Name, vendor and device of what a scan finds.
fn scanned(lab: &Lab) -> Vec<(String, u64, u64)> {
    let found = client(lab, &["--json", "scan"]).ok();
    let found: Value = serde_json::from_str(&found.out).unwrap_or_else(|e| panic!("{e}: {}", found.out));
    let stations = found["stations"].as_array().expect("stations");
    let row = |station: &Value| {
        let number = |key: &str| {
            station[key]
                .as_u64()
                .unwrap_or_else(|| panic!("{key} of {station}"))
        };
        let name = station["name"].as_str().expect("a name").to_owned();
        (name, number("vendor_id"), number("device_id"))
    };
    let mut rows: Vec<_> = stations.iter().map(row).collect();
    rows.sort();
    rows
}

/// Returns the file that `gsdml export` writes for a model, with these changes.
fn exported(lab: &Lab, model: &str, changes: &[(&str, &str)]) -> PathBuf {
    let folder = lab.folder().join(format!("{model}-{}", changes.len()));
    let line = ["gsdml", "export", "--model", model, "-o"];
    let output = Command::new(built("profidrive")).args(line).arg(&folder).output();
    let output = output.expect("the program runs");
    assert!(output.status.success(), "{output:?}");
    let written = String::from_utf8(output.stdout).expect("text");
    let file = PathBuf::from(written.lines().next().expect("a path"));
    let mut text = std::fs::read_to_string(&file).expect("the file");
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    std::fs::write(&file, text).expect("the file");
    file
}

#[test]
fn each_drive_of_a_plant_has_its_model() {
    let lab = Lab::new("plant-makes");
    let plant = lab.folder().join("plant.toml");
    std::fs::write(&plant, PLANT).unwrap();
    let capture = lab.capture("traffic");
    let drives = simulate(&lab, &[plant.to_str().unwrap()]);
    let identities = [
        ("akd-1".to_owned(), 0x0105, 0x0001),
        ("vacon-1".to_owned(), 0x01BA, 0x0100),
        ("vlt-1".to_owned(), 0x0080, 0x0001),
    ];
    assert_eq!(scanned(&lab), identities);
    for (line, words) in [
        (&["info", "vlt-1"][..], "FC-302"),
        (&["info", "akd-1"], "AKD-P00306"),
        (&["read", "vacon-1", "ID103"], "Acceleration time 1"),
        (&["read", "vlt-1", "3-41"], "Ramp 1 Ramp up Time"),
        (&["status", "vlt-1"], "words        of Danfoss PROFIdrive"),
        (&["status", "vacon-1"], "no controller is connected"),
    ] {
        let printed = client(&lab, line).ok().out;
        assert!(printed.contains(words), "{line:?}: {printed}");
    }
    client(&lab, &["write", "vacon-1", "ID103=0.5s", "ID104=0.5s"]).ok();
    // an update time that a busy machine keeps
    let order = [
        "run",
        "vacon-1",
        "--velocity",
        "300rpm",
        "--for",
        "1s",
        "--cycle",
        "64ms",
    ];
    let run = client(&lab, &order).ok();
    assert!(run.out.contains("S4 operation"), "{run:?}");
    drives.interrupt(Duration::from_secs(5)).ok();

    // a device description is that of its vendor's drives, the others stay what they are
    let changed = [("DeviceID=\"0x0100\"", "DeviceID=\"0x0777\"")];
    let file = exported(&lab, "vacon", &changed);
    let drives = simulate(
        &lab,
        &[plant.to_str().unwrap(), "--gsdml", file.to_str().unwrap()],
    );
    let [akd, (name, vendor, _), vlt] = identities;
    assert_eq!(scanned(&lab), [akd, (name, vendor, 0x0777), vlt]);
    drives.interrupt(Duration::from_secs(5)).ok();
    judge::judge(&capture.stop())
        .clean()
        .saw("pn_dcp", 6)
        .saw("pn_io", 20);
}

#[test]
fn a_device_description_determines_the_model() {
    let lab = Lab::new("vendor-unknown");
    let network = ["--name", "strange-1", "--ip", "192.168.77.50/24"];
    // of a vendor whose drives are simulated: no word about the model is needed
    let file = exported(&lab, "vlt", &[]);
    let own = [&["--gsdml", file.to_str().unwrap()], &network[..]].concat();
    let drive = simulate(&lab, &own);
    assert_eq!(scanned(&lab), [("strange-1".to_owned(), 0x0080, 0x0001)]);
    let printed = client(&lab, &["read", "strange-1", "3-41"]).ok().out;
    assert!(printed.contains("Ramp 1 Ramp up Time"), "{printed}");
    drive.interrupt(Duration::from_secs(5)).ok();

    // of an unknown vendor: its model must be given
    let file = exported(&lab, "vlt", &[("VendorID=\"0x0080\"", "VendorID=\"0x0ABC\"")]);
    let strange = [&["--gsdml", file.to_str().unwrap()], &network[..]].concat();
    let line = [&["simulate", "-i", "dev0"], &strange[..]].concat();
    let refused = lab.run(Side::Device, built("profidrive"), line, Duration::from_secs(10));
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(
        refused.err.contains("of vendor 0x0ABC") && refused.err.contains("--model"),
        "{refused:?}"
    );
    let drive = simulate(&lab, &[&strange[..], &["--model", "vlt"]].concat());
    assert!(
        drive.err().contains("of vendor 0x0ABC, inside model VLT"),
        "{}",
        drive.err()
    );
    assert_eq!(scanned(&lab), [("strange-1".to_owned(), 0x0ABC, 0x0001)]);
    // its tables are learned from itself
    let printed = client(&lab, &["read", "strange-1", "341"]).ok().out;
    assert!(printed.contains("Ramp 1 Ramp up T"), "{printed}");
    drive.interrupt(Duration::from_secs(5)).ok();
}
