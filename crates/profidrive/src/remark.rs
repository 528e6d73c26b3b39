//! Sentences that hold for every front end.

use client::Advice;
use serde::Serialize;

/// A sentence on what happened.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Remark {
    /// What happened.
    pub sentence: String,
    /// Whether something is not as it should be.
    pub is_warning: bool,
    /// What to do, where there is something to do.
    pub next: Option<Advice>,
}

impl Remark {
    pub(crate) fn news(sentence: impl Into<String>) -> Self {
        Self {
            sentence: sentence.into(),
            is_warning: false,
            next: None,
        }
    }

    pub(crate) fn warning(sentence: impl Into<String>) -> Self {
        Self {
            is_warning: true,
            ..Self::news(sentence)
        }
    }

    pub(crate) fn and(self, next: Option<Advice>) -> Self {
        Self { next, ..self }
    }
}
