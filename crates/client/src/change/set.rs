//! A set of changes: what it plans, how far it is, and what that means.

use profile::catalogue::{Phase, Role, Scaling};
use profile::parameter::{Dialect, Keep, RequestId, Saving, plan_changes, pnu};
use profile::value::{CheckedValue, Interpretation, Parameters, Reading, Selection};

use super::{Change, Condition, Outgoing, Saved, Step, TaskChange};
use crate::backup::Header;
use crate::wide::halves;
use crate::{Drive, Error, Refusal};

/// Changes of one drive, and how far each of them is.
#[derive(Debug, Clone)]
pub struct ChangeSet {
    pub(crate) changes: Vec<Change>,
    pub(crate) tasks: Vec<TaskChange>,
    condition: Condition,
    /// The new values are to be saved.
    pub(super) saves: bool,
    /// The command that saves, where a command is necessary.
    pub(crate) save_command: Option<Change>,
    /// When the drive saves most of its values.
    saving: Saving,
    drive: String,
    pub(super) header: Header,
    /// Tables and scaling of the drive before.
    pub(super) parameters: Parameters,
    /// Its scaling once everything is written.
    pub(super) after: Scaling,
    /// Why it ended before its end.
    pub(super) ended: Option<String>,
    pub(super) complete: bool,
}

impl ChangeSet {
    /// Without changes.
    pub(crate) fn new(drive: &Drive, condition: Condition) -> Self {
        Self {
            saving: drive.model.dialect.saving,
            drive: drive.label(),
            ..Self::of(Header::of(drive, None), drive.parameters, condition)
        }
    }

    /// The same for a drive of which only the head of a backup is known.
    pub(super) fn of(header: Header, parameters: Parameters, condition: Condition) -> Self {
        Self {
            changes: Vec::new(),
            tasks: Vec::new(),
            condition,
            saves: false,
            save_command: None,
            saving: header.known().dialect.saving,
            drive: header.station.clone(),
            header,
            parameters,
            after: parameters.scaling,
            ended: None,
            complete: false,
        }
    }

    /// Takes over what only the drive itself says: what its parameters are called and when it saves each of them.
    pub(crate) fn of_drive(&mut self, drive: &Drive) {
        self.saving = drive.model.dialect.saving;
        self.drive = drive.label();
        for change in &mut self.changes {
            let parameters = &drive.parameters;
            change.selection = parameters.element(change.new.pnu, change.new.index);
            change.saving = saving(drive, &change.selection);
        }
    }

    /// Adds a change.
    pub(crate) fn push(&mut self, drive: &Drive, change: Change) {
        let saving = saving(drive, &change.selection);
        self.changes.push(Change { saving, ..change });
    }

    /// Lets the drive save the new values once they are written.
    ///
    /// # Errors
    /// [`Error::UnknownModel`] when it needs a command for that which is not known.
    pub fn save(&mut self, drive: &Drive) -> Result<(), Error> {
        let dialect = drive.model.dialect;
        // of a whole set of settings nothing is saved before all of it is as planned
        let at_the_end = self.condition == Condition::Off || dialect.change_id(Keep::Permanent).is_none();
        if dialect.saving != Saving::Always && at_the_end {
            self.save_by_command(drive)?;
        }
        self.saves = true;
        Ok(())
    }

    /// Leaves out what the drive has already. What acts is carried out each time; so is everything behind something
    /// that is not a plain setting, as that may change what follows it. A set that is saved is written as a whole: a
    /// value that is there may not be saved yet.
    pub(crate) fn skip_same(&mut self) {
        let mut plain = !self.saves;
        for change in &mut self.changes {
            let same = change.is_same();
            plain &= is_plain(change.rule.map(|rule| rule.role), same);
            // a write saves it too, and whether that was done the value does not say
            if plain && same && change.saving != Saving::Always {
                change.step = Step::Same;
            }
        }
    }

    /// The changes, in the order of writing. The command that saves is not among them: see
    /// [`save_command`](Self::save_command).
    #[must_use]
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Motion tasks, which are written after everything else.
    #[must_use]
    pub fn tasks(&self) -> &[TaskChange] {
        &self.tasks
    }

    /// The command that saves the new values, where they are to be saved and the drive needs one. It is not sent where a
    /// value is not as planned.
    #[must_use]
    pub const fn save_command(&self) -> Option<&Change> {
        self.save_command.as_ref()
    }

    /// When the power stage has to be off.
    #[must_use]
    pub const fn condition(&self) -> Condition {
        self.condition
    }

    /// When the drive saves most of its values; a change may have a saving of its own.
    #[must_use]
    pub const fn saving(&self) -> Saving {
        self.saving
    }

    /// Tables and scaling of the drive before.
    #[must_use]
    pub const fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Tables and scaling as they are once everything is written: what the new values are in.
    #[must_use]
    pub fn parameters_after(&self) -> Parameters {
        Parameters {
            scaling: self.after,
            ..self.parameters
        }
    }

