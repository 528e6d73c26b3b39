//! `profidrive restore DRIVE FILE`

use std::path::{Path, PathBuf};

use client::change::{Change, ChangeSet, Choice, Plan, Skip, Skipped, Step};
use client::{Drive, ErrorKind, Wait};
use profidrive::report::RestoreReport;
use profidrive::settings::{self, RestoreError};
use profile::value::Reading;

use super::remark;
use crate::advice::Commands;
use crate::args::{Restore, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::Table;
use crate::render::{number, value};

pub fn run(args: &Restore, target: &Target, output: &Output) -> Result<(), Failure> {
    let wanted = settings::read(&args.file)?;
    let way_back = way_back(args)?;
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
    let request = settings::Restore {
        choice: Choice {
            only: args.only.clone(),
            network: args.network,
            saved_only: args.saved_only,
            beyond_limits: args.beyond_limits,
        },
        save: args.save,
        force: args.force,
        dry_run: args.dry_run,
    };
    let bar = connect::bar(output, 0, "reading");
    let progress = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let plan = settings::plan_with(&mut session, &mut drive, &wanted, &request, progress).wait();
    bar.finish_and_clear();
    let mut plan = plan?;
    for one in plan.identity_differences(&wanted) {
        output.say(&format!(
            "{}: {} in the settings, {} in the drive",
            one.what, one.left, one.right
        ));
    }
    if !output.json() {
        show(&plan, output);
    }
    if args.dry_run {
        session.close().wait()?;
        output.json_report(&document(&drive, args, &plan, None));
        output.say("dry run: nothing was written");
        return ended(&plan, &drive, &request);
    }
    let bar = connect::bar(output, plan.set.total(), "writing");
    let progress = |done| bar.set_position(done as u64);
    let result = settings::carry_out(
        &mut session,
        &mut drive,
        &wanted,
        &request,
        &mut plan,
        &way_back,
        progress,
    )
    .wait();
    bar.finish_and_clear();
    // the connection of a drive that is lost ends by itself
    let closed = session.close().wait();
    let file = (plan.set.total() > 0 && way_back.exists()).then_some(way_back.as_path());
    output.json_report(&document(&drive, args, &plan, file));
    if !output.json() {
        results(&plan.set, output);
    }
    report(&plan.set, file, &drive, output);
    result.map_err(|error| failed(error, &plan.set, file, &drive))?;
    closed?;
    ended(&plan, &drive, &request)
}

/// Where the way back goes: never over anything.
fn way_back(args: &Restore) -> Result<PathBuf, Failure> {
    match &args.way_back {
        Some(path) if path.exists() => Err(Failure::new(
            ErrorKind::Local,
            format!("--way-back: {} exists already", path.display()),
        )),
        Some(path) => Ok(path.clone()),
        None => settings::way_back(&args.file).ok_or_else(|| {
            Failure::usage("no free name for the values before: `.before-1` to `.before-9999` exist; choose one with --way-back PATH")
        }),
    }
}

impl From<RestoreError> for Failure {
    fn from(error: RestoreError) -> Self {
        match error {
            RestoreError::Nothing => Self::usage("--only: nothing in the file fits"),
            other => Self::explained(&other),
        }
    }
}

fn show(plan: &Plan, output: &Output) {
    let mut table = Table::new(&["name", "number", ">old", "", ">new", "unit", "limits", "kept"]);
    let set = &plan.set;
    for change in set.changes() {
        let limits = set
            .limits(change)
            .map(|(low, high)| format!("{} to {}", number(low), number(high)));
        let ([old, new], unit) = value::pair(old(change), Some(&change.new));
        table.row([
            change.new.name.unwrap_or_default().to_owned(),
            change.new.shown().to_string(),
            old,
            "->".to_owned(),
            new,
            unit,
            limits.unwrap_or_default(),
            kept(change).to_owned(),
        ]);
    }
    if !table.is_empty() {
        for line in table.lines() {
            output.line(&line);
        }
    }
    let after = set.parameters_after();
    for change in set.tasks() {
        output.line(&format!("MT[{}]", change.number));
        output.line(&format!("  old  {}", change.old.text(set.parameters())));
        output.line(&format!("  new  {}", change.new.text(&after)));
    }
    for skipped in plan.tasks_skipped.iter().filter(|one| one.why != Skip::Same) {
        output.line(&format!("MT[{}] left out: {}", skipped.number, skipped.why));
    }
    if let Some(why) = &plan.tasks_left_out {
        output.warn(&format!("the motion tasks are left out: {why}"));
    }
    let mut table = Table::new(&["left out", "number", ">in the file", "unit", "why"]);
    let left_out: Vec<&Skipped> = plan.skipped.iter().filter(|one| one.why != Skip::Same).collect();
    for group in left_out.chunk_by(|a, b| one_line(a, b)) {
        if let [first, rest @ ..] = group {
            table.row(left_out_row(first, rest));
        }
    }
    if !table.is_empty() {
        for line in table.lines() {
            output.line(&line);
        }
    }
    let refused = match plan.refused() {
        0 => String::new(),
        count => format!(" ({count} of them the drive cannot have)"),
    };
    output.say(&format!(
        "{} to write, {} same, {} left out{refused}",
        set.total(),
        plan.same(),
        plan.left_out()
    ));
}

/// Elements of one parameter, next to each other and left out for one reason, are one line.
fn one_line(a: &Skipped, b: &Skipped) -> bool {
    let next = a
        .reading
        .index
        .is_some_and(|index| b.reading.index == index.checked_add(1));
    next && a.reading.pnu == b.reading.pnu && a.why == b.why
}

fn left_out_row(first: &Skipped, rest: &[&Skipped]) -> [String; 5] {
    let reading = &first.reading;
    let (mut number, mut content) = (reading.shown().to_string(), value::value(reading));
    if let Some(last) = rest.last() {
        number = format!(
            "{}..{}]",
            number.trim_end_matches(']'),
            last.reading.index.unwrap_or(0)
        );
        if rest.iter().any(|one| value::value(&one.reading) != content) {
            content = format!("{} values", rest.len() + 1);
        }
    }
    [
        reading.name.unwrap_or_default().to_owned(),
        number,
        content,
        reading.unit.to_owned(),
        first.why.to_string(),
    ]
}

const fn kept(change: &Change) -> &'static str {
    match change.storable {
        Some(true) | None => "",
        Some(false) => "not over power-off",
    }
}

