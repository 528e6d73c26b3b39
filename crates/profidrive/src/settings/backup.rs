//! All settings of a drive, and what is missing among them.

use std::fmt;

use client::backup::{Backup, TaskCoverage};
use client::{Drive, Error, Session};

use crate::{Outcome, Reported};

/// Most names for one reason, in a text.
const MOST_NAMED: usize = 3;

/// Reads all settings of a drive and its motion tasks, with the outcome that [`outcome`] has for them. `progress` receives
/// how many settings and motion tasks are read, and their total.
///
/// # Errors
/// When the drive cannot be reached. What it refuses is in the backup: see [`missing`].
pub async fn backup(
    session: &mut Session,
    drive: &mut Drive,
    mut progress: impl FnMut(usize, usize) + Send,
) -> Result<Reported<Backup>, Error> {
    let report = session.backup(drive, &mut progress).await?;
    let outcome = outcome(&report);
    Ok(Reported { report, outcome })
}

/// How complete a backup is: [`Outcome::Difference`] where it has no value at all, [`Outcome::Partial`] where settings or the
/// motion tasks are missing.
#[must_use]
pub fn outcome(backup: &Backup) -> Outcome {
    if backup.readings().is_empty() && backup.task_count() == 0 {
        Outcome::Difference
    } else if missing(backup).is_nothing() {
        Outcome::Complete
    } else {
        Outcome::Partial
    }
}

/// What a backup lacks. Its text has the first names for each reason.
///
/// ```
/// use profidrive::client::backup::Backup;
/// use profidrive::settings::missing;
///
/// let head = "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\n";
/// let backup = Backup::read(format!("{head}tasks: left out, the power stage is on\np2108 = 1\n"))?;
/// assert_eq!(missing(&backup).to_string(), "the motion tasks are left out: the power stage is on");
/// # Ok::<(), profidrive::client::backup::BackupError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    /// The settings that could not be read, by reason.
    pub settings: Vec<MissingSettings>,
    /// Why the motion tasks are left out; `None` where they are not.
    pub tasks: Option<String>,
}

/// Settings that could not be read for one reason.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingSettings {
    /// The reason.
    pub why: String,
    /// Their names; the number where one has no name.
    pub names: Vec<String>,
}

/// Returns what a backup lacks.
#[must_use]
pub fn missing(backup: &Backup) -> Missing {
    let mut settings: Vec<MissingSettings> = Vec::new();
    for refusal in backup.refused() {
        let why = refusal.words();
        let name = refusal
            .name
            .map_or_else(|| refusal.shown.to_string(), str::to_owned);
        match settings.iter_mut().find(|known| known.why == why) {
            Some(known) => known.names.push(name),
            None => settings.push(MissingSettings {
                why,
                names: vec![name],
            }),
        }
    }
    let tasks = match &backup.header.tasks {
        TaskCoverage::LeftOut(why) => Some(why.clone()),
        TaskCoverage::Nothing | TaskCoverage::All => None,
    };
    Missing { settings, tasks }
}

impl Missing {
    /// Returns true where the backup is complete.
    #[must_use]
    pub const fn is_nothing(&self) -> bool {
        self.settings.is_empty() && self.tasks.is_none()
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut before = "";
        if !self.settings.is_empty() {
            let count: usize = self.settings.iter().map(|one| one.names.len()).sum();
            let plural = if count == 1 { "" } else { "s" };
            let reasons: Vec<String> = self.settings.iter().map(ToString::to_string).collect();
            write!(f, "{count} setting{plural} missing: {}", reasons.join("; "))?;
            before = "; ";
        }
        match &self.tasks {
            Some(why) => write!(f, "{before}the motion tasks are left out: {why}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for MissingSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let first: Vec<&str> = self.names.iter().take(MOST_NAMED).map(String::as_str).collect();
        let more = if first.len() < self.names.len() {
            ", .."
        } else {
            ""
        };
        write!(f, "{}{more} ({})", first.join(", "), self.why)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_backup_without_the_motion_tasks_is_incomplete() {
        let of = |tasks: &str| {
            let head = "profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\n";
            let backup = Backup::read(format!("{head}{tasks}p2108 = 1\n")).unwrap();
            (outcome(&backup), missing(&backup).to_string())
        };
        assert_eq!(of(""), (Outcome::Complete, String::new()));
        assert_eq!(of("tasks: all\n").0, Outcome::Complete);
        let (outcome, text) = of("tasks: left out, the power stage is on\n");
        assert_eq!(outcome, Outcome::Partial);
        assert_eq!(text, "the motion tasks are left out: the power stage is on");
    }

    #[test]
    fn missing_settings_are_named_by_reason() {
        let of = |why: &str, names: &[&str]| MissingSettings {
            why: why.to_owned(),
            names: names.iter().map(|&name| name.to_owned()).collect(),
        };
        let missing = Missing {
            settings: vec![of("no answer", &["A", "B", "C", "D"]), of("not readable", &["E"])],
            tasks: Some("the power stage is on".to_owned()),
        };
        assert_eq!(
            missing.to_string(),
            "5 settings missing: A, B, C, .. (no answer); E (not readable); \
             the motion tasks are left out: the power stage is on"
        );
    }
}
