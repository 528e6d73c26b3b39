//! Captures that a page uploads: kept for as long as the server runs, read once, and then shown in pieces.
//!
//! Nothing of a capture is in memory but what happened in it, up to a bound, and where its frames are on the disk.

mod reading;
mod spool;

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::http::StatusCode;

use crate::problem::Problem;

pub(crate) use reading::{CaptureReport, EventPage, Filter, FramePage, FrameReport, Reading};
pub(crate) use spool::Upload;

/// Captures that are kept at a time; the oldest makes room.
const CAPTURES: usize = 4;

/// The captures of a server.
#[derive(Debug)]
pub(crate) struct Captures {
    folder: PathBuf,
    all: Mutex<VecDeque<(u64, Arc<Reading>)>>,
    next: AtomicU64,
}

impl Captures {
    /// Returns a place for captures, in files of this folder that have no name as soon as they are open.
    pub fn new(folder: Option<&Path>) -> Self {
        Self {
            folder: folder.map_or_else(std::env::temp_dir, |folder| folder.join("captures")),
            all: Mutex::default(),
            next: AtomicU64::new(1),
        }
    }

    fn all(&self) -> MutexGuard<'_, VecDeque<(u64, Arc<Reading>)>> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns a file for an upload.
    pub fn begin(&self) -> Result<Upload, Problem> {
        Upload::new(&self.folder).map_err(|error| local(&error))
    }

    /// Takes an upload, whose frames are read in a thread of its own.
    pub fn take(&self, upload: Upload) -> Result<CaptureReport, Problem> {
        let frames = Upload::new(&self.folder).map_err(|error| local(&error))?;
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        let reading = Arc::new(Reading::new(id, upload.octets()));
        let work = Arc::clone(&reading);
        // ends with the file, or when the capture was removed
        tokio::task::spawn_blocking(move || work.read(upload, frames));
        let mut all = self.all();
        if all.len() >= CAPTURES
            && let Some((_, oldest)) = all.pop_front()
        {
            oldest.give_up();
        }
        all.push_back((id, Arc::clone(&reading)));
        drop(all);
        Ok(reading.report())
    }

    /// Returns a capture.
    pub fn get(&self, id: u64) -> Result<Arc<Reading>, Problem> {
        let found = self.all().iter().find(|(known, _)| *known == id).cloned();
        found.map(|(_, reading)| reading).ok_or_else(|| {
            let detail = "there is no such capture: the last four are kept while the server runs";
            Problem::new(StatusCode::NOT_FOUND, "capture", detail)
        })
    }

    /// Returns all captures, the newest first.
    pub fn list(&self) -> Vec<CaptureReport> {
        let all: Vec<_> = self
            .all()
            .iter()
            .rev()
            .map(|(_, reading)| Arc::clone(reading))
            .collect();
        all.iter().map(|reading| reading.report()).collect()
    }

    /// Removes a capture.
    pub fn remove(&self, id: u64) -> Result<(), Problem> {
        self.get(id)?.give_up();
        self.all().retain(|(known, _)| *known != id);
        Ok(())
    }
}

pub(crate) fn local(error: &std::io::Error) -> Problem {
    let detail = format!("cannot keep the capture: {error}");
    let status = match error.kind() {
        std::io::ErrorKind::StorageFull | std::io::ErrorKind::QuotaExceeded => {
            StatusCode::INSUFFICIENT_STORAGE
        }
        _ => StatusCode::INTERNAL_SERVER_ERROR,
    };
    Problem::new(status, "local", &detail)
}
