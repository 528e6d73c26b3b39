//! The unit in which people measure the travel of a load.

use std::fmt;

use profile::notation::{Number, Quantity, figures};

use crate::report;

/// The travel of a load in the unit of its machine: millimetres of a slide, bottles of a filler.
///
/// It counts turns of the motor, whatever units the drive itself is set up for.
///
/// ```
/// use profidrive::machine::UserUnit;
/// use profidrive::report::Quantity;
///
/// // a screw of 10 mm a turn behind a gear of 5:1
/// let unit = UserUnit::new("mm", 10.0, 5.0);
/// let motor = |text: &str| unit.to_motor(&text.parse().unwrap()).map(|quantity| quantity.to_string());
/// assert_eq!(motor("120mm").as_deref(), Some("60 rev"));
/// assert_eq!(motor("50mm/s").as_deref(), Some("1500 rpm"));
/// assert_eq!(motor("600mm/min").as_deref(), Some("300 rpm"));
/// assert_eq!(motor("100mm/s2").as_deref(), Some("3000 rpm/s"));
/// assert_eq!(motor("60rev"), None);
/// let load = unit.of_motor(&Quantity::rpm(1500.0)).unwrap();
/// assert_eq!((load.value, load.unit.as_str()), (50.0, "mm/s"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct UserUnit {
    /// Name of the unit.
    pub name: String,
    /// Travel for one turn of the motor.
    per_turn: f64,
}

impl UserUnit {
    /// Creates a unit: `pitch` of it for a turn of the load, and so many turns of the motor for one of the load.
    #[must_use]
    pub fn new(name: &str, pitch: f64, gear: f64) -> Self {
        Self {
            name: name.to_owned(),
            per_turn: pitch / gear,
        }
    }

    /// Returns a position, speed or acceleration in this unit as one of the motor, in rev, rpm or rpm/s; `None` for a quantity in
    /// another unit.
    #[must_use]
    pub fn to_motor(&self, quantity: &Quantity) -> Option<Quantity> {
        let rest = quantity.unit.as_deref()?.strip_prefix(self.name.as_str())?;
        let (factor, unit) = match rest {
            "" => (1.0, "rev"),
            "/s" => (60.0, "rpm"),
            "/min" => (1.0, "rpm"),
            "/s2" | "/s^2" | "/s²" => (60.0, "rpm/s"),
            _ => return None,
        };
        Some(Quantity {
            number: Number::Decimal(quantity.number.as_f64() * factor / self.per_turn),
            unit: Some(unit.to_owned()),
        })
    }

    /// Returns a position, speed or acceleration of the motor, in rev, rpm or rpm/s, as one of the load; `None` for a quantity in
    /// another unit.
    #[must_use]
    pub fn of_motor(&self, quantity: &report::Quantity) -> Option<report::Quantity> {
        let (divisor, rest) = match quantity.unit.as_str() {
            "rev" => (1.0, ""),
            "rpm" => (60.0, "/s"),
            "rpm/s" => (60.0, "/s2"),
            _ => return None,
        };
        Some(report::Quantity {
            value: quantity.value * self.per_turn / divisor,
            unit: format!("{}{rest}", self.name),
            beyond: quantity.beyond.clone(),
        })
    }
}

impl fmt::Display for UserUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} {} for a turn of the motor",
            figures(self.per_turn),
            self.name
        )
    }
}
