//! `profidrive write`

use client::change::{Change, Persistence, Step};
use client::{Drive, Wait};
use profidrive::DriveError;
use profidrive::fleet::{self, Member, WritePlan, WrittenMembers};
use profidrive::parameters::{self, Write as Wanted, Written};
use profidrive::report::Drives;
use profile::value::{Assignment, Content};

use super::super::each;
use crate::advice::Commands;
use crate::args::{Target, Write};
use crate::confirm::{Question, confirm};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::{Table, clean};
use crate::render::{number, value};

pub fn write(args: &Write, target: &Target, output: &Output) -> Result<(), Failure> {
    let assignments: Vec<Assignment> = args
        .assignments
        .iter()
        .map(|text| text.parse().map_err(Failure::from))
        .collect::<Result<_, _>>()?;
    let wanted = Wanted {
        save: args.save,
        dry_run: args.dry_run,
    };
    if connect::selector(target, output)?.single().is_none() {
        return many(args, &assignments, wanted, target, output);
    }
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
    let written = parameters::write(&mut session, &mut drive, &assignments, wanted).wait()?;
    session.close().wait()?;
    warn(&written, &drive, output);
    output.json_report(&written.report(&drive, &Commands::any()));
    if !output.json() {
        remark(&assignments, &written, output);
        let mut table = Table::new(&COLUMNS);
        for change in written.changes() {
            table.row(row(change, args.dry_run));
        }
        output.table(&table);
        if args.dry_run {
            output.say(DRY_RUN);
        } else {
            report_saved(&written, output);
        }
    }
    each::last(written.problems(&drive.label()), output)
}

const COLUMNS: [&str; 7] = ["name", "number", ">old", "", ">new", "unit", "result"];
const DRY_RUN: &str = "dry run: nothing was written";

/// Plans for all drives, asks once, and writes: with one value that cannot be written to one drive, nothing is written.
fn many(
    args: &Write,
    assignments: &[Assignment],
    wanted: Wanted,
    target: &Target,
    output: &Output,
) -> Result<(), Failure> {
    let (mut session, found) = connect::drives(target, Need::Records, output)?;
    let left_out = found.left_out;
    let plan = fleet::plan_write(&session, found.members, assignments, wanted).wait();
    let (drives, changing) = (plan.members().len(), plan.changing());
    let ends_here = !plan.is_whole() || args.dry_run || changing == 0;
    if !output.json() {
        if ends_here || !args.yes {
            table(plan.members(), true, output);
        }
        if let Some(first) = plan.plans().next() {
            remark(assignments, first, output);
        }
    }
    if ends_here {
        let closed = session.close().wait();
        ended(plan.into_members(), left_out, output).map_err(|failure| Failure {
            message: format!("nothing was written; {}", failure.message),
            ..failure
        })?;
        output.say(if args.dry_run {
            DRY_RUN
        } else {
            "nothing to write: every drive has these values"
        });
        return Ok(closed?);
    }
    if !args.yes {
        let question = Question {
            text: &format!("Write to {changing} of {drives} drives?"),
            undone: "nothing was written",
            unasked: "--yes writes without asking",
        };
        confirm(&mut session, &question, output)?;
    }
    let written = plan
        .carry_out(&session)
        .wait()
        .unwrap_or_else(WritePlan::into_members);
    let closed = session.close().wait();
    if !output.json() {
        table(&written, false, output);
    }
    for member in &written {
        let (Ok(written), Some(drive)) = (&member.result, &member.drive) else {
            continue;
        };
        warn(written, drive, output);
    }
    if !output.json() {
        report_all_saved(&written, output);
    }
    ended(written, left_out, output)?;
    Ok(closed?)
}

fn table(members: &[Member<Result<Written, DriveError>>], planned: bool, output: &Output) {
    let mut table = Table::new(&[&["drive"], &COLUMNS[..]].concat());
    for member in members {
        let changes = member.result.as_ref().ok().into_iter().flat_map(Written::changes);
        for change in changes {
            table.row([member.name.clone()].into_iter().chain(row(change, planned)));
        }
    }
    output.table(&table);
}

