//! The mode that a motion needs, for its time.

use client::{Drive, Error, ModeChange, PutBack, Session};
use profile::state::Mode;

use super::Control;
use super::event::{Event, Observer, Setting};

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

/// Puts mode and telegram back, whatever became of the motion.
pub(super) async fn leave(change: Option<ModeChange>, observer: &Observer) {
    let Some(change) = change else { return };
    let done = match change.put_back().await {
        Ok(done) => done,
        Err(error) => {
            observer.report(&Event::NotPutBack {
                setting: None,
                cause: error.to_string(),
            });
            return;
        }
    };
    for PutBack { value, result } in done {
        let number = value.raw().and_then(|raw| u16::try_from(raw & 0xFFFF).ok());
        let setting = Setting::Number {
            pnu: value.pnu,
            value: number.unwrap_or_default(),
        };
        observer.report(&match result {
            Ok(()) => Event::PutBack(setting),
            Err(error) => Event::NotPutBack {
                setting: Some(setting),
                cause: error.to_string(),
            },
        });
    }
}
