//! Drives: status, faults, back-up, comparison.

use std::path::PathBuf;

use clap::Args;
use client::backup::Pattern;

#[derive(Debug, Args)]
pub struct Status {
    /// Only the sentence, and what else stands in the way
    #[arg(long)]
    pub short: bool,
}

#[derive(Debug, Args)]
pub struct Faults {
    /// Also the faults that were acknowledged, situation by situation
    #[arg(long)]
    pub history: bool,
}

#[derive(Debug, Args)]
pub struct Backup {
    /// File to write; the settings go to stdout when left out
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Also over a file that is not a backup
    #[arg(long, requires = "output")]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct Diff {
    /// A backup file, a folder of backups, a machine file (*.toml) or a drive; a file of this name comes first
    #[arg(value_name = "A")]
    pub left: String,
    /// A backup file or a drive; for a folder or a machine file the drives: all, @line1, akd-*
    #[arg(value_name = "B")]
    pub right: String,
}

#[derive(Debug, Args)]
pub struct Restore {
    /// The backup
    pub file: PathBuf,
    /// Only these parameters: a name with * for any part (MOTOR.*) or a number; may be given several times
    #[arg(long, value_name = "PATTERN")]
    pub only: Vec<Pattern>,
    /// Show what would be written, but write nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Save the values in the drive (DRV.NVSAVE) once all are written and verified, so that they outlive power-off
    #[arg(long)]
    pub save: bool,
    /// Where to write the values that the drive has before; FILE.before-1, -2, .. when left out
    #[arg(long, value_name = "PATH")]
    pub way_back: Option<PathBuf>,
    /// Leave out what the drive cannot keep over power-off
    #[arg(long)]
    pub saved_only: bool,
    /// Also what belongs to the connection: telegram, command source, way to get an address
    #[arg(long)]
    pub network: bool,
    /// Also values outside the limits that are known; the drive then decides
    #[arg(long)]
    pub beyond_limits: bool,
    /// Also to a drive of another model, or while a controller is connected
    #[arg(long)]
    pub force: bool,
}
