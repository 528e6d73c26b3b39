//! Everything that is against the rules, not only the first thing.

mod meaning;
mod schema;
#[cfg(test)]
mod tests;

use alloc::format;
use alloc::vec::Vec;

use crate::file_name::FileName;
use crate::model::Gsdml;
use crate::problem::{Position, Problem, Rule, Severity};
use crate::read::{Reader, document};
use crate::source::Source;

/// What a check found.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// The description, where it can be used.
    pub description: Option<Gsdml>,
    /// Everything wrong, in the order of the file.
    pub problems: Vec<Problem>,
    /// How many problems more there are.
    pub left_out: usize,
}

impl Report {
    /// Returns true when nothing is against the rules; warnings do not count.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.left_out == 0
            && self
                .problems
                .iter()
                .all(|problem| problem.severity == Severity::Warning)
    }
}

/// Looks for everything wrong with a device description: what [`parse`](crate::parse) refuses, order and number of
/// elements, attributes that must be there, identifiers, references, texts, lengths, versions, and with a file name the
/// naming rule.
#[must_use]
pub fn check(octets: &[u8], file_name: Option<&str>) -> Report {
    let nothing = |problem| Report {
        description: None,
        problems: alloc::vec![problem],
        left_out: 0,
    };
    let source = match Source::new(octets) {
        Ok(source) => source,
        Err(problem) => return nothing(problem),
    };
    let document = match document(&source) {
        Ok(document) => document,
        Err(problem) => return nothing(problem),
    };
    let mut reader = Reader::new(&source);
    let description = reader.gsdml(&document);
    schema::check(&mut reader, document.root_element());
    if let Some(gsdml) = &description {
        meaning::check(&mut reader, document.root_element(), gsdml);
    }
    if let Some(name) = file_name {
        check_name(&mut reader, name, description.as_ref());
    }
    let mut problems = reader.problems.list;
    problems.sort_by_key(|problem| (problem.position, problem.rule));
    problems.dedup();
    let usable = problems
        .iter()
        .all(|problem| problem.severity < Severity::Unusable);
    Report {
        description: description.filter(|_| usable),
        problems,
        left_out: reader.problems.left_out,
    }
}

fn check_name(reader: &mut Reader<'_>, name: &str, gsdml: Option<&Gsdml>) {
    let mut wrong = |message| {
        reader.problems.add(Problem {
            severity: Severity::Error,
            rule: Rule::FileName,
            position: Position { line: 1, column: 1 },
            message,
        });
    };
    match name.parse::<FileName>() {
        Err(error) => wrong(format!("file name: {error}")),
        Ok(name) => {
            let version = gsdml.and_then(|gsdml| gsdml.schema_version);
            if version.is_some_and(|version| version != name.version) {
                let version = version.unwrap_or(name.version);
                wrong(format!(
                    "the file name says schema {}, the file {version}",
                    name.version
                ));
            }
        }
    }
}
