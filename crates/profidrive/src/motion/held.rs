//! An axis that its caller holds: enabled once and moved as often as wanted, with the rules of the single motions.

mod travel;

use std::future::{Future as _, poll_fn};
use std::pin::pin;
use std::task::Poll;
use std::time::Duration;

use client::axis::{Jog as Setpoint, Move as Order, MovePlan, Purpose, SpeedUnit};
use client::{
    Axis, AxisSettings, AxisStatus, BeatHandle, Drive, Enabled, Error, HomingSpeed, ModeChange, Samples,
    Session, StopHandle,
};
use profile::state::Mode;
use profinet::cyclic::CyclicStatistics;

use super::axis::{Taken, check_controller_loss, report_rounded, report_switch};
use super::error::{End, MotionError, explained};
use super::event::Observer;
use super::limit::{self, within};
use super::plan::MoveReport;
use super::position::{self, Move};
use super::report::{MotionResult, Report};
use super::run::{self, Run, permit_speed};
use super::speed::Speed;
use super::start::Start;
use super::{Control, SPEED_LIMIT, jog, mode};
use crate::report::Quantity;

/// How an axis is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// What the axis is held for: decides over the mode and the telegram. [`Purpose::Speed`] has [`HeldAxis::run`] and
    /// [`HeldAxis::jog`], [`Purpose::Move`] has moves, tasks, homing and all jogs.
    pub purpose: Purpose,
    /// The telegram to use; `None` leaves it to what the drive reports and the purpose needs.
    pub telegram: Option<u16>,
    /// Any speed above this is refused, rpm.
    pub limit: f64,
    /// How far the axis may go from where control begins, in turns both ways; `None` for any way.
    pub travel: Option<f64>,
    /// Time without a call after which the axis is brought to rest along its ramp; see [`AxisSettings::lease`].
    pub lease: Duration,
    /// What all motions have in common.
    pub control: Control,
}

impl Hold {
    /// For speeds up to [`SPEED_LIMIT`].
    #[must_use]
    pub fn for_speed() -> Self {
        Self::of(Purpose::Speed)
    }

    /// For positions, at speeds up to [`SPEED_LIMIT`].
    #[must_use]
    pub fn for_position() -> Self {
        Self::of(Purpose::Move)
    }

    /// For what the drive is set up for now: positions in position mode, else speeds; up to [`SPEED_LIMIT`].
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn for_present_mode(session: &mut Session, drive: &mut Drive) -> Result<Self, Error> {
        let positions = drive.check_able(Some(Mode::Position)).is_ok()
            && session.operating_mode(drive).await? == Some(Mode::Position);
        Ok(if positions {
            Self::for_position()
        } else {
            Self::for_speed()
        })
    }

    fn of(purpose: Purpose) -> Self {
        let AxisSettings { lease, .. } = AxisSettings::default();
        Self {
            purpose,
            telegram: None,
            limit: SPEED_LIMIT,
            travel: None,
            lease,
            control: Control::default(),
        }
    }

    const fn mode(&self) -> Mode {
        match self.purpose {
            Purpose::Speed => Mode::Velocity,
            _ => Mode::Position,
        }
    }
}

