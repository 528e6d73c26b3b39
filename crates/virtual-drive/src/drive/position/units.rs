//! Lengths: the unit that the user chose, and axes that turn round and round.

use profile::unit::UnitChoice;

/// 2^-32 revolutions of one revolution: positions inside the drive count in these.
pub(in crate::drive) const REVOLUTION: f64 = 4_294_967_296.0;

/// How many units of the user one revolution has.
/// Source: [`UnitChoice`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drive) struct Units {
    per_revolution: f64,
}

impl Units {
    pub fn new(choice: &UnitChoice) -> Self {
        Self {
            per_revolution: choice.unit().per_revolution,
        }
    }

    /// Returns a value of the user in 2^-32 revolutions; what is too far away is the farthest.
    pub fn counts(self, value: f64) -> i64 {
        (value / self.per_revolution * REVOLUTION).round() as i64
    }

    /// 2^-32 revolutions in the unit of the user.
    pub fn value(self, counts: i64) -> f64 {
        counts as f64 / REVOLUTION * self.per_revolution
    }

    /// Returns the user units in one revolution.
    pub const fn per_revolution(self) -> f64 {
        self.per_revolution
    }
}

/// Which way an absolute target of a modulo axis is gone to. Source: AKD PL.MODPDIR as the vendor's page on modulo
/// positions has it; that its values are in this order is ours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drive) enum Direction {
    /// Stays inside the range, never over its end.
    Inside,
    /// Always in positive direction.
    Positive,
    /// Always in negative direction.
    Negative,
    /// The shorter way.
    Shortest,
}

impl Direction {
    pub const fn of(number: i64) -> Self {
        match number {
            1 => Self::Positive,
            2 => Self::Negative,
            3 => Self::Shortest,
            _ => Self::Inside,
        }
    }
}

/// The range of a modulo axis: it begins again at its end.
/// Source: AKD PL.MODPEN, PL.MODP1, PL.MODP2, PL.MODPDIR.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drive) struct Modulo {
    low: i64,
    length: i64,
    direction: Direction,
}

impl Modulo {
    /// Returns the range between two ends, in whichever order; none when it is empty.
    pub fn new(one: i64, other: i64, direction: Direction) -> Option<Self> {
        let (low, high) = (one.min(other), one.max(other));
        let length = high.checked_sub(low).filter(|length| *length > 0)?;
        Some(Self {
            low,
            length,
            direction,
        })
    }

    /// Returns the place in the range.
    pub const fn wrap(&self, position: i64) -> i64 {
        self.low
            .wrapping_add(position.wrapping_sub(self.low).rem_euclid(self.length))
    }

    /// Returns true for a target inside the range.
    pub const fn contains(&self, target: i64) -> bool {
        target >= self.low && target.wrapping_sub(self.low) < self.length
    }

    /// Returns the place of an absolute target for an axis that has turned to `position`.
    pub const fn target(&self, position: i64, target: i64) -> i64 {
        let way = target.wrapping_sub(self.wrap(position));
        let way = match self.direction {
            Direction::Positive if way < 0 => way + self.length,
            Direction::Negative if way > 0 => way - self.length,
            Direction::Shortest if way > self.length / 2 => way - self.length,
            Direction::Shortest if way < -(self.length / 2) => way + self.length,
            _ => way,
        };
        position.wrapping_add(way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_in_the_unit_of_the_user() {
        let degrees = Units::new(&UnitChoice {
            rotary_unit: 2,
            ..UnitChoice::DELIVERED
        });
        assert_eq!(degrees.counts(-90.0), -(1 << 30));
        assert_eq!(degrees.value(1 << 32), 360.0);
        assert_eq!(degrees.counts(1e300), i64::MAX);
        assert_eq!(degrees.counts(f64::NAN), 0);
    }

    #[test]
    fn a_round_table() {
        let table = |direction| Modulo::new(360, 0, direction).unwrap();
        let inside = table(Direction::Inside);
        assert_eq!(
            [0, 359, 360, -1, 725].map(|position| inside.wrap(position)),
            [0, 359, 0, 359, 5]
        );
        assert!(inside.contains(0) && inside.contains(359) && !inside.contains(360) && !inside.contains(-1));
        // Two turns and 350 degrees, to 10 degrees.
        let to = |direction, target| table(direction).target(1070, target);
        assert_eq!(to(Direction::Inside, 10), 730);
        assert_eq!(to(Direction::Positive, 10), 1090);
        assert_eq!(to(Direction::Negative, 10), 730);
        assert_eq!(to(Direction::Shortest, 10), 1090);
        assert_eq!(to(Direction::Shortest, 340), 1060);
        assert_eq!(to(Direction::Negative, 355), 715);
        for direction in [
            Direction::Inside,
            Direction::Positive,
            Direction::Negative,
            Direction::Shortest,
        ] {
            assert_eq!(to(direction, 350), 1070, "it is there");
        }
        assert_eq!(Modulo::new(5, 5, Direction::Inside), None);
        assert_eq!(Modulo::new(i64::MIN, i64::MAX, Direction::Inside), None);
    }
}
