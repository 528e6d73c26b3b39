//! Networks, real ones and those of plants: the calls of a client.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak, mpsc};
use std::time::{Duration, Instant as Clock};

use client::{Drive, DriveAddress, Error, StopWay};
use profidrive::motion;
use profidrive::parameters::{self, Write};
use profidrive::{Access, Caller, Opening, StopRequests, inspection};
use profile::notation::ParameterReference;
use profile::value::{Assignment, ParameterProblem};
use pyo3::prelude::*;
use serde_json::json;

use crate::attention::{LOOK, Signals, wait};
use crate::axis::{Axis, Wanted};
use crate::errors::{Failure, closed, explained, of_client, of_drive, of_motion, of_open};
use crate::time::Span;
use crate::trace::document;
use crate::words::Calls;
use crate::world::Held;

/// How long a stop may take that is not that of an axis under control.
const STOP: Duration = Duration::from_secs(10);

/// The networks that are open.
static OPEN: Mutex<Vec<Weak<Joined>>> = Mutex::new(Vec::new());

pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A network that is open, with the drives that were found there.
pub struct Joined {
    network: Mutex<Option<profidrive::Network>>,
    caller: Caller,
    opening: Opening,
    drives: Mutex<HashMap<String, Drive>>,
    /// The process that opened it: a copy of that has no thread that carries it.
    process: u32,
}

impl Joined {
    fn new(network: profidrive::Network, opening: Opening) -> Arc<Self> {
        let joined = Arc::new(Self {
            caller: Caller::clone(&network),
            network: Mutex::new(Some(network)),
            opening,
            drives: Mutex::default(),
            process: std::process::id(),
        });
        let mut open = locked(&OPEN);
        open.retain(|one| one.strong_count() > 0);
        open.push(Arc::downgrade(&joined));
        joined
    }

    /// Joins a plant.
    pub fn in_plant(held: &Held) -> Result<Arc<Self>, Failure> {
        let network = held.running.join(None).map_err(|error| of_open(&error))?;
        Ok(Self::new(network, Opening::new(Access::Cyclic)))
    }

    /// Fails where the network cannot be used any more.
    pub fn usable(&self) -> Result<(), Failure> {
        if self.process != std::process::id() {
            return Err(closed(
                "the network was opened by another process, of which this one is a copy (fork)",
            ));
        }
        Ok(())
    }

    /// Returns whether it was not closed yet.
    pub fn is_open(&self) -> bool {
        locked(&self.network).is_some()
    }

    /// Returns a caller that obeys these requests.
    pub fn caller(&self, requests: &StopRequests) -> Caller {
        let mut caller = self.caller.clone();
        caller.obey(requests);
        caller
    }

    /// Lets time pass; the connections go on.
    pub fn pass(&self, time: Duration) -> PyResult<()> {
        let requests = StopRequests::default();
        let mut caller = self.caller(&requests);
        wait(&requests, async {
            let passed = caller.pass(time).await;
            passed.map_err(|error| of_client(&error))
        })
    }

    /// Returns a drive, which is searched at its first use.
    async fn drive(&self, caller: &mut Caller, name: &str) -> Result<Drive, Failure> {
        if let Some(drive) = locked(&self.drives).get(name) {
            return Ok(drive.clone());
        }
        let address = name
            .parse()
            .map_err(|error| explained(&profidrive::DriveError::from(error)))?;
        let found = self.opening.find(caller, &address, &mut |_| {}).await;
        found.map_err(|error| of_drive(&error))
    }

    /// Leaves the network: every axis is brought to rest and released. Signals make that a quick stop, then end the wait for it,
    /// and so does the end of the time.
    fn close(&self, limit: Option<Duration>) -> PyResult<()> {
        let Some(network) = locked(&self.network).take() else {
            return Ok(());
        };
        let (done, ended) = mpsc::channel();
        std::thread::spawn(move || {
            drop(network);
            // nobody listens where the time is over
            let _ = done.send(());
        });
        let requests = StopRequests::default();
        let mut signals = Signals::new(&requests);
        let begin = Clock::now();
        let mut hurried = false;
        while ended.recv_timeout(LOOK) == Err(mpsc::RecvTimeoutError::Timeout) {
            signals.look();
            if requests.is_urgent() && !hurried {
                hurried = true;
                self.caller.stop_all(true);
            }
            if requests.is_final() || limit.is_some_and(|limit| begin.elapsed() >= limit) {
                break;
            }
        }
        signals.raised()
    }
}

