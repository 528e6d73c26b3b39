//! Arguments of the commands for a whole machine.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
pub struct Commission {
    /// The machine file; that of --machine, PROFIDRIVE_MACHINE or the current folder when left out
    pub file: Option<PathBuf>,
    /// Only these drives of the file: akd-1, akd-*, @line1, model=vlt
    #[arg(long, value_name = "SELECTION")]
    pub only: Option<String>,
    /// Show what would be changed, but change nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Change without asking
    #[arg(long, conflicts_with = "dry_run")]
    pub yes: bool,
}
