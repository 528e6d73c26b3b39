//! Rows of samples as they travel to a page: the layout of version 1, little endian.
//!
//! ```text
//! off size field                                     off size field
//!  0   u8  kind = 1                                  20  u16 rows n
//!  1   u8  version = 1                               22  u16 columns m
//!  2   u16 stream                                    24  u32 rows lost since the block before
//!  4   u32 number of the block                       28  u16 flags: 1 offsets, 2 gap before row 0, 4 IOPS BAD, 8 simulation
//!  8   u64 engine time of row 0, us                  30  u16 0
//! 16   f32 nominal period, us                        32  u32 x n offsets from row 0 in us, with flag 1
//!                                                    ..  m columns of n x 4 octets
//! ```
//!
//! A value of 4 octets is an `f32`, `i32` or `u32` as its column says; [`NO_FLOAT`], [`NO_INTEGER`] or [`NO_WORD`] where it is missing.
//! `golden.json` has blocks that this file writes and the page reads.

/// A value that is missing in a column of `f32`: not a number.
pub(super) const NO_FLOAT: u32 = 0x7FC0_0000;
/// The same for `i32`: the lowest number.
pub(super) const NO_INTEGER: u32 = 0x8000_0000;
/// The same for `u32`: no word of 16 bits has this value.
pub(super) const NO_WORD: u32 = u32::MAX;

/// Octets before the rows.
const HEAD: usize = 32;
/// Rows of a block, at most: with 64 columns it is below 1 MiB.
pub(super) const MOST_ROWS: usize = 4000;

const OFFSETS: u16 = 1;
const GAP: u16 = 2;
const BAD: u16 = 4;
const SIMULATION: u16 = 8;

/// The values of one moment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Row {
    /// Engine time, us.
    pub at: u64,
    /// One for each column: the octets of its value.
    pub cells: Vec<u32>,
}

/// Rows without a gap between them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Rows {
    /// Rows that are missing before the first.
    pub lost: u32,
    /// Whether there is a gap before the first, however many rows are missing in it.
    pub gap: bool,
    /// Whether the drive marked its data in all of them as not valid (IOPS BAD): its values are missing.
    pub bad: bool,
    pub rows: Vec<Row>,
}

/// What is the same for each block of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Facts {
    pub stream: u16,
    pub period_us: f32,
    pub columns: u16,
    pub simulation: bool,
}

/// Encodes a block. Rows whose number of cells is another one, and rows beyond [`MOST_ROWS`], are an error of the caller: they are
/// left out.
pub(super) fn encode(facts: Facts, number: u32, block: &Rows) -> Vec<u8> {
    let columns = usize::from(facts.columns);
    let fits = |row: &&Row| row.cells.len() == columns;
    let rows: Vec<&Row> = block.rows.iter().filter(fits).take(MOST_ROWS).collect();
    let first = rows.first().map_or(0, |row| row.at);
    let offset = |row: &&Row| u32::try_from(row.at.saturating_sub(first)).unwrap_or(u32::MAX);
    let offsets: Vec<u32> = rows.iter().map(offset).collect();
    let mut flags = 0;
    if !are_regular(&offsets, facts.period_us) {
        flags |= OFFSETS;
    }
    if block.gap || block.lost > 0 {
        flags |= GAP;
    }
    if block.bad {
        flags |= BAD;
    }
    if facts.simulation {
        flags |= SIMULATION;
    }
    let mut out = Vec::with_capacity(HEAD + 4 * rows.len() * (columns + 1));
    out.extend_from_slice(&[1, 1]);
    out.extend_from_slice(&facts.stream.to_le_bytes());
    out.extend_from_slice(&number.to_le_bytes());
    out.extend_from_slice(&first.to_le_bytes());
    out.extend_from_slice(&facts.period_us.to_le_bytes());
    out.extend_from_slice(&u16::try_from(rows.len()).unwrap_or(u16::MAX).to_le_bytes());
    out.extend_from_slice(&facts.columns.to_le_bytes());
    out.extend_from_slice(&block.lost.to_le_bytes());
    out.extend_from_slice(&flags.to_le_bytes());
    out.extend_from_slice(&[0, 0]);
    if flags & OFFSETS != 0 {
        for offset in offsets {
            out.extend_from_slice(&offset.to_le_bytes());
        }
    }
    for column in 0..columns {
        for row in &rows {
            out.extend_from_slice(&row.cells.get(column).copied().unwrap_or_default().to_le_bytes());
        }
    }
    out
}

/// Returns whether each row has the time that follows from its place.
#[expect(clippy::cast_precision_loss, reason = "offsets of a block are far below 2^52")]
fn are_regular(offsets: &[u32], period: f32) -> bool {
    let due = |place: usize| place as f64 * f64::from(period);
    let regular = |(place, offset): (usize, &u32)| (f64::from(*offset) - due(place)).abs() < 0.5;
    offsets.iter().enumerate().all(regular)
}

