//! Who is on the network: what each station reports, as a table, for spreadsheets and for programs, and who comes and goes.

use std::time::Duration;

use serde_json::Value;
use system_tests::{Finished, Lab, Side, built, client, simulate};

const PLANT: &str = r#"
    [[drive]]
    name = "akd-1"
    ip = "192.168.77.51/24"
    event = [{ at = "0s", do = "fault=439" }]
    [[drive]]
    name = "vlt-1"
    model = "vlt"
    ip = "192.168.77.61/24"
    [[drive]]
    name = "akd-far"
    ip = "192.168.5.52/24"
    [[drive]]
    name = "akd-new"
"#;

/// The cells of a CSV file by their headings. No cell of these stations has a quote.
fn cells(finished: &Finished) -> Vec<Vec<(String, String)>> {
    let mut lines = finished.out.lines();
    let split = |line: &str| -> Vec<String> {
        let mut quoted = false;
        let mut cells = vec![String::new()];
        for letter in line.chars() {
            match letter {
                '"' => quoted = !quoted,
                ',' if !quoted => cells.push(String::new()),
                letter => cells.last_mut().unwrap().push(letter),
            }
        }
        cells
    };
    let headings = split(lines.next().unwrap());
    let row = |line| {
        let cells = split(line);
        assert_eq!(cells.len(), headings.len(), "{line}");
        headings.iter().cloned().zip(cells).collect()
    };
    lines.map(row).collect()
}

fn cell<'r>(row: &'r [(String, String)], heading: &str) -> &'r str {
    &row.iter().find(|(of, _)| of == heading).unwrap().1
}

#[test]
fn each_station_tells_who_it_is() {
    let lab = Lab::new("scanning");
    let plant = lab.folder().join("plant.toml");
    std::fs::write(&plant, PLANT).unwrap();
    let _drives = simulate(&lab, &[plant.to_str().unwrap()]);

    client(&lab, &["name", "akd-new", ""]).ok();

    let rows = cells(&client(&lab, &["scan", "--csv"]).ok());
    let shown = |name: &str| {
        let row = rows.iter().find(|row| cell(row, "name") == name).unwrap();
        [
            "vendor",
            "type",
            "serial_number",
            "software_revision",
            "state",
            "remarks",
        ]
        .map(|of| cell(row, of).to_owned())
    };
    assert_eq!(rows.len(), 4);
    let [vendor, kind, serial, software, state, remarks] = shown("akd-1");
    assert_eq!((&*vendor, &*kind, &*remarks), ("Kollmorgen", "AKD", ""));
    assert!(
        !serial.is_empty() && software.starts_with('V'),
        "{serial} {software}"
    );
    assert!(state.contains("fault"), "{state}");
    let [vendor, _, _, software, ..] = shown("vlt-1");
    assert_eq!((&*vendor, software.is_empty()), ("Danfoss", false));
    let [.., serial, _, _, remarks] = shown("akd-far");
    assert_eq!((&*serial, &*remarks), ("", "other subnet"));
    let [.., remarks] = shown("");
    assert_eq!(remarks, "no name, no IP address");

    let text = client(&lab, &["scan"]).ok();
    let line = text.out.lines().find(|line| line.starts_with("akd-1 ")).unwrap();
    assert!(
        line.contains("Kollmorgen") && line.contains(&shown("akd-1")[2]),
        "{text:?}"
    );
    assert!(text.out.contains("other subnet"), "{text:?}");

    let document = client(&lab, &["--json", "scan"]).ok().json_lines().remove(0);
    let stations = document["stations"].as_array().unwrap();
    let station = |name: &str| stations.iter().find(|one| one["name"] == name).unwrap();
    assert_eq!(
        station("akd-1")["info"]["identity"]["serial_number"],
        shown("akd-1")[2].as_str()
    );
    assert_eq!(station("akd-1")["info"]["faults"][0]["number"], 439);
    assert_eq!(station("akd-far")["remarks"], serde_json::json!(["other_subnet"]));
    assert_eq!(station("akd-far")["info"], Value::Null);

    // what discovery reports needs nothing of the devices
    let document = client(&lab, &["--json", "scan", "--quick"])
        .ok()
        .json_lines()
        .remove(0);
    let stations = document["stations"].as_array().unwrap();
    assert!(
        stations.len() == 4 && stations.iter().all(|one| one["info"].is_null()),
        "{document}"
    );
}

#[test]
fn who_comes_and_goes_is_shown() {
    let lab = Lab::new("scan-watch");
    let mut drives = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.51/24"]);
    let limit = Duration::from_secs(20);
    let interface = Side::Controller.interface();
    let watch = ["scan", "-i", interface, "--watch", "--for", "300ms", "--json"];
    let mut watching = lab.spawn(Side::Controller, built("profidrive"), watch);
    watching.wait_for(r#""change":"came""#, limit);
    drives.kill();
    watching.wait_for(r#""change":"went""#, limit);
    let _again = simulate(&lab, &["--name", "akd-2", "--ip", "192.168.77.51/24"]);
    watching.wait_for("akd-2", limit);
    let ended = watching.interrupt(limit).ok();
    let changes: Vec<(Value, Value)> = ended
        .json_lines()
        .into_iter()
        .map(|one| (one["change"].clone(), one["station"]["name"].clone()))
        .collect();
    let expected = [("came", "akd-1"), ("went", "akd-1"), ("came", "akd-2")];
    assert_eq!(
        changes,
        expected.map(|(change, name)| (change.into(), name.into()))
    );
}