impl Drop for Joined {
    fn drop(&mut self) {
        let network = self
            .network
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        if self.process != std::process::id() {
            // a copy of the process has no thread that could end it
            std::mem::forget(network);
            return;
        }
        // nobody else waits meanwhile; a Python that ends has closed it before
        let _ = Python::try_attach(|py| py.detach(|| drop(network)));
    }
}

/// Leaves all networks before Python ends.
#[pyfunction]
pub fn leave_all(py: Python<'_>, seconds: f64) -> PyResult<()> {
    let open: Vec<_> = locked(&OPEN).iter().filter_map(Weak::upgrade).collect();
    py.detach(|| {
        let begin = Clock::now();
        for joined in open.into_iter().filter(|joined| joined.usable().is_ok()) {
            let limit = Duration::try_from_secs_f64(seconds).unwrap_or_default();
            joined.close(Some(limit.saturating_sub(begin.elapsed())))?;
        }
        Ok(())
    })
}

/// Opens a network interface, the only one there is where none is named, or the serial line of a drive. With `ip` only UDP.
#[pyfunction]
pub fn open(py: Python<'_>, interface: Option<&str>, by_ip: bool) -> PyResult<Network> {
    let opened = py.detach(|| match interface {
        Some(line) if line.contains(':') => {
            let address: DriveAddress = line
                .parse()
                .map_err(|error| explained(&profidrive::DriveError::from(error)))?;
            let opening = Opening::new(Access::Cyclic);
            let network = opening.open_to(&address).map_err(|error| of_open(&error))?;
            Ok::<_, Failure>(Joined::new(network, opening))
        }
        interface => {
            let access = if by_ip { Access::Records } else { Access::Cyclic };
            // without permission for raw sockets drives are left that are given by their IP address
            let opening = Opening::new(access).by_ip(by_ip || interface.is_none());
            let opening = match interface {
                Some(name) => opening.on(name),
                None => opening,
            };
            let network = opening.clone().open().map_err(|error| of_open(&error))?;
            Ok(Joined::new(network, opening))
        }
    });
    Ok(Network(Source::Real(opened?)))
}

/// A network in use.
#[derive(Clone)]
pub struct Place {
    pub joined: Arc<Joined>,
    /// The plant that it is in.
    held: Option<Arc<Held>>,
}

impl Place {
    /// A plant is about to go on.
    pub fn goes_on(&self) {
        if let Some(held) = &self.held {
            held.goes_on();
        }
    }
}

enum Source {
    Real(Arc<Joined>),
    Plant(Arc<Held>),
}

/// A network.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Network(Source);

impl Network {
    pub const fn of_plant(held: Arc<Held>) -> Self {
        Self(Source::Plant(held))
    }

    fn place(&self) -> Result<Place, Failure> {
        Ok(match &self.0 {
            Source::Real(joined) => {
                joined.usable()?;
                Place {
                    joined: Arc::clone(joined),
                    held: None,
                }
            }
            Source::Plant(held) => Place {
                joined: held.joined()?,
                held: Some(Arc::clone(held)),
            },
        })
    }

