//! Motion tasks: rows of a table inside the drive, which shows one row at a time in a window of parameters.

use std::fmt::{self, Write as _};

use profile::catalogue::{Catalogue, Parameter, Part};
use profile::notation::Notation;
use profile::notation::setting::shorten;
use profile::parameter::{CodeSpace, Format};

use super::{Backup, Pattern, print};
use profile::value::{Interpretation, Parameters, Reading, Selection};

/// What a row has, in the order of a line.
const FIELDS: [Part; 8] = [
    Part::TaskPosition,
    Part::TaskVelocity,
    Part::TaskAcceleration,
    Part::TaskDeceleration,
    Part::TaskControl,
    Part::TaskNext,
    Part::TaskDwell,
    Part::TaskProfile,
];
/// Those of which one that is 0 makes a row an empty one, as places among the fields.
const NEVER_ZERO: std::ops::RangeInclusive<usize> = 1..=3;
/// What a line of an empty row says.
const EMPTY: &str = "empty";

/// The window of a model that has motion tasks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    pub number: &'static Parameter,
    pub fields: [&'static Parameter; FIELDS.len()],
    pub load: &'static Parameter,
    pub set: &'static Parameter,
    pub clear: &'static Parameter,
}

impl Window {
    /// Of a model with these tables, if it has motion tasks.
    pub fn of(tables: &'static Catalogue) -> Option<Self> {
        let number = tables.part(Part::TaskNumber)?;
        let mut fields = [number; FIELDS.len()];
        for (place, part) in fields.iter_mut().zip(FIELDS) {
            *place = tables.part(part)?;
        }
        Some(Self {
            number,
            fields,
            load: tables.part(Part::LoadTask)?,
            set: tables.part(Part::SetTask)?,
            clear: tables.part(Part::ClearTask)?,
        })
    }

    /// The words of a line, each in front of its value.
    fn words(&self) -> String {
        self.fields.map(|field| word(field.name)).join(", ")
    }

    /// Every row there is.
    pub fn rows(&self) -> std::ops::RangeInclusive<u16> {
        let (_, last) = self.number.raw_limits(&profile::catalogue::Scaling::default());
        1..=u16::try_from(last).unwrap_or(u16::MAX)
    }
}

/// What a file says about motion tasks as a whole.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum TaskCoverage {
    /// Nothing: only the lines that are there count.
    #[default]
    Nothing,
    /// All of them: a task without a line is empty.
    All,
    /// They were not read, and why.
    LeftOut(String),
}

impl TaskCoverage {
    pub(super) fn line(&self) -> Option<String> {
        match self {
            Self::Nothing => None,
            Self::All => Some("all, one without a line is empty".to_owned()),
            Self::LeftOut(why) => Some(format!("left out, {why}")),
        }
    }

    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let (word, rest) = text.split_once(',').unwrap_or((text, ""));
        match word.trim() {
            "all" => Ok(Self::All),
            "left out" => Ok(Self::LeftOut(rest.trim().to_owned())),
            _ => Err(format!("`tasks: {text}`: either `all` or `left out`")),
        }
    }
}

/// One motion task of a drive or a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Task {
    /// There is none of this number.
    Empty,
    /// Its values: position, velocity, acceleration, deceleration, control word, next task, dwell, profile.
    Values(Vec<Reading>),
}

impl Task {
    /// Out of what the window shows; a task without speed or ramp is none.
    pub(crate) fn new(values: Vec<Reading>) -> Self {
        let zero = |at: usize| values.get(at).is_none_or(|value| value.raw() == Some(0));
        if NEVER_ZERO.into_iter().any(zero) {
            Self::Empty
        } else {
            Self::Values(values)
        }
    }

    /// Its values; none of an empty task.
    #[must_use]
    pub fn values(&self) -> &[Reading] {
        match self {
            Self::Empty => &[],
            Self::Values(values) => values,
        }
    }

    /// The same number in the same place of the same size: what a drive shows of it.
    pub(crate) fn is_as(&self, other: &Self) -> bool {
        let (one, other) = (self.values(), other.values());
        one.len() == other.len() && one.iter().zip(other).all(|(a, b)| a.raw() == b.raw())
    }

    /// In units, for people.
    #[must_use]
    pub fn text(&self, parameters: &Parameters) -> String {
        let Self::Values(values) = self else {
            return EMPTY.to_owned();
        };
        let mut text = String::new();
        for value in values {
            let separator = if text.is_empty() { "" } else { ", " };
            let name = value.name.unwrap_or_default();
            let _ = write!(
                text,
                "{separator}{} {}",
                word(name),
                print::value(parameters, value)
            );
        }
        text
    }
}

/// `V` of `MT.V_32`.
fn word(name: &str) -> &str {
    let name = name.split_once('.').map_or(name, |(_, name)| name);
    name.strip_suffix("_32").unwrap_or(name)
}

/// `MT[3]`
pub(super) struct Name(pub u16);

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "MT[{}]", self.0)
    }
}

