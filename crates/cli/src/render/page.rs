//! Reports as text.

use serde::Serialize;

use crate::output::Output;

/// A report that people read as lines, and programs as JSON.
pub trait Page: Serialize {
    /// Prints the lines.
    fn print(&self, output: &Output);
}
