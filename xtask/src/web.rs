//! `web`: notes what the committed page of the workbench was built from, and checks that it is not old. Needs no Node.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::Outcome;
use crate::r#gen::Mode;

/// The most files of the page, and the most octets of all.
const FILES: usize = 8;
const OCTETS: u64 = 700_000;

/// What the page is built from, below `crates/workbench/web`.
const SOURCES: &[&str] = &[
    "index.html",
    "package-lock.json",
    "package.json",
    "public",
    "src",
    "tsconfig.json",
    "vite.config.ts",
];
/// The built files, apart from the notes about them and the plant of the demo.
const NOT_BUILT: &[&str] = &["manifest.json", "demo.toml"];

/// Writes `assets/manifest.json`, or compares it.
pub fn run(root: &Path, mode: Mode) -> Outcome<()> {
    let home = root.join("crates/workbench");
    let found = manifest(&home)?;
    let path = home.join("assets/manifest.json");
    match mode {
        Mode::Write => std::fs::write(&path, format!("{found:#}\n"))?,
        Mode::Check => {
            let noted: Value = serde_json::from_str(&std::fs::read_to_string(&path)?)?;
            if noted != found {
                return Err("the page in crates/workbench/assets is not built from crates/workbench/web as it is: run tools/web-build".into());
            }
        }
    }
    Ok(())
}

fn manifest(home: &Path) -> Outcome<Value> {
    let assets = home.join("assets");
    let mut built = Vec::new();
    collect(&assets, &mut built)?;
    built.retain(|path| !NOT_BUILT.iter().any(|name| path.ends_with(name)));
    let mut octets = 0;
    let mut files = BTreeMap::new();
    for path in &built {
        let content = std::fs::read(path)?;
        octets += content.len() as u64;
        files.insert(relative(path, &assets), format!("{:016x}", digest(&[&content])));
    }
    if files.len() > FILES || octets > OCTETS {
        return Err(format!(
            "the page has {} files of {octets} octets; at most {FILES} of {OCTETS} may be committed",
            files.len()
        )
        .into());
    }
    let web = home.join("web");
    let mut sources = Vec::new();
    for source in SOURCES {
        collect(&web.join(source), &mut sources)?;
    }
    sources.retain(|path| !path.to_string_lossy().contains(".test."));
    sources.sort();
    let mut parts = Vec::new();
    for path in &sources {
        parts.push(relative(path, &web).into_bytes());
        parts.push(std::fs::read(path)?);
    }
    let parts: Vec<&[u8]> = parts.iter().map(Vec::as_slice).collect();
    let package: Value = serde_json::from_slice(&std::fs::read(web.join("package.json"))?)?;
    let tool = |name: &str| package["devDependencies"][name].clone();
    Ok(json!({
        "sources": format!("{:016x}", digest(&parts)),
        "tools": { "vite": tool("vite"), "typescript": tool("typescript") },
        "files": files,
    }))
}

fn relative(path: &Path, folder: &Path) -> String {
    path.strip_prefix(folder)
        .unwrap_or(path)
        .to_string_lossy()
        .replace('\\', "/")
}

/// Adds the files of a folder and those below it, or the file itself.
fn collect(path: &Path, all: &mut Vec<PathBuf>) -> Outcome<()> {
    if !path.is_dir() {
        all.push(path.to_owned());
        return Ok(());
    }
    for entry in std::fs::read_dir(path)? {
        collect(&entry?.path(), all)?;
    }
    Ok(())
}

/// Returns the FNV-1a hash of texts with their lengths: it finds what was forgotten, and is no proof of anything.
fn digest(parts: &[&[u8]]) -> u64 {
    let octets = parts.iter().flat_map(|part| {
        let length = (part.len() as u64).to_le_bytes();
        length.into_iter().chain(part.iter().copied())
    });
    octets.fold(0xCBF2_9CE4_8422_2325, |hash, octet| {
        (hash ^ u64::from(octet)).wrapping_mul(0x0100_0000_01B3)
    })
}
