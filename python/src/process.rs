//! The process that something lives in. A copy of it (fork) has neither its threads nor, perhaps, locks that ever open.

use crate::errors::{Failure, closed};

/// The process in which it was made.
#[derive(Debug, Clone, Copy)]
pub struct Process(u32);

impl Process {
    pub fn this() -> Self {
        Self(std::process::id())
    }

    /// Returns whether this is the process.
    pub fn is_this(self) -> bool {
        self.0 == std::process::id()
    }

    /// Fails in a copy of the process. `what` is of the other one: `the network was opened`.
    pub fn check(self, what: &str) -> Result<(), Failure> {
        if self.is_this() {
            return Ok(());
        }
        let text = format!("{what} by another process, of which this one is a copy (fork)");
        Err(closed(&text))
    }
}
