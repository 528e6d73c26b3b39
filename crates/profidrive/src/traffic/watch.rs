//! What the frames mean, while they come.

use std::collections::BTreeMap;
use std::time::Duration;

use dissect::capture::event::Detail;
use dissect::capture::{Counts, DeviceSummary, Event, Walker};
use dissect::tree::Node;
use profinet::MacAddress;
use profinet::wire::ethernet::Frame as Ethernet;

use super::keep::{Frame, Traffic};
use crate::report::DriveWords;

/// Stations whose last cyclic frames are kept: drives and their controllers.
const STATIONS: usize = 4096;

/// What a frame shows.
#[derive(Debug, Clone, PartialEq)]
pub enum News {
    /// The control or status word of a drive changed.
    Words {
        /// The drive.
        drive: MacAddress,
        /// Calendar time of the frame since 1970.
        time: Duration,
        /// Its words.
        words: Box<DriveWords>,
    },
    /// Another plant was started in the place of the one before ([`Joined::restart`](crate::Joined::restart)): what frames showed so far
    /// is of drives that are no more.
    Restarted,
    /// Something that points to a fault: a refusal, a lost connection, an alarm.
    Trouble {
        /// Calendar time of the frame since 1970.
        time: Duration,
        /// What happened.
        event: Box<Event>,
    },
}

/// The last cyclic frames of a drive.
#[derive(Debug, Default)]
struct Last {
    /// From its controller.
    output: Option<Frame>,
    /// To its controller.
    input: Option<Frame>,
}

/// Reads the frames of a [`Traffic`] as they come, and keeps what they show of each drive.
#[derive(Debug)]
pub struct Watch {
    traffic: Traffic,
    /// Number of the next frame to read.
    next: u64,
    /// Number of the first frame of the plant that is watched; 0 of an interface.
    began: u64,
    /// Frames that were gone before they were read.
    missed: u64,
    begin: Option<Duration>,
    walker: Walker,
    last: BTreeMap<MacAddress, Last>,
}

impl Watch {
    /// Returns a watch that begins with the oldest frame that is kept.
    #[must_use]
    pub fn new(traffic: &Traffic) -> Self {
        Self {
            traffic: traffic.clone(),
            next: 0,
            began: 0,
            missed: 0,
            begin: None,
            walker: Walker::new(None),
            last: BTreeMap::new(),
        }
    }

    /// Reads the frames that have come since the last call, and calls `notice` with what they show.
    pub fn catch_up(&mut self, notice: &mut dyn FnMut(News)) {
        let (frames, began) = self.traffic.news(self.next);
        for frame in frames {
            if frame.number >= began {
                self.restart(began, notice);
            }
            let missed = frame.number.saturating_sub(self.next);
            self.missed += missed;
            self.next = frame.number + 1;
            self.read(frame, missed > 0, notice);
        }
        self.restart(began, notice);
    }

    /// Forgets the drives of the plant before the one that began with this frame.
    fn restart(&mut self, began: u64, notice: &mut dyn FnMut(News)) {
        if self.began == began {
            return;
        }
        self.began = began;
        self.begin = None;
        self.walker = Walker::new(None);
        self.last.clear();
        notice(News::Restarted);
    }

    fn read(&mut self, frame: Frame, missed: bool, notice: &mut dyn FnMut(News)) {
        let time = frame.time;
        let begin = *self.begin.get_or_insert(time);
        let at = time.saturating_sub(begin);
        if missed {
            self.walker.skip_to(at);
        }
        for event in self.walker.frame(at, &frame.octets) {
            if matches!(event.detail, Detail::State(_) | Detail::Fault(_)) {
                for drive in [event.source.mac, event.target.mac].into_iter().flatten() {
                    if let Some(words) = self.words(drive) {
                        let words = Box::new(words);
                        notice(News::Words { drive, time, words });
                    }
                }
            }
            if event.is_trouble() {
                let event = Box::new(event);
                notice(News::Trouble { time, event });
            }
        }
        let ends = Ethernet::parse(&frame.octets)
            .filter(|parsed| parsed.frame_id.is_cyclic())
            .map(|parsed| (parsed.source, parsed.destination));
        let Some((source, destination)) = ends else {
            return;
        };
        if let Some(last) = self.last_of(destination) {
            last.output = Some(frame.clone());
        }
        if let Some(last) = self.last_of(source) {
            last.input = Some(frame);
        }
    }

    /// Returns the place for the frames of a station; `None` for a new one without room: those that are followed stay.
    fn last_of(&mut self, mac: MacAddress) -> Option<&mut Last> {
        if self.last.len() >= STATIONS && !self.last.contains_key(&mac) {
            return None;
        }
        Some(self.last.entry(mac).or_default())
    }

    /// Returns state and words of a drive as its cyclic frames have them; `None` while it has no cyclic connection that began
    /// under this watch.
    #[must_use]
    pub fn words(&self, drive: MacAddress) -> Option<DriveWords> {
        let words = self.walker.words(drive)?;
        Some(DriveWords::of(
            words.profile,
            words.mode,
            words.control,
            words.status,
        ))
    }

    /// Returns the number of the telegram in the cyclic frames of a drive.
    #[must_use]
    pub fn telegram(&self, drive: MacAddress) -> Option<u16> {
        self.walker.words(drive)?.telegram
    }

    /// Returns the last cyclic frame to (`output`) or from a drive, with what it means.
    #[must_use]
    pub fn last(&self, drive: MacAddress, output: bool) -> Option<(Frame, Node)> {
        let last = self.last.get(&drive)?;
        let frame = if output { &last.output } else { &last.input };
        let frame = frame.clone()?;
        let tree = self.walker.tree(&frame.octets);
        Some((frame, tree))
    }

    /// Returns how regular the cyclic frames of a drive are.
    #[must_use]
    pub fn summary(&self, drive: MacAddress) -> Option<DeviceSummary> {
        self.walker
            .summary()
            .into_iter()
            .find(|device| device.mac == drive)
    }

    /// Returns how far the cyclic frames to (`output`) or from a drive were from their cycle; see [`Walker::deviations`].
    #[must_use]
    pub fn deviations(&self, drive: MacAddress, output: bool) -> Vec<(Duration, u64)> {
        self.walker.deviations(drive, output)
    }

    /// Returns what was seen, in numbers.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.walker.counts()
    }

    /// Returns how many frames were gone before they were read.
    #[must_use]
    pub const fn missed(&self) -> u64 {
        self.missed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mac(number: u16) -> MacAddress {
        let [high, low] = number.to_be_bytes();
        MacAddress([2, 0, 0, 0, high, low])
    }

    /// A cyclic frame without a connect.
    fn cyclic(from: MacAddress, to: MacAddress) -> Vec<u8> {
        let mut frame = [&to.0[..], &from.0, &[0x88, 0x92, 0x80, 0x01]].concat();
        frame.resize(64, 0);
        frame
    }

    #[test]
    fn stations_that_are_followed_make_no_room_for_new_ones() {
        let traffic = Traffic::new();
        let mut watch = Watch::new(&traffic);
        let plc = mac(0);
        for number in 1..=5000 {
            traffic.add(Duration::ZERO, &cyclic(mac(number), plc));
            watch.catch_up(&mut |_| {});
        }
        assert_eq!(watch.last.len(), STATIONS);
        assert!(watch.last(mac(1), false).is_some() && watch.last(mac(5000), false).is_none());
    }
}
