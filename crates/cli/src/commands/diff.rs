//! `profidrive diff A B`

use std::path::Path;

use client::backup::{Backup, Difference, Side};
use client::{DriveAddress, ErrorKind, Wait};
use profidrive::settings::{self, CompareError, Comparison};
use profile::value::Reading;

use super::{backup, commission, diff_folder};
use crate::advice::Commands;
use crate::args::{Diff, DriveOptions, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::Table;
use crate::render::value;

pub fn run(args: &Diff, options: &DriveOptions, output: &Output) -> Result<(), Failure> {
    let machine = Path::new(&args.left);
    if machine.extension().is_some_and(|extension| extension == "toml") {
        return commission::drift(machine, &args.right, options, output);
    }
    if machine.is_dir() {
        return diff_folder::run(machine, &options.target(&args.right), output);
    }
    let (left, right) = (source(&args.left)?, source(&args.right)?);
    let drive = |name: &str| {
        let read = backup::whole(&options.target(name), output);
        read.map(|(backup, _)| backup.report)
            .map_err(|failure| no_file(failure, name))
    };
    // of a drive, the contents of the file count: it may hold a part only
    let in_drive = |file: &Backup, name: &str| {
        like(file, &options.target(name), output).map_err(|failure| no_file(failure, name))
    };
    let (left, right) = match (left, right) {
        (Some(left), Some(right)) => (left, right),
        (Some(file), None) => {
            let drive = in_drive(&file, &args.right)?;
            (file, drive)
        }
        (None, Some(file)) => (in_drive(&file, &args.left)?, file),
        (None, None) => (drive(&args.left)?, drive(&args.right)?),
    };
    let comparison = Comparison::new(&left, &right).map_err(|error| match error {
        CompareError::OtherModel { left, right } => Failure::usage(format!(
            "{} is of model {left}, {} of model {right}: parameters of two models cannot be compared",
            args.left, args.right
        )),
        other => other.into(),
    })?;
    for one in left.header.differences(&right.header) {
        output.say(&format!(
            "{}: {} on the left, {} on the right",
            one.what, one.left, one.right
        ));
    }
    for (name, why) in [&args.left, &args.right]
        .into_iter()
        .zip(comparison.tasks_left_out())
    {
        if let Some(why) = why {
            output.warn(&format!(
                "motion tasks are not compared: they are left out of {name}: {why}"
            ));
        }
    }
    output.json_report(&comparison.report(&args.left, &args.right, &Commands::any()));
    if !output.json() {
        let mut table = Table::new(&["name", "number", ">left", ">right", "unit", "meaning"]);
        for row in rows(&comparison) {
            table.row(row);
        }
        output.table(&table);
        for one in &comparison.tasks {
            output.line(&format!("MT[{}]", one.number));
            output.line(&format!("  left   {}", one.left.text(left.parameters())));
            output.line(&format!("  right  {}", one.right.text(right.parameters())));
        }
    }
    let Some(kind) = comparison.outcome().kind() else {
        output.say("no difference");
        return Ok(());
    };
    let count = comparison.count();
    let plural = if count == 1 { "" } else { "s" };
    let of_it = match comparison.of_connection() {
        0 => String::new(),
        connection if connection == count => ", of the connection only".to_owned(),
        connection => format!(", {connection} of them of the connection"),
    };
    output.say(&format!("{count} difference{plural}{of_it}"));
    Err(Failure::silent(kind))
}

/// One row for each setting that differs: name, number, left, right, unit, meaning. Those of the connection come last, an array of
/// them in one row.
pub fn rows(comparison: &Comparison<'_>) -> Vec<[String; 6]> {
    let mut rows = Vec::new();
    let (connection, settings): (Vec<&Difference>, Vec<&Difference>) = comparison
        .settings
        .iter()
        .partition(|one| comparison.is_of_connection(one));
    rows.extend(settings.into_iter().map(row));
    let pnu = |one: &&Difference| one.reading().map(|reading| reading.pnu);
    for group in connection.chunk_by(|a, b| pnu(a) == pnu(b)) {
        match group {
            [first, .., last] => rows.push(folded(first, last, comparison.left, comparison.right)),
            [one] => rows.push(row(one)),
            [] => {}
        }
    }
    rows
}

fn row(one: &Difference) -> [String; 6] {
    let Some(reading) = one.reading() else {
        return Default::default();
    };
    let meaning = match [&one.left, &one.right].map(meaning) {
        [left, right] if left.is_empty() && right.is_empty() => String::new(),
        [left, right] => format!("{left} / {right}"),
    };
    let ([mut first, mut second], unit) = value::pair(given(&one.left), given(&one.right));
    for (text, side) in [(&mut first, &one.left), (&mut second, &one.right)] {
        if given(side).is_none() {
            *text = absent(side);
        }
    }
    [
        reading.name.unwrap_or_default().to_owned(),
        reading.shown().to_string(),
        first,
        second,
        unit,
        meaning,
    ]
}

/// Returns the elements of one array from the first that differs to the last, as both sides have them.
fn folded(first: &Difference, last: &Difference, left: &Backup, right: &Backup) -> [String; 6] {
    let Some((first, last)) = first.reading().zip(last.reading()) else {
        return Default::default();
    };
    let (from, to) = (first.index.unwrap_or(0), last.index.unwrap_or(0));
    let elements = |backup: &Backup| -> String {
        let values = (from..=to).map(|index| {
            let reading = backup.reading(first.pnu, Some(index));
            reading.map_or_else(|| "-".to_owned(), value::value)
        });
        values.collect::<Vec<_>>().join(" ")
    };
    [
        first.name.unwrap_or_default().to_owned(),
        format!("{}..{to}]", first.shown().to_string().trim_end_matches(']')),
        elements(left),
        elements(right),
        first.unit.to_owned(),
        "of the connection".to_owned(),
    ]
}

/// Returns the file, where there is one of this name or the text is a path; `None` for a drive.
fn source(text: &str) -> Result<Option<Backup>, Failure> {
    let path = Path::new(text);
    let drive = text.parse::<DriveAddress>();
    let at_line = matches!(drive, Ok(DriveAddress::Line(_)));
    if path.is_file() || (text.contains('/') && !at_line) {
        Ok(Some(settings::read(path)?))
    } else if drive.is_err() {
        let message = format!("there is no file {text}, and no drive can have this name");
        Err(Failure::usage(message).hint(
            "two drives or files are compared, or several drives with a folder of backups or the machine file",
        ))
    } else {
        Ok(None)
    }
}

/// Adds to the failure of a drive that was not found that its name is not a file's either.
fn no_file(failure: Failure, name: &str) -> Failure {
    let is_name = matches!(name.parse(), Ok(DriveAddress::Name(_)));
    if failure.kind == ErrorKind::Unreachable && is_name {
        failure.and_hint(format!("there is no file {name} either"))
    } else {
        failure
    }
}

/// Returns the parameters of a file, as the drive has them.
fn like(file: &Backup, target: &Target, output: &Output) -> Result<Backup, Failure> {
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
    let spinner = connect::spinner(output, format!("reading {}", drive.label()));
    let backup = settings::as_in(&mut session, &mut drive, file).wait();
    spinner.finish_and_clear();
    let backup = backup?;
    session.close().wait()?;
    let more = file.lacks(&drive.model);
    if more > 0 {
        output.say(&format!(
            "{more} settings of {} are not in the file and are not compared",
            drive.label()
        ));
    }
    Ok(backup)
}

const fn given(side: &Side) -> Option<&Reading> {
    match side {
        Side::Value(reading) => Some(reading),
        Side::Missing | Side::Refused(_) => None,
    }
}

/// Returns the text shown without a value.
fn absent(side: &Side) -> String {
    match side {
        Side::Missing => "(missing)".into(),
        Side::Refused(refusal) => format!("({})", refusal.short()),
        Side::Value(_) => String::new(),
    }
}

fn meaning(side: &Side) -> String {
    match side {
        Side::Value(reading) => value::meaning(reading),
        Side::Missing | Side::Refused(_) => String::new(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn backup(lines: &str) -> Backup {
        let head = "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\n";
        Backup::read(format!("{head}{lines}\n")).unwrap()
    }

    #[test]
    fn the_connection_is_one_line_for_each_array_and_comes_last() {
        let left = backup("p915[0] = 1\np915[1] = 5\np915[2] = 0\np922 = 1\np2108 = 3000 rpm/s");
        let right =
            backup("p915[0] = 1\np915[1] = 104\np915[2] = 28\np922 = 9\np2108 = 4000 rpm/s\np2115 = 1 rps/s");
        let found = rows(&Comparison::new(&left, &right).unwrap());
        assert_eq!(found.len(), 4, "{found:?}");
        assert_eq!(found[0][..4], ["DRV.ACC", "p2108", "3000", "4000"]);
        assert_eq!(found[1][2], "(missing)");
        assert_eq!(found[2][1..4], ["p0915[1..2]", "5 0", "104 28"]);
        assert_eq!(found[3][1], "p0922");
    }
}
