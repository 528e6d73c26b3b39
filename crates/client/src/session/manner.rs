//! How the requests of a caller are carried out at present: what a stop or a motion changes for a while.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use profinet::Instant;

use super::Session;
use super::unread::Unread;
use crate::Engine;

/// What holds for the requests of one caller.
#[derive(Debug, Clone, Default)]
pub(super) struct Manner {
    /// A stop is carried out that must not be interrupted.
    pub stopping: bool,
    /// When parameter requests are given up at the latest.
    pub bound: Option<Instant>,
    /// Parameters that are not answered are tolerated.
    pub unread: Option<Unread>,
    /// Time that the drive has for its first answer to a parameter request, until there is one.
    pub first_answer: Option<Duration>,
}

/// Ends with what it stands for, a call that is dropped half-way included: then everything holds again that held before.
#[derive(Debug)]
#[must_use]
pub(super) struct Meanwhile {
    manner: Arc<Mutex<Manner>>,
    before: Before,
}

#[derive(Debug)]
enum Before {
    Stopping(bool),
    Bound(Option<Instant>),
    /// Nothing was tolerated.
    Strict,
    Tolerant,
    /// A request began then, in the time that it has.
    InTime(Instant, Engine),
}

fn locked(manner: &Mutex<Manner>) -> MutexGuard<'_, Manner> {
    manner.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Drop for Meanwhile {
    fn drop(&mut self) {
        let mut manner = locked(&self.manner);
        match &self.before {
            Before::Stopping(stopping) => manner.stopping = *stopping,
            Before::Bound(bound) => manner.bound = *bound,
            Before::Strict => manner.unread = None,
            Before::Tolerant => {}
            Before::InTime(begin, engine) => {
                if let Some(unread) = &mut manner.unread {
                    unread.end(engine.now() - *begin);
                }
            }
        }
    }
}

impl Session {
    pub(super) fn manner(&self) -> MutexGuard<'_, Manner> {
        locked(&self.manner)
    }

    fn meanwhile(&self, before: Before) -> Meanwhile {
        Meanwhile {
            manner: Arc::clone(&self.manner),
            before,
        }
    }

    /// Meanwhile a caller's wish to stop interrupts nothing.
    pub(super) fn unstoppable(&self) -> Meanwhile {
        let before = std::mem::replace(&mut self.manner().stopping, true);
        self.meanwhile(Before::Stopping(before))
    }

    /// Meanwhile parameter requests are given up at `end`, or when those around them are: a motion does not wait for them.
    pub(super) fn bound_by(&self, end: Instant) -> Meanwhile {
        let mut manner = self.manner();
        let before = manner.bound;
        manner.bound = Some(before.map_or(end, |before| before.min(end)));
        drop(manner);
        self.meanwhile(Before::Bound(before))
    }

    /// Meanwhile a parameter that is not answered ends no call.
    pub(super) fn tolerant(&self) -> Meanwhile {
        let mut manner = self.manner();
        let before = match manner.unread {
            Some(_) => Before::Tolerant,
            None => Before::Strict,
        };
        manner.unread.get_or_insert_default();
        drop(manner);
        self.meanwhile(before)
    }

    /// Meanwhile one parameter request is carried out in the time that it has; all the time of the world outside of a stop.
    pub(super) fn in_time(&self, on_line: bool) -> Meanwhile {
        let begin = self.now();
        if let Some(unread) = &mut self.manner().unread {
            unread.begin(begin, on_line);
        }
        self.meanwhile(Before::InTime(begin, self.engine.clone()))
    }
}
