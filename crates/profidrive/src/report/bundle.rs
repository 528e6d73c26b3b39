//! What is in an archive for support.

use serde::Serialize;

use crate::Outcome;

/// An archive for support that was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BundleReport {
    /// The file.
    pub file: String,
    /// Its size in octets.
    pub size: u64,
    /// Whether nothing is missing.
    pub complete: bool,
    /// The files in it.
    pub files: Vec<BundledFile>,
    /// The drives, with what could not be read of them.
    pub drives: Vec<BundledDrive>,
    /// What else is missing.
    pub notes: Vec<String>,
}

/// A file in an archive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BundledFile {
    /// Its name in the archive.
    pub name: String,
    /// What it is.
    pub meaning: &'static str,
    /// Its size in octets, not compressed.
    pub size: u64,
}

/// A drive in an archive or on a page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BundledDrive {
    /// The drive, or the part of the selection that found none.
    pub drive: String,
    /// Whether anything was read of it.
    pub read: bool,
    /// What could not be read, with the reason.
    pub missing: Vec<String>,
}

impl BundleReport {
    /// Returns how it ended: [`Outcome::NoAnswer`] where nothing was read of a drive, or of all. Parts that are missing of a drive
    /// that answered are in the report.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        outcome_of(&self.drives)
    }
}

impl PageReport {
    /// Returns how it ended, as [`BundleReport::outcome`] does.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        outcome_of(&self.drives)
    }
}

fn outcome_of(drives: &[BundledDrive]) -> Outcome {
    if !drives.is_empty() && drives.iter().all(|drive| drive.read) {
        Outcome::Complete
    } else {
        Outcome::NoAnswer
    }
}

/// A page about a machine that was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PageReport {
    /// The file.
    pub file: String,
    /// Its size in octets.
    pub size: u64,
    /// The drives, with what could not be read of them.
    pub drives: Vec<BundledDrive>,
}
