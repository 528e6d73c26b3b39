//! Control of an axis as an object: while it exists the connection is open, when it goes the axis is stopped and
//! released.

mod beside;
mod open;
mod rest;

use std::sync::Arc;
use std::time::Duration;

use profile::state::Mode;
use profile::telegram::signal;
use profinet::controller::{LostCause, ServiceError};
use profinet::cyclic::CyclicStatistics;

use super::enabled::Enabled;
use super::faults::WarningEntry;
use super::warnings::Warnings;
use super::{GLANCE, Session};
use crate::axis::{
    Evidence, Goal, Limits, MotionFacts, Move, MovePlan, Progress, Purpose, Seen, SpeedScale, SpeedUnit,
    StopKind, Strained, Travel,
};
use crate::client::AxisView;
use crate::{Connection, Drive, Error, Link, LossReaction};
use profile::value::{Beyond, is_other_value, is_rounding};
use rest::Ending;

pub use beside::{BeatHandle, Samples, StopHandle};
pub(super) use rest::Place;

/// How to run an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisSettings {
    /// The purpose of the axis: decides over the telegram, and which mode the drive must be in.
    pub purpose: Purpose,
    /// Update time; when `None` at least [`Cycle::CALM`](crate::axis::Cycle::CALM), as the drive allows it. A serial line has none.
    pub cycle: Option<Duration>,
    /// Update times without data until both sides stop; when `None` so many that they are at least
    /// [`Cycle::CALM_HOLD`](crate::axis::Cycle::CALM_HOLD), or the longest there is for [`Purpose::Observe`].
    pub watchdog: Option<u16>,
    /// The telegram to use; `None` leaves it to what the drive reports and the purpose needs.
    pub telegram: Option<u16>,
    /// Unit of speeds.
    pub unit: SpeedUnit,
    /// Speed in rpm that is 100 % of the reference, for a drive that does not report it.
    pub reference_speed: Option<f64>,
    /// Highest speed that may be requested, in that unit.
    pub speed_limit: f64,
    /// How much longer than the ramp of the drive is reckoned to need stopping may take before the quick stop is used.
    pub stop: Duration,
    /// How long the axis stays in operation without a call: then it is brought to rest along its ramp, whatever became of
    /// the program. Every call for the axis that waits puts that off, and so does [`Axis::renew`].
    pub lease: Duration,
    /// Consent to enable an axis that no setting of the drive stops when its controller is lost: after a broken line or the
    /// death of this program nothing stops it. Without it such an axis is not taken for a motion ([`Error::RunsOn`]).
    pub may_run_on: bool,
}

impl Default for AxisSettings {
    fn default() -> Self {
        Self {
            purpose: Purpose::Speed,
            cycle: None,
            watchdog: None,
            telegram: None,
            unit: SpeedUnit::Rpm,
            reference_speed: None,
            speed_limit: 3000.0,
            stop: Duration::from_secs(10),
            lease: Duration::from_secs(5),
            may_run_on: false,
        }
    }
}

impl AxisSettings {
    /// The usual settings for a purpose.
    ///
    /// ```
    /// use profidrive_client::{AxisSettings, axis::Purpose};
    /// assert_eq!(AxisSettings::for_purpose(Purpose::Move).speed_limit, 3000.0);
    /// ```
    #[must_use]
    pub fn for_purpose(purpose: Purpose) -> Self {
        Self {
            purpose,
            ..Self::default()
        }
    }
}

/// What taking an axis would be: see [`Session::plan_axis`].
#[derive(Debug, Clone, PartialEq)]
pub struct AxisPlan {
    /// The telegram it would use.
    pub telegram: u16,
    /// The telegram that the drive reports now (PNU 922).
    pub telegram_before: Option<u16>,
    scale: SpeedScale,
}

impl AxisPlan {
    /// Returns the speed as sent for this one, in the unit of the settings: the nearest step of the setpoint.
    ///
    /// # Errors
    /// A speed that is not representable: see [`Session::check_speed`].
    pub fn rounded_speed_for(&self, drive: &Drive, speed: f64) -> Result<f64, Error> {
        speed_setpoint(drive, &self.scale, speed).map(|raw| self.scale.speed(raw))
    }
}

