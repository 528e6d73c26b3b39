//! Ownerless drives in operation, in virtual time: who may stop them, and how.

use std::time::Duration;
use testbench::running_on;
use testbench::shared::On;

use profidrive_client::axis::{Purpose, SpeedUnit, Trouble};
use profidrive_client::status::{Cause, diagnose};
use profidrive_client::{
    Action, Advice, AxisSettings, Drive, Error, LocalControl, LossAction, Rest, StopMeans, StopWay, Wait,
    WriteMode,
};
use profile::parameter::{Keep, ParameterAccess};
use testbench::world::{Accident, Transport, World};
use virtual_drive::drive::Injection;
use virtual_drive::model::{self, Model as Virtual};

const SECOND: Duration = Duration::from_secs(1);

/// Drives that keep turning with this setting when their controller is lost.
const KEEP_TURNING: [(&Virtual, &str, &str); 2] = [
    (&model::VLT, "vlt", "8-04=0"),
    (&model::VACON, "vacon", "ID733=0"),
];

/// The actions in an advice.
fn actions(advice: Option<Advice>) -> Vec<Action> {
    advice.iter().flat_map(Advice::actions).cloned().collect()
}

fn settings(drive: &Drive, purpose: Purpose) -> AxisSettings {
    AxisSettings {
        // what a drive does not report over its line
        reference_speed: drive.is_on_line().then_some(1500.0),
        ..running_on(purpose)
    }
}

/// Writes into the drive, past the channel of a line that may not carry the parameter.
fn set(world: &World, text: &str) {
    let (name, raw) = text.split_once('=').expect("an assignment");
    let raw = raw.parse().expect("a number");
    world.look(|drive| {
        let digits: String = name.chars().filter(char::is_ascii_digit).collect();
        let number: u16 = digits.parse().expect("a number");
        let parameter = drive.model().numbered(number).expect("known");
        let index = parameter.base.unwrap_or(0);
        ParameterAccess::write(drive, parameter.pnu, index, raw, Keep::Volatile).expect("taken");
    });
}

/// A client runs the drive and is killed.
fn kill_client(world: &World, model: &str, transport: Transport, speed: f64) {
    let (mut session, mut drive) = world.client(model, transport, 1).expect("found");
    let wanted = settings(&drive, Purpose::Speed);
    let mut axis = session.take_axis(&mut drive, wanted).wait().expect("free");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(speed, None).wait().expect("runs");
    world.plan(Duration::ZERO, Accident::Killed);
    enabled.hold(SECOND).wait().expect_err("killed");
}

fn transports(model: &str) -> &'static [Transport] {
    match model {
        "standard" => &[Transport::Profinet],
        _ => &[Transport::Profinet, Transport::Fc, Transport::Uss],
    }
}

#[test]
fn stop_takes_over_an_ownerless_drive_without_a_jump() {
    for (virtual_model, name, setting) in KEEP_TURNING {
        for &transport in transports(name) {
            for (speed, way) in [(600.0, StopWay::Stop), (900.0, StopWay::Disable)] {
                let world = World::new(virtual_model, transport, 7);
                set(&world, setting);
                kill_client(&world, name, transport, speed);
                world.pass(SECOND * 5);
                let before = world.speed();
                let at = format!("{name} {transport:?} {speed}: {before}");
                assert!(before > speed * 0.9, "{at}");
                let (mut session, mut drive) = world.client(name, transport, 2).expect("found");
                let means = session.stop_means(&mut drive, way).wait().expect("read");
                assert!(matches!(means, StopMeans::TakeOver), "{at}: {means:?}");
                world.fastest();
                let begin = session.now();
                let outcome = session
                    .stop_drive(&mut drive, way, SECOND * 10)
                    .wait()
                    .unwrap_or_else(|error| panic!("{at}: {error}"));
                assert!(outcome.sent && outcome.at_rest, "{at}: {outcome:?}");
                assert_eq!(outcome.enabled, Some(false), "{at}");
                // along the ramp: neither faster nor off at once
                assert!(world.fastest() < before + 5.0, "{at}");
                assert!(session.now() - begin > SECOND / 2, "{at}");
                assert!(
                    world.speed().abs() < 1.0 && world.look(|drive| !drive.is_enabled()),
                    "{at}"
                );
                let status = session.status(&mut drive).wait().expect("read");
                assert_eq!(diagnose(&status).cause, Cause::NoController, "{at}");
            }
        }
    }
}

