//! Bringing a drive to rest from beside its controller, or without one.

use std::fmt;
use std::time::Duration;

use client::status::moved_advice;
use client::{AtWork, Authority, Drive, Error, Session, StopOutcome, StopWay};
use serde::Serialize;

use super::error::MotionError;
use crate::Remark;
use crate::report::{Controller, DriveState, Quantity, StatusReport};
use profile::catalogue::Parameter;
use profile::notation::fixed;

/// What became of a stop.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StopReport {
    /// The drive.
    pub drive: String,
    /// What was sent; `None` when the axis was at rest already, or its power stage off: then no command holds it.
    pub sent: Option<&'static str>,
    /// Speed before; in `%` of the reference where it is not known in `rpm`.
    pub speed_before: Option<Quantity>,
    /// Speed at the end, likewise.
    pub speed: Option<Quantity>,
    /// The power stage is on at the end.
    pub enabled: Option<bool>,
    /// The axis stands, and is off where that was requested.
    pub at_rest: bool,
    /// The controller that goes on commanding the drive; null where it does not report that.
    pub controller: Option<Controller>,
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
        model: &'static str,
    },
    Late {
        seconds: f64,
        command: &'static str,
        can_disable: bool,
    },
}

/// Stops a drive and waits for up to `limit` until it is at rest, by the means that it has; see
/// [`Session::stop_own_or_drive`]. Never needs consent.
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
    let outcome = session.stop_own_or_drive(drive, way, limit).await?;
    let owner = session.owner(drive).await?;
    let command = outcome.command(way, drive);
    Ok(StopReport {
        drive: drive.label(),
        failure: failure(&outcome, command, way, limit, drive),
        sent: outcome.sent.then_some(command),
        speed_before: speed(outcome.speed_before, outcome.percent_before),
        speed: speed(outcome.speed, outcome.percent),
        enabled: outcome.enabled,
        at_rest: outcome.at_rest,
        controller: Controller::of(owner.as_ref()),
        unread: outcome.unread,
    })
}

/// As [`stop`], of a drive that no other controller has: beside one, a stop lasts until that one commands it again, and the person who
/// requests it may not know that.
///
/// # Errors
/// When another controller has the drive; then nothing was sent. Else as [`stop`].
pub async fn stop_unowned(
    session: &mut Session,
    drive: &mut Drive,
    limit: Duration,
) -> Result<StopReport, MotionError> {
    if !session.has_axis(drive) {
        match session.check_unowned(drive, "stopped").await {
            Err(Error::AtWork {
                drive,
                works: AtWork::Controller(controller),
                ..
            }) => return Err(MotionError::OfController { drive, controller }),
            other => other?,
        }
    }
    stop(session, drive, StopWay::Stop, limit).await
}

/// By what a drive can be brought to rest from here, by its status: for a front end that offers it. What is used in the end is decided by
/// what the drive reports when it is stopped.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StopOffer {
    /// By what.
    pub means: StopMeans,
    /// The parameter that commands it, by its name; null with other means.
    pub parameter: Option<&'static str>,
    /// Why there are no means; null where there are.
    pub reason: Option<NoStop>,
    /// The controller that has the drive, where that is the reason and it has a name.
    pub controller: Option<String>,
}

/// By what a drive can be brought to rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum StopMeans {
    /// By the frames of this program, which has the axis under control.
    Frame,
    /// By a parameter that commands it.
    Parameter,
    /// By its control word: no controller has it, so this program takes it over without a jump, ramps down and releases it.
    ControlWord,
    /// By nothing from here.
    None,
}

/// Why a drive is not stopped from here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NoStop {
    /// Another controller has it.
    Controller,
    /// It is in local operation: it is stopped where it is operated.
    LocalOperation,
    /// It has no parameter for it, and its control word travels in frames that need a network interface.
    NeedsInterface,
    /// It stands with its power stage off.
    AtRest,
}

/// Speed below which an axis counts as standing, in rpm, and in percent of its reference.
const STANDS: (f64, f64) = (1.0, 0.2);

