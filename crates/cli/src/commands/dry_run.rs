//! Dry run of a command that moves an axis: checked as far as possible by reading, and printed.

use client::status::{Verdict, diagnose};
use client::{AxisPlan, AxisSettings, Drive, Error, Wait};
use profile::state::Mode;
use serde_json::{Map, Value};

use super::axis::SetMode;
use crate::advice;
use crate::connect::Live;
use crate::failure::{Exit, Failure};
use crate::fields;
use crate::output::Output;

/// What was found.
#[derive(Debug)]
pub struct DryRun {
    /// Telegram and scale; `None` where the drive would be put into another mode first.
    pub plan: Option<AxisPlan>,
}

/// Checks the conditions for taking and enabling the axis: owner, mode, telegram, and causes that prevent operation.
/// Reads only.
pub fn axis(
    session: &mut Live,
    drive: &mut Drive,
    settings: &AxisSettings,
    needed: Option<(Mode, &SetMode)>,
    output: &Output,
) -> Result<DryRun, Failure> {
    let plan = match session.plan_axis(drive, settings).wait() {
        Err(Error::WrongMode { .. }) if needed.is_some_and(|(_, wanted)| wanted.set_mode) => {
            session.check_control(drive).wait()?;
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
    let status = session.status(drive).wait()?;
    let diagnosis = diagnose(&status);
    if diagnosis.verdict == Verdict::Held {
        let message = format!("{} would not run: {}", drive.label(), diagnosis.sentence);
        let failure = Failure::new(Exit::Refused, message);
        return Err(match diagnosis.next {
            Some(next) => failure.hint(advice::text(&next, &drive.label())),
            None => failure,
        });
    }
    Ok(DryRun { plan })
}

impl DryRun {
    /// `, telegram 9 -> 1 (PNU 922)`
    pub fn telegram_text(&self) -> String {
        let Some(plan) = &self.plan else {
            return String::new();
        };
        match plan.telegram_before.filter(|&before| before != plan.telegram) {
            Some(before) => format!(", telegram {before} -> {} (PNU 922)", plan.telegram),
            None => format!(", telegram {}", plan.telegram),
        }
    }

    /// Returns the same for programs.
    pub fn json(&self) -> Map<String, Value> {
        let plan = self.plan.as_ref();
        fields! {
            "telegram": plan.map(|plan| plan.telegram),
            "telegram_before": plan.and_then(|plan| plan.telegram_before),
        }
    }
}
