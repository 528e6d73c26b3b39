//! Moving an axis: the client against virtual drives on an in-memory segment, in virtual time.

use std::time::Duration;
use testbench::shared::Shared;

use profidrive_client::axis::{Move, Objection, Purpose, Trouble};
use profidrive_client::status::{Cause, Verdict, diagnose, switched_off_beside};
use profidrive_client::{
    Action, Axis, AxisSettings, Drive, Enabled, Error, LocalControl, Session, StopWay, VendorModule, Wait,
    WriteMode,
};
use profile::notation::Position;
use profile::parameter::{Keep, ParameterAccess};
use profile::state::{Mode, State};
use profile::value::Assignment;
use profinet::controller::{ModuleConfig, SubmoduleConfig};
use testbench::{bench, drive_at, find, is_at_rest, other_controller, with_drive};
use virtual_drive::description::TelegramModule;

fn write(session: &mut Session, drive: &mut Drive, assignments: &[&str]) {
    let assignments: Vec<Assignment> = assignments
        .iter()
        .map(|text| text.parse().expect("an assignment"))
        .collect();
    let outcomes = session
        .write(drive, &assignments, WriteMode::Write)
        .wait()
        .expect("reached");
    outcomes.accepted().expect("accepted");
}

/// Control of an axis, with the settings as delivered.
#[track_caller]
fn connected(session: &mut Session, drive: &mut Drive) -> Axis {
    session
        .take_axis(drive, AxisSettings::default())
        .wait()
        .expect("connected")
}

/// One second in operation.
#[track_caller]
fn runs_on(enabled: &mut Enabled) {
    let held = enabled.hold(Duration::from_secs(1)).wait();
    held.expect("keeps running");
}

fn cause(session: &mut Session, drive: &mut Drive) -> (Cause, Verdict) {
    let status = session.status(drive).wait().expect("a status");
    let found = diagnose(&status);
    (found.cause, found.verdict)
}

#[test]
fn a_drive_in_another_mode_is_not_changed() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    for purpose in [Purpose::Move, Purpose::Task, Purpose::Home] {
        let error = session
            .take_axis(&mut drive, AxisSettings::for_purpose(purpose))
            .wait()
            .map(|_| ())
            .expect_err("velocity mode");
        let Error::WrongMode { needed, .. } = &error else {
            panic!("{error}")
        };
        assert_eq!(*needed, Mode::Position);
        assert_eq!(
            error.to_string(),
            "akd-1 is in velocity mode (PNU 930 = 1), this needs position mode (PNU 930 = 2)"
        );
        assert!(
            error
                .advice()
                .is_some_and(|advice| advice.to_string().contains("[write 930=2]"))
        );
    }
    assert_eq!(
        session.operating_mode(&mut drive).wait().expect("answered"),
        Some(Mode::Velocity)
    );
    session
        .set_operating_mode(&mut drive, Mode::Position)
        .wait()
        .expect("changed");
    assert_eq!(
        session.operating_mode(&mut drive).wait().expect("answered"),
        Some(Mode::Position)
    );
    let error = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .map(|_| ())
        .expect_err("position mode");
    assert!(
        matches!(
            error,
            Error::WrongMode {
                needed: Mode::Velocity,
                ..
            }
        ),
        "{error}"
    );
    // PNU 930 does not matter for what only switches
    let axis = session
        .take_axis(&mut drive, AxisSettings::for_purpose(Purpose::Control))
        .wait()
        .expect("connected");
    axis.release().wait().expect("released");
    assert!(is_at_rest(&session, ids[0]));
}

#[test]
fn the_telegram_that_the_drive_reports_is_used_where_it_does() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    for (reported, chosen) in [(351, 351), (354, 354), (1, 1), (7, 1)] {
        write(&mut session, &mut drive, &[&format!("922={reported}")]);
        let mut axis = connected(&mut session, &mut drive);
        assert_eq!(axis.telegram(), chosen, "{reported}");
        let mut enabled = axis.enable().wait().expect("enabled");
        enabled.run(100.0).wait().expect("runs");
        runs_on(&mut enabled);
        let status = enabled.status().expect("a status");
        assert!(
            status
                .speed_actual
                .is_some_and(|speed| (speed - 100.0).abs() < 3.0)
        );
        assert_eq!(status.position.is_some(), chosen == 351);
        drop(enabled);
        axis.release().wait().expect("released");
        session.close().wait().expect("closed");
    }
}

