//! House tasks: `cargo run -p xtask -- gen [--check]` writes (or compares) the generated tables,
//! `cargo run -p xtask -- arrows` proves that the crates only depend on each other as ARCHITECTURE.md says,
//! `cargo run -p xtask -- notices TARGET` prints the licences of what is linked into the program,
//! `cargo run -p xtask -- sbom TARGET` prints its software bill of materials,
//! `cargo run -p xtask -- pages PROGRAM [--check]` writes (or compares) what `docs/` has from the program, and
//! `cargo run -p xtask -- web [--check]` does so with the digests of the page of the workbench.
#![forbid(unsafe_code)]

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

mod arrows;
mod circles;
mod r#gen;
mod linked;
mod notices;
mod pages;
mod sbom;
mod table;
mod web;

/// Result of a task; the error is a text for the user.
type Outcome<T> = Result<T, Box<dyn Error>>;

const USAGE: &str = "usage: cargo run -p xtask -- <task>
  gen            write the generated tables from data/
  gen --check    fail when a generated table is not up to date
  arrows         fail when a crate depends on one it must not know, or files import each other in a large circle
  notices TARGET print the licences of what is linked into the program
  sbom TARGET    print the software bill of materials of the program (CycloneDX)
  pages PROGRAM  write the pages of docs/ that come from the program
  pages PROGRAM --check  fail when one of these is not up to date
  web            note what the page of the workbench is built from (tools/web-build calls it)
  web --check    fail when that page is not up to date";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match words.as_slice() {
        ["gen"] => r#gen::run(&root(), r#gen::Mode::Write),
        ["gen", "--check"] => r#gen::run(&root(), r#gen::Mode::Check),
        ["arrows"] => arrows::run(&root()),
        ["notices", target] => notices::run(&root(), target),
        ["sbom", target] => sbom::run(&root(), target),
        ["pages", program] => pages::run(&root(), program, r#gen::Mode::Write),
        ["pages", program, "--check"] => pages::run(&root(), program, r#gen::Mode::Check),
        ["web"] => web::run(&root(), r#gen::Mode::Write),
        ["web", "--check"] => web::run(&root(), r#gen::Mode::Check),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Returns the folder of the workspace, the parent of this package's folder.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}
