//! Changes that a person has seen before they are written, and what takes them back.
#![cfg(feature = "simulate")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "it is a test")]

use std::time::Duration;

use client::{Drive, ErrorKind};
use profidrive::motion::{self, Hold, Observer};
use profidrive::parameters::{self, ParameterError, Write};
use profidrive::profile::value::Assignment;
use profidrive::{Explained, Network, Wait, open_plan, settings};

const MS: Duration = Duration::from_millis(1);

fn plant() -> (Network, Drive) {
    let plant = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
    let mut network = open_plan(plant.parse().unwrap()).unwrap();
    let drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
    (network, drive)
}

fn assignments(texts: &[&str]) -> Vec<Assignment> {
    texts.iter().map(|text| text.parse().unwrap()).collect()
}

fn value(network: &mut Network, drive: &mut Drive) -> f64 {
    let wanted = ["DRV.ACC".parse().unwrap()];
    let values = parameters::read(network, drive, &wanted).wait().unwrap();
    values.readings[0].as_ref().unwrap().number().unwrap()
}

#[test]
fn a_plan_is_written_once_as_it_was_seen_and_undone() {
    let (mut network, mut drive) = plant();
    let wanted = assignments(&["DRV.ACC=8000rpm/s", "DRV.DEC=3000rpm/s"]);
    let how = Write::default();
    let plan = parameters::plan(&mut network, &mut drive, &wanted, how)
        .wait()
        .unwrap();
    let seen = plan.clone();
    let written = parameters::carry_out_agreed(&mut network, &mut drive, plan)
        .wait()
        .unwrap();
    assert_eq!(
        settings::in_lines(&written.set),
        [
            "DRV.ACC (p2108): 3000 rpm/s -> 8000 rpm/s, written, read back",
            "DRV.DEC (p2115): 3000 rpm/s -> 3000 rpm/s, same value"
        ]
    );
    // what was seen is no longer so
    let error = parameters::carry_out_agreed(&mut network, &mut drive, seen)
        .wait()
        .unwrap_err();
    assert!(matches!(error, ParameterError::Outdated { .. }), "{error}");
    assert_eq!(
        (error.kind(), error.details()),
        (
            ErrorKind::Refused,
            vec!["DRV.ACC (p2108) was 3000 rpm/s, is 8000 rpm/s".to_owned()]
        )
    );
    let undone = parameters::undo(&mut network, &mut drive, &written)
        .wait()
        .unwrap();
    assert!(undone.problems("akd-1").is_empty());
    assert!((value(&mut network, &mut drive) - 3000.0).abs() < 0.1);
}

#[test]
fn each_assignment_that_is_wrong_is_named() {
    let (mut network, mut drive) = plant();
    let wanted = assignments(&["DRV.ACC=8000rpm/s", "NO.SUCH=1", "DRV.DEC=3A"]);
    let wrong = parameters::objections(&mut network, &mut drive, &wanted)
        .wait()
        .unwrap();
    let places: Vec<usize> = wrong.iter().map(|(place, _)| *place).collect();
    assert_eq!(places, [1, 2]);
}

/// Its owner waits for something else meanwhile, as the task of a server does.
#[test]
fn a_beat_of_another_thread_keeps_a_motion_and_its_lease() {
    let (mut network, mut drive) = plant();
    let hold = Hold {
        lease: 1000 * MS,
        ..Hold::for_speed()
    };
    let observer = Observer::default();
    let mut axis = motion::hold(&mut network, &mut drive, &hold, &observer)
        .wait()
        .unwrap();
    axis.enable().wait().unwrap();
    let beat = axis.beat_handle();
    beat.beat(200 * MS);
    axis.run(60.0).wait().unwrap();
    for _ in 0..60 {
        beat.beat(200 * MS);
        network.pass(50 * MS).wait().unwrap();
    }
    let speed = || axis.status().and_then(|status| status.speed_actual).unwrap();
    assert!((speed() - 60.0).abs() < 1.0, "{}", speed());
    beat.end();
    network.pass(200 * MS).wait().unwrap();
    assert!(speed().abs() < 0.5, "{}", speed());
    assert!(axis.status().unwrap().view.goal.operates(), "it stays enabled");
    // no beat renews the lease any more
    network.pass(1500 * MS).wait().unwrap();
    assert!(!axis.status().unwrap().view.goal.operates());
    // it was brought to rest by itself, which the one who gives it back is to know
    let error = axis.release().wait().unwrap_err();
    assert!(error.to_string().contains("no call was made"), "{error}");
}
