//! The `profidrive` command: arguments in, rooms composed, words out. Owns no protocol logic.
#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr, clippy::disallowed_methods)] // only `output` prints

mod advice;
mod args;
mod commands;
mod connect;
mod failure;
mod output;
mod render;

use std::process::ExitCode;

use crate::args::Cli;
use crate::failure::{Exit, Failure};
use crate::output::Output;

fn main() -> ExitCode {
    let cli = match Cli::read(std::env::args_os()) {
        Ok(cli) => cli,
        Err(error) => return misunderstood(&error, args::named(std::env::args_os())),
    };
    let output = Output::new(cli.global.json, cli.global.quiet)
        .with_details(cli.global.verbose)
        .of_command(cli.name.clone())
        .about(commands::drive(&cli.command));
    let result = commands::run(&cli, &output);
    output.end(result.as_ref().err());
    let lost = output.lost();
    if let Some(failure) = &lost {
        output.error(failure);
    }
    // what went wrong with the drive counts more than what became of the words about it
    match result.err().or(lost) {
        None => ExitCode::SUCCESS,
        Some(failure) => ExitCode::from(failure.exit as u8),
    }
}

/// A command line that is none, or that requests help. With `--json` a mistake is a document too.
fn misunderstood(error: &clap::Error, command: String) -> ExitCode {
    let json = error.use_stderr() && std::env::args_os().any(|argument| argument == "--json");
    let output = Output::new(json, false).of_command(command);
    if error.use_stderr() {
        output.styled_error(&error.render());
    } else {
        output.styled(&error.render());
    }
    let text = error.render().to_string();
    let message = text.lines().next().unwrap_or_default();
    output.fail(&Failure::usage(message.trim_start_matches("error: ")));
    if let Some(failure) = output.lost() {
        output.error(&failure);
        return ExitCode::from(failure.exit as u8);
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(Exit::Usage as u8))
}
