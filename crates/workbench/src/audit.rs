//! The log of what people did by a server: one line of JSON for each intent and each result, in files of one day.
//!
//! An intent is on the disk before anything is sent to a drive. Where it cannot be written nothing is changed; a stop is carried out
//! anyway.

use std::collections::VecDeque;
use std::fs::{DirBuilder, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime};

use chrono::{DateTime, SecondsFormat, Utc};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A file is not written to once it has this many octets.
const FILE: u64 = 64 << 20;
/// Files that are kept.
const FILES: usize = 30;
/// The longest text of a record, in characters.
const TEXT: usize = 2000;

/// What was wanted, or what became of it.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
pub(crate) struct Record {
    /// Who: the number of a session, or `token` for a program.
    pub who: String,
    /// What the people of that session call themselves, which nothing verifies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub claimed_name: Option<String>,
    /// The IP address that its connection came from; that of a proxy or a tunnel where one is between.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub address: Option<String>,
    /// The drive, as it is called in paths.
    pub drive: Option<String>,
    /// What the drive is called.
    pub name: Option<String>,
    /// Serial number of the drive, where it was read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub serial: Option<String>,
    /// Time of the engine, in microseconds: that of frames and samples. Of a plant it is that of the plant.
    pub engine_us: u64,
    /// How often STOP was pressed before.
    pub epoch: u64,
    /// What is done: `acknowledge`, `inject`, `write`, `restore`, `undo`, `stop`.
    pub action: &'static str,
    /// With which values.
    pub value: Option<String>,
    /// Each value that is or was changed, in one line: before, after, and in a result how far it came.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<String>,
    /// The drives of a STOP of all axes, as they are called in paths.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drives: Vec<String>,
    /// What became of it; null for an intent.
    pub result: Option<String>,
}

/// A record in the log.
#[derive(Debug, Serialize)]
struct Line<'r> {
    /// Time of day (ISO 8601, UTC).
    time: String,
    /// Distinguishes this start of the server from others.
    boot: &'r str,
    #[serde(flatten)]
    record: &'r Record,
}

/// A record as it was read from the log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct LogRecord {
    /// Time of day (ISO 8601, UTC).
    pub time: String,
    /// Distinguishes the start of the server that wrote it from others.
    pub boot: String,
    /// Who: the number of a session, or `token` for a program.
    pub who: String,
    /// What the people of that session called themselves, which nothing has verified.
    #[serde(default)]
    pub claimed_name: Option<String>,
    /// The IP address that its connection came from, that of a proxy or a tunnel where one was between; absent in records of older
    /// versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub address: Option<String>,
    /// The drive, as it is called in paths.
    pub drive: Option<String>,
    /// What the drive was called.
    pub name: Option<String>,
    /// Serial number of the drive, where it was read.
    #[serde(default)]
    pub serial: Option<String>,
    /// Time of the engine, in microseconds; null in records of older versions.
    #[serde(default)]
    pub engine_us: Option<u64>,
    /// How often STOP was pressed before; null in records of older versions.
    #[serde(default)]
    pub epoch: Option<u64>,
    /// What was done.
    pub action: String,
    /// With which values.
    pub value: Option<String>,
    /// Each value that was to be changed or was changed, in one line.
    #[serde(default)]
    pub changes: Vec<String>,
    /// The drives of a STOP of all axes, as they are called in paths; absent in records of other things and of older versions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drives: Vec<String>,
    /// What became of it; null for an intent.
    pub result: Option<String>,
}

/// Which records are read.
#[derive(Debug, Clone, Default)]
pub(crate) struct Wanted {
    /// Those of this drive, as it is called in paths.
    pub drive: Option<String>,
    /// Those of this action.
    pub action: Option<String>,
    /// Those with this text anywhere, in lower case.
    pub text: Option<String>,
}

impl Wanted {
    fn record(&self, line: &str) -> Option<LogRecord> {
        let has = |text: &String| line.to_lowercase().contains(text);
        if !self.text.as_ref().is_none_or(has) {
            return None;
        }
        // what is no record was not written by this program
        let record: LogRecord = serde_json::from_str(line).ok()?;
        let is =
            |wanted: &Option<String>, value: Option<&String>| wanted.is_none() || wanted.as_ref() == value;
        let stopped = self
            .drive
            .as_ref()
            .is_some_and(|drive| record.drives.contains(drive));
        let of_drive = stopped || is(&self.drive, record.drive.as_ref());
        (of_drive && is(&self.action, Some(&record.action))).then_some(record)
    }
}

/// The place of a record: its file, and its line in it.
type Place = (String, usize);

