//! The checks of expectations while drives run on a network. Their clock starts with the first connection of a
//! controller: before that nothing drives the plant.

use std::collections::BTreeMap;
use std::sync::Arc;

use network::ethernet::Runner;
use network::host::StationId;
use profile::catalogue::Catalogue;
use profinet::Instant;
use virtual_drive::station::StationEvent;

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
        }
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
        if self.expectations.is_empty() {
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
        if matches!(event, StationEvent::Connected { controller: true, .. }) && self.running.is_none() {
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
        if let (Some((start, monitor)), Some((number, drive))) = (&mut self.running, drive) {
            monitor.note(number, &Event::new(at - *start, &drive.name, kind));
        }
    }

    /// Looks at the drives to which something happened in this turn; at all of them when the clock has just started.
    pub fn look(&mut self, at: Instant, runner: &Runner) {
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