#[test]
fn a_free_telegram_runs_by_its_mapping() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(
        &mut session,
        &mut drive,
        &["922=400", "915[1]=5", "916[1]=6", "916[2]=28", "916[3]=28"],
    );
    let mut axis = connected(&mut session, &mut drive);
    assert_eq!(axis.telegram(), 400);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(-60.0).wait().expect("runs");
    runs_on(&mut enabled);
    let status = enabled.status().expect("a status");
    assert!(
        status
            .speed_actual
            .is_some_and(|speed| (speed + 60.0).abs() < 3.0)
    );
    assert!(status.position.is_some_and(|turns| turns < -0.5), "{status:?}");
    drop(enabled);
    axis.release().wait().expect("released");
}

#[test]
fn uncommanded_signals_keep_the_values_of_the_drive() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(
        &mut session,
        &mut drive,
        &["922=354", "DRV.ACC=763", "DRV.DEC=7630"],
    );
    let mut axis = connected(&mut session, &mut drive);
    assert_eq!(axis.telegram(), 354);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(100.0).wait().expect("runs");
    runs_on(&mut enabled);
    drop(enabled);
    axis.release().wait().expect("released");
    for (name, value) in [("DRV.ACC", 763.0), ("DRV.DEC", 7630.0)] {
        let selection = drive.select(name).expect("known");
        let reading = session.read_one(&mut drive, &selection).wait().expect("read");
        assert_eq!(reading.number(), Some(value), "{name}");
    }
    assert!(is_at_rest(&session, ids[0]));
}

#[test]
fn why_it_does_not_run_from_first_contact_to_operation() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    assert_eq!(
        cause(&mut session, &mut drive),
        (Cause::NoController, Verdict::Waits)
    );
    session.close().wait().expect("closed");
    let mut axis = connected(&mut session, &mut drive);
    let seen = |axis: &mut Axis| {
        let (session, drive) = axis.session();
        cause(session, drive).0
    };
    assert_eq!(seen(&mut axis), Cause::NoControl);
    axis.ready().wait().expect("ready");
    assert_eq!(seen(&mut axis), Cause::Off);
    let mut enabled = axis.enable().wait().expect("enabled");
    assert_eq!(seen(&mut enabled), Cause::ZeroSetpoint);
    enabled.run(60.0).wait().expect("runs");
    runs_on(&mut enabled);
    assert_eq!(seen(&mut enabled), Cause::Moves);
    drop(enabled);
    axis.release().wait().expect("released");
    testbench::drive_mut(&session, ids[0]).inject_fault(439, false);
    let status = session.status(&mut drive).wait().expect("a status");
    let found = diagnose(&status);
    assert_eq!(found.cause, Cause::Fault);
    assert!(
        found.sentence.starts_with("fault F439 is present: "),
        "{}",
        found.sentence
    );
}

#[test]
fn stop_beside_another_controller_stops_and_names_it() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let (host, ar) = other_controller();
    let plc = (session.medium().segment_mut().attach(host), ar);
    session.pass(Duration::from_secs(3)).wait().expect("time passes");
    testbench::command(&session, plc, &[0x04, 0x7E, 0, 0]);
    session.pass(Duration::from_secs(1)).wait().expect("time passes");
    testbench::command(&session, plc, &[0x04, 0x7F, 0x01, 0x11]);
    session.pass(Duration::from_secs(2)).wait().expect("time passes");
    assert!(drive_at(&session, ids[0]).drive().axis().speed() > 90.0);
    let mut drive = find(&mut session, "akd-1").expect("there");
    assert_eq!(cause(&mut session, &mut drive), (Cause::Moves, Verdict::Runs));
    let outcome = session
        .stop_drive(&mut drive, StopWay::Stop, Duration::from_secs(5))
        .wait()
        .expect("sent");
    assert!(outcome.sent && outcome.at_rest, "{outcome:?}");
    assert_eq!(outcome.enabled, Some(true));
    assert!(outcome.speed_before.is_some_and(|speed| speed > 90.0));
    assert_eq!(
        session.owner(&drive).wait().expect("answered"),
        Some(Some("plc".into())),
        "the controller was not disturbed"
    );
    let outcome = session
        .stop_drive(&mut drive, StopWay::Disable, Duration::from_secs(5))
        .wait()
        .expect("sent");
    assert!(outcome.sent && outcome.at_rest && outcome.enabled == Some(false));
    assert_eq!(cause(&mut session, &mut drive).0, Cause::Inhibited);
    let outcome = session
        .stop_drive(&mut drive, StopWay::Stop, Duration::from_secs(5))
        .wait()
        .expect("nothing to do");
    assert!(!outcome.sent);
}

