//! Checking a motion as far as reading can.

use client::status::{Verdict, diagnose};
use client::{AxisPlan, AxisSettings, Drive, Error, Session};
use profile::state::Mode;

use super::error::MotionError;
use super::event::{Event, Observer};
use super::plan::Telegrams;

/// Checks what taking the axis and enabling it would meet: the controller of the drive, its mode, the telegram, and what holds
/// it back. Reads only. The drive would be put into mode `set_mode` where it is in another one.
pub(super) async fn checked_axis(
    session: &mut Session,
    drive: &mut Drive,
    settings: &AxisSettings,
    set_mode: Option<Mode>,
    observer: &Observer,
) -> Result<(Option<AxisPlan>, Telegrams), MotionError> {
    let plan = match (session.plan_axis(drive, settings).await, set_mode) {
        (Err(Error::WrongMode { .. }), Some(mode)) => {
            session.check_control(drive).await?;
            observer.report(&Event::ModeWouldChange(mode));
            None
        }
        (other, _) => Some(other?),
    };
    let status = session.status(drive).await?;
    let diagnosis = diagnose(&status);
    if diagnosis.verdict == Verdict::Held {
        return Err(MotionError::Held {
            drive: drive.label(),
            diagnosis: Box::new(diagnosis),
        });
    }
    let telegrams = Telegrams {
        telegram: plan.as_ref().map(|plan| plan.telegram),
        telegram_before: plan.as_ref().and_then(|plan| plan.telegram_before),
    };
    Ok((plan, telegrams))
}