    /// Carries out a call for a drive.
    fn call<T: Send>(
        &self,
        py: Python<'_>,
        name: &str,
        work: impl AsyncFnOnce(&mut Caller, &mut Drive) -> Result<T, Failure> + Send,
    ) -> PyResult<T> {
        py.detach(|| {
            let place = self.place()?;
            place.goes_on();
            let requests = StopRequests::default();
            let mut caller = place.joined.caller(&requests);
            wait(&requests, async {
                let found = place.joined.drive(&mut caller, name).await;
                let mut drive = found.map_err(|failure| failure.about(name))?;
                let result = work(&mut caller, &mut drive).await;
                let result = result.map_err(|failure| failure.about(&drive.label()));
                // with what was read of it
                locked(&place.joined.drives).insert(name.to_owned(), drive);
                result
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
        self.call(py, drive, async |caller, drive| {
            let values = parameters::read(caller, drive, &wanted).await;
            let values = values.map_err(|error| of_client(&error))?;
            match values.problems(&drive.label()).first() {
                Some(problem) => Err(of_client(problem)),
                None => document(&values.report(drive, &Calls)),
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
            assignment.map_err(|problem| of_client(&Error::from(problem)).about(drive))
        });
        let assignments: Vec<Assignment> = assignments.collect::<Result<_, _>>()?;
        self.call(py, drive, async |caller, drive| {
            let label = drive.label();
            let written = parameters::write(caller, drive, &assignments, Write { save, dry_run }).await;
            let written = written.map_err(|error| of_client(&error))?;
            let report = written.report(drive, &Calls);
            let problems = written.problems(&label);
            let Some(first) = problems.first() else {
                return document(&report);
            };
            // one value alone was refused as a whole
            if let (parameters::ParameterError::Client(error), [_], [_]) =
                (first, &problems[..], &assignments[..])
            {
                return Err(of_client(error));
            }
            let failure = explained(first).of_kind(written.outcome().kind());
            Err(failure.with(json!({ "report": report })))
        })
    }

    /// How a drive is and why it does not run; a report as JSON.
    fn status(&self, py: Python<'_>, drive: &str) -> PyResult<String> {
        self.call(py, drive, async |caller, drive| {
            let status = inspection::status(caller, drive, &Calls).await;
            document(&status.map_err(|error| of_client(&error))?.report)
        })
    }

    /// Faults and warnings; a report as JSON.
    fn faults(&self, py: Python<'_>, drive: &str, history: bool) -> PyResult<String> {
        self.call(py, drive, async |caller, drive| {
            let faults = inspection::faults(caller, drive, history).await;
            document(&faults.map_err(|error| of_client(&error))?)
        })
    }

    /// Brings a drive to rest, whoever commands it; a report as JSON.
    fn stop(&self, py: Python<'_>, drive: &str, disable: bool) -> PyResult<String> {
        let way = if disable { StopWay::Disable } else { StopWay::Stop };
        self.call(py, drive, async |caller, drive| {
            let stopped = motion::stop(caller, drive, way, STOP).await;
            let report = stopped.and_then(|report| report.check().map(|()| report));
            document(&report.map_err(|error| of_motion(&error))?)
        })
    }

    /// Stops all axes that this program has under control; does not wait.
    fn stop_all(&self, py: Python<'_>, quick: bool) -> PyResult<()> {
        py.detach(|| {
            self.place()?.joined.caller.stop_all(quick);
            Ok(())
        })
    }

    /// Takes control of an axis.
    #[expect(
        clippy::too_many_arguments,
        reason = "each is an argument of the call in Python"
    )]
    fn control(
        &self,
        py: Python<'_>,
        drive: &str,
        max_speed: &str,
        mode: Option<&str>,
        telegram: Option<u16>,
        cycle: Option<Span>,
        lease: Span,
        set_mode: bool,
        accept_no_timeout: bool,
    ) -> PyResult<Axis> {
        let wanted = Wanted {
            limit: Wanted::speed(max_speed)?,
            mode: mode.map(Wanted::mode).transpose()?,
            telegram,
            cycle: cycle.map(|cycle| cycle.read()).transpose()?,
            lease: lease.read()?,
            set_mode,
            may_run_on: accept_no_timeout,
        };
        let place = self.place()?;
        let requests = StopRequests::default();
        let obeyed = requests.clone();
        self.call(py, drive, async move |caller, drive| {
            // its calls have requests of their own
            let mut own = caller.clone();
            own.obey(&obeyed);
            Axis::take(place, requests, &mut own, drive, &wanted).await
        })
    }

    /// Closes the network.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            let place = self.place()?;
            place.goes_on();
            place.joined.close(None)
        })
    }
}
