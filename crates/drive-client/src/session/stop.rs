//! Stopping a drive beside its controller: by the commands that the drive offers as parameters.

use std::time::Duration;

use super::Session;
use crate::parameter::{Assignment, Reading};
use crate::{Drive, Error, Wire, WriteMode};

/// PNUs of an AKD: power stage on, speed.
const ACTIVE: u16 = 2110;
const SPEED: u16 = 2428;
/// Speed below which an axis counts as standing, rpm.
const STANDS: f64 = 1.0;
/// Time between two looks.
const LOOK: Duration = Duration::from_millis(20);

/// How to stop a drive by a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopWay {
    /// DRV.STOP: all motion along the ramp; the axis stays enabled.
    Stop,
    /// DRV.DIS: the power stage off, as DRV.DISMODE says; a controller needs OFF and ON afterwards.
    Disable,
}

impl StopWay {
    /// Name of the command.
    #[must_use]
    pub const fn command(self) -> &'static str {
        match self {
            Self::Stop => "DRV.STOP",
            Self::Disable => "DRV.DIS",
        }
    }
}

/// What became of a stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StopOutcome {
    /// The command was sent; false when the axis was at rest already.
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
    /// The controller of the drive is not asked and goes on: what it commands next may move the axis again.
    ///
    /// # Errors
    /// When the drive has no such command, refuses it, or cannot be reached.
    pub fn stop_drive(
        &mut self,
        drive: &mut Drive,
        way: StopWay,
        limit: Duration,
    ) -> Result<StopOutcome, Error> {
        if drive
            .model
            .catalogue
            .is_none_or(|tables| tables.by_name(way.command()).is_none())
        {
            return Err(Error::UnknownModel {
                drive: drive.label(),
                what: "a parameter that stops it beside its controller",
                vendor_id: drive.station.vendor_id,
                device_id: drive.station.device_id,
            });
        }
        let before = self.look_at(drive, way)?;
        if before.enabled == Some(false) && before.at_rest {
            return Ok(before);
        }
        let assignment: Assignment = format!("{}=1", way.command()).parse()?;
        let outcomes = self.write(drive, &[assignment], WriteMode::Write)?;
        if let Some(Err(refusal)) = outcomes.into_iter().find_map(|outcome| outcome.written) {
            return Err(Error::Refused {
                drive: drive.label(),
                refusal,
            });
        }
        let end = self.now() + limit;
        loop {
            let seen = self.look_at(drive, way)?;
            if seen.at_rest || self.now() >= end {
                return Ok(StopOutcome {
                    sent: true,
                    speed_before: before.speed,
                    ..seen
                });
            }
            self.pass(LOOK)?;
        }
    }

    fn look_at(&mut self, drive: &mut Drive, way: StopWay) -> Result<StopOutcome, Error> {
        let readings = self.read_numbers(drive, &[ACTIVE, SPEED])?;
        let find = |pnu| readings.iter().find(|reading| reading.pnu == pnu);
        let speed = find(SPEED).and_then(Reading::number);
        let enabled = find(ACTIVE).and_then(Reading::raw).map(|raw| raw != 0);
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
