//! Axes whose position is reckoned modulo.

/// The range in which the position of a modulo axis stays, in turns.
/// Source: AKD PL.MODP1, PL.MODP2 (either may be the lower end), PL.MODPDIR.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModuloRange {
    pub(super) low: f64,
    pub(super) high: f64,
    way: i64,
}

impl ModuloRange {
    /// Between two ends, with the number of PL.MODPDIR: 1 positive, 2 negative, 3 the shorter way, else never over the
    /// end of the range. `None` for an empty range.
    #[must_use]
    pub fn new(one: f64, other: f64, way: i64) -> Option<Self> {
        let (low, high) = (one.min(other), one.max(other));
        (high - low > 0.0 && (high - low).is_finite()).then_some(Self { low, high, way })
    }

    /// Returns the place in the range.
    pub(super) fn wrap(self, position: f64) -> f64 {
        self.low + (position - self.low).rem_euclid(self.high - self.low)
    }

    /// Returns the distance from one position to another one inside the range.
    pub(super) fn distance(self, from: f64, target: f64) -> f64 {
        let length = self.high - self.low;
        let way = target - self.wrap(from);
        match self.way {
            1 if way < 0.0 => way + length,
            2 if way > 0.0 => way - length,
            3 if way > length / 2.0 => way - length,
            3 if way < -length / 2.0 => way + length,
            _ => way,
        }
    }
}
