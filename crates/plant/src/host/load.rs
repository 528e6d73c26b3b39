//! What a simulation does, in a few figures.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use network::ethernet::{Lateness, PacketStatistics};
use network::system::ThreadTime;
use virtual_drive::station::StationEvent;

use crate::text::count;

/// A thread that is busy for this share of its time has no room for more drives.
const FULL: f64 = 0.9;

/// What a simulation on a network does at one moment, and what it has done since its start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Load {
    /// Time since the start.
    pub time: Duration,
    /// Drives.
    pub drives: usize,
    /// Drives that exchange data with a controller.
    pub exchanging: usize,
    /// Shortest and longest time between two input frames of those.
    pub cycles: Option<(Duration, Duration)>,
    /// Connections of controllers on which the exchange of data began, since the start.
    pub connections: u64,
    /// Connections of controllers that ended, since the start.
    pub disconnections: u64,
    /// Faults that came, since the start.
    pub faults: u64,
    /// Frames, since the start.
    pub frames: PacketStatistics,
    /// How late the drives did what was due, since the start.
    pub lateness: Lateness,
    /// Processor time of the thread that runs the drives; `None` where the system does not report it.
    pub processor: Option<ThreadTime>,
}

impl Load {
    /// Returns what happened after `before`: its counters and times are differences, the rest is as now. The longest delay
    /// is that since the start.
    #[must_use]
    pub fn since(&self, before: &Self) -> Self {
        let (now, then) = (&self.frames, &before.frames);
        Self {
            time: self.time.saturating_sub(before.time),
            connections: self.connections.saturating_sub(before.connections),
            disconnections: self.disconnections.saturating_sub(before.disconnections),
            faults: self.faults.saturating_sub(before.faults),
            frames: PacketStatistics {
                received: now.received.saturating_sub(then.received),
                sent: now.sent.saturating_sub(then.sent),
                unsent: now.unsent.saturating_sub(then.unsent),
                missed: now.missed.saturating_sub(then.missed),
            },
            lateness: Lateness {
                late: self.lateness.late.saturating_sub(before.lateness.late),
                longest: self.lateness.longest,
            },
            processor: self
                .processor
                .zip(before.processor)
                .map(|(now, then)| ThreadTime {
                    ran: now.ran.saturating_sub(then.ran),
                    waited: now.waited.saturating_sub(then.waited),
                }),
            ..*self
        }
    }

    /// Returns the share of a processor that the drives used, 0 to 1; of the time of this load.
    #[must_use]
    pub fn used(&self) -> Option<f64> {
        share(self.processor?.ran, self.time)
    }

    /// Returns how many drives would fit, when these came too late because their thread had too much to do.
    #[must_use]
    pub fn overload(&self) -> Option<Overload> {
        let busy = self.processor?;
        let used = share(busy.ran, self.time)?;
        let waited = share(busy.waited, self.time)?;
        let full = self.lateness.late > 0 && self.exchanging > 0 && used + waited >= FULL;
        // what waits for a processor has work to do too
        let fit = self.exchanging as f64 * FULL * used / (used + waited);
        full.then_some(Overload {
            used,
            waited,
            late: self.lateness.late,
            exchanging: self.exchanging,
            fit: fit as usize,
        })
    }
}

fn share(part: Duration, whole: Duration) -> Option<f64> {
    (!whole.is_zero()).then(|| part.as_secs_f64() / whole.as_secs_f64())
}

impl fmt::Display for Load {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {} exchange data", self.exchanging, count(self.drives))?;
        let milliseconds = |cycle: Duration| cycle.as_secs_f64() * 1000.0;
        match self.cycles {
            Some((one, other)) if one == other => write!(f, " every {} ms", milliseconds(one))?,
            Some((one, other)) => {
                write!(f, " every {} to {} ms", milliseconds(one), milliseconds(other))?;
            }
            None => {}
        }
        if let Some(seconds) = Some(self.time.as_secs_f64()).filter(|seconds| *seconds > 0.0) {
            let rate = |number: u64| number as f64 / seconds;
            let (received, sent) = (rate(self.frames.received), rate(self.frames.sent));
            write!(f, "; frames per second {received:.0} in, {sent:.0} out")?;
        }
        if self.frames.missed > 0 {
            write!(f, ", {} lost", self.frames.missed)?;
        }
        write!(f, "; late {}", self.lateness.late)?;
        if let Some(used) = self.used() {
            write!(f, "; CPU {:.0} %", used * 100.0)?;
        }
        if self.faults > 0 {
            write!(f, "; {} faults", self.faults)?;
        }
        Ok(())
    }
}

/// More drives than their thread has time for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overload {
    /// Share of a processor that they used, 0 to 1.
    pub used: f64,
    /// Share of the time in which they waited for a processor that other programs used.
    pub waited: f64,
    /// Deadlines met more than 1 ms late.
    pub late: u64,
    /// Drives that exchange data.
    pub exchanging: usize,
    /// Drives that would fit, at the same cycles and beside the same programs.
    pub fit: usize,
}