    /// Lowest and highest value of a change in its unit, where there are tables.
    #[must_use]
    pub fn limits(&self, change: &Change) -> Option<(f64, f64)> {
        let parameter = change.selection.parameter?;
        Some(self.parameters_after().limits(parameter))
    }

    /// How far everything is: values, then motion tasks.
    fn steps(&self) -> impl Iterator<Item = &Step> {
        let changes = self.changes.iter().map(|change| &change.step);
        changes.chain(self.tasks.iter().map(|task| &task.step))
    }

    /// How many values and motion tasks it has.
    #[must_use]
    pub fn total(&self) -> usize {
        self.changes.len() + self.tasks.len()
    }

    /// How many of them are at a step for which `which` is true.
    #[must_use]
    pub fn count(&self, which: impl Fn(&Step) -> bool) -> usize {
        self.steps().filter(|step| which(step)).count()
    }

    /// True when every change was tried and read back.
    #[must_use]
    pub const fn is_complete(&self) -> bool {
        self.complete
    }

    /// True when the drive has every new value.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.changes.iter().all(Change::is_done) && self.tasks.iter().all(|task| task.step == Step::ReadBack)
    }

    /// True when nothing keeps the drive from saving the new values.
    pub(crate) fn may_save(&self) -> bool {
        match self.condition {
            Condition::Off => self.is_done(),
            Condition::OffToScale => self.changes.iter().all(|change| change.step.is_written()),
        }
    }

    /// Whether the drive saved the new values.
    #[must_use]
    pub fn saved(&self) -> Saved {
        match self.save_command.as_ref().map(|command| command.step) {
            _ if !self.saves => Saved::No,
            Some(Step::InDoubt) => Saved::InDoubt,
            Some(Step::Refused(refusal)) => Saved::Refused(refusal),
            Some(step) if step.is_written() => Saved::Yes,
            // each write saves
            None if self.complete && (self.condition == Condition::OffToScale || self.is_done()) => {
                Saved::Yes
            }
            _ => Saved::No,
        }
    }

    /// True for a new value that the drive has and that outlives its power. A command leaves no value behind.
    #[must_use]
    pub fn is_saved(&self, change: &Change) -> bool {
        let saved = self.saved() == Saved::Yes || change.saving == Saving::Always;
        saved && change.step.is_written() && !change.acts && change.storable != Some(false)
    }

    /// Fails where a change was refused.
    ///
    /// # Errors
    /// [`Error::Refused`] with the first refusal.
    pub fn accepted(&self) -> Result<(), Error> {
        let changes = self.changes.iter().chain(&self.save_command);
        match changes.filter_map(Change::refusal).next() {
            Some(refusal) => Err(Error::Refused {
                drive: self.drive.clone(),
                refusal: *refusal,
            }),
            None => Ok(()),
        }
    }

    /// What puts back everything that this set may have changed, as far as the old values are known. Each value is
    /// compared with what the drive has then.
    pub(crate) fn inverse(&self) -> Self {
        let undone = |change: &Change| {
            let old = change.old.clone()?.ok()?;
            let undo = change.step.may_have_changed() && !change.acts;
            undo.then(|| Change {
                new: old,
                old: None,
                rounding: None,
                read_back: None,
                step: Step::NotWritten,
                ..change.clone()
            })
        };
        let mut changes: Vec<Change> = self.changes.iter().filter_map(undone).collect();
        if self.condition == Condition::OffToScale {
            changes.reverse();
        }
        let tasks = self.tasks.iter().filter(|task| task.step.may_have_changed());
        Self {
            changes,
            tasks: tasks
                .map(|task| TaskChange {
                    number: task.number,
                    old: task.new.clone(),
                    new: task.old.clone(),
                    step: Step::NotWritten,
                })
                .collect(),
            saves: matches!(self.saved(), Saved::Yes | Saved::InDoubt),
            save_command: self.save_command.clone().map(|command| Change {
                step: Step::NotWritten,
                ..command
            }),
            parameters: self.parameters_after(),
            after: self.parameters.scaling,
            ended: None,
            complete: false,
            ..self.clone()
        }
    }
}

/// What carries a set out.
impl ChangeSet {
    /// The places of the changes at a step for which `which` is true.
    pub(crate) fn places(&self, which: impl Fn(&Step) -> bool) -> Vec<usize> {
        let numbered = self.changes.iter().enumerate();
        numbered
            .filter(|(_, change)| which(&change.step))
            .map(|(at, _)| at)
            .collect()
    }

    /// The changes at these places.
    pub(crate) fn at(&self, places: &[usize]) -> Vec<&Change> {
        places.iter().filter_map(|&at| self.changes.get(at)).collect()
    }

    /// These changes as they are sent.
    pub(crate) fn outgoing(&self, places: &[usize], dialect: &Dialect) -> Vec<Outgoing> {
        let changes = self.at(places).into_iter();
        changes.map(|change| change.outgoing(dialect)).collect()
    }

    pub(crate) fn set(&mut self, at: usize, step: Step) {
        if let Some(change) = self.changes.get_mut(at) {
            change.step = step;
        }
    }

