//! What becomes of new values at the next power cycle.

use profile::catalogue::{Parameter, Role};
use profile::parameter::Saving;

use super::{Change, ChangeSet, Saved};
use crate::{Drive, Refusal};

/// What lets a drive save the value of a parameter over a power cycle.
#[derive(Debug, Clone, Copy)]
pub enum SavedBy {
    /// Nothing: it has no non-volatile memory for it.
    Nothing,
    /// Every write.
    EveryWrite,
    /// A write that requests it.
    Request,
    /// A command, which saves all values at once; its parameter where it is in the tables.
    Command(Option<&'static Parameter>),
}

impl SavedBy {
    /// Its name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::EveryWrite => "every-write",
            Self::Request => "request",
            Self::Command(_) => "command",
        }
    }
}

/// What becomes of the new values that a drive can save.
#[derive(Debug, Clone, Copy)]
pub enum Persistence {
    /// They are saved: the drive saves every write.
    EveryWrite,
    /// They are saved as requested. A command also saved everything else that the drive can save.
    Saved {
        /// By a command.
        by_command: bool,
    },
    /// They are lost: to save them was not requested.
    NotRequested,
    /// They are lost: to save them was requested, but not every value is as planned.
    NotAsPlanned,
    /// To save them was requested, and not answered.
    InDoubt,
    /// They are lost: the drive refused to save, or the channel cannot carry the command.
    Refused(Refusal),
}

/// New values by what becomes of them at the next power cycle.
#[derive(Debug, Clone)]
pub struct Kept<'a> {
    /// Those that become what [`persistence`](Self::persistence) says.
    pub with_set: Vec<&'a Change>,
    /// The drive saved them by itself, whatever was requested: text at a serial line.
    pub by_itself: Vec<&'a Change>,
    /// The drive has no place for them.
    pub lost: Vec<&'a Change>,
    /// What becomes of most of them, and of motion tasks.
    pub persistence: Persistence,
}

impl ChangeSet {
    /// Returns the values that were written by what becomes of them at the next power cycle. A command leaves none behind.
    #[must_use]
    pub fn kept(&self) -> Kept<'_> {
        let mut kept = Kept {
            with_set: Vec::new(),
            by_itself: Vec::new(),
            lost: Vec::new(),
            persistence: self.persistence(),
        };
        let new = self.changes().iter();
        for change in new.filter(|change| change.step.is_written() && !change.acts) {
            let list = if change.storable == Some(false) {
                &mut kept.lost
            } else if change.saving == self.saving() {
                &mut kept.with_set
            } else {
                &mut kept.by_itself
            };
            list.push(change);
        }
        kept
    }

    /// Returns whether the drive was requested to save the new values.
    #[must_use]
    pub const fn is_to_be_saved(&self) -> bool {
        self.saves
    }

    fn persistence(&self) -> Persistence {
        if self.saving() == Saving::Always {
            return Persistence::EveryWrite;
        }
        match self.saved() {
            Saved::Yes => Persistence::Saved {
                by_command: self.save_command().is_some(),
            },
            Saved::InDoubt => Persistence::InDoubt,
            Saved::Refused(refusal) => Persistence::Refused(refusal),
            Saved::No if self.saves => Persistence::NotAsPlanned,
            Saved::No => Persistence::NotRequested,
        }
    }
}

impl Drive {
    /// Returns what lets the drive save the value of a parameter.
    #[must_use]
    pub fn saved_by(&self, parameter: &Parameter) -> SavedBy {
        let tables = self.model.catalogue;
        let kept = tables.map_or(parameter.saved, |tables| tables.is_kept(parameter));
        match self.saving(parameter) {
            _ if !kept => SavedBy::Nothing,
            Saving::Always => SavedBy::EveryWrite,
            Saving::Request => SavedBy::Request,
            Saving::Command => SavedBy::Command(tables.and_then(|tables| tables.with_role(Role::Save))),
        }
    }
}