/// The direction of a control word of the vendor is kept until the axis stands.
#[test]
fn a_drive_that_turns_backwards_by_a_bit_of_its_vendor_is_not_reversed() {
    let world = World::new(&model::VLT, Transport::Fc, 7);
    set(&world, "8-04=0");
    set(&world, "4-10=2");
    // start, reverse, 600 rpm of 1500; a master that is not yet lost has its word overwritten by ours
    let words: [u8; 4] = [0x84, 0x7C, 0x19, 0x9A];
    for (gap, kept) in [(Duration::ZERO, false), (SECOND * 3, true)] {
        world.command(&words, SECOND * 12);
        world.pass(gap);
        let before = world.speed();
        assert!(before < -500.0, "{before}");
        let (mut session, mut drive) = world.client("vlt", Transport::Fc, 2).expect("found");
        let mut axis = session
            .take_axis(&mut drive, running_on(Purpose::Control))
            .wait()
            .expect("taken over");
        axis.hold(SECOND * 2)
            .wait()
            .expect("goes on as it was, or ramps down");
        let after = world.speed();
        assert!(after < 1.0, "{before} -> {after}: reversed");
        assert!(!kept || (after - before).abs() < 60.0, "{before} -> {after}");
        axis.release().wait().expect("at rest");
        assert!(world.speed().abs() < 1.0);
        world.pass(SECOND * 3);
    }
}

#[test]
fn a_motion_is_not_begun_on_an_ownerless_drive() {
    for (virtual_model, name, setting) in KEEP_TURNING {
        for &transport in transports(name) {
            let world = World::new(virtual_model, transport, 7);
            set(&world, setting);
            kill_client(&world, name, transport, 600.0);
            world.pass(SECOND * 3);
            let before = world.speed();
            let (mut session, mut drive) = world.client(name, transport, 2).expect("found");
            for purpose in [Purpose::Speed, Purpose::Jog] {
                let wanted = settings(&drive, purpose);
                let error = session
                    .take_axis(&mut drive, wanted)
                    .wait()
                    .map(|_| ())
                    .expect_err("turns");
                assert!(
                    matches!(error, Error::Ownerless { .. }),
                    "{name} {transport:?}: {error}"
                );
                assert_eq!(actions(error.advice()), [Action::Stop], "{name}");
                assert!(
                    error.to_string().contains("though no controller is connected"),
                    "{error}"
                );
            }
            let error = session.check_control(&mut drive).wait().expect_err("turns");
            assert!(matches!(error, Error::Ownerless { .. }), "{error}");
            assert!(
                (world.speed() - before).abs() < 5.0,
                "{name} {transport:?}: left alone"
            );
            let status = session.status(&mut drive).wait().expect("read");
            let found = diagnose(&status);
            let turns = [Cause::TurnsOwnerless, Cause::EnabledOwnerless];
            assert!(turns.contains(&found.cause), "{name} {transport:?}: {found:?}");
            assert_eq!(actions(found.next.clone())[0], Action::Stop, "{name}: {found:?}");
        }
    }
}

