//! What a motion was like.

use std::fmt;

use client::Rest;
use profinet::cyclic::CyclicStatistics;
use serde::Serialize;

use super::plan::MoveReport;
use crate::report::{Fault, Quantity};

/// A motion that ended, or faults that were acknowledged.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "MotionReport")
)]
pub struct Report {
    /// Control of the axis was taken and given back. False where the connection was lost, and where control was not needed:
    /// there is no fault to acknowledge, or a parameter acknowledges it.
    pub released: bool,
    /// How the axis was when control of it was given back: `stands`, `coasts`, `runs`, or `unknown` where the drive
    /// reported nothing any more or was not under control.
    #[serde(serialize_with = "by_id")]
    #[cfg_attr(feature = "schema", schemars(with = "&'static str"))]
    pub rest: Rest,
    /// The axis turned with its power stage off when control of it was given back.
    pub coasts: bool,
    /// The caller stopped it before its end.
    pub interrupted: bool,
    /// Counters of the cyclic connection; a serial line has none.
    pub frames: Frames,
    /// The settings that were changed for it, after their values from before were written.
    pub put_back: Vec<PutBack>,
    /// What came of it.
    #[serde(flatten)]
    pub result: MotionResult,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature is that of serde")]
fn by_id<S: serde::Serializer>(rest: &Rest, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(rest.id())
}

/// A setting that was changed for a motion, after it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PutBack {
    /// The parameter; null where mode and telegram of the drive cannot be read.
    pub parameter: Option<String>,
    /// Its number as its vendor writes it: `930`, `p1004`.
    pub number: Option<String>,
    /// Its value from before the motion.
    pub value: Option<String>,
    /// Why it does not have that value again; null where it has.
    pub failed: Option<String>,
}

impl fmt::Display for PutBack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match (&self.parameter, &self.value) {
            (Some(parameter), Some(value)) => (parameter.as_str(), format!(" to {value}")),
            _ => ("mode and telegram (PNU 930, 922)", String::new()),
        };
        match &self.failed {
            None => write!(f, "{} was put back{}", what.0, what.1),
            Some(cause) => write!(f, "{} was not put back{}: {cause}", what.0, what.1),
        }
    }
}

/// Cyclic frames of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Frames {
    /// Received.
    pub received: Option<u64>,
    /// Lost between them, by their counter.
    pub missed: Option<u64>,
}

impl Frames {
    pub(super) fn of(statistics: Option<CyclicStatistics>) -> Self {
        Self {
            received: statistics.map(|counts| counts.received),
            missed: statistics.map(|counts| counts.missed),
        }
    }
}

/// What came of a motion. What it has no place for is `None`.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MotionResult {
    /// The speed, the target or the home position was reached, or no fault is left.
    pub reached: bool,
    /// Speed of the motor before the stop, where the telegram carries it.
    pub speed: Option<Quantity>,
    /// Highest speed of the motor by its amount.
    pub highest_speed: Option<Quantity>,
    /// Time at the speed of a run or a jog, s.
    pub time_at_speed: Option<f64>,
    /// How far the axis went until its release: by its position, else by its speed in rpm over time.
    pub distance: Option<Quantity>,
    /// Where the axis was at its target or home position.
    pub position: Option<Quantity>,
    /// Where it is since the power stage is off, if that is another place.
    pub left_to: Option<Quantity>,
    /// Whether the axis has its home position, after homing.
    pub homed: Option<bool>,
    /// Number of the motion task.
    pub task: Option<u16>,
    /// The motion task that the drive reported last (AKTSATZ).
    pub active_task: Option<u16>,
    /// The move.
    pub plan: Option<MoveReport>,
    /// Whether there were faults to acknowledge, where that was requested.
    pub acknowledged: Option<bool>,
    /// The faults that are left, where they were to be acknowledged.
    pub faults: Vec<Fault>,
}
