//! Positioning: the client against the virtual drive in position mode, in virtual time, and every way out of a motion.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;
use testbench::shared::Shared;

use network::host::{Host, StationId};
use network::segment::SegmentMedium;
use profidrive_client::axis::{Goal, Jog, Move, Objection, Purpose, Trouble};
use profidrive_client::change::Step;
use profidrive_client::status::{Cause, diagnose};
use profidrive_client::{Action, AxisSettings, Drive, Enabled, Error, MoveEnd, Wait, World, WriteMode};
use profile::notation::Position;
use profile::state::Mode;
use profile::value::Assignment;
use proptest::prelude::*;
use testbench::{Bench, bench, drive_at, drive_mut, find, is_at_rest};
use virtual_drive::drive::{Drive as VirtualDrive, Injection};
use virtual_drive::station::Station;

const LONG: Option<Duration> = Some(Duration::from_secs(60));

fn write(session: &mut Bench, drive: &mut Drive, assignments: &[&str]) {
    for text in assignments {
        let assignment: Assignment = text.parse().expect("an assignment");
        let outcomes = session
            .write(drive, &[assignment], WriteMode::Write)
            .wait()
            .expect("reached");
        outcomes.accepted().expect(text);
    }
}

/// A drive in position mode that has not been homed.
fn positioning() -> (Bench, StationId, Drive) {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    session
        .set_operating_mode(&mut drive, Mode::Position)
        .wait()
        .expect("position mode");
    (session, ids[0], drive)
}

/// The same, homed where it stands.
fn homed() -> (Bench, StationId, Drive) {
    let (mut session, id, mut drive) = positioning();
    write(&mut session, &mut drive, &["HOME.MODE=0", "HOME.P=0"]);
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::for_purpose(Purpose::Home))
        .wait()
        .expect("connected");
    axis.enable()
        .wait()
        .expect("enabled")
        .home(LONG)
        .wait()
        .expect("homed");
    axis.release().wait().expect("released");
    assert!(is_at_rest(&session, id));
    (session, id, drive)
}

/// Turns of the motor.
/// Increments of the virtual axis in one turn.
const TURN: f64 = 4_294_967_296.0;

/// Inspects the drive while another client has the session.
fn beside<T>(world: &World<SegmentMedium>, id: StationId, look: impl FnOnce(&mut VirtualDrive) -> T) -> T {
    let mut medium = world.wire();
    let host = medium.segment_mut().station_mut::<Host<Station>>(id);
    look(host.expect("the drive").endpoint_mut().drive_mut())
}

fn turns(session: &Bench, id: StationId) -> f64 {
    drive_at(session, id).drive().axis().position() as f64 / TURN
}

fn near(found: f64, wanted: f64) -> bool {
    (found - wanted).abs() < 0.02
}

fn to(target: f64) -> Move {
    Move::to(Position::Turns(target), 300.0).with_ramps(Some(3052.0), Some(3052.0))
}

