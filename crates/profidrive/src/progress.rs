//! How far long work has come.

/// A part of long work, with how much of it is done. Work that is not counted has no total.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Step {
    /// What is being done.
    pub part: Part,
    /// The drive, where it is about one of many.
    pub drive: Option<String>,
    /// How much of the total is done.
    pub done: usize,
    /// The total; 0 where nothing is counted.
    pub all: usize,
}

/// A part of long work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Part {
    /// Stations are searched.
    Searching,
    /// The stations are asked who they are.
    Identities,
    /// Requests measure the way to each station.
    Requests,
    /// Timers of this computer are measured.
    Timers,
    /// Drives are read.
    Drives,
    /// Frames are captured; counted in milliseconds.
    Capture,
    /// A file is written.
    Writing,
}

impl Part {
    /// Stable name for programs.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Searching => "searching",
            Self::Identities => "identities",
            Self::Requests => "requests",
            Self::Timers => "timers",
            Self::Drives => "drives",
            Self::Capture => "capture",
            Self::Writing => "writing",
        }
    }
}

impl Step {
    /// Returns a part that is not counted.
    #[must_use]
    pub const fn of(part: Part) -> Self {
        Self::counted(part, 0, 0)
    }

    /// Returns how much of a part is done.
    #[must_use]
    pub const fn counted(part: Part, done: usize, all: usize) -> Self {
        Self {
            part,
            drive: None,
            done,
            all,
        }
    }
}
