//! What a person is to know of a motion, in sentences that hold for every front end.

use client::{Advice, LossAction, LossReaction, Rest, WarningEntry};
use profile::notation::figures;
use profile::state::Mode;
use profinet::cyclic::CyclicStatistics;

use super::Setting;
use super::event::{Arrival, Ended, Event, TelegramChange};
use super::report::PutBack;
use super::start::Start;
use crate::Remark;

impl Event {
    /// Returns what a person is to know of it. Empty for a sample of the axis, and for what only a front end can word: that a
    /// motion begins, and a cycle that this computer does not keep.
    #[must_use]
    pub fn remarks(&self) -> Vec<Remark> {
        if let Some(remark) = self.of_settings() {
            return vec![remark];
        }
        let one = match self {
            Self::RunsOn(loss) => runs_on(loss),
            Self::AtSwitch => {
                Remark::warning("the limit switch in this direction is hit: the drive may not turn")
            }
            Self::Converted {
                hertz,
                rpm,
                pole_pairs,
            } => Remark::news(format!(
                "{} Hz -> {} rpm, without slip, by {pole_pairs} pole pairs of the motor",
                figures(*hertz),
                figures(*rpm)
            )),
            Self::Rounded { asked, sent, unit } => {
                let (asked, sent) = (figures(*asked), figures(*sent));
                // a step too fine for the figures shown is no news
                if asked == sent {
                    return Vec::new();
                }
                Remark::news(format!(
                    "{asked} {unit} -> {sent} {unit}, rounded to the nearest representable value"
                ))
            }
            Self::Starting {
                start: Start::Acknowledge,
                ..
            } => Remark::news("acknowledging by an edge of STW1 bit 7"),
            &Self::TelegramChanged(TelegramChange { before, now, kept }) => {
                let after = if kept {
                    "it remains selected"
                } else {
                    "it is put back afterwards"
                };
                Remark::news(format!("telegram {before} -> {now} (PNU 922) for this; {after}"))
            }
            Self::LongRamp { time, by } => {
                let by = by.as_ref().map_or_else(String::new, |by| format!(" ({by})"));
                Remark::news(format!(
                    "the ramp up takes about {:.0} s{by}, the time counts from its end",
                    time.as_secs_f64()
                ))
            }
            Self::LongStop => Remark::news("still stopping along the ramp"),
            Self::Warnings { warnings, .. } if warnings.is_empty() => {
                Remark::warning("the drive has a warning (ZSW1 bit 7) and no number for it")
            }
            Self::Warnings { warnings, .. } => return warnings.iter().map(warned).collect(),
            Self::SpeedNotReached { wanted, actual, unit } => {
                let actual = actual.map_or_else(String::new, |actual| format!(", it was {actual:.1} {unit}"));
                Remark::warning(format!(
                    "{wanted} {unit} was not reached when the stop came{actual}"
                ))
            }
            Self::HeldBack(evidence) => {
                Remark::warning(format!("the axis stood at the end of the jog: {evidence}"))
            }
            Self::Arrived {
                arrival,
                position,
                counts,
                left_to,
            } => return arrived(*arrival, position.zip(*counts), *left_to),
            Self::Faults(faults) => {
                return faults
                    .iter()
                    .map(|fault| Remark::news(fault.to_string()))
                    .collect();
            }
            Self::Clearing { parameter, pnu } => {
                Remark::news(format!("acknowledging with {parameter} (p{pnu})"))
            }
            Self::FaultsUnreadable(cause) => {
                Remark::warning(format!("which fault there is cannot be read: {cause}"))
            }
            Self::Ended(ended) => return ending(ended),
            _ => return Vec::new(),
        };
        vec![one]
    }

    /// What is changed at the drive for a motion, and put back.
    fn of_settings(&self) -> Option<Remark> {
        Some(match self {
            Self::ModeChanged {
                before: Some(before),
                now,
            } => Remark::news(format!(
                "PNU 930: {} -> {} for this motion",
                mode_number(*before),
                mode_number(*now)
            )),
            Self::ModeChanged { before: None, now } => Remark::news(format!(
                "PNU 930 is {} now; what it was is none of 1 and 2 and is not put back",
                mode_number(*now)
            )),
            Self::ModeWouldChange(mode) => Remark::news(format!(
                "PNU 930 would be set to {} mode for this and put back; the telegram is chosen then",
                match mode {
                    Mode::Position => "position",
                    Mode::Velocity => "velocity",
                }
            )),
            Self::PutBack(setting) => {
                Remark::news(format!("{} is {} again", setting.name(), setting.value()))
            }
            Self::NotPutBack { setting, cause } => {
                Remark::warning(PutBack::of(setting.as_ref(), Some(cause.clone())).to_string())
            }
            Self::LeftOver(left) => Remark::warning(left.note().sentence),
            Self::NoteUnreadable(note) => {
                let note = note.note();
                Remark::warning(note.sentence).and(note.next)
            }
            Self::NotNoted { setting, cause } => Remark::warning(format!(
                "if this program is killed, {} stays changed; it was {}: {cause}",
                setting.name(),
                setting.value()
            )),
            _ => return None,
        })
    }
}

