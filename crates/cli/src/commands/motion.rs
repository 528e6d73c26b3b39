//! `profidrive run`, `profidrive jog`, `profidrive ack`, `profidrive monitor`

use std::time::Duration;

use drive_client::axis;
use drive_client::parameter::{ParameterProblem, Selection};
use drive_client::{AxisSettings, Drive, Error, FaultEntry, Snapshot};
use profidrive::notation::{ParameterReference, Quantity};
use profidrive::state::Stw1;
use profinet::cyclic::Timing;
use serde_json::Value;

use crate::args::{Ack, Cyclic, Interface, Jog, Monitor, Run};
use crate::connect::{self, AnyMedium, Live, Need};
use crate::failure::Failure;
use crate::fields;
use crate::output::Output;
use crate::render::live::{AxisView, LiveView};
use crate::render::{hex16, value, words};

type Axis<'s> = drive_client::Axis<'s, AnyMedium>;

/// Longest wait of a run that ends with Ctrl-C only.
const FOR_EVER: Duration = Duration::from_secs(100 * 365 * 24 * 3600);
/// PNUs of the two jog speeds.
const JOG_SPEED: [u16; 2] = [1004, 1005];

fn rpm(quantity: &Quantity, what: &str) -> Result<f64, Failure> {
    quantity
        .in_unit("rpm")
        .map_err(|error| Failure::usage(format!("{what}: {error}")))
}

/// An update time that no connection can have is told before anything is opened.
fn checked(cyclic: &Cyclic) -> Result<(), Failure> {
    match cyclic.cycle {
        Some(cycle) if Timing::for_interval(cycle).is_none() => Err(Failure::usage(format!(
            "--cycle: an update time of {} ms does not exist",
            cycle.as_secs_f64() * 1000.0
        ))
        .hint("use 1, 2, 4, 8 .. 512 ms; left out it is the fastest the drive is known for")),
        _ => Ok(()),
    }
}

fn settings(cyclic: &Cyclic, limit: f64) -> AxisSettings {
    AxisSettings {
        cycle: cyclic.cycle,
        watchdog: cyclic.watchdog,
        speed_limit: limit,
        ..AxisSettings::default()
    }
}

pub fn run(args: &Run, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let speed = rpm(&args.velocity, "--velocity")?;
    let limit = rpm(&args.limit, "--limit")?.abs();
    within(speed, limit)?;
    checked(&args.cyclic)?;
    let (mut session, mut drive) = connect::drive(interface, Need::Cyclic, &args.drive, output)?;
    let time = args.time.map_or_else(
        || "until Ctrl-C".into(),
        |time| format!("for {} s", time.as_secs_f64()),
    );
    output.say(&format!(
        "this moves the axis: {} turns at {speed} rpm {time}; Ctrl-C stops it",
        drive.label()
    ));
    let mut axis = session.take_axis(&mut drive, settings(&args.cyclic, limit))?;
    watch(&mut axis, "run", output);
    let result = axis
        .run(speed)
        .and_then(|()| axis.hold(args.time.unwrap_or(FOR_EVER)));
    finish(axis, result, args.time.is_none(), "run", output)
        .map_err(|error| explained(error, &mut session, &mut drive))?;
    Ok(session.close()?)
}

/// Above the limit nothing is sent at all.
fn within(speed: f64, limit: f64) -> Result<(), Failure> {
    if speed.abs() > limit {
        return Err(Error::SpeedLimit { wanted: speed, limit }.into());
    }
    Ok(())
}

