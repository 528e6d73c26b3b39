//! New values, read back, and which of them outlive the power of the drive.

use client::change::{Change, ChangeSet, Step};
use client::{AtWork, Drive, Error, Session};
use dissect::value;
use profile::value::{Assignment, Reading};

use super::{ParameterError, remark};
use crate::report::{Controller, Wording, WriteReport};
use crate::{Outcome, Remark, settings};

/// How values are written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Write {
    /// The drive saves them over power-off; only where every value is as planned.
    pub save: bool,
    /// Nothing is written.
    pub dry_run: bool,
    /// Also where another controller has the drive, for whose motion the new values count at once. A plan is made in any case.
    pub beside_controller: bool,
}

/// What was written, or in a dry run would be.
#[derive(Debug, Clone)]
pub struct Written {
    /// The changes, with old and new values.
    pub set: ChangeSet,
    /// Name of the controller that has the cyclic connection: `Some(None)` without one.
    pub controller: Option<Option<String>>,
    /// What the axis of a drive without a controller is doing: nothing commands it, and it turns or its power stage is on.
    pub alone: Option<AtWork>,
    /// How it was requested.
    pub wanted: Write,
    /// What was requested, in the order of the changes.
    pub assignments: Vec<Assignment>,
}

impl Written {
    /// Every change, the command that saves among them.
    pub fn changes(&self) -> impl Iterator<Item = &Change> {
        self.set.changes().iter().chain(self.set.save_command())
    }

    /// Whether [`carry_out`] has anything to write.
    #[must_use]
    pub fn is_change(&self) -> bool {
        self.changes().any(|change| change.step == Step::NotWritten)
    }

    /// The controller for whose motion the new values count at once.
    #[must_use]
    pub fn affected_controller(&self) -> Option<&str> {
        self.controller
            .as_ref()?
            .as_deref()
            .filter(|_| self.has_written())
    }

    fn has_written(&self) -> bool {
        self.changes().any(|change| change.step.is_written())
    }

    /// Returns what went wrong with each change.
    #[must_use]
    pub fn problems(&self, drive: &str) -> Vec<ParameterError> {
        let problem = |change: &Change| match &change.step {
            Step::Refused(refusal) => Some(ParameterError::Client(Error::Refused {
                drive: drive.to_owned(),
                refusal: *refusal,
            })),
            Step::Differs => Some(ParameterError::Differs {
                drive: drive.to_owned(),
                parameter: change.label(),
            }),
            _ => None,
        };
        self.changes().filter_map(problem).collect()
    }

    /// How the call ended: [`Outcome::Partial`] where a value was refused, [`Outcome::Difference`] where the drive has another.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        let refused = self.changes().any(|change| change.refusal().is_some());
        let differs = self.changes().any(|change| change.step == Step::Differs);
        match (refused, differs) {
            (true, _) => Outcome::Partial,
            (false, true) => Outcome::Difference,
            (false, false) => Outcome::Complete,
        }
    }

    /// Returns what a person is to know of the values on their way to the drive: a raw number in its unit, a value that is
    /// rounded, blanks of a text that are left out.
    #[must_use]
    pub fn of_values(&self) -> Vec<Remark> {
        let pairs = self.assignments.iter().zip(self.set.changes());
        pairs
            .filter_map(|(assignment, change)| remark::of_value(assignment, change))
            .collect()
    }

    /// Returns the warning that a controller is connected, or that the axis works without one: the new values count for its motion at
    /// once.
    #[must_use]
    pub fn of_motion(&self, drive: &str) -> Option<Remark> {
        if let Some(name) = self.affected_controller() {
            return Some(Remark::warning(format!(
                "controller \"{name}\" is connected to {drive}: what was written counts for its motion at once"
            )));
        }
        let works = self.alone.as_ref().filter(|_| self.has_written())?;
        Some(Remark::warning(format!(
            "{drive}: {works}, and no controller is connected: what was written counts at once"
        )))
    }

    /// Returns which of the new values are lost at the next power cycle, and which are not.
    #[must_use]
    pub fn lasting(&self) -> Vec<Remark> {
        settings::lasting(&self.set)
    }

    /// Returns it as a report.
    #[must_use]
    pub fn report(&self, drive: &Drive, wording: &dyn Wording) -> WriteReport {
        let controller = Controller::of(self.controller.as_ref());
        WriteReport::new(drive.label(), &self.set, self.wanted.dry_run, controller, wording)
    }
}

/// Checks assignments, writes them in their order and reads them back. What the drive has already is not written, except to
/// save it.
///
/// # Errors
/// A wrong assignment, before anything is written, [`Error::AtWork`] for a drive that a controller has, without
/// [`beside_controller`](Write::beside_controller), or a drive that cannot be reached. What the drive refuses is in
/// [`Written::problems`].
pub async fn write(
    session: &mut Session,
    drive: &mut Drive,
    assignments: &[Assignment],
    wanted: Write,
) -> Result<Written, Error> {
    let planned = plan(session, drive, assignments, wanted).await?;
    if wanted.dry_run {
        return Ok(planned);
    }
    carry_out(session, drive, planned).await
}

