//! Restoring settings of a drive: what speaks against it, and the file with the values before.

use std::path::{Path, PathBuf};

use client::backup::Backup;
use client::change::{ChangeSet, Step};
use client::{Drive, Error, ErrorKind, Session, describe};
use network::files::StateFile;

/// Most ways back beside one file.
const MOST_WAYS_BACK: u32 = 9_999;

/// What speaks against restoring settings.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RestoreError {
    /// The settings are of another kind of drive: names and numbers can mean something else there.
    #[error("{0}")]
    Misfit(String),
    /// A controller is connected. It can switch the axis on while values change.
    #[error("nothing is written to {drive}: controller \"{controller}\" is running it")]
    Controlled {
        /// The drive.
        drive: String,
        /// Name of the controller.
        controller: String,
    },
    /// Whether a controller is connected cannot be read.
    #[error(transparent)]
    Client(#[from] Error),
}

impl RestoreError {
    /// The kind of the error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Misfit(_) | Self::Controlled { .. } => ErrorKind::Safety,
            Self::Client(error) => error.kind(),
        }
    }
}

/// Checks that settings are of this kind of drive.
///
/// # Errors
/// [`RestoreError::Misfit`]
pub fn check_fit(wanted: &Backup, drive: &Drive) -> Result<(), RestoreError> {
    wanted
        .header
        .misfit(drive)
        .map_or(Ok(()), |misfit| Err(RestoreError::Misfit(misfit)))
}

/// Checks that no controller is connected, which could switch the axis on while values change.
///
/// # Errors
/// [`RestoreError::Controlled`], and when the drive cannot be reached.
pub async fn check_no_controller(session: &mut Session, drive: &Drive) -> Result<(), RestoreError> {
    match session.owner(drive).await? {
        Some(Some(controller)) => Err(RestoreError::Controlled {
            drive: describe(&drive.station),
            controller,
        }),
        _ => Ok(()),
    }
}

/// Returns a path beside the file of a backup for the values before: `FILE.before-1`, `-2`, .., the first that does not
/// exist; `None` when there are 9999.
#[must_use]
pub fn way_back(file: &Path) -> Option<PathBuf> {
    let beside = |number: u32| {
        let mut name = file.file_name().unwrap_or_default().to_owned();
        name.push(format!(".before-{number}"));
        file.with_file_name(name)
    };
    let mut paths = (1..=MOST_WAYS_BACK).map(beside);
    paths.find(|path| !path.exists())
}

/// Writes what a set plans and keeps the values before in the file `way_back`, a backup that is complete before and after each
/// step. `progress` receives the number of changes that are written.
///
/// # Errors
/// As [`Session::apply_kept`].
pub async fn apply_with_way_back(
    session: &mut Session,
    drive: &mut Drive,
    set: &mut ChangeSet,
    way_back: &Path,
    mut progress: impl FnMut(usize) + Send,
) -> Result<(), Error> {
    let file = StateFile::document(way_back);
    let mut keep = |set: &ChangeSet| {
        progress(set.count(|step| !matches!(step, Step::NotWritten | Step::InDoubt)));
        if set.total() == 0 {
            // nothing changes, so there is no way back
            return Ok(());
        }
        file.replace(set.to_string().as_bytes()).map_err(Into::into)
    };
    session.apply_kept(drive, set, &mut keep).await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_back_is_never_over_a_file() {
        let file = Path::new("/nowhere/akd-1.txt");
        assert_eq!(way_back(file), Some(PathBuf::from("/nowhere/akd-1.txt.before-1")));
        let folder = std::env::temp_dir().join(format!("way-back-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("akd-1.txt");
        for number in [1, 2, 4] {
            std::fs::write(folder.join(format!("akd-1.txt.before-{number}")), "").unwrap();
        }
        assert_eq!(way_back(&file), Some(folder.join("akd-1.txt.before-3")));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