    pub(crate) fn set_task(&mut self, at: usize, step: Step) {
        if let Some(task) = self.tasks.get_mut(at) {
            task.step = step;
        }
    }

    /// Records what was read back of a change that was written.
    pub(crate) fn set_read_back(&mut self, at: usize, read: Result<Reading, Refusal>) {
        let Some(change) = self.changes.get_mut(at) else {
            return;
        };
        // what cannot be read, and what acts, stays what the drive confirmed
        change.step = match &read {
            Ok(reading) if !change.acts && change.is_in(reading) => Step::ReadBack,
            Ok(_) if !change.acts => Step::Differs,
            _ => Step::Written,
        };
        change.read_back = Some(read);
    }

    /// Records how it ended: why, where that was before its end.
    pub(crate) fn end(&mut self, early: Option<String>) {
        self.complete = early.is_none();
        self.ended = early;
    }

    /// True where setpoints of an axis that runs would get another meaning.
    pub(crate) fn scales_setpoints(&self, parameters: &Parameters) -> bool {
        let mut due = self
            .changes
            .iter()
            .filter(|change| change.step == Step::NotWritten);
        due.any(|change| change.scales_setpoints(parameters))
    }

    /// True where one of these changes scales other values.
    pub(crate) fn scales(&self, places: &[usize], parameters: &Parameters) -> bool {
        let mut changes = self.at(places).into_iter();
        changes.any(|change| change.scales(parameters))
    }

    /// The request that writes the values; that of the vendor which saves them too where the drive needs no command for it.
    pub(crate) fn request(&self, dialect: &Dialect) -> RequestId {
        let keep = match &self.save_command {
            None if self.saves => Keep::Permanent,
            _ => Keep::Volatile,
        };
        dialect.change_id(keep).unwrap_or(RequestId::Change)
    }

    /// The drive has no request that saves: its command does.
    pub(crate) fn save_by_command(&mut self, drive: &Drive) -> Result<(), Error> {
        self.save_command = Some(save_command(drive)?);
        Ok(())
    }

    /// Changes that go out in one request each: never one in two requests, and where the set is written phase by phase never
    /// of two phases.
    pub(crate) fn groups(&self, due: &[usize], dialect: &Dialect) -> Vec<Vec<usize>> {
        let mut groups: Vec<(Phase, Vec<usize>, Vec<usize>)> = Vec::new();
        for &at in due {
            let Some(change) = self.changes.get(at) else {
                continue;
            };
            // a 64-bit value goes to two numbers
            let own: Vec<usize> = halves(&change.selection, change.new.octets.clone())
                .iter()
                .map(|(_, octets)| octets.len())
                .collect();
            if let Some((phase, members, sizes)) = groups.last_mut() {
                let together = [sizes.as_slice(), &own].concat();
                let fits = *phase == change.phase() || self.condition == Condition::OffToScale;
                if fits && plan_changes(&together, dialect).len() == 1 {
                    members.push(at);
                    *sizes = together;
                    continue;
                }
            }
            groups.push((change.phase(), vec![at], own));
        }
        groups.into_iter().map(|(_, members, _)| members).collect()
    }
}

/// When a drive saves a value; one without a description is saved as most are.
fn saving(drive: &Drive, selection: &Selection) -> Saving {
    let parameter = selection.parameter;
    parameter.map_or(drive.model.dialect.saving, |parameter| drive.saving(parameter))
}

/// True for what does nothing but hold a value, and changes nothing that follows it.
const fn is_plain(role: Option<Role>, same: bool) -> bool {
    match role {
        // another name for a setting is that setting
        Some(Role::Setting | Role::Alias { .. }) => true,
        // changed, the telegram brings its own mapping with it
        Some(Role::Network) => same,
        _ => false,
    }
}

/// The command that lets a drive save its values; 1 executes it for every vendor.
fn save_command(drive: &Drive) -> Result<Change, Error> {
    let tables = drive.model.catalogue;
    let command = tables
        .and_then(|tables| tables.with_role(Role::Save).or_else(|| tables.by_pnu(pnu::SAVE)))
        .ok_or_else(|| Error::UnknownModel {
            drive: drive.label(),
            what: "how to save its parameters",
            vendor_id: drive.station.vendor_id,
            device_id: drive.station.device_id,
        })?;
    let selection = Selection::of(command, drive.parameters.notation());
    let format = command.format_in(drive.model.dialect);
    let mut octets = vec![0; command.octets()];
    if let Some(last) = octets.last_mut() {
        *last = 1;
    }
    let interpretation = Interpretation::of(format, drive.model.dialect.code_space);
    let new = drive
        .parameters
        .reading(&selection, 0, format.0, interpretation, &octets);
    let rounding = CheckedValue {
        raw: 1,
        engineering: 1.0,
        asked: 1.0,
        unit: "",
    };
    Ok(Change {
        rounding: Some(rounding),
        acts: true,
        ..Change::new(&drive.parameters, selection, new)
    })
}
