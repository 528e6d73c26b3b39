//! An axis in operation: the only thing here that has motions.

use std::ops::{Deref, DerefMut};
use std::time::Duration;

use profile::state::Mode;
use profinet::Instant;

use super::axis::{AxisStatus, speed_setpoint};
use super::scaling::SCALE_AGE;
use super::{Axis, GLANCE, HomingSpeed};
use crate::axis::{Evidence, Goal, Jog, Move, MovePlan, Progress, SpeedUnit, Traverse};
use crate::{Connection, Error, MoveEnd};

/// How much longer than reckoned a move may take: this many times, and this much more.
const ALLOWANCE: (u32, Duration) = (3, Duration::from_secs(10));
/// The same for coming up to a speed.
const SPEED_TIMEOUT: (u32, Duration) = (2, Duration::from_secs(5));
/// How near the speed has to be, as a share of it.
const SPEED_NEAR: f64 = 0.03;
/// How long an axis that had its speed may be away from it.
const AWAY: Duration = Duration::from_secs(1);
/// Part of a revolution that an axis has moved for certain.
const MOVED: f64 = 0.001;

/// An enabled axis (S4). Dropping it, for whatever reason, ends in a ramp stop.
///
/// It stands for operation that was reached. When the drive leaves it, by a fault for example, every motion returns
/// what happened and nothing is sent: the axis has to be enabled again.
pub struct Enabled<'a> {
    axis: &'a mut Axis,
    /// Dropping it stops the axis.
    stops: bool,
}

impl std::fmt::Debug for Enabled<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Enabled").field(&self.axis).finish()
    }
}

impl Deref for Enabled<'_> {
    type Target = Axis;

    fn deref(&self) -> &Self::Target {
        self.axis
    }
}

impl DerefMut for Enabled<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        self.axis
    }
}

impl<'a> Enabled<'a> {
    pub(super) const fn new(axis: &'a mut Axis) -> Self {
        Self { axis, stops: true }
    }

    /// Follows this speed from now on, in the unit of the axis ([`AxisSettings::unit`](crate::AxisSettings::unit)): rpm if
    /// nothing else was set.
    ///
    /// # Errors
    /// A speed above the limit or one that is not representable ([`Session::check_speed`](crate::Session::check_speed)),
    /// a drive in position mode, and when the axis is not enabled any more.
    pub async fn run(&mut self, rpm: f64) -> Result<(), Error> {
        let limit = self.axis.settings.speed_limit;
        if rpm.is_nan() || rpm.abs() > limit {
            return Err(Error::SpeedLimit {
                wanted: rpm,
                limit,
                unit: self.axis.scale.unit().symbol(),
            });
        }
        let setpoint = speed_setpoint(&self.axis.drive, &self.axis.scale, rpm)?;
        self.axis.ending.note_speed(rpm.abs());
        self.axis.evidence = None;
        self.reach(Goal::Run { setpoint }, None, "").await.map(|_| ())
    }

    /// Follows this speed from now on, in rpm, and returns once the axis has it: by NIST_A, or by ZSW1 bit 10 where the
    /// telegram carries no speed. Without a `limit` it may take somewhat longer than the ramp of the drive needs.
    ///
    /// # Errors
    /// When the axis does not come up to the speed, and as [`run`](Self::run).
    pub async fn reach_speed(&mut self, rpm: f64, limit: Option<Duration>) -> Result<(), Error> {
        self.run(rpm).await?;
        let limit = limit.unwrap_or_else(|| self.speed_time(rpm) * SPEED_TIMEOUT.0 + SPEED_TIMEOUT.1);
        let begin = self.axis.session.now();
        let mut highest: Option<f64> = None;
        loop {
            let status = self.axis.look().await?;
            if has_speed(&status, rpm) {
                return Ok(());
            }
            if let Some(actual) = status.speed_actual {
                let faster = highest.is_none_or(|highest| (actual - highest) * rpm.signum() > 0.0);
                highest = if faster { Some(actual) } else { highest };
            }
            if self.axis.session.now() - begin >= limit {
                self.axis.gather().await;
                return Err(self.axis.with_evidence(Error::SpeedNotReached {
                    drive: self.axis.drive.label(),
                    wanted: rpm,
                    highest,
                    limit,
                    unit: self.axis.scale.unit().symbol(),
                }));
            }
            let soon = self.axis.session.now() + GLANCE;
            self.axis.session.step(soon.min(begin + limit)).await?;
        }
    }

