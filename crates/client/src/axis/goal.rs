//! Goals of an axis, their progress, and the causes of failure.

use core::time::Duration;

use profile::state::{Mode, State, Stw1, Zsw1};

use super::command::Traverse;
use super::seen::state_words;

/// One of the two jog setpoints of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Jog {
    /// STW1 bit 8.
    One,
    /// STW1 bit 9.
    Two,
}

impl Jog {
    /// Returns the bit of STW1 that starts it.
    #[must_use]
    pub const fn bit(self) -> Stw1 {
        match self {
            Self::One => Stw1::JOG_1,
            Self::Two => Stw1::JOG_2,
        }
    }
}

/// How an axis stops; the later ones replace the earlier ones, never the other way round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum StopKind {
    /// Along its ramp (OFF1).
    #[default]
    Ramp,
    /// By its quick stop (OFF3).
    Quick,
    /// With its power stage off at once (OFF2): it coasts until friction or a brake has stopped it.
    Coast,
}

/// A goal of the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goal {
    /// Nothing: control is not taken.
    Released,
    /// What the drive obeyed before control of it was taken goes on. Only where an axis begins with it
    /// ([`AxisControl::taking_over`](super::AxisControl::taking_over)).
    Keep,
    /// Control taken, standing, ready for switching on (S2).
    Ready,
    /// Operation (S4), standing: speed setpoint 0, no task. A task under way is stopped along its ramp and discarded.
    Enabled,
    /// Operation (S4) at this NSOLL_A. Velocity mode only.
    Run {
        /// Speed setpoint as it travels (N2).
        setpoint: i16,
    },
    /// Operation (S4) at a jog setpoint of the drive.
    Jog(Jog),
    /// Operation (S4) and real-time jogging (STW1 bits 12 and 13) at these values; they may change while it jogs. Position
    /// mode only. Source: AKD manual 5.4 and 5.10.2.
    RealTimeJog {
        /// Speed and ramps as they travel.
        values: Traverse,
        /// Counter-clockwise (bit 13).
        backwards: bool,
    },
    /// Operation (S4) and this traversing task, by the handshake of STW1 bit 6 and ZSW1 bit 12; reached at its target.
    /// Position mode only. After [`Goal::Pause`] the same task goes on.
    Traverse(Traverse),
    /// Intermediate stop (STW1 bit 5) of the task; reached at standstill. Position mode only.
    Pause,
    /// Operation (S4) and homing (STW1 bit 11). Position mode only.
    Home {
        /// The procedure sets the position where the axis stands: ZSW1 bit 11 need not be seen to go first.
        on_the_spot: bool,
    },
    /// The fault acknowledged, then as [`Goal::Ready`].
    Acknowledge,
    /// Ramp stop (OFF1) until the pulses are off.
    Stop,
}

impl Goal {
    /// Returns true when the axis is in operation (S4) while this is pursued, so that it may turn.
    #[must_use]
    pub const fn operates(self) -> bool {
        !matches!(
            self,
            Self::Released | Self::Ready | Self::Acknowledge | Self::Stop
        )
    }

    /// Returns true when this moves the axis, or may.
    #[must_use]
    pub const fn moves(self) -> bool {
        matches!(
            self,
            Self::Run { .. }
                | Self::Jog(_)
                | Self::RealTimeJog { .. }
                | Self::Traverse(_)
                | Self::Home { .. }
        )
    }

    /// Returns the mode of the drive that this needs; `None` when it does not matter.
    #[must_use]
    pub const fn mode(self) -> Option<Mode> {
        match self {
            Self::Run { .. } => Some(Mode::Velocity),
            Self::Traverse(_) | Self::Pause | Self::Home { .. } | Self::RealTimeJog { .. } => {
                Some(Mode::Position)
            }
            _ => None,
        }
    }
}

/// How far the axis is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// On the way.
    Pursuing,
    /// Reached, and kept.
    Reached,
    /// Given up; the axis is being stopped or stands.
    Failed(Trouble),
}

