//! A plant in virtual time.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, Weak};
use std::time::{Duration, Instant as Clock};

use ::plant::{
    DriveMessage, Event, Goal, NotMet, Observed as _, ObservedQuantity, PlantEvent, PlantPlan, Snapshot,
    Trace as Kept, WorldError,
};
use network::files::create;
use network::pcap::Writer;
use profidrive::machine::Machine;
use profidrive::{Instant, Running};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::attention::LOOK;
use crate::errors::{Failure, explained, of_world};
use crate::joined::{Joined, locked};
use crate::log;
use crate::network::Network;
use crate::process::Process;
use crate::table::unwritten;
use crate::time::{Span, seconds};
use crate::trace::{Cell, Trace, event, fill, goal_of, lost, results};

/// Virtual time that passes at least between two looks at a goal while something has joined.
const TICK: Duration = Duration::from_micros(250);

/// Virtual time that passes at least between two looks at the signals of Python.
const STRIDE: Duration = Duration::from_millis(100);

/// A plant that runs, with its observers.
pub struct Held {
    pub running: Running,
    /// The trace that was handed out last, as long as it is in use.
    newest: Mutex<Weak<Cell>>,
    /// The network that has joined it, from the first use on.
    joined: Mutex<Option<Arc<Joined>>>,
    /// What its network knows of the machine.
    pub machine: Option<Machine>,
    /// The process that started it.
    process: Process,
}

impl Held {
    /// Gives a trace that is still held its content before the plant goes on.
    pub fn goes_on(&self) {
        let newest = locked(&self.newest);
        if let Some(cell) = newest.upgrade() {
            fill(&cell, &self.running);
        }
    }

    /// Fails in a copy of the process.
    pub fn usable(&self) -> Result<(), Failure> {
        self.process.check("the plant was started")
    }

    /// Returns the network of the plant, which joins it first where it has not.
    pub fn joined(&self) -> Result<Arc<Joined>, Failure> {
        self.usable()?;
        let mut joined = locked(&self.joined);
        if let Some(joined) = &*joined {
            return Ok(Arc::clone(joined));
        }
        Ok(Arc::clone(joined.insert(Joined::in_plant(self)?)))
    }

    fn passed(&self) -> Duration {
        self.running.with_world(|world| world.now() - Instant::ZERO)
    }

    /// Lets the plant go on, not longer than Python waits for its signals; returns whether it is at the end.
    fn advance(&self, end: Instant) -> PyResult<bool> {
        let joined = locked(&self.joined);
        if let Some(open) = open(joined.as_ref()) {
            drop(joined);
            // what has joined is carried along; it looks at the signals itself
            open.pass(end - self.running.with_world(|world| world.now()))?;
            return Ok(true);
        }
        // no client of another thread joins meanwhile: nothing would carry its calls
        let begin = Clock::now();
        Ok(self.running.with_world(|world| {
            while begin.elapsed() < LOOK {
                let until = (world.now() + STRIDE).min(end);
                world.run_until(until, &mut log::of_plant);
                if world.now() >= end {
                    return true;
                }
            }
            false
        }))
    }
}

impl Held {
    /// Runs until a goal is met. What has joined the plant is carried along.
    fn run_until_met(&self, goal: &Goal, timeout: Duration) -> PyResult<Result<Event, NotMet>> {
        let running = &self.running;
        let mut pursuit = running.with_world(|world| world.pursue(goal, timeout));
        let reports = pursuit.clone();
        let mut newest = None;
        let mut record = |event: Event| {
            if reports.is_reported_by(&event) {
                newest = Some(event.clone());
            }
            log::of_plant(event);
        };
        let mut looked = Clock::now();
        while let Some(time) = running.with_world(|world| world.pursues(&mut pursuit)) {
            let joined = locked(&self.joined);
            let passed = match open(joined.as_ref()) {
                // what has joined is carried along; it looks at the signals itself
                Some(open) => {
                    drop(joined);
                    open.pass(time.max(TICK))
                }
                None => {
                    running.with_world(|world| world.run_until(world.now() + time, &mut record));
                    drop(joined);
                    minds_signals(&mut looked)
                }
            };
            if let Err(raised) = passed {
                // the goal is given up, whether it was met or not
                drop(running.with_world(|world| world.end_pursuit(&pursuit, None)));
                return Err(raised);
            }
        }
        Ok(running.with_world(|world| world.end_pursuit(&pursuit, newest)))
    }
}