impl StopOffer {
    /// Returns the offer for a drive whose status was read.
    #[must_use]
    pub fn of(session: &Session, drive: &Drive, status: &StatusReport) -> Self {
        match session.has_axis(drive) {
            true => Self::by(StopMeans::Frame),
            false => Self::beside(
                StopWay::Stop.parameter(drive),
                session.carries_cyclic_data(drive),
                status,
            ),
        }
    }

    /// Returns the offer for a drive that this program does not control, by its parameter for it and by whether frames of this program
    /// can reach it.
    fn beside(parameter: Option<&'static Parameter>, reaches: bool, status: &StatusReport) -> Self {
        // one that another controller has is left alone, whatever could stop it: see `stop_unowned`
        if let Some(controller) = status.controller.as_ref().filter(|one| one.connected) {
            return Self {
                controller: controller.name.clone(),
                ..Self::none(NoStop::Controller)
            };
        }
        if !may_turn(status) {
            return Self::none(NoStop::AtRest);
        }
        let authority = status
            .local
            .clone()
            .map_or(Authority::Ownerless, Authority::Local);
        match client::StopMeans::of(parameter, authority) {
            client::StopMeans::Parameter(command) => Self {
                parameter: Some(command.name),
                ..Self::by(StopMeans::Parameter)
            },
            client::StopMeans::TakeOver if reaches => Self::by(StopMeans::ControlWord),
            client::StopMeans::TakeOver => Self::none(NoStop::NeedsInterface),
            client::StopMeans::Local(_) => Self::none(NoStop::LocalOperation),
            _ => Self::none(NoStop::Controller),
        }
    }

    const fn by(means: StopMeans) -> Self {
        Self {
            means,
            parameter: None,
            reason: None,
            controller: None,
        }
    }

    fn none(reason: NoStop) -> Self {
        Self {
            reason: Some(reason),
            ..Self::by(StopMeans::None)
        }
    }
}

/// Returns whether a drive turns or its power stage is on, as far as its status shows; what it does not report may be so.
fn may_turn(status: &StatusReport) -> bool {
    let turns = status.speed_actual.as_ref().map(|speed| {
        let (rpm, percent) = STANDS;
        let stands = if speed.unit == "%" { percent } else { rpm };
        speed.value.abs() >= stands
    });
    let is_on = status
        .words
        .state
        .map(|state| matches!(state, DriveState::S4 | DriveState::S5));
    turns.unwrap_or(is_on.is_none()) || is_on.unwrap_or(false)
}

