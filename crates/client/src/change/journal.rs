//! A set as text: a backup of the old values, with a remark behind each that says how far its change is.

use std::fmt;

use profile::notation::setting::{Entry, Form, Problem};
use profile::value::Reading;

use super::{Change, ChangeSet, Condition, Saved, Step};
use crate::backup::{Backup, BackupError, FORM, Header, Task, TaskCoverage, selection, value};

/// A journal that only programs read.
const SEALED: Form = Form { sealed: true, ..FORM };
/// Stands before the new value in the comment behind the old one.
const NEW: &str = "-> ";

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
            let new = value(&self.parameters_after(), &change.new);
            format!("{NEW}{new}: {}", change.step)
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
            format!("{NEW}{now}: {}", task.step)
        })
    }
}

impl ChangeSet {
    /// The journal with a checksum, which [`from_journal`](Self::from_journal) reads back.
    #[must_use]
    pub fn journal(&self) -> String {
        self.text(&SEALED)
    }

    /// Reads the text or the octets of the [`journal`](Self::journal) of a set of plain values back: old and new value of each, and how far it may
    /// be. What was sent counts as in doubt.
    ///
    /// # Errors
    /// When the text is not a journal, or is cut or changed; when it has motion tasks, or values that scale others.
    pub fn from_journal(file: impl AsRef<[u8]>) -> Result<Self, BackupError> {
        let old = SEALED.read(file.as_ref())?;
        let mut new = old.clone();
        let mut steps = Vec::new();
        for line in &mut new.lines {
            if let Entry::Setting { value, .. } = &mut line.entry {
                let comment = line
                    .comment
                    .strip_prefix(NEW)
                    .and_then(|new| new.split_once(": "));
                let (new, step) =
                    comment.ok_or_else(|| Problem::new(line.number, "a journal has the new value here"))?;
                new.clone_into(value);
                let mut unsent = [Step::Same, Step::NotWritten].into_iter();
                let unsent = unsent.find(|unsent| unsent.to_string() == step);
                steps.push((line.number, unsent.unwrap_or(Step::InDoubt)));
            }
        }
        let (old, new) = (Backup::of(old)?, Backup::of(new)?);
        let parameters = *old.parameters();
        let mut set = Self::of(old.header.clone(), parameters, Condition::OffToScale);
        // by number, as they were written
        for ((old, new), (line, step)) in old.readings().iter().zip(new.readings()).zip(steps) {
            let change = Change {
                old: Some(Ok(old.clone())),
                step,
                ..Change::new(&parameters, selection(&parameters, old), new.clone())
            };
            if change.scales(&parameters) {
                return Err(Problem::new(line, "this value scales the others").into());
            }
            set.changes.push(change);
        }
        Ok(set)
    }

    fn text(&self, form: &Form) -> String {
        let comment = |reading: &Reading| self.comment(reading);
        self.way_back().text(form, &self.remarks(), &comment, &|number| {
            self.task_comment(number)
        })
    }
}

impl fmt::Display for ChangeSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(&FORM))
    }
}
