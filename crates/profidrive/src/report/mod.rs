//! What each verb reports: data that serialises, in one shape for each idea, for every front end.
//!
//! | shape | what it is |
//! |---|---|
//! | [`Quantity`] | a number with its unit: speed, position, voltage |
//! | [`Word`], [`DriveState`] | a control or status word with the names of its bits; the state that it reports |
//! | [`Parameter`], [`ParameterError`] | a value of a parameter, or why there is none |
//! | [`Fault`], [`Warning`] | what is wrong with a drive, what it means and what to do |
//! | [`Station`], [`Controller`] | who a drive is, and who has its cyclic connection |
//! | [`Error`] | why a verb failed |
//!
//! Every field is always there: `null` means not known or not applicable, a list without entries is `[]`.
//! Times are in seconds. With the feature `schema` each report has a JSON schema.

mod backup;
mod bundle;
mod change;
mod commission;
mod doctor;
mod drive;
mod drives;
mod gsdml;
mod machine;
mod profile_identity;
mod record;
mod scan;
#[cfg(feature = "schema")]
pub mod schema;
mod serve;
mod shapes;
mod simulation;
mod station;
mod status;
mod tables;

/// Name and version of the JSON form of reports; changes only when a field changes its meaning or goes.
pub const SCHEMA: &str = "profidrive/1";

/// Returns a report as a document with its head: the form and the verb that it is of.
///
/// # Errors
/// When a report is nothing that JSON has.
#[cfg(feature = "documents")]
pub fn document(verb: &str, report: &impl serde::Serialize) -> Result<serde_json::Value, serde_json::Error> {
    let mut document = serde_json::to_value(report)?;
    if let serde_json::Value::Object(fields) = &mut document {
        fields.insert("schema".to_owned(), SCHEMA.into());
        fields.insert("command".to_owned(), verb.into());
    }
    Ok(document)
}

pub use dissect::meaning::{WordBit, WordBits};
pub use dissect::report::{DriveState, Parameter, ParameterContent, ParameterError, Word};

pub use backup::{BackupReport, DiffReport, Difference, MotionTask, NumberedTask, TaskDifference};
pub use bundle::{BundleReport, BundledDrive, BundledFile, PageReport};
pub use change::{MotionTaskChange, RestoreReport, SettingChange, SkippedSetting, WriteReport};
pub use commission::{CommissionReport, CommissionedDrive};
pub use doctor::{Check, DoctorReport, Finding, LinkReport, Severity, TimerReport};
pub use drive::{
    FaultsReport, Identity, InfoReport, LogEntry, Module, MonitorReading, MonitorSilence, Neighbour,
    ParametersReport, Submodule,
};
pub use drives::{Drives, OfDrive};
pub use gsdml::{
    GsdmlAccessPoint, GsdmlCheckReport, GsdmlExportReport, GsdmlItem, GsdmlModule, GsdmlProblem,
    GsdmlShowReport, GsdmlSubmodule, GsdmlSystemSubmodule,
};
pub use machine::{BitCondition, MachineReport, StateMachine, StateName, TransitionRow, WordStrip};
pub use profile_identity::{DriveObject, ProfileIdentity, ProfileVersion, Software};
pub use record::{RecordReport, RecordTrigger, RecordedDrive, RecordedSignal, StepReport};
pub use scan::{Change, Duplicate, Remark, ScanReport, Scanned, Shared, StationChange};
pub use serve::ServeReport;
pub use shapes::{
    Action, Controller, DriveWords, Error, Fault, LossReaction, PlainWording, Quantity, Station, Warning,
    Wording, parameter, parameter_error,
};
pub use simulation::{DemoEvent, DemoStep, InjectKey, InjectReport, SimulationLoad, SimulationReport};
pub use station::{BlinkReport, IpReport, NameReport, ResetReport};
pub use status::{LoadStatus, StatusNote, StatusReport};
pub use tables::{
    DescribeReport, ListReport, ParameterDescription, ReportedDescription, TelegramLayout, TelegramPlace,
    ValueText, access, number,
};
