//! Prints the events of a simulation, in a thread of its own: a terminal that takes no more text must not hold up a cycle.

use std::thread::{JoinHandle, sleep, spawn};
use std::time::Duration;

use plant::host::{DriveEvent, Event, EventSender, HostError, SaveResult, events};
use profidrive::report::SimulationEvent;

use crate::failure::Failure;
use crate::output::Output;
use crate::render::Page;

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
            output.report_event(&SimulationEvent {
                time: at.as_secs_f64(),
                drive: drive.to_string(),
                text: of_drive(what),
            });
        }
        Event::Running { .. } => output.say(&format!("{event}; Ctrl-C ends")),
        _ => output.say(&event.to_string()),
    }
}

impl Page for SimulationEvent {
    fn print(&self, output: &Output) {
        let Self { time, drive, text } = self;
        output.line(&format!("{time:>10.3} s  {drive:<16} {}", text.trim_end()));
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
