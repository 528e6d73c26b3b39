//! Many runs of one plant.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant as Clock;

use ::plant::{Bounds, Campaign as Source, CampaignError, Distribution, DistributionError, Trace as Kept};
use arrow_schema::ArrowError;
use client::ErrorKind;
use profidrive::Explained as _;
use profidrive::recording::{MeasuredRun, Runs as Table};
use profile::notation::Quantity;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::attention::LOOK;
use crate::errors::{Failure, explained};
use crate::plant::Plant;
use crate::table::unwritten;
use crate::time::{Span, seconds};
use crate::trace::Trace;

/// A campaign: a run depends on nothing but it and a seed.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Campaign {
    runs: Source,
}

/// How a value varies: its path, the name of a distribution, the numbers of that, and which of a list it is.
type Varied = (String, String, Vec<String>, Option<usize>);

fn distribution(kind: &str, values: &[String], place: Option<usize>) -> Result<Distribution, Failure> {
    let unread = |error: &dyn std::fmt::Display| Failure::usage(error.to_string());
    if kind == "choice" {
        let values = values.iter().map(|value| serde_json::from_str(value));
        let values: Result<Vec<toml::Value>, _> = values.collect();
        let values = values.map_err(|error| unread(&error))?;
        return Ok(match place {
            Some(place) => Distribution::Listed { values, place },
            None => Distribution::Choice(values),
        });
    }
    let quantity = |place: usize| {
        let text = values.get(place).map_or("", String::as_str);
        let read: Result<Quantity, _> = text.parse();
        read.map_err(|error| Failure::usage(format!("{text}: {error}")))
    };
    let (first, second) = (quantity(0)?, quantity(1)?);
    let made = |error: DistributionError| unread(&error);
    match kind {
        "uniform" => Ok(Distribution::Uniform(Bounds::new(&first, &second).map_err(made)?)),
        "log_uniform" => Ok(Distribution::LogUniform(
            Bounds::new(&first, &second).map_err(made)?,
        )),
        _ => Distribution::normal(&first, &second).map_err(made),
    }
}

fn failed(error: &CampaignError) -> Failure {
    match error {
        CampaignError::Change { error: inner, .. } => Failure::new(inner.kind(), error.to_string()),
        CampaignError::World { error: inner, .. } => {
            Failure::new(explained(&**inner).kind(), error.to_string())
        }
        _ => Failure::new(ErrorKind::Usage, error.to_string()),
    }
}

#[pymethods]
impl Campaign {
    #[new]
    fn new(
        plant: &Plant,
        until: Option<Span>,
        vary: Vec<Varied>,
        measures: Vec<(String, String)>,
    ) -> PyResult<Self> {
        let mut runs = Source::new(plant.source.clone());
        for (path, kind, values, place) in vary {
            let drawn = distribution(&kind, &values, place)?;
            runs = runs.vary(path, drawn);
        }
        for (name, text) in measures {
            let measure = plant.source.plan().measure(&text);
            let measure =
                measure.map_err(|error| Failure::usage(format!("measure {name}: {}", error.message)))?;
            runs = runs.measure(name, measure);
        }
        if let Some(until) = until {
            runs = runs.until(until.read()?);
        }
        Ok(Self { runs })
    }

    /// Runs the plant with each of these seeds; `measure` is called with the trace of each run and returns more numbers of it.
    #[pyo3(signature = (seeds, measure=None))]
    fn run(&self, py: Python<'_>, seeds: Vec<u64>, measure: Option<Bound<'_, PyAny>>) -> PyResult<Runs> {
        let mut runs = Vec::new();
        let mut looked = Clock::now();
        let has_measure = measure.is_some();
        for seed in seeds {
            let begin = Clock::now();
            let (run, measured) = py
                .detach(|| match has_measure {
                    false => self.runs.run(seed).map(|run| (run, None)),
                    true => {
                        let kept = self.runs.run_kept(seed, Kept::USUAL_LIMIT);
                        kept.map(|(run, plant, trace)| (run, trace.map(|trace| (plant, trace))))
                    }
                })
                .map_err(|error| failed(&error))?;
            let wall = seconds(begin.elapsed());
            let measures = match (&measure, measured) {
                (Some(measure), Some((plant, trace))) => {
                    let trace = Trace::kept(Arc::new(plant.plan().clone()), trace);
                    measure.call1((trace,))?.extract()?
                }
                _ => Vec::new(),
            };
            runs.push(MeasuredRun { run, measures, wall });
            if looked.elapsed() >= LOOK {
                looked = Clock::now();
                py.check_signals()?;
            }
        }
        let table = Table::new(&self.runs, &runs);
        let why = |error| match error {
            ArrowError::SchemaError(text) => text,
            other => other.to_string(),
        };
        Ok(Runs(table.map_err(|error| Failure::usage(why(error)))?))
    }

