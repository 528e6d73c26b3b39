//! A network that is joined: finding its drives, waiting for calls, and leaving it.

use std::collections::HashMap;
use std::future::poll_fn;
use std::pin::{Pin, pin};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant as Clock};

use client::{Drive, DriveAddress, ErrorKind};
use profidrive::addressing::AddressingError;
use profidrive::fleet::Selected;
use profidrive::machine::Machine;
use profidrive::{Access, Caller, DriveError, Opening, Selector, StopRequests};
use pyo3::prelude::*;

use crate::attention::{self, LOOK, Signals, Waiting};
use crate::errors::{Failure, explained, of_client, of_drive, of_open};
use crate::log::{self, Logger};
use crate::process::Process;
use crate::time::seconds;
use crate::world::Held;

/// The networks that are open.
static OPEN: Mutex<Vec<Weak<Joined>>> = Mutex::new(Vec::new());

pub type Task = Pin<Box<dyn Future<Output = ()> + Send>>;

pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A network that is open, with the drives that were found there.
pub struct Joined {
    network: Mutex<Option<profidrive::Network>>,
    /// Whether it was closed: every axis is at rest, or cannot be reached any more.
    left: Arc<AtomicBool>,
    pub caller: Caller,
    /// For the first answer to each call; `None` for the usual time.
    timeout: Option<Duration>,
    pub opening: Opening,
    /// The machine file; its groups can be selected.
    pub machine: Option<Machine>,
    pub drives: Mutex<HashMap<String, Drive>>,
    /// What goes on beside the calls that wait. On a real network it has threads of its own; in a plant time passes for it only
    /// while a call waits.
    pub beside: Mutex<Vec<Task>>,
    /// The process that opened it: a copy of that has no thread that carries it.
    process: Process,
}

impl Joined {
    pub fn new(
        mut network: profidrive::Network,
        opening: Opening,
        machine: Option<Machine>,
        timeout: Option<Duration>,
    ) -> Arc<Self> {
        network.bound_speeds(machine.as_ref().map(Machine::bounds).unwrap_or_default());
        let joined = Arc::new(Self {
            caller: Caller::clone(&network),
            timeout,
            network: Mutex::new(Some(network)),
            left: Arc::default(),
            opening,
            machine,
            drives: Mutex::default(),
            beside: Mutex::default(),
            process: Process::this(),
        });
        let mut open = locked(&OPEN);
        open.retain(|one| one.strong_count() > 0);
        open.push(Arc::downgrade(&joined));
        joined
    }

    /// Joins a plant.
    pub fn in_plant(held: &Held) -> Result<Arc<Self>, Failure> {
        let network = held.running.join(None).map_err(|error| of_open(&error))?;
        Ok(Self::new(
            network,
            Opening::new(Access::Cyclic),
            held.machine.clone(),
            None,
        ))
    }

    /// Fails where the network cannot be used any more.
    pub fn usable(&self) -> Result<(), Failure> {
        self.process.check("the network was opened")
    }

    /// Returns whether it was not closed yet.
    pub fn is_open(&self) -> bool {
        locked(&self.network).is_some()
    }

    /// Returns a caller that obeys these requests.
    pub fn caller(&self, requests: &StopRequests) -> Caller {
        let mut caller = self.caller.clone();
        caller.obey(requests);
        if let Some(timeout) = self.timeout {
            caller.expect_first_answer_within(timeout);
        }
        caller
    }

    /// Waits for a call; what goes on beside the calls of a plant goes on.
    pub fn wait<T>(
        &self,
        requests: &[StopRequests],
        call: impl Future<Output = Result<T, Failure>>,
    ) -> PyResult<T> {
        let mut call = pin!(call);
        attention::wait(
            requests,
            poll_fn(|context| {
                locked(&self.beside).retain_mut(|task| task.as_mut().poll(context).is_pending());
                call.as_mut().poll(context)
            }),
        )
    }

    /// Lets time pass; the connections go on.
    pub fn pass(&self, time: Duration) -> PyResult<()> {
        let requests = StopRequests::default();
        let mut caller = self.caller(&requests);
        self.wait(&[requests], async {
            let passed = caller.pass(time).await;
            passed.map_err(|error| of_client(&error))
        })
    }

    /// Returns a drive, which is searched at its first use.
    pub async fn drive(&self, caller: &mut Caller, name: &str) -> Result<Drive, Failure> {
        if let Some(drive) = locked(&self.drives).get(name) {
            return Ok(drive.clone());
        }
        let found = self.opening.find(caller, &address(name)?, &mut |_| {}).await;
        let found = found.map_err(|error| of_drive(&error));
        log::call(Logger::Network, format_args!("{name}: find"), &found, false);
        found
    }