/// Records of the log, the newest first.
#[derive(Debug, Default, Serialize, JsonSchema)]
pub(crate) struct LogPage {
    records: Vec<LogRecord>,
    /// Where the next older ones begin; null where there are none.
    before: Option<String>,
}

/// The log of a server.
#[derive(Debug)]
pub(crate) struct Audit {
    folder: Option<PathBuf>,
    boot: String,
    open: Mutex<Option<(PathBuf, File)>>,
    /// Records that were written since the start.
    written: AtomicU64,
    turn: Mutex<()>,
}

/// Why a record could not be written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum AuditError {
    #[error("there is no folder for the log: HOME and XDG_STATE_HOME are not set")]
    NoFolder,
    #[error("cannot write the log in {}: {error}", folder.display())]
    Write { folder: PathBuf, error: io::Error },
}

impl Audit {
    /// Returns the log in a folder, which is made where it is needed.
    pub const fn new(folder: Option<PathBuf>, boot: String) -> Self {
        Self {
            folder,
            boot,
            open: Mutex::new(None),
            written: AtomicU64::new(0),
            turn: Mutex::new(()),
        }
    }

    /// Returns how many records were written since the start.
    pub fn written(&self) -> u64 {
        self.written.load(Ordering::Relaxed)
    }

    /// Returns the files of the log, the oldest first.
    fn files(&self) -> io::Result<Vec<PathBuf>> {
        match &self.folder {
            Some(folder) if folder.exists() => files(folder),
            _ => Ok(Vec::new()),
        }
    }

    /// Reads records, the newest first: those before a place that an earlier page gave, at most `most`.
    pub fn page(&self, wanted: &Wanted, before: Option<&str>, most: usize) -> io::Result<LogPage> {
        let before: Option<Place> = before
            .and_then(|text| text.rsplit_once(':'))
            .and_then(|(file, line)| Some((file.to_owned(), line.parse().ok()?)));
        let mut page = LogPage::default();
        for path in self.files()?.iter().rev() {
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            let end = match &before {
                Some((file, _)) if name > *file => continue,
                Some((file, line)) if name == *file => *line,
                _ => usize::MAX,
            };
            let room = most - page.records.len();
            let mut last: VecDeque<(usize, LogRecord)> = VecDeque::new();
            for (number, line) in BufReader::new(File::open(path)?).lines().enumerate().take(end) {
                let Some(record) = wanted.record(&line?) else {
                    continue;
                };
                // one more says that there are older ones
                if last.len() > room {
                    last.pop_front();
                }
                last.push_back((number, record));
            }
            let is_full = last.len() > room;
            if is_full {
                last.pop_front();
            }
            let oldest = last.front().map_or(end, |(number, _)| *number);
            page.records
                .extend(last.into_iter().rev().map(|(_, record)| record));
            if is_full {
                page.before = Some(format!("{name}:{oldest}"));
                break;
            }
        }
        Ok(page)
    }

