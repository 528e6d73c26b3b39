//! An expectation as it was read.

use std::fmt;
use std::time::Duration;

use super::condition::{Condition, Source, Test};

/// Something that is expected of drives of a plant.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    /// The file that has it.
    pub(crate) file: Option<String>,
    pub(super) name: String,
    pub(super) line: usize,
    pub(super) rule: Rule,
    /// How long it must stay true.
    pub(super) lasts: Duration,
    pub(super) targets: Vec<Target>,
    /// As written, without the name.
    pub(super) source: String,
}

/// When it must hold.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Rule {
    At(Duration),
    Within {
        span: Duration,
        after: After,
    },
    /// Always true, or never.
    Whole {
        holds: bool,
        from: Duration,
        to: Option<Duration>,
    },
}

/// Start of a clock.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum After {
    Time(Duration),
    /// The first time that this holds for one of the drives.
    Condition(Vec<Target>),
}

/// Conditions of one drive, all of which must hold at the same instant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Target {
    /// Number of the drive in the plant.
    pub drive: usize,
    pub conditions: Vec<Condition>,
}

impl Expectation {
    /// Returns its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns true when a condition of it looks at a parameter.
    #[must_use]
    pub fn reads_parameters(&self) -> bool {
        let mut conditions = self.all_targets().flat_map(|target| &target.conditions);
        conditions.any(|condition| {
            matches!(
                &condition.test,
                Test::Number {
                    source: Source::Parameter(..),
                    ..
                }
            )
        })
    }

    /// Returns the number in the plant of each drive that it looks at.
    pub(crate) fn drives(&self) -> impl Iterator<Item = usize> {
        self.all_targets().map(|target| target.drive)
    }

    fn all_targets(&self) -> impl Iterator<Item = &Target> {
        let after = match &self.rule {
            Rule::Within {
                after: After::Condition(targets),
                ..
            } => targets.as_slice(),
            _ => &[],
        };
        self.targets.iter().chain(after)
    }

    /// Returns the line where it begins, from 1.
    #[must_use]
    pub const fn line(&self) -> usize {
        self.line
    }
}

impl fmt::Display for Expectation {
    /// As an inline table.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{{ name = {}, {} }}", quoted(&self.name), self.source)
    }
}

/// Returns a text in quotation marks, as TOML has it.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