/// The time-out function commands the axis, not the last control word; a motion is begun in no case.
#[test]
fn motion_of_an_ownerless_drive_is_reported_before_control() {
    let cases = [
        ("8-04=2", "8-04 is Stop"),
        ("8-04=3", "8-04 is Jogging"),
        ("8-04=4", "8-04 is Max. speed"),
    ];
    for transport in [Transport::Profinet, Transport::Fc, Transport::Uss] {
        for (setting, words) in cases {
            let world = World::new(&model::VLT, transport, 7);
            set(&world, setting);
            // 3-42: 60 s to the speed of the motor
            set(&world, "3-42=6000");
            kill_client(&world, "vlt", transport, 900.0);
            world.pass(SECOND * 3);
            let at = format!("{transport:?} {setting}: {} rpm", world.speed());
            let (mut session, mut drive) = world.client("vlt", transport, 2).expect("found");
            let status = session.status(&mut drive).wait().expect("read");
            let found = diagnose(&status);
            assert_eq!(found.cause, Cause::TurnsOwnerless, "{at}: {found:?}");
            assert!(
                found.notes.iter().all(|note| note.id != "moved-from-outside"),
                "{at}"
            );
            assert_eq!(actions(found.next.clone())[0], Action::Stop, "{at}");
            assert!(
                found.sentence.contains(words) && !found.sentence.contains("in force"),
                "{at}: {}",
                found.sentence
            );
            assert_eq!(
                session.is_enabled(&mut drive).wait().expect("read"),
                Some(true),
                "{at}"
            );
            let wanted = settings(&drive, Purpose::Speed);
            let error = session
                .take_axis(&mut drive, wanted)
                .wait()
                .map(|_| ())
                .expect_err("it turns");
            assert!(matches!(error, Error::Ownerless { .. }), "{at}: {error}");
            assert!(world.speed() > 10.0, "{at}: left alone");
        }
    }
}

/// What a servo drive has no panel for is not sent to one.
#[test]
fn local_operation_is_reported_with_the_terms_of_the_drive() {
    let world = World::new(&model::AKD, Transport::Profinet, 7);
    world.look(|drive| drive.inject("local=on".parse().expect("an injection")));
    world.pass(SECOND);
    let (mut session, mut drive) = world.client("akd", Transport::Profinet, 1).expect("found");
    let status = session.status(&mut drive).wait().expect("read");
    assert_eq!(status.local, Some(LocalControl::Elsewhere));
    let found = diagnose(&status);
    assert_eq!(found.cause, Cause::LocalOperation);
    let next = found.next.as_ref().map(ToString::to_string).unwrap_or_default();
    assert!(
        !found.sentence.contains("panel") && !next.contains("AUTO"),
        "{found:?} {next}"
    );
}

/// Another client owns the drive: nothing is taken over, and the advice is the controller.
#[test]
fn a_drive_with_an_owner_is_not_taken_over() {
    let world = World::new(&model::VLT, Transport::Profinet, 7);
    let (mut session, mut drive) = world.client("vlt", Transport::Profinet, 1).expect("found");
    let wanted = settings(&drive, Purpose::Speed);
    let mut axis = session.take_axis(&mut drive, wanted).wait().expect("free");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(600.0, None).wait().expect("runs");
    let (inner, own) = enabled.session();
    let means = inner.stop_means(own, StopWay::Stop).wait().expect("read");
    assert!(matches!(means, StopMeans::Owned(name) if name == "client"));
}

#[test]
fn local_control_is_refused_with_who_has_it() {
    // the panel runs the motor; a setting keeps the field bus off
    let cases: [(&Virtual, &str, &str, &str); 3] = [
        (&model::VLT, "vlt", "local-speed=600rpm", "its panel"),
        (&model::VACON, "vacon", "local-speed=600rpm", "its panel"),
        (&model::VLT, "vlt", "", "8-01 is Digital only"),
    ];
    for (virtual_model, name, injection, words) in cases {
        let world = World::new(virtual_model, Transport::Profinet, 7);
        if injection.is_empty() {
            set(&world, "8-01=1");
            // something to look after, so that the drive looks at its setting
            world.look(|drive| drive.inject(Injection::Load(0.0)));
        } else {
            let press: Injection = injection.parse().expect("an injection");
            world.look(|drive| drive.inject(press));
        }
        world.pass(SECOND * 6);
        let (mut session, mut drive) = world.client(name, Transport::Profinet, 1).expect("found");
        let error = session
            .take_axis(&mut drive, running_on(Purpose::Speed))
            .wait()
            .map(|_| ())
            .expect_err("local");
        assert!(matches!(error, Error::LocalOperation { .. }), "{name}: {error}");
        assert!(error.to_string().contains(words), "{name}: {error}");
        let before = world.speed();
        if before.abs() > 1.0 {
            let error = session
                .stop_drive(&mut drive, StopWay::Stop, SECOND)
                .wait()
                .expect_err("the panel has it");
            assert!(
                matches!(
                    &error,
                    Error::LocalOperation {
                        by: LocalControl::Panel,
                        ..
                    }
                ),
                "{name}: {error}"
            );
            assert!(
                error
                    .advice()
                    .is_some_and(|advice| advice.to_string().contains("at its panel")),
                "{error}"
            );
            assert_eq!(actions(error.advice()), [], "no command of ours stops it");
            assert!((world.speed() - before).abs() < 5.0, "left alone");
        }
        let status = session.status(&mut drive).wait().expect("read");
        let found = diagnose(&status);
        assert_eq!(found.cause, Cause::LocalOperation, "{name}");
        assert!(found.sentence.contains(words), "{name}: {found:?}");
    }
}

