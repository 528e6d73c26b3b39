//! Motion of every model: telegrams, speeds, jogs, stops.

use super::*;
use profidrive_client::Wait;

#[test]
fn every_model_runs_and_reports_its_speed() {
    let mut session = all_models();
    for name in NAMES {
        let mut drive = find(&mut session, name).expect("there");
        let before = diagnose(&session.status(&mut drive).wait().expect("a status"));
        assert_eq!(before.cause.id(), "no-controller", "{name}: {before:?}");
        let mut axis = session
            .take_axis(&mut drive, running_on(Purpose::Speed))
            .wait()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut enabled = axis
            .enable()
            .wait()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        enabled
            .reach_speed(600.0, None)
            .wait()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        enabled.hold(Duration::from_millis(500)).wait().expect("it runs");
        let status = enabled.status().expect("a status");
        let speed = status.speed_actual.expect("a speed");
        assert!((speed - 600.0).abs() < 20.0, "{name}: {speed}");
        drop(enabled);
        axis.stopped().wait().expect("along its ramp");
        {
            let (session, drive) = axis.session();
            let status = session.status(drive).wait().expect("a status");
            assert_eq!(status.state(), Some(State::S2), "{name}: {status:?}");
            let snapshot = session.snapshot(drive, &[]).wait().expect("a snapshot");
            let speed = snapshot.speed_actual.expect("a speed");
            assert_eq!(speed.unit, "rpm", "{name}");
        }
        drop(axis);
        session.settle();
        let state = session.status(&mut drive).wait().expect("a status").state();
        assert!(!state.is_some_and(State::pulses), "{name}: {state:?}");
    }
}

/// Nothing is enabled for a function that the drive lacks; where PNU 930 is read-only the advice does not suggest
/// writing it.
#[test]
fn speed_drives_refuse_positions_before_anything_is_enabled() {
    let mut session = all_models();
    for name in &NAMES[1..] {
        let mut drive = find(&mut session, name).expect("there");
        for purpose in [Purpose::Home, Purpose::Task, Purpose::Move, Purpose::RealTimeJog] {
            let settings = running_on(purpose);
            let error = session.take_axis(&mut drive, settings).wait().map(|_| ());
            let error = error.expect_err("no positions");
            assert!(
                matches!(error, Error::SpeedOnly { .. }),
                "{name} {purpose:?}: {error}"
            );
            assert!(
                error
                    .advice()
                    .is_some_and(|advice| !advice.to_string().contains("930"))
            );
        }
        let error = session.check_mode(&mut drive, Mode::Position).wait();
        assert!(matches!(error, Err(Error::SpeedOnly { .. })), "{name}: {error:?}");
    }
    let mut drive = find(&mut session, NAMES[0]).expect("there");
    let error = session.check_mode(&mut drive, Mode::Position).wait();
    assert!(matches!(error, Err(Error::WrongMode { .. })), "{error:?}");
}

#[test]
fn vendor_telegrams_run_their_drives_at_the_same_speed() {
    let mut session = all_models();
    let with = |telegram| AxisSettings {
        telegram: Some(telegram),
        ..running_on(Purpose::Speed)
    };
    for (name, setting, telegrams) in [
        (
            "vlt-1",
            "8-10='FC profile'",
            &[101, 102, 104, 105, 106, 107, 108, 103, 1][..],
        ),
        ("vlt-1", "8-10='PROFIdrive profile'", &[101, 104]),
        ("vacon-1", "ID101=5Hz", &[148, 149, 150, 1]),
    ] {
        let mut drive = find(&mut session, name).expect("there");
        write(&mut session, &mut drive, setting, WriteMode::Write).expect("taken");
        for &number in telegrams {
            let (speed, used) = turned(&mut session, name, with(number), 900.0)
                .unwrap_or_else(|error| panic!("{name} {number}: {error}"));
            assert!((speed - 900.0).abs() < 30.0, "{name} {number}: {speed}");
            assert_eq!(used, number);
            // what is plugged is used by itself
            let (speed, used) = turned(&mut session, name, running_on(Purpose::Speed), 600.0)
                .unwrap_or_else(|error| panic!("{name} {number}: {error}"));
            assert!((speed - 600.0).abs() < 20.0, "{name} {number}: {speed}");
            assert_eq!(used, number, "{name}");
        }
    }
    let error = turned(&mut session, "vlt-1", with(999), 60.0).expect_err("no such telegram");
    assert_eq!(error.to_string(), "vlt-1 has no telegram 999");
    assert!(
        error
            .advice()
            .is_some_and(|advice| advice.to_string().contains("104")),
        "{error}"
    );
    let error = turned(&mut session, "akd-1", with(9), 60.0).expect_err("no speed in it");
    assert!(error.to_string().contains("carries what this needs"), "{error}");
}

