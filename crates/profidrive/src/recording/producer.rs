//! The work on one drive: its rows and events, whether its values are read or received in each cycle.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Duration;

use client::{Drive, Error, ErrorKind, FaultEntry, LossReaction, Session};
use futures::SinkExt;
use futures::channel::mpsc;
use profinet::Instant;

use super::table::{Column, Kind, Row, Table, Value};
use super::trigger::Reported;
use crate::clock::WallClock;

/// Interval at which the end of the recording is checked.
const CHECKED: Duration = Duration::from_millis(50);
/// Gap rows of one interruption; further missing cycles are only counted.
pub(super) const MOST_GAPS: u64 = 1000;

/// Rows and events of the drives.
#[derive(Debug)]
pub(super) enum Item {
    Row(Reported),
    /// Readings or cycles that are missing and have no row of their own.
    Missed {
        drive: usize,
        count: u64,
    },
    /// Nothing is recorded of a drive; `again` where it was away already, for another reason.
    Away {
        drive: usize,
        since: Duration,
        absence: Absence,
        again: bool,
    },
    /// It is recorded again.
    Back {
        drive: usize,
        outage: Duration,
        faults: Vec<FaultEntry>,
    },
    /// Its power stage is on, and its connection stays open.
    PowerOn {
        drive: usize,
        reaction: Box<LossReaction>,
    },
    /// The recording has ended, and its connection stays open until the power stage is off.
    Waits {
        drive: usize,
        reaction: Box<LossReaction>,
    },
}

/// Why nothing is recorded of a drive for a while. It is tried again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Absence {
    /// It does not answer, or does not know its connection any more.
    Silent,
    /// Another controller has it.
    Controlled,
    /// It is in local operation, or its power stage is on: the cyclic connection is closed so that its end cannot stop the motor.
    InUse,
}

impl Absence {
    /// Returns why an error of a call is no end: the drive may be recorded later.
    pub(super) fn of(error: &Error) -> Option<Self> {
        match error {
            Error::Medium(_) | Error::Closed | Error::DriverFailed => None,
            Error::OwnedByController { .. } | Error::ParametersOwned { .. } => Some(Self::Controlled),
            Error::Ownerless { .. } | Error::LocalOperation { .. } => Some(Self::InUse),
            other => matches!(other.kind(), ErrorKind::Unreachable | ErrorKind::Lost).then_some(Self::Silent),
        }
    }
}

/// The first wait for a drive that another controller has, and the longest.
const CONTROLLED: [Duration; 2] = [Duration::from_secs(2), Duration::from_secs(60)];

/// An absence under way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Away {
    pub since: Instant,
    pub absence: Absence,
    wait: Duration,
}

impl Away {
    /// Returns how long to wait before the next attempt, `usual` or longer: each attempt makes work for a controller's drive.
    pub(super) fn wait(&mut self, usual: Duration) -> Duration {
        if self.absence != Absence::Controlled {
            self.wait = CONTROLLED[0];
            return usual;
        }
        let wait = self.wait;
        self.wait = (wait * 2).min(CONTROLLED[1]);
        wait.max(usual)
    }
}

/// Where the value of a column comes from: the position among the values of the drive.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub at: usize,
}

/// Sends the rows of one drive.
pub(super) struct Producer {
    pub session: Session,
    pub drive: usize,
    start: Instant,
    clock: WallClock,
    stop: RecordingStop,
    rows: mpsc::Sender<Item>,
    /// For each column of the table its place at this drive, and its kind.
    columns: Vec<(Option<Place>, Kind)>,
    /// Events to be sent with the next row.
    unsent: Vec<Item>,
    /// Faults of the drive that are known to the caller.
    known: Vec<u16>,
    /// Whether the faults are read when the drive begins to report one, and whether it reported one before.
    names_faults: bool,
    faulty: Option<bool>,
    /// Faults to be sent with the next row.
    came: Vec<FaultEntry>,
}

/// Ends a recording, from any thread.
#[derive(Debug, Clone, Default)]
pub struct RecordingStop(Arc<AtomicU8>);

