//! What a world shows to those who watch its drives: the checks of expectations and the trace that is kept.

use profinet::Instant;

use crate::digest::Digest;
use crate::event::Unit;
use crate::expect::{Live, Monitor, Observed};
use crate::kept::Trace;
use crate::snapshot::Snapshot;
use crate::trace::Event;

use super::{Seat, World};

/// Those who watch the drives of a world.
#[derive(Debug, Default)]
pub(super) struct Watchers {
    /// Checks what is expected of the drives.
    pub monitor: Option<Box<Monitor>>,
    /// Each waits for something to be true of a drive, by number.
    pub goals: Vec<(u64, Monitor)>,
    /// The number of the next one.
    pub next_goal: u64,
    /// Keeps the run.
    pub trace: Option<Box<Trace>>,
    /// Of all events.
    pub digest: Digest,
}

impl Watchers {
    /// Shows an event of the drive of that number.
    pub fn note(&mut self, drive: usize, event: &Event) {
        self.digest.event(drive, event);
        let goals = self.goals.iter_mut().map(|(_, goal)| goal);
        for monitor in self.monitor.as_deref_mut().into_iter().chain(goals) {
            monitor.note(drive, event);
        }
        if let Some(trace) = &mut self.trace {
            trace.take_event(event);
        }
    }

    const fn is_empty(&self) -> bool {
        self.monitor.is_none() && self.goals.is_empty() && self.trace.is_none()
    }
}

impl World {
    /// Keeps what happens from now on as a [`Trace`] of about `limit` octets at most, [`Trace::USUAL_LIMIT`] for usual runs.
    /// Replaces the trace before.
    pub fn keep_trace(&mut self, limit: usize) {
        let names = self.drives.iter().map(|seat| seat.name.as_str());
        let trace = Some(Box::new(Trace::new(self.seed, names, limit)));
        let watchers = self.shown(Watchers {
            trace,
            ..Watchers::default()
        });
        self.watchers.trace = watchers.trace;
    }

    /// Returns the trace until now; `None` when none is [kept](Self::keep_trace).
    pub fn trace(&mut self) -> Option<&Trace> {
        let (now, digest) = (self.now() - Instant::ZERO, self.digest());
        let trace = self.watchers.trace.as_mut()?;
        trace.end_at(now, digest);
        Some(trace)
    }

    /// Ends the trace and returns it; `None` when none is [kept](Self::keep_trace).
    pub fn take_trace(&mut self) -> Option<Trace> {
        self.trace()?;
        self.watchers.trace.take().map(|trace| *trace)
    }

    /// Returns a number that is the same for the same run: the same plant, the same seed, and the same calls until now.
    ///
    /// It covers the events, the frames, and what each drive is like now. It is that of this version of the library on this kind
    /// of computer.
    #[must_use]
    pub fn digest(&self) -> u64 {
        let mut digest = self.watchers.digest;
        digest.number(self.seed);
        digest.time(self.now() - Instant::ZERO);
        digest.number(self.medium.segment().trace_hash());
        for (seat, live) in self.seats() {
            digest.octets(seat.name.as_bytes());
            Snapshot::of(&live, None).digest(&mut digest);
        }
        digest.value()
    }

    /// Returns each drive in its place.
    fn seats(&self) -> impl Iterator<Item = (&Seat, Live<'_>)> {
        self.drives.iter().filter_map(|seat| {
            let unit = self.medium.segment().station::<Unit>(seat.id)?;
            let live = Live {
                drive: unit.inner().endpoint().drive(),
                connected: seat.connected,
            };
            Some((seat, live))
        })
    }

    /// Shows all drives to those who watch them.
    pub(super) fn show_drives(&mut self) {
        let watchers = std::mem::take(&mut self.watchers);
        self.watchers = self.shown(watchers);
    }

    /// Shows all drives as they are now; returns those who have seen them.
    pub(super) fn shown(&self, mut watchers: Watchers) -> Watchers {
        if watchers.is_empty() {
            return watchers;
        }
        let time = self.now() - Instant::ZERO;
        let drives: Vec<Live<'_>> = self.seats().map(|(_, live)| live).collect();
        let Watchers {
            monitor,
            goals,
            trace,
            ..
        } = &mut watchers;
        let goals = goals.iter_mut().map(|(_, goal)| goal);
        for monitor in monitor.as_deref_mut().into_iter().chain(goals) {
            for (number, live) in drives.iter().enumerate() {
                monitor.observe(number, time, live);
            }
        }
        if let Some(trace) = trace {
            trace.take_tick(time, drives.iter().map(|live| live as &dyn Observed));
        }
        watchers
    }
}
