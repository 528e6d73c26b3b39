//! The machine as a file: which drives it has, their addresses, groups, limits and settings.
//!
//! ```
//! use profidrive::machine::Machine;
//!
//! let machine: Machine = r#"
//!     [[drive]]
//!     name = "feed"
//!     model = "akd"
//!     ip = "192.168.77.11/24"
//!     groups = ["line1"]
//!     max-speed = "1500rpm"
//!     [drive.parameters]
//!     "DRV.ACC" = "5000rpm/s"
//! "#.parse()?;
//! assert_eq!(machine.group("line1")?, ["feed"]);
//! assert_eq!(machine.bound("feed").map(|bound| bound.rpm), Some(1500.0));
//!
//! let wrong = "[[drive]]\nname = \"feed\"\nmodel = \"akd\"\nmaxspeed = \"1500rpm\"".parse::<Machine>();
//! assert!(wrong.unwrap_err().to_string().starts_with("line 4: "));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod file;
mod kept;
mod user_unit;
mod write;

use std::io::{self, Read as _};
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};

use client::{BoundedDrive, ErrorKind};
use profile::model::Model;
use profile::value::Assignment;
use profinet::{IpSuite, MacAddress};

use crate::Selector;

pub use client::SpeedBound;
pub(crate) use kept::Kept;
pub use user_unit::UserUnit;

/// Octets of a machine file at most.
pub const LONGEST_FILE: usize = 1 << 20;
/// Drives of a machine at most.
pub const MOST_DRIVES: usize = 1000;

/// A machine as its file describes it.
#[derive(Debug, Clone, Default)]
pub struct Machine {
    /// The file; `None` for a text.
    pub path: Option<PathBuf>,
    /// What the machine is called.
    pub title: Option<String>,
    /// Its drives, in the order of the file.
    pub drives: Vec<MachineDrive>,
    limits: Vec<(String, SpeedBound)>,
}

/// A drive of a machine.
#[derive(Debug, Clone)]
pub struct MachineDrive {
    /// Name of the station.
    pub name: String,
    /// Line of the name, from 1; 0 where the drive is of a backup and no machine file.
    pub line: usize,
    /// Its model.
    pub model: Model,
    /// Ethernet address, by which the drive is found before it has its name.
    pub mac: Option<MacAddress>,
    /// Address, mask and gateway; `None` where the file does not set them.
    pub ip: Option<IpSuite>,
    /// The telegram, as in PNU 922.
    pub telegram: Option<u16>,
    /// The groups it belongs to.
    pub groups: Vec<String>,
    /// Highest speed of the drive itself; see [`Machine::bound`].
    pub max_speed: Option<SpeedBound>,
    /// The unit of its load; `None` where the file sets none.
    pub user_unit: Option<UserUnit>,
    /// The backup with its settings, below the folder of the file; see [`Machine::beside`].
    pub backup: Option<PathBuf>,
    /// Its settings, with their lines. They come before those of the backup.
    pub parameters: Vec<(usize, Assignment)>,
}

/// What is wrong in a machine file, and where.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct MachineProblem {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

/// Why a machine file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MachineError {
    /// It cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Something in it is not valid.
    #[error("{}, {problem}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What, and where.
        problem: MachineProblem,
    },
}

impl MachineError {
    /// The kind of the error.
    #[must_use]
    pub const fn kind(&self) -> ErrorKind {
        match self {
            Self::Read { .. } => ErrorKind::Local,
            Self::Invalid { .. } => ErrorKind::Usage,
        }
    }
}

/// A group that the machine file does not have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the machine file has no group `{name}`; there {}", there_are(.existing))]
pub struct UnknownGroup {
    /// The name.
    pub name: String,
    /// The groups that there are.
    pub existing: Vec<String>,
}

fn there_are(groups: &[String]) -> String {
    match groups {
        [] => "is none".to_owned(),
        groups => format!("are {}", groups.join(", ")),
    }
}

impl Machine {
    /// Reads a machine file.
    ///
    /// # Errors
    /// When it cannot be read, or something in it is not valid.
    pub fn read(path: &Path) -> Result<Self, MachineError> {
        Self::read_with_text(path).map(|(machine, _)| machine)
    }

