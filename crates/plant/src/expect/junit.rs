//! Results of expectations as a JUnit report.

use std::time::Duration;

use quick_junit::{NonSuccessKind, Property, Report, TestCase, TestCaseStatus, TestSuite};

use super::result::{ExpectationResult, Outcome};

/// A run of a plant as a test suite.
#[derive(Debug, Clone, Copy)]
pub struct Suite<'a> {
    /// Name of the plant file.
    pub plant: &'a str,
    /// Seed of the run.
    pub seed: u64,
    /// Version of the program.
    pub version: &'a str,
    /// Simulated time.
    pub simulated: Duration,
    /// Time that the run took.
    pub took: Duration,
}

/// Returns the report of one run: a test case for each expectation and drive. The time of a case is its share of the run.
#[must_use]
pub fn junit(suite: &Suite<'_>, results: &[ExpectationResult]) -> String {
    let mut cases = TestSuite::new(suite.plant);
    cases.set_time(suite.took);
    for (name, value) in [
        ("seed", suite.seed.to_string()),
        ("version", suite.version.to_owned()),
        ("virtual-time", format!("{} s", suite.simulated.as_secs_f64())),
    ] {
        cases.add_property(Property::new(name, value));
    }
    let share = suite.took / u32::try_from(results.len().max(1)).unwrap_or(u32::MAX);
    for result in results {
        let status = match result.outcome {
            Outcome::Met => TestCaseStatus::success(),
            Outcome::NotMet => failed(NonSuccessKind::Failure, result),
            Outcome::NeverStarted | Outcome::NotEnded => failed(NonSuccessKind::Error, result),
        };
        let mut case = TestCase::new(format!("{} [{}]", result.name, result.drive), status);
        let file = result.file.as_deref().unwrap_or(suite.plant);
        case.set_classname(file).set_time(share);
        cases.add_test_case(case);
    }
    let mut report = Report::new("profidrive");
    report.add_test_suite(cases);
    // writing to memory does not fail
    report.to_string().unwrap_or_default()
}

fn failed(kind: NonSuccessKind, result: &ExpectationResult) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(kind);
    status
        .set_type(result.outcome.to_string())
        .set_message(format!("expected {}, actual {}", result.expected, result.actual))
        .set_description(result.to_string());
    status
}
