//! What records one drive, whether its values are read or come by themselves.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use client::{Error, Session};
use futures::SinkExt;
use futures::channel::mpsc;
use profinet::Instant;

use super::table::{Column, Kind, Row, Table, Value};
use super::trigger::Reported;
use crate::clock::WallClock;

/// How often it is looked whether the recording ends.
const GLANCE: Duration = Duration::from_millis(50);
/// Gap rows of one place: what is missing beyond them is counted only.
const MOST_GAPS: u64 = 1000;

/// What comes from the drives.
#[derive(Debug)]
pub(super) enum Item {
    Row(Reported),
    /// Readings or cycles that are missing and have no row of their own.
    Missed {
        drive: usize,
        count: u64,
    },
    /// A drive does not answer.
    Silent {
        drive: usize,
        since: Duration,
    },
    /// It answers again.
    Answers {
        drive: usize,
        outage: Duration,
    },
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
    stop: Arc<AtomicBool>,
    rows: mpsc::Sender<Item>,
    /// For each column of the table its place at this drive, and its kind.
    columns: Vec<(Option<Place>, Kind)>,
    /// News that found no room among the rows.
    unsent: Vec<Item>,
}

/// What all producers have in common.
#[derive(Debug, Clone)]
pub(super) struct Common {
    pub start: Instant,
    pub clock: WallClock,
    pub stop: Arc<AtomicBool>,
    pub rows: mpsc::Sender<Item>,
}

impl Producer {
    pub(super) fn new(session: Session, drive: usize, common: Common, table: &Table, own: &[Column]) -> Self {
        let Common {
            start,
            clock,
            stop,
            rows,
        } = common;
        let mut producer = Self {
            session,
            drive,
            start,
            clock,
            stop,
            rows,
            columns: table.columns.iter().map(|column| (None, column.kind)).collect(),
            unsent: Vec::new(),
        };
        producer.wire(table, own);
        producer
    }

    /// Finds the columns of the table among those of the drive.
    pub(super) fn wire(&mut self, table: &Table, own: &[Column]) {
        for (place, column) in self.columns.iter_mut().zip(&table.columns) {
            let at = own.iter().position(|other| other.name == column.name);
            place.0 = at.map(|at| Place { at });
        }
    }

    /// Whether the recording has to end.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
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
            match self.session.pass((due - now).min(GLANCE)).await {
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
        self.send(Item::Row(Reported { row, fault, warning })).await;
    }

    /// Sends a gap: so many readings or cycles from `at` on are missing.
    pub(super) async fn gap(&mut self, at: Instant, missed: u64) {
        self.missed(missed);
        let row = self.stamped(at, true, vec![None; self.columns.len()]);
        self.send(Item::Row(Reported {
            row,
            fault: false,
            warning: false,
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

    pub(super) fn silent(&mut self, since: Instant) {
        let (drive, since) = (self.drive, since.saturating_since(self.start));
        self.unsent.push(Item::Silent { drive, since });
    }

    pub(super) fn answers(&mut self, now: Instant, since: Instant) {
        let (drive, outage) = (self.drive, now.saturating_since(since));
        self.unsent.push(Item::Answers { drive, outage });
    }

    async fn send(&mut self, item: Item) {
        self.flush().await;
        // a recording that was dropped takes no more
        let _ = self.rows.send(item).await;
    }

    /// Sends the news that is left.
    pub(super) async fn flush(&mut self) {
        for item in std::mem::take(&mut self.unsent) {
            let _ = self.rows.send(item).await;
        }
    }
}
