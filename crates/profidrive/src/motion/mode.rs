//! The mode that a motion needs, for its time.

use client::{Drive, Error, ModeBefore, PutBack, Session};
use profile::state::Mode;

use super::Control;
use super::event::{Event, Observer, Setting};

/// Puts the drive into the mode that is needed, where the caller allows that; what is to be put back.
pub(super) async fn enter(
    session: &mut Session,
    drive: &mut Drive,
    needed: Mode,
    control: &Control,
    observer: &Observer,
) -> Result<Option<ModeBefore>, Error> {
    drive.check_able(Some(needed))?;
    if !control.set_mode {
        return Ok(None);
    }
    // a drive that will be refused is left as it is
    session
        .loss_reaction(drive)
        .await?
        .permit(drive, control.may_run_on)?;
    let before = session.enter_mode(drive, needed).await?;
    if before.changed {
        observer.report(&Event::ModeChanged {
            before: before.mode,
            now: needed,
        });
    }
    Ok(Some(before))
}

/// Puts mode and telegram back, whatever became of the motion.
pub(super) async fn leave(
    session: &mut Session,
    drive: &mut Drive,
    before: Option<ModeBefore>,
    observer: &Observer,
) {
    let Some(before) = before else { return };
    let done = match session.leave_mode(drive, &before).await {
        Ok(done) => done,
        Err(error) => {
            observer.report(&Event::NotPutBack {
                setting: None,
                cause: error.to_string(),
            });
            return;
        }
    };
    for PutBack {
        number: pnu,
        value,
        result,
    } in done
    {
        let setting = Setting::Number { pnu, value };
        observer.report(&match result {
            Ok(()) => Event::PutBack(setting),
            Err(error) => Event::NotPutBack {
                setting: Some(setting),
                cause: error.to_string(),
            },
        });
    }
}
