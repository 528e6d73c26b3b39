//! Moving an axis: control words chosen from what the drive says.

mod control;
#[cfg(test)]
mod model;
mod seen;

pub use control::{
    AxisControl, Command, Goal, Jog, Limits, Progress, STW1_ACKNOWLEDGE, STW1_JOG_READY, STW1_QUICK_STOP,
    STW1_READY, STW1_RELEASED, STW1_RUN, STW1_RUN_INPUT_ZERO, Trouble,
};
pub use seen::{Phase, Seen};
