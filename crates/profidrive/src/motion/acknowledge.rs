//! Acknowledging faults by the control word.

use client::axis::Purpose;
use client::{Drive, Error, FaultEntry, Session};
use profile::state::Zsw1;

use super::Control;
use super::axis::Taken;
use super::error::{End, MotionError};
use super::event::{Event, Observer, Start};
use super::report::{MotionResult, Report};

/// What became of faults that were to be acknowledged.
#[derive(Debug, Clone, PartialEq)]
pub enum Acknowledged {
    /// There was none; nothing was sent.
    None,
    /// The faults are gone.
    Done(Box<Report>),
}

/// Acknowledges the faults of a drive by an edge of STW1 bit 7. Enables nothing.
///
/// # Errors
/// When no command clears what is present, when a fault stays, and when the axis cannot be taken.
pub async fn acknowledge(
    session: &mut Session,
    drive: &mut Drive,
    control: &Control,
    observer: &Observer,
) -> Result<Acknowledged, MotionError> {
    match session.fault_report(drive).await {
        Ok(report) => {
            // a drive that does not report its faults so may have one all the same
            let bit = report.zsw1.is_none_or(|word| Zsw1(word).has(Zsw1::FAULT));
            let present: Vec<FaultEntry> = report.present().cloned().collect();
            if present.is_empty() && !bit {
                return Ok(Acknowledged::None);
            }
            observer.report(&Event::Faults(present));
            if report.needs_restart() {
                return Err(MotionError::NeedsRestart { drive: drive.label() });
            }
        }
        Err(error @ (Error::Refused { .. } | Error::Changing { .. })) => {
            observer.report(&Event::FaultsUnreadable(error.to_string()));
        }
        Err(error) => return Err(error.into()),
    }
    let axis = session
        .take_axis(drive, control.settings(Purpose::Control, 0.0))
        .await?;
    let mut taken = Taken::begin(axis, End::Time, Start::Acknowledge, false, observer);
    let result = match taken.axis.ready_or_fault().await {
        Ok(()) => taken.axis.acknowledge().await,
        Err(error) => Err(error),
    };
    let found = MotionResult {
        reached: result.is_ok(),
        ..MotionResult::default()
    };
    let report = taken.finish(result, found, (session, drive)).await?;
    Ok(Acknowledged::Done(Box::new(report)))
}
