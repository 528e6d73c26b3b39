//! A command for one drive or for many: found, worked on side by side, and shown together.

use std::sync::atomic::{AtomicBool, Ordering};

use client::{Drive, ErrorKind, Session, Wait};
use profidrive::fleet::{self, Member};
use profidrive::report::{self, Drives, OfDrive};
use profidrive::{Part, Sum, listed};
use serde::Serialize;

use crate::advice::Commands;
use crate::args::Target;
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::Table;

/// Gets how much of how much is done.
pub type Progress<'p> = dyn FnMut(usize, usize) + Send + 'p;

/// What a command does with a drive.
pub trait Each: Shown {
    /// What is being done, beside the progress.
    const DOING: &'static str;

    /// What the command needs of the network.
    fn need(&self) -> Need {
        Need::Records
    }

    /// Works on a drive and prints nothing. `progress` gets how much of how much is done.
    async fn work(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        progress: &mut Progress<'_>,
    ) -> Result<Self::Done, Failure>;
}

/// How the work on a drive is shown.
pub trait Shown {
    /// What comes of the work on a drive.
    type Done;
    /// The same for programs.
    type Report: Serialize;
    /// The columns of many drives, behind their names.
    const COLUMNS: &'static [&'static str];
    /// What is the matter with drives that have problems, which the table shows: `kept from running`. `None` where each
    /// problem has a message of its own.
    const MATTER: Option<&'static str> = None;

    /// Returns what programs get.
    fn report(&self, done: &Self::Done, drive: &Drive) -> Self::Report;

    /// Prints what came of the only drive.
    fn show(&self, done: &Self::Done, drive: &Drive, output: &Output);

    /// Says what is to be known of the only drive beside what was printed, for programs and people alike.
    fn remark(&self, _done: &Self::Done, _drive: &Drive, _output: &Output) {}

    /// The same for many drives.
    fn remark_on_all(&self, _rows: &[Row<Self::Done>], _output: &Output) {}

    /// Returns the rows of one of many drives, without its name.
    fn rows(&self, done: &Self::Done, drive: &Drive) -> Vec<Vec<String>>;

    /// Returns the row of a drive without a result, without its name. The message of one that answered stands below the table.
    fn missing_row(&self, answered: bool) -> Option<Vec<String>> {
        (!answered).then(|| vec!["no answer".to_owned()])
    }

    /// Returns what is not as it should be; the last one ends the command.
    fn problems(&self, _done: &Self::Done, _drive: &Drive) -> Vec<Failure> {
        Vec::new()
    }

    /// Among many, drives with a higher number come first.
    fn urgency(&self, _done: &Self::Done) -> u8 {
        0
    }
}

/// Carries out a command for the drives that are meant.
pub fn run(verb: &impl Each, target: &Target, output: &Output) -> Result<(), Failure> {
    if connect::selector(target, output)?.single().is_some() {
        one(verb, target, output)
    } else {
        many(verb, target, output)
    }
}

fn one<V: Each>(verb: &V, target: &Target, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(target, verb.need(), output)?;
    let bar = connect::bar(output, 0, V::DOING);
    let mut progress = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let done = verb.work(&mut session, &mut drive, &mut progress).wait();
    bar.finish_and_clear();
    let done = done?;
    session.close().wait()?;
    shown_alone(verb, &done, &drive, output)
}

/// Shows what came of the work on the only drive.
pub fn shown_alone<V: Shown>(
    verb: &V,
    done: &V::Done,
    drive: &Drive,
    output: &Output,
) -> Result<(), Failure> {
    verb.remark(done, drive, output);
    output.json_report(&verb.report(done, drive));
    if !output.json() {
        verb.show(done, drive, output);
    }
    last(verb.problems(done, drive), output)
}

/// Prints all but the last problem at once; the last one ends the command.
pub fn last<E: Into<Failure>>(problems: Vec<E>, output: &Output) -> Result<(), Failure> {
    let mut problems: Vec<Failure> = problems.into_iter().map(E::into).collect();
    let last = problems.pop();
    for problem in problems {
        output.problem(&problem);
    }
    last.map_or(Ok(()), Err)
}

