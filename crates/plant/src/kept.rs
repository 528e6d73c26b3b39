//! A run that is kept: its events, and what each drive was like at each tick.

use std::time::Duration;

use crate::expect::{Expectation, ExpectationResult, Monitor, Observed};
use crate::snapshot::Snapshot;
use crate::trace::Event;

/// A run of a plant that is kept, made by [`World::keep_trace`](crate::World::keep_trace).
///
/// It has every event, and of each drive a snapshot of every tick at which something of it changed. Between two
/// snapshots the drive was as the first says. So expectations can be checked afterwards, with the results that they
/// would have had while it ran.
///
/// It is bounded: what does not fit is not kept, and the trace [ends](Self::cut) at the tick before, as a whole.
///
/// ```
/// use std::time::Duration;
/// use profidrive_plant::{Observed, PlantPlan, Trace, World};
/// use profinet::Instant;
/// let plant: PlantPlan = "[[drive]]\nname = \"akd-1\"\nevent = [{ at = \"2s\", do = \"fault=439\" }]".parse()?;
/// let mut world = World::new(&plant)?;
/// world.keep_trace(Trace::USUAL_LIMIT);
/// world.run_until(Instant::from_millis(3000), &mut drop);
/// let trace = world.take_trace().unwrap();
/// let results = trace.expect(&plant.expectations_of("{ never = true, fault = 439 }")?)?;
/// assert!(!results[0].is_met());
/// let (_, drive) = trace.at(Duration::from_secs(1)).unwrap().next().unwrap();
/// assert!(drive.messages(false).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    seed: u64,
    limit: usize,
    /// Octets that are in use.
    used: usize,
    /// The time of each tick.
    ticks: Vec<Duration>,
    /// Each event with the number of the tick that it came before.
    events: Vec<(usize, Event)>,
    drives: Vec<Kept>,
    end: Duration,
    cut: bool,
    digest: u64,
}

/// What is kept of one drive.
#[derive(Debug, Clone, PartialEq)]
struct Kept {
    name: String,
    /// Each snapshot with the number of its tick.
    snapshots: Vec<(usize, Snapshot)>,
}

/// Something that a trace cannot answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// An expectation looks at a parameter.
    #[error(
        "`{name}` has a condition on a parameter: a trace keeps no parameters, so it can only be checked while the plant runs"
    )]
    Parameter {
        /// Name of the expectation.
        name: String,
    },
    /// What is measured is not kept.
    #[error("`{what}`: the trace has no room after {} s; measure a shorter run", .time.as_secs_f64())]
    NoRoom {
        /// What is measured.
        what: String,
        /// Until when it is kept.
        time: Duration,
    },
    /// An expectation is one of another plant.
    #[error("`{name}` is an expectation of another plant: this one has {drives} drives")]
    OtherPlant {
        /// Name of the expectation.
        name: String,
        /// How many drives the trace has.
        drives: usize,
    },
}

/// What a trace has of one drive.
#[derive(Debug, Clone, Copy)]
pub struct DriveTrace<'a> {
    trace: &'a Trace,
    drive: &'a Kept,
}

impl Trace {
    /// A limit for usual runs, about so many octets: minutes of a few drives that move, hours at rest.
    pub const USUAL_LIMIT: usize = 256 << 20;

