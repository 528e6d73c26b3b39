//! A position or distance as written by a person: in turns of the shaft or in increments.

use alloc::string::{String, ToString};
use core::fmt;

use super::Quantity;
use super::units::{Dimension, unit_named, units_of};

/// A position or distance of a rotary axis.
///
/// ```
/// use profidrive_profile::notation::{Position, Quantity};
/// let position = |text: &str| text.parse::<Quantity>().unwrap().position().unwrap();
/// assert_eq!(position("10rev"), Position::Turns(10.0));
/// assert_eq!(position("-90deg"), Position::Turns(-0.25));
/// assert_eq!(position("655360"), Position::Counts(655_360.0));
/// assert_eq!(position("655360").turns(65_536.0), 10.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Position {
    /// Turns of the shaft.
    Turns(f64),
    /// Increments as they travel.
    Counts(f64),
}

impl Position {
    /// In turns, with this many increments in one.
    #[must_use]
    pub fn turns(self, counts_per_turn: f64) -> f64 {
        match self {
            Self::Turns(turns) => turns,
            Self::Counts(counts) => counts / counts_per_turn,
        }
    }

    /// In increments, with this many in one turn.
    #[must_use]
    pub fn counts(self, counts_per_turn: f64) -> f64 {
        match self {
            Self::Turns(turns) => turns * counts_per_turn,
            Self::Counts(counts) => counts,
        }
    }
}

/// The unit written is none of a position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NoPosition {
    /// The unit as written.
    pub given: String,
    /// What it measures, if it is a unit at all.
    pub given_dimension: Option<Dimension>,
}

impl fmt::Display for NoPosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.given_dimension {
            Some(dimension) => write!(f, "`{}` is a unit of {dimension}", self.given)?,
            None => write!(f, "`{}` is not a known unit", self.given)?,
        }
        f.write_str("; a position is in ")?;
        for unit in units_of(Dimension::Turns) {
            write!(f, "{}, ", unit.symbol)?;
        }
        f.write_str("or in counts (also without unit)")
    }
}

impl core::error::Error for NoPosition {}

impl Quantity {
    /// As a position: turns of the shaft (`10rev`, `90deg`, `3.1rad`) or increments (`655360`, `655360counts`).
    ///
    /// # Errors
    /// When the unit written measures something else.
    pub fn position(&self) -> Result<Position, NoPosition> {
        let dimension = self
            .unit
            .as_deref()
            .and_then(unit_named)
            .map(|unit| unit.dimension);
        let position = match dimension {
            Some(Dimension::Turns) => self.in_unit("rev").ok().map(Position::Turns),
            Some(Dimension::Counts) => self.in_unit("counts").ok().map(Position::Counts),
            _ if self.unit.is_none() => Some(Position::Counts(self.number.as_f64())),
            _ => None,
        };
        position.ok_or_else(|| NoPosition {
            given: self.unit.as_deref().unwrap_or_default().to_string(),
            given_dimension: dimension,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position(text: &str) -> Result<Position, NoPosition> {
        text.parse::<Quantity>().unwrap().position()
    }

    #[test]
    fn turns_and_increments() {
        for (text, turns) in [
            ("10rev", 10.0),
            ("1.5 turns", 1.5),
            ("-720°", -2.0),
            ("655360", 10.0),
            ("655360 counts", 10.0),
            ("-1inc", -1.0 / 65_536.0),
            ("0x10000", 1.0),
        ] {
            let found = position(text).unwrap();
            assert!((found.turns(65_536.0) - turns).abs() < 1e-12, "{text}: {found:?}");
            assert!((found.counts(65_536.0) - turns * 65_536.0).abs() < 1e-6, "{text}");
        }
    }

    #[test]
    fn other_units_are_refused_with_what_is_accepted() {
        let text = position("5rpm").unwrap_err().to_string();
        assert_eq!(
            text,
            "`rpm` is a unit of speed; a position is in rev, deg, rad, or in counts (also without unit)"
        );
        let text = position("5mm").unwrap_err().to_string();
        assert!(text.starts_with("`mm` is a unit of length"), "{text}");
        assert!(
            position("5furlong")
                .unwrap_err()
                .to_string()
                .contains("is not a known unit")
        );
    }
}
