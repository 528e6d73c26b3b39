//! What is done with a drive, or with each of many.

use std::path::PathBuf;
use std::time::Duration;

use client::backup::{Backup, Pattern};
use client::change::Choice;
use client::{Drive, Error, Session, StopWay};
use profidrive::inspection;
use profidrive::motion::{self, Control, Observer};
use profidrive::parameters::{self, List, ParameterError, Write};
use profidrive::report::{BackupReport, RestoreReport};
use profidrive::settings::{self, CompareError, Comparison, Restore, RestoreError};
use profile::notation::ParameterReference;
use profile::value::{Assignment, ParameterProblem};
use pyo3::prelude::*;
use serde_json::json;

use crate::errors::{Failure, explained, of_client, of_motion};
use crate::log::{self, Logger};
use crate::trace::document;
use crate::words::Calls;

/// How long a stop may take that is not that of an axis under control.
const STOP: Duration = Duration::from_secs(10);

/// A call for a drive. It returns a document.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Verb(What);

enum What {
    Read {
        names: Vec<ParameterReference>,
        /// What was not read is part of the document.
        collects: bool,
    },
    Write(Vec<Assignment>, Write),
    Describe(ParameterReference),
    List(List),
    Identity,
    Status,
    Faults {
        history: bool,
    },
    Acknowledge {
        by_parameter: bool,
    },
    Stop(StopWay),
    Backup,
    Diff(Box<Backup>, String, Vec<Pattern>),
    Restore(Box<Backup>, Restore, String, Option<PathBuf>),
}

fn reference(name: &str) -> Result<ParameterReference, Failure> {
    let reference = name.parse::<ParameterReference>();
    reference.map_err(|error| of_client(&Error::from(ParameterProblem::from(error))))
}

fn patterns(only: &[String]) -> Result<Vec<Pattern>, Failure> {
    let pattern = |one: &String| {
        let pattern = one.parse::<Pattern>();
        pattern.map_err(|error| Failure::usage(format!("{one}: {error}")))
    };
    only.iter().map(pattern).collect()
}

fn settings_of(text: &str) -> Result<Box<Backup>, Failure> {
    let backup = Backup::read(text);
    Ok(Box::new(backup.map_err(|error| {
        Failure::usage(format!("the settings cannot be used: {error}"))
    })?))
}

#[pymethods]
impl Verb {
    #[staticmethod]
    fn read(names: Vec<String>, collects: bool) -> PyResult<Self> {
        let names = names.iter().map(|name| reference(name));
        let names = names.collect::<Result<_, _>>()?;
        Ok(Self(What::Read { names, collects }))
    }

    #[staticmethod]
    fn write(
        values: Vec<(String, String)>,
        save: bool,
        dry_run: bool,
        beside_controller: bool,
    ) -> PyResult<Self> {
        let assignments = values.iter().map(|(name, value)| {
            let assignment = format!("{name}={value}").parse::<Assignment>();
            assignment.map_err(|problem| of_client(&Error::from(problem)))
        });
        let assignments = assignments.collect::<Result<_, _>>()?;
        let wanted = Write {
            save,
            dry_run,
            beside_controller,
        };
        Ok(Self(What::Write(assignments, wanted)))
    }

    #[staticmethod]
    fn describe(name: &str) -> PyResult<Self> {
        Ok(Self(What::Describe(reference(name)?)))
    }

    #[staticmethod]
    const fn list(filter: Option<String>, values: bool) -> Self {
        Self(What::List(List { filter, values }))
    }

    #[staticmethod]
    const fn identity() -> Self {
        Self(What::Identity)
    }

    #[staticmethod]
    const fn status() -> Self {
        Self(What::Status)
    }

    #[staticmethod]
    const fn faults(history: bool) -> Self {
        Self(What::Faults { history })
    }

    #[staticmethod]
    const fn ack(by_parameter: bool) -> Self {
        Self(What::Acknowledge { by_parameter })
    }

    #[staticmethod]
    const fn stop(disable: bool) -> Self {
        Self(What::Stop(if disable { StopWay::Disable } else { StopWay::Stop }))
    }

    #[staticmethod]
    const fn backup() -> Self {
        Self(What::Backup)
    }

