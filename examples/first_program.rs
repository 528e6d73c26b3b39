//! A drive on a network: find it, say what it is and how it is, read its ramps. Changes nothing. The network is an interface, or
//! a plant file with virtual drives: only one line differs.
//!
//! `cargo run -p examples --example first_program -- eth0 akd-1`
//!
//! `cargo run -p examples --example first_program -- examples/plants/one_drive.toml akd-1`

use std::error::Error;
use std::process::ExitCode;

use profidrive::Wait;
use profidrive::client::status::diagnose;

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
    let (Some(place), Some(drive)) = (arguments.next(), arguments.next()) else {
        return Err("give a network interface or a plant file, and a drive: eth0 akd-1".into());
    };

    let mut network = match place.ends_with(".toml") {
        false => profidrive::open(&place)?,
        true => profidrive::open_plant(&place)?,
    };
    let mut drive = network.find(&drive.parse()?).wait()?;
    println!("{}", profidrive::client::describe(&drive.station));

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