/// Runs `work` with an enabled axis, then releases it; the axis must be at rest then, and without a fault.
fn with_axis<T>(
    (session, id, drive): &mut (Bench, StationId, Drive),
    purpose: Purpose,
    work: impl FnOnce(&mut Enabled<'_>) -> T,
) -> T {
    let result = {
        let mut axis = session
            .take_axis(drive, AxisSettings::for_purpose(purpose))
            .wait()
            .expect("connected");
        let mut enabled = axis.enable().wait().expect("enabled");
        work(&mut enabled)
    };
    session.settle();
    assert!(is_at_rest(session, *id));
    result
}

#[test]
fn homed_then_to_a_position_and_back_by_a_distance() {
    let mut bench = homed();
    let zero = turns(&bench.0, bench.1);
    with_axis(&mut bench, Purpose::Move, |axis| {
        assert_eq!(axis.telegram(), 9);
        axis.move_to(&to(10.0)).wait().expect("moved");
        let status = axis.status().expect("a status");
        assert!(status.position.is_some_and(|at| near(at, 10.0)), "{status:?}");
    });
    assert!(near(turns(&bench.0, bench.1), zero + 10.0));
    with_axis(&mut bench, Purpose::Move, |axis| {
        let back = Move::by(Position::Counts(-655_360.0), 600.0).with_ramps(Some(7630.0), Some(7630.0));
        axis.move_to(&back).wait().expect("moved");
    });
    assert!(near(turns(&bench.0, bench.1), zero));
}

#[test]
fn a_modulo_axis_is_planned_inside_its_range_whichever_end_comes_first() {
    for ends in [
        ["PL.MODP1=0", "PL.MODP2=196608"],
        ["PL.MODP1=196608", "PL.MODP2=0"],
    ] {
        let mut bench = homed();
        write(&mut bench.0, &mut bench.2, &ends);
        write(&mut bench.0, &mut bench.2, &["PL.MODPEN=1"]);
        let (session, _, drive) = &mut bench;
        let out_of_range = session.plan_move(drive, &to(4.0), 3000.0).wait().expect("a plan");
        let range = Objection::ModuloRange {
            target: 4.0,
            low: 0.0,
            high: 3.0,
        };
        assert_eq!(out_of_range.objections, [range]);
        with_axis(&mut bench, Purpose::Move, |axis| {
            axis.move_to(&to(2.0)).wait().expect("inside the range");
            let by = Move::by(Position::Turns(2.0), 300.0).with_ramps(Some(3052.0), Some(3052.0));
            let plan = axis.plan(&by).wait().expect("a plan");
            let end = plan.target.expect("a target");
            assert!(near(end, 1.0), "over the end: {end}");
            axis.move_to(&by).wait().expect("over the end");
            let status = axis.status().expect("a status");
            assert!(status.position.is_some_and(|at| near(at, end)), "{status:?}");
            let error = axis.move_to(&to(4.0)).wait().expect_err("outside");
            assert!(matches!(error, Error::Objections { .. }), "{error}");
        });
    }
}

#[test]
fn an_axis_that_is_not_homed_is_not_moved() {
    let (mut session, id, mut drive) = positioning();
    let before = turns(&session, id);
    let plan = session
        .plan_move(&mut drive, &to(10.0), 3000.0)
        .wait()
        .expect("a plan");
    assert_eq!(plan.objections, [Objection::NotHomed]);
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::for_purpose(Purpose::Move))
        .wait()
        .expect("connected");
    let mut enabled = axis.enable().wait().expect("enabled");
    let error = enabled.move_to(&to(10.0)).wait().expect_err("not homed");
    assert!(matches!(error, Error::Objections { .. }), "{error}");
    assert_eq!(
        enabled.status().map(|status| status.view.goal),
        Some(Goal::Enabled)
    );
    // the drive rejects a client that ignores its limits
    let mut deaf = plan.clone();
    deaf.objections.clear();
    let error = enabled.start(&deaf).wait().expect_err("not accepted");
    let trouble = Trouble::NotAccepted { homed: false };
    assert!(
        matches!(&error, Error::Axis { trouble: found, .. } if *found == trouble),
        "{error}"
    );
    let (inner, drive) = enabled.session();
    let status = inner.status(drive).wait().expect("a status");
    assert!(status.faults.is_empty());
    drop(enabled);
    axis.release().wait().expect("released");
    assert!(is_at_rest(&session, id) && near(turns(&session, id), before));
}

