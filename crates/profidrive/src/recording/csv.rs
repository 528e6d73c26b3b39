//! Rows as lines of text.

use std::io;

use chrono::{DateTime, SecondsFormat, Utc};

use super::table::{Row, Table, Value};

/// Turns rows into lines: time in seconds, time of day (RFC 3339, UTC), drive, gap, then the signals. A missing value is
/// empty.
#[derive(Debug)]
pub struct CsvLines {
    drives: Vec<String>,
    pending: csv::Writer<Vec<u8>>,
}

impl CsvLines {
    /// Begins with the line of names. A unit stands behind the name, in brackets.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn new(table: &Table) -> io::Result<Self> {
        let mut lines = Self {
            drives: table.drives.clone(),
            pending: csv::Writer::from_writer(Vec::new()),
        };
        let named = table.columns.iter().map(|column| match column.unit.as_str() {
            "" => column.name.clone(),
            unit => format!("{} [{unit}]", column.name),
        });
        let head = ["t", "wall", "drive", "gap"].map(str::to_owned);
        lines.pending.write_record(head.into_iter().chain(named))?;
        Ok(lines)
    }

    /// Adds the line of a row.
    ///
    /// # Errors
    /// When the fields do not fit together, which is an error in this program.
    pub fn push(&mut self, row: &Row) -> io::Result<()> {
        let wall = row.wall.map(|wall| {
            let wall: DateTime<Utc> = wall.into();
            wall.to_rfc3339_opts(SecondsFormat::Nanos, true)
        });
        let drive = self.drives.get(row.drive).map_or("", String::as_str);
        let time = format!("{}.{:09}", row.time.as_secs(), row.time.subsec_nanos());
        let gap = if row.gap { "true" } else { "false" };
        let out = &mut self.pending;
        out.write_field(time)?;
        out.write_field(wall.unwrap_or_default())?;
        out.write_field(drive)?;
        out.write_field(gap)?;
        for value in &row.values {
            out.write_field(match value {
                None => String::new(),
                Some(Value::Word(word)) => word.to_string(),
                Some(Value::Integer(number)) => number.to_string(),
                Some(Value::Number(number)) => number.to_string(),
            })?;
        }
        out.write_record(None::<&[u8]>)?;
        Ok(())
    }

    /// Returns the lines that were not taken yet.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn take(&mut self) -> io::Result<Vec<u8>> {
        let pending = std::mem::replace(&mut self.pending, csv::Writer::from_writer(Vec::new()));
        pending.into_inner().map_err(|error| error.into_error())
    }
}
