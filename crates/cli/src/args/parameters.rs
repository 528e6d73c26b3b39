//! Parameters: read, write, list, describe.

use clap::Args;

#[derive(Debug, Args)]
pub struct Read {
    /// Parameters: DRV.ACC, 930, p930, r947[0], 947[0..7], 0x3A2; of a VLT 1-20, of a Vacon ID103
    #[arg(required = true, value_name = "PARAM")]
    pub parameters: Vec<String>,
    /// Also show the raw value in hexadecimal
    #[arg(long)]
    pub raw: bool,
}

#[derive(Debug, Args)]
pub struct Write {
    /// Assignments: DRV.ACC=5000rpm/s, 930=1, p930=0x0001; of a VLT 3-41=5s, of a Vacon ID103=5s
    #[arg(required = true, value_name = "PARAM=VALUE")]
    pub assignments: Vec<String>,
    /// Check and show, but write nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Save the values in the drive, so that they outlive a power cycle (AKD: DRV.NVSAVE saves all settings; VLT: these values)
    #[arg(long, conflicts_with = "dry_run")]
    pub save: bool,
    /// Write to several drives without asking
    #[arg(long)]
    pub yes: bool,
}

#[derive(Debug, Args)]
pub struct List {
    /// Only parameters with this text in name, number or description
    #[arg(long, value_name = "TEXT")]
    pub filter: Option<String>,
    /// Read and show the values too
    #[arg(long)]
    pub values: bool,
    /// Also show the raw value in hexadecimal
    #[arg(long, requires = "values")]
    pub raw: bool,
}

#[derive(Debug, Args)]
pub struct Describe {
    /// Parameter: DRV.ACC, 930, p930, 0x3A2; of a VLT 1-20, of a Vacon ID103
    #[arg(value_name = "PARAM")]
    pub parameter: String,
}
