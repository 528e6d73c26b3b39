//! Many runs of one plant.

use std::time::Instant as Clock;

use ::plant::{Bounds, Campaign as Runs, CampaignError, Distribution, DistributionError};
use client::ErrorKind;
use profidrive::Explained as _;
use profile::notation::Quantity;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::attention::LOOK;
use crate::errors::{Failure, explained};
use crate::plant::Plant;
use crate::time::{Span, seconds};

/// A campaign: a run depends on nothing but it and a seed.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Campaign {
    runs: Runs,
}

/// How a value varies: its path, the name of a distribution, and the numbers of that.
type Varied = (String, String, Vec<String>);

fn distribution(kind: &str, values: &[String]) -> Result<Distribution, Failure> {
    let unread = |error: &dyn std::fmt::Display| Failure::usage(error.to_string());
    if kind == "choice" {
        let values = values.iter().map(|value| serde_json::from_str(value));
        let values: Result<Vec<toml::Value>, _> = values.collect();
        return Ok(Distribution::Choice(values.map_err(|error| unread(&error))?));
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
    fn new(plant: &Plant, until: Option<Span>, vary: Vec<Varied>) -> PyResult<Self> {
        let mut runs = Runs::new(plant.source.clone());
        for (path, kind, values) in vary {
            let drawn = distribution(&kind, &values)?;
            runs = runs.vary(path, drawn);
        }
        if let Some(until) = until {
            runs = runs.until(until.read()?);
        }
        Ok(Self { runs })
    }

    /// Runs the plant with each of these seeds; a JSON list. Results of expectations are with those runs in which one failed.
    fn run(&self, py: Python<'_>, seeds: Vec<u64>) -> PyResult<String> {
        let mut rows = Vec::new();
        let mut looked = Clock::now();
        for seed in seeds {
            let begin = Clock::now();
            let run = py
                .detach(|| self.runs.run(seed))
                .map_err(|error| failed(&error))?;
            let lost: Vec<_> = run.results.iter().filter(|result| !result.is_met()).collect();
            let failed: Vec<_> = lost.iter().map(|result| &result.name).collect();
            let variables: Value = run
                .variables
                .iter()
                .cloned()
                .map(|(path, value)| (path, json!(value)))
                .collect();
            rows.push(json!({
                "seed": seed,
                "variables": variables,
                "failed": failed,
                "results": lost,
                "digest": run.digest,
                "wall": seconds(begin.elapsed()),
            }));
            if looked.elapsed() >= LOOK {
                looked = Clock::now();
                py.check_signals()?;
            }
        }
        Ok(Value::from(rows).to_string())
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
