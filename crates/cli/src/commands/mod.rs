//! One file per verb.

mod completions;
mod decode;
mod explain;

use crate::args::{Cli, Command};
use crate::failure::Failure;
use crate::output::Output;

/// Runs what was asked for.
pub fn run(cli: &Cli, output: &Output) -> Result<(), Failure> {
    match &cli.command {
        Command::Explain(args) => explain::run(args, output),
        Command::Decode(args) => decode::run(args, output),
        Command::Completions(args) => completions::run(args, output),
        _ => Err(Failure::usage("not part of this build")),
    }
}