/// A drive without tables is stopped by its control word too.
#[test]
fn an_ownerless_drive_without_tables_is_stopped() {
    let world = World::new(&model::VACON, Transport::Profinet, 7);
    set(&world, "ID733=0");
    kill_client(&world, "vacon", Transport::Profinet, 600.0);
    world.pass(SECOND * 2);
    let (mut session, mut drive) = world.client("standard", Transport::Profinet, 2).expect("found");
    session.find_channel(&mut drive).wait().expect("it has one");
    world.fastest();
    let outcome = session
        .stop_drive(&mut drive, StopWay::Stop, SECOND * 15)
        .wait()
        .expect("stopped");
    assert!(outcome.sent && outcome.at_rest, "{outcome:?}");
    assert!(
        world.fastest() < 620.0 && world.speed().abs() < 1.0,
        "{}",
        world.speed()
    );
}

/// What a lost connection means for this drive is read before, and said with the loss.
#[test]
fn a_connection_loss_message_describes_the_reaction_of_the_drive() {
    let cases: [(&Virtual, &str, &str, LossAction, &str); 13] = [
        (
            &model::AKD,
            "akd",
            "2158=1",
            LossAction::QuickStop,
            "the drive stops with a quick stop (p2605 is Fault)",
        ),
        (
            &model::AKD,
            "akd",
            "2605=1",
            LossAction::Ramp,
            "the drive stops along its ramp (p2605 is Ignored)",
        ),
        (
            &model::AKD,
            "akd",
            "2605=4",
            LossAction::Ramp,
            "the drive stops along its ramp (p2605 is Warning)",
        ),
        (
            &model::VLT,
            "vlt",
            "8-04=0",
            LossAction::KeepsTurning,
            "the drive keeps turning (8-04 is Off)",
        ),
        (
            &model::VLT,
            "vlt",
            "8-04=1",
            LossAction::KeepsTurning,
            "(8-04 is Freeze output)",
        ),
        (
            &model::VLT,
            "vlt",
            "8-04=2",
            LossAction::Ramp,
            "along its ramp after 1 s (8-04 is Stop)",
        ),
        (
            &model::VLT,
            "vlt",
            "8-04=3",
            LossAction::KeepsTurning,
            "(8-04 is Jogging)",
        ),
        (
            &model::VLT,
            "vlt",
            "8-04=4",
            LossAction::KeepsTurning,
            "(8-04 is Max. speed)",
        ),
        (
            &model::VLT,
            "vlt",
            "8-04=5",
            LossAction::Stop,
            "the drive stops after 1 s (8-04 is Stop and trip)",
        ),
        (
            &model::VACON,
            "vacon",
            "ID733=0",
            LossAction::Unknown,
            "it is not known whether the drive stops",
        ),
        (
            &model::VACON,
            "vacon",
            "ID733=1",
            LossAction::Unknown,
            "(ID 733 is Alarm)",
        ),
        (
            &model::VACON,
            "vacon",
            "ID733=2",
            LossAction::Ramp,
            "the drive stops along its ramp (ID 733 is",
        ),
        (
            &model::VACON,
            "vacon",
            "ID733=3",
            LossAction::Coast,
            "switches its power stage off and coasts",
        ),
    ];
    for (virtual_model, name, setting, action, words) in cases {
        let world = World::new(virtual_model, Transport::Profinet, 7);
        set(&world, setting);
        let (mut session, mut drive) = world.client(name, Transport::Profinet, 1).expect("found");
        let mut axis = session
            .take_axis(&mut drive, running_on(Purpose::Speed))
            .wait()
            .expect("free");
        assert_eq!(axis.loss_reaction().action, action, "{setting}");
        let mut enabled = axis.enable().wait().expect("enabled");
        enabled.reach_speed(300.0, None).wait().expect("runs");
        world.plan(Duration::ZERO, Accident::CableOut(SECOND * 3));
        let error = enabled.hold(SECOND).wait().expect_err("lost");
        let Error::ConnectionLost { reaction, .. } = &error else {
            panic!("{setting}: {error}");
        };
        let reaction = reaction.as_deref().expect("read before");
        assert_eq!(reaction.action, action, "{setting}");
        let text = error.to_string();
        assert!(
            text.starts_with("drive-1: connection lost") && text.contains(words),
            "{text}"
        );
        // the client cannot tell a restart from a lost line
        let restarted = text.ends_with(", unless it restarted: then it coasts");
        let stops = !matches!(action, LossAction::KeepsTurning | LossAction::Unknown);
        assert_eq!(restarted, stops, "{text}");
        let advice = if action.stops() {
            Action::Status
        } else {
            Action::Stop
        };
        assert_eq!(actions(error.advice()).last(), Some(&advice), "{setting}");
        drop(enabled);
        drop(axis);
        // and it is what the drive does
        world.pass(SECOND * 8);
        let turns = world.speed().abs() > 100.0;
        assert_eq!(turns, !action.stops(), "{setting}: {} rpm", world.speed());
    }
    // over a line what is not known of the AKD and of the settings that the channel cannot carry is not guessed
    for (virtual_model, name) in [(&model::AKD, "akd"), (&model::VACON, "vacon")] {
        let world = World::new(virtual_model, Transport::Fc, 7);
        let (mut session, mut drive) = world.client(name, Transport::Fc, 1).expect("found");
        let reaction = session.loss_reaction(&mut drive).wait().expect("read");
        assert_eq!(reaction.action, LossAction::Unknown, "{name}");
    }
}

