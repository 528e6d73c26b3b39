//! A recording under way: the drives side by side, their rows in the order of arrival.

use std::future::poll_fn;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::{Duration, SystemTime};

use client::{Error, FaultEntry, LossReaction, Session};
use futures::channel::mpsc;
use futures::future::BoxFuture;
use futures::stream::{FuturesUnordered, StreamExt};
use profinet::Instant;

use super::cyclic::observe;
use super::error::RecordingError;
use super::poll::poll;
use super::producer::{Absence, Common, Item, Producer, RecordingStop};
use super::source::{Origin, Source, together};
use super::table::{Row, Table};
use super::trigger::{Armed, MOST_BEFORE, Reported, Trigger};
use super::{Every, Request};
use crate::clock::WallClock;

/// Rows that are buffered; drives are not read while the buffer is full.
const ROOM: usize = 4096;

/// Interval at which the end is checked.
const BEAT: Duration = Duration::from_millis(50);

/// A recording under way. It ends by its time, by [`stop`](Self::stop) or when the caller of the session requests a stop
/// ([`Session::interrupt_with`]). Each of them keeps a connection whose end would stop a motor until that is at rest
/// ([`News::Waits`]).
///
/// Dropping it closes its cyclic connections, as the drop of an [`Axis`](client::Axis) does.
pub struct Recording {
    table: Table,
    start: Instant,
    session: Session,
    stop: RecordingStop,
    rows: mpsc::Receiver<Item>,
    producers: FuturesUnordered<BoxFuture<'static, (usize, Result<(), RecordingError>)>>,
    /// Rows to be returned next.
    ready: std::collections::VecDeque<Row>,
    armed: Option<(Armed, Trigger)>,
    triggered: Option<Triggered>,
    /// The event that did not happen, how long it was waited for, and the drives on which its condition held from the beginning.
    missed_trigger: Option<(Trigger, Duration, Vec<usize>)>,
    clock: WallClock,
    /// How long to record from the start or the trigger, and when that is over.
    time: Option<Duration>,
    end: Option<Duration>,
    /// Keeps virtual time running while the drives wait; `None` once the network failed.
    beat: Option<BoxFuture<'static, Result<(), Error>>>,
    counts: Vec<DriveCounts>,
}

impl std::fmt::Debug for Recording {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recording")
            .field("table", &self.table)
            .field("counts", &self.counts)
            .finish_non_exhaustive()
    }
}

/// What happens while something is recorded.
#[derive(Debug)]
#[non_exhaustive]
pub enum News {
    /// Values arrived, or are missing.
    Row(Row),
    /// Nothing is recorded of a drive since a time from the start. It is tried again.
    Away {
        /// Its index.
        drive: usize,
        /// Since when.
        since: Duration,
        /// Why.
        absence: Absence,
    },
    /// A drive is recorded again.
    Back {
        /// Its index.
        drive: usize,
        /// How long it was not.
        outage: Duration,
        /// Faults that are present and were not before.
        faults: Vec<FaultEntry>,
    },
    /// The power stage of a drive is on. Its connection stays open, as its end would stop the motor as this says; so does a
    /// connection that is lost.
    PowerOn {
        /// Its index.
        drive: usize,
        /// What the drive does when the connection ends.
        reaction: Box<LossReaction>,
    },
    /// The recording has ended, and the connection of a drive stays open until its power stage is off. A second
    /// [`stop`](Recording::stop) closes it at once, or the caller who insists ([`Session::hurry_with`]).
    Waits {
        /// Its index.
        drive: usize,
        /// What the drive does when the connection ends.
        reaction: Box<LossReaction>,
    },
    /// The condition of the request holds from the beginning, which is no event: the recording begins when it becomes true again,
    /// or becomes true on another drive.
    HoldsAlready {
        /// The condition.
        trigger: Trigger,
        /// Index of the drive.
        drive: usize,
    },
    /// The event of the request happened: the rows that follow begin before it.
    Triggered(Triggered),
    /// A drive is no longer recorded, the others are.
    Ended {
        /// Its index.
        drive: usize,
        /// Why.
        error: RecordingError,
    },
}

