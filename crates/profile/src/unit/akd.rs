//! Scalings of the Kollmorgen AKD.
//!
//! Source: AKD PROFINET manual ed. M 5.12, 6.1, 6.2 and 6.5; for the acceleration of MDI also Kollmorgen's support article
//! "AKD Profinet PN.ACCSCALING Examples" (2022), where the manual contradicts itself.

use super::{Linear, UnitChoice, Width};

/// How the number on the wire is made from the engineering value.
/// Source: AKD PROFINET manual 5.12 and 6; floats apart from positions 1000:1 as in the AKD EtherCAT and Modbus manuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Scale {
    /// The number itself.
    Raw,
    /// Thousandths.
    Milli,
    /// Thousandths divided by PN.POSSCALE.
    Position,
    /// Speed as NSOLL_A and NIST_A carry it, see [`Scaling::speed`]: steps of PN.VELSCALING times 60 times
    /// 16000 / 2^32 rpm, or N2 of the reference speed.
    Velocity,
    /// Steps of PN.ACCSCALING rpm/s.
    Acceleration,
    /// 2^14 is DRV.IPEAK.
    Current,
    /// 2^n is one revolution, n is PNU 1002.
    Singleturn,
    /// 2^32 is 12000 rpm.
    MdiVelocity,
    /// 2^15 is 12000 rpm, independent of PN.VELSCALING: the jog setpoints (manual 5.12.1 and 6.5).
    NominalVelocity,
    /// The raw number times 10^n in the unit of the parameter; n is not 0, that is [`Raw`](Self::Raw).
    Decimal(i8),
    /// N2 in percent: 2^14 is 100 %.
    Percent,
}

impl Scale {
    /// Returns the raw number times 10^`exponent`.
    #[must_use]
    pub const fn decimal(exponent: i8) -> Self {
        match exponent {
            0 => Self::Raw,
            exponent => Self::Decimal(exponent),
        }
    }

    /// Returns true where no value of the drive takes part in the conversion.
    #[must_use]
    pub const fn is_fixed(self) -> bool {
        matches!(
            self,
            Self::Raw | Self::Milli | Self::Decimal(_) | Self::Percent | Self::NominalVelocity
        )
    }

    /// Returns the power of ten between the raw number and the value in the unit, where it is that.
    #[must_use]
    pub const fn exponent(self) -> Option<i8> {
        match self {
            Self::Raw => Some(0),
            Self::Milli => Some(-3),
            Self::Decimal(exponent) => Some(exponent),
            _ => None,
        }
    }
}

/// The values of the drive that scale other values; the default is a drive as delivered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scaling {
    /// PN.VELSCALING, PNU 3064 and 1009.
    pub velocity: u16,
    /// PN.ACCSCALING, PNU 3065 and 1008.
    pub acceleration: u16,
    /// PN.POSSCALE, PNU 3014.
    pub position: u32,
    /// DRV.IPEAK in ampere, PNU 2132.
    pub peak_current: f64,
    /// Bits of one revolution, PNU 1002.
    pub singleturn_bits: u16,
    /// The unit of positions: UNIT.PROTARY and its like.
    pub unit: UnitChoice,
    /// Speed in rpm that is 100 % (0x4000) of NSOLL_A and NIST_A in a drive that normalises them so: VLT 3-03, the
    /// greatest frequency of a Vacon. None: the AKD's steps of `velocity`.
    pub reference: Option<f64>,
}

impl Default for Scaling {
    fn default() -> Self {
        Self::DELIVERED
    }
}

impl Scaling {
    /// A drive as delivered.
    pub const DELIVERED: Self = Self {
        velocity: 1638,
        acceleration: 763,
        position: 1000,
        peak_current: 9.0,
        singleturn_bits: 16,
        unit: UnitChoice::DELIVERED,
        reference: None,
    };

    /// Returns the scaling in which a drive keeps its values: positions in thousandths, whatever PN.POSSCALE is.
    ///
    /// PN.POSSCALE is a divisor of what is read and a factor of what is written (manual 6.2); it changes no position.
    #[must_use]
    pub const fn kept(&self) -> Self {
        Self { position: 1, ..*self }
    }

    /// Creates a drive whose speed setpoint is N2: 100 % is `reference` rpm.
    #[must_use]
    pub const fn of_reference(reference: f64) -> Self {
        Self {
            reference: Some(reference),
            ..Self::DELIVERED
        }
    }

