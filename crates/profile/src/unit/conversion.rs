//! Conversion index and physical size: how a drive describes its integers (the variable attribute of a
//! parameter description).
//!
//! Source: Danfoss MCA 101 manual p. 80 and FC 300 Profibus manual p. 18; index 100 is of no public table and taken as 1.

use super::{Linear, Width};

/// What one step of a raw number is in the SI unit of its physical size.
///
/// ```
/// use profidrive_profile::unit::ConversionIndex;
/// assert_eq!(ConversionIndex(-2).engineering(5012), Some(50.12));
/// assert_eq!(ConversionIndex(74).engineering(2), Some(7200.0)); // hours in seconds
/// assert_eq!(ConversionIndex(67).engineering(1500), Some(25.0)); // rpm in revolutions per second
/// assert_eq!(ConversionIndex(50).engineering(1), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct ConversionIndex(pub i8);

impl ConversionIndex {
    /// Steps of one, also for a unit without a step of its own.
    pub const ONE: Self = Self(0);

    /// Returns the factor as a fraction, multiplier first: both are whole, so that nothing is rounded before the
    /// division. None for an index that no table has.
    #[must_use]
    pub const fn fraction(self) -> Option<(u64, u64)> {
        Some(match self.0 {
            67 => (1, 60),
            70 => (60, 1),
            74 => (3_600, 1),
            75 => (3_600_000, 1),
            77 => (86_400, 1),
            100 => (1, 1),
            0..=9 => (10_u64.pow(self.0.unsigned_abs() as u32), 1),
            -9..0 => (1, 10_u64.pow(self.0.unsigned_abs() as u32)),
            _ => return None,
        })
    }

    /// Returns the power of ten, none for a special index.
    #[must_use]
    pub const fn exponent(self) -> Option<i8> {
        match self.0 {
            -9..=9 => Some(self.0),
            _ => None,
        }
    }

    /// Returns the conversion between raw numbers and the SI unit; none for an index that no table has.
    #[must_use]
    pub const fn linear(self, width: Width) -> Option<Linear> {
        match self.fraction() {
            Some((multiplier, divisor)) => Some(Linear {
                multiplier: multiplier as f64,
                divisor: divisor as f64,
                width,
            }),
            None => None,
        }
    }

    /// Returns the value of a raw number in the SI unit; none for an index that no table has.
    #[must_use]
    pub const fn engineering(self, raw: i64) -> Option<f64> {
        match self.linear(Width::I32) {
            Some(linear) => Some(linear.engineering(raw)),
            None => None,
        }
    }
}

/// Variable attribute of a parameter description: physical size and conversion index.
///
/// ```
/// use profidrive_profile::unit::{ConversionIndex, Variable};
/// let motor_power = Variable { size: 9, conversion: ConversionIndex(1) }; // steps of 10 W
/// assert_eq!(motor_power.unit(), ("kW", -2));
/// assert_eq!(Variable::of("kW", -2), Some(motor_power));
/// assert_eq!(Variable { size: 4, conversion: ConversionIndex(74) }.unit(), ("h", 0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Variable {
    /// Physical size, see [`QUANTITIES`]; 0 is none.
    pub size: u8,
    /// What one step is.
    pub conversion: ConversionIndex,
}

/// One physical quantity and its units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PhysicalSize {
    /// Number in the description.
    pub index: u8,
    /// Name.
    pub name: &'static str,
    /// Unit and conversion index that means one of it. The first has the lowest power of ten.
    pub units: &'static [(&'static str, i8)],
}

/// Every physical size, ascending.
/// Source: Danfoss MCA 101 manual p. 80; the kilowatt-hour of index 75 (3.6 million joules) is that of FC 300.
#[rustfmt::skip]
pub static QUANTITIES: &[PhysicalSize] = &[
    PhysicalSize { index: 0, name: "none", units: &[("", 0)] },
    PhysicalSize { index: 4, name: "time", units: &[("ms", -3), ("s", 0), ("min", 70), ("h", 74), ("d", 77)] },
    PhysicalSize { index: 8, name: "energy", units: &[("Wh", 0), ("kWh", 3), ("MWh", 6), ("kWh", 75)] },
    PhysicalSize { index: 9, name: "power", units: &[("mW", -3), ("W", 0), ("kW", 3), ("MW", 6)] },
    PhysicalSize { index: 11, name: "rotation", units: &[("rpm", 67)] },
    PhysicalSize { index: 16, name: "torque", units: &[("Nm", 0), ("kNm", 3)] },
    PhysicalSize { index: 17, name: "temperature", units: &[("degC", 0), ("degC", 100)] },
    PhysicalSize { index: 21, name: "voltage", units: &[("mV", -3), ("V", 0), ("kV", 3)] },
    PhysicalSize { index: 22, name: "current", units: &[("mA", -3), ("A", 0), ("kA", 3)] },
    PhysicalSize { index: 23, name: "resistance", units: &[("mohm", -3), ("ohm", 0), ("kohm", 3)] },
    PhysicalSize { index: 24, name: "ratio", units: &[("%", 0)] },
    PhysicalSize { index: 27, name: "relative change", units: &[("%", 0)] },
    PhysicalSize { index: 28, name: "frequency", units: &[("Hz", 0), ("kHz", 3), ("MHz", 6), ("GHz", 9)] },
];

impl Variable {
    /// Nothing is reported: whole numbers without a unit.
    pub const NONE: Self = Self {
        size: 0,
        conversion: ConversionIndex::ONE,
    };