    /// Waits until nothing else has the turn to read the whole log. However many read it, they take one processor.
    pub fn turn(&self) -> MutexGuard<'_, ()> {
        self.turn.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls `each` with every record, the oldest first, until that has no room for more.
    pub fn each(&self, wanted: &Wanted, each: &mut dyn FnMut(&str, &LogRecord) -> bool) -> io::Result<()> {
        for path in self.files()? {
            for line in BufReader::new(File::open(path)?).lines() {
                let line = line?;
                if let Some(record) = wanted.record(&line)
                    && !each(&line, &record)
                {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// Checks that records can be written: makes the folder and the file of today.
    pub fn check(&self) -> Result<(), AuditError> {
        let folder = self.folder.as_ref().ok_or(AuditError::NoFolder)?;
        let opened = next(folder, &day(SystemTime::now()));
        opened.map(|_| ()).map_err(|error| AuditError::Write {
            folder: folder.clone(),
            error,
        })
    }

    /// Writes a record, so that it is on the disk when this returns.
    pub fn write(&self, record: &Record) -> Result<(), AuditError> {
        self.write_at(record, SystemTime::now())
    }

    fn write_at(&self, record: &Record, now: SystemTime) -> Result<(), AuditError> {
        let folder = self.folder.as_ref().ok_or(AuditError::NoFolder)?;
        let failed = |error| AuditError::Write {
            folder: folder.clone(),
            error,
        };
        let record = Record {
            value: record.value.as_deref().map(cut),
            result: record.result.as_deref().map(cut),
            changes: record.changes.iter().map(|change| cut(change)).collect(),
            ..record.clone()
        };
        let time = DateTime::<Utc>::from(now);
        let line = Line {
            time: time.to_rfc3339_opts(SecondsFormat::Millis, true),
            boot: &self.boot,
            record: &record,
        };
        let mut text = serde_json::to_string(&line).map_err(|error| failed(error.into()))?;
        text.push('\n');
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let result = append(folder, &mut open, &day(now), text.as_bytes());
        if result.is_err() {
            // a folder that was removed or was full may be there again
            *open = None;
        }
        result.map_err(failed)?;
        self.written.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }
}

fn cut(text: &str) -> String {
    text.chars().take(TEXT).collect()
}

fn day(now: SystemTime) -> String {
    DateTime::<Utc>::from(now).format("%Y-%m-%d").to_string()
}

fn append(folder: &Path, open: &mut Option<(PathBuf, File)>, day: &str, text: &[u8]) -> io::Result<()> {
    let is_usable = |path: &Path, file: &File| -> io::Result<bool> {
        let of_day = path
            .file_name()
            .is_some_and(|name| name.to_string_lossy().contains(day));
        Ok(of_day && file.metadata()?.len() < FILE && path.exists())
    };
    let usable = match open.as_ref() {
        Some((path, file)) => is_usable(path, file)?,
        None => false,
    };
    if !usable {
        *open = Some(next(folder, day)?);
    }
    let Some((_, file)) = open.as_mut() else {
        return Ok(());
    };
    file.write_all(text)?;
    file.sync_data()
}

/// Opens the file of a day that has room, a new one where there is none, and removes the oldest files.
fn next(folder: &Path, day: &str) -> io::Result<(PathBuf, File)> {
    let mut builder = DirBuilder::new();
    let mut options = OpenOptions::new();
    options.create(true).append(true);
    private(&mut builder, &mut options);
    builder.recursive(true).create(folder)?;
    for number in 0_u32.. {
        let path = folder.join(format!("audit-{day}-{number:03}.jsonl"));
        if path.metadata().is_ok_and(|file| file.len() >= FILE) {
            continue;
        }
        let file = options.open(&path)?;
        remove_old(folder)?;
        return Ok((path, file));
    }
    Err(io::ErrorKind::QuotaExceeded.into())
}

/// Returns the files of the log in a folder, the oldest first.
fn files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files: Vec<PathBuf> = folder
        .read_dir()?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("audit-") && name.ends_with(".jsonl")
        })
        .collect();
    // their names are in the order of time
    files.sort();
    Ok(files)
}

fn remove_old(folder: &Path) -> io::Result<()> {
    let files = files(folder)?;
    let old = files.len().saturating_sub(FILES);
    for path in files.iter().take(old) {
        std::fs::remove_file(path)?;
    }
    Ok(())
}

/// Lets only this user read the log.
#[cfg(unix)]
fn private(builder: &mut DirBuilder, options: &mut OpenOptions) {
    use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
    builder.mode(0o700);
    options.mode(0o600);
}

/// The folder of a user is its own.
#[cfg(not(unix))]
fn private(_: &mut DirBuilder, _: &mut OpenOptions) {}

/// Records of a kind that changes nothing that are logged at once, and then one in each second: a flood does not fill the log.
const UNCHANGED: u32 = 20;

/// Bounds how many records are logged of what changes nothing: refusals, and stops of what stands already.
#[derive(Debug)]
pub(crate) struct Flood {
    room: u32,
    /// When there was room for one more last.
    since: Instant,
    left_out: u64,
}

impl Flood {
    pub const fn new(now: Instant) -> Self {
        Self {
            room: UNCHANGED,
            since: now,
            left_out: 0,
        }
    }

    /// Returns how many were left out before, where this one is to be logged.
    pub fn admit(&mut self, now: Instant) -> Option<u64> {
        let seconds = now.saturating_duration_since(self.since).as_secs();
        if seconds > 0 {
            self.since += Duration::from_secs(seconds);
            let more = u32::try_from(seconds).unwrap_or(UNCHANGED);
            self.room = self.room.saturating_add(more).min(UNCHANGED);
        }
        if self.room == 0 {
            self.left_out += 1;
            return None;
        }
        self.room -= 1;
        Some(std::mem::take(&mut self.left_out))
    }
}

#[cfg(test)]
mod tests {
    use std::time::UNIX_EPOCH;

    use serde_json::Value;

    use super::*;

    /// A folder that is removed at the end of a test.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("profidrive-audit-{name}-{}", std::process::id()));
            std::fs::create_dir(&path).unwrap();
            Self(path)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    fn at(day: u64) -> SystemTime {
        UNIX_EPOCH + Duration::from_secs(day * 86_400 + 3)
    }

    fn record(value: &str) -> Record {
        Record {
            who: "1".to_owned(),
            action: "inject",
            value: Some(value.to_owned()),
            ..Record::default()
        }
    }

