//! Parameters that a drive does not answer while it is stopped. A stop needs none of them.

use std::time::Duration;

use profinet::Instant;

use super::Session;
use crate::{Drive, Error};

/// How long one parameter request of a stop may remain without an answer.
pub(super) const SILENCE: Duration = Duration::from_secs(2);
/// How long all parameter requests of a stop may take together on a network.
const TOGETHER: Duration = Duration::from_secs(4);
/// Shortest wait after that: a connection that is given up is closed at the drive too.
const LEAST: Duration = Duration::from_millis(100);

/// What became of the parameter requests of a stop.
#[derive(Debug, Clone, Default)]
pub(super) struct Unread {
    /// Time that the requests took so far.
    spent: Duration,
    /// When the request under way is given up.
    pub due: Option<Instant>,
    /// The first error: no more requests are sent.
    cause: Option<String>,
}

impl Session {
    /// From now on a parameter that the drive does not answer, or not properly, counts as unknown and ends no call. After
    /// the first one none is requested any more. [`stop_drive`](Self::stop_drive) does this by itself; before
    /// [`find`](Self::find) it bounds what is read there too.
    pub fn tolerate_unread(&mut self) {
        self.unread.get_or_insert_default();
    }

    /// Why parameters are not read any more, since [`tolerate_unread`](Self::tolerate_unread); `None` while they are.
    #[must_use]
    pub fn unread(&self) -> Option<&str> {
        self.unread.as_ref()?.cause.as_deref()
    }

    /// Begins a parameter request that has only so much time; all the time of the world outside of a stop.
    pub(super) fn begin_in_time(&mut self, drive: &Drive) -> Instant {
        let begin = self.now();
        if let Some(unread) = &mut self.unread {
            let left = TOGETHER.saturating_sub(unread.spent);
            // a line carries one parameter at a time, and waits for each
            unread.due = (!drive.is_on_line()).then(|| begin + left.min(SILENCE));
        }
        begin
    }

    /// Ends the request that began then.
    pub(super) fn end_in_time(&mut self, begin: Instant) {
        let took = self.now() - begin;
        if let Some(unread) = &mut self.unread {
            unread.due = None;
            unread.spent += took;
        }
    }

    /// Whether this error of a parameter request is tolerated; then no more are sent.
    pub(super) fn gives_up(&mut self, error: &Error) -> bool {
        let Some(unread) = self.unread.as_mut().filter(|_| is_unread(error)) else {
            return false;
        };
        unread.cause.get_or_insert_with(|| error.to_string());
        true
    }

    /// From now on parameter requests are given up at `end`, or when those around them are: a motion does not wait for
    /// them. Returns what is to be put back.
    pub(super) fn bind(&mut self, end: Instant) -> Option<Instant> {
        let before = self.bound;
        self.bound = Some(before.map_or(end, |before| before.min(end)));
        before
    }

    /// When the parameter request under way is given up, if not by its own limit.
    pub(super) fn due(&self) -> Option<Instant> {
        let unread = self.unread.as_ref().and_then(|unread| unread.due);
        [unread, self.bound].into_iter().flatten().min()
    }

    /// The end of a wait that may take so long.
    pub(super) fn end_of(&self, limit: Duration) -> Instant {
        let now = self.now();
        let due = self.unread.as_ref().and_then(|unread| unread.due);
        let end = due.map_or(now + limit, |due| (now + limit).min(due.max(now + LEAST)));
        self.bound.map_or(end, |bound| end.min(bound.max(now)))
    }

    /// How long one parameter of a serial line may remain without an answer.
    pub(super) fn silence(&self, limit: Duration) -> Duration {
        if self.unread.is_some() {
            limit.min(SILENCE)
        } else {
            limit
        }
    }
}

/// The drive is there, its parameters are not.
const fn is_unread(error: &Error) -> bool {
    matches!(
        error,
        Error::Record { .. }
            | Error::Timeout { .. }
            | Error::Malformed { .. }
            | Error::Channel { .. }
            | Error::LineSilent { .. }
            | Error::Refused { .. }
            | Error::UnknownRequest { .. }
            | Error::NoRoute { .. }
            | Error::ParametersOwned { .. }
            | Error::ConnectionLost { .. }
            | Error::Connect { .. }
    )
}
