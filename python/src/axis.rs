//! An axis under control.

use std::future::poll_fn;
use std::pin::pin;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, TryLockError, Weak};
use std::task::Poll;
use std::thread::{self, ThreadId};
use std::time::Duration;

use client::{AxisStatus, Drive, ErrorKind, StopHandle};
use profidrive::motion::{
    self, AxisState, Control, Event, HeldAxis, Hold, MotionError, Observer, Report, Speed,
};
use profidrive::{Caller, StopRequests};
use profile::notation::Quantity;
use profile::state::Mode;
use pyo3::exceptions::PyBaseException;
use pyo3::prelude::*;

use crate::attention::LOOK;
use crate::errors::{Failure, closed, of_motion};
use crate::joined::locked;
use crate::log::{self, Logger};
use crate::network::Place;
use crate::time::{Span, seconds};
use crate::trace::document;

/// How an axis is taken.
pub struct Wanted {
    pub limit: Speed,
    pub mode: Option<Mode>,
    pub telegram: Option<u16>,
    pub cycle: Option<Duration>,
    pub lease: Duration,
    pub set_mode: bool,
    pub may_run_on: bool,
}

impl Wanted {
    pub fn speed(text: &str) -> Result<Speed, Failure> {
        Speed::of(&quantity(text)?, "speed").map_err(|error| of_motion(&error))
    }

    pub fn mode(name: &str) -> Result<Mode, Failure> {
        match name {
            "velocity" => Ok(Mode::Velocity),
            "position" => Ok(Mode::Position),
            other => Err(Failure::usage(format!(
                "`{other}` is not a mode; there are `velocity` and `position`"
            ))),
        }
    }

    /// Reads the limit of an axis. With one of 0 nothing could move; who means no limit is to say which one.
    pub fn limit(text: &str) -> Result<Speed, Failure> {
        let limit = Self::speed(text)?;
        let (Speed::Rpm(value) | Speed::Hertz(value)) = limit;
        if value == 0.0 {
            let why = format!("max_speed: {text}: the highest speed must be above 0");
            return Err(Failure::usage(why));
        }
        Ok(limit)
    }

    async fn hold(&self, caller: &mut Caller, drive: &mut Drive) -> Result<Hold, MotionError> {
        let hold = match self.mode {
            Some(Mode::Velocity) => Hold::for_speed(),
            Some(Mode::Position) => Hold::for_position(),
            None => Hold::for_present_mode(caller, drive).await?,
        };
        Ok(Hold {
            limit: self
                .limit
                .in_rpm(caller, drive, &Observer::default())
                .await?
                .abs(),
            telegram: self.telegram,
            lease: self.lease,
            control: Control {
                cycle: self.cycle,
                may_run_on: self.may_run_on,
                set_mode: self.set_mode,
                ..Control::default()
            },
            ..hold
        })
    }
}

fn quantity(text: &str) -> Result<Quantity, Failure> {
    text.parse()
        .map_err(|error| Failure::usage(format!("{text}: {error}")))
}

/// An axis under control of this program.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Axis {
    place: Place,
    held: Arc<Mutex<Option<HeldAxis>>>,
    /// The axes that belong together with it: they are kept while it is waited for, and when one fails its calls end.
    beside: OnceLock<Vec<Weak<Mutex<Option<HeldAxis>>>>>,
    /// The thread whose call is at work with it: others only look.
    at_work: Mutex<Option<ThreadId>>,
    /// For stops from other threads.
    stop: StopHandle,
    requests: StopRequests,
    /// What was seen last, for those who look while it moves.
    seen: Arc<Mutex<Option<AxisStatus>>>,
}

impl Axis {
    pub async fn take(
        place: Place,
        requests: StopRequests,
        caller: &mut Caller,
        drive: &mut Drive,
        wanted: &Wanted,
    ) -> Result<Self, Failure> {
        let seen = Arc::new(Mutex::new(None));
        let shown = Arc::clone(&seen);
        let label = drive.label();
        let observer = Observer::new(move |event| match event {
            Event::Sample(status) => *locked(&shown) = Some(*status),
            other => log::of_motion(&label, other),
        });
        let hold = wanted.hold(caller, drive).await;
        let hold = hold.map_err(|error| of_motion(&error))?;
        let held = motion::hold(caller, drive, &hold, &observer).await;
        let held = held.map_err(|error| of_motion(&error))?;
        *locked(&seen) = held.status();
        Ok(Self {
            place,
            stop: held.stop_handle(),
            held: Arc::new(Mutex::new(Some(held))),
            beside: OnceLock::new(),
            at_work: Mutex::default(),
            requests,
            seen,
        })
    }

