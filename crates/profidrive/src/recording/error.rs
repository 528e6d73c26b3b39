//! Why something cannot be recorded, or cannot be written.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use client::{Advice, Error, ErrorKind};
use profile::value::ParameterProblem;

use super::trigger::{MOST_BEFORE, Trigger};
use crate::clock::lasting;
use crate::drive::DriveError;
use crate::explained::Explained;
use crate::listed;
use crate::monitor::TooFast;

/// End of the name of a file that grows until it is made into one of another form.
pub(super) const PART: &str = "part";

/// Why something cannot be recorded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// Nothing is named.
    #[error("no signal to record")]
    NoSignal,
    /// A name means the same as one before it.
    #[error("`{name}` is named twice")]
    Twice {
        /// The name.
        name: String,
    },
    /// Readings were to follow each other too fast.
    #[error(transparent)]
    TooFast(#[from] TooFast),
    /// A name means no parameter of the drive.
    #[error("{drive}: {problem}")]
    Parameter {
        /// The drive.
        drive: String,
        /// What is wrong.
        problem: ParameterProblem,
    },
    /// A parameter has no number.
    #[error("{drive}: {name} is not a number")]
    NotANumber {
        /// The drive.
        drive: String,
        /// The parameter as it was named.
        name: String,
    },
    /// The telegram does not carry a signal.
    #[error("{drive}: telegram {telegram} has no signal `{name}`; it has {}", .signals.join(", "))]
    NoSuchSignal {
        /// The drive.
        drive: String,
        /// Its telegram.
        telegram: u16,
        /// The signal as it was named.
        name: String,
        /// The signals of the telegram.
        signals: Vec<String>,
    },
    /// The signal of a trigger has other units on other drives.
    #[error("the trigger compares `{name}`, which is in {} on some drives, in {} on others", shown(.units.0.as_str()), shown(.units.1.as_str()))]
    TriggerUnits {
        /// The name.
        name: String,
        /// Two of its units.
        units: (String, String),
    },
    /// The signal of a trigger is not recorded.
    #[error("the trigger compares `{name}`, which is not recorded; recorded are {}", .recorded.join(", "))]
    TriggerSignal {
        /// The signal.
        name: String,
        /// What is recorded.
        recorded: Vec<String>,
    },
    /// The value of a trigger has another unit.
    #[error("the trigger on {name}: {cause}")]
    TriggerUnit {
        /// The signal.
        name: String,
        /// What is wrong.
        cause: String,
    },
    /// The time before the trigger does not fit into memory.
    #[error("the time before the trigger has {rows} rows, {MOST_BEFORE} are possible")]
    Before {
        /// Rows that it would have.
        rows: u128,
    },
    /// The time to record is none.
    #[error("a recording of 0 s has no rows")]
    NoTime,
    /// A drive that was away has another telegram, without a signal that was recorded or with another unit of it.
    #[error("{drive}: telegram {telegram}, which it has now, does not carry `{name}` in {} as before", shown(.unit))]
    Changed {
        /// The drive.
        drive: String,
        /// Its telegram now.
        telegram: u16,
        /// The signal.
        name: String,
        /// The unit that its values had.
        unit: String,
    },
    /// The event at which the recording was to begin did not happen.
    #[error("`{trigger}` did not happen within {}{}: nothing was recorded", lasting(*.waited), held(.already))]
    NotTriggered {
        /// What was waited for.
        trigger: Box<Trigger>,
        /// For how long.
        waited: Duration,
        /// The drives on which the condition was true from the beginning.
        already: Vec<String>,
    },
    /// The drive could not be found or worked with.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// The drive cannot be reached, or refuses.
    #[error(transparent)]
    Client(#[from] Error),
}

fn held(already: &[String]) -> String {
    if already.is_empty() {
        return String::new();
    }
    let names: Vec<&str> = already.iter().map(String::as_str).collect();
    format!(
        " (it was true from the beginning on {}, and did not become true again)",
        listed(&names)
    )
}

fn shown(unit: &str) -> &str {
    if unit.is_empty() { "no unit" } else { unit }
}

impl Explained for RecordingError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Parameter { problem, .. } => Error::from(problem.clone()).kind(),
            Self::Drive(error) => error.kind(),
            Self::Client(error) => error.kind(),
            Self::Changed { .. } => ErrorKind::Difference,
            Self::NotTriggered { .. } => ErrorKind::NotReached,
            _ => ErrorKind::Usage,
        }
    }

    fn message(&self) -> String {
        match self {
            Self::Drive(error) => error.message(),
            Self::Client(error) => error.message(),
            other => other.to_string(),
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Parameter { problem, .. } => Error::from(problem.clone()).advice().unwrap_or_default(),
            Self::TooFast(_) => Advice::from(
                "the parameter channel of the drive would be blocked for others; cyclic signals come with each cycle",
            ),
            Self::TriggerUnits { .. } => Advice::from("record these drives one by one"),
            Self::Drive(error) => error.advice(),
            Self::Client(error) => Explained::advice(error),
            Self::Before { .. } => Advice::from("take a shorter time, fewer drives or a longer interval"),
            _ => Advice::default(),
        }
    }
}

/// Why rows could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}{}", described(.action, .file, .cause), kept(.rows, .readable.as_ref()))]
pub struct WriteError {
    /// What failed: `cannot write`.
    pub action: &'static str,
    /// The file.
    pub file: PathBuf,
    /// What the system reports.
    pub cause: io::Error,
    /// Rows that were recorded before and can be read.
    pub rows: u64,
    /// The file in which they are; `None` where nothing was written.
    pub readable: Option<PathBuf>,
}

fn described(action: &str, file: &Path, cause: &io::Error) -> String {
    match cause.kind() {
        io::ErrorKind::AlreadyExists => format!("`{}` exists already", file.display()),
        _ => format!("{action} {}: {cause}", file.display()),
    }
}

fn kept(rows: &u64, readable: Option<&PathBuf>) -> String {
    readable.map_or_else(String::new, |file| {
        format!("; the {rows} rows before are in {}", file.display())
    })
}

impl Explained for WriteError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Local
    }

    fn advice(&self) -> Advice {
        match self.cause.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                Advice::from("free some space, or record to another disk")
            }
            io::ErrorKind::AlreadyExists if is_part(&self.file) => Advice::from(
                "a recording that did not end left it: an Arrow stream with its rows. Rename it to NAME.arrows to read it, or delete it",
            ),
            io::ErrorKind::AlreadyExists => Advice::from("choose another name: recordings are not replaced"),
            _ => Advice::default(),
        }
    }
}

impl WriteError {
    /// A file that is not to be replaced.
    pub(super) fn exists(file: &Path) -> Self {
        Self::new("cannot create", file, io::ErrorKind::AlreadyExists.into())
    }

    pub(super) fn new(action: &'static str, file: impl Into<PathBuf>, cause: io::Error) -> Self {
        Self {
            action,
            file: file.into(),
            cause,
            rows: 0,
            readable: None,
        }
    }
}

/// Whether a file is one that grows until its recording ends.
fn is_part(file: &Path) -> bool {
    file.extension().is_some_and(|end| end == PART)
}
