//! A plant on a network interface, in real time.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex};
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant as Clock};

use ::network::system::Stop;
use ::plant::control_socket::{InjectRequest, target};
use ::plant::host::{Drives, Event, EventSender, Host, HostConfig, HostError, HostTrace, StatePlace, events};
use ::plant::{DriveMessage, ExpectationResult, Observed as _, PlantPlan};
use client::ErrorKind;
use pyo3::prelude::*;

use crate::attention::LOOK;
use crate::errors::{Failure, closed, explained};
use crate::joined::locked;
use crate::log::{self, Logger};
use crate::process::Process;
use crate::time::{Span, seconds};
use crate::trace::{Trace, document, event, goal_of, lost};
use crate::world::looks;

/// Events that are kept.
const KEPT: usize = 100_000;
/// The most octets of the trace, about. It is copied for each look.
const TRACE: usize = 64 << 20;
/// Time between two looks at what is waited for.
const TICK: Duration = Duration::from_millis(2);
/// How long drives may take to begin, and to end.
const LIMIT: Duration = Duration::from_secs(30);

type Ended = Result<Vec<ExpectationResult>, HostError>;

/// Drives that run on an interface until it is closed.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Served {
    plan: Arc<PlantPlan>,
    trace: HostTrace,
    stop: Stop,
    happened: Arc<Mutex<VecDeque<::plant::Event>>>,
    thread: Mutex<Option<JoinHandle<Ended>>>,
    /// The process that serves: a copy of it has no thread that does, and shares what ends it.
    process: Process,
}

impl Served {
    /// Fails in a copy of the process.
    fn usable(&self) -> Result<(), Failure> {
        self.process.check("the plant is served")
    }

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
        match ready.recv_timeout(LIMIT) {
            Ok(opened) => opened.map_err(|error| explained(&error))?,
            Err(RecvTimeoutError::Timeout) => {
                stop.stop();
                return Err(late("not ready"));
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Failure::internal(&"the drives ended by a panic"));
            }
        }
        let happened = Arc::new(Mutex::new(VecDeque::new()));
        let kept = Arc::clone(&happened);
        spawn(move || received.for_each(|event| keep(&kept, &event)));
        Ok(Self {
            plan: Arc::new(plan.clone()),
            trace,
            stop,
            happened,
            thread: Mutex::new(Some(thread)),
            process: Process::this(),
        })
    }
}

/// Drives that take too long for something.
fn late(what: &str) -> Failure {
    let text = format!("the drives are {what} after {} s", seconds(LIMIT));
    Failure::new(ErrorKind::Local, text)
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
        self.usable()?;
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
        self.usable()?;
        Ok(py.detach(|| document(&*locked(&self.happened)))?)
    }

    /// What a drive is like now, as JSON.
    fn look(&self, py: Python<'_>, drive: &str) -> PyResult<String> {
        self.usable()?;
        let drives = &self.plan.drives;
        let number = drives.iter().position(|one| one.name == drive);
        let found =
            number.and_then(|number| Some((py.detach(|| self.trace.state(number))?, drives.get(number)?)));
        let (snapshot, plan) = found.ok_or_else(|| Failure::internal(&"the drive has no state"))?;
        let messages = |warnings| -> Vec<DriveMessage> {
            let numbers = snapshot.messages(warnings).into_iter();
            let of = |number| DriveMessage::of(number, warnings, plan.model.catalogue);
            numbers.map(of).collect()
        };
        Ok(looks(&snapshot, &messages(false), &messages(true)).to_string())
    }

    /// Waits until conditions hold of a drive; returns the event that reports it, as JSON.
    fn wait_until(&self, py: Python<'_>, goal: &str, timeout: Span) -> PyResult<String> {
        self.usable()?;
        let goal = goal_of(&self.plan, goal)?;
        if goal.reads_parameters() {
            let why = "parameters of drives that are served are read over their network: a condition on one cannot be waited for";
            return Err(Failure::usage(why).into());
        }
        let timeout = timeout.read()?;
        let pursuit = py.detach(|| self.trace.pursue(&goal, timeout));
        let pursuit = pursuit.ok_or_else(|| Failure::internal(&"the drives keep no trace"))?;
        while !py.detach(|| pursuit.is_decided()) {
            if locked(&self.thread).as_ref().is_none_or(JoinHandle::is_finished) {
                return Err(closed("the plant is not served any more").into());
            }
            py.detach(|| std::thread::sleep(TICK));
            py.check_signals()?;
        }
        let met = py.detach(|| pursuit.end());
        let met = met.map_err(|error| lost(&error, &error.0))?;
        Ok(event(&met)?)
    }

    /// What has happened until now, and the states of the drives.
    fn trace(&self, py: Python<'_>) -> PyResult<Trace> {
        self.usable()?;
        let trace = py.detach(|| self.trace.until_now());
        let trace = trace.ok_or_else(|| Failure::internal(&"the drives keep no trace"))?;
        Ok(Trace::kept(Arc::clone(&self.plan), trace))
    }

    /// Ends the drives.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.usable()?;
        self.stop.stop();
        let thread = locked(&self.thread).take();
        let Some(thread) = thread else { return Ok(()) };
        let begin = Clock::now();
        while !thread.is_finished() {
            if begin.elapsed() >= LIMIT {
                return Err(late("still there").into());
            }
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
        if self.usable().is_ok() {
            self.stop.stop();
        }
    }
}
