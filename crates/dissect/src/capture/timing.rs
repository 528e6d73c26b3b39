//! How regularly cyclic frames come: cycle, jitter, lost frames, gaps. No allocation for a frame.

use std::time::Duration;

use super::connect::TICK_NS;

/// Steps of an octave in the histogram: its values are within 3 % of the measured ones.
const STEPS: usize = 16;
/// Octaves from 1 us up, to more than an hour.
const OCTAVES: usize = 32;
/// A cycle counter that goes back, or is the same: an old frame, or one received twice. IEC 61158-6-10, cycle counter.
const OLD: u16 = 0xF000;

/// How often each deviation from the cycle was measured.
#[derive(Debug, Clone)]
struct Histogram {
    counts: Box<[u32]>,
    total: u64,
}

impl Default for Histogram {
    fn default() -> Self {
        Self {
            counts: vec![0; STEPS * OCTAVES].into_boxed_slice(),
            total: 0,
        }
    }
}

impl Histogram {
    fn add(&mut self, time: Duration) {
        let micros = u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
        let place = place(micros).min(self.counts.len() - 1);
        if let Some(count) = self.counts.get_mut(place) {
            *count = count.saturating_add(1);
            self.total += 1;
        }
    }

    /// Returns the time that this part of the measured ones does not exceed; the middle of its step.
    fn percentile(&self, percent: u64) -> Option<Duration> {
        let wanted = (self.total * percent).div_ceil(100).max(1);
        let mut sum = 0;
        let at = self.counts.iter().position(|count| {
            sum += u64::from(*count);
            sum >= wanted
        })?;
        let (low, high) = (start(at), start(at + 1));
        Some(Duration::from_micros(low + (high - low) / 2))
    }
}

/// Returns the step of a time in microseconds: exact up to 16, then 16 steps for each doubling.
fn place(micros: u64) -> usize {
    let steps = STEPS as u64;
    if micros < steps {
        return usize::try_from(micros).unwrap_or(0);
    }
    let octave = micros.ilog2() - steps.ilog2();
    let step = (micros >> octave) - steps;
    (octave as usize + 1) * STEPS + usize::try_from(step).unwrap_or(0)
}

/// Returns the first time of a step.
fn start(place: usize) -> u64 {
    let (octave, step) = (place / STEPS, (place % STEPS) as u64);
    match octave.checked_sub(1) {
        None => step,
        Some(octave) => (STEPS as u64 + step) << octave.min(40),
    }
}

/// The cyclic frames of one direction of a connection, over all its connects.
#[derive(Debug, Clone, Default)]
pub struct Timing {
    /// Time between two frames as the connect agreed, or as the cycle counter shows.
    pub cycle: Duration,
    /// Frames received.
    pub frames: u64,
    /// Frames missing by the cycle counter.
    pub lost: u64,
    /// Frames with the cycle counter of the one before, or an older one.
    pub repeated: u64,
    /// Longest time between two frames of one connection.
    pub longest_gap: Duration,
    jitter: Histogram,
    /// Time and cycle counter of the last frame.
    last: Option<(Duration, u16)>,
}

/// What one frame adds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Step {
    /// Time since the frame before.
    pub gap: Duration,
    /// Frames missing before it.
    pub lost: u64,
}

impl Timing {
    /// A connection begins: what was before it is not a gap.
    pub fn begin(&mut self, cycle: Duration) {
        self.cycle = cycle;
        self.last = None;
    }

    /// Frames were not seen: neither the time nor the counters between those around them say anything.
    pub const fn skip(&mut self) {
        self.last = None;
    }

    /// Resets the measurements and keeps the connection.
    pub fn reset(&mut self) {
        *self = Self {
            cycle: self.cycle,
            last: self.last,
            ..Self::default()
        };
    }

