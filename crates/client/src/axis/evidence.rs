//! What a drive reports about an axis that does not get where it should, and what that points to.

use std::fmt;

use profile::catalogue::Part;
use profile::notation::fixed;

use crate::Advice;
use crate::names::read_in_models;

/// Share of the current limit from which on the current counts as being at it.
const AT_LIMIT: f64 = 0.9;
/// Following error from which on the axis is behind its setpoint, turns.
const BEHIND: f64 = 0.01;

/// An axis in operation that stays away from its target or its speed; `None` where the drive does not report it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Evidence {
    /// Position command minus position, in turns.
    pub following_error: Option<f64>,
    /// Current of the motor, A.
    pub current: Option<f64>,
    /// The highest current in that direction, A.
    pub current_limit: Option<f64>,
    /// A limit switch is hit.
    pub limit_switch: bool,
    /// A software limit is reached.
    pub software_limit: bool,
}

impl Evidence {
    /// Returns the cause that it points to.
    #[must_use]
    pub fn cause(&self) -> Option<&'static str> {
        let behind = self.following_error.is_some_and(|error| error.abs() > BEHIND);
        let at_limit = self
            .current
            .zip(self.current_limit)
            .is_some_and(|(current, limit)| limit != 0.0 && (current / limit).abs() >= AT_LIMIT);
        if self.limit_switch {
            Some("a limit switch is hit")
        } else if self.software_limit {
            Some("a software limit is reached")
        } else if at_limit {
            Some("the current is at its limit and the axis does not follow: blocked, braked or overloaded")
        } else if behind {
            Some("the axis does not follow: something holds it")
        } else {
            None
        }
    }

    /// Returns the hint.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        let (what, parts, shows) = if self.limit_switch {
            let switches = [Part::PositiveSwitch, Part::NegativeSwitch];
            ("move the other way", switches, "the switches")
        } else if self.software_limit {
            let limits = [Part::SoftwareLimit0, Part::SoftwareLimit1];
            ("move back inside", limits, "the limits")
        } else {
            self.cause()?;
            let limits = [Part::PositiveCurrentLimit, Part::NegativeCurrentLimit];
            ("look at mechanics, brake and load", limits, "the limits")
        };
        let read = read_in_models(&parts);
        Some(format!("{what}; {read} shows {shows}").as_str().into())
    }
}

impl fmt::Display for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        if let Some(error) = self.following_error {
            parts.push(format!("following error {} rev", fixed(error, 3)));
        }
        if let Some(current) = self.current {
            let limit = self
                .current_limit
                .map_or_else(String::new, |limit| format!(" of {limit:.2} A"));
            parts.push(format!("current {current:.2} A{limit}"));
        }
        let text = parts.join(", ");
        match (text.is_empty(), self.cause()) {
            (false, Some(cause)) => write!(f, "{text}: {cause}"),
            (false, None) => f.write_str(&text),
            (true, Some(cause)) => f.write_str(cause),
            (true, None) => f.write_str("the drive does not report the cause"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_what_they_point_to() {
        let blocked = Evidence {
            following_error: Some(3.25),
            current: Some(8.95),
            current_limit: Some(9.0),
            ..Evidence::default()
        };
        assert_eq!(
            blocked.to_string(),
            "following error 3.250 rev, current 8.95 A of 9.00 A: the current is at its limit and the axis does not follow: blocked, braked or overloaded"
        );
        let switch = Evidence {
            limit_switch: true,
            ..blocked
        };
        assert_eq!(switch.cause(), Some("a limit switch is hit"));
        let held = Evidence {
            current: Some(1.0),
            ..blocked
        };
        assert_eq!(held.cause(), Some("the axis does not follow: something holds it"));
        let nothing = Evidence::default();
        assert_eq!((nothing.cause(), nothing.advice()), (None, None));
        assert_eq!(nothing.to_string(), "the drive does not report the cause");
    }
}
