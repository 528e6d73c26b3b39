//! A plant in virtual time: the trace on stdout, the same every time.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;
use std::time::Duration;

use client::ErrorKind;
use network::files::create;
use network::pcap::Writer;
use network::system::{Stop, now};
use plant::{Event, ExpectationResult, PlantPlan, Suite, World, junit};
use profidrive::report::SimulationReport;
use profinet::Instant;

use crate::args::Simulate;
use crate::failure::Failure;
use crate::output::Output;

/// Virtual time between two looks at the stop flag.
const STRIDE: Duration = Duration::from_millis(500);

pub fn run(plant: &PlantPlan, args: &Simulate, output: &Output) -> Result<(), Failure> {
    let Some(time) = args.time.or(plant.duration) else {
        return Err(Failure::usage("how long? Virtual time has no end of its own")
            .hint("give `duration` in the plant file, or --for TIME"));
    };
    if args.junit.is_some() && plant.expectations.is_empty() {
        return Err(Failure::usage("--junit: nothing is expected of this plant")
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
    // a file that cannot be written is an error before the run, not after it
    let report = args
        .junit
        .as_deref()
        .map(|path| Ok::<_, Failure>((path, open(path)?)))
        .transpose()?;
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
        world.trace_hash(),
        if world.now() < end { "; ended early" } else { "" }
    ));
    let written = report.map_or(Ok(()), |(path, mut file)| {
        let plant_file = args.plant.as_deref().unwrap_or(Path::new(""));
        let suite = Suite {
            plant: &plant_file.display().to_string(),
            seed: plant.seed,
            version: env!("CARGO_PKG_VERSION"),
            simulated,
            took,
        };
        file.write_all(junit(&suite, &results).as_bytes())
            .map_err(|error| failed(&path.display().to_string(), &error))
    });
    // a lost expectation counts more than a report that could not be written
    let judged = judge(results, output);
    if let (Err(_), Err(failure)) = (&judged, &written) {
        output.problem(failure);
    }
    judged.and(written)
}

/// Shows what came of the expectations; fails when one was lost.
fn judge(results: Vec<ExpectationResult>, output: &Output) -> Result<(), Failure> {
    let all = results.len();
    if all == 0 {
        return Ok(());
    }
    let lost: Vec<String> = results
        .iter()
        .filter(|result| !result.is_met())
        .map(ToString::to_string)
        .collect();
    output.json_event(&SimulationReport::Expectations {
        expectations: results,
    });
    let of = if all == 1 {
        "1 expectation".to_owned()
    } else {
        format!("{all} expectations")
    };
    if lost.is_empty() {
        output.say(&format!("{of}: all met"));
        return Ok(());
    }
    let mut failure = Failure::new(ErrorKind::Difference, format!("{} of {of} lost", lost.len()));
    failure.details = lost
        .iter()
        .flat_map(|text| text.lines())
        .map(str::to_owned)
        .collect();
    Err(failure)
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
