//! The files with settings of drives that this server keeps, beside its log.

use std::fs::Metadata;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use axum::http::StatusCode;
use chrono::{DateTime, Utc};
use profidrive::client::backup::Backup;
use profidrive::settings::{self, BackupFile};
use schemars::JsonSchema;
use serde::Serialize;

use crate::problem::Problem;
use crate::shared::Shared;

/// Files that are listed, the newest first.
const LISTED: usize = 200;

/// Files in the folder, after which no more are made: none is removed by this server.
const FILES: usize = 5000;

/// A file with settings.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct KeptBackup {
    /// Its name.
    file: String,
    /// The name of station of the drive; empty where the file does not have it.
    drive: String,
    /// The model of the drive.
    model: String,
    /// How many settings it has.
    settings: usize,
    /// Whether it has the values before a restore.
    before: bool,
    /// When it was made, in seconds since 1970-01-01 UTC.
    time: f64,
}

/// Returns the folder, which is made with the first file.
fn folder(shared: &Shared) -> Result<&Path, Problem> {
    shared.backups.as_deref().ok_or_else(|| {
        let detail = "there is no folder for settings: HOME and XDG_STATE_HOME are not set";
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "local", detail)
    })
}

/// Returns the files, the newest first.
fn files(folder: &Path) -> Vec<(String, PathBuf, SystemTime)> {
    let entries = folder.read_dir().into_iter().flatten().flatten();
    let mut files: Vec<_> = entries
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            let metadata: Metadata = entry.metadata().ok()?;
            let is_one = metadata.is_file() && name.contains(".backup") && !name.starts_with('.');
            is_one.then(|| (name, entry.path(), metadata.modified().unwrap_or(UNIX_EPOCH)))
        })
        .collect();
    files.sort_by(|a, b| (b.2, &b.0).cmp(&(a.2, &a.0)));
    files
}

/// Returns the files with settings, the newest first.
pub(crate) fn list(shared: &Shared) -> Vec<KeptBackup> {
    let Ok(folder) = folder(shared) else {
        return Vec::new();
    };
    let readable = files(folder).into_iter().filter_map(|(file, path, time)| {
        let backup = settings::read(&path).ok()?;
        Some(KeptBackup {
            before: file.contains(".before-"),
            file,
            settings: backup.readings().len(),
            drive: backup.header.station,
            model: backup.header.model,
            time: time.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64(),
        })
    });
    readable.take(LISTED).collect()
}

/// Returns where a file is that is in the folder. A name is compared with those there and is never a part of a path.
pub(crate) fn path(shared: &Shared, name: &str) -> Result<PathBuf, Problem> {
    let found = files(folder(shared)?).into_iter().find(|(file, ..)| file == name);
    found.map(|(_, path, _)| path).ok_or_else(|| {
        let detail = "there is no such file; /api/v1/backups lists those that are kept";
        Problem::new(StatusCode::NOT_FOUND, "file", detail)
    })
}

/// Reads a file.
pub(crate) fn read(shared: &Shared, name: &str) -> Result<Backup, Problem> {
    settings::read(&path(shared, name)?).map_err(|error| Problem::of(&error))
}

/// Writes a new file for these settings and returns its name, which this server makes of the drive and the time.
pub(crate) fn keep(shared: &Shared, backup: &Backup, label: &str) -> Result<String, Problem> {
    let folder = folder(shared)?;
    settings::make_folder(folder).map_err(|error| Problem::of(&error))?;
    if folder.read_dir().is_ok_and(|all| all.count() >= FILES) {
        let detail = format!("there are {FILES} files in {}: remove old ones", folder.display());
        return Err(Problem::new(StatusCode::INSUFFICIENT_STORAGE, "local", &detail));
    }
    let plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '-';
    let label: String = label
        .chars()
        .take(80)
        .map(|letter| if plain(letter) { letter } else { '-' })
        .collect();
    let time = DateTime::<Utc>::from(SystemTime::now()).format("%Y%m%dT%H%M%S%.3fZ");
    let mut name = format!("{label}-{time}.backup");
    // two in one millisecond
    while folder.join(&name).exists() {
        name.insert(0, 'x');
    }
    let file = BackupFile::at(&folder.join(&name), false).map_err(|error| Problem::of(&error))?;
    file.write(backup).map_err(|error| Problem::of(&error))?;
    Ok(name)
}
