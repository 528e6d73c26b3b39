//! The table at the end.

/// One figure with what stands beside it.
#[derive(Debug, Clone, Default)]
pub struct Row {
    what: String,
    ours: String,
    beside: String,
    limit: String,
    held: Option<bool>,
}

impl Row {
    /// Creates a figure of ours.
    pub fn new(what: &str, ours: String) -> Self {
        Self {
            what: what.into(),
            ours,
            ..Self::default()
        }
    }

    /// Adds the figure of the peer, measured in the same run.
    pub fn beside(mut self, beside: String) -> Self {
        self.beside = beside;
        self
    }

    /// Adds the limit, and whether it was kept.
    pub fn limit(mut self, limit: String, held: bool) -> Self {
        self.limit = limit;
        self.held = Some(held);
        self
    }

    fn cells(&self) -> [&str; 5] {
        let held = match self.held {
            Some(true) => "ok",
            Some(false) => "MISSED",
            None => "",
        };
        [&self.what, &self.ours, &self.beside, &self.limit, held]
    }
}

/// Prints all rows in columns. Says whether every limit held.
pub fn print(rows: &[Row]) -> bool {
    let head = ["figure", "ours", "beside it", "limit", ""];
    let all: Vec<[&str; 5]> = std::iter::once(head).chain(rows.iter().map(Row::cells)).collect();
    let mut widths = [0; 5];
    for row in &all {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    for row in all {
        let line: Vec<String> = row
            .iter()
            .zip(widths)
            .map(|(cell, width)| format!("{cell:<width$}"))
            .collect();
        println!("{}", line.join("  ").trim_end());
    }
    rows.iter().all(|row| row.held != Some(false))
}
