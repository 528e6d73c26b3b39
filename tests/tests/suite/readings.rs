//! The table "Reading of the specification" of `data/README.md`: every row names a seed and tests that exist.

use std::collections::BTreeMap;

const README: &str = include_str!("../../../data/README.md");

/// The documents of the specification by number, as the table calls them.
const SEEDS: [&str; 5] = ["000", "001", "002", "003", "004"];

/// One row of the table.
struct Row {
    seed: String,
    section: String,
    statement: String,
    reading: String,
    tests: Vec<String>,
}

/// Returns the rows of the table below the heading.
fn rows() -> Vec<Row> {
    let (_, section) = README
        .split_once("\n## Reading of the specification\n")
        .expect("the section");
    let section = section.split("\n## ").next().expect("text");
    let mut lines = section.lines().filter(|line| line.starts_with('|'));
    assert_eq!(
        lines.next(),
        Some("| Seed | Section | Statement | Reading | Test |")
    );
    assert_eq!(lines.next(), Some("|---|---|---|---|---|"));
    lines
        .map(|line| {
            let inner = line
                .trim()
                .strip_prefix('|')
                .and_then(|line| line.strip_suffix('|'));
            let cells: Vec<&str> = inner.expect("a whole row").split('|').map(str::trim).collect();
            let [seed, section, statement, reading, tests] = cells[..] else {
                panic!("five cells: {line}");
            };
            let tests = tests
                .split(',')
                .map(|test| test.trim().trim_matches('`').to_owned());
            Row {
                seed: seed.to_owned(),
                section: section.to_owned(),
                statement: statement.to_owned(),
                reading: reading.to_owned(),
                tests: tests.collect(),
            }
        })
        .collect()
}

#[test]
fn every_reading_has_a_seed_and_tests_that_exist() {
    let rows = rows();
    assert!(rows.len() > 15, "{}", rows.len());
    let root = system_tests::root();
    let mut files: BTreeMap<String, String> = BTreeMap::new();
    for row in &rows {
        let place = format!("{} {}: {}", row.seed, row.section, row.statement);
        assert!(SEEDS.contains(&row.seed.as_str()), "{place}");
        for cell in [&row.section, &row.statement, &row.reading] {
            assert!(!cell.is_empty(), "{place}");
        }
        for test in &row.tests {
            let (file, name) = test
                .split_once("::")
                .unwrap_or_else(|| panic!("{place}: `{test}` is not a file::test"));
            let text = files.entry(file.to_owned()).or_insert_with(|| {
                std::fs::read_to_string(root.join(file))
                    .unwrap_or_else(|error| panic!("{place}: {file}: {error}"))
            });
            assert!(is_test(text, name), "{place}: {file} has no test {name}");
        }
    }
}

/// Returns true when the file has a function of this name that is a test.
fn is_test(text: &str, name: &str) -> bool {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let head = format!("fn {name}(");
    lines.iter().enumerate().any(|(at, line)| {
        let before = lines[..at].iter().rev().take_while(|line| line.starts_with("#["));
        line.starts_with(&head) && before.clone().any(|line| *line == "#[test]")
    })
}

#[test]
fn a_row_is_not_right_by_chance() {
    let text = "#[test]\nfn there() {}\nfn helper() {}\n";
    assert!(is_test(text, "there") && !is_test(text, "helper") && !is_test(text, "the"));
}
