//! The `profidrive` command: arguments in, rooms composed, words out. Owns no protocol logic.
#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr, clippy::disallowed_methods)] // only `output` prints

mod advice;
mod args;
mod cache;
mod commands;
mod completion;
mod config;
mod confirm;
mod connect;
mod failure;
mod live_plot;
mod output;
mod render;

use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind as Mistake};
use client::{Advice, ErrorKind};

use crate::args::Cli;
use crate::config::Config;
use crate::failure::{Failure, exit_code};
use crate::output::Output;

fn main() -> ExitCode {
    if let Some(completed) = completion::requested(&Output::new(false, true)) {
        // a shell shows nothing else of it
        return completed.map_or_else(|failure| exit_code(failure.kind).into(), |()| ExitCode::SUCCESS);
    }
    let mut cli = match Cli::read(std::env::args_os()) {
        Ok(cli) => cli,
        Err(error) => return misunderstood(&error, args::named(std::env::args_os())),
    };
    let (config, wrong) = match Config::read() {
        Ok(config) => (config, None),
        Err(failure) => (Config::default(), Some(failure)),
    };
    cli.interface.configured = config.interface;
    let output = Output::new(cli.global.json, cli.global.quiet)
        .coloured(config.colours)
        .with_details(cli.verbose)
        .of_command(cli.name.clone())
        .about(cli.drive.as_deref());
    let result = match wrong {
        // a configuration that is not valid keeps no drive from being stopped
        Some(wrong) if matches!(cli.command, args::Command::Stop(_)) => {
            output.warn(&wrong.message);
            commands::run(&cli, &output)
        }
        Some(wrong) => Err(wrong),
        None => commands::run(&cli, &output),
    };
    output.end(result.as_ref().err());
    let lost = output.lost();
    if let Some(failure) = &lost {
        output.error(failure);
    }
    // what went wrong with the drive counts more than what became of the words about it
    match result.err().or(lost) {
        None => ExitCode::SUCCESS,
        Some(failure) => ExitCode::from(exit_code(failure.kind)),
    }
}

/// An invalid command line, or one that requests help. With `--json` a mistake is a document too.
fn misunderstood(error: &clap::Error, command: String) -> ExitCode {
    let json = error.use_stderr() && std::env::args_os().any(|argument| argument == "--json");
    // a configuration that is not valid is reported by a line that is
    let config = Config::read().unwrap_or_default();
    let output = Output::new(json, false)
        .coloured(config.colours)
        .of_command(command);
    if error.use_stderr() {
        output.styled_error(&error.render());
    } else {
        output.styled(&error.render());
    }
    output.fail(&mistake(error));
    if let Some(failure) = output.lost() {
        output.error(&failure);
        return ExitCode::from(exit_code(failure.kind));
    }
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or_else(|_| exit_code(ErrorKind::Usage)))
}

/// Returns the failure of a command line that is not valid: its message, what is missing or possible, and suggestions.
fn mistake(error: &clap::Error) -> Failure {
    let text = error.render().to_string();
    let message = text
        .lines()
        .next()
        .unwrap_or_default()
        .trim_start_matches("error: ");
    let values = |kind| match error.get(kind) {
        Some(ContextValue::String(value)) => vec![value.clone()],
        Some(ContextValue::Strings(values)) => values.clone(),
        Some(ContextValue::StyledStrs(values)) => values.iter().map(ToString::to_string).collect(),
        _ => Vec::new(),
    };
    let mut details = match error.kind() {
        Mistake::MissingRequiredArgument => values(ContextKind::InvalidArg),
        Mistake::ArgumentConflict => values(ContextKind::PriorArg),
        _ => Vec::new(),
    };
    let possible = [ContextKind::ValidValue, ContextKind::ValidSubcommand]
        .map(values)
        .concat();
    if !possible.is_empty() {
        details.push(format!("possible values: {}", possible.join(", ")));
    }
    let similar = [
        ContextKind::SuggestedArg,
        ContextKind::SuggestedSubcommand,
        ContextKind::SuggestedValue,
    ];
    let similar = similar.map(values).concat();
    let similar = similar.iter().map(|similar| format!("similar: '{similar}'"));
    let hints: Vec<String> = similar.chain(values(ContextKind::Suggested)).collect();
    Failure {
        details,
        hint: if hints.is_empty() {
            Advice::default()
        } else {
            hints.join("; ").into()
        },
        ..Failure::usage(message)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(line: &str) -> Failure {
        match Cli::read(line.split(' ')) {
            Ok(_) => panic!("{line} is accepted"),
            Err(error) => mistake(&error),
        }
    }

    #[test]
    fn verbose_is_an_option_of_what_reaches_a_drive() {
        for line in [
            "-v read akd-1 930",
            "read akd-1 930 -v",
            "-v simulate --name akd-1",
        ] {
            let cli = Cli::read(format!("profidrive {line}").split(' ')).expect(line);
            assert!(cli.verbose, "{line}");
        }
        let cli = Cli::read("profidrive read akd-1 930".split(' ')).expect("a command");
        assert!(!cli.verbose);
        for line in ["explain 1 --as stw1", "gsdml check a.xml", "decode a.pcap"] {
            let before = of(&format!("profidrive -v {line}"));
            assert!(
                before
                    .message
                    .ends_with("reaches no drive: --verbose has no meaning for it"),
                "{}",
                before.message
            );
            let after = of(&format!("profidrive {line} -v"));
            assert!(
                after.message.contains("unexpected argument '-v'"),
                "{}",
                after.message
            );
        }
    }

    #[test]
    fn a_mistake_on_the_command_line_keeps_what_is_listed_and_what_to_do() {
        let missing = of("profidrive read");
        assert_eq!(missing.details, ["<DRIVE>", "<PARAM>..."]);
        assert_eq!(missing.kind, ErrorKind::Usage);
        let misspelt = of("profidrive raed akd-1");
        assert_eq!(misspelt.message, "unrecognized subcommand 'raed'");
        assert!(misspelt.hint.to_string().contains("'read'"));
        let choices = of("profidrive explain 1 --as nothing").details;
        assert!(
            choices.iter().any(|line| line.contains("possible values: stw1")),
            "{choices:?}"
        );
    }
}
