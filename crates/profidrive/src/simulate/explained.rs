//! Errors of plants as every front end shows them.

use client::{Advice, ErrorKind};
use plant::{
    ChangeError, ModelsError, NotMet, PlantError, PlantEventError, PlantFileError, TraceError, WorldError,
};

use crate::explained::Explained;

impl Explained for PlantFileError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Read { .. } => ErrorKind::Local,
            _ => ErrorKind::Usage,
        }
    }
}

impl Explained for WorldError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Refused { .. } => ErrorKind::Refused,
            _ => ErrorKind::Usage,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Parameter { problem, .. } => problem.hint().map_or_else(Advice::default, Advice::from),
            _ => Advice::default(),
        }
    }
}

/// What did not come true is a difference between a plant and what was expected of it.
impl Explained for NotMet {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Difference
    }
}

/// Errors that only a caller can avoid, with the remedy in their message.
macro_rules! usage {
    ($($error:ty),*) => {
        $(impl Explained for $error {
            fn kind(&self) -> ErrorKind {
                ErrorKind::Usage
            }
        })*
    };
}

usage!(ChangeError, ModelsError, PlantError, PlantEventError, TraceError);
