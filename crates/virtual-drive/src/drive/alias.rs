//! Parameters that are other names of a value: the same thing under a number of the profile (PNU 1008 and
//! PN.ACCSCALING), and setpoint signals that set a parameter (DRV_ACC and DRV.ACC).

use profile::catalogue::{Parameter, Scale};
use profile::parameter::ErrorNumber;

use super::Drive;
use crate::model::Live;

impl Drive {
    /// Returns the value of the parameter: the one of its alias.
    pub(super) fn same(&self, parameter: &Parameter, other: u16) -> i64 {
        match self.model.numbered(other) {
            Some(target) => self.converted(target, parameter, self.values.get(other)),
            None => 0,
        }
    }

    /// Returns the signal as it came, as long as the parameter it sets has taken it over; else the value of that one.
    pub(super) fn through(&self, signal: &Parameter, other: u16) -> i64 {
        let came = self.process.signal(signal.pnu);
        if self.differs(signal, other, came) {
            self.same(signal, other)
        } else {
            came
        }
    }

    /// Returns true when this signal is not the value that the other parameter has.
    pub(super) fn differs(&self, signal: &Parameter, other: u16, raw: i64) -> bool {
        self.model
            .numbered(other)
            .is_some_and(|target| self.converted(signal, target, raw) != self.values.get(other))
    }

    /// Writes the other parameter.
    ///
    /// # Errors
    /// Outside the limits of that one.
    pub(super) fn write_same(
        &mut self,
        parameter: &Parameter,
        other: u16,
        raw: i64,
    ) -> Result<(), ErrorNumber> {
        let target = self.model.numbered(other);
        let target = target.ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
        let (low, high) = self.limits_through(parameter, target);
        if !(low..=high).contains(&raw) {
            return Err(ErrorNumber::LIMIT);
        }
        self.values.set(other, self.converted(parameter, target, raw));
        Ok(())
    }

    /// Lowest and highest number that a write accepts.
    pub(super) fn limits(&self, position: usize, parameter: &Parameter) -> (i64, i64) {
        let target = match self.live.get(position) {
            Some(Live::Same(other) | Live::Through(other)) => self.model.numbered(*other),
            _ => None,
        };
        match target {
            Some(target) => self.limits_through(parameter, target),
            None => self.own_limits(parameter),
        }
    }

    /// Returns the limits of the parameter itself. A position is kept as thousandths in 64 bits, so that PN.POSSCALE
    /// limits its number.
    pub(super) fn own_limits(&self, parameter: &Parameter) -> (i64, i64) {
        let scaling = &self.settings.scaling;
        let (low, high) = parameter.raw_limits(scaling);
        if parameter.scale != Scale::Position {
            return (low, high);
        }
        let most = i64::MAX / i64::from(scaling.position.max(1));
        (low.max(-most), high.min(most))
    }

    /// Returns the limits of another parameter in the steps of this one. Without a limit it is the size of the other
    /// one that ends it.
    fn limits_through(&self, parameter: &Parameter, target: &Parameter) -> (i64, i64) {
        let scaling = &self.settings.scaling;
        let limit = |known: Option<f64>, end: i64, upwards: bool| {
            let value = known.unwrap_or_else(|| target.engineering(end, scaling));
            parameter.raw_limit(
                value * self.between(target.scale, parameter.scale),
                upwards,
                scaling,
            )
        };
        let there = target.range();
        let (minimum, maximum) = target.limits_in(scaling);
        (
            limit(minimum, *there.start(), true),
            limit(maximum, *there.end(), false),
        )
    }

    /// Factor between engineering values: positions are revolutions in signals and the user's units in parameters.
    fn between(&self, from: Scale, to: Scale) -> f64 {
        let units = self.settings.position.units.per_revolution();
        match (from, to) {
            (Scale::Singleturn, Scale::Position) => units,
            (Scale::Position, Scale::Singleturn) => 1.0 / units,
            _ => 1.0,
        }
    }

    /// Returns the number of one parameter as the number of another with the same meaning. The one that is a position is
    /// the one that is kept.
    fn converted(&self, from: &Parameter, to: &Parameter, raw: i64) -> i64 {
        if from.scale == to.scale {
            return raw;
        }
        let scaling = &self.settings.scaling.kept();
        to.raw(
            from.engineering(raw, scaling) * self.between(from.scale, to.scale),
            scaling,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::AKD;

    /// UNIT.PROTARY.
    const UNIT_ROTARY: u16 = 2393;

    #[test]
    fn limits_of_the_other_one_in_ones_own_steps() {
        let mut drive = Drive::new(&AKD);
        let limits = |drive: &Drive, pnu: u16| {
            let position = AKD.catalogue.position(pnu).unwrap();
            drive.limits(position, &AKD.catalogue.parameters[position])
        };
        assert_eq!(limits(&drive, 1001), (0, 15));
        assert_eq!(limits(&drive, 103), (0, 15));
        assert_eq!(limits(&drive, 1009), (1, 2000));
        // Software limits: 2^37 revolutions, which is fewer degrees than counts.
        let place = AKD.catalogue.by_name("SWLS.LIMIT1").unwrap().pnu;
        assert_eq!(limits(&drive, place), (-(1 << 53), (1 << 53) - 1));
        drive
            .set_element(AKD.catalogue.position(UNIT_ROTARY).unwrap(), 0, 2)
            .unwrap();
        assert_eq!(limits(&drive, place).0, -(360 << 37));
        drive
            .set_element(AKD.catalogue.position(UNIT_ROTARY).unwrap(), 0, 4)
            .unwrap();
        // DRV.ACC is 1.86 to 50,000,000 rpm/s: 65,530 steps of 763 are below, 65,531 above.
        assert_eq!(limits(&drive, 108), (1, 65_530));
        drive.values.set(3065, 1);
        drive.apply();
        assert_eq!(limits(&drive, 108), (2, 65_535));
        drive.values.set(3065, 10_000);
        drive.apply();
        assert_eq!(
            limits(&drive, 109),
            (1, 5000),
            "a limit that is a step belongs to them"
        );
        // HOME.DIST has two numbers: whatever the signal holds fits.
        drive.values.set(1002, 0);
        drive.apply();
        assert_eq!(limits(&drive, 100), (i64::from(i32::MIN), i64::from(i32::MAX)));
        drive.values.set(1002, 16);
        drive.apply();
        assert_eq!(limits(&drive, 100), (i64::from(i32::MIN), i64::from(i32::MAX)));
    }
}
