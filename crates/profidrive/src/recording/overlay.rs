//! Steps that were recorded before, to compare with.

use std::path::Path;

use super::scope::{Curve, Scope};
use super::table::{Column, Kind, Row, Table, Value};
use crate::motion::{Response, StepPoint, step_in};

/// Lines of a file with an earlier step at most.
const MOST_LINES: usize = 1_000_000;

/// Why a file is no step to compare with.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OverlayError {
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
}

impl OverlayError {
    /// What kind of error it is.
    #[must_use]
    pub const fn kind(&self) -> client::ErrorKind {
        client::ErrorKind::Local
    }
}

/// Reads a step from a CSV file that a recording has written: its commanded speed and speed.
///
/// # Errors
/// When the file cannot be read, or has no step.
pub fn read_step(path: &Path) -> Result<Vec<StepPoint>, OverlayError> {
    let file = path.display().to_string();
    let failed = |error| OverlayError::File {
        file: file.clone(),
        error,
    };
    let none = |what| OverlayError::NoStep {
        file: file.clone(),
        what,
    };
    let mut reader = csv::Reader::from_path(path).map_err(failed)?;
    let head = reader.headers().map_err(failed)?.clone();
    let find = |name: &str| {
        let is = |column: &str| column == name || column.starts_with(&format!("{name} ["));
        head.iter().position(is)
    };
    let place = find("t").zip(find("NSOLL_A")).zip(find("NIST_A"));
    let Some(((time, set), actual)) = place else {
        return Err(none("the columns t, NSOLL_A and NIST_A are needed"));
    };
    let mut points = Vec::new();
    for line in reader.records().take(MOST_LINES) {
        let line = line.map_err(failed)?;
        let number = |at: usize| {
            line.get(at)?
                .parse::<f64>()
                .ok()
                .filter(|number| number.is_finite())
        };
        // a gap has no numbers
        if let (Some(time), Some(set), Some(actual)) = (number(time), number(set), number(actual)) {
            points.push(StepPoint { time, set, actual });
        }
    }
    if step_in(&points).is_none() {
        return Err(none("the commanded speed does not change"));
    }
    Ok(points)
}

/// Returns the figures of a step that was read.
#[must_use]
pub fn response_of(points: &[StepPoint], band: f64) -> Option<Response> {
    let step = step_in(points)?;
    let from = points.get(step.checked_sub(1)?)?.set;
    let after = points.get(step..)?;
    Response::of(after, from, after.first()?.set, band)
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