/// The event at which a recording began.
#[derive(Debug, Clone, PartialEq)]
pub struct Triggered {
    /// What happened.
    pub trigger: Trigger,
    /// Index of the drive on which it happened.
    pub drive: usize,
    /// When the row of the event arrived, from the start.
    pub time: Duration,
    /// The time of day; `None` in virtual time.
    pub wall: Option<SystemTime>,
    /// The faults that came with it, where the trigger is a fault.
    pub faults: Vec<FaultEntry>,
}

/// What was recorded of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DriveCounts {
    /// Rows with values.
    pub rows: u64,
    /// Rows that are gaps.
    pub gaps: u64,
    /// Readings or cycles that are missing, in gaps or beside them, since the start.
    pub missed: u64,
    /// How often nothing was recorded of the drive for a while: it did not answer, was lost or was in use.
    pub outages: u64,
    /// How long it was away, as far as it came back.
    pub outage_time: Duration,
    /// Since when from the start nothing is recorded of it.
    pub away_since: Option<Duration>,
}

impl Recording {
    /// Begins to record. `clock` is that of the network ([`Caller::wall_clock`](crate::Caller::wall_clock)).
    ///
    /// # Errors
    /// When the request is not valid, or the drives do not fit together: one name has two units.
    pub fn begin(
        session: &Session,
        clock: WallClock,
        sources: Vec<Source>,
        request: &Request,
    ) -> Result<Self, RecordingError> {
        request.check()?;
        let columns = sources
            .iter()
            .map(|source| (source.name.as_str(), &source.columns[..]));
        let table = together(columns);
        let armed = match &request.trigger {
            Some(trigger) => {
                check_before(request, &sources)?;
                Some((Armed::new(trigger, request.pre, &table)?, trigger.clone()))
            }
            None => None,
        };
        let (sender, rows) = mpsc::channel(ROOM);
        let start = session.now();
        let stop = RecordingStop::default();
        let words = matches!(request.trigger, Some(Trigger::Fault | Trigger::Warning));
        let producers = FuturesUnordered::new();
        for (drive, source) in sources.into_iter().enumerate() {
            let common = Common {
                start,
                clock,
                stop: stop.clone(),
                rows: sender.clone(),
            };
            let producer = Producer::new(session.clone(), drive, common, &table, &source.columns)
                .with_known_faults(source.faults.clone())
                .naming_faults(request.trigger == Some(Trigger::Fault));
            producers.push(produce(drive, producer, source, request.every, words));
        }
        let counts = vec![DriveCounts::default(); table.drives.len()];
        let mut recording = Self {
            table,
            start,
            session: session.clone(),
            stop,
            rows,
            producers,
            ready: std::collections::VecDeque::new(),
            armed,
            triggered: None,
            missed_trigger: None,
            clock,
            time: request.time,
            end: None,
            beat: None,
            counts,
        };
        if recording.armed.is_none() {
            recording.limit(Duration::ZERO);
        }
        recording.beat = Some(recording.next_beat());
        Ok(recording)
    }

    /// Returns the drives and columns.
    #[must_use]
    pub const fn table(&self) -> &Table {
        &self.table
    }

    /// Returns what was recorded of each drive so far.
    #[must_use]
    pub fn counts(&self) -> &[DriveCounts] {
        &self.counts
    }

    /// Returns the event at which it began; `None` without one, and before it.
    #[must_use]
    pub const fn triggered(&self) -> Option<&Triggered> {
        self.triggered.as_ref()
    }

    /// Returns the time since the start.
    #[must_use]
    pub fn elapsed(&self) -> Duration {
        self.session.now().saturating_since(self.start)
    }

    /// Returns what ends it from any thread.
    #[must_use]
    pub fn stop_handle(&self) -> RecordingStop {
        self.stop.clone()
    }

    /// Ends it. A connection whose end would stop a motor stays open until that is at rest; a second call closes it at once. What
    /// came before is still returned by [`next`](Self::next), which then closes the connections.
    pub fn stop(&self) {
        self.stop.stop();
    }

