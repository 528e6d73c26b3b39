//! The blocking facade: one call per wish, over any medium.

mod access;
mod at_work;
mod authority;
mod axis;
mod backup;
mod describe;
mod enabled;
mod evidence;
mod extent;
mod faults;
mod find;
mod info;
mod jog;
mod keep;
mod learn;
mod line;
mod loss;
mod mode;
mod monitor;
mod neutral;
mod parameters;
mod plugged;
mod prepare;
mod route;
mod scaling;
mod status;
mod stop;
mod takeover;
mod tasks;
mod told;
mod unread;
mod warnings;

use std::time::Duration;

use profinet::Instant;
use profinet::controller::ControllerConfig;

use crate::{Client, Drive, Error, LineConfig, Wire};

pub use at_work::AtWork;
pub(crate) use authority::power_is_on;
pub use authority::{Authority, LocalControl};
pub use axis::{Axis, AxisPlan, AxisSettings, AxisStatus, Rest, WarningWatcher, Watcher};
pub use describe::{Described, DescribedLimits};
pub use enabled::Enabled;
pub use faults::{FaultEntry, FaultReport, LoggedFault, WarningEntry};
pub use info::{Identity, Info, Peer};
pub use jog::JogSpeed;
pub use loss::{LossAction, LossReaction};
pub use mode::{ModeBefore, PutBack};
pub use monitor::Snapshot;
pub use parameters::{ChangeOutcome, PlannedChange, PlannedValue, WriteMode};
pub use route::{ClosedRoute, Route, RouteNotice};
pub use stop::{StopMeans, StopOutcome, StopWay};

/// How often a caller's wish to stop is looked at while nothing happens.
const GLANCE: Duration = Duration::from_millis(50);

/// A client on a wire, with calls that wait for their result.
///
/// Reads only until told otherwise: nothing is written and nothing moves on construction, on finding or on reading.
///
/// ```
/// use profidrive_client::{DriveAddress, Error, Session};
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
/// let mut session = Session::new(Silence(Instant::ZERO), config);
/// let drive: DriveAddress = "akd-1".parse()?;
/// assert!(matches!(session.find(&drive), Err(Error::NotFound { .. })));
/// # Ok::<(), profidrive_client::DriveAddressError>(())
/// ```
///
/// Leaving it by any way, an error or a wish to stop included, closes its connections at the drives.
pub struct Session<M: Wire> {
    client: Client,
    medium: M,
    /// Says that the caller wants to stop.
    interrupted: Box<dyn FnMut() -> bool>,
    /// Says that an axis is to be stopped quickly, and that it has said so.
    hurry: Box<dyn FnMut() -> bool>,
    hurried: bool,
    /// True while a stop is carried out that must not be interrupted.
    stopping: bool,
    access: Vec<access::Access>,
    /// What turned out about the ways to drives.
    routes: Vec<route::Routes>,
    /// Follows the steps on these ways.
    route_follower: RouteFollower,
    reference: u8,
    discovery: bool,
    /// Drives can call their controller here.
    calls: bool,
    /// When somebody who waits for an answer is to be told that there is none, and how.
    silence: Option<Silence>,
    /// The drive whose axis is under control, and what it does when it loses that.
    under_control: Option<(String, Box<LossReaction>)>,
    /// Parameters that are not answered are tolerated.
    unread: Option<unread::Unread>,
    /// When parameter requests are given up at the latest.
    bound: Option<Instant>,
}

/// Somebody who waits for an answer.
struct Silence {
    due: Instant,
    tell: Box<dyn FnMut()>,
}

/// Takes the name of a drive and a step on the way to its records.
type RouteFollower = Box<dyn FnMut(&str, &RouteNotice)>;

/// How long a session that is left may still wait for each drive.
const FAREWELL: Duration = Duration::from_secs(1);

impl<M: Wire> Drop for Session<M> {
    fn drop(&mut self) {
        // nobody is left to be told that the medium failed
        let _ = self.close_within(FAREWELL);
    }
}

impl<M: Wire> std::fmt::Debug for Session<M> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Session")
            .field("client", &self.client)
            .finish_non_exhaustive()
    }
}

impl<M: Wire> Session<M> {
    /// A session of a controller on a medium.
    #[must_use]
    pub fn new(medium: M, config: ControllerConfig) -> Self {
        Self::of(medium, Client::new(config))
    }

    /// A session of the master of a serial line: its drives are named by [`LineAddress`](crate::LineAddress).
    ///
    /// Parameters travel one at a time, so that many take long. Until an axis is taken the process data sent along say
    /// that nobody has control (bit 10 of the control word is 0): no drive acts on them.
    #[must_use]
    pub fn on_line(wire: M, config: LineConfig) -> Self {
        Self::of(wire, Client::on_line(config))
    }

    fn of(medium: M, client: Client) -> Self {
        Self {
            client,
            medium,
            interrupted: Box::new(|| false),
            hurry: Box::new(|| false),
            hurried: false,
            stopping: false,
            access: Vec::new(),
            routes: Vec::new(),
            route_follower: Box::new(|_, _| {}),
            reference: 0,
            discovery: true,
            calls: true,
            silence: None,
            under_control: None,
            unread: None,
            bound: None,
        }
    }

