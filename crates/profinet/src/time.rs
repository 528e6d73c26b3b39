//! Time as the engines see it: a number handed in by the caller.

use core::ops::{Add, AddAssign, Sub};
use core::time::Duration;

/// A point in time in nanoseconds since an origin the caller chose.
///
/// The engines never read a clock: every `handle_*` call gets the time. A simulation starts at zero and counts
/// in virtual time; a program on a network passes the time of a monotonic clock.
///
/// ```
/// use core::time::Duration;
/// use profidrive_profinet::Instant;
/// let t = Instant::ZERO + Duration::from_millis(16);
/// assert_eq!(t - Instant::ZERO, Duration::from_millis(16));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Instant(u64);

impl Instant {
    /// The origin.
    pub const ZERO: Self = Self(0);
    /// The last representable instant, 584 years after the origin.
    pub const MAX: Self = Self(u64::MAX);

    /// From nanoseconds since the origin.
    #[must_use]
    pub const fn from_nanos(nanos: u64) -> Self {
        Self(nanos)
    }

    /// From milliseconds since the origin.
    #[must_use]
    pub const fn from_millis(millis: u64) -> Self {
        Self(millis.saturating_mul(1_000_000))
    }

    /// Nanoseconds since the origin.
    #[must_use]
    pub const fn as_nanos(self) -> u64 {
        self.0
    }

    /// Whole milliseconds since the origin.
    #[must_use]
    pub const fn as_millis(self) -> u64 {
        self.0 / 1_000_000
    }

    /// Returns the earliest of these times.
    ///
    /// ```
    /// use profidrive_profinet::Instant;
    /// let [soon, late] = [1, 2].map(|at| Some(Instant::from_millis(at)));
    /// assert_eq!(Instant::earliest([late, None, soon]), soon);
    /// assert_eq!(Instant::earliest([None, None]), None);
    /// ```
    #[must_use]
    pub fn earliest<const N: usize>(times: [Option<Self>; N]) -> Option<Self> {
        // asked several times in a cycle by everything with a deadline: plainer for the compiler than a chain of iterators
        let mut earliest: Option<Self> = None;
        for time in &times {
            if let Some(time) = *time
                && earliest.is_none_or(|earliest| time < earliest)
            {
                earliest = Some(time);
            }
        }
        earliest
    }

    /// Returns the time since `earlier`, zero if `earlier` is later.
    #[must_use]
    pub const fn saturating_since(self, earlier: Self) -> Duration {
        Duration::from_nanos(self.0.saturating_sub(earlier.0))
    }
}

fn nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

impl Add<Duration> for Instant {
    type Output = Self;
    /// Saturates at [`Instant::MAX`].
    fn add(self, rhs: Duration) -> Self {
        Self(self.0.saturating_add(nanos(rhs)))
    }
}

impl AddAssign<Duration> for Instant {
    fn add_assign(&mut self, rhs: Duration) {
        *self = *self + rhs;
    }
}

impl Sub for Instant {
    type Output = Duration;
    /// Saturates at zero.
    fn sub(self, rhs: Self) -> Duration {
        self.saturating_since(rhs)
    }
}
