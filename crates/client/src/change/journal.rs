//! A set as text: a backup of the old values, with a remark behind each that says how far its change is.

use std::fmt;

use super::{Change, ChangeSet, Saved, Step};
use crate::backup::{Backup, FORM, Header, Task, TaskCoverage, unit};
use profile::value::{Content, Reading};

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Same => f.write_str("same value"),
            Self::NotWritten => f.write_str("not written"),
            Self::InDoubt => f.write_str("in doubt: sent, not answered"),
            Self::Written => f.write_str("written"),
            Self::ReadBack => f.write_str("written, read back"),
            Self::Differs => f.write_str("written, but reads back another value"),
            Self::Refused(refusal) => f.write_str(&refusal.outcome()),
        }
    }
}

impl ChangeSet {
    /// The old values, as far as they are known: restoring them undoes what was done.
    #[must_use]
    pub fn way_back(&self) -> Backup {
        let settings = self.changes.iter().filter(|change| !change.acts);
        let old = settings.filter_map(|change| Some(Ok(change.old.clone()?.ok()?)));
        let header = Header {
            tasks: TaskCoverage::Nothing,
            ..self.header.clone()
        };
        let mut backup = Backup::new(header, self.parameters, old);
        for task in &self.tasks {
            backup.put_task(task.number, task.old.clone());
        }
        backup
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
            (self.count(|step| *step == Step::Same), "same"),
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

    fn remarks(&self) -> Vec<String> {
        let mut remarks = vec![
            "the values before a restore, of the parameters that it changes; restoring this file brings them back"
                .to_owned(),
            format!("{}: {}", if self.complete { "complete" } else { "not complete" }, self.summary()),
        ];
        remarks.extend(self.ended.as_ref().map(|why| format!("ended early: {why}")));
        remarks.push(match self.saved() {
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

    /// `-> 5000 rpm/s: written, read back`
    fn comment(&self, reading: &Reading) -> String {
        let of = |change: &&Change| (change.new.pnu, change.new.index) == (reading.pnu, reading.index);
        let change = self.changes.iter().find(of);
        change.map_or_else(String::new, |change| {
            format!("-> {}: {}", value(&change.new), change.step)
        })
    }

    fn task_comment(&self, number: u16) -> String {
        let mut tasks = self.tasks.iter().filter(|task| task.number == number);
        tasks.next().map_or_else(String::new, |task| {
            let now = if task.new == Task::Empty {
                "empty"
            } else {
                "another task"
            };
            format!("-> {now}: {}", task.step)
        })
    }
}

impl fmt::Display for ChangeSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.way_back().text(
            &FORM,
            &self.remarks(),
            &|reading| self.comment(reading),
            &|number| self.task_comment(number),
        );
        f.write_str(&text)
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
