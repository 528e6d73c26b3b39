//! The trace of drives that run on a network.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use network::system::now;
use profinet::Instant;

use crate::digest::Digest;
use crate::expect::{Goal, Live, Monitor, Observed};
use crate::kept::Trace;
use crate::snapshot::Snapshot;
use crate::trace::{Event, EventKind};
use crate::world::NotMet;

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
    /// What each drive was like when something happened to it last.
    latest: Vec<Snapshot>,
    /// When they were looked at last.
    looked: Duration,
    /// Who waits for something, by number.
    waits: Vec<(u64, Monitor)>,
    /// The number of the next one who waits.
    next: u64,
}

/// Conditions of a drive that someone waits for, from [`HostTrace::pursue`].
#[derive(Debug)]
pub struct HostPursuit {
    kept: HostTrace,
    number: u64,
    goal: Goal,
    end: Duration,
}

impl HostTrace {
    fn locked(&self) -> MutexGuard<'_, Option<Kept>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns what the drive of this number in the plant is like now; `None` before the host has begun.
    #[must_use]
    pub fn state(&self, drive: usize) -> Option<Snapshot> {
        self.locked().as_ref()?.latest.get(drive).cloned()
    }

    /// Begins to wait until the conditions of a goal hold of its drive, for `timeout` from now; `None` before the host has begun. A goal
    /// with a condition on a parameter is not met: a trace keeps none.
    #[must_use]
    pub fn pursue(&self, goal: &Goal, timeout: Duration) -> Option<HostPursuit> {
        let mut kept = self.locked();
        let kept = kept.as_mut()?;
        let begin = kept.passed();
        let wanted = goal.within(timeout, begin);
        let monitor = Monitor::new(&[wanted], kept.latest.len(), kept.trace.seed());
        let number = kept.next;
        kept.next += 1;
        kept.waits.push((number, monitor));
        Some(HostPursuit {
            kept: self.clone(),
            number,
            goal: goal.clone(),
            end: begin + timeout + goal.lasts(),
        })
    }

    /// Returns what has happened until now; `None` before the host has begun. Its digest is that of its events.
    #[must_use]
    pub fn until_now(&self) -> Option<Trace> {
        let mut kept = self.locked();
        let kept = kept.as_mut()?;
        kept.trace.end_at(now() - kept.start, kept.digest.value());
        Some(kept.trace.clone())
    }
}

impl Kept {
    /// Returns the time now, which does not go back behind the last look of the host.
    fn passed(&mut self) -> Duration {
        self.looked = self.looked.max(now().saturating_since(self.start));
        self.looked
    }
}

impl HostPursuit {
    /// Returns whether it is decided if the goal is met: a caller asks every few milliseconds.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        let mut kept = self.kept.locked();
        let Some(kept) = kept.as_mut() else { return true };
        let time = kept.passed();
        let drive = self.goal.drive();
        let Some((_, monitor)) = kept.waits.iter_mut().find(|(number, _)| *number == self.number) else {
            return true;
        };
        // nothing has happened to it since
        if let Some(seen) = kept.latest.get(drive) {
            monitor.observe(drive, time, seen);
        }
        monitor.is_decided() || time >= self.end
    }

    /// Ends the wait. Returns the newest event that reports the goal, from before the wait where it was met then; a sample of now where
    /// no event reports it.
    ///
    /// # Errors
    /// When it is not met: what there was instead.
    pub fn end(self) -> Result<Event, NotMet> {
        let mut kept = self.kept.locked();
        let Some(kept) = kept.as_mut() else {
            return Ok(Event::new(self.end, "", EventKind::note("")));
        };
        let (time, drive) = (kept.passed(), self.goal.drive());
        let mut drives = kept.trace.drives();
        let name = drives
            .nth(drive)
            .map_or_else(String::new, |drive| drive.name().to_owned());
        let place = kept.waits.iter().position(|(number, _)| *number == self.number);
        let monitor = place.map(|place| kept.waits.swap_remove(place).1);
        let results = monitor.map(|monitor| monitor.finish(time, |_| &name));
        // a goal has one drive, so one result
        if let Some(lost) = results.into_iter().flatten().find(|result| !result.is_met()) {
            return Err(NotMet(Box::new(lost)));
        }
        let mut events = kept.trace.events();
        let found = events.rfind(|event| event.drive == name && self.goal.is_reported_by(&event.kind));
        let sample = || {
            let seen = kept.latest.get(drive).map(Into::into);
            Event::new(
                time,
                &name,
                seen.map_or_else(|| EventKind::note(""), EventKind::Sample),
            )
        };
        Ok(found.cloned().unwrap_or_else(sample))
    }
}

