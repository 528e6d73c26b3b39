//! `profidrive write`

use client::change::{Change, Step};
use client::{Drive, Wait};
use profidrive::Remark;
use profidrive::fleet::{self, WritePlan};
use profidrive::parameters::{self, Write as Wanted, Written};
use profidrive::report::WriteReport;
use profile::value::Assignment;

use super::super::each::{self, Row, Shown};
use super::super::remark;
use crate::advice::Commands;
use crate::args::{Target, Write};
use crate::confirm::{Question, confirm};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::Table;
use crate::render::value;

pub fn write(args: &Write, target: &Target, output: &Output) -> Result<(), Failure> {
    let assignments: Vec<Assignment> = args
        .assignments
        .iter()
        .map(|text| text.parse().map_err(Failure::from))
        .collect::<Result<_, _>>()?;
    let wanted = Wanted {
        save: args.save,
        dry_run: args.dry_run,
        beside_controller: true,
    };
    if connect::selector(target, output)?.single().is_none() {
        return many(args, &assignments, wanted, target, output);
    }
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
    let written = parameters::write(&mut session, &mut drive, &assignments, wanted).wait()?;
    session.close().wait()?;
    let verb = Writing {
        planned: args.dry_run,
    };
    each::shown_alone(&verb, &written, &drive, output)
}

/// How a write is shown, or a plan of it.
struct Writing {
    planned: bool,
}

impl Shown for Writing {
    type Done = Written;
    type Report = WriteReport;
    const COLUMNS: &'static [&'static str] = &COLUMNS;

    fn report(&self, done: &Written, drive: &Drive) -> WriteReport {
        done.report(drive, &Commands::any())
    }

    fn show(&self, done: &Written, _: &Drive, output: &Output) {
        say_values(done, output);
        let mut table = Table::new(&COLUMNS);
        for change in done.changes() {
            table.row(row(change, self.planned));
        }
        output.table(&table);
        if self.planned {
            output.say(DRY_RUN);
            return;
        }
        for remark in done.lasting() {
            remark::print(&remark, "", output);
        }
    }

    fn remark(&self, done: &Written, drive: &Drive, output: &Output) {
        warn(done, drive, output);
    }

    fn remark_on_all(&self, rows: &[Row<Written>], output: &Output) {
        for row in rows {
            if let (Some(written), Some(drive)) = (&row.done, &row.drive) {
                warn(written, drive, output);
            }
        }
        if !self.planned && !output.json() {
            report_all_saved(rows, output);
        }
    }

    fn rows(&self, done: &Written, _: &Drive) -> Vec<Vec<String>> {
        done.changes()
            .map(|change| row(change, self.planned).into())
            .collect()
    }

    fn problems(&self, done: &Written, drive: &Drive) -> Vec<Failure> {
        let problems = done.problems(&drive.label());
        problems.into_iter().map(Failure::from).collect()
    }
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
    if !output.json()
        && let Some(first) = plan.plans().next()
    {
        say_values(first, output);
    }
    let show = |planned| Writing { planned };
    if ends_here {
        let closed = session.close().wait();
        let shown = each::shown(&show(true), plan.into_members(), left_out, output);
        shown.map_err(|failure| Failure {
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
        let planned = plan.members().iter().map(|member| {
            let done = member.result.as_ref().ok().zip(member.drive.as_ref());
            each::TableRow {
                name: &member.name,
                done,
                answered: true,
            }
        });
        each::table(&show(true), planned, output);
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
    each::shown(&show(false), written, left_out, output)?;
    Ok(closed?)
}

/// A controller whose motion the new values change.
fn warn(written: &Written, drive: &Drive, output: &Output) {
    if let Some(remark) = written.of_motion(&drive.label()) {
        remark::print(&remark, "", output);
    }
}

/// What becomes of values on the way to the drive.
fn say_values(written: &Written, output: &Output) {
    for remark in written.of_values() {
        remark::print(&remark, "", output);
    }
}

/// Prints which new values are lost at the next power cycle, and which are not. Drives of which the same is to be said are
/// named together.
fn report_all_saved(rows: &[Row<Written>], output: &Output) {
    let mut remarks: Vec<(Remark, Vec<&str>)> = Vec::new();
    for row in rows {
        for remark in row.done.as_ref().map(Written::lasting).unwrap_or_default() {
            match remarks.iter_mut().find(|(known, _)| *known == remark) {
                Some((_, drives)) => drives.push(&row.name),
                None => remarks.push((remark, vec![&row.name])),
            }
        }
    }
    for (remark, drives) in remarks {
        remark::print(&remark, &format!("{}: ", profidrive::listed(&drives)), output);
    }
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