    fn read_with_text(path: &Path) -> Result<(Self, String), MachineError> {
        let unreadable = |source| MachineError::Read {
            path: path.to_owned(),
            source,
        };
        let mut octets = Vec::new();
        let file = std::fs::File::open(path).map_err(unreadable)?;
        // one more than is allowed, so that a longer file is recognized
        let most = LONGEST_FILE as u64 + 1;
        file.take(most).read_to_end(&mut octets).map_err(unreadable)?;
        let text = String::from_utf8(octets)
            .map_err(|_| unreadable(io::Error::new(io::ErrorKind::InvalidData, "not a text in UTF-8")))?;
        let machine = text.parse::<Self>().map_err(|problem| MachineError::Invalid {
            path: path.to_owned(),
            problem,
        })?;
        let path = Some(path.to_owned());
        Ok((Self { path, ..machine }, text))
    }

    /// Returns the drive of this name.
    #[must_use]
    pub fn drive(&self, name: &str) -> Option<&MachineDrive> {
        self.drives.iter().find(|drive| drive.name == name)
    }

    /// Returns the names of all groups, sorted.
    #[must_use]
    pub fn groups(&self) -> Vec<String> {
        let mut groups: Vec<String> = self
            .drives
            .iter()
            .flat_map(|drive| drive.groups.clone())
            .collect();
        groups.sort_unstable();
        groups.dedup();
        groups
    }

    /// Returns the names of the drives of a group, in the order of the file.
    ///
    /// # Errors
    /// [`UnknownGroup`]
    pub fn group(&self, name: &str) -> Result<Vec<&str>, UnknownGroup> {
        let members = self
            .drives
            .iter()
            .filter(|drive| drive.groups.iter().any(|group| group == name));
        let members: Vec<&str> = members.map(|drive| drive.name.as_str()).collect();
        if members.is_empty() {
            return Err(UnknownGroup {
                name: name.to_owned(),
                existing: self.groups(),
            });
        }
        Ok(members)
    }

    /// Returns the lowest limit for the speed of a drive: its own and those of its groups. `None` where the file sets none.
    #[must_use]
    pub fn bound(&self, name: &str) -> Option<SpeedBound> {
        let drive = self.drive(name)?;
        let of_groups = self
            .limits
            .iter()
            .filter(|(group, _)| drive.groups.contains(group));
        let bounds = of_groups.map(|(_, bound)| *bound).chain(drive.max_speed);
        bounds.min_by(|a, b| a.rpm.total_cmp(&b.rpm))
    }

    /// Returns the limits for the speeds of its drives, as a network takes them: see
    /// [`Opening::on_machine`](crate::Opening::on_machine).
    #[must_use]
    pub fn bounds(&self) -> Vec<BoundedDrive> {
        let bounded = |drive: &MachineDrive| {
            Some(BoundedDrive {
                name: drive.name.clone(),
                mac: drive.mac,
                bound: self.bound(&drive.name)?,
            })
        };
        self.drives.iter().filter_map(bounded).collect()
    }

    /// Returns the unit of the load of a drive, by its name, MAC address or IP address.
    #[must_use]
    pub fn user_unit(&self, drive: &str) -> Option<&UserUnit> {
        let mac: Option<MacAddress> = drive.parse().ok();
        let ip: Option<Ipv4Addr> = drive.parse().ok();
        let means = |one: &&MachineDrive| {
            one.name == drive
                || mac.is_some() && one.mac == mac
                || ip.is_some() && one.ip.map(|suite| suite.address) == ip
        };
        self.drives.iter().find(means)?.user_unit.as_ref()
    }

    /// Returns the machine with the drives that a selector means; `None` where it means none of them.
    #[must_use]
    pub fn only(&self, selector: &Selector) -> Option<Self> {
        let mut machine = self.clone();
        machine.drives.retain(|drive| selector.means(drive));
        (!machine.drives.is_empty()).then_some(machine)
    }

    /// Returns a path of the file, which counts from the folder of the file.
    #[must_use]
    pub fn beside(&self, path: &Path) -> PathBuf {
        match self.path.as_deref().and_then(Path::parent) {
            Some(folder) => folder.join(path),
            None => path.to_owned(),
        }
    }
}
