//! The settings that a machine file wants of a drive, and the plan to write them.

use std::path::PathBuf;

use client::backup::{Backup, Header};
use client::change::{Plan, Skip};
use client::{AtWork, Drive, Error, Session};
use profile::value::{Assignment, Reading};

use super::Purpose;
use super::error::CommissionError;
use crate::machine::{Machine, MachineDrive};
use crate::settings::{self, Restore};

/// Settings that are to be written, and what that takes.
#[derive(Debug)]
pub struct PlannedSettings {
    /// The settings of the file and of its backup.
    pub wanted: Backup,
    /// How they are written.
    pub request: Restore,
    /// What is written.
    pub plan: Plan,
}

/// A setting of the file with its line.
type Explicit = (usize, Reading);

/// Plans the settings of a drive; `None` where the file has none for it. What the drive cannot have is an objection.
pub(super) async fn plan(
    session: &mut Session,
    drive: &mut Drive,
    machine: &Machine,
    wanted: &MachineDrive,
    (purpose, unfinished): (Purpose, bool),
) -> Result<(Option<PlannedSettings>, Vec<CommissionError>), CommissionError> {
    let Some((settings, explicit, unfit)) = settings_of(session, drive, machine, wanted).await? else {
        return Ok((None, Vec::new()));
    };
    let mut request = Restore {
        dry_run: purpose == Purpose::Compare,
        ..Restore::default()
    };
    request.choice.network = true;
    let mut plan = settings::plan(session, drive, &settings, &request).await?;
    if purpose == Purpose::Commission && (plan.set.total() > 0 || unfinished) {
        plan.set.save(drive)?;
        request.save = true;
    }
    let mut objections = objections(&plan, &explicit, wanted);
    objections.extend(unfit);
    if purpose == Purpose::Commission
        && plan.set.total() > 0
        && session.is_enabled(drive).await? == Some(true)
    {
        objections.push(CommissionError::Client(Error::AtWork {
            drive: drive.label(),
            undone: "changed",
            works: AtWork::Enabled,
        }));
    }
    let planned = PlannedSettings {
        wanted: settings,
        request,
        plan,
    };
    Ok((Some(planned), objections))
}

async fn settings_of(
    session: &mut Session,
    drive: &mut Drive,
    machine: &Machine,
    wanted: &MachineDrive,
) -> Result<Option<(Backup, Vec<Explicit>, Vec<CommissionError>)>, CommissionError> {
    let path = wanted.backup.as_deref().map(|path| machine.beside(path));
    let read =
        |path: PathBuf| settings::read(&path).map_err(|error| CommissionError::at(wanted.line)(error.into()));
    let base = path.map(read).transpose()?;
    let explicit = explicit(session, drive, wanted).await?;
    if base.is_none() && explicit.is_empty() {
        return Ok(None);
    }
    let own = explicit.iter().map(|(_, reading)| Ok(reading.clone()));
    let own = Backup::new(Header::of(drive, None), drive.parameters, own);
    let Some(base) = base else {
        return Ok(Some((own, explicit, Vec::new())));
    };
    let (settings, unfit) = base.under(&own);
    let unfit = unfit.into_iter().map(|reading| CommissionError::LeftOut {
        drive: wanted.name.clone(),
        line: line_of(&explicit, &reading).unwrap_or(wanted.line),
        parameter: label(&reading),
        why: Box::new(Skip::Size {
            drive: reading.octets.len(),
            file: 8,
        }),
    });
    let unfit = unfit.collect();
    Ok(Some((settings, explicit, unfit)))
}

/// Returns the telegram and the parameters of the file as values of the drive.
async fn explicit(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &MachineDrive,
) -> Result<Vec<Explicit>, CommissionError> {
    let invalid = |line, problem| CommissionError::Setting {
        drive: wanted.name.clone(),
        line,
        problem: Box::new(problem),
    };
    let mut lines = Vec::new();
    let mut assignments: Vec<Assignment> = Vec::new();
    if let Some(telegram) = wanted.telegram {
        let text = format!("p{}={telegram}", profile::parameter::pnu::TELEGRAM);
        let assignment = text
            .parse()
            .map_err(|problem| invalid(wanted.line, Error::from(problem)))?;
        lines.push(wanted.line);
        assignments.push(assignment);
    }
    for (line, assignment) in &wanted.parameters {
        lines.push(*line);
        assignments.push(assignment.clone());
    }
    if assignments.is_empty() {
        return Ok(Vec::new());
    }
    match session.plan_write(drive, &assignments, false).await {
        Ok(set) => {
            let readings = set.changes().iter().map(|change| change.new.clone());
            Ok(lines.into_iter().zip(readings).collect())
        }
        Err(error) => {
            // which of them it is
            for (line, assignment) in lines.iter().zip(assignments) {
                if let Err(problem) = session.plan_write(drive, &[assignment], false).await {
                    return Err(invalid(*line, problem));
                }
            }
            Err(error.into())
        }
    }
}

fn objections(plan: &Plan, explicit: &[Explicit], wanted: &MachineDrive) -> Vec<CommissionError> {
    let drive = || wanted.name.clone();
    let mut objections = Vec::new();
    for skipped in plan.skipped.iter().filter(|skipped| skipped.why != Skip::Same) {
        let of_file = line_of(explicit, &skipped.reading);
        // the rules of a backup leave out what is not in the file
        if of_file.is_none() && !skipped.why.is_refusal() {
            continue;
        }
        objections.push(CommissionError::LeftOut {
            drive: drive(),
            line: of_file.unwrap_or(wanted.line),
            parameter: label(&skipped.reading),
            why: Box::new(skipped.why.clone()),
        });
    }
    if let Some(why) = &plan.tasks_left_out {
        objections.push(CommissionError::TasksLeftOut {
            drive: drive(),
            why: why.clone(),
        });
    }
    objections
}

fn line_of(explicit: &[Explicit], reading: &Reading) -> Option<usize> {
    let same = |(_, own): &&Explicit| (own.pnu, own.index) == (reading.pnu, reading.index);
    explicit.iter().find(same).map(|(line, _)| *line)
}

fn label(reading: &Reading) -> String {
    reading
        .name
        .map_or_else(|| reading.shown().to_string(), str::to_owned)
}
