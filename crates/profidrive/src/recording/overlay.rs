//! Steps that were recorded before, to compare with.

use std::io;
use std::path::Path;

use client::axis::SpeedUnit;
use client::{Advice, ErrorKind};
use profile::notation::figures;

use super::file::Form;
use super::scope::{Curve, Scope};
use super::table::{Column, Kind, Row, Table, Value};
use crate::explained::Explained;
use crate::motion::{Response, Step, StepPoint, step_in};

/// Lines of a file with an earlier step at most.
pub const MOST_LINES: usize = 1_000_000;
/// Octets of such a file at most.
const MOST_OCTETS: u64 = 256_000_000;
/// How far the speeds of two steps may differ, as a share of the step: setpoints are rounded.
const SAME: f64 = 0.01;

/// A step that was recorded before.
#[derive(Debug, Clone, PartialEq)]
pub struct EarlierStep {
    file: String,
    unit: String,
    points: Vec<StepPoint>,
    /// Index of the first point of the step, and the speed before it.
    step: (usize, f64),
}

/// Why a file is not a step to compare with.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OverlayError {
    /// The end of its name means another form.
    #[error("{file}: a step to compare with is read from CSV files only")]
    NotCsv {
        /// The file.
        file: String,
    },
    /// It is not CSV, or cannot be read.
    #[error("cannot read {file}: {error}")]
    File {
        /// The file.
        file: String,
        /// Why.
        error: csv::Error,
    },
    /// Something that a step has is missing.
    #[error("{file} is not a recorded step: {what}")]
    NoStep {
        /// The file.
        file: String,
        /// What is missing.
        what: &'static str,
    },
    /// It is too long to be one.
    #[error("{file} has more than {MOST_LINES} lines or {MOST_OCTETS} bytes")]
    TooLong {
        /// The file.
        file: String,
    },
    /// It is another step.
    #[error("{file} has a step {theirs}, this one is {this}")]
    OtherStep {
        /// The file.
        file: String,
        /// Its step: `from 0 to 300 rpm`.
        theirs: String,
        /// The present one.
        this: String,
    },
}

impl Explained for OverlayError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotCsv { .. } | Self::OtherStep { .. } => ErrorKind::Usage,
            _ => ErrorKind::Local,
        }
    }

    fn advice(&self) -> Advice {
        match self {
            Self::OtherStep { .. } => "compare steps with the same speeds".into(),
            _ => "record a step to a CSV file".into(),
        }
    }
}

impl EarlierStep {
    /// Reads a step from a CSV file that a recording has written: its commanded speed and speed.
    ///
    /// # Errors
    /// When the file is not CSV, cannot be read, or has no step.
    pub fn read(path: &Path) -> Result<Self, OverlayError> {
        let file = path.display().to_string();
        if Form::of(path).is_some_and(|form| form != Form::Csv) {
            return Err(OverlayError::NotCsv { file });
        }
        let opened = std::fs::File::open(path).and_then(|open| Ok((open.metadata()?.len(), open)));
        match opened {
            Ok((octets, _)) if octets > MOST_OCTETS => Err(OverlayError::TooLong { file }),
            Ok((_, open)) => Self::parse(file, open),
            Err(error) => Err(OverlayError::File {
                file,
                error: error.into(),
            }),
        }
    }

