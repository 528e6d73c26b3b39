//! The examination of this computer and its network, and files about a whole machine.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use super::duration;

#[derive(Debug, Args)]
pub struct Doctor {
    /// The drives to examine the way to: one, a list (akd-1,akd-2), a pattern (akd-*), model=vlt, vendor=danfoss, @line1 of
    /// the machine file, or all
    #[arg(default_value = "all")]
    pub drive: String,
}

#[derive(Debug, Args)]
pub struct Bundle {
    /// The zip file to write; nothing is replaced
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Also capture the traffic of the interface for this time while the drives are read; what `decode --keep` kept before is added
    /// anyway
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub capture: Option<Duration>,
    /// Also this file: a capture, a log, the machine file; may be given several times
    #[arg(long, value_name = "FILE")]
    pub add: Vec<PathBuf>,
}

#[derive(Debug, Args)]
pub struct Report {
    /// The HTML file to write; nothing is replaced
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}
