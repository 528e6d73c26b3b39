//! `profidrive demo`: the whole chain in one process, every byte through the same code as on a wire.

mod converters;

use std::fs::File;
use std::path::Path;
use std::time::Duration;

use client::axis::{Jog, Trouble};
use client::change::Change;
use client::{
    Axis, AxisSettings, Drive, DriveAddress, Enabled, Error, ErrorKind, Session, Wait, WriteMode, describe,
};
use network::files;
use network::pcap::Writer;
use network::segment::Pace;
use network::system::Stop;
use plant::PlantEvent;
use profidrive::report::{DemoEvent, DemoStep};
use profidrive::{Access, Joined, Network, Opening, Transport};
use profile::value::{Assignment, Reading, Selection};
use virtual_drive::drive::Injection;

use crate::args::Demo;
use crate::failure::Failure;
use crate::output::{Colour, Output, Shared};
use crate::render::live::LiveView;
use crate::render::table::Table;
use crate::render::{hex16, value, words};

const NAME: &str = "akd-1";
/// The three drives.
const PLANT: &str = r#"
    [[drive]]
    name = "akd-1"
    mac = "02:50:4e:00:00:01"
    ip = "10.0.0.2/24"
    [[drive]]
    name = "vlt-1"
    model = "vlt"
    mac = "02:50:4e:00:00:02"
    ip = "10.0.0.3/24"
    [[drive]]
    name = "vacon-1"
    model = "vacon"
    mac = "02:50:4e:00:00:03"
    ip = "10.0.0.4/24"
"#;
/// The page that is read by name.
const PAGE: [&str; 8] = [
    "DRV.OPMODE",
    "DRV.ACC",
    "DRV.DEC",
    "DRV.IPEAK",
    "VBUS.VALUE",
    "VL.FB_32",
    "PL.FB",
    "PN.VELSCALING",
];
/// Speeds in rpm.
const RUN: f64 = 60.0;
const JOG: f64 = 30.0;
/// How far from the speed requested the motor may be.
const TOLERANCE: f64 = 3.0;
/// Following error: a fault that every servo drive has.
const FAULT: u16 = 439;

type Demonstrated<'a> = Enabled<'a>;

/// One thing the demo promises.
#[derive(Debug)]
struct Step {
    what: &'static str,
    result: Result<String, String>,
}

/// Everything the demo promises, in order.
const PROMISES: [&str; 20] = [
    "find the drive by name",
    "read its identity",
    "read a page of parameters by name",
    "connect cyclically with telegram 1",
    "step to S4",
    "run at 60 rpm",
    "change an acceleration while running",
    "jog",
    "fault comes and is acknowledged",
    "stop along the ramp",
    "release",
    "find the VLT by name",
    "read a page of the VLT",
    "parameters beside PPO type 1",
    "run the VLT at a reference",
    "alarm comes and is reset",
    "find the Vacon by name",
    "read a page of the Vacon",
    "run the Vacon at a reference",
    "fault comes and is reset",
];

struct Show {
    output: Output,
    view: Shared<LiveView>,
    position: Shared<Option<f64>>,
    steps: Vec<Step>,
}

pub fn run(args: &Demo, output: &Output) -> Result<(), Failure> {
    let (mut network, plant) = stage(args)?;
    show(args, (&mut network, &plant), output)
}

