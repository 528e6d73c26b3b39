//! What a motion reports while it goes on.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use client::axis::{Evidence, Strained};
use client::{AxisStatus, FaultEntry, LossReaction, WarningEntry};
use profile::notation::Quantity;
use profile::state::Mode;
use profile::value::Reading;
use profinet::cyclic::CyclicStatistics;
use serde::Serialize;

use super::leftover::{Leftover, UnreadableNote};
use super::report::Report;
use super::start::Start;
use super::tap::{SampleTap, SharedTap};
use crate::report::Parameter;

/// Something that happened on the way.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Event {
    /// The mode of the drive (PNU 930) was changed for this motion. `None` before: it was none of the two, and is not put
    /// back.
    ModeChanged {
        /// Before.
        before: Option<Mode>,
        /// Now.
        now: Mode,
    },
    /// In a dry run: this mode would be set for the motion and put back.
    ModeWouldChange(Mode),
    /// A setting that was changed for this motion has its value from before again.
    PutBack(Setting),
    /// A setting that was changed for this motion could not be put back.
    NotPutBack {
        /// The setting; `None` where mode and telegram of the drive cannot be read.
        setting: Option<Setting>,
        /// Why.
        cause: String,
    },
    /// The jog speed still has the value of a motion whose program was killed. It is put back first, except in a dry run.
    LeftOver(Leftover),
    /// What a killed program may have left of the jog speed is not known: its note is not readable, and stays.
    NoteUnreadable(UnreadableNote),
    /// What the jog speed was before could not be noted on the disk: if this program is killed, it stays changed.
    NotNoted {
        /// The setting and its value.
        setting: Setting,
        /// Why.
        cause: String,
    },
    /// Nothing is known to stop the axis when its controller is lost; the caller consented, or nothing is known of the
    /// drive at all.
    RunsOn(LossReaction),
    /// The limit switch in the direction of the motion is hit: the drive may not turn.
    AtSwitch,
    /// A speed in Hz is converted by the pole pairs of the motor.
    Converted {
        /// The requested output frequency, Hz.
        hertz: f64,
        /// The synchronous speed, rpm.
        rpm: f64,
        /// Pole pairs of the motor.
        pole_pairs: f64,
    },
    /// The speed travels as the nearest representable value. The difference may be too small for the figures shown.
    Rounded {
        /// The requested speed.
        asked: f64,
        /// The speed that is sent.
        sent: f64,
        /// Unit of both.
        unit: &'static str,
    },
    /// Control is taken; the axis is enabled next and moves.
    Starting {
        /// The telegram in use.
        telegram: u16,
        /// What begins.
        start: Start,
    },
    /// Taking the axis changed its telegram (PNU 922).
    TelegramChanged(TelegramChange),
    /// This computer does not keep to the cycle of the connection.
    Strained(Strained),
    /// The ramp to the speed takes some time, which does not count for the motion.
    LongRamp {
        /// How long.
        time: Duration,
        /// The parameter that sets it.
        by: Option<String>,
    },
    /// The axis, after everything that happens.
    Sample(AxisStatus),
    /// Warnings that came; empty where the drive has a warning and no number for it.
    Warnings {
        /// The axis at that time.
        status: AxisStatus,
        /// The warnings.
        warnings: Vec<WarningEntry>,
    },
    /// The ramp stop takes longer than a second.
    LongStop,
    /// The motion was stopped before the axis was at its speed.
    SpeedNotReached {
        /// The requested speed.
        wanted: f64,
        /// The speed that it had.
        actual: Option<f64>,
        /// Unit of both.
        unit: &'static str,
    },
    /// The axis stood at the end of a jog.
    HeldBack(Evidence),
    /// The axis is where it was to go: target or home position.
    Arrived {
        /// At what.
        arrival: Arrival,
        /// Where it was at that time, in turns.
        position: Option<f64>,
        /// The same in counts.
        counts: Option<f64>,
        /// Where it is since the power stage is off, if that is another place.
        left_to: Option<f64>,
    },
    /// The faults that are acknowledged, or of which nothing but their cause is known to clear them.
    Faults(Vec<FaultEntry>),
    /// The faults are acknowledged by a parameter, without control of the axis.
    Clearing {
        /// The parameter as its vendor writes it.
        parameter: &'static str,
        /// PNU.
        pnu: u16,
    },
    /// Which fault the drive has cannot be read.
    FaultsUnreadable(String),
    /// Control is given back, or was not needed. Comes after every motion whose axis was taken, whatever its end.
    Ended(Box<Ended>),
}

