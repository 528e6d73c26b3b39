//! Motions of position mode: to a target, by a task of the drive, to its home position.

use std::time::Duration;

use client::axis::{Move as Order, MovePlan, Purpose, SpeedUnit};
use client::{AxisStatus, Drive, Enabled, Error, Session};
use profile::catalogue::Part;
use profile::state::Mode;
use profile::value::{Reading, Selection};

use super::axis::{Done, Taken, check_controller_loss};
use super::error::{End, MotionError};
use super::event::{Arrival, Observer};
use super::limit::{self, within};
use super::plan::MoveReport;
use super::report::{MotionResult, Report};
use super::start::Start;
use super::{Control, SPEED_LIMIT, mode};
use crate::report::Quantity;

/// How much longer than computed a move may take: this many times, and this much more.
const ALLOWANCE: (u32, Duration) = (3, Duration::from_secs(10));
/// For a move whose length is not known.
const LONGEST: Duration = Duration::from_secs(120);
/// What decides over the homing procedure.
const HOMING: [Part; 4] = [
    Part::HomeMode,
    Part::HomeDirection,
    Part::HomeSpeed,
    Part::HomeAcceleration,
];

/// A move to a target.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    /// Where to, how fast, with which ramps.
    pub order: Order,
    /// Any speed above this is refused, rpm.
    pub limit: f64,
    /// The axis is stopped when it is not at its target after this time; a multiple of the computed time when `None`.
    pub timeout: Option<Duration>,
    /// What all motions have in common.
    pub control: Control,
}

impl Move {
    /// By this order, up to [`SPEED_LIMIT`].
    #[must_use]
    pub fn by(order: Order) -> Self {
        Self {
            order,
            limit: SPEED_LIMIT,
            timeout: None,
            control: Control::default(),
        }
    }

    /// Checks what is wrong whatever the drive is like.
    ///
    /// # Errors
    /// A speed above the limit.
    pub fn check(&self) -> Result<(), MotionError> {
        within(self.order.speed, self.limit, SpeedUnit::Rpm, &self.control)
    }
}

/// A motion task of the drive, or a chain of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Task {
    /// Its number in the table of the drive: 1 to 128.
    pub number: u16,
    /// The axis is stopped when the last task of the chain is not at its target after this time.
    pub timeout: Duration,
    /// What all motions have in common.
    pub control: Control,
}

/// The homing procedure of the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Home {
    /// The axis is stopped when homing takes longer.
    pub timeout: Duration,
    /// What all motions have in common.
    pub control: Control,
}

/// Goes to a target.
///
/// # Errors
/// Nothing is sent where something speaks against the move ([`Error::Objections`]), a limit, the mode, the loss reaction or
/// another controller; else when the target is not reached in time, and when the caller stops it before.
pub async fn move_to(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Move,
    observer: &Observer,
) -> Result<Report, MotionError> {
    let wanted = &Move {
        control: wanted.control.on(session, drive),
        ..wanted.clone()
    };
    wanted.check()?;
    check_mode(session, drive, &wanted.control).await?;
    let mode = (Mode::Position, &wanted.control);
    mode::during((session, drive), mode, wanted, observer, travel).await
}

/// What a move would be, with everything that speaks against it. Reads only.
///
/// # Errors
/// A speed above the limit, another mode, an axis that may run on without consent, and when the drive cannot be reached.
/// What speaks against the move itself is in [`MovePlan::objections`].
pub async fn plan_move(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Move,
    observer: &Observer,
) -> Result<MovePlan, MotionError> {
    let wanted = &Move {
        control: wanted.control.on(session, drive),
        ..wanted.clone()
    };
    wanted.check()?;
    drive.check_able(Some(Mode::Position))?;
    check_mode(session, drive, &wanted.control).await?;
    let plan = session.plan_move(drive, &wanted.order, wanted.limit).await?;
    check_controller_loss(session, drive, &wanted.control, observer).await?;
    Ok(plan)
}

async fn check_mode(session: &mut Session, drive: &mut Drive, control: &Control) -> Result<(), Error> {
    if control.set_mode {
        return Ok(());
    }
    session.check_mode(drive, Mode::Position).await
}

async fn travel(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Move,
    observer: &Observer,
) -> Result<Done, MotionError> {
    let plan = session.plan_move(drive, &wanted.order, wanted.limit).await?;
    if !plan.objections.is_empty() {
        return Err(MotionError::Client(Error::Objections {
            drive: drive.label(),
            objections: plan.objections,
        }));
    }
    check_controller_loss(session, drive, &wanted.control, observer).await?;
    let settings = wanted.control.settings(Purpose::Move, wanted.limit);
    let axis = session.take_axis(drive, settings).await?;
    let start = Start::Move(Box::new(plan.clone()));
    let mut taken = Taken::begin(axis, End::Target, start, wanted.control.set_mode, observer).await?;
    let mut last = None;
    let motion = async |enabled: &mut Enabled<'_>| reach(enabled, wanted, &mut last).await;
    let result = taken.move_by(motion).await;
    let position = last.and_then(|status| status.position);
    let left_to = taken.arrived(Arrival::Target, position, &result).await;
    let found = MotionResult {
        reached: result.is_ok(),
        position: position.map(Quantity::turns),
        left_to: left_to.map(Quantity::turns),
        plan: Some(MoveReport::of(&plan, drive)),
        ..MotionResult::default()
    };
    Ok(taken.finish(result, found).await)
}