    #[test]
    fn each_day_has_a_file_and_the_oldest_are_removed() {
        let folder = Folder::new("days");
        let place = folder.0.join("log");
        let audit = Audit::new(Some(place.clone()), "boot".to_owned());
        for day in 0..40 {
            audit.write_at(&record("one\n\"two\""), at(day)).unwrap();
            audit.write_at(&record("three"), at(day)).unwrap();
        }
        let mut names: Vec<String> = place
            .read_dir()
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(names.len(), FILES);
        assert_eq!(names[0], "audit-1970-01-11-000.jsonl");
        let text = std::fs::read_to_string(place.join(&names[0])).unwrap();
        let lines: Vec<Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[0]["value"], "one\n\"two\"");
        assert_eq!(lines[0]["time"], "1970-01-11T00:00:03.000Z");
        assert_eq!(lines[0]["boot"], "boot");
    }

    #[test]
    fn a_file_that_is_full_or_gone_is_followed_by_another() {
        let folder = Folder::new("full");
        let audit = Audit::new(Some(folder.0.clone()), "boot".to_owned());
        audit.write_at(&record("a"), at(1)).unwrap();
        let first = folder.0.join("audit-1970-01-02-000.jsonl");
        let file = OpenOptions::new().write(true).open(&first).unwrap();
        file.set_len(FILE).unwrap();
        audit.write_at(&record("b"), at(1)).unwrap();
        let second = folder.0.join("audit-1970-01-02-001.jsonl");
        assert_eq!(std::fs::read_to_string(&second).unwrap().lines().count(), 1);
        std::fs::remove_file(&second).unwrap();
        audit.write_at(&record("c"), at(1)).unwrap();
        assert!(std::fs::read_to_string(&second).unwrap().contains("\"c\""));
    }

    fn read(page: &LogPage) -> Vec<&str> {
        page.records
            .iter()
            .filter_map(|record| record.value.as_deref())
            .collect()
    }

    #[test]
    fn pages_have_the_newest_first_over_all_files() {
        let folder = Folder::new("pages");
        let audit = Audit::new(Some(folder.0.clone()), "boot".to_owned());
        for number in 0..25 {
            audit
                .write_at(&record(&format!("n{number}")), at(number / 10))
                .unwrap();
        }
        let all = Wanted::default();
        let first = audit.page(&all, None, 10).unwrap();
        assert_eq!((read(&first)[0], read(&first)[9]), ("n24", "n15"));
        let second = audit.page(&all, first.before.as_deref(), 10).unwrap();
        assert_eq!((read(&second)[0], read(&second)[9]), ("n14", "n5"));
        let last = audit.page(&all, second.before.as_deref(), 10).unwrap();
        assert_eq!((read(&last)[0], read(&last)[4]), ("n4", "n0"));
        assert_eq!(last.before, None);
        let one = Wanted {
            text: Some("n13".to_owned()),
            ..Wanted::default()
        };
        assert_eq!(read(&audit.page(&one, None, 10).unwrap()), ["n13"]);
        let none = Wanted {
            action: Some("write".to_owned()),
            ..Wanted::default()
        };
        assert_eq!(audit.page(&none, None, 10).unwrap().records, []);
        // what no program wrote is passed over
        let file = folder.0.join("audit-1970-01-03-000.jsonl");
        let mut damaged = OpenOptions::new().append(true).open(file).unwrap();
        damaged.write_all(b"{\"half\n[1]\n").unwrap();
        let mut count = 0;
        audit
            .each(&all, &mut |_, _| {
                count += 1;
                true
            })
            .unwrap();
        assert_eq!((count, audit.written()), (25, 25));
    }

    #[test]
    fn without_a_place_nothing_is_written() {
        let none = Audit::new(None, "boot".to_owned());
        assert!(matches!(none.write(&record("a")), Err(AuditError::NoFolder)));
        let folder = Folder::new("none");
        let file = folder.0.join("file");
        std::fs::write(&file, "").unwrap();
        let blocked = Audit::new(Some(file.join("log")), "boot".to_owned());
        assert!(matches!(
            blocked.write(&record("a")),
            Err(AuditError::Write { .. })
        ));
    }

    #[test]
    fn a_flood_of_refusals_is_counted() {
        let begin = Instant::now();
        let mut refusals = Flood::new(begin);
        for _ in 0..UNCHANGED {
            assert_eq!(refusals.admit(begin), Some(0));
        }
        for _ in 0..5 {
            assert_eq!(refusals.admit(begin), None);
        }
        assert_eq!(refusals.admit(begin + Duration::from_secs(1)), Some(5));
        assert_eq!(refusals.admit(begin + Duration::from_secs(1)), None);
        assert_eq!(refusals.admit(begin + Duration::from_secs(2)), Some(1));
    }
}