/// An axis at a glance, in engineering units. What its telegram does not carry is `None`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisStatus {
    /// Goal, progress, words.
    pub view: AxisView,
    /// What the speeds are in.
    pub unit: SpeedUnit,
    /// Speed requested.
    pub speed_set: Option<f64>,
    /// Speed of the motor.
    pub speed_actual: Option<f64>,
    /// The speed signal is at the end of its range: the motor may turn faster than reported.
    pub speed_beyond: Option<Beyond>,
    /// Where the task under way leads, in turns, as far as it is known here.
    pub target: Option<f64>,
    /// Where the axis is, in turns.
    pub position: Option<f64>,
    /// Position command minus position, in turns.
    pub following_error: Option<f64>,
    /// Time since control was taken.
    pub time: Duration,
    /// The connection is lost: all of this is what the drive reported last.
    pub lost: bool,
}

/// How an axis is when control of it is given back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rest {
    /// The drive reports nothing any more, or was not under control.
    #[default]
    Unknown,
    /// It does not turn, as far as the drive reports.
    Stands,
    /// It turns with its power stage off: it coasts, or something moves it.
    Coasts,
    /// It turns with its power stage on: control of it was not taken.
    Runs,
}

impl Rest {
    /// Stable name for programs.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Stands => "stands",
            Self::Coasts => "coasts",
            Self::Runs => "runs",
        }
    }
}

/// How control of an axis was given back.
#[derive(Debug)]
pub struct Released {
    /// How the axis was then.
    pub rest: Rest,
    /// Its connection was closed in order.
    pub closed: bool,
    /// The caller has made its ramp a quick stop ([`Session::hurry_with`]).
    pub hurried: bool,
    /// Why it did not end as it was to: a connection lost before the axis was at rest, a fault on the ramp, an axis that
    /// still turns.
    pub result: Result<(), Error>,
}

/// Callback for the status of the axis while calls wait.
pub type Watcher = Box<dyn FnMut(&AxisStatus) + Send>;

/// Callback for warnings as they come, by number where the drive has numbers.
pub type WarningWatcher = Box<dyn FnMut(&AxisStatus, &[WarningEntry]) + Send>;

/// An axis under control.
///
/// Dropping it, for whatever reason, ends in a ramp stop and a release, which the driver of the network sees to: the drop
/// itself does not wait. It may go to another thread, and cannot be moved before it is enabled: only
/// [`enable`](Self::enable) gives the [`Enabled`] that has motions.
///
/// Operation ends by itself [some time](AxisSettings::lease) after the last call for the axis.
///
/// ```
/// use profidrive_client::{Axis, Error};
/// async fn turn(axis: &mut Axis) -> Result<(), Error> {
///     let mut enabled = axis.enable().await?;
///     enabled.run(60.0).await?;
///     enabled.hold(std::time::Duration::from_secs(1)).await?;
///     enabled.disable().await // dropping it stops too
/// }
/// ```
///
/// Without it there is nothing to call:
///
/// ```compile_fail,E0599
/// use profidrive_client::{Axis, Error};
/// async fn turn(axis: &mut Axis) -> Result<(), Error> {
///     axis.run(60.0).await
/// }
/// ```
pub struct Axis {
    pub(super) session: Session,
    pub(super) drive: Drive,
    link: Link,
    pub(super) settings: AxisSettings,
    cycle: Duration,
    /// The cycle of the connection if this computer does not keep to it.
    strained: Option<Strained>,
    telegram: u16,
    /// The telegram that the drive had before (PNU 922).
    telegram_before: Option<u16>,
    /// What the numbers of its speeds mean.
    pub(super) scale: SpeedScale,
    /// Ramps of the drive in the unit of the speeds a second.
    pub(super) acceleration: Option<f64>,
    pub(super) deceleration: Option<f64>,
    /// What the drive reported about a motion without progress.
    pub(super) evidence: Option<Evidence>,
    /// What the drive does when this connection is lost.
    loss: Box<LossReaction>,
    /// Where the move under way leads, in turns.
    pub(super) target: Option<f64>,
    begun: profinet::Instant,
    pub(super) watcher: Option<Watcher>,
    pub(super) warnings: Warnings,
    /// The trouble there is was returned to the caller.
    reported: bool,
    /// State of the task that brings it to rest.
    pub(super) ending: Arc<Ending>,
}