    /// The smallest plant in which an expectation of a run still fails, found within a time of this computer; what fails in
    /// it, the runs that it took, and whether it is the smallest one.
    fn shrink(
        &self,
        py: Python<'_>,
        seed: u64,
        expectation: Option<String>,
        budget: Span,
    ) -> PyResult<(Plant, String, usize, bool)> {
        let (budget, begin) = (budget.read()?, Clock::now());
        let (mut looked, mut raised) = (begin, None);
        let mut goes_on = || {
            if looked.elapsed() >= LOOK {
                looked = Clock::now();
                raised = Python::attach(|py| py.check_signals()).err();
            }
            raised.is_none() && begin.elapsed() < budget
        };
        let shrunk = py.detach(|| self.runs.shrink(seed, expectation.as_deref(), &mut goes_on));
        if let Some(raised) = raised {
            return Err(raised);
        }
        let shrunk = shrunk.map_err(|error| failed(&error))?.ok_or_else(|| {
            let what = expectation.map_or_else(String::new, |name| format!(" `{name}`"));
            Failure::usage(format!("seed {seed}: no expectation{what} fails"))
        })?;
        let reason = shrunk.to_string();
        let source = shrunk.plant;
        Ok((Plant { source }, reason, shrunk.runs, shrunk.is_smallest))
    }

    /// The plant of a run.
    fn plant(&self, seed: u64) -> PyResult<Plant> {
        let (source, _) = self.runs.plant(seed).map_err(|error| failed(&error))?;
        Ok(Plant { source })
    }
}

/// Runs in columns.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Runs(Table);

fn unfit(error: &dyn std::fmt::Display) -> Failure {
    Failure::internal(error)
}

#[pymethods]
impl Runs {
    #[staticmethod]
    fn from_ipc(octets: &[u8]) -> PyResult<Self> {
        Ok(Self(Table::from_ipc(octets).map_err(|error| unfit(&error))?))
    }

    /// Reads a file of a part.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = py.detach(|| Table::read(&path));
        Ok(Self(read.map_err(|error| unwritten(&path, &error))?))
    }

    /// Chosen rows of many parts, by their numbers as if all parts were one.
    #[staticmethod]
    fn of_parts(py: Python<'_>, parts: Vec<PyRef<'_, Self>>, rows: Vec<u64>) -> PyResult<Self> {
        let parts: Vec<_> = parts.iter().map(|part| part.0.clone()).collect();
        let whole = py.detach(|| Table::of_parts(&parts, &rows));
        Ok(Self(whole.map_err(|error| Failure::usage(error.to_string()))?))
    }

    fn to_ipc<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let octets = py.detach(|| self.0.to_ipc()).map_err(|error| unfit(&error))?;
        Ok(PyBytes::new(py, &octets))
    }

    /// Writes them to a new file of a part.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let written = py.detach(|| self.0.write(&path));
        Ok(written.map_err(|error| unwritten(&path, &error))?)
    }

    fn __len__(&self) -> usize {
        self.0.columns().num_rows()
    }

    fn seeds(&self) -> Vec<u64> {
        self.0.seeds()
    }

    fn failures(&self) -> Vec<usize> {
        self.0.failures()
    }

    /// A row as a JSON object.
    fn row(&self, place: usize) -> Option<String> {
        self.0.row(place).map(|row| row.to_string())
    }

    fn table(&self) -> crate::table::Table {
        crate::table::Table::new(self.0.columns().clone())
    }
}
