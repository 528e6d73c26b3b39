//! Home an axis in position mode and move it: to a position, by a distance, and to another target while it moves.
//!
//! `cargo run -p examples --example move_axis`

use std::error::Error;
use std::time::Duration;

use profidrive::client::axis::{Move, Purpose};
use profidrive::client::{AxisSettings, DriveAddress, Enabled, Wait};
use profidrive::profile::notation::{Position, fixed};
use profidrive::profile::state::Mode;

fn main() -> Result<(), Box<dyn Error>> {
    let mut network = profidrive::open_plant("examples/plants/one_drive.toml")?;
    let mut drive = network.find(&DriveAddress::Name("akd-1".into())).wait()?;
    network.set_operating_mode(&mut drive, Mode::Position).wait()?;
    let mut axis = network
        .take_axis(&mut drive, AxisSettings::for_purpose(Purpose::Move))
        .wait()?;
    let mut enabled = axis.enable().wait()?;
    enabled.home(Some(Duration::from_secs(30))).wait()?;
    for order in [
        Move::to(Position::Turns(10.0), 600.0),
        Move::by(Position::Counts(-65_536.0), 60.0).with_ramps(Some(3000.0), Some(1500.0)),
    ] {
        // what speaks against a move is reported before anything is sent
        enabled.move_to(&order).wait()?;
        print(&enabled);
    }
    let far = enabled.plan(&Move::to(Position::Turns(500.0), 300.0)).wait()?;
    enabled.start(&far).wait()?;
    enabled.hold(Duration::from_secs(1)).wait()?;
    let home = enabled.plan(&Move::to(Position::Turns(0.0), 300.0)).wait()?;
    enabled.start(&home).wait()?; // on the fly
    enabled.reach_target(Some(Duration::from_secs(30))).wait()?;
    print(&enabled);
    enabled.disable().wait()?;
    axis.release().wait()?;
    Ok(())
}

fn print(axis: &Enabled<'_>) {
    let position = axis.status().and_then(|status| status.position);
    println!("at {} rev", fixed(position.unwrap_or_default(), 3));
}