#[test]
fn a_move_is_planned_from_drive_values_without_writing() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(
        &mut session,
        &mut drive,
        &["DRV.ACC=1526", "DRV.DEC=3052", "VL.LIMITN=-500"],
    );
    let order = Move::to(Position::Turns(-10.0), 600.0);
    let plan = session
        .plan_move(&mut drive, &order, 3000.0)
        .wait()
        .expect("a plan");
    assert_eq!((plan.acceleration, plan.deceleration), (1526.0, 3052.0));
    assert_eq!(plan.traverse.target, -655_360);
    let expected = Objection::DriveLimit {
        speed: 600.0,
        limit: 500.0,
    };
    assert!(plan.objections.contains(&expected), "{:?}", plan.objections);
    assert!(plan.objections.contains(&Objection::NotHomed));
    assert!(is_at_rest(&session, ids[0]));
}

/// A module of a device description as a controller expects it.
fn vendor_module(telegram: &TelegramModule) -> VendorModule {
    let submodules = telegram.module.submodules.iter();
    let module = ModuleConfig {
        api: 0x3A00,
        slot: telegram.slot,
        ident: telegram.module.ident,
        submodules: submodules
            .map(|submodule| SubmoduleConfig {
                subslot: submodule.subslot,
                ident: submodule.ident,
                input_length: submodule.input_length,
                output_length: submodule.output_length,
            })
            .collect(),
    };
    VendorModule {
        telegram: telegram.telegram,
        place: (telegram.slot, telegram.subslot),
        modules: vec![module],
    }
}

#[test]
fn ident_numbers_of_a_vendor_file_come_from_the_drive() {
    let (mut session, ids) = testbench::bench_from("GSDML-V2.1-KOLLMORGEN-AKDLIKE-20140301.xml");
    let mut drive = find(&mut session, "akd-1").expect("there");
    let mut axis = connected(&mut session, &mut drive);
    assert_eq!(axis.telegram(), 1);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(100.0).wait().expect("runs");
    runs_on(&mut enabled);
    let speed = enabled.status().and_then(|status| status.speed_actual);
    assert!(
        speed.is_some_and(|speed| (speed - 100.0).abs() < 3.0),
        "{speed:?}"
    );
    drop(enabled);
    axis.release().wait().expect("released");
    assert!(is_at_rest(&session, ids[0]));
    // the ident number of another module stands nowhere
    session
        .set_operating_mode(&mut drive, Mode::Position)
        .wait()
        .expect("changed");
    let error = session
        .take_axis(&mut drive, AxisSettings::for_purpose(Purpose::Move))
        .wait()
        .map(|_| ())
        .expect_err("telegram 9 is not plugged");
    let expected = (Some(1), 9);
    assert!(
        matches!(error, Error::ForeignModule { plugged, wanted, .. } if (plugged, wanted) == expected),
        "{error}"
    );
    // nothing is advised that ends nowhere
    let hint = error.advice().expect("advice").to_string();
    assert!(
        hint.contains("[choose description]") && hint.contains("only telegram 1 works"),
        "{hint}"
    );
    // but in the vendor's file, independent of the present telegram in PNU 922
    write(&mut session, &mut drive, &["922=9"]);
    drive.vendor_modules = testbench::description("GSDML-V2.1-KOLLMORGEN-AKDLIKE-20140301.xml")
        .telegrams
        .iter()
        .map(vendor_module)
        .collect();
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::for_purpose(Purpose::Home))
        .wait()
        .expect("connected with the module of the file");
    assert_eq!(axis.telegram(), 9);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.home(Some(Duration::from_secs(5))).wait().expect("homed");
    drop(enabled);
    axis.release().wait().expect("released");
}

