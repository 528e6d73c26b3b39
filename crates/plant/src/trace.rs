//! What happens in a plant, as typed events, and their text.

use std::fmt;
use std::time::Duration;

use profile::catalogue::Catalogue;
use profile::state::{State, Stw1, Zsw1};
use profinet::Instant;
use profinet::wire::PnioStatus;
use profinet::wire::status::abort;
use serde::Serialize;
use virtual_drive::station::StationEvent;

use crate::expect::{Observed as _, Quantity};
use crate::snapshot::Snapshot;
use crate::timeline::Played;
use crate::written::{ParameterReading, WrittenBy};

/// Something that happened to a drive of a plant. The same plant gives the same events every time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Event {
    /// Seconds since the start of the simulation.
    pub time: f64,
    /// The same in nanoseconds.
    pub time_ns: u64,
    /// Name of the drive.
    pub drive: String,
    /// What happened.
    #[serde(flatten)]
    pub kind: EventKind,
}

/// What happened to a drive. Numbers are fields, never text alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub enum EventKind {
    /// The state of the general state machine changed.
    StateChanged {
        /// State before, 1 to 5.
        #[serde(serialize_with = "state_number")]
        #[cfg_attr(feature = "schema", schemars(with = "u8"))]
        old: State,
        /// State now, 1 to 5.
        #[serde(serialize_with = "state_number")]
        #[cfg_attr(feature = "schema", schemars(with = "u8"))]
        new: State,
    },
    /// A fault came.
    FaultRaised {
        /// The fault.
        fault: DriveMessage,
    },
    /// A fault was acknowledged.
    FaultCleared {
        /// The fault.
        fault: DriveMessage,
    },
    /// A warning came.
    WarningRaised {
        /// The warning.
        warning: DriveMessage,
    },
    /// A warning went.
    WarningCleared {
        /// The warning.
        warning: DriveMessage,
    },
    /// Where the drive is, at a sample or because its status word has changed.
    Sample(Sample),
    /// A controller opened a connection.
    Connected {
        /// Its name of station.
        controller: String,
    },
    /// Controller and drive exchange data.
    Exchanging {
        /// Number of the telegram in use.
        telegram: u16,
    },
    /// The connection of the controller was lost.
    ConnectionLost {
        /// The cause in words.
        cause: String,
        /// The PNIO status that stands for it: ErrorCode, ErrorDecode, ErrorCode1 and ErrorCode2 from the highest octet down.
        status: u32,
    },
    /// The controller released its connection.
    Released,
    /// Something was done to the drive from outside, by its time line or by a caller.
    Injected {
        /// What, in the notation of plant files.
        action: String,
        /// Seconds until it ends by itself; null for something without an end.
        duration: Option<f64>,
    },
    /// Something that was to last for a time has ended.
    Restored {
        /// What was done to end it, in the notation of plant files.
        action: String,
    },
    /// The axis arrived at the target of a traversing task.
    TargetReached {
        /// Position that the drive reports, in revolutions.
        position: f64,
    },
    /// The axis has its home position.
    Homed,
    /// The drive ignores a setpoint that is outside its limits.
    SetpointIgnored {
        /// Name of the parameter of the setpoint.
        parameter: String,
        /// Its number.
        pnu: u16,
        /// The number as it came.
        raw: i64,
    },
    /// A parameter was written: by a controller, a tool or the owner of the simulation.
    ParameterWritten {
        /// The parameter as the drive reports it since.
        reading: ParameterReading,
        /// How the change reached the drive.
        by: WrittenBy,
    },
    /// Anything else, in words.
    Note {
        /// The words.
        text: String,
    },
}

/// A fault or a warning of a drive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DriveMessage {
    /// Its number.
    pub number: u16,
    /// Its meaning; empty where the tables have none.
    pub text: String,
}

/// Words and values of a drive at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sample {
    /// Control word in force.
    pub stw1: u16,
    /// Status word it sends.
    pub zsw1: u16,
    /// Speed of the shaft, rpm.
    pub speed: f64,
    /// Position that the drive reports, rev.
    pub position: f64,
    /// Current, A.
    pub current: f64,
}

fn state_number<S: serde::Serializer>(state: &State, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_u8(state.number())
}

impl DriveMessage {
    /// Returns the fault or warning of this number with its meaning from `catalogue`.
    #[must_use]
    pub fn of(number: u16, warning: bool, catalogue: &Catalogue) -> Self {
        let meaning = catalogue.fault(number, warning).map_or("", |row| row.meaning);
        Self {
            number,
            text: meaning.to_owned(),
        }
    }
}

impl Event {
    /// Creates an event of a drive, so long after the start.
    #[must_use]
    pub fn new(after: Duration, drive: &str, kind: EventKind) -> Self {
        Self {
            time: after.as_secs_f64(),
            time_ns: u64::try_from(after.as_nanos()).unwrap_or(u64::MAX),
            drive: drive.to_owned(),
            kind,
        }
    }

    pub(crate) fn at(now: Instant, drive: &str, kind: EventKind) -> Self {
        Self::new(now - Instant::ZERO, drive, kind)
    }
}

