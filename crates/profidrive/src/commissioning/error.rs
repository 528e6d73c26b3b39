//! Why a drive of a machine file is not as the file says.

use std::path::PathBuf;

use client::change::Skip;
use client::{DriveAddress, Error, ErrorKind};
use profinet::MacAddress;

use crate::DriveError;
use crate::addressing::AddressingError;
use crate::machine::MachineError;
use crate::settings::{FileError, RestoreError};

/// What speaks against commissioning a drive or against writing the file of drives, or went wrong with it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CommissionError {
    /// No station has the name or the MAC address of the drive.
    #[error("{drive}{} does not answer{}", at(*.line), by(.mac.as_ref()))]
    NotFound {
        /// Name of the drive.
        drive: String,
        /// Line of the machine file; 0 where there is none, only a backup.
        line: usize,
        /// The MAC address that was searched, too.
        mac: Option<MacAddress>,
    },
    /// Another station than the one with this MAC address has the name.
    #[error("{drive}{}: the station with this name has the MAC address {found}, not {mac}", at(*.line))]
    OtherStation {
        /// Name of the drive.
        drive: String,
        /// Line of the machine file; 0 where there is none, only a backup.
        line: usize,
        /// The MAC address in the file.
        mac: MacAddress,
        /// That of the station.
        found: MacAddress,
    },
    /// The drive is of another model.
    #[error("{drive}{}: {} {wanted}, the drive is {found}", at(*.line), source(*.line))]
    OtherModel {
        /// Name of the drive.
        drive: String,
        /// Line of the machine file; 0 where there is none, only a backup.
        line: usize,
        /// Model of the file.
        wanted: &'static str,
        /// What the station is.
        found: String,
    },
    /// A setting of the file is not valid for this drive.
    #[error("{drive}{}: {problem}", at(*.line))]
    Setting {
        /// Name of the drive.
        drive: String,
        /// Line of the machine file; 0 where there is none, only a backup.
        line: usize,
        /// What is wrong.
        problem: Box<Error>,
    },
    /// The drive cannot have a setting of the file or of the backup.
    #[error("{drive}{}: {parameter} cannot be set: {why}", at(*.line))]
    LeftOut {
        /// Name of the drive.
        drive: String,
        /// Line of the machine file; 0 where there is none, only a backup.
        line: usize,
        /// The parameter.
        parameter: String,
        /// Why.
        why: Box<Skip>,
    },
    /// The name, the address or the backup that the file has for a drive.
    #[error("{problem}{}", at(*.line))]
    Entry {
        /// Line of the drive in the machine file; 0 where there is none, only a backup.
        line: usize,
        /// What is wrong with it.
        problem: Box<CommissionError>,
    },
    /// The motion tasks of the backup cannot be set.
    #[error("{drive}: the motion tasks are left out: {why}")]
    TasksLeftOut {
        /// Name of the drive.
        drive: String,
        /// Why.
        why: String,
    },
    /// After everything was written the drive is not as the file says.
    #[error("{drive} is not as the file says: {count} settings differ after they were written")]
    Differs {
        /// Name of the drive.
        drive: String,
        /// How many settings.
        count: usize,
    },
    /// The drive refused values, or to save them.
    #[error("{first}{}", and_others(*.others))]
    Refused {
        /// The first refusal.
        first: Box<Error>,
        /// How many more there are.
        others: usize,
    },
    /// The machine was read from a text: there is no folder for the values before.
    #[error("the machine is not a file: there is no folder for the values before")]
    NoFolder,
    /// The note that a run has begun cannot be written or removed.
    #[error("{}: {source}", path.display())]
    Note {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A machine file is there and is not to be replaced.
    #[error("{} exists already", .0.display())]
    Exists(PathBuf),
    /// A drive that is there cannot be in a machine file.
    #[error("{drive} cannot be in a machine file: {why}")]
    NotInFile {
        /// The drive.
        drive: String,
        /// Why.
        why: &'static str,
    },
    /// A new machine file would lose drives of the one that is there.
    #[error("{} is not replaced: it has drives that were not read: {drives}", path.display())]
    NotRead {
        /// The machine file.
        path: PathBuf,
        /// The drives.
        drives: String,
    },
    /// Nothing was read for a machine file.
    #[error("{} is not written: no drive was read", .0.display())]
    NothingRead(PathBuf),
    /// The caller requested a stop before all drives were read.
    #[error("{} is not written: interrupted", .0.display())]
    Interrupted(PathBuf),
    /// The machine file that is there is not valid, or the new one would not be.
    #[error(transparent)]
    Machine(#[from] MachineError),
    /// The drive cannot be worked with.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// The name or the address cannot be given.
    #[error(transparent)]
    Addressing(#[from] AddressingError),
    /// The settings cannot be written.
    #[error(transparent)]
    Restore(#[from] RestoreError),
    /// The backup cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The drive cannot be reached, or refuses.
    #[error(transparent)]
    Client(#[from] Error),
}

/// ` (line 4)`, for a drive of a machine file.
fn at(line: usize) -> String {
    match line {
        0 => String::new(),
        line => format!(" (line {line})"),
    }
}

fn and_others(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => "; one more value was refused".to_owned(),
        count => format!("; {count} more values were refused"),
    }
}

const fn source(line: usize) -> &'static str {
    if line == 0 {
        "the backup is of"
    } else {
        "the file says"
    }
}

fn by(mac: Option<&MacAddress>) -> String {
    mac.map_or_else(String::new, |mac| format!(", neither by its name nor as {mac}"))
}

impl CommissionError {
    /// Returns the error of what the machine file has for a drive, with its line.
    pub(super) fn at(line: usize) -> impl Fn(Self) -> Self {
        move |problem| Self::Entry {
            line,
            problem: Box::new(problem),
        }
    }

    /// The kind of the error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::NotFound { .. } => ErrorKind::Unreachable,
            Self::OtherStation { .. } | Self::OtherModel { .. } => ErrorKind::Safety,
            Self::Setting { problem, .. } => problem.kind(),
            Self::Entry { problem, .. } => problem.kind(),
            Self::LeftOut { .. } | Self::TasksLeftOut { .. } | Self::Differs { .. } => ErrorKind::Difference,
            Self::Refused { first, .. } => first.kind(),
            Self::NoFolder => ErrorKind::Usage,
            Self::NotInFile { .. } => ErrorKind::Unsupported,
            Self::NotRead { .. } | Self::NothingRead(_) => ErrorKind::Partial,
            Self::Interrupted(_) => ErrorKind::Interrupted,
            Self::Exists(_) | Self::Note { .. } => ErrorKind::Local,
            Self::Machine(error) => error.kind(),
            Self::Drive(error) => error.kind(),
            Self::Addressing(error) => error.kind(),
            Self::Restore(error) => error.kind(),
            Self::File(error) => error.kind(),
            Self::Client(error) => error.kind(),
        }
    }
}

/// Returns the error of a name that two stations have.
pub(super) fn ambiguous(name: &str, macs: Vec<MacAddress>) -> CommissionError {
    let drive = DriveAddress::Name(name.to_owned());
    CommissionError::Client(Error::Ambiguous { drive, macs })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive that takes the place of another one by a backup has no line in any file.
    #[test]
    fn only_a_drive_of_a_machine_file_has_a_line() {
        let error = |line| {
            let error = CommissionError::OtherModel {
                drive: "akd-1".into(),
                line,
                wanted: "AKD",
                found: "VLT".into(),
            };
            error.to_string()
        };
        assert_eq!(error(4), "akd-1 (line 4): the file says AKD, the drive is VLT");
        assert_eq!(error(0), "akd-1: the backup is of AKD, the drive is VLT");
    }
}