pub fn jog(args: &Jog, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let limit = rpm(&args.limit, "--limit")?.abs();
    let wanted = args
        .velocity
        .as_ref()
        .map(|quantity| rpm(quantity, "--velocity"))
        .transpose()?;
    if let Some(speed) = wanted {
        within(speed, limit)?;
    }
    checked(&args.cyclic)?;
    let (mut session, mut drive) = connect::drive(interface, Need::Cyclic, &args.drive, output)?;
    let (jog, pnu) = match args.jog {
        2 => (axis::Jog::Two, JOG_SPEED[1]),
        _ => (axis::Jog::One, JOG_SPEED[0]),
    };
    let selection = drive.parameters.select(&ParameterReference::number(pnu))?;
    if let Some(speed) = &args.velocity {
        let reference = ParameterReference::number(pnu);
        let assignment = drive_client::parameter::Assignment {
            reference,
            quantity: speed.clone(),
        };
        let outcomes = session.write(&mut drive, &[assignment], drive_client::WriteMode::Write)?;
        if let Some(Err(refusal)) = outcomes.into_iter().find_map(|outcome| outcome.written) {
            return Err(Error::Refused {
                drive: drive.label(),
                refusal,
            }
            .into());
        }
    }
    let speed = session.read_one(&mut drive, &selection)?;
    within(speed.number().unwrap_or(0.0), limit)?;
    output.say(&format!(
        "this moves the axis: {} jogs at {} for {} s; Ctrl-C stops it",
        drive.label(),
        value::full(&speed),
        args.time.as_secs_f64()
    ));
    let mut axis = session.take_axis(&mut drive, settings(&args.cyclic, limit))?;
    watch(&mut axis, "jog", output);
    let result = axis.jog(jog).and_then(|()| axis.hold(args.time));
    finish(axis, result, false, "jog", output).map_err(|error| explained(error, &mut session, &mut drive))?;
    Ok(session.close()?)
}

pub fn ack(args: &Ack, interface: &Interface, output: &Output) -> Result<(), Failure> {
    checked(&args.cyclic)?;
    let (mut session, mut drive) = connect::drive(interface, Need::Cyclic, &args.drive, output)?;
    let faults = session.faults(&mut drive).unwrap_or_default();
    let present: Vec<String> = faults
        .iter()
        .filter(|fault| fault.situation == 0)
        .map(told)
        .collect();
    for fault in &present {
        output.say(fault);
    }
    if present.is_empty() {
        output.say("no fault is present");
    } else {
        output.say(&format!("acknowledging with STW1 {}", Stw1::ACKNOWLEDGE));
    }
    let mut axis = session.take_axis(&mut drive, settings(&args.cyclic, 0.0))?;
    watch(&mut axis, "ack", output);
    let result = axis.ready_or_fault().and_then(|()| axis.acknowledge());
    finish(axis, result, false, "ack", output).map_err(|error| explained(error, &mut session, &mut drive))?;
    Ok(session.close()?)
}

fn watch(axis: &mut Axis<'_>, command: &'static str, output: &Output) {
    let mut view = LiveView::new(output.clone(), command);
    axis.watch(move |status| view.show(&AxisView::of(status)));
}

/// Stops and releases whatever happened, then tells what did.
fn finish(
    axis: Axis<'_>,
    result: Result<(), Error>,
    open_end: bool,
    command: &str,
    output: &Output,
) -> Result<(), Error> {
    let statistics = axis.statistics();
    let released = axis.release();
    let interrupted = matches!(result, Err(Error::Interrupted));
    let result = if interrupted { Ok(()) } else { result };
    if interrupted && !open_end {
        output.say("stopped by Ctrl-C before the time was over");
    }
    let stopped = result.is_ok() && released.is_ok();
    if let Some(statistics) = statistics {
        output.say(&format!(
            "{} cyclic frames taken, {} missed, longest gap {:.1} ms",
            statistics.received,
            statistics.missed,
            statistics.longest_gap.as_secs_f64() * 1000.0
        ));
    }
    if stopped {
        output.say("axis at rest, control released");
    }
    if output.json() && stopped {
        let counts = statistics.map_or_else(Default::default, |counts| {
            fields! { "received": counts.received, "missed": counts.missed }
        });
        output.document(
            command,
            fields! { "end": true, "released": true, "frames": counts },
        );
    }
    result.and(released)
}

