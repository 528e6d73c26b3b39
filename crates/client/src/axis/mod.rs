//! Control of an axis: control words depend on the status of the drive, telegrams on its model.

mod choose;
mod command;
mod control;
mod cycle;
mod evidence;
mod goal;
#[cfg(test)]
mod model;
mod order;
mod samples;
mod scale;
mod seen;
mod travel;
mod wiring;

pub use choose::{
    Choice, NoTelegram, Purpose, ReportedTelegram, choose_telegram, named_telegram, process_words,
};
pub use command::{Command, Traverse};
pub use control::AxisControl;
pub use cycle::{Cycle, Room, Strained};
pub use evidence::Evidence;
pub use goal::{Goal, Jog, Limits, Progress, StopKind, Trouble};
pub use order::{ModuloRange, MotionFacts, Move, MovePlan, Objection, plan_move};
pub(crate) use samples::SampleQueue;
pub use samples::{AxisSignal, Octets, Sample, SignalScale};
pub use scale::{SpeedScale, SpeedUnit};
pub use seen::Seen;
pub use travel::Travel;
pub use wiring::{Wiring, WiringError};
