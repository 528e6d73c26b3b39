//! Watching a drive: its words, its speeds and parameters, read again and again beside its controller. Nothing is changed.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use std::time::Duration;
//!
//! use profidrive::Wait;
//! use profidrive::monitor::Monitor;
//!
//! let plant = r#"
//!     [[drive]]
//!     name = "akd-1"
//!     ip = "192.168.0.11/24"
//!     event = [{ at = "1s", do = "fault=439" }]
//! "#;
//! let mut network = profidrive::open_plan(plant.parse()?)?;
//! let mut drive = network.find(&"akd-1".parse()?).wait()?;
//! let speed = drive.select("VL.FB")?;
//! let mut monitor = Monitor::new(Duration::from_millis(100))?.with(vec![speed]);
//! let end = network.now() + Duration::from_secs(2);
//! let mut faults = Vec::new();
//! loop {
//!     let silent = || println!("the drive does not answer; waiting for it");
//!     match monitor.read_reporting_silence(&mut network, &mut drive, silent).wait()? {
//!         Some(observation) => faults.extend(observation.faults),
//!         None => break,
//!     }
//!     if !monitor.pause(&mut network, end).wait()? {
//!         break;
//!     }
//! }
//! // once, though it was there in ten readings
//! assert_eq!(faults.iter().map(|fault| fault.number).collect::<Vec<_>>(), [439]);
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::time::{Duration, SystemTime};

use client::{Advice, Drive, Error, ErrorKind, FaultEntry, Session, Snapshot};
use profile::value::Selection;
use profinet::Instant;

use crate::clock::{WallClock, lasting};
use crate::report::DriveWords;

/// The shortest time between two readings: faster than that the parameter channel of the drive is blocked for others.
pub const SHORTEST_INTERVAL: Duration = Duration::from_millis(10);

/// A drive usually answers within milliseconds; after this time without an answer it counts as silent.
pub const SILENCE: Duration = Duration::from_secs(1);

/// Why a drive is no longer watched.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MonitorError {
    /// The caller requested a stop while the drive was silent.
    #[error("{drive} has not answered for {}", lasting(*.waited))]
    Silent {
        /// The drive.
        drive: String,
        /// For how long.
        waited: Duration,
    },
    /// The drive cannot be reached.
    #[error(transparent)]
    Client(#[from] Error),
}

impl MonitorError {
    /// The kind of the error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Silent { .. } => ErrorKind::Unreachable,
            Self::Client(error) => error.kind(),
        }
    }

    /// What to do; empty where there is nothing to add.
    #[must_use]
    pub fn advice(&self) -> Advice {
        match self {
            Self::Client(error) if !Self::is_of_drive(error) => error.advice().unwrap_or_default(),
            _ => Advice::from("check power and cable of the drive; {scan} lists who answers"),
        }
    }

    /// Returns true where the drive does not answer, and not for a fault of what carries the frames.
    #[must_use]
    pub fn is_of_drive(error: &Error) -> bool {
        error.kind() == ErrorKind::Unreachable && !matches!(error, Error::Medium(_))
    }
}

/// Readings were to follow each other faster than [`SHORTEST_INTERVAL`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("at least {} ms between two readings", SHORTEST_INTERVAL.as_millis())]
pub struct TooFast;

/// Reads a drive at an interval, and notices the faults that come.
#[derive(Debug, Clone)]
pub struct Monitor {
    more: Vec<Selection>,
    interval: Duration,
    clock: WallClock,
    /// When the first reading arrived.
    first: Option<Instant>,
    /// When the last reading began.
    last: Instant,
    /// Fault counter of the last reading.
    counted: Option<u16>,
    /// Numbers of the faults that were present then.
    present: Vec<u16>,
}

/// A drive at a moment.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Observation {
    /// From the arrival of the first reading to that of this one.
    pub time: Duration,
    /// The time of day at which it arrived; `None` in virtual time, and where the monitor has no clock.
    pub wall: Option<SystemTime>,
    /// From the request to the answer: long after an outage.
    pub answer_time: Duration,
    /// The drive did not know the connection any more and was connected to again: it has restarted.
    pub restarted: bool,
    /// What the drive reported.
    pub snapshot: Snapshot,
    /// Faults that came since the reading before; with the first reading those that were present.
    pub faults: Vec<FaultEntry>,
}

impl Observation {
    /// Returns how long the drive had not answered before this reading; `None` where it answered in time.
    #[must_use]
    pub fn outage(&self) -> Option<Duration> {
        Some(self.answer_time).filter(|time| *time >= SILENCE)
    }
}

