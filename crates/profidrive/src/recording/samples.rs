//! The cyclic samples of a motion, recorded to a file as a recording of every cycle has them.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use client::Axis;
use client::axis::{AxisSignal, Sample};
use profinet::Instant;

use super::cyclic::{Last, value_of};
use super::error::WriteError;
use super::file::{Form, RecordingFile};
use super::producer::MOST_GAPS;
use super::source::column_of;
use super::table::{Row, Sink, Table};
use crate::clock::WallClock;
use crate::motion::{SampleTap, TapError};

/// Records every cyclic sample of a motion to a file. The file is created once the axis is taken, before it moves. A write that
/// fails does not end the motion.
///
/// ```
/// # #[cfg(feature = "simulate")] {
/// use std::time::Duration;
/// use profidrive::Wait;
/// use profidrive::motion::{self, Observer, Run};
/// use profidrive::recording::{Form, MotionRecorder};
///
/// # let plant = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
/// # let folder = std::env::temp_dir().join(format!("profidrive-doc-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let mut network = profidrive::open_plan(plant.parse()?)?;
/// let mut drive = network.find(&"akd-1".parse()?).wait()?;
/// let recorder = MotionRecorder::new(&folder.join("run.csv"), Form::Csv, network.wall_clock());
/// let observer = Observer::default().tapped_by(recorder.clone());
/// let wanted = Run { time: Some(Duration::from_secs(1)), ..Run::at(60.0) };
/// motion::run(&mut network, &mut drive, &wanted, &observer).wait()?;
/// let recorded = recorder.finish()?.unwrap();
/// assert!(recorded.rows > 60 && recorded.file.exists());
/// # std::fs::remove_dir_all(&folder)?;
/// # }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MotionRecorder(Arc<Mutex<State>>);

#[derive(Debug)]
struct State {
    path: PathBuf,
    form: Form,
    clock: WallClock,
    /// Once the axis is taken.
    open: Option<Open>,
    failed: Option<WriteError>,
}

#[derive(Debug)]
struct Open {
    signals: Vec<AxisSignal>,
    table: Table,
    cycle: Duration,
    file: RecordingFile,
    start: Option<Instant>,
    last: Last,
    recorded: MotionRecorded,
}

/// What was recorded of a motion.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MotionRecorded {
    /// The file.
    pub file: PathBuf,
    /// Rows with values.
    pub rows: u64,
    /// Cycles that are missing.
    pub missed: u64,
}

impl MotionRecorder {
    /// Will record to a new file. `clock` is that of the network ([`Caller::wall_clock`](crate::Caller::wall_clock)).
    #[must_use]
    pub fn new(file: &Path, form: Form, clock: WallClock) -> Self {
        Self(Arc::new(Mutex::new(State {
            path: file.to_owned(),
            form,
            clock,
            open: None,
            failed: None,
        })))
    }

    /// Completes the file, after the motion, whatever its end. `None` where the axis was not taken: then there is no file.
    ///
    /// # Errors
    /// When something could not be written.
    pub fn finish(&self) -> Result<Option<MotionRecorded>, WriteError> {
        let mut state = self.state();
        let open = state.open.take();
        if let Some(error) = state.failed.take() {
            return Err(error);
        }
        let Some(mut open) = open else { return Ok(None) };
        open.file.finish()?;
        Ok(Some(open.recorded))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl SampleTap for MotionRecorder {
    fn begin(&mut self, axis: &Axis) -> Result<(), TapError> {
        let mut state = self.state();
        let signals = axis.signals();
        let table = Table {
            drives: vec![axis.drive().label()],
            columns: signals.iter().map(column_of).collect(),
            facts: Vec::new(),
        };
        state.open = Some(Open {
            file: RecordingFile::create(&table, &state.path, state.form, None)?,
            signals,
            table,
            cycle: axis.cycle(),
            start: None,
            last: None,
            recorded: MotionRecorded {
                file: state.path.clone(),
                rows: 0,
                missed: 0,
            },
        });
        Ok(())
    }

    fn take(&mut self, sample: &Sample, now: Instant) {
        let mut state = self.state();
        let clock = state.clock;
        if state.failed.is_some() {
            return;
        }
        let Some(open) = &mut state.open else { return };
        if let Err(error) = open.write(sample, now, clock) {
            state.failed = Some(error);
        }
    }
}

impl Open {
    /// Writes a sample, after a row for each cycle that is missing before it.
    fn write(&mut self, sample: &Sample, now: Instant, clock: WallClock) -> Result<(), WriteError> {
        let start = *self.start.get_or_insert(sample.at);
        let row = |at: Instant, gap, values| Row {
            time: at.saturating_since(start),
            wall: clock.before(now.saturating_since(at)),
            drive: 0,
            gap,
            values,
        };
        let missed = self.last.map_or(0, |before| sample.missing_since(&before));
        self.recorded.missed += missed;
        if let Some(before) = self.last {
            for lost in 1..=missed.min(MOST_GAPS) {
                let after = self.cycle * u32::try_from(lost).unwrap_or(u32::MAX);
                self.file
                    .write(&row(before.at + after, true, vec![None; self.signals.len()]))?;
            }
        }
        self.last = Some(*sample);
        let values = self.signals.iter().zip(&self.table.columns);
        let values = values.map(|(signal, column)| value_of(signal, sample, column.kind));
        self.file.write(&row(sample.at, false, values.collect()))?;
        self.recorded.rows += 1;
        Ok(())
    }
}