/// Checks assignments and returns what [`carry_out`] would write; nothing is written.
///
/// # Errors
/// A wrong assignment, or a drive that cannot be reached.
pub async fn plan(
    session: &mut Session,
    drive: &mut Drive,
    assignments: &[Assignment],
    wanted: Write,
) -> Result<Written, Error> {
    let (controller, alone) = commanded(session, drive).await?;
    Ok(Written {
        controller,
        alone,
        set: session.plan_write(drive, assignments, wanted.save).await?,
        wanted,
        assignments: assignments.to_vec(),
    })
}

/// Reads who commands a drive, and what its axis does where none is connected.
async fn commanded(
    session: &mut Session,
    drive: &mut Drive,
) -> Result<(Option<Option<String>>, Option<AtWork>), Error> {
    let controller = session.owner(drive).await?;
    let alone = match controller {
        Some(None) => session.motion(drive).await?,
        _ => None,
    };
    Ok((controller, alone))
}

/// Writes what was planned, and reads it back: see [`write()`].
///
/// # Errors
/// [`Error::AtWork`] where a controller had the drive when it was planned, without [`beside_controller`](Write::beside_controller),
/// and when the drive cannot be reached. What it refuses is in [`Written::problems`].
pub async fn carry_out(
    session: &mut Session,
    drive: &mut Drive,
    mut planned: Written,
) -> Result<Written, Error> {
    let is_refused = !planned.wanted.beside_controller && !session.has_axis(drive);
    if let (true, Some(Some(name))) = (is_refused, &planned.controller) {
        return Err(Error::AtWork {
            drive: drive.label(),
            undone: "written",
            works: AtWork::Controller(name.clone()),
        });
    }
    session.apply(drive, &mut planned.set).await?;
    Ok(planned)
}

/// Checks each assignment by itself, where [`plan()`] has refused all of them together. Returns the place and the reason of each
/// that is wrong, in their order. Nothing is written.
///
/// # Errors
/// When the drive cannot be reached.
pub async fn objections(
    session: &mut Session,
    drive: &mut Drive,
    assignments: &[Assignment],
) -> Result<Vec<(usize, Error)>, Error> {
    let mut wrong = Vec::new();
    for (place, assignment) in assignments.iter().enumerate() {
        match session
            .plan_write(drive, std::slice::from_ref(assignment), false)
            .await
        {
            Ok(_) => {}
            Err(error @ Error::Parameter(_)) => wrong.push((place, error)),
            Err(error) => return Err(error),
        }
    }
    Ok(wrong)
}

/// As [`carry_out`], where a person has agreed to a plan: nothing is written when the drive has other values now than the plan
/// has as the old ones.
///
/// # Errors
/// [`ParameterError::Outdated`] with the values of then and of now, else as [`carry_out`].
pub async fn carry_out_agreed(
    session: &mut Session,
    drive: &mut Drive,
    planned: Written,
) -> Result<Written, ParameterError> {
    let now = plan(session, drive, &planned.assignments, planned.wanted).await?;
    let pairs = planned.set.changes().iter().zip(now.set.changes());
    let changes: Vec<String> = pairs.filter_map(|(then, now)| outdated(then, now)).collect();
    if !changes.is_empty() {
        let drive = drive.label();
        return Err(ParameterError::Outdated { drive, changes });
    }
    Ok(carry_out(session, drive, now).await?)
}

/// Returns how the old value of a change is another one now.
fn outdated(then: &Change, now: &Change) -> Option<String> {
    let old = |change: &Change| change.old.clone().and_then(Result::ok);
    let (before, present) = (old(then), old(now));
    let octets = |reading: &Option<Reading>| reading.as_ref().map(|reading| reading.octets.clone());
    (octets(&before) != octets(&present)).then(|| {
        let text = |reading: Option<Reading>| {
            reading
                .as_ref()
                .map_or_else(|| "not readable".to_owned(), value::full)
        };
        format!("{} was {}, is {}", then.label(), text(before), text(present))
    })
}

/// Writes the values before, as far as they are known, and reads them back. A wish to stop does not interrupt it.
///
/// # Errors
/// When the drive cannot be reached. What it refuses is in [`Written::problems`].
pub async fn undo(session: &mut Session, drive: &mut Drive, written: &Written) -> Result<Written, Error> {
    let set = session.undo(drive, &written.set).await?;
    let (controller, alone) = commanded(session, drive).await?;
    Ok(Written {
        set,
        controller,
        alone,
        wanted: written.wanted,
        // values of the drive itself: they were never text
        assignments: Vec::new(),
    })
}
