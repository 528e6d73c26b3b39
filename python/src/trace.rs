//! A run of a plant that was kept.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use ::plant::{Event, EventKind, Expectation, ExpectationResult, Goal, PlantPlan};
use client::ErrorKind;
use profidrive::recording::{Mark, Scope, svg, trace_columns, trace_rows, trace_table};
use profidrive::{Explained, Running};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::errors::{Failure, explained};
use crate::process::Process;
use crate::table::{Table, write};
use crate::time::{Span, seconds};

/// A trace that is cloned from its plant when it is looked at, or right before the plant goes on.
pub type Cell = OnceLock<::plant::Trace>;

/// A run, or a part of it from the start.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Trace {
    plan: Arc<PlantPlan>,
    cell: Arc<Cell>,
    /// Where it is cloned from, in this process.
    running: Option<(Running, Process)>,
}

/// Fills a cell with the trace of a plant as it is now.
pub fn fill(cell: &Cell, running: &Running) {
    let trace = running.with_world(|world| world.trace().cloned());
    if let Some(trace) = trace {
        // another thread has stored the same trace
        let _ = cell.set(trace);
    }
}

impl Trace {
    /// The trace of a plant that may go on.
    pub fn of(running: &Running, cell: Arc<Cell>) -> Self {
        Self {
            plan: Arc::clone(running.plan()),
            cell,
            running: Some((running.clone(), Process::this())),
        }
    }

    /// A trace that does not grow.
    pub fn kept(plan: Arc<PlantPlan>, trace: ::plant::Trace) -> Self {
        Self {
            plan,
            cell: Arc::new(Cell::from(trace)),
            running: None,
        }
    }

    fn get(&self, py: Python<'_>) -> Result<&::plant::Trace, Failure> {
        if let (None, Some((running, process))) = (self.cell.get(), &self.running) {
            process.check("the plant was started")?;
            py.detach(|| fill(&self.cell, running));
        }
        let trace = self.cell.get();
        trace.ok_or_else(|| Failure::internal(&"the plant keeps no trace"))
    }
}

/// Returns a document as JSON.
pub fn document(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|error| Failure::internal(&error))
}

#[pymethods]
impl Trace {
    #[getter]
    fn seed(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(self.get(py)?.seed())
    }

    #[getter]
    fn end(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(seconds(self.get(py)?.end()))
    }

    #[getter]
    fn cut(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        Ok(self.get(py)?.cut().map(seconds))
    }

    #[getter]
    fn drives(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let drives = self.get(py)?.drives();
        Ok(drives.map(|drive| drive.name().to_owned()).collect())
    }

    fn digest(&self, py: Python<'_>) -> PyResult<String> {
        let trace = self.get(py)?;
        Ok(format!("{:016x}", py.detach(|| trace.digest())))
    }

    /// The events as a JSON list.
    fn events(&self, py: Python<'_>) -> PyResult<String> {
        let events: Vec<&Event> = self.get(py)?.events().collect();
        Ok(document(&events)?)
    }

    /// The events as lines of text.
    fn lines(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(self.get(py)?.events().map(Event::to_string).collect())
    }

    /// Each drive as it was at a time, as a JSON list of samples; an empty one outside of the trace.
    #[pyo3(signature = (time, drive=None))]
    fn at(&self, py: Python<'_>, time: Span, drive: Option<&str>) -> PyResult<String> {
        let time = time.read()?;
        let trace = self.get(py)?;
        let drives = trace.at(time).into_iter().flatten();
        let drives = drives.filter(|(name, _)| drive.is_none_or(|drive| drive == *name));
        let samples: Vec<Event> = drives
            .map(|(name, snapshot)| Event::new(time, name, EventKind::Sample(snapshot.into())))
            .collect();
        Ok(document(&samples)?)
    }

    /// The samples, of one drive where its name is given.
    #[pyo3(signature = (drive=None))]
    fn samples(&self, py: Python<'_>, drive: Option<&str>) -> PyResult<Table> {
        let trace = self.get(py)?;
        let columns = py.detach(|| trace_columns(trace, &self.plan, drive));
        Ok(Table::new(columns.map_err(|error| Failure::internal(&error))?))
    }

    /// Writes the samples to a file; the end of its name decides the form.
    #[pyo3(signature = (path, drive=None))]
    fn write(&self, py: Python<'_>, path: PathBuf, drive: Option<&str>) -> PyResult<()> {
        let trace = self.get(py)?;
        py.detach(|| write(&trace_table(trace, &self.plan), &trace_rows(trace, drive), &path))?;
        Ok(())
    }

    /// Draws the samples of these columns (SVG), with a mark for each fault.
    #[pyo3(signature = (title, columns, drive=None))]
    fn picture(
        &self,
        py: Python<'_>,
        title: &str,
        columns: Vec<String>,
        drive: Option<&str>,
    ) -> PyResult<String> {
        let trace = self.get(py)?;
        let picture = py.detach(|| {
            let table = trace_table(trace, &self.plan);
            let mut scope = Scope::new(&table);
            for row in trace_rows(trace, drive) {
                scope.push(&row);
            }
            scope.curves.retain(|curve| {
                let signal = curve.name.rsplit(' ').next().unwrap_or_default();
                columns.iter().any(|column| column == signal)
            });
            svg(title, &scope, &marks(trace, drive))
        });
        Ok(picture.map_err(|error| explained(&error))?)
    }

