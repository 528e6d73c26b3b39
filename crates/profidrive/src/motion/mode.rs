//! The mode that a motion needs, for its time.

use client::{Drive, Error, ModeChange, PutBack, Session};
use profile::state::Mode;

use super::Control;
use super::axis::{Done, Restored};
use super::error::MotionError;
use super::event::{Event, Observer, Setting};
use super::report::Report;

/// Puts the drive into the mode that is needed, where the caller allows that. What this returns puts mode and telegram back, also when it is
/// dropped.
pub(super) async fn enter(
    session: &mut Session,
    drive: &mut Drive,
    needed: Mode,
    control: &Control,
    observer: &Observer,
) -> Result<Option<ModeChange>, Error> {
    drive.check_able(Some(needed))?;
    if !control.set_mode {
        return Ok(None);
    }
    // a drive that will be refused is left as it is
    session
        .loss_reaction(drive)
        .await?
        .permit(drive, control.may_run_on)?;
    let change = session.enter_mode(drive, needed).await?;
    if change.changed {
        observer.report(&Event::ModeChanged {
            before: change.before,
            now: needed,
        });
    }
    Ok(Some(change))
}

/// Carries out a motion in the mode that it needs. Mode and telegram are put back, whatever became of it.
///
/// [`hold`](super::hold) and [`step`](super::step) enter and leave by themselves: a held axis keeps the mode beyond the call, and a step
/// returns samples beside its report, also when it fails.
pub(super) async fn during<W>(
    (session, drive): (&mut Session, &mut Drive),
    (needed, control): (Mode, &Control),
    wanted: &W,
    observer: &Observer,
    motion: impl AsyncFnOnce(&mut Session, &mut Drive, &W, &Observer) -> Result<Done, MotionError>,
) -> Result<Report, MotionError> {
    let change = enter(session, drive, needed, control, observer).await?;
    let result = motion(session, drive, wanted, observer).await;
    let restored = leave(change, observer).await;
    result?.report(restored, observer, (session, drive)).await
}

/// Puts mode and telegram back, whatever became of the motion.
pub(super) async fn leave(change: Option<ModeChange>, observer: &Observer) -> Vec<Restored> {
    let Some(change) = change else {
        return Vec::new();
    };
    let restored = match change.put_back().await {
        Ok(done) => done.into_iter().map(restored).collect(),
        Err(error) => vec![Restored {
            setting: None,
            result: Err(error.to_string()),
        }],
    };
    restored
        .into_iter()
        .map(|one: Restored| one.reported(observer))
        .collect()
}

fn restored(PutBack { value, result }: PutBack) -> Restored {
    let number = value.raw().and_then(|raw| u16::try_from(raw & 0xFFFF).ok());
    Restored {
        setting: Some(Setting::Number {
            pnu: value.pnu,
            value: number.unwrap_or_default(),
        }),
        result: result.map_err(|error| error.to_string()),
    }
}
