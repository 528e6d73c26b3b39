//! `profidrive ack`, `profidrive monitor`

use std::time::Duration;

use client::{Drive, Error, ErrorKind, Session, Snapshot, Wait};
use profidrive::motion;
use profidrive::report::MonitorReading;
use profile::notation::ParameterReference;
use profile::state::{State, Zsw1};
use profile::value::{ParameterProblem, Selection};

use super::axis::{self, FOR_EVER, fault_text};
use crate::advice::Commands;
use crate::args::{Ack, Monitor, Target};
use crate::connect::{self, Live, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::{hex16, value, words};

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

/// The shortest time between two readings of a monitor: a drive has other callers too.
const FASTEST: Duration = Duration::from_millis(10);

pub fn monitor(args: &Monitor, target: &Target, output: &Output) -> Result<(), Failure> {
    if args.every < FASTEST {
        return Err(
            Failure::usage(format!("--every: at least {} ms", FASTEST.as_millis()))
                .hint("faster than that the parameter channel of the drive is blocked for others"),
        );
    }
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
    output.say(&format!("watching {}, reads only; Ctrl-C ends", drive.label()));
    let start = session.now();
    let end = start + args.time.unwrap_or(FOR_EVER);
    let (mut counted, mut shown) = (None, Vec::new());
    loop {
        let begin = session.now();
        let snapshot = match answered(&mut session, &mut drive, &more, output) {
            Ok(None) => break,
            Ok(Some(snapshot)) => snapshot,
            Err(failure) => {
                // the device does not answer, so there is no orderly release
                session.forget(&drive);
                return Err(failure);
            }
        };
        show_snapshot(begin - start, &snapshot, args.raw, output);
        // PNU 944 may count situations only: a further fault of one is in the buffer alone
        let again = counted != snapshot.fault_counter;
        counted = snapshot.fault_counter;
        if again || general(&snapshot).is_some_and(|(zsw1, _)| words::has_fault(zsw1)) {
            let faults = session.faults(&mut drive).wait().unwrap_or_default();
            let present = || faults.iter().filter(|fault| fault.situation == 0);
            for fault in present().filter(|fault| again || !shown.contains(&fault.number)) {
                output.warn(&fault_text(fault));
            }
            shown = present().map(|fault| fault.number).collect();
        }
        let next = (begin + args.every).min(end);
        let time = next - session.now();
        match session.pass(time).wait() {
            Err(Error::Interrupted) => break,
            other => other?,
        }
        if session.now() >= end {
            break;
        }
    }
    Ok(session.close().wait()?)
}

/// A drive usually answers within milliseconds; a longer silence is reported.
const SILENCE: Duration = Duration::from_secs(1);

/// Returns the answer of the drive; `None` when the user ends the command. A silent drive is reported at once.
fn answered(
    session: &mut Live,
    drive: &mut Drive,
    more: &[Selection],
    output: &Output,
) -> Result<Option<Snapshot>, Failure> {
    let begin = session.now();
    let label = drive.label();
    let (printer, silent) = (output.clone(), label.clone());
    let result = session
        .reporting_silence(
            SILENCE,
            async |session: &mut Session| session.snapshot(drive, more).await,
            move || printer.warn(&format!("{silent} does not answer; waiting for it")),
        )
        .wait();
    let waited = session.now() - begin;
    match result {
        Ok(snapshot) => Ok(Some(snapshot)),
        Err(Error::Interrupted) if waited < SILENCE => Ok(None),
        Err(Error::Interrupted) => Err(gone(Failure::new(
            ErrorKind::Unreachable,
            format!("{label} has not answered for {:.1} s", waited.as_secs_f64()),
        ))),
        Err(error) => {
            let failure = Failure::from(error);
            Err(match failure.kind {
                ErrorKind::Unreachable => gone(failure),
                _ => failure,
            })
        }
    }
}

fn gone(failure: Failure) -> Failure {
    failure.hint("check power and cable of the drive; {scan} lists who answers")
}

/// Returns status and control word in the bits of the profile, independent of the model.
fn general(snapshot: &Snapshot) -> Option<(u16, Option<u16>)> {
    let sent = snapshot.stw1;
    let zsw1 = snapshot.profile.zsw1(snapshot.zsw1?, sent.unwrap_or_default());
    let runs = zsw1.has(Zsw1::READY_TO_OPERATE);
    let state = if runs { State::S4 } else { State::S2 };
    Some((
        zsw1.0,
        sent.map(|word| snapshot.profile.orders(word, state).stw1.0),
    ))
}

fn show_snapshot(time: Duration, snapshot: &Snapshot, raw: bool, output: &Output) {
    let state = general(snapshot);
    output.json_event(&MonitorReading::new(
        time.as_secs_f64(),
        snapshot,
        &Commands::any(),
    ));
    if output.json() {
        return;
    }
    let word = |word: Option<u16>| word.map_or_else(|| "-".into(), hex16);
    let speed =
        |reading: &Option<profile::value::Reading>| reading.as_ref().map_or_else(|| "-".into(), value::full);
    let mut line = format!(
        "{:>8.2} s  {:<30}  STW1 {}  ZSW1 {}  set {:>12}  actual {:>12}",
        time.as_secs_f64(),
        state.map_or_else(|| "state unknown".into(), |(zsw1, stw1)| words::state(zsw1, stw1)),
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
