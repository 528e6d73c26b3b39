//! Plants of virtual drives, and what happens to them.
//!
//! A [`PlantPlan`] is read from a TOML file: drives with model, name, address, motor, load and first parameters, a time
//! line of what happens to each ([`PlantEvent`]: faults, STO, load steps, a pulled cable, late frames, wrong answers),
//! and controllers with a program. A [`World`] plays it in virtual time, as fast as the machine can, and gives the same
//! trace for the same seed every time. On a real interface the owner of the stations plays each drive's [`Timeline`]
//! itself ([`Timeline::play`]): [`host::Host`] does so, with everything else that a simulation on a network has.
//!
//! Only [`host`] and [`control_socket`] have sockets, threads and a clock. Nothing in here prints. A simulation on an
//! interface needs raw Ethernet (Linux), one at a serial line runs anywhere; control sockets are for Linux.

mod campaign;
pub mod control_socket;
mod digest;
mod event;
mod expect;
mod file;
pub mod host;
mod kept;
mod lasting;
mod located;
#[cfg(feature = "metrics")]
pub mod metrics;
mod plan;
mod program;
mod shrink;
mod snapshot;
mod source;
mod text;
mod timeline;
mod trace;
mod world;
mod written;

pub use campaign::{
    Bounds, Campaign, CampaignError, CampaignRun, Distribution, DistributionError, ValueForm, number_of,
};
pub use event::{LinkFault, PlantEvent, PlantEventError, Unit, keys};
pub use expect::{
    Expectation, ExpectationResult, Goal, Live, Measure, Monitor, Nearest, Observed, Outcome,
    Quantity as ObservedQuantity,
};
#[cfg(feature = "junit")]
pub use expect::{Suite, junit};
pub use file::PlantFileError;
pub use kept::{DriveTrace, Trace, TraceError};
pub use located::PlantError;
pub use plan::{Action, ControllerPlan, Cue, DrivePlan, PlantPlan, Step, Trigger, WorldError};
pub use shrink::Reproduction;
pub use snapshot::Snapshot;
pub use source::{ChangeError, Happened, ModelsError, PlantSource};
pub use text::{derived_mac, time};
pub use timeline::{Played, Timeline};
pub use trace::{DriveMessage, Event, EventKind, Sample};
pub use world::{NotMet, Pursuit, Shaft, World};
pub use written::{ParameterReading, ReadingValue, WrittenBy};