#[test]
fn change_on_the_fly_pause_resume_and_halt() {
    let mut bench = homed();
    let id = bench.1;
    with_axis(&mut bench, Purpose::Move, |axis| {
        let plan = axis.plan(&to(100.0)).wait().expect("a plan");
        axis.start(&plan).wait().expect("accepted");
        axis.hold(Duration::from_secs(1)).wait().expect("goes");
        let plan = axis.plan(&to(20.0)).wait().expect("a plan");
        axis.start(&plan).wait().expect("accepted while it moves");
        axis.hold(Duration::from_millis(500)).wait().expect("goes");
        axis.pause().wait().expect("stands");
        let held = axis
            .status()
            .and_then(|status| status.position)
            .expect("a position");
        assert!(held > 1.0 && held < 19.0, "{held}");
        axis.hold(Duration::from_secs(1)).wait().expect("stays");
        let after = axis
            .status()
            .and_then(|status| status.position)
            .expect("a position");
        assert!(near(held, after));
        axis.resume().wait().expect("goes on");
        axis.reach_target(LONG).wait().expect("there");
        let at = axis
            .status()
            .and_then(|status| status.position)
            .expect("a position");
        assert!(near(at, 20.0), "{at}");
        let plan = axis.plan(&to(0.0)).wait().expect("a plan");
        axis.start(&plan).wait().expect("accepted");
        axis.hold(Duration::from_millis(500)).wait().expect("goes");
        axis.halt().wait().expect("stands");
        let held = axis
            .status()
            .and_then(|status| status.position)
            .expect("a position");
        axis.hold(Duration::from_secs(1)).wait().expect("stays");
        let after = axis
            .status()
            .and_then(|status| status.position)
            .expect("a position");
        assert!(near(held, after) && held > 1.0, "discarded: {held} {after}");
    });
    assert!(!drive_at(&bench.0, id).drive().has_fault());
}

#[test]
fn software_limits_are_reported_before_sending() {
    let mut bench = homed();
    let (session, id, drive) = &mut bench;
    write(
        session,
        drive,
        &["SWLS.LIMIT0=-65536", "SWLS.LIMIT1=327680", "SWLS.EN=3"],
    );
    let before = turns(session, *id);
    let plan = session.plan_move(drive, &to(5.1), 3000.0).wait().expect("a plan");
    let expected = Objection::SoftwareLimit {
        target: plan.target.expect("a target"),
        limit: 5.0,
        upper: true,
    };
    assert_eq!(plan.objections, [expected]);
    let back = Move::by(Position::Turns(-1.5), 300.0);
    let plan = session.plan_move(drive, &back, 3000.0).wait().expect("a plan");
    assert!(matches!(
        plan.objections[..],
        [Objection::SoftwareLimit {
            limit: -1.0,
            upper: false,
            ..
        }]
    ));
    let plan = session.plan_move(drive, &to(4.9), 3000.0).wait().expect("a plan");
    assert_eq!(plan.objections, []);
    assert!(near(turns(session, *id), before));
    with_axis(&mut bench, Purpose::Move, |axis| {
        axis.move_to(&to(4.9)).wait().expect("inside")
    });
}

#[test]
fn a_command_with_an_argument_that_reads_back_something_else_is_no_difference() {
    let (mut session, _, mut drive) = homed();
    let mut outcome = |text: &str| {
        let assignment: Assignment = text.parse().expect("an assignment");
        let set = session
            .write(&mut drive, &[assignment], WriteMode::Write)
            .wait()
            .expect("reached");
        set.changes()[0].clone()
    };
    let cleared = outcome("MT.CLEAR=3");
    assert!(
        cleared.acts && cleared.step == Step::Written && cleared.is_done(),
        "{cleared:?}"
    );
    let setting = outcome("MT.NUM=3");
    assert!(!setting.acts && setting.is_done(), "{setting:?}");
}

#[test]
fn tasks_of_the_drive() {
    let mut bench = homed();
    let (session, _, drive) = &mut bench;
    write(
        session,
        drive,
        &[
            "MT.NUM=3",
            "MT.P=131072",
            "MT.V_32=300rpm",
            "MT.ACC=3000rpm/s",
            "MT.DEC=3000rpm/s",
            "MT.CNTL=0",
            "MT.SET=1",
        ],
    );
    with_axis(&mut bench, Purpose::Task, |axis| {
        // the one that homing has chosen before does as well
        assert_eq!(axis.telegram(), 9);
        axis.start_task(3).wait().expect("accepted");
        axis.reach_target(LONG).wait().expect("there");
        let error = axis.start_task(77).wait().expect_err("an empty task");
        assert!(
            matches!(
                error,
                Error::Axis {
                    trouble: Trouble::NotAccepted { homed: true },
                    ..
                }
            ),
            "{error}"
        );
    });
    let selection = bench.2.select("PL.FB").expect("known");
    let reading = bench.0.read_one(&mut bench.2, &selection).wait().expect("read");
    assert!(
        reading.number().is_some_and(|at| (at - 131_072.0).abs() < 1000.0),
        "{reading:?}"
    );
}

