//! What came of an expectation.

use std::fmt;

use serde::Serialize;

use super::condition::with_unit;
use crate::trace::Event;

/// What came of one expectation for one drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExpectationResult {
    /// The file that has the expectation; null for a text.
    pub file: Option<String>,
    /// Name of the expectation.
    pub name: String,
    /// Line where it begins, from 1.
    pub line: usize,
    /// The drive.
    pub drive: String,
    /// What came of it.
    pub outcome: Outcome,
    /// What was expected, as written.
    pub expected: String,
    /// What the drive reported when it was decided.
    pub actual: String,
    /// Seconds from the start to the moment when it was decided.
    pub time: f64,
    /// The nearest value of a quantity that was not met.
    pub nearest: Option<Nearest>,
    /// The last events of the drive before that moment, five at most; without samples.
    pub last_events: Vec<Event>,
    /// Seed of the run.
    pub seed: u64,
}

/// What came of an expectation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Outcome {
    /// It came true.
    Met,
    /// It did not come true.
    NotMet,
    /// Its clock never started.
    NeverStarted,
    /// The run ended before its time.
    NotEnded,
}

/// The value of a quantity that came nearest to the expected ones.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Nearest {
    /// Which quantity.
    pub quantity: String,
    /// Its value.
    pub value: f64,
    /// Its unit, empty for none.
    pub unit: &'static str,
    /// Seconds from the start to that moment.
    pub time: f64,
}

impl ExpectationResult {
    /// Returns true when it came true.
    #[must_use]
    pub fn is_met(&self) -> bool {
        self.outcome == Outcome::Met
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Met => "met",
            Self::NotMet => "not met",
            Self::NeverStarted => "its time never started",
            Self::NotEnded => "the run ended before its time",
        })
    }
}

impl fmt::Display for Nearest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = with_unit(self.value, self.unit);
        write!(f, "{} {value} at {} s", self.quantity, self.time)
    }
}

impl fmt::Display for ExpectationResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.file {
            write!(f, "{file}, ")?;
        }
        writeln!(
            f,
            "line {}: {}: {}: {}",
            self.line, self.drive, self.name, self.outcome
        )?;
        writeln!(f, "  expected: {}", self.expected)?;
        writeln!(f, "  actual:   {} at {} s", self.actual, self.time)?;
        if let Some(nearest) = &self.nearest {
            writeln!(f, "  nearest:  {nearest}")?;
        }
        if !self.last_events.is_empty() {
            writeln!(f, "  last events of {}:", self.drive)?;
        }
        for event in &self.last_events {
            writeln!(f, "  {event}")?;
        }
        write!(f, "  seed {}", self.seed)
    }
}
