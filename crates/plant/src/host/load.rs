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
/// Fewer frames do not show what one of them costs.
const FEW_FRAMES: u64 = 100;
/// Keeps a whole number of drives whole.
const ROUNDING: f64 = 1e-6;

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
    /// Cycles that those have in a second, all together.
    pub cycle_rate: f64,
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

    /// Returns true where work was late or frames were lost.
    fn is_troubled(&self) -> bool {
        self.lateness.late > 0 || self.frames.missed > 0
    }

    /// Returns the processor time of one frame; `None` where there were too few of them.
    fn cost(&self) -> Option<f64> {
        let frames = self.frames.received.saturating_add(self.frames.sent);
        let ran = self.processor?.ran.as_secs_f64();
        (frames >= FEW_FRAMES && ran > 0.0).then(|| ran / frames as f64)
    }
}

/// Returns a share of the time of one thread. The kernel counts processor time in steps, so a busy thread may seem to have
/// more than all of it.
fn share(part: Duration, whole: Duration) -> Option<f64> {
    (!whole.is_zero()).then(|| (part.as_secs_f64() / whole.as_secs_f64()).min(1.0))
}

/// Finds out whether the processor has time for the drives, from one window of time to the next.
#[derive(Debug, Default)]
pub(super) struct Judge {
    /// Frames and processor time of one frame, from the busiest window in which nothing was late.
    quiet: Option<(u64, f64)>,
    /// Drives that exchanged data and their cycles in a second: most of them since nothing was late. While there is too much
    /// to do, connections end, but their controllers go on trying.
    wanted: (usize, f64),
}

impl Judge {
    /// Takes what happened in a window; returns what is to be known where the drives came too late because their thread had
    /// too much to do.
    pub fn take(&mut self, passed: &Load) -> Option<Overload> {
        let troubled = passed.is_troubled();
        if !troubled || passed.cycle_rate > self.wanted.1 {
            self.wanted = (passed.exchanging, passed.cycle_rate);
        }
        if !troubled {
            self.learn(passed);
            return None;
        }
        let busy = passed.processor?;
        let used = share(busy.ran, passed.time)?;
        let waited = share(busy.waited, passed.time)?;
        if used + waited < FULL {
            return None;
        }
        let (drives, rate) = self.wanted;
        // what waits for a processor has work to do too
        let room = FULL * used / (used + waited);
        let cost = self.quiet.map(|(_, cost)| cost).or_else(|| passed.cost());
        let fit = cost.filter(|_| drives > 0).map(|cost| {
            // each cycle is a frame in and a frame out
            let of_drive = cost * 2.0 * rate / drives as f64;
            // with the thread full, no more fit than their part of what it should have had
            ((room / of_drive).min(drives as f64 * room) + ROUNDING) as usize
        });
        Some(Overload {
            used,
            waited,
            late: passed.lateness.late,
            lost: passed.frames.missed,
            drives: if drives > 0 { drives } else { passed.drives },
            exchanging: passed.exchanging,
            fit,
        })
    }

    /// Takes the processor time of a frame from a window of cyclic data alone: beginning a connection costs more.
    fn learn(&mut self, passed: &Load) {
        let cyclic = passed.exchanging > 0 && passed.connections == 0 && passed.disconnections == 0;
        let Some(cost) = passed.cost().filter(|_| cyclic) else {
            return;
        };
        let frames = passed.frames.received.saturating_add(passed.frames.sent);
        // with more to do at once, a frame costs less
        if self.quiet.is_none_or(|(most, _)| frames >= most) {
            self.quiet = Some((frames, cost));
        }
    }
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
    /// Received frames that were lost.
    pub lost: u64,
    /// Drives that are too many: those that exchanged data before the processor was too slow, else all.
    pub drives: usize,
    /// Drives that still exchange data.
    pub exchanging: usize,
    /// Drives that would fit, at the same cycles and beside the same programs; `None` where that is not known.
    pub fit: Option<usize>,
}

impl fmt::Display for Overload {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the processor is too slow for {}: ", count(self.drives))?;
        match self.late {
            0 => {}
            1 => f.write_str("late once, ")?,
            late => write!(f, "late {late} times, ")?,
        }
        match self.lost {
            0 => {}
            1 => f.write_str("1 frame lost, ")?,
            lost => write!(f, "{lost} frames lost, ")?,
        }
        let verb = if self.exchanging == 1 {
            "exchanges"
        } else {
            "exchange"
        };
        write!(f, "{} still {verb} data; ", self.exchanging)?;
        write!(f, "the drives used {:.0} % of a processor", self.used * 100.0)?;
        if self.waited > 0.05 {
            write!(
                f,
                " and waited for other programs for {:.0} % of the time",
                self.waited * 100.0
            )?;
        }
        match self.fit {
            None => Ok(()),
            Some(0) => f.write_str("; at these cycles not even one drive fits"),
            Some(1) => f.write_str("; at these cycles about 1 drive fits"),
            Some(fit) => write!(f, "; at these cycles about {fit} drives fit"),
        }
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
        let rates = self.cycles.iter().filter(|(cycle, _)| !cycle.is_zero());
        load.cycle_rate = rates
            .map(|(cycle, drives)| *drives as f64 / cycle.as_secs_f64())
            .sum();
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
            cycle_rate: 62_500.0,
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

