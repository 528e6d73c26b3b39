//! Stopping a drive beside its controller: by the commands that the drive offers as parameters.

use std::time::Duration;

use profidrive::catalogue::{Parameter, Part};

use super::{AxisSettings, Session};
use crate::axis::Purpose;
use crate::parameter::Assignment;
use crate::{Drive, Error, Wire, WriteMode};

/// Speed below which an axis counts as standing, rpm.
pub(super) const STANDS: f64 = 1.0;
/// Time between two looks.
const LOOK: Duration = Duration::from_millis(20);

/// How to stop a drive by a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopWay {
    /// AKD: DRV.STOP, all motion along the ramp; the axis stays enabled.
    Stop,
    /// AKD: DRV.DIS, the power stage off, as DRV.DISMODE says; a controller needs OFF and ON afterwards.
    Disable,
}

impl StopWay {
    /// What the command is among the parameters of a make.
    #[must_use]
    pub const fn part(self) -> Part {
        match self {
            Self::Stop => Part::Stop,
            Self::Disable => Part::Disable,
        }
    }

    /// What is sent: the parameter of a make that has one, else the control word.
    #[must_use]
    pub fn command(self, drive: &Drive) -> &'static str {
        let parameter = drive.model.catalogue.and_then(|tables| tables.part(self.part()));
        parameter.map_or("OFF1 (control word)", |parameter| parameter.name)
    }
}

/// What became of a stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StopOutcome {
    /// The command was sent; false when the axis was at rest already, or its power stage off: then no command holds it.
    pub sent: bool,
    /// Speed before in rpm.
    pub speed_before: Option<f64>,
    /// Speed at the end in rpm.
    pub speed: Option<f64>,
    /// The power stage is on at the end.
    pub enabled: Option<bool>,
    /// The axis stands, and is off where that was wanted.
    pub at_rest: bool,
}

impl<M: Wire> Session<M> {
    /// Stops a drive that somebody else commands, and looks for up to `limit` whether it does.
    ///
    /// An axis that turns with its power stage off, because it coasts or a load pulls at it, is only waited for.
    ///
    /// The controller of the drive is not asked and goes on: what it commands next may move the axis again. A make that
    /// has no parameter for it (VLT, Vacon) stops by its control word only, which is taken for a moment if nobody has it.
    ///
    /// # Errors
    /// When the drive has no such command and a controller has it, it refuses, or cannot be reached.
    pub fn stop_drive(
        &mut self,
        drive: &mut Drive,
        way: StopWay,
        limit: Duration,
    ) -> Result<StopOutcome, Error> {
        let command = drive.model.catalogue.and_then(|tables| tables.part(way.part()));
        let Some(command) = command else {
            return self.stop_by_word(drive, limit);
        };
        let before = self.look_at(drive, way)?;
        if before.enabled == Some(false) && before.at_rest {
            return Ok(before);
        }
        let sent = before.enabled != Some(false);
        if sent {
            self.command_stop(drive, command)?;
        }
        let end = self.now() + limit;
        loop {
            let seen = self.look_at(drive, way)?;
            if seen.at_rest || self.now() >= end {
                return Ok(StopOutcome {
                    sent,
                    speed_before: before.speed,
                    ..seen
                });
            }
            self.pass(LOOK)?;
        }
    }

    fn stop_by_word(&mut self, drive: &mut Drive, limit: Duration) -> Result<StopOutcome, Error> {
        let before = self.look_at(drive, StopWay::Disable)?;
        if before.at_rest {
            return Ok(before);
        }
        if let Some(Some(controller)) = self.owner(drive)? {
            return Err(Error::NoStopBeside {
                drive: drive.label(),
                make: drive.model.name,
                controller,
            });
        }
        let settings = AxisSettings {
            stop: limit,
            ..AxisSettings::for_purpose(Purpose::Control)
        };
        let mut axis = self.take_axis(drive, settings)?;
        axis.stop()?;
        axis.release()?;
        let seen = self.look_at(drive, StopWay::Disable)?;
        Ok(StopOutcome {
            sent: true,
            speed_before: before.speed,
            ..seen
        })
    }

    fn command_stop(&mut self, drive: &mut Drive, command: &Parameter) -> Result<(), Error> {
        let assignment = Assignment::of(command, 1);
        let outcomes = self.write(drive, &[assignment], WriteMode::Write)?;
        if let Some(Err(refusal)) = outcomes.into_iter().find_map(|outcome| outcome.written) {
            return Err(Error::Refused {
                drive: drive.label(),
                refusal,
            });
        }
        Ok(())
    }

    fn look_at(&mut self, drive: &mut Drive, way: StopWay) -> Result<StopOutcome, Error> {
        let enabled = self.is_enabled(drive)?;
        let speed = self.ask(drive, &[Part::Speed])?.rpm(Part::Speed);
        let stands = speed.is_some_and(|speed| speed.abs() < STANDS);
        Ok(StopOutcome {
            sent: false,
            speed_before: speed,
            speed,
            enabled,
            at_rest: stands && (way == StopWay::Stop || enabled == Some(false)),
        })
    }
}