#[test]
fn homing_to_a_switch_and_homing_that_is_broken_off() {
    let mut bench = positioning();
    let (session, id, drive) = &mut bench;
    write(
        session,
        drive,
        &["HOME.MODE=1", "HOME.DIR=1", "HOME.V=60rpm", "HOME.P=0"],
    );
    drive_mut(session, *id).inject(Injection::Limit {
        positive: true,
        active: Some(false),
    });
    let error = with_axis(&mut bench, Purpose::Home, |axis| {
        axis.home(Some(Duration::from_secs(2)))
            .wait()
            .expect_err("no switch so far")
    });
    assert!(
        matches!(error, Error::NotInTime { what: "homing", .. }),
        "{error}"
    );
    let facts = bench.0.motion_facts(&mut bench.2).wait().expect("answered");
    assert_eq!(
        facts.homed,
        Some(false),
        "broken off: the home position stays unset"
    );
}

/// Telegram 7 has SATZANW and no position: homing works with it, and the telegram stays.
#[test]
fn homing_with_telegram_7() {
    let mut bench = positioning();
    let (session, _, drive) = &mut bench;
    write(session, drive, &["922=7"]);
    let mut axis = session
        .take_axis(drive, AxisSettings::for_purpose(Purpose::Home))
        .wait()
        .expect("connected");
    assert_eq!((axis.telegram(), axis.telegram_before()), (7, None));
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.home(Some(Duration::from_secs(5))).wait().expect("homed");
    drop(enabled);
    axis.release().wait().expect("at rest");
    assert_eq!(
        session.motion_facts(drive).wait().expect("answered").homed,
        Some(true)
    );
}

#[test]
fn jog_in_position_mode() {
    let mut bench = positioning();
    let id = bench.1;
    write(&mut bench.0, &mut bench.2, &["1004=120rpm"]);
    let before = turns(&bench.0, id);
    with_axis(&mut bench, Purpose::Jog, |axis| {
        axis.jog(Jog::One).wait().expect("jogs");
        axis.hold(Duration::from_secs(2)).wait().expect("keeps jogging");
        axis.halt().wait().expect("stands");
    });
    let way = turns(&bench.0, id) - before;
    assert!(way > 2.0 && way < 5.5, "{way}");
}

/// An axis at its software limit stands during the whole jog, also where the jog is slower than what counts as standstill.
#[test]
fn a_jog_that_moves_nothing_is_an_error() {
    for (speed, rpm) in [("1004=120rpm", 120.0), ("1004=4rpm", 4.0)] {
        let mut bench = homed();
        let limits = ["SWLS.LIMIT0=-65536", "SWLS.LIMIT1=65536", "SWLS.EN=3", speed];
        write(&mut bench.0, &mut bench.2, &limits);
        with_axis(&mut bench, Purpose::Jog, |axis| {
            let time = Duration::from_secs(20);
            axis.jog(Jog::One).wait().expect("jogs");
            axis.keep_jog(rpm, time).wait().expect("it moves to the limit");
            axis.halt().wait().expect("stands");
            axis.jog(Jog::One).wait().expect("jogs");
            let error = axis.keep_jog(rpm, time).wait().expect_err("it stands there");
            let text = error.to_string();
            assert!(text.contains("for 20.0 s did not move the axis"), "{text}");
        });
    }
}