/// One of many drives, its work done.
pub struct Row<D> {
    /// The drive, or the part of the selection that found none.
    pub name: String,
    /// The drive, where one was found.
    pub drive: Option<Drive>,
    /// What came of the work.
    pub done: Option<D>,
    /// What is not as it should be.
    pub problems: Vec<Failure>,
}

impl<D> Row<D> {
    /// From what became of the work; `problems` are those of a drive that answered.
    pub fn new<E: Into<Failure>>(
        member: Member<Result<D, E>>,
        problems: impl FnOnce(&D, &Drive) -> Vec<Failure>,
    ) -> Self {
        let Member { name, drive, result } = member;
        let (done, problems) = match (result, &drive) {
            (Ok(done), Some(drive)) => {
                let problems = problems(&done, drive);
                (Some(done), problems)
            }
            (Ok(done), None) => (Some(done), Vec::new()),
            (Err(error), _) => (None, vec![error.into()]),
        };
        Self {
            name,
            drive,
            done,
            problems,
        }
    }

    /// Returns what programs get of it.
    pub fn entry<R>(&self, report: impl FnOnce(&D, &Drive) -> R) -> OfDrive<R> {
        let error = self.problems.last().map(|failure| {
            report::Error::new(
                failure.kind,
                &failure.message,
                &failure.details,
                &failure.hint,
                &Commands(&self.name),
            )
        });
        let done = self.done.as_ref().zip(self.drive.as_ref());
        OfDrive {
            drive: self.name.clone(),
            report: done.map(|(done, drive)| report(done, drive)),
            error,
        }
    }
}

/// Carries out a command for drives of which there may be several.
pub fn many<V: Each>(verb: &V, target: &Target, output: &Output) -> Result<(), Failure> {
    let (mut session, found) = connect::drives(target, verb.need(), output)?;
    let bar = connect::bar(output, found.members.len(), V::DOING);
    // verbs that count their work are shown by it, others by the drives that are done
    let counted = AtomicBool::new(false);
    let sum = Sum::new(Part::Drives, found.members.len(), |step| {
        counted.store(true, Ordering::Relaxed);
        bar.set_length(step.all as u64);
        bar.set_position(step.done as u64);
    });
    let members = fleet::each(&session, found.members, async |session, drive| {
        let name = drive.label();
        let mut progress = |done, all| sum.report(&name, done, all);
        let done = verb.work(session, drive, &mut progress).await;
        if !counted.load(Ordering::Relaxed) {
            bar.inc(1);
        }
        done
    });
    let members = members.wait();
    bar.finish_and_clear();
    // what could be read is shown, whatever became of the rest
    let closed = session.close().wait();
    shown(verb, members, found.left_out, output)?;
    Ok(closed?)
}

/// Shows what came of the work on many drives, and returns how the command ends.
pub fn shown<V: Shown, E: Into<Failure>>(
    verb: &V,
    members: Vec<Member<Result<V::Done, E>>>,
    left_out: Vec<String>,
    output: &Output,
) -> Result<(), Failure> {
    let row = |member| Row::new(member, |done, drive| verb.problems(done, drive));
    let mut rows: Vec<Row<V::Done>> = members.into_iter().map(row).collect();
    rows.sort_by_key(|row| std::cmp::Reverse(row.done.as_ref().map_or(u8::MAX, |done| verb.urgency(done))));
    table(verb, rows.iter().map(TableRow::of), output);
    if !left_out.is_empty() {
        let left_out = left_out.join(", ");
        output.say(&format!("left out, as they are no drives: {left_out}"));
    }
    output.json_report(&Drives {
        drives: rows
            .iter()
            .map(|row| row.entry(|done, drive| verb.report(done, drive)))
            .collect(),
        left_out,
    });
    verb.remark_on_all(&rows, output);
    ended(&rows, V::MATTER, output)
}

/// What a table shows of a drive.
pub struct TableRow<'a, D> {
    /// Its name.
    pub name: &'a str,
    /// What came of it, where something did.
    pub done: Option<(&'a D, &'a Drive)>,
    /// Whether it answered at all.
    pub answered: bool,
}

