//! Signals of drives, recorded: for some time, or beside other calls until they are enough.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use client::Session;
use profidrive::fleet::Selected;
use profidrive::recording::{
    Batch, DriveCounts, News, Recording as Source, RecordingStop, Request, Row, Scope, Table as Columns,
    prepare, svg,
};
use profidrive::{Explained as _, WallClock};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::attention::LOOK;
use crate::errors::{Failure, explained, of_client};
use crate::joined::locked;
use crate::network::Place;
use crate::table::{Table, write};
use crate::time::seconds;

/// Virtual time between two looks whether a recording has ended.
const STRIDE: Duration = Duration::from_millis(10);

/// What is recorded. It may grow.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Recording {
    columns: Columns,
    grown: Arc<Mutex<Grown>>,
    stop: RecordingStop,
    place: Place,
}

/// What there is until now.
struct Grown {
    rows: Vec<Row>,
    counts: Vec<DriveCounts>,
    /// Why a drive is no longer recorded.
    ended: Vec<Option<String>>,
    is_over: bool,
    failure: Option<Failure>,
    /// The columns of so many rows.
    batch: Option<(usize, arrow_array::RecordBatch)>,
}

/// Gets ready to record; with `most` rows it ends before its time. What is returned beside the recording carries it out.
pub async fn record(
    place: Place,
    session: &Session,
    clock: WallClock,
    members: Vec<Selected>,
    request: &Request,
    most: usize,
) -> Result<(Recording, impl Future<Output = ()> + Send + use<>), Failure> {
    request.check().map_err(|error| explained(&error))?;
    let mut sources = Vec::new();
    for member in prepare(session, members, request).await {
        let source = member.result;
        sources.push(source.map_err(|error| explained(&error).about(&member.name))?);
    }
    let source = Source::begin(session, clock, sources, request);
    let source = source.map_err(|error| explained(&error))?;
    let columns = source.table().clone();
    let grown = Grown {
        rows: Vec::new(),
        counts: source.counts().to_vec(),
        ended: vec![None; columns.drives.len()],
        is_over: false,
        failure: None,
        batch: None,
    };
    let grown = Arc::new(Mutex::new(grown));
    let stop = source.stop_handle();
    let task = grow(source, Arc::clone(&grown), most);
    Ok((
        Recording {
            columns,
            grown,
            stop,
            place,
        },
        task,
    ))
}

async fn grow(mut source: Source, grown: Arc<Mutex<Grown>>, most: usize) {
    loop {
        let news = source.next().await;
        let mut grown = locked(&grown);
        match news {
            Ok(Some(News::Row(row))) if grown.rows.len() < most => {
                grown.rows.push(row);
                if grown.rows.len() == most {
                    source.stop();
                }
            }
            Ok(Some(News::Ended { drive, error })) => {
                if let Some(why) = grown.ended.get_mut(drive) {
                    *why = Some(error.message());
                }
            }
            Ok(Some(_)) => {}
            Ok(None) => grown.is_over = true,
            Err(error) => {
                grown.failure = Some(of_client(&error));
                grown.is_over = true;
            }
        }
        grown.counts.clear();
        grown.counts.extend_from_slice(source.counts());
        if grown.is_over {
            return;
        }
    }
}

impl Recording {
    /// Fails where it ended by an error of the network.
    pub fn check(&self) -> Result<(), Failure> {
        locked(&self.grown).failure.take().map_or(Ok(()), Err)
    }

    fn batch(&self) -> Result<arrow_array::RecordBatch, Failure> {
        let mut grown = locked(&self.grown);
        if let Some((rows, batch)) = &grown.batch
            && *rows == grown.rows.len()
        {
            return Ok(batch.clone());
        }
        let mut batch = Batch::new(&self.columns);
        for row in &grown.rows {
            batch.push(row);
        }
        let batch = batch.take().map_err(|error| Failure::internal(&error))?;
        grown.batch = Some((grown.rows.len(), batch.clone()));
        Ok(batch)
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        // nothing can look at it any more; a copy of the process records nothing
        if self.place.joined.usable().is_ok() {
            self.stop.stop_once();
        }
    }
}

#[pymethods]
impl Recording {
    /// The rows until now.
    fn table(&self, py: Python<'_>) -> PyResult<Table> {
        Ok(Table::new(py.detach(|| self.batch())?))
    }

    /// Whether it still grows.
    #[getter]
    fn grows(&self) -> bool {
        !locked(&self.grown).is_over
    }

    /// Ends it, and returns when its connections are closed.
    fn stop(&self, py: Python<'_>) -> PyResult<()> {
        self.place.joined.usable()?;
        self.stop.stop();
        while self.grows() && self.place.joined.is_open() {
            py.detach(|| match self.place.is_plant() {
                true => self.place.joined.pass(STRIDE),
                false => {
                    std::thread::sleep(LOOK / 10);
                    Ok(())
                }
            })?;
            py.check_signals()?;
        }
        Ok(self.check()?)
    }

    /// What was recorded of each drive; JSON.
    fn drives(&self) -> String {
        let grown = locked(&self.grown);
        let drives = self.columns.drives.iter().zip(&grown.counts).zip(&grown.ended);
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
        Value::from_iter(drives).to_string()
    }

    /// The times at which values of a drive are missing, seconds from the start.
    fn gaps(&self) -> Vec<(f64, String)> {
        let grown = locked(&self.grown);
        let gaps = grown.rows.iter().filter(|row| row.gap);
        let gap = |row: &Row| (seconds(row.time), self.columns.drives.get(row.drive).cloned());
        gaps.map(gap)
            .map(|(time, drive)| (time, drive.unwrap_or_default()))
            .collect()
    }

    /// Writes the rows to a file; the end of its name decides the form.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        Ok(py.detach(|| write(&self.columns, &locked(&self.grown).rows, &path))?)
    }

    /// Draws the rows of these columns, of all where none are given (SVG).
    #[pyo3(signature = (title, columns=None))]
    fn picture(&self, py: Python<'_>, title: &str, columns: Option<Vec<String>>) -> PyResult<String> {
        let picture = py.detach(|| {
            let mut scope = Scope::new(&self.columns);
            for row in &locked(&self.grown).rows {
                scope.push(row);
            }
            if let Some(columns) = columns {
                let is_one = |name: &str| columns.iter().any(|column| name.ends_with(column));
                scope.curves.retain(|curve| is_one(&curve.name));
            }
            svg(title, &scope, &[])
        });
        Ok(picture.map_err(|error| explained(&error))?)
    }
}
