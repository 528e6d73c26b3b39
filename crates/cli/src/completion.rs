//! Completion of a command line by the program itself, when a shell requests it: drives of the last search, groups of the machine
//! file, parameters, faults. Nothing is sent and no network is opened.

use std::ffi::{OsStr, OsString};

use clap::{Arg, Command};
use clap_complete::CompletionCandidate;
use clap_complete::engine::{ArgValueCompleter, PathCompleter, ValueCompleter};
use clap_complete::env::{EnvCompleter, Shells};
use client::ErrorKind;
use profidrive::machine::Machine;
use profidrive::report;
use profile::catalogue::{Catalogue, CommonName, Fault};
use profile::model::Model;
use profile::telegram::SIGNALS;

use crate::args::{self, DriveOptions};
use crate::cache::{self, Known};
use crate::connect;
use crate::failure::Failure;
use crate::output::Output;

/// The variable by which the script of a shell requests completions; its value is the shell.
const VARIABLE: &str = "PROFIDRIVE_COMPLETE";

/// Returns the script of a shell, which has this program complete the line.
pub fn script(shell: &str) -> Result<Vec<u8>, Failure> {
    const PROGRAM: &str = "profidrive";
    let mut script = Vec::new();
    completer(shell)?
        .write_registration(VARIABLE, PROGRAM, PROGRAM, PROGRAM, &mut script)
        .map_err(|error| Failure::new(ErrorKind::Internal, format!("cannot make the script: {error}")))?;
    Ok(script)
}

/// Completes the line that a shell passes behind `--`; `None` where none requests it.
pub fn requested(output: &Output) -> Option<Result<(), Failure>> {
    let shell = std::env::var(VARIABLE).ok().filter(|shell| !shell.is_empty())?;
    Some(respond(&shell, output))
}

fn respond(shell: &str, output: &Output) -> Result<(), Failure> {
    let words: Vec<OsString> = std::env::args_os()
        .skip_while(|word| word != "--")
        .skip(1)
        .collect();
    let mut found = Vec::new();
    let folder = std::env::current_dir().ok();
    let mut command = completing(args::command(), &words);
    command.build();
    completer(shell)?
        .write_complete(&mut command, words, folder.as_deref(), &mut found)
        .map_err(|error| Failure::new(ErrorKind::Internal, format!("cannot complete: {error}")))?;
    output.candidates(&String::from_utf8_lossy(&found));
    Ok(())
}

fn completer(shell: &str) -> Result<&'static dyn EnvCompleter, Failure> {
    const SHELLS: Shells<'static> = Shells::builtins();
    SHELLS
        .completer(shell)
        .ok_or_else(|| Failure::usage(format!("there is no completion for the shell `{shell}`")))
}

/// Returns the command line with completers for what only the drives, the machine file and the tables have.
fn completing(command: Command, words: &[OsString]) -> Command {
    let known = cache::known();
    let tables = tables(words, &known);
    let names: Vec<String> = known.into_iter().map(|known| known.name).collect();
    each(command, &|argument| {
        let names = names.clone();
        match argument.get_id().as_str() {
            "drive" | "station" => argument.add(ArgValueCompleter::new(Drives { names, files: false })),
            // a drive or a file
            "left" | "right" | "new" | "old" => {
                argument.add(ArgValueCompleter::new(Drives { names, files: true }))
            }
            "signals" => {
                let tables = tables.clone();
                argument.add(ArgValueCompleter::new(move |begin: &OsStr| {
                    signals(&tables, begin)
                }))
            }
            "parameters" | "parameter" | "assignments" => {
                let tables = tables.clone();
                argument.add(ArgValueCompleter::new(move |begin: &OsStr| {
                    parameters(&tables, begin)
                }))
            }
            "value" => {
                let tables = tables.clone();
                argument.add(ArgValueCompleter::new(move |begin: &OsStr| {
                    faults(&tables, begin)
                }))
            }
            _ => argument,
        }
    })
}

fn each(command: Command, change: &impl Fn(Arg) -> Arg) -> Command {
    command
        .mut_args(change)
        .mut_subcommands(|inner| each(inner, change))
}

