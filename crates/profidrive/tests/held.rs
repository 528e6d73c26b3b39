//! An axis that its caller holds.
#![cfg(feature = "simulate")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "it is a test")]

use std::time::Duration;

use client::axis::{Jog as Setpoint, Move as Order};
use client::{Drive, Error, ErrorKind};
use profidrive::motion::{self, Control, HeldAxis, Hold, MotionError, Observer};
use profidrive::{Caller, Network, Transport, Wait, open_plan, parameters};
use profile::notation::Position;

const MS: Duration = Duration::from_millis(1);

const PLANT: &str = r#"
    [[drive]]
    name = "akd-1"
    ip = "10.0.0.1/24"
"#;

fn plant() -> (Network, Drive) {
    let mut network = open_plan(PLANT.parse().unwrap()).unwrap();
    let drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
    (network, drive)
}

fn held(network: &mut Network, drive: &mut Drive, wanted: &Hold) -> HeldAxis {
    let observer = Observer::default();
    let mut axis = motion::hold(network, drive, wanted, &observer).wait().unwrap();
    axis.enable().wait().unwrap();
    axis
}

fn for_position() -> Hold {
    Hold {
        control: Control {
            set_mode: true,
            ..Control::default()
        },
        ..Hold::for_position()
    }
}

fn write(network: &mut Network, drive: &mut Drive, text: &str) {
    let assignments = [text.parse().unwrap()];
    let wanted = parameters::Write::default();
    let written = parameters::write(network, drive, &assignments, wanted)
        .wait()
        .unwrap();
    assert!(written.problems("akd-1").is_empty());
}

/// Speed of the motor, and whether the power stage is on.
fn truth(network: &Caller) -> (f64, bool) {
    let Transport::Plant(plant) = network.transport() else {
        panic!("it is a plant");
    };
    plant.with_world(|world| {
        let drive = world.drive(0).unwrap().drive();
        (drive.axis().speed(), drive.is_enabled())
    })
}

fn home(axis: &mut HeldAxis) {
    axis.home(10_000 * MS).wait().unwrap();
}

#[test]
fn a_motion_lasts_as_long_as_its_beats() {
    let (mut network, mut drive) = plant();
    let mut axis = held(&mut network, &mut drive, &for_position());
    home(&mut axis);
    axis.beat(Some(200 * MS));
    axis.jog_at(60.0).wait().unwrap();
    for _ in 0..20 {
        axis.beat(Some(200 * MS));
        network.pass(50 * MS).wait().unwrap();
    }
    let (speed, enabled) = truth(&network);
    assert!((speed - 60.0).abs() < 1.0 && enabled, "{speed} rpm");
    // the page is gone: the jog is halted after 200 ms, and operation ends with the lease
    network.pass(400 * MS).wait().unwrap();
    let (speed, enabled) = truth(&network);
    assert!(speed.abs() < 0.1 && enabled, "{speed} rpm");
    network.pass(5_000 * MS).wait().unwrap();
    assert!(!truth(&network).1);
    let error = axis.jog_at(60.0).wait().unwrap_err();
    assert!(
        matches!(error, MotionError::Client(Error::NotEnabled { .. })),
        "{error}"
    );
}

/// A goal that was sent before the last beat ran out must not move the axis.
#[test]
fn from_the_first_beat_on_a_motion_needs_one() {
    let (mut network, mut drive) = plant();
    let mut axis = held(&mut network, &mut drive, &Hold::for_speed());
    axis.beat(Some(20 * MS));
    network.pass(100 * MS).wait().unwrap();
    let _ = axis.run(60.0).wait();
    network.pass(500 * MS).wait().unwrap();
    assert!(truth(&network).0.abs() < 0.1);
    axis.beat(None);
    axis.run(60.0).wait().unwrap();
    axis.pass(500 * MS).wait().unwrap();
    assert!((truth(&network).0 - 60.0).abs() < 1.0);
}

#[test]
fn every_limit_of_a_single_motion_holds_for_each_call() {
    let (mut network, mut drive) = plant();
    write(&mut network, &mut drive, "VL.LIMITP=500rpm");
    write(&mut network, &mut drive, "1004=400rpm");
    let wanted = Hold {
        limit: 300.0,
        ..Hold::for_speed()
    };
    let mut axis = held(&mut network, &mut drive, &wanted);
    axis.run(100.0).wait().unwrap();
    axis.pass(1_000 * MS).wait().unwrap();
    // of the caller
    let error = axis.run(301.0).wait().unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Safety, "{error}");
    // the jog speed that the drive has
    let error = axis.jog(Setpoint::One).wait().unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Safety, "{error}");
    let (speed, enabled) = truth(&network);
    assert!(
        (speed - 100.0).abs() < 1.0 && enabled,
        "it keeps its speed: {speed} rpm"
    );
    axis.release().wait().unwrap();
    // of the drive
    let mut axis = held(&mut network, &mut drive, &Hold::for_speed());
    let error = axis.run(501.0).wait().unwrap_err();
    assert!(matches!(error, MotionError::AboveLimit { .. }), "{error}");
    axis.run(499.0).wait().unwrap();
    axis.halt().wait().unwrap();
    let (speed, enabled) = truth(&network);
    assert!(speed.abs() < 1.0 && enabled, "{speed} rpm");
}

#[test]
fn moves_follow_each_other_and_a_refused_one_changes_nothing() {
    let (mut network, mut drive) = plant();
    let mut axis = held(&mut network, &mut drive, &for_position());
    home(&mut axis);
    for target in [2.0, -1.0] {
        let order = Order::to(Position::Turns(target), 600.0);
        let plan = axis.start(&order).wait().unwrap();
        assert!(plan.objections.is_empty());
        let status = axis.arrive(10_000 * MS).wait().unwrap();
        assert!((status.position.unwrap() - target).abs() < 0.01, "{status:?}");
    }
    let error = axis
        .start(&Order::to(Position::Turns(5.0), 4000.0))
        .wait()
        .unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Safety, "{error}");
    assert!(axis.start_task(0xFFFF).wait().is_err());
    let report = axis.release().wait().unwrap();
    assert!(report.released);
}

#[test]
fn dropping_it_or_a_panic_of_its_thread_stops_it_and_puts_the_mode_back() {
    for panics in [false, true] {
        let (mut network, mut drive) = plant();
        let mut axis = held(&mut network, &mut drive, &for_position());
        home(&mut axis);
        axis.jog_at(60.0).wait().unwrap();
        axis.pass(500 * MS).wait().unwrap();
        assert!(truth(&network).0 > 59.0);
        let owner = std::thread::spawn(move || {
            let _axis = axis;
            assert!(!panics, "the caller fails");
        });
        assert_eq!(owner.join().is_err(), panics);
        network.settled().wait().unwrap();
        let (speed, enabled) = truth(&network);
        assert!(speed.abs() < 0.1 && !enabled, "{speed} rpm");
        let mode = drive.select("930").unwrap();
        let mode = network.read_one(&mut drive, &mode).wait().unwrap();
        assert_eq!(mode.number(), Some(1.0), "velocity mode again");
    }
}
