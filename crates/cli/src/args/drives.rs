//! Drives: status, faults, back-up, comparison.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
pub struct Status {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Only the sentence, and what else stands in the way
    #[arg(long)]
    pub short: bool,
}

#[derive(Debug, Args)]
pub struct Faults {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// Also the faults that were acknowledged, situation by situation
    #[arg(long)]
    pub history: bool,
}

#[derive(Debug, Args)]
pub struct Backup {
    /// Station name, IP address, MAC address, or fc:PORT/ADDRESS or uss:PORT/ADDRESS
    pub drive: String,
    /// File to write; the settings go to stdout when left out
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Also over a file that is not a backup
    #[arg(long, requires = "output")]
    pub force: bool,
}

#[derive(Debug, Args)]
pub struct Diff {
    /// A backup file or a drive; a file of this name comes first
    #[arg(value_name = "A")]
    pub left: String,
    /// A backup file or a drive
    #[arg(value_name = "B")]
    pub right: String,
}