#[test]
fn real_time_jogging_takes_its_speed_from_here_and_changes_on_the_fly() {
    let mut bench = positioning();
    write(&mut bench.0, &mut bench.2, &["1004=12rpm"]);
    let id = bench.1;
    let before = turns(&bench.0, id);
    let world = bench.0.world();
    with_axis(&mut bench, Purpose::RealTimeJog, |axis| {
        assert_eq!(axis.telegram(), 9);
        axis.jog_at(120.0).wait().expect("jogs");
        axis.hold(Duration::from_secs(2)).wait().expect("keeps jogging");
        let command = axis.status().expect("a status").view.command.stw1;
        assert_eq!(command.0, 0x143F);
        let forth = beside(&world, id, |drive| drive.axis().position() as f64 / TURN) - before;
        assert!(forth > 3.5 && forth < 4.5, "{forth}");
        // the other way, through standstill on the ramps
        axis.jog_at(-240.0).wait().expect("jogs back");
        assert_eq!(axis.status().expect("a status").view.command.stw1.0, 0x343F);
        axis.hold(Duration::from_secs(3)).wait().expect("keeps jogging");
        let back = beside(&world, id, |drive| drive.axis().position() as f64 / TURN) - before;
        assert!(back < -5.0, "{back}");
        let error = axis.jog_at(4000.0).wait().expect_err("above the limit");
        assert!(matches!(error, Error::SpeedLimit { .. }), "{error}");
        axis.halt().wait().expect("stands");
        axis.jog(Jog::One)
            .wait()
            .expect("the setpoint of the drive after it");
        axis.hold(Duration::from_secs(1)).wait().expect("keeps jogging");
    });
    assert!(!drive_at(&bench.0, id).drive().has_fault());
}

/// Real-time jogging knows the limits that a move knows, each in its direction.
#[test]
fn real_time_jogging_respects_the_limits_of_the_drive_and_of_its_setpoint() {
    let mut bench = positioning();
    write(
        &mut bench.0,
        &mut bench.2,
        &["VL.LIMITP=200rpm", "VL.LIMITN=-300rpm"],
    );
    let objection = |error: Error| match error {
        Error::Objections { objections, .. } => objections,
        other => panic!("{other}"),
    };
    let (session, drive) = (&mut bench.0, &mut bench.2);
    let within = session
        .check_jog(drive, -250.0, 3000.0)
        .wait()
        .expect("VL.LIMITN");
    assert!((within + 250.0).abs() < 0.001, "{within}");
    let above = |speed, limit| vec![Objection::DriveLimit { speed, limit }];
    let refused = session.check_jog(drive, 250.0, 3000.0).wait();
    assert_eq!(objection(refused.expect_err("VL.LIMITP")), above(250.0, 200.0));
    let refused = session
        .check_jog(drive, 13_000.0, 14_000.0)
        .wait()
        .expect_err("2^32");
    let [
        ..,
        Objection::DriveLimit { .. },
        Objection::SpeedRange { speed, highest },
    ] = objection(refused)[..]
    else {
        panic!("two objections");
    };
    assert_eq!([speed, highest], [13_000.0, 12_000.0]);
    let id = bench.1;
    let world = bench.0.world();
    with_axis(&mut bench, Purpose::RealTimeJog, |axis| {
        let error = axis.jog_at(-301.0).wait().expect_err("VL.LIMITN");
        assert_eq!(objection(error), above(301.0, 300.0));
        axis.hold(Duration::from_millis(500))
            .wait()
            .expect("nothing sent");
        assert!(beside(&world, id, |drive| drive.axis().is_at_rest()));
        axis.jog_at(-250.0).wait().expect("within");
        axis.halt().wait().expect("stands");
    });
}

#[test]
fn a_jog_that_ends_at_a_software_limit_names_it() {
    let mut bench = homed();
    write(
        &mut bench.0,
        &mut bench.2,
        &[
            "SWLS.LIMIT0=-65536",
            "SWLS.LIMIT1=65536",
            "SWLS.EN=3",
            "1004=120rpm",
        ],
    );
    with_axis(&mut bench, Purpose::Jog, |axis| {
        axis.jog(Jog::One).wait().expect("jogs");
        axis.hold(Duration::from_millis(200))
            .wait()
            .expect("keeps jogging");
        assert_eq!(axis.held_back().wait(), None, "it moves");
        axis.hold(Duration::from_secs(3))
            .wait()
            .expect("stays in operation");
        let evidence = axis.held_back().wait().expect("it stands");
        assert_eq!(evidence.cause(), Some("a software limit is reached"));
    });
}

