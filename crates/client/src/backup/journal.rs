//! What a restore did and what it did not, at every moment: a backup of the old values with a word behind each.

use std::fmt;

use super::print::unit;
use super::{Backup, Plan, Task, key};
use crate::Refusal;
use profile::value::{Content, Reading};

/// How far one value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Nothing was sent for it: the drive has the old value.
    NotWritten,
    /// Sent, and not answered: the drive has the old value or the new one.
    InDoubt,
    /// The drive said that it wrote it.
    Written,
    /// Written, and read back as the new value.
    ReadBack,
    /// The drive said that it wrote it, and has another value all the same.
    Differs,
    /// The drive refused, or the channel cannot carry it: the drive has the old value.
    Refused(Refusal),
}

impl Step {
    /// True where the drive refused.
    #[must_use]
    pub fn is_refused(&self) -> bool {
        matches!(self, Self::Refused(refusal) if !refusal.is_unsent())
    }

    /// True where nothing was sent, as the channel cannot carry it.
    #[must_use]
    pub fn is_not_carried(&self) -> bool {
        matches!(self, Self::Refused(refusal) if refusal.is_unsent())
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotWritten => f.write_str("not written"),
            Self::InDoubt => f.write_str("in doubt: sent, not answered"),
            Self::Written => f.write_str("written"),
            Self::ReadBack => f.write_str("written, read back"),
            Self::Differs => f.write_str("written, but reads back another value"),
            Self::Refused(refusal) => f.write_str(&refusal.outcome()),
        }
    }
}

/// Whether the drive keeps the new values when it is switched off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saved {
    /// Nobody asked for it, or not everything was written.
    No,
    /// Asked for, and not answered.
    InDoubt,
    /// The drive said so.
    Yes,
    /// The drive refused, or the channel cannot carry the command.
    Refused(Refusal),
}

/// The way back and what was done, in one text that [`Backup::parse`] reads.
#[derive(Debug, Clone)]
pub struct Journal {
    way_back: Backup,
    /// In the order of the plan.
    steps: Vec<Step>,
    /// The same for the motion tasks.
    task_steps: Vec<Step>,
    plan: Plan,
    saved: Saved,
    /// Why it ended before its end.
    ended: Option<String>,
    complete: bool,
}

impl Journal {
    /// Before anything is written.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        Self {
            way_back: plan.way_back(),
            steps: vec![Step::NotWritten; plan.changes.len()],
            task_steps: vec![Step::NotWritten; plan.tasks.len()],
            plan: plan.clone(),
            saved: Saved::No,
            ended: None,
            complete: false,
        }
    }

    /// The plan.
    #[must_use]
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// How far each change of the plan is, in its order.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// How far each motion task of the plan is, in its order.
    #[must_use]
    pub fn task_steps(&self) -> &[Step] {
        &self.task_steps
    }

    /// How far everything is: values, then motion tasks.
    fn all(&self) -> impl Iterator<Item = &Step> {
        self.steps.iter().chain(&self.task_steps)
    }

    /// How many values and motion tasks are to be written.
    #[must_use]
    pub fn total(&self) -> usize {
        self.steps.len() + self.task_steps.len()
    }

    /// Whether the new values were saved.
    #[must_use]
    pub const fn saved(&self) -> Saved {
        self.saved
    }

    /// True when every change was tried and looked at.
    #[must_use]
    pub const fn is_complete(&self) -> bool {
        self.complete
    }

    /// True when the drive has every new value.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.all().all(|step| *step == Step::ReadBack)
    }

    /// How many changes are at a step that `which` says.
    #[must_use]
    pub fn count(&self, which: impl Fn(&Step) -> bool) -> usize {
        self.all().filter(|step| which(step)).count()
    }

    /// The old values: restoring them undoes what was done.
    #[must_use]
    pub const fn way_back(&self) -> &Backup {
        &self.way_back
    }

    /// In one sentence: `3 of 5 written and read back, 1 refused, 1 not written`.
    #[must_use]
    pub fn summary(&self) -> String {
        let mut parts = vec![format!(
            "{} of {} written and read back",
            self.count(|step| *step == Step::ReadBack),
            self.total()
        )];
        for (count, what) in [
            (
                self.count(|step| *step == Step::Written),
                "written, not read back",
            ),
            (
                self.count(|step| *step == Step::Differs),
                "read back another value",
            ),
            (self.count(Step::is_refused), "refused"),
            (self.count(Step::is_not_carried), "not carried by the channel"),
            (self.count(|step| *step == Step::InDoubt), "in doubt"),
            (self.count(|step| *step == Step::NotWritten), "not written"),
        ] {
            if count > 0 {
                parts.push(format!("{count} {what}"));
            }
        }
        parts.join(", ")
    }

    pub(crate) fn set(&mut self, at: usize, step: Step) {
        if let Some(place) = self.steps.get_mut(at) {
            *place = step;
        }
    }

    pub(crate) fn set_task(&mut self, at: usize, step: Step) {
        if let Some(place) = self.task_steps.get_mut(at) {
            *place = step;
        }
    }

    pub(crate) const fn set_saved(&mut self, saved: Saved) {
        self.saved = saved;
    }

    pub(crate) const fn complete(&mut self) {
        self.complete = true;
    }

    pub(crate) fn end(&mut self, why: &str) {
        self.ended = Some(why.to_owned());
    }

    fn remarks(&self) -> Vec<String> {
        let mut remarks = vec![
            "the values before a restore, of the parameters that it changes; restoring this file brings them back"
                .to_owned(),
            format!("{}: {}", if self.complete { "complete" } else { "not complete" }, self.summary()),
        ];
        remarks.extend(self.ended.as_ref().map(|why| format!("ended early: {why}")));
        remarks.push(match self.saved {
            Saved::Yes => "saved in the drive".to_owned(),
            Saved::No => {
                "not saved by this restore: what is not saved is lost at the next power cycle".to_owned()
            }
            Saved::InDoubt => {
                "in doubt whether the new values were saved: asked for, not answered".to_owned()
            }
            Saved::Refused(refusal) => format!("not saved: {}", refusal.outcome()),
        });
        remarks
    }

    /// `now 5000 rpm/s: written, read back`
    fn comment(&self, reading: &Reading) -> String {
        let at = self
            .plan
            .changes
            .iter()
            .position(|change| key(&change.new) == key(reading));
        let change = at.and_then(|at| self.plan.changes.get(at));
        let step = at.and_then(|at| self.steps.get(at));
        match (change, step) {
            (Some(change), Some(step)) => format!("-> {}: {step}", value(&change.new)),
            _ => String::new(),
        }
    }
}

impl Journal {
    fn result_text(&self, number: u16) -> String {
        let planned = self.plan.tasks.iter().zip(&self.task_steps);
        let mut found = planned.filter(|(change, _)| change.number == number);
        found.next().map_or_else(String::new, |(change, step)| {
            let now = if change.new == Task::Empty {
                "empty"
            } else {
                "another task"
            };
            format!("-> {now}: {step}")
        })
    }
}

impl fmt::Display for Journal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.way_back
            .write(f, &self.remarks(), &|reading| self.comment(reading), &|number| {
                self.result_text(number)
            })
    }
}

fn value(reading: &Reading) -> String {
    let text = match &reading.content {
        Content::Number { engineering, .. } => {
            let text = format!("{engineering:.*}", usize::from(reading.decimals));
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                text
            }
        }
        Content::Float(value) => value.to_string(),
        Content::Text(text) => format!("\"{text}\""),
        Content::Octets => format!("{:02X?}", reading.octets),
    };
    format!("{text}{}", unit(reading.unit))
}
