//! Update time and watchdog of the cyclic connection of an axis, and whether this computer keeps to them.

use std::fmt;
use std::time::Duration;

use profinet::controller::Misuse;
use profinet::cyclic::Timing;

use crate::error::Error;

/// Update time and watchdog of a cyclic connection.
///
/// ```
/// use std::time::Duration;
/// use profidrive_client::axis::Cycle;
/// let calm = Cycle::choose(&[], Duration::from_millis(4), None, None)?;
/// assert_eq!((calm.interval(), calm.watchdog), (Duration::from_millis(16), 7));
/// assert_eq!(calm.hold_time(), Duration::from_millis(112));
/// let asked = Cycle::choose(&[], Duration::from_millis(4), Some(Duration::from_millis(4)), Some(3))?;
/// assert_eq!(asked.hold_time(), Duration::from_millis(12));
/// # Ok::<(), profidrive_client::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cycle {
    /// Send clock and reduction ratio.
    pub timing: Timing,
    /// Watchdog and data hold factor: update times without data until either side gives the connection up.
    pub watchdog: u16,
}

impl Cycle {
    /// Shortest update time that is chosen by default: a PC without a real-time system keeps to it under load.
    pub const CALM: Duration = Duration::from_millis(16);
    /// Shortest watchdog time that is chosen by default.
    pub const CALM_HOLD: Duration = Duration::from_millis(100);
    /// Fewest update times of a watchdog that is chosen by default.
    const LEAST_COUNT: u16 = 3;

    /// Returns the update time and watchdog for a drive: those that are requested, else [`CALM`](Self::CALM) and
    /// [`CALM_HOLD`](Self::CALM_HOLD) or the next above them.
    ///
    /// `allowed` are the update times of the device description, empty where none was read; `least` is the shortest
    /// update time of the drive. Where the description allows calm ones only below [`CALM`](Self::CALM), its longest is
    /// chosen.
    ///
    /// # Errors
    /// When the update time requested does not exist or the description does not offer it, which says what is offered, or the
    /// watchdog is outside 1 to 1.92 s.
    pub fn choose(
        allowed: &[Timing],
        least: Duration,
        cycle: Option<Duration>,
        watchdog: Option<u16>,
    ) -> Result<Self, Error> {
        let timing = match cycle {
            Some(cycle) if allowed.is_empty() => Timing::for_interval(cycle),
            Some(cycle) => allowed.iter().copied().find(|timing| timing.interval() == cycle),
            None => calm(allowed, least),
        };
        let timing = timing.ok_or_else(|| Error::UpdateTime {
            asked: cycle.unwrap_or(least),
            offered: offered(allowed),
        })?;
        let watchdog = watchdog.unwrap_or_else(|| {
            let count = Self::CALM_HOLD.as_nanos().div_ceil(timing.interval().as_nanos());
            let count = u16::try_from(count).unwrap_or(u16::MAX);
            count.clamp(Self::LEAST_COUNT, timing.highest_hold_factor())
        });
        timing.check(watchdog, watchdog, 0).map_err(Misuse::Cyclic)?;
        Ok(Self { timing, watchdog })
    }

    /// Returns this cycle with the longest watchdog there is, at most 1.92 s.
    #[must_use]
    pub(crate) fn patient(self) -> Self {
        Self {
            watchdog: self.timing.highest_hold_factor(),
            ..self
        }
    }

    /// Returns the time from frame to frame.
    #[must_use]
    pub const fn interval(&self) -> Duration {
        self.timing.interval()
    }

    /// Returns the data hold time of either side: without a frame for this long the connection is lost.
    #[must_use]
    pub const fn hold_time(&self) -> Duration {
        self.timing.hold_time(self.watchdog)
    }

    /// Returns the problem of this cycle on a computer that wakes up as late as `delay`: `None` if it sends each
    /// frame within its update time and two such delays in a row leave the connection alive.
    #[must_use]
    pub fn judge(self, delay: Duration) -> Option<Strained> {
        let late = delay >= self.interval();
        let near = self.interval() + delay * 2 >= self.hold_time();
        (late || near).then_some(Strained { cycle: self, delay })
    }
}