    /// Returns the axis for a call that is at work with it.
    fn work(&self) -> Result<(AtWork<'_>, MutexGuard<'_, Option<HeldAxis>>), Failure> {
        self.place.joined.usable()?;
        let at_work = AtWork::begin(&self.at_work)?;
        // a reader holds the lock briefly
        Ok((at_work, locked(&self.held)))
    }

    /// Ends the call of another thread that moves it, by a stop. One of this thread cannot end before the caller, the handler of a
    /// signal, has returned.
    fn end_other(&self, py: Python<'_>, quick: bool) -> PyResult<()> {
        self.place.joined.usable()?;
        loop {
            let Some(other) = *locked(&self.at_work) else {
                return Ok(());
            };
            if quick {
                self.stop.quick_stop();
            } else {
                self.stop.stop();
            }
            if other == thread::current().id() {
                return Err(closed(
                    "a call of this thread moves the axis: it is stopped and that call ends, once this handler has returned",
                )
                .into());
            }
            py.detach(|| thread::sleep(LOOK));
            py.check_signals()?;
        }
    }

    /// Takes it to give control back. After an interrupt the next one makes that a quick stop.
    fn taken(&self, is_interrupted: bool) -> Result<(AtWork<'_>, HeldAxis), Failure> {
        let (at_work, mut held) = self.work()?;
        let held = held.take().ok_or_else(released)?;
        self.requests.clear();
        if is_interrupted {
            self.requests.request();
        }
        Ok((at_work, held))
    }

    fn call<T: Send>(
        &self,
        py: Python<'_>,
        what: &str,
        work: impl AsyncFnOnce(&mut HeldAxis) -> Result<T, MotionError> + Send,
    ) -> PyResult<T> {
        py.detach(|| {
            let (_at_work, mut held) = self.work()?;
            let held = held.as_mut().ok_or_else(released)?;
            self.place.goes_on();
            self.requests.clear();
            let requests = std::slice::from_ref(&self.requests);
            let mut call = pin!(async {
                let done = work(held).await;
                let done = done.map_err(|error| of_motion(&error).about(&held.drive().label()));
                let what = format_args!("{}: {what}", held.drive().label());
                log::call(Logger::Axis, what, &done, true);
                done
            });
            let mut failed = None;
            let done = self.place.joined.wait(
                requests,
                poll_fn(|context| {
                    if failed.is_none() {
                        failed = self.failed_beside();
                        // it ends along its ramp
                        failed.iter().for_each(|_| self.requests.request());
                    }
                    call.as_mut().poll(context)
                }),
            );
            match failed {
                Some(other) => Err(self.why_failed(&other, done.err())),
                None => done,
            }
        })
    }

    /// Keeps the axes that belong together with it; returns the first one that has failed.
    fn failed_beside(&self) -> Option<Arc<Mutex<Option<HeldAxis>>>> {
        let mut beside = self.beside.get()?.iter().filter_map(Weak::upgrade);
        let fails = |other: &Arc<Mutex<Option<HeldAxis>>>| {
            // one that another thread moves is kept by that
            free(other).is_some_and(|held| held.as_ref().is_some_and(|held| !held.keep_beside()))
        };
        beside.find(fails)
    }

    /// Returns why another axis has failed; what became of the own call comes with it.
    fn why_failed(&self, other: &Mutex<Option<HeldAxis>>, own: Option<PyErr>) -> PyErr {
        let mut held = locked(other);
        let Some(held) = held.as_mut() else {
            return own.unwrap_or_else(|| released().into());
        };
        let label = held.drive().label();
        let requests = [StopRequests::default()];
        let why = self.place.joined.wait(&requests, async {
            let kept = held.keep_alive().await;
            kept.map_err(|error| of_motion(&error.into()).about(&label))
        });
        why.err().or(own).unwrap_or_else(|| released().into())
    }

    /// Carries out a motion; its report as JSON.
    fn motion(
        &self,
        py: Python<'_>,
        what: &str,
        work: impl AsyncFnOnce(&mut HeldAxis) -> Result<Report, MotionError> + Send,
    ) -> PyResult<String> {
        Ok(document(&self.call(py, what, work)?)?)
    }
}

/// A call that is at work with an axis.
struct AtWork<'a>(&'a Mutex<Option<ThreadId>>);

impl<'a> AtWork<'a> {
    fn begin(at_work: &'a Mutex<Option<ThreadId>>) -> Result<Self, Failure> {
        let mut who = locked(at_work);
        let own = thread::current().id();
        match *who {
            Some(other) if other == own => Err(closed("a call of this thread moves the axis already")),
            Some(_) => Err(closed(
                "another thread moves this axis; only `stop` may be called meanwhile",
            )),
            None => {
                *who = Some(own);
                Ok(Self(at_work))
            }
        }
    }
}

impl Drop for AtWork<'_> {
    fn drop(&mut self) {
        *locked(self.0) = None;
    }
}