impl<'a, D> TableRow<'a, D> {
    fn of(row: &'a Row<D>) -> Self {
        Self {
            name: &row.name,
            done: row.done.as_ref().zip(row.drive.as_ref()),
            answered: !row.problems.iter().any(|problem| is_silence(problem.kind)),
        }
    }
}

/// Whether an error of this kind means that a drive did not answer.
pub const fn is_silence(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::Unreachable | ErrorKind::Lost)
}

/// Prints a table of drives, for people.
pub fn table<'a, V: Shown>(verb: &V, drives: impl Iterator<Item = TableRow<'a, V::Done>>, output: &Output)
where
    V::Done: 'a,
{
    if output.json() {
        return;
    }
    let mut table = Table::new(&[&["drive"], V::COLUMNS].concat());
    for row in drives {
        let rows = match row.done {
            Some((done, drive)) => verb.rows(done, drive),
            None => verb.missing_row(row.answered).into_iter().collect(),
        };
        for cells in rows {
            table.row(std::iter::once(row.name.to_owned()).chain(cells));
        }
    }
    output.table(&table);
}

/// Prints the messages of the problems and returns how the command ends. With `matter` the table has shown what is the matter
/// with drives that answered. Drives that were not done because of Ctrl-C are counted, not listed.
pub fn ended<D>(rows: &[Row<D>], matter: Option<&str>, output: &Output) -> Result<(), Failure> {
    let shown = |row: &Row<D>| matter.is_some() && row.done.is_some();
    for row in rows.iter().filter(|row| !shown(row)) {
        let output = output.clone().about(Some(&row.name));
        for problem in row.problems.iter().filter(|problem| !is_interrupted(problem)) {
            let named = problem.message.contains(&row.name);
            let message = if named {
                problem.message.clone()
            } else {
                format!("{}: {}", row.name, problem.message)
            };
            let problem = problem.clone();
            output.error(&Failure { message, ..problem });
        }
    }
    summary(rows, matter).map_or(Ok(()), Err)
}

fn is_interrupted(problem: &Failure) -> bool {
    problem.kind == ErrorKind::Interrupted
}

/// Returns how many drives have which kind of problem; `None` without any.
fn summary<D>(rows: &[Row<D>], matter: Option<&str>) -> Option<Failure> {
    let kinds = rows
        .iter()
        .flat_map(|row| &row.problems)
        .map(|problem| problem.kind);
    let kind = fleet::kind_of(kinds)?;
    let interrupted = |row: &&Row<D>| row.problems.iter().any(is_interrupted);
    let mut parts = Vec::new();
    let count = rows.iter().filter(interrupted).count();
    if count > 0 {
        parts.push(format!("interrupted: {count} of {} drives not done", rows.len()));
    }
    for (answered, what) in [(false, "failed"), (true, matter.unwrap_or("with problems"))] {
        let names: Vec<&str> = rows
            .iter()
            .filter(|row| !row.problems.is_empty() && !interrupted(row))
            .filter(|row| row.done.is_some() == answered)
            .map(|row| row.name.as_str())
            .collect();
        if !names.is_empty() {
            let (names, count) = (listed(&names), names.len());
            parts.push(format!("{what}: {names} ({count} of {})", rows.len()));
        }
    }
    Some(Failure::new(kind, parts.join("; ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A person who presses Ctrl-C reads one line, whatever the number of drives.
    #[test]
    fn interrupted_drives_are_counted_once() {
        let row = |name: &str, problems: Vec<ErrorKind>| Row {
            name: name.to_owned(),
            drive: None,
            done: problems.is_empty().then_some(()),
            problems: problems
                .into_iter()
                .map(|kind| Failure::new(kind, "why"))
                .collect(),
        };
        let rows = [
            row("a", vec![]),
            row("b", vec![ErrorKind::Interrupted]),
            row("c", vec![ErrorKind::Interrupted]),
            row("d", vec![ErrorKind::Refused]),
        ];
        let ended = summary(&rows, None).unwrap_or_else(|| Failure::silent(ErrorKind::Internal));
        assert_eq!(
            (ended.kind, ended.message.as_str()),
            (
                ErrorKind::Interrupted,
                "interrupted: 2 of 4 drives not done; failed: d (1 of 4)"
            )
        );
        assert_eq!(summary(&rows[..1], None), None);
    }
}
