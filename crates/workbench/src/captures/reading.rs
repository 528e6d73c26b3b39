//! One capture: read once from its beginning, then shown in pieces.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use axum::http::StatusCode;
use profidrive::MacAddress;
use profidrive::report::{DriveState, DriveWords};
use profidrive::traffic::{Counts, Detail, DeviceSummary, Event, Node, Reader, Walker, Weight, hex_bytes};
use schemars::JsonSchema;
use serde::Serialize;

use super::local;
use super::spool::{Frames, Upload};
use crate::problem::Problem;

/// Events that are kept; of those behind only what points to a fault, up to so many more.
const EVENTS: usize = 50_000;
const TROUBLES: usize = 10_000;
/// Frames that establish connections, names and addresses: they are read again before a frame is shown.
const CONTEXT: usize = 10_000;
/// Frames before a frame that are read again: requests whose answer it is.
const BEFORE: u64 = 400;
/// Frames after which progress is shown.
const PROGRESS: u64 = 4096;
/// The longest text of an event, in characters.
const TEXT: usize = 2000;

/// What is known of a capture.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct CaptureReport {
    id: u64,
    /// Octets of its file.
    octets: u64,
    /// Whether all of it was read.
    ended: bool,
    /// Why it was not read to its end, with the place in the file.
    error: Option<String>,
    /// Time of day of its first frame in ms since 1970.
    unix_ms: Option<u64>,
    /// Seconds from the first frame to the last.
    lasts: f64,
    counts: Counts,
    /// Events that are shown.
    events: usize,
    /// Events that had no place.
    left_out: u64,
    /// Devices with cyclic connections, and how regular their frames are.
    devices: Vec<DeviceSummary>,
}

/// Something that happened in a capture.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct CaptureLine {
    /// Number of the frame from 1, as Wireshark counts.
    frame: u64,
    /// Time since the first frame, in seconds.
    time: f64,
    /// Who sent it.
    from: String,
    /// For whom it is; empty where for all.
    to: String,
    /// The protocol or service.
    topic: &'static str,
    /// What happened.
    text: String,
    weight: Weight,
    /// Whether it points to a fault.
    trouble: bool,
    /// The drive whose state it shows, as its MAC address.
    drive: Option<String>,
    /// Its state.
    state: Option<DriveState>,
    #[serde(skip)]
    ends: [Option<MacAddress>; 2],
}

/// What is wanted of the events.
#[derive(Debug, Clone, Default)]
pub(crate) struct Filter {
    /// Only what points to a fault.
    pub trouble: bool,
    /// Only from or to this device.
    pub device: Option<MacAddress>,
    /// Only from this time on and before that, in seconds.
    pub from: Option<f64>,
    pub to: Option<f64>,
    /// Only changes of states.
    pub states: bool,
}

impl Filter {
    fn fits(&self, line: &CaptureLine) -> bool {
        (!self.trouble || line.trouble)
            && (!self.states || line.state.is_some())
            && self.device.is_none_or(|device| line.ends.contains(&Some(device)))
            && self.from.is_none_or(|from| line.time >= from)
            && self.to.is_none_or(|to| line.time < to)
    }
}

/// Some of the events.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct EventPage {
    /// In the order of their frames.
    events: Vec<CaptureLine>,
    /// How many there are with this filter.
    total: usize,
}

/// A frame in a list.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct FrameRow {
    /// Number of the frame from 1, as Wireshark counts.
    frame: u64,
    /// Time since the first frame, in seconds.
    time: f64,
    /// Its octets.
    length: usize,
    /// Sender and receiver.
    source: String,
    destination: String,
    /// What happened in it; empty for cyclic data that says nothing new.
    text: String,
}

/// Some of the frames.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct FramePage {
    frames: Vec<FrameRow>,
    /// How many there are.
    total: u64,
}

/// One frame.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct FrameReport {
    /// Number of the frame from 1, as Wireshark counts.
    frame: u64,
    /// Time since the first frame, in seconds.
    time: f64,
    /// Its octets in hexadecimal.
    octets: String,
    /// Every field of it.
    tree: Node,
    /// What happened in it.
    texts: Vec<String>,
}

/// A capture.
#[derive(Debug)]
pub(crate) struct Reading {
    state: Mutex<Known>,
    frames: Mutex<Option<Frames>>,
    given_up: AtomicBool,
}

