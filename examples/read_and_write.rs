//! Find a drive, read parameters by name, change one.
//!
//! `cargo run -p examples --example read_and_write`

use std::error::Error;

use profidrive::client::{DriveAddress, Wait, WriteMode};
use profidrive::profile::value::Assignment;

fn main() -> Result<(), Box<dyn Error>> {
    let mut network = profidrive::open_plant("examples/plants/one_drive.toml")?;
    let mut drive = network.find(&DriveAddress::Name("akd-1".into())).wait()?;
    println!("found {}", profidrive::client::describe(&drive.station));

    let names = ["DRV.ACC", "VBUS.VALUE", "r947[0]"];
    let selections = names
        .iter()
        .map(|name| drive.select(name))
        .collect::<Result<Vec<_>, _>>()?;
    for result in network.read(&mut drive, &selections).wait()? {
        match result {
            Ok(reading) => println!(
                "{:12} {:8} {} {}",
                reading.name.unwrap_or(""),
                reading.shown(),
                reading.number().unwrap_or(f64::NAN),
                reading.unit
            ),
            Err(refusal) => println!("refused: {refusal}"),
        }
    }

    // Checked against the table of the drive before anything is sent; old and new value come back.
    let change: Assignment = "DRV.ACC=5000rpm/s".parse()?;
    let set = network.write(&mut drive, &[change], WriteMode::Write).wait()?;
    set.accepted()?;
    for change in set.changes() {
        let old = change.old.as_ref().and_then(|old| old.as_ref().ok()?.number());
        let new = change.new.number().unwrap_or(f64::NAN);
        println!("DRV.ACC {} -> {new}: {}", old.unwrap_or(f64::NAN), change.step);
    }
    network.close().wait()?;
    Ok(())
}