/// An axis under control of its caller. It moves only by a call, and every call applies the limits of its single motion.
///
/// | motion | a whole one | its parts |
/// |---|---|---|
/// | turn at a speed | [`turn`](Self::turn) | [`run`](Self::run), [`halt`](Self::halt) |
/// | jog | [`jog_for`](Self::jog_for) | [`jog`](Self::jog), [`jog_at`](Self::jog_at), [`halt`](Self::halt) |
/// | go to a position | [`travel`](Self::travel) | [`start`](Self::start), [`arrive`](Self::arrive) |
/// | carry out a motion task of the drive | [`carry_out`](Self::carry_out) | [`start_task`](Self::start_task), [`arrive`](Self::arrive) |
/// | set the home position | [`find_home`](Self::find_home) | [`home`](Self::home) |
/// | stop | [`bring_to_rest`](Self::bring_to_rest) | [`stop`](Self::stop) |
///
/// A whole motion enables the axis where it is not in operation, takes as long as it takes and returns a report. Where it fails,
/// or its caller stops it, the axis is at rest when it returns. A motion that a limit forbids is none: the axis goes on as before.
/// An axis that stopped by itself since the last call, by the end of its lease for example, is not started again: the next call
/// returns why.
///
/// The parts are for callers who do something meanwhile; they need an axis that is [enabled](Self::enable).
///
/// It may go to another thread. However it ends, by [`release`](Self::release), by a drop, a panic or the end of its lease, the
/// axis is ramped down and released, then mode and telegram are put back. A motion that only lasts while a person wants it to,
/// a held button for example, is kept going by [`beat`](Self::beat).
///
/// ```
/// # #[cfg(feature = "simulate")] {
/// use std::time::Duration;
/// use profidrive::Wait;
/// use profidrive::motion::{self, Hold, Observer};
///
/// # let plant = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
/// let mut network = profidrive::open_plan(plant.parse()?)?;
/// let mut drive = network.find(&"akd-1".parse()?).wait()?;
/// let observer = Observer::default();
/// let mut axis = motion::hold(&mut network, &mut drive, &Hold::for_speed(), &observer).wait()?;
/// axis.enable().wait()?;
/// axis.run(60.0).wait()?;
/// axis.pass(Duration::from_secs(1)).wait()?;
/// assert!(axis.status().and_then(|status| status.speed_actual).is_some_and(|speed| speed > 59.0));
/// assert!(axis.run(4000.0).wait().is_err()); // above the limit: the axis keeps its speed
/// axis.halt().wait()?; // along the ramp; it stays enabled
///
/// let turned = axis.turn(60.0, Some(Duration::from_secs(1))).wait()?; // the same as a whole motion
/// assert!(turned.result.reached);
/// axis.release().wait()?;
/// # }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct HeldAxis {
    // dropped before what is put back once it is at rest
    taken: Taken,
    change: Option<ModeChange>,
    limit: f64,
    control: Control,
}

/// Takes control of an axis and nothing else: it is enabled by [`HeldAxis::enable`].
///
/// # Errors
/// When the mode, the reaction to a lost controller or another controller speaks against it.
pub async fn hold(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Hold,
    observer: &Observer,
) -> Result<HeldAxis, MotionError> {
    let wanted = &Hold {
        control: wanted.control.on(session, drive),
        ..*wanted
    };
    check_controller_loss(session, drive, &wanted.control, observer).await?;
    let change = mode::enter(session, drive, wanted.mode(), &wanted.control, observer).await?;
    let settings = AxisSettings {
        lease: wanted.lease,
        telegram: wanted.telegram,
        ..wanted.control.settings(wanted.purpose, wanted.limit)
    };
    let axis = match session.take_axis(drive, settings).await {
        Ok(axis) => axis,
        Err(error) => {
            mode::leave(change, observer).await;
            return Err(error.into());
        }
    };
    let taken = match Taken::begin(axis, End::Open, Start::Hold, wanted.control.set_mode, observer).await {
        Ok(taken) => taken,
        Err(error) => {
            mode::leave(change, observer).await;
            return Err(error);
        }
    };
    let axis = HeldAxis {
        taken,
        change,
        limit: wanted.limit,
        control: wanted.control,
    };
    match wanted.travel {
        Some(turns) if !axis.taken.axis.limit_travel(turns) => {
            let error = axis.not_watched("its telegram has no position, and no speed in rpm");
            // how it is given back is not what was wrong
            let _ = axis.release().await;
            Err(error)
        }
        _ => Ok(axis),
    }
}

impl HeldAxis {
    /// Enables the axis (S4). It stands.
    ///
    /// # Errors
    /// When the drive does not come into operation, with the faults that it has; and when the connection is lost.
    pub async fn enable(&mut self) -> Result<(), MotionError> {
        let result = self.operate().await;
        self.done(End::Open, result, MotionResult::default()).await?;
        Ok(())
    }

    /// Enables the axis, without what the drive reports about a failure.
    async fn operate(&mut self) -> Result<(), Error> {
        let error = match self.taken.axis.enable().await {
            Ok(enabled) => {
                enabled.leave();
                return Ok(());
            }
            Err(error) => error,
        };
        // a caller who was stopped on the way leaves no axis that comes into operation later
        if self.taken.axis.operates() {
            let _ = self.taken.axis.stop().await;
        }
        Err(error)
    }