    /// Creates a trace at the start of a run; `limit` is about the most that it takes, in octets.
    pub(crate) fn new<'a>(seed: u64, names: impl Iterator<Item = &'a str>, limit: usize) -> Self {
        let drives = names.map(|name| Kept {
            name: name.to_owned(),
            snapshots: Vec::new(),
        });
        Self {
            seed,
            limit,
            used: 0,
            ticks: Vec::new(),
            events: Vec::new(),
            drives: drives.collect(),
            end: Duration::ZERO,
            cut: false,
            digest: 0,
        }
    }

    /// Takes an event, which belongs to the next tick.
    pub(crate) fn take_event(&mut self, event: &Event) {
        if self.cut {
            return;
        }
        // other texts of an event are short, a name at most
        self.used += size_of::<(usize, Event)>() + event.drive.len();
        self.events.push((self.ticks.len(), event.clone()));
    }

    /// Takes what the drives are like at `now`, in their order.
    pub(crate) fn take_tick<'a>(&mut self, now: Duration, drives: impl Iterator<Item = &'a dyn Observed>) {
        if self.cut {
            return;
        }
        let tick = self.ticks.len();
        let kept: Vec<usize> = self.drives.iter().map(|drive| drive.snapshots.len()).collect();
        for (drive, seen) in self.drives.iter_mut().zip(drives) {
            let last = drive.snapshots.last().map(|(_, snapshot)| snapshot);
            let snapshot = Snapshot::of(seen, last);
            if last != Some(&snapshot) {
                self.used += size_of::<usize>() + snapshot.size(last);
                drive.snapshots.push((tick, snapshot));
            }
        }
        self.used += size_of::<Duration>();
        if self.used > self.limit {
            // the tick that does not fit is taken back as a whole
            for (drive, kept) in self.drives.iter_mut().zip(kept) {
                drive.snapshots.truncate(kept);
            }
            self.events.retain(|(at, _)| *at < tick);
            self.cut = true;
            return;
        }
        self.ticks.push(now);
        self.end = now;
    }

    /// Ends at `now`: nothing changed since the last tick. The run has this digest until then.
    pub(crate) const fn end_at(&mut self, now: Duration, digest: u64) {
        self.digest = digest;
        if !self.cut {
            self.end = now;
        }
    }

    /// Returns the seed of the run.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the time from the start of the plant to the end of the trace.
    #[must_use]
    pub const fn end(&self) -> Duration {
        self.end
    }

    /// Returns the time of the last tick that is kept when the run went on but its trace was full; `None` for a trace
    /// that has the whole run.
    #[must_use]
    pub fn cut(&self) -> Option<Duration> {
        self.cut.then_some(self.end)
    }

    /// Returns the events, in the order in which they happened.
    pub fn events(&self) -> impl DoubleEndedIterator<Item = &Event> {
        self.events.iter().map(|(_, event)| event)
    }

    /// Returns what there is of the drive of this name; `None` for a drive that the plant does not have.
    #[must_use]
    pub fn of(&self, drive: &str) -> Option<DriveTrace<'_>> {
        self.drives().find(|found| found.name() == drive)
    }

    /// Returns what there is of each drive, in the order of the plant.
    pub fn drives(&self) -> impl Iterator<Item = DriveTrace<'_>> {
        self.drives.iter().map(|drive| DriveTrace { trace: self, drive })
    }

    /// Returns each drive by name as it was at a time, after everything that happened until then; `None` for a time
    /// before or after the trace.
    #[must_use]
    pub fn at(&self, time: Duration) -> Option<impl Iterator<Item = (&str, &Snapshot)>> {
        let begin = *self.ticks.first()?;
        let inside = (begin..=self.end).contains(&time);
        inside.then(|| {
            self.drives()
                .filter_map(move |drive| Some((drive.drive.name.as_str(), drive.at(time)?)))
        })
    }

    /// Checks expectations; the results are those that a check while it ran would have had. At the end of a trace that
    /// was [cut](Self::cut) the run counts as over.
    ///
    /// # Errors
    /// For an expectation with a condition on a parameter, which a trace does not keep, and for one of another plant.
    pub fn expect(&self, expectations: &[Expectation]) -> Result<Vec<ExpectationResult>, TraceError> {
        for expectation in expectations {
            let name = || expectation.name().to_owned();
            if expectation.reads_parameters() {
                return Err(TraceError::Parameter { name: name() });
            }
            if expectation.drives().any(|drive| drive >= self.drives.len()) {
                return Err(TraceError::OtherPlant {
                    name: name(),
                    drives: self.drives.len(),
                });
            }
        }
        let mut monitor = Monitor::new(expectations, self.drives.len(), self.seed);
        let mut events = self.events.iter().peekable();
        let mut rest: Vec<_> = self
            .drives
            .iter()
            .map(|drive| drive.snapshots.iter().peekable())
            .collect();
        let mut present: Vec<Option<&Snapshot>> = vec![None; self.drives.len()];
        for (tick, time) in self.ticks.iter().enumerate() {
            while let Some((_, event)) = events.next_if(|(at, _)| *at <= tick) {
                let named = |drive: &Kept| drive.name == event.drive;
                if let Some(drive) = self.drives.iter().position(named) {
                    monitor.note(drive, event);
                }
            }
            for (drive, (rest, present)) in rest.iter_mut().zip(&mut present).enumerate() {
                if let Some((_, snapshot)) = rest.next_if(|(at, _)| *at <= tick) {
                    *present = Some(snapshot);
                }
                if let Some(snapshot) = *present {
                    monitor.observe(drive, *time, snapshot);
                }
            }
            if monitor.is_decided() {
                break;
            }
        }
        // what happened after the last tick is of the end
        if !monitor.is_decided() {
            for (_, event) in events {
                let named = |drive: &Kept| drive.name == event.drive;
                if let Some(drive) = self.drives.iter().position(named) {
                    monitor.note(drive, event);
                }
            }
        }
        let name = |drive: usize| self.drives.get(drive).map_or("", |drive| drive.name.as_str());
        Ok(monitor.finish(self.end, name))
    }

    /// Returns the number of the run that [`World::digest`](crate::World::digest) had when the trace was taken: that of the whole
    /// run, whatever was [cut](Self::cut).
    #[must_use]
    pub const fn digest(&self) -> u64 {
        self.digest
    }
}

impl<'a> DriveTrace<'a> {
    /// Returns the name of the drive.
    #[must_use]
    pub fn name(&self) -> &'a str {
        &self.drive.name
    }

    /// Returns its events.
    pub fn events(&self) -> impl Iterator<Item = &'a Event> + use<'a> {
        let drive = self.drive;
        let events = self.trace.events.iter().map(|(_, event)| event);
        events.filter(move |event| event.drive == drive.name)
    }

    /// Returns what it was like at each tick at which something of it changed, with the time of the tick.
    pub fn snapshots(&self) -> impl ExactSizeIterator<Item = (Duration, &'a Snapshot)> + use<'a> {
        let ticks = &self.trace.ticks;
        let snapshots = self.drive.snapshots.iter();
        snapshots.map(move |(tick, snapshot)| (ticks.get(*tick).copied().unwrap_or_default(), snapshot))
    }

    /// Returns what it was like at a time, after everything that happened until then; `None` for a time before or after
    /// the trace.
    #[must_use]
    pub fn at(&self, time: Duration) -> Option<&'a Snapshot> {
        let ticks = self.trace.ticks.partition_point(|tick| *tick <= time);
        let snapshots = &self.drive.snapshots;
        let place = snapshots.partition_point(|(tick, _)| *tick < ticks);
        let (_, snapshot) = snapshots.get(place.checked_sub(1)?)?;
        (time <= self.trace.end).then_some(snapshot)
    }
}