const fn mode_number(mode: Mode) -> u8 {
    match mode {
        Mode::Velocity => 1,
        Mode::Position => 2,
    }
}

impl PutBack {
    /// What became of a setting: why it was not put back, if it was not.
    pub(super) fn of(setting: Option<&Setting>, failed: Option<String>) -> Self {
        Self {
            parameter: setting.map(Setting::name),
            number: setting.map(Setting::number),
            value: setting.map(Setting::value),
            failed,
        }
    }
}

/// The drive may run on when its controller is gone.
fn runs_on(loss: &LossReaction) -> Remark {
    let does = match loss.action {
        LossAction::KeepsTurning => "the drive goes on",
        _ => "it is not known whether the drive stops",
    };
    let setting = match (&loss.parameter, &loss.setting) {
        (Some(parameter), Some(setting)) => format!("{parameter} is {setting}: "),
        _ => String::new(),
    };
    let next = loss.remedy.as_ref().map(client::Remedy::sentence);
    Remark::warning(format!(
        "{setting}should this program be killed or the line break, {does}"
    ))
    .and(next)
}

fn warned(warning: &WarningEntry) -> Remark {
    let remedy = warning.remedy.map(|remedy| Advice::from(remedy.to_owned()));
    Remark::warning(warning.to_string()).and(remedy)
}

/// Where a motion came to, in turns and counts, and where the axis is since.
fn arrived(arrival: Arrival, at: Option<(f64, f64)>, left_to: Option<f64>) -> Vec<Remark> {
    let at_turns = |turns| format!("{} rev", figures(rounded(turns)));
    let text = match arrival {
        Arrival::Home => {
            let at = at.map_or_else(String::new, |(turns, _)| {
                format!(", the axis is at {}", at_turns(turns))
            });
            format!("homed (ZSW1 bit 11){at}")
        }
        Arrival::Task(number) => format!("task {number} at its target (ZSW1 bit 10)"),
        Arrival::Target => {
            let at = at.map_or_else(String::new, |(turns, counts)| {
                format!(": {} ({:.0} counts)", at_turns(turns), counts.round() + 0.0)
            });
            format!("target reached (ZSW1 bit 10){at}")
        }
    };
    let place = match arrival {
        Arrival::Home => "that place",
        Arrival::Target | Arrival::Task(_) => "the target",
    };
    let left = left_to.map(|now| {
        Remark::warning(format!(
            "it has left {place} since: it is at {} now",
            at_turns(now)
        ))
    });
    std::iter::once(Remark::news(text)).chain(left).collect()
}

/// Turns to three digits; a zero has no sign.
fn rounded(turns: f64) -> f64 {
    (turns * 1000.0).round() / 1000.0 + 0.0
}

fn ending(ended: &Ended) -> Vec<Remark> {
    let frames = ended.statistics.as_ref().map(frames);
    let rest = match ended.report.rest {
        _ if !ended.report.released => None,
        Rest::Unknown => None,
        Rest::Stands => Some("axis at rest, control released"),
        Rest::Coasts => Some(
            "control released; the axis turns with its power stage off: it coasts, or something moves it",
        ),
        Rest::Runs => Some("control released; the axis still turns with its power stage on"),
    };
    frames
        .into_iter()
        .chain(rest.map(str::to_owned))
        .map(Remark::news)
        .collect()
}

/// Summary of the cyclic connection. Missing frames come from the cycle counter; the longest gap is measured by this
/// computer, which may have been suspended.
fn frames(statistics: &CyclicStatistics) -> String {
    format!(
        "{} cyclic frames received, {} lost between them, longest time without one {:.1} ms",
        statistics.received,
        statistics.missed,
        statistics.longest_gap.as_secs_f64() * 1000.0
    )
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_silence_is_no_contradiction_to_frames_that_are_all_there() {
        let slept = CyclicStatistics {
            received: 40,
            longest_gap: Duration::from_micros(1_161_200),
            ..CyclicStatistics::default()
        };
        assert_eq!(
            frames(&slept),
            "40 cyclic frames received, 0 lost between them, longest time without one 1161.2 ms"
        );
    }

    #[test]
    fn an_axis_that_left_its_target_is_a_warning() {
        let event = Event::Arrived {
            arrival: Arrival::Target,
            position: Some(2.000_04),
            counts: Some(131_074.6),
            left_to: Some(-0.0001),
        };
        let remarks = event.remarks();
        let texts: Vec<(bool, &str)> = remarks
            .iter()
            .map(|one| (one.is_warning, one.sentence.as_str()))
            .collect();
        assert_eq!(
            texts,
            [
                (false, "target reached (ZSW1 bit 10): 2 rev (131075 counts)"),
                (true, "it has left the target since: it is at 0 rev now")
            ]
        );
    }

    #[test]
    fn a_rounding_that_no_figure_shows_is_no_news() {
        let rounded = |sent| {
            Event::Rounded {
                asked: 60.0,
                sent,
                unit: "rpm",
            }
            .remarks()
            .len()
        };
        assert_eq!((rounded(60.000_000_1), rounded(60.1)), (0, 1));
    }
}
