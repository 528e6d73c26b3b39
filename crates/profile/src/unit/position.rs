//! User unit of positions on an AKD.

/// 2^32 increments are one revolution.
const FINE: f64 = 4_294_967_296.0;
/// 2^16 increments are one revolution.
const COARSE: f64 = 65_536.0;

/// The parameters that choose the unit of positions.
/// Source: AKD UNIT.PROTARY, UNIT.PLINEAR, UNIT.PIN, UNIT.POUT, MOTOR.TYPE, MOTOR.PITCH; AKD PROFINET manual 6.2 says
/// which parameters follow them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnitChoice {
    /// MOTOR.TYPE 1.
    pub linear: bool,
    /// UNIT.PROTARY.
    pub rotary_unit: i64,
    /// UNIT.PLINEAR.
    pub linear_unit: i64,
    /// UNIT.PIN and UNIT.POUT.
    pub custom: (i64, i64),
    /// MOTOR.PITCH, um; what a linear motor moves in one electrical revolution.
    pub pitch: i64,
}

/// A unit of positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionUnit {
    /// As printed, and as a person may write it.
    pub symbol: &'static str,
    /// How many of it one revolution has.
    pub per_revolution: f64,
    /// The shaft turns: revolutions and angles mean something.
    pub turns: bool,
}

impl UnitChoice {
    /// As delivered: 2^16 counts are one revolution.
    pub const DELIVERED: Self = Self {
        linear: false,
        rotary_unit: 4,
        linear_unit: 0,
        custom: (100, 100),
        pitch: 1000,
    };

    /// Returns the unit that they choose; that the custom unit is UNIT.PIN / UNIT.POUT for each revolution is the
    /// reading of the names.
    ///
    /// ```
    /// use profidrive_profile::unit::UnitChoice;
    /// let degrees = UnitChoice { rotary_unit: 2, ..UnitChoice::DELIVERED };
    /// assert_eq!((degrees.unit().symbol, degrees.unit().per_revolution), ("deg", 360.0));
    /// ```
    #[must_use]
    pub fn unit(&self) -> PositionUnit {
        let (numerator, denominator) = self.custom;
        let custom = numerator.max(1) as f64 / denominator.max(1) as f64;
        let pitch = self.pitch.max(1) as f64;
        let number = if self.linear {
            self.linear_unit
        } else {
            self.rotary_unit
        };
        let (symbol, per_revolution) = match (self.linear, number) {
            (_, 0) => ("counts32", FINE),
            (false, 1) => ("rad", core::f64::consts::TAU),
            (false, 2) => ("deg", 360.0),
            (true, 1) => ("mm", pitch / 1000.0),
            (true, 2) => ("um", pitch),
            (_, 3) => ("LU", custom),
            _ => ("counts", COARSE),
        };
        PositionUnit {
            symbol,
            per_revolution,
            turns: !self.linear,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::notation::unit_named;

    #[test]
    fn one_revolution_in_each_unit() {
        let of = |linear: bool, number: i64| {
            UnitChoice {
                linear,
                rotary_unit: number,
                linear_unit: number,
                custom: (720, 2),
                pitch: 32_000,
            }
            .unit()
        };
        let rotary = [0, 2, 3, 4, 9].map(|number| of(false, number).per_revolution);
        assert_eq!(rotary, [FINE, 360.0, 360.0, COARSE, COARSE]);
        assert!((of(false, 1).per_revolution - core::f64::consts::TAU).abs() < 1e-12);
        let linear = [0, 1, 2, 3, 4].map(|number| of(true, number).per_revolution);
        assert_eq!(linear, [FINE, 32.0, 32_000.0, 360.0, COARSE]);
        for unit in (0..5).flat_map(|number| [of(false, number), of(true, number)]) {
            assert!(unit_named(unit.symbol).is_some(), "{unit:?} can be written");
        }
        assert_eq!(UnitChoice::DELIVERED.unit().symbol, "counts");
    }
}
