//! The `profidrive` command: arguments in, rooms composed, words out. Owns no protocol logic.
#![forbid(unsafe_code)]

mod args;
mod commands;
mod connect;
mod decode;
mod failure;
mod job;
mod output;
mod render;
mod state;

use std::process::ExitCode;

use clap::Parser;

use crate::args::Cli;
use crate::failure::Failure;
use crate::output::Output;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let output = Output::new(cli.global.json, cli.global.quiet);
    match commands::run(&cli, &output) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => report(&failure, &output),
    }
}

fn report(failure: &Failure, output: &Output) -> ExitCode {
    if output.json() {
        let mut error = fields! { "kind": failure.exit.word(), "message": failure.message.as_str() };
        if let Some(hint) = &failure.hint {
            error.insert("hint".into(), hint.as_str().into());
        }
        output.document("error", fields! { "error": error });
    }
    output.error(&failure.message, failure.hint.as_deref());
    ExitCode::from(failure.exit as u8)
}
