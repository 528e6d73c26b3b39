//! `profidrive diff FOLDER DRIVE`: drives against the backups that `profidrive backup all -o FOLDER` wrote.

use std::path::{Path, PathBuf};

use client::backup::Backup;
use client::{Drive, ErrorKind, Session};
use profidrive::report::DiffReport;
use profidrive::settings::{self, Comparison};

use super::diff;
use super::each::{self, Each, Progress, Row, Shown};
use crate::advice::Commands;
use crate::args::Target;
use crate::failure::Failure;
use crate::output::Output;

pub fn run(folder: &Path, target: &Target, output: &Output) -> Result<(), Failure> {
    let all = target.drive.trim().eq_ignore_ascii_case("all");
    each::run(&InFolder { folder, all }, target, output)
}

/// Drives that are compared with their backups.
struct InFolder<'a> {
    folder: &'a Path,
    /// All drives are meant: a backup without a drive is a difference too.
    all: bool,
}

/// The settings of a drive, in its backup and now.
struct Compared {
    path: PathBuf,
    file: Backup,
    now: Backup,
}

impl Compared {
    fn comparison(&self) -> Option<Comparison<'_>> {
        // both are of one model: the drive was read as the file is
        Comparison::new(&self.file, &self.now).ok()
    }

    fn count(&self) -> usize {
        self.comparison().map_or(0, |comparison| comparison.count())
    }
}

impl Each for InFolder<'_> {
    const DOING: &'static str = "comparing";

    async fn work(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        _: &mut Progress<'_>,
    ) -> Result<Compared, Failure> {
        let path = settings::file_in(self.folder, drive);
        let file = settings::read(&path)?;
        let now = settings::as_in(session, drive, &file).await?;
        Ok(Compared { path, file, now })
    }
}

impl Shown for InFolder<'_> {
    type Done = Compared;
    type Report = DiffReport;
    const COLUMNS: &'static [&'static str] = &["name", "number", ">in the backup", ">now", "unit", "meaning"];
    const MATTER: Option<&'static str> = Some("not as in the backup");

    fn report(&self, done: &Compared, drive: &Drive) -> DiffReport {
        let (left, right) = (done.path.display().to_string(), drive.label());
        match done.comparison() {
            Some(comparison) => comparison.report(&left, &right, &Commands::any()),
            None => DiffReport {
                left,
                right,
                differences: Vec::new(),
                tasks: Vec::new(),
                network: Vec::new(),
            },
        }
    }

    fn show(&self, done: &Compared, drive: &Drive, output: &Output) {
        let rows = [each::TableRow {
            name: &drive.label(),
            done: Some((done, drive)),
            answered: true,
        }];
        each::table(self, rows.into_iter(), output);
    }

    fn remark(&self, done: &Compared, _: &Drive, output: &Output) {
        if done.count() == 0 {
            output.say("no difference");
        }
    }

    fn remark_on_all(&self, rows: &[Row<Compared>], output: &Output) {
        let same = rows.iter().filter_map(|row| row.done.as_ref());
        let same = same.filter(|done| done.count() == 0).count();
        output.say(&format!(
            "{same} of {} drives are as in their backups",
            rows.len()
        ));
        if self.all {
            let names: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
            for path in settings::without_drive(self.folder, &names) {
                output.warn(&format!("{}: no drive of this name answers", path.display()));
            }
        }
    }

    fn rows(&self, done: &Compared, _: &Drive) -> Vec<Vec<String>> {
        let Some(comparison) = done.comparison() else {
            return Vec::new();
        };
        let settings = diff::rows(&comparison).into_iter().map(Vec::from);
        let tasks = comparison.tasks.iter();
        let tasks = tasks.map(|task| {
            vec![
                format!("MT[{}]", task.number),
                String::new(),
                "other values".to_owned(),
            ]
        });
        settings.chain(tasks).collect()
    }

    fn problems(&self, done: &Compared, drive: &Drive) -> Vec<Failure> {
        let count = done.count();
        if count == 0 {
            return Vec::new();
        }
        let plural = if count == 1 { "" } else { "s" };
        let message = format!(
            "{}: {count} difference{plural} from {}",
            drive.label(),
            done.path.display()
        );
        vec![Failure::new(ErrorKind::Difference, message)]
    }
}
