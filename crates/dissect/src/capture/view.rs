//! The part of a capture that a person wants to see.

use std::time::Duration;

use profile::model::Model;

use super::{Counts, DeviceSummary, Event, Walker};
use crate::tree::Node;

/// Which events are wanted. Times are since the first frame.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Selection {
    /// Only what is from, to or about this station: its name, IP address or Ethernet address.
    pub station: Option<String>,
    /// Only what points to a fault.
    pub only_trouble: bool,
    /// Leaves out what is before; the summary is about what follows.
    pub since: Option<Duration>,
    /// The end: later frames are not looked at.
    pub until: Option<Duration>,
}

/// Looks at the frames of a capture in order and returns the events that are wanted.
///
/// ```
/// use std::time::Duration;
///
/// use profidrive_dissect::capture::{Selection, View};
///
/// let selection = Selection { only_trouble: true, ..Selection::default() };
/// let mut view = View::new(None, selection);
/// // a PROFINET frame that ends after its FrameID
/// let cut = [[0x02; 12].as_slice(), &[0x88, 0x92, 0xFE, 0xFE]].concat();
/// let events = view.frame(Duration::from_secs(1_700_000_000), &cut).ok_or("at its end")?;
/// assert_eq!((events[0].topic, events[0].at), ("malformed", Duration::ZERO));
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug)]
pub struct View {
    walker: Walker,
    /// The names of the whole capture, where it was read before.
    names: Option<Walker>,
    selection: Selection,
    first: Option<Duration>,
    now: Duration,
    /// Time without frames, while frames are being captured.
    idle: Duration,
    began: bool,
    met: bool,
}

/// What was seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// The devices that are wanted, and how regular their frames are.
    pub devices: Vec<DeviceSummary>,
    /// Frames, of all stations.
    pub counts: Counts,
    /// The station that was asked for, where nothing is from, to or about it.
    pub missing: Option<String>,
}

impl View {
    /// Drives whose identity is not in the capture are decoded as this model; without one as an AKD.
    #[must_use]
    pub fn new(model: Option<Model>, selection: Selection) -> Self {
        Self {
            walker: Walker::new(model),
            names: None,
            began: selection.since.is_none(),
            selection,
            first: None,
            now: Duration::ZERO,
            idle: Duration::ZERO,
            met: false,
        }
    }

    /// Reads a capture that can be read twice for the names of its stations: a name may appear only after the first frames
    /// of its station. Nothing is read where no station was asked for.
    #[must_use]
    pub fn with_names<F: AsRef<[u8]>>(mut self, frames: impl IntoIterator<Item = F>) -> Self {
        if self.selection.station.is_some() {
            let mut walker = Walker::default();
            for frame in frames {
                walker.frame(Duration::ZERO, frame.as_ref());
            }
            self.names = Some(walker);
        }
        self
    }

    /// Looks at a frame, with its time as the capture has it, and returns the events that are wanted; `None` at the end of
    /// the selection.
    pub fn frame(&mut self, time: Duration, frame: &[u8]) -> Option<Vec<Event>> {
        let at = time.saturating_sub(*self.first.get_or_insert(time));
        self.now = at;
        self.idle = Duration::ZERO;
        if self.selection.until.is_some_and(|until| at > until) {
            return None;
        }
        if !self.began && self.selection.since.is_some_and(|since| at >= since) {
            self.began = true;
            self.walker.restart_summary();
        }
        let events = self.walker.frame(at, frame);
        Some(self.wanted(events))
    }

    /// Goes on at this time without the frames before it ([`Walker::skip_to`]).
    pub fn skip_to(&mut self, time: Duration) {
        let first = *self.first.get_or_insert(time);
        self.walker.skip_to(time.saturating_sub(first));
    }