/// The value before, which was read.
fn old(change: &Change) -> Option<&Reading> {
    change.old.as_ref()?.as_ref().ok()
}

/// What did not go as planned, one line each.
fn results(set: &ChangeSet, output: &Output) {
    let mut table = Table::new(&["name", "number", ">wanted", "unit", "result"]);
    for change in set.changes().iter().filter(|change| !change.is_done()) {
        table.row([
            change.new.name.unwrap_or_default().to_owned(),
            change.new.shown().to_string(),
            value::value(&change.new),
            change.new.unit.to_owned(),
            change.step.to_string(),
        ]);
    }
    if !table.is_empty() {
        for line in table.lines() {
            output.line(&line);
        }
    }
    for task in set.tasks().iter().filter(|task| task.step != Step::ReadBack) {
        output.line(&format!("MT[{}]: {}", task.number, task.step));
    }
}

fn report(set: &ChangeSet, file: Option<&Path>, drive: &Drive, output: &Output) {
    if set.total() > 0 {
        output.say(&set.summary());
    }
    for remark in settings::lasting(set) {
        remark::print(&remark, "", output);
    }
    if let Some(file) = file {
        output.say(&format!(
            "the values before are in {}; `profidrive restore {} {}` brings them back",
            file.display(),
            drive.label(),
            file.display()
        ));
    }
}

fn failed(error: RestoreError, set: &ChangeSet, file: Option<&Path>, drive: &Drive) -> Failure {
    let begun = matches!(error, RestoreError::Client(_));
    let mut failure = Failure::from(error);
    if let Some(file) = file.filter(|_| begun) {
        failure.message = format!("{}; {}", failure.message, set.summary());
        let hint = format!(
            "{} says which; `profidrive diff {} {}` shows what the drive has now",
            file.display(),
            drive.label(),
            file.display()
        );
        failure = failure.hint(hint);
    }
    failure
}

fn ended(plan: &Plan, drive: &Drive, request: &settings::Restore) -> Result<(), Failure> {
    settings::shortfall(plan, drive, request).map_or(Ok(()), |shortfall| Err(shortfall.into()))
}

fn document(drive: &Drive, args: &Restore, plan: &Plan, file: Option<&Path>) -> RestoreReport {
    let text = |path: &Path| path.display().to_string();
    let (source, way_back) = (text(&args.file), file.map(text));
    RestoreReport::new(drive, plan, source, args.dry_run, way_back, &Commands::any())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use client::backup::Backup;

    use super::*;

    fn backup(lines: &str) -> Backup {
        let head = "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\n";
        Backup::read(format!("{head}{lines}\n")).unwrap()
    }

    #[test]
    fn elements_left_out_for_one_reason_are_one_line() {
        let wanted =
            backup("p0915[0] = 1\np915[1] = 5\np915[2] = 7\np915[5] = 7\np916[0] = 2\np916[1] = 2\np922 = 1");
        let present =
            backup("p0915[0] = 0\np915[1] = 0\np915[2] = 0\np915[5] = 0\np916[0] = 0\np916[1] = 0\np922 = 9");
        let plan = Plan::new(&wanted, &present, &Choice::default());
        let skipped: Vec<&Skipped> = plan.skipped.iter().collect();
        let rows: Vec<[String; 5]> = skipped
            .chunk_by(|a, b| one_line(a, b))
            .map(|group| left_out_row(group[0], &group[1..]))
            .collect();
        let shown: Vec<(&str, &str)> = rows
            .iter()
            .map(|row| (row[1].as_str(), row[2].as_str()))
            .collect();
        assert_eq!(
            shown,
            [
                ("p0915[0..2]", "3 values"),
                ("p0915[5]", "7"),
                ("p0916[0..1]", "2"),
                ("p0922", "1")
            ]
        );
    }
}
