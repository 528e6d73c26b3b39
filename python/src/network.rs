//! A network that has joined a plant: the calls of a client in virtual time.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant as Clock};

use client::{Drive, Error};
use profidrive::parameters::{self, Write};
use profidrive::report::PlainWording;
use profidrive::{Access, Opening, Wait as _, inspection};
use profile::notation::ParameterReference;
use profile::value::{Assignment, ParameterProblem};
use pyo3::prelude::*;
use serde_json::json;

use crate::errors::{Failure, explained, of_parameter};
use crate::trace::document;
use crate::world::Held;

/// Time of this computer between two looks at the signals of Python.
const LOOK: Duration = Duration::from_millis(50);

/// What a signal raised in Python while a call waited.
type Caught = Arc<Mutex<Option<PyErr>>>;

/// A network in a plant, with the drives that were found there.
pub struct Joined {
    network: profidrive::Network,
    drives: HashMap<String, Drive>,
    caught: Caught,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Joined {
    /// Joins a plant.
    pub fn new(held: &Held) -> Result<Self, Failure> {
        let mut network = held.running.join(None).map_err(|error| explained(&error))?;
        let caught = Caught::default();
        let (signal, mut looked) = (Arc::clone(&caught), Clock::now());
        network.interrupt_with(move || {
            if looked.elapsed() >= LOOK {
                looked = Clock::now();
                if let Err(raised) = Python::attach(|py| py.check_signals()) {
                    *locked(&signal) = Some(raised);
                }
            }
            // until the call has ended with it
            locked(&signal).is_some()
        });
        Ok(Self {
            network,
            drives: HashMap::new(),
            caught,
        })
    }

    /// Lets time pass; the connections go on.
    pub fn pass(&mut self, time: Duration) -> PyResult<()> {
        let passed = self.network.pass(time).wait();
        self.raised()?;
        Ok(passed.map_err(|error| explained(&error))?)
    }

    /// Fails with what a signal raised.
    fn raised(&self) -> PyResult<()> {
        locked(&self.caught).take().map_or(Ok(()), Err)
    }

    fn drive(&mut self, name: &str) -> Result<(&mut profidrive::Network, &mut Drive), Failure> {
        if !self.drives.contains_key(name) {
            let address = name
                .parse()
                .map_err(|error| explained(&profidrive::DriveError::from(error)))?;
            let opening = Opening::new(Access::Cyclic);
            let found = opening.find(&mut self.network, &address, &mut |_| {}).wait();
            let found = found.map_err(|error| explained(&error))?;
            self.drives.insert(name.to_owned(), found);
        }
        let drive = self.drives.get_mut(name);
        let drive = drive.ok_or_else(|| Failure::internal(&"the drive is not there"))?;
        Ok((&mut self.network, drive))
    }
}

/// The network of a world.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Network {
    held: Arc<Held>,
}

impl Network {
    pub const fn new(held: Arc<Held>) -> Self {
        Self { held }
    }

    /// Carries out a call for a drive.
    fn call<T: Send>(
        &self,
        py: Python<'_>,
        drive: &str,
        work: impl FnOnce(&mut profidrive::Network, &mut Drive) -> Result<T, Failure> + Send,
    ) -> PyResult<T> {
        py.detach(|| {
            self.held.goes_on();
            self.held.joined(|joined| {
                let result = joined
                    .drive(drive)
                    .and_then(|(network, drive)| work(network, drive));
                // the error of an interrupted call is that of the signal
                joined.raised()?;
                Ok(result?)
            })
        })
    }
}

fn references(names: &[String]) -> Result<Vec<ParameterReference>, Failure> {
    let read = |name: &String| {
        let reference = name.parse::<ParameterReference>();
        reference.map_err(|error| explained(&Error::from(ParameterProblem::from(error))))
    };
    names.iter().map(read).collect()
}

#[pymethods]
impl Network {
    /// Reads parameters; a report as JSON.
    fn read(&self, py: Python<'_>, drive: &str, names: Vec<String>) -> PyResult<String> {
        let wanted = references(&names)?;
        self.call(py, drive, |network, drive| {
            let values = parameters::read(network, drive, &wanted).wait();
            let values = values.map_err(|error| explained(&error))?;
            match values.problems(&drive.label()).first() {
                Some(problem) => Err(of_parameter(problem, &drive.label())),
                None => document(&values.report(drive, &PlainWording)),
            }
        })
    }

    /// Writes parameters in this order; a report as JSON.
    fn write(
        &self,
        py: Python<'_>,
        drive: &str,
        values: Vec<(String, String)>,
        save: bool,
        dry_run: bool,
    ) -> PyResult<String> {
        let assignments = values.iter().map(|(name, value)| {
            let assignment = format!("{name}={value}").parse::<Assignment>();
            assignment.map_err(|problem| of_parameter(&Error::from(problem), drive))
        });
        let assignments: Vec<Assignment> = assignments.collect::<Result<_, _>>()?;
        self.call(py, drive, |network, drive| {
            let label = drive.label();
            let written = parameters::write(network, drive, &assignments, Write { save, dry_run }).wait();
            let written = written.map_err(|error| of_parameter(&error, &label))?;
            let report = written.report(drive, &PlainWording);
            let problems = written.problems(&label);
            let Some(first) = problems.first() else {
                return document(&report);
            };
            // one value alone was refused as a whole
            if let (parameters::ParameterError::Client(error), [_], [_]) =
                (first, &problems[..], &assignments[..])
            {
                return Err(of_parameter(error, &label));
            }
            Err(explained(first)
                .of_kind(written.outcome().kind())
                .with(json!({ "drive": label, "report": report })))
        })
    }

    /// How a drive is and why it does not run; a report as JSON.
    fn status(&self, py: Python<'_>, drive: &str) -> PyResult<String> {
        self.call(py, drive, |network, drive| {
            let status = inspection::status(network, drive, &PlainWording).wait();
            document(&status.map_err(|error| explained(&error))?.report)
        })
    }

    /// Faults and warnings; a report as JSON.
    fn faults(&self, py: Python<'_>, drive: &str, history: bool) -> PyResult<String> {
        self.call(py, drive, |network, drive| {
            let faults = inspection::faults(network, drive, history).wait();
            document(&faults.map_err(|error| explained(&error))?)
        })
    }
}