    /// NSOLL_A and NIST_A in rpm: N2 of the reference speed where there is one, else as [`velocity`].
    ///
    /// ```
    /// use profidrive_profile::catalogue::Scaling;
    /// assert_eq!(Scaling::of_reference(1500.0).speed().raw(750.0).value, 0x2000);
    /// assert_eq!(Scaling::default().speed().raw(60.0).value, 164); // AKD
    /// ```
    #[must_use]
    pub const fn speed(&self) -> Linear {
        match self.reference {
            Some(reference) => Linear::normalised(reference, 14, Width::I16),
            None => velocity(self),
        }
    }

    /// Returns the conversion of a scale. [`Scale::Raw`], [`Scale::Milli`] and [`Scale::Decimal`] occur in all sizes;
    /// their width here is that of a signed double word.
    #[must_use]
    pub const fn linear(&self, scale: Scale) -> Linear {
        match scale {
            Scale::Raw => Linear::step(1.0, Width::I32),
            Scale::Milli => Linear::decimal(-3, Width::I32),
            Scale::Position => position(self),
            Scale::Velocity => self.speed(),
            Scale::Acceleration => acceleration(self),
            Scale::Current => current(self),
            Scale::Singleturn => revolutions(self),
            Scale::MdiVelocity => mdi_velocity(),
            Scale::NominalVelocity => nominal_velocity(),
            Scale::Decimal(exponent) => Linear::decimal(exponent, Width::I32),
            Scale::Percent => Linear::N2,
        }
    }
}

/// Speed at full scale, rpm.
pub const FULL_SPEED: f64 = 12_000.0;

/// NSOLL_A and NIST_A in rpm: the raw number times PN.VELSCALING times 60 times 16000 / 2^32. With the default of 1638
/// that is 0.024 % below [`nominal_velocity`]. Source: manual 6.5.
#[must_use]
pub const fn velocity(scaling: &Scaling) -> Linear {
    Linear::normalised(scaling.velocity as f64 * 960_000.0, 32, Width::I16)
}

/// NSOLL_A and NIST_A in rpm as the chapter on units has it: 2^15 is 12000 rpm. Source: manual 5.12.1.
#[must_use]
pub const fn nominal_velocity() -> Linear {
    Linear::normalised(FULL_SPEED, 15, Width::I16)
}

/// MDI_VELOCITY in rpm: 2^32 is 12000 rpm, unsigned. Source: manual 5.12.1; signed it would end at 6000 rpm.
#[must_use]
pub const fn mdi_velocity() -> Linear {
    Linear::normalised(FULL_SPEED, 32, Width::U32)
}

/// MDI_ACC, MDI_DEC, DRV_ACC, DRV_DEC and the jog ramps (PNU 1006, 1007) in rpm/s: steps of PN.ACCSCALING.
/// Source: manual 6.1 and the support article.
#[must_use]
pub const fn acceleration(scaling: &Scaling) -> Linear {
    Linear::step(scaling.acceleration as f64, Width::U16)
}

/// MDI_ACC and MDI_DEC in rpm/s as the chapter on units has it: 2^16 is 50 000 000 rpm/s. Source: manual 5.12.3.
#[must_use]
pub const fn nominal_acceleration() -> Linear {
    Linear::normalised(50_000_000.0, 16, Width::U16)
}

/// ITIST_GLATT in ampere: N2, 2^14 is DRV.IPEAK. Source: manual 5.12.4.
#[must_use]
pub const fn current(scaling: &Scaling) -> Linear {
    Linear::normalised(scaling.peak_current, 14, Width::I16)
}

/// MDI_TARPOS, XIST_A and HOME_DIST in revolutions: 2^n is one, n is PNU 1002. Source: manual 5.12.2.
#[must_use]
pub const fn revolutions(scaling: &Scaling) -> Linear {
    let bits = if scaling.singleturn_bits > 32 {
        32
    } else {
        scaling.singleturn_bits as u8
    };
    Linear::normalised(1.0, bits, Width::I32)
}