impl std::fmt::Debug for Axis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Axis")
            .field("drive", &self.drive.label())
            .field("link", &self.link)
            .finish_non_exhaustive()
    }
}

/// The number of a speed that a person requested: the nearest step, if that is the same speed.
pub(super) fn speed_setpoint(drive: &Drive, scale: &SpeedScale, speed: f64) -> Result<i16, Error> {
    let unit = scale.unit().symbol();
    let Some(raw) = scale.raw(speed) else {
        let named = drive
            .named(&[profile::catalogue::Part::VelocityScaling])
            .into_iter()
            .next();
        return Err(Error::SpeedRange {
            drive: drive.label(),
            wanted: speed,
            highest: scale.speed(i16::MAX).copysign(speed),
            unit,
            scaling: named.map(|name| (name, drive.parameters.scaling.velocity)),
        });
    };
    let rounded = scale.speed(raw);
    if !is_other_value(speed, rounded) {
        return Ok(raw);
    }
    let beside = if rounded > speed {
        raw.saturating_sub(1)
    } else {
        raw.saturating_add(1)
    };
    let other = scale.speed(beside);
    Err(Error::SpeedStep {
        drive: drive.label(),
        wanted: speed,
        nearest: [rounded.min(other), rounded.max(other)],
        unit,
    })
}

impl Axis {
    /// Shows the axis to `watcher` after everything that happens while calls wait.
    pub fn watch(&mut self, watcher: impl FnMut(&AxisStatus) + Send + 'static) {
        self.watcher = Some(Box::new(watcher));
    }

    /// Calls `watcher` for each new warning (ZSW1 bit 7) while calls wait. A drive that has no number for its warning
    /// gives an empty list.
    pub fn watch_warnings(&mut self, watcher: impl FnMut(&AxisStatus, &[WarningEntry]) + Send + 'static) {
        self.warnings.watch(Box::new(watcher));
    }

    /// Returns the rounded speed if it differs from this one: the setpoint has steps. `None` too when it is not
    /// representable, which [`run`](Enabled::run) refuses.
    #[must_use]
    pub fn rounded_speed(&self, speed: f64) -> Option<f64> {
        let rounded = self.scale.speed(self.scale.raw(speed)?);
        is_rounding(speed, rounded).then_some(rounded)
    }

    /// The drive.
    #[must_use]
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// Number of the telegram in use.
    #[must_use]
    pub const fn telegram(&self) -> u16 {
        self.telegram
    }

    /// The telegram that the drive had before (PNU 922), if it is another one: the drive keeps the one in use.
    #[must_use]
    pub fn telegram_before(&self) -> Option<u16> {
        self.telegram_before.filter(|&before| before != self.telegram)
    }

    /// The update time in use.
    #[must_use]
    pub const fn cycle(&self) -> Duration {
        self.cycle
    }

    /// What is wrong with the cycle of the connection, by the delays that this computer showed before anything was
    /// enabled. `None` where the cycle fits, on a serial line, and for [`Purpose::Control`], which is not measured.
    #[must_use]
    pub const fn strained(&self) -> Option<Strained> {
        self.strained
    }

    /// The session, for parameters beside the running axis.
    pub const fn session(&mut self) -> (&mut Session, &mut Drive) {
        (&mut self.session, &mut self.drive)
    }

    /// The axis as it is now.
    #[must_use]
    pub fn status(&self) -> Option<AxisStatus> {
        let view = self.session.client().axis(self.link)?;
        Some(AxisStatus {
            view,
            unit: self.scale.unit(),
            speed_set: (view.mode == Mode::Velocity).then(|| self.scale.speed(view.command.nsoll_a)),
            speed_actual: view.seen.and_then(|seen| Some(self.scale.speed(seen.nist_a?))),
            speed_beyond: view.seen.and_then(|seen| Beyond::of(seen.nist_a?)),
            target: self
                .target
                .filter(|_| matches!(view.goal, Goal::Traverse(_) | Goal::Pause)),
            position: view.seen.and_then(|seen| Some(self.turns(seen.xist_a?))),
            following_error: view.seen.and_then(|seen| Some(self.turns(seen.xist_error?))),
            time: self.session.now() - self.begun,
            lost: matches!(self.session.connection(self.link), Connection::Lost(_)),
        })
    }

