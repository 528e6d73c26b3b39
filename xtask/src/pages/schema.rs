//! The JSON schemas of what the commands print, in `docs/schema`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;

use crate::Outcome;
use crate::r#gen::Mode;

const FOLDER: &str = "docs/schema";

/// Returns the shared definitions of the files that `printed` has.
pub fn definitions(printed: &str) -> Outcome<Value> {
    let mut files: BTreeMap<String, Value> = serde_json::from_str(printed)?;
    let shared = files.get_mut("definitions.json");
    Ok(shared.ok_or("the program prints no shared definitions")?["$defs"].take())
}

/// Writes the files that `printed` has by their names, or compares with them.
pub fn run(root: &Path, printed: &str, mode: Mode) -> Outcome<()> {
    let files: BTreeMap<String, Value> = serde_json::from_str(printed)?;
    let folder = root.join(FOLDER);
    std::fs::create_dir_all(&folder)?;
    let mut stale = BTreeSet::new();
    for entry in std::fs::read_dir(&folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if !files.contains_key(&name) {
            stale.insert(name);
        }
    }
    if mode == Mode::Write {
        for name in std::mem::take(&mut stale) {
            std::fs::remove_file(folder.join(name))?;
        }
    }
    for (name, schema) in files {
        let text = format!("{schema:#}\n");
        let file = folder.join(&name);
        match mode {
            Mode::Write => std::fs::write(file, text)?,
            Mode::Check if std::fs::read_to_string(file).is_ok_and(|there| there == text) => {}
            Mode::Check => {
                stale.insert(name);
            }
        }
    }
    if stale.is_empty() {
        return Ok(());
    }
    let names: Vec<String> = stale.into_iter().collect();
    let message = format!(
        "{FOLDER}: {} not up to date; `make pages` writes them",
        names.join(", ")
    );
    Err(message.into())
}