    /// Returns drives of these names, those that are not known found at the same time.
    pub async fn members(&self, caller: &mut Caller, names: &[String]) -> Result<Vec<Selected>, Failure> {
        let known = |name: &String| locked(&self.drives).get(name).cloned();
        let unknown: Vec<_> = names
            .iter()
            .filter(|name| known(name).is_none())
            .cloned()
            .collect();
        let mut failed = HashMap::new();
        if !unknown.is_empty() {
            let selector = Selector::of(&unknown.join(","), None).map_err(|error| explained(&error))?;
            let found = self.opening.select(caller, &selector).await;
            for Selected { name, drive, .. } in found.map_err(|error| of_drive(&error))?.members {
                match drive {
                    Ok(drive) => _ = locked(&self.drives).insert(name, drive),
                    Err(error) => _ = failed.insert(name, error),
                }
            }
        }
        let members = names.iter().map(|name| {
            let missing = || DriveError::NoneFits {
                term: name.clone(),
                answered: Vec::new(),
            };
            let failed = failed.remove(name);
            Selected {
                name: name.clone(),
                notes: Vec::new(),
                drive: known(name).ok_or_else(|| failed.unwrap_or_else(missing)),
            }
        });
        Ok(members.collect())
    }

    /// Returns the names of the drives that a selector means, and why those that cannot be worked with cannot.
    pub async fn select(
        &self,
        caller: &mut Caller,
        selector: &Selector,
    ) -> Result<Vec<(String, Option<Failure>)>, Failure> {
        let found = self.opening.select(caller, selector).await;
        let members = found.map_err(|error| of_drive(&error))?.members.into_iter();
        let named = members.map(|Selected { name, drive, .. }| match drive {
            Ok(drive) => {
                locked(&self.drives).insert(name.clone(), drive);
                (name, None)
            }
            Err(error) => {
                let failure = of_drive(&error).about(&name);
                (name, Some(failure))
            }
        });
        Ok(named.collect())
    }

    /// Leaves the network: every axis is brought to rest and released. Signals make that a quick stop, then end the wait for it,
    /// and so does the end of the time; what was begun goes on.
    pub fn close(&self, limit: Duration) -> PyResult<()> {
        if close_all(&[self], limit)? {
            return Ok(());
        }
        let text = format!(
            "the network is not closed after {} s: an axis is not at rest; it goes on stopping",
            seconds(limit)
        );
        Err(Failure::new(ErrorKind::NotReached, text).into())
    }
}

/// Leaves networks, all at once, as [`Joined::close`] does: none waits for the stops of another one. False where the time was over
/// first.
fn close_all(all: &[&Joined], limit: Duration) -> PyResult<bool> {
    let _waiting = Waiting::begin()?;
    for joined in all {
        let Some(network) = locked(&joined.network).take() else {
            continue;
        };
        log::info(Logger::Network, || "close".to_owned());
        let (left, caller) = (Arc::clone(&joined.left), thread::current());
        thread::spawn(move || {
            drop(network);
            left.store(true, Ordering::Release);
            caller.unpark();
        });
    }
    let requests = [StopRequests::default()];
    let mut signals = Signals::new(&requests);
    let [requests] = &requests;
    let begin = Clock::now();
    let mut hurried = false;
    let are_left = || all.iter().all(|joined| joined.left.load(Ordering::Acquire));
    while !are_left() {
        thread::park_timeout(LOOK);
        signals.look();
        if requests.is_urgent() && !hurried {
            hurried = true;
            for joined in all {
                joined.caller.stop_all(true);
            }
        }
        if requests.is_final() || begin.elapsed() >= limit {
            break;
        }
    }
    signals.raised()?;
    Ok(are_left())
}

impl Drop for Joined {
    fn drop(&mut self) {
        let network = self
            .network
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        if !self.process.is_this() {
            // a copy of the process has no thread that could end it
            std::mem::forget(network);
            return;
        }
        // no other caller waits meanwhile; a Python that ends has closed it before
        let _ = Python::try_attach(|py| py.detach(|| drop(network)));
    }
}

/// Reads the name or address of a drive.
pub fn address(name: &str) -> Result<DriveAddress, Failure> {
    name.parse().map_err(|error| explained(&DriveError::from(error)))
}

impl From<AddressingError> for Failure {
    fn from(error: AddressingError) -> Self {
        match &error {
            AddressingError::Client(error) => of_client(error),
            other => explained(other),
        }
    }
}

impl From<DriveError> for Failure {
    fn from(error: DriveError) -> Self {
        of_drive(&error)
    }
}

/// Leaves all networks before Python ends.
#[pyfunction]
pub fn leave_all(py: Python<'_>, seconds: f64) -> PyResult<()> {
    let open: Vec<_> = locked(&OPEN).iter().filter_map(Weak::upgrade).collect();
    let usable: Vec<&Joined> = open
        .iter()
        .map(|joined| &**joined)
        .filter(|joined| joined.usable().is_ok())
        .collect();
    let limit = Duration::try_from_secs_f64(seconds).unwrap_or_default();
    py.detach(|| close_all(&usable, limit)).map(drop)
}
