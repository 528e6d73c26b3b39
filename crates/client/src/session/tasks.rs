//! Motion tasks through their window: read, written back, and the window left as it was.

use profile::catalogue::{Parameter, Role};
use profile::notation::Notation;
use profile::parameter::{Format, plan_changes};

use super::Session;
use super::change::{Keep, kept};
use crate::axis::Objection;
use crate::backup::{Backup, Task, TaskCoverage, Window};
use crate::change::{ChangeSet, Outgoing, Step, TaskChange};
use crate::{Drive, Error, Refusal};
use profile::value::{Reading, Selection};

/// Motion tasks written between two times that the journal is kept.
const BATCH: usize = 16;
/// A task that a positioning order fills, and mostly an empty one.
const ZERO: u16 = 0;

/// What one look through the window showed.
enum Look {
    Task(Task),
    /// Why there is nothing to see.
    Not(String),
}

impl Session {
    /// Reads motion tasks into a backup, or records the reason for leaving them out. Each is loaded into the edit
    /// window of the drive (MT.NUM, MT.LOAD), whose content is restored. This moves nothing but could disturb another
    /// user of the window. So tasks are read only while the power stage is off and no controller is connected.
    pub(super) async fn read_tasks(
        &mut self,
        drive: &mut Drive,
        backup: &mut Backup,
        numbers: &[u16],
        progress: &mut (dyn FnMut(usize) + Send),
    ) -> Result<(), Error> {
        let Some(window) = drive.model.catalogue.and_then(Window::of) else {
            return Ok(());
        };
        let result = self.tasks(drive, &window, numbers, progress).await?;
        match result {
            Ok(tasks) => {
                backup.header.tasks = if window.rows().eq(numbers.iter().copied()) {
                    TaskCoverage::All
                } else {
                    TaskCoverage::Nothing
                };
                for (&number, task) in numbers.iter().zip(tasks) {
                    backup.put_task(number, task);
                }
            }
            Err(why) => backup.header.tasks = TaskCoverage::LeftOut(why),
        }
        Ok(())
    }

    /// Checks what a drive can say in advance against a task of its table: that the axis is homed,
    /// that the feedrate is not 0 and that there is such a task. The table is read as for a backup and not changed; where that is not
    /// possible, because a controller is connected for example, the task is taken at the caller's word.
    ///
    /// # Errors
    /// [`Error::Objections`] with everything that speaks against it, and when the drive cannot be reached.
    pub async fn check_task(&mut self, drive: &mut Drive, number: u16) -> Result<(), Error> {
        let facts = self.motion_facts(drive).await?;
        let mut objections = Vec::new();
        if facts.homed == Some(false) {
            objections.push(Objection::NotHomed);
        }
        if facts.feedrate == Some(0.0) {
            objections.push(Objection::Feedrate);
        }
        let window = drive.model.catalogue.and_then(Window::of);
        let row = match window {
            Some(window) if window.rows().contains(&number) => {
                self.tasks(drive, &window, &[number], &mut |_| {}).await?.ok()
            }
            Some(_) => Some(vec![Task::Empty]),
            None => None,
        };
        if row.is_some_and(|row| row.contains(&Task::Empty)) {
            objections.push(Objection::NoTask { number });
        }
        if objections.is_empty() {
            return Ok(());
        }
        Err(Error::Objections {
            drive: drive.label(),
            objections,
        })
    }

    async fn tasks(
        &mut self,
        drive: &mut Drive,
        window: &Window,
        numbers: &[u16],
        progress: &mut (dyn FnMut(usize) + Send),
    ) -> Result<Result<Vec<Task>, String>, Error> {
        if numbers.is_empty() {
            return Ok(Ok(Vec::new()));
        }
        match self.is_enabled(drive).await? {
            Some(false) => {}
            Some(true) => return Ok(Err("the power stage is on".to_owned())),
            None => {
                return Ok(Err(
                    "the drive does not report whether its power stage is on".to_owned()
                ));
            }
        }
        if let Some(Some(name)) = self.owner(drive).await? {
            return Ok(Err(format!("controller \"{name}\" is connected")));
        }
        let Some(before) = self.window(drive, window).await? else {
            return Ok(Err("the drive does not report its task values".to_owned()));
        };
        let mut tasks = Vec::with_capacity(numbers.len());
        let mut ended = None;
        for &number in numbers {
            progress(tasks.len());
            match self.look(drive, window, number).await {
                Ok(Look::Task(task)) => tasks.push(task),
                Ok(Look::Not(why)) => {
                    ended = Some(why);
                    break;
                }
                Err(error) => {
                    if is_there(&error) {
                        let _ = self.put_back(drive, window, &before, None).await;
                    }
                    return Err(error);
                }
            }
        }
        let empty = numbers.iter().zip(&tasks).find(|(_, task)| **task == Task::Empty);
        let back = self
            .put_back(drive, window, &before, empty.map(|(number, _)| *number))
            .await?;
        Ok(match (ended, back) {
            (Some(why), _) => Err(why),
            (None, false) => Err(
                "the edit window of the table did not take back what it had before they were read".to_owned(),
            ),
            (None, true) => Ok(tasks),
        })
    }

