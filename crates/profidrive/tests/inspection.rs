//! What stations and drives are like, in a plant in memory.
#![cfg(feature = "simulate")]

use std::time::Duration;

use profidrive::client::{Action, Drive, ErrorKind};
use profidrive::inspection::{faults, info, status};
use profidrive::report::PlainWording;
use profidrive::scan::discover;
use profidrive::{Network, Outcome, Wait};

const PLANT: &str = r#"
[[drive]]
name = "akd-1"
ip = "10.0.0.1/24"
event = [{ at = "3s", do = "fault=439" }]
[[drive]]
name = "vlt-1"
model = "vlt"
ip = "10.0.0.2/24"
"#;

fn open(plant: &str) -> Network {
    profidrive::open_plan(plant.parse().expect("a plant")).expect("opens")
}

fn find(network: &mut Network, name: &str) -> Drive {
    network
        .find(&name.parse().expect("a name"))
        .wait()
        .expect("there")
}

#[test]
fn a_scan_without_an_answer_is_an_outcome() {
    let mut network = open(PLANT);
    let time = Duration::from_secs(1);
    let found = discover(&mut network, time).wait().unwrap();
    assert_eq!(found.outcome, Outcome::Complete);
    assert_eq!(found.report.stations.len(), 2);
    assert!(found.report.duplicates().is_empty());

    let pulled = "[[drive]]\nname = \"akd-1\"\nevent = [{ at = \"0s\", do = \"cable=pulled\" }]";
    let mut network = open(pulled);
    network.pass(Duration::from_millis(100)).wait().unwrap();
    let found = discover(&mut network, time).wait().unwrap();
    assert!(found.report.stations.is_empty());
    assert_eq!(found.outcome.kind(), Some(ErrorKind::Unreachable));
}

#[test]
fn a_drive_with_a_fault_is_kept_from_running() {
    let mut network = open(PLANT);
    let mut drive = find(&mut network, "akd-1");
    let before = status(&mut network, &mut drive, &PlainWording).wait().unwrap();
    assert_eq!(
        (before.outcome, before.report.verdict.as_str()),
        (Outcome::Complete, "waits")
    );
    assert!(
        faults(&mut network, &mut drive, false)
            .wait()
            .unwrap()
            .advice()
            .is_empty()
    );

    network.pass(Duration::from_secs(4)).wait().unwrap();
    let held = status(&mut network, &mut drive, &PlainWording).wait().unwrap();
    assert_eq!(
        (held.outcome, held.report.verdict.as_str()),
        (Outcome::Difference, "held")
    );
    assert_eq!(held.report.faults[0].number, 439);
    let found = faults(&mut network, &mut drive, true).wait().unwrap();
    assert_eq!(found.present().next().map(|fault| fault.number), Some(439));
    let advice = found.advice();
    assert!(
        advice.actions().any(|action| *action == Action::Acknowledge),
        "{advice}"
    );
}

#[test]
fn an_info_has_identity_state_and_faults() {
    let mut network = open(PLANT);
    let mut drive = find(&mut network, "vlt-1");
    let report = info(&mut network, &mut drive).wait().unwrap();
    assert!(report.is_drive && report.identity.is_some());
    assert!(report.words.zsw1.is_some() && report.faults.is_empty());

    let mut drive = find(&mut network, "akd-1");
    network.pass(Duration::from_secs(4)).wait().unwrap();
    let report = info(&mut network, &mut drive).wait().unwrap();
    assert_eq!(report.faults.first().map(|fault| fault.number), Some(439));
}
