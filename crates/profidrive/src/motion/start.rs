//! What begins, and what would begin, in words.

use std::fmt;
use std::time::Duration;

use client::axis::MovePlan;
use dissect::value;
use profile::notation::figures;
use profile::value::Reading;

use super::plan::{JogPlan, RunPlan, Telegrams};
use crate::report::Quantity;

/// What begins.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Start {
    /// Nothing yet: the axis is held, and moves by the calls of its owner.
    Hold,
    /// A speed.
    Run {
        /// The speed.
        speed: Quantity,
        /// How long; when `None` until the caller stops it.
        time: Option<Duration>,
    },
    /// A step from one speed to another.
    Step {
        /// The speed before.
        from: Quantity,
        /// The speed after.
        to: Quantity,
    },
    /// The jog function of the drive.
    Jog {
        /// Its speed, as the drive has it.
        speed: Box<Reading>,
        /// How long.
        time: Duration,
    },
    /// Real-time jogging.
    RealTimeJog {
        /// The speed, rpm.
        speed: f64,
        /// How long.
        time: Duration,
    },
    /// A move.
    Move(Box<MovePlan>),
    /// The motion task of the drive with this number.
    Task(u16),
    /// The homing procedure of the drive.
    Home {
        /// What decides over the procedure, as far as the drive reports it: name and value.
        procedure: Vec<(&'static str, Reading)>,
    },
    /// Nothing moves: faults are acknowledged.
    Acknowledge,
}

impl Start {
    /// Returns what the axis does now, behind its name: `turns at 60 rpm for 1 s`. `None` where nothing moves.
    #[must_use]
    pub fn sentence(&self, telegram: u16) -> Option<String> {
        Some(match self {
            Self::Hold | Self::Acknowledge => return None,
            Self::Run { speed, time } => format!("turns at {}", for_time(speed, *time)),
            Self::Step { from, to } => {
                let (from, speed) = (figures(from.value), figures(to.value));
                format!("steps from {from} to {speed} {}", to.unit)
            }
            Self::Jog { speed, time } => {
                format!("jogs at {} for {} s", value::full(speed), time.as_secs_f64())
            }
            Self::RealTimeJog { speed, time } => format!(
                "jogs at {} rpm for {} s (real-time jogging, telegram {telegram})",
                figures(*speed),
                time.as_secs_f64()
            ),
            Self::Move(plan) => format!("{plan}, telegram {telegram}"),
            Self::Task(number) => format!("carries out its motion task {number}, telegram {telegram}"),
            Self::Home { procedure } => {
                let parts = procedure.iter();
                let parts = parts.map(|(name, reading)| format!("{name} {}", value::full(reading)));
                let by = if procedure.is_empty() { "" } else { " by " };
                let parts = parts.collect::<Vec<_>>().join(", ");
                format!("homes{by}{parts}, telegram {telegram}")
            }
        })
    }
}

/// `60 rpm for 1 s`
fn for_time(speed: &Quantity, time: Option<Duration>) -> String {
    let time = time.map_or_else(
        || "until it is stopped".to_owned(),
        |time| format!("for {} s", time.as_secs_f64()),
    );
    format!("{} {} {time}", figures(speed.value), speed.unit)
}

/// What the axis would do, behind its name: `turn at 60 rpm for 1 s, telegram 9 -> 1 (PNU 922)`.
impl fmt::Display for RunPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = self.time.and_then(|time| Duration::try_from_secs_f64(time).ok());
        write!(f, "turn at {}{}", for_time(&self.speed, time), self.telegrams)
    }
}

/// What the axis would do, behind its name.
impl fmt::Display for JogPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let speed = figures(self.speed.value);
        write!(f, "jog at {speed} rpm for {} s{}", self.time, self.telegrams)
    }
}

/// `, telegram 9 -> 1 (PNU 922)`
impl fmt::Display for Telegrams {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.telegram_before, self.telegram) {
            (_, None) => Ok(()),
            (Some(before), Some(now)) if before != now => write!(f, ", telegram {before} -> {now} (PNU 922)"),
            (_, Some(now)) => write!(f, ", telegram {now}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use client::axis::SpeedUnit;

    use super::*;

    /// 33.3 Hz of a motor with 1500 rpm at 50 Hz is 998.9999999999999 rpm in floating point.
    #[test]
    fn a_speed_that_was_converted_is_rounded_in_a_sentence() {
        let speed = |value| Quantity::speed(value, SpeedUnit::Rpm);
        let run = Start::Run {
            speed: speed(33.3 * 60.0 / 2.0),
            time: None,
        };
        assert_eq!(
            run.sentence(1).as_deref(),
            Some("turns at 999 rpm until it is stopped")
        );
        let step = Start::Step {
            from: speed(0.1 + 0.2),
            to: speed(33.3 * 60.0 / 2.0),
        };
        assert_eq!(step.sentence(1).as_deref(), Some("steps from 0.3 to 999 rpm"));
    }
}