    /// Keeps the speed that [`reach_speed`](Self::reach_speed) has reached for `time`.
    ///
    /// # Errors
    /// When the axis does not follow any more for a second, when another client changes the scale of its speeds, and as
    /// [`hold`](Axis::hold).
    pub async fn keep_speed(&mut self, rpm: f64, time: Duration) -> Result<(), Error> {
        let end = self.axis.session.now() + time;
        // no parameter makes the motion longer
        let _meanwhile = self.axis.session.bound_by(end);
        self.keep_until(rpm, end).await
    }

    async fn keep_until(&mut self, rpm: f64, end: Instant) -> Result<(), Error> {
        let mut followed = self.axis.session.now();
        let mut checked = followed;
        loop {
            let status = self.axis.look().await?;
            let now = self.axis.session.now();
            if has_speed(&status, rpm) {
                followed = now;
            } else if now - followed >= AWAY {
                self.check_scale(now + SCALE_AGE).await?;
                self.axis.gather().await;
                return Err(self.axis.with_evidence(Error::SpeedLost {
                    drive: self.axis.drive.label(),
                    wanted: rpm,
                    actual: status.speed_actual,
                    time: now - followed,
                    unit: self.axis.scale.unit().symbol(),
                }));
            }
            if now >= end {
                return Ok(());
            }
            if now - checked >= SCALE_AGE {
                self.check_scale(followed + AWAY).await?;
                checked = self.axis.session.now();
            }
            let soon = (checked + SCALE_AGE).min(followed + AWAY).min(end);
            self.axis
                .session
                .step(soon.max(now + Duration::from_millis(1)))
                .await?;
        }
    }

    /// The setpoint means what it meant when the axis was taken, as far as the drive reports it until `due`. On a serial line
    /// the setpoint has a scale of its own.
    async fn check_scale(&mut self, due: Instant) -> Result<(), Error> {
        if self.axis.drive.is_on_line() {
            return Ok(());
        }
        let mut drive = self.axis.drive.clone();
        drive.scaled_at = None;
        let session = &mut self.axis.session;
        let scale = {
            let _meanwhile = session.bound_by(due);
            session.read_scaling(&mut drive).await
        };
        match scale {
            Ok(()) => {}
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            // a lost connection is seen by the exchange of data; a parameter channel that is busy is tried again
            Err(_) => return Ok(()),
        }
        let before = self.axis.drive.parameters.scaling.velocity;
        let now = drive.parameters.scaling.velocity;
        if now == before {
            return Ok(());
        }
        Err(Error::ScaleChanged {
            drive: self.axis.drive.label(),
            before,
            now,
        })
    }

    /// Returns the duration of the drive's ramp up to this speed, if the drive reports its ramp.
    #[must_use]
    pub fn speed_time(&self, rpm: f64) -> Duration {
        self.axis
            .acceleration
            .and_then(|ramp| Duration::try_from_secs_f64(rpm.abs() / ramp).ok())
            .unwrap_or_default()
    }

    /// Jogs at one of the drive's jog setpoints.
    ///
    /// # Errors
    /// When the axis does not come to a standstill first, or is not enabled any more.
    pub async fn jog(&mut self, jog: Jog) -> Result<(), Error> {
        self.reach(Goal::Jog(jog), None, "").await.map(|_| ())
    }

