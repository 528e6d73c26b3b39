//! One file per verb, or per family of verbs that share their words.

mod address;
mod completions;
mod decode;
mod demo;
mod explain;
mod info;
mod motion;
mod parameters;
mod scan;
mod simulate;

use crate::args::{Cli, Command};
use crate::failure::Failure;
use crate::output::Output;

/// Runs what was asked for.
pub fn run(cli: &Cli, output: &Output) -> Result<(), Failure> {
    let global = &cli.global;
    match &cli.command {
        Command::Scan(args) => scan::run(args, global, output),
        Command::Name(args) => address::name(args, global, output),
        Command::Ip(args) => address::ip(args, global, output),
        Command::Blink(args) => address::blink(args, global, output),
        Command::Reset(args) => address::reset(args, global, output),
        Command::Info(args) => info::run(args, global, output),
        Command::Read(args) => parameters::read(args, global, output),
        Command::Write(args) => parameters::write(args, global, output),
        Command::List(args) => parameters::list(args, global, output),
        Command::Describe(args) => parameters::describe(args, global, output),
        Command::Run(args) => motion::run(args, global, output),
        Command::Jog(args) => motion::jog(args, global, output),
        Command::Ack(args) => motion::ack(args, global, output),
        Command::Monitor(args) => motion::monitor(args, global, output),
        Command::Explain(args) => explain::run(args, output),
        Command::Decode(args) => decode::run(args, output),
        Command::Simulate(args) => simulate::run(args, global, output),
        Command::Demo(args) => demo::run(args, output),
        Command::Completions(args) => completions::run(args, output),
    }
}
