//! The `profidrive` command: arguments in, rooms composed, words out. Owns no protocol logic.
//!
//! A library so that what reads captures, which may be hostile, can be tested and fuzzed as it is; the program itself is
//! [`main`].
#![forbid(unsafe_code)]

mod args;
mod carrier;
mod commands;
mod connect;
mod decode;
mod desk;
mod failure;
mod job;
mod output;
mod reach;
mod render;
mod state;

use std::process::ExitCode;
use std::time::Duration;

use crate::args::Cli;
use crate::decode::Walker;
use crate::failure::{Exit, Failure};
use crate::output::Output;

/// The program: takes its arguments from the command line and gives its exit code.
#[must_use]
pub fn main() -> ExitCode {
    let cli = match Cli::read(std::env::args_os()) {
        Ok(cli) => cli,
        Err(error) => return misunderstood(&error),
    };
    let output = Output::new(cli.global.json, cli.global.quiet);
    let result = commands::run(&cli, &output);
    output.end(result.as_ref().err());
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => ExitCode::from(failure.exit as u8),
    }
}

/// A command line that is none, or that asks for help. With `--json` a mistake is a document too.
fn misunderstood(error: &clap::Error) -> ExitCode {
    // a closed stdout or stderr is nobody's mistake
    let _ = error.print();
    if error.use_stderr() && std::env::args_os().any(|argument| argument == "--json") {
        let text = error.render().to_string();
        let message = text
            .lines()
            .next()
            .unwrap_or_default()
            .trim_start_matches("error: ");
        let failure = Failure::usage(message);
        println!(
            "{}",
            output::document("error", fields! { "error": failure.json() })
        );
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(Exit::Usage as u8))
}

/// What `profidrive decode FILE` says about frames in the order in which they were captured: who, to whom, what. Each
/// frame comes with its time since the first one.
///
/// ```
/// let frame = [0xFF; 60];
/// assert!(profidrive_cli::decode_frames([(std::time::Duration::ZERO, &frame[..])]).is_empty());
/// ```
#[must_use]
pub fn decode_frames<'a>(frames: impl IntoIterator<Item = (Duration, &'a [u8])>) -> Vec<String> {
    let mut walker = Walker::default();
    let notes = frames.into_iter().flat_map(|(at, frame)| walker.frame(at, frame));
    notes
        .map(|note| format!("{} > {}: {} {}", note.from, note.to, note.topic, note.text))
        .collect()
}
