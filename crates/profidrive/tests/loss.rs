//! What errors say about a network that loses frames, in virtual time.

// helpers of tests fail by panicking, like the tests themselves
#![allow(clippy::unwrap_used, clippy::panic)]
#![cfg(feature = "simulate")]

use std::time::Duration;

use profidrive::client::Action;
use profidrive::report::PlainWording;
use profidrive::{Access, Opening, Outcome, Transport, Wait, doctor, scan};

const PLANT: &str = "[[drive]]\nname = \"akd-1\"\nip = \"192.168.0.11/24\"";

/// Reads a parameter until that fails, at most so often. Returns the error.
fn error_of_reads(event: &str, count: usize) -> Option<String> {
    let mut network = profidrive::open_plan(PLANT.parse().unwrap()).unwrap();
    let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
    let selection = drive.select("ramp-up").unwrap();
    for _ in 0..5 {
        network.read_one(&mut drive, &selection).wait().unwrap();
    }
    let Transport::Plant(plant) = network.transport() else {
        panic!("a plant is in memory");
    };
    let event = event.parse().unwrap();
    plant
        .with_world(|world| world.inject("akd-1", event, None))
        .unwrap();
    (0..count).find_map(|_| {
        let read = network.read_one(&mut drive, &selection).wait();
        read.err().map(|error| error.to_string())
    })
}

#[test]
fn thirty_percent_loss_is_called_loss() {
    let error = error_of_reads("loss=30%", 500).unwrap();
    assert!(error.contains("packet loss of "), "{error}");
}

#[test]
fn a_pulled_cable_is_not_called_loss() {
    let error = error_of_reads("cable=pulled", 1).unwrap();
    assert!(!error.contains("loss"), "{error}");
}

/// The first request for a parameter fails, and what is known by then is that the drive answered one of two DCP requests.
#[test]
fn loss_before_the_first_request_is_called_loss() {
    let mut network = profidrive::open_plan(PLANT.parse().unwrap()).unwrap();
    let Transport::Plant(plant) = network.transport().clone() else {
        panic!("a plant is in memory");
    };
    let pulled = |lasts| {
        let event = "cable=pulled".parse().unwrap();
        plant
            .with_world(|world| world.inject("akd-1", event, lasts))
            .unwrap();
    };
    pulled(Some(Duration::from_millis(100)));
    let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
    pulled(None);
    let selection = drive.select("ramp-up").unwrap();
    let error = network.read_one(&mut drive, &selection).wait().unwrap_err();
    let text = error.to_string();
    assert!(
        text.ends_with(": packet loss (1 of the 2 requests before it were answered)"),
        "{text}"
    );
    let advice = error.advice().unwrap();
    assert!(
        advice.actions().any(|action| *action == Action::Doctor),
        "{advice}"
    );
}

/// Each station that answers discovery is read whole, or it is said what is missing of it.
#[test]
fn a_scan_says_what_was_not_answered() {
    let mut missing = 0;
    for seed in 0..20 {
        let plant = format!("seed = {seed}\n{PLANT}");
        let mut network = profidrive::open_plan(plant.parse().unwrap()).unwrap();
        let Transport::Plant(plant) = network.transport().clone() else {
            panic!("a plant is in memory");
        };
        let event = "loss=40%".parse().unwrap();
        plant
            .with_world(|world| world.inject("akd-1", event, None))
            .unwrap();
        let time = Duration::from_secs(1);
        let found = scan::survey(&mut network, time, &mut |_, _| {}).wait().unwrap();
        for one in &found.report.stations {
            let state = one.info.as_ref().and_then(|info| info.words.zsw1.as_ref());
            let identity = one.info.as_ref().and_then(|info| info.identity.as_ref());
            let whole = state.is_some() && identity.is_some();
            assert!(whole || one.unread.is_some(), "seed {seed}: {one:?}");
            missing += usize::from(one.info.is_some() && !whole);
        }
    }
    assert!(missing > 0, "no scan was in part");
}

/// A station whose answers to the first search are lost is found by the requests that follow.
#[test]
fn the_doctor_counts_a_station_that_the_search_has_lost() {
    for seed in 0..20 {
        let plant = format!(
            "seed = {seed}\n{PLANT}\n[[drive]]\nname = \"akd-2\"\nip = \"192.168.0.12/24\"\nevent = [{{ at = \"0s\", do = \"loss=40%\" }}]"
        );
        let opening = Opening::new(Access::Identity).in_plant(plant.parse().unwrap());
        let found = doctor::examine(&opening, None, &PlainWording, &mut |_| {})
            .wait()
            .unwrap();
        assert_eq!(found.outcome, Outcome::Unfit, "seed {seed}");
        let answers = |name| {
            let link = found.report.links.iter().find(|link| link.drive == name);
            link.map(|link| (link.answers, link.requests))
        };
        assert_eq!(answers("akd-1"), Some((40, 40)), "seed {seed}");
        let lossy = answers("akd-2");
        assert!(
            lossy.is_some_and(|(count, _)| count < 36),
            "seed {seed}: {lossy:?}"
        );
    }
}
