//! Why a motion did not go as it was to.

use super::report::Report;
use crate::machine::SpeedBound;
use client::axis::Trouble;
use client::status::{Cause, Diagnosis, Note, Verdict, diagnose, switched_off_beside};
use client::{Action, Advice, AtWork, Choice, Drive, Error, ErrorKind, FaultEntry, Rule, Session};
use profile::notation::{NoPosition, UnitMismatch, figures};

/// Why a tap of a motion cannot receive samples.
pub type TapError = Box<dyn std::error::Error + Send + Sync>;

/// How a motion ends by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Never: it ends when its caller stops it.
    Open,
    /// When its time is over.
    Time,
    /// When its target is reached.
    Target,
    /// When its task is finished.
    Task,
    /// When the axis is homed.
    Home,
}

impl End {
    /// What is missing where the caller stops it before its end.
    #[must_use]
    pub const fn missing(self) -> &'static str {
        match self {
            Self::Open | Self::Time => "its time was not over",
            Self::Target => "the target was not reached",
            Self::Task => "the task was not finished",
            Self::Home => "the axis is not homed",
        }
    }
}

/// Why a motion did not go as it was to.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// Nothing was enabled, or there is nothing to add to the error of the client.
    #[error(transparent)]
    Client(#[from] Error),
    /// The motion failed. With what the drive reports about itself.
    #[error("{error}{}", joined(.findings))]
    Failed {
        /// What failed.
        #[source]
        error: Box<Error>,
        /// What the drive reports: faults, warnings, why it does not run.
        findings: Vec<String>,
        /// The faults of the drive.
        faults: Vec<FaultEntry>,
        /// What to do about the findings.
        next: Option<Advice>,
        /// What the motion was like until its end: whether the axis is at rest, whether control was given back.
        report: Box<Report>,
    },
    /// The caller stopped it before its end.
    #[error("{drive}: stopped, {}", .end.missing())]
    Stopped {
        /// The drive.
        drive: String,
        /// How it was to end.
        end: End,
        /// What it was like until then.
        report: Box<Report>,
    },
    /// The cyclic samples of the motion were to be recorded, and cannot be; nothing was enabled.
    #[error("{drive}: not moved, as its samples cannot be recorded: {error}")]
    NotRecorded {
        /// The drive.
        drive: String,
        /// Why.
        error: TapError,
    },
    /// The motion went well, but a setting that was changed for it does not have its value from before.
    #[error("{drive}: {}", kept(.report))]
    NotPutBack {
        /// The drive.
        drive: String,
        /// What the motion was like; [`Report::put_back`] has the settings.
        report: Box<Report>,
    },
    /// The speed is above the limit of the drive, which would never reach it.
    #[error("{drive}: {}", beyond(*.speed, *.limit, .by.as_deref()))]
    AboveLimit {
        /// The drive.
        drive: String,
        /// Requested speed, rpm.
        speed: f64,
        /// Highest speed in that direction, rpm; 0 where the drive does not turn in it.
        limit: f64,
        /// The parameter that sets it.
        by: Option<String>,
    },
    /// The speed is above the limit of the machine file.
    #[error("the speed {} rpm is above the limit of {} rpm in line {} of the machine file", figures(*.speed), figures(.bound.rpm), .bound.line)]
    AboveBound {
        /// Requested speed, rpm.
        speed: f64,
        /// The limit.
        bound: SpeedBound,
    },
    /// The machine file limits the speed, and it is not known whether the motion is within the limit.
    #[error(
        "{drive}: {what} may be faster than the {} rpm in line {} of the machine file: the drive has no limit that is as low",
        figures(.bound.rpm), .bound.line
    )]
    NotBounded {
        /// The drive.
        drive: String,
        /// The motion.
        what: &'static str,
        /// The limit.
        bound: SpeedBound,
    },
    /// The speed of the motion is stored in the drive, and above the limit of the caller or not known.
    #[error("{drive}: {}", stored(.what, *.speed, *.limit))]
    StoredSpeed {
        /// The drive.
        drive: String,
        /// The motion.
        what: &'static str,
        /// The speed that is stored, rpm; `None` where it cannot be read.
        speed: Option<f64>,
        /// The limit of the caller, rpm.
        limit: f64,
    },
    /// The motion would leave the travel of the session.
    #[error(
        "{drive}: {what} would leave the travel of this session, {} rev both ways from where it began; the axis is at {} rev",
        figures(*.limit), figures(*.way)
    )]
    BeyondTravel {
        /// The drive.
        drive: String,
        /// The motion.
        what: String,
        /// The travel, in turns.
        limit: f64,
        /// Where the axis is from where it began, in turns.
        way: f64,
    },
    /// How far the axis goes cannot be watched.
    #[error("{drive}: its travel cannot be limited: {why}")]
    TravelNotWatched {
        /// The drive.
        drive: String,
        /// Why.
        why: &'static str,
    },
    /// A dry run found that something keeps the drive from running.
    #[error("{drive} would not run: {}", .diagnosis.sentence)]
    Held {
        /// The drive.
        drive: String,
        /// Why.
        diagnosis: Box<Diagnosis>,
    },
    /// The drive has no PPO types, or not this one.
    #[error("{drive} has no such PPO type")]
    NoPpo {
        /// The drive.
        drive: String,
    },
    /// A setting of the call is not valid for any drive.
    #[error("{what}")]
    Invalid {
        /// What is not valid.
        what: &'static str,
    },
    /// A quantity of the call has another unit.
    #[error("{what}: {problem}")]
    Unit {
        /// What was given.
        what: &'static str,
        /// What is wrong.
        problem: UnitMismatch,
    },
    /// The target of a move is not a position.
    #[error("target: {0}")]
    NoPosition(NoPosition),
    /// A fault is present that no command clears.
    #[error("{drive}: no command clears what is present")]
    NeedsRestart {
        /// The drive.
        drive: String,
    },
    /// The drive has no parameter that acknowledges faults.
    #[error("{drive}: model {model} has no parameter that clears its faults")]
    NoClearParameter {
        /// The drive.
        drive: String,
        /// Its model.
        model: &'static str,
    },
    /// Faults stay after they were acknowledged by a parameter.
    #[error("{drive}: the fault stays: {}", staying(.faults, .moved.as_deref()))]
    FaultsStay {
        /// The drive.
        drive: String,
        /// The faults.
        faults: Vec<FaultEntry>,
        /// Something moves the axis, which may be their cause.
        moved: Option<Box<Note>>,
    },
    /// After a stop the axis turns with its power stage off.
    #[error("{drive} turns at {speed:.1} rpm with its power stage off: something outside moves it")]
    MovedFromOutside {
        /// The drive.
        drive: String,
        /// Its speed, rpm.
        speed: f64,
        /// What to do.
        advice: Advice,
    },
    /// The drive is not stopped, as this controller has it: what that one commands next would take a stop back.
    #[error("{drive} is not stopped: {}", AtWork::Controller(.controller.clone()))]
    OfController {
        /// The drive.
        drive: String,
        /// The station name of the controller, empty where it has none.
        controller: String,
    },
    /// After a stop the axis is not at rest in time.
    #[error("{drive} is not at rest {seconds} s after {command}")]
    NotAtRest {
        /// The drive.
        drive: String,
        /// How long was waited, s.
        seconds: f64,
        /// What was sent.
        command: &'static str,
        /// Its power stage can be switched off too.
        can_disable: bool,
    },
}

