//! `profidrive backup DRIVE -o FILE`; exit code 1 when settings or motion tasks are missing.

use client::backup::{Backup, Cause, TaskCoverage};
use client::{Drive, ErrorKind, Refusal, Wait};
use profidrive::report::BackupReport;
use profidrive::settings::{self, BackupFile, FileError};

use crate::advice::Commands;
use crate::args::{self, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &args::Backup, target: &Target, output: &Output) -> Result<(), Failure> {
    // what cannot be written is reported before anything is read
    let file = args.output.as_ref();
    let file = file.map(|path| BackupFile::at(path, args.force)).transpose()?;
    let (backup, drive) = whole(target, output)?;
    let label = drive.label();
    let problem = settings::outcome(&backup).kind();
    if problem == Some(ErrorKind::Difference) {
        return Err(without_content(&backup, &label));
    }
    if let Some(file) = &file {
        let written = file.write(&backup)?;
        let count = backup.readings().len();
        let unchanged = if written { "" } else { ", unchanged" };
        let tasks = match (&backup.header.tasks, backup.task_count()) {
            (_, 0) => String::new(),
            (TaskCoverage::All, 1) => " and 1 motion task".to_owned(),
            (TaskCoverage::All, count) => format!(" and {count} motion tasks"),
            _ => String::new(),
        };
        let missing = match backup.refused().len() {
            0 => String::new(),
            refused => format!(" (of {}, {refused} missing)", count + refused),
        };
        output.say(&format!(
            "{count} settings{missing}{tasks} of {label} in {}{unchanged}",
            file.path().display()
        ));
    }
    if output.json() {
        let path = file.as_ref().map(|file| file.path().display().to_string());
        let wording = Commands::any();
        output.json_report(&BackupReport::new(
            &drive,
            &backup,
            path,
            problem.is_none(),
            &wording,
        ));
    } else if file.is_none() {
        output.raw(&backup.to_string());
    }
    problem.map_or(Ok(()), |kind| Err(incomplete(kind, &backup, &label)))
}

/// The missing settings of a backup, with reasons.
fn incomplete(kind: ErrorKind, backup: &Backup, drive: &str) -> Failure {
    let refused = backup.refused();
    let mut missing = Vec::new();
    let mut hints = Vec::new();
    if !refused.is_empty() {
        missing.push(format!(
            "{} missing: {}",
            counted(refused.len()),
            reasons(refused)
        ));
        hints.push(
            "the settings that are missing are comments in the backup; `profidrive restore` leaves them out",
        );
    }
    if let TaskCoverage::LeftOut(why) = &backup.header.tasks {
        missing.push(format!("the motion tasks are left out: {why}"));
        hints.push("motion tasks are read while the power stage is off and no controller is connected");
    }
    let message = format!("the backup of {drive} is incomplete: {}", missing.join("; "));
    Failure::new(kind, message).hint(hints.join("; "))
}

/// A backup without a value is none.
fn without_content(backup: &Backup, drive: &str) -> Failure {
    let refused = backup.refused();
    let why = if refused.is_empty() {
        "it has no settings that can be listed".to_owned()
    } else {
        format!("{} missing: {}", counted(refused.len()), reasons(refused))
    };
    let message = format!("{drive} reports none of its settings, nothing is written: {why}");
    Failure::new(ErrorKind::Difference, message).hint(
        "is it the selected model? {info} shows it, {choose model} selects another; another tool may hold the parameter channel",
    )
}

fn counted(count: usize) -> String {
    match count {
        1 => "1 setting".to_owned(),
        _ => format!("{count} settings"),
    }
}

/// Returns the reasons for missing settings, each with its parameters, the first few by name.
fn reasons(refused: &[Refusal]) -> String {
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for refusal in refused {
        let words = refusal.words();
        let name = refusal
            .name
            .map_or_else(|| refusal.shown.to_string(), str::to_owned);
        match reasons.iter_mut().find(|(known, _)| *known == words) {
            Some((_, names)) => names.push(name),
            None => reasons.push((words, vec![name])),
        }
    }
    let texts = reasons.iter().map(|(words, names)| {
        let first = names.get(..names.len().min(MOST_NAMED)).unwrap_or_default();
        let more = if first.len() < names.len() { ", .." } else { "" };
        format!("{}{more} ({words})", first.join(", "))
    });
    texts.collect::<Vec<_>>().join("; ")
}

/// Most names for one reason.
const MOST_NAMED: usize = 3;

/// Returns all settings of a drive, and the drive.
pub fn whole(target: &Target, output: &Output) -> Result<(Backup, Drive), Failure> {
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
    let bar = connect::bar(output, 0, "reading");
    let backup = session
        .backup(&mut drive, &mut |done, of| {
            bar.set_length(of as u64);
            bar.set_position(done as u64);
        })
        .wait();
    bar.finish_and_clear();
    let backup = backup?;
    session.close().wait()?;
    Ok((backup, drive))
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        let failure = Self::new(error.kind(), error.to_string());
        match error {
            FileError::Wrong { path, error } => match error.problems.as_slice() {
                [one] => match hint(&one.cause) {
                    Some(hint) => failure.hint(hint),
                    None => failure,
                },
                many => Self {
                    message: format!("{}: {} lines are wrong", path.display(), many.len()),
                    details: many.iter().map(ToString::to_string).collect(),
                    ..failure
                },
            },
            FileError::NotReplaceable(_) => failure.hint("without -o the settings go to stdout"),
            FileError::OtherContent(_) => failure.hint("choose another name; --force writes over it"),
            _ => failure,
        }
    }
}

/// What to do about a file that is not read.
const fn hint(cause: &Cause) -> Option<&'static str> {
    match cause {
        Cause::TooLong { .. } | Cause::NotText { .. } | Cause::OtherKind { .. } => {
            Some("`profidrive backup DRIVE -o FILE` writes a backup")
        }
        Cause::OtherVersion { .. } => Some("another version of profidrive wrote it; that version reads it"),
        Cause::NoLineBreak => Some("if the file is complete, end its last line with a line break"),
        Cause::Changed { .. } => {
            Some("if the file was changed on purpose and is complete, remove its last line, the checksum")
        }
        _ => None,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_backup_without_the_motion_tasks_is_incomplete() {
        let backup = |tasks: &str| {
            let text = format!(
                "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\n{tasks}p2108 = 1\n"
            );
            let backup = Backup::read(&text).unwrap();
            settings::outcome(&backup)
                .kind()
                .map(|kind| incomplete(kind, &backup, "akd-1"))
        };
        assert_eq!(backup(""), None);
        assert_eq!(backup("tasks: all\n"), None);
        let failure = backup("tasks: left out, the power stage is on\n").unwrap();
        assert_eq!(failure.kind, ErrorKind::Partial);
        assert_eq!(
            failure.message,
            "the backup of akd-1 is incomplete: the motion tasks are left out: the power stage is on"
        );
    }
}
