//! What the verbs report about device descriptions.

use serde::Serialize;

/// Files that were written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlExportReport {
    /// The files.
    pub files: Vec<String>,
}

/// What is against the rules in a device description.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlCheckReport {
    /// The file.
    pub file: String,
    /// Whether nothing is against the rules.
    pub sound: bool,
    /// Whether the file can be used.
    pub usable: bool,
    /// What was found.
    pub problems: Vec<GsdmlProblem>,
    /// Problems that were found and are not listed.
    pub left_out: usize,
    /// What is wrong with the pictures beside the file.
    pub pictures: Vec<String>,
}

/// Something that is against the rules.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GsdmlProblem {
    /// `warning`, `error` or `unusable`.
    pub severity: &'static str,
    /// Name of the rule.
    pub rule: &'static str,
    /// Line in the file, from 1.
    pub line: u32,
    /// Column in the line, from 1.
    pub column: u32,
    /// What is wrong.
    pub message: String,
}