fn ended(members: WrittenMembers, left_out: Vec<String>, output: &Output) -> Result<(), Failure> {
    let problems = |written: &Written, drive: &Drive| -> Vec<Failure> {
        let problems = written.problems(&drive.label());
        problems.into_iter().map(Failure::from).collect()
    };
    let rows = members.into_iter();
    let rows: Vec<each::Row<Written>> = rows.map(|member| each::Row::new(member, problems)).collect();
    output.json_report(&Drives {
        drives: rows
            .iter()
            .map(|row| row.entry(|written, drive| written.report(drive, &Commands::any())))
            .collect(),
        left_out,
    });
    each::ended(&rows, None, output)
}

/// A controller whose motion the new values change.
fn warn(written: &Written, drive: &Drive, output: &Output) {
    if let Some(name) = written.affected_controller() {
        output.warn(&format!(
            "controller \"{}\" is connected to {}: what was written counts for its motion at once",
            clean(name),
            drive.label(),
        ));
    }
}

/// What becomes of values on the way to the drive.
fn remark(assignments: &[Assignment], written: &Written, output: &Output) {
    for (assignment, change) in assignments.iter().zip(written.set.changes()) {
        let remark = raw_note(assignment, change)
            .or_else(|| rounded(assignment, change))
            .or_else(|| blanks_lost(assignment, change));
        if let Some(remark) = remark {
            output.say(&remark);
        }
    }
}

/// A remark on what outlives the power of the drive, in words.
#[derive(Debug, PartialEq, Eq)]
enum Remark {
    Said(String),
    Warned(String),
}

impl Remark {
    fn print(self, drives: &str, output: &Output) {
        match self {
            Self::Said(words) => output.say(&format!("{drives}{words}")),
            Self::Warned(words) => output.warn(&format!("{drives}{words}")),
        }
    }
}

/// Reports which of the new values outlive the power of the drive, and which do not.
fn report_saved(written: &Written, output: &Output) {
    for remark in saved(written) {
        remark.print("", output);
    }
}

/// The same for many drives: those of which the same is to be said are named together.
fn report_all_saved(members: &[Member<Result<Written, DriveError>>], output: &Output) {
    let mut remarks: Vec<(Remark, Vec<String>)> = Vec::new();
    for member in members {
        let written = member.result.as_ref().ok();
        for remark in written.map(saved).unwrap_or_default() {
            match remarks.iter_mut().find(|(known, _)| *known == remark) {
                Some((_, drives)) => drives.push(member.name.clone()),
                None => remarks.push((remark, vec![member.name.clone()])),
            }
        }
    }
    for (remark, drives) in remarks {
        remark.print(&format!("{}: ", listed(&drives)), output);
    }
}

fn saved(written: &Written) -> Vec<Remark> {
    let kept = written.set.kept();
    let names =
        |changes: &[&Change]| -> Vec<String> { changes.iter().map(|change| change.label()).collect() };
    let (as_written, by_itself, lost) = (names(&kept.with_set), names(&kept.by_itself), names(&kept.lost));
    let only = by_itself.is_empty() && lost.is_empty();
    let mut remarks = Vec::new();
    if !as_written.is_empty() {
        remarks.push(match kept.persistence {
            Persistence::Refused(_) => {
                Remark::Warned(unsaved_words("the drive refused to save", &as_written))
            }
            Persistence::NotAsPlanned => {
                let why = "the save command was not sent because a value was refused";
                Remark::Warned(unsaved_words(why, &as_written))
            }
            Persistence::InDoubt => Remark::Warned(format!(
                "it is not known whether the drive saved {}: asked for, not answered",
                listed(&as_written)
            )),
            saved => Remark::Said(kept_words(saved, if only { &[] } else { &as_written })),
        });
    }
    if !by_itself.is_empty() {
        let which = listed(&by_itself);
        remarks.push(Remark::Said(format!(
            "saved in the drive: {which} (at a serial line it saves text with every write)"
        )));
    }
    if !lost.is_empty() {
        let words = lost_words(&lost);
        remarks.push(if written.wanted.save {
            Remark::Warned(words)
        } else {
            Remark::Said(words)
        });
    }
    remarks
}

/// What becomes of new values that were to be saved and were not.
fn unsaved_words(why: &str, which: &[String]) -> String {
    format!(
        "not saved: {why}, {} lost at the next power cycle",
        listed_with_verb(which)
    )
}

