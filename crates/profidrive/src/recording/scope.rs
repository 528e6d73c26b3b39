//! What of a recording is drawn: bounded, however long it lasts.

use super::table::{Kind, Row, Table};

/// Points of a curve at most; when there are more, neighbours become one with the lowest and the highest value.
const MOST_POINTS: usize = 4000;

/// Collects the curves of a recording. Its memory is bounded: long recordings are drawn coarser, with every peak.
#[derive(Debug, Clone)]
pub struct Scope {
    /// What is drawn, by drive and signal.
    pub curves: Vec<Curve>,
    columns: usize,
}

/// A signal of a drive.
#[derive(Debug, Clone)]
pub struct Curve {
    /// `akd-1 NIST_A`
    pub name: String,
    /// Unit of its values, empty for none.
    pub unit: String,
    /// It is a word of bits.
    pub is_word: bool,
    /// In the order of time.
    pub points: Vec<Point>,
    /// Rows in one point.
    share: u32,
    /// Rows in the last point.
    filled: u32,
}

/// Some rows of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Time of the first one, s.
    pub time: f64,
    /// Lowest value; NaN in a gap.
    pub low: f64,
    /// Highest value; NaN in a gap.
    pub high: f64,
}

impl Point {
    fn is_gap(&self) -> bool {
        self.low.is_nan()
    }
}

impl Scope {
    /// For the signals of a recording.
    #[must_use]
    pub fn new(table: &Table) -> Self {
        let curve = |drive: &str, column: &super::table::Column| Curve {
            name: format!("{drive} {}", column.name),
            unit: column.unit.clone(),
            is_word: column.kind == Kind::Word,
            points: Vec::new(),
            share: 1,
            filled: 0,
        };
        let of = |drive: &String| -> Vec<Curve> {
            table.columns.iter().map(|column| curve(drive, column)).collect()
        };
        Self {
            curves: table.drives.iter().flat_map(of).collect(),
            columns: table.columns.len(),
        }
    }

    /// Adds a row.
    pub fn push(&mut self, row: &Row) {
        let first = row.drive * self.columns;
        let curves = self.curves.iter_mut().skip(first).take(self.columns);
        for (curve, value) in curves.zip(&row.values) {
            let value = value.map_or(f64::NAN, super::table::Value::number);
            curve.push(row.time.as_secs_f64(), value);
        }
    }
}

impl Curve {
    fn push(&mut self, time: f64, value: f64) {
        let joins = self.filled < self.share
            && self
                .points
                .last()
                .is_some_and(|last| !last.is_gap() && !value.is_nan());
        match self.points.last_mut().filter(|_| joins) {
            Some(last) => {
                last.low = last.low.min(value);
                last.high = last.high.max(value);
                self.filled += 1;
            }
            None => {
                self.points.push(Point {
                    time,
                    low: value,
                    high: value,
                });
                self.filled = 1;
            }
        }
        if self.points.len() >= MOST_POINTS {
            self.thin();
        }
    }

    /// Makes one point of two neighbours. A gap stays, as far as two of them are not beside each other.
    fn thin(&mut self) {
        let pairs = self.points.chunks(2);
        self.points = pairs
            .filter_map(|pair| match *pair {
                [one, other] if one.is_gap() || other.is_gap() => {
                    Some(if one.is_gap() { one } else { other })
                }
                [one, other] => Some(Point {
                    time: one.time,
                    low: one.low.min(other.low),
                    high: one.high.max(other.high),
                }),
                [one] => Some(one),
                _ => None,
            })
            .collect();
        self.share = self.share.saturating_mul(2);
        self.filled = self.share;
    }

    /// Returns the pieces between gaps, as lines through the lowest and highest values.
    #[must_use]
    pub fn pieces(&self) -> Vec<Vec<(f64, f64)>> {
        let mut pieces = vec![Vec::new()];
        for point in &self.points {
            if point.is_gap() {
                pieces.push(Vec::new());
            } else if let Some(piece) = pieces.last_mut() {
                piece.push((point.time, point.low));
                if point.high > point.low {
                    piece.push((point.time, point.high));
                }
            }
        }
        pieces.retain(|piece| !piece.is_empty());
        pieces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(values: impl Iterator<Item = f64>) -> Curve {
        let mut curve = Curve {
            name: String::new(),
            unit: String::new(),
            is_word: false,
            points: Vec::new(),
            share: 1,
            filled: 0,
        };
        for (at, value) in values.enumerate() {
            curve.push(at as f64, value);
        }
        curve
    }

    #[test]
    fn a_long_curve_keeps_its_peaks_in_bounded_memory() {
        let curve = curve((0..1_000_000).map(|at| if at == 777_777 { 99.0 } else { (at % 10) as f64 }));
        assert!(curve.points.len() < MOST_POINTS);
        assert!(curve.points.iter().any(|point| point.high == 99.0));
        assert!(
            curve
                .points
                .iter()
                .all(|point| point.low == 0.0 || point.high == 99.0)
        );
    }

    #[test]
    fn a_gap_interrupts_the_line() {
        let curve = curve([1.0, 2.0, f64::NAN, 3.0].into_iter());
        assert_eq!(curve.pieces(), [vec![(0.0, 1.0), (1.0, 2.0)], vec![(3.0, 3.0)]]);
    }
}