    /// Waits for the next row or event; `None` once it ended and every connection is closed.
    ///
    /// # Errors
    /// When the network fails.
    pub async fn next(&mut self) -> Result<Option<News>, Error> {
        loop {
            if let Some(row) = self.ready.pop_front() {
                if let Some(news) = self.counted(row) {
                    return Ok(Some(news));
                }
                continue;
            }
            let Some(step) = poll_fn(|context| self.poll(context)).await else {
                if !self.gives_up_waiting() {
                    return Ok(None);
                }
                continue;
            };
            let news = match step {
                Step::Item(item) => self.take(item),
                Step::Ended(_, RecordingError::Client(error)) if is_of_network(&error) => {
                    self.stop();
                    return Err(error);
                }
                Step::Ended(drive, error) => Some(News::Ended { drive, error }),
            };
            if news.is_some() {
                return Ok(news);
            }
        }
    }

    /// Turns to the end of a recording whose event did not happen: a gap of each drive says that nothing was recorded until then.
    /// Returns false when that was done, or there is nothing to wait for.
    fn gives_up_waiting(&mut self) -> bool {
        let Some((armed, trigger)) = self.armed.take() else {
            return false;
        };
        let waited = self.elapsed();
        let gap = |drive| Row {
            time: waited,
            wall: self.clock.before(Duration::ZERO),
            drive,
            gap: true,
            values: vec![None; self.table.columns.len()],
        };
        self.ready = (0..self.table.drives.len()).map(gap).collect();
        self.missed_trigger = Some((trigger, waited, armed.already().to_vec()));
        true
    }

    /// Checks that the event of the request happened.
    ///
    /// # Errors
    /// [`RecordingError::NotTriggered`] once the recording has ended without it.
    pub fn check_triggered(&self) -> Result<(), RecordingError> {
        match &self.missed_trigger {
            None => Ok(()),
            Some((trigger, waited, already)) => Err(RecordingError::NotTriggered {
                trigger: Box::new(trigger.clone()),
                waited: *waited,
                already: already
                    .iter()
                    .filter_map(|drive| self.table.drives.get(*drive).cloned())
                    .collect(),
            }),
        }
    }

    /// Polls every drive, then returns the next item.
    fn poll(&mut self, context: &mut Context<'_>) -> Poll<Option<Step>> {
        while let Some(beat) = &mut self.beat {
            let Poll::Ready(passed) = beat.as_mut().poll(context) else {
                break;
            };
            if self.end.is_some_and(|end| self.elapsed() >= end) {
                self.stop.stop_once();
            }
            self.beat = passed.is_ok().then(|| self.next_beat());
        }
        loop {
            if let Poll::Ready(Some(item)) = self.rows.poll_next_unpin(context) {
                return Poll::Ready(Some(Step::Item(item)));
            }
            match self.producers.poll_next_unpin(context) {
                Poll::Ready(Some((_, Ok(())))) => {}
                Poll::Ready(Some((drive, Err(error)))) => {
                    return Poll::Ready(Some(Step::Ended(drive, error)));
                }
                Poll::Ready(None) => {
                    // all drives have ended: only buffered items are left
                    let rest = Pin::new(&mut self.rows).poll_next_unpin(context);
                    return rest.map(|item| item.map(Step::Item));
                }
                // items that were sent during this poll are returned before the task sleeps
                Poll::Pending => {
                    let rest = self.rows.poll_next_unpin(context);
                    let Poll::Ready(Some(item)) = rest else {
                        return Poll::Pending;
                    };
                    return Poll::Ready(Some(Step::Item(item)));
                }
            }
        }
    }

    fn take(&mut self, item: Item) -> Option<News> {
        match item {
            Item::Row(reported) => self.take_row(reported),
            Item::Missed { drive, count } => {
                let counts = self.counts.get_mut(drive)?;
                counts.missed = counts.missed.saturating_add(count);
                None
            }
            Item::Away {
                drive,
                since,
                absence,
                again,
            } => {
                let counts = self.counts.get_mut(drive)?;
                counts.outages += u64::from(!again);
                counts.away_since.get_or_insert(since);
                Some(News::Away {
                    drive,
                    since,
                    absence,
                })
            }
            Item::Back {
                drive,
                outage,
                faults,
            } => {
                let counts = self.counts.get_mut(drive)?;
                counts.outage_time += outage;
                counts.away_since = None;
                Some(News::Back {
                    drive,
                    outage,
                    faults,
                })
            }
            Item::PowerOn { drive, reaction } => Some(News::PowerOn { drive, reaction }),
            Item::Waits { drive, reaction } => Some(News::Waits { drive, reaction }),
        }
    }

