//! Acknowledging faults by the control word or by a parameter.

use std::time::Duration;

use client::axis::Purpose;
use client::status::{Cause, Note, diagnose};
use client::{Drive, Error, FaultEntry, Session, WriteMode};
use profile::catalogue::Role;
use profile::state::Zsw1;
use profile::value::Assignment;

use super::Control;
use super::axis::Taken;
use super::error::{End, MotionError};
use super::event::{Ended, Event, Observer};
use super::report::{MotionResult, Report};
use super::start::Start;
use crate::report::Fault;

/// Acknowledges the faults of a drive by an edge of STW1 bit 7. Enables nothing. Where there is none, control of the axis is
/// not taken, which is in the report.
///
/// # Errors
/// When no command clears what is present, when a fault stays, and when the axis cannot be taken.
pub async fn acknowledge(
    session: &mut Session,
    drive: &mut Drive,
    control: &Control,
    observer: &Observer,
) -> Result<Report, MotionError> {
    match session.fault_report(drive).await {
        Ok(report) => {
            // a drive that does not report its faults so may have one anyway
            let bit = report.zsw1.is_none_or(|word| Zsw1(word).has(Zsw1::FAULT));
            let present: Vec<FaultEntry> = report.present().cloned().collect();
            if present.is_empty() && !bit {
                return Ok(without_control(false, Vec::new(), observer));
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
    let mut taken = Taken::begin(axis, End::Time, Start::Acknowledge, false, observer).await?;
    let result = match taken.axis.ready_or_fault().await {
        Ok(()) => taken.axis.acknowledge().await,
        Err(error) => Err(error),
    };
    let found = MotionResult {
        reached: result.is_ok(),
        acknowledged: Some(true),
        ..MotionResult::default()
    };
    let done = taken.finish(result, found).await;
    done.report(Vec::new(), observer, (session, drive)).await
}

/// How long a drive may take to clear its faults, and how often that is looked at.
const CLEAR_TIMEOUT: Duration = Duration::from_secs(1);
const GLANCE: Duration = Duration::from_millis(50);

/// Acknowledges the faults of a drive by the parameter that it has for that, beside the controller that has it.
///
/// # Errors
/// When the drive has no such parameter or refuses it, and when a fault stays.
pub async fn acknowledge_by_parameter(
    session: &mut Session,
    drive: &mut Drive,
    observer: &Observer,
) -> Result<Report, MotionError> {
    let command = drive
        .model
        .catalogue
        .and_then(|tables| tables.with_role(Role::ClearFaults))
        .ok_or_else(|| MotionError::NoClearParameter {
            drive: drive.label(),
            model: drive.model.name,
        })?;
    let before = session.faults(drive).await?;
    let present = before.into_iter().filter(|fault| fault.situation == 0);
    observer.report(&Event::Faults(present.collect()));
    observer.report(&Event::Clearing {
        parameter: command.name,
        pnu: command.pnu,
    });
    let assignment = Assignment::of(command, 1);
    let set = session.write(drive, &[assignment], WriteMode::Write).await?;
    set.accepted()?;
    // the drive takes the command in its own time
    let end = session.now() + CLEAR_TIMEOUT;
    let left: Vec<FaultEntry> = loop {
        let report = session.fault_report(drive).await?;
        let left: Vec<FaultEntry> = report.present().cloned().collect();
        if left.is_empty() || session.now() >= end {
            break left;
        }
        session.pass(GLANCE).await?;
    };
    let report = without_control(true, left.iter().map(Fault::from).collect(), observer);
    if left.is_empty() {
        return Ok(report);
    }
    let status = session.status(drive).await?;
    let moves = |note: &Note| note.id == Cause::MovedExternally.id();
    Err(MotionError::FaultsStay {
        drive: drive.label(),
        faults: left,
        moved: diagnose(&status).notes.into_iter().find(moves).map(Box::new),
    })
}

/// The end of an acknowledgement for which control of the axis was not taken.
fn without_control(acknowledged: bool, faults: Vec<Fault>, observer: &Observer) -> Report {
    let result = MotionResult {
        reached: faults.is_empty(),
        acknowledged: Some(acknowledged),
        faults,
        ..MotionResult::default()
    };
    let report = Report {
        result,
        ..Report::default()
    };
    observer.report(&Event::Ended(Box::new(Ended {
        report: report.clone(),
        ..Ended::default()
    })));
    report
}