fn show(args: &Demo, (session, plant): (&mut Session, &Joined), output: &Output) -> Result<(), Failure> {
    let view = LiveView::new(output.clone());
    let mut show = Show {
        output: output.clone(),
        view: Shared::new(view),
        position: Shared::new(None),
        steps: Vec::new(),
    };
    output.say("an in-memory Ethernet segment with a virtual AKD, a VLT, a Vacon and a controller");
    let result = play(session, plant, &mut show).and_then(|()| converters::play(session, plant, &mut show));
    let settled = session.uninterrupted(async |session: &mut Session| session.settled().await);
    let closed = settled.wait().and(session.close().wait());
    let interrupted = matches!(result, Err(Error::Interrupted));
    let taps = plant.with_world(|world| world.finish_taps());
    if let Err(error) = result.and(closed) {
        let what = PROMISES.get(show.steps.len()).copied().unwrap_or("close");
        show.steps.push(Step {
            what,
            result: Err(error.to_string()),
        });
    }
    show.summary();
    taps.map_err(|error| Failure::new(ErrorKind::Local, format!("the capture is not complete: {error}")))?;
    if let Some(path) = &args.pcap {
        output.say(&format!(
            "traffic is in {}; `profidrive decode {}` says what it means",
            path.display(),
            path.display()
        ));
    }
    if interrupted {
        let message = "stopped by Ctrl-C or a signal; every axis was brought to rest";
        return Err(Failure::new(ErrorKind::Interrupted, message));
    }
    match show
        .steps
        .iter()
        .find_map(|step| Some((step.what, step.result.as_ref().err()?)))
    {
        Some((what, reason)) => Err(Failure::new(
            ErrorKind::Internal,
            format!("the demo failed at \"{what}\": {reason}"),
        )),
        None if show.steps.len() != PROMISES.len() => Err(Failure::new(
            ErrorKind::Internal,
            "the demo did not do everything",
        )),
        None => Ok(()),
    }
}

/// The drives and the controller.
fn stage(args: &Demo) -> Result<(Network, Joined), Failure> {
    let failed = |error: &dyn std::fmt::Display| Failure::new(ErrorKind::Internal, error.to_string());
    let plant = PLANT.parse().map_err(|error| failed(&error))?;
    let mut opening = Opening::new(Access::Cyclic).in_plant(plant);
    if let Ok(stop) = Stop::on_signals() {
        opening = opening.stopped_by(stop);
    }
    let network = opening.open().map_err(|error| failed(&error))?;
    let Transport::Plant(plant) = network.transport().clone() else {
        return Err(failed(&"not a plant"));
    };
    if let Some(path) = &args.pcap {
        let capture = Box::new(capture(path)?);
        plant.with_world(|world| world.add_tap(capture));
    }
    if !args.fast {
        plant.with_world(|world| world.set_pace(Pace::Wall));
    }
    Ok((network, plant))
}

fn capture(path: &Path) -> Result<Writer<File>, Failure> {
    let failed = |error: std::io::Error| {
        Failure::new(
            ErrorKind::Local,
            format!("cannot write {}: {error}", path.display()),
        )
    };
    let file = files::create(path).map_err(|error| Failure::new(ErrorKind::Local, error.to_string()))?;
    Writer::starting_now(file, "demo").map_err(failed)
}

