//! Plants: what they are read from and changed by.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use ::plant::{Happened, PlantError, PlantEventError, PlantPlan, PlantSource};
use pyo3::prelude::*;
use serde_json::json;

use crate::errors::{Failure, explained};
use crate::log;
use crate::network::machine_of;
use crate::served::Served;
use crate::time::{Span, seconds};
use crate::world::World;

/// A plant that does not run.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Plant {
    pub source: PlantSource,
}

fn unread(error: &PlantError) -> Failure {
    explained(error).with(json!({ "line": error.line }))
}

#[pymethods]
impl Plant {
    #[staticmethod]
    fn from_file(path: PathBuf) -> PyResult<Self> {
        let source = PlantSource::read(&path).map_err(|error| {
            let failure = explained(&error);
            match &error {
                ::plant::PlantFileError::PlantPlan { error, .. } => {
                    failure.with(json!({ "line": error.line }))
                }
                ::plant::PlantFileError::Read { source, .. } => {
                    failure.with(json!({ "errno": source.raw_os_error(), "filename": path }))
                }
                _ => failure,
            }
        })?;
        Ok(Self { source })
    }

    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        let source = text.parse().map_err(|error| unread(&error))?;
        Ok(Self { source })
    }

    #[staticmethod]
    fn of(models: Vec<String>) -> PyResult<Self> {
        let source = PlantSource::of(models.iter().map(String::as_str));
        let source = source.map_err(|error| explained(&error))?;
        Ok(Self { source })
    }

    /// Other values at these paths; a JSON object.
    fn with_changes(&self, changes: &str) -> PyResult<Self> {
        let changes: Result<BTreeMap<String, toml::Value>, _> = serde_json::from_str(changes);
        let changes =
            changes.map_err(|error| Failure::usage(format!("a change has no TOML value: {error}")))?;
        let changes = changes.iter().map(|(path, value)| (path.as_str(), value.clone()));
        let source = self
            .source
            .with_changes(changes)
            .map_err(|error| explained(&error))?;
        Ok(Self { source })
    }

    fn to_toml(&self) -> &str {
        self.source.as_toml()
    }

    #[getter]
    fn seed(&self) -> u64 {
        self.source.plan().seed
    }

    #[getter]
    fn duration(&self) -> Option<f64> {
        self.source.plan().duration.map(seconds)
    }

    #[getter]
    fn drives(&self) -> Vec<String> {
        let drives = self.source.plan().drives.iter();
        drives.map(|drive| drive.name.clone()).collect()
    }

    /// Names of the expectations of the plant file.
    #[getter]
    fn expectations(&self) -> Vec<String> {
        let expectations = self.source.plan().expectations.iter();
        expectations
            .map(|expectation| expectation.name().to_owned())
            .collect()
    }

    /// The plant with something that happens to a drive at its start.
    #[pyo3(signature = (drive, action, lasts=None))]
    fn with_event(&self, drive: &str, action: &str, lasts: Option<Span>) -> PyResult<Self> {
        let happened = Happened {
            drive: drive.to_owned(),
            at: Duration::ZERO,
            event: action
                .parse()
                .map_err(|error: PlantEventError| explained(&error))?,
            lasts: lasts.map(|lasts| lasts.read()).transpose()?,
        };
        let source = self.source.with_events([&happened]);
        // the line is one of a text that the caller has not seen
        let source = source.map_err(|error| Failure::usage(error.message))?;
        Ok(Self { source })
    }

    /// Runs its drives on an interface in real time; they are ready when it returns.
    fn serve(&self, py: Python<'_>, interface: String, state: Option<PathBuf>) -> PyResult<Served> {
        log::begin(py)?;
        Ok(py.detach(|| Served::start(self.source.plan(), interface, state))?)
    }

    /// Starts it in virtual time; `capture` is a file for the frames, `machine` the machine file of its network.
    #[pyo3(signature = (seed=None, capture=None, machine=None))]
    fn start(
        &self,
        py: Python<'_>,
        seed: Option<u64>,
        capture: Option<PathBuf>,
        machine: Option<PathBuf>,
    ) -> PyResult<World> {
        log::begin(py)?;
        let mut plan: PlantPlan = self.source.plan().clone();
        plan.seed = seed.unwrap_or(plan.seed);
        Ok(py.detach(|| {
            let machine = machine.as_deref().map(machine_of).transpose()?;
            World::start(Arc::new(plan), capture, machine)
        })?)
    }
}