    /// Works on the axis, which stays in operation with the motion that is under way then.
    async fn in_operation<T>(
        &mut self,
        work: impl AsyncFnOnce(&mut Enabled<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let mut enabled = operation(&mut self.taken)?;
        let result = work(&mut enabled).await;
        enabled.leave();
        result
    }

    /// Follows this speed from now on, in rpm. Another speed is taken on the fly.
    ///
    /// # Errors
    /// A speed above the limit of the caller or of the drive, and when the axis is not enabled. What moved before goes on.
    pub async fn run(&mut self, speed: f64) -> Result<(), MotionError> {
        self.permit_run(speed).await?;
        Ok(self
            .in_operation(async |enabled| enabled.run(speed).await)
            .await?)
    }

    /// Returns a speed in rpm: an output frequency is converted by the motor data of the drive, which is reported.
    ///
    /// # Errors
    /// As [`speed_at`](super::speed_at).
    pub async fn in_rpm(&mut self, speed: Speed) -> Result<f64, MotionError> {
        let observer = self.taken.observer().clone();
        let (session, drive) = self.taken.axis.session();
        let rpm = speed.in_rpm(session, drive, &observer).await;
        self.unless_lost(rpm)
    }

    async fn permit_run(&mut self, speed: f64) -> Result<(), MotionError> {
        within(speed, self.limit, SpeedUnit::Rpm, &self.control)?;
        self.permit_way(speed)?;
        let observer = self.taken.observer().clone();
        let (session, drive) = self.taken.axis.session();
        let permitted = permit_speed(session, drive, speed, None, &observer).await;
        self.unless_lost(permitted)?;
        if let Some(nearest) = self.taken.axis.rounded_speed(speed) {
            report_rounded(speed, nearest, SpeedUnit::Rpm.symbol(), &observer);
        }
        Ok(())
    }

    /// What failed because the connection of the axis is gone failed by that, which says what the drive does without it.
    fn unless_lost<T>(&self, result: Result<T, impl Into<MotionError>>) -> Result<T, MotionError> {
        result.map_err(|error| {
            self.taken
                .axis
                .lost()
                .map_or_else(|| error.into(), MotionError::from)
        })
    }

    /// Jogs by the jog function of the drive, at the speed that the drive has; returns it, in rpm.
    ///
    /// # Errors
    /// A jog speed above the limit of the caller or of the drive, and when the axis is not enabled.
    pub async fn jog(&mut self, setpoint: Setpoint) -> Result<f64, MotionError> {
        let speed = self.permit_jog(setpoint).await?;
        self.in_operation(async |enabled| enabled.jog(setpoint).await)
            .await?;
        Ok(speed)
    }

    /// Jogs at this speed, in rpm, by the telegram (real-time jogging). Another speed is taken on the fly.
    ///
    /// # Errors
    /// A speed above the limit of the caller or of the drive, a drive in velocity mode, and when the axis is not enabled.
    pub async fn jog_at(&mut self, speed: f64) -> Result<(), MotionError> {
        self.permit_jog_at(speed).await?;
        Ok(self
            .in_operation(async |enabled| enabled.jog_at(speed).await)
            .await?)
    }

    /// Returns the jog speed of the drive, rpm, once nothing speaks against it.
    async fn permit_jog(&mut self, setpoint: Setpoint) -> Result<f64, MotionError> {
        let read = async |session: &mut Session, drive: &mut Drive| {
            let setting = session.jog_speed(drive, setpoint).await?;
            let reading = session.read_one(drive, &setting.selection).await?;
            let facts = session.motion_facts(drive).await?;
            Ok::<_, Error>((setting, reading, facts))
        };
        let (session, drive) = self.taken.axis.session();
        let read = read(session, drive).await;
        let (setting, reading, facts) = self.unless_lost(read)?;
        // a speed that is not known is within no limit
        let speed = setting.rpm(&reading).unwrap_or(f64::NAN);
        within(speed, self.limit, SpeedUnit::Rpm, &self.control)?;
        self.permit_way(speed)?;
        limit::jog(speed, &facts, self.drive())?;
        report_switch(speed, &facts, self.taken.observer());
        Ok(speed)
    }

    async fn permit_jog_at(&mut self, speed: f64) -> Result<(), MotionError> {
        within(speed, self.limit, SpeedUnit::Rpm, &self.control)?;
        self.permit_way(speed)?;
        let limit = self.limit;
        let read = async |session: &mut Session, drive: &mut Drive| {
            let sent = session.check_jog(drive, speed, limit).await?;
            Ok::<_, Error>((sent, session.motion_facts(drive).await?))
        };
        let (session, drive) = self.taken.axis.session();
        let read = read(session, drive).await;
        let (sent, facts) = self.unless_lost(read)?;
        let observer = self.taken.observer();
        report_rounded(speed, sent, SpeedUnit::Rpm.symbol(), observer);
        report_switch(speed, &facts, observer);
        Ok(())
    }

    /// Starts a move and returns its plan once the drive has accepted it. A move under way is replaced on the fly;
    /// [`arrive`](Self::arrive) waits for its end.
    ///
    /// # Errors
    /// A speed above the limit, what speaks against the move ([`Error::Objections`]), and when the axis is not enabled.
    pub async fn start(&mut self, order: &Order) -> Result<MovePlan, MotionError> {
        within(order.speed, self.limit, SpeedUnit::Rpm, &self.control)?;
        self.permit_target(order)?;
        let start = async |enabled: &mut Enabled<'_>| {
            let plan = enabled.plan(order).await?;
            enabled.start(&plan).await?;
            Ok(plan)
        };
        Ok(self.in_operation(start).await?)
    }