    /// What the window shows: its number, then its fields.
    async fn window(&mut self, drive: &mut Drive, window: &Window) -> Result<Option<Vec<Reading>>, Error> {
        let selections: Vec<Selection> = parameters(window).map(shown).collect();
        Ok(self
            .read(drive, &selections)
            .await?
            .into_iter()
            .collect::<Result<_, _>>()
            .ok())
    }

    /// Loads a row of the table into the window and reads it.
    async fn look(&mut self, drive: &mut Drive, window: &Window, number: u16) -> Result<Look, Error> {
        let orders = [
            outgoing(window.number, i64::from(number)),
            outgoing(window.load, 1),
        ];
        for answer in self.change(drive, &orders).await? {
            if let Err(refusal) = answer {
                return Ok(Look::Not(format!(
                    "the drive refused to show task {number}: {}",
                    refusal.words()
                )));
            }
        }
        let active = drive
            .model
            .catalogue
            .and_then(|tables| tables.with_role(Role::Active));
        let selections: Vec<Selection> = parameters(window).chain(active).map(shown).collect();
        let shown: Result<Vec<Reading>, _> = self.read(drive, &selections).await?.into_iter().collect();
        let Ok(mut shown) = shown else {
            return Ok(Look::Not(format!("the drive does not report task {number}")));
        };
        if active.is_some() && shown.pop().is_none_or(|active| active.raw() != Some(0)) {
            return Ok(Look::Not("the power stage came on".to_owned()));
        }
        let shows = shown.remove(0);
        if shows.raw() != Some(i64::from(number)) {
            let name = window.number.name;
            return Ok(Look::Not(format!("another client uses {name}")));
        }
        Ok(Look::Task(Task::new(shown)))
    }

    /// Gives the window what it had. A 0 where none can be written is that of an empty task, which has to be loaded first.
    /// False when the window is not as it was. A person who stops the program waits for this.
    async fn put_back(
        &mut self,
        drive: &mut Drive,
        window: &Window,
        before: &[Reading],
        empty: Option<u16>,
    ) -> Result<bool, Error> {
        let _meanwhile = self.unstoppable();
        self.try_put_back(drive, window, before, empty).await
    }

    async fn try_put_back(
        &mut self,
        drive: &mut Drive,
        window: &Window,
        before: &[Reading],
        empty: Option<u16>,
    ) -> Result<bool, Error> {
        let scaling = drive.parameters.scaling;
        let writable = |value: &&Reading| {
            let parameter = parameters(window).find(|one| one.pnu == value.pnu);
            parameter.zip(value.raw()).is_some_and(|(parameter, raw)| {
                let (low, high) = parameter.raw_limits(&scaling);
                (low..=high).contains(&raw)
            })
        };
        if before.iter().any(|value| !writable(&value)) {
            self.look(drive, window, empty.unwrap_or(ZERO)).await?;
        }
        // the number last, so that the window is not mistaken for another row meanwhile
        let order = before.iter().skip(1).chain(before.first()).filter(writable);
        let values: Vec<Outgoing> = order
            .filter_map(|value| {
                let parameter = parameters(window).find(|one| one.pnu == value.pnu)?;
                Some(outgoing(parameter, value.raw()?))
            })
            .collect();
        self.change_in_groups(drive, &values).await?;
        let after = self.window(drive, window).await?;
        Ok(after.is_some_and(|after| {
            after.len() == before.len() && after.iter().zip(before).all(|(a, b)| a.octets == b.octets)
        }))
    }

