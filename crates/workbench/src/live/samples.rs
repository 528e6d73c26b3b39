//! Where samples come from: the cyclic connection of an axis that this server controls, or readings of parameters beside whoever
//! controls the drive.

use std::collections::{BTreeMap, HashSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use profidrive::client::axis::{AxisSignal, Sample, SignalScale};
use profidrive::client::{Axis, Samples, Snapshot};
use profidrive::monitor::Monitor;
use profidrive::profile::state::bits::Bit;
use profidrive::profile::telegram::signal;
use profidrive::profile::value::{Reading, Selection};
use tokio::task::JoinSet;
use tokio::time::{MissedTickBehavior, interval, sleep};

use super::block::{MOST_ROWS, NO_FLOAT, NO_INTEGER, NO_WORD, Row, Rows};
use super::hub::Topic;
use super::streams::{ColumnFacts, Header};
use crate::board::explained;
use crate::shared::Shared;

/// Time between two blocks of a stream.
const BLOCK: Duration = Duration::from_millis(33);
/// Samples of an axis that wait for the next block: some four seconds of the shortest cycle.
const WAITING: usize = 4096;
/// Time between two readings of parameters, where the drive answers as fast.
const READING: Duration = Duration::from_millis(20);
/// Time before a drive that cannot be read is tried again.
const AGAIN: Duration = Duration::from_secs(1);
/// The source of a stream without values.
const NONE: u64 = 0;

/// The axes that this server controls, by drive: where their samples come from.
#[derive(Debug, Default)]
pub(crate) struct Feeds(Mutex<Open>);

#[derive(Debug, Default)]
struct Open {
    feeds: BTreeMap<String, Feed>,
    last: u64,
}

/// The samples of one axis.
#[derive(Debug)]
struct Feed {
    source: u64,
    signals: Vec<AxisSignal>,
    header: Header,
    samples: Samples,
    before: Option<Sample>,
}

impl Feeds {
    fn open(&self) -> MutexGuard<'_, Open> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets pages see the samples of an axis, until [`end`](Self::end).
    pub fn begin(&self, drive: &str, axis: &Axis, simulation: bool) {
        let signals = axis.signals();
        let columns = signals.iter().map(|signal| column_of(signal, axis.bits(signal)));
        let header = Header {
            source: "cyclic",
            period_us: u32::try_from(axis.cycle().as_micros()).unwrap_or(u32::MAX),
            telegram: Some(axis.telegram()),
            simulation,
            columns: columns.collect(),
            ..Header::none(None)
        };
        let mut open = self.open();
        open.last += 1;
        let feed = Feed {
            source: open.last,
            signals,
            header,
            samples: axis.all_samples(WAITING),
            before: None,
        };
        open.feeds.insert(drive.to_owned(), feed);
    }

    pub fn end(&self, drive: &str) {
        self.open().feeds.remove(drive);
    }
}

/// Returns the column of a signal. Positions stay the numbers that travel, which an `f32` would round.
fn column_of(signal: &AxisSignal, bits: Option<&'static [Bit; 16]>) -> ColumnFacts {
    let of = signal.field.signal;
    let is_word = of.bits == 16 && !of.signed;
    let (kind, scale) = match signal.scale {
        SignalScale::Raw if is_word => ("u32", 1.0),
        SignalScale::Raw if of.bits <= 32 => ("i32", 1.0),
        SignalScale::Raw | SignalScale::Speed(_) => ("f32", 1.0),
        SignalScale::Turns(counts) => ("i32", 1.0 / counts),
    };
    ColumnFacts {
        name: of.name.to_owned(),
        role: match of.number {
            signal::STW1 => "control",
            signal::ZSW1 => "status",
            signal::NSOLL_A => "speed_set",
            signal::NIST_A => "speed",
            signal::XIST_A => "position",
            _ => "",
        },
        unit: signal.unit(),
        r#type: kind,
        scale,
        bits: is_word.then(|| bits.map_or_else(Vec::new, names)),
        from: None,
    }
}

fn names(bits: &'static [Bit; 16]) -> Vec<&'static str> {
    bits.iter().map(|bit| bit.name).collect()
}

/// Returns the cell of a signal in a sample.
fn cell_of(signal: &AxisSignal, column: &ColumnFacts, sample: &Sample) -> u32 {
    let raw = signal.raw(sample);
    match column.r#type {
        "u32" => raw.and_then(|raw| u32::try_from(raw).ok()).unwrap_or(NO_WORD),
        "i32" => integer(raw),
        _ => float(raw.map(|raw| signal.engineering(raw).unwrap_or_else(|| rounded(raw)))),
    }
}

/// Returns the low 32 bits of a number as they travel.
fn integer(raw: Option<i64>) -> u32 {
    raw.and_then(|raw| u32::try_from(raw & 0xFFFF_FFFF).ok())
        .unwrap_or(NO_INTEGER)
}

#[expect(clippy::cast_possible_truncation, reason = "a value to look at")]
fn float(value: Option<f64>) -> u32 {
    value.map_or(NO_FLOAT, |value| (value as f32).to_bits())
}

#[expect(clippy::cast_precision_loss, reason = "a value to look at")]
const fn rounded(raw: i64) -> f64 {
    raw as f64
}

fn micros(at: profidrive::Instant) -> u64 {
    at.as_nanos() / 1000
}

/// Stamps a header with the present time.
fn stamped(header: Header, now: profidrive::Instant) -> Header {
    let unix = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Header {
        t_us: micros(now),
        unix_ms: u64::try_from(unix.as_millis()).unwrap_or(u64::MAX),
        ..header
    }
}

/// Sends the samples of axes under control while pages want them, for ever.
pub(super) async fn cyclic(shared: Arc<Shared>) {
    let mut turn = interval(BLOCK);
    turn.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut wants = shared.hub.wants();
    loop {
        let wanted: Vec<(Topic, String)> = shared
            .hub
            .wanted()
            .into_iter()
            .filter_map(|topic| match &topic {
                Topic::Samples(id) => Some((topic.clone(), id.clone())),
                _ => None,
            })
            .collect();
        shared.hub.streams.keep(|topic| shared.hub.is_wanted(topic));
        if wanted.is_empty() {
            // fails only when the hub is gone
            if wants.changed().await.is_err() {
                return;
            }
            continue;
        }
        let mut some = false;
        for (topic, id) in &wanted {
            some |= pass_on(&shared, topic, id);
        }
        if some {
            shared.hub.announce();
        }
        turn.tick().await;
    }
}

/// Puts what came from an axis into its stream; returns whether there was something.
fn pass_on(shared: &Shared, topic: &Topic, id: &str) -> bool {
    let streams = &shared.hub.streams;
    let mut open = shared.feeds.open();
    let Some(feed) = open.feeds.get_mut(id) else {
        let is_new = streams.source(topic) != Some(NONE);
        if is_new {
            streams.begin(topic, NONE, &Header::none(None));
        }
        return is_new;
    };
    if streams.source(topic) != Some(feed.source) {
        // what has waited is of a time without a page
        while let Some(sample) = feed.samples.take() {
            feed.before = Some(sample);
        }
        streams.begin(
            topic,
            feed.source,
            &stamped(feed.header.clone(), feed.samples.now()),
        );
        return true;
    }
    let now = Instant::now();
    let mut some = false;
    let mut rows = Rows::default();
    while let Some(sample) = feed.samples.take() {
        some = true;
        let missing = feed.before.map_or(0, |before| sample.missing_since(&before));
        feed.before = Some(sample);
        let bad = !sample.valid;
        let another = missing > 0 || rows.bad != bad;
        if (another && !rows.rows.is_empty()) || rows.rows.len() == MOST_ROWS {
            streams.push(topic, &std::mem::take(&mut rows), now);
        }
        rows.bad = bad;
        if missing > 0 {
            rows.lost = u32::try_from(missing).unwrap_or(u32::MAX);
            rows.gap = true;
        }
        let signals = feed.signals.iter().zip(&feed.header.columns);
        rows.rows.push(Row {
            at: micros(sample.at),
            cells: signals
                .map(|(signal, column)| cell_of(signal, column, &sample))
                .collect(),
        });
    }
    if !rows.rows.is_empty() {
        streams.push(topic, &rows, now);
    }
    some
}

/// Reads parameters of drives while pages want them, for ever.
pub(super) async fn acyclic(shared: Arc<Shared>) {
    let mut wants = shared.hub.wants();
    let mut read: HashSet<Topic> = HashSet::new();
    let mut reading: JoinSet<Topic> = JoinSet::new();
    loop {
        for topic in shared.hub.wanted() {
            if matches!(topic, Topic::Acyclic(..)) && read.insert(topic.clone()) {
                reading.spawn(follow(Arc::clone(&shared), topic));
            }
        }
        tokio::select! {
            changed = wants.changed() => {
                // fails only when the hub is gone
                if changed.is_err() {
                    return;
                }
            }
            Some(done) = reading.join_next() => match done {
                Ok(topic) => { read.remove(&topic); }
                // a panic in a reading was printed; its drive is read again
                Err(_) => read.clear(),
            },
        }
    }
}

/// Reads one drive until no page wants it.
async fn follow(shared: Arc<Shared>, topic: Topic) -> Topic {
    while let Topic::Acyclic(id, parameters) = &topic
        && shared.hub.is_wanted(&topic)
    {
        let Err(reason) = read(&shared, &topic, id, parameters).await else {
            continue;
        };
        shared
            .hub
            .streams
            .begin(&topic, NONE, &Header::none(Some(reason)));
        shared.hub.announce();
        sleep(AGAIN).await;
    }
    shared.hub.streams.keep(|topic| shared.hub.is_wanted(topic));
    topic
}

/// Reads a drive again and again.
///
/// # Errors
/// Why it cannot be read, in words.
async fn read(shared: &Shared, topic: &Topic, id: &str, parameters: &[String]) -> Result<(), String> {
    let mut network = shared.network.clone();
    let restarts = shared.board.restarts();
    let found = shared.board.find(&mut network, id).await;
    let mut drive = found.map_err(|error| explained(&error).message)?;
    let mut refused = Vec::new();
    let mut wanted: Vec<(String, Selection)> = Vec::new();
    for name in parameters {
        match drive.select(name) {
            // one element for each column
            Ok(selection) if selection.count == 1 => wanted.push((name.clone(), selection)),
            Ok(selection) => refused.push((name.clone(), format!("it has {} elements", selection.count))),
            Err(problem) => refused.push((name.clone(), problem.to_string())),
        }
    }
    let selections = wanted.iter().map(|(_, selection)| *selection).collect();
    let monitor = Monitor::new(READING).map_err(|error| error.to_string())?;
    let mut monitor = monitor.with(selections);
    let mut plan: Option<Vec<(ColumnFacts, Origin)>> = None;
    let mut rows = Rows::default();
    let mut pushed = Instant::now();
    // another plant may have another drive in this place
    while shared.hub.is_wanted(topic) && shared.board.restarts() == restarts {
        let seen = monitor.read(&mut network, &mut drive).await;
        let snapshot = seen.map_err(|error| explained(&error).message)?.snapshot;
        let at = network.now();
        if plan.is_none() {
            let columns = columns_of(&snapshot, &wanted, &mut refused);
            let header = Header {
                source: "acyclic",
                period_us: u32::try_from(READING.as_micros()).unwrap_or(u32::MAX),
                simulation: shared.source.is_simulation(),
                columns: columns.iter().map(|(column, _)| column.clone()).collect(),
                refused: std::mem::take(&mut refused),
                ..Header::none(None)
            };
            shared.hub.streams.begin(topic, NONE + 1, &stamped(header, at));
            shared.hub.announce();
            plan = Some(columns);
        }
        let columns = plan.iter().flatten();
        let cells = columns.map(|(column, origin)| origin.cell(column, &snapshot));
        rows.rows.push(Row {
            at: micros(at),
            cells: cells.collect(),
        });
        let now = Instant::now();
        if now.saturating_duration_since(pushed) >= BLOCK {
            pushed = now;
            shared.hub.streams.push(topic, &std::mem::take(&mut rows), now);
            shared.hub.announce();
        }
        let end = network.now() + AGAIN;
        monitor
            .pause(&mut network, end)
            .await
            .map_err(|error| explained(&error).message)?;
    }
    Ok(())
}

/// What of a snapshot a column has.
#[derive(Debug, Clone, Copy)]
enum Origin {
    Control,
    Status,
    SpeedSet,
    Speed,
    Position,
    /// The place among the further readings.
    Parameter(usize),
}

impl Origin {
    fn reading(self, snapshot: &Snapshot) -> Option<&Reading> {
        match self {
            Self::Control | Self::Status => None,
            Self::SpeedSet => snapshot.speed_set.as_ref(),
            Self::Speed => snapshot.speed_actual.as_ref(),
            Self::Position => snapshot.position.as_ref(),
            Self::Parameter(place) => snapshot.readings.get(place)?.as_ref().ok(),
        }
    }

    fn cell(self, column: &ColumnFacts, snapshot: &Snapshot) -> u32 {
        let word = |word: Option<u16>| word.map_or(NO_WORD, u32::from);
        let reading = self.reading(snapshot);
        match (self, column.r#type) {
            (Self::Control, _) => word(snapshot.stw1),
            (Self::Status, _) => word(snapshot.zsw1),
            (_, "u32") => {
                let raw = reading.and_then(Reading::raw);
                word(raw.and_then(|raw| u16::try_from(raw & 0xFFFF).ok()))
            }
            (_, "i32") => integer(reading.and_then(Reading::raw)),
            _ => float(reading.and_then(Reading::number)),
        }
    }
}

/// Returns the columns of what was read first. A parameter that is no number is refused.
fn columns_of(
    snapshot: &Snapshot,
    wanted: &[(String, Selection)],
    refused: &mut Vec<(String, String)>,
) -> Vec<(ColumnFacts, Origin)> {
    let word = |name: &str, role, bits: &'static [Bit; 16]| ColumnFacts {
        name: name.to_owned(),
        role,
        unit: "",
        r#type: "u32",
        scale: 1.0,
        bits: Some(names(bits)),
        from: None,
    };
    let mut columns = Vec::new();
    if snapshot.stw1.is_some() {
        let bits = snapshot.profile.control_bits(snapshot.mode);
        columns.push((word("STW1", "control", bits), Origin::Control));
    }
    if snapshot.zsw1.is_some() {
        let bits = snapshot.profile.status_bits(snapshot.mode);
        columns.push((word("ZSW1", "status", bits), Origin::Status));
    }
    for (origin, name, role) in [
        (Origin::SpeedSet, "set speed", "speed_set"),
        (Origin::Speed, "speed", "speed"),
        (Origin::Position, "position", "position"),
    ] {
        if let Some(reading) = origin.reading(snapshot)
            && let Some(column) = column_of_reading(name, role, reading)
        {
            columns.push((column, origin));
        }
    }
    for (place, (name, _)) in wanted.iter().enumerate() {
        let reading = match snapshot.readings.get(place) {
            Some(Ok(reading)) => reading,
            Some(Err(refusal)) => {
                refused.push((name.clone(), refusal.to_string()));
                continue;
            }
            None => continue,
        };
        match column_of_reading(name, "", reading) {
            Some(column) => columns.push((column, Origin::Parameter(place))),
            None => refused.push((name.clone(), "its value is not a number".to_owned())),
        }
    }
    columns
}

fn column_of_reading(name: &str, role: &'static str, reading: &Reading) -> Option<ColumnFacts> {
    let is_word = reading.word.is_some() && reading.octets.len() == 2;
    let is_whole = reading.unit.is_empty()
        && reading.decimals == 0
        && reading.raw().is_some_and(|raw| i32::try_from(raw).is_ok());
    reading.number()?;
    Some(ColumnFacts {
        name: name.to_owned(),
        role,
        unit: reading.unit,
        r#type: match () {
            () if is_word => "u32",
            () if is_whole => "i32",
            () => "f32",
        },
        scale: 1.0,
        bits: is_word.then(Vec::new),
        from: Some(match reading.name {
            Some(name) => format!("{name} (p{})", reading.pnu),
            None => format!("p{}", reading.pnu),
        }),
    })
}