    /// Starts a motion task of the drive; [`arrive`](Self::arrive) waits for its end.
    ///
    /// # Errors
    /// A task that the drive does not have or that cannot run, a limit of the caller or of the machine below that of the drive, for the
    /// speed is in the task; and when the axis is not enabled.
    pub async fn start_task(&mut self, number: u16) -> Result<(), MotionError> {
        self.permit_task(number).await?;
        Ok(self
            .in_operation(async |enabled| enabled.start_task(number).await)
            .await?)
    }

    async fn permit_task(&mut self, number: u16) -> Result<(), MotionError> {
        let (session, drive) = self.taken.axis.session();
        let checked = session.check_task(drive, number).await;
        self.unless_lost(checked)?;
        self.bounded("a motion task", None).await
    }

    /// Waits until the move or task under way is at its target; returns how the axis was then. The axis goes on where the time is
    /// over first.
    ///
    /// # Errors
    /// When it takes longer than `limit`, the axis stops elsewhere, or it leaves operation.
    pub async fn arrive(&mut self, limit: Duration) -> Result<AxisStatus, Error> {
        self.in_operation(async |enabled| enabled.reach_target(Some(limit)).await)
            .await
    }

    /// Homes the axis as the drive is set up, and waits for the end.
    ///
    /// # Errors
    /// When the drive homes faster than the limit of the caller or of the machine, or does not report how fast; when homing fails,
    /// is halted or takes longer than `limit`, and when the axis is not enabled.
    pub async fn home(&mut self, limit: Duration) -> Result<(), MotionError> {
        self.permit_home().await?;
        Ok(self
            .in_operation(async |enabled| enabled.home(Some(limit)).await)
            .await?)
    }

    async fn permit_home(&mut self) -> Result<(), MotionError> {
        let (session, drive) = self.taken.axis.session();
        let speed = session.homing_speed(drive).await;
        let speed = match self.unless_lost(speed)? {
            HomingSpeed::None => Some(0.0),
            HomingSpeed::Rpm(speed) => Some(speed),
            HomingSpeed::Unknown => None,
        };
        self.bounded("homing", speed).await
    }

    /// Refuses a motion whose speed only the drive has, where it is above the limit of the caller, or may be, and where the machine
    /// bounds it.
    async fn bounded(&mut self, what: &'static str, speed: Option<f64>) -> Result<(), MotionError> {
        let (limit, control) = (self.limit, self.control);
        let check = async |session: &mut Session, drive: &mut Drive| {
            limit::stored(session, drive, limit, what, speed).await?;
            limit::of_drive(session, drive, &control, what).await
        };
        let (session, drive) = self.taken.axis.session();
        let bounded = check(session, drive).await;
        self.unless_lost(bounded)
    }

