//! What is linked into the program: its dependencies and theirs, not those of builds and tests.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::Outcome;

/// The package whose program is handed out.
pub const PROGRAM: &str = "profidrive-cli";

/// The packages that are linked, from cargo's own metadata.
#[derive(Debug)]
pub struct Linked {
    metadata: Value,
    /// Ids of the packages that are linked, with the ids that each of them needs; the program itself among them.
    needs: BTreeMap<String, Vec<String>>,
}

impl Linked {
    /// Reads what is linked for a target.
    pub fn read(root: &Path, target: &str) -> Outcome<Self> {
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
        Ok(Self::of(serde_json::from_slice(&output.stdout)?))
    }

    fn of(metadata: Value) -> Self {
        let needs = needs(&metadata);
        Self { metadata, needs }
    }

    /// Returns the linked packages, the program among them.
    pub fn packages(&self) -> impl Iterator<Item = &Value> {
        let packages = self.metadata["packages"].as_array().into_iter().flatten();
        packages.filter(|package| self.needs.contains_key(text(&package["id"])))
    }

    /// Returns the ids of the packages that a linked package needs.
    pub fn needs(&self, id: &str) -> &[String] {
        self.needs.get(id).map_or(&[], Vec::as_slice)
    }
}

/// Returns a value as text, empty where it is none.
pub fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

fn needs(metadata: &Value) -> BTreeMap<String, Vec<String>> {
    let nodes = metadata["resolve"]["nodes"].as_array().into_iter().flatten();
    let nodes: BTreeMap<&str, &Value> = nodes.map(|node| (text(&node["id"]), &node["deps"])).collect();
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let program = packages.filter(|package| package["name"] == PROGRAM);
    let mut next: Vec<&str> = program.map(|package| text(&package["id"])).collect();
    let mut linked = BTreeMap::new();
    while let Some(id) = next.pop() {
        if linked.contains_key(id) {
            continue;
        }
        let dependencies = nodes.get(id).and_then(|deps| deps.as_array());
        let runs_with = |dependency: &&Value| {
            let mut kinds = dependency["dep_kinds"].as_array().into_iter().flatten();
            kinds.any(|kind| kind["kind"].is_null())
        };
        let needs: Vec<&str> = dependencies
            .into_iter()
            .flatten()
            .filter(runs_with)
            .map(|dependency| text(&dependency["pkg"]))
            .collect();
        next.extend(&needs);
        linked.insert(id.to_owned(), needs.into_iter().map(str::to_owned).collect());
    }
    linked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_linked_is_what_the_program_needs_to_run() {
        let dependency =
            |id: &str, kind: Value| serde_json::json!({ "pkg": id, "dep_kinds": [{ "kind": kind }] });
        let metadata = serde_json::json!({
            "packages": [{ "name": PROGRAM, "id": "cli" }, { "name": "xtask", "id": "xtask" }, { "name": "deep", "id": "deep" }],
            "resolve": { "nodes": [
                { "id": "cli", "deps": [dependency("library", Value::Null), dependency("judge", "dev".into())] },
                { "id": "library", "deps": [dependency("deep", Value::Null), dependency("generator", "build".into())] },
                { "id": "xtask", "deps": [dependency("csv", Value::Null)] },
            ] },
        });
        let linked = Linked::of(metadata);
        let ids: Vec<&String> = linked.needs.keys().collect();
        assert_eq!(ids, ["cli", "deep", "library"]);
        assert_eq!(linked.needs("library"), ["deep"]);
        let names: Vec<&str> = linked.packages().map(|package| text(&package["name"])).collect();
        assert_eq!(names, [PROGRAM, "deep"]);
    }
}