    /// Counters of the cyclic connection; a serial line has none.
    #[must_use]
    pub fn statistics(&self) -> Option<CyclicStatistics> {
        match self.link {
            Link::ArListEntry(ar) => self.session.client().controller_ref().statistics(ar),
            Link::Slave(_) => None,
        }
    }

    /// Takes control and gets ready for switching on (S2).
    ///
    /// # Errors
    /// When the drive does not follow, the connection is lost or the caller requests a stop.
    pub async fn ready(&mut self) -> Result<(), Error> {
        self.reach(Goal::Ready).await
    }

    /// As [`ready`](Self::ready), but content with a fault that waits to be acknowledged.
    ///
    /// # Errors
    /// When the connection is lost or the caller requests a stop.
    pub async fn ready_or_fault(&mut self) -> Result<(), Error> {
        self.pursue(Goal::Ready);
        let fault = |status: &AxisStatus| status.view.seen.is_some_and(Seen::fault);
        let ready = |status: &AxisStatus| status.view.progress == Progress::Reached;
        self.hold_until(Limits::default().step, |status| fault(status) || ready(status))
            .await
            .map(|_| ())
    }

    /// Switches on and stands (S4): the axis can be moved as long as what this returns lives, and stops when it goes.
    ///
    /// Setpoints are preset first: speed 0, target of a move where the axis is.
    ///
    /// # Errors
    /// [`Error::RunsOn`] without the consent that the drive requires, earlier trouble with the motion that was not
    /// returned yet, and as [`ready`](Self::ready).
    pub async fn enable(&mut self) -> Result<Enabled<'_>, Error> {
        // an axis of `Purpose::Control` is taken without this check
        self.loss.permit(&self.drive, self.settings.may_run_on)?;
        // an axis that stopped by itself is not started again before the caller knows
        self.check_reported().await?;
        self.target = None;
        self.reach(Goal::Enabled).await?;
        Ok(Enabled::new(self))
    }

    /// What a move would be, and everything that speaks against it. Reads only.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn plan(&mut self, order: &Move) -> Result<MovePlan, Error> {
        let limit = self.settings.speed_limit;
        let seen = self
            .status()
            .and_then(|status| Some((status.view.seen?, status.position)));
        let mut drive = self.drive.clone();
        let facts = self.session.motion_facts(&mut drive).await?;
        let facts = MotionFacts {
            // the telegram is newer
            position: seen.and_then(|(_, position)| position).or(facts.position),
            homed: seen.map(|(seen, _)| seen.homed()).or(facts.homed),
            fault: seen.map(|(seen, _)| seen.fault()).or(facts.fault),
            ..facts
        };
        self.session.plan_with(&drive, order, &facts, limit)
    }

    /// Increments in turns.
    fn turns(&self, counts: i32) -> f64 {
        f64::from(counts) / self.drive.counts_per_turn()
    }

    /// Acknowledges a fault.
    ///
    /// # Errors
    /// When the fault stays, and as [`ready`](Self::ready).
    pub async fn acknowledge(&mut self) -> Result<(), Error> {
        self.reach(Goal::Acknowledge).await
    }

    /// Ramp stop (OFF1); returns once the pulses are off. A caller's wish to stop does not interrupt it.
    ///
    /// # Errors
    /// When the axis does not come to a standstill or the connection is lost.
    pub async fn stop(&mut self) -> Result<(), Error> {
        self.stop_by(StopKind::Ramp).await
    }

    /// Quick stop (OFF3), likewise.
    ///
    /// # Errors
    /// As [`stop`](Self::stop).
    pub async fn quick_stop(&mut self) -> Result<(), Error> {
        self.stop_by(StopKind::Quick).await
    }

    async fn stop_by(&mut self, way: StopKind) -> Result<(), Error> {
        let _meanwhile = self.session.unstoppable();
        self.begin_stop_by(way);
        self.arrive(None, "", |status| status.view.progress == Progress::Reached)
            .await
            .map(|_| ())
    }

    /// True when the axis turns with its power stage off and was so before control was taken: it coasts, or something
    /// moves it. Nothing that is commanded here ends that.
    #[must_use]
    pub fn coasts(&self) -> bool {
        let off = |view: &AxisView| view.seen.is_some_and(Seen::pulses_off);
        let view = self.status().map(|status| status.view);
        view.is_some_and(|view| !view.operated && view.turns && off(&view))
    }

    /// Keeps what was reached for `time`.
    ///
    /// # Errors
    /// As soon as the drive leaves it, the connection is lost or the caller requests a stop.
    pub async fn hold(&mut self, time: Duration) -> Result<(), Error> {
        self.hold_until(time, |_| false).await.map(|_| ())
    }

    /// Keeps what was reached until `enough`, at most for `time`; true if it was enough.
    ///
    /// # Errors
    /// As [`hold`](Self::hold).
    pub async fn hold_until(
        &mut self,
        time: Duration,
        mut enough: impl FnMut(&AxisStatus) -> bool,
    ) -> Result<bool, Error> {
        let end = self.session.now() + time;
        loop {
            let status = {
                let _meanwhile = self.session.bound_by(end);
                self.look().await
            };
            if enough(&status?) {
                return Ok(true);
            }
            if self.session.now() >= end {
                return Ok(false);
            }
            self.session.step(end).await?;
        }
    }

    pub(super) fn pursue(&mut self, goal: Goal) {
        let now = self.session.now();
        self.reported = false;
        self.ending.note_returned(None);
        self.session.client().pursue(now, self.link, goal);
    }

    /// Returns the trouble that ended the last motion, where no call has returned it yet: the axis stopped by itself meanwhile.
    ///
    /// # Errors
    /// That trouble, and a connection that is lost.
    pub async fn check_reported(&mut self) -> Result<(), Error> {
        if self.reported {
            return Ok(());
        }
        self.look().await.map(|_| ())
    }

    /// Returns whether the axis does what it was commanded: its connection is there, and there is no trouble that no call has
    /// returned yet.
    #[must_use]
    pub fn goes_on(&self) -> bool {
        let fails = |status: AxisStatus| matches!(status.view.progress, Progress::Failed(_));
        let is_there = !self.ending.is_reported() && self.lost().is_none();
        self.reported || is_there && self.status().is_some_and(|status| !fails(status))
    }

    async fn reach(&mut self, goal: Goal) -> Result<(), Error> {
        self.stopped().await?;
        self.pursue(goal);
        self.arrive(None, "", |status| status.view.progress == Progress::Reached)
            .await
            .map(|_| ())
    }

    /// Waits for the end of a stop under way, as the one that begins when an [`Enabled`] is dropped. The release
    /// returns its result.
    ///
    /// # Errors
    /// When the wire fails. A caller's wish to stop does not interrupt it.
    pub async fn stopped(&mut self) -> Result<(), Error> {
        let _meanwhile = self.session.unstoppable();
        let stops = |view: &AxisView| view.goal == Goal::Stop && !view.at_rest;
        while self.status().is_some_and(|status| stops(&status.view)) && self.lost().is_none() {
            // the trouble that began the stop is no end of it
            if !matches!(self.look().await, Ok(_) | Err(Error::Axis { .. })) {
                return Ok(());
            }
            self.session.look_again().await?;
        }
        Ok(())
    }

    /// Waits until `enough`, for no longer than `limit`.
    pub(super) async fn arrive(
        &mut self,
        limit: Option<Duration>,
        what: &'static str,
        mut enough: impl FnMut(&AxisStatus) -> bool,
    ) -> Result<AxisStatus, Error> {
        let begin = self.session.now();
        loop {
            let status = {
                let _meanwhile = limit.map(|limit| self.session.bound_by(begin + limit));
                let status = self.look().await;
                if status.as_ref().is_ok_and(|status| status.view.stays_away) {
                    self.gather().await;
                }
                status?
            };
            if enough(&status) {
                return Ok(status);
            }
            if let Some(limit) = limit.filter(|&limit| self.session.now() - begin >= limit) {
                return Err(Error::NotInTime {
                    drive: self.drive.label(),
                    what,
                    limit,
                });
            }
            // the control has its own limits and fails
            let soon = self.session.now() + GLANCE;
            let end = limit.map_or(soon, |limit| begin + limit);
            self.session.step(end.min(soon)).await?;
        }
    }

    /// Shows the axis to its observers.
    fn show(&mut self) -> Option<AxisStatus> {
        let status = self.status();
        if let (Some(watcher), Some(status)) = (&mut self.watcher, &status) {
            watcher(status);
        }
        status
    }

    /// Puts off the end of operation: see [`AxisSettings::lease`].
    pub fn renew(&self) {
        let deadline = self.session.now() + self.settings.lease;
        let engine = self.session.engine();
        engine.quietly().set_deadline(self.link, Some(deadline));
    }

    /// Keeps a motion going for this time from now on: without another beat the axis is halted along its ramp and stays in
    /// operation, whatever the caller does. For motions that last while a person holds a button. From the first beat on every motion
    /// needs one, before it begins too; `None` ends that.
    pub fn beat(&self, time: Option<Duration>) {
        let beat = time.map(|time| self.session.now() + time);
        self.session.engine().quietly().set_beat(self.link, beat);
    }

    /// Limits how far the axis may go from where it is now, in turns both ways: a motion that would leave that is halted along the
    /// ramp in time, by the position in the telegram, else by its speed. Returns false, and limits nothing, where the telegram has
    /// neither, or the speed is not known in rpm.
    #[must_use]
    pub fn limit_travel(&self, turns: f64) -> bool {
        let per_step = (self.scale.unit() == SpeedUnit::Rpm).then(|| self.scale.speed(1) / 60.0);
        let signals = self.signals();
        let has = |number| {
            signals
                .iter()
                .any(|one| !one.is_setpoint && one.field.signal.number == number)
        };
        let known = has(signal::XIST_A) || (has(signal::NIST_A) && per_step.is_some());
        let ramp = self.deceleration.map(|ramp| ramp / 60.0);
        let travel = Travel::new(turns, 1.0 / self.drive.counts_per_turn(), per_step, ramp);
        if known {
            self.session.client().set_travel(self.link, Some(travel));
        }
        known
    }

    /// Returns how far the axis is and may go; `None` where that is not limited.
    #[must_use]
    pub fn travel(&self) -> Option<Travel> {
        self.session.client().travel(self.link)
    }

    /// Returns the axis in operation, where it was left there: see [`Enabled::leave`].
    pub fn operation(&mut self) -> Option<Enabled<'_>> {
        self.operates().then(|| Enabled::new(self))
    }

    /// Returns whether the axis is in operation, or on the way there.
    #[must_use]
    pub fn operates(&self) -> bool {
        let operates = |status: AxisStatus| status.view.goal.operates() && !status.lost;
        self.status().is_some_and(operates)
    }

    /// Calls the watcher and returns the trouble of the axis.
    pub(super) async fn look(&mut self) -> Result<AxisStatus, Error> {
        let status = self.show();
        if self.ending.is_reported() {
            return Err(Error::Closed);
        }
        if let Some(error) = self.lost() {
            return Err(error);
        }
        let Some(status) = status else {
            let what = "cyclic data";
            return Err(self.connection_lost(LostCause::Service(ServiceError::Closed { what })));
        };
        self.renew();
        self.session.hurry_on(self.link, &status.view);
        match status.view.progress {
            Progress::Failed(trouble) => {
                self.reported = true;
                self.ending.note_returned(Some(trouble));
                Err(Error::Axis {
                    drive: self.drive.label(),
                    trouble,
                })
            }
            Progress::Pursuing | Progress::Reached => {
                self.look_for_warnings(&status).await;
                Ok(status)
            }
        }
    }

    /// What the drive does when the connection of the axis is lost, by its settings at the time control was taken.
    #[must_use]
    pub const fn loss_reaction(&self) -> &LossReaction {
        &self.loss
    }

    /// Returns the error of a connection that is gone, with what the drive does without it.
    #[must_use]
    pub fn lost(&self) -> Option<Error> {
        rest::lost(&self.drive, self.connection(), &self.loss)
    }

    fn connection_lost(&self, cause: LostCause) -> Error {
        Error::ConnectionLost {
            drive: self.drive.label(),
            cause,
            reaction: Some(self.loss.clone()),
        }
    }

    /// What became of the connection.
    pub(super) fn connection(&self) -> Connection {
        self.session.connection(self.link)
    }
}
