//! Saving the settings of a drive, and bringing them back.

use profile::catalogue::{Access, Part, Phase, Role};
use profile::notation::Notation;
use profile::parameter::{ErrorNumber, Format, Identifier, Saving, plan_changes};

use super::Session;
use super::authority::power_is_on;
use super::parameters::{Outgoing, saver};
use super::prepare::zsw1_of;
use crate::backup::{Backup, Change, Choice, Header, Journal, Plan, Saved, Step, Window, everything};
use crate::wide::halves;
use crate::{Drive, Error, Refusal};
use profile::value::{Interpretation, Selection};

/// The lists of all parameters of a drive.
pub(super) const LISTS: std::ops::RangeInclusive<u16> = 980..=989;
/// Status word as the profile numbers it, and its bits for operation and readiness for it.
const ZSW1: u16 = 968;
const ENABLED: i64 = 1 << 2 | 1 << 1;
/// Elements read between two looks at the progress: three full requests.
const PART: usize = 117;
/// How often what the drive changed by itself is written again.
const REPAIRS: usize = 2;

/// Where a journal is kept: on a disk, mostly.
pub type Keep<'k> = dyn FnMut(&Journal) -> Result<(), Box<dyn std::error::Error + Send + Sync>> + Send + 'k;

impl Session {
    /// The numbers of all parameters, as the drive itself lists them (PNU 980 and following).
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn numbers(&mut self, drive: &mut Drive) -> Result<Vec<u16>, Error> {
        let mut numbers: Vec<u16> = Vec::new();
        for list in LISTS {
            let selections = self.whole(drive, &[list]).await?;
            let found: Vec<u16> = self
                .read(drive, &selections)
                .await?
                .into_iter()
                .flatten()
                .filter_map(|reading| u16::try_from(reading.raw()?).ok())
                .take_while(|&pnu| pnu != 0)
                .collect();
            if found.is_empty() {
                break;
            }
            numbers.extend(found);
        }
        numbers.sort_unstable();
        numbers.dedup();
        Ok(numbers)
    }

