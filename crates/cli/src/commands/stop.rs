//! `profidrive stop`

use client::{StopWay, Wait};
use profidrive::motion;

use super::axis;
use crate::args::{Interface, Stop};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::clean;

pub fn run(args: &Stop, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let way = if args.disable {
        StopWay::Disable
    } else {
        StopWay::Stop
    };
    let report = axis::with_drive(interface, Need::Stop, &args.drive, output, |session, drive| {
        motion::stop(session, drive, way, args.timeout).wait()
    })?;
    let label = &report.drive;
    if output.json() {
        output.document("stop", axis::fields_of(&report));
    } else {
        output.line(&report.to_string());
    }
    if let Some(cause) = &report.unread {
        output.warn(&format!(
            "parameters of {label} cannot be read ({}): what they say was not taken into account",
            clean(cause)
        ));
    }
    if let Some(name) = report.controller.as_ref().filter(|_| report.sent.is_some()) {
        output.warn(&format!(
            "controller \"{}\" goes on commanding {label}: what it sends next may move the axis again",
            clean(name)
        ));
    }
    Ok(report.check()?)
}
