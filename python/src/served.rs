//! A plant on a network interface, in real time.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, mpsc};
use std::thread::{JoinHandle, spawn};

use ::network::system::Stop;
use ::plant::control_socket::{InjectRequest, target};
use ::plant::host::{Drives, Event, EventSender, Host, HostConfig, HostError, HostTrace, StatePlace, events};
use ::plant::{ExpectationResult, PlantPlan};
use client::ErrorKind;
use pyo3::prelude::*;

use crate::attention::LOOK;
use crate::errors::{Failure, explained};
use crate::joined::locked;
use crate::log::{self, Logger};
use crate::time::Span;
use crate::trace::{Trace, document};

/// Events that are kept.
const KEPT: usize = 100_000;
/// The most octets of the trace, about. It is copied for each look.
const TRACE: usize = 64 << 20;

type Ended = Result<Vec<ExpectationResult>, HostError>;

/// Drives that run on an interface until it is closed.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Served {
    plan: Arc<PlantPlan>,
    trace: HostTrace,
    stop: Stop,
    happened: Arc<Mutex<VecDeque<::plant::Event>>>,
    thread: Mutex<Option<JoinHandle<Ended>>>,
}

impl Served {
    /// Starts the drives of a plant; they are ready when it returns.
    pub fn start(plan: &PlantPlan, interface: String, state: Option<PathBuf>) -> Result<Self, Failure> {
        let stop = Stop::new().map_err(|error| Failure::new(ErrorKind::Local, error.to_string()))?;
        let trace = HostTrace::default();
        let config = HostConfig {
            trace: Some((trace.clone(), TRACE)),
            interface,
            drives: Drives::Plans(plan.drives.clone()),
            seed: plan.seed,
            state: state.map(|folder| StatePlace {
                folder,
                holder: format!("process {}", std::process::id()),
            }),
            description: None,
            refuses_in_operation: false,
            capture: None,
            expectations: Vec::new(),
            time: None,
            load_every: None,
            stop: stop.clone(),
        };
        let (sender, received) = events();
        let (opened, ready) = mpsc::channel();
        // what is not `Send` stays in its thread
        let thread = spawn(move || run(config, sender, &opened));
        ready
            .recv()
            .map_err(|error| Failure::internal(&error))?
            .map_err(|error| explained(&error))?;
        let happened = Arc::new(Mutex::new(VecDeque::new()));
        let kept = Arc::clone(&happened);
        spawn(move || received.for_each(|event| keep(&kept, &event)));
        Ok(Self {
            plan: Arc::new(plan.clone()),
            trace,
            stop,
            happened,
            thread: Mutex::new(Some(thread)),
        })
    }
}

fn run(config: HostConfig, sender: EventSender, opened: &mpsc::Sender<Result<(), HostError>>) -> Ended {
    match Host::open(config, sender) {
        Ok(host) => {
            // the caller waits for it
            let _ = opened.send(Ok(()));
            host.run()
        }
        Err(error) => {
            let _ = opened.send(Err(error));
            Ok(Vec::new())
        }
    }
}

fn keep(kept: &Mutex<VecDeque<::plant::Event>>, event: &Event) {
    match event {
        Event::Drive { drive, at, what } => {
            let event = ::plant::Event::new(*at, drive, what.kind());
            log::of_plant(event.clone());
            let mut kept = locked(kept);
            if kept.len() == KEPT {
                kept.pop_front();
            }
            kept.push_back(event);
        }
        event if event.is_warning() => log::warning(Logger::Plant, || event.to_string()),
        event => log::info(Logger::Plant, || event.to_string()),
    }
}

#[pymethods]
impl Served {
    /// Lets something happen to a drive now.
    fn inject(&self, py: Python<'_>, drive: &str, action: String, lasts: Option<Span>) -> PyResult<()> {
        let lasts = lasts.map(|lasts| lasts.read()).transpose()?;
        let done = py.detach(|| {
            let request = InjectRequest::new(drive, &[action], lasts)?;
            target(&request)?.inject(request)
        });
        done.map_err(|error| explained(&error).about(drive))?;
        Ok(())
    }

    /// What has happened, a JSON list; the last 100,000 events.
    fn events(&self, py: Python<'_>) -> PyResult<String> {
        Ok(py.detach(|| document(&*locked(&self.happened)))?)
    }

    /// What has happened until now, and the states of the drives.
    fn trace(&self, py: Python<'_>) -> PyResult<Trace> {
        let trace = py.detach(|| self.trace.until_now());
        let trace = trace.ok_or_else(|| Failure::internal(&"the drives keep no trace"))?;
        Ok(Trace::kept(Arc::clone(&self.plan), trace))
    }

    /// Ends the drives.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.stop.stop();
        let thread = locked(&self.thread).take();
        let Some(thread) = thread else { return Ok(()) };
        while !thread.is_finished() {
            py.detach(|| std::thread::sleep(LOOK / 10));
            py.check_signals()?;
        }
        match thread.join() {
            Ok(ended) => Ok(ended.map(drop).map_err(|error| explained(&error))?),
            Err(_) => Err(Failure::internal(&"the drives ended by a panic").into()),
        }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.stop();
    }
}
