//! What was recorded.

use serde::Serialize;

use super::Quantity;
use crate::motion::{Response, Step, Stepped};

/// A recording that ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordReport {
    /// The complete files, in their order; empty where the rows went elsewhere.
    pub files: Vec<String>,
    /// The file with the plot.
    pub plot: Option<String>,
    /// Seconds from the start to the end.
    pub time: f64,
    /// Rows with values, of all drives.
    pub rows: u64,
    /// Rows that are gaps, of all drives.
    pub gaps: u64,
    /// Rows in the files, gaps among them: fewer than were recorded where a file could not be written. Null where the rows went
    /// elsewhere.
    pub written: Option<u64>,
    /// The signals.
    pub signals: Vec<RecordedSignal>,
    /// The drives.
    pub drives: Vec<RecordedDrive>,
    /// The event at which the recording began; null without one, and where it did not happen.
    pub trigger: Option<RecordTrigger>,
}

/// A step of the speed of an axis that ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StepReport {
    /// The drive.
    pub drive: String,
    /// Speed before the step.
    pub from: Quantity,
    /// Speed that was commanded by the step.
    pub to: Quantity,
    /// Update time of the connection, s.
    pub cycle: f64,
    /// The times of the figures are exact to this, s: the longest time between two samples of the step, one cycle at least.
    pub resolution: f64,
    /// Cycles without a sample.
    pub missed: u64,
    /// Samples of the step.
    pub samples: usize,
    /// Samples that were lost on the way.
    pub dropped: u64,
    /// The figures; null where the connection carries no speed or the step was not seen.
    pub response: Option<Response>,
    /// The figures of the step it is compared with.
    pub before: Option<Response>,
    /// The file with the samples.
    pub file: Option<String>,
    /// The file with the plot.
    pub plot: Option<String>,
}

impl StepReport {
    /// Returns the report of a step that ended. `wanted` is in rpm or percent ([`Step::in_rpm`]), `before` has the figures of the
    /// step that it is compared with.
    #[must_use]
    pub fn new(
        stepped: &Stepped,
        wanted: &Step,
        before: Option<Response>,
        [file, plot]: [Option<String>; 2],
    ) -> Self {
        let unit = wanted.run.unit;
        Self {
            drive: stepped.drive.clone(),
            from: Quantity::speed(wanted.from, unit),
            to: Quantity::speed(wanted.run.speed, unit),
            cycle: stepped.cycle.as_secs_f64(),
            resolution: stepped.resolution.as_secs_f64(),
            missed: stepped.missed,
            samples: stepped.samples.len(),
            dropped: stepped.dropped,
            response: stepped.response,
            before,
            file,
            plot,
        }
    }
}

/// A signal of a recording.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordedSignal {
    /// As it was named.
    pub name: String,
    /// Unit of its values, empty for none.
    pub unit: String,
    /// The parameter or the signal of the telegram: `DRV.ACC (p2108)`, `signal 5`.
    pub parameter: String,
    /// How the values follow from what travels; empty for a number as it travels.
    pub scaling: String,
}

/// What was recorded of a drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordedDrive {
    /// The drive.
    pub drive: String,
    /// Rows with values.
    pub rows: u64,
    /// Rows that are gaps.
    pub gaps: u64,
    /// Readings or cycles that are missing, in gaps or beside them.
    pub missed: u64,
    /// How often it did not answer or was lost.
    pub outages: u64,
    /// How long it was away, as far as it came back, in seconds.
    pub outage_time: f64,
    /// Seconds from the start since when nothing was recorded of it; null where it was recorded at the end.
    pub away_since: Option<f64>,
    /// Update time of the cyclic connection in seconds; null where parameters were read.
    pub cycle: Option<f64>,
    /// Telegram of the cyclic connection.
    pub telegram: Option<u16>,
}

/// The event at which a recording began.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordTrigger {
    /// What happened: `fault`, `NIST_A > 60rpm`.
    pub condition: String,
    /// The drive on which it happened.
    pub drive: String,
    /// Seconds from the start to its row.
    pub time: f64,
    /// The time of day of its row, in seconds since 1970-01-01 UTC; null in virtual time.
    pub wall: Option<f64>,
    /// Numbers of the faults that came with it, where the condition is a fault.
    pub faults: Vec<u16>,
}

#[cfg(feature = "recording")]
mod of {
    use std::path::{Path, PathBuf};
    use std::time::Duration;

    use super::{RecordReport, RecordTrigger, RecordedDrive, RecordedSignal};
    use crate::recording::Recording;
    use crate::report::drive::since_1970;
    use crate::{Remark, lasting};

    impl RecordReport {
        /// Returns which drives were not recorded at the end.
        #[must_use]
        pub fn remarks(&self) -> Vec<Remark> {
            let of_drive = |drive: &RecordedDrive| {
                let since = lasting(Duration::try_from_secs_f64(drive.away_since?).ok()?);
                // a drive reports the end of a cyclic connection by itself
                let fault = match drive.cycle {
                    Some(_) => "; its lost connection may have left a fault in it",
                    None => "",
                };
                Some(Remark::warning(format!(
                    "{}: nothing was recorded from {since} after the start to the end{fault}",
                    drive.drive
                )))
            };
            self.drives.iter().filter_map(of_drive).collect()
        }

        /// Returns what was recorded so far. `cyclic` has the update time and telegram of each drive.
        #[must_use]
        pub fn of(recording: &Recording, cyclic: &[Option<(Duration, u16)>], files: &[PathBuf]) -> Self {
            let table = recording.table();
            let counts = recording.counts();
            let name = |drive: usize| table.drives.get(drive).cloned().unwrap_or_default();
            let drives = counts.iter().enumerate().map(|(at, counts)| {
                let cyclic = cyclic.get(at).copied().flatten();
                RecordedDrive {
                    drive: name(at),
                    rows: counts.rows,
                    gaps: counts.gaps,
                    missed: counts.missed,
                    outages: counts.outages,
                    outage_time: counts.outage_time.as_secs_f64(),
                    away_since: counts.away_since.map(|since| since.as_secs_f64()),
                    cycle: cyclic.map(|(cycle, _)| cycle.as_secs_f64()),
                    telegram: cyclic.map(|(_, telegram)| telegram),
                }
            });
            let signals = table.columns.iter().map(|column| RecordedSignal {
                name: column.name.clone(),
                unit: column.unit.clone(),
                parameter: column.parameter.clone(),
                scaling: column.scaling.clone(),
            });
            let shown = |file: &PathBuf| Path::display(file).to_string();
            Self {
                files: files.iter().map(shown).collect(),
                plot: None,
                time: recording.elapsed().as_secs_f64(),
                rows: counts.iter().map(|counts| counts.rows).sum(),
                gaps: counts.iter().map(|counts| counts.gaps).sum(),
                written: None,
                signals: signals.collect(),
                drives: drives.collect(),
                trigger: recording.triggered().map(|triggered| RecordTrigger {
                    condition: triggered.trigger.to_string(),
                    drive: name(triggered.drive),
                    time: triggered.time.as_secs_f64(),
                    wall: triggered.wall.and_then(since_1970),
                    faults: triggered.faults.iter().map(|fault| fault.number).collect(),
                }),
            }
        }
    }
}