impl RecordingStop {
    /// Ends it, as [`Recording::stop`](super::Recording::stop) does. A second call closes the connections also where that stops a
    /// motor.
    pub fn stop(&self) {
        let _ = self
            .0
            .fetch_update(Ordering::AcqRel, Ordering::Acquire, |count| count.checked_add(1));
    }

    /// Ends it; further calls change nothing. For an end that is no wish of a person: no room for the rows, a terminal that is gone.
    pub fn stop_once(&self) {
        let _ = self.0.compare_exchange(0, 1, Ordering::AcqRel, Ordering::Acquire);
    }

    fn requests(&self) -> u8 {
        self.0.load(Ordering::Acquire)
    }
}

/// What all producers have in common.
#[derive(Debug, Clone)]
pub(super) struct Common {
    pub start: Instant,
    pub clock: WallClock,
    pub stop: RecordingStop,
    pub rows: mpsc::Sender<Item>,
}

impl Producer {
    /// Finds the columns of the table among those of the drive, `own`.
    pub(super) fn new(session: Session, drive: usize, common: Common, table: &Table, own: &[Column]) -> Self {
        let Common {
            start,
            clock,
            stop,
            rows,
        } = common;
        let place = |column: &Column| {
            let at = own.iter().position(|own| own.belongs_to(column));
            (at.map(|at| Place { at }), column.kind)
        };
        Self {
            session,
            drive,
            start,
            clock,
            stop,
            rows,
            columns: table.columns.iter().map(place).collect(),
            unsent: Vec::new(),
            known: Vec::new(),
            names_faults: false,
            faulty: None,
            came: Vec::new(),
        }
    }

    /// Takes the faults that are present as known.
    pub(super) fn with_known_faults(self, known: Vec<u16>) -> Self {
        Self { known, ..self }
    }

    /// With `names_faults` the row with which a drive begins to report a fault has its number.
    pub(super) fn naming_faults(self, names_faults: bool) -> Self {
        Self { names_faults, ..self }
    }

    /// Takes what the drive reports in the next row.
    pub(super) async fn note_fault(&mut self, fault: bool, drive: &Drive) {
        let before = self.faulty.replace(fault);
        if self.names_faults && fault && before == Some(false) {
            self.came = self.new_faults(&mut drive.clone()).await;
        }
    }

    /// Returns the faults that are present and were not known.
    async fn new_faults(&mut self, drive: &mut Drive) -> Vec<FaultEntry> {
        let present = present_faults(&mut self.session, drive).await;
        let numbers = present.iter().map(|fault| fault.number).collect();
        let known = std::mem::replace(&mut self.known, numbers);
        let new = present.into_iter().filter(|fault| !known.contains(&fault.number));
        new.collect()
    }

