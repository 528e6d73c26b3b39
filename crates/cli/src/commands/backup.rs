//! `profidrive backup DRIVE -o FILE`, or many drives with a folder; exit code 1 when settings or motion tasks are missing.

use std::path::{Path, PathBuf};

use client::backup::{Backup, TaskCoverage};
use client::{Drive, ErrorKind, Session, Wait};
use profidrive::Reported;
use profidrive::report::BackupReport;
use profidrive::settings::{self, BackupFile, FileError, Missing};

use super::each::{self, Each, Progress, Shown};
use crate::advice::Commands;
use crate::args::{self, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &args::Backup, target: &Target, output: &Output) -> Result<(), Failure> {
    // what cannot be written is reported before anything is read
    let place = match (&args.output, connect::selector(target, output)?.single()) {
        (None, Some(_)) => Place::Output,
        (None, None) => {
            let failure = Failure::usage("the settings of several drives need a folder");
            return Err(failure.hint("-o FOLDER: each drive gets a file there, NAME.backup"));
        }
        (Some(path), Some(_)) => Place::File(BackupFile::at(path, args.force)?),
        (Some(folder), None) => {
            settings::make_folder(folder)?;
            Place::Folder(folder)
        }
    };
    let force = args.force;
    each::run(&Saving { place, force }, target, output)
}

/// Where backups go.
enum Place<'a> {
    Output,
    File(BackupFile),
    Folder(&'a Path),
}

struct Saving<'a> {
    place: Place<'a>,
    force: bool,
}

/// A backup, with the file that has it.
struct Saved {
    backup: Backup,
    problem: Option<ErrorKind>,
    /// Also what became of it.
    file: Option<(PathBuf, Kept)>,
}

/// What became of the file of a backup.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kept {
    New,
    /// An older backup had its name.
    Replaced,
    /// It had the same content.
    Unchanged,
}

impl Kept {
    const fn words(self) -> &'static str {
        match self {
            Self::New => "",
            Self::Replaced => "older one replaced",
            Self::Unchanged => "unchanged",
        }
    }
}

impl Each for Saving<'_> {
    const DOING: &'static str = "reading";

    async fn work(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        progress: &mut Progress<'_>,
    ) -> Result<Saved, Failure> {
        let read = settings::backup(session, drive, progress).await?;
        let (backup, problem) = (read.report, read.outcome.kind());
        if problem == Some(ErrorKind::Difference) {
            return Err(without_content(&settings::missing(&backup), &drive.label()));
        }
        let write = |file: &BackupFile| {
            let kept = match (file.write(&backup)?, file.has_content()) {
                (false, _) => Kept::Unchanged,
                (true, true) => Kept::Replaced,
                (true, false) => Kept::New,
            };
            Ok::<_, FileError>((file.path().to_owned(), kept))
        };
        let file = match &self.place {
            Place::Output => None,
            Place::File(file) => Some(write(file)?),
            Place::Folder(folder) => {
                let path = settings::file_in(folder, drive);
                Some(write(&BackupFile::at(&path, self.force)?)?)
            }
        };
        Ok(Saved {
            backup,
            problem,
            file,
        })
    }
}

impl Shown for Saving<'_> {
    type Done = Saved;
    type Report = BackupReport;
    const COLUMNS: &'static [&'static str] = &[">settings", ">missing", ">motion tasks", "file", ""];

    fn report(&self, done: &Saved, drive: &Drive) -> BackupReport {
        let path = done.file.as_ref().map(|(path, _)| path.display().to_string());
        BackupReport::new(
            drive,
            &done.backup,
            path,
            done.problem.is_none(),
            &Commands::any(),
        )
    }

    fn show(&self, done: &Saved, _: &Drive, output: &Output) {
        if done.file.is_none() {
            output.raw(&done.backup.to_string());
        }
    }

    fn remark(&self, done: &Saved, drive: &Drive, output: &Output) {
        let Saved { backup, file, .. } = done;
        let Some((path, kept)) = file else { return };
        let (label, count) = (drive.label(), backup.readings().len());
        let kept = match kept.words() {
            "" => String::new(),
            words => format!(", {words}"),
        };
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
            "{count} settings{refused}{tasks} of {label} in {}{kept}",
            path.display()
        ));
    }

    fn rows(&self, done: &Saved, _: &Drive) -> Vec<Vec<String>> {
        let Saved { backup, file, .. } = done;
        let (path, kept) = file.as_ref().map_or_else(
            || (String::new(), ""),
            |(path, kept)| (path.display().to_string(), kept.words()),
        );
        let tasks = match &backup.header.tasks {
            TaskCoverage::LeftOut(_) => "left out".to_owned(),
            _ => backup.task_count().to_string(),
        };
        vec![vec![
            backup.readings().len().to_string(),
            backup.refused().len().to_string(),
            tasks,
            path,
            kept.to_owned(),
        ]]
    }

    fn problems(&self, done: &Saved, drive: &Drive) -> Vec<Failure> {
        let missing = settings::missing(&done.backup);
        let incomplete = |kind| incomplete(kind, &missing, &drive.label());
        done.problem.map(incomplete).into_iter().collect()
    }
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

/// An empty backup is an error.
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
        let failure = Self::explained(&error);
        match error {
            FileError::NotReplaceable(_) => failure.hint("without -o the settings go to stdout"),
            _ => failure,
        }
    }
}
