//! Reports of an axis under control: virtual drives on a segment, in virtual time.

use std::time::Duration;
use testbench::shared::Shared;

use profidrive_client::axis::{Move, Objection, Purpose};
use profidrive_client::{AxisSettings, Error, Wait, WriteMode};
use profile::notation::Position;
use profile::value::{Assignment, ParameterProblem};
use testbench::{bench, find, is_at_rest, with_drive};
use virtual_drive::drive::Injection;

/// A warning is reported by number when it comes, once, also one that comes while another is there.
#[test]
fn warnings_are_reported_when_they_occur() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    with_drive(&session, ids[0], |drive| {
        drive.inject(Injection::Warning { number: 107 });
    });
    let reports = Shared::new(Vec::new());
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    let sink = reports.clone();
    axis.watch_warnings(move |status, warnings| {
        let numbers: Vec<u32> = warnings.iter().map(|warning| warning.number).collect();
        let words = warnings.iter().all(|warning| warning.meaning.is_some());
        assert!(words, "{warnings:?}");
        sink.borrow_mut().push((status.time.as_secs(), numbers));
    });
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(60.0, None).wait().expect("runs");
    enabled
        .keep_speed(60.0, Duration::from_secs(5))
        .wait()
        .expect("keeps it");
    assert_eq!(*reports.borrow(), [(0, vec![107])]);
    drop(enabled);
    axis.release().wait().expect("released");
    assert_eq!(reports.borrow().len(), 1, "not again: {reports:?}");
    assert!(is_at_rest(&session, ids[0]));
}

/// A dry run finds what a run would: telegram, rounded speed, a controller that has the drive. It changes nothing.
#[test]
fn taking_an_axis_can_be_planned() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let assignment: Assignment = "922=9".parse().expect("an assignment");
    session
        .write(&mut drive, &[assignment], WriteMode::Write)
        .wait()
        .expect("telegram 9");
    let plan = session
        .plan_axis(&mut drive, &AxisSettings::default())
        .wait()
        .expect("possible");
    assert_eq!((plan.telegram, plan.telegram_before), (1, Some(9)));
    let rounded = plan.rounded_speed_for(&drive, 61.7).expect("near enough");
    assert!((rounded - 61.88).abs() < 0.01, "{rounded}");
    let again = session.plan_axis(&mut drive, &AxisSettings::default()).wait();
    let before = again.expect("still possible").telegram_before;
    assert_eq!(before, Some(9), "as it was");
    let error = session
        .plan_axis(&mut drive, &AxisSettings::for_purpose(Purpose::Move))
        .wait()
        .expect_err("velocity mode");
    assert!(matches!(error, Error::WrongMode { .. }), "{error}");
    let long = AxisSettings {
        watchdog: Some(255),
        ..AxisSettings::default()
    };
    let error = session.plan_axis(&mut drive, &long).wait().expect_err("4 s");
    assert!(error.to_string().contains("1 to 120 are possible"), "{error}");
    let axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    assert_eq!(axis.rounded_speed(61.7), Some(rounded));
    axis.release().wait().expect("released");
    assert!(is_at_rest(&session, ids[0]));
}

/// Nothing is sent that would be another speed: neither a standstill nor one that is more than a tenth away.
#[test]
fn speeds_that_are_not_representable_are_refused() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    for (rpm, below, above) in [(0.001, 0.0, 0.366), (-0.1, -0.366, 0.0), (0.5, 0.366, 0.732)] {
        let error = session
            .check_speed(&mut drive, rpm)
            .wait()
            .expect_err("no such speed");
        let Error::SpeedStep { nearest, .. } = &error else {
            panic!("{error}")
        };
        assert!(
            (nearest[0] - below).abs() < 1e-3 && (nearest[1] - above).abs() < 1e-3,
            "{error}"
        );
    }
    for rpm in [0.0, 0.366, 99.0, -60.0] {
        session.check_speed(&mut drive, rpm).wait().expect("near enough");
    }
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    let mut enabled = axis.enable().wait().expect("enabled");
    assert!(matches!(enabled.run(0.5).wait(), Err(Error::SpeedStep { .. })));
    drop(enabled);
    axis.release().wait().expect("released");
    assert!(is_at_rest(&session, ids[0]));
}

#[test]
fn distances_that_are_none_are_refused() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let order = Move::by(Position::Turns(1e-6), 300.0);
    let plan = session
        .plan_move(&mut drive, &order, 3000.0)
        .wait()
        .expect("a plan");
    assert!(
        plan.objections
            .iter()
            .any(|one| matches!(one, Objection::NoDistance { .. })),
        "{plan:?}"
    );
}

/// What a drive cannot hold within a hundredth is not written, and nothing beside it.
#[test]
fn values_that_cannot_be_held_are_refused_before_anything_is_sent() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let write = |text: &str| -> Vec<Assignment> {
        text.split(' ')
            .map(|one| one.parse().expect("an assignment"))
            .collect()
    };
    let error = session
        .write(&mut drive, &write("DRV.ACC=5000 1004=0.001rpm"), WriteMode::Write)
        .wait()
        .expect_err("too small");
    assert!(
        matches!(error, Error::Parameter(ParameterProblem::Coarse { .. })),
        "{error}"
    );
    let selection = drive
        .parameters
        .select(&"DRV.ACC".parse().expect("a name"))
        .expect("known");
    let kept = session.read_one(&mut drive, &selection).wait().expect("read");
    assert_eq!(kept.number(), Some(3000.0));
    let outcomes = session
        .write(&mut drive, &write("1004=99rpm"), WriteMode::Write)
        .wait()
        .expect("written");
    let change = &outcomes.changes()[0];
    assert!(change.rounding.unwrap().is_rounded() && change.is_done());
}
