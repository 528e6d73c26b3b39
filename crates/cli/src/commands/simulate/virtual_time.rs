//! A plant in virtual time: the trace on stdout, the same every time.

use std::path::Path;
use std::time::Duration;

use client::ErrorKind;
use network::files::create;
use network::pcap::Writer;
use network::system::{Stop, now};
use plant::{Entry, PlantPlan, World};
use profidrive::report::{SimulationEvent, SimulationReport};
use profinet::Instant;

use crate::failure::Failure;
use crate::output::Output;

/// Virtual time between two looks at the stop flag.
const STRIDE: Duration = Duration::from_millis(500);

pub fn run(
    plant: &PlantPlan,
    time: Option<Duration>,
    pcap: Option<&Path>,
    output: &Output,
) -> Result<(), Failure> {
    let Some(time) = time.or(plant.duration) else {
        return Err(Failure::usage("how long? Virtual time has no end of its own")
            .hint("give `duration` in the plant file, or --for TIME"));
    };
    let failed = |what: &str, error: &dyn std::fmt::Display| {
        Failure::new(ErrorKind::Local, format!("{what}: {error}"))
    };
    let mut world = World::new(plant).map_err(|error| failed("the plant cannot start", &error))?;
    if let Some(path) = pcap {
        let name = path.display().to_string();
        let file = create(path).map_err(|error| Failure::new(ErrorKind::Local, error.to_string()))?;
        let writer = Writer::new(file, "plant", Duration::ZERO).map_err(|error| failed(&name, &error))?;
        world.add_tap(Box::new(writer));
    }
    let stop = Stop::on_signals().map_err(|error| failed("cannot watch for Ctrl-C", &error))?;
    let begin = now();
    let end = Instant::ZERO + time;
    let mut print_entry = |entry: Entry| print(&entry, output);
    while world.now() < end && !stop.is_stopped() {
        let until = (world.now() + STRIDE).min(end);
        world.run_until(until, &mut print_entry);
    }
    world
        .finish_taps()
        .map_err(|error| failed("the capture is not complete", &error))?;
    let (simulated, took) = (
        (world.now() - Instant::ZERO).as_secs_f64(),
        (now() - begin).as_secs_f64(),
    );
    output.say(&format!(
        "{simulated} s in {took:.3} s, {:.0} times real time; seed {}, trace {:016x}{}",
        simulated / took.max(1e-9),
        plant.seed,
        world.trace_hash(),
        if world.now() < end { "; ended early" } else { "" }
    ));
    Ok(())
}

fn print(entry: &Entry, output: &Output) {
    if output.json() {
        output.json_event(&SimulationReport::Drive(SimulationEvent {
            time: (entry.at - Instant::ZERO).as_secs_f64(),
            drive: entry.drive.clone(),
            text: entry.what.to_string(),
        }));
    } else {
        output.line(&entry.to_string());
    }
}
