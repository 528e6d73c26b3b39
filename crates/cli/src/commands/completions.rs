//! `profidrive completions SHELL`

use crate::args::Completions;
use crate::completion;
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Completions, output: &Output) -> Result<(), Failure> {
    // the names of shells are those of the completers
    let script = completion::script(&args.shell.to_string())?;
    output.raw(&String::from_utf8_lossy(&script));
    Ok(())
}
