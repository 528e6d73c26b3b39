//! Planning, writing, verifying and undoing changes.

use profile::parameter::{ErrorNumber, RequestId};
use profile::value::{Assignment, ParameterProblem, Reading, Selection};

use super::Session;
use super::parameters::{NewContent, needs_scaling, planned};
use crate::change::{Change, ChangeSet, Condition, Outgoing, Step, is_command};
use crate::{Drive, Error, Refusal};

/// How often what the drive changed by itself is written again.
const REPAIRS: usize = 2;

/// Where a journal is kept: on a disk, mostly.
pub type Keep<'k> = dyn FnMut(&ChangeSet) -> Result<(), Box<dyn std::error::Error + Send + Sync>> + Send + 'k;

/// Write, or only check and show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WriteMode {
    /// Nothing is sent but reads.
    DryRun,
    /// Values are written and read back.
    Write,
    /// The same, and the drive saves them to non-volatile memory.
    Save,
}

impl Session {
    /// Plans assignments, and unless it is a dry run writes what is new and reads it back: [`plan_write`](Self::plan_write),
    /// then [`apply`](Self::apply).
    ///
    /// # Errors
    /// As both of them. A refused write is reported in the set: see [`ChangeSet::accepted`].
    pub async fn write(
        &mut self,
        drive: &mut Drive,
        assignments: &[Assignment],
        mode: WriteMode,
    ) -> Result<ChangeSet, Error> {
        let mut set = self
            .plan_write(drive, assignments, mode == WriteMode::Save)
            .await?;
        if mode != WriteMode::DryRun {
            self.apply(drive, &mut set).await?;
        }
        Ok(set)
    }

    /// Checks assignments against the tables, in their order, and reads the present values. What the drive has already is
    /// not written; with `save` all of it is, as a value that is there may not be saved yet. Nothing is written.
    ///
    /// # Errors
    /// A wrong assignment, or a drive that cannot be reached.
    pub async fn plan_write(
        &mut self,
        drive: &mut Drive,
        assignments: &[Assignment],
        save: bool,
    ) -> Result<ChangeSet, Error> {
        let mut wanted: Vec<(Selection, NewContent)> = Vec::new();
        for assignment in assignments {
            let selection = drive.parameters.select(&assignment.reference)?;
            if needs_scaling(&selection) {
                self.read_scaling(drive).await?;
            }
            let content = match drive.parameters.check_text(&selection, &assignment.value)? {
                Some(text) => NewContent::Text(text),
                None => NewContent::Number(drive.parameters.check(&selection, &assignment.value)?),
            };
            let place = |selection: &Selection| (selection.pnu, selection.first);
            if wanted.iter().any(|(other, _)| place(other) == place(&selection)) {
                let parameter = selection.label();
                return Err(ParameterProblem::Twice { parameter }.into());
            }
            wanted.push((selection, content));
        }
        let selections: Vec<Selection> = wanted.iter().map(|(selection, _)| *selection).collect();
        let old = self.present(drive, &selections).await?;
        let mut set = ChangeSet::new(drive, Condition::OffToScale);
        if save {
            set.save(drive)?;
        }
        for ((selection, content), old) in wanted.into_iter().zip(old) {
            let change = planned(drive, selection, content, old)?;
            set.push(drive, change);
        }
        set.skip_same();
        Ok(set)
    }

