//! `profidrive backup DRIVE -o FILE`; exit code 1 when settings or motion tasks are missing.

use client::backup::{Backup, Cause, TaskCoverage};
use client::{Drive, ErrorKind, Wait};
use profidrive::Reported;
use profidrive::report::BackupReport;
use profidrive::settings::{self, BackupFile, FileError, Missing};

use crate::advice::Commands;
use crate::args::{self, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &args::Backup, target: &Target, output: &Output) -> Result<(), Failure> {
    // what cannot be written is reported before anything is read
    let file = args.output.as_ref();
    let file = file.map(|path| BackupFile::at(path, args.force)).transpose()?;
    let (read, drive) = whole(target, output)?;
    let (backup, problem) = (read.report, read.outcome.kind());
    let (label, missing) = (drive.label(), settings::missing(&backup));
    if problem == Some(ErrorKind::Difference) {
        return Err(without_content(&missing, &label));
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
        let refused = match backup.refused().len() {
            0 => String::new(),
            refused => format!(" (of {}, {refused} missing)", count + refused),
        };
        output.say(&format!(
            "{count} settings{refused}{tasks} of {label} in {}{unchanged}",
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
    problem.map_or(Ok(()), |kind| Err(incomplete(kind, &missing, &label)))
}

/// The missing settings of a backup, with reasons.
fn incomplete(kind: ErrorKind, missing: &Missing, drive: &str) -> Failure {
    let mut hints = Vec::new();
    if !missing.settings.is_empty() {
        hints.push(
            "the settings that are missing are comments in the backup; `profidrive restore` leaves them out",
        );
    }
    if missing.tasks.is_some() {
        hints.push("motion tasks are read while the power stage is off and no controller is connected");
    }
    let message = format!("the backup of {drive} is incomplete: {missing}");
    Failure::new(kind, message).hint(hints.join("; "))
}

/// A backup without a value is none.
fn without_content(missing: &Missing, drive: &str) -> Failure {
    let why = if missing.settings.is_empty() {
        "it has no settings that can be listed".to_owned()
    } else {
        missing.to_string()
    };
    let message = format!("{drive} reports none of its settings, nothing is written: {why}");
    Failure::new(ErrorKind::Difference, message).hint(
        "is it the selected model? {info} shows it, {choose model} selects another; another tool may hold the parameter channel",
    )
}

/// Returns all settings of a drive with the outcome, and the drive.
pub fn whole(target: &Target, output: &Output) -> Result<(Reported<Backup>, Drive), Failure> {
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
    let bar = connect::bar(output, 0, "reading");
    let progress = |done, of| {
        bar.set_length(of as u64);
        bar.set_position(done as u64);
    };
    let backup = settings::backup(&mut session, &mut drive, progress).wait();
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
