//! `profidrive stop`

use client::{StopWay, Wait};
use profidrive::motion;

use super::axis;
use crate::args::{Stop, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::clean;

pub fn run(args: &Stop, target: &Target, output: &Output) -> Result<(), Failure> {
    let way = if args.disable {
        StopWay::Disable
    } else {
        StopWay::Stop
    };
    let report = axis::with_drive(target, Need::Stop, output, |session, drive| {
        motion::stop(session, drive, way, args.timeout).wait()
    })?;
    let label = &report.drive;
    if output.json() {
        output.json_report(&report);
    } else {
        output.line(&report.to_string());
    }
    if let Some(cause) = &report.unread {
        output.warn(&format!(
            "parameters of {label} cannot be read ({}): what they say was not taken into account",
            clean(cause)
        ));
    }
    let controller = report.controller.as_ref().filter(|one| one.connected);
    if let Some(controller) = controller.filter(|_| report.sent.is_some()) {
        output.warn(&format!(
            "controller \"{}\" goes on commanding {label}: what it sends next may move the axis again",
            clean(controller.name.as_deref().unwrap_or_default())
        ));
    }
    Ok(report.check()?)
}
