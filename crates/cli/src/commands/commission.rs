//! `profidrive commission`, and `profidrive diff` with a machine file

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use client::backup::Backup;
use client::change::Step;
use client::{Drive, ErrorKind, Wait};
use profidrive::commissioning::{self, MachineFile, Planned, Purpose};
use profidrive::machine::Machine;
use profidrive::report::{BackupReport, CommissionReport, Drives};
use profidrive::{Opening, Selector, listed, settings};

use super::each::{self, Row};
use super::remark;
use crate::advice::Commands;
use crate::args::{Commission, DriveOptions, Replace};
use crate::confirm::{Question, confirm};
use crate::connect::{self, Live, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::{Table, clean};
use crate::render::value;

pub fn run(args: &Commission, options: &DriveOptions, output: &Output) -> Result<(), Failure> {
    let path = args.file.clone().or_else(|| connect::machine_path(options));
    let path = path.ok_or_else(|| {
        Failure::usage("no machine file is named, and there is no machine.toml in this folder")
            .hint("`profidrive commission FILE`, or PROFIDRIVE_MACHINE")
    })?;
    if let Some(drives) = &args.from {
        return from(drives, &path, args.force, options, output);
    }
    let machine = selected(Machine::read(&path)?, args.only.as_deref())?;
    carry_out(&machine, MACHINE, (args.dry_run, args.yes), options, output)
}

/// Where the wanted state is from, as messages and tables name it.
#[derive(Clone, Copy)]
struct Origin {
    name: &'static str,
    heading: &'static str,
}

const MACHINE: Origin = Origin {
    name: "the file says",
    heading: ">in the file",
};
const BACKUP: Origin = Origin {
    name: "its backup says",
    heading: ">in the backup",
};

/// `profidrive replace NEW OLD`
pub fn replace(args: &Replace, options: &DriveOptions, output: &Output) -> Result<(), Failure> {
    let (mut session, new) = connect::drive(&options.target(&args.new), Need::Discovery, output)?;
    session.close().wait()?;
    let origin = if args.backup.is_some() { BACKUP } else { MACHINE };
    let machine = match &args.backup {
        Some(file) => Machine::replacement(&new, &args.old, file, &settings::read(file)?),
        None => {
            let machine = connect::machine(options, output)?.ok_or_else(|| {
                Failure::usage("neither a backup nor a machine file says what the old drive was like")
                    .hint("--backup FILE, or --machine FILE")
            })?;
            machine.with_replacement(&new, &args.old).ok_or_else(|| {
                let names: Vec<&str> = machine.drives.iter().map(|drive| drive.name.as_str()).collect();
                Failure::usage(format!("the machine file has no drive {}", args.old))
                    .hint(format!("it has {}", listed(&names)))
            })?
        }
    };
    carry_out(&machine, origin, (args.dry_run, args.yes), options, output)
}

/// Writes the machine file from the drives that are there, and their backups beside it.
fn from(
    drives: &str,
    path: &Path,
    force: bool,
    options: &DriveOptions,
    output: &Output,
) -> Result<(), Failure> {
    let file = MachineFile::at(path, force)?;
    let (mut session, found) = connect::drives(&options.target(drives), Need::Records, output)?;
    let bar = connect::bar(output, found.members.len(), "reading");
    let progress = |step: profidrive::Step| {
        bar.set_length(step.all as u64);
        bar.set_position(step.done as u64);
    };
    let read = commissioning::from_drives(&session, found.members, &file, progress).wait();
    bar.finish_and_clear();
    let closed = session.close().wait();
    let incomplete = |backup: &Backup, drive: &Drive| {
        let missing = settings::missing(backup);
        let message = format!("the backup of {} is incomplete: {missing}", drive.label());
        let problem = (!missing.is_nothing()).then(|| Failure::new(ErrorKind::Partial, message));
        problem.into_iter().collect()
    };
    let rows = read.drives.into_iter();
    let rows: Vec<Row<Backup>> = rows.map(|member| Row::new(member, incomplete)).collect();
    let entry = |backup: &Backup, drive: &Drive| {
        let place = file.backup_of(drive).display().to_string();
        let complete = settings::missing(backup).is_nothing();
        BackupReport::new(drive, backup, Some(place), complete, &Commands::any())
    };
    output.json_report(&Drives {
        drives: rows.iter().map(|row| row.entry(entry)).collect(),
        left_out: found.left_out,
    });
    for remark in &read.remarks {
        remark::print(remark, "", output);
    }
    let problems = each::ended(&rows, None, output).err().into_iter();
    let problems = match read.written {
        Ok(count) => {
            let plural = if count == 1 { "" } else { "s" };
            output.say(&format!("{count} drive{plural} in {}", path.display()));
            problems.collect()
        }
        Err(error) => problems.chain([error.into()]).collect(),
    };
    each::last::<Failure>(problems, output)?;
    Ok(closed?)
}

/// Shows what a machine needs, asks, and does it.
fn carry_out(
    machine: &Machine,
    origin: Origin,
    (dry_run, yes): (bool, bool),
    options: &DriveOptions,
    output: &Output,
) -> Result<(), Failure> {
    let (opening, mut session, planned) = plan(machine, Purpose::Commission, options, output)?;
    let objections = planned.iter().any(|one| !one.objections.is_empty());
    let changing = planned.iter().filter(|one| one.is_change()).count();
    if !output.json() {
        show(&planned, origin, output);
    }
    if objections || dry_run || changing == 0 {
        session.close().wait()?;
        output.json_report(&CommissionReport::new(machine, &planned, true, &Commands::any()));
        ended(planned, output).map_err(|failure| Failure {
            message: format!("nothing was changed; {}", failure.message),
            ..failure
        })?;
        let every = if machine.drives.len() == 1 {
            "the drive"
        } else {
            "every drive"
        };
        output.say(&if changing == 0 {
            format!("nothing to change: {every} is as {}", origin.name)
        } else {
            "dry run: nothing was changed".to_owned()
        });
        return Ok(());
    }
    if !yes {
        let text = match planned.len() {
            1 => "Change the drive?".to_owned(),
            all => format!("Change {changing} of {all} drives?"),
        };
        let question = Question {
            text: &text,
            undone: "nothing was changed",
            unasked: "--yes changes without asking",
        };
        confirm(&mut session, &question, output)?;
    }
    let bar = connect::bar(output, changing, "commissioning");
    let progress = |step: profidrive::Step| {
        bar.set_length(step.all as u64);
        bar.set_position(step.done as u64);
    };
    let done = commissioning::carry_out(&opening, &mut session, machine, planned, progress).wait();
    bar.finish_and_clear();
    let done = done?;
    let closed = session.close().wait();
    output.json_report(&CommissionReport::new(machine, &done, false, &Commands::any()));
    results(&done, origin, output);
    ended(done, output)?;
    Ok(closed?)
}

/// The drives of a machine that are not as its file says.
pub fn drift(path: &Path, drives: &str, options: &DriveOptions, output: &Output) -> Result<(), Failure> {
    let machine = selected(Machine::read(path)?, Some(drives))?;
    let (_, mut session, planned) = plan(&machine, Purpose::Compare, options, output)?;
    session.close().wait()?;
    output.json_report(&CommissionReport::new(&machine, &planned, true, &Commands::any()));
    if !output.json() {
        show(&planned, MACHINE, output);
    }
    let differ = planned.iter().filter(|one| one.is_change()).count();
    let drives = planned.len();
    ended(planned, output)?;
    if differ == 0 {
        output.say("no difference");
        return Ok(());
    }
    output.say(&format!("{differ} of {drives} drives differ from the file"));
    Err(Failure::silent(ErrorKind::Difference))
}

/// The machine with the drives that are meant.
fn selected(machine: Machine, only: Option<&str>) -> Result<Machine, Failure> {
    let Some(only) = only else {
        return Ok(machine);
    };
    let selector = Selector::of(only, Some(&machine)).map_err(|error| Failure::usage(error.to_string()))?;
    machine.only(&selector).ok_or_else(|| {
        let names: Vec<&str> = machine.drives.iter().map(|drive| drive.name.as_str()).collect();
        Failure::usage(format!("`{only}` fits no drive of the machine file"))
            .hint(format!("it has {}", listed(&names)))
    })
}

fn plan(
    machine: &Machine,
    purpose: Purpose,
    options: &DriveOptions,
    output: &Output,
) -> Result<(Opening, Live, Vec<Planned>), Failure> {
    let all = Selector::all();
    let (opening, mut session) = connect::network(&options.target("all"), &all, Need::Records, output)?;
    let steps = Mutex::new(connect::steps(output));
    let progress = |step: profidrive::Step| {
        steps.lock().unwrap_or_else(PoisonError::into_inner).show(&step);
    };
    let planned = commissioning::plan_with(&opening, &mut session, machine, purpose, progress).wait();
    drop(steps);
    Ok((opening, session, planned?))
}

/// What differs from the file, one line each.
fn show(planned: &[Planned], origin: Origin, output: &Output) {
    let mut table = Table::new(&["drive", "name", "number", ">now", "", origin.heading, "unit"]);
    for one in planned {
        let mut row = |name: &str, number: &str, now: &str, new: &str, unit: &str| {
            table.row([&one.wanted.name, name, number, now, "->", new, unit].map(clean));
        };
        if let Some(name) = &one.name {
            let now = name.old.as_deref().unwrap_or("-");
            row("station name", "", now, name.name.as_deref().unwrap_or("-"), "");
        }
        if let (Some(ip), Some(drive)) = (&one.ip, &one.drive) {
            let now = drive.station.ip;
            let now = if now.is_set() {
                now.address.to_string()
            } else {
                "-".to_owned()
            };
            row("IP address", "", &now, &ip.ip, "");
        }
        for change in one
            .settings
            .iter()
            .flat_map(|settings| settings.plan.set.changes())
        {
            let old = change.old.as_ref().and_then(|old| old.as_ref().ok());
            let ([old, new], unit) = value::pair(old, Some(&change.new));
            let name = change.new.name.unwrap_or_default();
            row(name, &change.new.shown().to_string(), &old, &new, &unit);
        }
        for task in one.settings.iter().flat_map(|settings| settings.plan.set.tasks()) {
            row(&format!("MT[{}]", task.number), "", "", "other values", "");
        }
        if one.settings_later {
            row("settings", "", "?", "compared once the drive has its address", "");
        }
        if one.unfinished {
            row("saved settings", "", "?", "saved (a run before did not end)", "");
        }
    }
    output.table(&table);
}

fn results(done: &[Planned], origin: Origin, output: &Output) {
    for one in done.iter().filter(|one| one.is_change()) {
        let name = &one.wanted.name;
        let set = one.settings.as_ref().map(|settings| &settings.plan.set);
        let written = set.map_or(0, |set| set.count(Step::is_written));
        if one.verified {
            output.say(&format!(
                "{name}: as {}; settings written: {written}",
                origin.name
            ));
        }
        if let Some(path) = &one.way_back {
            let path = path.display();
            output.say(&format!(
                "{name}: `profidrive restore {name} {path} --network` brings the values before back"
            ));
        }
    }
}

fn ended(planned: Vec<Planned>, output: &Output) -> Result<(), Failure> {
    let rows = planned.into_iter().map(|one| Row {
        name: one.wanted.name,
        drive: one.drive,
        done: Some(()),
        problems: one.objections.into_iter().map(Failure::from).collect(),
    });
    each::ended(&rows.collect::<Vec<_>>(), None, output)
}