#[test]
fn words_of_a_ppo_type_that_settings_choose_keep_their_parameters() {
    let mut session = all_models();
    let mut drive = find(&mut session, "vlt-1").expect("there");
    for setting in [
        "922=104",
        "915[2]=341",
        "915[3]=341",
        "915[4]=312",
        "341=7.5s",
        "312=25%",
    ] {
        write(&mut session, &mut drive, setting, WriteMode::Write)
            .unwrap_or_else(|error| panic!("{setting}: {error}"));
    }
    let settings = AxisSettings {
        telegram: Some(104),
        ..running_on(Purpose::Speed)
    };
    turned(&mut session, "vlt-1", settings, 300.0).expect("it turns");
    assert_eq!(number(&mut session, &mut drive, "3-41"), 7.5);
    assert_eq!(number(&mut session, &mut drive, "3-12"), 25.0);
}

#[test]
fn stop_refuses_a_converter_with_another_controller() {
    let mut session = all_models();
    for name in ["vlt-1", "vacon-1"] {
        let mut drive = find(&mut session, name).expect("there");
        let mut axis = session
            .take_axis(&mut drive, running_on(Purpose::Speed))
            .wait()
            .expect("free");
        let mut enabled = axis.enable().wait().expect("it starts");
        enabled.reach_speed(300.0, None).wait().expect("it runs");
        let (inner, own) = enabled.session();
        let error = inner
            .stop_drive(own, StopWay::Stop, Duration::from_secs(1))
            .wait()
            .expect_err("owned");
        assert!(
            error
                .to_string()
                .contains("no parameter that stops it, and controller \"client\""),
            "{error}"
        );
        assert!(
            error
                .advice()
                .is_some_and(|advice| advice.to_string().contains("at its controller")),
            "{error}"
        );
        drop(enabled);
        axis.release().wait().expect("released");
        let outcome = session
            .stop_drive(&mut drive, StopWay::Stop, Duration::from_secs(1))
            .wait();
        assert!(
            outcome.is_ok_and(|outcome| !outcome.sent && outcome.at_rest),
            "{name}"
        );
    }
}

/// Each model jogs at the speed of its own setting, which is reported.
#[test]
fn every_model_jogs_at_its_own_setting() {
    let mut session = all_models();
    for (name, label) in NAMES.into_iter().zip(["(p1004)", "(8-90)", "(ID 124)"]) {
        let mut drive = find(&mut session, name).expect("there");
        let setting = session.jog_speed(&mut drive, Jog::One).wait().expect("known");
        assert!(
            setting.selection.label().ends_with(label),
            "{}",
            setting.selection.label()
        );
        let reading = session
            .read_one(&mut drive, &setting.selection)
            .wait()
            .expect("answered");
        let speed = setting.rpm(&reading).expect("a speed");
        assert!(speed > 10.0, "{name}: {speed}");
        let settings = running_on(Purpose::Jog);
        let mut axis = session.take_axis(&mut drive, settings).wait().expect("connected");
        let mut enabled = axis.enable().wait().expect("enabled");
        enabled.jog(Jog::One).wait().expect("jogs");
        enabled.hold(Duration::from_secs(4)).wait().expect("goes on");
        let actual = enabled.status().and_then(|status| status.speed_actual);
        let near = actual.is_some_and(|actual| (actual - speed).abs() < speed * 0.06 + 2.0);
        assert!(near, "{name}: {actual:?} of {speed}");
        drop(enabled);
        axis.release().wait().expect("at rest");
    }
}