/// Ways out of a motion that is under way.
#[derive(Debug, Clone, Copy)]
enum Door {
    Scope,
    Disable,
    Interrupt,
    Panic,
    Timeout,
    Fault,
    Sto,
    Link,
}

#[test]
fn every_door_ends_at_rest() {
    for door in [
        Door::Scope,
        Door::Disable,
        Door::Interrupt,
        Door::Panic,
        Door::Timeout,
        Door::Fault,
        Door::Sto,
        Door::Link,
    ] {
        let (mut session, id, mut drive) = homed();
        let flag = Shared::new(false);
        let asked = flag.clone();
        session.interrupt_with(move || asked.get());
        let result = catch_unwind(AssertUnwindSafe(|| {
            leave(&mut session, id, &mut drive, door, &flag)
        }));
        flag.set(false);
        session.medium().segment_mut().uncut(id);
        session.settle();
        session.pass(Duration::from_secs(1)).wait().expect("time passes");
        assert_eq!(result.is_err(), matches!(door, Door::Panic), "{door:?}");
        assert!(is_at_rest(&session, id), "{door:?}");
        assert!(
            drive_at(&session, id).drive().axis().speed().abs() < 0.5,
            "{door:?}"
        );
        let fault = drive_at(&session, id).drive().fault_number(0);
        match door {
            Door::Fault => assert_eq!(fault, 439),
            Door::Link => assert_eq!(fault, 702),
            Door::Sto => {}
            _ => assert_eq!(fault, 0, "{door:?}"),
        }
        if let Door::Link | Door::Fault = door {
            let status = session.status(&mut drive).wait().expect("a status");
            assert_eq!(diagnose(&status).cause, Cause::Fault);
        }
    }
}

fn leave(session: &mut Bench, id: StationId, drive: &mut Drive, door: Door, flag: &Shared<bool>) {
    let mut axis = session
        .take_axis(drive, AxisSettings::for_purpose(Purpose::Move))
        .wait()
        .expect("connected");
    let mut enabled = axis.enable().wait().expect("enabled");
    let plan = enabled.plan(&to(1000.0)).wait().expect("a plan");
    enabled.start(&plan).wait().expect("accepted");
    enabled.hold(Duration::from_secs(2)).wait().expect("goes");
    assert!(drive_at(session, id).drive().axis().speed() > 290.0);
    match door {
        Door::Scope => {}
        Door::Disable => enabled.disable().wait().expect("stopped"),
        Door::Interrupt => {
            flag.set(true);
            assert!(matches!(
                enabled.reach_target(LONG).wait(),
                Err(Error::Interrupted)
            ));
        }
        Door::Panic => {
            enabled.watch(|status| assert!(status.position.is_none(), "the terminal is gone"));
            let _ = enabled.reach_target(LONG).wait();
        }
        Door::Timeout => {
            let error = enabled
                .reach_target(Some(Duration::from_secs(1)))
                .wait()
                .expect_err("too long");
            assert!(matches!(error, Error::NotInTime { .. }), "{error}");
        }
        Door::Fault => {
            drive_mut(session, id).inject_fault(439, false);
            let error = enabled.reach_target(LONG).wait().expect_err("a fault");
            assert!(
                matches!(
                    error,
                    Error::Axis {
                        trouble: Trouble::Fault,
                        ..
                    }
                ),
                "{error}"
            );
            let error = enabled.start(&plan).wait().expect_err("this operation is over");
            assert!(
                matches!(error, Error::Axis { .. } | Error::NotEnabled { .. }),
                "{error}"
            );
        }
        Door::Sto => {
            drive_mut(session, id).inject(Injection::Sto(true));
            let error = enabled.reach_target(LONG).wait().expect_err("no torque");
            assert!(matches!(error, Error::Axis { .. }), "{error}");
        }
        Door::Link => {
            session.medium().segment_mut().cut(id);
            let error = enabled.reach_target(LONG).wait().expect_err("cut");
            assert!(matches!(error, Error::ConnectionLost { .. }), "{error}");
        }
    }
}

