//! Bringing a drive to rest from beside its controller, or without one.

use std::time::Duration;

use profile::catalogue::{Parameter, Part};
use profile::notation::fixed;

use super::unread::SILENCE;
use super::{AxisSettings, AxisStatus, Rest, STANDS, Session};
use crate::axis::{Purpose, Seen, StopKind};
use crate::{Authority, Drive, Error, Link, LocalControl, WriteMode};
use profile::value::Assignment;

/// What the control word commands.
const BY_WORD: &str = "OFF1 (control word)";
/// What it commands once the caller is in a hurry.
const BY_WORD_QUICKLY: &str = "OFF3 (control word)";
/// How long the command of a drive whose parameters are silent may remain without an answer.
const LAST_TRY: Duration = Duration::from_millis(500);
/// How long a drive may take to request control by the field bus once a controller is connected.
const ASKS: Duration = Duration::from_millis(500);
/// Time between two looks.
const LOOK: Duration = Duration::from_millis(20);

/// How far to stop a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopWay {
    /// All motion stops along the ramp. A drive with a parameter for it (AKD DRV.STOP) stays enabled, all others are switched
    /// off by OFF1.
    Stop,
    /// The power stage is switched off too (AKD DRV.DIS, by DRV.DISMODE); a controller needs OFF and ON afterwards.
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
        self.parameter(drive).map_or(BY_WORD, |parameter| parameter.name)
    }

    /// Returns the parameter of a drive that commands it; `None` for a model without one.
    #[must_use]
    pub fn parameter(self, drive: &Drive) -> Option<&'static Parameter> {
        drive.model.catalogue.and_then(|tables| tables.part(self.part()))
    }
}

/// By what means a drive can be brought to rest from here.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum StopMeans {
    /// A parameter of the drive commands it, beside any other controller of the drive.
    Parameter(&'static Parameter),
    /// No controller has the control word: it is taken over without a jump, then the axis ramps down and is released.
    TakeOver,
    /// None: this controller has the control word.
    Owned(String),
    /// None: the drive is in local operation.
    Local(LocalControl),
}

impl StopMeans {
    /// Returns the means for a drive that has this parameter and is commanded by this authority.
    #[must_use]
    pub fn of(parameter: Option<&'static Parameter>, authority: Authority) -> Self {
        match (parameter, authority) {
            (Some(parameter), _) => Self::Parameter(parameter),
            (None, Authority::Local(by)) => Self::Local(by),
            (None, Authority::Controller(name)) => Self::Owned(name),
            // a device that does not report its connections refuses when another controller has it
            (None, Authority::Ownerless | Authority::Free | Authority::Unknown) => Self::TakeOver,
        }
    }
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
    /// Speed before in percent of the reference, where it is not known in rpm.
    pub percent_before: Option<f64>,
    /// Speed at the end in percent of the reference, likewise.
    pub percent: Option<f64>,
    /// How it was stopped by its control word, where that was used: along its ramp, or by its quick stop once the caller was in a hurry
    /// ([`Session::hurry_with`]).
    pub by_word: Option<StopKind>,
    /// The power stage is on at the end.
    pub enabled: Option<bool>,
    /// The axis stands, and is off where that was requested.
    pub at_rest: bool,
    /// Why parameters of the drive could not be read: it was stopped by what else is known of it.
    pub unread: Option<String>,
}

impl StopOutcome {
    /// What was sent.
    #[must_use]
    pub fn command(&self, way: StopWay, drive: &Drive) -> &'static str {
        match self.by_word {
            Some(StopKind::Quick) => BY_WORD_QUICKLY,
            Some(_) => BY_WORD,
            None => way.command(drive),
        }
    }
}

