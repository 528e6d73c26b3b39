//! Bringing a drive to rest from beside its controller, or without one.

use std::fmt;
use std::time::Duration;

use client::status::moved_advice;
use client::{Drive, Session, StopOutcome, StopWay};
use serde::Serialize;

use super::error::MotionError;

/// What became of a stop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StopReport {
    /// The drive.
    pub drive: String,
    /// What was sent; `None` when the axis was at rest already, or its power stage off: then no command holds it.
    pub sent: Option<&'static str>,
    /// Speed before, rpm.
    pub speed_before: Option<f64>,
    /// Speed at the end, rpm.
    pub speed: Option<f64>,
    /// Speed before in percent of the reference, where it is not known in rpm.
    pub speed_before_percent: Option<f64>,
    /// Speed at the end, likewise.
    pub speed_percent: Option<f64>,
    /// The power stage is on at the end.
    pub enabled: Option<bool>,
    /// The axis stands, and is off where that was wanted.
    pub at_rest: bool,
    /// The controller that goes on commanding the drive.
    pub controller: Option<String>,
    /// Why parameters of the drive could not be read.
    pub unread: Option<String>,
    #[serde(skip)]
    failure: Option<Failure>,
}

/// Why the axis is not at rest.
#[derive(Debug, Clone, PartialEq)]
enum Failure {
    Moved {
        speed: f64,
        make: &'static str,
    },
    Late {
        seconds: f64,
        command: &'static str,
        can_disable: bool,
    },
}

/// Stops a drive and waits for up to `limit` until it is at rest, by the means that it has; see
/// [`Session::stop_drive`]. Never needs consent.
///
/// # Errors
/// When the drive has no means to be stopped from here, or cannot be reached. An axis that is not at rest is a report, and
/// its [`check`](StopReport::check) an error.
pub async fn stop(
    session: &mut Session,
    drive: &mut Drive,
    way: StopWay,
    limit: Duration,
) -> Result<StopReport, MotionError> {
    // the command first: everything else can be read while it slows down
    let outcome = session.stop_drive(drive, way, limit).await?;
    let owner = session.owner(drive).await?;
    let command = outcome.command(way, drive);
    Ok(StopReport {
        drive: drive.label(),
        failure: failure(&outcome, command, way, limit, drive),
        sent: outcome.sent.then_some(command),
        speed_before: outcome.speed_before,
        speed: outcome.speed,
        speed_before_percent: outcome.percent_before,
        speed_percent: outcome.percent,
        enabled: outcome.enabled,
        at_rest: outcome.at_rest,
        controller: owner.flatten(),
        unread: outcome.unread,
    })
}

fn failure(
    outcome: &StopOutcome,
    command: &'static str,
    way: StopWay,
    limit: Duration,
    drive: &Drive,
) -> Option<Failure> {
    match outcome.speed {
        _ if outcome.at_rest => None,
        Some(speed) if outcome.enabled == Some(false) => Some(Failure::Moved {
            speed,
            make: drive.model.name,
        }),
        // of a drive that is stopped by its control word there is nothing stronger
        _ => Some(Failure::Late {
            seconds: limit.as_secs_f64(),
            command,
            can_disable: way == StopWay::Stop
                && drive
                    .model
                    .catalogue
                    .is_some_and(|tables| tables.part(StopWay::Disable.part()).is_some()),
        }),
    }
}

impl StopReport {
    /// Whether the axis is at rest.
    ///
    /// # Errors
    /// When it is not: something outside moves it, or the time was too short.
    pub fn check(&self) -> Result<(), MotionError> {
        let drive = self.drive.clone();
        match self.failure {
            None => Ok(()),
            Some(Failure::Moved { speed, make }) => Err(MotionError::MovedFromOutside {
                drive,
                speed,
                advice: moved_advice(make).into(),
            }),
            Some(Failure::Late {
                seconds,
                command,
                can_disable,
            }) => Err(MotionError::NotAtRest {
                drive,
                seconds,
                command,
                can_disable,
            }),
        }
    }
}

/// What was done, in one line.
impl fmt::Display for StopReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let speed = |rpm: Option<f64>, percent: Option<f64>| match (rpm, percent) {
            (Some(rpm), _) => format!("{rpm:.1} rpm"),
            (None, Some(percent)) => format!("{percent:.1} % of its reference"),
            (None, None) => "an unknown speed".into(),
        };
        let drive = &self.drive;
        let before = speed(self.speed_before, self.speed_before_percent);
        let after = speed(self.speed, self.speed_percent);
        let stage = match self.enabled {
            Some(true) => "the power stage is still on",
            Some(false) => "the power stage is off",
            None => "the drive does not report whether its power stage is on",
        };
        let turned = self.speed_before.is_some_and(|speed| speed.abs() >= 1.0);
        match self.sent {
            None if turned => {
                let end = if self.at_rest { "came to rest" } else { "turns on" };
                write!(
                    f,
                    "{drive} turned at {before} with its power stage off, so nothing was sent: it {end} ({after})"
                )
            }
            None => write!(f, "{drive} is at rest, {stage}: nothing was sent"),
            Some(command) => {
                let end = if self.at_rest {
                    "it stands"
                } else {
                    "it still turns or is still on"
                };
                write!(
                    f,
                    "{command} sent to {drive} at {before}: {end} ({after}), {stage}"
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_describes_the_stop() {
        let report = StopReport {
            drive: "akd-1".into(),
            sent: Some("DRV.STOP"),
            speed_before: Some(60.02),
            speed: Some(0.0),
            speed_before_percent: None,
            speed_percent: None,
            enabled: Some(true),
            at_rest: true,
            controller: None,
            unread: None,
            failure: None,
        };
        assert_eq!(
            report.to_string(),
            "DRV.STOP sent to akd-1 at 60.0 rpm: it stands (0.0 rpm), the power stage is still on"
        );
        let nothing = StopReport {
            sent: None,
            speed_before: Some(0.0),
            enabled: Some(false),
            ..report.clone()
        };
        assert_eq!(
            nothing.to_string(),
            "akd-1 is at rest, the power stage is off: nothing was sent"
        );
        let pulled = StopReport {
            speed_before: Some(60.02),
            speed: Some(-480.5),
            at_rest: false,
            ..nothing
        };
        assert_eq!(
            pulled.to_string(),
            "akd-1 turned at 60.0 rpm with its power stage off, so nothing was sent: it turns on (-480.5 rpm)"
        );
        let slave = StopReport {
            sent: Some("OFF1"),
            speed_before: None,
            speed: None,
            speed_before_percent: Some(60.02),
            speed_percent: Some(0.0),
            enabled: Some(false),
            ..report
        };
        assert_eq!(
            slave.to_string(),
            "OFF1 sent to akd-1 at 60.0 % of its reference: it stands (0.0 % of its reference), the power stage is off"
        );
    }
}
