//! `profidrive home`

use client::Wait;
use profidrive::motion;

use super::axis;
use crate::args::{Home, Target};
use crate::connect::Need;
use crate::failure::Failure;
use crate::output::Output;

pub fn run(args: &Home, target: &Target, output: &Output) -> Result<(), Failure> {
    let mut wanted = motion::Home {
        timeout: args.timeout,
        control: axis::in_mode(&args.control)?,
    };
    axis::moving(
        target,
        Need::Cyclic,
        output,
        |(session, drive), bound, observer| {
            wanted.control.bound = bound;
            motion::home(session, drive, &wanted, observer).wait()
        },
    )
    .map(|_| ())
}