    /// Every parameter that belongs into a backup: by the tables, else by what the drive says about its parameters.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn settings(&mut self, drive: &mut Drive) -> Result<Vec<Selection>, Error> {
        if drive.model.catalogue.is_some() && !drive.model.learned {
            return Ok(everything(&drive.model));
        }
        let numbers = self.numbers(drive).await?;
        let descriptions = self.descriptions(drive, &numbers).await?;
        let described = numbers.into_iter().zip(descriptions);
        Ok(described
            .filter(|(pnu, description)| {
                let read_only = description.is_some_and(|one| one.identifier.has(Identifier::READ_ONLY));
                !read_only && !LISTS.contains(pnu)
            })
            .map(|(pnu, description)| {
                let array = description.filter(|one| one.identifier.has(Identifier::ARRAY));
                Selection {
                    count: array.map_or(1, |one| one.elements.max(1)),
                    indexed: array.is_some(),
                    ..Selection::number(pnu, Notation::Name)
                }
            })
            .collect())
    }

    /// Reads all settings of a drive and its motion tasks. No setting is written; to see the tasks they are loaded into
    /// their edit window, which gets back what it had, and that only while the power stage is off and no controller is
    /// connected: else the header says why they are left out. `progress` is told how many parameters of how many were
    /// read.
    ///
    /// # Errors
    /// When the drive cannot be reached. A refused parameter stands in the backup as refused.
    pub async fn backup(
        &mut self,
        drive: &mut Drive,
        progress: &mut (dyn FnMut(usize, usize) + Send),
    ) -> Result<Backup, Error> {
        let settings = self.settings(drive).await?;
        let mut backup = self.backup_of(drive, &settings, progress).await?;
        let window = drive.model.catalogue.and_then(Window::of);
        let rows: Vec<u16> = window.map_or_else(Vec::new, |window| window.rows().collect());
        self.read_tasks(drive, &mut backup, &rows).await?;
        Ok(backup)
    }

    /// What a drive has where `like` says something: its parameters and motion tasks.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn backup_like(&mut self, drive: &mut Drive, like: &Backup) -> Result<Backup, Error> {
        // what the file calls a parameter is one of this drive
        let selections: Vec<Selection> = like
            .selections()
            .into_iter()
            .map(|selection| Selection {
                parameter: drive.parameters.at(selection.pnu, selection.first),
                notation: drive.parameters.notation(),
                ..selection
            })
            .filter(|selection| {
                selection
                    .parameter
                    .is_none_or(|one| one.access != Access::WriteOnly)
            })
            .collect();
        let mut backup = self.backup_of(drive, &selections, &mut |_, _| {}).await?;
        self.read_tasks(drive, &mut backup, &like.task_numbers()).await?;
        Ok(backup)
    }

    /// The same for chosen parameters, without motion tasks. Nothing is written.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn backup_of(
        &mut self,
        drive: &mut Drive,
        selections: &[Selection],
        progress: &mut (dyn FnMut(usize, usize) + Send),
    ) -> Result<Backup, Error> {
        let identity = self.identity(drive).await?;
        // the scaling that the values are read with is that of the drive
        drive.scaled = false;
        self.read_scaling(drive).await?;
        let mut answers = Vec::new();
        for (at, part) in selections.chunks(PART).enumerate() {
            progress(at * PART, selections.len());
            answers.extend(self.read(drive, part).await?);
        }
        progress(selections.len(), selections.len());
        let mut parameters = drive.parameters;
        if drive.model.learned {
            // whoever reads the text has no tables of it
            parameters.catalogue = None;
        }
        Ok(Backup::new(
            Header::of(drive, identity.as_ref()),
            parameters,
            answers,
        ))
    }

    /// What restoring `wanted` would write; nothing is written.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn plan(&mut self, drive: &mut Drive, wanted: &Backup, choice: &Choice) -> Result<Plan, Error> {
        let present = self.backup_like(drive, wanted).await?;
        Ok(Plan::new(wanted, &present, choice))
    }

    /// True when the power stage is on; `None` when the drive does not tell.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn is_enabled(&mut self, drive: &mut Drive) -> Result<Option<bool>, Error> {
        let active = drive
            .model
            .catalogue
            .and_then(|tables| tables.with_role(Role::Active));
        if let Some(active) = active {
            let selection = Selection::of(active, drive.parameters.notation());
            let reading = self.read(drive, &[selection]).await?.into_iter().next();
            let raw = reading.and_then(Result::ok).and_then(|reading| reading.raw());
            return Ok(raw.map(|raw| raw != 0));
        }
        if drive.model.learned_or_none().is_some() {
            // only this number is sure to be the status word of a drive without tables
            let selection = Selection::number(ZSW1, Notation::Name);
            let reading = self.read(drive, &[selection]).await?.into_iter().next();
            let raw = reading.and_then(Result::ok).and_then(|reading| reading.raw());
            return Ok(raw.map(|raw| raw & ENABLED != 0));
        }
        let telegram = self.telegram_now(drive).await?;
        let readings = self
            .ask(
                drive,
                &[Part::ControlWord, Part::StatusWord, Part::ControlProfile],
            )
            .await?;
        let zsw1 = zsw1_of(drive, &readings, telegram);
        // the motor turns as long as it is stopped too
        Ok(zsw1.map(power_is_on))
    }

    /// Writes what the plan of `journal` says, in its order, and reads it back; `save` lets the drive keep it. `keep` is
    /// given the journal before and after each step that changes the drive: when it fails, nothing more is written.
    ///
    /// What the drive refuses is tried again as long as others succeed: a limit may have to move first. What it changed
    /// by itself afterwards is written again. It is saved only when every value is as planned.
    ///
    /// # Errors
    /// When the power stage is on or comes on, the drive is lost, the caller wants to stop or `keep` fails. The journal
    /// then says what was done, what was not, and what is in doubt. Refused values are told in the journal only.
    pub async fn restore(
        &mut self,
        drive: &mut Drive,
        journal: &mut Journal,
        save: bool,
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        let result = self.restore_all(drive, journal, save, keep).await;
        match &result {
            Ok(()) => journal.complete(),
            Err(error) => journal.end(&error.to_string()),
        }
        let kept = kept(drive, journal, keep);
        result.and(kept)
    }

    async fn restore_all(
        &mut self,
        drive: &mut Drive,
        journal: &mut Journal,
        save: bool,
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        let changes = journal.plan().changes.clone();
        self.at_rest(drive).await?;
        kept(drive, journal, keep)?;
        let mut due: Vec<usize> = (0..changes.len()).collect();
        for _ in 0..=REPAIRS {
            self.write_all(drive, journal, &changes, &due, keep).await?;
            self.look_back(drive, journal, &changes).await?;
            kept(drive, journal, keep)?;
            due = places(journal, |step| *step == Step::Differs);
            if due.is_empty() {
                break;
            }
        }
        self.restore_tasks(drive, journal, keep).await?;
        if save && journal.is_done() {
            self.save(drive, journal, keep).await?;
        }
        Ok(())
    }

    /// Writes the changes at `due`, and again what was refused while something else was taken.
    async fn write_all(
        &mut self,
        drive: &mut Drive,
        journal: &mut Journal,
        changes: &[Change],
        due: &[usize],
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        let mut due = due.to_vec();
        while !due.is_empty() {
            for group in groups(changes, &due, drive) {
                self.glance()?;
                self.at_rest(drive).await?;
                self.write_group(drive, journal, changes, &group, keep).await?;
            }
            let refused: Vec<usize> = due
                .iter()
                .copied()
                .filter(|&at| matches!(journal.steps().get(at), Some(Step::Refused(refusal)) if may_change(refusal)))
                .collect();
            if refused.len() == due.len() {
                break;
            }
            due = refused;
        }
        Ok(())
    }

    async fn write_group(
        &mut self,
        drive: &mut Drive,
        journal: &mut Journal,
        changes: &[Change],
        group: &[usize],
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        let outgoing: Vec<Outgoing> = group
            .iter()
            .filter_map(|&at| changes.get(at))
            .map(|change| outgoing(drive, change))
            .collect();
        for &at in group {
            journal.set(at, Step::InDoubt);
        }
        kept(drive, journal, keep)?;
        // a scaling may be among them
        drive.scaled = false;
        let answers = self.change(drive, &outgoing).await?;
        for (&at, answer) in group.iter().zip(answers) {
            let step = match answer {
                Ok(()) => Step::Written,
                Err(refusal) => Step::Refused(refusal),
            };
            journal.set(at, step);
        }
        kept(drive, journal, keep)
    }

    /// Reads everything back that was written, at the end: a later value can change an earlier one.
    async fn look_back(
        &mut self,
        drive: &mut Drive,
        journal: &mut Journal,
        changes: &[Change],
    ) -> Result<(), Error> {
        let written = places(journal, |step| {
            matches!(step, Step::Written | Step::ReadBack | Step::Differs)
        });
        let selections: Vec<Selection> = written
            .iter()
            .filter_map(|&at| changes.get(at))
            .map(|change| selection(drive, change))
            .collect();
        let back = self.read(drive, &selections).await?;
        for (&at, back) in written.iter().zip(back) {
            let Some(change) = changes.get(at) else { continue };
            // what cannot be read stays what the drive said: written
            let step = match back {
                Ok(reading) if reading.octets == change.new.octets => Step::ReadBack,
                Ok(_) => Step::Differs,
                Err(_) => Step::Written,
            };
            journal.set(at, step);
        }
        Ok(())
    }

    async fn save(
        &mut self,
        drive: &mut Drive,
        journal: &mut Journal,
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        if drive.model.dialect.saving == Saving::Always {
            journal.set_saved(Saved::Yes);
            return Ok(());
        }
        let command = saver(drive)?;
        let selection = Selection::of(command, drive.parameters.notation());
        let outgoing = Outgoing {
            selection,
            format: command.format_in(drive.model.dialect),
            count: 1,
            octets: vec![0; command.octets().saturating_sub(1)]
                .into_iter()
                .chain([1])
                .collect(),
        };
        journal.set_saved(Saved::InDoubt);
        kept(drive, journal, keep)?;
        let answer = self.change(drive, &[outgoing]).await?.into_iter().next();
        journal.set_saved(match answer {
            Some(Ok(())) => Saved::Yes,
            Some(Err(refusal)) => Saved::Refused(refusal),
            None => Saved::InDoubt,
        });
        Ok(())
    }

    pub(super) async fn at_rest(&mut self, drive: &mut Drive) -> Result<(), Error> {
        let what = match self.is_enabled(drive).await? {
            Some(false) => return Ok(()),
            Some(true) => "the power stage is on",
            None => "the drive does not tell whether its power stage is on",
        };
        Err(Error::NotAtRest {
            drive: drive.label(),
            what,
        })
    }
}

