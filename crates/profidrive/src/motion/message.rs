//! What a motion reports to other programs.

use client::AxisStatus;
use client::axis::Strained;
use dissect::{hex16, words};
use profile::state::{Profile, bits};
use serde::Serialize;

use super::event::{Event, TelegramChange};
use super::report::Report;
use crate::Remark;
use crate::report::{DriveWords, LossReaction, Quantity, Warning, Word, Wording};

/// An [`Event`] of a motion that serialises. Its fields identify the event.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Message {
    /// Nothing is known to stop the axis when its controller is lost; the caller consented.
    RunsOn {
        /// What the drive does then.
        goes_on_alone: RunsOn,
    },
    /// Another telegram was selected (PNU 922).
    TelegramChanged {
        /// The telegrams.
        telegram_changed: TelegramChange,
    },
    /// This computer does not keep to the cycle of the connection.
    CycleStrained {
        /// The cycle and the delay.
        cycle_strained: CycleStrained,
    },
    /// The axis, after a change or some time.
    Sample(Box<AxisState>),
    /// Warnings that came; empty where the drive has a warning and no number for it.
    Warnings {
        /// Seconds since control was taken.
        time: f64,
        /// The warnings.
        warnings: Vec<Warning>,
    },
    /// Something that is to be known and has no fields of its own.
    Remark {
        /// What happened, as a sentence.
        remark: String,
        /// Whether something is not as it should be.
        warning: bool,
        /// What to do, where there is something to do.
        advice: Option<String>,
    },
    /// The motion has ended; nothing follows.
    Ended {
        /// True.
        end: bool,
        /// How it ended.
        #[serde(flatten)]
        report: Box<Report>,
    },
}

impl Message {
    /// Returns an event as messages; none for one without a message.
    #[must_use]
    pub fn of(event: &Event, wording: &dyn Wording) -> Vec<Self> {
        let one = match event {
            Event::RunsOn(loss) => {
                let advice = loss
                    .remedy
                    .as_ref()
                    .and_then(|remedy| wording.command(&remedy.action));
                let on_loss = LossReaction::from(loss);
                Self::RunsOn {
                    goes_on_alone: RunsOn { on_loss, advice },
                }
            }
            &Event::TelegramChanged(telegram_changed) => Self::TelegramChanged { telegram_changed },
            Event::Strained(strained) => Self::CycleStrained {
                cycle_strained: CycleStrained::from(strained),
            },
            Event::Sample(status) => Self::Sample(Box::new(AxisState::from(status))),
            Event::Warnings { status, warnings } => Self::Warnings {
                time: status.time.as_secs_f64(),
                warnings: warnings.iter().map(Warning::from).collect(),
            },
            Event::Ended(ended) => Self::from(ended.report.clone()),
            other => {
                let remark = |Remark {
                                  sentence,
                                  is_warning,
                                  next,
                              }| Self::Remark {
                    remark: sentence,
                    warning: is_warning,
                    advice: next.map(|next| wording.advice(&next)),
                };
                return other.remarks().into_iter().map(remark).collect();
            }
        };
        vec![one]
    }
}

impl From<Report> for Message {
    fn from(report: Report) -> Self {
        Self::Ended {
            end: true,
            report: Box::new(report),
        }
    }
}

/// What a drive does that may run on when its controller is lost.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunsOn {
    /// What it does, and the setting that decides it.
    #[serde(flatten)]
    pub on_loss: LossReaction,
    /// The call that makes it stop.
    pub advice: Option<String>,
}

/// A cycle that is too short for this computer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CycleStrained {
    /// Update time of the connection, s.
    pub cycle: f64,
    /// Watchdog of the connection, s.
    pub watchdog: f64,
    /// Longest delay of this computer, s.
    pub longest_delay: f64,
}

impl From<&Strained> for CycleStrained {
    fn from(strained: &Strained) -> Self {
        Self {
            cycle: strained.cycle.interval().as_secs_f64(),
            watchdog: strained.cycle.hold_time().as_secs_f64(),
            longest_delay: strained.delay.as_secs_f64(),
        }
    }
}

/// An axis at one moment.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AxisState {
    /// Seconds since control was taken.
    pub time: f64,
    /// State of the drive and the words that are exchanged. The bits have the names of the profile.
    #[serde(flatten)]
    pub words: DriveWords,
    /// False when the connection is lost: then all of this was reported before.
    pub connected: bool,
    /// Speed that is commanded.
    pub speed_set: Option<Quantity>,
    /// Speed of the motor.
    pub speed_actual: Option<Quantity>,
    /// Position that a move leads to.
    pub target: Option<Quantity>,
    /// Position of the axis.
    pub position: Option<Quantity>,
    /// Commanded position minus position.
    pub following_error: Option<Quantity>,
}

impl From<&AxisStatus> for AxisState {
    fn from(status: &AxisStatus) -> Self {
        let view = &status.view;
        let speed = |value: f64| Quantity::speed(value, status.unit);
        let general = view.seen.map(|seen| seen.zsw1.0);
        let words = DriveWords::of(Profile::Profidrive, view.mode, Some(view.answered.0), general);
        let meaning = words::stw1_meaning_in(view.mode, view.command.stw1.0).to_owned();
        let stw1 = Word::of(
            bits::stw1(view.mode),
            view.command.stw1.0,
            view.sent,
            Some(meaning),
        );
        let zsw1 = words.zsw1.zip(view.seen).map(|(word, seen)| Word {
            number: seen.word.into(),
            hex: hex16(seen.word),
            ..word
        });
        Self {
            time: status.time.as_secs_f64(),
            words: DriveWords {
                stw1: Some(stw1),
                zsw1,
                ..words
            },
            connected: !status.lost,
            speed_set: status.speed_set.map(speed),
            speed_actual: status
                .speed_actual
                .map(|value| speed(value).beyond(status.speed_beyond)),
            target: status.target.map(Quantity::turns),
            position: status.position.map(Quantity::turns),
            following_error: status.following_error.map(Quantity::turns),
        }
    }
}
