//! Warnings of an axis under control: the status word has one bit for all of them, their numbers are requested.

use std::time::Duration;

use profinet::Instant;

use super::BESIDE;
use super::axis::{Axis, AxisStatus, WarningWatcher};
use crate::{Connection, Error};

/// How often the warnings of a drive that has one are read.
const AGAIN: Duration = Duration::from_secs(1);

/// The observer, and what was reported to it.
#[derive(Default)]
pub(super) struct Warnings {
    watcher: Option<WarningWatcher>,
    reported: Reported,
}

/// What was reported since the warning bit came.
#[derive(Debug, Default, PartialEq)]
enum Reported {
    /// There is no warning.
    #[default]
    Nothing,
    /// These numbers; read from the drive at this time.
    Numbers(Vec<u32>, Instant),
    /// That there is one: the drive has no number for it, or does not answer.
    TheBit,
}

impl Warnings {
    pub(super) fn watch(&mut self, watcher: WarningWatcher) {
        self.watcher = Some(watcher);
        self.reported = Reported::Nothing;
    }
}

impl Axis {
    /// Reports new warnings. A drive that does not answer causes no delay: it is queried once.
    pub(super) async fn look_for_warnings(&mut self, status: &AxisStatus) {
        if self.warnings.watcher.is_none() || self.connection() != Connection::Running {
            return;
        }
        if !status.view.seen.is_some_and(crate::axis::Seen::warning) {
            self.warnings.reported = Reported::Nothing;
            return;
        }
        let now = self.session.now();
        let mut before = Vec::new();
        match &mut self.warnings.reported {
            Reported::TheBit => return,
            Reported::Numbers(_, asked) if now - *asked < AGAIN => return,
            Reported::Numbers(numbers, _) => before = std::mem::take(numbers),
            Reported::Nothing => {}
        }
        let drive = &self.drive;
        let asked = {
            let _meanwhile = self.session.bound_by(now + BESIDE);
            self.session.warnings(drive).await
        };
        let present = match asked {
            Err(Error::Interrupted) => return,
            other => other.ok().flatten().filter(|present| !present.is_empty()),
        };
        let still = self.status().and_then(|status| status.view.seen);
        let still = still.is_some_and(crate::axis::Seen::warning);
        let Some(watcher) = &mut self.warnings.watcher else {
            return;
        };
        let Some(present) = present else {
            // gone before it was requested, or without a number
            if still && before.is_empty() {
                watcher(status, &[]);
            }
            self.warnings.reported = Reported::TheBit;
            return;
        };
        let new: Vec<_> = present
            .iter()
            .filter(|warning| !before.contains(&warning.number))
            .cloned()
            .collect();
        if !new.is_empty() {
            watcher(status, &new);
        }
        let numbers = present.iter().map(|warning| warning.number).collect();
        self.warnings.reported = Reported::Numbers(numbers, self.session.now());
    }
}