/// Positions among the parameters from PNU 2000 on: thousandths divided by PN.POSSCALE. Source: manual 6.2; that the
/// number before the division is the one of thousandths is our reading.
#[must_use]
pub const fn position(scaling: &Scaling) -> Linear {
    Linear {
        multiplier: scaling.position as f64,
        divisor: 1000.0,
        width: Width::I32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(change: impl Fn(&mut Scaling)) -> Scaling {
        let mut scaling = Scaling::default();
        change(&mut scaling);
        scaling
    }

    fn near(a: f64, b: f64, tolerance: f64) -> bool {
        (a - b).abs() <= tolerance
    }

    #[test]
    fn speed_of_chapter_5_12_1() {
        let nominal = nominal_velocity();
        assert!(near(nominal.engineering(163), 59.69, 0.005)); // the manual cuts 163.84
        assert!(near(nominal.engineering(164), 60.06, 0.005));
        assert_eq!(nominal.raw(60.0).value, 164);
        assert_eq!(nominal.raw(-60.0).value, -164);
        assert_eq!(nominal.raw(12_000.0).checked().unwrap_err().nearest, 0x7FFF);
        assert!(near(nominal.engineering(0x7FFF), 11_999.6, 0.05));
        assert!(near(nominal.engineering(0x9E), 57.86, 0.005));
    }

    #[test]
    fn speed_of_chapter_6_5() {
        let default = velocity(&Scaling::default());
        assert!(near(default.engineering(163), 59.678, 0.0005));
        assert!(near(default.engineering(158), 57.85, 0.005));
        assert!(near(default.engineering(32_768), 11_997.07, 0.005));
        assert!(near(default.engineering(0x7FFF), 11_996.7, 0.05));
        assert_eq!(default.raw(60.0).value, 164);
        for (factor, step) in [
            (1, 0.000_223_5),
            (100, 0.022_35),
            (1000, 0.223_52),
            (1638, 0.366_12),
            (2000, 0.447_03),
        ] {
            let scale = velocity(&with(|scaling| scaling.velocity = factor));
            assert!(near(scale.engineering(1), step, 0.000_005), "{factor}");
        }
    }

    #[test]
    fn speed_of_mdi() {
        let scale = mdi_velocity();
        assert_eq!(scale.raw(60.0).value, 0x0147_AE14);
        assert!(near(scale.engineering(0xFFFF_FFFF), 11_999.999_997, 0.000_000_5));
        assert!(near(scale.engineering(i64::from(i32::MAX)), 5_999.99, 0.01));
        assert!(scale.raw(12_000.0).saturated && scale.raw(-1.0).saturated);
    }

    #[test]
    fn accelerations() {
        let default = acceleration(&Scaling::default());
        assert_eq!(default.engineering(2), 1526.0);
        assert_eq!(default.engineering(65_535), 50_003_205.0);
        assert!(default.raw(50_003_205.0 + 382.0).saturated);
        let of = |factor| acceleration(&with(|scaling| scaling.acceleration = factor));
        assert_eq!(of(1).engineering(400), 400.0);
        assert_eq!(of(20).raw(10_000.0).value, 500);
        assert_eq!(of(14_648).engineering(65_535), 959_956_680.0);
        assert_eq!(of(14_648).engineering(1), 14_648.0);
        assert!(near(nominal_acceleration().engineering(1), 762.94, 0.005));
        assert!(near(nominal_acceleration().engineering(2), 1525.88, 0.005));
        assert!(nominal_acceleration().raw(50_000_000.0).saturated); // 65536 does not fit
    }

    #[test]
    fn currents_and_positions() {
        let ampere = current(&Scaling::default());
        assert!(near(ampere.engineering(-182), -0.099_98, 0.000_005));
        assert_eq!(ampere.raw(9.0).value, 0x4000);
        assert_eq!(revolutions(&Scaling::default()).raw(1.5).value, 0x0001_8000);
        // MDI_TARPOS, XIST_A, XIST_ERROR and HOME_DIST
        for name in ["MDI_TARPOS", "XIST_A", "XIST_ERROR", "HOME_DIST"] {
            let parameter = crate::catalogue::AKD.by_name(name).unwrap();
            assert_eq!(parameter.scale, Scale::Singleturn, "{name}");
        }
        let coarse = with(|scaling| scaling.singleturn_bits = 10);
        assert_eq!(revolutions(&coarse).raw(-1.5).value, -1536);
        assert_eq!(position(&Scaling::default()).engineering(65_536), 65_536.0);
        assert_eq!(
            position(&with(|scaling| scaling.position = 1)).engineering(65_536),
            65.536
        );
    }

    #[test]
    fn each_scale_has_its_conversion() {
        let scaling = with(|scaling| {
            scaling.velocity = 1234;
            scaling.acceleration = 99;
            scaling.position = 17;
            scaling.peak_current = 27.3;
            scaling.singleturn_bits = 20;
        });
        for (scale, step) in [
            (Scale::Raw, 1.0),
            (Scale::Milli, 0.001),
            (Scale::Position, 0.017),
            (Scale::Velocity, 1234.0 * 960_000.0 / 4_294_967_296.0),
            (Scale::Acceleration, 99.0),
            (Scale::Current, 27.3 / 16_384.0),
            (Scale::Singleturn, 1.0 / 1_048_576.0),
            (Scale::MdiVelocity, 12_000.0 / 4_294_967_296.0),
        ] {
            assert_eq!(scaling.linear(scale).engineering(1), step, "{scale:?}");
        }
        assert_eq!(scaling.linear(Scale::Milli).engineering(1500), 1.5);
    }
}