fn speed(rpm: Option<f64>, percent: Option<f64>) -> Option<Quantity> {
    rpm.map(Quantity::rpm)
        .or_else(|| Some(Quantity::new(percent?, "%")))
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
            model: drive.model.name,
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
    /// Returns what a person is to know beside what was done: that parameters could not be read, and that a controller goes on
    /// commanding the drive.
    #[must_use]
    pub fn remarks(&self) -> Vec<Remark> {
        let drive = &self.drive;
        let unread = self.unread.as_ref().map(|cause| {
            Remark::warning(format!(
                "parameters of {drive} cannot be read ({cause}): what they say was not taken into account"
            ))
        });
        let connected = self.controller.as_ref().filter(|one| one.connected);
        let commands = connected.filter(|_| self.sent.is_some()).map(|controller| {
            let name = controller.name.as_deref().unwrap_or_default();
            Remark::warning(format!(
                "controller \"{name}\" goes on commanding {drive}: what it sends next may move the axis again"
            ))
        });
        unread.into_iter().chain(commands).collect()
    }

    /// Whether the axis is at rest.
    ///
    /// # Errors
    /// When it is not: something outside moves it, or the time was too short.
    pub fn check(&self) -> Result<(), MotionError> {
        let drive = self.drive.clone();
        match self.failure {
            None => Ok(()),
            Some(Failure::Moved { speed, model }) => Err(MotionError::MovedFromOutside {
                drive,
                speed,
                advice: moved_advice(model).into(),
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
        let speed = |speed: &Option<Quantity>| match speed {
            Some(speed) if speed.unit == "%" => format!("{} % of its reference", fixed(speed.value, 1)),
            Some(speed) => format!("{} {}", fixed(speed.value, 1), speed.unit),
            None => "unknown speed".into(),
        };
        let drive = &self.drive;
        let before = speed(&self.speed_before);
        let after = speed(&self.speed);
        let stage = match self.enabled {
            Some(true) => "the power stage is still on",
            Some(false) => "the power stage is off",
            None => "the drive does not report whether its power stage is on",
        };
        let rpm = self.speed_before.as_ref().filter(|speed| speed.unit != "%");
        let turned = rpm.is_some_and(|speed| speed.value.abs() >= 1.0);
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
                    "it is at rest"
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
            speed_before: speed(Some(60.02), None),
            speed: speed(Some(0.0), None),
            enabled: Some(true),
            at_rest: true,
            controller: None,
            unread: None,
            failure: None,
        };
        assert_eq!(
            report.to_string(),
            "DRV.STOP sent to akd-1 at 60.0 rpm: it is at rest (0.0 rpm), the power stage is still on"
        );
        let nothing = StopReport {
            sent: None,
            speed_before: speed(Some(0.0), None),
            enabled: Some(false),
            ..report.clone()
        };
        assert_eq!(
            nothing.to_string(),
            "akd-1 is at rest, the power stage is off: nothing was sent"
        );
        let pulled = StopReport {
            speed_before: speed(Some(60.02), None),
            speed: speed(Some(-480.5), None),
            at_rest: false,
            ..nothing
        };
        assert_eq!(
            pulled.to_string(),
            "akd-1 turned at 60.0 rpm with its power stage off, so nothing was sent: it turns on (-480.5 rpm)"
        );
        let slave = StopReport {
            sent: Some("OFF1"),
            speed_before: speed(None, Some(60.02)),
            speed: speed(None, Some(0.0)),
            enabled: Some(false),
            ..report
        };
        assert_eq!(
            slave.to_string(),
            "OFF1 sent to akd-1 at 60.0 % of its reference: it is at rest (0.0 % of its reference), the power stage is off"
        );
    }

    /// Whatever a status says: by what a drive is stopped follows from who has it, from its parameter and from the way to it.
    #[cfg(feature = "simulate")]
    #[test]
    fn a_control_word_that_cannot_travel_is_no_offer() {
        use crate::report::PlainWording;
        use crate::{Wait, inspection, open_plan};

        let plan = "[[drive]]\nname = \"vlt-1\"\nmodel = \"vlt\"\nip = \"10.0.0.1/24\"\n";
        let mut network = open_plan(plan.parse().unwrap()).unwrap();
        let mut drive = network.find(&"vlt-1".parse().unwrap()).wait().unwrap();
        let mut status = inspection::status(&mut network, &mut drive, &PlainWording)
            .wait()
            .unwrap()
            .report;
        let reason = |reaches, status: &StatusReport| StopOffer::beside(None, reaches, status).reason;
        assert_eq!(reason(false, &status), Some(NoStop::AtRest));
        status.words.state = Some(DriveState::S4);
        assert_eq!(reason(true, &status), None);
        assert_eq!(reason(false, &status), Some(NoStop::NeedsInterface));
        status.local = Some(client::LocalControl::Panel);
        assert_eq!(reason(false, &status), Some(NoStop::LocalOperation));
        status.controller = Some(Controller {
            connected: true,
            name: None,
        });
        assert_eq!(reason(false, &status), Some(NoStop::Controller));
    }

    #[test]
    fn a_controller_that_goes_on_is_a_warning_where_something_was_sent() {
        let report = |sent, connected| StopReport {
            drive: "vlt-1".into(),
            sent,
            speed_before: None,
            speed: None,
            enabled: Some(true),
            at_rest: true,
            controller: Some(Controller {
                connected,
                name: Some("plc".into()),
            }),
            unread: None,
            failure: None,
        };
        let remarks = report(Some("OFF1"), true).remarks();
        assert!(
            remarks.len() == 1
                && remarks[0].is_warning
                && remarks[0]
                    .sentence
                    .starts_with("controller \"plc\" goes on commanding vlt-1"),
            "{remarks:?}"
        );
        for report in [report(None, true), report(Some("OFF1"), false)] {
            assert_eq!(report.remarks(), []);
        }
    }
}