/// Starts the move and waits for its target.
pub(super) async fn reach(
    enabled: &mut Enabled<'_>,
    wanted: &Move,
    last: &mut Option<AxisStatus>,
) -> Result<(), Error> {
    // with the present contents of the telegram
    let plan = enabled.plan(&wanted.order).await?;
    enabled.start(&plan).await?;
    let limit = wanted.timeout.unwrap_or_else(|| time_limit(&plan));
    arrive(enabled, limit, last).await
}

/// Waits for ZSW1 bit 10; `last` is how the axis was when it came, before anything else happens.
pub(super) async fn arrive(
    enabled: &mut Enabled<'_>,
    limit: Duration,
    last: &mut Option<AxisStatus>,
) -> Result<(), Error> {
    let reached = enabled.reach_target(Some(limit)).await;
    *last = reached.as_ref().ok().copied().or_else(|| enabled.status());
    reached.map(|_| ())
}

/// How long a move may take.
fn time_limit(plan: &MovePlan) -> Duration {
    plan.duration
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .map_or(LONGEST, |time| time * ALLOWANCE.0 + ALLOWANCE.1)
}

/// Carries out a motion task of the drive.
///
/// # Errors
/// As [`move_to`]; a task that the drive does not have or that cannot run is refused before anything is sent.
pub async fn task(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Task,
    observer: &Observer,
) -> Result<Report, MotionError> {
    let wanted = &Task {
        control: wanted.control.on(session, drive),
        ..*wanted
    };
    limit::of_drive(session, drive, &wanted.control, "a motion task").await?;
    let mode = (Mode::Position, &wanted.control);
    mode::during((session, drive), mode, wanted, observer, carry_out).await
}

async fn carry_out(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Task,
    observer: &Observer,
) -> Result<Done, MotionError> {
    session.check_mode(drive, Mode::Position).await?;
    session.check_control(drive).await?;
    session.check_task(drive, wanted.number).await?;
    check_controller_loss(session, drive, &wanted.control, observer).await?;
    let settings = wanted.control.settings(Purpose::Task, f64::INFINITY);
    let axis = session.take_axis(drive, settings).await?;
    let mut taken = Taken::begin(
        axis,
        End::Task,
        Start::Task(wanted.number),
        wanted.control.set_mode,
        observer,
    )
    .await?;
    let mut last = None;
    let motion = async |enabled: &mut Enabled<'_>| {
        enabled.start_task(wanted.number).await?;
        arrive(enabled, wanted.timeout, &mut last).await
    };
    let result = taken.move_by(motion).await;
    let position = last.and_then(|status| status.position);
    let left_to = taken
        .arrived(Arrival::Task(wanted.number), position, &result)
        .await;
    let found = MotionResult {
        reached: result.is_ok(),
        position: position.map(Quantity::turns),
        left_to: left_to.map(Quantity::turns),
        task: Some(wanted.number),
        active_task: last.and_then(|status| status.view.seen?.aktsatz),
        ..MotionResult::default()
    };
    Ok(taken.finish(result, found).await)
}

/// Sets the home position by the homing procedure of the drive.
///
/// # Errors
/// As [`move_to`].
pub async fn home(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Home,
    observer: &Observer,
) -> Result<Report, MotionError> {
    let wanted = &Home {
        control: wanted.control.on(session, drive),
        ..*wanted
    };
    limit::of_drive(session, drive, &wanted.control, "homing").await?;
    let mode = (Mode::Position, &wanted.control);
    mode::during((session, drive), mode, wanted, observer, set_home).await
}

async fn set_home(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &Home,
    observer: &Observer,
) -> Result<Done, MotionError> {
    check_controller_loss(session, drive, &wanted.control, observer).await?;
    let procedure = procedure(session, drive).await?;
    let settings = wanted.control.settings(Purpose::Home, f64::INFINITY);
    let axis = session.take_axis(drive, settings).await?;
    let start = Start::Home { procedure };
    let mut taken = Taken::begin(axis, End::Home, start, wanted.control.set_mode, observer).await?;
    let mut position = None;
    let motion = async |enabled: &mut Enabled<'_>| {
        let result = enabled.home(Some(wanted.timeout)).await;
        position = enabled.status().and_then(|status| status.position);
        result
    };
    let result = taken.move_by(motion).await;
    let left_to = taken.arrived(Arrival::Home, position, &result).await;
    let found = MotionResult {
        reached: result.is_ok(),
        homed: Some(result.is_ok()),
        position: position.map(Quantity::turns),
        left_to: left_to.map(Quantity::turns),
        ..MotionResult::default()
    };
    Ok(taken.finish(result, found).await)
}

/// What decides over the homing procedure, as far as the drive reports it.
async fn procedure(session: &mut Session, drive: &mut Drive) -> Result<Vec<(&'static str, Reading)>, Error> {
    let mut found = Vec::new();
    for part in HOMING {
        let Some(parameter) = drive.model.catalogue.and_then(|tables| tables.part(part)) else {
            continue;
        };
        let selection = Selection::of(parameter, drive.parameters.notation());
        match session.read_one(drive, &selection).await {
            Ok(reading) => found.push((parameter.name, reading)),
            Err(Error::Refused { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(found)
}
