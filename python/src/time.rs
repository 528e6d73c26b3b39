//! Times as Python gives them.

use std::time::Duration;

use pyo3::prelude::*;

use crate::errors::Failure;

/// A time: seconds, or a text with its unit.
#[derive(Debug, FromPyObject)]
pub enum Span {
    /// `0.4`
    Seconds(f64),
    /// `400ms`
    Text(String),
}

impl Span {
    /// Returns the time, 0 s to one year.
    pub fn read(&self) -> Result<Duration, Failure> {
        match self {
            // the same bounds and words as for a text
            Self::Seconds(seconds) => plant::time(&format!("{seconds}s")),
            Self::Text(text) => plant::time(text),
        }
        .map_err(Failure::usage)
    }
}

/// Returns seconds.
pub const fn seconds(time: Duration) -> f64 {
    time.as_secs_f64()
}