impl Drop for Axis {
    fn drop(&mut self) {
        if self.place.joined.usable().is_err() {
            // a copy of the process must not end what the first one has, and may find locks that no thread of it opens
            std::mem::forget(Arc::clone(&self.held));
        }
    }
}

/// Brings an axis to rest and gives control back.
async fn given_back(held: HeldAxis) -> Result<Report, Failure> {
    let drive = held.drive().label();
    let done = held.release().await;
    done.map_err(|error| of_motion(&error).about(&drive))
}

/// Makes axes belong together: while a call for one of them waits the others are kept, and it ends when one of them fails.
#[pyfunction]
pub fn hold_together(axes: Vec<Py<Axis>>) {
    let own: Vec<_> = axes.iter().map(|axis| Arc::downgrade(&axis.get().held)).collect();
    for (place, axis) in axes.iter().enumerate() {
        let others = own.iter().enumerate().filter(|(other, _)| *other != place);
        // they are put together once, when they are taken
        let _ = axis
            .get()
            .beside
            .set(others.map(|(_, held)| held.clone()).collect());
    }
}

/// Brings axes of one network to rest at the same time and gives control back; an error for each that fails.
#[pyfunction]
pub fn release_together(
    py: Python<'_>,
    axes: Vec<Py<Axis>>,
    is_interrupted: bool,
) -> PyResult<Vec<Option<Py<PyBaseException>>>> {
    let axes: Vec<&Axis> = axes.iter().map(|axis| axis.get()).collect();
    let Some(first) = axes.first() else {
        return Ok(Vec::new());
    };
    for axis in &axes {
        axis.end_other(py, is_interrupted)?;
    }
    let failures = py.detach(|| {
        first.place.goes_on();
        let requests: Vec<_> = axes.iter().map(|axis| axis.requests.clone()).collect();
        let (mut calls, mut failures, mut at_work) = (Vec::new(), Vec::new(), Vec::new());
        for axis in &axes {
            let (call, failure) = match axis.taken(is_interrupted) {
                Ok((guard, held)) => {
                    at_work.push(guard);
                    (Some(Box::pin(given_back(held))), None)
                }
                Err(failure) => (None, Some(failure)),
            };
            calls.push(call);
            failures.push(failure);
        }
        let together = poll_fn(|context| {
            for (call, failure) in calls.iter_mut().zip(&mut failures) {
                if let Some(released) = call
                    && let Poll::Ready(result) = released.as_mut().poll(context)
                {
                    *failure = result.err();
                    *call = None;
                }
            }
            match calls.iter().all(Option::is_none) {
                true => Poll::Ready(Ok(std::mem::take(&mut failures))),
                false => Poll::Pending,
            }
        });
        first.place.joined.wait(&requests, together)
    })?;
    let error = |failure: Failure| PyErr::from(failure).into_value(py);
    Ok(failures.into_iter().map(|failure| failure.map(error)).collect())
}

/// Locks, unless another thread has.
fn free<T>(mutex: &Mutex<T>) -> Option<MutexGuard<'_, T>> {
    match mutex.try_lock() {
        Ok(held) => Some(held),
        Err(TryLockError::Poisoned(held)) => Some(held.into_inner()),
        Err(TryLockError::WouldBlock) => None,
    }
}

fn released() -> Failure {
    closed("the axis was released")
}

#[pymethods]
impl Axis {
    /// Stops it. While another thread moves it, that call ends first.
    fn stop(&self, py: Python<'_>, quick: bool, timeout: Option<Span>) -> PyResult<String> {
        let timeout = timeout.map(|timeout| timeout.read()).transpose()?;
        self.end_other(py, quick)?;
        let Some(timeout) = timeout else {
            return self.motion(py, "stop", async move |axis| axis.bring_to_rest(quick).await);
        };
        let rests = self.call(py, "stop", async move |axis| {
            axis.rest_within(quick, timeout).await
        })?;
        let late = || {
            let text = format!(
                "the axis is not at rest after {} s; it goes on stopping",
                seconds(timeout)
            );
            Failure::new(ErrorKind::NotReached, text)
        };
        Ok(document(&rests.ok_or_else(late)?)?)
    }

    /// Requests that the call which moves it ends; it is stopped along its ramp.
    fn interrupt(&self) {
        self.requests.request();
    }

    /// Turns at a speed, for some time or until another call.
    fn run(&self, py: Python<'_>, speed: &str, lasts: Option<Span>) -> PyResult<String> {
        let speed = Wanted::speed(speed)?;
        let lasts = lasts.map(|lasts| lasts.read()).transpose()?;
        self.motion(py, "run", async move |axis| {
            let speed = axis.in_rpm(speed).await?;
            axis.turn(speed, lasts).await
        })
    }

