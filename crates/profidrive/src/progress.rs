//! How far long work has come.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// A part of long work, with how much of it is done. Work that is not counted has no total.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step {
    /// What is being done.
    pub part: Part,
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
    /// Settings are written.
    Settings,
    /// Frames are captured.
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
            Self::Settings => "settings",
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
        Self { part, done, all }
    }
}

/// The progress of many drives that are worked on side by side, as one: what is done of all of them, of what all of them have.
///
/// ```
/// use std::sync::Mutex;
/// use profidrive::{Part, Sum};
///
/// let seen = Mutex::new(Vec::new());
/// let report = |step: profidrive::Step| seen.lock().unwrap().push((step.done, step.all));
/// let sum = Sum::new(Part::Drives, 2, report);
/// sum.report("akd-1", 10, 100);
/// sum.report("akd-2", 50, 100);
/// sum.report("akd-1", 100, 100);
/// // a drive that has not begun is taken for one like the others
/// assert_eq!(*seen.lock().unwrap(), [(10, 200), (60, 200), (150, 200)]);
/// ```
#[derive(Debug)]
pub struct Sum<F> {
    part: Part,
    drives: usize,
    of_each: Mutex<BTreeMap<String, (usize, usize)>>,
    report: F,
}

impl<F: Fn(Step)> Sum<F> {
    /// Returns the progress of so many drives, which `report` gets.
    pub const fn new(part: Part, drives: usize, report: F) -> Self {
        Self {
            part,
            drives,
            of_each: Mutex::new(BTreeMap::new()),
            report,
        }
    }

    /// Takes how far one of them is.
    pub fn report(&self, drive: &str, done: usize, all: usize) {
        let (done, all) = {
            let mut of_each = self.of_each.lock().unwrap_or_else(PoisonError::into_inner);
            of_each.insert(drive.to_owned(), (done, all));
            let sum = of_each
                .values()
                .fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
            (
                sum.0,
                sum.1 * self.drives.max(of_each.len()) / of_each.len().max(1),
            )
        };
        (self.report)(Step::counted(self.part, done, all));
    }
}