/// The read beside a running axis finds the connection gone first: the loss is a loss for every call after it.
#[test]
fn a_lost_connection_is_never_a_mistake_of_the_caller() {
    let world = World::new(&model::AKD, Transport::Profinet, 7);
    let (mut session, mut drive) = world.client("akd", Transport::Profinet, 1).expect("found");
    let mut axis = session
        .take_axis(&mut drive, running_on(Purpose::Speed))
        .wait()
        .expect("free");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(300.0, None).wait().expect("runs");
    let lost = |error: Error| {
        let text = error.to_string();
        assert!(matches!(error, Error::ConnectionLost { .. }), "{text}");
        assert!(text.starts_with("drive-1: connection lost"), "{text}");
    };
    world.plan(Duration::ZERO, Accident::CableOut(SECOND * 60));
    // a read goes through the connection of the axis, and is the first to notice its end
    let (inner, own) = enabled.session();
    let reading = own.select("DRV.ACC").expect("known");
    lost(inner.read(own, &[reading]).wait().expect_err("gone"));
    lost(enabled.run(100.0).wait().expect_err("gone"));
    lost(enabled.keep_speed(100.0, SECOND).wait().expect_err("gone"));
    lost(enabled.halt().wait().expect_err("gone"));
    assert!(enabled.held_back().wait().is_none());
    drop(enabled);
    lost(axis.stop().wait().expect_err("gone"));
    lost(axis.enable().wait().map(|_| ()).expect_err("gone"));
    lost(axis.hold(SECOND).wait().expect_err("gone"));
    lost(axis.release().wait().expect_err("gone"));
}

