//! The `profidrive` command: arguments in, rooms composed, words out. Owns no protocol logic.
//!
//! A library so that what reads captures, which may be hostile, can be tested and fuzzed as it is; the program itself is
//! [`main`].
#![forbid(unsafe_code)]

mod args;
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

use clap::Parser;

use crate::args::Cli;
use crate::decode::Walker;
use crate::failure::Failure;
use crate::output::Output;

/// The program: takes its arguments from the command line and gives its exit code.
#[must_use]
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let output = Output::new(cli.global.json, cli.global.quiet);
    match commands::run(&cli, &output) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => report(&failure, &output),
    }
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

fn report(failure: &Failure, output: &Output) -> ExitCode {
    if failure.message.is_empty() {
        return ExitCode::from(failure.exit as u8);
    }
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
