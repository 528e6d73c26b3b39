//! A plant in virtual time: the trace on stdout, the same every time.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;
use std::time::Duration;

use client::ErrorKind;
use network::files::create;
use network::pcap::Writer;
use network::system::{Stop, now};
use plant::{Event, PlantPlan, World};
use profidrive::report::SimulationReport;
use profinet::Instant;

use crate::args::Simulate;
use crate::failure::Failure;
use crate::output::Output;

use super::judgement::{Ran, ReportFile, judge};

/// Virtual time between two looks at the stop flag.
const STRIDE: Duration = Duration::from_millis(500);

pub fn run(plant: &PlantPlan, args: &Simulate, output: &Output) -> Result<(), Failure> {
    let Some(time) = args.time.or(plant.duration) else {
        return Err(Failure::usage("how long? Virtual time has no end of its own")
            .hint("give `duration` in the plant file, or --for TIME"));
    };
    if args.junit.is_some() && plant.expectations.is_empty() {
        return Err(Failure::usage("--junit: the plant has no expectations")
            .hint("write `expect` in the plant file, or give --expect FILE"));
    }
    let mut world = World::new(plant).map_err(|error| failed("the plant cannot start", &error))?;
    if let Some(path) = &args.pcap {
        let name = path.display().to_string();
        let writer =
            Writer::new(open(path)?, "plant", Duration::ZERO).map_err(|error| failed(&name, &error))?;
        world.add_tap(Box::new(writer));
    }
    let mut trace = args.trace.as_deref().map(TraceFile::create).transpose()?;
    let report = ReportFile::create(args)?;
    if !plant.expectations.is_empty() {
        world.expect(&plant.expectations, plant.seed);
    }
    let stop = Stop::on_signals().map_err(|error| failed("cannot watch for Ctrl-C", &error))?;
    let begin = now();
    let end = Instant::ZERO + time;
    let mut record = |event: Event| {
        if let Some(trace) = &mut trace {
            trace.write(&event);
        }
        print(event, output);
    };
    while world.now() < end && !stop.is_stopped() {
        let until = (world.now() + STRIDE).min(end);
        world.run_until(until, &mut record);
    }
    world
        .finish_taps()
        .map_err(|error| failed("the capture is not complete", &error))?;
    if let Some(trace) = trace {
        trace.finish()?;
    }
    let (simulated, took) = (world.now() - Instant::ZERO, now() - begin);
    let results = world.finish_expectations();
    output.say(&format!(
        "{} s in {:.3} s, {:.0} times real time; seed {}, trace {:016x}{}",
        simulated.as_secs_f64(),
        took.as_secs_f64(),
        simulated.as_secs_f64() / took.as_secs_f64().max(1e-9),
        plant.seed,
        world.digest(),
        if world.now() < end { "; ended early" } else { "" }
    ));
    let ran = Ran {
        seed: plant.seed,
        simulated,
        took,
    };
    judge(results, report, ran, output)
}

fn failed(what: &str, error: &dyn std::fmt::Display) -> Failure {
    Failure::new(ErrorKind::Local, format!("{what}: {error}"))
}

fn open(path: &Path) -> Result<File, Failure> {
    create(path).map_err(|error| Failure::new(ErrorKind::Local, error.to_string()))
}

/// A file with the events, a JSON document a line.
struct TraceFile {
    name: String,
    file: BufWriter<File>,
    /// Why it is not complete.
    error: Option<std::io::Error>,
}

impl TraceFile {
    fn create(path: &Path) -> Result<Self, Failure> {
        Ok(Self {
            name: path.display().to_string(),
            file: BufWriter::new(open(path)?),
            error: None,
        })
    }

    fn write(&mut self, event: &Event) {
        if self.error.is_none() {
            let written = serde_json::to_writer(&mut self.file, event).map_err(std::io::Error::from);
            self.error = written.and_then(|()| self.file.write_all(b"\n")).err();
        }
    }

    fn finish(mut self) -> Result<(), Failure> {
        let error = self.error.or_else(|| self.file.flush().err());
        error.map_or(Ok(()), |error| Err(failed(&self.name, &error)))
    }
}

fn print(event: Event, output: &Output) {
    if output.json() {
        output.json_event(&SimulationReport::Drive(event));
    } else {
        output.line(&event.to_string());
    }
}