#[derive(Debug)]
struct Known {
    report: CaptureReport,
    lines: Vec<CaptureLine>,
    troubles_behind: usize,
    /// Numbers of frames, counted from 0.
    context: VecDeque<u64>,
    begin: Option<Duration>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Known {
    fn add(&mut self, walker: &Walker, event: Event) {
        let is_trouble = event.is_trouble();
        if self.lines.len() >= EVENTS {
            if !is_trouble || self.troubles_behind >= TROUBLES {
                self.report.left_out += 1;
                return;
            }
            self.troubles_behind += 1;
        }
        let ends = [event.source.mac, event.target.mac];
        let has_state = matches!(event.detail, Detail::State(_) | Detail::Fault(_));
        let of_drive = ends.into_iter().flatten().find_map(|mac| {
            let words = walker.words(mac).filter(|_| has_state)?;
            let words = DriveWords::of(words.profile, words.mode, words.control, words.status);
            Some((mac.to_string(), words.state?))
        });
        let (drive, state) = of_drive.unzip();
        self.lines.push(CaptureLine {
            frame: event.frame,
            time: event.at.as_secs_f64(),
            from: event.from,
            to: event.to,
            topic: event.topic,
            text: event.text.chars().take(TEXT).collect(),
            weight: event.weight,
            trouble: is_trouble,
            drive,
            state,
            ends,
        });
        self.report.events = self.lines.len();
    }
}

/// Returns whether a later frame is read with what this one established.
const fn is_context(event: &Event) -> bool {
    matches!(event.detail, Detail::Connect(_) | Detail::Dcp(_))
}

impl Reading {
    pub fn new(id: u64, octets: u64) -> Self {
        Self {
            state: Mutex::new(Known {
                report: CaptureReport {
                    id,
                    octets,
                    ended: false,
                    error: None,
                    unix_ms: None,
                    lasts: 0.0,
                    counts: Counts::default(),
                    events: 0,
                    left_out: 0,
                    devices: Vec::new(),
                },
                lines: Vec::new(),
                troubles_behind: 0,
                context: VecDeque::new(),
                begin: None,
            }),
            frames: Mutex::new(None),
            given_up: AtomicBool::new(false),
        }
    }

    /// Ends reading, as nothing of it will be shown.
    pub fn give_up(&self) {
        self.given_up.store(true, Ordering::Relaxed);
    }

    /// Returns what is known so far.
    pub fn report(&self) -> CaptureReport {
        locked(&self.state).report.clone()
    }

    /// Reads all frames of a file into another one, from which they are shown.
    pub fn read(&self, file: Upload, frames: Upload) {
        let mut walker = Walker::new(None);
        let mut frames = Frames::new(frames);
        let read = self.read_frames(file, &mut frames, &mut walker);
        // what came before a damaged place is shown
        let flushed = frames.flush().map_err(|error| error.to_string());
        let ended = read.and(flushed);
        let mut known = locked(&self.state);
        for event in walker.end() {
            known.add(&walker, event);
        }
        known.report.error = ended.err();
        known.report.counts = walker.counts();
        known.report.devices = walker.summary();
        *locked(&self.frames) = Some(frames);
        known.report.ended = true;
    }

    fn read_frames(&self, file: Upload, frames: &mut Frames, walker: &mut Walker) -> Result<(), String> {
        let reader = file.into_reader().map_err(|error| error.to_string())?;
        for captured in Reader::new(reader).map_err(|error| error.to_string())? {
            let captured = captured.map_err(|error| error.to_string())?;
            let number = frames.count();
            let added = frames.add(captured.time, &captured.frame);
            added.map_err(|error| format!("cannot keep the frames: {error}"))?;
            let mut known = locked(&self.state);
            let begin = *known.begin.get_or_insert(captured.time);
            let at = captured.time.saturating_sub(begin);
            let events = walker.frame(at, &captured.frame);
            if events.iter().any(is_context) {
                if known.context.len() >= CONTEXT {
                    known.context.pop_front();
                }
                known.context.push_back(number);
            }
            for event in events {
                known.add(walker, event);
            }
            known.report.unix_ms = u64::try_from(begin.as_millis()).ok();
            known.report.lasts = known.report.lasts.max(at.as_secs_f64());
            if number.is_multiple_of(PROGRESS) {
                known.report.counts = walker.counts();
            }
            drop(known);
            if self.given_up.load(Ordering::Relaxed) {
                return Err("the capture was removed".to_owned());
            }
        }
        Ok(())
    }

    /// Returns events, `most` from this one on.
    pub fn events(&self, filter: &Filter, from: usize, most: usize) -> EventPage {
        let known = locked(&self.state);
        let fitting = known.lines.iter().filter(|line| filter.fits(line));
        EventPage {
            events: fitting.clone().skip(from).take(most).cloned().collect(),
            total: fitting.count(),
        }
    }

