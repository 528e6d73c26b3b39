//! What restoring would do: which values, from what to what, in which order, and what is left out and why.

use profile::catalogue::{Parameter, Phase, Role, Scaling};

use super::{Change, ChangeSet, Condition, Step, TaskChange};
use crate::Refusal;
use crate::backup::{Backup, IdentityDifference, Pattern, Task, TaskCoverage, rule, selection, task};
use profile::value::take_scale;
use profile::value::{Content, Interpretation, Parameters, Reading, Selection};

/// Options of a restore.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Choice {
    /// Only what one of these means; everything when there is none.
    pub only: Vec<Pattern>,
    /// Also what belongs to the connection: telegram, command source, way to get an address.
    pub network: bool,
    /// Only what the drive keeps when it is switched off.
    pub saved_only: bool,
    /// Also values outside the limits of the tables: the drive then decides.
    pub beyond_limits: bool,
}

/// Why a value of the file is not written.
#[derive(Debug, Clone, PartialEq)]
pub enum Skip {
    /// The drive has this value.
    Same,
    /// It cannot be written.
    ReadOnly,
    /// The drive does not have it, or does not report its value.
    Unreadable(Refusal),
    /// The drive's value has another size.
    Size {
        /// Octets in the drive.
        drive: usize,
        /// Octets in the file.
        file: usize,
    },
    /// Outside the limits.
    Limits {
        /// Lowest value.
        minimum: f64,
        /// Highest value.
        maximum: f64,
        /// Their unit.
        unit: &'static str,
    },
    /// The drive forgets it when it is switched off.
    NotSaved,
    /// Belongs to the connection.
    Network(&'static str),
    /// A setpoint or an output.
    Setpoint(&'static str),
    /// Writing it does something.
    Action(&'static str),
    /// Shows one row of a table.
    Window,
    /// Written by the drive itself.
    State,
    /// The same as another parameter.
    Alias(&'static str),
}

impl std::fmt::Display for Skip {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let because = |f: &mut std::fmt::Formatter<'_>, what: &str, why: &str| {
            f.write_str(what)?;
            if why.is_empty() {
                Ok(())
            } else {
                write!(f, ": {why}")
            }
        };
        match self {
            Self::Same => f.write_str("same value"),
            Self::ReadOnly => f.write_str("read-only"),
            Self::Unreadable(refusal) if refusal.is_unsent() => f.write_str(&refusal.words()),
            Self::Unreadable(refusal) => write!(f, "the drive does not report it: {}", refusal.words()),
            Self::Size { drive, file } => write!(f, "{file} octets in the file, {drive} in the drive"),
            Self::Limits {
                minimum,
                maximum,
                unit,
            } => {
                write!(f, "outside {minimum} to {maximum}")?;
                if unit.is_empty() {
                    Ok(())
                } else {
                    write!(f, " {unit}")
                }
            }
            Self::NotSaved => f.write_str("the drive forgets it when it is switched off"),
            Self::Network(why) => because(f, "belongs to the connection", why),
            Self::Setpoint(why) => because(f, "a setpoint", why),
            Self::Action(why) => because(f, "writing it does something", why),
            Self::Window => f.write_str("shows one row of a table of the drive"),
            Self::State => f.write_str("the drive itself writes it"),
            Self::Alias(name) => write!(f, "the same as {name}"),
        }
    }
}

impl Skip {
    /// Returns true where the file requests something that the drive cannot have; everything else is left out by rule
    /// or wish.
    #[must_use]
    pub const fn is_refusal(&self) -> bool {
        matches!(
            self,
            Self::ReadOnly | Self::Unreadable(_) | Self::Size { .. } | Self::Limits { .. }
        )
    }
}

/// A value of the file that is not written.
#[derive(Debug, Clone, PartialEq)]
pub struct Skipped {
    /// The value of the file.
    pub reading: Reading,
    /// Why.
    pub why: Skip,
}

/// A motion task of the file that is not written.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskSkipped {
    /// Its number.
    pub number: u16,
    /// Why.
    pub why: Skip,
}

/// What restoring a backup writes, and what it leaves out.
#[derive(Debug, Clone)]
pub struct Plan {
    /// What is written.
    pub set: ChangeSet,
    /// What is not, by number.
    pub skipped: Vec<Skipped>,
    /// Motion tasks that are not.
    pub tasks_skipped: Vec<TaskSkipped>,
    /// Why the motion tasks of the file are left out all together, where they are.
    pub tasks_left_out: Option<String>,
}

impl Plan {
    /// Returns the writes that bring a drive from `present` to `wanted`. `present` holds the drive's answer
    /// for each value of `wanted`.
    #[must_use]
    pub fn new(wanted: &Backup, present: &Backup, choice: &Choice) -> Self {
        let mut set = ChangeSet::of(present.header.clone(), *present.parameters(), Condition::Off);
        let mut skipped = Vec::new();
        let chosen: Vec<&Reading> = wanted
            .readings()
            .iter()
            .filter(|reading| choice.only.is_empty() || choice.only.iter().any(|one| one.means(reading)))
            .collect();
        // the scalings first: they decide what the other numbers of the file will be
        for first in [true, false] {
            for reading in &chosen {
                let is_first = rule(&set.parameters, reading.pnu, reading.index).phase == Phase::Scaling;
                if is_first != first {
                    continue;
                }
                match decide(wanted, present, reading, choice, &set.after) {
                    Ok(change) => {
                        if let Some(number) = change.new.number() {
                            let at = (change.new.pnu, change.new.index);
                            let tables = set.parameters.catalogue;
                            tables.and_then(|tables| take_scale(tables, &mut set.after, at, number));
                        }
                        set.changes.push(change);
                    }
                    Err(why) => skipped.push(Skipped {
                        reading: (*reading).clone(),
                        why,
                    }),
                }
            }
        }
        set.changes
            .sort_by_key(|change| (change.phase(), change.new.pnu, change.new.index));
        skipped.sort_by_key(|skipped| (skipped.reading.pnu, skipped.reading.index));
        let mut plan = Self {
            set,
            skipped,
            tasks_skipped: Vec::new(),
            tasks_left_out: None,
        };
        plan.plan_tasks(wanted, present, choice);
        plan
    }

