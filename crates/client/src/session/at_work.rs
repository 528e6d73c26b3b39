//! Whether a drive is at work: what a reset, another name or another address would disturb. Reads only.

use std::time::Duration;

use profile::catalogue::Part;

use super::{STANDS, Session};
use crate::engine::Interest;
use crate::{AtWork, Drive, Error};

/// Longer than any wait.
const FOREVER: Duration = Duration::from_secs(365 * 24 * 3600);

impl Session {
    /// Checks that no controller is connected to a drive. `undone` is the action that is not done otherwise: `renamed`.
    ///
    /// A drive that cannot be read passes: another name or address is how it becomes reachable.
    ///
    /// # Errors
    /// [`Error::AtWork`] when a controller is connected, [`Error::Interrupted`] when the caller requests a stop.
    pub async fn check_unowned(&mut self, drive: &Drive, undone: &'static str) -> Result<(), Error> {
        let owner = answered(self.owner(drive).await)?;
        let works = owner.flatten().flatten().map(AtWork::Controller);
        idle(drive, undone, works)
    }

    /// Checks that a drive is not at work: no controller is connected, its axis stands and its power stage is off.
    /// `undone` is the action that is not done otherwise: `reset`.
    ///
    /// A drive that cannot be read passes, and so does one that does not report its speed or state.
    ///
    /// # Errors
    /// [`Error::AtWork`] when it is at work, [`Error::Interrupted`] when the caller requests a stop.
    pub async fn check_idle(&mut self, drive: &mut Drive, undone: &'static str) -> Result<(), Error> {
        self.check_unowned(drive, undone).await?;
        let works = self.motion(drive).await?;
        idle(drive, undone, works)
    }

    /// Returns true while this program has the axis of a drive. [`owner`](Self::owner) then has the name of this program.
    #[must_use]
    pub fn has_axis(&self, drive: &Drive) -> bool {
        self.engine.records().own_axis(drive).is_some()
    }

    /// Waits until nothing carries the network any more, and returns why: it was closed, or the thread that carries it has failed.
    pub async fn carrier_ended(&self) -> Error {
        loop {
            let due = self.now() + FOREVER;
            match self.engine.next_turn(due, Interest::Events).await {
                Err(error) if error.is_final() => return error,
                // a wire that failed may come back
                _ => {}
            }
        }
    }

    /// Returns whether cyclic data can travel from here, so that a control word reaches the drive: not over UDP alone.
    #[must_use]
    pub fn carries_cyclic_data(&self, drive: &Drive) -> bool {
        drive.is_on_line() || (self.engine.discovers() && self.engine.receives_calls())
    }

    /// Reads whether the axis of a drive turns or its power stage is on; `None` for one that is off and stands, that cannot be read,
    /// or that does not report its speed or state.
    ///
    /// # Errors
    /// [`Error::Interrupted`] when the caller requests a stop.
    pub async fn motion(&mut self, drive: &mut Drive) -> Result<Option<AtWork>, Error> {
        let readings = answered(self.ask(drive, &[Part::Speed, Part::SpeedActual]).await)?;
        let speed = readings.and_then(|readings| {
            readings
                .rpm(Part::Speed)
                .or_else(|| readings.rpm(Part::SpeedActual))
        });
        if let Some(speed) = speed.filter(|speed| speed.abs() >= STANDS) {
            return Ok(Some(AtWork::Turns(speed)));
        }
        let on = answered(self.is_enabled(drive).await)?.flatten();
        Ok(on.filter(|on| *on).map(|_| AtWork::Enabled))
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
