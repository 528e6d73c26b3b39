//! `profidrive gsdml export|show|check`: device descriptions.

mod check;
mod export;
mod show;

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use client::ErrorKind;
use gsdml::{Gsdml as Description, MOST_OCTETS};

use crate::args::{Gsdml, GsdmlCommand};
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Gsdml, output: &Output) -> Result<(), Failure> {
    match &args.what {
        GsdmlCommand::Export(args) => export::run(args, output),
        GsdmlCommand::Show(args) => show::run(args, output),
        GsdmlCommand::Check(args) => check::run(args, output),
    }
}

/// The octets of a file, not more than a description may have.
fn octets(path: &Path) -> Result<Vec<u8>, Failure> {
    let failed = |error: std::io::Error| {
        Failure::new(
            ErrorKind::Local,
            format!("cannot read {}: {error}", path.display()),
        )
    };
    let mut octets = Vec::new();
    // one octet more than accepted, so that a longer file is detected
    let most = MOST_OCTETS as u64 + 1;
    File::open(path)
        .and_then(|file| file.take(most).read_to_end(&mut octets))
        .map_err(failed)?;
    Ok(octets)
}

/// A description that can be used.
pub fn read(path: &Path) -> Result<Description, Failure> {
    gsdml::parse(&octets(path)?).map_err(|problem| {
        let place = problem.position;
        Failure::new(
            ErrorKind::Local,
            format!(
                "{}:{place}: {}",
                path.display(),
                crate::render::table::clean(&problem.message)
            ),
        )
        .hint(format!(
            "`profidrive gsdml check {}` shows everything",
            path.display()
        ))
    })
}

/// The name of a file without its folder.
fn file_name(path: &Path) -> String {
    path.file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default()
}
