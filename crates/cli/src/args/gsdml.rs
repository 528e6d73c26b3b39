//! Device descriptions.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Subcommand};
use virtual_drive::model::Model;

use super::{duration, simulated};

/// What to do with device descriptions.
#[derive(Debug, Args)]
pub struct Gsdml {
    #[command(subcommand)]
    pub what: GsdmlCommand,
}

#[derive(Debug, Subcommand)]
pub enum GsdmlCommand {
    /// Write the device description of a virtual drive with its picture, for the engineering tool of a PLC
    Export(GsdmlExport),
    /// Show what a device description says: identity, access points, modules, lengths, texts
    Show(GsdmlShow),
    /// Look for everything that is against the rules in a device description
    Check(GsdmlCheck),
}

#[derive(Debug, Args)]
pub struct GsdmlExport {
    /// Drive model
    #[arg(long, value_parser = simulated(), value_name = "MODEL", default_value = "akd")]
    pub model: &'static Model,
    /// Fastest update time in the description: 1, 2, 4, 8 .. 512 ms; that of the model when left out. For drives of `simulate` with
    /// the same option
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub min_cycle: Option<Duration>,
    /// Folder to write into; the rules give the names of the files
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    pub output: PathBuf,
}

#[derive(Debug, Args)]
pub struct GsdmlShow {
    /// Device description (.xml)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Names in another language of the file, for example de
    #[arg(long, value_name = "LANGUAGE")]
    pub language: Option<String>,
    /// Show all texts too
    #[arg(long)]
    pub texts: bool,
}

#[derive(Debug, Args)]
pub struct GsdmlCheck {
    /// Device description (.xml)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
}
