//! Changes of the settings of a drive: planned, written, verified and undone in one way. Pure; [`Session`](crate::Session)
//! does the reading and writing.
//!
//! A [`ChangeSet`] is a plan first: old and new value of each change, how the new one is rounded, the order, and what the
//! drive has already. A dry run is this plan, printed. [`Session::apply`](crate::Session::apply) writes it and reads it
//! back, and the set records at every moment how far each change is: as text it is the journal, and a
//! [`Backup`](crate::backup::Backup) that restores the old values. [`Session::undo`](crate::Session::undo) writes them at once.
//!
//! | plan | from |
//! |---|---|
//! | [`Session::plan_write`](crate::Session::plan_write) | assignments: parameters and values as a person writes them |
//! | [`Session::plan`](crate::Session::plan) | a backup that is restored |
//! | [`Session::plan_values`](crate::Session::plan_values) | values read before |

mod journal;
mod kept;
mod plan;
mod set;
#[cfg(test)]
mod tests;

use profile::catalogue::{Access, BackupRule, Phase, Role};
use profile::parameter::{Dialect, Format, Saving};
use profile::value::{CheckedValue, Content, Interpretation, Parameters, Reading, Selection, is_scaling};

pub use kept::{Kept, Persistence, SavedBy};
pub(crate) use plan::in_size_of;
pub use plan::{Choice, Plan, Skip, Skipped, TaskSkipped};
pub use set::ChangeSet;

use crate::Refusal;
use crate::backup::Task;

/// How far one change is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// The drive had the value before: nothing is sent.
    Same,
    /// Nothing was sent: the drive has the old value.
    NotWritten,
    /// Sent, and not answered: the drive has the old value or the new one.
    InDoubt,
    /// The drive confirmed the write.
    Written,
    /// Written, and read back as the new value.
    ReadBack,
    /// The drive confirmed the write and reads back another value.
    Differs,
    /// The drive refused, or the channel cannot carry it: the drive has the old value.
    Refused(Refusal),
}

impl Step {
    /// True where the drive refused.
    #[must_use]
    pub fn is_refused(&self) -> bool {
        matches!(self, Self::Refused(refusal) if !refusal.is_unsent())
    }

    /// True where nothing was sent, as the channel cannot carry it.
    #[must_use]
    pub fn is_not_carried(&self) -> bool {
        matches!(self, Self::Refused(refusal) if refusal.is_unsent())
    }

    /// True where the drive confirmed the write.
    #[must_use]
    pub const fn is_written(&self) -> bool {
        matches!(self, Self::Written | Self::ReadBack | Self::Differs)
    }

    /// True where the drive may have another value than before.
    #[must_use]
    pub const fn may_have_changed(&self) -> bool {
        self.is_written() || matches!(self, Self::InDoubt)
    }
}

/// Whether the drive saved the new values to non-volatile memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saved {
    /// Not requested, or not everything was written as planned.
    No,
    /// Requested, and not answered.
    InDoubt,
    /// The drive confirmed it.
    Yes,
    /// The drive refused, or the channel cannot carry the command.
    Refused(Refusal),
}

/// When the power stage has to be off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    /// Before a unit or a scaling is written. Each value is written once, in the order of the plan.
    OffToScale,
    /// Before each step. Values are written phase by phase. What the drive refuses is tried again as long as others
    /// succeed, because a limit may have to move first; what it changed by itself afterwards is written again.
    Off,
}

/// One value of a set.
#[derive(Debug, Clone)]
pub struct Change {
    /// Parameter and element.
    pub selection: Selection,
    /// Value before; `None` for a command, which has none.
    pub old: Option<Result<Reading, Refusal>>,
    /// Value that the drive is to have, as it can represent it.
    pub new: Reading,
    /// The number as it was requested and as it is rounded; `None` for text and for a value that a drive had.
    pub rounding: Option<CheckedValue>,
    /// Value read after the write; `None` for a command and while nothing is written.
    pub read_back: Option<Result<Reading, Refusal>>,
    /// How far it is.
    pub step: Step,
    /// When the drive saves the value.
    pub saving: Saving,
    /// Whether the drive has non-volatile memory for the value; `None` where no table says so.
    pub storable: Option<bool>,
    /// Writing it does something (MT.CLEAR, MT.MOVE): what it reads as afterwards says nothing about success.
    pub acts: bool,
    /// What the tables say about changing it.
    rule: Option<BackupRule>,
}

