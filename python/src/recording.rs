//! Signals of drives, recorded for some time.

use std::path::PathBuf;

use client::Session;
use profidrive::fleet::Selected;
use profidrive::recording::{Batch, News, Request, Row, Scope, Table as Columns, prepare, svg};
use profidrive::{Explained as _, WallClock};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::errors::{Failure, explained, of_client};
use crate::table::{Table, write};
use crate::time::seconds;

/// What was recorded.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Recording {
    columns: Columns,
    rows: Vec<Row>,
    batch: arrow_array::RecordBatch,
    /// What was recorded of each drive, and why it ended early.
    drives: Value,
}

/// Records until the time of the request is over; with `most` rows it ends before.
pub async fn record(
    session: &Session,
    clock: WallClock,
    members: Vec<Selected>,
    request: &Request,
    most: usize,
) -> Result<Recording, Failure> {
    request.check().map_err(|error| explained(&error))?;
    let mut sources = Vec::new();
    for member in prepare(session, members, request).await {
        let source = member.result;
        sources.push(source.map_err(|error| explained(&error).about(&member.name))?);
    }
    let recording = profidrive::recording::Recording::begin(session, clock, sources, request);
    let mut recording = recording.map_err(|error| explained(&error))?;
    let columns = recording.table().clone();
    let mut batch = Batch::new(&columns);
    let mut rows = Vec::new();
    let mut ended = vec![None; columns.drives.len()];
    while let Some(news) = recording.next().await.map_err(|error| of_client(&error))? {
        match news {
            News::Row(row) if rows.len() < most => {
                batch.push(&row);
                rows.push(row);
                if rows.len() == most {
                    recording.stop();
                }
            }
            News::Ended { drive, error } => {
                if let Some(why) = ended.get_mut(drive) {
                    *why = Some(error.message());
                }
            }
            _ => {}
        }
    }
    let drives = columns.drives.iter().zip(recording.counts()).zip(ended);
    let drives = drives.map(|((name, counts), why)| {
        json!({
            "drive": name,
            "rows": counts.rows,
            "gaps": counts.gaps,
            "missed": counts.missed,
            "outages": counts.outages,
            "outage_time": seconds(counts.outage_time),
            "ended": why,
        })
    });
    Ok(Recording {
        drives: drives.collect(),
        batch: batch.take().map_err(|error| Failure::internal(&error))?,
        columns,
        rows,
    })
}

#[pymethods]
impl Recording {
    fn table(&self) -> Table {
        Table::new(self.batch.clone())
    }

    /// What was recorded of each drive; JSON.
    fn drives(&self) -> String {
        self.drives.to_string()
    }

    /// Writes the rows to a file; the end of its name decides the form.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        Ok(py.detach(|| write(&self.columns, &self.rows, &path))?)
    }

    /// Draws the rows (SVG).
    fn picture(&self, py: Python<'_>, title: &str) -> PyResult<String> {
        let picture = py.detach(|| {
            let mut scope = Scope::new(&self.columns);
            for row in &self.rows {
                scope.push(row);
            }
            svg(title, &scope, &[])
        });
        Ok(picture.map_err(|error| explained(&error))?)
    }
}