    fn take_row(&mut self, reported: Reported) -> Option<News> {
        let Some((armed, trigger)) = &mut self.armed else {
            return self.counted(reported.row);
        };
        let (drive, time, wall) = (reported.row.drive, reported.row.time, reported.row.wall);
        let (faults, known) = (reported.faults.clone(), armed.already().len());
        let Some(rows) = armed.look(reported) else {
            let held = armed.already().len() > known;
            return held.then(|| News::HoldsAlready {
                trigger: trigger.clone(),
                drive,
            });
        };
        let triggered = Triggered {
            trigger: trigger.clone(),
            drive,
            time,
            wall,
            faults,
        };
        self.armed = None;
        self.ready = rows.into();
        self.triggered = Some(triggered.clone());
        self.limit(time);
        Some(News::Triggered(triggered))
    }

    /// Starts the time that is to be recorded.
    fn limit(&mut self, from: Duration) {
        let Some(time) = self.time else { return };
        let end = from.saturating_add(time);
        self.end = Some(end);
    }

    /// Waits for the end, at most [`BEAT`]. In virtual time, which advances only while calls wait, the wait of one drive alone is not
    /// enough: the futures of drives that were not woken are not polled.
    fn next_beat(&self) -> BoxFuture<'static, Result<(), Error>> {
        let left = self.end.map(|end| end.saturating_sub(self.elapsed()));
        let time = left
            .filter(|left| !left.is_zero())
            .map_or(BEAT, |left| left.min(BEAT));
        let mut session = self.session.clone();
        Box::pin(async move {
            session
                .uninterrupted(async |session: &mut Session| session.pass(time).await)
                .await
        })
    }

    /// Counts a row, unless its time is over.
    fn counted(&mut self, row: Row) -> Option<News> {
        if self.end.is_some_and(|end| row.time >= end) {
            return None;
        }
        let counts = self.counts.get_mut(row.drive)?;
        *(if row.gap {
            &mut counts.gaps
        } else {
            &mut counts.rows
        }) += 1;
        Some(News::Row(row))
    }
}

enum Step {
    Item(Item),
    Ended(usize, RecordingError),
}

/// The network failed, for all drives.
const fn is_of_network(error: &Error) -> bool {
    matches!(error, Error::Medium(_) | Error::Closed | Error::DriverFailed)
}

/// The work on one drive. A gap says that it ended before the recording.
fn produce(
    drive: usize,
    mut producer: Producer,
    source: Source,
    every: Every,
    words: bool,
) -> BoxFuture<'static, (usize, Result<(), RecordingError>)> {
    let interval = match every {
        Every::Interval(interval) => interval,
        Every::Cycle { .. } => crate::monitor::SHORTEST_INTERVAL,
    };
    Box::pin(async move {
        let result = match source.origin {
            Origin::Parameters(selections) => {
                let read = poll(&mut producer, source.drive, selections, interval, words).await;
                read.map_err(RecordingError::from)
            }
            Origin::Cyclic(observed) => observe(&mut producer, *observed, &source.columns).await,
        };
        if result.is_err() {
            let now = producer.session.now();
            producer.gap(now, 0).await;
        }
        producer.flush().await;
        (drive, result)
    })
}

/// Checks that the time before the trigger fits into memory.
fn check_before(request: &Request, sources: &[Source]) -> Result<(), RecordingError> {
    let rows = |source: &Source| {
        let interval = match (request.every, source.cyclic()) {
            (_, Some((cycle, _))) => cycle,
            (Every::Interval(interval), None) => interval,
            (Every::Cycle { .. }, None) => crate::monitor::SHORTEST_INTERVAL,
        };
        request.pre.as_nanos() / interval.as_nanos().max(1)
    };
    let rows = sources.iter().map(rows).sum();
    if rows > MOST_BEFORE as u128 {
        return Err(RecordingError::Before { rows });
    }
    Ok(())
}