/// Returns the network that has joined a plant, unless it was closed.
fn open(joined: Option<&Arc<Joined>>) -> Option<Arc<Joined>> {
    joined.filter(|joined| joined.is_open()).cloned()
}

/// Fails with what a signal of Python raised, where it is time to look for one.
fn minds_signals(looked: &mut Clock) -> PyResult<()> {
    if looked.elapsed() < LOOK {
        return Ok(());
    }
    *looked = Clock::now();
    Python::attach(|py| py.check_signals())
}

/// What a drive is like, with its faults and warnings.
pub fn looks(snapshot: &Snapshot, faults: &[DriveMessage], warnings: &[DriveMessage]) -> Value {
    let number = |quantity| snapshot.quantity(quantity);
    json!({
        "state": snapshot.state().number(),
        "stw1": snapshot.stw1().0,
        "zsw1": snapshot.zsw1().0,
        "moving": snapshot.is_moving(),
        "connected": snapshot.connected(),
        "speed": number(ObservedQuantity::LoadSpeed),
        "position": number(ObservedQuantity::Position),
        "current": number(ObservedQuantity::Current),
        "torque": number(ObservedQuantity::Torque),
        "faults": faults,
        "warnings": warnings,
    })
}

/// A plant that runs when a program waits.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct World {
    held: Arc<Held>,
    capture: Option<PathBuf>,
}

impl World {
    pub fn start(
        plan: Arc<PlantPlan>,
        capture: Option<PathBuf>,
        machine: Option<Machine>,
    ) -> Result<Self, Failure> {
        let tap = capture.as_deref().map(recorder).transpose()?;
        let running = Running::start(plan).map_err(|error| explained(&error))?;
        running.with_world(|world| {
            world.keep_trace(Kept::USUAL_LIMIT);
            world.observe(log::of_plant);
            if let Some(tap) = tap {
                world.add_tap(Box::new(tap));
            }
            // expectations on parameters cannot be checked afterwards
            let plan = running.plan();
            if !plan.expectations.is_empty() {
                world.expect(&plan.expectations, plan.seed);
            }
        });
        let held = Held {
            running,
            newest: Mutex::default(),
            joined: Mutex::new(None),
            machine,
            process: Process::this(),
        };
        Ok(Self {
            held: Arc::new(held),
            capture,
        })
    }
}

impl World {
    /// The plant, in the process that started it.
    fn held(&self) -> Result<&Arc<Held>, Failure> {
        self.held.usable()?;
        Ok(&self.held)
    }
}

fn recorder(path: &Path) -> Result<Writer<std::fs::File>, Failure> {
    let file = create(path).map_err(|error| unwritten(path, &std::io::Error::other(error)))?;
    Writer::new(file, "plant", Duration::ZERO).map_err(|error| unwritten(path, &error))
}

#[pymethods]
impl World {
    #[getter]
    fn now(&self, py: Python<'_>) -> PyResult<f64> {
        let held = self.held()?;
        Ok(py.detach(|| seconds(held.passed())))
    }

    #[getter]
    fn seed(&self) -> u64 {
        self.held.running.plan().seed
    }

    #[getter]
    fn drives(&self) -> Vec<String> {
        let drives = self.held.running.plan().drives.iter();
        drives.map(|drive| drive.name.clone()).collect()
    }

    /// Runs until a time since the start, or for a time.
    #[pyo3(signature = (until=None, lasts=None))]
    fn run(&self, py: Python<'_>, until: Option<Span>, lasts: Option<Span>) -> PyResult<()> {
        let held = self.held()?;
        py.detach(|| held.goes_on());
        let now = py.detach(|| self.held.passed());
        let end = match (until, lasts) {
            (Some(until), None) => until.read()?,
            (None, Some(lasts)) => now + lasts.read()?,
            (None, None) => self.held.running.plan().duration.ok_or_else(|| {
                Failure::usage("how long? The plant has no `duration`: give a time to run until, or for")
            })?,
            (Some(_), Some(_)) => {
                return Err(Failure::usage("a run goes on until a time or for a time, not both").into());
            }
        };
        if end < now {
            let text = format!(
                "the plant is at {} s already and cannot go back to {} s",
                seconds(now),
                seconds(end)
            );
            return Err(Failure::usage(text).into());
        }
        while !py.detach(|| self.held.advance(Instant::ZERO + end))? {
            py.check_signals()?;
        }
        Ok(())
    }

