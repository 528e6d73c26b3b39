//! Files about a whole machine: an archive for support ([`bundle`]), with the last traffic where that was kept ([`traffic`]), and a
//! page for its documentation ([`page`]). Both read the drives and change nothing. A drive that does not answer is noted in the file and is not the end of it.

pub mod bundle;
pub mod page;
mod portrait;
pub mod traffic;

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use client::{Advice, ErrorKind};
use network::files::{StateFile, StateFileError};

use crate::explained::Explained;

pub use portrait::{DrivePortrait, Portrait, portrait};

/// Why a file about a machine cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// There is something of this name.
    #[error("{} exists already", .0.display())]
    Exists(PathBuf),
    /// The folder of the file does not exist.
    #[error("there is no folder {}", .0.display())]
    NoFolder(PathBuf),
    /// A file to add cannot be read.
    #[error("cannot read {}: {source}", .path.display())]
    NotRead {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// The files to add are larger than what an archive takes.
    #[error("{} is too large: the files to add have {limit} octets at most in all", .path.display())]
    TooLarge {
        /// The file that is too much.
        path: PathBuf,
        /// Octets at most.
        limit: u64,
    },
    /// The system refuses the file.
    #[error(transparent)]
    File(#[from] StateFileError),
    /// The drives could not be read at all.
    #[error(transparent)]
    Client(#[from] client::Error),
    /// The content cannot be made.
    #[error("the content cannot be made: {0}")]
    Content(Box<dyn std::error::Error + Send + Sync>),
}

impl Explained for DocumentError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoFolder(_) | Self::TooLarge { .. } => ErrorKind::Usage,
            Self::Exists(_) | Self::NotRead { .. } | Self::File(_) => ErrorKind::Local,
            Self::Client(error) => error.kind(),
            Self::Content(_) => ErrorKind::Internal,
        }
    }

    fn passed_on(&self) -> Option<&dyn Explained> {
        match self {
            Self::Client(error) => Some(error),
            _ => None,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Exists(_) => "choose another name: nothing is replaced".into(),
            other => other.passed_on().map_or_else(Advice::default, Explained::advice),
        }
    }
}

/// A file that is not there yet: nothing is replaced, and it is whole as soon as it is there.
///
/// ```
/// use profidrive::documents::{DocumentError, NewFile};
/// let error = NewFile::at(&std::env::temp_dir()).unwrap_err();
/// assert!(matches!(error, DocumentError::Exists(_)));
/// ```
#[derive(Debug, Clone)]
pub struct NewFile {
    path: PathBuf,
}

impl NewFile {
    /// Checks the place before anything is read for it.
    ///
    /// # Errors
    /// [`DocumentError::Exists`] or [`DocumentError::NoFolder`].
    pub fn at(path: &Path) -> Result<Self, DocumentError> {
        if std::fs::symlink_metadata(path).is_ok() {
            return Err(DocumentError::Exists(path.to_owned()));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
            return Err(DocumentError::NoFolder(folder.to_owned()));
        }
        Ok(Self {
            path: path.to_owned(),
        })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// When something of its name is there by now, or the disk refuses. Then nothing is left behind.
    pub fn write(&self, content: &[u8]) -> Result<(), DocumentError> {
        StateFile::document(&self.path)
            .create(content)
            .map_err(|error| match error.source.kind() {
                std::io::ErrorKind::AlreadyExists => DocumentError::Exists(self.path.clone()),
                _ => error.into(),
            })
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// `2026-11-24 13:05:07 UTC`
fn time_text(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
    let seconds = i64::try_from(seconds).unwrap_or_default();
    let time = chrono::DateTime::from_timestamp(seconds, 0).unwrap_or_default();
    time.format("%Y-%m-%d %H:%M:%S UTC").to_string()
}
