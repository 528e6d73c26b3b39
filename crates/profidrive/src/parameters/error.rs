//! Why parameters could not be listed, described or written as requested.

use client::{Action, Advice, Error, ErrorKind};

/// Why parameters could not be listed, described or written as requested.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// No parameter fits the filter.
    #[error("no parameter of the {model} matches `{filter}`")]
    NoMatch {
        /// The model with the tables.
        model: &'static str,
        /// The filter.
        filter: String,
    },
    /// The number is the high half of a 64-bit parameter.
    #[error("{parameter} is the high half of {whole}")]
    HighHalf {
        /// The number as it was given.
        parameter: String,
        /// The parameter with both halves.
        whole: &'static str,
    },
    /// Neither the tables nor the drive describe it.
    #[error("{parameter} is in no table of the {model}")]
    Undescribed {
        /// The parameter.
        parameter: String,
        /// The model of the drive.
        model: &'static str,
    },
    /// The drive accepted a value and has another.
    #[error("{drive}: {parameter} reads back another value than was written")]
    Differs {
        /// The drive.
        drive: String,
        /// The parameter.
        parameter: String,
    },
    /// The drive has other values than when the changes were planned. Nothing was written.
    #[error("nothing was written to {drive}: values have changed since this was planned")]
    Outdated {
        /// The drive.
        drive: String,
        /// Each parameter with the value of then and of now.
        changes: Vec<String>,
    },
    /// The drive cannot be reached, or refuses.
    #[error(transparent)]
    Client(#[from] Error),
}

impl ParameterError {
    /// The kind of the error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::NoMatch { .. } | Self::HighHalf { .. } | Self::Undescribed { .. } => ErrorKind::Unsupported,
            Self::Differs { .. } => ErrorKind::Difference,
            Self::Outdated { .. } => ErrorKind::Refused,
            Self::Client(error) => error.kind(),
        }
    }

    /// What to do; empty where there is nothing to add.
    #[must_use]
    pub fn advice(&self) -> Advice {
        match self {
            Self::NoMatch { .. } => Advice::default(),
            Self::HighHalf { whole, .. } => Advice::from(Action::Describe {
                parameter: (*whole).to_owned(),
            }),
            Self::Undescribed { .. } => {
                Advice::from("the drive does not describe it; {read} may read it anyway")
            }
            Self::Differs { .. } => {
                Advice::from("the drive may round, limit or change it by itself; read it again")
            }
            Self::Outdated { .. } => Advice::from("plan the changes again, with the values of now"),
            Self::Client(error) => error.advice().unwrap_or_default(),
        }
    }
}
