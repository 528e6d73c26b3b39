//! Record every cyclic sample of an axis while it ramps up and down, as CSV lines. Samples that were lost on the network or
//! not taken in time are counted.
//!
//! `cargo run -p examples --example record_samples >ramp.csv`

use std::error::Error;
use std::io::Write;
use std::time::Duration;

use profidrive::client::{AxisSettings, DriveAddress, Samples, Wait};

/// More than the samples of this run: nothing is dropped.
const CAPACITY: usize = 10_000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut network = profidrive::open_plant("examples/plants/one_drive.toml")?;
    let mut drive = network.find(&DriveAddress::Name("akd-1".into())).wait()?;
    let mut axis = network.take_axis(&mut drive, AxisSettings::default()).wait()?;
    let mut samples = axis.samples(CAPACITY);
    let mut enabled = axis.enable().wait()?;
    enabled.reach_speed(300.0, None).wait()?;
    enabled.hold(Duration::from_millis(200)).wait()?;
    enabled.disable().wait()?;
    axis.release().wait()?;

    write(&mut samples, &mut std::io::stdout().lock())?;
    eprintln!("{} samples dropped", samples.dropped());
    Ok(())
}

/// The stream ends with the release of the axis. Speeds are in N2: 0x4000 is 100 % of the reference speed of the drive.
fn write(samples: &mut Samples, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(out, "time_ms,number,missed,stw1,zsw1,speed_set,speed_actual")?;
    let mut start = None;
    while let Some(sample) = samples.next().wait()? {
        let start = *start.get_or_insert(sample.at);
        writeln!(
            out,
            "{:.3},{},{},0x{:04X},0x{:04X},{},{}",
            (sample.at - start).as_secs_f64() * 1000.0,
            sample.number,
            sample.missed,
            sample.command.stw1.0,
            sample.seen.word,
            sample.command.nsoll_a,
            sample.seen.nist_a.unwrap_or_default()
        )?;
    }
    Ok(())
}