    /// Jogs for some time, at the speed of the drive where none is given.
    fn jog(&self, py: Python<'_>, speed: Option<&str>, lasts: Span) -> PyResult<String> {
        let speed = speed.map(Wanted::speed).transpose()?;
        let lasts = lasts.read()?;
        self.motion(py, "jog", async move |axis| {
            let speed = match speed {
                Some(speed) => Some(axis.in_rpm(speed).await?),
                None => None,
            };
            axis.jog_for(speed, lasts).await
        })
    }

    /// Moves to a position or by a distance. Where it does not wait it returns once the drive has accepted the move.
    #[expect(
        clippy::too_many_arguments,
        reason = "each is an argument of the call in Python"
    )]
    fn move_to(
        &self,
        py: Python<'_>,
        target: &str,
        is_distance: bool,
        speed: &str,
        acceleration: Option<&str>,
        deceleration: Option<&str>,
        waits: bool,
        timeout: Option<Span>,
    ) -> PyResult<String> {
        let ramps = [acceleration, deceleration].map(|ramp| ramp.map(quantity).transpose());
        let [acceleration, deceleration] = ramps;
        let (acceleration, deceleration) = (acceleration?, deceleration?);
        let wanted = motion::Move::of(&quantity(target)?, is_distance, &quantity(speed)?)
            .and_then(|wanted| wanted.with_ramps(acceleration.as_ref(), deceleration.as_ref()));
        let order = wanted.map_err(|error| of_motion(&error))?.order;
        let timeout = timeout.map(|timeout| timeout.read()).transpose()?;
        self.motion(py, "move", async move |axis| {
            if waits {
                return axis.travel(&order, timeout).await;
            }
            axis.set_out(&order).await?;
            Ok(Report::default())
        })
    }

    fn home(&self, py: Python<'_>, timeout: Span) -> PyResult<String> {
        let timeout = timeout.read()?;
        self.motion(py, "home", async move |axis| axis.find_home(timeout).await)
    }

    /// Carries out a motion task. Where it does not wait it returns once the drive has accepted it.
    fn task(&self, py: Python<'_>, number: u16, waits: bool, timeout: Span) -> PyResult<String> {
        let timeout = timeout.read()?;
        self.motion(py, "task", async move |axis| {
            if waits {
                return axis.carry_out(number, timeout).await;
            }
            axis.set_out_task(number).await?;
            Ok(Report::default())
        })
    }

    fn ack(&self, py: Python<'_>) -> PyResult<()> {
        self.call(py, "ack", async |axis| Ok(axis.acknowledge().await?))
    }

    fn keep_alive(&self, py: Python<'_>) -> PyResult<()> {
        self.call(py, "keep alive", async |axis| Ok(axis.keep_alive().await?))
    }

    /// Brings it to rest and gives control back; its report as JSON. After an interrupt the next one makes it a quick stop.
    fn release(&self, py: Python<'_>, is_interrupted: bool) -> PyResult<String> {
        self.end_other(py, is_interrupted)?;
        py.detach(|| {
            let (_at_work, held) = self.taken(is_interrupted)?;
            self.place.goes_on();
            let requests = std::slice::from_ref(&self.requests);
            let report = self.place.joined.wait(requests, given_back(held))?;
            Ok(document(&report)?)
        })
    }

    /// Leaves it to the network, which brings it to rest. False where it was released before.
    fn abandon(&self, py: Python<'_>) -> bool {
        py.detach(|| {
            if self.place.joined.usable().is_err() {
                return false;
            }
            let Some(mut held) = free(&self.held) else {
                // a thread whose caller is gone, such as a task of an event loop that was closed
                self.requests.request();
                return true;
            };
            held.take().is_some()
        })
    }

    /// What the last frame reported; JSON. No I/O.
    fn status(&self, py: Python<'_>) -> PyResult<Option<String>> {
        py.detach(|| {
            self.place.joined.usable()?;
            let status = match free(&self.held) {
                Some(held) => held.as_ref().and_then(HeldAxis::status),
                None => None,
            };
            let status = status.or_else(|| *locked(&self.seen));
            Ok(status
                .map(|status| document(&AxisState::from(&status)))
                .transpose()?)
        })
    }

    /// Frames of the connection: received, missed, and seconds of the longest time without one.
    fn frames(&self, py: Python<'_>) -> PyResult<Option<(u64, u64, f64)>> {
        py.detach(|| {
            self.place.joined.usable()?;
            let held = free(&self.held);
            let counts = held.as_ref().and_then(|held| held.as_ref()?.statistics());
            Ok(counts.map(|counts| (counts.received, counts.missed, seconds(counts.longest_gap))))
        })
    }

    #[getter]
    fn is_held(&self, py: Python<'_>) -> bool {
        py.detach(|| free(&self.held).is_none_or(|held| held.is_some()))
    }
}
