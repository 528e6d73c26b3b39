//! The frames of the last minute.

use std::collections::VecDeque;
use std::io;
use std::ops::RangeInclusive;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::Duration;
#[cfg(feature = "simulate")]
use std::time::{SystemTime, UNIX_EPOCH};

use network::ethernet::Capture;
use network::pcap::Writer;
#[cfg(feature = "simulate")]
use network::segment::Tap;
use profinet::Instant;

/// Frames are kept for this time.
const KEPT: Duration = Duration::from_secs(60);
/// Octets that are kept at most, with what a frame costs beside its own.
const OCTETS: usize = 32 << 20;
/// What a frame costs beside its octets.
const BESIDE: usize = 48;
/// Time between two looks at whether anyone still wants the frames.
const LOOK: Duration = Duration::from_millis(500);

/// How late frames of a plant may be against the time at which they are seen: as late as a plant runs that catches up.
#[cfg(feature = "simulate")]
const MOST_BEHIND: Duration = crate::simulate::MOST_BEHIND;

/// A frame that was kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// Its number, counted from 0 since the network was opened. Frames that this computer missed, as it was too slow, have numbers
    /// too.
    pub number: u64,
    /// Calendar time since 1970.
    pub time: Duration,
    /// Its octets, from the destination on.
    pub octets: Arc<[u8]>,
}

/// The frames of the last minute, at most 32 MiB of them. Clones are the same.
///
/// What it keeps is what the computer sees: of a plant every frame, of an interface those that the switch sends here.
#[derive(Debug, Clone, Default)]
pub struct Traffic(Arc<Mutex<Kept>>);

#[derive(Debug, Default)]
struct Kept {
    frames: VecDeque<Frame>,
    octets: usize,
    /// Number of the next frame.
    next: u64,
    /// Calendar time of the instant zero, of a plant.
    #[cfg(feature = "simulate")]
    origin: Option<Duration>,
    /// Number of the first frame of the plant that runs: those before it are of another one.
    began: u64,
}

impl Kept {
    fn add(&mut self, time: Duration, octets: &[u8]) {
        let frame = Frame {
            number: self.next,
            time,
            octets: octets.into(),
        };
        self.next += 1;
        self.octets += octets.len() + BESIDE;
        self.frames.push_back(frame);
        while let Some(oldest) = self.frames.front()
            && (self.octets > OCTETS || time.saturating_sub(oldest.time) > KEPT)
        {
            self.octets = self.octets.saturating_sub(oldest.octets.len() + BESIDE);
            self.frames.pop_front();
        }
    }
}

#[cfg(feature = "simulate")]
impl Kept {
    /// Adds a frame of a plant at its time, which begins with the first one. A plant that was paused or could not keep up goes on
    /// later than that: its times follow.
    fn add_of_plant(&mut self, since: Duration, now: Duration, octets: &[u8]) {
        let latest = now.saturating_sub(since);
        let origin = self
            .origin
            .filter(|origin| latest.saturating_sub(*origin) <= MOST_BEHIND);
        let origin = *self.origin.insert(origin.unwrap_or(latest));
        self.add(origin + since, octets);
    }
}

impl Traffic {
    /// Returns a place for frames, which [`Opening::kept_in`](crate::Opening::kept_in) fills.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a frame, as a capture does.
    #[cfg(test)]
    pub(super) fn add(&self, time: Duration, octets: &[u8]) {
        self.kept().add(time, octets);
    }

    /// Returns the frames from this number on that are still kept. Where the first one has a larger number, those before it are
    /// gone.
    #[must_use]
    pub fn since(&self, number: u64) -> Vec<Frame> {
        self.news(number).0
    }

    /// The same, with the number of the first frame of the plant that runs: a larger one than at the last call where another plant
    /// was started meanwhile.
    pub(super) fn news(&self, number: u64) -> (Vec<Frame>, u64) {
        let kept = self.kept();
        // numbers of frames that were missed are not there
        let known = kept.frames.partition_point(|frame| frame.number < number);
        (kept.frames.range(known..).cloned().collect(), kept.began)
    }

    /// Returns the frames that are kept as a pcapng file, for Wireshark; `name` is that of the interface in it.
    ///
    /// # Errors
    /// When there is no memory for it.
    pub fn capture(&self, name: &str) -> io::Result<Vec<u8>> {
        self.capture_of(name, Duration::ZERO..=Duration::MAX)
    }

    /// The same of the frames with these calendar times since 1970, as far as they are kept.
    ///
    /// # Errors
    /// When there is no memory for it.
    pub fn capture_of(&self, name: &str, times: RangeInclusive<Duration>) -> io::Result<Vec<u8>> {
        // the frames are written without holding up those that come
        let mut frames = self.since(0);
        frames.retain(|frame| times.contains(&frame.time));
        let mut file = Vec::new();
        {
            let mut writer = Writer::new(&mut file, name, Duration::ZERO)?;
            for frame in &frames {
                let at = u64::try_from(frame.time.as_nanos()).unwrap_or_default();
                writer.write(Instant::from_nanos(at), &frame.octets)?;
            }
            writer.flush()?;
        }
        Ok(file)
    }

