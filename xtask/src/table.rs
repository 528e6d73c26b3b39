//! The tables in `data/`: comma separated, the first line names the columns. The crate `csv` takes them apart, this gives
//! cells by column and reports the place of an error.

use std::path::Path;

use crate::Outcome;

/// One table with named columns.
pub struct Table {
    file: String,
    columns: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

/// One row of a [`Table`].
#[derive(Clone, Copy)]
pub struct Row<'a> {
    table: &'a Table,
    /// Index of the row, 0 is the line below the column names.
    index: usize,
}

impl Table {
    /// Reads `root/file`.
    pub fn read(root: &Path, file: &str) -> Outcome<Self> {
        let text = std::fs::read_to_string(root.join(file)).map_err(|error| format!("{file}: {error}"))?;
        Self::parse(file, &text)
    }

    /// Reads a table out of its text; `file` is for messages.
    pub fn parse(file: &str, text: &str) -> Outcome<Self> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let mut read = || -> Result<_, csv::Error> {
            let columns: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
            let rows: Result<Vec<csv::StringRecord>, _> = reader.records().collect();
            Ok((columns, rows?))
        };
        let (columns, rows) = read().map_err(|error| format!("{file}: {error}"))?;
        Ok(Self {
            file: file.to_owned(),
            columns,
            rows,
        })
    }

    /// Returns all rows in file order.
    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        (0..self.rows.len()).map(|index| Row { table: self, index })
    }
}

impl<'a> Row<'a> {
    /// Returns the text of a cell, empty when unknown.
    pub fn text(self, column: &str) -> Outcome<&'a str> {
        let Some(at) = self.table.columns.iter().position(|name| name == column) else {
            return Err(format!("{}: no column {column}", self.table.file).into());
        };
        Ok(self
            .table
            .rows
            .get(self.index)
            .and_then(|cells| cells.get(at))
            .unwrap_or_default())
    }

    /// Returns the text of a cell, empty when unknown and also where the table has no such column.
    pub fn maybe(self, column: &str) -> &'a str {
        self.text(column).unwrap_or_default()
    }

    /// Returns the number in a cell; an error when it is empty or no number.
    pub fn number<T: std::str::FromStr>(self, column: &str) -> Outcome<T> {
        let text = self.text(column)?;
        text.parse()
            .map_err(|_| format!("{}: {column} is not a number: {text:?}", self.place()).into())
    }

    /// Returns the number in a cell, `None` when the cell is empty.
    pub fn optional<T: std::str::FromStr>(self, column: &str) -> Outcome<Option<T>> {
        if self.text(column)?.is_empty() {
            Ok(None)
        } else {
            self.number(column).map(Some)
        }
    }

    /// As [`optional`](Self::optional), also where the table has no such column.
    pub fn maybe_number<T: std::str::FromStr>(self, column: &str) -> Outcome<Option<T>> {
        if self.maybe(column).is_empty() {
            Ok(None)
        } else {
            self.number(column).map(Some)
        }
    }

    /// File and line for messages.
    pub fn place(self) -> String {
        format!("{}:{}", self.table.file, self.index + 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_commas_and_empty_cells() {
        let table = Table::parse("t", "a,b,c\n1,\"x, \"\"y\"\"\",\n").unwrap();
        let row = table.rows().next().unwrap();
        assert_eq!(row.number::<u16>("a").unwrap(), 1);
        assert_eq!(row.text("b").unwrap(), "x, \"y\"");
        assert_eq!(row.optional::<f64>("c").unwrap(), None);
        assert!(row.text("d").is_err());
        assert_eq!((row.maybe("d"), row.maybe_number::<u8>("d").unwrap()), ("", None));
        assert_eq!(row.maybe_number::<u8>("a").unwrap(), Some(1));
    }

    #[test]
    fn a_short_row_is_refused() {
        assert!(Table::parse("t", "a,b\n1\n").is_err());
        assert!(Table::parse("t", "a\n1,2\n").is_err());
    }
}
