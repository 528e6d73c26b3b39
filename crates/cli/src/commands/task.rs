//! `profidrive task`

use client::Wait;
use profidrive::motion;

use super::axis;
use crate::args::{Target, Task};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Task, target: &Target, output: &Output) -> Result<(), Failure> {
    let number = args.number;
    let mut wanted = motion::Task {
        number,
        timeout: args.timeout,
        control: axis::in_mode(&args.control)?,
    };
    axis::moving(
        target,
        Need::Cyclic,
        output,
        |(session, drive), bound, observer| {
            wanted.control.bound = bound;
            motion::task(session, drive, &wanted, observer).wait()
        },
    )
    .map(|_| ())
}
