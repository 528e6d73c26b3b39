//! Reading the settings of a drive into a backup, and planning to restore one.

use profile::catalogue::{Access, Part, Role};
use profile::notation::Notation;
use profile::parameter::{Identifier, pnu};

use super::Session;
use super::authority::power_is_on;
use super::readings::zsw1_of;
use crate::backup::{Backup, Header, Window, everything};
use crate::change::{Choice, Plan};
use crate::{Drive, Error};
use profile::value::Selection;

/// The lists of all parameters of a drive.
pub(super) const LISTS: std::ops::RangeInclusive<u16> = 980..=989;
/// Status word as the profile numbers it, and its bits for operation and readiness for it.
const ZSW1: u16 = 968;
const ENABLED: i64 = 1 << 2 | 1 << 1;
/// Elements read between two looks at the progress: three full requests.
const PART: usize = 117;
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

    /// Reads all settings of a drive and its motion tasks. No setting is written. Motion tasks are loaded into the edit
    /// window of the drive, whose content is restored. They are read only while the power stage is off and no
    /// controller is connected; otherwise the header has the reason for leaving them out. `progress` receives how many
    /// settings and motion tasks are read, and their total.
    ///
    /// # Errors
    /// When the drive cannot be reached. A refused parameter stands in the backup as refused.
    pub async fn backup(
        &mut self,
        drive: &mut Drive,
        progress: &mut (dyn FnMut(usize, usize) + Send),
    ) -> Result<Backup, Error> {
        let settings = self.settings(drive).await?;
        let window = drive.model.catalogue.and_then(Window::of);
        let rows: Vec<u16> = window.map_or_else(Vec::new, |window| window.rows().collect());
        let all = settings.len() + rows.len();
        let mut backup = self
            .backup_of(drive, &settings, &mut |done, _| progress(done, all))
            .await?;
        let telegram = Selection::number(pnu::TELEGRAM, drive.parameters.notation());
        let telegram = self.read(drive, &[telegram]).await?.into_iter().flatten().next();
        backup.header.telegram = telegram.and_then(|reading| u16::try_from(reading.raw()?).ok());
        self.read_tasks(drive, &mut backup, &rows, &mut |done| {
            progress(settings.len() + done, all)
        })
        .await?;
        progress(all, all);
        Ok(backup)
    }

    /// What a drive has where `like` says something: its parameters and motion tasks.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn backup_like(&mut self, drive: &mut Drive, like: &Backup) -> Result<Backup, Error> {
        self.backup_like_with(drive, like, &mut |_, _| {}).await
    }

    /// The same; `progress` receives how many settings and motion tasks are read, and how many there are.
    async fn backup_like_with(
        &mut self,
        drive: &mut Drive,
        like: &Backup,
        progress: &mut (dyn FnMut(usize, usize) + Send),
    ) -> Result<Backup, Error> {
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
        let tasks = like.task_numbers();
        let (settings, all) = (selections.len(), selections.len() + tasks.len());
        let mut backup = self
            .backup_of(drive, &selections, &mut |done, _| progress(done, all))
            .await?;
        self.read_tasks(drive, &mut backup, &tasks, &mut |done| {
            progress(settings + done, all)
        })
        .await?;
        progress(all, all);
        Ok(backup)
    }

    /// The settings of a drive as its model is delivered: those whose delivered value the tables have. Reads what scales
    /// values, so that they compare with those of the drive ([`backup_like`](Self::backup_like)).
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn as_delivered(&mut self, drive: &mut Drive) -> Result<Backup, Error> {
        drive.scaled_at = None;
        self.read_scaling(drive).await?;
        Ok(Backup::as_delivered(drive))
    }

    /// As [`backup`](Self::backup) for chosen parameters, without motion tasks. Nothing is written.
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
        drive.scaled_at = None;
        self.read_scaling(drive).await?;
        let mut answers = Vec::new();
        for (at, part) in selections.chunks(PART).enumerate() {
            progress(at * PART, selections.len());
            answers.extend(self.look_for(drive, part).await?);
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

    /// What restoring `wanted` writes and leaves out. Nothing is written before its set is [applied](Self::apply).
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn plan(&mut self, drive: &mut Drive, wanted: &Backup, choice: &Choice) -> Result<Plan, Error> {
        self.plan_reporting(drive, wanted, choice, &mut |_, _| {}).await
    }

    /// The same; `progress` receives how many settings and motion tasks are read, and how many there are.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn plan_reporting(
        &mut self,
        drive: &mut Drive,
        wanted: &Backup,
        choice: &Choice,
        progress: &mut (dyn FnMut(usize, usize) + Send),
    ) -> Result<Plan, Error> {
        let present = self.backup_like_with(drive, wanted, progress).await?;
        let mut plan = Plan::new(wanted, &present, choice);
        plan.set.of_drive(drive);
        Ok(plan)
    }

    /// Returns true when the power stage is on; `None` when the drive does not report it.
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

    pub(super) async fn at_rest(&mut self, drive: &mut Drive) -> Result<(), Error> {
        let what = match self.is_enabled(drive).await? {
            Some(false) => return Ok(()),
            Some(true) => "the power stage is on",
            None => "the drive does not report whether its power stage is on",
        };
        Err(Error::NotAtRest {
            drive: drive.label(),
            what,
        })
    }
}