/// What becomes of new values that the drive can save; `which` is empty for all of them.
fn kept_words(persistence: Persistence, which: &[String]) -> String {
    let named = match which {
        [] => String::new(),
        names => format!(": {}", listed(names)),
    };
    match persistence {
        Persistence::EveryWrite => format!("saved in the drive{named} (it saves every write)"),
        Persistence::Saved { by_command: true } => {
            format!("saved in the drive{named}, with everything else that it can save")
        }
        Persistence::Saved { by_command: false } => format!("saved in the drive{named}"),
        _ if which.is_empty() => "not saved: lost at the next power cycle (use --save)".to_owned(),
        _ => format!(
            "not saved: {} lost at the next power cycle (use --save)",
            listed_with_verb(which)
        ),
    }
}

/// `DRV.ACC is`, `DRV.ACC and DRV.DEC are`.
fn listed_with_verb(names: &[String]) -> String {
    let verb = if names.len() == 1 { "is" } else { "are" };
    format!("{} {verb}", listed(names))
}

/// What becomes of values that the drive has no place for.
fn lost_words(lost: &[String]) -> String {
    let which = if lost.len() == 1 { "it" } else { "them" };
    format!(
        "not saved: {} lost at the next power cycle, the drive cannot save {which}",
        listed_with_verb(lost)
    )
}

/// `922`, `922 and HOME.V`, `922, 930 and HOME.V`
fn listed(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// A number in hexadecimal is the one on the wire: what that is in the unit of the parameter.
fn raw_note(assignment: &Assignment, change: &Change) -> Option<String> {
    let raw = assignment.value.raw()?;
    let unit = change.rounding?.unit;
    (!unit.is_empty()).then(|| {
        let (label, value) = (change.label(), value::value(&change.new));
        format!("{label}: 0x{raw:04X} is the raw value, that is {value} {unit}")
    })
}

/// That a text is written without the blanks in front of it, and how to write them.
fn blanks_lost(assignment: &Assignment, change: &Change) -> Option<String> {
    let Content::Text(text) = &change.new.content else {
        return None;
    };
    assignment.value.has_lost_blanks().then(|| {
        let label = change.label();
        let text = clean(text);
        format!(
            "{label}: blanks before the text are left out; to write them use quotation marks: \" {text}\""
        )
    })
}

/// What becomes of a value between two that the drive can hold.
fn rounded(assignment: &Assignment, change: &Change) -> Option<String> {
    let value = change.rounding?;
    let asked = assignment.value.number()?;
    let unit = asked.unit.as_deref().unwrap_or(value.unit);
    let (asked, written) = (number(asked.number.as_f64()), value::value(&change.new));
    let shown = unit != value.unit || asked != written;
    (value.is_rounded() && shown).then(|| {
        let label = change.label();
        let line = format!("{label}: {asked} {unit} -> {written} {}", value.unit);
        format!("{}, rounded to the nearest representable value", line.trim_end())
    })
}

fn row(change: &Change, dry_run: bool) -> [String; 7] {
    let new = value::value(&change.new);
    let old = match &change.old {
        Some(Ok(reading)) => with_text(value::value(reading), reading.choice),
        Some(Err(refusal)) => format!("({})", refusal.words()),
        None => "-".into(),
    };
    let result = match (change.step, &change.read_back) {
        (Step::Same, _) => format!("already {new}"),
        (Step::NotWritten, _) if dry_run => "would be written".into(),
        (Step::NotWritten, _) => "not sent".into(),
        (Step::Refused(refusal), _) => refusal.outcome(),
        (Step::Written, None) => "executed".into(),
        (Step::Written, _) if change.acts => "executed".into(),
        (Step::Written, Some(Err(refusal))) => format!("written, not readable: {}", refusal.words()),
        (Step::Differs, Some(Ok(back))) => format!("written, but reads back {}", value::full(back)),
        (step, _) => step.to_string(),
    };
    let name = change.selection.parameter.map(|parameter| parameter.name);
    [
        name.unwrap_or_default().to_owned(),
        change.selection.shown(0).to_string(),
        old,
        "->".into(),
        with_text(new, change.new.choice),
        change.new.unit.to_owned(),
        result,
    ]
}

/// `1 (PROFIdrive profile)`
fn with_text(value: String, text: Option<&str>) -> String {
    match text {
        Some(text) => format!("{value} ({text})"),
        None => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unsaved_values_are_reported() {
        let names = ["922".to_owned(), "HOME.V".to_owned()];
        assert_eq!(
            lost_words(&names),
            "not saved: 922 and HOME.V are lost at the next power cycle, the drive cannot save them"
        );
        assert!(lost_words(&names[..1]).starts_with("not saved: 922 is lost"));
    }
}
