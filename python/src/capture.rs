//! Frames of captures, explained.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Instant as Clock;

use ::network::pcap::{ReadError, Reader};
use client::ErrorKind;
use dissect::capture::{Event, Selection, View};
use profile::model::Model;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::json;

use crate::attention::LOOK;
use crate::errors::Failure;
use crate::joined::locked;
use crate::time::Span;
use crate::trace::document;

/// Where the frames are.
#[derive(FromPyObject)]
enum Source {
    Octets(Vec<u8>),
    File(PathBuf),
    Stream(Py<PyAny>),
}

/// An open file of Python.
struct Stream(Py<PyAny>);

impl Read for Stream {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        Python::attach(|py| {
            let stream = self.0.bind(py);
            // of a pipe what is there, not all that fits
            let way = if stream.hasattr("read1")? { "read1" } else { "read" };
            let octets: Vec<u8> = stream.call_method1(way, (into.len(),))?.extract()?;
            let room = into.get_mut(..octets.len());
            let room = room.ok_or_else(|| io::Error::other("it returned more octets than it was to"))?;
            room.copy_from_slice(&octets);
            Ok(octets.len())
        })
    }
}

/// A capture that is being read.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Capture(Mutex<Reading>);

struct Reading {
    /// `None` behind the end.
    frames: Option<Reader>,
    shown: String,
    view: View,
    events: VecDeque<(Event, Option<Vec<u8>>)>,
    damage: Option<PyErr>,
}

impl Reading {
    /// Reads until there is an event, or nothing any more.
    fn advance(&mut self) -> PyResult<()> {
        let mut looked = Clock::now();
        while self.events.is_empty()
            && let Some(frames) = &mut self.frames
        {
            let read = frames.next().transpose();
            let (events, frame) = match read.map_err(|error| unread(&self.shown, error)) {
                Ok(Some(captured)) => match self.view.frame(captured.time, &captured.frame) {
                    Some(events) => (events, Some(captured.frame)),
                    None => (self.end(), None),
                },
                Ok(None) => (self.end(), None),
                Err(error) => {
                    self.damage = Some(error);
                    (self.end(), None)
                }
            };
            let number = self.view.counts().frames;
            let of_frame = |event: &Event| frame.clone().filter(|_| event.frame == number);
            let events = events.into_iter();
            self.events.extend(events.map(|event| {
                let frame = of_frame(&event);
                (event, frame)
            }));
            if looked.elapsed() >= LOOK {
                looked = Clock::now();
                Python::attach(|py| py.check_signals())?;
            }
        }
        Ok(())
    }

    fn end(&mut self) -> Vec<Event> {
        self.frames = None;
        self.view.end()
    }
}

fn unread(shown: &str, error: ReadError) -> PyErr {
    match error {
        // what Python raised itself
        ReadError::Io(error) if error.get_ref().is_some_and(|inner| inner.is::<PyErr>()) => error.into(),
        error => Failure::new(ErrorKind::Local, format!("{shown}: {error}")).into(),
    }
}

fn opened(path: &Path) -> Result<File, Failure> {
    File::open(path).map_err(|error| {
        let failure = Failure::new(
            ErrorKind::Local,
            format!("cannot read {}: {error}", path.display()),
        );
        failure.with(json!({ "errno": error.raw_os_error(), "filename": path }))
    })
}

#[pymethods]
impl Capture {
    #[new]
    fn new(
        py: Python<'_>,
        source: Source,
        station: Option<String>,
        only_trouble: bool,
        since: Option<Span>,
        until: Option<Span>,
        model: Option<&str>,
    ) -> PyResult<Self> {
        let unknown = |name| Failure::usage(format!("no model `{name}`"));
        let model = model
            .map(|name| Model::by_name(name).ok_or_else(|| unknown(name)))
            .transpose()?;
        let selection = Selection {
            station,
            only_trouble,
            since: since.map(|since| since.read()).transpose()?,
            until: until.map(|until| until.read()).transpose()?,
        };
        let view = View::new(model, selection);
        py.detach(|| {
            let frames = |captured: Reader| captured.map_while(|one| Some(one.ok()?.frame));
            let (shown, frames, view) = match source {
                Source::Octets(octets) => {
                    let octets: Arc<[u8]> = octets.into();
                    let open = || Reader::new(Cursor::new(Arc::clone(&octets)));
                    let view = open().map(|captured| view.with_names(frames(captured)));
                    ("the capture".to_owned(), open(), view)
                }
                Source::File(path) => {
                    let named = Reader::new(opened(&path)?);
                    let view = named.map(|captured| view.with_names(frames(captured)));
                    (path.display().to_string(), Reader::new(opened(&path)?), view)
                }
                // it can be read only once
                Source::Stream(stream) => ("the stream".to_owned(), Reader::new(Stream(stream)), Ok(view)),
            };
            let reading = Reading {
                frames: Some(frames.map_err(|error| unread(&shown, error))?),
                view: view.map_err(|error| unread(&shown, error))?,
                shown,
                events: VecDeque::new(),
                damage: None,
            };
            Ok(Self(Mutex::new(reading)))
        })
    }

    /// The next event as JSON, with its frame where it is of one; `None` at the end.
    fn next<'py>(&self, py: Python<'py>) -> PyResult<Option<(String, Option<Bound<'py, PyBytes>>)>> {
        let next = py.detach(|| {
            let mut reading = locked(&self.0);
            reading.advance()?;
            match (reading.events.pop_front(), reading.damage.take()) {
                (Some(event), damage) => {
                    reading.damage = damage;
                    Ok(Some(event))
                }
                (None, Some(damage)) => Err(damage),
                (None, None) => Ok(None),
            }
        })?;
        let Some((event, frame)) = next else {
            return Ok(None);
        };
        let frame = frame.map(|frame| PyBytes::new(py, &frame));
        Ok(Some((document(&event)?, frame)))
    }

    /// A frame as a tree of its fields, with what the capture has shown so far; JSON.
    fn tree(&self, py: Python<'_>, frame: &[u8]) -> PyResult<String> {
        let tree = py.detach(|| locked(&self.0).view.tree(frame));
        Ok(document(&tree)?)
    }

    /// The devices with cyclic frames so far, and the numbers of frames; JSON.
    fn summary(&self, py: Python<'_>) -> PyResult<String> {
        let summary = py.detach(|| locked(&self.0).view.summary());
        Ok(document(
            &json!({ "devices": summary.devices, "counts": summary.counts }),
        )?)
    }
}
