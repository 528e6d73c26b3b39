//! What is wrong with a file, and where.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

/// Most problems of one report.
const MOST: usize = 200;

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Position {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Allowed, but tools may stumble.
    Warning,
    /// Against the rules; the file can be used anyway.
    Error,
    /// What the file means is not certain: it is not used.
    Unusable,
}

impl Severity {
    /// In a word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Warning => "warning",
            Self::Error => "error",
            Self::Unusable => "unusable",
        }
    }
}

/// Which rule is not kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rule {
    /// The octets are not text in an encoding that is read.
    Encoding,
    /// The text is not valid XML.
    Xml,
    /// Document types and entities are not taken.
    Entity,
    /// The file is larger, deeper or fuller than is read.
    Limit,
    /// It is not GSDML.
    Root,
    /// An element that must be there is not, or one is there twice or where it does not belong.
    Element,
    /// Elements stand in another order than the schema's.
    Order,
    /// An attribute that must be there is not, or is not known.
    Attribute,
    /// A value is not of its type or not in its range.
    Value,
    /// An identifier is used twice.
    Identifier,
    /// Something is named that is not there.
    Reference,
    /// A text is named that is not in the list of texts.
    Text,
    /// References go round in a circle.
    Loop,
    /// Lengths do not fit each other.
    Length,
    /// The file name violates the naming rule or contradicts the contents of the file.
    FileName,
    /// Versions do not fit each other or what is in the file.
    Version,
}

impl Rule {
    /// In a word, for programs.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Encoding => "encoding",
            Self::Xml => "xml",
            Self::Entity => "entity",
            Self::Limit => "limit",
            Self::Root => "root",
            Self::Element => "element",
            Self::Order => "order",
            Self::Attribute => "attribute",
            Self::Value => "value",
            Self::Identifier => "identifier",
            Self::Reference => "reference",
            Self::Text => "text",
            Self::Loop => "loop",
            Self::Length => "length",
            Self::FileName => "file name",
            Self::Version => "version",
        }
    }
}

/// Something wrong.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {}, column {}: {message}", position.line, position.column)]
pub struct Problem {
    /// How bad it is.
    pub severity: Severity,
    /// Which rule is not kept.
    pub rule: Rule,
    /// Where.
    pub position: Position,
    /// What was expected and what was found.
    pub message: String,
}

/// Problems as they are found; the list is bounded, the count is not.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    pub list: Vec<Problem>,
    pub left_out: usize,
}

impl Problems {
    /// Returns whether another problem of this severity fits; else it is only counted. The first one that forbids the
    /// use is in the list however many warnings came before.
    pub fn wants(&mut self, severity: Severity) -> bool {
        let first = severity == Severity::Unusable
            && self.list.iter().all(|known| known.severity < Severity::Unusable);
        let room = self.list.len() < MOST || first;
        if !room {
            self.left_out += 1;
        }
        room
    }

    pub fn add(&mut self, problem: Problem) {
        if self.wants(problem.severity) {
            self.list.push(problem);
        }
    }
}
