//! `gen`: turns the tables in `data/` into Rust source that is committed, so that a plain build needs no generator.

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::Outcome;

mod advice;
mod catalogue;
mod names;
mod parameter;
mod profile;
mod vendors;
mod words;

/// What to do with the generated text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Write the files.
    Write,
    /// Compare with the files and fail when one differs.
    Check,
}

/// One generated file.
pub struct Generated {
    /// Path below the workspace folder.
    pub path: String,
    /// Where its facts are, for the first line of the file.
    pub from: String,
    /// Rust source, unformatted, or Python source, without the first line.
    pub text: String,
}

/// Generates every file.
pub fn run(root: &Path, mode: Mode) -> Outcome<()> {
    let mut files = catalogue::files(root)?;
    files.extend(profile::files(root)?);
    files.extend(parameter::files(root)?);
    files.extend(words::files(root)?);
    files.extend(advice::files(root)?);
    files.push(vendors::file(root)?);
    files.push(names::file(root)?);
    let mut stale = Vec::new();
    for file in files {
        let head = format!("Generated from {} by `cargo run -p xtask -- gen`.", file.from);
        let text = if file.path.ends_with(".py") {
            Ok(format!("# {head} Do not edit.\n{}", file.text))
        } else {
            rustfmt(root, &format!("// {head}\n\n{}", file.text))
        };
        let text = text.map_err(|error: Box<dyn std::error::Error>| format!("{}: {error}", file.path))?;
        let path = root.join(&file.path);
        let present = std::fs::read_to_string(&path).unwrap_or_default();
        if present == text {
            continue;
        }
        match mode {
            Mode::Check => stale.push(file.path),
            Mode::Write => {
                if let Some(folder) = path.parent() {
                    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", file.path))?;
                }
                std::fs::write(&path, text).map_err(|error| format!("{}: {error}", file.path))?;
                println!("wrote {}", file.path);
            }
        }
    }
    if stale.is_empty() {
        Ok(())
    } else {
        Err(format!(
            "not up to date, run `cargo run -p xtask -- gen`: {}",
            stale.join(", ")
        )
        .into())
    }
}

fn rustfmt(root: &Path, text: &str) -> Outcome<String> {
    let mut child = Command::new("rustfmt")
        .args(["--edition", "2024", "--emit", "stdout", "--config-path"])
        .arg(root.join("rustfmt.toml"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| format!("rustfmt does not start: {error}"))?;
    let mut input = child.stdin.take().ok_or("rustfmt takes no input")?;
    let text = text.to_owned();
    let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = child.wait_with_output()?;
    writer.join().map_err(|_| "rustfmt was not fed")??;
    if !output.status.success() {
        return Err("rustfmt refuses the generated source".into());
    }
    Ok(String::from_utf8(output.stdout)?)
}
