//! `notices`: the licence texts of everything that is linked into the program, for the packages that are handed out.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::Outcome;

/// The package whose program is handed out.
const PROGRAM: &str = "profidrive-cli";
/// How files with a licence begin.
const LICENCE_FILES: &[&str] = &[
    "LICENSE",
    "LICENCE",
    "COPYING",
    "COPYRIGHT",
    "NOTICE",
    "UNLICENSE",
];

/// Prints name, version, licence and licence texts of each linked package; equal texts are printed once.
pub fn run(root: &Path, target: &str) -> Outcome<()> {
    let output = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args([
            "metadata",
            "--format-version",
            "1",
            "--locked",
            "--filter-platform",
            target,
        ])
        .current_dir(root)
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    let metadata: Value = serde_json::from_slice(&output.stdout)?;
    let linked = linked(&metadata);
    let mut packages = String::new();
    let mut texts = BTreeMap::<String, Vec<String>>::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        // those of this workspace have the licence that the package itself has
        if !linked.contains(text(&package["id"])) || package["source"].is_null() {
            continue;
        }
        let name = format!("{} {}", text(&package["name"]), text(&package["version"]));
        writeln!(packages, "{name}: {}", text(&package["license"]))?;
        let manifest = Path::new(text(&package["manifest_path"]));
        for licence in licences(manifest.parent().unwrap_or(manifest))? {
            texts.entry(licence).or_default().push(name.clone());
        }
    }
    println!("{packages}");
    for (licence, of) in texts {
        println!("{}\n{}\n{licence}\n", "-".repeat(80), of.join(", "));
    }
    Ok(())
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// Returns the ids of the packages that are linked: the program's dependencies and theirs, not those of builds and
/// tests.
fn linked(metadata: &Value) -> BTreeSet<&str> {
    let nodes = metadata["resolve"]["nodes"].as_array().into_iter().flatten();
    let nodes: BTreeMap<&str, &Value> = nodes.map(|node| (text(&node["id"]), &node["deps"])).collect();
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let program = packages.filter(|package| package["name"] == PROGRAM);
    let mut next: Vec<&str> = program.map(|package| text(&package["id"])).collect();
    let mut linked = BTreeSet::new();
    while let Some(id) = next.pop() {
        if !linked.insert(id) {
            continue;
        }
        for dependency in nodes
            .get(id)
            .and_then(|deps| deps.as_array())
            .into_iter()
            .flatten()
        {
            let mut kinds = dependency["dep_kinds"].as_array().into_iter().flatten();
            if kinds.any(|kind| kind["kind"].is_null()) {
                next.push(text(&dependency["pkg"]));
            }
        }
    }
    linked
}

/// Returns the texts of the licences in the folder of a package.
fn licences(folder: &Path) -> Outcome<Vec<String>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().to_uppercase();
        if entry.file_type()?.is_file() && LICENCE_FILES.iter().any(|start| name.starts_with(start)) {
            found.push(std::fs::read_to_string(entry.path())?.trim().to_owned());
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_linked_is_what_the_program_needs_to_run() {
        let dependency =
            |id: &str, kind: Value| serde_json::json!({ "pkg": id, "dep_kinds": [{ "kind": kind }] });
        let metadata = serde_json::json!({
            "packages": [{ "name": PROGRAM, "id": "cli" }, { "name": "xtask", "id": "xtask" }],
            "resolve": { "nodes": [
                { "id": "cli", "deps": [dependency("library", Value::Null), dependency("judge", "dev".into())] },
                { "id": "library", "deps": [dependency("deep", Value::Null), dependency("generator", "build".into())] },
                { "id": "xtask", "deps": [dependency("csv", Value::Null)] },
            ] },
        });
        assert_eq!(linked(&metadata), BTreeSet::from(["cli", "library", "deep"]));
    }
}
