//! The calls: one for each wish, over any wire.

mod access;
mod at_work;
mod authority;
mod axis;
mod backup;
mod change;
mod describe;
mod enabled;
mod evidence;
mod extent;
mod faults;
mod find;
mod frequency;
mod info;
mod jog;
mod keep;
mod learn;
mod line;
mod loss;
mod manner;
mod mode;
mod monitor;
mod neutral;
mod parameters;
mod plugged;
mod prepare;
mod readings;
mod route;
mod scaling;
mod status;
mod stop;
mod takeover;
mod tasks;
mod temporary;
mod unread;
mod warnings;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use profinet::Instant;
use uss::ReceiverStatistics;

use crate::absent::{Absent, Looks};
use crate::axis::{Goal, StopKind};
use crate::engine::{Interest, NextTurn, Touched};
use crate::{
    AxisView, BoundedDrive, Client, Connection, Drive, Engine, Error, Link, LossReaction, RouteNotice,
};

use manner::Manner;

pub(crate) use access::Records;

pub(crate) use authority::power_is_on;
pub use axis::{
    Axis, AxisPlan, AxisSettings, AxisStatus, BeatHandle, Released, Rest, Samples, StopHandle,
    WarningWatcher, Watcher,
};
pub use change::{Keep, WriteMode};
pub use describe::{Described, ReportedLimits};
pub use enabled::Enabled;
pub use faults::{FaultEntry, FaultReport, LoggedFault, WarningEntry};
pub use frequency::synchronous_speed;
pub use info::{Info, Peer};
pub use jog::{HomingSpeed, JogSpeed};
pub use mode::ModeChange;
pub use monitor::Snapshot;
pub use stop::{StopMeans, StopOutcome, StopWay};
pub use temporary::{PutBack, TemporaryChange};

/// How often a caller's wish to stop is looked at while nothing happens.
const GLANCE: Duration = Duration::from_millis(50);
/// Speed below which an axis counts as standing, rpm.
const STANDS: f64 = 1.0;
/// Time for a drive in motion to report additional evidence.
const BESIDE: Duration = Duration::from_millis(500);

/// Calls to the drives of a network, each a future: [`Wait::wait`](crate::Wait::wait) waits for one, and an async program
/// awaits it. Clones are further callers on the same network, each with one call at a time.
///
/// Reads only until a write or a motion is requested: nothing is written and nothing moves on construction, on finding
/// or on reading.
///
/// ```
/// use profidrive_client::{DriveAddress, Error, Network, Wait};
/// use profinet::controller::ControllerConfig;
/// use profinet::{Endpoint, Instant, IpSuite, MacAddress, Medium};
///
/// /// A cable that ends nowhere.
/// struct Silence(Instant);
/// impl Medium for Silence {
///     type Error = std::convert::Infallible;
///     fn now(&self) -> Instant {
///         self.0
///     }
///     fn step(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> Result<(), Self::Error> {
///         let mut buffer = [0; profinet::MAX_FRAME];
///         while endpoint.poll_transmit(self.0, &mut buffer).is_some() {}
///         self.0 = endpoint.poll_timeout().map_or(until, |due| due.clamp(self.0, until));
///         endpoint.handle_timeout(self.0);
///         Ok(())
///     }
/// }
///
/// let mac = MacAddress([2, 0x50, 0x4E, 0, 0, 0xC0]);
/// let config = ControllerConfig::new(mac, IpSuite::NONE, "tool", 1);
/// let (mut network, _) = Network::on(Silence(Instant::ZERO), config);
/// let drive: DriveAddress = "akd-1".parse()?;
/// assert!(matches!(network.find(&drive).wait(), Err(Error::NotFound { .. })));
/// # Ok::<(), profidrive_client::DriveAddressError>(())
/// ```
pub struct Session {
    engine: Engine,
    /// Asks whether the caller requests a stop.
    interrupted: Arc<Mutex<Question>>,
    /// Asks whether the caller requests a quick stop of an axis.
    hurry: Arc<Mutex<Question>>,
    /// Follows the steps on the ways to records.
    route_follower: Arc<Mutex<RouteFollower>>,
    /// How its requests are carried out at present.
    manner: Arc<Mutex<Manner>>,
    /// When and how a caller that waits for an answer is notified of its absence.
    silence: Option<Silence>,
    /// The drive whose axis is under control, and what it does when it loses that.
    under_control: Option<(String, Box<LossReaction>)>,
    /// What it looks at while it waits for more than one thing.
    interest: Interest,
    /// Highest speeds of drives on their machine.
    pub(crate) bounds: Arc<[BoundedDrive]>,
    /// What drives have reported not to have, for all callers.
    absent: Arc<Mutex<Absent>>,
    /// What was read to see whether drives have it, by all callers.
    looks: Arc<Mutex<Looks>>,
}