/// A load that pulls, no brake: when the power stage is off the axis turns, and no status claims that it rests.
#[test]
fn an_axis_that_turns_without_power_is_not_called_at_rest() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    for (torque, rests) in [(0.0, true), (1.0, false)] {
        let load = format!("load={torque}Nm").parse().expect("a load");
        let mut axis = connected(&mut session, &mut drive);
        let mut enabled = axis.enable().wait().expect("enabled");
        with_drive(&session, ids[0], |drive| drive.inject(load));
        enabled.run(60.0).wait().expect("runs");
        runs_on(&mut enabled);
        drop(enabled);
        let released = axis.release().wait();
        match released {
            Ok(()) => assert!(rests, "it turns"),
            Err(Error::Axis {
                trouble: Trouble::StillTurns,
                ..
            }) => assert!(!rests, "it stands"),
            Err(error) => panic!("{error}"),
        }
    }
}

/// A disable by another program's parameter write is reported as such, and not as an open input.
#[test]
fn an_axis_disabled_by_another_program_reports_the_cause() {
    for (by_parameter, torque_off) in [(true, false), (false, true)] {
        let (mut session, ids) = bench(&[("akd-1", 1)]);
        let mut drive = find(&mut session, "akd-1").expect("there");
        let mut axis = connected(&mut session, &mut drive);
        let mut enabled = axis.enable().wait().expect("enabled");
        enabled.reach_speed(60.0, None).wait().expect("runs");
        {
            let (inner, drive) = enabled.session();
            if by_parameter {
                let outcome = inner
                    .stop_drive(drive, StopWay::Disable, Duration::from_secs(2))
                    .wait();
                assert!(outcome.expect("sent").sent);
            }
            with_drive(&session, ids[0], |drive| {
                if torque_off {
                    drive.inject("sto=on".parse().expect("an injection"));
                }
            });
        }
        let error = enabled
            .hold(Duration::from_secs(2))
            .wait()
            .expect_err("it is off");
        assert!(
            matches!(
                error,
                Error::Axis {
                    trouble: Trouble::LeftOperation { .. } | Trouble::Fault,
                    ..
                }
            ),
            "{error}"
        );
        drop(enabled);
        let _ = axis.release().wait();
        let status = session.status(&mut drive).wait().expect("a status");
        let note = switched_off_beside(&status);
        assert_eq!(note.is_some(), by_parameter, "{note:?}");
        if let Some(note) = note {
            assert!(note.sentence.contains("DRV.DIS"), "{note:?}");
            assert!(
                note.next
                    .is_some_and(|next| next.actions().any(|action| *action == Action::Disable))
            );
        }
    }
}

/// A load that turns an axis whose power stage is off: no command stops it, and nothing claims that one does.
#[test]
fn an_axis_that_its_load_turns_is_not_sent_to_a_stop() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    with_drive(&session, ids[0], |drive| {
        drive.inject("load=0.3Nm".parse().expect("a load"));
    });
    session
        .pass(Duration::from_millis(100))
        .wait()
        .expect("time passes");
    assert_eq!(
        cause(&mut session, &mut drive),
        (Cause::MovedExternally, Verdict::Held)
    );
    for way in [StopWay::Stop, StopWay::Disable] {
        let outcome = session
            .stop_drive(&mut drive, way, Duration::from_millis(50))
            .wait()
            .expect("looked at");
        assert!(!outcome.sent && !outcome.at_rest, "{outcome:?}");
    }
    // too fast by now: the fault stays, and the cause is reported with it
    session.pass(Duration::from_secs(2)).wait().expect("time passes");
    let status = session.status(&mut drive).wait().expect("a status");
    let found = diagnose(&status);
    assert_eq!(found.cause, Cause::Fault);
    assert!(
        found
            .notes
            .iter()
            .any(|note| note.id == Cause::MovedExternally.id()),
        "{found:?}"
    );
}

/// A ramp longer than its setting: the quick stop that ends it is reported.
#[test]
fn a_quick_stop_instead_of_the_ramp_is_reported() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let mut axis = connected(&mut session, &mut drive);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(600.0).wait().expect("runs");
    runs_on(&mut enabled);
    let (inner, drive) = enabled.session();
    write(inner, drive, &["DRV.DEC=10rpm/s"]);
    drop(enabled);
    let error = axis.release().wait().expect_err("not as asked");
    assert!(error.to_string().contains("quick stop (OFF3)"), "{error}");
}