    fn plan_tasks(&mut self, wanted: &Backup, present: &Backup, choice: &Choice) {
        let numbers = wanted.task_numbers();
        let meant = numbers
            .into_iter()
            .filter(|&number| task::is_meant(&choice.only, number));
        let here = self.set.parameters_after();
        for number in meant {
            let Some(new) = wanted.task(number) else { continue };
            let Some(old) = present.task(number) else {
                if let TaskCoverage::LeftOut(why) = &present.header.tasks {
                    self.tasks_left_out = Some(why.clone());
                }
                continue;
            };
            if (new, old) == (&Task::Empty, &Task::Empty) {
                continue;
            }
            match decide_task(wanted, present, new, old, choice, &here) {
                Ok(new) => self.set.tasks.push(TaskChange {
                    number,
                    old: old.clone(),
                    new,
                    step: Step::NotWritten,
                }),
                Err(why) => self.tasks_skipped.push(TaskSkipped { number, why }),
            }
        }
    }

    /// What differs between the drive that the settings are of (left) and this one (right).
    #[must_use]
    pub fn identity_differences(&self, wanted: &Backup) -> Vec<IdentityDifference> {
        wanted.header.differences(&self.set.header)
    }

    /// Returns true when nothing of the file fits what was chosen.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        self.set.total() == 0
            && self.skipped.is_empty()
            && self.tasks_skipped.is_empty()
            && self.tasks_left_out.is_none()
    }

    /// Returns the number of values and motion tasks that are the same in drive and file.
    #[must_use]
    pub fn same(&self) -> usize {
        self.skipped.len() + self.tasks_skipped.len() - self.left_out()
    }

    /// Returns the number of values and motion tasks that are left out although they differ.
    #[must_use]
    pub fn left_out(&self) -> usize {
        self.reasons().filter(|why| **why != Skip::Same).count()
    }

    /// Returns the number of values and motion tasks of the file that the drive cannot have.
    #[must_use]
    pub fn refused(&self) -> usize {
        self.reasons().filter(|why| why.is_refusal()).count()
    }

    fn reasons(&self) -> impl Iterator<Item = &Skip> {
        let tasks = self.tasks_skipped.iter().map(|skipped| &skipped.why);
        self.skipped.iter().map(|skipped| &skipped.why).chain(tasks)
    }
}

