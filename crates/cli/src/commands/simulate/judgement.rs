//! What came of the expectations of a simulation: shown, and as a JUnit report.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use client::ErrorKind;
use network::files::create;
use plant::{ExpectationResult, Suite, junit};
use profidrive::report::SimulationReport;

use crate::args::Simulate;
use crate::failure::Failure;
use crate::output::Output;

/// The file of a JUnit report.
pub struct ReportFile {
    path: PathBuf,
    file: File,
    plant: String,
}

/// A run as its report has it.
#[derive(Debug, Clone, Copy)]
pub struct Ran {
    pub seed: u64,
    /// Simulated time.
    pub simulated: Duration,
    /// Time that it took.
    pub took: Duration,
}

impl ReportFile {
    /// Creates the file of `--junit`: one that cannot be written is an error before the run, not after it.
    pub fn create(args: &Simulate) -> Result<Option<Self>, Failure> {
        let Some(path) = &args.junit else {
            return Ok(None);
        };
        let file = create(path).map_err(|error| Failure::new(ErrorKind::Local, error.to_string()))?;
        Ok(Some(Self {
            path: path.clone(),
            file,
            plant: args
                .plant
                .as_deref()
                .unwrap_or(Path::new(""))
                .display()
                .to_string(),
        }))
    }

    fn write(&mut self, ran: Ran, results: &[ExpectationResult]) -> Result<(), Failure> {
        let suite = Suite {
            plant: &self.plant,
            seed: ran.seed,
            version: env!("CARGO_PKG_VERSION"),
            simulated: ran.simulated,
            took: ran.took,
        };
        let written = self.file.write_all(junit(&suite, results).as_bytes());
        written.map_err(|error| Failure::new(ErrorKind::Local, format!("{}: {error}", self.path.display())))
    }
}

/// Writes the report and shows what came of the expectations; fails when one was lost.
pub fn judge(
    results: Vec<ExpectationResult>,
    report: Option<ReportFile>,
    ran: Ran,
    output: &Output,
) -> Result<(), Failure> {
    let written = report.map_or(Ok(()), |mut report| report.write(ran, &results));
    // a lost expectation counts more than a report that could not be written
    let judged = show(results, output);
    if let (Err(_), Err(failure)) = (&judged, &written) {
        output.problem(failure);
    }
    judged.and(written)
}

/// Shows what came of the expectations; fails when one was lost.
fn show(results: Vec<ExpectationResult>, output: &Output) -> Result<(), Failure> {
    let all = results.len();
    if all == 0 {
        return Ok(());
    }
    let lost: Vec<String> = results
        .iter()
        .filter(|result| !result.is_met())
        .map(ToString::to_string)
        .collect();
    output.json_event(&SimulationReport::Expectations {
        expectations: results,
    });
    let of = if all == 1 {
        "1 expectation".to_owned()
    } else {
        format!("{all} expectations")
    };
    if lost.is_empty() {
        output.say(&format!("{of}: all met"));
        return Ok(());
    }
    let mut failure = Failure::new(ErrorKind::Difference, format!("{} of {of} lost", lost.len()));
    failure.details = lost
        .iter()
        .flat_map(|text| text.lines())
        .map(str::to_owned)
        .collect();
    Err(failure)
}