    /// The same on a medium that carries UDP only: drives go by IP address, nothing cyclic.
    #[must_use]
    pub fn without_discovery(mut self) -> Self {
        self.discovery = false;
        self
    }

    /// The same on a medium on which drives cannot call their controller, as another program has UDP port 34964: no
    /// connection as IO controller can be made.
    #[must_use]
    pub fn without_calls(mut self) -> Self {
        self.calls = false;
        self
    }

    /// Asks `interrupted` now and then whether the caller wants to stop; calls then end with
    /// [`Error::Interrupted`]. An axis under control is stopped all the same.
    pub fn interrupt_with(&mut self, interrupted: impl FnMut() -> bool + 'static) {
        self.interrupted = Box::new(interrupted);
    }

    /// Asks `hurry` while an axis stops along its ramp, until it says yes: what remains is a quick stop (OFF3).
    pub fn hurry_with(&mut self, hurry: impl FnMut() -> bool + 'static) {
        self.hurry = Box::new(hurry);
    }

    /// True once the caller wanted a stop to be a quick one.
    fn hurries(&mut self) -> bool {
        self.hurried = self.hurried || (self.hurry)();
        self.hurried
    }

    /// The client inside.
    #[must_use]
    pub const fn client(&self) -> &Client {
        &self.client
    }

    /// The medium.
    #[must_use]
    pub const fn medium(&self) -> &M {
        &self.medium
    }

    /// The medium, to change it: cables and taps of a simulated segment.
    pub fn medium_mut(&mut self) -> &mut M {
        &mut self.medium
    }

    /// The present time of the medium.
    #[must_use]
    pub fn now(&self) -> Instant {
        self.medium.now()
    }

    /// Lets time pass; connections and axes go on.
    ///
    /// # Errors
    /// When the medium fails or the caller wants to stop.
    pub fn pass(&mut self, time: Duration) -> Result<(), Error> {
        let end = self.now() + time;
        while self.now() < end {
            self.step(end)?;
        }
        Ok(())
    }

    /// Does something that a caller's wish to stop must not interrupt: putting back what was changed.
    pub fn uninterrupted<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let stopping = std::mem::replace(&mut self.stopping, true);
        let result = work(self);
        self.stopping = stopping;
        result
    }

    /// Carries out `work`, and says once with `tell` when it takes longer than `limit`: somebody does not answer. The
    /// work goes on, as a drive may still be there.
    pub fn telling_silence<T>(
        &mut self,
        limit: Duration,
        work: impl FnOnce(&mut Self) -> T,
        tell: impl FnMut() + 'static,
    ) -> T {
        let due = self.now() + limit;
        let tell = Box::new(tell);
        let before = self.silence.replace(Silence { due, tell });
        let result = work(self);
        self.silence = before;
        result
    }

    /// Forgets the connections to a drive that is gone, without a farewell that nobody would hear.
    pub fn forget(&mut self, drive: &Drive) {
        for ar in self.accesses(drive) {
            self.drop_access(ar);
        }
    }

    /// Says whether the caller wants to stop, before something is begun that should not be interrupted.
    ///
    /// # Errors
    /// When the caller wants to stop ([`interrupt_with`](Self::interrupt_with)).
    pub fn glance(&mut self) -> Result<(), Error> {
        if !self.stopping && (self.interrupted)() {
            return Err(Error::Interrupted);
        }
        Ok(())
    }

    /// Lets one thing happen, at most until `until`.
    fn step(&mut self, until: Instant) -> Result<(), Error> {
        self.glance()?;
        let now = self.now();
        if let Some(mut silence) = self.silence.take_if(|silence| silence.due <= now) {
            (silence.tell)();
        }
        let until = until.min(now + GLANCE);
        self.medium
            .step(&mut self.client, until)
            .map_err(|error| match &self.under_control {
                // the drive hears nothing any more, wherever the way ends
                Some((drive, reaction)) => Error::CarrierLost {
                    drive: drive.clone(),
                    error: Box::new(error),
                    reaction: Some(reaction.clone()),
                },
                None => Error::Medium(Box::new(error)),
            })
    }

    /// Names the drive that is out of reach when the medium fails meanwhile.
    fn reaching<T>(
        &mut self,
        drive: &Drive,
        work: impl FnOnce(&mut Self) -> Result<T, Error>,
    ) -> Result<T, Error> {
        work(self).map_err(|error| match error {
            Error::Medium(error) => Error::CarrierLost {
                drive: drive.label(),
                error,
                reaction: None,
            },
            other => other,
        })
    }

    /// Lets things happen until `done` gives something, at most for `limit`; `None` when the time is over.
    fn wait<T>(
        &mut self,
        limit: Duration,
        mut done: impl FnMut(&mut Client) -> Option<T>,
    ) -> Result<Option<T>, Error> {
        let end = self.end_of(limit);
        loop {
            if let Some(result) = done(&mut self.client) {
                return Ok(Some(result));
            }
            if self.now() >= end {
                return Ok(None);
            }
            self.step(end)?;
        }
    }
}
