//! `profidrive ack`, `profidrive monitor`

use std::time::Duration;

use client::{Drive, Session, Wait};
use profidrive::fleet;
use profidrive::monitor::{Monitor, Observation};
use profidrive::motion::{self, Control, MotionError, Observer, Report as MotionReport};
use profidrive::report::{MonitorReading, MonitorSilence};
use profidrive::{WallClock, lasting};
use profile::notation::ParameterReference;
use profile::value::{ParameterProblem, Selection};

use super::axis::{self, UNLIMITED};
use super::each::{self, Each, Progress, Shown};
use crate::advice::Commands;
use crate::args::{self, Ack, Target};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::{hex16, value};

pub fn ack(args: &Ack, target: &Target, output: &Output) -> Result<(), Failure> {
    let verb = Acknowledging {
        control: axis::control(&args.cyclic)?,
        by_parameter: args.by_parameter,
    };
    if connect::selector(target, output)?.single().is_none() {
        return each::many(&verb, target, output);
    }
    let report = axis::with_drive(target, verb.need(), output, |session, drive| {
        let observer = axis::observer(&drive.label(), output);
        verb.carry_out(session, drive, &observer).wait()
    })?;
    output.say(acknowledged(&report));
    Ok(())
}

/// How faults are acknowledged.
struct Acknowledging {
    control: Control,
    by_parameter: bool,
}

impl Acknowledging {
    async fn carry_out(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        observer: &Observer,
    ) -> Result<MotionReport, MotionError> {
        if self.by_parameter {
            motion::acknowledge_by_parameter(session, drive, observer).await
        } else {
            motion::acknowledge(session, drive, &self.control, observer).await
        }
    }
}

impl Each for Acknowledging {
    const DOING: &'static str = "acknowledging";

    /// A drive without a fault needs no port of a controller, which another program of this computer may hold.
    fn need(&self) -> Need {
        Need::Records
    }

    async fn work(
        &self,
        session: &mut Session,
        drive: &mut Drive,
        _: &mut Progress<'_>,
    ) -> Result<MotionReport, Failure> {
        Ok(self.carry_out(session, drive, &Observer::default()).await?)
    }
}

impl Shown for Acknowledging {
    type Done = MotionReport;
    type Report = MotionReport;
    const COLUMNS: &'static [&'static str] = &["result"];

    fn report(&self, done: &MotionReport, _: &Drive) -> MotionReport {
        done.clone()
    }

    fn show(&self, done: &MotionReport, _: &Drive, output: &Output) {
        output.say(acknowledged(done));
    }

    fn rows(&self, done: &MotionReport, _: &Drive) -> Vec<Vec<String>> {
        vec![vec![acknowledged(done).to_owned()]]
    }

    fn missing_row(&self, _: bool) -> Option<Vec<String>> {
        Some(vec!["not acknowledged".to_owned()])
    }
}

const fn acknowledged(report: &MotionReport) -> &'static str {
    match report.result.acknowledged {
        Some(false) => "no fault: nothing to acknowledge",
        _ => "acknowledged: no fault is present",
    }
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
    let watching = Watching {
        monitor,
        references,
        time: args.time.unwrap_or(UNLIMITED),
        raw: args.raw,
        output,
    };
    if connect::selector(target, output)?.single().is_some() {
        let (mut session, mut drive) = connect::drive(target, Need::Records, output)?;
        output.say(&format!("watching {}, reads only; Ctrl-C ends", drive.label()));
        let watching = watching.stamped_by(session.wall_clock());
        watching.watch(&mut session, &mut drive, 0).wait()?;
        return Ok(session.close().wait()?);
    }
    let (mut session, found) = connect::drives(target, Need::Records, output)?;
    let watching = watching.stamped_by(session.wall_clock());
    let names = found.members.iter().filter(|member| member.drive.is_ok());
    let names: Vec<&str> = names.map(|member| member.name.as_str()).collect();
    let width = names.iter().map(|name| name.len()).max().unwrap_or_default();
    output.say(&format!(
        "watching {}, reads only; Ctrl-C ends",
        profidrive::listed(&names)
    ));
    let members = fleet::each(&session, found.members, async |session, drive| {
        watching.watch(session, drive, width).await
    });
    let members = members.wait().into_iter();
    let closed = session.close().wait();
    let rows: Vec<each::Row<()>> = members
        .map(|member| each::Row::new(member, |(), _| Vec::new()))
        .collect();
    each::ended(&rows, None, output)?;
    Ok(closed?)
}

/// How drives are watched.
struct Watching<'a> {
    monitor: Monitor,
    references: Vec<ParameterReference>,
    time: Duration,
    raw: bool,
    output: &'a Output,
}

impl Watching<'_> {
    fn stamped_by(self, clock: WallClock) -> Self {
        let monitor = self.monitor.stamped_by(clock);
        Self { monitor, ..self }
    }

    /// Watches a drive and prints what it reports, behind its name where that gets a column.
    async fn watch(&self, session: &mut Session, drive: &mut Drive, width: usize) -> Result<(), Failure> {
        let selections = self.references.iter();
        let more: Vec<Selection> = selections
            .map(|reference| drive.parameters.select(reference))
            .collect::<Result<_, _>>()?;
        let mut monitor = self.monitor.clone().with(more);
        let end = session.now() + self.time;
        let label = drive.label();
        let column = match width {
            0 => String::new(),
            width => format!("{label:<width$}  "),
        };
        loop {
            let (printer, silent) = (self.output.clone(), label.clone());
            let asked = monitor.elapsed(session);
            let silent = move || {
                printer.json_event(&MonitorSilence {
                    drive: silent.clone(),
                    silent: true,
                    time: asked.map(|time| time.as_secs_f64()),
                });
                printer.warn(&format!("{silent} does not answer; waiting for it"));
            };
            let seen = monitor.read_reporting_silence(session, drive, silent).await?;
            let Some(seen) = seen else { return Ok(()) };
            if let Some(outage) = seen.outage() {
                let outage = lasting(outage);
                self.output
                    .warn(&format!("{label} answers again after {outage} without an answer"));
            }
            if seen.restarted {
                self.output
                    .warn(&format!("{label} has restarted: it was connected to again"));
            }
            show(&seen, &label, &column, self.raw, self.output);
            let at = seen.wall.map_or_else(String::new, |wall| {
                format!("{}  ", profidrive::date_and_time(wall))
            });
            for fault in &seen.faults {
                self.output.warn(&format!("{column}{at}{fault}"));
            }
            if !monitor.pause(session, end).await? {
                return Ok(());
            }
        }
    }
}

fn show(seen: &Observation, drive: &str, column: &str, raw: bool, output: &Output) {
    let (time, snapshot) = (seen.time.as_secs_f64(), &seen.snapshot);
    let reading = MonitorReading::new(drive, seen, &Commands::any());
    output.json_event(&reading);
    if output.json() {
        return;
    }
    let state = reading.words.zsw1.and_then(|word| word.meaning);
    let word = |word: Option<u16>| word.map_or_else(|| "-".into(), hex16);
    let speed =
        |reading: &Option<profile::value::Reading>| reading.as_ref().map_or_else(|| "-".into(), value::full);
    let mut line = format!(
        "{column}{:>8.2} s  {:<30}  STW1 {}  ZSW1 {}  set {:>12}  actual {:>12}",
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
