//! How a call ended whose report is there anyway.

use client::ErrorKind;

/// How a call ended that has a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Outcome {
    /// Everything that was requested is done, and as it should be.
    Complete,
    /// No station answered.
    NoAnswer,
    /// A part is missing.
    Partial,
    /// Something is not as it should be, or two things differ.
    Difference,
    /// This computer or its network is not fit for what is meant.
    Unfit,
}

impl Outcome {
    /// Returns the kind of error that a front end makes of it; `None` for a success.
    #[must_use]
    pub const fn kind(self) -> Option<ErrorKind> {
        match self {
            Self::Complete => None,
            Self::NoAnswer => Some(ErrorKind::Unreachable),
            Self::Partial => Some(ErrorKind::Partial),
            Self::Difference => Some(ErrorKind::Difference),
            Self::Unfit => Some(ErrorKind::Local),
        }
    }
}

/// A report with the outcome of its call.
#[derive(Debug, Clone, PartialEq)]
pub struct Reported<R> {
    /// What was found or done.
    pub report: R,
    /// How the call ended.
    pub outcome: Outcome,
}
