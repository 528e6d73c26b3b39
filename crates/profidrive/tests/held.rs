//! An axis that its caller holds.
#![cfg(feature = "simulate")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "it is a test")]

use std::time::Duration;

use client::axis::{Jog as Setpoint, Move as Order};
use client::{Drive, Error, ErrorKind, Rule, StopWay};
use profidrive::motion::{self, Control, HeldAxis, Hold, MotionError, Observer};
use profidrive::{Caller, Network, StopRequests, Transport, Wait, open_plan, parameters};
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

#[test]
fn an_axis_that_cannot_be_enabled_names_the_fault_by_number_and_text() {
    let plant = format!("{PLANT}event = [{{ at = \"0s\", do = \"sto=on\" }}]");
    let mut network = open_plan(plant.parse().unwrap()).unwrap();
    let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
    let mut axis = motion::hold(&mut network, &mut drive, &Hold::for_speed(), &Observer::default())
        .wait()
        .unwrap();
    let error = axis.enable().wait().unwrap_err();
    assert_eq!(
        error
            .faults()
            .iter()
            .map(|fault| fault.number)
            .collect::<Vec<_>>(),
        [602]
    );
    assert!(error.to_string().contains("; F602 Safe torque off"), "{error}");
    assert!(error.advice().is_some());
    axis.release().wait().unwrap();
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
fn a_move_that_is_halted_on_its_way_has_not_arrived() {
    let (mut network, mut drive) = plant();
    let mut axis = held(&mut network, &mut drive, &for_position());
    home(&mut axis);
    axis.start(&Order::to(Position::Turns(20.0), 60.0))
        .wait()
        .unwrap();
    network.pass(1000 * MS).wait().unwrap();
    axis.beat_handle().end();
    let error = axis.arrive(10_000 * MS).wait().unwrap_err();
    assert!(
        matches!(
            error,
            Error::MoveEnded {
                target: Some(20.0),
                position: Some(_),
                ..
            }
        ),
        "{error}"
    );
    assert_eq!(error.kind(), ErrorKind::NotReached);
    axis.release().wait().unwrap();
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

#[test]
fn a_whole_motion_enables_the_axis_and_leaves_it_holding() {
    let (mut network, mut drive) = plant();
    let observer = Observer::default();
    let hold = Hold::for_present_mode(&mut network, &mut drive).wait().unwrap();
    assert_eq!(hold.purpose, Hold::for_speed().purpose, "as it is delivered");
    let mut axis = motion::hold(&mut network, &mut drive, &hold, &observer)
        .wait()
        .unwrap();
    assert!(!truth(&network).1, "nothing is enabled yet");
    let turned = axis.turn(600.0, Some(500 * MS)).wait().unwrap();
    assert!(turned.result.reached && turned.result.time_at_speed.is_some_and(|time| time >= 0.5));
    assert_eq!(turned.rest, client::Rest::Stands);
    let (speed, enabled) = truth(&network);
    assert!(speed.abs() < 1.0 && enabled, "halted: {speed} rpm");
    let turned = axis.turn(-600.0, None).wait().unwrap();
    assert_eq!(turned.rest, client::Rest::Runs);
    assert!(truth(&network).0 < -580.0, "it goes on");
    // of this motion, not of the one before
    assert!(turned.result.highest_speed.is_some_and(|speed| speed.value < 0.0));
    assert!(axis.turn(4000.0, None).wait().is_err());
    assert!(truth(&network).0 < -580.0, "a refused motion changes nothing");
    axis.release().wait().unwrap();
    let (speed, enabled) = truth(&network);
    assert!(speed.abs() < 1.0 && !enabled);

    let mut axis = motion::hold(&mut network, &mut drive, &for_position(), &observer)
        .wait()
        .unwrap();
    let order = Order::to(Position::Turns(2.0), 600.0);
    let error = axis.travel(&order, None).wait().unwrap_err();
    assert_eq!(error.rule(), Some(Rule::Move), "not homed: {error}");
    assert!(!truth(&network).1);
    let homed = axis.find_home(10_000 * MS).wait().unwrap();
    assert_eq!(homed.result.homed, Some(true));
    let moved = axis.travel(&order, None).wait().unwrap();
    let position = moved.result.position.unwrap().value;
    assert!(moved.result.reached && (position - 2.0).abs() < 0.01);
    let jogged = axis.jog_for(Some(-60.0), 1000 * MS).wait().unwrap();
    assert!(jogged.result.distance.unwrap().value < -0.8);
    assert_eq!(jogged.rest, client::Rest::Stands);
    axis.set_out(&Order::by(Position::Turns(5.0), 60.0))
        .wait()
        .unwrap();
    axis.pass(500 * MS).wait().unwrap();
    assert!(truth(&network).0 > 50.0, "under way");
    axis.bring_to_rest(true).wait().unwrap();
    assert!(!truth(&network).1);
    axis.find_home(10_000 * MS).wait().unwrap();
    axis.release().wait().unwrap();
}

#[test]
fn an_axis_without_calls_is_stopped_and_the_next_call_says_why() {
    let (mut network, mut drive) = plant();
    let wanted = Hold {
        lease: 1000 * MS,
        ..Hold::for_speed()
    };
    let hold = async |network: &mut Network, drive: &mut Drive| {
        let mut axis = motion::hold(network, drive, &wanted, &Observer::default())
            .await
            .unwrap();
        axis.turn(100.0, None).await.unwrap();
        network.pass(3000 * MS).await.unwrap();
        axis
    };
    let mut axis = hold(&mut network, &mut drive).wait();
    assert!(!truth(&network).1);
    let error = axis.turn(100.0, None).wait().unwrap_err();
    assert_eq!(
        (error.kind(), error.rule()),
        (ErrorKind::Safety, Some(Rule::Lease)),
        "{error}"
    );
    assert!(!truth(&network).1, "it is not started again");
    axis.turn(100.0, None).wait().unwrap();
    axis.keep_alive().wait().unwrap();
    axis.release().wait().unwrap();
    // where there is no other call the release says it
    let error = hold(&mut network, &mut drive)
        .wait()
        .release()
        .wait()
        .unwrap_err();
    assert_eq!(error.rule(), Some(Rule::Lease), "{error}");
    let mut axis = hold(&mut network, &mut drive).wait();
    let error = axis.keep_alive().wait().unwrap_err();
    assert_eq!(error.rule(), Some(Rule::Lease), "{error}");
}

#[test]
fn a_stop_from_elsewhere_ends_a_motion_and_is_no_error_of_the_release() {
    for quick in [false, true] {
        let (mut network, mut drive) = plant();
        write(&mut network, &mut drive, "DRV.DEC=100rpm/s");
        let mut axis = held(&mut network, &mut drive, &Hold::for_speed());
        axis.turn(300.0, None).wait().unwrap();
        let handle = axis.stop_handle();
        if quick {
            handle.quick_stop();
        } else {
            handle.stop();
        }
        network.pass(500 * MS).wait().unwrap();
        assert_eq!(truth(&network).0 < 1.0, quick, "{} rpm", truth(&network).0);
        let error = axis.turn(300.0, None).wait().unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Interrupted, "{error}");
        axis.release().wait().unwrap();
        assert!(!truth(&network).1);
    }
}

#[test]
fn requests_to_stop_end_a_motion_at_rest_and_are_forgotten_before_the_next() {
    let (mut network, mut drive) = plant();
    let requests = StopRequests::default();
    network.obey(&requests);
    let (asked, mut looks) = (requests.clone(), 0);
    let observer = Observer::new(move |event| {
        looks += i32::from(matches!(event, motion::Event::Sample(status) if status.view.operated));
        if looks == 40 {
            asked.request();
        }
    });
    let mut axis = motion::hold(&mut network, &mut drive, &Hold::for_speed(), &observer)
        .wait()
        .unwrap();
    let error = axis.turn(300.0, Some(60_000 * MS)).wait().unwrap_err();
    assert!(matches!(error, MotionError::Stopped { .. }), "{error}");
    assert!(error.report().unwrap().result.reached, "{error:?}");
    assert!(!truth(&network).1);
    requests.clear();
    axis.turn(300.0, Some(100 * MS)).wait().unwrap();
    axis.release().wait().unwrap();
}

#[test]
fn a_lost_connection_says_what_the_drive_does() {
    let (mut network, mut drive) = plant();
    let mut axis = held(&mut network, &mut drive, &Hold::for_speed());
    axis.turn(300.0, None).wait().unwrap();
    let cable = |network: &Network, cable: &str| {
        let Transport::Plant(plant) = network.transport() else {
            panic!("it is a plant");
        };
        let action = format!("cable={cable}").parse().unwrap();
        plant
            .with_world(|world| world.inject("akd-1", action, None))
            .unwrap();
    };
    cable(&network, "pulled");
    // its checks read parameters before anything else
    let error = axis.turn(200.0, None).wait().unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Lost, "{error}");
    let reaction = error.client().and_then(Error::loss_reaction).unwrap();
    assert!(reaction.action.stops(), "{reaction}");
    let again = axis.turn(200.0, None).wait().unwrap_err();
    assert_eq!(again.kind(), ErrorKind::Lost, "{again}");
    assert_eq!(axis.release().wait().unwrap_err().kind(), ErrorKind::Lost);
    cable(&network, "plugged");
    network.pass(1000 * MS).wait().unwrap();
    motion::acknowledge(
        &mut network,
        &mut drive,
        &Control::default(),
        &Observer::default(),
    )
    .wait()
    .unwrap();
    let mut axis = held(&mut network, &mut drive, &Hold::for_speed());
    axis.turn(200.0, Some(100 * MS)).wait().unwrap();
    axis.release().wait().unwrap();
}