    /// Compares the settings of the drive with those of a text, or those of them that are meant.
    #[staticmethod]
    fn diff(text: &str, name: String, only: Vec<String>) -> PyResult<Self> {
        Ok(Self(What::Diff(settings_of(text)?, name, patterns(&only)?)))
    }

    /// Writes the settings of a text; with `dry_run` nothing.
    #[staticmethod]
    fn restore(
        text: &str,
        name: String,
        only: Vec<String>,
        save: bool,
        dry_run: bool,
        way_back: Option<PathBuf>,
    ) -> PyResult<Self> {
        let choice = Choice {
            only: patterns(&only)?,
            ..Choice::default()
        };
        let wanted = Restore {
            choice,
            save,
            dry_run,
            ..Restore::default()
        };
        Ok(Self(What::Restore(settings_of(text)?, wanted, name, way_back)))
    }
}

impl Verb {
    /// Whether it changes something at a drive. A stop is always permitted.
    pub const fn changes(&self) -> bool {
        match &self.0 {
            What::Write(_, wanted) => !wanted.dry_run,
            What::Restore(_, wanted, ..) => !wanted.dry_run,
            What::Acknowledge { .. } => true,
            _ => false,
        }
    }

    /// What it is, for the log.
    const fn name(&self) -> &'static str {
        match self.0 {
            What::Read { .. } => "read",
            What::Write(..) => "write",
            What::Describe(_) => "describe",
            What::List(_) => "parameters",
            What::Identity => "identity",
            What::Status => "status",
            What::Faults { .. } => "faults",
            What::Acknowledge { .. } => "ack",
            What::Stop(_) => "stop",
            What::Backup => "backup",
            What::Diff(..) => "diff",
            What::Restore(..) => "restore",
        }
    }

    /// Does it.
    pub async fn carry_out(&self, session: &mut Session, drive: &mut Drive) -> Result<String, Failure> {
        let label = drive.label();
        let done = self.done(session, drive).await;
        let what = format_args!("{label}: {}", self.name());
        log::call(Logger::Network, what, &done, self.changes());
        done.map_err(|failure| failure.about(&label))
    }

    async fn done(&self, session: &mut Session, drive: &mut Drive) -> Result<String, Failure> {
        match &self.0 {
            What::Read { names, collects } => read(session, drive, names, *collects).await,
            What::Write(assignments, wanted) => write(session, drive, assignments, *wanted).await,
            What::Describe(name) => {
                let described = parameters::describe(session, drive, name).await;
                document(
                    &described
                        .map_err(|error| of_parameters(&error))?
                        .report(drive, &Calls),
                )
            }
            What::List(wanted) => {
                let listed = parameters::list(session, drive, wanted, &Calls, &mut |_, _| {}).await;
                document(&listed.map_err(|error| of_parameters(&error))?)
            }
            What::Identity => {
                let info = inspection::info(session, drive).await;
                document(&info.map_err(|error| of_client(&error))?)
            }
            What::Status => {
                let status = inspection::status(session, drive, &Calls).await;
                document(&status.map_err(|error| of_client(&error))?.report)
            }
            What::Faults { history } => {
                let faults = inspection::faults(session, drive, *history).await;
                document(&faults.map_err(|error| of_client(&error))?)
            }
            What::Acknowledge { by_parameter } => {
                let (control, observer) = (Control::default(), Observer::default());
                let done = match by_parameter {
                    true => motion::acknowledge_by_parameter(session, drive, &observer).await,
                    false => motion::acknowledge(session, drive, &control, &observer).await,
                };
                document(&done.map_err(|error| of_motion(&error))?)
            }
            What::Stop(way) => {
                let stopped = motion::stop(session, drive, *way, STOP).await;
                let report = stopped.and_then(|report| report.check().map(|()| report));
                document(&report.map_err(|error| of_motion(&error))?)
            }
            What::Backup => backup(session, drive).await,
            What::Diff(file, name, only) => {
                let found = settings::as_in(session, drive, file).await;
                let found = found.map_err(|error| of_compare(&error))?;
                let comparison = Comparison::new(&found, file).and_then(|comparison| comparison.only(only));
                let comparison = comparison.map_err(|error| of_compare(&error))?;
                document(&comparison.report(&drive.label(), name, &Calls))
            }
            What::Restore(file, wanted, name, way_back) => {
                restore(session, drive, file, wanted, name, way_back.clone()).await
            }
        }
    }
}