    /// A window in which so many frames of each direction came, one of them costs `cost` microseconds.
    fn window(frames: u64, cost: u64, late: u64) -> Load {
        Load {
            frames: PacketStatistics {
                received: frames,
                sent: frames,
                ..PacketStatistics::default()
            },
            ..load(2 * frames * cost / 1000, 0, late)
        }
    }

    #[test]
    fn too_many_drives_are_reported_with_the_number_that_fits() {
        let judged = |load: Load| Judge::default().take(&load);
        assert_eq!(judged(load(300, 10, 40)), None, "late for another reason");
        assert_eq!(judged(load(990, 10, 0)), None, "busy and never late");
        // twice too many from the start on: half of the frames are served
        let twice = judged(window(31_250, 16, 40)).unwrap();
        assert_eq!((twice.drives, twice.fit), (1_000, Some(450)));
        let shared = judged(load(600, 400, 40)).unwrap();
        assert_eq!(
            shared.to_string(),
            "the processor is too slow for 1000 drives: late 40 times, 1000 still exchange data; the drives used 60 % of a \
             processor and waited for other programs for 40 % of the time; at these cycles about 540 drives fit"
        );
    }

    #[test]
    fn what_fits_follows_from_the_cost_of_quiet_times_and_not_from_the_drives_that_are_left() {
        let mut judge = Judge::default();
        // 500 drives, then 1000 of them: 12 us for each frame do not fit into a second
        let half = Load {
            exchanging: 500,
            cycle_rate: 31_250.0,
            ..window(31_250, 12, 0)
        };
        assert_eq!(judge.take(&half), None);
        let all = judge.take(&Load {
            connections: 500,
            ..window(40_000, 13, 900)
        });
        assert_eq!(all.unwrap().fit, Some(600));
        // all connections but eight have ended
        let left = Load {
            exchanging: 8,
            cycle_rate: 500.0,
            ..window(20_000, 25, 900)
        };
        let left = judge.take(&left).unwrap();
        assert_eq!((left.drives, left.exchanging, left.fit), (1_000, 8, Some(600)));
        // nothing is late any more: what was wanted then is over
        let few = Load {
            exchanging: 8,
            cycle_rate: 500.0,
            ..window(500, 12, 0)
        };
        assert_eq!(judge.take(&few), None);
        let other = judge.take(&Load {
            processor: Some(ThreadTime {
                ran: SECOND / 10,
                waited: SECOND,
            }),
            lateness: Lateness {
                late: 1,
                longest: SECOND,
            },
            ..few
        });
        let other = other.unwrap();
        assert_eq!(other.drives, 8);
        assert!(
            other.to_string().contains("8 drives: late once, 8 still"),
            "{other}"
        );
    }

    #[test]
    fn frames_that_are_lost_without_a_connection_are_an_overload() {
        let mut starved = window(100, 40, 0);
        (starved.exchanging, starved.cycle_rate) = (0, 0.0);
        starved.frames.missed = 14_166;
        starved.processor = Some(ThreadTime {
            ran: SECOND / 20,
            waited: SECOND,
        });
        let never = Judge::default().take(&starved).unwrap();
        assert_eq!((never.drives, never.fit), (2_000, None));
        assert_eq!(
            never.to_string(),
            "the processor is too slow for 2000 drives: 14166 frames lost, 0 still exchange data; the drives used 5 % of a \
             processor and waited for other programs for 100 % of the time"
        );
        let mut judge = Judge::default();
        assert_eq!(judge.take(&window(62_500, 4, 0)), None);
        let starved = judge.take(&starved).unwrap();
        assert_eq!((starved.drives, starved.exchanging), (1_000, 0));
        assert!(starved.fit.is_some_and(|fit| fit < 50), "{starved}");
    }

    #[test]
    fn no_thread_has_more_than_its_time() {
        assert_eq!(load(1_360, 0, 0).used(), Some(1.0));
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
        assert_eq!(load.cycle_rate, 1_125.0);
        tally.change(Some(fast), None);
        tally.change(Some(slow), Some(slow));
        tally.fill(&mut load);
        assert_eq!((load.exchanging, load.cycles), (2, Some((slow, slow))));
    }
}