/// Of its own axis this program is the controller, which no parameter has to stop beside.
#[test]
fn a_drive_under_control_of_this_program_is_stopped_by_its_control_word() {
    let (mut network, mut drive) = plant();
    let mut axis = held(&mut network, &mut drive, &Hold::for_speed());
    axis.turn(300.0, None).wait().unwrap();
    let stopped = motion::stop(&mut network, &mut drive, StopWay::Stop, 5000 * MS)
        .wait()
        .unwrap();
    assert_eq!(stopped.check().map_err(|error| error.to_string()), Ok(()));
    assert_eq!(stopped.sent, Some("OFF1 (control word)"));
    let (speed, enabled) = truth(&network);
    assert!(speed.abs() < 1.0 && !enabled);
    assert_eq!(
        axis.keep_alive().wait().unwrap_err().kind(),
        ErrorKind::Interrupted
    );
    axis.release().wait().unwrap();
}

#[test]
fn a_drive_that_runs_on_alone_is_not_taken_without_consent() {
    let plant =
        "[[drive]]\nname = \"vlt-1\"\nmodel = \"vlt\"\nip = \"10.0.0.1/24\"\nparameters = { \"8-04\" = 0 }";
    let mut network = open_plan(plant.parse().unwrap()).unwrap();
    let mut drive = network.find(&"vlt-1".parse().unwrap()).wait().unwrap();
    let observer = Observer::default();
    let hold = Hold::for_present_mode(&mut network, &mut drive).wait().unwrap();
    let error = motion::hold(&mut network, &mut drive, &hold, &observer)
        .wait()
        .unwrap_err();
    assert_eq!(error.rule(), Some(Rule::ControllerLoss), "{error}");
}

