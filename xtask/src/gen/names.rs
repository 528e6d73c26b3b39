//! Common names of parameters across vendors: `names.csv` of the profile.

use std::fmt::Write as _;
use std::path::Path;

use super::Generated;
use super::catalogue::variant;
use crate::Outcome;
use crate::table::Table;

const FROM: &str = "data/profile/names.csv";

/// The generated file.
pub fn file(root: &Path) -> Outcome<Generated> {
    let parts = Table::read(root, "data/profile/parts.csv")?;
    let parts: Result<Vec<&str>, _> = parts.rows().map(|row| row.text("part")).collect();
    let parts = parts?;
    let table = Table::read(root, FROM)?;
    let mut rows = String::new();
    let mut seen = Vec::new();
    for row in table.rows() {
        let (name, about, place) = (row.text("name")?, row.text("about")?, row.place());
        if name.is_empty() || about.is_empty() || seen.contains(&name) {
            return Err(format!("{place}: a name of its own and a meaning are required").into());
        }
        seen.push(name);
        let mut variants = String::new();
        for part in row.text("parts")?.split_whitespace() {
            if !parts.contains(&part) {
                return Err(format!("{place}: {part:?} is not a part of profile/parts.csv").into());
            }
            write!(variants, "Part::{},", variant(part))?;
        }
        if variants.is_empty() {
            return Err(format!("{place}: parts are missing").into());
        }
        writeln!(
            rows,
            "CommonName {{ name: {name:?}, parts: &[{variants}], about: {about:?} }},"
        )?;
    }
    Ok(Generated {
        path: "crates/profile/src/catalogue/generated_names.rs".to_owned(),
        from: FROM.to_owned(),
        text: format!(
            "use super::{{CommonName, Part}};\n\n#[rustfmt::skip]\npub(super) static NAMES: &[CommonName] = &[\n{rows}];\n"
        ),
    })
}
