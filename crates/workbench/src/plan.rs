//! A plan of changes: made, shown, and carried out once a person agrees.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use profidrive::client::Drive;
use profidrive::client::backup::Backup;
use profidrive::client::change::{ChangeSet, Plan, Step};
use profidrive::parameters::{self, Written};
use profidrive::profile::value::Assignment;
use profidrive::report::{Error, MotionTaskChange, RestoreReport, SettingChange, SkippedSetting};
use profidrive::settings::{self, Restore};
use profidrive::{Explained, Remark};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::board::explained;
use crate::problem::Problem;
use crate::words::PageWords;

/// A value that is wanted, as people write it.
#[derive(Debug, Clone, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Wanted {
    /// Number or name: `DRV.ACC`, `p2108`, `3-41`.
    parameter: String,
    /// The value with or without its unit: `8000 rpm/s`, `80rps/s`.
    value: String,
}

/// A value that cannot be written.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct Refusal {
    /// The parameter as it was requested.
    parameter: String,
    /// Why.
    error: Error,
}

/// What is changed, and how far it is.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
pub(crate) struct PlanReport {
    /// Whether there is something to write, and nothing that keeps it from being written.
    ready: bool,
    /// Whether the drive saves the new values.
    saves: bool,
    /// Whether there are values before to be written again.
    pub undo: bool,
    /// In one sentence, how much was written.
    summary: String,
    /// The values, in the order of writing.
    changes: Vec<SettingChange>,
    /// The values that cannot be written. With one of them nothing is written.
    refusals: Vec<Refusal>,
    /// What is in the file and is not written.
    skipped: Vec<SkippedSetting>,
    /// The motion tasks.
    tasks: Vec<MotionTaskChange>,
    /// Why no motion task of the file is written.
    tasks_left_out: Option<String>,
    /// The name of the controller for whose motion the new values count at once.
    controller: Option<String>,
    /// The file with the settings to restore.
    file: Option<String>,
    /// The file with the values before.
    before: Option<String>,
}

impl PlanReport {
    /// Notes in `unsaved`, as requests name them, which values the drive would lose at its next power cycle once this was carried out.
    pub fn note_unsaved(&self, unsaved: &mut BTreeSet<String>) {
        for change in &self.changes {
            let number = &change.new.number;
            let name = match change.index {
                Some(index) if !number.contains('[') => format!("{number}[{index}]"),
                _ => number.clone(),
            };
            if self.saves || change.saved {
                unsaved.remove(&name);
            } else if change.written && change.can_be_kept != Some(false) {
                unsaved.insert(name);
            }
        }
    }
}

/// A plan that can be carried out.
#[derive(Debug)]
pub(crate) enum Planned {
    /// Values.
    Write(Box<Written>),
    /// The settings of a file.
    Restore(Box<Restoring>),
}

/// Settings of a file that are restored.
#[derive(Debug)]
pub(crate) struct Restoring {
    /// The name of the file.
    pub file: String,
    /// Its content.
    pub settings: Backup,
    pub wanted: Restore,
    pub plan: Plan,
    /// The file for the values before.
    pub way_back: PathBuf,
}

/// Takes the wishes as people write them; those that are no parameter or no value are returned apart.
pub(crate) fn assignments(wanted: &[Wanted]) -> (Vec<Assignment>, Vec<Refusal>) {
    let (mut good, mut bad) = (Vec::new(), Vec::new());
    for Wanted { parameter, value } in wanted {
        match format!("{parameter}={value}").parse::<Assignment>() {
            Ok(assignment) => good.push(assignment),
            Err(problem) => bad.push(refusal(parameter, &profidrive::client::Error::from(problem))),
        }
    }
    (good, bad)
}

pub(crate) fn refusal(parameter: &str, error: &impl Explained) -> Refusal {
    Refusal {
        parameter: parameter.to_owned(),
        error: explained(error),
    }
}

impl Planned {
    pub fn set(&self) -> &ChangeSet {
        match self {
            Self::Write(written) => &written.set,
            Self::Restore(restoring) => &restoring.plan.set,
        }
    }

