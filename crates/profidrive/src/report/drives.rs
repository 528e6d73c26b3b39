//! What a verb reports that worked on many drives.

use serde::Serialize;

use super::Error;

/// The same report of each of many drives.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "DrivesWith{R}")
)]
pub struct Drives<R> {
    /// Each drive with its report, its error, or both.
    pub drives: Vec<OfDrive<R>>,
    /// Stations that were selected by a pattern, a model, a vendor or `all`, and are no drives.
    pub left_out: Vec<String>,
}

/// The report of one of many drives.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "DriveWith{R}")
)]
pub struct OfDrive<R> {
    /// The drive, or the part of the selection that found none.
    pub drive: String,
    /// What the verb reports for it alone; null where the drive could not be worked with.
    pub report: Option<R>,
    /// What went wrong with it.
    pub error: Option<Error>,
}
