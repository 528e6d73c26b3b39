//! A drive on a real network: find it, say what it is and how it is, read its ramps. Changes nothing.
//!
//! `cargo run -p examples --example real_network -- eth0 akd-1`
//!
//! Without hardware: `profidrive simulate` on the other end of a cable, see README.

use std::error::Error;
use std::process::ExitCode;

use client::status::diagnose;
use profidrive::Wait;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(interface), Some(drive)) = (arguments.next(), arguments.next()) else {
        return Err("give a network interface and a drive: eth0 akd-1".into());
    };

    let mut network = profidrive::open(&interface)?;
    let mut drive = network.find(&drive.parse()?).wait()?;
    println!("{}", client::describe(&drive.station));

    let diagnosis = diagnose(&network.status(&mut drive).wait()?);
    println!("{}: {}", diagnosis.verdict, diagnosis.sentence);
    if let Some(next) = diagnosis.next {
        println!("next: {next}");
    }

    for name in ["DRV.ACC", "DRV.DEC"] {
        let selection = drive.select(name)?;
        let reading = network.read_one(&mut drive, &selection).wait()?;
        println!(
            "{name} = {} {}",
            reading.number().unwrap_or(f64::NAN),
            reading.unit
        );
    }
    network.close().wait()?;
    Ok(())
}
