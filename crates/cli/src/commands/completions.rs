//! `profidrive completions SHELL`

use clap::CommandFactory;

use crate::args::{Cli, Completions};
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Completions, output: &Output) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "profidrive", &mut script);
    output.raw(&String::from_utf8_lossy(&script));
    Ok(())
}
