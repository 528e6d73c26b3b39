//! What a motion was like.

use client::Rest;
use profinet::cyclic::CyclicStatistics;
use serde::Serialize;

use super::plan::MoveReport;

/// A motion that ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Control of the axis was given back.
    pub released: bool,
    /// The axis turned with its power stage off when control of it was given back.
    pub coasts: bool,
    /// The caller stopped it before its end.
    pub interrupted: bool,
    /// Counters of the cyclic connection; a serial line has none.
    pub frames: Frames,
    /// What came of it.
    #[serde(flatten)]
    pub result: MotionResult,
    /// How the axis was when control of it was given back.
    #[serde(skip)]
    pub rest: Rest,
}

/// Cyclic frames of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
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
pub struct MotionResult {
    /// The speed, the target or the home position was reached.
    pub reached: bool,
    /// Speed of the motor before the stop, in `speed_unit`, where the telegram carries it.
    pub speed: Option<f64>,
    /// Highest speed of the motor by its amount, in the same unit.
    pub highest_speed: Option<f64>,
    /// `rpm` or `%`.
    pub speed_unit: Option<&'static str>,
    /// Time at the speed of a run or a jog, s.
    pub time_at_speed: Option<f64>,
    /// How far the axis went until its release, in turns: by its position, else by its speed in rpm over time.
    pub distance: Option<f64>,
    /// Where the axis was at its target or home position, in turns.
    pub position: Option<f64>,
    /// Where it is since the power stage is off, if that is another place, in turns.
    pub left_to: Option<f64>,
    /// Number of the motion task.
    pub task: Option<u16>,
    /// The motion task that the drive reported last (AKTSATZ).
    #[serde(rename = "aktsatz")]
    pub active_task: Option<u16>,
    /// The move.
    pub plan: Option<MoveReport>,
}
