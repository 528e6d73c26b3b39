//! What the verbs report that change settings.

use client::Drive;
use client::change::{Change, ChangeSet, Plan, Saved, Skipped, Step, TaskChange};
use serde::Serialize;

use super::{Controller, MotionTask, Parameter, ParameterError, Wording, parameter, parameter_error};

/// Parameters that were written, or in a dry run would be.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WriteReport {
    /// The drive.
    pub drive: String,
    /// Whether nothing was written.
    pub dry_run: bool,
    /// The changes in the order of the request, then the command that saves.
    pub changes: Vec<SettingChange>,
    /// Who has the cyclic connection of the drive; null where it does not report that.
    pub controller: Option<Controller>,
}

impl WriteReport {
    /// Returns how far the changes are.
    #[must_use]
    pub fn new(
        drive: String,
        set: &ChangeSet,
        dry_run: bool,
        controller: Option<Controller>,
        wording: &dyn Wording,
    ) -> Self {
        let all = set.changes().iter().chain(set.save_command());
        Self {
            drive,
            dry_run,
            changes: all
                .map(|change| SettingChange::new(set, change, wording))
                .collect(),
            controller,
        }
    }
}

/// Settings that were restored, or in a dry run would be.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RestoreReport {
    /// The drive.
    pub drive: String,
    /// The file with the settings.
    pub file: String,
    /// Whether nothing was written.
    pub dry_run: bool,
    /// Whether everything that was to be written is written and read back.
    pub complete: bool,
    /// Whether the drive saved it.
    pub saved: bool,
    /// The file with the values before; null where nothing was written.
    pub way_back: Option<String>,
    /// The values.
    pub changes: Vec<SettingChange>,
    /// What is in the file and is not written.
    pub skipped: Vec<SkippedSetting>,
    /// The motion tasks.
    pub tasks: Vec<MotionTaskChange>,
    /// Why no motion task of the file is written.
    pub tasks_left_out: Option<String>,
}

impl RestoreReport {
    /// Returns how far a plan is.
    #[must_use]
    pub fn new(
        drive: &Drive,
        plan: &Plan,
        file: String,
        dry_run: bool,
        way_back: Option<String>,
        wording: &dyn Wording,
    ) -> Self {
        let set = &plan.set;
        let changes = set.changes().iter();
        let tasks = set.tasks().iter();
        Self {
            drive: drive.label(),
            file,
            dry_run,
            complete: set.is_complete(),
            saved: set.saved() == Saved::Yes,
            way_back,
            changes: changes
                .map(|change| SettingChange::new(set, change, wording))
                .collect(),
            skipped: plan.skipped.iter().map(SkippedSetting::from).collect(),
            tasks: tasks.map(|task| MotionTaskChange::new(task, wording)).collect(),
            tasks_left_out: plan.tasks_left_out.clone(),
        }
    }
}

/// A setting that is changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SettingChange {
    /// Parameter number.
    pub pnu: u16,
    /// Element of an array.
    pub index: Option<u16>,
    /// The vendor's name.
    pub name: Option<&'static str>,
    /// The value before, or why it cannot be read; null for a command, which has none.
    pub old: Option<Parameter>,
    /// The value that the drive is to have, as it can represent it.
    pub new: Parameter,
    /// The number that was requested, in the unit of `new`; null for a text and for a value of a file.
    pub asked: Option<f64>,
    /// Whether `new` is rounded.
    pub rounded: bool,
    /// Lowest value that is valid, where that is known.
    pub minimum: Option<f64>,
    /// Highest value that is valid, where that is known.
    pub maximum: Option<f64>,
    /// How far it is: `same` (the drive had it before), `not written`, `in doubt` (sent, no answer), `written`,
    /// `read back`, `differs` (another value was read back), `refused` or `not carried` (the channel cannot).
    pub step: &'static str,
    /// Whether the drive had the value before.
    pub same: bool,
    /// Whether it was sent.
    pub sent: bool,
    /// Whether the drive confirmed it.
    pub written: bool,
    /// Whether another value was read back.
    pub differs: bool,
    /// The value after, or why it cannot be read.
    pub read_back: Option<Parameter>,
    /// Whether the drive has non-volatile memory for it.
    pub can_be_kept: Option<bool>,
    /// Whether the drive saved it.
    pub saved: bool,
    /// Why it was not written.
    pub error: Option<ParameterError>,
}

impl SettingChange {
    fn new(set: &ChangeSet, change: &Change, wording: &dyn Wording) -> Self {
        let limits = set.limits(change);
        let unsent = matches!(change.step, Step::Same | Step::NotWritten) || change.step.is_not_carried();
        let reading = |reading: &_| parameter(reading, wording);
        let selection = &change.selection;
        Self {
            pnu: selection.pnu,
            index: selection.shown(0).index,
            name: selection.parameter.map(|parameter| parameter.name),
            old: change.old.as_ref().map(reading),
            new: Parameter::from(&change.new),
            asked: change.rounding.map(|value| value.asked),
            rounded: change.rounding.is_some_and(|value| value.is_rounded()),
            minimum: limits.map(|(low, _)| low),
            maximum: limits.map(|(_, high)| high),
            step: step(&change.step),
            same: change.step == Step::Same,
            sent: !unsent,
            written: change.step.is_written(),
            differs: change.step == Step::Differs,
            read_back: change.read_back.as_ref().map(reading),
            can_be_kept: change.storable,
            saved: set.is_saved(change),
            error: change.refusal().map(|refusal| parameter_error(refusal, wording)),
        }
    }
}

/// A setting of a file that is not written.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SkippedSetting {
    /// Why.
    pub why: String,
    /// Whether that is because the drive cannot have it.
    pub refused: bool,
    /// The setting in the file.
    pub setting: Parameter,
}

impl From<&Skipped> for SkippedSetting {
    fn from(skipped: &Skipped) -> Self {
        Self {
            why: skipped.why.to_string(),
            refused: skipped.why.is_refusal(),
            setting: Parameter::from(&skipped.reading),
        }
    }
}

/// A motion task that is changed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MotionTaskChange {
    /// Number of the task.
    pub number: u16,
    /// The task before.
    pub old: MotionTask,
    /// The task that the drive is to have.
    pub new: MotionTask,
    /// How far it is, as for a setting.
    pub step: &'static str,
    /// Why it was not written.
    pub error: Option<ParameterError>,
}

impl MotionTaskChange {
    fn new(task: &TaskChange, wording: &dyn Wording) -> Self {
        Self {
            number: task.number,
            old: MotionTask::from(&task.old),
            new: MotionTask::from(&task.new),
            step: step(&task.step),
            error: match &task.step {
                Step::Refused(refusal) => Some(parameter_error(refusal, wording)),
                _ => None,
            },
        }
    }
}

fn step(step: &Step) -> &'static str {
    match step {
        Step::Same => "same",
        Step::NotWritten => "not written",
        Step::InDoubt => "in doubt",
        Step::Written => "written",
        Step::ReadBack => "read back",
        Step::Differs => "differs",
        Step::Refused(refusal) if refusal.is_unsent() => "not carried",
        Step::Refused(_) => "refused",
    }
}