impl MotionError {
    /// The kind of the error.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Client(error) => error.kind(),
            Self::Failed { error, .. } => error.kind(),
            Self::Stopped { .. } => ErrorKind::Interrupted,
            Self::NotPutBack { .. } => ErrorKind::Partial,
            Self::NotRecorded { .. } => ErrorKind::Local,
            Self::AboveLimit { .. }
            | Self::AboveBound { .. }
            | Self::NotBounded { .. }
            | Self::StoredSpeed { .. }
            | Self::BeyondTravel { .. }
            | Self::TravelNotWatched { .. }
            | Self::OfController { .. }
            | Self::MovedFromOutside { .. } => ErrorKind::Safety,
            Self::Held { .. } => ErrorKind::Refused,
            Self::NeedsRestart { .. } | Self::FaultsStay { .. } => ErrorKind::Fault,
            Self::NoClearParameter { .. } => ErrorKind::Unsupported,
            Self::NoPpo { .. } | Self::Invalid { .. } | Self::Unit { .. } | Self::NoPosition(_) => {
                ErrorKind::Usage
            }
            Self::NotAtRest { .. } => ErrorKind::NotReached,
        }
    }

    /// Returns the rule that an error of the kind [`ErrorKind::Safety`] stands for.
    #[must_use]
    pub fn rule(&self) -> Option<Rule> {
        match self {
            Self::AboveLimit { .. }
            | Self::AboveBound { .. }
            | Self::NotBounded { .. }
            | Self::StoredSpeed { .. } => Some(Rule::SpeedLimit),
            Self::BeyondTravel { .. } | Self::TravelNotWatched { .. } => Some(Rule::Move),
            Self::MovedFromOutside { .. } => Some(Rule::Standstill),
            Self::OfController { .. } => Some(Rule::Control),
            other => other.client().and_then(Error::rule),
        }
    }

    /// Returns the faults that the drive has, where one ended the motion.
    #[must_use]
    pub fn faults(&self) -> &[FaultEntry] {
        match self {
            Self::Failed { faults, .. } | Self::FaultsStay { faults, .. } => faults,
            _ => &[],
        }
    }

    /// The error of the client, where it is one.
    #[must_use]
    pub fn client(&self) -> Option<&Error> {
        match self {
            Self::Client(error) => Some(error),
            Self::Failed { error, .. } => Some(error),
            _ => None,
        }
    }

    /// What the motion was like, where the axis was taken.
    #[must_use]
    pub fn report(&self) -> Option<&Report> {
        match self {
            Self::Failed { report, .. } | Self::Stopped { report, .. } | Self::NotPutBack { report, .. } => {
                Some(report)
            }
            _ => None,
        }
    }

    /// What to do about it, where there is something to do. A front end puts its own words in the place of the actions.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        match self {
            Self::Client(error) => error.advice(),
            Self::Failed { error, next, .. } => next.clone().or_else(|| error.advice()),
            Self::AboveLimit { by, .. } => {
                let parameter = by.as_ref()?.replace(' ', "");
                let describe = Advice::from(Action::Describe { parameter });
                Some(describe.and(" shows it; choose a speed within it"))
            }
            Self::Held { diagnosis, .. } => diagnosis.next.clone(),
            Self::NotPutBack { report, .. } => {
                let left = report.put_back.iter().filter(|one| one.failed.is_some());
                let mut named = left.filter_map(|one| one.number.clone().zip(one.value.clone()));
                let (parameter, value) = named.next()?;
                let value = value.replace(' ', "");
                Some(Advice::from(Action::Write { parameter, value }).and(" puts it back"))
            }
            Self::AboveBound { .. } => Some("choose a speed within it".into()),
            Self::BeyondTravel { .. } => Some("move back, or take control again with another travel".into()),
            Self::TravelNotWatched { .. } => Some("take control without a limit of the travel".into()),
            Self::NotBounded { .. } => Some(
                "set a limit of the drive itself; a motion that has a speed of its own takes one in rpm"
                    .into(),
            ),
            Self::StoredSpeed { speed: Some(_), .. } => {
                Some("store a lower speed in the drive, or take control with a higher limit".into())
            }
            Self::StoredSpeed { speed: None, .. } => Some(
                "set a limit of the drive itself that is as low, or take control with the limit that the drive has".into(),
            ),
            Self::NoPpo { .. } => Some("use the number of a telegram".into()),
            Self::NeedsRestart { .. } => Some("remove the cause, then switch the drive off and on".into()),
            Self::NoClearParameter { .. } => {
                Some(Advice::from(Action::Acknowledge).and(" takes control and does it by STW1 bit 7"))
            }
            Self::FaultsStay { moved, .. } => {
                let next = moved.as_ref().and_then(|moved| moved.next.clone());
                next.or_else(|| Some("remove the cause, then acknowledge again".into()))
            }
            Self::MovedFromOutside { advice, .. } => Some(advice.clone()),
            Self::OfController { .. } => {
                Some("stop it by that controller, or with the emergency stop of the machine".into())
            }
            Self::NotAtRest {
                can_disable: true, ..
            } => Some("{disable} switches the power stage off; this is not an emergency stop".into()),
            Self::NotAtRest { .. } => Some(
                "stop it at its controller or with its safety circuit; this is not an emergency stop".into(),
            ),
            Self::Stopped { .. }
            | Self::Invalid { .. }
            | Self::Unit { .. }
            | Self::NoPosition(_)
            | Self::NotRecorded { .. } => None,
        }
    }

    /// Consent that would let the same motion begin.
    #[must_use]
    pub const fn consent(&self) -> Option<Choice> {
        match self {
            Self::Client(Error::RunsOn { .. }) => Some(Choice::RunOn),
            _ => None,
        }
    }
}

