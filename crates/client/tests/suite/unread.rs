//! Stopping a drive whose parameters cannot be read, in virtual time: control word and status word are enough.

use std::time::Duration;
use testbench::running_on;
use testbench::shared::On;

use profidrive_client::axis::Purpose;
use profidrive_client::{AxisSettings, Drive, Error, LocalControl, StopOutcome, StopWay, Wait};
use profile::parameter::{Keep, ParameterAccess};
use testbench::world::{Accident, Transport, World};
use virtual_drive::model::{self, Model as Virtual};
use virtual_drive::station::AnswerFault;

/// Parameters by number with their values.
type Settings<'a> = &'a [(u16, u64)];

const SECOND: Duration = Duration::from_secs(1);
/// The ramp of the drives, and what else a stop may take with all of its parameters.
const STOP: Duration = Duration::from_secs(9);
/// How much longer it may take without them.
const DELAY: Duration = Duration::from_millis(2500);

/// Drives that keep turning with this setting when their controller is lost.
const KEEP_TURNING: [(&Virtual, &str, u16); 2] = [(&model::VLT, "vlt", 804), (&model::VACON, "vacon", 733)];

fn set(world: &World, number: u16, value: u64) {
    world.look(|drive| {
        let parameter = drive.model().numbered(number).expect("known");
        let index = parameter.base.unwrap_or(0);
        ParameterAccess::write(drive, parameter.pnu, index, value, Keep::Volatile).expect("taken");
    });
}

/// A drive that a client left running, and from then on does not answer parameters as it should.
fn left_running(
    virtual_model: &'static Virtual,
    name: &str,
    settings: Settings<'_>,
    transport: Transport,
    telegram: Option<u16>,
) -> World {
    let world = World::new(virtual_model, transport, 7);
    for (number, value) in settings {
        set(&world, *number, *value);
    }
    let (mut session, mut drive) = world.client(name, transport, 1).expect("found");
    let wanted = AxisSettings {
        reference_speed: drive.is_on_line().then_some(1500.0),
        telegram,
        ..running_on(Purpose::Speed)
    };
    let mut axis = session.take_axis(&mut drive, wanted).wait().expect("free");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(900.0, None).wait().expect("runs");
    world.plan(Duration::ZERO, Accident::Killed);
    enabled.hold(SECOND).wait().expect_err("killed");
    drop(enabled);
    drop(axis);
    drop(session);
    world.pass(SECOND * 3);
    assert!(world.speed() > 800.0, "{name} {transport:?}: {}", world.speed());
    world
}

fn found(world: &World, transport: Transport) -> (On<World>, Drive) {
    let (mut session, address) = world.session(transport, 2);
    session.tolerate_unread();
    let drive = session.find(&address).wait().expect("it answers");
    (session, drive)
}

fn stopped(world: &World, transport: Transport, at: &str) -> (StopOutcome, Duration) {
    let (mut session, mut drive) = found(world, transport);
    let before = world.fastest().max(world.speed());
    let begin = session.now();
    let outcome = session
        .stop_drive(&mut drive, StopWay::Stop, SECOND * 10)
        .wait()
        .expect(at);
    assert!(outcome.sent && outcome.at_rest, "{at}: {outcome:?}");
    assert_eq!(outcome.enabled, Some(false), "{at}");
    assert!(world.fastest() < before + 5.0, "{at}: no jump");
    assert!(
        world.speed().abs() < 1.0 && world.look(|drive| !drive.is_enabled()),
        "{at}"
    );
    (outcome, session.now() - begin)
}

#[test]
fn stop_takes_over_a_drive_whose_parameters_cannot_be_read() {
    let faults = [
        AnswerFault::Silent,
        AnswerFault::Reference,
        AnswerFault::Cut,
        AnswerFault::Late(SECOND * 3),
    ];
    for (virtual_model, name, setting) in KEEP_TURNING {
        for transport in [Transport::Profinet, Transport::Fc, Transport::Uss] {
            for fault in faults {
                let at = format!("{name} {transport:?} {fault:?}");
                let world = left_running(virtual_model, name, &[(setting, 0)], transport, None);
                world.answer(fault);
                let (outcome, took) = stopped(&world, transport, &at);
                assert!(outcome.unread.is_some(), "{at}: {outcome:?}");
                assert!(took < STOP + DELAY, "{at}: {took:?}");
                // along the ramp, neither faster nor off at once
                assert!(took > SECOND, "{at}: {took:?}");
            }
        }
    }
}