    /// Returns what hands over the frames of a plant.
    #[cfg(feature = "simulate")]
    pub(crate) fn tap(&self) -> Box<dyn Tap> {
        self.tap_since(Duration::ZERO)
    }

    /// The same of a plant that was started at this time of its network.
    #[cfg(feature = "simulate")]
    pub(crate) fn tap_since(&self, base: Duration) -> Box<dyn Tap> {
        {
            let mut kept = self.kept();
            kept.began = kept.next;
        }
        Box::new(OfPlant {
            traffic: self.clone(),
            base,
        })
    }

    /// Receives the frames of an interface in a thread of its own, until this and its clones are gone.
    pub(crate) fn receive(&self, capture: Capture) -> io::Result<()> {
        let kept = Arc::downgrade(&self.0);
        let thread = thread::Builder::new().name("profidrive-traffic".into());
        thread.spawn(move || receive(capture, &kept)).map(drop)
    }
}

/// Receives frames while anyone wants them. An interface that is gone ends it: who works on it learns that from its calls.
fn receive(mut capture: Capture, kept: &Weak<Mutex<Kept>>) {
    while kept.strong_count() > 0 {
        match capture.next(LOOK) {
            Ok(Some(captured)) => {
                if let Some(kept) = kept.upgrade() {
                    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                    // a gap leaves out a number, also where its frames were counted before
                    kept.next += captured.missed.max(captured.after_gap.into());
                    // one that is too long has no octets
                    if !captured.frame.is_empty() {
                        kept.add(captured.time, captured.frame);
                    }
                }
            }
            Ok(None) => {}
            Err(_) => return,
        }
    }
}

/// Hands over the frames of a plant.
#[cfg(feature = "simulate")]
#[derive(Debug)]
struct OfPlant {
    traffic: Traffic,
    base: Duration,
}

#[cfg(feature = "simulate")]
impl Tap for OfPlant {
    fn frame(&mut self, at: Instant, frame: &[u8]) {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let since = self.base + Duration::from_nanos(at.as_nanos());
        self.traffic.kept().add_of_plant(since, now, frame);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(times: impl IntoIterator<Item = u64>, length: usize) -> Traffic {
        let traffic = Traffic::new();
        for time in times {
            traffic.kept().add(Duration::from_secs(time), &vec![0; length]);
        }
        traffic
    }

    #[test]
    fn frames_are_kept_for_a_minute() {
        let traffic = kept(0..100, 60);
        let frames = traffic.since(0);
        assert_eq!((frames.len(), frames[0].number), (61, 39));
        assert_eq!(traffic.since(98).len(), 2);
        assert_eq!(traffic.since(100), []);
        assert_eq!(traffic.since(u64::MAX), []);
    }

    #[test]
    fn frames_that_were_missed_have_numbers() {
        let traffic = kept(0..3, 60);
        traffic.kept().next += 10;
        traffic.kept().add(Duration::from_secs(3), &[0; 60]);
        let from = |number| {
            traffic
                .since(number)
                .iter()
                .map(|frame| frame.number)
                .collect::<Vec<_>>()
        };
        assert_eq!(from(2), [2, 13]);
        assert_eq!(from(3), [13]);
        assert_eq!(from(13), [13]);
    }

    #[cfg(feature = "simulate")]
    #[test]
    fn times_of_a_plant_follow_its_pauses() {
        let (traffic, seconds) = (Traffic::new(), Duration::from_secs_f64);
        let mut times = Vec::new();
        for (since, now) in [
            (0.0, 100.0),
            (1.0, 101.0),
            (1.5, 102.4),
            (2.4, 102.4),
            (2.5, 110.5),
            (2.6, 110.6),
        ] {
            traffic
                .kept()
                .add_of_plant(seconds(since), seconds(now), &[0; 60]);
            times.push(traffic.since(0).last().unwrap().time.as_secs_f64());
        }
        // late by less than a second it catches up; after a pause of eight seconds it does not
        assert_eq!(times, [100.0, 101.0, 101.5, 102.4, 110.5, 110.6]);
    }

    #[test]
    fn their_memory_is_bounded() {
        let traffic = kept(std::iter::repeat_n(0, 30_000), 1500);
        let octets: usize = traffic.since(0).iter().map(|frame| frame.octets.len()).sum();
        assert!(octets < OCTETS && octets > OCTETS * 9 / 10, "{octets}");
    }

    #[test]
    fn a_capture_has_the_frames_with_their_times() {
        let file = kept([5, 6], 60).capture("eth0").unwrap();
        let read: Vec<_> = network::pcap::Reader::new(io::Cursor::new(file))
            .unwrap()
            .map(Result::unwrap)
            .collect();
        assert_eq!(read.len(), 2);
        assert_eq!((read[1].time, read[1].frame.len()), (Duration::from_secs(6), 60));
        let seconds = |from, to| Duration::from_secs(from)..=Duration::from_secs(to);
        let around = kept(0..20, 60).capture_of("eth0", seconds(7, 9)).unwrap();
        let times = network::pcap::Reader::new(io::Cursor::new(around)).unwrap();
        let times: Vec<u64> = times.map(|frame| frame.unwrap().time.as_secs()).collect();
        assert_eq!(times, [7, 8, 9]);
    }
}