pub(super) fn kept(drive: &Drive, journal: &Journal, keep: &mut Keep<'_>) -> Result<(), Error> {
    keep(journal).map_err(|source| Error::Journal {
        drive: drive.label(),
        source,
    })
}

/// Changes that go out in one request each: never of two phases, never one in two requests.
fn groups(changes: &[Change], due: &[usize], drive: &Drive) -> Vec<Vec<usize>> {
    let mut groups: Vec<(Phase, Vec<usize>, Vec<usize>)> = Vec::new();
    for &at in due {
        let Some(change) = changes.get(at) else { continue };
        // a 64-bit value goes to two numbers
        let own: Vec<usize> = halves(&selection(drive, change), change.new.octets.clone())
            .iter()
            .map(|(_, octets)| octets.len())
            .collect();
        if let Some((phase, members, sizes)) = groups.last_mut() {
            let together = [sizes.as_slice(), &own].concat();
            if *phase == change.phase && plan_changes(&together, drive.model.dialect).len() == 1 {
                members.push(at);
                *sizes = together;
                continue;
            }
        }
        groups.push((change.phase, vec![at], own));
    }
    groups.into_iter().map(|(_, members, _)| members).collect()
}

fn places(journal: &Journal, which: impl Fn(&Step) -> bool) -> Vec<usize> {
    let numbered = journal.steps().iter().enumerate();
    numbered
        .filter(|(_, step)| which(step))
        .map(|(at, _)| at)
        .collect()
}

fn selection(drive: &Drive, change: &Change) -> Selection {
    drive.parameters.element(change.new.pnu, change.new.index)
}

fn outgoing(drive: &Drive, change: &Change) -> Outgoing {
    let format = Format(change.new.format);
    let octets = change.new.octets.clone();
    let count = match Interpretation::of(format, drive.model.dialect.code_space) {
        Interpretation::Text | Interpretation::Octets => u8::try_from(octets.len()).unwrap_or(u8::MAX),
        _ => 1,
    };
    Outgoing {
        selection: selection(drive, change),
        format,
        count,
        octets,
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
