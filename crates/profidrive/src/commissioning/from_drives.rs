//! The machine file of the drives that are there, with a backup of each beside it.

use std::path::{Path, PathBuf};

use client::backup::Backup;
use client::{Drive, ErrorKind, Session};
use network::files::StateFile;

use super::error::CommissionError;
use crate::fleet::{self, Member, Selected};
use crate::listed::listed;
use crate::machine::{Kept, Machine, MachineError};
use crate::remark::Remark;
use crate::settings::{self, BackupFile, FileError};
use crate::{Part, Step, Sum};

/// A machine file that may be written.
///
/// Of a file that is replaced the title, groups, limits of speed, MAC addresses and units of the load are kept: a drive does not have
/// them.
#[derive(Debug)]
pub struct MachineFile {
    path: PathBuf,
    force: bool,
    old: Option<Machine>,
    kept: Kept,
}

/// What became of the machine file of the drives that are there.
#[derive(Debug)]
pub struct FromDrives {
    /// The drives with the settings that were read. Each backup is in its file, whatever became of the others.
    pub drives: Vec<Member<Result<Backup, CommissionError>>>,
    /// How many drives the machine file has; why it was not written, where it was not. The old one is then as it was.
    pub written: Result<usize, CommissionError>,
    /// What the new file does not have of the old one.
    pub remarks: Vec<Remark>,
}

impl MachineFile {
    /// Checks that a machine file may be written there: it replaces another one only with `force`.
    ///
    /// # Errors
    /// [`CommissionError::Exists`]; a folder that does not exist. [`CommissionError::Machine`] when what is there is not a valid machine file: its limits could not be
    /// kept.
    pub fn at(path: &Path, force: bool) -> Result<Self, CommissionError> {
        let exists = std::fs::symlink_metadata(path).is_ok();
        if exists && !force {
            return Err(CommissionError::Exists(path.to_owned()));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
            return Err(FileError::NoFolder(folder.to_owned()).into());
        }
        let is_empty = std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() == 0);
        let (old, kept) = if exists && !is_empty {
            let (machine, kept) = Kept::read(path)?;
            (Some(machine), kept)
        } else {
            (None, Kept::default())
        };
        Ok(Self {
            path: path.to_owned(),
            force,
            old,
            kept,
        })
    }

    /// Returns the file of the backup of a drive, which is beside the machine file.
    #[must_use]
    pub fn backup_of(&self, drive: &Drive) -> PathBuf {
        settings::file_in(self.path.parent().unwrap_or(Path::new("")), drive)
    }

    /// Returns the names of the drives of the old file that are not among those that were read.
    fn not_read(&self, drives: &[(&Drive, &Backup)]) -> Vec<&str> {
        let is_read = |name: &str, mac| {
            drives
                .iter()
                .any(|(drive, _)| drive.station.name == name || mac == Some(drive.station.mac))
        };
        let old = self.old.iter().flat_map(|old| &old.drives);
        old.filter(|old| !is_read(&old.name, old.mac))
            .map(|old| old.name.as_str())
            .collect()
    }

    /// Writes the file from the drives that were read.
    fn write(&self, drives: &[(&Drive, &Backup)]) -> Result<usize, CommissionError> {
        let missing = self.not_read(drives);
        if !missing.is_empty() {
            return Err(CommissionError::NotRead {
                path: self.path.clone(),
                drives: listed(&missing),
            });
        }
        if drives.is_empty() {
            return Err(CommissionError::NothingRead(self.path.clone()));
        }
        let text = Machine::text_of(drives.iter().copied(), &self.kept);
        // a file that cannot be read must not take the place of one that can
        text.parse::<Machine>().map_err(|problem| MachineError::Invalid {
            path: self.path.clone(),
            problem,
        })?;
        let file = StateFile::document(&self.path);
        file.replace(text.as_bytes()).map_err(FileError::from)?;
        Ok(drives.len())
    }

    /// Returns what a new file leaves out of the old one, which its backups have instead.
    fn remarks(&self) -> Vec<Remark> {
        let old = self.old.iter().flat_map(|old| &old.drives);
        let with_parameters = old.filter(|old| !old.parameters.is_empty());
        let names: Vec<&str> = with_parameters.map(|old| old.name.as_str()).collect();
        if names.is_empty() {
            return Vec::new();
        }
        let sentence = format!(
            "parameters and comments of the old file are not in the new one ({}): the backups have the values of the drives",
            listed(&names)
        );
        vec![Remark::warning(sentence)]
    }
}

/// Reads the settings of drives, writes a backup of each beside the machine file, and then the machine file. `progress` receives
/// how much is read.
///
/// The machine file is not written when the caller requested a stop, nor where a drive of the file that is there was not read.
pub async fn from_drives(
    session: &Session,
    members: Vec<Selected>,
    file: &MachineFile,
    progress: impl Fn(Step) + Sync,
) -> FromDrives {
    let sum = Sum::new(Part::Drives, members.len(), progress);
    let drives = fleet::each(session, members, async |session, drive| {
        let name = drive.label();
        read(session, drive, file, &|done, all| sum.report(&name, done, all)).await
    })
    .await;
    let interrupted = drives
        .iter()
        .any(|member| matches!(&member.result, Err(error) if error.kind() == ErrorKind::Interrupted));
    let read: Vec<(&Drive, &Backup)> = drives
        .iter()
        .filter_map(|member| member.drive.as_ref().zip(member.result.as_ref().ok()))
        .collect();
    let written = if interrupted {
        Err(CommissionError::Interrupted(file.path.clone()))
    } else {
        file.write(&read)
    };
    let remarks = match written {
        Ok(_) => file.remarks(),
        Err(_) => Vec::new(),
    };
    FromDrives {
        drives,
        written,
        remarks,
    }
}

/// Reads the settings of a drive and writes its backup.
async fn read(
    session: &mut Session,
    drive: &mut Drive,
    file: &MachineFile,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Backup, CommissionError> {
    let not_named = |why| CommissionError::NotInFile {
        drive: drive.label(),
        why,
    };
    if drive.station.name.is_empty() {
        return Err(not_named("it has no name"));
    }
    if drive.model.catalogue.is_none() {
        return Err(not_named("its model has no built-in catalogue"));
    }
    let place = BackupFile::at(&file.backup_of(drive), file.force)?;
    let read = settings::backup(session, drive, progress).await?;
    // refuses settings without content
    place.write(&read.report)?;
    Ok(read.report)
}
