//! What happens while something is recorded, in words.

use super::producer::Absence;
use super::run::{News, Triggered};
use super::table::Table;
use crate::{Explained, Remark, date_and_time, lasting};

impl News {
    /// Returns what a person is to know, in sentences; none for a row. `table` is that of the recording.
    #[must_use]
    pub fn remarks(&self, table: &Table) -> Vec<Remark> {
        let named = |drive: &usize| table.drives.get(*drive).map_or("", String::as_str);
        match self {
            Self::Row(_) => Vec::new(),
            Self::Away {
                drive,
                since,
                absence,
            } => vec![Remark::warning(format!(
                "{} {}, since {} after the start; retrying",
                named(drive),
                absence.sentence(),
                lasting(*since)
            ))],
            Self::Back {
                drive,
                outage,
                faults,
            } => {
                let name = named(drive);
                let back = format!("{name} is recorded again after {}", lasting(*outage));
                let faults = faults
                    .iter()
                    .map(|fault| Remark::warning(format!("{name}: {fault}")));
                std::iter::once(Remark::news(back)).chain(faults).collect()
            }
            Self::PowerOn { drive, reaction } => vec![Remark::warning(format!(
                "{}: its power stage is on; the cyclic connection stays open, because when it ends, {reaction}",
                named(drive)
            ))],
            Self::Waits { drive, reaction } => vec![Remark::warning(format!(
                "{}: the recording has ended, and the connection is closed once the power stage is off, because then {reaction}",
                named(drive)
            ))],
            Self::HoldsAlready { trigger, drive } => vec![Remark::warning(format!(
                "{}: `{trigger}` is true already; the recording begins when it becomes true again",
                named(drive)
            ))],
            Self::Triggered(triggered) => vec![Remark::news(triggered.sentence(named(&triggered.drive)))],
            Self::Ended { drive, error } => vec![Remark::warning(format!(
                "{} is no longer recorded: {}",
                named(drive),
                error.message()
            ))],
        }
    }
}

impl Triggered {
    /// `fault of akd-2 after 3.2 s, at 2026-11-24 13:05:07.123 UTC: F439 Following error`
    fn sentence(&self, drive: &str) -> String {
        let mut text = format!("{} of {drive} after {}", self.trigger, lasting(self.time));
        if let Some(wall) = self.wall {
            text = format!("{text}, at {}", date_and_time(wall));
        }
        let faults: Vec<String> = self.faults.iter().map(ToString::to_string).collect();
        if !faults.is_empty() {
            text = format!("{text}: {}", faults.join(", "));
        }
        text
    }
}

impl Absence {
    /// Returns why nothing is recorded, behind the name of the drive.
    const fn sentence(self) -> &'static str {
        match self {
            Self::Silent => "does not answer",
            Self::Controlled => "has another controller",
            Self::InUse => "is operated: its cyclic connection is closed, so that it cannot stop the motor",
        }
    }
}
