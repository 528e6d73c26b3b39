//! A mode for one piece of work: what that changes at the drive is put back, however the work ends. In virtual time.

use std::time::Duration;
use testbench::shared::Shared;

use network::host::StationId;
use profidrive_client::axis::{Jog, Purpose};
use profidrive_client::{AxisSettings, Drive, Error, Wait, WriteMode};
use profile::state::Mode;
use testbench::{Bench, bench, find, is_at_rest, select, with_drive};

/// How the work ends.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    Well,
    Fault,
    CtrlC,
    /// It was never begun.
    Refused,
}

fn settings_of(session: &mut Bench, drive: &mut Drive) -> Vec<i64> {
    let read = |text: &str| {
        let selection = select(drive, text);
        session.read_one(drive, &selection).wait().expect("read").raw()
    };
    [
        "930",
        "922",
        "915[0]",
        "915[1]",
        "915[2]",
        "916[1]",
        "916[2]",
        "DRV.CMDSOURCE",
    ]
    .map(read)
    .into_iter()
    .map(|raw| raw.expect("a number"))
    .collect()
}

fn telegram(session: &mut Bench, drive: &mut Drive) -> i64 {
    settings_of(session, drive)[1]
}

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

fn home(session: &mut Bench, drive: &mut Drive, id: StationId, end: End) -> Result<(), Error> {
    if end == End::Refused {
        return Err(Error::Interrupted);
    }
    let mut axis = session
        .take_axis(drive, AxisSettings::for_purpose(Purpose::Home))
        .wait()?;
    assert_eq!(axis.telegram(), 9);
    let result = axis.enable().wait().and_then(|mut enabled| {
        if end == End::Fault {
            with_drive(session, id, |drive| {
                drive.inject_fault(439, false);
            });
        }
        enabled.home(Some(Duration::from_secs(5))).wait()
    });
    let released = axis.release().wait();
    result.and(released)
}

#[test]
fn mode_telegram_and_mapping_are_put_back_however_the_work_ends() {
    let free = "922=0 915[0]=1 915[1]=5 916[0]=2 916[1]=6 916[2]=28";
    for before in ["922=1", "922=350", free] {
        for end in [End::Well, End::Fault, End::CtrlC, End::Refused] {
            let (mut session, ids) = bench(&[("akd-1", 1)]);
            let stop = Shared::new(false);
            let mut drive = find(&mut session, "akd-1").expect("there");
            write(&mut session, &mut drive, before);
            let settings = settings_of(&mut session, &mut drive);
            let entered = session
                .enter_mode(&mut drive, Mode::Position)
                .wait()
                .expect("its mode");
            assert!(entered.changed && entered.before == Some(Mode::Velocity));
            let (interrupted, enabled) = (stop.clone(), Shared::new(0));
            session.interrupt_with(move || {
                enabled.set(enabled.get() + 1);
                end == End::CtrlC && enabled.get() > 40 || interrupted.get()
            });
            let result = home(&mut session, &mut drive, ids[0], end);
            assert_eq!(result.is_ok(), end == End::Well, "{before} {end:?}: {result:?}");
            // the wish to stop is still there
            stop.set(true);
            let done = entered.put_back().wait().expect("put back");
            stop.set(false);
            session.interrupt_with(|| false);
            assert!(
                done.iter().all(|one| one.result.is_ok()),
                "{before} {end:?}: {done:?}"
            );
            assert_eq!(
                settings_of(&mut session, &mut drive),
                settings,
                "{before} {end:?}"
            );
            assert!(is_at_rest(&session, ids[0]));
        }
    }
}

/// The telegram is put back too where the mode was the one needed.
#[test]
fn the_telegram_is_put_back_where_the_mode_was_right_already() {
    let (mut session, _) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    write(&mut session, &mut drive, "930=2 922=7");
    let entered = session
        .enter_mode(&mut drive, Mode::Position)
        .wait()
        .expect("its mode");
    assert!(!entered.changed);
    let settings = AxisSettings {
        telegram: Some(9),
        ..AxisSettings::for_purpose(Purpose::Move)
    };
    let axis = session.take_axis(&mut drive, settings).wait().expect("connected");
    axis.release().wait().expect("released");
    assert_eq!(telegram(&mut session, &mut drive), 9);
    let done = entered.put_back().wait().expect("put back");
    assert_eq!(
        done.iter()
            .map(|one| (one.value.pnu, one.value.raw()))
            .collect::<Vec<_>>(),
        [(922, Some(7))]
    );
    assert_eq!(telegram(&mut session, &mut drive), 7);
}

/// After homing for once a drive in velocity mode jogs as before.
#[test]
fn a_drive_that_was_homed_for_once_jogs_afterwards() {
    let (mut session, ids) = bench(&[("akd-1", 1)]);
    let mut drive = find(&mut session, "akd-1").expect("there");
    let entered = session
        .enter_mode(&mut drive, Mode::Position)
        .wait()
        .expect("its mode");
    home(&mut session, &mut drive, ids[0], End::Well).expect("homed");
    entered.put_back().wait().expect("put back");
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::for_purpose(Purpose::Jog))
        .wait()
        .expect("connected");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.jog(Jog::One).wait().expect("jogs");
    enabled.hold(Duration::from_secs(1)).wait().expect("goes on");
    assert!(
        enabled
            .status()
            .and_then(|status| status.speed_actual)
            .is_some_and(|speed| speed > 50.0)
    );
    drop(enabled);
    axis.release().wait().expect("released");
}