impl Drop for HostPursuit {
    fn drop(&mut self) {
        if let Some(kept) = self.kept.locked().as_mut() {
            kept.waits.retain(|(number, _)| *number != self.number);
        }
    }
}

/// Fills a trace.
#[derive(Debug)]
pub(super) struct Keeper {
    kept: HostTrace,
    start: Instant,
    /// Events that came while another thread looked at the trace.
    waiting: Vec<(usize, Event)>,
    /// Numbers of the drives that changed meanwhile.
    late: BTreeSet<usize>,
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
        *kept.locked() = Some(Kept {
            start,
            trace: Trace::new(seed, names, limit),
            digest: Digest::default(),
            latest: Vec::new(),
            looked: Duration::ZERO,
            waits: Vec::new(),
            next: 0,
        });
        Self {
            kept,
            start,
            waiting: Vec::new(),
            late: BTreeSet::new(),
        }
    }

    /// Takes an event of the drive of that number.
    pub fn note(&mut self, drive: usize, event: Event) {
        self.waiting.push((drive, event));
    }

    /// Whether something waits to be taken by the next [look](Self::look).
    pub fn is_behind(&self) -> bool {
        !self.waiting.is_empty() || !self.late.is_empty()
    }

    /// Returns the time of the trace.
    pub fn time(&self, at: Instant) -> Duration {
        at.saturating_since(self.start)
    }

    /// Takes what the drives are like at a time; `touched` are the numbers of those to which something happened. While another thread
    /// looks at the trace this tick is left out: the next look has what changed, and must come soon.
    pub fn look<'a>(&mut self, at: Instant, drives: impl Iterator<Item = Live<'a>>, touched: &[usize]) {
        let time = self.time(at);
        self.late.extend(touched);
        let Ok(mut kept) = self.kept.0.try_lock() else {
            return;
        };
        let Some(Kept {
            trace,
            digest,
            latest,
            looked,
            waits,
            ..
        }) = kept.as_mut()
        else {
            return;
        };
        let time = time.max(*looked);
        *looked = time;
        // what was injected in this turn has its events in the next one
        let injected = |(drive, event): &(usize, Event)| {
            let is_injected = matches!(
                event.kind,
                EventKind::Injected { .. } | EventKind::Restored { .. }
            );
            is_injected.then_some(*drive)
        };
        let injected: Vec<usize> = self.waiting.iter().filter_map(injected).collect();
        for (drive, event) in self.waiting.drain(..) {
            digest.event(drive, &event);
            trace.take_event(&event);
            for (_, monitor) in &mut *waits {
                monitor.note(drive, &event);
            }
        }
        let drives: Vec<Live<'_>> = drives.collect();
        for (number, live) in drives.iter().enumerate() {
            let is_new = latest.len() <= number;
            if !is_new && (injected.contains(&number) || !self.late.contains(&number)) {
                continue;
            }
            self.late.remove(&number);
            let snapshot = Snapshot::of(live, latest.get(number));
            match latest.get_mut(number) {
                Some(before) => *before = snapshot,
                None => latest.push(snapshot),
            }
            for (_, monitor) in &mut *waits {
                monitor.observe(number, time, live);
            }
        }
        trace.take_tick(time, drives.iter().map(|live| live as &dyn Observed));
    }
}

#[cfg(test)]
mod tests {
    use virtual_drive::drive::Drive;
    use virtual_drive::model::AKD;

    use super::*;

    #[test]
    fn what_changes_while_another_thread_looks_is_taken_by_the_next_look() {
        let (trace, drive) = (HostTrace::default(), Drive::new(&AKD));
        let live = |connected| {
            std::iter::once(Live {
                drive: &drive,
                connected,
            })
        };
        let connected = || trace.state(0).unwrap().connected();
        let mut keeper = Keeper::begin(trace.clone(), Instant::ZERO, 1, ["akd-1"].into_iter(), 1 << 20);
        keeper.look(Instant::ZERO, live(None), &[]);
        assert!(connected().is_none() && !keeper.is_behind());
        let looks = trace.locked();
        keeper.look(Instant::from_millis(1), live(Some(true)), &[0]);
        drop(looks);
        assert!(connected().is_none() && keeper.is_behind());
        // the drive is idle now: nothing happens to it
        keeper.look(Instant::from_millis(2), live(Some(true)), &[]);
        assert!(connected() == Some(true) && !keeper.is_behind());
    }
}
