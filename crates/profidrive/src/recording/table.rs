//! What a recording consists of: columns, rows, and what takes them.

use std::time::{Duration, SystemTime};

/// The columns of a recording, and the drives whose signals they have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Names of the drives; a row has the index of its drive.
    pub drives: Vec<String>,
    /// The signals. The columns of each row before them are time, time of day, drive and gap.
    pub columns: Vec<Column>,
    /// What else is known of the whole, by name: part of files that have room for it.
    pub facts: Vec<(&'static str, String)>,
}

/// A signal of a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// What the caller named it.
    pub name: String,
    /// What its values are.
    pub kind: Kind,
    /// Unit of its values, empty for none.
    pub unit: String,
    /// The parameter or the signal number at the drive: `DRV.ACC (p2108)`, `signal 5`.
    pub parameter: String,
    /// How the values follow from what travels; empty for a number as it travels.
    pub scaling: String,
}

impl Column {
    /// `current (A)`: the column of a signal whose name another column has, in another unit.
    pub(super) fn name_with_unit(&self) -> String {
        match self.unit.as_str() {
            "" => format!("{} (no unit)", self.name),
            unit => format!("{} ({unit})", self.name),
        }
    }

    /// Whether it is the column of a signal of this name that has [another unit](Self::name_with_unit).
    pub(super) fn is_called(&self, name: &str) -> bool {
        self.name
            .strip_prefix(name)
            .is_some_and(|rest| rest.starts_with(" ("))
    }

    /// Whether values of a signal of a drive, `self`, stand in this column of the table.
    pub(super) fn belongs_to(&self, column: &Self) -> bool {
        self.unit == column.unit && (self.name == column.name || self.name_with_unit() == column.name)
    }
}

/// What the values of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// 16 bits.
    Word,
    /// A whole number.
    Integer,
    /// A number in the unit of the column.
    Number,
}

/// One value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// Of [`Kind::Word`].
    Word(u16),
    /// Of [`Kind::Integer`].
    Integer(i64),
    /// Of [`Kind::Number`].
    Number(f64),
}

impl Value {
    /// Returns the value as a number.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a number to look at")]
    pub const fn number(self) -> f64 {
        match self {
            Self::Word(word) => word as f64,
            Self::Integer(number) => number as f64,
            Self::Number(number) => number,
        }
    }
}

impl Kind {
    /// Returns the kind that has the values of both.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Word, Self::Word) => Self::Word,
            (Self::Number, _) | (_, Self::Number) => Self::Number,
            _ => Self::Integer,
        }
    }

    /// Returns a value as one of this kind; `None` where it does not fit.
    #[must_use]
    pub fn of(self, value: Value) -> Option<Value> {
        match (self, value) {
            (Self::Number, value) => Some(Value::Number(value.number())),
            (Self::Integer, Value::Word(word)) => Some(Value::Integer(word.into())),
            (Self::Integer, value @ Value::Integer(_)) | (Self::Word, value @ Value::Word(_)) => Some(value),
            (Self::Word, Value::Integer(number)) => u16::try_from(number).ok().map(Value::Word),
            (Self::Word | Self::Integer, Value::Number(_)) => None,
        }
    }
}

/// The signals of one drive at one moment, or a gap.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// From the start of the recording to the arrival of the values. A lost cycle has the time at which it was due.
    pub time: Duration,
    /// The time of day at which they arrived; `None` in virtual time.
    pub wall: Option<SystemTime>,
    /// Index of the drive in [`Table::drives`].
    pub drive: usize,
    /// Values are missing here: a lost cycle, a reading without an answer, a drive that is not there.
    pub gap: bool,
    /// One for each column; `None` in a gap, and where the drive has no value.
    pub values: Vec<Option<Value>>,
}

/// Takes the rows of a recording.
pub trait Sink: Send {
    /// Takes a row.
    ///
    /// # Errors
    /// When it cannot be written. Rows that were taken before stay readable.
    fn write(&mut self, row: &Row) -> Result<(), super::WriteError>;

    /// Writes everything that is left. What was written is complete afterwards.
    ///
    /// # Errors
    /// When it cannot be written.
    fn finish(&mut self) -> Result<(), super::WriteError>;
}