fn decide(
    wanted: &Backup,
    present: &Backup,
    reading: &Reading,
    choice: &Choice,
    scaling: &Scaling,
) -> Result<Change, Skip> {
    let now = present.parameters();
    let rule = rule(now, reading.pnu, reading.index);
    match rule.role {
        // what need not be written needs no reason why it is not
        Role::Network if unchanged(wanted, present, reading) => return Err(Skip::Same),
        Role::Setting => {}
        Role::Network if choice.network => {}
        Role::Network => return Err(Skip::Network(rule.why)),
        Role::Setpoint => return Err(Skip::Setpoint(rule.why)),
        Role::Action | Role::Save | Role::ClearFaults => return Err(Skip::Action(rule.why)),
        Role::Window => return Err(Skip::Window),
        Role::State => return Err(Skip::State),
        Role::Alias { of } => {
            let other = now.catalogue.and_then(|tables| tables.by_pnu(of));
            return Err(Skip::Alias(other.map_or("another", |other| other.name)));
        }
        Role::Active => return Err(Skip::ReadOnly),
    }
    let selection = selection(now, reading);
    if selection.writable() == Some(false) {
        return Err(if unchanged(wanted, present, reading) {
            Skip::Same
        } else {
            Skip::ReadOnly
        });
    }
    let Some(old) = present.reading(reading.pnu, reading.index) else {
        let refused = present.refused().iter().find(|refusal| {
            refusal.shown.pnu == reading.pnu
                && (refusal.shown.index == reading.index || refusal.shown.index.is_none())
        });
        return Err(refused.map_or(Skip::ReadOnly, |refusal| Skip::Unreadable(*refusal)));
    };
    let new = match (selection.parameter, reading.raw()) {
        (Some(parameter), Some(raw)) => {
            let here = Parameters {
                scaling: *scaling,
                ..*now
            };
            let target = here.converted(parameter, raw, &wanted.parameters().scaling);
            // a value that is scaled again is written again, whatever number it has now
            if old.raw() == Some(target) && now.scales_as(parameter, scaling) {
                return Err(Skip::Same);
            }
            within(parameter, target, choice, &here)?;
            in_size_of(&here, &selection, old, target)?
        }
        _ if old.octets == reading.octets => return Err(Skip::Same),
        _ if old.octets.len() != reading.octets.len() => {
            return Err(Skip::Size {
                drive: old.octets.len(),
                file: reading.octets.len(),
            });
        }
        // the drive says what kind of value it is
        _ => now.reading(&selection, 0, old.format, like(old), &reading.octets),
    };
    let change = Change {
        old: Some(Ok(old.clone())),
        rule: Some(rule),
        ..Change::new(now, selection, new)
    };
    if choice.saved_only && change.storable == Some(false) {
        return Err(Skip::NotSaved);
    }
    Ok(change)
}

/// Returns the task as the drive shall have it, in its numbers.
fn decide_task(
    wanted: &Backup,
    present: &Backup,
    new: &Task,
    old: &Task,
    choice: &Choice,
    here: &Parameters,
) -> Result<Task, Skip> {
    let now = present.parameters();
    let target = task::scaled(new, wanted.parameters(), here);
    let tables = now.catalogue;
    let parameter = |value: &Reading| tables.and_then(|tables| tables.by_pnu(value.pnu));
    let scaled_anew = old
        .values()
        .iter()
        .filter_map(parameter)
        .any(|parameter| !now.scales_as(parameter, &here.scaling));
    if target.is_as(old) && !scaled_anew {
        return Err(Skip::Same);
    }
    for value in target.values() {
        if let (Some(parameter), Some(raw)) = (parameter(value), value.raw()) {
            within(parameter, raw, choice, here)?;
        }
    }
    Ok(target)
}

/// Returns whether the drive has the same number, and it means the same there.
fn unchanged(wanted: &Backup, present: &Backup, reading: &Reading) -> bool {
    present.reading(reading.pnu, reading.index).is_some_and(|old| {
        old.raw() == reading.raw()
            && old.number() == reading.number()
            && (old.raw().is_some() || old.octets == reading.octets)
            && wanted.parameters().catalogue.is_some() == present.parameters().catalogue.is_some()
    })
}

fn within(parameter: &Parameter, raw: i64, choice: &Choice, here: &Parameters) -> Result<(), Skip> {
    let (low, high) = parameter.raw_limits(&here.scaling);
    if choice.beyond_limits || (low..=high).contains(&raw) {
        return Ok(());
    }
    let (minimum, maximum) = here.limits(parameter);
    Err(Skip::Limits {
        minimum,
        maximum,
        unit: parameter.unit_in(&here.scaling),
    })
}

/// Returns the number in the size and format in which the drive has it.
pub(crate) fn in_size_of(
    here: &Parameters,
    selection: &Selection,
    old: &Reading,
    raw: i64,
) -> Result<Reading, Skip> {
    let width = old.octets.len();
    let size = selection
        .parameter
        .map_or(width, |parameter| parameter.size.octets());
    let bits = 8 * u32::try_from(width).unwrap_or(8);
    let fits = bits >= 64 || (bits > 0 && (-(1_i64 << (bits - 1)) <= raw && raw < 1_i64 << bits));
    if !fits || width > 8 {
        return Err(Skip::Size {
            drive: width,
            file: size,
        });
    }
    let octets = raw.to_be_bytes();
    let octets = octets.get(octets.len() - width..).unwrap_or_default();
    Ok(here.reading(selection, 0, old.format, Interpretation::Plain, octets))
}

/// As the drive's own value was read.
const fn like(old: &Reading) -> Interpretation {
    match old.content {
        Content::Number { .. } => Interpretation::Plain,
        Content::Float(_) => Interpretation::Float,
        Content::Text(_) => Interpretation::Text,
        Content::Octets => Interpretation::Octets,
    }
}