/// The own interface, or the serial port, fails while an axis is under control: the drive has lost its controller, and a
/// person must know which drive and what it does.
#[test]
fn a_carrier_that_fails_is_a_lost_connection_of_the_axis() {
    for (virtual_model, name, setting, words) in [
        (
            &model::VLT,
            "vlt",
            "8-04=0",
            "the drive keeps turning (8-04 is Off)",
        ),
        (&model::VLT, "vlt", "8-04=2", "the drive stops"),
        (&model::AKD, "akd", "", "the drive stops"),
    ] {
        for &transport in transports(name)
            .iter()
            .filter(|_| !setting.is_empty())
            .chain(&[Transport::Profinet])
        {
            let at = format!("{name} {setting} {transport:?}");
            let world = World::new(virtual_model, transport, 7);
            if !setting.is_empty() {
                set(&world, setting);
            }
            let (mut session, mut drive) = world.client(name, transport, 1).expect("found");
            let label = drive.label();
            let wanted = settings(&drive, Purpose::Speed);
            let mut axis = session.take_axis(&mut drive, wanted).wait().expect("free");
            let lost = |error: Error| {
                let text = error.to_string();
                assert!(matches!(error, Error::CarrierLost { .. }), "{at}: {error:?}");
                // the cause is kept
                let begin = format!("{label}: connection lost: the client was killed; ");
                assert!(text.starts_with(&begin) && text.contains(words), "{at}: {text}");
                let advice = if words.contains("stops") {
                    Action::Status
                } else {
                    Action::Stop
                };
                assert_eq!(actions(error.advice()).last(), Some(&advice), "{at}");
            };
            let mut enabled = axis.enable().wait().expect("enabled");
            enabled.reach_speed(300.0, None).wait().expect("runs");
            // the medium of this client fails with every step from here on
            world.plan(Duration::ZERO, Accident::Killed);
            lost(enabled.hold(SECOND).wait().expect_err("gone"));
            let (inner, own) = enabled.session();
            lost(inner.fault_report(own).wait().expect_err("gone"));
            drop(enabled);
            lost(axis.release().wait().expect_err("standstill not seen"));
            // nothing is under control any more: what fails now is the medium
            let error = session.pass(SECOND).wait().expect_err("gone");
            assert!(matches!(error, Error::Medium(_)), "{at}: {error:?}");
        }
    }
}

/// UDP reads a drive without any right, but control is not carried by it.
#[test]
fn a_drive_that_is_to_be_taken_over_needs_raw_frames() {
    let world = World::new(&model::VLT, Transport::Profinet, 7);
    set(&world, "8-04=0");
    kill_client(&world, "vlt", Transport::Profinet, 600.0);
    world.pass(SECOND);
    let (session, _) = world.client("vlt", Transport::Profinet, 2).expect("found");
    let mut session = session.without_discovery();
    let address = "10.0.0.1".parse().expect("an address");
    let mut drive = session.find(&address).wait().expect("by its address");
    assert_eq!(drive.model.name, "VLT");
    let begin = session.now();
    let error = session
        .stop_drive(&mut drive, StopWay::Stop, SECOND * 10)
        .wait()
        .expect_err("not by UDP");
    assert!(matches!(error, Error::NeedsRawFrames { .. }), "{error}");
    let text = format!("{error}; {}", error.advice().unwrap_or_default());
    for words in [
        "raw Ethernet frames",
        "nothing was commanded",
        "interface",
        "CAP_NET_RAW",
    ] {
        assert!(text.contains(words), "{text}");
    }
    assert!(session.now() - begin < SECOND * 2, "no connection was tried");
    let plan = session
        .plan_axis(&mut drive, &running_on(Purpose::Control))
        .wait();
    assert!(matches!(plan, Err(Error::NeedsRawFrames { .. })), "{plan:?}");
    assert!(world.speed() > 500.0, "{}", world.speed());
}

