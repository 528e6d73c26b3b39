//! Parameters that a drive does not answer while it is stopped. A stop needs none of them.

use std::time::Duration;

use profinet::Instant;

use super::Session;
use super::manner::Manner;
use crate::Error;

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

impl Unread {
    /// Begins a request at `now`, which has only so much time.
    pub(super) fn begin(&mut self, now: Instant, on_line: bool) {
        let left = TOGETHER.saturating_sub(self.spent);
        // a line carries one parameter at a time, and waits for each
        self.due = (!on_line).then(|| now + left.min(SILENCE));
    }

    /// Ends the request, which took so long.
    pub(super) fn end(&mut self, took: Duration) {
        self.due = None;
        self.spent += took;
    }
}

impl Manner {
    /// Returns the time when the request under way is given up because nothing has answered for too long.
    fn silent(&self) -> Option<Instant> {
        self.unread.as_ref()?.due
    }
}

impl Session {
    /// From now on a parameter that the drive does not answer, or not properly, counts as unknown and ends no call. After
    /// the first one none is requested any more. [`stop_drive`](Self::stop_drive) does this by itself; before
    /// [`find`](Self::find) it bounds what is read there too.
    pub fn tolerate_unread(&mut self) {
        self.manner().unread.get_or_insert_default();
    }

    /// Gives a drive only `limit` to be ready with the answer to the first parameter request of this caller. Once it has answered
    /// one, the others have their usual time. For one drive of many: the others do not wait long for one that is silent.
    pub fn expect_first_answer_within(&mut self, limit: Duration) {
        self.manner().first_answer = Some(limit);
    }

    /// Returns the time for the answer to a parameter request that is sent now; `None` for the usual time.
    pub(super) fn time_for_answer(&self) -> Option<Duration> {
        let due = self.due().map(|due| due.saturating_since(self.now()));
        let first = self.manner().first_answer;
        due.into_iter().chain(first).min()
    }

    /// Returns the error since which parameters are not read any more, after
    /// [`tolerate_unread`](Self::tolerate_unread); `None` while they are.
    #[must_use]
    pub fn unread(&self) -> Option<String> {
        self.manner().unread.as_ref()?.cause.clone()
    }

    /// Returns whether this error of a parameter request is tolerated; then no more are sent.
    pub(super) fn gives_up(&self, error: &Error) -> bool {
        let mut manner = self.manner();
        let Some(unread) = manner.unread.as_mut().filter(|_| is_unread(error)) else {
            return false;
        };
        unread.cause.get_or_insert_with(|| error.to_string());
        true
    }

    /// Returns whether a stop or a motion waits for what is requested now.
    pub(super) fn is_hurried(&self) -> bool {
        let manner = self.manner();
        manner.bound.is_some() || manner.unread.is_some()
    }

    /// Returns the time when the parameter request under way is given up, if not by its own limit.
    pub(super) fn due(&self) -> Option<Instant> {
        let manner = self.manner();
        Instant::earliest([manner.silent(), manner.bound])
    }

    /// Returns the end of a wait that may take so long.
    pub(super) fn end_of(&self, limit: Duration) -> Instant {
        let now = self.now();
        let manner = self.manner();
        let silent = manner.silent();
        let end = silent.map_or(now + limit, |due| (now + limit).min(due.max(now + LEAST)));
        manner.bound.map_or(end, |bound| end.min(bound.max(now)))
    }

    /// Returns the longest time for the answer to one parameter at a serial line.
    pub(super) fn silence(&self, limit: Duration) -> Duration {
        if self.manner().unread.is_some() {
            limit.min(SILENCE)
        } else {
            limit
        }
    }
}

/// Returns whether the drive is there, its parameters are not.
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