    /// Jogs at a speed given from here, in rpm, with the ramps of the drive (real-time jogging, STW1 bits 12 and 13). Called
    /// again while it jogs, the other speed is taken on the fly. [`halt`](Self::halt) ends it.
    ///
    /// # Errors
    /// A speed above the limits ([`Session::check_jog`](crate::Session::check_jog)), a drive in velocity mode, and as [`jog`](Self::jog).
    pub async fn jog_at(&mut self, rpm: f64) -> Result<(), Error> {
        let limit = self.axis.settings.speed_limit;
        if rpm.is_nan() || rpm.abs() > limit {
            return Err(Error::SpeedLimit {
                wanted: rpm,
                limit,
                unit: SpeedUnit::Rpm.symbol(),
            });
        }
        let ramps = [self.axis.acceleration, self.axis.deceleration];
        let mut drive = self.axis.drive.clone();
        let plan = self.axis.session.plan_jog(&mut drive, rpm, ramps, limit).await?;
        self.axis.ending.note_speed(plan.speed);
        self.axis.evidence = None;
        let goal = Goal::RealTimeJog {
            values: plan.traverse,
            backwards: rpm < 0.0,
        };
        self.reach(goal, None, "").await.map(|_| ())
    }

    /// Keeps a jog at this speed, in rpm, for `time`.
    ///
    /// # Errors
    /// When the axis did not move at all in that time, as far as its telegram contains it, and as [`hold`](Axis::hold).
    pub async fn keep_jog(&mut self, rpm: f64, time: Duration) -> Result<(), Error> {
        let mut seen = Moved::new(rpm);
        self.axis
            .hold_until(time, |status| {
                seen.look(status);
                false
            })
            .await?;
        if seen.moved != Some(false) {
            return Ok(());
        }
        self.axis.gather().await;
        Err(self.axis.with_evidence(Error::NotMoved {
            drive: self.axis.drive.label(),
            wanted: rpm,
            highest: seen.highest,
            time,
            unit: self.axis.scale.unit().symbol(),
        }))
    }

    /// Returns the reason why an axis stands though it was commanded to jog, as far as the drive reports it.
    pub async fn held_back(&mut self) -> Option<Evidence> {
        let status = self.axis.status()?;
        let reports_rest = status.view.mode == Mode::Position || status.speed_actual.is_some();
        if status.view.turns || !reports_rest {
            return None;
        }
        self.axis.gather().await;
        self.axis.evidence.filter(|evidence| evidence.cause().is_some())
    }

    /// Starts a move; returns once the drive has accepted it. A move under way is replaced on the fly.
    ///
    /// # Errors
    /// When something speaks against it, the drive does not accept it, or the axis is not enabled any more.
    pub async fn start(&mut self, plan: &MovePlan) -> Result<(), Error> {
        if !plan.objections.is_empty() {
            return Err(Error::Objections {
                drive: self.axis.drive.label(),
                objections: plan.objections.clone(),
            });
        }
        self.axis.ending.note_speed(plan.speed);
        self.begin(plan.traverse, plan.target).await
    }

