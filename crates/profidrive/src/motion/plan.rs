//! What a motion would do.

use client::Drive;
use client::axis::MovePlan;
use profile::value::Reading;
use serde::Serialize;

use crate::report::Quantity;

/// The telegram that a motion would use. `None` where the drive would be put into another mode first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Telegrams {
    /// The telegram in use.
    pub telegram: Option<u16>,
    /// What the drive reports now (PNU 922).
    pub telegram_before: Option<u16>,
}

/// A run that was not done.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunPlan {
    /// The drive.
    pub drive: String,
    /// True: nothing was sent.
    pub dry_run: bool,
    /// Speed that was requested.
    pub speed: Quantity,
    /// The nearest speed that can be transmitted; `None` where the telegram is not known yet.
    pub speed_rounded: Option<Quantity>,
    /// How long it would run at that speed, s; without end when `None`.
    pub time: Option<f64>,
    /// The telegram.
    #[serde(flatten)]
    pub telegrams: Telegrams,
}

/// A jog that was not done.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JogPlan {
    /// The drive.
    pub drive: String,
    /// True: nothing was sent.
    pub dry_run: bool,
    /// Speed as the drive would have it.
    pub speed: Quantity,
    /// How long, s.
    pub time: f64,
    /// The jog speed of the drive that would be changed and put back.
    #[serde(skip)]
    pub change: Option<Box<JogChange>>,
    /// The telegram.
    #[serde(flatten)]
    pub telegrams: Telegrams,
}

/// A jog speed of the drive that would be changed for a jog.
#[derive(Debug, Clone, PartialEq)]
pub struct JogChange {
    /// The parameter as its vendor writes it.
    pub parameter: String,
    /// Its value.
    pub before: Reading,
    /// The value for the time of the jog.
    pub after: Reading,
}

/// A move as it travels, with everything that speaks against it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MoveReport {
    /// The drive.
    pub drive: String,
    /// Where the axis is.
    pub from: Option<Quantity>,
    /// Where it goes.
    pub target: Option<Quantity>,
    /// Speed as the drive takes it.
    pub speed: Quantity,
    /// Acceleration as the drive takes it.
    pub acceleration: Quantity,
    /// Deceleration as the drive takes it.
    pub deceleration: Quantity,
    /// Computed time, s.
    pub duration: Option<f64>,
    /// SATZANW.
    pub satzanw: u16,
    /// MDI_TARPOS.
    pub mdi_tarpos: i32,
    /// MDI_VELOCITY.
    pub mdi_velocity: u32,
    /// MDI_ACC.
    pub mdi_acc: u16,
    /// MDI_DEC.
    pub mdi_dec: u16,
    /// MDI_MOD.
    pub mdi_mod: u16,
    /// What speaks against it.
    pub objections: Vec<String>,
}

impl MoveReport {
    /// A plan as data.
    #[must_use]
    pub fn of(plan: &MovePlan, drive: &Drive) -> Self {
        Self {
            drive: drive.label(),
            from: plan.from.map(Quantity::turns),
            target: plan.target.map(Quantity::turns),
            speed: Quantity::rpm(plan.speed),
            acceleration: Quantity::new(plan.acceleration, "rpm/s"),
            deceleration: Quantity::new(plan.deceleration, "rpm/s"),
            duration: plan.duration,
            satzanw: plan.traverse.satzanw,
            mdi_tarpos: plan.traverse.target,
            mdi_velocity: plan.traverse.velocity,
            mdi_acc: plan.traverse.acceleration,
            mdi_dec: plan.traverse.deceleration,
            mdi_mod: plan.traverse.modus,
            objections: plan.objections.iter().map(ToString::to_string).collect(),
        }
    }
}