    /// Runs until conditions hold of a drive; returns the event that reports it, as JSON.
    fn run_until(&self, py: Python<'_>, goal: &str, timeout: Span) -> PyResult<String> {
        let goal = goal_of(self.held.running.plan(), goal)?;
        let timeout = timeout.read()?;
        let held = self.held()?;
        let met = py.detach(|| {
            held.goes_on();
            held.run_until_met(&goal, timeout)
        })?;
        let met = met.map_err(|error| lost(&error, &error.0))?;
        Ok(event(&met)?)
    }

    #[pyo3(signature = (drive, action, lasts=None))]
    fn inject(&self, py: Python<'_>, drive: &str, action: &str, lasts: Option<Span>) -> PyResult<()> {
        let action: PlantEvent = action.parse().map_err(|error| explained(&error))?;
        let lasts = lasts.map(|lasts| lasts.read()).transpose()?;
        let held = self.held()?;
        let done = py.detach(|| {
            held.running
                .with_world(|world| world.inject(drive, action, lasts))
        });
        Ok(done.map_err(|error| of_world(&error))?)
    }

    /// What a drive is like now, as JSON.
    fn look(&self, py: Python<'_>, drive: &str) -> PyResult<String> {
        let held = self.held()?;
        let seen = py.detach(|| {
            held.running.with_world(|world| {
                let snapshot = world.snapshot(drive)?;
                let messages = |warnings| world.messages(drive, warnings);
                Ok::<_, WorldError>(looks(&snapshot, &messages(false)?, &messages(true)?))
            })
        });
        Ok(seen.map_err(|error| of_world(&error))?.to_string())
    }

    fn read(&self, py: Python<'_>, drive: &str, parameter: &str) -> PyResult<String> {
        let held = self.held()?;
        let reading = py.detach(|| held.running.with_world(|world| world.parameter(drive, parameter)));
        let reading = reading.map_err(|error| of_world(&error))?;
        Ok(serde_json::to_string(&reading).map_err(|error| Failure::internal(&error))?)
    }

    fn write(&self, py: Python<'_>, drive: &str, parameter: &str, value: &str) -> PyResult<String> {
        let held = self.held()?;
        let written = py.detach(|| {
            held.running
                .with_world(|world| world.set_parameter(drive, parameter, value))
        });
        let written = written.map_err(|error| of_world(&error))?;
        Ok(serde_json::to_string(&written).map_err(|error| Failure::internal(&error))?)
    }

    /// What has happened until now.
    fn trace(&self) -> PyResult<Trace> {
        let mut newest = locked(&self.held()?.newest);
        let cell = newest.upgrade().filter(|cell| cell.get().is_none());
        let cell = cell.unwrap_or_default();
        *newest = Arc::downgrade(&cell);
        Ok(Trace::of(&self.held.running, cell))
    }

    /// The network of the plant.
    fn network(&self) -> Network {
        Network::of_plant(Arc::clone(&self.held))
    }

    /// Ends the checks of the expectations of the plant file; returns each result as JSON with its text.
    fn finish_expectations(&self, py: Python<'_>) -> PyResult<Vec<(String, String)>> {
        let held = self.held()?;
        let found = py.detach(|| held.running.with_world(|world| world.finish_expectations()));
        Ok(results(&found)?)
    }

    /// Completes the file with the frames.
    fn finish_capture(&self, py: Python<'_>) -> PyResult<()> {
        let held = self.held()?;
        let done = py.detach(|| held.running.with_world(|world| world.finish_taps()));
        let path = self.capture.clone().unwrap_or_default();
        Ok(done.map_err(|error| unwritten(&path, &error))?)
    }
}