    /// Checks expectations: JSON objects, inline tables, or texts with the key `expect`; those of the plant file where none is
    /// given. Returns each result as JSON with its text.
    fn expect(&self, py: Python<'_>, expectations: Vec<String>) -> PyResult<Vec<(String, String)>> {
        let trace = self.get(py)?;
        let mut given = Given::default();
        let results = py.detach(|| {
            let expected = if expectations.is_empty() {
                &self.plan.expectations
            } else {
                given = Given::read(&self.plan, &expectations)?;
                &given.found
            };
            trace.expect(expected).map_err(|error| explained(&error))
        })?;
        let text = |result: &ExpectationResult| match given.is_mapping(result) {
            true => without_line(result),
            false => result.to_string(),
        };
        let pairs = results
            .iter()
            .map(|result| Ok::<_, Failure>((document(result)?, text(result))));
        Ok(pairs.collect::<Result<_, _>>()?)
    }
}

/// A line for each fault that came.
fn marks(trace: &::plant::Trace, drive: Option<&str>) -> Vec<Mark> {
    let chosen = trace
        .events()
        .filter(|event| drive.is_none_or(|drive| drive == event.drive));
    chosen
        .filter(|event| matches!(event.kind, EventKind::FaultRaised { .. }))
        .take(20)
        .map(|event| Mark {
            time: event.time,
            text: format!("{} {}", event.drive, event.kind),
        })
        .collect()
}

/// Expectations of one call, which are numbered and named together.
#[derive(Default)]
struct Given {
    found: Vec<Expectation>,
    /// Those from here on are mappings: no text of theirs has lines that the caller knows.
    mappings: usize,
}

impl Given {
    fn read(plan: &PlantPlan, given: &[String]) -> Result<Self, Failure> {
        let mut tables = Vec::new();
        let mut found = Vec::new();
        for text in given {
            match inline(text) {
                Some(table) => tables.push(table?),
                None => {
                    let read = plan.expectations_of(text);
                    found
                        .extend(read.map_err(|error| explained(&error).with(json!({ "line": error.line })))?);
                }
            }
        }
        let mappings = found.len();
        if !tables.is_empty() {
            let text = format!("expect = [\n{}\n]", tables.join(",\n"));
            let read = plan.expectations_of(&text);
            found.extend(read.map_err(|error| Failure::usage(error.message))?);
        }
        Ok(Self { found, mappings })
    }

    fn is_mapping(&self, result: &ExpectationResult) -> bool {
        let (_, mappings) = self.found.split_at_checked(self.mappings).unwrap_or_default();
        let mut mappings = mappings.iter();
        mappings.any(|one| (one.name(), one.line()) == (&result.name, result.line))
    }
}

/// The text of a result whose line no one has seen.
fn without_line(result: &ExpectationResult) -> String {
    let text = result.to_string();
    let line = format!("line {}: ", result.line);
    text.strip_prefix(&line).unwrap_or(&text).to_owned()
}

/// Returns an inline table: one that is written as such, or a JSON object; `None` for another text.
fn inline(text: &str) -> Option<Result<String, Failure>> {
    if !text.trim_start().starts_with('{') {
        return None;
    }
    // no inline table of TOML is a JSON object but the empty one
    let Ok(object) = serde_json::from_str::<Value>(text) else {
        return Some(Ok(text.to_owned()));
    };
    let table: Result<toml::Value, _> = serde_json::from_value(object);
    let table = table.map(|table| table.to_string());
    Some(table.map_err(|error| Failure::new(ErrorKind::Usage, format!("{text}: {error}"))))
}

/// Returns the conditions of a text or of a JSON object; their errors have no line, as the caller wrote none.
pub fn goal_of(plan: &PlantPlan, text: &str) -> Result<Goal, Failure> {
    let text = inline(text).unwrap_or_else(|| Ok(text.to_owned()))?;
    plan.goal(&text).map_err(|error| Failure::usage(error.message))
}

/// Returns each result as JSON with its text.
pub fn results(results: &[ExpectationResult]) -> Result<Vec<(String, String)>, Failure> {
    let pair = |result: &ExpectationResult| Ok((document(result)?, result.to_string()));
    results.iter().map(pair).collect()
}

/// Returns an event as JSON.
pub fn event(event: &Event) -> Result<String, Failure> {
    document(event)
}

/// Returns an error of the library with the JSON of the results that it stands for.
pub fn lost(error: &dyn Explained, result: &ExpectationResult) -> Failure {
    Failure::new(error.kind(), without_line(result))
        .of_class("ExpectationFailed")
        .with(json!({ "drive": result.drive, "results": [result] }))
}
