//! Parameter jobs: write a request record, read the answer from the same record until it is ready.
//!
//! Source: PROFIdrive profile, base mode parameter access over PROFINET. The pauses lie here and nowhere else.

use alloc::vec::Vec;
use core::time::Duration;

use super::error::ServiceError;
use super::event::CallId;
use crate::Instant;
use crate::wire::PnioStatus;
use crate::wire::block::RecordAddress;

/// First pause after "not ready".
const FIRST_PAUSE: Duration = Duration::from_millis(10);
/// Longest pause.
const LONGEST_PAUSE: Duration = Duration::from_millis(50);
/// Longest answer requested.
pub(super) const ANSWER: u32 = 4096;

/// What a job does next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    Write,
    Read,
}

/// One parameter job.
#[derive(Debug, Clone)]
pub(super) struct Job {
    pub call: CallId,
    pub at: RecordAddress,
    pub request: Vec<u8>,
    pub step: Step,
    /// When the step may be done.
    pub due: Instant,
    pause: Duration,
    started: Option<Instant>,
    limit: Duration,
}

impl Job {
    pub(super) const fn new(
        now: Instant,
        call: CallId,
        at: RecordAddress,
        request: Vec<u8>,
        limit: Duration,
    ) -> Self {
        Self {
            call,
            at,
            request,
            step: Step::Write,
            due: now,
            pause: FIRST_PAUSE,
            started: None,
            limit,
        }
    }

    /// Its first request goes out: the time allowed starts.
    pub(super) fn begin(&mut self, now: Instant) {
        self.started.get_or_insert(now);
    }

    /// The request was taken.
    pub(super) const fn written(&mut self, now: Instant) {
        self.step = Step::Read;
        self.due = now;
        self.pause = FIRST_PAUSE;
    }

    /// Handles a failed step. Returns true if it is to be tried again; else the error is final.
    pub(super) fn again(&mut self, now: Instant, error: &mut ServiceError) -> bool {
        let status: PnioStatus = match error {
            ServiceError::Refused { status, .. } if status.is_state_conflict() => *status,
            _ => return false,
        };
        let spent = self
            .started
            .map_or(Duration::ZERO, |start| now.saturating_since(start));
        if spent >= self.limit {
            *error = ServiceError::NotReady {
                limit: self.limit,
                status,
            };
            return false;
        }
        // the last try is at the limit
        let left = self.limit.saturating_sub(spent);
        self.due = now + self.pause.min(left);
        self.pause = (self.pause * 2).min(LONGEST_PAUSE);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    const AT: RecordAddress = RecordAddress {
        api: 0x3A00,
        slot: 1,
        subslot: 1,
        index: 0xB02E,
    };

    #[test]
    fn pauses_grow_to_fifty_and_end_at_the_limit() {
        let limit = Duration::from_millis(200);
        let mut job = Job::new(Instant::ZERO, CallId(1), AT, vec![], limit);
        job.begin(Instant::ZERO);
        job.written(Instant::ZERO);
        assert_eq!(
            (job.step, job.due),
            (Step::Read, Instant::ZERO),
            "the first read goes out at once"
        );
        let mut tries = vec![];
        let mut now = Instant::ZERO;
        let busy = ServiceError::Refused {
            what: "record read",
            status: PnioStatus::read(0xB5),
        };
        let mut error = busy.clone();
        while job.again(now, &mut error) {
            now = job.due;
            tries.push(now.as_millis());
        }
        assert_eq!(tries, [10, 30, 70, 120, 170, 200]);
        assert_eq!(
            error,
            ServiceError::NotReady {
                limit,
                status: PnioStatus::read(0xB5)
            }
        );
        let mut other = ServiceError::Refused {
            what: "record read",
            status: PnioStatus::read(0xB0),
        };
        assert!(!job.again(Instant::ZERO, &mut other));
        assert!(matches!(other, ServiceError::Refused { .. }));
    }
}