    /// Returns the physical size; none for a number that no table has.
    #[must_use]
    pub fn quantity(self) -> Option<&'static PhysicalSize> {
        QUANTITIES.iter().find(|quantity| quantity.index == self.size)
    }

    /// Unit and power of ten: the value in that unit is the raw number times 10^power. The unit is the one of its size
    /// that the step is one of, else the next greater one (steps of 10 W are hundredths of a kilowatt). Without a known
    /// size the unit is empty; rotation is reported in rpm also by an index 0, as in older books. An index that no
    /// table has counts as 0.
    #[must_use]
    pub fn unit(self) -> (&'static str, i8) {
        let index = self.conversion.0;
        let units = self.quantity().map_or(&[][..], |quantity| quantity.units);
        if let Some((unit, _)) = units.iter().find(|(_, of)| *of == index) {
            return (unit, 0);
        }
        let Some(exponent) = self.conversion.exponent() else {
            return ("", 0);
        };
        let mut plain = units
            .iter()
            .filter(|(_, of)| ConversionIndex(*of).exponent().is_some());
        match plain.clone().find(|(_, of)| *of > exponent).or(plain.next_back()) {
            Some((unit, of)) => (unit, exponent - of),
            // rotation: its only unit has a special index
            None => (units.first().map_or("", |(unit, _)| unit), exponent),
        }
    }

    /// Returns the attribute for a raw number whose value in `unit` is the number times 10^`exponent`. `None` when no
    /// pair of indices expresses it.
    #[must_use]
    pub fn of(unit: &str, exponent: i8) -> Option<Self> {
        QUANTITIES.iter().find_map(|quantity| {
            quantity.units.iter().find_map(|(known, index)| {
                let index = match ConversionIndex(*index).exponent() {
                    _ if *known != unit => return None,
                    Some(of) => of.checked_add(exponent)?,
                    None if exponent == 0 => *index,
                    None => return None,
                };
                let conversion = ConversionIndex(index);
                conversion.fraction().map(|_| Self {
                    size: quantity.index,
                    conversion,
                })
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn every_index_of_the_table() {
        for (index, raw, value) in [
            (0, 7, 7.0),
            (-1, 7, 0.7),
            (-2, 7, 0.07),
            (-3, 7, 0.007),
            (-4, 7, 0.0007),
            (-5, 7, 0.000_07),
            (-6, 7, 0.000_007),
            (-7, 7, 0.000_000_7),
            (1, 7, 70.0),
            (2, 7, 700.0),
            (3, 7, 7_000.0),
            (6, 7, 7_000_000.0),
            (9, 7, 7e9),
            (67, 3000, 50.0),
            (70, 2, 120.0),
            (74, 2, 7_200.0),
            (75, 2, 7_200_000.0),
            (77, 2, 172_800.0),
            (100, 42, 42.0),
        ] {
            assert_eq!(ConversionIndex(index).engineering(raw), Some(value), "{index}");
        }
        for index in [-128, -10, 10, 66, 68, 73, 76, 99, 127] {
            assert_eq!(ConversionIndex(index).fraction(), None);
            assert_eq!(
                Variable {
                    size: 21,
                    conversion: ConversionIndex(index)
                }
                .unit(),
                ("", 0)
            );
        }
    }

    #[test]
    fn sizes_and_units() {
        let unit = |size, index| {
            Variable {
                size,
                conversion: ConversionIndex(index),
            }
            .unit()
        };
        for (size, index, expected) in [
            (0, 0, ("", 0)),
            (0, -2, ("", -2)),
            (4, 0, ("s", 0)),
            (4, -2, ("s", -2)),
            (4, -3, ("ms", 0)),
            (4, -5, ("ms", -2)),
            (4, 70, ("min", 0)),
            (4, 77, ("d", 0)),
            (8, 75, ("kWh", 0)),
            (8, 3, ("kWh", 0)),
            (9, 1, ("kW", -2)),
            (9, 9, ("MW", 3)),
            (11, 67, ("rpm", 0)),
            (11, 0, ("rpm", 0)),
            (17, 100, ("degC", 0)),
            (21, -1, ("V", -1)),
            (22, -2, ("A", -2)),
            (22, -4, ("mA", -1)),
            (24, -2, ("%", -2)),
            (28, -1, ("Hz", -1)),
            (99, -1, ("", -1)),
        ] {
            assert_eq!(unit(size, index), expected, "{size} {index}");
        }
        assert_eq!(Variable::of("rpm", -1), None);
        assert_eq!(Variable::of("furlong", 0), None);
        assert_eq!(Variable::of("", 0), Some(Variable::NONE));
        assert_eq!(Variable::of("GHz", 1), None);
    }

    proptest! {
        #[test]
        fn units_round_trip_through_variable_attributes(quantity in 0..QUANTITIES.len(), unit: prop::sample::Index, exponent in -9_i8..=9) {
            let quantity = &QUANTITIES[quantity];
            let (unit, _) = quantity.units[unit.index(quantity.units.len())];
            if let Some(variable) = Variable::of(unit, exponent) {
                let (unit, power) = variable.unit();
                // the same quantity, perhaps in another unit of it: the values in SI agree
                let si = |unit: &str, power: i8| Variable::of(unit, power).unwrap();
                prop_assert_eq!(si(unit, power), variable);
            }
        }

        #[test]
        fn raw_numbers_come_back(raw: i32, index in -9_i8..=9) {
            let linear = ConversionIndex(index).linear(Width::I32).unwrap();
            prop_assert_eq!(linear.raw(linear.engineering(raw.into())).checked(), Ok(i64::from(raw)));
        }
    }
}