    /// Counts a frame.
    pub fn add(&mut self, at: Duration, counter: u16) -> Step {
        self.frames += 1;
        let Some((before, old)) = self.last else {
            self.last = Some((at, counter));
            return Step::default();
        };
        let ticks = counter.wrapping_sub(old);
        if ticks == 0 || ticks > OLD {
            self.repeated += 1;
            return Step::default();
        }
        self.last = Some((at, counter));
        let gap = at.saturating_sub(before);
        self.longest_gap = self.longest_gap.max(gap);
        let passed = Duration::from_nanos(u64::from(ticks) * TICK_NS);
        if self.cycle.is_zero() {
            self.cycle = passed;
        }
        let cycles = passed.as_nanos() / self.cycle.as_nanos().max(1);
        let lost = u64::try_from(cycles).unwrap_or(0).saturating_sub(1);
        self.lost += lost;
        self.jitter.add(gap.abs_diff(passed));
        Step { gap, lost }
    }

    /// Returns how often deviations were measured, in steps that double: each with the deviation that it does not reach.
    /// Steps without any are left out.
    pub fn deviations(&self) -> Vec<(Duration, u64)> {
        let octaves = self.jitter.counts.chunks(STEPS).enumerate();
        let steps = octaves.map(|(octave, counts)| {
            let count = counts.iter().map(|count| u64::from(*count)).sum();
            (Duration::from_micros(start((octave + 1) * STEPS)), count)
        });
        steps.filter(|(_, count)| *count > 0).collect()
    }

    /// Deviation from the cycle that this percentage of the frames does not exceed.
    pub fn jitter(&self, percent: u64) -> Option<Duration> {
        self.jitter.percentile(percent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const fn ms(time: u64) -> Duration {
        Duration::from_millis(time)
    }

    #[test]
    fn lost_and_late_frames_are_counted() {
        let mut timing = Timing::default();
        timing.begin(ms(4));
        let frames = [(0, 0), (4, 128), (8, 256), (8, 256), (21, 640), (24, 768)];
        let steps: Vec<_> = frames.map(|(at, counter)| timing.add(ms(at), counter)).to_vec();
        assert_eq!(steps[3], Step::default(), "the same counter again");
        assert_eq!((steps[4].gap, steps[4].lost), (ms(13), 2));
        assert_eq!((timing.frames, timing.lost, timing.repeated), (6, 2, 1));
        assert_eq!(timing.longest_gap, ms(13));
        assert_eq!(timing.jitter(50), Some(Duration::ZERO));
        let most = timing.jitter(99).unwrap();
        assert!(most.abs_diff(ms(1)) < Duration::from_micros(32), "{most:?}");
        let steps = timing.deviations();
        assert_eq!(steps.iter().map(|(_, count)| count).sum::<u64>(), 4);
        assert_eq!(steps[0], (Duration::from_micros(16), 2));
        assert_eq!(steps[1], (Duration::from_micros(1024), 2));
        timing.begin(ms(4));
        assert_eq!(
            timing.add(ms(900), 5),
            Step::default(),
            "a new connection, no gap"
        );
        assert_eq!((timing.lost, timing.longest_gap), (2, ms(13)));
    }

    #[test]
    fn a_cycle_without_a_connect_is_derived_from_the_counter() {
        let mut timing = Timing::default();
        for (at, counter) in [(0, 65_024), (16, 0), (32, 512)] {
            timing.add(ms(at), counter);
        }
        assert_eq!((timing.cycle, timing.lost), (ms(16), 0));
    }

    proptest! {
        #[test]
        fn a_step_holds_what_is_put_into_it(micros in 0..3_600_000_000_u64) {
            let at = place(micros);
            prop_assert!(start(at) <= micros && micros < start(at + 1), "{micros} in {at}");
            prop_assert!(at < STEPS * OCTAVES);
        }

        #[test]
        fn any_frames_are_counted(frames in proptest::collection::vec((0..u64::MAX / 2, any::<u16>()), 0..50)) {
            let mut timing = Timing::default();
            for (at, counter) in &frames {
                timing.add(Duration::from_nanos(*at), *counter);
            }
            prop_assert_eq!(timing.frames, frames.len() as u64);
            let _ = (timing.jitter(50), timing.jitter(99));
        }
    }
}
