//! What commissioning reports.

use serde::Serialize;

use super::{Error, IpReport, NameReport, RestoreReport, Wording};
use crate::Explained;
use crate::commissioning::{CommissionError, Planned};
use crate::machine::Machine;

/// The drives of a machine file, with what differs from it or was done.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CommissionReport {
    /// The machine file.
    pub file: String,
    /// Whether nothing was changed.
    pub dry_run: bool,
    /// The drives, in the order of the file.
    pub drives: Vec<CommissionedDrive>,
}

/// A drive of a machine file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CommissionedDrive {
    /// Name of the drive.
    pub drive: String,
    /// Line of the machine file; 0 where there is none, only a backup.
    pub line: usize,
    /// Name of its model.
    pub model: &'static str,
    /// Its Ethernet address; null where it was not found.
    pub mac: Option<String>,
    /// Its new name; null where it had the name.
    pub name: Option<NameReport>,
    /// Its new address; null where it had the address.
    pub ip: Option<IpReport>,
    /// Its settings; null where the file has none, or they can be read with the new address only.
    pub settings: Option<RestoreReport>,
    /// Whether the settings can be read with the new address only.
    pub settings_later: bool,
    /// Whether a run before this one did not end.
    pub unfinished: bool,
    /// Whether anything differs from the file, or did before.
    pub differs: bool,
    /// Whether everything was read back and is as the file says.
    pub verified: bool,
    /// What speaks against it, or went wrong.
    pub errors: Vec<Error>,
}

impl CommissionReport {
    /// Returns how far a plan is.
    #[must_use]
    pub fn new(machine: &Machine, planned: &[Planned], dry_run: bool, wording: &dyn Wording) -> Self {
        let path = machine.path.as_deref();
        let file = path.map_or_else(String::new, |path| path.display().to_string());
        let drives = planned.iter();
        Self {
            drives: drives.map(|one| drive(one, &file, dry_run, wording)).collect(),
            file,
            dry_run,
        }
    }
}

fn drive(one: &Planned, file: &str, dry_run: bool, wording: &dyn Wording) -> CommissionedDrive {
    let way_back = one.way_back.as_deref().map(|path| path.display().to_string());
    let settings = one.drive.as_ref().zip(one.settings.as_ref());
    let settings = settings.map(|(drive, settings)| {
        RestoreReport::new(drive, &settings.plan, file.to_owned(), dry_run, way_back, wording)
    });
    let error = |error: &CommissionError| {
        Error::new(
            Explained::kind(error),
            &error.message(),
            &error.details(),
            &error.advice(),
            wording,
        )
    };
    CommissionedDrive {
        drive: one.wanted.name.clone(),
        line: one.wanted.line,
        model: one.wanted.model.name,
        mac: one.drive.as_ref().map(|drive| drive.station.mac.to_string()),
        name: one.name.clone(),
        ip: one.ip.clone(),
        settings,
        settings_later: one.settings_later,
        unfinished: one.unfinished,
        differs: one.is_change(),
        verified: one.verified,
        errors: one.objections.iter().map(error).collect(),
    }
}
