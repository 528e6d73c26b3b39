//! Samples of an axis as rows, the same as those of a recording.

use std::time::Duration;

use client::axis::{AxisSignal, Sample};
use profinet::Instant;

use super::cyclic::{Last, missing, value_of};
use super::source::column_of;
use super::table::{Row, Table};
use crate::clock::WallClock;

/// Returns the samples of an axis as a recording: a row each, and one for each cycle that is missing. `now` is the present
/// time of the network whose clock this is.
#[must_use]
pub fn of_samples(
    drive: &str,
    signals: &[AxisSignal],
    samples: &[Sample],
    cycle: Duration,
    (clock, now): (WallClock, Instant),
) -> (Table, Vec<Row>) {
    let table = Table {
        drives: vec![drive.to_owned()],
        columns: signals.iter().map(column_of).collect(),
    };
    let start = samples.first().map_or(Instant::ZERO, |sample| sample.at);
    let row = |at: Instant, gap, values| Row {
        time: at.saturating_since(start),
        wall: clock.before(now.saturating_since(at)),
        drive: 0,
        gap,
        values,
    };
    let mut last: Last = None;
    let mut rows = Vec::new();
    for sample in samples {
        if let Some((at, ..)) = last {
            for lost in 0..missing(&last, sample).min(1000) {
                let after = cycle * u32::try_from(lost + 1).unwrap_or(u32::MAX);
                rows.push(row(at + after, true, vec![None; signals.len()]));
            }
        }
        last = Some((sample.at, sample.number, sample.missed));
        let values = signals.iter().zip(&table.columns);
        let values = values.map(|(signal, column)| value_of(signal, sample, column.kind));
        rows.push(row(sample.at, false, values.collect()));
    }
    (table, rows)
}
