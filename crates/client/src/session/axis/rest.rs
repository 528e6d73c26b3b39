//! The end of an axis: it is brought to rest and given back, whatever happened before.

use std::time::Duration;

use super::{Axis, AxisStatus, Rest};
use crate::axis::{Goal, Seen, Trouble};
use crate::session::takeover;
use crate::{Connection, Error, Wire};

/// How long a drive at a line that fell silent is told to stop.
const CALL_AGAIN: Duration = Duration::from_secs(2);
/// How long the first valid data of a drive is waited for.
const FIRST_DATA: Duration = Duration::from_secs(1);
/// The longest ramp that is waited for.
const LONGEST_RAMP: Duration = Duration::from_secs(600);

impl<M: Wire> Axis<'_, M> {
    pub(super) fn shut_down(&mut self) -> Result<(), Error> {
        if self.finished {
            return Ok(());
        }
        self.finished = true;
        let stopping = std::mem::replace(&mut self.session.stopping, true);
        if self.session.client.connection(self.link) == Connection::Silent {
            self.call_again();
        }
        let connection = self.session.client.connection(self.link);
        let running = connection == Connection::Running;
        let mut result = match self.lost() {
            // nobody saw it stand: whatever went before, this is no end of a stop
            Some(error) => Err(error),
            None if running => self.bring_to_rest(),
            None => Ok(()),
        };
        let released = self.session.release(self.link);
        if result.is_ok() {
            result = released;
        }
        if running && result.is_ok() {
            result = self.session.give_back(&mut self.drive, &self.kept);
        }
        self.session.under_control = None;
        self.session.stopping = stopping;
        result
    }

    /// A drive at a line that does not answer may still hear, and may run on if its time-out is not set: it is told to
    /// stop for a while, and brought to rest once it answers.
    fn call_again(&mut self) {
        self.pursue(Goal::Stop);
        let end = self.session.now() + CALL_AGAIN;
        while self.session.now() < end && self.session.client.connection(self.link) == Connection::Silent {
            if self.session.step(end).is_err() {
                return;
            }
        }
    }

    fn bring_to_rest(&mut self) -> Result<(), Error> {
        let control_taken = self
            .status()
            .is_some_and(|status| status.view.goal != Goal::Released);
        let stopped = if control_taken { self.ramp_down() } else { Ok(()) };
        self.pursue(Goal::Released);
        // the drive must see the word without control before the connection ends
        let end = self.session.now() + self.cycle * 4;
        while self.session.now() < end && self.session.client.connection(self.link) == Connection::Running {
            self.session.step(end)?;
        }
        stopped?;
        if self.quick && !self.session.hurried {
            return Err(Error::Axis {
                drive: self.drive.label(),
                trouble: Trouble::QuickStopUsed,
            });
        }
        // the power stage is off by now: a load that hangs on the shaft shows. An axis that nobody here had in operation
        // coasts from before
        let view = self.status().map(|status| status.view);
        self.rest = match view.filter(|view| view.turns) {
            None => Rest::Stands,
            Some(view) if view.seen.is_some_and(Seen::pulses_off) => Rest::Coasts,
            Some(_) => Rest::Runs,
        };
        if self.operated && self.rest != Rest::Stands {
            return Err(Error::Axis {
                drive: self.drive.label(),
                trouble: Trouble::StillTurns,
            });
        }
        Ok(())
    }

    /// As [`ramp_down`](Self::ramp_down), not to be interrupted. Of an axis that was not taken over the first data shows
    /// whether it is in operation.
    pub(in crate::session) fn come_to_rest(&mut self) -> Result<(), Error> {
        let stopping = std::mem::replace(&mut self.session.stopping, true);
        let seen = |status: &AxisStatus| status.view.seen.map(|seen| seen.zsw1);
        let mut result = Ok(true);
        if !self.operated {
            result = self.hold_until(FIRST_DATA, |status| seen(status).is_some());
            self.operated = takeover::is_kept(self.status().as_ref().and_then(seen));
        }
        let result = result.and_then(|_| self.ramp_down());
        self.session.stopping = stopping;
        result
    }

    /// How long the drive needs for its ramp from the present speed, as far as that can be reckoned.
    fn ramp_time(&self) -> Duration {
        let told = self.status().and_then(|status| status.speed_actual);
        let speed = told.map_or(self.fastest, f64::abs);
        self.deceleration
            .and_then(|ramp| Duration::try_from_secs_f64(speed / ramp).ok())
            .map_or(Duration::ZERO, |time| time.min(LONGEST_RAMP))
    }

    /// OFF1, and whatever it takes until the pulses are off or the control gives up.
    fn ramp_down(&mut self) -> Result<(), Error> {
        let limit = self.settings.stop + self.ramp_time();
        self.session.client.allow_stop(self.link, limit);
        self.pursue(Goal::Stop);
        loop {
            // a quick stop that took over is waited for as well, and told with the release
            self.quick |= self.status().is_some_and(|status| status.view.quick_stop);
            match self.look() {
                Ok(status) if status.view.at_rest => return Ok(()),
                Ok(_) => {}
                Err(Error::Axis {
                    trouble: Trouble::QuickStopUsed,
                    ..
                }) if self.status().is_some_and(|status| !status.view.at_rest) => {}
                Err(error) => return Err(error),
            }
            let soon = self.session.now() + self.cycle.max(Duration::from_millis(1));
            self.session.step(soon)?;
        }
    }
}

impl<M: Wire> Drop for Axis<'_, M> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            // a watcher that panics once more would end the process before the axis stands
            self.watcher = None;
            self.warnings = Default::default();
        }
        // nobody is left to tell
        let _ = self.shut_down();
    }
}
