//! What keeps a drive from being as a file of settings says.

use client::change::{Plan, Saved, Step};
use client::{Advice, Drive, ErrorKind};

use super::Restore;
use crate::explained::Explained;

/// Most parameters that are named in one sentence.
const MOST_NAMED: usize = 4;

/// What keeps a drive from being as a file says.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Shortfall {
    /// The drive refused values.
    #[error("{drive} refused {refused} of {total} values")]
    Refused {
        /// The drive.
        drive: String,
        /// How many values it refused.
        refused: usize,
        /// How many were to be written.
        total: usize,
    },
    /// The drive has its new values, and refused to save them.
    #[error("{drive} refused to save its new values: {cause}")]
    NotSaved {
        /// The drive.
        drive: String,
        /// What it answered.
        cause: String,
    },
    /// A value reads back differently, or is not saved though that was requested.
    #[error("{drive} is not as the file says: {summary}")]
    Differs {
        /// The drive.
        drive: String,
        /// What was written and verified, in numbers.
        summary: String,
    },
    /// The file has values or motion tasks that cannot be written; all others are written.
    #[error("{drive} is not as the file says: {}", missing(*.values, .names, .tasks.as_deref()))]
    Unwritable {
        /// The drive.
        drive: String,
        /// How many values cannot be written.
        values: usize,
        /// Names of some of them.
        names: Vec<&'static str>,
        /// Why the motion tasks are left out, if they are.
        tasks: Option<String>,
    },
}

impl Explained for Shortfall {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Refused { .. } | Self::NotSaved { .. } => ErrorKind::Refused,
            Self::Differs { .. } | Self::Unwritable { .. } => ErrorKind::Difference,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::Refused { .. } => Advice::default(),
            Self::NotSaved { .. } => "the new values are lost when the drive is switched off".into(),
            Self::Differs { .. } => "the drive may round, limit or change values by itself".into(),
            Self::Unwritable { .. } => {
                "take out of the file what is left out, or choose the rest with {choose settings}, where that is meant".into()
            }
        }
    }
}

/// What a plan, carried out or not, leaves different from its file; `None` where the drive is as the file says.
#[must_use]
pub fn shortfall(plan: &Plan, drive: &Drive, wanted: &Restore) -> Option<Shortfall> {
    let (set, drive) = (&plan.set, drive.label());
    if !wanted.dry_run {
        let refused = set.count(Step::is_refused);
        if refused > 0 {
            let total = set.total();
            return Some(Shortfall::Refused {
                drive,
                refused,
                total,
            });
        }
        if let Saved::Refused(cause) = set.saved() {
            let cause = cause.to_string();
            return Some(Shortfall::NotSaved { drive, cause });
        }
        if !set.is_done() || (wanted.save && set.saved() != Saved::Yes) {
            let summary = set.summary();
            return Some(Shortfall::Differs { drive, summary });
        }
    }
    let values = plan.refused();
    let tasks = plan.tasks_left_out.as_ref().map(ToString::to_string);
    if values == 0 && tasks.is_none() {
        return None;
    }
    let refused = plan.skipped.iter().filter(|skipped| skipped.why.is_refusal());
    let names = refused.filter_map(|skipped| skipped.reading.name);
    Some(Shortfall::Unwritable {
        drive,
        values,
        names: names.take(MOST_NAMED).collect(),
        tasks,
    })
}

fn missing(values: usize, names: &[&str], tasks: Option<&str>) -> String {
    let values_missing = match values {
        0 => None,
        1 => Some("1 value of the file cannot be written".to_owned()),
        count => Some(format!("{count} values of the file cannot be written")),
    };
    let tasks = tasks.map(|why| format!("the motion tasks are left out ({why})"));
    let missing: Vec<String> = values_missing.into_iter().chain(tasks).collect();
    let named = match names.len() {
        0 => String::new(),
        count if count < values => format!(" ({}, ..)", names.join(", ")),
        _ => format!(" ({})", names.join(", ")),
    };
    format!("{}{named}", missing.join("; "))
}