/// Asks the caller something, now and then while a call waits.
type Question = Box<dyn FnMut() -> bool + Send>;

/// A caller that waits for an answer.
struct Silence {
    due: Instant,
    /// In a lock, so that threads can share a session.
    notify: Mutex<Box<dyn FnMut() + Send>>,
}

/// How long a network that is left may still wait for each drive.
const FAREWELL: Duration = Duration::from_secs(1);

/// Takes the name of a drive and a step on the way to its records.
type RouteFollower = Box<dyn FnMut(&str, &RouteNotice) + Send>;

fn shared<T>(inner: T) -> Arc<Mutex<T>> {
    Arc::new(Mutex::new(inner))
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Clone for Session {
    fn clone(&self) -> Self {
        Self {
            engine: self.engine.clone(),
            interrupted: Arc::clone(&self.interrupted),
            hurry: Arc::clone(&self.hurry),
            route_follower: Arc::clone(&self.route_follower),
            manner: Arc::new(Mutex::new(self.manner().clone())),
            silence: None,
            under_control: self.under_control.clone(),
            interest: self.interest,
            bounds: Arc::clone(&self.bounds),
            absent: Arc::clone(&self.absent),
            looks: Arc::clone(&self.looks),
        }
    }
}

impl std::fmt::Debug for Session {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Session").finish_non_exhaustive()
    }
}

impl Session {
    pub(crate) fn new(engine: Engine) -> Self {
        Self {
            engine,
            interrupted: shared(Box::new(|| false)),
            hurry: shared(Box::new(|| false)),
            route_follower: shared(Box::new(|_, _| {})),
            manner: Arc::default(),
            silence: None,
            under_control: None,
            interest: Interest::Anything,
            bounds: Arc::default(),
            absent: Arc::default(),
            looks: Arc::default(),
        }
    }

    /// Calls `interrupted` now and then to check whether the caller requests a stop; calls then end with
    /// [`Error::Interrupted`]. An axis under control is stopped as well. It holds for this session and the clones that are
    /// made of it from now on.
    pub fn interrupt_with(&mut self, interrupted: impl FnMut() -> bool + Send + 'static) {
        self.interrupted = shared(Box::new(interrupted));
    }

    /// Calls `hurry` while an axis stops along its ramp; once it returns true what remains is a quick stop (OFF3). It holds
    /// for this session and the clones that are made of it from now on.
    pub fn hurry_with(&mut self, hurry: impl FnMut() -> bool + Send + 'static) {
        self.hurry = shared(Box::new(hurry));
    }

    /// Makes a ramp stop a quick one once the caller requests it.
    fn hurry_on(&self, link: Link, view: &AxisView) {
        let ramp = view.goal == Goal::Stop && !view.quick_stop && !view.at_rest;
        if !ramp {
            return;
        }
        if self.hurry_requested() {
            let now = self.now();
            self.client().hurry(now, link, StopKind::Quick);
        }
    }

    /// Returns true when the caller requests that what takes its time is cut short ([`hurry_with`](Self::hurry_with)).
    #[must_use]
    pub fn hurry_requested(&self) -> bool {
        (locked(&self.hurry))()
    }

    /// Brings every axis to rest and closes every connection.
    pub(crate) async fn leave(&mut self) -> Result<(), Error> {
        let _meanwhile = self.unstoppable();
        self.engine.begin_closing();
        while self.engine.is_busy() {
            // an axis that cannot be reached any more ends as well
            if let Err(error) = self.look_again().await
                && error.is_final()
            {
                return Err(error);
            }
        }
        self.close_within(FAREWELL).await
    }

    /// The engine that carries out the calls.
    #[must_use]
    pub const fn engine(&self) -> &Engine {
        &self.engine
    }

    /// What the serial line has brought, telegrams and noise; `None` on a network.
    #[must_use]
    pub fn line_counters(&self) -> Option<ReceiverStatistics> {
        self.client().line_counters().copied()
    }