/// A fault is told by number and text, not by the bit alone.
fn explained(error: Error, session: &mut Live, drive: &mut Drive) -> Failure {
    let fault = matches!(
        error,
        Error::Axis {
            trouble: axis::Trouble::Fault | axis::Trouble::FaultStays,
            ..
        }
    );
    let mut failure = Failure::from(error);
    if fault {
        let faults = session.faults(drive).unwrap_or_default();
        for fault in faults.iter().filter(|fault| fault.situation == 0) {
            failure.message = format!("{}; {}", failure.message, told(fault));
        }
    }
    failure
}

/// `F702 Fieldbus communication lost`
fn told(fault: &FaultEntry) -> String {
    format!(
        "F{} {}",
        fault.number,
        fault.meaning.unwrap_or("not in the tables")
    )
}

pub fn monitor(args: &Monitor, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let references: Vec<ParameterReference> = args
        .parameters
        .iter()
        .map(|text| {
            text.parse()
                .map_err(|error| Failure::from(ParameterProblem::from(error)))
        })
        .collect::<Result<_, _>>()?;
    let (mut session, mut drive) = connect::drive(interface, Need::Records, &args.drive, output)?;
    let more: Vec<Selection> = references
        .iter()
        .map(|reference| drive.parameters.select(reference))
        .collect::<Result<_, _>>()?;
    output.say(&format!("watching {}, reads only; Ctrl-C ends", drive.label()));
    let end = session.now() + args.time.unwrap_or(FOR_EVER);
    let mut faults_seen = None;
    loop {
        let begin = session.now();
        let snapshot = match session.snapshot(&mut drive, &more) {
            Err(Error::Interrupted) => break,
            other => other?,
        };
        show_snapshot(&snapshot, args.raw, output);
        if faults_seen != snapshot.fault_counter {
            faults_seen = snapshot.fault_counter;
            let faults = session.faults(&mut drive).unwrap_or_default();
            for fault in faults.iter().filter(|fault| fault.situation == 0) {
                output.warn(&told(fault));
            }
        }
        let next = (begin + args.every).min(end);
        match session.pass(next - session.now()) {
            Err(Error::Interrupted) => break,
            other => other?,
        }
        if session.now() >= end {
            break;
        }
    }
    Ok(session.close()?)
}

fn show_snapshot(snapshot: &Snapshot, raw: bool, output: &Output) {
    if output.json() {
        let mut fields = fields! {
            "stw1": snapshot.stw1, "zsw1": snapshot.zsw1,
            "state": snapshot.zsw1.map(|zsw1| words::state_number(zsw1, snapshot.stw1)), "fault_counter": snapshot.fault_counter,
        };
        for (name, reading) in [
            ("speed_set", &snapshot.speed_set),
            ("speed_actual", &snapshot.speed_actual),
        ] {
            if let Some(reading) = reading {
                fields.insert(name.into(), value::json(reading));
            }
        }
        let values: Vec<Value> = snapshot.readings.iter().flatten().map(value::json).collect();
        fields.insert("parameters".into(), values.into());
        output.document("monitor", fields);
        return;
    }
    let word = |word: Option<u16>| word.map_or_else(|| "-".into(), hex16);
    let speed = |reading: &Option<drive_client::parameter::Reading>| {
        reading
            .as_ref()
            .map_or_else(|| "-".into(), |reading| format!("{} rpm", value::value(reading)))
    };
    let mut line = format!(
        "{:<30}  STW1 {}  ZSW1 {}  set {:>12}  actual {:>12}",
        snapshot.zsw1.map_or_else(
            || "state unknown".into(),
            |zsw1| words::state(zsw1, snapshot.stw1)
        ),
        word(snapshot.stw1),
        word(snapshot.zsw1),
        speed(&snapshot.speed_set),
        speed(&snapshot.speed_actual),
    );
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
            Err(refusal) => line = format!("{line}  {} refused", refusal.shown),
        }
    }
    output.line(line.trim_end());
}
