//! Signals of many drives, recorded: parameters that are read at an interval, or every cyclic signal with each cycle.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use std::time::Duration;
//!
//! use profidrive::{Access, Opening, Wait};
//! use profidrive::recording::{Every, News, Recording, Request, prepare};
//!
//! let plant = r#"
//!     [[drive]]
//!     name = "akd-1"
//!     ip = "192.168.0.11/24"
//! "#;
//! let opening = Opening::new(Access::Cyclic).in_plant(plant.parse()?);
//! let mut network = opening.clone().open()?;
//! let fleet = opening.select(&mut network, &"akd-*".parse()?).wait()?;
//! let request = Request {
//!     time: Some(Duration::from_secs(1)),
//!     ..Request::new(["ZSW1", "NIST_A"], Every::CYCLE)
//! };
//! let mut sources = Vec::new();
//! for member in prepare(&network, fleet.members, &request).wait() {
//!     sources.push(member.result?);
//! }
//! let mut recording = Recording::begin(&network, network.wall_clock(), sources, &request)?;
//! let mut rows = Vec::new();
//! while let Some(news) = recording.next().wait()? {
//!     if let News::Row(row) = news {
//!         rows.push(row);
//!     }
//! }
//! // a row each 16 ms, and the control word of the connection commands nothing
//! assert!((60..=64).contains(&rows.len()), "{}", rows.len());
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod batch;
mod csv;
mod cyclic;
mod error;
mod file;
mod overlay;
mod plot;
mod poll;
mod producer;
mod remark;
mod run;
#[cfg(feature = "simulate")]
mod runs;
mod samples;
mod scope;
mod source;
mod table;
#[cfg(feature = "simulate")]
mod trace;
mod trigger;

use std::time::Duration;

pub use batch::{Batch, FORM, schema};
pub use csv::CsvLines;
pub use error::{RecordingError, WriteError};
pub use file::{Form, RecordingFile, Rotation};
pub use overlay::{EarlierStep, OverlayError, overlay};
pub use plot::{Mark, PlotError, html, svg};
pub use producer::{Absence, RecordingStop};
pub use run::{DriveCounts, News, Recording, Triggered};
#[cfg(feature = "simulate")]
pub use runs::{MeasuredRun, Runs};
pub use samples::{MotionRecorded, MotionRecorder};
pub use scope::{Curve, Point, Scope};
pub use source::{Source, prepare};
pub use table::{Column, Kind, Row, Sink, Table, Value};
#[cfg(feature = "simulate")]
pub use trace::{trace_columns, trace_rows, trace_table};
pub use trigger::{Comparison, MOST_BEFORE, Trigger, TriggerError};

/// What is to be recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Parameters as people name them; with each cycle the names of signals of the telegram (`ZSW1`), or `all`.
    pub signals: Vec<String>,
    /// When there are values.
    pub every: Every,
    /// How long to record, from the start or from the trigger; when `None` until the caller stops it.
    pub time: Option<Duration>,
    /// Nothing is recorded before this happens.
    pub trigger: Option<Trigger>,
    /// How much of the time before the trigger is recorded.
    pub pre: Duration,
}

/// When there are values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Every {
    /// Parameters are read at this interval, beside a controller too.
    Interval(Duration),
    /// With each cycle of a cyclic connection that commands nothing. It is opened to drives without a controller whose power
    /// stage is off: a controller is refused as long as it lasts.
    Cycle {
        /// Update time; see [`AxisSettings::cycle`](client::AxisSettings::cycle).
        cycle: Option<Duration>,
        /// Update times without data until both sides stop; see [`AxisSettings::watchdog`](client::AxisSettings::watchdog).
        watchdog: Option<u16>,
    },
}

impl Every {
    /// With each cycle, at the update time that is chosen without a wish.
    pub const CYCLE: Self = Self::Cycle {
        cycle: None,
        watchdog: None,
    };
}

impl Request {
    /// These signals, from the start until the caller stops it.
    pub fn new<S: Into<String>>(signals: impl IntoIterator<Item = S>, every: Every) -> Self {
        Self {
            signals: signals.into_iter().map(Into::into).collect(),
            every,
            time: None,
            trigger: None,
            pre: Duration::ZERO,
        }
    }

    /// Checks what is wrong whatever the drives are like.
    ///
    /// # Errors
    /// No signal, one that is named twice, an interval that is too short.
    pub fn check(&self) -> Result<(), RecordingError> {
        source::check(self)
    }
}