/// A trip lets the axis coast: acknowledging it is a success, however long the axis turns.
#[test]
fn a_fault_is_acknowledged_while_the_axis_still_coasts() {
    for transport in [Transport::Profinet, Transport::Fc, Transport::Uss] {
        let world = World::new(&model::VLT, transport, 7);
        set(&world, "8-04=5");
        kill_client(&world, "vlt", transport, 1400.0);
        let tripped = |world: &World| world.look(|drive| !drive.is_enabled());
        while !tripped(&world) {
            world.pass(SECOND / 20);
        }
        let (mut session, mut drive) = world.client("vlt", transport, 2).expect("found");
        let wanted = settings(&drive, Purpose::Control);
        let mut axis = session.take_axis(&mut drive, wanted).wait().expect("free");
        axis.ready_or_fault().wait().expect("a fault");
        let seen = axis.status().and_then(|status| status.view.seen);
        assert!(seen.is_some_and(|seen| seen.fault()), "{transport:?}: {seen:?}");
        axis.acknowledge().wait().expect("acknowledged");
        assert!(
            world.speed().abs() > 100.0 && axis.coasts(),
            "{transport:?}: {}",
            world.speed()
        );
        axis.release().wait().expect("not turned by this client");
        let report = session.fault_report(&mut drive).wait();
        let present = report.map(|report| report.present().count());
        assert!(!matches!(present, Ok(1..)), "{transport:?}: {present:?}");
        // and one that stands is said to coast no more
        session.pass(SECOND * 60).wait().expect("time passes");
        let wanted = settings(&drive, Purpose::Control);
        let mut axis = session.take_axis(&mut drive, wanted).wait().expect("free");
        axis.ready().wait().expect("no fault");
        assert!(!axis.coasts(), "{transport:?}");
        axis.release().wait().expect("released");
    }
}

/// An axis that ramps when control is taken and loses its power stage then: it coasts, which is not at rest.
#[test]
fn a_ramp_that_ends_in_coasting_is_no_rest() {
    for stage_goes in [true, false] {
        let world = World::new(&model::VLT, Transport::Profinet, 7);
        set(&world, "8-04=2");
        kill_client(&world, "vlt", Transport::Profinet, 1400.0);
        let turned = world.speed();
        while world.speed() > turned - 100.0 {
            world.pass(SECOND / 20);
        }
        let (mut session, mut drive) = world.client("vlt", Transport::Profinet, 2).expect("found");
        let wanted = settings(&drive, Purpose::Control);
        let mut axis = session.take_axis(&mut drive, wanted).wait().expect("free");
        axis.hold_until(SECOND, |status| status.view.seen.is_some())
            .wait()
            .expect("data");
        assert!(world.look(|drive| drive.is_enabled()), "it ramps");
        if stage_goes {
            world.look(|drive| drive.inject("sto=on".parse().expect("an injection")));
        }
        axis.ready_or_fault().wait().expect("reached or not");
        let released = axis.release_and_look().wait();
        assert!(released.closed && released.result.is_ok(), "{released:?}");
        let rest = released.rest;
        let wanted = if stage_goes { Rest::Coasts } else { Rest::Stands };
        assert_eq!(rest, wanted, "{} rpm", world.speed());
        assert_eq!(world.speed().abs() > 100.0, stage_goes, "{} rpm", world.speed());
    }
}

/// A Vacon at a line carries no id in its parameter channel: the state comes from the status word in its replies.
#[test]
fn a_vacon_at_a_line_is_seen_by_its_replies() {
    for transport in [Transport::Fc, Transport::Uss] {
        let world = World::new(&model::VACON, transport, 7);
        let (mut session, mut drive) = world.client("vacon", transport, 1).expect("found");
        let snapshot = session.snapshot(&mut drive, &[]).wait().expect("read");
        assert_eq!(snapshot.zsw1.map(|word| word & 0x0004), Some(0), "{snapshot:?}");
        set(&world, "ID733=0");
        kill_client(&world, "vacon", transport, 600.0);
        world.pass(SECOND * 2);
        let (mut session, mut drive) = world.client("vacon", transport, 2).expect("found");
        let snapshot = session.snapshot(&mut drive, &[]).wait().expect("read");
        assert_eq!(snapshot.zsw1.map(|word| word & 0x0007), Some(7), "{snapshot:?}");
        let status = session.status(&mut drive).wait().expect("read");
        assert_eq!(status.state(), Some(profile::state::State::S4));
        // 600 of 1500 rpm; the reference is not among what the line carries
        let near = |percent: Option<f64>| percent.is_some_and(|percent| (39.0..41.0).contains(&percent));
        assert!(
            status.speed_actual.is_none() && near(status.speed_percent),
            "{status:?}"
        );
        let found = diagnose(&status);
        assert_eq!(found.cause, Cause::TurnsOwnerless);
        assert!(found.sentence.contains("% of its reference"), "{found:?}");
        let speed = snapshot.speed_actual.expect("in every reply");
        assert!(speed.unit == "%" && near(speed.number()), "{speed:?}");
        let begin = session.now();
        let outcome = session
            .stop_drive(&mut drive, StopWay::Stop, SECOND * 10)
            .wait()
            .expect("stopped");
        assert!(outcome.sent && outcome.at_rest, "{outcome:?}");
        assert!(session.now() - begin > SECOND, "it waits for the ramp");
        assert!(world.speed().abs() < 1.0, "{}", world.speed());
        // nothing is sent to one that stands
        let again = session
            .stop_drive(&mut drive, StopWay::Stop, SECOND)
            .wait()
            .expect("looked at");
        assert!(!again.sent && again.at_rest, "{again:?}");
    }
}

