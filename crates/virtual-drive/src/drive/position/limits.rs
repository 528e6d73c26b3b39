//! Software limits, and the ways that braking takes.

/// 2^-32 revolutions of one rpm for one second.
pub(in crate::drive) const COUNTS: f64 = 4_294_967_296.0 / 60.0;

/// Way in 2^-32 revolutions until the axis stands, from a speed in rpm with a deceleration in rpm/s.
pub(in crate::drive) fn brake_way(speed: f64, deceleration: f64) -> i64 {
    (0.5 * speed * speed / deceleration.max(f64::MIN_POSITIVE) * COUNTS).ceil() as i64
}

/// Where the axis may be.
/// Source: AKD SWLS.EN, SWLS.LIMIT0, SWLS.LIMIT1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drive) struct Limits {
    low: i64,
    high: i64,
}

impl Limits {
    /// No limits.
    pub const NONE: Self = Self {
        low: i64::MIN,
        high: i64::MAX,
    };

    /// Returns the limits that are switched on. When both are, the lower one is the negative one.
    pub fn new(low: Option<i64>, high: Option<i64>) -> Self {
        let (low, high) = match (low, high) {
            (Some(low), Some(high)) if low > high => (Some(high), Some(low)),
            both => both,
        };
        Self {
            low: low.unwrap_or(i64::MIN),
            high: high.unwrap_or(i64::MAX),
        }
    }

    /// Returns true for a place inside.
    pub const fn contains(&self, place: i64) -> bool {
        place >= self.low && place <= self.high
    }

    /// Returns true when braking from `command` to `rest` leads out, or farther out.
    pub const fn is_left(&self, command: i64, rest: i64) -> bool {
        (rest > self.high && rest > command) || (rest < self.low && rest < command)
    }

    /// Returns the limit in this direction; none where there is none.
    pub const fn towards(&self, way: i64) -> Option<i64> {
        match way {
            1.. if self.high != i64::MAX => Some(self.high),
            ..=-1 if self.low != i64::MIN => Some(self.low),
            _ => None,
        }
    }

    /// Way that is left in this direction; none without a limit there, 0 at and beyond it.
    pub const fn room(&self, place: i64, way: i64) -> Option<i64> {
        match self.towards(way) {
            None => None,
            Some(limit) => {
                let room = limit.saturating_sub(place).saturating_mul(way.signum());
                Some(if room > 0 { room } else { 0 })
            }
        }
    }

    /// SWLS.STATE: bit 0 at or below the negative limit, bit 1 at or above the positive one.
    pub const fn state(&self, place: i64) -> i64 {
        let low = self.low != i64::MIN && place <= self.low;
        let high = self.high != i64::MAX && place >= self.high;
        low as i64 | (high as i64) << 1
    }

    /// Returns the deceleration, in rpm/s, that brakes in front of the limit from this speed, in rpm; none when there
    /// is no limit in that direction.
    pub fn needed(&self, place: i64, speed: f64) -> Option<f64> {
        let room = self.room(place, if speed > 0.0 { 1 } else { -1 })? as f64 / COUNTS;
        Some(0.5 * speed * speed / room.max(f64::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURN: i64 = 1 << 32;

    #[test]
    fn ways_of_braking() {
        // 600 rpm at 3000 rpm/s: 0.2 s at 300 rpm on average, one revolution.
        assert_eq!(brake_way(600.0, 3000.0), TURN);
        assert_eq!(brake_way(-600.0, 3000.0), TURN);
        assert_eq!(brake_way(1.0, 0.0), i64::MAX);
        let limits = Limits::new(Some(-TURN), Some(TURN));
        assert_eq!(limits.needed(0, 600.0), Some(3000.0));
        assert_eq!(limits.needed(0, -600.0), Some(3000.0));
        assert_eq!(Limits::new(None, Some(TURN)).needed(0, -600.0), None);
    }

    #[test]
    fn inside_at_and_beyond_the_limits() {
        let limits = Limits::new(Some(100), Some(-100)); // in whichever order
        assert!(limits.contains(100) && limits.contains(-100) && !limits.contains(101));
        assert_eq!(
            [-101, -100, 0, 100, 101].map(|place| limits.state(place)),
            [1, 1, 0, 2, 2]
        );
        assert_eq!(limits.room(40, 1), Some(60));
        assert_eq!(limits.room(40, -1), Some(140));
        assert_eq!(limits.room(101, 1), Some(0));
        assert_eq!((limits.room(0, 0), Limits::NONE.room(0, 1)), (None, None));
        assert!(!limits.is_left(0, 100) && limits.is_left(0, 101) && limits.is_left(0, -101));
        // Outside: only farther out is bad.
        assert!(!limits.is_left(150, 150) && !limits.is_left(150, 120) && limits.is_left(150, 151));
        assert_eq!(Limits::NONE.state(i64::MAX), 0);
        assert!(Limits::NONE.contains(i64::MIN));
    }
}
