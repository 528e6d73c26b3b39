//! A drive at work is not reset: a controller, a power stage that is on, an axis that turns. In virtual time.

use std::time::Duration;

use profidrive_client::{AtWork, Drive, Error, Wait, WriteMode};
use testbench::{Bench, bench, bench_of, find, other_controller, select, station, with_drive};

/// ResetToFactory of the application data.
const APPLICATION: u8 = 1;

fn write(session: &mut Bench, drive: &mut Drive, text: &str) {
    let assignments: Vec<_> = text
        .split(' ')
        .map(|one| one.parse().expect("an assignment"))
        .collect();
    let outcomes = session
        .write(drive, &assignments, WriteMode::Write)
        .wait()
        .expect("reached");
    assert!(outcomes.is_done(), "{outcomes:?}");
}

fn acceleration(session: &mut Bench, drive: &mut Drive) -> Option<f64> {
    let selection = select(drive, "DRV.ACC");
    session.read_one(drive, &selection).wait().expect("read").number()
}

/// What keeps it from being reset; its parameters are as they were.
fn refused(session: &mut Bench, drive: &mut Drive) -> AtWork {
    let error = session.reset(drive, APPLICATION).wait().expect_err("at work");
    assert_eq!(acceleration(session, drive), Some(7000.0), "{error}");
    let works = match error {
        Error::AtWork { works, .. } => Some(works),
        _ => None,
    };
    works.expect("the reason")
}

#[test]
fn a_drive_that_is_on_or_turns_is_not_reset() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, "DRV.ACC=7000 DRV.CMDSOURCE=0 DRV.EN=1");
    assert_eq!(refused(&mut session, &mut drive), AtWork::Enabled);
    // off, with a load that pulls at it
    write(&mut session, &mut drive, "DRV.DIS=1");
    with_drive(&session, ids[0], |drive| {
        drive.inject("load=0.5Nm".parse().expect("a load"));
    });
    session
        .pass(Duration::from_millis(200))
        .wait()
        .expect("time passes");
    assert!(matches!(refused(&mut session, &mut drive), AtWork::Turns(_)));
    // a name does not touch the axis
    session.check_unowned(&drive, "renamed").wait().expect("no owner");
    session.reset_at_work(&drive, APPLICATION).wait().expect("forced");
    assert_eq!(acceleration(&mut session, &mut drive), Some(3000.0));
}

#[test]
fn a_drive_with_a_controller_is_neither_reset_nor_renamed() {
    let (plc, _) = other_controller();
    let (mut session, _) = bench_of(vec![station("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, "DRV.ACC=7000");
    session.check_idle(&mut drive, "reset").wait().expect("no owner");
    session.medium().segment_mut().attach(plc);
    session.pass(Duration::from_secs(3)).wait().expect("it connects");
    assert_eq!(
        refused(&mut session, &mut drive),
        AtWork::Controller("plc".into())
    );
    let error = session
        .check_unowned(&drive, "renamed")
        .wait()
        .expect_err("in use");
    assert_eq!(
        error.to_string(),
        "akd-1 is not renamed: controller \"plc\" is running it"
    );
}

/// What cannot be asked is reset: that may be the way to reach it again.
#[test]
fn a_drive_that_does_not_answer_is_reset() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, "DRV.ACC=7000");
    drive.station.ip = profinet::IpSuite::NONE;
    session.reset(&mut drive, APPLICATION).wait().expect("reset");
}