/// A change of the telegram.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TelegramChange {
    /// Before.
    pub before: u16,
    /// Now.
    pub now: u16,
    /// It is not put back afterwards.
    pub kept: bool,
}

/// How a motion ended.
#[derive(Debug, Clone, Default)]
pub struct Ended {
    /// Counters of the cyclic connection; a serial line has none.
    pub statistics: Option<CyclicStatistics>,
    /// The caller requested a stop.
    pub interrupted: bool,
    /// What the motion was like, whatever its end.
    pub report: Report,
}

/// A setting of the drive with its value.
#[derive(Debug, Clone)]
pub enum Setting {
    /// A number of the profile: mode or telegram.
    Number {
        /// PNU.
        pnu: u16,
        /// Its value.
        value: u16,
    },
    /// A parameter as it was read.
    Reading {
        /// The parameter as its vendor writes it.
        parameter: String,
        /// Its value.
        reading: Box<Reading>,
    },
    /// A parameter as it was noted.
    Noted {
        /// The parameter as its vendor writes it.
        parameter: String,
        /// Its value.
        value: Quantity,
    },
}

impl Setting {
    /// Returns the parameter in words.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Number { pnu, .. } => format!("PNU {pnu}"),
            Self::Reading { parameter, .. } | Self::Noted { parameter, .. } => parameter.clone(),
        }
    }

    /// Returns the number of the parameter as its vendor writes it.
    #[must_use]
    pub fn number(&self) -> String {
        match self {
            Self::Number { pnu, .. } => pnu.to_string(),
            Self::Reading { reading, .. } => Parameter::from(&**reading).number,
            Self::Noted { parameter, .. } => parameter.clone(),
        }
    }

    /// Returns its value with unit and meaning.
    #[must_use]
    pub fn value(&self) -> String {
        match self {
            Self::Number { value, .. } => value.to_string(),
            Self::Reading { reading, .. } => Parameter::from(&**reading).full(),
            Self::Noted { value, .. } => value.to_string(),
        }
    }
}

/// What an axis arrived at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    /// The target of a move.
    Target,
    /// The target of the last one of a chain of motion tasks that begins with this one.
    Task(u16),
    /// Its home position.
    Home,
}

/// Receives the events of a motion, on the thread that waits for it or that polls its future.
#[derive(Clone)]
pub struct Observer {
    receiver: Arc<Mutex<Receiver>>,
    tap: Option<SharedTap>,
}

type Receiver = dyn FnMut(&Event) + Send;

impl Observer {
    /// Calls `receive` for every event.
    pub fn new(receive: impl FnMut(&Event) + Send + 'static) -> Self {
        Self {
            receiver: Arc::new(Mutex::new(receive)),
            tap: None,
        }
    }

    /// Returns the same with a tap that receives every cyclic sample.
    #[must_use]
    pub fn tapped_by(self, tap: impl SampleTap + 'static) -> Self {
        Self {
            tap: Some(Arc::new(Mutex::new(tap))),
            ..self
        }
    }

    pub(super) fn tap(&self) -> Option<SharedTap> {
        self.tap.clone()
    }

    pub(super) fn report(&self, event: &Event) {
        (self.receiver.lock().unwrap_or_else(PoisonError::into_inner))(event);
    }
}

/// Ignores every event.
impl Default for Observer {
    fn default() -> Self {
        Self::new(|_| ())
    }
}

impl fmt::Debug for Observer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Observer")
    }
}