impl From<&Snapshot> for Sample {
    fn from(snapshot: &Snapshot) -> Self {
        Self {
            stw1: snapshot.stw1().0,
            zsw1: snapshot.zsw1().0,
            speed: snapshot.quantity(Quantity::LoadSpeed),
            position: snapshot.quantity(Quantity::Position),
            current: snapshot.quantity(Quantity::Current),
        }
    }
}

impl EventKind {
    /// Returns what a station reported; `None` for what only requests to be saved.
    ///
    /// A caller that has the numbers of the faults makes a [`FaultCleared`](Self::FaultCleared) of each at an acknowledge; here
    /// it is a note.
    pub(crate) fn of_station(event: &StationEvent, catalogue: &Catalogue) -> Option<Self> {
        Some(match event {
            StationEvent::State { from, to } => Self::StateChanged { old: *from, new: *to },
            StationEvent::Fault { number } => Self::FaultRaised {
                fault: DriveMessage::of(*number, false, catalogue),
            },
            StationEvent::Warning { number, active } => {
                let warning = DriveMessage::of(*number, true, catalogue);
                if *active {
                    Self::WarningRaised { warning }
                } else {
                    Self::WarningCleared { warning }
                }
            }
            StationEvent::Connected {
                controller: true,
                station,
            } => Self::Connected {
                controller: station.clone(),
            },
            StationEvent::Exchanging { telegram } => Self::Exchanging { telegram: *telegram },
            StationEvent::Disconnected { cause } if *cause == PnioStatus::aborted(abort::RELEASED) => {
                Self::Released
            }
            StationEvent::Disconnected { cause } => Self::ConnectionLost {
                cause: cause.to_string(),
                status: u32::from_be_bytes([cause.code, cause.decode, cause.code1, cause.code2]),
            },
            StationEvent::SetpointIgnored { pnu, raw } => Self::SetpointIgnored {
                parameter: catalogue.by_pnu(*pnu).map_or("", |row| row.name).to_owned(),
                pnu: *pnu,
                raw: *raw,
            },
            StationEvent::Written(written) => Self::ParameterWritten {
                reading: ParameterReading::of(written, catalogue),
                by: written.channel.into(),
            },
            other => Self::note(other.words(catalogue)?.trim_end()),
        })
    }

    pub(crate) fn note(text: &str) -> Self {
        Self::Note {
            text: text.to_owned(),
        }
    }

    /// What came about between two status words in position mode.
    pub(crate) fn of_positioning(before: Zsw1, now: Zsw1, position: f64) -> impl Iterator<Item = Self> {
        let rose = move |bit| now.has(bit) && !before.has(bit);
        let reached = rose(Zsw1::REACHED).then_some(Self::TargetReached { position });
        let homed = rose(Zsw1::HOMED).then_some(Self::Homed);
        homed.into_iter().chain(reached)
    }
}

impl From<Played> for EventKind {
    fn from(played: Played) -> Self {
        let action = played.what.to_string();
        if played.restores {
            Self::Restored { action }
        } else {
            Self::Injected {
                action,
                duration: played.lasts.map(|lasts| lasts.as_secs_f64()),
            }
        }
    }
}

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let micros = self.time_ns / 1000;
        write!(
            f,
            "{:>5}.{:06} s  {:<12} {}",
            micros / 1_000_000,
            micros % 1_000_000,
            self.drive,
            self.kind
        )
    }
}

impl fmt::Display for DriveMessage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.number)?;
        if self.text.is_empty() {
            return Ok(());
        }
        write!(f, " {}", self.text)
    }
}

impl fmt::Display for Sample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            stw1,
            zsw1,
            speed,
            position,
            current,
        } = self;
        let (stw1, zsw1) = (Stw1(*stw1), Zsw1(*zsw1));
        write!(
            f,
            "STW1 {stw1} ZSW1 {zsw1} {speed:.2} rpm {position:.5} rev {current:.3} A"
        )
    }
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StateChanged { old, new } => write!(f, "{old} -> {new}"),
            Self::FaultRaised { fault } => write!(f, "fault F{fault}"),
            Self::FaultCleared { fault } => write!(f, "fault F{fault} is gone"),
            Self::WarningRaised { warning } => write!(f, "warning n{warning}"),
            Self::WarningCleared { warning } => write!(f, "warning n{warning} is gone"),
            Self::Sample(sample) => sample.fmt(f),
            Self::Connected { controller } => {
                write!(f, "connected: controller \"{}\"", controller.escape_debug())
            }
            Self::Exchanging { telegram } => write!(f, "exchanges data, telegram {telegram}"),
            Self::ConnectionLost { cause, .. } => write!(f, "disconnected: {cause}"),
            Self::Released => f.write_str("disconnected: released by the controller"),
            Self::Injected {
                action,
                duration: Some(duration),
            } => write!(f, "! {action} for {duration} s"),
            Self::Injected {
                action,
                duration: None,
            }
            | Self::Restored { action } => write!(f, "! {action}"),
            Self::TargetReached { position } => write!(f, "target reached at {position:.5} rev"),
            Self::Homed => f.write_str("homed"),
            Self::SetpointIgnored { parameter, pnu, raw } => write!(
                f,
                "setpoint {parameter} ({pnu}) = {raw} ignored: outside its limits, the last value stays"
            ),
            Self::ParameterWritten { reading, by } => write!(f, "{reading}, written by {by}"),
            Self::Note { text } => f.write_str(text),
        }
    }
}