#[test]
fn a_move_that_something_halts_is_not_at_its_target() {
    let mut bench = homed();
    with_axis(&mut bench, Purpose::Move, |axis| {
        let start = |axis: &mut Enabled<'_>, target: f64| {
            let plan = axis.plan(&to(target)).wait().expect("a plan");
            axis.start(&plan).wait().expect("accepted");
        };
        let ended = |error: Error, wanted: MoveEnd, goal: f64| match error {
            Error::MoveEnded {
                end,
                position: Some(at),
                target: Some(target),
                ..
            } => {
                assert_eq!((end, target), (wanted, goal));
                at
            }
            other => panic!("{other}"),
        };
        // as by a page that is gone
        axis.beat(Some(Duration::from_secs(1)));
        start(axis, 50.0);
        let error = axis.reach_target(LONG).wait().expect_err("halted");
        let text = error.to_string();
        let at = ended(error, MoveEnd::Halted, 50.0);
        assert!(at > 1.0 && at < 20.0, "{text}");
        assert!(
            text.contains("halted before its target: the axis is at")
                && text.contains("the target is 50 rev"),
            "{text}"
        );
        axis.beat(None);
        // an intermediate stop keeps the move, which reaches its target afterwards
        start(axis, 10.0);
        axis.hold(Duration::from_millis(300)).wait().expect("goes");
        axis.pause().wait().expect("stands");
        let error = axis.reach_target(LONG).wait().expect_err("held");
        assert!(!near(ended(error, MoveEnd::Paused, 10.0), 10.0));
        axis.resume().wait().expect("goes on");
        let there = axis.reach_target(LONG).wait().expect("at the target");
        assert!(there.position.is_some_and(|at| near(at, 10.0)), "{there:?}");
        // what has no target reaches none
        axis.jog(Jog::One).wait().expect("jogs");
        let error = axis.reach_target(LONG).wait().expect_err("a jog");
        assert!(matches!(error, Error::Misuse(_)), "{error}");
        axis.halt().wait().expect("stands");
        assert!(axis.limit_travel(2.0));
        start(axis, 50.0);
        let error = axis
            .reach_target(LONG)
            .wait()
            .expect_err("at the end of its travel");
        let at = ended(error, MoveEnd::Travel, 50.0);
        assert!(at > 11.0 && at < 20.0, "{at}");
    });
}

#[test]
fn a_blocked_axis_is_reported() {
    let mut bench = homed();
    let id = bench.1;
    let world = bench.0.world();
    // near enough to the target that the following error raises no fault
    let error = with_axis(&mut bench, Purpose::Move, |axis| {
        let plan = axis.plan(&to(5.5)).wait().expect("a plan");
        axis.start(&plan).wait().expect("accepted");
        axis.hold(Duration::from_secs(1)).wait().expect("goes");
        beside(&world, id, |drive| drive.inject(Injection::Block(true)));
        axis.reach_target(Some(Duration::from_secs(20)))
            .wait()
            .expect_err("blocked")
    });
    let Error::Held { evidence, .. } = &error else {
        panic!("{error}")
    };
    assert!(
        evidence.following_error.is_some() && evidence.current.is_some(),
        "{error}"
    );
    assert!(error.to_string().contains("does not follow"), "{error}");
}

/// What a program may ask of an enabled axis.
#[derive(Debug, Clone, Copy)]
enum Wish {
    Start(i32),
    Pause,
    Resume,
    Halt,
    Home,
    Jog,
    Pass(u16),
}

