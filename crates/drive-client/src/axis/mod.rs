//! Moving an axis: control words chosen from what the drive says.

mod control;
#[cfg(test)]
mod model;
mod seen;

pub use control::{AxisControl, Command, Goal, Jog, Limits, Progress, Trouble};
pub use seen::Seen;
