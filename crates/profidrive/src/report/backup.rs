//! What the verbs report that save and compare settings.

use client::backup::{Backup, Side, Task, TaskCoverage};
use serde::Serialize;

use super::{Parameter, Wording, parameter};

/// The settings of a drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BackupReport {
    /// The drive.
    pub drive: String,
    /// Name of its model.
    pub model: &'static str,
    /// The file that was written.
    pub file: Option<String>,
    /// The settings.
    pub parameters: Vec<Parameter>,
    /// The settings that could not be read, with the reason.
    pub refused: Vec<Parameter>,
    /// The motion tasks; null where they are left out.
    pub tasks: Option<Vec<NumberedTask>>,
    /// Whether no setting and no motion task is missing.
    pub complete: bool,
}

impl BackupReport {
    /// Returns the settings of a drive as they were read.
    #[must_use]
    pub fn new(
        drive: &client::Drive,
        backup: &Backup,
        file: Option<String>,
        complete: bool,
        wording: &dyn Wording,
    ) -> Self {
        let tasks = || {
            let numbers = backup.task_numbers().into_iter();
            numbers
                .filter_map(|number| Some((number, backup.task(number)?)))
                .filter(|(_, task)| **task != Task::Empty)
                .map(|(number, task)| NumberedTask {
                    number,
                    task: MotionTask::from(task),
                })
                .collect()
        };
        Self {
            drive: drive.label(),
            model: drive.model.name,
            file,
            parameters: backup.readings().iter().map(Parameter::from).collect(),
            refused: backup
                .refused()
                .iter()
                .map(|refusal| parameter(&Err(*refusal), wording))
                .collect(),
            tasks: (backup.header.tasks == TaskCoverage::All).then(tasks),
            complete,
        }
    }
}

/// A motion task with its number.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NumberedTask {
    /// Number of the task.
    pub number: u16,
    /// The task.
    #[serde(flatten)]
    pub task: MotionTask,
}

/// A motion task of the drive's own table.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MotionTask {
    /// Whether it has no values.
    pub empty: bool,
    /// Its values.
    pub values: Vec<Parameter>,
}

impl From<&Task> for MotionTask {
    fn from(task: &Task) -> Self {
        Self {
            empty: *task == Task::Empty,
            values: task.values().iter().map(Parameter::from).collect(),
        }
    }
}

/// What differs between two sets of settings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DiffReport {
    /// File or drive on the left.
    pub left: String,
    /// File or drive on the right.
    pub right: String,
    /// The settings that differ.
    pub differences: Vec<Difference>,
    /// The motion tasks that differ.
    pub tasks: Vec<TaskDifference>,
    /// What differs in name and address. A restore does not write it, and it does not count as a difference.
    pub network: Vec<NetworkDifference>,
}

/// Something in name or address that differs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NetworkDifference {
    /// `name of station`, `IP address`, `subnet mask` or `gateway`.
    pub setting: &'static str,
    /// What it is on the left; empty for no name.
    pub left: String,
    /// What it is on the right; empty for no name.
    pub right: String,
}

impl From<client::backup::IdentityDifference> for NetworkDifference {
    fn from(one: client::backup::IdentityDifference) -> Self {
        Self {
            setting: one.what,
            left: one.left,
            right: one.right,
        }
    }
}

/// A setting that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Difference {
    /// Parameter number.
    pub pnu: Option<u16>,
    /// Element of an array.
    pub index: Option<u16>,
    /// The vendor's name.
    pub name: Option<&'static str>,
    /// Whether a controller decides it by connecting: telegram, mapping, command source, address.
    pub connection: bool,
    /// The value on the left; null where it is missing.
    pub left: Option<Parameter>,
    /// The value on the right; null where it is missing.
    pub right: Option<Parameter>,
}

impl Difference {
    /// Returns a setting that differs.
    #[must_use]
    pub fn new(one: &client::backup::Difference, connection: bool, wording: &dyn Wording) -> Self {
        let side = |side: &Side| match side {
            Side::Missing => None,
            Side::Refused(refusal) => Some(parameter(&Err(*refusal), wording)),
            Side::Value(reading) => Some(Parameter::from(reading)),
        };
        let reading = one.reading();
        Self {
            pnu: reading.map(|reading| reading.pnu),
            index: reading.and_then(|reading| reading.index),
            name: reading.and_then(|reading| reading.name),
            connection,
            left: side(&one.left),
            right: side(&one.right),
        }
    }
}

/// A motion task that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TaskDifference {
    /// Number of the task.
    pub number: u16,
    /// The task on the left.
    pub left: MotionTask,
    /// The task on the right.
    pub right: MotionTask,
}