fn wishes() -> impl Strategy<Value = Vec<Wish>> {
    let wish = prop_oneof![
        4 => (-40..40_i32).prop_map(Wish::Start),
        1 => Just(Wish::Pause),
        2 => Just(Wish::Resume),
        1 => Just(Wish::Halt),
        1 => Just(Wish::Home),
        1 => Just(Wish::Jog),
        4 => (1..1500_u16).prop_map(Wish::Pass),
    ];
    prop::collection::vec(wish, 1..12)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any requests in any order: each completes or is reported, the last target is reached where one is under way, and
    /// the end is at rest without a fault.
    #[test]
    fn any_order_of_wishes_ends_at_rest(wishes in wishes()) {
        let mut bench = homed();
        let id = bench.1;
        with_axis(&mut bench, Purpose::Move, |axis| {
            let mut under_way = None;
            for wish in &wishes {
                let result = match *wish {
                    Wish::Start(turns) => axis.plan(&to(turns.into())).wait().and_then(|plan| axis.start(&plan).wait()),
                    Wish::Pause => axis.pause().wait(),
                    Wish::Resume => axis
                        .resume()
                        .wait().and_then(|()| axis.hold(Duration::from_secs(3)).wait()),
                    Wish::Halt => axis.halt().wait(),
                    Wish::Home => axis.home(LONG).wait(),
                    Wish::Jog => axis.jog(Jog::One).wait(),
                    Wish::Pass(millis) => axis.hold(Duration::from_millis(millis.into())).wait(),
                };
                match (wish, result) {
                    // only where a task is held
                    (Wish::Resume, Err(Error::Misuse(_))) => {}
                    (_, result) => result.unwrap_or_else(|error| unreachable!("{wish:?}: {error}")),
                }
                under_way = match *wish {
                    Wish::Start(turns) => Some(turns),
                    Wish::Pass(_) | Wish::Resume => under_way,
                    Wish::Pause | Wish::Halt | Wish::Home | Wish::Jog => None,
                };
            }
            if let Some(turns) = under_way {
                axis.reach_target(LONG).wait().expect("the target");
                let at = axis.status().and_then(|status| status.position).expect("a position");
                assert!(near(at, turns.into()), "{at} instead of {turns}");
            }
        });
        prop_assert!(!drive_at(&bench.0, id).drive().has_fault());
    }
}

#[test]
fn an_axis_without_a_home_position_is_recommended_to_home_and_not_to_move() {
    let recommended = |(session, _, drive): &mut (Bench, StationId, Drive)| -> Vec<Action> {
        let found = diagnose(&session.status(drive).wait().expect("a status"));
        assert_eq!(found.cause.id(), "no-controller", "{found:?}");
        found.next.expect("advice").actions().cloned().collect()
    };
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, &["930=2"]);
    let mut fresh = (session, ids[0], drive);
    let actions = recommended(&mut fresh);
    assert!(
        actions.contains(&Action::Home) && !actions.contains(&Action::Move),
        "{actions:?}"
    );
    let actions = recommended(&mut homed());
    assert!(
        actions.contains(&Action::Move) && !actions.contains(&Action::Home),
        "{actions:?}"
    );
}

/// Signal 101 holds every task while it is 0, and no telegram of an AKD but a mapped one carries it.
#[test]
fn a_feedrate_of_0_is_named_before_a_move_and_a_task() {
    let (mut session, _, mut drive) = homed();
    write(&mut session, &mut drive, &["MT_FEEDRATE=0"]);
    let error = session
        .check_task(&mut drive, 0)
        .wait()
        .expect_err("a task that never ends");
    let order = to(3.0);
    let plan = session
        .plan_move(&mut drive, &order, 3000.0)
        .wait()
        .expect("planned");
    assert!(plan.objections.contains(&Objection::Feedrate), "{plan:?}");
    let Error::Objections { objections, .. } = &error else {
        panic!("{error}")
    };
    assert!(objections.contains(&Objection::Feedrate), "{error}");
    assert!(error.to_string().contains("(AKD: MT_FEEDRATE)"), "{error}");
    write(&mut session, &mut drive, &["MT_FEEDRATE=100"]);
    let plan = session
        .plan_move(&mut drive, &order, 3000.0)
        .wait()
        .expect("planned");
    assert!(!plan.objections.contains(&Objection::Feedrate), "{plan:?}");
}

/// `status` reads the feedrate, by which it names a task that is held.
#[test]
fn the_status_has_the_feedrate() {
    let (mut session, _, mut drive) = positioning();
    for (text, feedrate) in [(None, 100.0), (Some("MT_FEEDRATE=0"), 0.0)] {
        write(&mut session, &mut drive, text.as_slice());
        let status = session.status(&mut drive).wait().expect("a status");
        assert_eq!(status.feedrate, Some(feedrate));
    }
}