/// A ramp that is set to be slow gets its time.
#[test]
fn a_slow_ramp_is_waited_for() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, &["DRV.DEC=20rpm/s"]);
    let mut axis = connected(&mut session, &mut drive);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(600.0, None).wait().expect("runs");
    let begin = enabled.status().expect("a status").time;
    drop(enabled);
    axis.stopped().wait().expect("along its ramp");
    let took = axis.status().expect("a status").time - begin;
    axis.release().wait().expect("along its ramp");
    assert!(took > Duration::from_secs(25), "{took:?}");
    assert!(is_at_rest(&session, ids[0]));
}

/// An urgent caller gets a quick stop in place of a long ramp, and no error for it.
#[test]
fn a_hurry_turns_the_ramp_into_a_quick_stop() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, &["DRV.DEC=10rpm/s"]);
    let asked = Shared::new(0);
    let count = asked.clone();
    session.hurry_with(move || {
        count.set(count.get() + 1);
        count.get() > 20
    });
    let mut axis = connected(&mut session, &mut drive);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(600.0).wait().expect("runs");
    runs_on(&mut enabled);
    assert_eq!(asked.get(), 0, "only while it stops");
    let begin = enabled.status().expect("a status").time;
    drop(enabled);
    let took = axis.status().expect("a status").time - begin;
    axis.release().wait().expect("as asked");
    assert!(took < Duration::from_secs(5), "{took:?}");
    assert_eq!(asked.get(), 21, "not asked again");
    assert!(is_at_rest(&session, ids[0]));
    assert_eq!(drive_at(&session, ids[0]).drive().fault_number(0), 0);
}

#[test]
fn a_speed_counts_from_when_it_is_reached_and_is_not_claimed() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, &["DRV.ACC=100rpm/s"]);
    let mut axis = connected(&mut session, &mut drive);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(600.0, None).wait().expect("after some 6 s");
    let status = enabled.status().expect("a status");
    assert!(
        status.speed_actual.is_some_and(|speed| speed > 580.0),
        "{status:?}"
    );
    enabled.reach_speed(0.0, None).wait().expect("stands");
    let error = enabled
        .reach_speed(-600.0, Some(Duration::from_secs(2)))
        .wait()
        .expect_err("too short");
    let text = error.to_string();
    assert!(
        text.contains("-600 rpm not reached within 2.0 s, the highest speed was -1")
            || text.contains("-600 rpm not reached within 2.0 s, the highest speed was -2"),
        "{text}"
    );
    drop(enabled);
    axis.release().wait().expect("released");
}

/// Local operation: refused before anything is sent, whatever the axis is wanted for.
#[test]
fn local_operation_is_refused_before_taking_control() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, &["DRV.CMDSOURCE=0"]);
    write(&mut session, &mut drive, &["DRV.EN=1"]);
    for purpose in [
        Purpose::Speed,
        Purpose::Jog,
        Purpose::Move,
        Purpose::Home,
        Purpose::Task,
        Purpose::Control,
    ] {
        let error = session
            .take_axis(&mut drive, AxisSettings::for_purpose(purpose))
            .wait()
            .map(|_| ())
            .expect_err("local operation");
        assert!(
            matches!(
                error,
                Error::LocalOperation {
                    by: LocalControl::ServiceChannel,
                    ..
                }
            ),
            "{purpose:?}: {error}"
        );
    }
    {
        let station = drive_at(&session, ids[0]);
        assert!(station.drive().is_enabled() && !station.drive().has_fault());
    }
    // the service channel commands nothing any more: the telegram decides
    write(&mut session, &mut drive, &["DRV.DIS=1"]);
    session.pass(Duration::from_secs(1)).wait().expect("time passes");
    let axis = connected(&mut session, &mut drive);
    axis.release().wait().expect("released");
}

