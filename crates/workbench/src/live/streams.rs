//! The samples of drives for all pages: the last blocks of each stream, encoded once.
//!
//! A page that reads slowly finds that the oldest blocks are gone; the next one that it gets reports how many rows that were.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::Utf8Bytes;
use serde::Serialize;

use super::block::{Facts, Rows, encode, with_more_lost};
use super::hub::Topic;

/// Blocks are kept for this time, and up to this many octets of a stream.
const KEPT: Duration = Duration::from_secs(2);
const OCTETS: usize = 2 << 20;

/// What precedes the blocks of a stream.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Header {
    /// Where the values come from: `cyclic`, `acyclic` or `none`.
    pub source: &'static str,
    /// Why there are no values.
    pub reason: Option<String>,
    /// Nominal time between two rows, us.
    pub period_us: u32,
    /// The telegram of the connection.
    pub telegram: Option<u16>,
    pub simulation: bool,
    /// Engine time, us, and the time of day at that moment, ms since 1970.
    pub t_us: u64,
    pub unix_ms: u64,
    pub columns: Vec<ColumnFacts>,
    /// Parameters that are not read, each with its reason.
    pub refused: Vec<(String, String)>,
}

impl Header {
    /// A stream without values.
    pub fn none(reason: Option<String>) -> Self {
        Self {
            source: "none",
            reason,
            period_us: 0,
            telegram: None,
            simulation: false,
            t_us: 0,
            unix_ms: 0,
            columns: Vec::new(),
            refused: Vec::new(),
        }
    }
}

/// What a column has.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct ColumnFacts {
    pub name: String,
    /// What it is, by people: `speed`, `speed_set`, `position`, `control`, `status`; empty for the rest.
    pub role: &'static str,
    pub unit: &'static str,
    /// `f32`, `i32` or `u32`.
    pub r#type: &'static str,
    /// A number of the column times this is the value in its unit.
    pub scale: f64,
    /// The names of the bits of a word, bit 0 first.
    pub bits: Option<Vec<&'static str>>,
    /// The parameter that it is read from.
    pub from: Option<String>,
}

#[derive(Serialize)]
struct Opened<'s> {
    r#type: &'static str,
    topic: &'s str,
    id: u16,
    #[serde(flatten)]
    header: &'s Header,
}

#[derive(Debug)]
struct Kept {
    at: Instant,
    octets: Bytes,
    /// Rows, with those that are lost, before this block.
    before: u64,
}

#[derive(Debug)]
struct Stream {
    facts: Facts,
    /// Which source it is of; for its producer.
    source: u64,
    header: Utf8Bytes,
    blocks: VecDeque<Kept>,
    /// The number of the first block that is kept.
    first: u64,
    octets: usize,
    /// Rows so far, with those that are lost.
    rows: u64,
}

/// How far a page is in a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Place {
    stream: Option<u16>,
    next: u64,
    rows: u64,
}

/// What a page gets next.
#[derive(Debug)]
pub(crate) enum Next {
    Header(Utf8Bytes),
    Block(Bytes),
}

/// The streams that pages want.
#[derive(Debug, Default)]
pub(crate) struct Streams(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    streams: BTreeMap<Topic, Stream>,
    last: u16,
}

impl Streams {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a stream of this source in place of what the topic had.
    pub fn begin(&self, topic: &Topic, source: u64, header: &Header) {
        let mut state = self.state();
        state.last = state.last.wrapping_add(1);
        let id = state.last;
        let opened = Opened {
            r#type: "stream",
            topic: &topic.name(),
            id,
            header,
        };
        let stream = Stream {
            facts: Facts {
                stream: id,
                #[expect(clippy::cast_precision_loss, reason = "a nominal period")]
                period_us: header.period_us as f32,
                columns: u16::try_from(header.columns.len()).unwrap_or(u16::MAX),
                simulation: header.simulation,
            },
            source,
            header: serde_json::to_string(&opened).unwrap_or_default().into(),
            blocks: VecDeque::new(),
            first: 0,
            octets: 0,
            rows: 0,
        };
        state.streams.insert(topic.clone(), stream);
    }

    /// Returns the source of a stream.
    pub fn source(&self, topic: &Topic) -> Option<u64> {
        self.state().streams.get(topic).map(|stream| stream.source)
    }

    /// Adds rows to a stream.
    pub(super) fn push(&self, topic: &Topic, rows: &Rows, now: Instant) {
        let mut state = self.state();
        let Some(stream) = state.streams.get_mut(topic) else {
            return;
        };
        let number = stream.first + stream.blocks.len() as u64;
        // numbers of 32 bits begin again after years
        let octets = encode(stream.facts, (number & 0xFFFF_FFFF) as u32, rows);
        stream.octets += octets.len();
        stream.blocks.push_back(Kept {
            at: now,
            octets: octets.into(),
            before: stream.rows,
        });
        stream.rows += rows.rows.len() as u64 + u64::from(rows.lost);
        while let Some(oldest) = stream.blocks.front()
            && stream.blocks.len() > 1
            && (stream.octets > OCTETS || now.saturating_duration_since(oldest.at) > KEPT)
        {
            stream.octets -= oldest.octets.len();
            stream.blocks.pop_front();
            stream.first += 1;
        }
    }