/// Returns a copy of a block that reports more rows as lost.
pub(super) fn with_more_lost(block: &[u8], more: u32) -> Vec<u8> {
    let mut copy = block.to_vec();
    if let Some(lost) = copy
        .get_mut(24..28)
        .and_then(|place| <&mut [u8; 4]>::try_from(place).ok())
    {
        *lost = u32::from_le_bytes(*lost).saturating_add(more).to_le_bytes();
    }
    if let Some(flags) = copy.get_mut(28) {
        *flags |= GAP.to_le_bytes()[0];
    }
    copy
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    /// The golden blocks: what they are called, and what they are encoded from.
    fn golden() -> Vec<(&'static str, Facts, u32, Rows)> {
        let facts = Facts {
            stream: 7,
            period_us: 4000.0,
            columns: 3,
            simulation: false,
        };
        let row = |at, speed: f32, position: i32, word: u32| Row {
            at,
            cells: vec![speed.to_bits(), u32::from_le_bytes(position.to_le_bytes()), word],
        };
        let regular = Rows {
            rows: vec![
                row(1_000_000, 0.0, 16_777_217, 0x0231),
                row(1_004_000, 19.75, -16_777_217, 0x0637),
                row(1_008_000, -0.5, i32::MAX, 0xFFFF),
            ],
            ..Rows::default()
        };
        let late = Rows {
            lost: 6,
            gap: true,
            bad: false,
            rows: vec![
                row(9_007_199_254, 1.0, 0, 0),
                Row {
                    at: 9_007_203_511,
                    cells: vec![NO_FLOAT, NO_INTEGER, NO_WORD],
                },
            ],
        };
        let invalid = Rows {
            bad: true,
            rows: vec![Row {
                at: 2_000_000,
                cells: vec![NO_FLOAT, NO_INTEGER, 0x047F],
            }],
            ..Rows::default()
        };
        let simulated = Facts {
            stream: 65_535,
            period_us: 1000.0,
            columns: 1,
            simulation: true,
        };
        let one = Rows {
            gap: true,
            rows: vec![Row {
                at: 0,
                cells: vec![0x3F80_0000],
            }],
            ..Rows::default()
        };
        vec![
            ("regular", facts, 0, regular),
            ("with offsets, loss and a missing value", facts, 41, late),
            ("one row of a simulation", simulated, u32::MAX, one),
            ("no row", facts, 1, Rows::default()),
            ("not valid", facts, 42, invalid),
        ]
    }

    #[test]
    fn golden_blocks_are_what_the_page_reads() {
        let blocks: Vec<Value> = golden()
            .iter()
            .map(|(name, facts, number, rows)| {
                let octets = encode(*facts, *number, rows);
                let hex: String = octets.iter().map(|octet| format!("{octet:02x}")).collect();
                let cells: Vec<&[u32]> = rows.rows.iter().map(|row| &row.cells[..]).collect();
                json!({
                    "name": name,
                    "stream": facts.stream,
                    "number": number,
                    "period": facts.period_us,
                    "columns": facts.columns,
                    "simulation": facts.simulation,
                    "lost": rows.lost,
                    "gap": rows.gap,
                    "bad": rows.bad,
                    "times": rows.rows.iter().map(|row| row.at).collect::<Vec<_>>(),
                    "cells": cells,
                    "hex": hex,
                })
            })
            .collect();
        let written = serde_json::to_string_pretty(&Value::Array(blocks)).unwrap() + "\n";
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/live/golden.json");
        if std::env::var_os("GOLDEN").is_some() {
            std::fs::write(path, &written).unwrap();
        }
        assert_eq!(std::fs::read_to_string(path).unwrap(), written);
    }

    #[test]
    fn a_block_that_follows_a_loss_reports_it() {
        let (_, facts, number, rows) = golden().swap_remove(1);
        let whole = encode(facts, number, &rows);
        let more = Rows {
            lost: rows.lost + 250,
            ..rows
        };
        assert_eq!(with_more_lost(&whole, 250), encode(facts, number, &more));
        assert_eq!(
            with_more_lost(&whole, u32::MAX)[24..28],
            u32::MAX.to_le_bytes(),
            "it does not overflow"
        );
    }

    #[test]
    fn rows_that_do_not_fit_are_left_out_and_a_block_is_bounded() {
        let facts = Facts {
            stream: 0,
            period_us: 1.0,
            columns: 64,
            simulation: false,
        };
        let mut rows = Rows::default();
        rows.rows.push(Row { at: 5, cells: vec![] });
        for at in 0..10_000 {
            rows.rows.push(Row {
                at,
                cells: vec![1; 64],
            });
        }
        let octets = encode(facts, 0, &rows);
        assert_eq!(octets.len(), HEAD + MOST_ROWS * 4 * 64);
        assert!(octets.len() < 1 << 20);
    }
}
