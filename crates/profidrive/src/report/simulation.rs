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

/// Something that happened to a virtual drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SimulationEvent {
    /// Seconds since the simulation began.
    pub time: f64,
    /// The drive.
    pub drive: String,
    /// What happened.
    pub text: String,
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