fn of_compare(error: &CompareError) -> Failure {
    match error {
        CompareError::Client(error) => of_client(error),
        other => explained(other),
    }
}

fn of_restore(error: &RestoreError) -> Failure {
    match error {
        RestoreError::Client(error) => of_client(error),
        other => explained(other),
    }
}

fn of_parameters(error: &ParameterError) -> Failure {
    match error {
        ParameterError::Client(error) => of_client(error),
        other => explained(other),
    }
}

async fn read(
    session: &mut Session,
    drive: &mut Drive,
    names: &[ParameterReference],
    collects: bool,
) -> Result<String, Failure> {
    let values = parameters::read(session, drive, names).await;
    let values = values.map_err(|error| of_client(&error))?;
    let problems = values.problems(&drive.label());
    let report = values.report(drive, &Calls);
    if !collects {
        return problems
            .first()
            .map_or_else(|| document(&report), |problem| Err(of_client(problem)));
    }
    let problems: Vec<_> = problems
        .iter()
        .map(|problem| of_client(problem).about(&drive.label()))
        .collect();
    let problems: Vec<_> = problems.iter().map(Failure::parts).collect();
    document(&json!({ "report": report, "problems": problems }))
}

/// What to do about a drive that a controller has.
const BESIDE: &str =
    "beside_controller=True writes anyway: the new values take effect while the controller moves the axis";

async fn write(
    session: &mut Session,
    drive: &mut Drive,
    assignments: &[Assignment],
    wanted: Write,
) -> Result<String, Failure> {
    let written = parameters::write(session, drive, assignments, wanted).await;
    let written = written.map_err(|error| match &error {
        Error::AtWork { .. } => of_client(&error).hinted(BESIDE),
        _ => of_client(&error),
    })?;
    let report = written.report(drive, &Calls);
    let problems = written.problems(&drive.label());
    let Some(first) = problems.first() else {
        return document(&report);
    };
    // one value alone was refused as a whole
    if let (ParameterError::Client(error), [_], [_]) = (first, &problems[..], assignments) {
        return Err(of_client(error));
    }
    let failure = explained(first).of_kind(written.outcome().kind());
    Err(failure.with(json!({ "report": report })))
}

/// The text of a backup beside its report.
async fn backup(session: &mut Session, drive: &mut Drive) -> Result<String, Failure> {
    let read = settings::backup(session, drive, |_, _| {}).await;
    let read = read.map_err(|error| of_client(&error))?;
    let complete = read.outcome.kind().is_none();
    let missing = settings::missing(&read.report);
    let missing = (!missing.is_nothing()).then(|| missing.to_string());
    let report = BackupReport::new(drive, &read.report, None, complete, &Calls);
    document(&json!({ "text": read.report.to_string(), "missing": missing, "report": report }))
}

async fn restore(
    session: &mut Session,
    drive: &mut Drive,
    file: &Backup,
    wanted: &Restore,
    name: &str,
    way_back: Option<PathBuf>,
) -> Result<String, Failure> {
    let plan = settings::plan(session, drive, file, wanted).await;
    let mut plan = plan.map_err(|error| of_restore(&error))?;
    let report = |plan: &_, way_back: Option<&PathBuf>| {
        let way_back = way_back.map(|path| path.display().to_string());
        RestoreReport::new(drive, plan, name.to_owned(), wanted.dry_run, way_back, &Calls)
    };
    if wanted.dry_run {
        return document(&report(&plan, None));
    }
    let beside = || settings::way_back(format!("{}.backup", drive.label()).as_ref());
    let way_back = way_back.or_else(beside);
    let way_back =
        way_back.ok_or_else(|| Failure::usage("no free name is left for the file with the values before"))?;
    let mut restored = drive.clone();
    let done = settings::carry_out(session, &mut restored, file, wanted, &mut plan, &way_back, |_| {}).await;
    let kept = Some(&way_back).filter(|path| plan.set.total() > 0 && path.exists());
    let restoration = report(&plan, kept);
    let failed = |failure: Failure| failure.with(json!({ "restore": restoration }));
    done.map_err(|error| failed(of_restore(&error)))?;
    if let Some(shortfall) = settings::shortfall(&plan, drive, wanted) {
        return Err(failed(explained(&shortfall)));
    }
    document(&restoration)
}
