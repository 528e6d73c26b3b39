//! Plain columns.

/// Rows of text under headings.
#[derive(Debug, Clone, Default)]
pub struct Table {
    headings: Vec<&'static str>,
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// With these headings; one that starts with `>` is aligned to the right.
    pub fn new(headings: &[&'static str]) -> Self {
        Self {
            right: headings.iter().map(|heading| heading.starts_with('>')).collect(),
            headings: headings
                .iter()
                .map(|heading| heading.trim_start_matches('>'))
                .collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row; missing cells are empty.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows
            .push(cells.into_iter().map(|cell| clean(&cell)).collect());
    }

    /// Returns true when there is no row.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns the lines of the table, the last column ragged. Columns without any content are left out.
    pub fn lines(&self) -> Vec<String> {
        let width = |at: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(at));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let columns: Vec<(usize, usize)> = (0..self.headings.len())
            .map(|at| (at, width(at)))
            .filter(|&(_, width)| width > 0)
            .map(|(at, width)| {
                (
                    at,
                    width.max(self.headings.get(at).map_or(0, |h| h.chars().count())),
                )
            })
            .collect();
        let headings: Vec<String> = self.headings.iter().map(|&heading| heading.to_owned()).collect();
        std::iter::once(&headings)
            .chain(&self.rows)
            .map(|row| self.line(row, &columns))
            .collect()
    }

    fn line(&self, row: &[String], columns: &[(usize, usize)]) -> String {
        let mut line = String::new();
        for (position, &(at, width)) in columns.iter().enumerate() {
            if position > 0 {
                line.push_str("  ");
            }
            let cell = row.get(at).map_or("", String::as_str);
            let space = " ".repeat(width.saturating_sub(cell.chars().count()));
            if self.right.get(at).copied().unwrap_or(false) {
                line.push_str(&space);
                line.push_str(cell);
            } else {
                line.push_str(cell);
                line.push_str(&space);
            }
        }
        line.trim_end().to_owned()
    }
}

pub use crate::output::clean;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let mut table = Table::new(&["name", ">value", "unit", "never"]);
        table.row(["DRV.ACC".into(), "10000".into(), "rpm/s".into()]);
        table.row(["VL.FB".into(), "-1.5".into(), "rpm".into(), String::new()]);
        assert_eq!(
            table.lines(),
            [
                "name     value  unit",
                "DRV.ACC  10000  rpm/s",
                "VL.FB     -1.5  rpm"
            ]
        );
    }

    #[test]
    fn hostile_text_stays_in_its_cell() {
        let mut table = Table::new(&["name", "mac"]);
        table.row(["a\x1b[2Jb\nc".into(), "1".into()]);
        table.row(["d".into(), "2".into()]);
        assert_eq!(
            table.lines(),
            ["name            mac", "a\\u{1b}[2Jb\\nc  1", "d               2"]
        );
    }
}