/// Returns the update times that a drive offers, shortest first.
fn offered(allowed: &[Timing]) -> Vec<Duration> {
    let mut all: Vec<Duration> = allowed.iter().map(Timing::interval).collect();
    if allowed.is_empty() {
        all.extend((0..10).map(|power| Duration::from_millis(1 << power)));
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// Returns the shortest update time that is calm and that the drive can do.
fn calm(allowed: &[Timing], least: Duration) -> Option<Timing> {
    let wanted = Cycle::CALM.max(least);
    if allowed.is_empty() {
        let powers = (0..10).map(|power| Duration::from_millis(1 << power));
        return powers
            .filter(|&cycle| cycle >= wanted)
            .find_map(Timing::for_interval);
    }
    let enough = allowed.iter().filter(|timing| timing.interval() >= wanted);
    enough
        .min_by_key(|timing| timing.ticks())
        .or_else(|| allowed.iter().max_by_key(|timing| timing.ticks()))
        .copied()
}

/// A cycle that this computer does not keep to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Strained {
    /// The cycle of the connection.
    pub cycle: Cycle,
    /// How late this computer woke up at the most.
    pub delay: Duration,
}

impl Strained {
    /// Returns true where this computer keeps to the cycle, and the watchdog alone leaves no room.
    #[must_use]
    pub fn is_watchdog_too_short(&self) -> bool {
        self.delay < self.cycle.interval()
    }

    /// Returns timing that this computer keeps to; none where even the longest cycle leaves no room for its delays.
    ///
    /// ```
    /// use std::time::Duration;
    /// use profidrive_client::axis::{Cycle, Room};
    /// let millis = Duration::from_millis;
    /// let cycle = Cycle::choose(&[], millis(1), Some(millis(16)), Some(7))?;
    /// let strained = cycle.judge(millis(17)).expect("no room for 17 ms");
    /// assert_eq!(strained.room(), Some(Room::Cycle { interval: millis(64), watchdog: 7 }));
    /// # Ok::<(), profidrive_client::Error>(())
    /// ```
    #[must_use]
    pub fn room(&self) -> Option<Room> {
        if self.is_watchdog_too_short() {
            return Some(Room::DefaultWatchdog);
        }
        let needed = Cycle::CALM.max(self.delay * 2);
        let interval = [16, 32, 64, 128]
            .map(Duration::from_millis)
            .into_iter()
            .find(|&cycle| cycle >= needed)?;
        Some(if interval == Cycle::CALM {
            Room::Default
        } else {
            Room::Cycle {
                interval,
                watchdog: 7,
            }
        })
    }
}

/// Timing with more room than one that is [`Strained`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Room {
    /// The same cycle with the watchdog that is chosen without a wish.
    DefaultWatchdog,
    /// Cycle and watchdog that are chosen without a wish.
    Default,
    /// A longer cycle.
    Cycle {
        /// Update time.
        interval: Duration,
        /// Cycles without a frame after which the connection is lost.
        watchdog: u16,
    },
}

impl fmt::Display for Strained {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let millis = |time: Duration| (time.as_secs_f64() * 10_000.0).round() / 10.0;
        let (cycle, delay) = (millis(self.cycle.interval()), millis(self.delay));
        let hold = millis(self.cycle.hold_time());
        if self.is_watchdog_too_short() {
            return write!(
                f,
                "a watchdog of {hold} ms is too short for a cycle of {cycle} ms: after {hold} ms without a frame the \
                 connection is lost, and frames may be {delay} ms late on this PC"
            );
        }
        write!(
            f,
            "this PC holds a cycle of {cycle} ms badly: longest delay {delay} ms; after {hold} ms without a frame the \
             connection is lost"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    fn timing(ratio: u16) -> Timing {
        Timing {
            send_clock_factor: 32,
            reduction_ratio: ratio,
            phase: 1,
        }
    }

    fn chosen(allowed: &[Timing], least: Duration, cycle: Option<Duration>) -> (Duration, Duration) {
        let cycle = Cycle::choose(allowed, least, cycle, None).unwrap();
        (cycle.interval(), cycle.hold_time())
    }

    #[test]
    fn the_default_is_calm_within_the_device_description() {
        assert_eq!(chosen(&[], MS / 4, None), (MS * 16, MS * 112));
        assert_eq!(chosen(&[], MS * 20, None), (MS * 32, MS * 128));
        assert_eq!(chosen(&[], MS * 512, None), (MS * 512, MS * 1536));
        let short = [timing(1), timing(8), timing(4)];
        assert_eq!(chosen(&short, MS, None), (MS * 8, MS * 104));
        let long = [timing(64), timing(32), timing(8)];
        assert_eq!(chosen(&long, MS, None), (MS * 32, MS * 128));
    }

    #[test]
    fn a_requested_cycle_is_used_if_it_exists() {
        assert_eq!(chosen(&[], MS * 4, Some(MS)), (MS, MS * 100));
        assert!(Cycle::choose(&[], MS, Some(MS * 3), None).is_err());
        let refused = Cycle::choose(&[timing(16), timing(8)], MS, Some(MS * 4), None).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "no update time of 4 ms: offered are 8, 16 ms"
        );
        assert!(Cycle::choose(&[], MS, None, Some(0)).is_err());
        let error = Cycle::choose(&[], MS, None, Some(255)).unwrap_err();
        assert!(error.to_string().contains("1 to 120 are possible"), "{error}");
    }

    #[test]
    fn a_cycle_is_strained_by_a_delay_as_long_or_near_the_watchdog() {
        let short = Cycle::choose(&[], MS, Some(MS * 4), Some(3)).unwrap();
        assert_eq!(short.judge(MS * 3), None);
        let strained = short.judge(MS * 9).unwrap();
        assert_eq!(
            strained.to_string(),
            "this PC holds a cycle of 4 ms badly: longest delay 9 ms; after 12 ms without a frame the connection is lost"
        );
        let patient = Cycle::choose(&[], MS, Some(MS * 4), None).unwrap();
        assert!(patient.judge(MS * 4).is_some(), "a frame is missed");
        let hasty = Cycle::choose(&[], MS, None, Some(1)).unwrap();
        let strained = hasty.judge(MS / 10).expect("no frame may be late at all");
        assert_eq!(
            strained.to_string(),
            "a watchdog of 16 ms is too short for a cycle of 16 ms: after 16 ms without a frame the connection is lost, and \
             frames may be 0.1 ms late on this PC"
        );
    }
}
