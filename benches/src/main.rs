//! Comparison benchmarks: every figure beside its limit or a peer measured in the same run.
//!
//! `make bench` runs all; `make bench ARGS=round-trip` one section. `ARGS=python` and `ARGS=workbench` are other programs, with a
//! browser and without this one (`tools/bench`). The figures are of this machine at this moment: read the
//! columns against each other.
#![forbid(unsafe_code)]
// A benchmark reports by panicking when what it measures does not work.
#![allow(clippy::unwrap_used, clippy::panic)]

// the benchmarks and tests of the crates that are measured here too know their crate by its own name
extern crate profile as profidrive_profile;
extern crate virtual_drive as profidrive_virtual_drive;

mod core;
mod cycles;
mod drives;
mod fleet;
mod parameters;
mod round_trip;
mod table;
mod virtual_time;

use std::process::ExitCode;

type Section = (&'static str, fn() -> Vec<table::Row>);

const SECTIONS: &[Section] = &[
    ("core", core::compare),
    ("round-trip", round_trip::compare),
    ("cpu", cycles::cpu),
    ("start", cycles::start),
    ("parameters", parameters::compare),
    ("virtual-time", virtual_time::compare),
    ("fleet", fleet::compare),
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        // the programs that the sections start
        ["echo", address] => {
            round_trip::echo(address);
            return ExitCode::SUCCESS;
        }
        ["pace", address, millis, seconds] => {
            round_trip::pace(address, millis, seconds);
            return ExitCode::SUCCESS;
        }
        ["ask", address, port, vendor, count] => {
            round_trip::ask(address, port, vendor, count);
            return ExitCode::SUCCESS;
        }
        ["stalls"] => {
            fleet::watch_stalls();
            return ExitCode::SUCCESS;
        }
        ["read-all", interface] => {
            parameters::read_all(interface);
            return ExitCode::SUCCESS;
        }
        _ => {}
    }
    let chosen: Vec<&Section> = SECTIONS
        .iter()
        .filter(|(name, _)| words.is_empty() || words.contains(name))
        .collect();
    if chosen.is_empty() {
        let names: Vec<&str> = SECTIONS.iter().map(|(name, _)| *name).collect();
        eprintln!("usage: comparisons [{}]...", names.join(" | "));
        return ExitCode::from(2);
    }
    let mut rows = Vec::new();
    for (name, section) in chosen {
        eprintln!("measuring {name}");
        rows.extend(section());
    }
    if table::print(&rows) {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