/// Where the shaft really is, in turns.
fn place(network: &Caller) -> f64 {
    let Transport::Plant(plant) = network.transport() else {
        panic!("it is a plant");
    };
    plant.with_world(|world| world.shaft(0).unwrap().position)
}

#[test]
fn an_axis_stays_within_its_travel_in_both_modes() {
    for (wanted, is_position) in [(Hold::for_speed(), false), (for_position(), true)] {
        let (mut network, mut drive) = plant();
        let wanted = Hold {
            travel: Some(2.0),
            ..wanted
        };
        let mut axis = held(&mut network, &mut drive, &wanted);
        let origin = place(&network);
        if is_position {
            // the position that is set anew is no way
            home(&mut axis);
        }
        let start = |axis: &mut HeldAxis, speed: f64| match is_position {
            true => axis.jog_at(speed).wait(),
            false => axis.run(speed).wait(),
        };
        start(&mut axis, 300.0).unwrap();
        axis.pass(3000 * MS).wait().unwrap();
        let way = place(&network) - origin;
        assert!((1.5..=2.0).contains(&way), "{way}");
        assert!(axis.status().unwrap().view.travel_ended);
        assert!(truth(&network).1, "it stays enabled");
        // not on, and back
        let refused = start(&mut axis, 300.0).unwrap_err();
        assert!(matches!(refused, MotionError::BeyondTravel { .. }), "{refused}");
        assert_eq!(
            (refused.kind(), refused.rule()),
            (ErrorKind::Safety, Some(Rule::Move))
        );
        start(&mut axis, -300.0).unwrap();
        axis.pass(3000 * MS).wait().unwrap();
        let way = place(&network) - origin;
        assert!((-2.0..=-1.5).contains(&way), "{way}");
        if is_position {
            let far = Order {
                relative: true,
                ..Order::to(Position::Turns(4.5), 60.0)
            };
            let refused = axis.travel(&far, None).wait().unwrap_err();
            assert!(matches!(refused, MotionError::BeyondTravel { .. }), "{refused}");
            let near = Order {
                relative: true,
                ..Order::to(Position::Turns(1.0), 60.0)
            };
            axis.travel(&near, None).wait().unwrap();
        }
        axis.release().wait().unwrap();
    }
}