impl Name {
    /// The number of a line, when it is one of a task.
    pub fn parse(text: &str) -> Option<Result<u16, String>> {
        let number = text.strip_prefix("MT[")?.strip_suffix(']')?.trim();
        Some(
            number
                .parse()
                .map_err(|_| format!("{text}: write the number of the task, MT[1]")),
        )
    }
}

/// A task out of its line. `read` makes the number of one field out of its text.
pub(super) fn parse(
    number: u16,
    text: &str,
    parameters: &Parameters,
    read: impl Fn(&str, &'static Parameter) -> Result<i64, String>,
) -> Result<Task, String> {
    let name = Name(number);
    let window = parameters
        .catalogue
        .and_then(Window::of)
        .ok_or_else(|| format!("{name}: this model has no motion tasks that are known"))?;
    let rows = window.rows();
    if !rows.contains(&number) {
        return Err(format!(
            "{name}: there are tasks {} to {}",
            rows.start(),
            rows.end()
        ));
    }
    if text == EMPTY {
        return Ok(Task::Empty);
    }
    let mut found: [Option<i64>; FIELDS.len()] = [None; FIELDS.len()];
    for part in text.split(',') {
        let part = part.trim();
        let (first, value) = part.split_once(char::is_whitespace).unwrap_or((part, ""));
        let mut fields = window.fields.iter();
        let at = fields
            .position(|field| word(field.name) == first)
            .ok_or_else(|| format!("{name}: `{}` is none of {}", shorten(first), window.words()))?;
        let (Some(place), Some(&parameter)) = (found.get_mut(at), window.fields.get(at)) else {
            continue;
        };
        if place.is_some() {
            return Err(format!("{name}: {first} stands there twice"));
        }
        *place = Some(read(value.trim(), parameter).map_err(|what| format!("{name}: {what}"))?);
    }
    let mut values = Vec::new();
    for (at, (raw, parameter)) in found.into_iter().zip(window.fields).enumerate() {
        let needed = at <= *NEVER_ZERO.end();
        match raw {
            None if needed => return Err(format!("{name}: {} is missing", word(parameter.name))),
            Some(0) if NEVER_ZERO.contains(&at) => {
                return Err(format!(
                    "{name}: with {} 0 it is not a task; write `{EMPTY}`",
                    word(parameter.name)
                ));
            }
            _ => values.push(field(parameters, parameter, raw.unwrap_or(0))),
        }
    }
    Ok(Task::Values(values))
}

/// A number as the drive would show it.
pub(crate) fn field(parameters: &Parameters, parameter: &'static Parameter, raw: i64) -> Reading {
    let octets = raw.to_be_bytes();
    let octets = octets
        .get(octets.len() - parameter.octets()..)
        .unwrap_or_default();
    let format = Format(parameter.size.format_code());
    let interpretation = Interpretation::of(format, CodeSpace::V4);
    parameters.reading(
        &Selection::of(parameter, Notation::Name),
        0,
        format.0,
        interpretation,
        octets,
    )
}

/// The same task in the numbers of another scaling; nothing when it is scaled alike.
pub(crate) fn scaled(task: &Task, from: &Parameters, to: &Parameters) -> Task {
    let Task::Values(values) = task else {
        return Task::Empty;
    };
    let tables = to.catalogue;
    let values =
        values.iter().map(
            |value| match (tables.and_then(|tables| tables.by_pnu(value.pnu)), value.raw()) {
                (Some(parameter), Some(raw)) => {
                    field(to, parameter, to.converted(parameter, raw, &from.scaling))
                }
                _ => value.clone(),
            },
        );
    Task::Values(values.collect())
}

/// A motion task that is not the same on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskDifference {
    /// Its number.
    pub number: u16,
    /// The first side.
    pub left: Task,
    /// The second side.
    pub right: Task,
}

impl Backup {
    /// One motion task; `None` where nothing is said about it.
    #[must_use]
    pub fn task(&self, number: u16) -> Option<&Task> {
        match self.tasks.get(&number) {
            Some(task) => Some(task),
            None if self.header.tasks == TaskCoverage::All => Some(&Task::Empty),
            None => None,
        }
    }

    /// Numbers of the motion tasks of which something is said.
    #[must_use]
    pub fn task_numbers(&self) -> Vec<u16> {
        let window = self.parameters.catalogue.and_then(Window::of);
        match (&self.header.tasks, window) {
            (TaskCoverage::All, Some(window)) => window.rows().collect(),
            _ => self.tasks.keys().copied().collect(),
        }
    }

    /// Takes a motion task in.
    pub(crate) fn put_task(&mut self, number: u16, task: Task) {
        if task == Task::Empty && self.header.tasks == TaskCoverage::All {
            self.tasks.remove(&number);
        } else {
            self.tasks.insert(number, task);
        }
    }

    /// How many motion tasks it has that are not empty.
    #[must_use]
    pub fn task_count(&self) -> usize {
        self.tasks.values().filter(|task| **task != Task::Empty).count()
    }
}