/// A telegram that carries ramps in coarse steps: the drive has its own again afterwards.
#[test]
fn ramps_that_a_telegram_rounds_are_put_back() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(
        &mut session,
        &mut drive,
        &["922=354", "DRV.ACC=3000", "DRV.DEC=2500"],
    );
    let mut axis = connected(&mut session, &mut drive);
    assert_eq!((axis.telegram(), axis.telegram_before()), (354, None));
    axis.enable()
        .wait()
        .expect("enabled")
        .reach_speed(100.0, None)
        .wait()
        .expect("runs");
    axis.release().wait().expect("released");
    for (name, value) in [("DRV.ACC", 3000.0), ("DRV.DEC", 2500.0)] {
        let selection = drive.select(name).expect("known");
        let reading = session.read_one(&mut drive, &selection).wait().expect("read");
        assert_eq!(reading.number(), Some(value), "{name}");
    }
    write(&mut session, &mut drive, &["922=9"]);
    let axis = connected(&mut session, &mut drive);
    assert_eq!((axis.telegram(), axis.telegram_before()), (1, Some(9)));
    axis.release().wait().expect("released");
}

/// The cable is cut: the state shown is what the drive said last, not what it was sent.
#[test]
fn a_state_is_the_state_the_drive_reported() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let shown = Shared::new(Vec::new());
    let list = shown.clone();
    let mut axis = connected(&mut session, &mut drive);
    axis.watch(move |status| list.borrow_mut().push((status.view.state(), status.lost)));
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(100.0, None).wait().expect("runs");
    session.medium().segment_mut().cut(ids[0]);
    // the stop request reaches no drive
    let error = enabled.disable().wait().expect_err("cut");
    assert!(matches!(error, Error::ConnectionLost { .. }), "{error}");
    drop(axis);
    let last = shown.borrow().last().copied();
    assert_eq!(last, Some((Some(State::S4), true)));
}

/// Another scale would turn the setpoint of a running axis into another speed.
#[test]
fn a_scale_is_not_written_while_the_power_stage_is_on() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, &["PN.VELSCALING=200"]);
    let mut axis = connected(&mut session, &mut drive);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(300.0, None).wait().expect("runs");
    let (inner, running) = enabled.session();
    for text in ["PN.VELSCALING=1638", "1009=1638", "UNIT.PROTARY=3"] {
        let assignment: Assignment = text.parse().expect("an assignment");
        let error = inner
            .write(running, std::slice::from_ref(&assignment), WriteMode::Write)
            .wait()
            .expect_err("refused");
        assert!(matches!(error, Error::NotAtRest { .. }), "{text}: {error}");
        inner
            .write(running, &[assignment], WriteMode::DryRun)
            .wait()
            .expect("only looks");
    }
    enabled
        .keep_speed(300.0, Duration::from_secs(3))
        .wait()
        .expect("nothing has changed");
    drop(enabled);
    axis.release().wait().expect("released");
    assert!(is_at_rest(&session, ids[0]));
    write(&mut session, &mut drive, &["PN.VELSCALING=1638"]);
}

/// A copy of a drive that is kept for hours must not send a setpoint that meant this speed once.
#[test]
fn a_scale_changed_by_another_client_counts_for_a_kept_drive() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, &["PN.VELSCALING=200"]);
    let mut kept = drive.clone();
    session.check_speed(&mut kept, 300.0).wait().expect("has steps");
    with_drive(&session, ids[0], |drive| {
        ParameterAccess::write(drive, 3064, 0, 1638, Keep::Volatile).expect("taken");
    });
    session.pass(Duration::from_secs(1)).wait().expect("time passes");
    let assignment: Assignment = "5=10rpm".parse().expect("an assignment");
    let plan = session
        .plan_write(&mut kept, &[assignment], false)
        .wait()
        .expect("a plan");
    assert_eq!(kept.parameters.scaling.velocity, 1638, "{plan:?}");
    let mut axis = connected(&mut session, &mut kept);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(300.0, None).wait().expect("runs");
    let mut speed = 0.0;
    with_drive(&session, ids[0], |drive| speed = drive.axis().speed());
    assert!((speed - 300.0).abs() < 15.0, "{speed} rpm");
    drop(enabled);
    axis.release().wait().expect("released");
}

