//! `--record FILE` of the commands that move an axis.

use std::path::{Path, PathBuf};

use client::Drive;
use profidrive::machine::SpeedBound;
use profidrive::motion::{MotionError, Observer};
use profidrive::recording::{Form, MotionRecorder, RecordingFile};

use super::axis;
use super::record::form;
use crate::args::Target;
use crate::connect::{Live, Need};
use crate::failure::Failure;
use crate::output::Output;

/// Records the samples of a motion, where that is requested.
pub struct Recorder {
    file: Option<(PathBuf, Form)>,
    recorder: Option<MotionRecorder>,
}

impl Recorder {
    /// Checks the file, before anything is connected.
    pub fn of(file: Option<&Path>) -> Result<Self, Failure> {
        let file = match file {
            None => None,
            Some(file) => {
                let form = form(file)?
                    .ok_or_else(|| Failure::usage("`-`: the samples of a motion are written to a file"))?;
                RecordingFile::check(file, form, None)?;
                Some((file.to_owned(), form))
            }
        };
        Ok(Self { file, recorder: None })
    }

    /// Connects to a drive, moves it and completes the file, whatever became of the motion. Beside what came of the motion is
    /// what came of the file.
    pub fn moving<T>(
        &mut self,
        target: &Target,
        output: &Output,
        work: impl FnOnce((&mut Live, &mut Drive), Option<SpeedBound>, &Observer) -> Result<T, MotionError>,
    ) -> Result<(T, Result<(), Failure>), Failure> {
        let done = axis::moving(
            target,
            Need::Cyclic,
            output,
            |(session, drive), bound, observer| {
                let observer = self.tap(observer, session);
                work((session, drive), bound, &observer)
            },
        );
        let finished = self.recorder.as_ref().map_or(Ok(None), MotionRecorder::finish);
        let recorded = finished.map_err(Failure::from).map(|recorded| {
            if let Some(recorded) = recorded {
                output.say(&format!(
                    "{} samples recorded to {}, {} missed",
                    recorded.rows,
                    recorded.file.display(),
                    recorded.missed
                ));
            }
        });
        match done {
            Ok(done) => Ok((done, recorded)),
            Err(failure) => {
                // the failure of the motion comes first
                if let Err(error) = recorded {
                    output.problem(&error);
                }
                Err(failure)
            }
        }
    }

    fn tap(&mut self, observer: Observer, session: &Live) -> Observer {
        let Some((file, form)) = &self.file else {
            return observer;
        };
        let recorder = MotionRecorder::new(file, *form, session.wall_clock());
        self.recorder = Some(recorder.clone());
        observer.tapped_by(recorder)
    }

    /// The name of the file, once it was begun.
    pub fn file(&self) -> Option<String> {
        let (file, _) = self.file.as_ref().filter(|_| self.recorder.is_some())?;
        Some(file.display().to_string())
    }
}