impl fmt::Display for Overload {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            used,
            waited,
            late,
            exchanging,
            fit,
        } = self;
        write!(
            f,
            "the processor is too slow for {exchanging} drives: {late} times late; it worked for them for {:.0} % of the time",
            used * 100.0
        )?;
        if *waited > 0.05 {
            write!(f, " and for other programs for {:.0} %", waited * 100.0)?;
        }
        write!(f, "; at these cycles about {fit} drives fit")
    }
}

/// What is counted while a simulation runs.
#[derive(Debug, Default)]
pub(super) struct Tally {
    /// How many drives exchange data at each time between two input frames.
    cycles: BTreeMap<Duration, usize>,
    connections: u64,
    disconnections: u64,
    faults: u64,
}

impl Tally {
    /// Counts an event of a drive; `exchanging` becomes true when it exchanges data, and false when that ends.
    pub fn note(&mut self, event: &StationEvent, exchanging: &mut bool) {
        match event {
            StationEvent::Exchanging { .. } => {
                self.connections += 1;
                *exchanging = true;
            }
            StationEvent::Disconnected { .. } => {
                self.disconnections += 1;
                *exchanging = false;
            }
            StationEvent::Fault { .. } => self.faults += 1,
            _ => {}
        }
    }

    /// Notes the time between two input frames of a drive; `None` while it exchanges no data.
    pub fn change(&mut self, before: Option<Duration>, now: Option<Duration>) {
        if before == now {
            return;
        }
        if let Some(before) = before
            && let Some(drives) = self.cycles.get_mut(&before)
        {
            *drives -= 1;
            if *drives == 0 {
                self.cycles.remove(&before);
            }
        }
        if let Some(now) = now {
            *self.cycles.entry(now).or_default() += 1;
        }
    }

    /// Puts what was counted into a load.
    pub fn fill(&self, load: &mut Load) {
        let ends = self.cycles.first_key_value().zip(self.cycles.last_key_value());
        load.cycles = ends.map(|((shortest, _), (longest, _))| (*shortest, *longest));
        load.exchanging = self.cycles.values().sum();
        load.connections = self.connections;
        load.disconnections = self.disconnections;
        load.faults = self.faults;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn load(ran: u64, waited: u64, late: u64) -> Load {
        Load {
            time: SECOND,
            drives: 2_000,
            exchanging: 1_000,
            cycles: Some((Duration::from_millis(16), Duration::from_millis(16))),
            frames: PacketStatistics {
                received: 62_500,
                sent: 62_400,
                ..PacketStatistics::default()
            },
            lateness: Lateness {
                late,
                longest: Duration::from_millis(2),
            },
            processor: Some(ThreadTime {
                ran: Duration::from_millis(ran),
                waited: Duration::from_millis(waited),
            }),
            ..Load::default()
        }
    }

    #[test]
    fn a_load_is_one_line() {
        assert_eq!(
            load(254, 0, 3).to_string(),
            "1000 of 2000 drives exchange data every 16 ms; frames per second 62500 in, 62400 out; late 3; CPU 25 %"
        );
        assert_eq!(Load::default().to_string(), "0 of 0 drives exchange data; late 0");
    }

    #[test]
    fn what_happened_between_two_moments() {
        let mut later = load(500, 100, 8);
        later.time = 3 * SECOND;
        let between = later.since(&load(200, 50, 3));
        assert_eq!(between.time, 2 * SECOND);
        assert_eq!((between.lateness.late, between.frames.sent), (5, 0));
        assert_eq!(between.used(), Some(0.15));
        assert_eq!(between.exchanging, 1_000);
    }

    #[test]
    fn too_many_drives_are_reported_with_the_number_that_fits() {
        assert_eq!(load(300, 10, 40).overload(), None, "late for another reason");
        assert_eq!(load(990, 10, 0).overload(), None, "busy and never late");
        assert_eq!(load(1_000, 0, 40).overload().unwrap().fit, 900);
        let shared = load(600, 400, 40).overload().unwrap();
        assert_eq!(
            shared.to_string(),
            "the processor is too slow for 1000 drives: 40 times late; it worked for them for 60 % of the time and for \
             other programs for 40 %; at these cycles about 540 drives fit"
        );
    }

    #[test]
    fn drives_are_counted_by_their_cycle() {
        let (fast, slow) = (Duration::from_millis(1), Duration::from_millis(16));
        let mut tally = Tally::default();
        let mut load = Load::default();
        for (before, now) in [(None, Some(fast)), (None, Some(slow)), (None, Some(slow))] {
            tally.change(before, now);
        }
        tally.fill(&mut load);
        assert_eq!((load.exchanging, load.cycles), (3, Some((fast, slow))));
        tally.change(Some(fast), None);
        tally.change(Some(slow), Some(slow));
        tally.fill(&mut load);
        assert_eq!((load.exchanging, load.cycles), (2, Some((slow, slow))));
    }
}
