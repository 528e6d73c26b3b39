//! Prints the events of a simulation, in a thread of its own: a terminal that takes no more text must not hold up a cycle.

use std::thread::{JoinHandle, sleep, spawn};
use std::time::Duration;

use plant::EventKind;
use plant::host::{DriveEvent, Event, EventSender, HostError, Load, SaveResult, events};
use plant::metrics::MetricsServer;
use profidrive::report::SimulationReport;

use crate::failure::Failure;
use crate::output::Output;
use crate::render::Page;

/// How long the end waits for a terminal that takes nothing.
const TIMEOUT: Duration = Duration::from_secs(1);

/// Time between two summaries while nothing changes.
const QUIET: Duration = Duration::from_secs(10);

/// Shows what a simulation does.
pub struct Printer {
    output: Output,
    /// What all drives do is printed, not what happens to each.
    summary: bool,
    metrics: Option<MetricsServer>,
    /// The load printed last.
    printed: Load,
}

impl Printer {
    pub fn new(output: &Output, summary: bool, metrics: Option<MetricsServer>) -> Self {
        Self {
            output: output.clone(),
            summary,
            metrics,
            printed: Load::default(),
        }
    }

    /// Runs a simulation and shows its events.
    pub fn show<T>(mut self, run: impl FnOnce(EventSender) -> Result<T, HostError>) -> Result<T, Failure> {
        let (sender, events) = events();
        let printer = spawn(move || events.for_each(|event| self.take(&event)));
        let result = run(sender);
        finish(&printer);
        result.map_err(Failure::from)
    }

    fn take(&mut self, event: &Event) {
        let output = &self.output;
        match event {
            _ if event.is_warning() => output.warn(&warning(event)),
            Event::Drive { drive, at, what } => {
                let kind = match what.kind() {
                    EventKind::Note { .. } => EventKind::Note { text: of_drive(what) },
                    kind => kind,
                };
                let report = SimulationReport::Drive(plant::Event::new(*at, drive, kind));
                if !self.summary || output.verbose() || what.is_commanded() {
                    output.report_event(&report);
                } else {
                    output.json_event(&report);
                }
            }
            Event::Load(load) => self.take_load(load),
            Event::Running { .. } => output.say(&format!("{event}; Ctrl-C ends")),
            _ => output.say(&event.to_string()),
        }
    }

    fn take_load(&mut self, load: &Load) {
        if let Some(metrics) = &self.metrics {
            metrics.publish(*load);
        }
        let passed = load.since(&self.printed);
        let changed = load.exchanging != self.printed.exchanging || passed.frames.missed > 0;
        if self.summary && (changed || passed.time >= QUIET) {
            self.printed = *load;
            self.output.json_event(&SimulationReport::Load(load.into()));
            self.output
                .say(&format!("{:>8.0} s  {passed}", load.time.as_secs_f64()));
        }
    }
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

impl Page for SimulationReport {
    fn print(&self, output: &Output) {
        if let Self::Drive(plant::Event {
            time, drive, kind, ..
        }) = self
        {
            let text = kind.to_string();
            output.line(&format!("{time:>10.3} s  {drive:<16} {}", text.trim_end()));
        }
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