/// A value of the unit is not needed to stop: neither a reference nor a speed in rpm.
#[test]
fn percent_is_enough() {
    let world = World::new(&model::VACON, Transport::Uss, 7);
    let (mut session, mut drive) = world.client("vacon", Transport::Uss, 1).expect("found");
    let wanted = AxisSettings {
        unit: SpeedUnit::Percent,
        speed_limit: 100.0,
        ..running_on(Purpose::Speed)
    };
    let mut axis = session.take_axis(&mut drive, wanted).wait().expect("free");
    axis.enable()
        .wait()
        .expect("enabled")
        .run(40.0)
        .wait()
        .expect("runs");
    axis.release().wait().expect("at rest");
}

/// The loss reaction is a setting: written, it is read back as what it does.
#[test]
fn the_remedy_of_a_drive_that_keeps_turning_works() {
    for (virtual_model, name, setting) in KEEP_TURNING {
        let world = World::new(virtual_model, Transport::Profinet, 7);
        set(&world, setting);
        let (mut session, mut drive) = world.client(name, Transport::Profinet, 1).expect("found");
        let remedy = session.loss_reaction(&mut drive).wait().expect("read").remedy;
        let Some(Action::Write { parameter, value }) = remedy.map(|remedy| remedy.action) else {
            panic!("{name}: no parameter");
        };
        write(&mut session, &mut drive, &format!("{parameter}={value}"));
        let after = session.loss_reaction(&mut drive).wait().expect("read");
        assert!(
            after.action.stops() && after.remedy.is_none(),
            "{name}: {after:?}"
        );
    }
}

fn write(session: &mut On<World>, drive: &mut Drive, text: &str) {
    let outcomes = session
        .write(drive, &[text.parse().expect("an assignment")], WriteMode::Write)
        .wait()
        .expect("written");
    assert!(outcomes.changes()[0].step.is_written(), "{outcomes:?}");
}

/// A fault that came after the last look of the caller is no regular end; one that the caller knows is.
#[test]
fn a_fault_during_the_stop_is_reported_once() {
    let is_fault = |error: &Error| {
        let trouble = Trouble::Fault;
        matches!(error, Error::Axis { trouble: found, .. } if *found == trouble)
    };
    for transport in [Transport::Profinet, Transport::Fc, Transport::Uss] {
        for known in [false, true] {
            let world = World::new(&model::AKD, transport, 7);
            let (mut session, mut drive) = world.client("akd", transport, 1).expect("found");
            let wanted = settings(&drive, Purpose::Speed);
            let mut axis = session.take_axis(&mut drive, wanted).wait().expect("free");
            let mut enabled = axis.enable().wait().expect("enabled");
            enabled.reach_speed(600.0, None).wait().expect("runs");
            world.look(|drive| drive.inject("fault=703".parse().expect("an injection")));
            if known {
                let error = enabled.keep_speed(600.0, SECOND).wait().expect_err("a fault");
                assert!(is_fault(&error), "{transport:?}: {error}");
            }
            drop(enabled);
            let released = axis.release().wait();
            // it may still coast, which is another error
            let reported = released.as_ref().is_err_and(is_fault);
            assert!(reported != known, "{transport:?}, known {known}: {released:?}");
        }
    }
}