    /// Writes in as few requests as it takes; the first refusal.
    async fn change_in_groups(
        &mut self,
        drive: &Drive,
        values: &[Outgoing],
    ) -> Result<Option<Refusal>, Error> {
        let sizes: Vec<usize> = values.iter().map(|value| value.octets.len().max(4)).collect();
        let mut refused = None;
        for group in plan_changes(&sizes, drive.model.dialect) {
            let answers = self.change(drive, values.get(group).unwrap_or_default()).await?;
            let refusal = answers.into_iter().find_map(Result::err);
            refused = refused.or(refusal);
        }
        Ok(refused)
    }

    /// Writes the motion tasks of a set and reads each back.
    pub(super) async fn apply_tasks(
        &mut self,
        drive: &mut Drive,
        set: &mut ChangeSet,
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        let tasks = set.tasks.clone();
        let window = drive.model.catalogue.and_then(Window::of);
        let (Some(window), false) = (window, tasks.is_empty()) else {
            return Ok(());
        };
        let before = self.window(drive, &window).await?;
        let mut result = Ok(());
        for (batch, changes) in tasks.chunks(BATCH).enumerate() {
            result = self
                .apply_batch(drive, &window, set, (batch * BATCH, changes), keep)
                .await;
            if result.is_err() {
                break;
            }
        }
        let lost = result.as_ref().is_err_and(|error| !is_there(error));
        let Some(before) = before.filter(|_| !lost) else {
            return result;
        };
        let empty = tasks.iter().find(|change| change.new == Task::Empty);
        let back = self
            .put_back(drive, &window, &before, empty.map(|change| change.number))
            .await;
        result.and(back.map(|_| ()))
    }

    async fn apply_batch(
        &mut self,
        drive: &mut Drive,
        window: &Window,
        set: &mut ChangeSet,
        (first, changes): (usize, &[TaskChange]),
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        self.glance()?;
        self.at_rest(drive).await?;
        for at in 0..changes.len() {
            set.set_task(first + at, Step::InDoubt);
        }
        kept(drive, set, keep)?;
        for (at, change) in changes.iter().enumerate() {
            let step = match self.write_task(drive, window, change).await? {
                Some(refusal) => Step::Refused(refusal),
                None => match self.look(drive, window, change.number).await? {
                    Look::Task(task) if task.is_as(&change.new) => Step::ReadBack,
                    Look::Task(_) => Step::Differs,
                    Look::Not(_) => Step::Written,
                },
            };
            set.set_task(first + at, step);
        }
        kept(drive, set, keep)
    }

    /// The table takes a row only when the window has taken all of it.
    async fn write_task(
        &mut self,
        drive: &Drive,
        window: &Window,
        change: &TaskChange,
    ) -> Result<Option<Refusal>, Error> {
        let number = i64::from(change.number);
        let values = match &change.new {
            Task::Empty => {
                return self
                    .change_in_groups(drive, &[outgoing(window.clear, number)])
                    .await;
            }
            Task::Values(values) => values,
        };
        let values = values.iter().zip(window.fields);
        let values = values.filter_map(|(value, parameter)| Some(outgoing(parameter, value.raw()?)));
        let all: Vec<Outgoing> = [outgoing(window.number, number)]
            .into_iter()
            .chain(values)
            .collect();
        match self.change_in_groups(drive, &all).await? {
            None => self.change_in_groups(drive, &[outgoing(window.set, 1)]).await,
            refused => Ok(refused),
        }
    }
}

/// The drive is still there to be put in order.
const fn is_there(error: &Error) -> bool {
    matches!(
        error,
        Error::Interrupted | Error::NotAtRest { .. } | Error::Journal { .. }
    )
}

fn parameters(window: &Window) -> impl Iterator<Item = &'static Parameter> + use<> {
    [window.number].into_iter().chain(window.fields)
}

/// Returns a parameter of the window. Vendors with motion tasks name parameters by text.
fn shown(parameter: &'static Parameter) -> Selection {
    Selection::of(parameter, Notation::Name)
}

fn outgoing(parameter: &'static Parameter, raw: i64) -> Outgoing {
    let octets = raw.to_be_bytes();
    let octets = octets.get(octets.len() - parameter.octets()..);
    Outgoing {
        selection: shown(parameter),
        format: Format(parameter.size.format_code()),
        count: 1,
        octets: octets.unwrap_or_default().to_vec(),
    }
}
