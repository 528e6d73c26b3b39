//! Rows as columns in memory (Apache Arrow): what a file of columns consists of, and what other programs take as it is.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::UNIX_EPOCH;

use arrow_array::builder::{
    BooleanBuilder, DurationNanosecondBuilder, Float64Builder, Int64Builder, TimestampNanosecondBuilder,
    UInt16Builder,
};
use arrow_array::types::UInt16Type;
use arrow_array::{ArrayRef, DictionaryArray, RecordBatch, StringArray, UInt16Array};
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef, TimeUnit};

use super::table::{Kind, Row, Table, Value};

/// The form of a recording: it changes only when a column changes its meaning or goes.
pub const FORM: &str = "profidrive/1";

/// What tables name the fingerprint of their plant.
pub(super) const PLANT: &str = "plant_hash";

/// Collects rows into a batch of columns: `t` (duration from the start), `wall` (time of day, UTC, null in virtual time),
/// `drive`, `gap`, then one column for each signal. The fields of the signals have `unit`, `parameter` and `scaling`.
#[derive(Debug)]
pub struct Batch {
    schema: SchemaRef,
    names: Arc<StringArray>,
    time: DurationNanosecondBuilder,
    wall: TimestampNanosecondBuilder,
    drive: Vec<u16>,
    gap: BooleanBuilder,
    signals: Vec<Builder>,
}

#[derive(Debug)]
enum Builder {
    Word(UInt16Builder),
    Integer(Int64Builder),
    Number(Float64Builder),
}

impl Builder {
    fn new(kind: Kind) -> Self {
        match kind {
            Kind::Word => Self::Word(UInt16Builder::new()),
            Kind::Integer => Self::Integer(Int64Builder::new()),
            Kind::Number => Self::Number(Float64Builder::new()),
        }
    }

    fn push(&mut self, value: Option<Value>) {
        match (self, value) {
            (Self::Word(builder), Some(Value::Word(word))) => builder.append_value(word),
            (Self::Integer(builder), Some(Value::Integer(number))) => builder.append_value(number),
            (Self::Number(builder), Some(Value::Number(number))) => builder.append_value(number),
            (Self::Word(builder), _) => builder.append_null(),
            (Self::Integer(builder), _) => builder.append_null(),
            (Self::Number(builder), _) => builder.append_null(),
        }
    }

    fn finish(&mut self) -> ArrayRef {
        match self {
            Self::Word(builder) => Arc::new(builder.finish()),
            Self::Integer(builder) => Arc::new(builder.finish()),
            Self::Number(builder) => Arc::new(builder.finish()),
        }
    }
}

/// Returns the columns of a recording with what they mean.
#[must_use]
pub fn schema(table: &Table) -> SchemaRef {
    let mut fields = vec![
        Field::new("t", DataType::Duration(TimeUnit::Nanosecond), false),
        Field::new(
            "wall",
            DataType::Timestamp(TimeUnit::Nanosecond, Some("UTC".into())),
            true,
        ),
        Field::new_dictionary("drive", DataType::UInt16, DataType::Utf8, false),
        Field::new("gap", DataType::Boolean, false),
    ];
    for column in &table.columns {
        let kind = match column.kind {
            Kind::Word => DataType::UInt16,
            Kind::Integer => DataType::Int64,
            Kind::Number => DataType::Float64,
        };
        let facts = [
            ("unit", &column.unit),
            ("parameter", &column.parameter),
            ("scaling", &column.scaling),
        ];
        let facts: HashMap<String, String> = facts
            .into_iter()
            .map(|(name, text)| (name.to_owned(), text.clone()))
            .collect();
        fields.push(Field::new(&column.name, kind, true).with_metadata(facts));
    }
    let facts = [("schema", FORM), ("version", env!("CARGO_PKG_VERSION"))];
    let facts = facts.map(|(name, text)| (name, text.to_owned()));
    let own = table.facts.iter().map(|(name, text)| (*name, text.clone()));
    let facts = facts.into_iter().chain(own);
    let facts = facts.map(|(name, text)| (name.to_owned(), text));
    Arc::new(Schema::new_with_metadata(
        fields,
        facts.collect::<HashMap<_, _>>(),
    ))
}

impl Batch {
    /// Creates an empty one.
    #[must_use]
    pub fn new(table: &Table) -> Self {
        let signals = table.columns.iter().map(|column| Builder::new(column.kind));
        Self {
            schema: schema(table),
            names: Arc::new(StringArray::from_iter_values(&table.drives)),
            time: DurationNanosecondBuilder::new(),
            wall: TimestampNanosecondBuilder::new().with_timezone("UTC"),
            drive: Vec::new(),
            gap: BooleanBuilder::new(),
            signals: signals.collect(),
        }
    }

    /// Returns the columns.
    #[must_use]
    pub fn schema(&self) -> SchemaRef {
        Arc::clone(&self.schema)
    }

    /// Returns the rows in it.
    #[must_use]
    pub fn len(&self) -> usize {
        self.drive.len()
    }

    /// Returns whether it has no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.drive.is_empty()
    }

    /// Adds a row.
    pub fn push(&mut self, row: &Row) {
        let nanos = |time: std::time::Duration| i64::try_from(time.as_nanos()).unwrap_or(i64::MAX);
        self.time.append_value(nanos(row.time));
        let wall = row.wall.and_then(|wall| wall.duration_since(UNIX_EPOCH).ok());
        self.wall.append_option(wall.map(nanos));
        self.drive.push(u16::try_from(row.drive).unwrap_or(u16::MAX));
        self.gap.append_value(row.gap);
        for (at, builder) in self.signals.iter_mut().enumerate() {
            builder.push(row.values.get(at).copied().flatten());
        }
    }

    /// Returns the rows as columns and begins anew.
    ///
    /// # Errors
    /// When the columns do not fit together, which is an error in this program.
    pub fn take(&mut self) -> Result<RecordBatch, ArrowError> {
        let keys = UInt16Array::from(std::mem::take(&mut self.drive));
        let names: ArrayRef = Arc::<StringArray>::clone(&self.names);
        let drive = DictionaryArray::<UInt16Type>::try_new(keys, names)?;
        let mut columns: Vec<ArrayRef> = vec![
            Arc::new(self.time.finish()),
            Arc::new(self.wall.finish()),
            Arc::new(drive),
            Arc::new(self.gap.finish()),
        ];
        columns.extend(self.signals.iter_mut().map(Builder::finish));
        RecordBatch::try_new(self.schema(), columns)
    }
}