    /// Returns the changes for the log, in one line each.
    pub fn lines(&self) -> Vec<String> {
        settings::in_lines(self.set())
    }

    /// Returns how far it is.
    pub fn report(&self, drive: &Drive) -> PlanReport {
        let set = self.set();
        let base = PlanReport {
            saves: set.is_to_be_saved(),
            undo: set
                .changes()
                .iter()
                .any(|change| change.step.may_have_changed() && !change.acts),
            summary: set.summary(),
            ..PlanReport::default()
        };
        match self {
            Self::Write(written) => PlanReport {
                ready: written.is_change(),
                changes: written.report(drive, &PageWords).changes,
                controller: written.controller.clone().flatten(),
                ..base
            },
            Self::Restore(restoring) => {
                let Restoring {
                    file, plan, way_back, ..
                } = &**restoring;
                let report = RestoreReport::new(drive, plan, file.clone(), false, None, &PageWords);
                PlanReport {
                    ready: set.count(|step| *step == Step::NotWritten) > 0,
                    // the way back is a file, restored like any other
                    undo: false,
                    changes: report.changes,
                    skipped: report.skipped.into_iter().filter(|one| one.refused).collect(),
                    tasks: report.tasks,
                    tasks_left_out: report.tasks_left_out,
                    file: Some(file.clone()),
                    before: way_back.exists().then(|| name(way_back)),
                    ..base
                }
            }
        }
    }

    /// Returns what a person is to know before it is carried out.
    pub fn before(&self) -> Vec<String> {
        match self {
            Self::Write(written) => sentences(written.of_values()),
            Self::Restore(restoring) => {
                let differences = restoring.plan.identity_differences(&restoring.settings);
                let lines = differences.iter();
                lines
                    .map(|one| {
                        format!(
                            "{}: {} in the file, {} in the drive",
                            one.what, one.left, one.right
                        )
                    })
                    .collect()
            }
        }
    }

    /// Returns what a person is to know once it was carried out.
    pub fn after(&self, drive: &Drive) -> Vec<String> {
        match self {
            Self::Write(written) => {
                let problems = written.problems(&drive.label());
                let of_motion = written.of_motion(&drive.label());
                let mut all: Vec<String> = problems
                    .iter()
                    .map(|problem| explained(problem).message)
                    .collect();
                all.extend(sentences(of_motion));
                all.extend(sentences(written.lasting()));
                all
            }
            Self::Restore(restoring) => {
                let shortfall = settings::shortfall(&restoring.plan, drive, &restoring.wanted);
                let mut all: Vec<String> = shortfall.iter().map(|one| explained(one).message).collect();
                all.extend(sentences(settings::lasting(&restoring.plan.set)));
                all
            }
        }
    }

    /// Writes it, and reads it back. What was done of it before an error is in it.
    pub async fn carry_out(
        self,
        network: &mut profidrive::Caller,
        drive: &mut Drive,
        progress: impl FnMut(usize) + Send,
    ) -> Result<(Self, Option<Problem>), Problem> {
        match self {
            Self::Write(written) => {
                let done = parameters::carry_out_agreed(network, drive, *written).await;
                let done = done.map_err(|error| Problem::of(&error))?;
                Ok((Self::Write(Box::new(done)), None))
            }
            Self::Restore(mut restoring) => {
                let Restoring {
                    settings,
                    wanted,
                    plan,
                    way_back,
                    ..
                } = &mut *restoring;
                let done =
                    settings::carry_out(network, drive, settings, wanted, plan, way_back, progress).await;
                let problem = done.err().map(|error| Problem::of(&error));
                Ok((Self::Restore(restoring), problem))
            }
        }
    }
}

/// Returns a plan of which nothing can be written, because of these.
pub(crate) fn refused(refusals: Vec<Refusal>) -> PlanReport {
    PlanReport {
        refusals,
        ..PlanReport::default()
    }
}

fn name(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

fn sentences(remarks: impl IntoIterator<Item = Remark>) -> Vec<String> {
    // what is to be done next stands beside it on the page, as a button
    remarks.into_iter().map(|remark| remark.sentence).collect()
}
