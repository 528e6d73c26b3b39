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
    output.fail(&mistake(&error.render().to_string()));
    if let Some(failure) = output.lost() {
        output.error(&failure);
        return ExitCode::from(failure.exit as u8);
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(Exit::Usage as u8))
}

/// Returns the failure that the reader of the command line words: a message, indented details and tips, then the usage.
fn mistake(text: &str) -> Failure {
    let mut lines = text
        .lines()
        .take_while(|line| !line.starts_with("Usage:"))
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with("For more information"));
    let message = lines.next().unwrap_or_default();
    let (tips, details): (Vec<&str>, Vec<&str>) = lines.partition(|line| line.starts_with("tip: "));
    let hint = tips.iter().map(|tip| tip.trim_start_matches("tip: "));
    Failure {
        details: details.into_iter().map(str::to_owned).collect(),
        hint: Some(hint.collect::<Vec<_>>().join("; ")).filter(|hint| !hint.is_empty()),
        ..Failure::usage(message.trim_start_matches("error: "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(line: &str) -> Failure {
        match Cli::read(line.split(' ')) {
            Ok(_) => panic!("{line}"),
            Err(error) => mistake(&error.render().to_string()),
        }
    }

    #[test]
    fn a_mistake_on_the_command_line_keeps_what_is_listed_and_what_to_do() {
        let missing = of("profidrive read");
        assert_eq!(missing.details, ["<DRIVE>", "<PARAM>..."]);
        assert_eq!(missing.exit, Exit::Usage);
        let misspelt = of("profidrive raed akd-1");
        assert_eq!(misspelt.message, "unrecognized subcommand 'raed'");
        assert!(misspelt.hint.is_some_and(|hint| hint.contains("'read'")));
        let choices = of("profidrive explain 1 --as nothing").details;
        assert!(
            choices.iter().any(|line| line.contains("possible values: stw1")),
            "{choices:?}"
        );
    }
}