impl Monitor {
    /// Will read state and speeds, each reading `interval` after the one before began.
    ///
    /// # Errors
    /// When the interval is shorter than [`SHORTEST_INTERVAL`].
    pub fn new(interval: Duration) -> Result<Self, TooFast> {
        if interval < SHORTEST_INTERVAL {
            return Err(TooFast);
        }
        Ok(Self {
            more: Vec::new(),
            interval,
            clock: WallClock::NONE,
            first: None,
            last: Instant::ZERO,
            counted: None,
            present: Vec::new(),
        })
    }

    /// Returns the same that reads these parameters too.
    #[must_use]
    pub fn with(self, more: Vec<Selection>) -> Self {
        Self { more, ..self }
    }

    /// Returns the same that stamps readings with the time of day too ([`Caller::wall_clock`](crate::Caller::wall_clock)).
    #[must_use]
    pub fn stamped_by(self, clock: WallClock) -> Self {
        Self { clock, ..self }
    }

    /// Returns the time from the arrival of the first reading until now; `None` before there is one.
    #[must_use]
    pub fn elapsed(&self, session: &Session) -> Option<Duration> {
        self.first.map(|first| session.now() - first)
    }

    /// Reads the drive now. Faults are read only where the status word reports one or the drive counted one.
    ///
    /// # Errors
    /// When the drive cannot be reached or the caller requests a stop. What it refuses is in the snapshot.
    pub async fn read(&mut self, session: &mut Session, drive: &mut Drive) -> Result<Observation, Error> {
        self.last = session.now();
        let (snapshot, restarted) = match session.snapshot(drive, &self.more).await {
            // it is there, and has lost what it knew
            Err(Error::ConnectionLost { .. }) => {
                session.forget(drive);
                (session.snapshot(drive, &self.more).await?, true)
            }
            other => (other?, false),
        };
        let arrived = session.now();
        let wall = self.clock.before(Duration::ZERO);
        let mut faults = Vec::new();
        // PNU 944 may count situations only: a further fault of one is in the buffer alone
        let again = restarted || self.counted != snapshot.fault_counter;
        self.counted = snapshot.fault_counter;
        if again || DriveWords::from(&snapshot).fault_bit == Some(true) {
            let buffer = session.faults(drive).await.unwrap_or_default();
            let present: Vec<FaultEntry> = buffer.into_iter().filter(|fault| fault.situation == 0).collect();
            let numbers = present.iter().map(|fault| fault.number).collect();
            let before = std::mem::replace(&mut self.present, numbers);
            let is_new = |fault: &FaultEntry| again || !before.contains(&fault.number);
            faults = present.into_iter().filter(is_new).collect();
        }
        Ok(Observation {
            time: arrived - *self.first.get_or_insert(arrived),
            wall,
            answer_time: arrived - self.last,
            restarted,
            snapshot,
            faults,
        })
    }

    /// As [`read`](Self::read), for a person who waits: `notify` is called once when the drive is silent for [`SILENCE`]. Returns
    /// `None` when the caller requests a stop of a drive that is not silent. After an error the connections to the drive are
    /// dropped, as it would not answer a release.
    ///
    /// # Errors
    /// When the drive cannot be reached, or the caller requests a stop while it is silent.
    pub async fn read_reporting_silence(
        &mut self,
        session: &mut Session,
        drive: &mut Drive,
        notify: impl FnMut() + Send + 'static,
    ) -> Result<Option<Observation>, MonitorError> {
        let begin = session.now();
        let read = async |session: &mut Session| self.read(session, drive).await;
        let result = session.reporting_silence(SILENCE, read, notify).await;
        let waited = session.now() - begin;
        let error = match result {
            Ok(seen) => return Ok(Some(seen)),
            Err(Error::Interrupted) if waited < SILENCE => return Ok(None),
            Err(Error::Interrupted) => MonitorError::Silent {
                drive: drive.label(),
                waited,
            },
            Err(error) => error.into(),
        };
        session.forget(drive);
        Err(error)
    }

    /// Lets the time pass until the next reading is due, which is at once after one that took longer than the interval.
    /// Returns false when `end` came first or the caller requests a stop.
    ///
    /// # Errors
    /// When the medium fails.
    pub async fn pause(&self, session: &mut Session, end: Instant) -> Result<bool, Error> {
        let due = self.last + self.interval;
        match session.pass(due.min(end) - session.now()).await {
            Err(Error::Interrupted) => Ok(false),
            passed => passed.map(|()| session.now() < end),
        }
    }
}