    /// Whether the recording has to end.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.requests() > 0
    }

    /// Whether connections have to be closed whatever the drive is doing.
    pub(super) fn is_stopped_at_once(&self) -> bool {
        self.stop.requests() > 1
    }

    /// Lets the time pass; false when the recording ends or the caller requests a stop.
    pub(super) async fn wait_until(&mut self, due: Instant) -> Result<bool, Error> {
        loop {
            if self.is_stopped() {
                return Ok(false);
            }
            let now = self.session.now();
            if now >= due {
                return match self.session.glance() {
                    Err(Error::Interrupted) => Ok(false),
                    other => other.map(|()| true),
                };
            }
            match self.session.pass((due - now).min(CHECKED)).await {
                Err(Error::Interrupted) => return Ok(false),
                other => other?,
            }
        }
    }

    /// Sends the values that arrived at `at`.
    pub(super) async fn row(
        &mut self,
        at: Instant,
        fault: bool,
        warning: bool,
        value: impl Fn(&Place, Kind) -> Option<Value>,
    ) {
        let values = self.columns.iter();
        let values = values
            .map(|(place, kind)| value(place.as_ref()?, *kind))
            .collect();
        let row = self.stamped(at, false, values);
        let faults = std::mem::take(&mut self.came);
        self.send(Item::Row(Reported {
            row,
            fault,
            warning,
            faults,
        }))
        .await;
    }

    /// Sends a gap: so many readings or cycles from `at` on are missing.
    pub(super) async fn gap(&mut self, at: Instant, missed: u64) {
        self.missed(missed);
        let row = self.stamped(at, true, vec![None; self.columns.len()]);
        self.send(Item::Row(Reported {
            row,
            fault: false,
            warning: false,
            faults: Vec::new(),
        }))
        .await;
    }

    /// Sends a gap for each lost cycle.
    pub(super) async fn lost_cycles(&mut self, first: Instant, cycle: Duration, count: u64) {
        for at in 0..count.min(MOST_GAPS) {
            let after = cycle * u32::try_from(at).unwrap_or(u32::MAX);
            self.gap(first + after, 1).await;
        }
        self.missed(count.saturating_sub(MOST_GAPS));
    }

    fn stamped(&self, at: Instant, gap: bool, values: Vec<Option<Value>>) -> Row {
        Row {
            time: at.saturating_since(self.start),
            wall: self.clock.before(self.session.now().saturating_since(at)),
            drive: self.drive,
            gap,
            values,
        }
    }

    pub(super) fn missed(&mut self, count: u64) {
        if count > 0 {
            let drive = self.drive;
            self.unsent.push(Item::Missed { drive, count });
        }
    }

    /// Reports that nothing is recorded of the drive, once for each reason; `away` is what was reported before.
    pub(super) fn away(&mut self, away: &mut Option<Away>, at: Instant, absence: Absence) {
        let before = *away;
        let since = before.map_or(at, |before| before.since);
        if before.is_some_and(|before| before.absence == absence) {
            return;
        }
        *away = Some(Away {
            since,
            absence,
            wait: CONTROLLED[0],
        });
        self.unsent.push(Item::Away {
            drive: self.drive,
            since: since.saturating_since(self.start),
            absence,
            again: before.is_some(),
        });
    }

    /// Reports that values come again, with the faults that are new since.
    pub(super) async fn back(&mut self, drive: &mut Drive, since: Instant) {
        let outage = self.session.now().saturating_since(since);
        let faults = self.new_faults(drive).await;
        self.unsent.push(Item::Back {
            drive: self.drive,
            outage,
            faults,
        });
    }

    /// Reports that the power stage is on and the connection stays open.
    pub(super) fn power_on(&mut self, reaction: &LossReaction) {
        self.unsent.push(Item::PowerOn {
            drive: self.drive,
            reaction: Box::new(reaction.clone()),
        });
    }

    /// Reports that the connection stays open although the recording has ended.
    pub(super) fn waits(&mut self, reaction: &LossReaction) {
        self.unsent.push(Item::Waits {
            drive: self.drive,
            reaction: Box::new(reaction.clone()),
        });
    }

    async fn send(&mut self, item: Item) {
        self.flush().await;
        // fails when the recording was dropped
        let _ = self.rows.send(item).await;
    }

    /// Sends the events that are left.
    pub(super) async fn flush(&mut self) {
        for item in std::mem::take(&mut self.unsent) {
            let _ = self.rows.send(item).await;
        }
    }
}

/// Returns the faults that are present; none where the drive has no fault buffer or does not answer.
pub(super) async fn present_faults(session: &mut Session, drive: &mut Drive) -> Vec<FaultEntry> {
    let mut faults = session.faults(drive).await.unwrap_or_default();
    faults.retain(|fault| fault.situation == 0);
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_of_another_controller_is_tried_less_and_less_often() {
        let usual = Duration::from_secs(1);
        let mut away = Away {
            since: Instant::ZERO,
            absence: Absence::Controlled,
            wait: CONTROLLED[0],
        };
        let waits: Vec<u64> = (0..7).map(|_| away.wait(usual).as_secs()).collect();
        assert_eq!(waits, [2, 4, 8, 16, 32, 60, 60]);
        away.absence = Absence::Silent;
        assert_eq!(away.wait(usual), usual);
    }
}