#[test]
fn an_axis_that_coasts_is_held_until_it_rests() {
    let (mut network, mut drive) = plant();
    let mut axis = held(&mut network, &mut drive, &Hold::for_speed());
    axis.run(600.0).wait().unwrap();
    axis.pass(2000 * MS).wait().unwrap();
    axis.stop_handle().coast();
    network.pass(100 * MS).wait().unwrap();
    let (speed, enabled) = truth(&network);
    assert!(!enabled && speed.abs() > 1.0, "it coasts at {speed} rpm");
    let _ = axis.release().wait();
    assert!(truth(&network).0.abs() < 1.0, "given back at rest");
}

#[test]
fn a_plant_is_started_again_under_its_network() {
    let (mut network, mut drive) = plant();
    write(&mut network, &mut drive, "DRV.ACC=5000");
    network.pass(2000 * MS).wait().unwrap();
    let before = network.now();
    let Transport::Plant(joined) = network.transport().clone() else {
        panic!("it is a plant");
    };
    joined.restart(&PLANT.parse().unwrap(), &mut network).unwrap();
    assert_eq!(joined.with_world(|world| world.now()), profidrive::Instant::ZERO);
    // a drive as delivered, and the time of the network goes on
    let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
    let read = ["DRV.ACC".parse().unwrap()];
    // the connection for parameters went with the drive before, and this one is not bothered with it
    let values = parameters::read(&mut network, &mut drive, &read).wait().unwrap();
    let report = values.report(&drive, &profidrive::report::PlainWording);
    assert_eq!(report.parameters[0].text.as_deref(), Some("3000"));
    assert!(network.now() > before);
    // an axis is taken and moved as before
    let mut axis = held(&mut network, &mut drive, &Hold::for_speed());
    axis.run(60.0).wait().unwrap();
    axis.pass(1000 * MS).wait().unwrap();
    assert!((truth(&network).0 - 60.0).abs() < 1.0);
    axis.release().wait().unwrap();
    let elsewhere = "[[drive]]\nname = \"akd-1\"\nip = \"172.16.0.1/24\"";
    let refused = joined
        .restart(&elsewhere.parse().unwrap(), &mut network)
        .unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::Usage);
}

/// What turns at a speed that only the drive has is within the limit of the caller as well.
#[test]
fn speeds_that_are_stored_in_the_drive_are_within_the_limit_of_the_caller() {
    let (mut network, mut drive) = plant();
    let wanted = Hold {
        limit: 10.0,
        ..for_position()
    };
    let mut axis = held(&mut network, &mut drive, &wanted);
    // where it stands: nothing turns
    home(&mut axis);
    let task = axis.start_task(1).wait().unwrap_err();
    assert!(
        matches!(task, MotionError::StoredSpeed { speed: None, .. }),
        "{task}"
    );
    axis.release().wait().unwrap();
    write(&mut network, &mut drive, "HOME.MODE=4");
    write(&mut network, &mut drive, "HOME.V=600rpm");
    let mut axis = held(&mut network, &mut drive, &wanted);
    let fast = axis.home(10_000 * MS).wait().unwrap_err();
    assert!(
        matches!(fast, MotionError::StoredSpeed { speed: Some(_), .. }),
        "{fast}"
    );
    assert_eq!(
        (fast.kind(), fast.rule()),
        (ErrorKind::Safety, Some(Rule::SpeedLimit))
    );
    assert!(fast.to_string().contains("600 rpm") && fast.to_string().contains("10 rpm"));
    assert!(truth(&network).0.abs() < 0.1);
}

#[test]
fn homing_that_the_end_of_the_travel_halts_is_not_done() {
    let (mut network, mut drive) = plant();
    write(&mut network, &mut drive, "HOME.MODE=4");
    write(&mut network, &mut drive, "HOME.V=60rpm");
    let wanted = Hold {
        travel: Some(1.0),
        ..for_position()
    };
    let mut axis = held(&mut network, &mut drive, &wanted);
    let ended = axis.home(10_000 * MS).wait().unwrap_err();
    assert!(
        matches!(
            ended,
            MotionError::Client(Error::HomingEnded { by_travel: true, .. })
        ),
        "{ended}"
    );
    assert!(truth(&network).1, "it stays enabled");
}
