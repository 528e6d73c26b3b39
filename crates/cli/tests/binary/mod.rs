//! The program as it is built, run with a line of arguments.

// each test program uses a part of it
#![allow(dead_code)]

use std::process::{Command, Output, Stdio};

/// Returns the program with these arguments, without colours and with nothing from the environment.
pub fn profidrive(line: &[&str]) -> Output {
    run(command(line).env_remove("PROFIDRIVE_INTERFACE"))
}

/// Returns the same where the environment names an interface.
pub fn profidrive_on(interface: &str, line: &[&str]) -> Output {
    run(command(line).env("PROFIDRIVE_INTERFACE", interface))
}

/// Returns the same with what it prints going elsewhere.
pub fn onto(line: &[&str], stdout: Stdio) -> Output {
    run(command(line).env_remove("PROFIDRIVE_INTERFACE").stdout(stdout))
}

fn command(line: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_profidrive"));
    command.args(line).env("NO_COLOR", "1");
    // no file is there: nothing of the configuration of whoever runs the tests
    command.env("XDG_CONFIG_HOME", "/nonexistent");
    command
}

fn run(command: &mut Command) -> Output {
    command.output().expect("the binary runs")
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text")
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("text")
}
