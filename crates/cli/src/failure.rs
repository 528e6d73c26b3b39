//! How a command fails: message, what to do, exit code.

use std::fmt;

/// The exit codes of the conventions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Anything not named below.
    Failed = 1,
    /// The command line is wrong.
    Usage = 2,
    /// The drive said no.
    Refused = 3,
    /// The drive, the network or the right to use it is not there.
    Unreachable = 4,
    /// Something differs from what it should be.
    Difference = 5,
    /// A rule that protects people or machines stopped it.
    Safety = 6,
}

impl Exit {
    /// Word for the JSON form.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Failed => "failed",
            Self::Usage => "usage",
            Self::Refused => "refused",
            Self::Unreachable => "unreachable",
            Self::Difference => "difference",
            Self::Safety => "safety",
        }
    }
}

/// Why a command ended without success.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// Exit code.
    pub exit: Exit,
    /// What was tried, on which drive and parameter, and what came back.
    pub message: String,
    /// What to do.
    pub hint: Option<String>,
}

impl Failure {
    /// A failure without a hint.
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self {
            exit,
            message: message.into(),
            hint: None,
        }
    }

    /// A mistake on the command line.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(Exit::Usage, message)
    }

    /// The same with what to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}