    /// Reads a step from the content of such a file; `file` is its name in errors.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(file: impl Into<String>, content: impl io::Read) -> Result<Self, OverlayError> {
        let file = file.into();
        let failed = |error| OverlayError::File {
            file: file.clone(),
            error,
        };
        let none = |what| OverlayError::NoStep {
            file: file.clone(),
            what,
        };
        // a device without an end is no file of so many octets
        let mut reader = csv::Reader::from_reader(io::Read::take(content, MOST_OCTETS));
        let head = reader.headers().map_err(failed)?.clone();
        let find = |name: &str| {
            let is = |column: &str| column == name || column.starts_with(&format!("{name} ["));
            head.iter().position(is)
        };
        let place = find("t").zip(find("NSOLL_A")).zip(find("NIST_A"));
        let Some(((time, set), actual)) = place else {
            return Err(none("the columns t, NSOLL_A and NIST_A are needed"));
        };
        let drive = find("drive");
        let unit = head.get(set).and_then(|name| name.split_once('['));
        let unit = unit.map_or("", |(_, unit)| unit.trim_end_matches(']')).to_owned();
        let mut points = Vec::new();
        let mut of: Option<String> = None;
        for (at, line) in reader.records().enumerate() {
            let line = line.map_err(failed)?;
            if at >= MOST_LINES {
                return Err(OverlayError::TooLong { file });
            }
            let named = drive.and_then(|drive| line.get(drive)).unwrap_or_default();
            if of.get_or_insert_with(|| named.to_owned()) != named {
                return Err(none("it has several drives"));
            }
            let number = |at: usize| {
                let number = line.get(at)?.parse::<f64>().ok();
                number.filter(|number| number.is_finite())
            };
            // a gap has no numbers
            if let (Some(time), Some(set), Some(actual)) = (number(time), number(set), number(actual)) {
                points.push(StepPoint { time, set, actual });
            }
        }
        let at = step_in(&points);
        let from = at.and_then(|at| points.get(at.checked_sub(1)?));
        let Some(step) = at.zip(from.map(|point| point.set)) else {
            return Err(none("the commanded speed does not change"));
        };
        Ok(Self {
            file,
            unit,
            points,
            step,
        })
    }

    /// Commanded speed and speed.
    #[must_use]
    pub fn points(&self) -> &[StepPoint] {
        &self.points
    }

    /// Checks that this is the same step: the same speeds in the same unit.
    ///
    /// # Errors
    /// [`OverlayError::OtherStep`].
    pub fn check_same(&self, step: &Step) -> Result<(), OverlayError> {
        let (from, to) = (self.step.1, self.points.last().map_or(0.0, |point| point.set));
        let unit = step.run.unit.symbol();
        let near = match step.run.unit {
            SpeedUnit::Rpm => 0.1,
            SpeedUnit::Percent => 0.01,
        };
        let room = near + (step.run.speed - step.from).abs() * SAME;
        let same = (from - step.from).abs() <= room && (to - step.run.speed).abs() <= room;
        if same && self.unit == unit {
            return Ok(());
        }
        // setpoints are rounded: no more figures than a person gave
        let short = |speed: f64| match speed.abs() {
            100.0.. => figures(speed.round()),
            _ => figures((speed * 10.0).round() / 10.0),
        };
        let words = |from, to, unit: &str| format!("from {} to {} {unit}", short(from), short(to));
        Err(OverlayError::OtherStep {
            file: self.file.clone(),
            theirs: words(from, to, &self.unit),
            this: words(step.from, step.run.speed, unit),
        })
    }

    /// Returns its figures.
    #[must_use]
    pub fn response(&self, band: f64) -> Option<Response> {
        let (at, from) = self.step;
        let after = self.points.get(at..)?;
        Response::of(after, from, after.first()?.set, band)
    }
}

/// Returns the curves of steps, one over the other: time 0 is the step.
#[must_use]
pub fn overlay(steps: &[(&str, &[StepPoint])], unit: &str) -> Scope {
    let column = |name: &str| Column {
        name: name.to_owned(),
        kind: Kind::Number,
        unit: unit.to_owned(),
        parameter: String::new(),
        scaling: String::new(),
    };
    let table = Table {
        drives: steps.iter().map(|(name, _)| (*name).to_owned()).collect(),
        columns: vec![column("commanded speed"), column("speed")],
        facts: Vec::new(),
    };
    let mut scope = Scope::new(&table);
    for (drive, (_, points)) in steps.iter().enumerate() {
        for point in *points {
            scope.push(&Row {
                time: std::time::Duration::try_from_secs_f64(point.time).unwrap_or_default(),
                wall: None,
                drive,
                gap: false,
                values: vec![Some(Value::Number(point.set)), Some(Value::Number(point.actual))],
            });
        }
        let zero = step_in(points)
            .and_then(|at| points.get(at))
            .map_or(0.0, |point| point.time);
        let own = scope.curves.iter_mut().skip(drive * 2).take(2);
        own.for_each(|curve| curve.shift(-zero));
    }
    scope
}

impl Curve {
    /// Moves the curve in time.
    fn shift(&mut self, by: f64) {
        for point in &mut self.points {
            point.time += by;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn any_octets_are_a_step_or_an_error(octets in proptest::collection::vec(any::<u8>(), 0..200)) {
            let _ = EarlierStep::parse("a.csv", octets.as_slice());
        }

        /// Any numbers behind a head: what is read has a step of finite numbers.
        #[test]
        fn any_numbers_are_a_step_or_an_error(
            rows in proptest::collection::vec((any::<f64>(), any::<f64>(), any::<f64>()), 0..20)
        ) {
            let mut text = "t,NSOLL_A [rpm],NIST_A [rpm]\n".to_owned();
            for (time, set, actual) in &rows {
                text += &format!("{time},{set},{actual}\n");
            }
            if let Ok(step) = EarlierStep::parse("a.csv", text.as_bytes()) {
                let finite = |point: &StepPoint| point.set.is_finite() && point.actual.is_finite();
                prop_assert!(step.points().iter().all(finite));
                let _ = step.response(0.02);
            }
        }
    }

    #[test]
    fn several_drives_are_not_one_step() {
        let text = "t,drive,NSOLL_A,NIST_A\n0,a,0,0\n1,b,5,5\n";
        let error = EarlierStep::parse("a.csv", text.as_bytes()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a.csv is not a recorded step: it has several drives"
        );
    }
}
