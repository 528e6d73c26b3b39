//! `profidrive gsdml export|show|check`: device descriptions.

mod check;
mod export;
mod show;

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use gsdml::{Gsdml as Description, MOST_OCTETS};
use virtual_drive::model::Model;

use crate::args::simulated;
use crate::failure::{Exit, Failure};
use crate::output::Output;

/// What to do with device descriptions.
#[derive(Debug, Args)]
pub struct Gsdml {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Write the device description of a virtual drive with its picture, for the engineering tool of a PLC
    Export(Export),
    /// Show what a device description says: identity, access points, modules, lengths, texts
    Show(Show),
    /// Look for everything that is against the rules in a device description
    Check(Check),
}

#[derive(Debug, Args)]
struct Export {
    /// Drive model
    #[arg(long, value_parser = simulated(), value_name = "MODEL", default_value = "akd")]
    model: &'static Model,
    /// Folder to write into; the rules give the names of the files
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    output: PathBuf,
}

#[derive(Debug, Args)]
struct Show {
    /// Device description (.xml)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Names in another language of the file, for example de
    #[arg(long, value_name = "LANGUAGE")]
    language: Option<String>,
    /// Show all texts too
    #[arg(long)]
    texts: bool,
}

#[derive(Debug, Args)]
struct Check {
    /// Device description (.xml)
    #[arg(value_name = "FILE")]
    file: PathBuf,
}

pub fn run(args: &Gsdml, output: &Output) -> Result<(), Failure> {
    match &args.what {
        What::Export(args) => export::run(args, output),
        What::Show(args) => show::run(args, output),
        What::Check(args) => check::run(args, output),
    }
}

/// The octets of a file, not more than a description may have.
fn octets(path: &Path) -> Result<Vec<u8>, Failure> {
    let failed = |error: std::io::Error| {
        Failure::new(Exit::Failed, format!("cannot read {}: {error}", path.display()))
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
            Exit::Failed,
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
