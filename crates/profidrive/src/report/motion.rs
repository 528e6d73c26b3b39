//! What the verbs report that move an axis.

use client::axis::Strained;
use client::{AxisStatus, Rest};
use dissect::{hex16, words};
use profile::state::{Profile, bits};
use profinet::cyclic::CyclicStatistics;
use serde::Serialize;

use super::{DriveWords, Fault, LossReaction, Quantity, Warning, Word};

/// One event of a verb that moves an axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum MotionEvent {
    /// What the verb would do, with `--dry-run`.
    DryRun(DryRun),
    /// The drive does not stop by itself when this program is gone.
    KeepsTurning {
        /// What it does, and which setting says so.
        on_loss: LossReaction,
        /// The call that makes it stop.
        command: Option<String>,
    },
    /// Another telegram was selected (PNU 922).
    TelegramChanged(TelegramChange),
    /// This computer does not keep to the cycle of the connection.
    CycleStrained(CycleStrained),
    /// State, words and values of the axis, after a change or some time.
    State(AxisState),
    /// Warnings came or went.
    Warnings {
        /// Seconds since control was taken.
        time: f64,
        /// The warnings that are present.
        warnings: Vec<Warning>,
    },
    /// The axis was stopped and control was released.
    End(MotionEnd),
}

/// What a verb would do.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DryRun {
    /// The drive.
    pub drive: String,
    /// Telegram that would be used; null where the mode would be changed first.
    pub telegram: Option<u16>,
    /// Telegram that the drive has now.
    pub telegram_before: Option<u16>,
    /// Speed that was requested.
    pub speed: Option<Quantity>,
    /// The nearest speed that can be transmitted.
    pub speed_rounded: Option<Quantity>,
    /// Seconds at that speed.
    pub time: Option<f64>,
}

/// A change of the telegram.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TelegramChange {
    /// Telegram before.
    pub before: u16,
    /// Telegram now.
    pub now: u16,
    /// Whether it remains selected afterwards.
    pub kept: bool,
}

/// A cycle that is too short for this computer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CycleStrained {
    /// Update time of the connection, s.
    pub cycle: f64,
    /// Watchdog of the connection, s.
    pub watchdog: f64,
    /// Longest delay of this computer, s.
    pub longest_delay: f64,
}

impl From<&Strained> for CycleStrained {
    fn from(strained: &Strained) -> Self {
        Self {
            cycle: strained.cycle.interval().as_secs_f64(),
            watchdog: strained.cycle.hold_time().as_secs_f64(),
            longest_delay: strained.delay.as_secs_f64(),
        }
    }
}

/// An axis at one moment.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AxisState {
    /// Seconds since control was taken.
    pub time: f64,
    /// State of the drive and the words that are exchanged. The bits have the names of the profile.
    #[serde(flatten)]
    pub words: DriveWords,
    /// False when the connection is lost: then all of this was reported before.
    pub connected: bool,
    /// Speed that is commanded.
    pub speed_set: Option<Quantity>,
    /// Speed of the motor.
    pub speed_actual: Option<Quantity>,
    /// Position that a move leads to.
    pub target: Option<Quantity>,
    /// Position of the axis.
    pub position: Option<Quantity>,
    /// Commanded position minus position.
    pub following_error: Option<Quantity>,
}

impl From<&AxisStatus> for AxisState {
    fn from(status: &AxisStatus) -> Self {
        let view = &status.view;
        let speed = |value: f64| Quantity::speed(value, status.unit);
        let general = view.seen.map(|seen| seen.zsw1.0);
        let words = DriveWords::of(Profile::Profidrive, view.mode, Some(view.answered.0), general);
        let meaning = words::stw1_meaning_in(view.mode, view.command.stw1.0).to_owned();
        let stw1 = Word::of(
            bits::stw1(view.mode),
            view.command.stw1.0,
            view.sent,
            Some(meaning),
        );
        let zsw1 = words.zsw1.zip(view.seen).map(|(word, seen)| Word {
            number: seen.word.into(),
            hex: hex16(seen.word),
            ..word
        });
        Self {
            time: status.time.as_secs_f64(),
            words: DriveWords {
                stw1: Some(stw1),
                zsw1,
                ..words
            },
            connected: !status.lost,
            speed_set: status.speed_set.map(speed),
            speed_actual: status
                .speed_actual
                .map(|value| speed(value).beyond(status.speed_beyond)),
            target: status.target.map(Quantity::turns),
            position: status.position.map(Quantity::turns),
            following_error: status.following_error.map(Quantity::turns),
        }
    }
}

/// Cyclic frames of a connection.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Frames {
    /// Frames that were received.
    pub received: u64,
    /// Frames that are missing between them.
    pub missed: u64,
    /// Longest time without a frame, s.
    pub longest_gap: f64,
}

impl From<&CyclicStatistics> for Frames {
    fn from(statistics: &CyclicStatistics) -> Self {
        Self {
            received: statistics.received,
            missed: statistics.missed,
            longest_gap: statistics.longest_gap.as_secs_f64(),
        }
    }
}

/// How a motion ended. What a verb does not measure is null.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MotionEnd {
    /// Whether control was released.
    pub released: bool,
    /// Whether the axis turns on with its power stage off.
    pub coasts: bool,
    /// Whether it was stopped before its end, by Ctrl-C or a signal.
    pub interrupted: bool,
    /// Frames of the connection; null where there was none.
    pub frames: Option<Frames>,
    /// Whether the speed or the target was reached.
    pub reached: Option<bool>,
    /// Last speed before the stop.
    pub speed: Option<Quantity>,
    /// Seconds at the speed that was commanded.
    pub time_at_speed: Option<f64>,
    /// Position at the target.
    pub position: Option<Quantity>,
    /// Position to which the axis has moved since it was at its target.
    pub left_to: Option<Quantity>,
    /// Distance from the begin of the motion.
    pub distance: Option<Quantity>,
    /// Whether the axis has its home position.
    pub homed: Option<bool>,
    /// Motion task that was commanded.
    pub task: Option<u16>,
    /// Motion task that the drive reports as active (AKTSATZ).
    pub active_task: Option<u16>,
    /// Faults that are present, where a verb acknowledges them.
    pub faults: Vec<Fault>,
}

impl MotionEnd {
    /// Returns the end of a motion whose axis was released.
    #[must_use]
    pub fn released(rest: Rest, interrupted: bool, statistics: Option<&CyclicStatistics>) -> Self {
        Self {
            released: true,
            coasts: rest == Rest::Coasts,
            interrupted,
            frames: statistics.map(Frames::from),
            ..Self::default()
        }
    }
}
