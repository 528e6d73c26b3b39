//! The time of day of events on a network, and durations as text.

use std::time::{Duration, SystemTime};

use crate::open::{Caller, Transport};

/// The time of day on a network. A plant in memory has none: its time is virtual.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WallClock {
    is_real: bool,
}

impl WallClock {
    /// For times without a time of day.
    pub const NONE: Self = Self { is_real: false };

    /// Returns the time of day of an event that long ago; `None` in virtual time.
    #[must_use]
    pub fn before(self, ago: Duration) -> Option<SystemTime> {
        self.is_real.then(|| SystemTime::now().checked_sub(ago)).flatten()
    }
}

impl Caller {
    /// Returns the clock with the time of day of events on this network.
    #[must_use]
    pub const fn wall_clock(&self) -> WallClock {
        WallClock {
            is_real: match self.transport() {
                Transport::Packet(_) | Transport::Udp | Transport::Serial => true,
                #[cfg(feature = "simulate")]
                Transport::Plant(_) => false,
            },
        }
    }
}

/// Returns the time of day of an event as people write it.
///
/// ```
/// use std::time::{Duration, SystemTime};
/// let time = SystemTime::UNIX_EPOCH + Duration::from_millis(1_795_525_507_123);
/// assert_eq!(profidrive::date_and_time(time), "2026-11-24 13:05:07.123 UTC");
/// ```
#[cfg(any(feature = "recording", feature = "documents"))]
#[must_use]
pub fn date_and_time(time: SystemTime) -> String {
    let time: chrono::DateTime<chrono::Utc> = time.into();
    time.format("%Y-%m-%d %H:%M:%S%.3f UTC").to_string()
}

/// Returns a time as people write it: `250 ms`, `2.5 s`, `1 min 30 s`, `2 h 5 min`.
///
/// ```
/// use std::time::Duration;
/// use profidrive::lasting;
/// assert_eq!(lasting(Duration::from_micros(15_999)), "16 ms");
/// assert_eq!(lasting(Duration::from_millis(2_499)), "2.5 s");
/// assert_eq!(lasting(Duration::from_millis(89_900)), "1 min 30 s");
/// assert_eq!(lasting(Duration::from_secs(7_500)), "2 h 5 min");
/// ```
#[must_use]
pub fn lasting(time: Duration) -> String {
    let two = |number: u64, unit: &str, rest: u64, smaller: &str| match rest {
        0 => format!("{number} {unit}"),
        rest => format!("{number} {unit} {rest} {smaller}"),
    };
    let seconds = time.as_secs_f64();
    if seconds < 0.9995 {
        return format!("{:.0} ms", seconds * 1000.0);
    }
    if seconds < 59.95 {
        return format!("{} s", (seconds * 10.0).round() / 10.0);
    }
    let whole = (time + Duration::from_millis(500)).as_secs();
    match whole {
        0..3600 => two(whole / 60, "min", whole % 60, "s"),
        _ => two(whole / 3600, "h", whole % 3600 / 60, "min"),
    }
}
