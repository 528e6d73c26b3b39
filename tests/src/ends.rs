//! The program under test at the ends of the cable: virtual drives at one, a client at the other.

use std::time::Duration;

use crate::lab::{Lab, Side};
use crate::process::{Finished, Running};
use crate::programs::built;

/// How long a command of the client may take.
const SHORT: Duration = Duration::from_secs(20);

/// Virtual drives at the end for devices, once they are ready; `more` selects them.
pub fn simulate(lab: &Lab, more: &[&str]) -> Running {
    simulate_at(lab, Side::Device, more)
}

/// Returns the same at either end.
pub fn simulate_at(lab: &Lab, side: Side, more: &[&str]) -> Running {
    let mut arguments = vec!["simulate", "-i", side.interface()];
    arguments.extend(more);
    let mut drives = lab.spawn(side, built("profidrive"), arguments);
    drives.wait_for("Ctrl-C ends", Duration::from_secs(5));
    drives
}

/// Returns a command of the client, once it is done.
pub fn client(lab: &Lab, arguments: &[&str]) -> Finished {
    let mut all = vec!["-i", Side::Controller.interface()];
    all.extend(arguments);
    lab.run(Side::Controller, built("profidrive"), all, SHORT)
}