    /// Starts a task of the drive's table; returns once the drive has accepted it.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub async fn start_task(&mut self, number: u16) -> Result<(), Error> {
        self.begin(Traverse::task(number), None).await
    }

    /// Plans a move, starts it and waits until the target is reached.
    ///
    /// # Errors
    /// As [`start`](Self::start), and when the target is not reached.
    pub async fn move_to(&mut self, order: &Move) -> Result<AxisStatus, Error> {
        let plan = self.axis.plan(order).await?;
        self.start(&plan).await?;
        let limit = plan
            .duration
            .map(|seconds| Duration::from_secs_f64(seconds) * ALLOWANCE.0 + ALLOWANCE.1);
        self.reach_target(limit).await
    }

    /// Waits until the task under way is at its target, or homing has ended; returns how the axis was at that moment.
    ///
    /// # Errors
    /// When it takes longer than `limit`, the axis stops elsewhere, the drive leaves operation, the connection is lost
    /// or the caller requests a stop. The motion is still under way then until this object goes. [`Error::MoveEnded`] when
    /// something halts or pauses it first: the axis stands then, and not at the target.
    pub async fn reach_target(&mut self, limit: Option<Duration>) -> Result<AxisStatus, Error> {
        let result = self
            .axis
            .arrive(limit, "reaching the target", |status| {
                status.view.progress == Progress::Reached
            })
            .await;
        if let Err(Error::NotInTime { .. }) = &result {
            self.axis.gather().await;
        }
        let status = result.map_err(|error| self.axis.with_evidence(error))?;
        // a halt and a pause are goals of their own, which are reached at standstill wherever that is
        let end = match status.view.goal {
            Goal::Traverse(_) | Goal::Home { .. } => return Ok(status),
            Goal::Pause => MoveEnd::Paused,
            _ if status.view.travel_ended => MoveEnd::Travel,
            goal if !goal.moves() => MoveEnd::Halted,
            _ => {
                let nothing = "a target is waited for while no move is under way";
                return Err(profinet::controller::Misuse::Range(nothing).into());
            }
        };
        Err(Error::MoveEnded {
            drive: self.axis.drive.label(),
            end,
            position: status.position,
            target: self.axis.target,
        })
    }

    /// Homes the axis as the drive is set up (HOME.MODE) and waits for the end.
    ///
    /// # Errors
    /// When homing does not begin, fails, is halted before its end or takes longer than `limit`, and as [`start`](Self::start).
    pub async fn home(&mut self, limit: Option<Duration>) -> Result<(), Error> {
        let mut drive = self.axis.drive.clone();
        let speed = self.axis.session.homing_speed(&mut drive).await?;
        let on_the_spot = speed == HomingSpeed::None;
        let end = self.reach(Goal::Home { on_the_spot }, limit, "homing").await?;
        // a halt has a goal of its own, which is reached too
        let homed = end.view.seen.is_some_and(crate::axis::Seen::homed);
        match end.view.goal {
            Goal::Home { .. } if homed => Ok(()),
            _ => Err(Error::HomingEnded {
                drive: self.axis.drive.label(),
                by_travel: end.view.travel_ended,
            }),
        }
    }

    /// Intermediate stop: the task stays, [`resume`](Self::resume) goes on with it. Returns at standstill.
    ///
    /// # Errors
    /// When the axis does not come to a standstill, or is not enabled any more.
    pub async fn pause(&mut self) -> Result<(), Error> {
        self.reach(Goal::Pause, None, "").await.map(|_| ())
    }

    /// Goes on with the task that a pause holds.
    ///
    /// # Errors
    /// When no task is held, or the axis is not enabled any more.
    pub async fn resume(&mut self) -> Result<(), Error> {
        let status = self.axis.look().await?;
        let held = status.view.held.ok_or(profinet::controller::Misuse::Range(
            "resume without a paused task",
        ))?;
        self.pursue_enabled(Goal::Traverse(held)).await
    }

    /// Stops along the ramp and stays enabled; a task is discarded. Returns at standstill.
    ///
    /// # Errors
    /// When the axis does not come to a standstill, or is not enabled any more.
    pub async fn halt(&mut self) -> Result<(), Error> {
        let speed = self.axis.status().and_then(|status| status.speed_actual);
        let limit = self.axis.ending.stop_limit(speed, self.axis.deceleration);
        self.reach(Goal::Enabled, None, "").await?;
        // in velocity mode the goal is reached with its setpoint, before the ramp ends
        self.axis
            .arrive(Some(limit), "coming to a standstill", |status| !status.view.turns)
            .await
            .map(|_| ())
    }

    /// Ramp stop (OFF1) and the end of operation.
    ///
    /// # Errors
    /// When the axis does not come to a standstill or the connection is lost.
    pub async fn disable(self) -> Result<(), Error> {
        self.axis.stop().await
    }

    /// Leaves the axis in operation, with the motion that is under way: [`Axis::operation`] goes on with it. It ends with
    /// its lease ([`AxisSettings::lease`](crate::AxisSettings::lease)) and with the axis.
    pub fn leave(mut self) {
        self.stops = false;
    }

    async fn begin(&mut self, traverse: Traverse, target: Option<f64>) -> Result<(), Error> {
        self.pursue_enabled(Goal::Traverse(traverse)).await?;
        self.axis.evidence = None;
        self.axis.target = target;
        // the control has its own limit for the handshake
        self.axis
            .arrive(None, "", |status| status.view.accepted)
            .await
            .map(|_| ())
    }

    async fn reach(
        &mut self,
        goal: Goal,
        limit: Option<Duration>,
        what: &'static str,
    ) -> Result<AxisStatus, Error> {
        self.pursue_enabled(goal).await?;
        self.axis
            .arrive(limit, what, |status| status.view.progress == Progress::Reached)
            .await
    }

    /// Nothing is pursued any more once the axis has been commanded to stop, or stopped by itself.
    async fn pursue_enabled(&mut self, goal: Goal) -> Result<(), Error> {
        let status = self.axis.look().await?;
        if !status.view.goal.operates() {
            return Err(Error::NotEnabled {
                drive: self.axis.drive.label(),
            });
        }
        if let Some(needed) = goal.mode().filter(|&needed| needed != status.view.mode) {
            return Err(Error::WrongMode {
                drive: self.axis.drive.label(),
                needed,
                present: crate::error::mode_words(status.view.mode).into(),
            });
        }
        if goal.moves() && !matches!(goal, Goal::Traverse(_)) {
            self.axis.target = None;
        }
        self.axis.pursue(goal);
        Ok(())
    }
}