impl Change {
    /// A value for a drive with these tables; the old one is not known yet.
    pub(crate) fn new(tables: &Parameters, selection: Selection, new: Reading) -> Self {
        let base = selection.parameter.and_then(|parameter| parameter.base);
        let rule = tables
            .catalogue
            .map(|tables| tables.backup_rule_at(selection.pnu, base));
        let role = rule.map(|rule| rule.role);
        Self {
            selection,
            old: None,
            new,
            rounding: None,
            read_back: None,
            step: Step::NotWritten,
            saving: Saving::Command,
            storable: tables
                .catalogue
                .and_then(|tables| Some(tables.is_kept(selection.parameter?))),
            acts: is_command(&selection)
                || matches!(role, Some(Role::Action | Role::Save | Role::ClearFaults)),
            rule,
        }
    }

    /// Name and number: `DRV.ACC (p2108)`.
    #[must_use]
    pub fn label(&self) -> String {
        self.selection.label()
    }

    /// When it is written in a set that is written phase by phase.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.rule.map_or(Phase::Value, |rule| rule.phase)
    }

    /// True when the drive had this value before.
    #[must_use]
    pub fn is_same(&self) -> bool {
        let old = self.old.as_ref().and_then(|old| old.as_ref().ok());
        !self.acts && old.is_some_and(|old| self.is_in(old))
    }

    /// True when a drive that reads like this has the new value.
    pub(crate) fn is_in(&self, read: &Reading) -> bool {
        let near = |wanted: f64, read: f64| (read - wanted).abs() <= read.abs() * 1e-6;
        read.octets == self.new.octets
            || match (&self.new.content, &read.content) {
                (Content::Number { raw: wanted, .. }, Content::Number { raw, .. }) => wanted == raw,
                (Content::Float(wanted), Content::Float(read)) => near(*wanted, *read),
                (Content::Number { engineering, .. }, Content::Float(read)) => near(*engineering, *read),
                (Content::Text(wanted), Content::Text(read)) => wanted == read,
                _ => false,
            }
    }

    /// True where the drive has the new value: confirmed and, where that says anything, read back.
    #[must_use]
    pub fn is_done(&self) -> bool {
        matches!(self.step, Step::Same | Step::ReadBack) || self.acts && self.step.is_written()
    }

    /// The value that the drive has now, as far as it was read.
    #[must_use]
    pub fn now(&self) -> Option<&Reading> {
        let read = match self.step {
            Step::Same => self.old.as_ref(),
            _ => self.read_back.as_ref(),
        };
        read?.as_ref().ok()
    }

    /// The refusal, where the drive refused it or the channel cannot carry it.
    #[must_use]
    pub const fn refusal(&self) -> Option<&Refusal> {
        match &self.step {
            Step::Refused(refusal) => Some(refusal),
            _ => None,
        }
    }

    /// Units and scalings decide what setpoints mean, also those of an axis that runs.
    fn scales_setpoints(&self, parameters: &Parameters) -> bool {
        // the profile has numbers of its own for some of them
        let alias = self
            .rule
            .is_some_and(|rule| matches!(rule.role, Role::Alias { .. }));
        self.selection.parameter.is_some() && self.phase() == Phase::Scaling
            || alias && self.scales(parameters)
    }

    /// True where other values are scaled by it.
    fn scales(&self, parameters: &Parameters) -> bool {
        let known = self.selection.parameter.zip(parameters.catalogue);
        known.is_some_and(|(parameter, tables)| is_scaling(tables, parameter))
    }

    /// The value as it is sent.
    pub(crate) fn outgoing(&self, dialect: &Dialect) -> Outgoing {
        let format = Format(self.new.format);
        let octets = self.new.octets.clone();
        let count = match Interpretation::of(format, dialect.code_space) {
            Interpretation::Text | Interpretation::Octets => u8::try_from(octets.len()).unwrap_or(u8::MAX),
            _ => 1,
        };
        Outgoing {
            selection: self.selection,
            format,
            count,
            octets,
        }
    }
}

/// True for a parameter that cannot be read.
pub(crate) fn is_command(selection: &Selection) -> bool {
    let access = selection.parameter.map(|parameter| parameter.access);
    access == Some(Access::WriteOnly)
}

/// One value on its way to a drive.
#[derive(Debug, Clone)]
pub(crate) struct Outgoing {
    pub selection: Selection,
    pub format: Format,
    /// Number of values; of octets for a string.
    pub count: u8,
    pub octets: Vec<u8>,
}

/// One motion task that is to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskChange {
    /// Its number.
    pub number: u16,
    /// As it is now.
    pub old: Task,
    /// As it is to be.
    pub new: Task,
    /// How far it is.
    pub step: Step,
}
