//! `profidrive ack`, `profidrive monitor`

use client::Wait;
use profidrive::monitor::{Monitor, MonitorError, Observation};
use profidrive::motion;
use profidrive::report::MonitorReading;
use profile::notation::ParameterReference;
use profile::value::{ParameterProblem, Selection};

use super::axis::{self, UNLIMITED, fault_text};
use crate::advice::Commands;
use crate::args::{self, Ack, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::{hex16, value};

pub fn ack(args: &Ack, target: &Target, output: &Output) -> Result<(), Failure> {
    let control = axis::control(&args.cyclic)?;
    let need = if args.by_parameter {
        Need::Records
    } else {
        Need::Cyclic
    };
    let report = axis::with_drive(target, need, output, |session, drive| {
        let observer = axis::observer(&drive.label(), Box::new(|_, _| None), output);
        if args.by_parameter {
            motion::acknowledge_by_parameter(session, drive, &observer).wait()
        } else {
            motion::acknowledge(session, drive, &control, &observer).wait()
        }
    })?;
    if args.by_parameter {
        output.say("no fault is present");
    } else if !report.released {
        output.say("no fault: nothing to acknowledge");
    }
    Ok(())
}

pub fn monitor(args: &args::Monitor, target: &Target, output: &Output) -> Result<(), Failure> {
    let monitor = Monitor::new(args.every).map_err(|error| {
        Failure::usage(format!("--every: {error}"))
            .hint("faster than that the parameter channel of the drive is blocked for others")
    })?;
    let references: Vec<ParameterReference> = args
        .parameters
        .iter()
        .map(|text| {
            text.parse()
                .map_err(|error| Failure::from(ParameterProblem::from(error)))
        })
        .collect::<Result<_, _>>()?;
    let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
    let more: Vec<Selection> = references
        .iter()
        .map(|reference| drive.parameters.select(reference))
        .collect::<Result<_, _>>()?;
    let mut monitor = monitor.with(more);
    output.say(&format!("watching {}, reads only; Ctrl-C ends", drive.label()));
    let end = session.now() + args.time.unwrap_or(UNLIMITED);
    let label = drive.label();
    loop {
        let (printer, silent) = (output.clone(), label.clone());
        let silent = move || printer.warn(&format!("{silent} does not answer; waiting for it"));
        let Some(seen) = monitor
            .read_reporting_silence(&mut session, &mut drive, silent)
            .wait()?
        else {
            break;
        };
        show(&seen, args.raw, output);
        for fault in &seen.faults {
            output.warn(&fault_text(fault));
        }
        if !monitor.pause(&mut session, end).wait()? {
            break;
        }
    }
    Ok(session.close().wait()?)
}

impl From<MonitorError> for Failure {
    fn from(error: MonitorError) -> Self {
        let advice = error.advice();
        match error {
            MonitorError::Client(error) if !MonitorError::is_of_drive(&error) => error.into(),
            other => Self::new(other.kind(), other.to_string()).hint(advice),
        }
    }
}

fn show(seen: &Observation, raw: bool, output: &Output) {
    let (time, snapshot) = (seen.time.as_secs_f64(), &seen.snapshot);
    let reading = MonitorReading::new(time, snapshot, &Commands::any());
    output.json_event(&reading);
    if output.json() {
        return;
    }
    let state = reading.words.zsw1.and_then(|word| word.meaning);
    let word = |word: Option<u16>| word.map_or_else(|| "-".into(), hex16);
    let speed =
        |reading: &Option<profile::value::Reading>| reading.as_ref().map_or_else(|| "-".into(), value::full);
    let mut line = format!(
        "{:>8.2} s  {:<30}  STW1 {}  ZSW1 {}  set {:>12}  actual {:>12}",
        time,
        state.unwrap_or_else(|| "state unknown".into()),
        word(snapshot.stw1),
        word(snapshot.zsw1),
        speed(&snapshot.speed_set),
        speed(&snapshot.speed_actual),
    );
    if let Some(position) = &snapshot.position {
        line = format!("{line}  position {:>12}", value::full(position));
    }
    for reading in &snapshot.readings {
        match reading {
            Ok(reading) => {
                let name = reading
                    .name
                    .map_or_else(|| reading.shown().to_string(), str::to_owned);
                line = format!("{line}  {name} {}", value::full(reading));
                if raw {
                    line = format!("{line} [{}]", value::raw(reading));
                }
            }
            Err(refusal) => line = format!("{line}  {} {}", refusal.shown, refusal.short()),
        }
    }
    output.line(line.trim_end());
}
