//! `profidrive home`

use client::Wait;
use profidrive::motion::{self, Start};

use super::axis;
use super::recorded::Recorder;
use crate::args::{Home, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::value;

pub fn run(args: &Home, target: &Target, output: &Output) -> Result<(), Failure> {
    let mut wanted = motion::Home {
        timeout: args.timeout,
        control: axis::in_mode(&args.control)?,
    };
    let mut recorder = Recorder::of(args.recorded.record.as_deref())?;
    let done = axis::moving(target, Need::Cyclic, output, |session, drive, bound| {
        wanted.control.bound = bound;
        let start =
            Box::new(|start: &_, telegram| Some(format!("homes{}, telegram {telegram}", procedure(start))));
        let observer = recorder.tap(axis::observer(&drive.label(), start, output), session);
        motion::home(session, drive, &wanted, &observer).wait()
    });
    recorder.end(done, output).map(|_| ())
}

/// ` by HOME.MODE 1 (To a limit switch), HOME.DIR 1, HOME.V 60 rpm`, as far as the drive reports it.
fn procedure(start: &Start) -> String {
    let Start::Home { procedure } = start else {
        return String::new();
    };
    let parts = procedure.iter();
    let parts: Vec<String> = parts
        .map(|(name, reading)| format!("{name} {}", value::full(reading)))
        .collect();
    if parts.is_empty() {
        return String::new();
    }
    format!(" by {}", parts.join(", "))
}
