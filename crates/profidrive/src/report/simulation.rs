//! What the verbs report that run virtual drives.

use serde::Serialize;

use crate::motion::AxisState;

/// What the demonstration shows: an axis that moves, and what was done at the end.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum DemoEvent {
    /// An axis at one moment.
    Axis(Box<AxisState>),
    /// The demonstration has ended; nothing follows.
    Ended {
        /// True.
        end: bool,
        /// What was done, in order.
        steps: Vec<DemoStep>,
    },
}

/// A step of the demonstration.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DemoStep {
    /// What was to be done.
    pub step: &'static str,
    /// Whether it was.
    pub ok: bool,
    /// What came of it.
    pub text: String,
}

/// What a simulation reports while it runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum SimulationReport {
    /// Something happened to a drive.
    #[cfg(feature = "simulate")]
    Drive(plant::Event),
    /// What all drives do.
    Load(SimulationLoad),
    /// What came of the expectations; nothing follows.
    #[cfg(feature = "simulate")]
    Expectations {
        /// The results, in the order of the file.
        expectations: Vec<plant::ExpectationResult>,
    },
}

/// What the drives of a simulation do at one moment, and what happened since it began. Times are in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SimulationLoad {
    /// Seconds since the simulation began.
    pub time: f64,
    /// Number of drives.
    pub drives: usize,
    /// Drives that exchange data with a controller.
    pub exchanging: usize,
    /// Shortest time between two input frames; null while no drive exchanges data.
    pub shortest_cycle: Option<f64>,
    /// Longest time between two input frames; null while no drive exchanges data.
    pub longest_cycle: Option<f64>,
    /// Connections of controllers that began to exchange data.
    pub connections: u64,
    /// Connections of controllers that ended.
    pub disconnections: u64,
    /// Faults that came.
    pub faults: u64,
    /// Frames received.
    pub received: u64,
    /// Frames sent.
    pub sent: u64,
    /// Frames lost because they came faster than they were handled.
    pub missed: u64,
    /// Deadlines of drives met more than 1 ms late.
    pub late: u64,
    /// Longest delay of a deadline.
    pub longest_delay: f64,
    /// Processor time of the thread that runs the drives; null where the system does not report it.
    pub processor: Option<f64>,
    /// Time in which that thread waited for a processor.
    pub processor_waiting: Option<f64>,
}

#[cfg(feature = "simulate")]
impl From<&plant::host::Load> for SimulationLoad {
    fn from(load: &plant::host::Load) -> Self {
        let seconds = |time: std::time::Duration| time.as_secs_f64();
        Self {
            time: seconds(load.time),
            drives: load.drives,
            exchanging: load.exchanging,
            shortest_cycle: load.cycles.map(|(shortest, _)| seconds(shortest)),
            longest_cycle: load.cycles.map(|(_, longest)| seconds(longest)),
            connections: load.connections,
            disconnections: load.disconnections,
            faults: load.faults,
            received: load.frames.received,
            sent: load.frames.sent,
            missed: load.frames.missed,
            late: load.lateness.late,
            longest_delay: seconds(load.lateness.longest),
            processor: load.processor.map(|time| seconds(time.ran)),
            processor_waiting: load.processor.map(|time| seconds(time.waited)),
        }
    }
}

/// What was injected, or what can be.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InjectReport {
    /// The drive; null where the keys are listed.
    pub drive: Option<String>,
    /// What happened to it.
    pub happened: Option<String>,
    /// What can happen, where nothing was named.
    pub keys: Vec<InjectKey>,
}

/// Something that can happen to a virtual drive.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InjectKey {
    /// The key.
    pub key: &'static str,
    /// The key with a value.
    pub example: &'static str,
    /// What happens.
    pub meaning: &'static str,
}
