//! Whether a drive is at work: what a reset, another name or another address would disturb. Reads only.

use std::fmt;

use profile::catalogue::Part;

use super::Session;
use super::stop::STANDS;
use crate::{Drive, Error};

/// What a drive is at work with.
#[derive(Debug, Clone, PartialEq)]
pub enum AtWork {
    /// A controller of this station name is connected.
    Controller(String),
    /// The axis turns at this speed in rpm, whether its power stage is on or not.
    Turns(f64),
    /// The power stage is on.
    Enabled,
}

impl fmt::Display for AtWork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Controller(name) if name.is_empty() => {
                write!(f, "a controller without a name is running it")
            }
            Self::Controller(name) => write!(f, "controller \"{name}\" is running it"),
            Self::Turns(speed) => write!(f, "its axis turns at {speed:.1} rpm"),
            Self::Enabled => write!(f, "its power stage is on"),
        }
    }
}

impl Session {
    /// Checks that no controller is connected to a drive. `undone` says what is not done otherwise: `renamed`.
    ///
    /// A drive that cannot be asked passes: another name or address is how it becomes reachable.
    ///
    /// # Errors
    /// [`Error::AtWork`] when a controller is connected, [`Error::Interrupted`] when the caller wants to stop.
    pub async fn check_unowned(&mut self, drive: &Drive, undone: &'static str) -> Result<(), Error> {
        let owner = answered(self.owner(drive).await)?;
        let works = owner.flatten().flatten().map(AtWork::Controller);
        idle(drive, undone, works)
    }

    /// Checks that a drive is not at work: no controller is connected, its axis stands and its power stage is off.
    /// `undone` says what is not done otherwise: `reset`.
    ///
    /// A drive that cannot be asked passes, and so does one that does not report its speed or state.
    ///
    /// # Errors
    /// [`Error::AtWork`] when it is at work, [`Error::Interrupted`] when the caller wants to stop.
    pub async fn check_idle(&mut self, drive: &mut Drive, undone: &'static str) -> Result<(), Error> {
        self.check_unowned(drive, undone).await?;
        let readings = answered(self.ask(drive, &[Part::Speed, Part::SpeedActual]).await)?;
        let speed = readings.and_then(|readings| {
            readings
                .rpm(Part::Speed)
                .or_else(|| readings.rpm(Part::SpeedActual))
        });
        let turns = speed.filter(|speed| speed.abs() >= STANDS).map(AtWork::Turns);
        let on = match turns {
            Some(_) => None,
            None => answered(self.is_enabled(drive).await)?.flatten(),
        };
        let enabled = on.filter(|on| *on).map(|_| AtWork::Enabled);
        idle(drive, undone, turns.or(enabled))
    }
}

fn idle(drive: &Drive, undone: &'static str, works: Option<AtWork>) -> Result<(), Error> {
    works.map_or(Ok(()), |works| {
        let drive = drive.label();
        Err(Error::AtWork { drive, undone, works })
    })
}

/// Returns the answer of a drive, if there was one.
fn answered<T>(result: Result<T, Error>) -> Result<Option<T>, Error> {
    match result {
        Err(error @ Error::Interrupted) => Err(error),
        other => Ok(other.ok()),
    }
}