impl Session {
    /// Finds the means to stop a drive: its parameter, its control word if no controller has it, or none. Reads only.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn stop_means(&mut self, drive: &mut Drive, way: StopWay) -> Result<StopMeans, Error> {
        let authority = match way.parameter(drive) {
            // who commands it need not be read
            Some(_) => Authority::Unknown,
            None => self.authority(drive).await?,
        };
        Ok(StopMeans::of(way.parameter(drive), authority))
    }

    /// Stops a drive and waits for up to `limit` until it is at rest, by the means that it has
    /// ([`stop_means`](Self::stop_means)). A ramp that takes longer by the settings of the drive gets its time.
    ///
    /// An axis that turns with its power stage off, because it coasts or a load pulls at it, is only waited for.
    ///
    /// A parameter that the drive does not answer, or not properly, is not an error: control word and status word are
    /// enough. After the first one none is requested, and [`StopOutcome::unread`] is the reason.
    ///
    /// A controller of the drive is not involved and goes on: what it commands next may move the axis again.
    ///
    /// # Errors
    /// [`Error::StopUnanswered`] when the drive does not answer its parameter and a controller has its control word,
    /// [`Error::NoStopBeside`] when the drive has no such parameter and a controller has its control word,
    /// [`Error::LocalOperation`] in local operation, and when it refuses or cannot be reached.
    pub async fn stop_drive(
        &mut self,
        drive: &mut Drive,
        way: StopWay,
        limit: Duration,
    ) -> Result<StopOutcome, Error> {
        self.stop_by_means(drive, way, limit, None).await
    }

    /// The same, also for an axis that this program has under control itself: that is stopped as by its
    /// [`StopHandle`](crate::StopHandle).
    ///
    /// # Errors
    /// As [`stop_drive`](Self::stop_drive).
    pub async fn stop_own_or_drive(
        &mut self,
        drive: &mut Drive,
        way: StopWay,
        limit: Duration,
    ) -> Result<StopOutcome, Error> {
        let own = self.engine.records().own_axis(drive);
        self.stop_by_means(drive, way, limit, own).await
    }

    async fn stop_by_means(
        &mut self,
        drive: &mut Drive,
        way: StopWay,
        limit: Duration,
        own: Option<Link>,
    ) -> Result<StopOutcome, Error> {
        let _meanwhile = self.tolerant();
        let mut last = None;
        let stopped = self.stop_and_look(drive, way, limit, own, &mut last).await;
        let unread = self.unread();
        let stopped = stopped.map(|stopped| StopOutcome { unread, ..stopped });
        stopped.map_err(|error| match error {
            Error::Interrupted => Error::StopInterrupted {
                drive: drive.label(),
                seen: seen_last(last.as_ref()),
            },
            other => other,
        })
    }

    /// The same; `last` is how the drive was seen last.
    async fn stop_and_look(
        &mut self,
        drive: &mut Drive,
        way: StopWay,
        limit: Duration,
        own: Option<Link>,
        last: &mut Option<StopOutcome>,
    ) -> Result<StopOutcome, Error> {
        // a stop by the control word always ends with the power stage off
        let way = if own.is_some() || way.parameter(drive).is_none() {
            StopWay::Disable
        } else {
            way
        };
        let before = self.look_at(drive, way, None).await?;
        if before.at_rest && before.enabled == Some(false) {
            return Ok(before);
        }
        // of an axis without power only its telegram shows whether it turns, where its speed cannot be read
        let unseen = before.speed.or(before.percent).is_none() && self.unread().is_some();
        let sent = unseen || before.enabled != Some(false);
        *last = Some(before.clone());
        let mut by_word = None;
        if let Some(link) = own.filter(|_| sent) {
            self.stop_own(link, limit);
        } else if sent {
            match self.stop_means(drive, way).await? {
                StopMeans::Parameter(command) => {
                    by_word = self.stop_by_parameter(drive, command, limit).await?;
                }
                StopMeans::TakeOver => by_word = Some(self.take_over_and_stop(drive, limit).await?),
                StopMeans::Owned(controller) => {
                    return Err(Error::NoStopBeside {
                        drive: drive.label(),
                        model: drive.model.name,
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
        let way = if by_word.is_some() { StopWay::Disable } else { way };
        let end = self.now() + limit;
        loop {
            let seen = self.look_at(drive, way, by_word.map(|(rest, _)| rest)).await?;
            *last = Some(StopOutcome { sent, ..seen.clone() });
            if seen.at_rest || self.now() >= end {
                return Ok(StopOutcome {
                    sent,
                    speed_before: before.speed,
                    percent_before: before.percent,
                    by_word: own.map(|_| StopKind::Ramp).or(by_word.map(|(_, way)| way)),
                    ..seen
                });
            }
            self.pass(LOOK).await?;
        }
    }

    /// Begins the stop of an axis that this program moves.
    fn stop_own(&self, link: Link, limit: Duration) {
        let now = self.now();
        {
            let mut client = self.client();
            client.allow_stop(link, limit);
            client.stop_now(now, Some(link), StopKind::Ramp);
        }
        self.engine.stir();
    }

    /// Takes the control word over as it is, ramps down by OFF1 and gives it back. Returns how the axis was then, and how it was
    /// stopped in the end.
    async fn take_over_and_stop(
        &mut self,
        drive: &mut Drive,
        limit: Duration,
    ) -> Result<(Rest, StopKind), Error> {
        // a service channel may have it: with silent parameters only its telegram shows it
        let by_parameter = StopWay::Stop.parameter(drive).is_some();
        let settings = AxisSettings {
            stop: limit,
            ..AxisSettings::for_purpose(Purpose::Control)
        };
        let mut axis = self.take_axis(drive, settings).await?;
        if by_parameter && !axis.hold_until(ASKS, asks_for_control).await? {
            let word = axis.status().and_then(|status| status.view.seen);
            // there is nothing to wait for
            axis.ending.allow(LAST_TRY);
            let _ = axis.release().await;
            let by = self.local_control(drive, word.unwrap_or_default().zsw1).await?;
            return Err(Error::LocalOperation {
                drive: drive.label(),
                by,
            });
        }
        axis.stop_and_release().await
    }

    /// Stops a drive by its parameter. Without an answer it is stopped by the control word, unless a controller or
    /// local operation has it; returns how the axis was at the end of that.
    async fn stop_by_parameter(
        &mut self,
        drive: &mut Drive,
        command: &'static Parameter,
        limit: Duration,
    ) -> Result<Option<(Rest, StopKind)>, Error> {
        let silent = self.unread().is_some();
        if !silent && self.command_within(drive, command, SILENCE).await? {
            return Ok(None);
        }
        match self.authority(drive).await? {
            Authority::Local(by) => Err(Error::LocalOperation {
                drive: drive.label(),
                by,
            }),
            Authority::Controller(controller) => {
                if silent && self.command_within(drive, command, LAST_TRY).await? {
                    return Ok(None);
                }
                Err(Error::StopUnanswered {
                    drive: drive.label(),
                    command: command.name,
                    controller,
                    cause: self.unread().unwrap_or_default(),
                })
            }
            Authority::Ownerless | Authority::Free | Authority::Unknown => {
                self.take_over_and_stop(drive, limit).await.map(Some)
            }
        }
    }

    /// Sends the command of a vendor; false when the drive has not answered it within `limit`, or not properly.
    async fn command_within(
        &mut self,
        drive: &mut Drive,
        command: &Parameter,
        limit: Duration,
    ) -> Result<bool, Error> {
        let end = self.now() + limit;
        let sent = {
            let _meanwhile = self.bound_by(end);
            self.command_stop(drive, command).await
        };
        match sent {
            Err(error) if !matches!(error, Error::Refused { .. }) && self.gives_up(&error) => Ok(false),
            sent => sent.map(|()| true),
        }
    }

    async fn command_stop(&mut self, drive: &mut Drive, command: &Parameter) -> Result<(), Error> {
        let assignment = Assignment::of(command, 1);
        let set = self.write(drive, &[assignment], WriteMode::Write).await?;
        set.accepted()
    }

    /// How the axis is; `by_word` is how its telegram reported it at the end of a stop by the control word, for a drive
    /// whose parameters do not say it.
    async fn look_at(
        &mut self,
        drive: &mut Drive,
        way: StopWay,
        by_word: Option<Rest>,
    ) -> Result<StopOutcome, Error> {
        let enabled = self.is_enabled(drive).await?.or(by_word.map(|_| false));
        let readings = self.ask(drive, &[Part::Speed, Part::SpeedActual]).await?;
        let speed = readings.rpm(Part::Speed);
        let percent = readings.percent(Part::SpeedActual).filter(|_| speed.is_none());
        let stands = match (readings.stands(STANDS), by_word) {
            (Some(stands), _) => stands,
            (None, Some(Rest::Stands)) => true,
            (None, Some(Rest::Coasts | Rest::Runs)) => false,
            // of a drive that has no speed to report the power stage is all there is
            (None, Some(Rest::Unknown) | None) => enabled == Some(false) && self.unread().is_none(),
        };
        Ok(StopOutcome {
            sent: false,
            speed_before: speed,
            speed,
            percent_before: percent,
            percent,
            by_word: None,
            enabled,
            at_rest: stands && (way == StopWay::Stop || enabled == Some(false)),
            unread: None,
        })
    }
}

/// ZSW1 bit 9.
fn asks_for_control(status: &AxisStatus) -> bool {
    status.view.seen.is_some_and(Seen::control_requested)
}

/// How a drive was seen last, for a caller that gives up a stop.
fn seen_last(last: Option<&StopOutcome>) -> String {
    let Some(last) = last else {
        return "nothing was sent, and how it is was not read".to_owned();
    };
    let sent = if last.sent {
        "its stop was sent"
    } else {
        "whether its stop was sent is not known"
    };
    let speed = match (last.speed, last.percent) {
        (Some(rpm), _) => format!("{} rpm", fixed(rpm, 1)),
        (None, Some(percent)) => format!("{} % of its reference", fixed(percent, 1)),
        (None, None) => "an unknown speed".to_owned(),
    };
    let stage = match last.enabled {
        Some(true) => "its power stage on",
        Some(false) => "its power stage off",
        None => "its power stage not known",
    };
    format!("{sent}; it was seen last at {speed} with {stage}")
}
