//! What is in an archive for support.

use serde::Serialize;

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
    /// What could not be read, with the reason.
    pub missing: Vec<String>,
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
