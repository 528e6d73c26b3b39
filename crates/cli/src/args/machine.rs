//! Arguments of the commands for a whole machine.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
pub struct Commission {
    /// The machine file; that of --machine, PROFIDRIVE_MACHINE or the current folder when left out
    pub file: Option<PathBuf>,
    /// Write the file from the drives that are there, with a backup of each beside it: all, akd-*, model=vlt
    #[arg(long, value_name = "SELECTION", requires = "file", conflicts_with_all = ["only", "dry_run", "yes"])]
    pub from: Option<String>,
    /// Also over a machine file that exists
    #[arg(long, requires = "from", conflicts_with_all = ["only", "dry_run", "yes"])]
    pub force: bool,
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

#[derive(Debug, Args)]
pub struct Replace {
    /// The new drive: station name, IP address or MAC address
    pub new: String,
    /// Name of the drive that it takes the place of
    pub old: String,
    /// Backup of the old drive, with its address; the machine file when left out
    #[arg(long, value_name = "FILE")]
    pub backup: Option<PathBuf>,
    /// Show what would be changed, but change nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Change without asking
    #[arg(long, conflicts_with = "dry_run")]
    pub yes: bool,
}
