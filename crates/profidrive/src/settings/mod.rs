//! Settings of a drive: saved in a file, compared, and restored with a way back.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use profidrive::Wait;
//! use profidrive::settings::{self, Restore};
//!
//! let plant = r#"
//!     [[drive]]
//!     name = "akd-1"
//!     ip = "192.168.0.11/24"
//! "#;
//! let mut network = profidrive::open_plan(plant.parse()?)?;
//! let mut drive = network.find(&"akd-1".parse()?).wait()?;
//! let saved = settings::backup(&mut network, &mut drive, |_, _| {}).wait()?;
//! assert_eq!(saved.outcome, profidrive::Outcome::Complete);
//!
//! // nothing has changed since, so there is nothing to write
//! let wanted = Restore::default();
//! let plan = settings::plan(&mut network, &mut drive, &saved.report, &wanted).wait()?;
//! assert_eq!((plan.set.total(), settings::shortfall(&plan, &drive, &wanted)), (0, None));
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod backup;
mod comparison;
mod file;
mod lasting;
mod shortfall;

use std::fs::File;
use std::path::{Path, PathBuf};

use client::backup::Backup;
use client::change::{ChangeSet, Choice, Plan, Step};
use client::{Drive, Error, ErrorKind, Session, describe};
use network::files::StateFile;

pub use backup::{Missing, MissingSettings, backup, missing, outcome};
pub use comparison::{CompareError, Comparison, as_delivered, as_in};
pub use file::{BackupFile, FileError, file_in, make_folder, read, without_drive};
pub use lasting::{in_lines, lasting};
pub use shortfall::{Shortfall, shortfall};

/// Most ways back beside one file.
const MOST_WAYS_BACK: u32 = 9_999;

/// How settings are restored.
#[derive(Debug, Clone, Default)]
pub struct Restore {
    /// Which settings of the file.
    pub choice: Choice,
    /// The drive saves them over power-off; only where every value is as planned.
    pub save: bool,
    /// Also to another kind of drive, and while a controller is connected.
    pub force: bool,
    /// Nothing is to be written: a connected controller is no obstacle.
    pub dry_run: bool,
}

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
    /// The file for the values before exists, or cannot be created.
    #[error("nothing is written: the values before cannot be kept in {}: {source}", path.display())]
    WayBack {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Nothing of the file fits the choice.
    #[error("nothing in the file fits what was chosen")]
    Nothing,
    /// The drive cannot be reached, or refuses.
    #[error(transparent)]
    Client(#[from] Error),
}

impl RestoreError {
    /// The kind of the error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Misfit(_) | Self::Controlled { .. } => ErrorKind::Safety,
            Self::Nothing => ErrorKind::Usage,
            Self::WayBack { .. } => ErrorKind::Local,
            Self::Client(error) => error.kind(),
        }
    }
}

/// Checks that settings are of this kind of drive.
fn check_fit(wanted: &Backup, drive: &Drive) -> Result<(), RestoreError> {
    wanted
        .header
        .misfit(drive)
        .map_or(Ok(()), |misfit| Err(RestoreError::Misfit(misfit)))
}

/// Checks that no controller is connected, which could switch the axis on while values change.
async fn check_no_controller(session: &mut Session, drive: &Drive) -> Result<(), RestoreError> {
    match session.owner(drive).await? {
        Some(Some(controller)) => Err(RestoreError::Controlled {
            drive: describe(&drive.station),
            controller,
        }),
        _ => Ok(()),
    }
}

/// What restoring settings would write and leave out. Reads only.
///
/// # Errors
/// When the settings are of another kind of drive or a controller is connected, unless forced; when nothing fits the choice;
/// when the drive cannot be reached.
pub async fn plan(
    session: &mut Session,
    drive: &mut Drive,
    settings: &Backup,
    wanted: &Restore,
) -> Result<Plan, RestoreError> {
    plan_with(session, drive, settings, wanted, |_, _| {}).await
}

/// The same; `progress` receives how many settings and motion tasks are read, and how many there are.
///
/// # Errors
/// As [`plan`].
pub async fn plan_with(
    session: &mut Session,
    drive: &mut Drive,
    settings: &Backup,
    wanted: &Restore,
    mut progress: impl FnMut(usize, usize) + Send,
) -> Result<Plan, RestoreError> {
    if !wanted.force {
        check_fit(settings, drive)?;
        if !wanted.dry_run {
            check_no_controller(session, drive).await?;
        }
    }
    let mut plan = session
        .plan_reporting(drive, settings, &wanted.choice, &mut progress)
        .await?;
    if wanted.save {
        plan.set.save(drive)?;
    }
    if plan.is_nothing() {
        return Err(RestoreError::Nothing);
    }
    Ok(plan)
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

/// Writes what a plan of these settings says and keeps the values before in the new file `way_back`, a backup that is complete
/// before and after each step. `progress` receives the number of changes that are written.
///
/// # Errors
/// What speaks against it is checked again, also for a plan of a dry run: since the plan was made a controller may have
/// connected. [`RestoreError::WayBack`] where the file exists or cannot be created. Nothing is written then. Else as
/// [`Session::apply_kept`].
pub async fn carry_out(
    session: &mut Session,
    drive: &mut Drive,
    settings: &Backup,
    wanted: &Restore,
    plan: &mut Plan,
    way_back: &Path,
    mut progress: impl FnMut(usize) + Send,
) -> Result<(), RestoreError> {
    if !wanted.force {
        check_fit(settings, drive)?;
        check_no_controller(session, drive).await?;
    }
    if plan.set.total() == 0 {
        // nothing changes, so there is no way back
        return Ok(session.apply_kept(drive, &mut plan.set, &mut |_| Ok(())).await?);
    }
    File::create_new(way_back).map_err(|source| RestoreError::WayBack {
        path: way_back.to_owned(),
        source,
    })?;
    let file = StateFile::document(way_back);
    let mut keep = |set: &ChangeSet| {
        progress(set.count(|step| !matches!(step, Step::NotWritten | Step::InDoubt)));
        file.replace(set.to_string().as_bytes()).map_err(Into::into)
    };
    let result = session.apply_kept(drive, &mut plan.set, &mut keep).await;
    // it failed before anything was kept, so before anything was written
    if std::fs::metadata(way_back).is_ok_and(|file| file.len() == 0) {
        let _ = file.remove();
    }
    Ok(result?)
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
