//! Prints the events of a simulation, in a thread of its own: a terminal that takes no more text must not hold up a cycle.

use std::thread::{JoinHandle, sleep, spawn};
use std::time::Duration;

use plant::host::{DriveEvent, Event, EventSender, HostError, SaveResult, events};

use crate::failure::Failure;
use crate::fields;
use crate::output::Output;

/// How long the end waits for a terminal that takes nothing.
const TIMEOUT: Duration = Duration::from_secs(1);

/// Runs a simulation and prints its events.
pub fn shown(output: &Output, run: impl FnOnce(EventSender) -> Result<(), HostError>) -> Result<(), Failure> {
    let (sender, events) = events();
    let printed = output.clone();
    let printer = spawn(move || events.for_each(|event| print(&event, &printed)));
    let result = run(sender);
    finish(&printer);
    result.map_err(Failure::from)
}

/// Waits until everything is printed, but not for ever.
fn finish(printer: &JoinHandle<()>) {
    let mut left = TIMEOUT;
    while !printer.is_finished() && !left.is_zero() {
        let nap = Duration::from_millis(5).min(left);
        sleep(nap);
        left -= nap;
    }
}

fn print(event: &Event, output: &Output) {
    match event {
        _ if event.is_warning() => output.warn(&warning(event)),
        Event::Drive { drive, at, what } => {
            let (at, text) = (at.as_secs_f64(), of_drive(what));
            if output.json() {
                output.event(
                    "simulate",
                    fields! { "time": at, "drive": &**drive, "text": text },
                );
            } else {
                output.line(&format!("{at:>10.3} s  {drive:<16} {}", text.trim_end()));
            }
        }
        Event::Running { .. } => output.say(&format!("{event}; Ctrl-C ends")),
        _ => output.say(&event.to_string()),
    }
}

fn warning(event: &Event) -> String {
    match event {
        Event::SavedAddress {
            drive,
            saved,
            planned,
        } => format!(
            "{drive}: the address {saved} kept in --state counts, not {planned}; `profidrive ip` changes it"
        ),
        Event::NoControlSocket(why) => {
            format!("`profidrive inject` will not reach these drives: {why}")
        }
        _ => event.to_string(),
    }
}

fn of_drive(what: &DriveEvent) -> String {
    match what {
        DriveEvent::Saved(_, SaveResult::NoFolder) => format!("{what}, without --state"),
        _ => what.to_string(),
    }
}