    /// Turns at a speed, in rpm: returns once the axis has it and leaves it turning, or keeps it for this time and halts.
    ///
    /// # Errors
    /// As [`run`](Self::run) and [`enable`](Self::enable), and when the speed is not reached or not kept.
    pub async fn turn(&mut self, speed: f64, time: Option<Duration>) -> Result<Report, MotionError> {
        self.permit_run(speed).await?;
        let wanted = Run {
            time,
            ..Run::at(speed)
        };
        let observer = self.taken.observer().clone();
        let mut found = MotionResult::default();
        let motion = async |enabled: &mut Enabled<'_>| {
            run::reach(enabled, &wanted, &mut found, &observer).await?;
            let Some(time) = time else { return Ok(()) };
            run::hold(enabled, speed, time, &mut found).await?;
            enabled.halt().await
        };
        let result = self.whole(motion).await;
        self.done(End::Time, result, found).await
    }

    /// Jogs for this time and halts: at a speed in rpm by the telegram (real-time jogging), or with `None` by the jog function 1
    /// of the drive at the speed that it has.
    ///
    /// # Errors
    /// As [`jog`](Self::jog), [`jog_at`](Self::jog_at) and [`enable`](Self::enable), and when the axis does not move.
    pub async fn jog_for(&mut self, speed: Option<f64>, time: Duration) -> Result<Report, MotionError> {
        let rpm = match speed {
            Some(speed) => {
                self.permit_jog_at(speed).await?;
                speed
            }
            None => self.permit_jog(Setpoint::One).await?,
        };
        let observer = self.taken.observer().clone();
        let mut found = MotionResult::default();
        let motion = async |enabled: &mut Enabled<'_>| {
            match speed {
                Some(speed) => enabled.jog_at(speed).await?,
                None => enabled.jog(Setpoint::One).await?,
            }
            jog::keep(enabled, rpm, time, &mut found, &observer).await?;
            enabled.halt().await
        };
        let result = self.whole(motion).await;
        self.done(End::Time, result, found).await
    }

    /// Goes to a position, or by a distance, and holds there. Without a timeout it may take some multiple of its computed time.
    ///
    /// # Errors
    /// As [`start`](Self::start), [`arrive`](Self::arrive) and [`enable`](Self::enable).
    pub async fn travel(&mut self, order: &Order, timeout: Option<Duration>) -> Result<Report, MotionError> {
        let plan = self.permit_move(order).await?;
        let wanted = Move {
            timeout,
            ..Move::by(*order)
        };
        let mut last = None;
        let result = self
            .whole(async |enabled: &mut Enabled<'_>| position::reach(enabled, &wanted, &mut last).await)
            .await;
        let found = MotionResult {
            reached: result.is_ok(),
            plan: Some(MoveReport::of(&plan, self.drive())),
            ..at(last)
        };
        self.done(End::Target, result, found).await
    }

    /// Starts a move and returns its plan once the drive has accepted it, as [`start`](Self::start) does; the axis is enabled
    /// where it is not.
    ///
    /// # Errors
    /// As [`start`](Self::start) and [`enable`](Self::enable).
    pub async fn set_out(&mut self, order: &Order) -> Result<MovePlan, MotionError> {
        self.permit_move(order).await?;
        if !self.taken.axis.operates() {
            self.operate().await?;
        }
        self.start(order).await
    }

    /// The plan of a move that nothing speaks against.
    async fn permit_move(&mut self, order: &Order) -> Result<MovePlan, MotionError> {
        within(order.speed, self.limit, SpeedUnit::Rpm, &self.control)?;
        self.permit_target(order)?;
        let plan = self.taken.axis.plan(order).await;
        let plan = self.unless_lost(plan)?;
        if plan.objections.is_empty() {
            return Ok(plan);
        }
        Err(MotionError::Client(Error::Objections {
            drive: self.drive().label(),
            objections: plan.objections,
        }))
    }

    /// Carries out a motion task of the drive, or the chain that begins with it, and holds at its target.
    ///
    /// # Errors
    /// As [`start_task`](Self::start_task), [`arrive`](Self::arrive) and [`enable`](Self::enable).
    pub async fn carry_out(&mut self, number: u16, timeout: Duration) -> Result<Report, MotionError> {
        self.permit_task(number).await?;
        let mut last = None;
        let motion = async |enabled: &mut Enabled<'_>| {
            enabled.start_task(number).await?;
            position::arrive(enabled, timeout, &mut last).await
        };
        let result = self.whole(motion).await;
        let found = MotionResult {
            reached: result.is_ok(),
            task: Some(number),
            active_task: last.and_then(|status: AxisStatus| status.view.seen?.aktsatz),
            ..at(last)
        };
        self.done(End::Task, result, found).await
    }

    /// Starts a motion task once the drive has accepted it, as [`start_task`](Self::start_task) does; the axis is enabled where it is
    /// not.
    ///
    /// # Errors
    /// As [`start_task`](Self::start_task) and [`enable`](Self::enable).
    pub async fn set_out_task(&mut self, number: u16) -> Result<(), MotionError> {
        self.permit_task(number).await?;
        if !self.taken.axis.operates() {
            self.operate().await?;
        }
        self.start_task(number).await
    }

    /// Homes the axis as the drive is set up, and holds.
    ///
    /// # Errors
    /// As [`home`](Self::home) and [`enable`](Self::enable).
    pub async fn find_home(&mut self, timeout: Duration) -> Result<Report, MotionError> {
        self.permit_home().await?;
        let result = self
            .whole(async |enabled: &mut Enabled<'_>| enabled.home(Some(timeout)).await)
            .await;
        let found = MotionResult {
            reached: result.is_ok(),
            homed: Some(result.is_ok()),
            ..at(self.status())
        };
        self.done(End::Home, result, found).await
    }

    /// Stops the axis along its ramp (OFF1), or by its quick stop (OFF3), and ends operation; control is kept. Returns at
    /// standstill. A wish to stop does not interrupt it.
    ///
    /// # Errors
    /// As [`stop`](Self::stop).
    pub async fn bring_to_rest(&mut self, quick: bool) -> Result<Report, MotionError> {
        self.taken.begin_course();
        let result = match quick {
            true => self.taken.axis.quick_stop().await,
            false => self.taken.axis.stop().await,
        };
        let found = MotionResult {
            reached: result.is_ok(),
            ..at(self.status())
        };
        self.done(End::Time, result, found).await
    }

    /// Stops the axis as [`bring_to_rest`](Self::bring_to_rest) does, and waits at most this time for standstill; `None` when it is over.
    /// The axis goes on stopping then.
    ///
    /// # Errors
    /// As [`stop`](Self::stop).
    pub async fn rest_within(&mut self, quick: bool, time: Duration) -> Result<Option<Report>, MotionError> {
        let mut session = self.taken.axis.session().0.clone();
        let mut rests = pin!(self.bring_to_rest(quick));
        let mut over = pin!(session.uninterrupted(async |session| session.pass(time).await));
        poll_fn(|context| match rests.as_mut().poll(context) {
            Poll::Ready(report) => Poll::Ready(report.map(Some)),
            Poll::Pending => over
                .as_mut()
                .poll(context)
                .map(|passed| Ok(passed.map(|()| None)?)),
        })
        .await
    }

    /// Carries out a whole motion. What becomes of it leaves the axis holding, or at rest where it fails.
    async fn whole(
        &mut self,
        motion: impl AsyncFnOnce(&mut Enabled<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        self.taken.begin_course();
        if !self.taken.axis.operates() {
            self.operate().await?;
        }
        let mut enabled = operation(&mut self.taken)?;
        let result = motion(&mut enabled).await;
        if result.is_ok() {
            enabled.leave();
            return result;
        }
        drop(enabled);
        // how it stopped is reported with the release
        let _ = self.taken.axis.stopped().await;
        result
    }

    /// Returns the report of a whole motion, or why it failed with what the drive reports about itself.
    async fn done(
        &mut self,
        end: End,
        result: Result<(), Error>,
        found: MotionResult,
    ) -> Result<Report, MotionError> {
        let found = MotionResult {
            speed: self.taken.speed(),
            ..found
        };
        let report = self.taken.report(found);
        match result {
            Ok(()) => Ok(report),
            Err(error) => {
                let (session, drive) = self.taken.axis.session();
                Err(explained(error, end, report, session, drive).await)
            }
        }
    }

    /// Lets time pass and keeps the axis: its motion goes on.
    ///
    /// # Errors
    /// When the axis leaves operation, and when the caller requests a stop.
    pub async fn pass(&mut self, time: Duration) -> Result<(), Error> {
        self.taken.axis.hold(time).await
    }

    /// Halts along the ramp; the axis stays enabled. Returns at standstill.
    ///
    /// # Errors
    /// When the axis does not come to a standstill, or is not enabled.
    pub async fn halt(&mut self) -> Result<(), Error> {
        self.in_operation(async |enabled| enabled.halt().await).await
    }

    /// Ramp stop (OFF1) and the end of operation; control is kept. Returns at standstill.
    ///
    /// # Errors
    /// When the axis does not come to a standstill, or the connection is lost.
    pub async fn stop(&mut self) -> Result<(), Error> {
        self.taken.axis.stop().await
    }

    /// Acknowledges faults by an edge of STW1 bit 7.
    ///
    /// # Errors
    /// When a fault stays, or the connection is lost.
    pub async fn acknowledge(&mut self) -> Result<(), Error> {
        self.taken.axis.acknowledge().await
    }

    /// Keeps a motion going for this time from now on, and renews the lease: see [`client::Axis::beat`].
    pub fn beat(&self, time: Option<Duration>) {
        self.taken.axis.beat(time);
        self.taken.axis.renew();
    }

    /// Renews the lease, as every call that waits does.
    ///
    /// # Errors
    /// When the axis has stopped by itself since the last call, by the end of its lease for example, or the connection is lost.
    pub async fn keep_alive(&mut self) -> Result<(), Error> {
        self.taken.axis.check_reported().await?;
        self.taken.axis.renew();
        Ok(())
    }

    /// Renews the lease while another axis is waited for that belongs together with this one. False where this one has stopped by
    /// itself or its connection is lost: [`keep_alive`](Self::keep_alive) says why.
    #[must_use]
    pub fn keep_beside(&self) -> bool {
        let goes_on = self.taken.axis.goes_on();
        if goes_on {
            self.taken.axis.renew();
        }
        goes_on
    }

    /// Returns the counters of the cyclic connection; a serial line has none.
    #[must_use]
    pub fn statistics(&self) -> Option<CyclicStatistics> {
        self.taken.axis.statistics()
    }

    /// Returns what keeps a motion going, and renews the lease, from any thread: also while a call for the axis waits.
    #[must_use]
    pub fn beat_handle(&self) -> BeatHandle {
        self.taken.axis.beat_handle()
    }

    /// Returns the axis as its last inputs show it; `None` once the connection is closed.
    #[must_use]
    pub fn status(&self) -> Option<AxisStatus> {
        self.taken.axis.status()
    }

    /// Returns what stops this axis from any thread.
    #[must_use]
    pub fn stop_handle(&self) -> StopHandle {
        self.taken.axis.stop_handle()
    }

    /// Returns every cyclic sample of the axis from now on.
    #[must_use]
    pub fn samples(&self, room: usize) -> Samples {
        self.taken.axis.samples(room)
    }

    /// Returns the axis, for what is read of it: its signals, its telegram and its cycle.
    #[must_use]
    pub const fn axis(&self) -> &Axis {
        &self.taken.axis
    }

    /// Returns the drive.
    #[must_use]
    pub const fn drive(&self) -> &Drive {
        self.taken.axis.drive()
    }

    /// Ramps the axis down, gives control of it back, and puts mode and telegram back.
    ///
    /// # Errors
    /// When the axis does not come to a standstill, the connection was lost before, or a setting was not put back; and when the
    /// axis had stopped by itself, by the end of its lease for example, and no call has returned that yet.
    pub async fn release(mut self) -> Result<Report, MotionError> {
        let unreported = self.taken.axis.check_reported().await;
        let Self {
            mut taken, change, ..
        } = self;
        let (mut session, mut drive) = {
            let (session, drive) = taken.axis.session();
            (session.clone(), drive.clone())
        };
        let observer = taken.observer().clone();
        let found = MotionResult {
            speed: taken.speed(),
            ..MotionResult::default()
        };
        let done = taken.finish(unreported, found).await;
        let restored = mode::leave(change, &observer).await;
        done.report(restored, &observer, (&mut session, &mut drive)).await
    }
}

/// The axis in operation.
fn operation(taken: &mut Taken) -> Result<Enabled<'_>, Error> {
    let drive = taken.axis.drive().label();
    taken.axis.operation().ok_or(Error::NotEnabled { drive })
}

/// Where the axis is.
fn at(status: Option<AxisStatus>) -> MotionResult {
    let position = status.and_then(|status| status.position);
    MotionResult {
        position: position.map(Quantity::turns),
        ..MotionResult::default()
    }
}
