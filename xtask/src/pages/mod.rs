//! `pages`: what stands in `docs/` and comes from the program itself, the picture of its demo, the reference of its
//! commands and the JSON schemas; and the data classes of the Python package, which come from the schemas.

mod commands;
mod picture;
mod python;
mod schema;

use std::path::Path;
use std::process::Command;

use crate::Outcome;
use crate::r#gen::Mode;

/// Writes what the program at `program` gives, or compares with it.
pub fn run(root: &Path, program: &str, mode: Mode) -> Outcome<()> {
    let schemas = output(program, &["schema"])?;
    let mut pages = vec![
        (
            "docs/src/demo.svg",
            picture::draw(&output(program, &["demo", "--fast"])?)?,
        ),
        (
            "docs/src/commands.md",
            commands::page(&mut |command| output(program, &[command, &["--help"]].concat()))?,
        ),
    ];
    let definitions = schema::definitions(&schemas)?;
    for (path, roots) in python::FILES {
        pages.push((path, python::file(&definitions, roots)?));
    }
    for (path, text) in pages {
        let file = root.join(path);
        match mode {
            Mode::Write => std::fs::write(file, text)?,
            Mode::Check if std::fs::read_to_string(file).is_ok_and(|there| there == text) => {}
            Mode::Check => {
                return Err(
                    format!("{path} is not what the program prints now; `make pages` writes it").into(),
                );
            }
        }
    }
    schema::run(root, &schemas, mode)
}

/// Returns the standard output of the program.
fn output(program: &str, arguments: &[&str]) -> Outcome<String> {
    // the help is wrapped to the width of a terminal, where one is given
    let output = Command::new(program)
        .args(arguments)
        .env_remove("COLUMNS")
        .output()?;
    if !output.status.success() {
        return Err(format!("{program} {}: {}", arguments.join(" "), output.status).into());
    }
    Ok(String::from_utf8(output.stdout)?)
}