    fn client(&self) -> Touched<'_> {
        self.engine.client()
    }

    /// What became of a connection.
    fn connection(&self, link: impl Into<Link>) -> Connection {
        self.client().connection(link)
    }

    /// The present time.
    #[must_use]
    pub fn now(&self) -> Instant {
        self.engine.now()
    }

    /// Stops every axis that this program has in operation, along its ramp (OFF1) or by its quick stop (OFF3). Nothing that
    /// waits for a drive holds that up; it does not wait for the end.
    pub fn stop_all(&self, quick: bool) {
        let now = self.now();
        let way = if quick { StopKind::Quick } else { StopKind::Ramp };
        self.client().stop_now(now, None, way);
        self.engine.stir();
    }

    /// Lets time pass; connections and axes go on.
    ///
    /// # Errors
    /// When the medium fails or the caller requests a stop.
    pub async fn pass(&mut self, time: Duration) -> Result<(), Error> {
        let end = self.now() + time;
        while self.now() < end {
            // inputs of axes change nothing about the time: no cycle wakes a caller who waits for that
            let due = end.min(self.now() + GLANCE);
            let turn = self.engine.next_turn(due, Interest::Events);
            self.step_in(turn).await?;
        }
        Ok(())
    }

    /// Does something that a caller's wish to stop must not interrupt: putting back what was changed.
    pub async fn uninterrupted<T>(&mut self, work: impl AsyncFnOnce(&mut Self) -> T) -> T {
        let _meanwhile = self.unstoppable();
        work(self).await
    }

    /// Runs `work`, and calls `notify` once when it takes longer than `limit` because a drive does not answer. The work
    /// continues, as the drive may still answer.
    pub async fn reporting_silence<T>(
        &mut self,
        limit: Duration,
        work: impl AsyncFnOnce(&mut Self) -> T,
        notify: impl FnMut() + Send + 'static,
    ) -> T {
        let due = self.now() + limit;
        let notify: Mutex<Box<dyn FnMut() + Send>> = Mutex::new(Box::new(notify));
        let before = self.silence.replace(Silence { due, notify });
        let result = work(self).await;
        self.silence = before;
        result
    }

    /// Drops the connections to a lost drive without a release, which it would not receive.
    pub fn forget(&mut self, drive: &Drive) {
        for ar in self.accesses(drive) {
            self.drop_access(ar);
        }
    }

    /// Returns an error if the caller requests a stop, before something is begun that should not be interrupted.
    ///
    /// # Errors
    /// When the caller requests a stop ([`interrupt_with`](Self::interrupt_with)).
    pub fn glance(&mut self) -> Result<(), Error> {
        if !self.manner().stopping && (locked(&self.interrupted))() {
            return Err(Error::Interrupted);
        }
        Ok(())
    }

    /// Lets one thing happen, at most until `until`.
    async fn step(&mut self, until: Instant) -> Result<(), Error> {
        let turn = self
            .engine
            .next_turn(until.min(self.now() + GLANCE), self.interest);
        self.step_in(turn).await
    }

    async fn step_in(&mut self, turn: NextTurn) -> Result<(), Error> {
        self.glance()?;
        let now = self.now();
        if let Some(mut silence) = self.silence.take_if(|silence| silence.due <= now) {
            let notify = silence.notify.get_mut().unwrap_or_else(PoisonError::into_inner);
            notify();
        }
        turn.await.map_err(|error| match (error, &self.under_control) {
            // nothing reaches the drive any more, wherever the way ends
            (Error::Medium(error), Some((drive, reaction))) => Error::CarrierLost {
                drive: drive.clone(),
                error,
                reaction: Some(reaction.clone()),
            },
            (error, _) => error,
        })
    }

    /// Names the drive that is out of reach when the medium fails meanwhile.
    fn reached<T>(drive: &Drive, result: Result<T, Error>) -> Result<T, Error> {
        result.map_err(|error| match error {
            Error::Medium(error) => Error::CarrierLost {
                drive: drive.label(),
                error,
                reaction: None,
            },
            other => other,
        })
    }

    /// Waits for the next thing to happen, or not for long.
    async fn look_again(&mut self) -> Result<(), Error> {
        self.step(self.now() + GLANCE).await
    }

    /// Lets things happen until `done` gives something, at most for `limit`; `None` when the time is over.
    async fn wait<T>(
        &mut self,
        limit: Duration,
        mut done: impl FnMut(&mut Client) -> Option<T>,
    ) -> Result<Option<T>, Error> {
        let end = self.end_of(limit);
        loop {
            let events = self.engine.events();
            let result = done(&mut self.engine.quietly());
            if result.is_some() {
                return Ok(result);
            }
            if self.now() >= end {
                return Ok(None);
            }
            let until = end.min(self.now() + GLANCE);
            let turn = self.engine.next_turn(until, Interest::Events).since(events);
            self.step_in(turn).await?;
        }
    }
}