/// The settings that were not put back, in words.
fn kept(report: &Report) -> String {
    let left = report.put_back.iter().filter(|one| one.failed.is_some());
    left.map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

/// A failed motion with what the drive reports about itself: faults and warnings by number and text, and why it does not run.
pub(super) async fn explained(
    error: Error,
    end: End,
    report: Report,
    session: &mut Session,
    drive: &mut Drive,
) -> MotionError {
    let report = Box::new(report);
    if matches!(error, Error::Interrupted) {
        return MotionError::Stopped {
            drive: drive.label(),
            end,
            report,
        };
    }
    // what the drive reported while it was still in operation is in the error already
    let read = matches!(
        error,
        Error::Axis { .. }
            | Error::NotInTime { .. }
            | Error::HomingEnded { .. }
            | Error::MoveEnded { .. }
            | Error::Held { .. }
            | Error::SpeedNotReached { .. }
            | Error::NotMoved { .. }
            | Error::SpeedLost { .. }
    );
    let held = matches!(error, Error::Held { .. });
    let left_operation = matches!(
        error,
        Error::Axis {
            trouble: Trouble::LeftOperation { .. },
            ..
        }
    );
    let mut next = error.advice_for(drive);
    let mut findings = Vec::new();
    let status = if read {
        let status = session.uninterrupted(async |session: &mut Session| session.status(drive).await);
        status.await.ok()
    } else {
        None
    };
    let mut faults = Vec::new();
    if let Some(status) = status {
        faults.clone_from(&status.faults);
        findings.extend(status.faults.iter().map(ToString::to_string));
        let warnings = status.warnings.iter();
        findings.extend(warnings.map(|warning| format!("warning {warning}")));
        let diagnosis = diagnose(&status);
        // by now the axis is off: what turns it then is not under control, and a fault that comes of it stays
        let turns = |note: &&Note| note.id == Cause::MovedExternally.id();
        let moved = diagnosis.notes.iter().find(turns).cloned();
        let beside = switched_off_beside(&status).filter(|_| left_operation);
        // the axis is released by now: that it has no controller is no finding
        if diagnosis.verdict == Verdict::Held && status.faults.is_empty() && !held {
            findings.push(diagnosis.sentence.clone());
            next = diagnosis.next.or(next);
        }
        for note in moved.into_iter().chain(beside) {
            findings.push(note.sentence);
            next = note.next.or(next);
        }
    }
    MotionError::Failed {
        error: Box::new(error),
        findings,
        faults,
        next,
        report,
    }
}

fn staying(faults: &[FaultEntry], moved: Option<&Note>) -> String {
    let faults = faults.iter().map(ToString::to_string);
    let moved = moved.map(|moved| moved.sentence.clone());
    faults.chain(moved).collect::<Vec<_>>().join("; ")
}

fn joined(findings: &[String]) -> String {
    findings.iter().map(|finding| format!("; {finding}")).collect()
}

fn stored(what: &str, speed: Option<f64>, limit: f64) -> String {
    let limit = short(limit);
    match speed {
        Some(speed) => format!(
            "{what} is at {} rpm, the speed that is stored in the drive, which is above the limit of {limit} rpm",
            short(speed)
        ),
        None => format!(
            "{what} is at a speed that is stored in the drive and cannot be read now: it may be above the limit of {limit} rpm"
        ),
    }
}

/// Where the limit of a direction is 0 the drive turns in the other one only.
fn beyond(speed: f64, limit: f64, by: Option<&str>) -> String {
    let by = by.map_or_else(String::new, |by| format!(" ({by})"));
    let asked = short(speed);
    if limit > 0.0 {
        return format!(
            "{asked} rpm is above the limit of the drive, {} rpm{by}",
            short(limit)
        );
    }
    let only = if speed < 0.0 { "forward" } else { "backward" };
    format!("{asked} rpm is in a direction that the drive does not allow: it turns {only} only{by}")
}

/// Up to three digits behind the point.
fn short(number: f64) -> String {
    if !(-1e15..1e15).contains(&number) {
        return figures(number);
    }
    let text = format!("{number:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_of_nothing_is_a_direction() {
        assert_eq!(
            beyond(-600.0, 500.0, None),
            "-600 rpm is above the limit of the drive, 500 rpm"
        );
        assert_eq!(
            beyond(-700.5, 0.0, Some("3-00")),
            "-700.5 rpm is in a direction that the drive does not allow: it turns forward only (3-00)"
        );
    }

    #[test]
    fn a_motion_that_its_caller_stops_says_what_is_missing() {
        let error = MotionError::Stopped {
            drive: "akd-1".into(),
            end: End::Target,
            report: Box::default(),
        };
        assert_eq!(error.to_string(), "akd-1: stopped, the target was not reached");
        assert_eq!(error.kind(), ErrorKind::Interrupted);
    }
}