/// Finds out if an axis moves.
struct Moved {
    /// Speed that it should have, rpm.
    rpm: f64,
    /// `None` while the telegram has not reported it.
    moved: Option<bool>,
    highest: Option<f64>,
    from: Option<f64>,
}

impl Moved {
    const fn new(rpm: f64) -> Self {
        Self {
            rpm,
            moved: None,
            highest: None,
            from: None,
        }
    }

    fn look(&mut self, status: &AxisStatus) {
        let standstill = status.unit.standstill();
        let position = status.position.map(|position| {
            let from = *self.from.get_or_insert(position);
            (position - from).abs() > MOVED
        });
        let least = match status.unit {
            SpeedUnit::Rpm => (self.rpm.abs() / 2.0).min(standstill),
            SpeedUnit::Percent => status.unit.near() / 2.0,
        };
        let speed = status.speed_actual.map(f64::abs).map(|actual| {
            self.highest = Some(self.highest.map_or(actual, |highest| highest.max(actual)));
            actual > least
        });
        // a drive reports standstill of a slow axis too
        let slow = self.rpm.abs() <= standstill;
        let stopped = status
            .view
            .seen
            .filter(|_| status.view.mode == Mode::Position && !slow);
        let turns = stopped.map(|_| status.view.turns);
        for moved in [position, speed, turns].into_iter().flatten() {
            self.moved = Some(moved || self.moved == Some(true));
        }
    }
}

/// Returns whether the axis has this speed, by the best value of its telegram.
fn has_speed(status: &AxisStatus, rpm: f64) -> bool {
    match status.speed_actual {
        Some(actual) => (actual - rpm).abs() <= (rpm.abs() * SPEED_NEAR).max(status.unit.near()),
        None => status.view.seen.is_some_and(crate::axis::Seen::reached),
    }
}

impl Drop for Enabled<'_> {
    fn drop(&mut self) {
        let operates = self
            .axis
            .status()
            .is_some_and(|status| status.view.goal.operates());
        if self.stops && operates && self.axis.connection() == Connection::Running {
            self.axis.begin_stop();
        }
    }
}
