//! The `profidrive` command: arguments in, rooms composed, words out. Owns no protocol logic.
//!
//! A library so that what reads captures, which may be hostile, can be tested and fuzzed as it is; the program itself is
//! [`main`].
#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr, clippy::disallowed_methods)] // only `output` prints

mod advice;
mod args;
mod carrier;
mod commands;
mod connect;
mod decode;
mod desk;
mod failure;
mod job;
mod leftover;
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
    let output = Output::new(cli.global.json, cli.global.quiet)
        .with_details(cli.global.verbose)
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

/// A command line that is none, or that asks for help. With `--json` a mistake is a document too.
fn misunderstood(error: &clap::Error) -> ExitCode {
    let output = Output::new(false, false);
    if error.use_stderr() {
        output.styled_error(&error.render());
    } else {
        output.styled(&error.render());
    }
    if error.use_stderr() && std::env::args_os().any(|argument| argument == "--json") {
        let text = error.render().to_string();
        let message = text
            .lines()
            .next()
            .unwrap_or_default()
            .trim_start_matches("error: ");
        let failure = Failure::usage(message);
        output.event("error", fields! { "error": failure.json() });
    }
    if let Some(failure) = output.lost() {
        output.error(&failure);
        return ExitCode::from(failure.exit as u8);
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
    let mut events = Vec::new();
    for (at, frame) in frames {
        events.extend(walker.frame(at, frame));
    }
    events.extend(walker.end());
    events
        .iter()
        .map(|event| format!("{} > {}: {} {}", event.from, event.to, event.topic, event.text))
        .collect()
}

/// What `profidrive decode --hex` says about octets of any kind, from every make: parameter channels, serial telegrams and
/// cyclic data. Octets that are no such thing say nothing.
///
/// ```
/// let told = profidrive_cli::decode_octets(&[0x02, 0x06, 0x81, 0x04, 0x7C, 0x20, 0x00, 0xDD]);
/// assert!(told.iter().any(|line| line.starts_with("FC telegram, address 0x81")));
/// ```
#[must_use]
pub fn decode_octets(octets: &[u8]) -> Vec<String> {
    use job::{JobDrive, pkw, serial, telegram};
    let mut lines = Vec::new();
    for drive in profidrive::model::Model::NAMES
        .iter()
        .filter_map(|name| profidrive::model::Model::by_name(name))
        .map(JobDrive::new)
    {
        let mut told = vec![
            pkw::decode(&drive, drive.ppo(), octets, None),
            serial::decode(&drive, uss::Protocol::Fc, octets, None),
            serial::decode(&drive, uss::Protocol::Uss, octets, None),
        ];
        let rows = drive.tables().map_or(&[][..], |tables| tables.device.telegrams);
        told.extend(
            rows.iter()
                .map(|row| telegram::decode(&drive, row.telegram, octets, None)),
        );
        lines.extend(told.into_iter().flatten().flat_map(|decoded| decoded.lines));
    }
    lines.into_iter().map(|(_, line)| line).collect()
}