    /// Returns the statistics so far, of all stations.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.walker.counts()
    }

    /// Returns a frame as a tree of its fields, with what the frames so far showed ([`Walker::tree`]).
    #[must_use]
    pub fn tree(&self, frame: &[u8]) -> Node {
        self.walker.tree(frame)
    }

    /// Counts time without a frame; true when the end of the selection has passed.
    pub fn waited(&mut self, time: Duration) -> bool {
        self.idle += time;
        self.selection
            .until
            .is_some_and(|until| self.now + self.idle > until)
    }

    /// Ends the capture: returns what is still without an answer, as far as it is wanted.
    pub fn end(&mut self) -> Vec<Event> {
        // what waits for an answer when the selection ends before the capture is not without one
        if self.selection.until.is_some() {
            return Vec::new();
        }
        let events = self.walker.end();
        self.wanted(events)
    }

    /// Returns what was seen.
    #[must_use]
    pub fn summary(&self) -> Summary {
        let mut devices = self.walker.summary();
        let wanted = self.selection.station.as_ref();
        devices.retain(|device| wanted.is_none_or(|wanted| device.is(wanted)));
        Summary {
            missing: wanted.filter(|_| !self.met && devices.is_empty()).cloned(),
            devices,
            counts: self.walker.counts(),
        }
    }

    fn wanted(&mut self, mut events: Vec<Event>) -> Vec<Event> {
        if let Some(station) = &self.selection.station {
            let walkers = std::iter::once(&self.walker).chain(&self.names);
            events.retain(|event| walkers.clone().any(|walker| walker.is_about(event, station)));
        }
        self.met |= !events.is_empty();
        let Selection {
            since, only_trouble, ..
        } = self.selection;
        events.retain(|event| {
            since.is_none_or(|since| event.at >= since) && (!only_trouble || event.is_trouble())
        });
        events
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A DCP identify request of a name that no station has.
    fn identify(source: u8) -> Vec<u8> {
        let mut frame = vec![0x01, 0x0E, 0xCF, 0, 0, 0, 2, 0, 0, 0, 0, source, 0x88, 0x92];
        frame.extend([0xFE, 0xFE, 5, 0, 0, 0, 0, 1, 0, 1, 0, 4, 0xFF, 0xFF, 0, 0]);
        frame.resize(60, 0);
        frame
    }

    /// The times of the events in tenths of a second, whether more came at the end, and the summary.
    fn seen(selection: Selection) -> (Vec<u128>, bool, Summary) {
        let mut view = View::new(None, selection);
        let mut seen = Vec::new();
        for (tenth, source) in [(1000, 1), (1001, 2), (1002, 3)] {
            let Some(events) = view.frame(Duration::from_millis(tenth * 100), &identify(source)) else {
                break;
            };
            seen.extend(events.iter().map(|event| event.at.as_millis() / 100));
        }
        (seen, !view.end().is_empty(), view.summary())
    }

    #[test]
    fn only_what_is_wanted_is_returned() {
        let tenth = |tenth: u64| Some(Duration::from_millis(tenth * 100));
        let station = |name: &str| Some(name.to_owned());
        // no station answers
        let (times, unanswered, _) = seen(Selection::default());
        assert_eq!((times, unanswered), (vec![0, 1, 2], true));
        let since = Selection {
            since: tenth(1),
            ..Selection::default()
        };
        assert_eq!(seen(since).0, [1, 2]);
        let until = Selection {
            until: tenth(1),
            ..Selection::default()
        };
        let (times, unanswered, summary) = seen(until);
        assert_eq!((times, unanswered, summary.counts.frames), (vec![0, 1], false, 2));
        let of_one = Selection {
            station: station("02:00:00:00:00:02"),
            ..Selection::default()
        };
        let (times, _, summary) = seen(of_one);
        assert_eq!((times, summary.missing), (vec![1], None));
        let of_nobody = Selection {
            station: station("akd-1"),
            ..Selection::default()
        };
        let (times, unanswered, summary) = seen(of_nobody);
        assert_eq!(
            (times, unanswered, summary.missing),
            (vec![], false, station("akd-1"))
        );
    }

    #[test]
    fn a_capture_without_frames_goes_on_until_its_end() {
        let selection = Selection {
            until: Some(Duration::from_secs(2)),
            ..Selection::default()
        };
        let mut view = View::new(None, selection);
        assert!(view.frame(Duration::from_secs(50), &identify(1)).is_some());
        assert!(!view.waited(Duration::from_secs(1)));
        assert!(!view.waited(Duration::from_secs(1)));
        assert!(view.waited(Duration::from_millis(1)));
        assert!(view.frame(Duration::from_secs(53), &identify(1)).is_none());
    }
}
