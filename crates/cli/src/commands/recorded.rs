//! `--record FILE` of the commands that move an axis.

use std::path::{Path, PathBuf};

use profidrive::motion::Observer;
use profidrive::recording::{Form, MotionRecorder, RecordingFile};

use super::record::form;
use crate::connect::Live;
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

    /// Returns the observer with a tap.
    pub fn tap(&mut self, observer: Observer, session: &Live) -> Observer {
        let Some((file, form)) = &self.file else {
            return observer;
        };
        let recorder = MotionRecorder::new(file, *form, session.wall_clock());
        self.recorder = Some(recorder.clone());
        observer.tapped_by(recorder)
    }

    /// Completes the file, whatever became of the motion. The failure of the motion comes first.
    pub fn end<T>(&self, done: Result<T, Failure>, output: &Output) -> Result<T, Failure> {
        let finished = self.recorder.as_ref().map_or(Ok(None), MotionRecorder::finish);
        match (done, finished) {
            (Ok(done), Err(error)) => {
                drop(done);
                Err(error.into())
            }
            (done, finished) => {
                match finished {
                    Ok(Some(recorded)) => output.say(&format!(
                        "{} samples recorded to {}, {} missed",
                        recorded.rows,
                        recorded.file.display(),
                        recorded.missed
                    )),
                    Ok(None) => {}
                    Err(error) => output.problem(&error.into()),
                }
                done
            }
        }
    }

    /// The name of the file, once it was begun.
    pub fn file(&self) -> Option<String> {
        let (file, _) = self.file.as_ref().filter(|_| self.recorder.is_some())?;
        Some(file.display().to_string())
    }
}
