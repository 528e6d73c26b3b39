//! Virtual drives as programs of their own.

use std::time::Duration;

use system_tests::{Lab, Running, Side, built};

/// Starts one virtual AKD named akd-1 at the device's end and waits until it is on the wire.
pub fn simulate(lab: &Lab, more: &[&str]) -> Running {
    let mut arguments = vec!["simulate", "--model", "akd", "--name", "akd-1", "-i", "dev0"];
    arguments.extend(more);
    let mut drive = lab.spawn(Side::Device, built("profidrive"), arguments);
    drive.wait_for("Ctrl-C ends", Duration::from_secs(5));
    drive
}