/// Another client changes the scale anyway: the axis is stopped and the cause reported.
#[test]
fn a_scale_changed_under_a_running_axis_stops_it() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, &["PN.VELSCALING=200"]);
    let mut axis = connected(&mut session, &mut drive);
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(300.0, None).wait().expect("runs");
    let begin = enabled.status().expect("a status").time;
    with_drive(&session, ids[0], |drive| {
        ParameterAccess::write(drive, 3064, 0, 1638, Keep::Volatile).expect("taken");
    });
    let error = enabled
        .keep_speed(300.0, Duration::from_secs(30))
        .wait()
        .expect_err("another speed");
    let expected = (200, 1638);
    assert!(
        matches!(error, Error::ScaleChanged { before, now, .. } if (before, now) == expected),
        "{error}"
    );
    assert!(enabled.status().expect("a status").time - begin < Duration::from_secs(1));
    drop(enabled);
    // the speed of a standstill is scaled as before
    let _ = axis.release().wait();
    assert!(is_at_rest(&session, ids[0]));
}

/// An axis that had its speed and is slowed down beside its controller is not called a success.
#[test]
fn a_lost_speed_is_reported() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let mut axis = connected(&mut session, &mut drive);
    let mut enabled = axis.enable().wait().expect("enabled");
    assert!(matches!(enabled.run(0.001).wait(), Err(Error::SpeedStep { .. })));
    enabled.reach_speed(60.0, None).wait().expect("runs");
    enabled
        .keep_speed(60.0, Duration::from_secs(5))
        .wait()
        .expect("keeps it");
    let begin = enabled.status().expect("a status").time;
    let (inner, running) = enabled.session();
    write(inner, running, &["VL.LIMITP_32=10rpm"]);
    let error = enabled
        .keep_speed(60.0, Duration::from_secs(30))
        .wait()
        .expect_err("10 rpm only");
    let text = error.to_string();
    assert!(text.contains("60 rpm was reached and is not kept: "), "{text}");
    assert!(enabled.status().expect("a status").time - begin < Duration::from_secs(3));
    drop(enabled);
    axis.release().wait().expect("released");
    assert!(is_at_rest(&session, ids[0]));
}

/// The panel takes a running drive: that cause is reported, and its stop is not a state of switching on.
#[test]
fn local_operation_during_a_run_is_named() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let shown = Shared::new(Vec::new());
    let list = shown.clone();
    let mut axis = connected(&mut session, &mut drive);
    axis.watch(move |status| list.borrow_mut().push(status.view.state()));
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(600.0, None).wait().expect("runs");
    shown.borrow_mut().clear();
    with_drive(&session, ids[0], |drive| {
        drive.inject("local=on".parse().expect("an injection"));
    });
    let error = enabled
        .keep_speed(600.0, Duration::from_secs(3))
        .wait()
        .expect_err("the panel stops it");
    assert!(
        matches!(
            error,
            Error::Axis {
                trouble: Trouble::LocalOperation,
                ..
            }
        ),
        "{error}"
    );
    drop(enabled);
    let _ = axis.release().wait();
    let states = shown.borrow();
    assert!(!states.contains(&Some(State::S3)), "{states:?}");
    assert!(states.contains(&Some(State::S5Ramp)), "{states:?}");
    let status = session.status(&mut drive).wait().expect("a status");
    assert_eq!(switched_off_beside(&status), None);
    assert_eq!(diagnose(&status).cause, Cause::LocalOperation);
}

/// A refused client gets the owner of the drive.
#[test]
fn a_refusal_names_the_controller_that_has_the_drive() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    session.medium().segment_mut().attach(other_controller().0);
    session.pass(Duration::from_secs(3)).wait().expect("time passes");
    let mut drive = find(&mut session, "akd-1").expect("there");
    let error = session
        .take_axis(&mut drive, AxisSettings::for_purpose(Purpose::Control))
        .wait()
        .map(|_| ())
        .expect_err("refused");
    let message = error.to_string();
    assert!(message.contains("controller \"plc\" owns it"), "{message}");
}

/// A speed between two steps of the setpoint is reported as the one that is sent.
#[test]
fn the_rounded_speed_is_reported() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let mut axis = connected(&mut session, &mut drive);
    let rounded = axis.rounded_speed(61.7).expect("another speed");
    assert!((rounded - 61.87).abs() < 0.01, "{rounded}");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.run(61.7).wait().expect("runs");
    let status = enabled.status().expect("a status");
    assert_eq!(status.speed_set, Some(rounded));
    assert_eq!(enabled.rounded_speed(rounded), None, "a step itself");
    assert_eq!(enabled.rounded_speed(1e9), None, "refused instead");
    drop(enabled);
    axis.release().wait().expect("released");
}
