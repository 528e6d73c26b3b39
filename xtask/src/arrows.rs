//! `arrows`: the crates may only depend on each other as in the table below; checked by cargo's metadata. Within a
//! crate [`circles`] checks the files.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::{Outcome, circles};

/// Every library. A folder `X` of `crates/` is the package `profidrive-X`, but for the library that a user adds.
const LIBRARIES: &[&str] = &[
    "profidrive",
    "profidrive-profile",
    "profidrive-profinet",
    "profidrive-gsdml",
    "profidrive-uss",
    "profidrive-virtual-drive",
    "profidrive-client",
    "profidrive-dissect",
    "profidrive-network",
    "profidrive-plant",
    "profidrive-workbench",
];

/// Who may depend on whom inside the workspace (ARCHITECTURE.md draws it). Arrows only point down.
const ALLOWED: &[(&str, &[&str])] = &[
    ("profidrive-profile", &[]),
    ("profidrive-profinet", &[]),
    ("profidrive-gsdml", &[]),
    ("profidrive-uss", &[]),
    (
        "profidrive-virtual-drive",
        &[
            "profidrive-profile",
            "profidrive-profinet",
            "profidrive-gsdml",
            "profidrive-uss",
        ],
    ),
    (
        "profidrive-client",
        &["profidrive-profile", "profidrive-profinet", "profidrive-uss"],
    ),
    (
        "profidrive-dissect",
        &["profidrive-profile", "profidrive-profinet", "profidrive-uss"],
    ),
    ("profidrive-network", &["profidrive-profinet"]),
    (
        "profidrive",
        &[
            "profidrive-client",
            "profidrive-dissect",
            "profidrive-gsdml",
            "profidrive-network",
            "profidrive-plant",
            "profidrive-profile",
            "profidrive-profinet",
            "profidrive-uss",
            "profidrive-virtual-drive",
        ],
    ),
    (
        "profidrive-plant",
        &[
            "profidrive-profile",
            "profidrive-profinet",
            "profidrive-gsdml",
            "profidrive-uss",
            "profidrive-virtual-drive",
            "profidrive-network",
        ],
    ),
    ("profidrive-workbench", &["profidrive"]),
    ("profidrive-cli", LIBRARIES),
    ("profidrive-python", LIBRARIES),
    ("examples", LIBRARIES),
    ("xtask", &[]),
    // tests and benchmarks look at every library, and no library depends on them
    ("system-tests", LIBRARIES),
    ("testbench", LIBRARIES),
    ("comparisons", LIBRARIES),
    ("allocations", &[]),
    ("pnio-device", &[]),
];

/// Arrows that are not between libraries: the benchmarks start programs as the tests do.
const BESIDE: &[(&str, &str)] = &[("comparisons", "system-tests")];

/// Libraries without sockets, threads and clocks.
const NO_IO: &[&str] = &[
    "profidrive-profile",
    "profidrive-profinet",
    "profidrive-gsdml",
    "profidrive-uss",
    "profidrive-virtual-drive",
    "profidrive-client",
    "profidrive-dissect",
];
/// Outside crates that would bring them in.
const IO_CRATES: &[&str] = &[
    "libc",
    "socket2",
    "smoltcp",
    "tokio",
    "mio",
    "nix",
    "rustix",
    "rand",
    "getrandom",
];

/// Checks every dependency of every package of the workspace, development dependencies apart: tests may look across. Checks
/// the files of each crate, too.
pub fn run(root: &Path) -> Outcome<()> {
    let output = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(root)
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    let mut wrong = violations(&serde_json::from_slice(&output.stdout)?)?;
    let circles = circles::find(root)?;
    wrong.extend(circles.wrong);
    if wrong.is_empty() {
        println!("all arrows point down, and no more than three files import each other");
        println!(
            "with names of the module above as arrows: {} larger circles, of {:?} files",
            circles.strict.len(),
            circles.strict
        );
        Ok(())
    } else {
        Err(wrong.join("\n").into())
    }
}

fn violations(metadata: &Value) -> Outcome<Vec<String>> {
    let packages = metadata["packages"]
        .as_array()
        .ok_or("cargo metadata has no packages")?;
    let names: Vec<&str> = packages
        .iter()
        .filter_map(|package| package["name"].as_str())
        .collect();
    let mut wrong = Vec::new();
    for package in packages {
        let name = package["name"].as_str().unwrap_or_default();
        let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| *known == name) else {
            wrong.push(format!(
                "{name} is not in the table of arrows (xtask/src/arrows.rs)"
            ));
            continue;
        };
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            let other = dependency["name"].as_str().unwrap_or_default();
            if dependency["kind"] == "dev" {
                continue;
            }
            if names.contains(&other) && !allowed.contains(&other) && !BESIDE.contains(&(name, other)) {
                wrong.push(format!("{name} must not depend on {other}"));
            }
            if NO_IO.contains(&name) && IO_CRATES.contains(&other) {
                wrong.push(format!("{name} is free of I/O and must not depend on {other}"));
            }
        }
    }
    Ok(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metadata(text: &str) -> Value {
        serde_json::from_str(text).unwrap()
    }

    #[test]
    fn an_upward_arrow_is_found() {
        let found = violations(&metadata(
            r#"{"packages":[{"name":"profidrive-profinet","dependencies":[{"name":"profidrive-profile","kind":null},{"name":"libc","kind":null}]},
                {"name":"profidrive-profile","dependencies":[]}]}"#,
        ))
        .unwrap();
        assert_eq!(
            found,
            [
                "profidrive-profinet must not depend on profidrive-profile",
                "profidrive-profinet is free of I/O and must not depend on libc"
            ]
        );
    }

    #[test]
    fn development_dependencies_are_free_and_strangers_are_not() {
        let found = violations(&metadata(
            r#"{"packages":[{"name":"profidrive-profinet","dependencies":[{"name":"profidrive-network","kind":"dev"}]},
                {"name":"profidrive-network","dependencies":[]},{"name":"stranger","dependencies":[]}]}"#,
        ))
        .unwrap();
        assert_eq!(
            found,
            ["stranger is not in the table of arrows (xtask/src/arrows.rs)"]
        );
    }
}