/// The tables of the drives that are named in a line; of all models where none is.
fn tables(words: &[OsString], known: &[Known]) -> Vec<&'static Catalogue> {
    let words: Vec<&str> = words.iter().filter_map(|word| word.to_str()).collect();
    let named = |known: &&Known| {
        words
            .iter()
            .any(|word| word.split(',').any(|part| part == known.name))
    };
    let of_drives = known
        .iter()
        .filter(named)
        .filter_map(|known| known.model.as_deref());
    let of_option = words
        .windows(2)
        .filter(|pair| pair[0] == "--model")
        .map(|pair| pair[1]);
    let mut tables: Vec<&'static Catalogue> = Vec::new();
    for model in of_drives.chain(of_option).filter_map(Model::by_name) {
        tables.extend(
            model
                .catalogue
                .filter(|one| !tables.iter().any(|other| other.model == one.model)),
        );
    }
    if tables.is_empty() {
        tables.extend(profile::model::ALL.iter().filter_map(|model| model.catalogue));
    }
    tables
}

/// Drives of the last search, groups of the machine file and the other ways to select drives; the last of a list is completed.
struct Drives {
    names: Vec<String>,
    /// Files are possible in their place.
    files: bool,
}

impl ValueCompleter for Drives {
    fn complete(&self, begin: &OsStr) -> Vec<CompletionCandidate> {
        let Some(text) = begin.to_str() else {
            return Vec::new();
        };
        let (before, last) = text.rsplit_once(',').map_or(("", text), |(_, last)| {
            (text.get(..text.len() - last.len()).unwrap_or_default(), last)
        });
        let machine = connect::machine_path(&DriveOptions::default());
        // a file that is not valid has no groups: the command itself will say so
        let machine = machine.and_then(|path| Machine::read(&path).ok());
        let groups = machine
            .iter()
            .flat_map(|machine| machine.groups().into_iter().map(|name| format!("@{name}")));
        let planned = machine
            .iter()
            .flat_map(|machine| machine.drives.iter().map(|drive| drive.name.clone()));
        let mut all: Vec<String> = self.names.iter().cloned().chain(planned).collect();
        all.extend(groups);
        all.push("all".to_owned());
        // a drive of the machine file may have answered too
        all.sort();
        all.dedup();
        let fitting = all.into_iter().filter(|name| name.starts_with(last));
        let mut found: Vec<CompletionCandidate> = fitting
            .map(|name| CompletionCandidate::new(format!("{before}{name}")))
            .collect();
        if self.files {
            found.extend(PathCompleter::any().complete(begin));
        }
        found
    }
}

fn parameters(tables: &[&'static Catalogue], begin: &OsStr) -> Vec<CompletionCandidate> {
    let begin = begin.to_string_lossy().to_lowercase();
    let common = CommonName::ALL
        .iter()
        .map(|name| (name.name.to_owned(), name.about));
    let own = tables.iter().flat_map(|tables| {
        tables.parameters.iter().map(|one| match one.name.contains(' ') {
            // names of several words are for people; the number of the vendor is what is typed
            true => (report::number(tables, one).replace(' ', ""), one.name),
            false => (one.name.to_owned(), one.description),
        })
    });
    candidates(common.chain(own), &begin)
}

/// Signals of telegrams, and parameters.
fn signals(tables: &[&'static Catalogue], begin: &OsStr) -> Vec<CompletionCandidate> {
    let text = begin.to_string_lossy().to_lowercase();
    let all = SIGNALS
        .iter()
        .map(|signal| (signal.name.to_owned(), signal.meaning));
    let mut found = candidates(all, &text);
    found.extend(parameters(tables, begin));
    found
}

/// The numbers of faults.
fn faults(tables: &[&'static Catalogue], begin: &OsStr) -> Vec<CompletionCandidate> {
    let begin = begin.to_string_lossy().to_lowercase();
    let all = tables.iter().flat_map(|tables| tables.faults.iter());
    let all = all.filter(|fault| !fault.warning);
    // as it is displayed, too
    let lettered = begin.starts_with('f');
    let number = |fault: &Fault| match lettered {
        true => format!("F{}", fault.number),
        false => fault.number.to_string(),
    };
    candidates(all.map(|fault| (number(fault), fault.meaning)), &begin)
}

fn candidates(all: impl Iterator<Item = (String, &'static str)>, begin: &str) -> Vec<CompletionCandidate> {
    let fitting = all.filter(|(name, _)| name.to_lowercase().starts_with(begin));
    fitting
        .map(|(name, about)| CompletionCandidate::new(name).help(Some(about.into())))
        .collect()
}
