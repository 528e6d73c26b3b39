//! `profidrive diff A B`

use std::path::Path;

use drive_client::backup::{Backup, Side, TasksTold, compare, compare_tasks};
use drive_client::{Drive, DriveAddress, Refusal};
use profidrive::parameter::ErrorNumber;
use serde_json::{Map, Value};

use super::backup::{self, task_json};
use super::parameters::refusal_json;
use crate::args::Interface;
use crate::connect::{self, Need};
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::Output;
use crate::render::table::Table;
use crate::render::value;

/// Arguments of `diff`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A backup file or a drive; a file of this name comes first
    #[arg(value_name = "A")]
    pub left: String,
    /// A backup file or a drive
    #[arg(value_name = "B")]
    pub right: String,
}

pub fn run(args: &Args, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (left, right) = (source(&args.left)?, source(&args.right)?);
    let (left, right) = match (left, right) {
        (Some(left), Some(right)) => (left, right),
        // of a drive, what the file says counts: it may hold a part only
        (Some(file), None) => {
            let drive = like(&file, &args.right, interface, output)?;
            (file, drive)
        }
        (None, Some(file)) => (like(&file, &args.left, interface, output)?, file),
        (None, None) => {
            let left = whole(&args.left, interface, output)?;
            (left, whole(&args.right, interface, output)?)
        }
    };
    if left.header.model != right.header.model {
        let message = format!(
            "{} is of a {}, {} of a {}: parameters of two models cannot be compared",
            args.left, left.header.model, args.right, right.header.model
        );
        return Err(Failure::usage(message));
    }
    for remark in left.header.remarks(&right.header) {
        output.say(
            &remark
                .replace("in the settings", "on the left")
                .replace("in the drive", "on the right"),
        );
    }
    for (name, one, other) in [(&args.left, &left, &right), (&args.right, &right, &left)] {
        if let (TasksTold::LeftOut(why), false) = (&one.header.tasks, other.task_numbers().is_empty()) {
            output.warn(&format!(
                "motion tasks are not compared: they are left out of {name}: {why}"
            ));
        }
    }
    let differences = compare(&left, &right);
    let tasks = compare_tasks(&left, &right);
    if output.json() {
        let list: Vec<Value> = differences
            .iter()
            .map(|one| {
                let mut fields = one.reading().map_or_else(Map::new, |reading| {
                    fields! { "pnu": reading.pnu, "index": reading.index, "name": reading.name }
                });
                fields.insert("left".into(), side_json(&one.left));
                fields.insert("right".into(), side_json(&one.right));
                Value::Object(fields)
            })
            .collect();
        let tasks: Vec<Value> = tasks
            .iter()
            .map(|one| {
                let mut fields = fields! { "number": one.number };
                fields.insert("left".into(), Value::Object(task_json(&one.left)));
                fields.insert("right".into(), Value::Object(task_json(&one.right)));
                Value::Object(fields)
            })
            .collect();
        output.document(
            "diff",
            fields! { "left": args.left.as_str(), "right": args.right.as_str(), "differences": list,
            "tasks": tasks },
        );
    } else if !differences.is_empty() {
        let mut table = Table::new(&["name", "number", ">left", ">right", "unit", "meaning"]);
        for one in &differences {
            let Some(reading) = one.reading() else { continue };
            let meaning = [&one.left, &one.right].map(meaning);
            let meaning = match meaning {
                [left, right] if left.is_empty() && right.is_empty() => String::new(),
                [left, right] => format!("{left} / {right}"),
            };
            table.row([
                reading.name.unwrap_or_default().to_owned(),
                reading.shown().to_string(),
                side(&one.left),
                side(&one.right),
                reading.unit.to_owned(),
                meaning,
            ]);
        }
        for line in table.lines() {
            output.line(&line);
        }
    }
    if !output.json() {
        for one in &tasks {
            output.line(&format!("MT[{}]", one.number));
            output.line(&format!("  left   {}", one.left.text(left.parameters())));
            output.line(&format!("  right  {}", one.right.text(right.parameters())));
        }
    }
    match differences.len() + tasks.len() {
        0 => {
            output.say("no difference");
            Ok(())
        }
        count => {
            let plural = if count == 1 { "" } else { "s" };
            output.say(&format!("{count} difference{plural}"));
            Err(Failure::told(Exit::Difference))
        }
    }
}

/// The file, where there is one of this name or the text is a path; `None` for a drive.
fn source(text: &str) -> Result<Option<Backup>, Failure> {
    let path = Path::new(text);
    let drive = text.parse::<DriveAddress>();
    let at_line = matches!(drive, Ok(DriveAddress::Line(_)));
    if path.is_file() || (text.contains('/') && !at_line) {
        backup::read(path).map(Some)
    } else if drive.is_err() {
        Err(Failure::usage(format!(
            "there is no file {text}, and no drive can have this name"
        )))
    } else {
        Ok(None)
    }
}

fn whole(text: &str, interface: &Interface, output: &Output) -> Result<Backup, Failure> {
    let (mut session, mut drive) = connect::drive(interface, Need::Records, text, output)?;
    let bar = connect::bar(output, 0, "reading");
    let backup = session.backup(&mut drive, &mut |done, of| {
        bar.set_length(of as u64);
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    let backup = backup?;
    session.close()?;
    Ok(backup)
}

/// The parameters of a file, as the drive has them.
fn like(file: &Backup, text: &str, interface: &Interface, output: &Output) -> Result<Backup, Failure> {
    let (mut session, mut drive) = connect::drive(interface, Need::Records, text, output)?;
    fits(file, &drive)?;
    let spinner = connect::spinner(output, format!("reading {}", drive.label()));
    let backup = session.backup_like(&mut drive, file);
    spinner.finish_and_clear();
    let backup = backup?;
    session.close()?;
    let more = drive_client::backup::everything(&drive.model)
        .iter()
        .filter(|selection| {
            file.reading(selection.pnu, selection.indexed.then_some(0))
                .is_none()
        })
        .count();
    if more > 0 {
        output.say(&format!(
            "{more} settings of {} are not in the file and are not compared",
            drive.label()
        ));
    }
    Ok(backup)
}

fn fits(file: &Backup, drive: &Drive) -> Result<(), Failure> {
    match file.header.misfit(drive) {
        Some(misfit) => Err(Failure::usage(misfit)),
        None => Ok(()),
    }
}

fn side(side: &Side) -> String {
    match side {
        Side::Missing => "(missing)".into(),
        Side::Refused(Refusal { number, .. }) => format!("({})", short(*number)),
        Side::Value(reading) => value::value(reading),
    }
}

fn short(number: ErrorNumber) -> String {
    format!("refused 0x{:02X}", number.0)
}

fn meaning(side: &Side) -> String {
    match side {
        Side::Value(reading) => value::meaning(reading),
        Side::Missing | Side::Refused(_) => String::new(),
    }
}

fn side_json(side: &Side) -> Value {
    match side {
        Side::Missing => Value::Null,
        Side::Refused(refusal) => Value::Object(refusal_json(refusal)),
        Side::Value(reading) => value::json(reading),
    }
}
