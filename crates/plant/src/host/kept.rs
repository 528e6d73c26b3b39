//! The trace of drives that run on a network.

use std::sync::{Arc, Mutex, PoisonError};

use network::system::now;
use profinet::Instant;

use crate::digest::Digest;
use crate::expect::{Live, Observed};
use crate::kept::Trace;
use crate::trace::Event;

/// A trace that a [`Host`](super::Host) keeps while it runs, with times from its start. Clones are the same one.
///
/// The host never waits for who looks at it.
#[derive(Debug, Clone, Default)]
pub struct HostTrace(Arc<Mutex<Option<Kept>>>);

#[derive(Debug)]
struct Kept {
    start: Instant,
    trace: Trace,
    /// Of the events.
    digest: Digest,
}

impl HostTrace {
    /// Returns what has happened until now; `None` before the host has begun. Its digest is that of its events.
    #[must_use]
    pub fn until_now(&self) -> Option<Trace> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = kept.as_mut()?;
        kept.trace.end_at(now() - kept.start, kept.digest.value());
        Some(kept.trace.clone())
    }
}

/// Fills a trace.
#[derive(Debug)]
pub(super) struct Keeper {
    kept: HostTrace,
    start: Instant,
    /// Events that came while another thread looked at the trace.
    waiting: Vec<(usize, Event)>,
}

impl Keeper {
    /// Begins a trace of about `limit` octets at most.
    pub fn begin<'a>(
        kept: HostTrace,
        start: Instant,
        seed: u64,
        names: impl Iterator<Item = &'a str>,
        limit: usize,
    ) -> Self {
        *kept.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(Kept {
            start,
            trace: Trace::new(seed, names, limit),
            digest: Digest::default(),
        });
        Self {
            kept,
            start,
            waiting: Vec::new(),
        }
    }

    /// Takes an event of the drive of that number.
    pub fn note(&mut self, drive: usize, event: Event) {
        self.waiting.push((drive, event));
    }

    /// Whether events wait to be taken.
    pub const fn has_events(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// Returns the time of the trace.
    pub fn time(&self, at: Instant) -> std::time::Duration {
        at.saturating_since(self.start)
    }

    /// Takes what the drives are like at a time. While another thread looks at the trace this tick is left out: the next one has what
    /// changed.
    pub fn look<'a>(&mut self, at: Instant, drives: impl Iterator<Item = Live<'a>>) {
        let time = self.time(at);
        let Ok(mut kept) = self.kept.0.try_lock() else {
            return;
        };
        let Some(Kept { trace, digest, .. }) = kept.as_mut() else {
            return;
        };
        for (drive, event) in self.waiting.drain(..) {
            digest.event(drive, &event);
            trace.take_event(&event);
        }
        let drives: Vec<Live<'_>> = drives.collect();
        trace.take_tick(time, drives.iter().map(|live| live as &dyn Observed));
    }
}
