//! What a drive can say against a motion is asked before its power stage is on. In virtual time.

use std::time::Duration;

use profidrive_client::axis::{Jog, Objection, Purpose};
use profidrive_client::{AxisSettings, Drive, Error, Wait, WriteMode};
use testbench::{Bench, bench, find, with_drive};

fn write(session: &mut Bench, drive: &mut Drive, text: &str) {
    for text in text.split(' ') {
        let assignment = text.parse().expect("an assignment");
        let outcomes = session
            .write(drive, &[assignment], WriteMode::Write)
            .wait()
            .expect("reached");
        assert!(outcomes.accepted().is_ok(), "{outcomes:?}");
    }
}

fn objections(result: Result<(), Error>) -> Vec<Objection> {
    let found = match result {
        Ok(()) => Some(Vec::new()),
        Err(Error::Objections { objections, .. }) => Some(objections),
        Err(_) => None,
    };
    found.expect("nothing but objections")
}

fn home(session: &mut Bench, drive: &mut Drive) {
    let mut axis = session
        .take_axis(drive, AxisSettings::for_purpose(Purpose::Home))
        .wait()
        .expect("connected");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.home(Some(Duration::from_secs(5))).wait().expect("homed");
    drop(enabled);
    axis.release().wait().expect("released");
}

/// An axis that is not homed, a task that is not there: known from status word and table, without a connection.
#[test]
fn a_task_is_checked_before_the_client_takes_control() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, "930=2");
    let (not_homed, empty) = (Objection::NotHomed, |number| Objection::NoTask { number });
    assert_eq!(
        objections(session.check_task(&mut drive, 3).wait()),
        [not_homed, empty(3)]
    );
    home(&mut session, &mut drive);
    assert_eq!(objections(session.check_task(&mut drive, 3).wait()), [empty(3)]);
    assert_eq!(
        objections(session.check_task(&mut drive, 200).wait()),
        [empty(200)]
    );
    write(
        &mut session,
        &mut drive,
        "MT.NUM=3 MT.P=65536 MT.V=60 MT.ACC=3000 MT.DEC=3000 MT.CNTL=0 MT.SET=1",
    );
    session.check_task(&mut drive, 3).wait().expect("there is one");
    assert_eq!(objections(session.check_task(&mut drive, 4).wait()), [empty(4)]);
}

/// Whatever telegram the drive has: a jog turns the axis, in both modes.
#[test]
fn a_jog_turns_with_every_telegram_the_drive_had() {
    for (mode, telegrams) in [
        ("930=1", [1, 7, 9, 350, 351, 352, 353, 354]),
        ("930=2", [1, 7, 9, 350, 351, 352, 353, 354]),
    ] {
        for telegram in telegrams {
            let (mut session, _) = bench(&[("akd-1", 1)]);
            let mut drive = find(&mut session, "akd-1").expect("there");
            write(&mut session, &mut drive, &format!("{mode} 922={telegram}"));
            let mut axis = session
                .take_axis(&mut drive, AxisSettings::for_purpose(Purpose::Jog))
                .wait()
                .expect("connected");
            let used = axis.telegram();
            let mut enabled = axis.enable().wait().expect("enabled");
            enabled
                .jog(Jog::One)
                .wait()
                .unwrap_or_else(|error| panic!("{mode} {telegram}: {error}"));
            enabled.hold(Duration::from_secs(1)).wait().expect("goes on");
            let turns = enabled.status().is_some_and(|status| status.view.turns);
            assert!(
                turns,
                "{mode}, telegram {telegram}: {used} is used and nothing turns"
            );
            drop(enabled);
            axis.release()
                .wait()
                .unwrap_or_else(|error| panic!("{mode} {telegram}: {error}"));
        }
    }
}

/// A limit switch in the way of a jog is a fact of the drive.
#[test]
fn an_active_limit_switch_is_detected() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    with_drive(&session, ids[0], |drive| {
        drive.inject("limit+=on".parse().expect("a switch"));
    });
    let facts = session.motion_facts(&mut drive).wait().expect("read");
    assert!(facts.is_at_switch(60.0) && !facts.is_at_switch(-60.0));
}
