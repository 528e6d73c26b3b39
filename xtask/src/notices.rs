//! `notices`: the licence texts of everything that is linked into the program, for the packages that are handed out.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use crate::Outcome;
use crate::linked::{Linked, text};

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
    let linked = Linked::read(root, target)?;
    let mut packages = String::new();
    let mut texts = BTreeMap::<String, Vec<String>>::new();
    for package in linked.packages() {
        // those of this workspace have the licence that the package itself has
        if package["source"].is_null() {
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
    // the page of the workbench is a part of the program, and its packages are none of Rust
    let page = root.join("crates/workbench/assets/licences.txt");
    println!("{}\n{}", "-".repeat(80), std::fs::read_to_string(page)?);
    Ok(())
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
