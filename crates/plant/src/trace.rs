//! The trace of a plant: its entries and their text.

use std::fmt;

use profile::state::{Stw1, Zsw1};
use profinet::Instant;

use crate::event::PlantEvent;
use crate::timeline::Played;

/// One line of a trace. The same plant gives the same lines every time.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Virtual time.
    pub at: Instant,
    /// Name of the drive it is about.
    pub drive: String,
    /// What.
    pub what: What,
}

/// Content of a trace entry.
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// Something of the time line happened.
    Happened(Played),
    /// The drive reported an event.
    Reported(String),
    /// Its controller reported an event.
    Controller(String),
    /// Where the drive is, at a sample or because its status word has changed.
    Values {
        /// Control word in force.
        stw1: Stw1,
        /// Status word it sends.
        zsw1: Zsw1,
        /// Speed, rpm.
        speed: f64,
        /// Position, rev.
        position: f64,
        /// Current, A.
        current: f64,
    },
}

impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let micros = self.at.as_nanos() / 1000;
        write!(
            f,
            "{:>5}.{:06} s  {:<12} ",
            micros / 1_000_000,
            micros % 1_000_000,
            self.drive
        )?;
        self.what.fmt(f)
    }
}

impl fmt::Display for What {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Happened(Played { what, lasts: None }) => write!(f, "! {what}"),
            Self::Happened(Played {
                what,
                lasts: Some(lasts),
            }) => write!(f, "! {what} for {} s", lasts.as_secs_f64()),
            Self::Reported(text) => f.write_str(text),
            Self::Controller(text) => write!(f, "controller: {text}"),
            Self::Values {
                stw1,
                zsw1,
                speed,
                position,
                current,
            } => write!(
                f,
                "STW1 0x{:04X} ZSW1 0x{:04X} {speed:.2} rpm {position:.5} rev {current:.3} A",
                stw1.0, zsw1.0
            ),
        }
    }
}

impl What {
    /// Creates an event that lasts until the next change.
    #[must_use]
    pub const fn happened(what: PlantEvent) -> Self {
        Self::Happened(Played { what, lasts: None })
    }
}
