//! What is wrong with a file, and where.

use std::ops::Range;

use toml::Spanned;

/// What is wrong with a plant file, and where.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct PlantError {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

/// A message with its place in the file.
pub(crate) struct Located(pub Range<usize>, pub String);

/// Adds the location in the file to the message about a value.
pub(crate) fn located<T, U, E: ToString>(
    value: &Spanned<T>,
    read: impl FnOnce(&T) -> Result<U, E>,
) -> Result<U, Located> {
    read(value.get_ref()).map_err(|error| Located(value.span(), error.to_string()))
}

pub(crate) fn line_of(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|octet| *octet == b'\n').count()
}