    /// Plans to give a drive values that it had before, in their order; those that it has already are not written.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn plan_values(&mut self, drive: &mut Drive, values: &[Reading]) -> Result<ChangeSet, Error> {
        let mut set = ChangeSet::new(drive, Condition::OffToScale);
        for value in values {
            let selection = drive.parameters.element(value.pnu, value.index);
            let change = Change::new(&drive.parameters, selection, value.clone());
            set.push(drive, change);
        }
        self.compare(drive, &mut set).await?;
        Ok(set)
    }

    /// The present values; `None` for a command, which has none.
    async fn present(
        &mut self,
        drive: &mut Drive,
        selections: &[Selection],
    ) -> Result<Vec<Option<Result<Reading, Refusal>>>, Error> {
        let readable: Vec<Selection> = selections
            .iter()
            .copied()
            .filter(|selection| !is_command(selection))
            .collect();
        let mut read = self.read(drive, &readable).await?.into_iter();
        let present = |selection| {
            if is_command(selection) { None } else { read.next() }
        };
        Ok(selections.iter().map(present).collect())
    }

    /// Reads the present values of a set and leaves out what the drive has already.
    async fn compare(&mut self, drive: &mut Drive, set: &mut ChangeSet) -> Result<(), Error> {
        let selections: Vec<Selection> = set.changes.iter().map(|change| change.selection).collect();
        let old = self.present(drive, &selections).await?;
        for (change, old) in set.changes.iter_mut().zip(old) {
            change.old = old;
            if change.is_same() {
                change.step = Step::Same;
            }
        }
        Ok(())
    }

    /// Writes what a set plans, in its order, reads it back and lets the drive save it where that is requested.
    ///
    /// # Errors
    /// When the power stage is on or comes on while it must be off ([`Condition`]), the drive is lost or the caller wants to
    /// stop. The set then says what was done, what was not, and what is in doubt. Refused values are reported in the set only.
    pub async fn apply(&mut self, drive: &mut Drive, set: &mut ChangeSet) -> Result<(), Error> {
        self.apply_kept(drive, set, &mut |_| Ok(())).await
    }

    /// The same with a journal: `keep` is given the set before and after each step that changes the drive. When it fails,
    /// nothing more is written.
    ///
    /// # Errors
    /// As [`apply`](Self::apply), and [`Error::Journal`] when `keep` fails.
    pub async fn apply_kept(
        &mut self,
        drive: &mut Drive,
        set: &mut ChangeSet,
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        let result = self.apply_all(drive, set, keep).await;
        set.end(result.as_ref().err().map(ToString::to_string));
        let kept = kept(drive, set, keep);
        result.and(kept)
    }

    /// Puts back what a set may have changed, as far as the old values are known, and returns the set that did. A caller's
    /// wish to stop does not interrupt it.
    ///
    /// # Errors
    /// As [`apply`](Self::apply).
    pub async fn undo(&mut self, drive: &mut Drive, set: &ChangeSet) -> Result<ChangeSet, Error> {
        let _meanwhile = self.unstoppable();
        let mut back = set.inverse();
        self.compare(drive, &mut back).await?;
        self.apply(drive, &mut back).await?;
        Ok(back)
    }

    /// Gives a drive values that it had before: [`plan_values`](Self::plan_values), then [`apply`](Self::apply).
    ///
    /// # Errors
    /// As both of them, and when the drive refuses.
    pub(super) async fn put_values_back(
        &mut self,
        drive: &mut Drive,
        values: &[Reading],
    ) -> Result<(), Error> {
        let mut set = self.plan_values(drive, values).await?;
        self.apply(drive, &mut set).await?;
        set.accepted()
    }

    async fn apply_all(
        &mut self,
        drive: &mut Drive,
        set: &mut ChangeSet,
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        self.check_off(drive, set).await?;
        kept(drive, set, keep)?;
        let mut due = set.places(|step| *step == Step::NotWritten);
        for _ in 0..=REPAIRS {
            self.write_due(drive, set, due, keep).await?;
            self.verify(drive, set).await?;
            kept(drive, set, keep)?;
            due = set.places(|step| *step == Step::Differs);
            if due.is_empty() || set.condition() != Condition::Off {
                break;
            }
        }
        self.apply_tasks(drive, set, keep).await?;
        self.save(drive, set, keep).await
    }

    async fn check_off(&mut self, drive: &mut Drive, set: &ChangeSet) -> Result<(), Error> {
        if set.condition() == Condition::Off {
            return self.at_rest(drive).await;
        }
        let scales = set.scales_setpoints(&drive.parameters);
        if scales && self.is_enabled(drive).await? == Some(true) {
            return Err(Error::NotAtRest {
                drive: drive.label(),
                what: "the power stage is on and another scale would give its setpoints another meaning",
            });
        }
        Ok(())
    }

    /// Writes the changes at `due`, and, of a set that is written phase by phase, again what was refused while something else
    /// was taken.
    async fn write_due(
        &mut self,
        drive: &mut Drive,
        set: &mut ChangeSet,
        mut due: Vec<usize>,
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        let by_phases = set.condition() == Condition::Off;
        while !due.is_empty() {
            for group in set.groups(&due, drive.model.dialect) {
                if by_phases {
                    self.glance()?;
                    self.at_rest(drive).await?;
                }
                self.write_group(drive, set, &group, keep).await?;
            }
            let refused = set.places(|step| matches!(step, Step::Refused(refusal) if may_change(refusal)));
            let again: Vec<usize> = due.iter().copied().filter(|at| refused.contains(at)).collect();
            if !by_phases || again.len() == due.len() {
                break;
            }
            due = again;
        }
        Ok(())
    }

    async fn write_group(
        &mut self,
        drive: &mut Drive,
        set: &mut ChangeSet,
        group: &[usize],
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        let outgoing = set.outgoing(group, drive.model.dialect);
        for &at in group {
            set.set(at, Step::InDoubt);
        }
        kept(drive, set, keep)?;
        // a change of a value that scales others counts from here on
        if set.scales(group, &drive.parameters) {
            drive.scaled_at = None;
        }
        let answers = self.change_saving(drive, set, &outgoing).await?;
        for (&at, answer) in group.iter().zip(answers) {
            set.set(at, answered(answer));
        }
        kept(drive, set, keep)
    }

    /// Writes with the request that saves too, where the set requests that and the drive supports it.
    async fn change_saving(
        &mut self,
        drive: &Drive,
        set: &mut ChangeSet,
        outgoing: &[Outgoing],
    ) -> Result<Vec<Result<(), Refusal>>, Error> {
        let id = set.request(drive.model.dialect);
        match self.change_as(id, drive, outgoing).await {
            Err(Error::UnknownRequest { .. }) if id != RequestId::Change => {
                set.save_by_command(drive)?;
                self.change(drive, outgoing).await
            }
            other => other,
        }
    }

    /// Reads everything back that was written, at the end: a later value can change an earlier one.
    async fn verify(&mut self, drive: &mut Drive, set: &mut ChangeSet) -> Result<(), Error> {
        let mut written = set.places(Step::is_written);
        written.retain(|&at| set.at(&[at]).iter().all(|change| !is_command(&change.selection)));
        let selections: Vec<Selection> = set.at(&written).iter().map(|change| change.selection).collect();
        let read = self.read(drive, &selections).await?;
        for (at, read) in written.into_iter().zip(read) {
            set.set_read_back(at, read);
        }
        Ok(())
    }

    /// Sends the command that saves, where the set has one and nothing speaks against it.
    async fn save(
        &mut self,
        drive: &mut Drive,
        set: &mut ChangeSet,
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        let may = set.may_save();
        let Some(command) = set.save_command.as_mut().filter(|_| may) else {
            return Ok(());
        };
        let outgoing = command.outgoing(drive.model.dialect);
        command.step = Step::InDoubt;
        kept(drive, set, keep)?;
        let answer = self.change(drive, &[outgoing]).await?.into_iter().next();
        if let (Some(command), Some(answer)) = (set.save_command.as_mut(), answer) {
            command.step = answered(answer);
        }
        Ok(())
    }
}

pub(super) fn kept(drive: &Drive, set: &ChangeSet, keep: &mut Keep<'_>) -> Result<(), Error> {
    keep(set).map_err(|source| Error::Journal {
        drive: drive.label(),
        source,
    })
}

const fn answered(answer: Result<(), Refusal>) -> Step {
    match answer {
        Ok(()) => Step::Written,
        Err(refusal) => Step::Refused(refusal),
    }
}

/// Whether another try can end differently once other values have changed.
fn may_change(refusal: &Refusal) -> bool {
    !refusal.is_unsent()
        && !matches!(
            refusal.number,
            ErrorNumber::UNKNOWN_PARAMETER | ErrorNumber::NOT_CHANGEABLE | ErrorNumber::NO_RIGHTS
        )
}
