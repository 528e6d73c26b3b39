//! Take control of an axis, run it, stop it. The axis also stops when the program leaves this scope by any other door.
//!
//! `cargo run -p examples --example run_axis`

use std::error::Error;
use std::time::Duration;

use profidrive::client::{AxisSettings, DriveAddress, Wait};

fn main() -> Result<(), Box<dyn Error>> {
    let mut network = profidrive::open_plant("examples/plants/one_drive.toml")?;
    let mut drive = network.find(&DriveAddress::Name("akd-1".into())).wait()?;
    let mut axis = network.take_axis(&mut drive, AxisSettings::default()).wait()?;
    let mut enabled = axis.enable().wait()?;
    enabled.run(60.0).wait()?;
    for _ in 0..5 {
        enabled.hold(Duration::from_millis(500)).wait()?;
        if let Some(status) = enabled.status() {
            let speed = status.speed_actual.unwrap_or_default();
            println!("{:5} ms  {speed:6.2} rpm", status.time.as_millis());
        }
    }
    enabled.disable().wait()?;
    let speed = axis.status().and_then(|status| status.speed_actual);
    println!("stopped at {:.2} rpm", speed.unwrap_or_default());
    axis.release().wait()?;
    Ok(())
}
