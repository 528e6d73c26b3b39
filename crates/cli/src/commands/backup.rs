//! `profidrive backup DRIVE -o FILE`; exit code 1 when settings or motion tasks are missing.

use std::path::Path;

use client::backup::{Backup, Cause, TaskCoverage};
use client::{Drive, ErrorKind, Refusal, Wait};
use network::files::StateFile;
use profidrive::report::BackupReport;

use crate::advice::Commands;
use crate::args::{self, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &args::Backup, target: &Target, output: &Output) -> Result<(), Failure> {
    // what cannot be written is reported before anything is read
    let old = match &args.output {
        Some(path) => replaceable(path, args.force)?,
        None => None,
    };
    let (backup, drive) = whole(target, output)?;
    let label = drive.label();
    check_content(&backup, &label)?;
    let text = backup.to_string();
    if let Some(path) = &args.output {
        let same = old.as_deref() == Some(text.as_bytes());
        if !same {
            replace(path, &text)?;
        }
        let count = backup.readings().len();
        let unchanged = if same { ", unchanged" } else { "" };
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
            path.display()
        ));
    }
    let incomplete = incomplete(&backup, &label);
    if output.json() {
        let file = args.output.as_ref().map(|path| path.display().to_string());
        let complete = incomplete.is_none();
        let wording = Commands::any();
        output.json_report(&BackupReport::new(&drive, &backup, file, complete, &wording));
    } else if args.output.is_none() {
        output.raw(&text);
    }
    incomplete.map_or(Ok(()), Err)
}

/// Returns the missing settings of a backup, with reasons; `None` when it is complete.
fn incomplete(backup: &Backup, drive: &str) -> Option<Failure> {
    let refused = backup.refused();
    let mut missing = Vec::new();
    let mut hints = Vec::new();
    if !refused.is_empty() {
        missing.push(format!(
            "{} missing: {}",
            settings(refused.len()),
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
    (!missing.is_empty()).then(|| {
        let message = format!("the backup of {drive} is incomplete: {}", missing.join("; "));
        Failure::new(ErrorKind::Partial, message).hint(hints.join("; "))
    })
}

/// A backup without a value is none.
fn check_content(backup: &Backup, drive: &str) -> Result<(), Failure> {
    if !backup.readings().is_empty() || backup.task_count() > 0 {
        return Ok(());
    }
    let refused = backup.refused();
    let why = if refused.is_empty() {
        "it has no settings that can be listed".to_owned()
    } else {
        format!("{} missing: {}", settings(refused.len()), reasons(refused))
    };
    let message = format!("{drive} reports none of its settings, nothing is written: {why}");
    Err(Failure::new(ErrorKind::Difference, message).hint(
        "is it the selected model? {info} shows it, --model selects another; another tool may hold the parameter channel",
    ))
}

fn settings(count: usize) -> String {
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

/// Reads a backup file.
pub fn read(path: &Path) -> Result<Backup, Failure> {
    let wrong = |what: String| Failure::new(ErrorKind::Local, format!("{}: {what}", path.display()));
    let content = StateFile::document(path)
        .read()
        .map_err(|error| Failure::new(ErrorKind::Local, error.to_string()))?
        .ok_or_else(|| wrong("there is no such file".to_owned()))?;
    Backup::read(content).map_err(|error| match error.problems.as_slice() {
        [one] => {
            let failure = wrong(one.to_string());
            match hint(&one.cause) {
                Some(hint) => failure.hint(hint),
                None => failure,
            }
        }
        many => {
            let mut failure = wrong(format!("{} lines are wrong", many.len()));
            failure.details = many.iter().map(ToString::to_string).collect();
            failure
        }
    })
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

/// Returns the old content if the file may be replaced: a backup may, any other file only with `force`.
fn replaceable(path: &Path, force: bool) -> Result<Option<Vec<u8>>, Failure> {
    if path.is_dir() {
        return Err(Failure::usage(format!("{} is a folder", path.display())));
    }
    if path.exists() && !path.is_file() {
        let message = format!("{} is not a file that can be replaced", path.display());
        return Err(Failure::usage(message).hint("without -o the settings go to stdout"));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Err(Failure::usage(format!("there is no folder {}", folder.display())));
    }
    let old = match StateFile::document(path).read() {
        Ok(old) => old,
        Err(_) if force => return Ok(None),
        Err(error) => return Err(Failure::new(ErrorKind::Local, error.to_string())),
    };
    let is_backup = old
        .as_ref()
        .is_none_or(|old| old.is_empty() || old.starts_with(b"profidrive backup "));
    if is_backup || force {
        Ok(old)
    } else {
        let message = format!("{} is not a backup and is not replaced", path.display());
        Err(Failure::new(ErrorKind::Local, message).hint("choose another name; --force writes over it"))
    }
}

fn replace(path: &Path, text: &str) -> Result<(), Failure> {
    StateFile::document(path)
        .replace(text.as_bytes())
        .map_err(|error| Failure::new(ErrorKind::Local, error.to_string()))
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
            incomplete(&Backup::read(&text).unwrap(), "akd-1")
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

    #[test]
    fn an_invalid_target_is_refused_before_reading() {
        for (path, words) in [
            ("/dev/full", "not a file that can be replaced"),
            (
                "/no-such-folder/sub/a.b",
                "there is no folder /no-such-folder/sub",
            ),
            ("/tmp", "is a folder"),
        ] {
            for force in [false, true] {
                let failure = replaceable(Path::new(path), force).unwrap_err();
                assert_eq!(failure.kind, ErrorKind::Usage);
                assert!(failure.message.contains(words), "{}", failure.message);
            }
        }
        assert_eq!(replaceable(Path::new("no-such.backup"), false), Ok(None));
    }
}