    /// Removes the streams that no page wants.
    pub fn keep(&self, wanted: impl Fn(&Topic) -> bool) {
        self.state().streams.retain(|topic, _| wanted(topic));
    }

    /// Returns what a page gets next of a topic, and moves its place.
    pub fn next(&self, topic: &Topic, place: &mut Place) -> Option<Next> {
        let state = self.state();
        let stream = state.streams.get(topic)?;
        if place.stream != Some(stream.facts.stream) {
            // a page begins with what comes from now on
            *place = Place {
                stream: Some(stream.facts.stream),
                next: stream.first + stream.blocks.len() as u64,
                rows: stream.rows,
            };
            return Some(Next::Header(stream.header.clone()));
        }
        let gone = stream.first.saturating_sub(place.next);
        let at = place.next.max(stream.first);
        let block = stream.blocks.get(usize::try_from(at - stream.first).ok()?)?;
        let missed = block.before.saturating_sub(place.rows);
        *place = Place {
            stream: place.stream,
            next: at + 1,
            rows: stream
                .blocks
                .get(usize::try_from(at + 1 - stream.first).ok()?)
                .map_or(stream.rows, |next| next.before),
        };
        Some(Next::Block(if gone == 0 {
            block.octets.clone()
        } else {
            let missed = u32::try_from(missed).unwrap_or(u32::MAX);
            with_more_lost(&block.octets, missed).into()
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::block::Row;
    use super::*;

    fn rows(count: usize, lost: u32) -> Rows {
        let row = |at| Row {
            at,
            cells: vec![0; 4],
        };
        Rows {
            lost,
            gap: lost > 0,
            bad: false,
            rows: (0..count as u64).map(row).collect(),
        }
    }

    fn header() -> Header {
        let column = ColumnFacts {
            name: "NIST_A".to_owned(),
            role: "speed",
            unit: "rpm",
            r#type: "f32",
            scale: 1.0,
            bits: None,
            from: None,
        };
        Header {
            source: "cyclic",
            columns: vec![column; 4],
            ..Header::none(None)
        }
    }

    /// Number and loss of the next block.
    fn block(streams: &Streams, topic: &Topic, place: &mut Place) -> Option<(u32, u32)> {
        match streams.next(topic, place)? {
            Next::Header(text) => panic!("{text}"),
            Next::Block(octets) => {
                let word = |at: usize| u32::from_le_bytes(octets[at..at + 4].try_into().unwrap());
                Some((word(4), word(24)))
            }
        }
    }

    #[test]
    fn a_slow_page_misses_the_oldest_blocks_and_the_next_one_reports_them() {
        let streams = Streams::default();
        let topic = Topic::named("drive/x/samples", Vec::new()).unwrap();
        let begin = Instant::now();
        assert!(streams.next(&topic, &mut Place::default()).is_none());
        streams.begin(&topic, 1, &header());
        let (mut fast, mut slow) = (Place::default(), Place::default());
        for place in [&mut fast, &mut slow] {
            assert!(matches!(streams.next(&topic, place), Some(Next::Header(_))));
            assert!(streams.next(&topic, place).is_none());
        }
        for number in 0..100_u32 {
            let now = begin + Duration::from_millis(33) * number;
            streams.push(&topic, &rows(8, u32::from(number == 3)), now);
            assert_eq!(
                block(&streams, &topic, &mut fast),
                Some((number, u32::from(number == 3)))
            );
        }
        // 60 blocks are of the last two seconds, and one row was lost before that
        assert_eq!(block(&streams, &topic, &mut slow), Some((39, 39 * 8 + 1)));
        assert_eq!(block(&streams, &topic, &mut slow), Some((40, 0)));
        streams.begin(&topic, 2, &header());
        assert!(matches!(streams.next(&topic, &mut slow), Some(Next::Header(_))));
        assert!(streams.next(&topic, &mut slow).is_none());
    }

    #[test]
    fn a_stream_keeps_a_bounded_number_of_octets_whatever_its_rate() {
        let streams = Streams::default();
        let topic = Topic::named("drive/x/samples", Vec::new()).unwrap();
        let now = Instant::now();
        streams.begin(&topic, 1, &header());
        for _ in 0..200 {
            streams.push(&topic, &rows(1000, 0), now);
        }
        let octets = streams.state().streams[&topic].octets;
        assert!(octets <= OCTETS && octets > OCTETS / 2, "{octets}");
        streams.keep(|_| false);
        assert!(streams.next(&topic, &mut Place::default()).is_none());
    }
}