#[test]
fn a_drive_that_answers_is_stopped_with_its_parameters() {
    for (virtual_model, name, setting) in KEEP_TURNING {
        for transport in [Transport::Profinet, Transport::Fc, Transport::Uss] {
            let at = format!("{name} {transport:?}");
            let world = left_running(virtual_model, name, &[(setting, 0)], transport, None);
            let (outcome, _) = stopped(&world, transport, &at);
            assert_eq!(outcome.unread, None, "{at}");
        }
    }
}

/// Which words a telegram of the vendor has depends on settings (8-10, 9-15): those of telegram 1 do not.
#[test]
fn a_drive_in_a_telegram_of_its_vendor_is_stopped_without_its_parameters() {
    let cases: [(&Virtual, &str, Settings<'_>, u16); 3] = [
        (&model::VLT, "vlt", &[(804, 0)], 106),
        (&model::VLT, "vlt", &[(804, 0), (810, 1)], 103),
        (&model::VACON, "vacon", &[(733, 0)], 148),
    ];
    for (virtual_model, name, settings, telegram) in cases {
        let at = format!("{name} {telegram}");
        let world = left_running(virtual_model, name, settings, Transport::Profinet, Some(telegram));
        world.answer(AnswerFault::Silent);
        let (outcome, took) = stopped(&world, Transport::Profinet, &at);
        assert!(outcome.unread.is_some(), "{at}");
        assert!((SECOND..STOP + DELAY).contains(&took), "{at}: {took:?}");
    }
}

/// The ramp of the drive has its time whatever the limit; without knowing it the quick stop comes after the limit.
#[test]
fn a_ramp_longer_than_the_limit_is_waited_for_where_the_drive_reports_it() {
    for (fault, quick) in [(AnswerFault::None, false), (AnswerFault::Cut, true)] {
        let world = left_running(&model::VLT, "vlt", &[(804, 0)], Transport::Profinet, None);
        // 3-42: 10 s to the speed of the motor
        set(&world, 342, 1000);
        world.answer(fault);
        let (mut session, mut drive) = found(&world, Transport::Profinet);
        let begin = session.now();
        let stopped = session.stop_drive(&mut drive, StopWay::Stop, SECOND).wait();
        assert_eq!(stopped.is_err(), quick, "{fault:?}: {stopped:?}");
        let took = session.now() - begin;
        assert_eq!(took < SECOND * 6, quick, "{fault:?}: {took:?}");
        // what was commanded last goes on
        world.pass(SECOND * 5);
        assert!(world.speed().abs() < 1.0, "{fault:?}: {}", world.speed());
    }
}

/// Whose bits the words at a line have shows in the status word where 8-10 cannot be read.
#[test]
fn the_profile_on_a_line_is_recognised_by_the_status_word() {
    for transport in [Transport::Fc, Transport::Uss] {
        let world = left_running(&model::VLT, "vlt", &[(810, 1), (804, 0)], transport, None);
        world.answer(AnswerFault::Silent);
        let (outcome, took) = stopped(&world, transport, &format!("{transport:?}"));
        assert!(outcome.unread.is_some(), "{outcome:?}");
        assert!(took > SECOND, "along the ramp: {took:?}");
    }
}

/// The controller that has the control word is named anyway: that is read from a record.
#[test]
fn a_drive_with_an_owner_is_not_taken_over_without_its_parameters() {
    let world = World::new(&model::VLT, Transport::Profinet, 7);
    let (mut session, mut drive) = world.client("vlt", Transport::Profinet, 1).expect("found");
    let wanted = running_on(Purpose::Speed);
    let mut axis = session.take_axis(&mut drive, wanted).wait().expect("free");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(600.0, None).wait().expect("runs");
    world.answer(AnswerFault::Silent);
    let (inner, own) = enabled.session();
    let begin = inner.now();
    let error = inner
        .stop_drive(own, StopWay::Stop, SECOND)
        .wait()
        .expect_err("owned");
    assert!(
        matches!(&error, Error::NoStopBeside { controller, .. } if controller == "client"),
        "{error}"
    );
    assert!(inner.now() - begin < DELAY);
    assert!(inner.unread().is_none(), "for a stop only");
    let selection = own.select("8-04").expect("known");
    assert!(
        inner.read(own, &[selection]).wait().is_err(),
        "a read beside it is one again"
    );
}

/// The time of a motion is kept, and a speed that is lost is seen, whatever became of the parameters meanwhile.
#[test]
fn a_motion_does_not_wait_for_parameters() {
    let faults = [
        AnswerFault::Silent,
        AnswerFault::Cut,
        AnswerFault::Late(SECOND * 3),
    ];
    for fault in faults {
        let world = World::new(&model::AKD, Transport::Profinet, 7);
        let (mut session, mut drive) = world.client("akd", Transport::Profinet, 1).expect("found");
        let mut axis = session
            .take_axis(&mut drive, running_on(Purpose::Speed))
            .wait()
            .expect("free");
        let mut enabled = axis.enable().wait().expect("enabled");
        enabled.reach_speed(300.0, None).wait().expect("runs");
        world.answer(fault);
        let begin = profidrive_client::Wire::now(&world);
        enabled.keep_speed(300.0, SECOND * 3).wait().expect("keeps it");
        let took = profidrive_client::Wire::now(&world) - begin;
        assert!(took < SECOND * 3 + SECOND / 10, "{fault:?}: {took:?}");
        set(&world, 2439, 10_000);
        let begin = profidrive_client::Wire::now(&world);
        let error = enabled
            .keep_speed(300.0, SECOND * 30)
            .wait()
            .expect_err("10 rpm only");
        assert!(matches!(error, Error::SpeedLost { .. }), "{fault:?}: {error}");
        let took = profidrive_client::Wire::now(&world) - begin;
        assert!(took < SECOND * 5 / 2, "{fault:?}: {took:?}");
    }
}

/// Its telegram shows that it coasts, and its parameters say nothing.
#[test]
fn an_axis_that_coasts_unread_is_not_called_at_rest() {
    let world = World::new(&model::VLT, Transport::Profinet, 7);
    let (mut session, mut drive) = world.client("vlt", Transport::Profinet, 1).expect("found");
    let mut axis = session
        .take_axis(&mut drive, running_on(Purpose::Speed))
        .wait()
        .expect("free");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(1400.0, None).wait().expect("runs");
    // a trip: the motor coasts
    world.look(|drive| drive.inject_fault(14, false));
    let _ = enabled.hold(SECOND / 10).wait();
    drop(enabled);
    let _ = axis.release().wait();
    world.answer(AnswerFault::Silent);
    let outcome = session
        .stop_drive(&mut drive, StopWay::Stop, SECOND)
        .wait()
        .expect("no owner");
    assert!(world.speed() > 10.0, "{} rpm", world.speed());
    assert!(!outcome.at_rest && outcome.speed.is_none(), "{outcome:?}");
}

/// A drive with a parameter that stops it: what can be done without it follows from who has the control word.
#[test]
fn a_stop_by_parameter_that_is_not_answered_is_one_by_the_control_word() {
    for fault in [AnswerFault::Silent, AnswerFault::Cut] {
        let world = World::new(&model::AKD, Transport::Profinet, 7);
        world.answer(fault);
        let (mut session, mut drive) = found(&world, Transport::Profinet);
        let begin = session.now();
        let outcome = session
            .stop_drive(&mut drive, StopWay::Stop, SECOND * 10)
            .wait()
            .expect("no owner");
        // one value alone is not cut: the drive said that its power stage is off, and not whether it turns
        assert!(outcome.by_word.is_some(), "{fault:?}: {outcome:?}");
        assert!(outcome.at_rest, "{fault:?}: {outcome:?}");
        assert_eq!(outcome.enabled, Some(false), "{fault:?}");
        assert!(session.now() - begin < SECOND * 4, "{fault:?}");
        drop(session);

        let world = World::new(&model::AKD, Transport::Profinet, 7);
        let (mut session, mut drive) = world.client("akd", Transport::Profinet, 1).expect("found");
        let mut axis = session
            .take_axis(&mut drive, running_on(Purpose::Speed))
            .wait()
            .expect("free");
        let mut enabled = axis.enable().wait().expect("enabled");
        enabled.reach_speed(300.0, None).wait().expect("runs");
        world.answer(fault);
        let (inner, own) = enabled.session();
        let begin = inner.now();
        let error = inner
            .stop_drive(own, StopWay::Stop, SECOND * 10)
            .wait()
            .expect_err("it has an owner");
        assert!(
            matches!(&error, Error::StopUnanswered { controller, command: "DRV.STOP", .. } if controller == "client"),
            "{fault:?}: {error}"
        );
        assert!(
            error
                .advice()
                .is_some_and(|advice| advice.to_string().contains("safety circuit")),
            "{error}"
        );
        assert!(inner.now() - begin < SECOND * 3, "{fault:?}");
    }
}

/// Its service channel has enabled it: no control word stops it.
#[test]
fn a_drive_enabled_by_its_service_channel_is_not_called_stopped() {
    let world = World::new(&model::AKD, Transport::Profinet, 7);
    // DRV.CMDSOURCE, DRV.EN
    set(&world, 2113, 0);
    set(&world, 2127, 1);
    world.pass(SECOND);
    assert!(world.look(|drive| drive.is_enabled()));
    world.answer(AnswerFault::Silent);
    let (mut session, mut drive) = found(&world, Transport::Profinet);
    let begin = session.now();
    let error = session
        .stop_drive(&mut drive, StopWay::Stop, SECOND * 10)
        .wait()
        .expect_err("it is local");
    assert!(
        matches!(
            &error,
            Error::LocalOperation {
                by: LocalControl::ServiceChannel,
                ..
            }
        ),
        "{error}"
    );
    assert!(session.now() - begin < SECOND * 5, "{:?}", session.now() - begin);
}

/// The reported wait is the actual one.
#[test]
fn an_abandoned_request_has_its_time() {
    let world = left_running(&model::VLT, "vlt", &[(804, 0)], Transport::Profinet, None);
    world.answer(AnswerFault::Silent);
    let (outcome, _) = stopped(&world, Transport::Profinet, "vlt");
    let cause = outcome.unread.expect("silent");
    assert!(!cause.contains("90000"), "{cause}");
}

/// Over a line that carries no speed parameter of a Vacon the speed is that of its replies.
#[test]
fn stop_on_a_line_reports_the_speed_of_the_replies() {
    for transport in [Transport::Fc, Transport::Uss] {
        let world = left_running(&model::VACON, "vacon", &[(733, 0)], transport, None);
        let (outcome, _) = stopped(&world, transport, "vacon");
        let before = outcome.percent_before.expect("in every reply");
        assert!((50.0..70.0).contains(&before), "{transport:?}: {outcome:?}");
        assert_eq!(outcome.percent, Some(0.0), "{transport:?}");
    }
}

/// An interrupted stop reports which drive it was, and its last state.
#[test]
fn an_interrupted_stop_reports_the_last_state_of_the_drive() {
    let mut seen = 0;
    for after in [0, 50, 100, 200, 500].map(Duration::from_millis) {
        let world = left_running(&model::VLT, "vlt", &[(804, 0)], Transport::Profinet, None);
        let (mut session, mut drive) = found(&world, Transport::Profinet);
        let (clock, due) = (world.clone(), session.now() + after);
        session.interrupt_with(move || profidrive_client::Wire::now(&clock) >= due);
        match session.stop_drive(&mut drive, StopWay::Stop, SECOND * 10).wait() {
            Ok(outcome) => assert!(outcome.at_rest, "{after:?}: {outcome:?}"),
            Err(error @ Error::StopInterrupted { .. }) => {
                let text = error.to_string();
                assert!(text.starts_with("drive-1: interrupted; "), "{text}");
                seen += usize::from(text.contains("it was seen last at 9"));
            }
            Err(error) => panic!("{after:?}: {error}"),
        }
    }
    assert!(seen > 0);
}