    /// Returns the frames from this number on, counted from 1.
    pub fn frames(&self, from: u64, most: usize) -> Result<FramePage, Problem> {
        let begin = locked(&self.state).begin.unwrap_or_default();
        let mut frames = locked(&self.frames);
        let frames = frames.as_mut().ok_or_else(unread)?;
        let first = from.saturating_sub(1);
        let mut walker = Walker::new(None);
        let mut rows: Vec<FrameRow> = Vec::new();
        self.replay(frames, first, &mut walker)?;
        let read = frames.each(first, &mut |number, time, frame| {
            let at = time.saturating_sub(begin);
            let texts: Vec<String> = walker
                .frame(at, frame)
                .into_iter()
                .map(|event| event.text)
                .collect();
            let mac = |place: usize| {
                let octets = frame
                    .get(place..place + 6)
                    .and_then(|octets| octets.try_into().ok());
                octets.map_or_else(String::new, |octets| MacAddress(octets).to_string())
            };
            rows.push(FrameRow {
                frame: number + 1,
                time: at.as_secs_f64(),
                length: frame.len(),
                source: mac(6),
                destination: mac(0),
                text: texts.join("; ").chars().take(TEXT).collect(),
            });
            rows.len() < most
        });
        read.map_err(|error| local(&error))?;
        Ok(FramePage {
            frames: rows,
            total: frames.count(),
        })
    }

    /// Returns a frame by its number, counted from 1.
    pub fn frame(&self, number: u64) -> Result<FrameReport, Problem> {
        let begin = locked(&self.state).begin.unwrap_or_default();
        let mut frames = locked(&self.frames);
        let frames = frames.as_mut().ok_or_else(unread)?;
        let wanted = number.checked_sub(1).filter(|wanted| *wanted < frames.count());
        let wanted = wanted.ok_or_else(|| {
            let detail = format!("the capture has the frames 1 to {}", frames.count());
            Problem::new(StatusCode::NOT_FOUND, "frame", &detail)
        })?;
        let mut walker = Walker::new(None);
        self.replay(frames, wanted, &mut walker)?;
        let mut report = None;
        let read = frames.each(wanted, &mut |_, time, frame| {
            let at = time.saturating_sub(begin);
            let texts = walker.frame(at, frame).into_iter().map(|event| event.text);
            report = Some(FrameReport {
                frame: number,
                time: at.as_secs_f64(),
                octets: hex_bytes(frame),
                texts: texts.collect(),
                tree: walker.tree(frame),
            });
            false
        });
        read.map_err(|error| local(&error))?;
        report.ok_or_else(unread)
    }

    /// Reads again what frames before this one established.
    fn replay(&self, frames: &mut Frames, until: u64, walker: &mut Walker) -> Result<(), Problem> {
        let (begin, context) = {
            let known = locked(&self.state);
            let earliest = until.saturating_sub(BEFORE);
            let before = known
                .context
                .iter()
                .copied()
                .take_while(|number| *number < earliest);
            (known.begin.unwrap_or_default(), before.collect::<Vec<_>>())
        };
        let mut again = |number: u64, frames: &mut Frames, end: u64| {
            frames.each(number, &mut |number, time, frame| {
                if number < end {
                    walker.frame(time.saturating_sub(begin), frame);
                }
                number + 1 < end
            })
        };
        for number in context {
            again(number, frames, number + 1).map_err(|error| local(&error))?;
        }
        again(until.saturating_sub(BEFORE), frames, until).map_err(|error| local(&error))
    }
}

fn unread() -> Problem {
    let detail = "the capture is still being read";
    Problem::new(StatusCode::CONFLICT, "reading", detail)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What happens with a DCP frame.
    fn event(dcp: &[u8]) -> Event {
        let mut walker = Walker::new(None);
        let frame = [[0x02; 12].as_slice(), &[0x88, 0x92, 0xFE, 0xFD], dcp].concat();
        walker.frame(Duration::ZERO, &frame).remove(0)
    }

    #[test]
    fn events_are_bounded_and_those_that_point_to_a_fault_longer() {
        let walker = Walker::new(None);
        let reading = Reading::new(1, 0);
        let mut known = locked(&reading.state);
        let harmless = event(&[3, 0, 0, 0, 0, 7, 0, 0, 0, 2, 2, 2]);
        // it ends in the middle
        let trouble = event(&[3]);
        assert_eq!((harmless.is_trouble(), trouble.is_trouble()), (false, true));
        for event in [&harmless, &trouble] {
            for frame in 0..60_000 {
                let event = Event {
                    frame,
                    ..event.clone()
                };
                known.add(&walker, event);
            }
        }
        let troubles = known.lines.iter().filter(|line| line.trouble).count();
        assert_eq!((known.lines.len(), troubles), (EVENTS + TROUBLES, TROUBLES));
        assert_eq!(known.report.events, EVENTS + TROUBLES);
        assert_eq!(known.report.left_out, 120_000 - 60_000);
    }
}
