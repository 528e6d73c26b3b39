//! `profidrive task`

use client::Wait;
use profidrive::motion;

use super::axis;
use super::recorded::Recorder;
use crate::args::{Target, Task};
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Task, target: &Target, output: &Output) -> Result<(), Failure> {
    let number = args.number;
    let mut wanted = motion::Task {
        number,
        timeout: args.timeout,
        control: axis::in_mode(&args.control)?,
    };
    let mut recorder = Recorder::of(args.recorded.record.as_deref())?;
    let (_, recorded) = recorder.moving(target, output, |(session, drive), bound, observer| {
        wanted.control.bound = bound;
        motion::task(session, drive, &wanted, observer).wait()
    })?;
    recorded
}