fn play(session: &mut Session, plant: &Joined, show: &mut Show) -> Result<(), Error> {
    let mut drive = find(session, show)?;
    identity(session, &mut drive, show)?;
    page(session, &mut drive, &PAGE, show)?;
    show.next();
    let mut axis = session.take_axis(&mut drive, AxisSettings::default()).wait()?;
    show.done(format!(
        "update time {} ms, both directions",
        axis.cycle().as_millis()
    ));
    let (view, position) = (show.view.clone(), show.position.clone());
    let seen_states = Shared::new(Vec::<&'static str>::new());
    let states = seen_states.clone();
    let live = show.output.live();
    axis.watch(move |status| {
        if let Some(seen) = status.view.seen {
            let state = words::state_number(seen.zsw1.0, Some(status.view.answered.0));
            let mut states = states.lock();
            if state != "--" && states.last() != Some(&state) {
                states.push(state);
            }
        }
        // a line shows no position older than itself; a picture keeps its last one
        let position = position.lock().filter(|_| live);
        view.lock().show_words(status, position);
    });
    show.next();
    axis.ready().wait()?;
    let mut enabled = axis.enable().wait()?;
    show.done(seen_states.lock().join(", "));
    turn(&mut enabled, show)?;
    accelerate(&mut enabled, show)?;
    jog(&mut enabled, show)?;
    fault(&mut enabled, plant, show)?;
    drop(enabled);
    stop(&mut axis, show)?;
    show.next();
    axis.release().wait()?;
    let free = plant.with_world(|world| {
        let station = world.drive(0);
        station.is_some_and(|station| !station.device().is_exchanging() && !station.drive().is_enabled())
    });
    show.check(
        free,
        "connection closed, the drive is without a controller".into(),
        "the drive is still connected",
    )
}

fn find(session: &mut Session, show: &mut Show) -> Result<Drive, Error> {
    show.next();
    let drive = session.find(&DriveAddress::Name(NAME.into())).wait()?;
    show.done(describe(&drive.station));
    Ok(drive)
}

fn identity(session: &mut Session, drive: &mut Drive, show: &mut Show) -> Result<(), Error> {
    show.next();
    let info = session.info(drive).wait()?;
    let word = |pnu| info.raw(pnu).and_then(|raw| u16::try_from(raw).ok());
    let state = word(2).map_or_else(|| "unknown".into(), |zsw1| words::state(zsw1, word(1)));
    let Some(identity) = info.identity.filter(|_| info.refused.is_empty()) else {
        return show.check(
            false,
            String::new(),
            &format!("refused: {}", info.refused.join("; ")),
        );
    };
    show.done(format!(
        "{} {}, serial {}, software {}, {state}",
        drive.model.name, identity.order_id, identity.serial_number, identity.software_revision
    ));
    Ok(())
}

fn page(session: &mut Session, drive: &mut Drive, names: &[&str], show: &mut Show) -> Result<(), Error> {
    show.next();
    let mut selections: Vec<Selection> = Vec::new();
    for name in names {
        selections.push(
            drive
                .parameters
                .select(&name.parse().map_err(profile::value::ParameterProblem::from)?)?,
        );
    }
    let readings: Vec<Reading> = session
        .read(drive, &selections)
        .wait()?
        .into_iter()
        .flatten()
        .collect();
    let mut table = Table::new(&["name", "number", ">value", "unit", "meaning"]);
    for reading in &readings {
        table.row([
            reading.name.unwrap_or_default().to_owned(),
            reading.shown().to_string(),
            value::value(reading),
            reading.unit.to_owned(),
            value::meaning(reading),
        ]);
    }
    if !show.output.json() {
        for line in table.lines() {
            show.output.line(&format!("    {line}"));
        }
    }
    show.check(
        readings.len() == names.len(),
        format!("{} of {} parameters", readings.len(), names.len()),
        "some parameters could not be read",
    )
}

fn near(actual: f64, wanted: f64) -> bool {
    (actual - wanted).abs() <= TOLERANCE
}

/// Keeps the axis going for a while, with its position beside the speeds.
fn hold(axis: &mut Demonstrated<'_>, time: Duration, show: &Show) -> Result<f64, Error> {
    const PART: Duration = Duration::from_millis(250);
    let mut left = time;
    while !left.is_zero() {
        let part = left.min(PART);
        axis.hold(part).wait()?;
        left -= part;
        let (session, drive) = axis.session();
        let selection = drive
            .parameters
            .select(&"PL.FB".parse().map_err(profile::value::ParameterProblem::from)?)?;
        *show.position.lock() = session.read_one(drive, &selection).wait()?.number();
        if let Some(status) = axis.status() {
            show.view.lock().show(&status, *show.position.lock());
        }
    }
    Ok(axis
        .status()
        .and_then(|status| status.speed_actual)
        .unwrap_or(0.0))
}

fn turn(axis: &mut Demonstrated<'_>, show: &mut Show) -> Result<(), Error> {
    show.next();
    axis.run(RUN).wait()?;
    let before = *show.position.lock();
    let speed = hold(axis, Duration::from_millis(2500), show)?;
    let moved = *show.position.lock() != before;
    let text = format!(
        "{speed:.2} rpm, position {:.0}",
        show.position.lock().unwrap_or(0.0)
    );
    show.check(
        near(speed, RUN) && moved,
        text,
        &format!("the motor turns at {speed:.2} rpm"),
    )
}

fn accelerate(axis: &mut Demonstrated<'_>, show: &mut Show) -> Result<(), Error> {
    show.next();
    let (session, drive) = axis.session();
    let assignment: Assignment = "DRV.ACC=1000rpm/s".parse()?;
    let set = session.write(drive, &[assignment], WriteMode::Write).wait()?;
    let change = set.changes().first();
    let old = change
        .and_then(|change| change.old.as_ref()?.as_ref().ok())
        .map(value::full);
    let new = change.and_then(Change::now).map(value::full);
    axis.run(2.0 * RUN).wait()?;
    let speed = hold(axis, Duration::from_millis(1250), show)?;
    let text = format!(
        "DRV.ACC {} -> {}, then {speed:.2} rpm",
        old.unwrap_or_default(),
        new.clone().unwrap_or_default()
    );
    show.check(
        set.is_done() && new.is_some() && near(speed, 2.0 * RUN),
        text,
        "the value did not arrive, or the motor not there",
    )
}

fn jog(axis: &mut Demonstrated<'_>, show: &mut Show) -> Result<(), Error> {
    show.next();
    let (session, drive) = axis.session();
    let assignment: Assignment = format!("1004={JOG}rpm").parse()?;
    session.write(drive, &[assignment], WriteMode::Write).wait()?;
    axis.jog(Jog::One).wait()?;
    let speed = hold(axis, Duration::from_millis(1500), show)?;
    show.check(
        near(speed, JOG),
        format!("{speed:.2} rpm"),
        &format!("the motor jogs at {speed:.2} rpm"),
    )
}

fn fault(axis: &mut Demonstrated<'_>, plant: &Joined, show: &mut Show) -> Result<(), Error> {
    show.next();
    axis.run(RUN).wait()?;
    hold(axis, Duration::from_millis(500), show)?;
    inject(plant, NAME, FAULT)?;
    match axis.hold(Duration::from_secs(2)).wait() {
        Err(Error::Axis {
            trouble: Trouble::Fault,
            ..
        }) => {}
        Err(error) => return Err(error),
        Ok(()) => return show.check(false, String::new(), "the fault did not arrive"),
    }
    let (session, drive) = axis.session();
    let faults = session.faults(drive).wait()?;
    let present = faults.iter().find(|fault| fault.situation == 0);
    let fault_text = present.map(|fault| format!("F{} {}", fault.number, fault.meaning.unwrap_or_default()));
    let right = present.is_some_and(|fault| fault.number == FAULT);
    axis.acknowledge().wait()?;
    let zsw1 = axis
        .status()
        .and_then(|status| status.view.seen)
        .map_or(0, |seen| seen.zsw1.0);
    let (session, drive) = axis.session();
    let shifted = session
        .faults(drive)
        .wait()?
        .iter()
        .any(|fault| fault.situation == 1 && fault.number == FAULT);
    let text = format!(
        "{}; acknowledged, ZSW1 {}",
        fault_text.unwrap_or_default(),
        hex16(zsw1)
    );
    show.check(
        right && shifted && !words::has_fault(zsw1),
        text,
        "the fault buffer is not as it should be",
    )
}

fn stop(axis: &mut Axis, show: &mut Show) -> Result<(), Error> {
    show.next();
    let mut enabled = axis.enable().wait()?;
    enabled.run(RUN).wait()?;
    hold(&mut enabled, Duration::from_millis(750), show)?;
    enabled.disable().wait()?;
    let status = axis.status();
    let state = status
        .and_then(|status| status.view.state())
        .map_or_else(|| "not ready".into(), |state| state.to_string());
    let speed = status.and_then(|status| status.speed_actual).unwrap_or(f64::MAX);
    show.check(
        near(speed, 0.0),
        format!("{state}, {speed:.2} rpm"),
        "the motor still turns",
    )
}

/// Lets a fault come at the drive itself.
fn inject(plant: &Joined, drive: &str, number: u16) -> Result<(), Error> {
    let fault = Injection::Fault {
        number,
        lasting: false,
    };
    let injected = plant.with_world(|world| world.inject(drive, PlantEvent::Drive(fault), None));
    injected.map_err(|error| Error::Malformed {
        drive: drive.into(),
        reason: error.to_string(),
    })
}

impl Show {
    /// Says what comes.
    fn next(&mut self) {
        let what = PROMISES.get(self.steps.len()).copied().unwrap_or_default();
        self.view.lock().leave();
        if !self.output.json() {
            self.output
                .line(&self.output.paint(Colour::Strong, &format!("> {what}")));
        }
    }

    /// More about it.
    fn detail(&self, text: &str) {
        if !self.output.json() {
            self.output.line(&format!("    {text}"));
        }
    }

    /// It happened.
    fn done(&mut self, text: String) {
        let what = PROMISES.get(self.steps.len()).copied().unwrap_or_default();
        self.steps.push(Step {
            what,
            result: Ok(text),
        });
    }

    /// It happened, or the demo fails.
    fn check(&mut self, good: bool, text: String, otherwise: &str) -> Result<(), Error> {
        if good {
            self.done(text);
            return Ok(());
        }
        Err(Error::Malformed {
            drive: NAME.into(),
            reason: otherwise.to_owned(),
        })
    }

    fn summary(&self) {
        self.view.lock().leave();
        if self.output.json() {
            let steps = self.steps.iter().map(|step| DemoStep {
                step: step.what,
                ok: step.result.is_ok(),
                text: step.result.clone().unwrap_or_else(|reason| reason),
            });
            self.output.json_event(&DemoEvent::Ended {
                end: true,
                steps: steps.collect(),
            });
            return;
        }
        self.output
            .line(&self.output.paint(Colour::Strong, "what happened"));
        for step in &self.steps {
            let line = match &step.result {
                Ok(text) => {
                    self.output.paint(Colour::Normal, "ok    ") + &format!("{:<38} {text}", step.what)
                }
                Err(text) => {
                    self.output.paint(Colour::Fault, "FAILED") + &format!("{:<38} {text}", step.what)
                }
            };
            self.output.line(&line);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_promised_happens() {
        let args = Demo {
            pcap: None,
            fast: true,
        };
        assert_eq!(run(&args, &Output::new(true, true)), Ok(()));
    }

    #[test]
    fn wherever_it_is_stopped_every_axis_stands_and_every_connection_is_closed() {
        let args = Demo {
            pcap: None,
            fast: true,
        };
        for looks in (10..100_000).step_by(131) {
            let (mut network, plant) = stage(&args).unwrap();
            let mut left = looks;
            network.interrupt_with(move || {
                left -= 1;
                left < 0
            });
            let Err(failure) = show(&args, (&mut network, &plant), &Output::new(true, true)) else {
                assert!(looks > 1000, "the demo looks up to {looks} times only");
                return;
            };
            assert!(
                failure.message.starts_with("stopped by Ctrl-C"),
                "{looks}: {failure:?}"
            );
            for number in 0..3 {
                plant.with_world(|world| {
                    let station = world.drive(number).unwrap();
                    let speed = station.drive().axis().measured_speed();
                    // a fault leaves the motor to its friction, and so does its reset
                    let coasts = (0..64).any(|index| station.drive().fault_number(index) != 0);
                    assert!(coasts || speed.abs() < 1.0, "{looks}: it turns at {speed} rpm");
                    assert!(
                        !station.drive().is_enabled() && !station.device().is_exchanging(),
                        "{looks}"
                    );
                });
            }
        }
        panic!("the demo does not end");
    }
}
