//! Those who watch drives that run on a network: the checks of expectations, and the trace. The clock of the checks starts with the
//! first connection of a controller: before that nothing drives the plant.

use std::collections::BTreeMap;
use std::sync::Arc;

use network::ethernet::Runner;
use network::host::StationId;
use profile::catalogue::Catalogue;
use profinet::Instant;
use virtual_drive::station::StationEvent;

use super::kept::{HostTrace, Keeper};
use crate::event::Unit;
use crate::expect::{Expectation, ExpectationResult, Live, Monitor, Outcome};
use crate::trace::{Event, EventKind};

/// Checks what is expected of the drives of a simulation.
#[derive(Debug)]
pub(super) struct Expected {
    expectations: Vec<Expectation>,
    seed: u64,
    /// In the order of the plant.
    drives: Vec<Drive>,
    numbers: BTreeMap<StationId, usize>,
    /// The checks and the start of their clock; `None` before the first connection.
    running: Option<(Instant, Monitor)>,
    /// No drive was looked at since the clock started.
    fresh: bool,
    /// The trace, where one is kept.
    keeper: Option<Keeper>,
}

#[derive(Debug)]
struct Drive {
    id: StationId,
    name: Arc<str>,
    /// Whether a controller exchanges data with it; `None` before the first one did.
    connected: Option<bool>,
}

impl Expected {
    pub fn new(expectations: Vec<Expectation>, seed: u64) -> Self {
        Self {
            expectations,
            seed,
            drives: Vec::new(),
            numbers: BTreeMap::new(),
            running: None,
            fresh: false,
            keeper: None,
        }
    }

    /// Keeps a trace of the drives that were added, of about `limit` octets at most.
    pub fn keep(&mut self, kept: HostTrace, limit: usize, start: Instant, runner: &Runner) {
        let names = self.drives.iter().map(|drive| &*drive.name);
        let mut keeper = Keeper::begin(kept, start, self.seed, names, limit);
        keeper.look(start, self.seen(runner), &[]);
        self.keeper = Some(keeper);
    }

    /// Returns each drive as it is now, in the order of the plant.
    fn seen<'r>(&self, runner: &'r Runner) -> impl Iterator<Item = Live<'r>> {
        self.drives.iter().filter_map(|drive| {
            let unit = runner.station::<Unit>(drive.id)?;
            Some(Live {
                drive: unit.inner().endpoint().drive(),
                connected: drive.connected,
            })
        })
    }

    /// Adds the next drive of the plant.
    pub fn add(&mut self, id: StationId, name: &Arc<str>) {
        self.numbers.insert(id, self.drives.len());
        self.drives.push(Drive {
            id,
            name: Arc::clone(name),
            connected: None,
        });
    }

    /// Takes an event of a station.
    pub fn take(&mut self, id: StationId, at: Instant, event: &StationEvent, catalogue: &Catalogue) {
        if self.expectations.is_empty() && self.keeper.is_none() {
            return;
        }
        let number = self.numbers.get(&id).copied();
        if let Some(drive) = number.and_then(|number| self.drives.get_mut(number)) {
            match event {
                StationEvent::Exchanging { .. } => drive.connected = Some(true),
                StationEvent::Disconnected { .. } => drive.connected = Some(false),
                _ => {}
            }
        }
        let begins = matches!(event, StationEvent::Connected { controller: true, .. });
        if begins && self.running.is_none() && !self.expectations.is_empty() {
            let monitor = Monitor::new(&self.expectations, self.drives.len(), self.seed);
            self.running = Some((at, monitor));
            self.fresh = true;
        }
        if let Some(kind) = EventKind::of_station(event, catalogue) {
            self.note(id, at, kind);
        }
    }

    /// Takes something else that happened to a drive.
    pub fn note(&mut self, id: StationId, at: Instant, kind: EventKind) {
        let number = self.numbers.get(&id).copied();
        let drive = number.and_then(|number| Some((number, self.drives.get(number)?)));
        let Some((number, drive)) = drive else {
            return;
        };
        if let Some((start, monitor)) = &mut self.running {
            monitor.note(number, &Event::new(at - *start, &drive.name, kind.clone()));
        }
        if let Some(keeper) = &mut self.keeper {
            keeper.note(number, Event::new(keeper.time(at), &drive.name, kind));
        }
    }

    /// Whether the trace has to be looked after soon, even if nothing happens.
    pub fn is_behind(&self) -> bool {
        self.keeper.as_ref().is_some_and(Keeper::is_behind)
    }

    /// Looks at the drives to which something happened in this turn; at all of them when the clock has just started.
    pub fn look(&mut self, at: Instant, runner: &Runner) {
        if let Some(mut keeper) = self.keeper.take() {
            if keeper.is_behind() || !runner.touched().is_empty() {
                let touched = runner
                    .touched()
                    .iter()
                    .filter_map(|id| self.numbers.get(id).copied());
                let touched: Vec<usize> = touched.collect();
                keeper.look(at, self.seen(runner), &touched);
            }
            self.keeper = Some(keeper);
        }
        let Some((start, monitor)) = &mut self.running else {
            return;
        };
        let all = self.drives.iter().map(|drive| drive.id);
        let (at, ids): (Instant, Vec<StationId>) = if std::mem::take(&mut self.fresh) {
            (*start, all.collect())
        } else {
            (at, runner.touched().to_vec())
        };
        for id in ids {
            let number = self.numbers.get(&id).copied();
            let drive = number.and_then(|number| Some((number, self.drives.get(number)?)));
            if let (Some((number, drive)), Some(unit)) = (drive, runner.station::<Unit>(id)) {
                let live = Live {
                    drive: unit.inner().endpoint().drive(),
                    connected: drive.connected,
                };
                monitor.observe(number, at - *start, &live);
            }
        }
    }

    /// Ends the checks; returns what came of each expectation for each of its drives.
    pub fn finish(&mut self, at: Instant) -> Vec<ExpectationResult> {
        let drives = &self.drives;
        let name = |number: usize| drives.get(number).map_or("", |drive| &*drive.name);
        if let Some((start, monitor)) = self.running.take() {
            return monitor.finish(at - start, name);
        }
        let monitor = Monitor::new(&self.expectations, drives.len(), self.seed);
        let mut results = monitor.finish(std::time::Duration::ZERO, name);
        for result in &mut results {
            result.outcome = Outcome::NeverStarted;
            result.actual = "no controller connected".to_owned();
        }
        results
    }
}
