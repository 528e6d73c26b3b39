//! What a command that moves an axis would do: checked as far as reading can, said, not done.

use drive_client::status::{Verdict, diagnose};
use drive_client::{AxisPlan, AxisSettings, Drive, Error};
use profidrive::state::Mode;
use serde_json::{Map, Value};

use super::axis::SetMode;
use crate::connect::Live;
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::Output;

/// What was found.
#[derive(Debug)]
pub struct Rehearsal {
    /// Telegram and scale; `None` where the drive would be put into another mode first.
    pub plan: Option<AxisPlan>,
}

/// Checks what taking the axis and enabling it would meet: whoever has the drive, its mode, the telegram, and what holds
/// it back. Reads only.
pub fn axis(
    session: &mut Live,
    drive: &mut Drive,
    settings: &AxisSettings,
    needed: Option<(Mode, &SetMode)>,
    output: &Output,
) -> Result<Rehearsal, Failure> {
    let plan = match session.plan_axis(drive, settings) {
        Err(Error::WrongMode { .. }) if needed.is_some_and(|(_, wanted)| wanted.set_mode) => {
            session.check_control(drive)?;
            let mode = match needed {
                Some((Mode::Position, _)) => "position",
                _ => "velocity",
            };
            output.say(&format!(
                "PNU 930 would be set to {mode} mode for this and put back; the telegram is chosen then"
            ));
            None
        }
        other => Some(other?),
    };
    let status = session.status(drive)?;
    let diagnosis = diagnose(&status);
    if diagnosis.verdict == Verdict::Held {
        let message = format!("{} would not run: {}", drive.label(), diagnosis.sentence);
        let failure = Failure::new(Exit::Refused, message);
        return Err(match diagnosis.next {
            Some(next) => failure.hint(next),
            None => failure,
        });
    }
    Ok(Rehearsal { plan })
}

impl Rehearsal {
    /// `, telegram 9 -> 1 (PNU 922)`
    pub fn told(&self) -> String {
        let Some(plan) = &self.plan else {
            return String::new();
        };
        match plan.telegram_before.filter(|&before| before != plan.telegram) {
            Some(before) => format!(", telegram {before} -> {} (PNU 922)", plan.telegram),
            None => format!(", telegram {}", plan.telegram),
        }
    }

    /// The same for programs.
    pub fn json(&self) -> Map<String, Value> {
        let plan = self.plan.as_ref();
        fields! {
            "telegram": plan.map(|plan| plan.telegram),
            "telegram_before": plan.and_then(|plan| plan.telegram_before),
        }
    }
}

/// A speed to two digits: `61.88`
pub fn shown(speed: f64) -> String {
    let text = format!("{speed:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A speed that the drive can only be told as another one: `61.7 rpm -> 61.88 rpm, the nearest the drive can hold`.
pub fn rounded(asked: f64, told: f64, unit: &str) -> Option<String> {
    let (asked, told) = (shown(asked), shown(told));
    (asked != told).then(|| format!("{asked} {unit} -> {told} {unit}, the nearest the drive can hold"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_that_is_changed_is_told() {
        assert_eq!(
            rounded(61.7, 61.875, "rpm").as_deref(),
            Some("61.7 rpm -> 61.88 rpm, the nearest the drive can hold")
        );
        assert_eq!(rounded(60.0, 60.001, "rpm"), None);
        assert_eq!(rounded(-20.0, -20.0, "%"), None);
    }
}