/// Every motion task of which both sides say something, and not the same. Values count as they are in units.
#[must_use]
pub fn compare_tasks(left: &Backup, right: &Backup) -> Vec<TaskDifference> {
    left.task_numbers()
        .into_iter()
        .filter_map(|number| {
            let (one, other) = (left.task(number)?, right.task(number)?);
            let same = scaled(one, &left.parameters, &right.parameters).is_as(other);
            (!same).then(|| TaskDifference {
                number,
                left: one.clone(),
                right: other.clone(),
            })
        })
        .collect()
}

/// True when a person means this task: `MT*`, `MT[3]`.
pub(crate) fn is_meant(only: &[Pattern], number: u16) -> bool {
    only.is_empty() || only.iter().any(|one| one.means_task(number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::{AKD, Role};

    #[test]
    fn the_window_is_one_of_the_tables() {
        let window = Window::of(&AKD).unwrap();
        assert_eq!(window.rows(), 1..=128);
        for parameter in window.fields.iter().chain([&window.number]) {
            assert_eq!(
                AKD.backup_rule(parameter.pnu).role,
                Role::Window,
                "{}",
                parameter.name
            );
        }
        assert_eq!(window.words(), "P, V, ACC, DEC, CNTL, MTNEXT, TNEXT, TNUM");
    }

    fn file(lines: &str) -> Result<Backup, String> {
        let head = "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\n\
                    scaling: position 1000\n";
        Backup::read(format!("{head}{lines}\n")).map_err(|error| error.to_string())
    }

    #[test]
    fn one_line_for_each_task() {
        let text = "MT[1] = P 196608 counts, V 300 rpm, ACC 3000 rpm/s, DEC 50 rps/s, CNTL 0x10, MTNEXT 6, TNEXT 0.25 s";
        let backup = file(&format!("tasks: all\nMT[3] = empty\n{text}")).unwrap();
        assert_eq!((backup.task_count(), backup.task(3)), (1, Some(&Task::Empty)));
        assert_eq!(backup.task_numbers().len(), 128);
        let line = "\nMT[1] = P 196608 counts, V 300 rpm, ACC 3000 rpm/s, DEC 3000 rpm/s, CNTL 0x00000010, MTNEXT 6, TNEXT 250 ms, TNUM 0\n";
        let printed = backup.to_string();
        assert!(printed.contains(line), "{printed}");
        assert!(
            printed.contains("\ntasks: all, one without a line is empty\n") && !printed.contains("MT[3]")
        );
        assert_eq!(Backup::read(&printed).unwrap(), backup);
        // of a part only, an empty task has a line, and nothing is said of the others
        let part = file("MT[3] = empty").unwrap();
        assert_eq!((part.task(3), part.task(4)), (Some(&Task::Empty), None));
        assert!(part.to_string().contains("\nMT[3] = empty\n"));
        assert_ne!(part, file("").unwrap());
        let left = file("tasks: left out, the power stage is on").unwrap();
        assert!(left.task_numbers().is_empty());
        assert!(
            left.to_string()
                .contains("\ntasks: left out, the power stage is on\n")
        );
    }

    #[test]
    fn invalid_tasks_are_reported() {
        for (line, words) in [
            ("MT[129] = empty", "line 6: MT[129]: there are tasks 1 to 128"),
            ("MT[x] = empty", "write the number of the task"),
            ("MT[1] = P 1", "MT[1]: V is missing"),
            ("MT[1] = P 1, P 2", "P stands there twice"),
            ("MT[1] = Q 1", "`Q` is none of P, V, ACC"),
            ("MT[1] = P 1, V 0, ACC 1, DEC 1", "with V 0 it is not a task"),
            ("MT[1] = P 1 A, V 1, ACC 1, DEC 1", "`A` is a unit of current"),
            ("tasks: some", "either `all` or `left out`"),
            ("MT[1] = empty\nMT[1] = empty", "MT[1] stands in line 6 already"),
        ] {
            let error = file(line).unwrap_err();
            assert!(error.contains(words), "{line}: {error}");
        }
    }

    #[test]
    fn tasks_differ_only_when_both_sides_list_them() {
        let task = |speed: &str| format!("MT[1] = P 1, V {speed}, ACC 1000, DEC 1000");
        let one = file(&task("300 rpm")).unwrap();
        let other = file(&format!(
            "tasks: all\n{}\nMT[2] = P 1, V 1, ACC 1, DEC 1",
            task("5 rps")
        ))
        .unwrap();
        assert!(compare_tasks(&one, &other).is_empty());
        let faster = file(&task("301 rpm")).unwrap();
        assert_eq!(compare_tasks(&faster, &other)[0].number, 1);
        let none = file("tasks: all").unwrap();
        let numbers: Vec<u16> = compare_tasks(&other, &none)
            .iter()
            .map(|one| one.number)
            .collect();
        assert_eq!(numbers, [1, 2]);
        let check_reported = file("tasks: left out, the power stage is on").unwrap();
        assert!(compare_tasks(&other, &check_reported).is_empty());
    }
}
