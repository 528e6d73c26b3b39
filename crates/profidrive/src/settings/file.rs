//! Files of settings.

use std::path::{Path, PathBuf};

use client::backup::{Backup, BackupError};
use client::{Drive, ErrorKind};
use network::files::{StateFile, StateFileError};

use super::outcome;
use crate::Outcome;

/// How every backup begins.
const HEAD: &[u8] = b"profidrive backup ";

/// Why a file of settings cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// There is none.
    #[error("{}: there is no such file", .0.display())]
    Missing(PathBuf),
    /// The system refuses it.
    #[error(transparent)]
    File(#[from] StateFileError),
    /// Its content is not a backup, or not a whole one.
    #[error("{}: {error}", .path.display())]
    Wrong {
        /// The file.
        path: PathBuf,
        /// What is wrong, line by line.
        error: BackupError,
    },
    /// A folder has this name.
    #[error("{} is a folder", .0.display())]
    Folder(PathBuf),
    /// A device or a socket has this name.
    #[error("{} is not a file that can be replaced", .0.display())]
    NotReplaceable(PathBuf),
    /// The folder of the file does not exist.
    #[error("there is no folder {}", .0.display())]
    NoFolder(PathBuf),
    /// A folder cannot be made.
    #[error("the folder {} cannot be made: {error}", .folder.display())]
    NotMade {
        /// The folder.
        folder: PathBuf,
        /// Why not.
        error: std::io::Error,
    },
    /// The backup has no values: a file of it would look like settings that are saved.
    #[error("nothing is written to {}: the backup has no settings", .0.display())]
    NoSettings(PathBuf),
    /// The file holds something else.
    #[error("{} is not a backup and is not replaced", .0.display())]
    OtherContent(PathBuf),
}

impl FileError {
    /// The kind of the error.
    #[must_use]
    pub const fn kind(&self) -> ErrorKind {
        match self {
            Self::Folder(_) | Self::NotReplaceable(_) | Self::NoFolder(_) => ErrorKind::Usage,
            _ => ErrorKind::Local,
        }
    }
}

/// Reads a file of settings: a backup, or the values before a restore.
///
/// # Errors
/// When there is no such file, it cannot be read, or its content is not a whole backup.
pub fn read(path: &Path) -> Result<Backup, FileError> {
    let content = StateFile::document(path)
        .read()?
        .ok_or_else(|| FileError::Missing(path.to_owned()))?;
    Backup::read(content).map_err(|error| FileError::Wrong {
        path: path.to_owned(),
        error,
    })
}

/// Makes a folder for the backups of many drives where there is none.
///
/// # Errors
/// When it cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(folder).map_err(|error| FileError::NotMade {
        folder: folder.to_owned(),
        error,
    })
}

/// Returns the file of a drive in a folder of backups: its name and `.backup`.
#[must_use]
pub fn file_in(folder: &Path, drive: &Drive) -> PathBuf {
    // an Ethernet address has colons, which not every file system takes
    folder.join(format!("{}.backup", drive.label().replace(':', "-")))
}

/// Returns the backups in a folder that are of none of these drives, sorted by name.
#[must_use]
pub fn without_drive(folder: &Path, drives: &[&str]) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let paths = files.map(|file| file.path()).filter(|path| {
        let is_backup = path.extension().is_some_and(|extension| extension == "backup");
        let stem = path.file_stem().unwrap_or_default();
        is_backup
            && !drives
                .iter()
                .any(|drive| stem == drive.replace(':', "-").as_str())
    });
    let mut paths: Vec<PathBuf> = paths.collect();
    paths.sort();
    paths
}

/// A file that a backup may be written to.
///
/// ```
/// use profidrive::settings::{BackupFile, FileError};
///
/// // nothing is read from a drive for a file that cannot be written
/// let folder = std::env::temp_dir();
/// assert!(matches!(BackupFile::at(&folder, false), Err(FileError::Folder(_))));
/// ```
#[derive(Debug)]
pub struct BackupFile {
    path: PathBuf,
    old: Option<Vec<u8>>,
}

impl BackupFile {
    /// Checks that a backup may be written there: a backup is replaced, an empty file too, any other file only with `force`.
    ///
    /// # Errors
    /// When it may not, and when it cannot be.
    pub fn at(path: &Path, force: bool) -> Result<Self, FileError> {
        if path.is_dir() {
            return Err(FileError::Folder(path.to_owned()));
        }
        if path.exists() && !path.is_file() {
            return Err(FileError::NotReplaceable(path.to_owned()));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
            return Err(FileError::NoFolder(folder.to_owned()));
        }
        let old = match StateFile::document(path).read() {
            Err(_) if force => None,
            old => old?,
        };
        let replaceable = |old: &Vec<u8>| old.is_empty() || old.starts_with(HEAD);
        if force || old.as_ref().is_none_or(replaceable) {
            let path = path.to_owned();
            Ok(Self { path, old })
        } else {
            Err(FileError::OtherContent(path.to_owned()))
        }
    }

    /// Writes a backup; the file is whole at every moment. Returns false where its content is that already.
    ///
    /// # Errors
    /// [`FileError::NoSettings`], and when the file cannot be written; the old content is then still there.
    pub fn write(&self, backup: &Backup) -> Result<bool, FileError> {
        if outcome(backup) == Outcome::Difference {
            return Err(FileError::NoSettings(self.path.clone()));
        }
        let text = backup.to_string();
        if self.old.as_deref() == Some(text.as_bytes()) {
            return Ok(false);
        }
        StateFile::document(&self.path).replace(text.as_bytes())?;
        Ok(true)
    }

    /// Whether there is content that a new one replaces.
    #[must_use]
    pub fn has_content(&self) -> bool {
        self.old.as_ref().is_some_and(|old| !old.is_empty())
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
                let error = BackupFile::at(Path::new(path), force).unwrap_err();
                assert_eq!(error.kind(), ErrorKind::Usage);
                assert!(error.to_string().contains(words), "{error}");
            }
        }
        assert!(BackupFile::at(Path::new("no-such.backup"), false).is_ok());
    }

    #[test]
    fn a_backup_without_its_drive_is_found() {
        let folder = std::env::temp_dir().join(format!("profidrive-without-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for name in [
            "akd-1.backup",
            "02-00-00-00-00-01.backup",
            "gone.backup",
            "note.txt",
        ] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        let found = without_drive(&folder, &["akd-1", "02:00:00:00:00:01"]);
        assert_eq!(found, [folder.join("gone.backup")]);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