/// Why a goal was given up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Trouble {
    /// ZSW1 bit 3 came.
    #[error("the drive reports a fault (ZSW1 bit 3)")]
    Fault,
    /// ZSW1 bit 3 stayed after the acknowledge edge.
    #[error("the fault stays after acknowledging (ZSW1 bit 3)")]
    FaultStays,
    /// ZSW1 bit 9 stayed 0.
    #[error("the drive does not ask for control by the PLC (ZSW1 bit 9 is 0): it is in local operation")]
    LocalOperation,
    /// The drive did not reach the state in time.
    #[error("the drive stays in {}", state_words(*state))]
    StuckIn {
        /// Where it is, `None` in a self test.
        state: Option<State>,
    },
    /// The drive left S4 without a command of this client. It is not switched on again automatically.
    #[error("the drive left operation without a command, it is in {} now", state_words(*state))]
    LeftOperation {
        /// Where it is, `None` in a self test.
        state: Option<State>,
    },
    /// The ramp stop took too long, the quick stop was used.
    #[error("the ramp stop did not end in time, a quick stop (OFF3) was commanded")]
    QuickStopUsed,
    /// Neither ramp stop nor quick stop ended in time.
    #[error("the axis did not come to a standstill")]
    NotStopped,
    /// The power stage is off, but the axis is not at rest, or not yet.
    #[error("the power stage is off, but the axis turns: something pulls at it and no brake holds it")]
    StillTurns,
    /// The goal belongs to the other mode of the drive.
    #[error("the drive is not in the mode for this ({})", mode_words(*needed))]
    OtherMode {
        /// The mode it would need.
        needed: Mode,
    },
    /// ZSW1 bit 12 did not follow the edge of STW1 bit 6.
    #[error("the drive does not accept the traversing task (ZSW1 bit 12 stays 0){}", unhomed(*homed))]
    NotAccepted {
        /// ZSW1 bit 11: the home position is set.
        homed: bool,
    },
    /// ZSW1 bit 12 did not go back with STW1 bit 6.
    #[error("the drive does not take its acknowledge of the last task back (ZSW1 bit 12 stays 1)")]
    AcceptanceStays,
    /// The axis stands, but not at the target of its task.
    #[error("the axis stopped before the target of its task (ZSW1 bit 13 is 1, bit 10 is 0)")]
    TargetNotReached,
    /// The drive did not begin to home.
    #[error("the drive does not start homing (ZSW1 bits 11 and 13 do not react to STW1 bit 11)")]
    HomingNotStarted,
    /// Homing ended without a home position.
    #[error("homing ended without a home position (ZSW1 bit 13 is 1, bit 11 is 0)")]
    HomingFailed,
    /// Its stop handle stopped it, or all axes were stopped.
    #[error("it was stopped from elsewhere in this program")]
    Stopped,
    /// No call was made for the axis before its deadline ([`AxisSettings::lease`](crate::AxisSettings::lease)): its owner
    /// hangs or keeps it without using it. The axis was brought to rest.
    #[error("no call was made for the axis in time, it was brought to rest")]
    Unattended,
    /// The connection lives, but the inputs are marked bad (IOPS).
    #[error("the drive marks its data as not valid (IOPS bad)")]
    NoInputs,
}

impl Trouble {
    /// Returns its stable name, for programs.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Fault => "fault",
            Self::FaultStays => "fault-stays",
            Self::LocalOperation => "local-operation",
            Self::StuckIn { .. } => "stuck",
            Self::LeftOperation { .. } => "left-operation",
            Self::QuickStopUsed => "quick-stop-used",
            Self::NotStopped => "not-stopped",
            Self::StillTurns => "still-turns",
            Self::OtherMode { .. } => "other-mode",
            Self::NotAccepted { .. } => "not-accepted",
            Self::AcceptanceStays => "acceptance-stays",
            Self::TargetNotReached => "target-not-reached",
            Self::HomingNotStarted => "homing-not-started",
            Self::HomingFailed => "homing-failed",
            Self::Stopped => "stopped",
            Self::Unattended => "unattended",
            Self::NoInputs => "no-inputs",
        }
    }
}

fn mode_words(mode: Mode) -> &'static str {
    match mode {
        Mode::Velocity => "velocity mode",
        Mode::Position => "position mode",
    }
}

fn unhomed(homed: bool) -> &'static str {
    if homed {
        ""
    } else {
        ": the axis is not homed (ZSW1 bit 11 is 0)"
    }
}

/// Times and thresholds of the control.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// How long a control word must stand so that the drive sees it: some cycles.
    pub dwell: Duration,
    /// How long switching on, or acknowledging, may take.
    pub step: Duration,
    /// How long the ramp stop may take before the quick stop is used, and the quick stop before giving up.
    pub stop: Duration,
    /// How long a coast stop may take: nothing brakes the axis.
    pub coast: Duration,
    /// How long a coasting axis has to stand to be at rest: one that swings back stands for a moment, too.
    pub rest: Duration,
    /// Speed (as NIST_A) below which the axis stands.
    pub standstill: u16,
    /// How long the drive may take to accept a task, to start homing and to take an acknowledge back.
    pub accept: Duration,
    /// How long the axis may stand away from its target, or after homing without a home position.
    pub settle: Duration,
    /// Bits of ZSW1 that report a running task; none where the vendor has no such bit.
    pub task_active: Zsw1,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            dwell: Duration::from_millis(64),
            step: Duration::from_secs(5),
            stop: Duration::from_secs(10),
            coast: Duration::from_secs(60),
            rest: Duration::from_millis(500),
            standstill: 14,
            accept: Duration::from_secs(2),
            settle: Duration::from_secs(2),
            task_active: Zsw1(0),
        }
    }
}
