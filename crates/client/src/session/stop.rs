//! Bringing a drive to rest from beside its controller, or without one.

use std::time::Duration;

use profile::catalogue::{Parameter, Part};

use super::{Authority, AxisSettings, LocalControl, Session};
use crate::axis::Purpose;
use crate::{Drive, Error, Wire, WriteMode};
use profile::value::Assignment;

/// Speed below which an axis counts as standing, rpm.
pub(super) const STANDS: f64 = 1.0;
/// Time between two looks.
const LOOK: Duration = Duration::from_millis(20);

/// How far to stop a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopWay {
    /// All motion stops along the ramp. A drive with a parameter for it (AKD DRV.STOP) stays enabled, all others are switched
    /// off by OFF1.
    Stop,
    /// The power stage is switched off too (AKD DRV.DIS, as DRV.DISMODE says); a controller needs OFF and ON afterwards.
    Disable,
}

impl StopWay {
    /// What the command is among the parameters of a vendor.
    #[must_use]
    pub const fn part(self) -> Part {
        match self {
            Self::Stop => Part::Stop,
            Self::Disable => Part::Disable,
        }
    }

    /// What is sent: the parameter of a vendor that has one, else the control word.
    #[must_use]
    pub fn command(self, drive: &Drive) -> &'static str {
        self.parameter(drive)
            .map_or("OFF1 (control word)", |parameter| parameter.name)
    }

    fn parameter(self, drive: &Drive) -> Option<&'static Parameter> {
        drive.model.catalogue.and_then(|tables| tables.part(self.part()))
    }
}

/// By what means a drive can be brought to rest from here.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum StopMeans {
    /// A parameter of the drive commands it, whoever else commands the drive.
    Parameter(&'static Parameter),
    /// Nobody has the control word: it is taken over without a jump, then the axis ramps down and is released.
    TakeOver,
    /// None: this controller has the control word.
    Owned(String),
    /// None: somebody at the drive itself commands it.
    Local(LocalControl),
}

/// What became of a stop.
#[derive(Debug, Clone, PartialEq)]
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
    /// Why parameters of the drive could not be read: it was stopped by what else is known of it.
    pub unread: Option<String>,
}

impl<M: Wire> Session<M> {
    /// Finds the means to bring a drive to rest: its parameter, its control word if nobody has it, or none. Reads only.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub fn stop_means(&mut self, drive: &mut Drive, way: StopWay) -> Result<StopMeans, Error> {
        if let Some(parameter) = way.parameter(drive) {
            return Ok(StopMeans::Parameter(parameter));
        }
        Ok(match self.authority(drive)? {
            Authority::Local(by) => StopMeans::Local(by),
            Authority::Controller(name) => StopMeans::Owned(name),
            // a device that does not report its connections refuses when another controller has it
            Authority::Ownerless | Authority::Nobody | Authority::Unknown => StopMeans::TakeOver,
        })
    }

    /// Stops a drive and waits for up to `limit` until it is at rest, by the means that it has
    /// ([`stop_means`](Self::stop_means)). A ramp that takes longer by the settings of the drive gets its time.
    ///
    /// An axis that turns with its power stage off, because it coasts or a load pulls at it, is only waited for.
    ///
    /// A parameter that the drive does not answer, or not properly, is no error: control word and status word are enough.
    /// After the first one none is requested, and [`StopOutcome::unread`] says why.
    ///
    /// A controller of the drive is not asked and goes on: what it commands next may move the axis again.
    ///
    /// # Errors
    /// [`Error::NoStopBeside`] when the drive has no such parameter and a controller has its control word,
    /// [`Error::LocalOperation`] when somebody at the drive commands it, and when it refuses or cannot be reached.
    pub fn stop_drive(
        &mut self,
        drive: &mut Drive,
        way: StopWay,
        limit: Duration,
    ) -> Result<StopOutcome, Error> {
        let tolerant = self.unread.is_some();
        self.tolerate_unread();
        let stopped = self.stop_by_means(drive, way, limit);
        let unread = self.unread().map(str::to_owned);
        if !tolerant {
            self.unread = None;
        }
        Ok(StopOutcome { unread, ..stopped? })
    }

    fn stop_by_means(
        &mut self,
        drive: &mut Drive,
        way: StopWay,
        limit: Duration,
    ) -> Result<StopOutcome, Error> {
        // a stop by the control word always ends with the power stage off
        let by_word = way.parameter(drive).is_none();
        let way = if by_word { StopWay::Disable } else { way };
        let before = self.look_at(drive, way, false)?;
        if before.at_rest && before.enabled == Some(false) {
            return Ok(before);
        }
        let sent = before.enabled != Some(false);
        let mut off = false;
        if sent {
            match self.stop_means(drive, way)? {
                StopMeans::Parameter(command) => self.command_stop(drive, command)?,
                StopMeans::TakeOver => {
                    self.take_over_and_stop(drive, limit)?;
                    off = true;
                }
                StopMeans::Owned(controller) => {
                    return Err(Error::NoStopBeside {
                        drive: drive.label(),
                        make: drive.model.name,
                        controller,
                    });
                }
                StopMeans::Local(by) => {
                    return Err(Error::LocalOperation {
                        drive: drive.label(),
                        by,
                    });
                }
            }
        }
        let end = self.now() + limit;
        loop {
            let seen = self.look_at(drive, way, off)?;
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

    /// Takes the control word over as it is, ramps down by OFF1 and gives it back.
    fn take_over_and_stop(&mut self, drive: &mut Drive, limit: Duration) -> Result<(), Error> {
        let settings = AxisSettings {
            stop: limit,
            ..AxisSettings::for_purpose(Purpose::Control)
        };
        let mut axis = self.take_axis(drive, settings)?;
        let stopped = axis.come_to_rest();
        let released = axis.release();
        stopped.and(released)
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

    /// How the axis is; `off` when its telegram has said that the power stage is off, for a drive without a status word.
    fn look_at(&mut self, drive: &mut Drive, way: StopWay, off: bool) -> Result<StopOutcome, Error> {
        let enabled = self.is_enabled(drive)?.or(off.then_some(false));
        let told = self.ask(drive, &[Part::Speed, Part::SpeedActual])?;
        let speed = told.rpm(Part::Speed);
        // of a drive that reports no speed the power stage is all there is to know
        let stands = told.stands(STANDS).unwrap_or(enabled == Some(false));
        Ok(StopOutcome {
            sent: false,
            speed_before: speed,
            speed,
            enabled,
            at_rest: stands && (way == StopWay::Stop || enabled == Some(false)),
            unread: None,
        })
    }
}
