//! Parameters that scale other parameters.

use crate::catalogue::{Catalogue, Parameter, Part, Scale, Scaling};

/// Every part that scales something.
pub const SCALING: [Part; 16] = [
    Part::VelocityScaling,
    Part::AccelerationScaling,
    Part::PositionScaling,
    Part::PeakCurrent,
    Part::SingleturnBits,
    Part::MotorType,
    Part::MotorPitch,
    Part::UnitRotary,
    Part::UnitLinear,
    Part::UnitNumerator,
    Part::UnitDenominator,
    Part::Reference,
    Part::ReferenceUnit,
    Part::MotorFrequency,
    Part::MotorSpeed,
    Part::MotorPoles,
];

/// Takes over the value of a parameter that scales others, in its engineering unit, and returns the scale it is for;
/// nothing happens for any other one, and by 0 nothing is scaled. The reference of a converter depends on several
/// parameters and is not taken here.
///
/// ```
/// use profidrive_profile::value::take_scale;
/// use profidrive_profile::catalogue::{AKD, Scale, Scaling};
/// let mut scaling = Scaling::default();
/// assert_eq!(take_scale(&AKD, &mut scaling, (3064, None), 200.0), Some(Scale::Velocity)); // PN.VELSCALING
/// assert_eq!(scaling.velocity, 200);
/// assert_eq!(take_scale(&AKD, &mut scaling, (2108, None), 200.0), None);
/// ```
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
pub fn take_scale(
    tables: &Catalogue,
    scaling: &mut Scaling,
    (pnu, index): (u16, Option<u16>),
    number: f64,
) -> Option<Scale> {
    let base = tables.at(pnu, index.unwrap_or(0))?.base;
    let part = tables.parts_at(pnu, base).find(|part| SCALING.contains(part))?;
    let unit = &mut scaling.unit;
    Some(match part {
        Part::MotorType => {
            unit.linear = number == 1.0;
            Scale::Position
        }
        Part::UnitRotary => {
            unit.rotary_unit = number as i64;
            Scale::Position
        }
        Part::UnitLinear => {
            unit.linear_unit = number as i64;
            Scale::Position
        }
        _ if number <= 0.0 => return None,
        Part::MotorPitch => {
            unit.pitch = number as i64;
            Scale::Position
        }
        Part::UnitNumerator => {
            unit.custom.0 = number as i64;
            Scale::Position
        }
        Part::UnitDenominator => {
            unit.custom.1 = number as i64;
            Scale::Position
        }
        Part::VelocityScaling => {
            scaling.velocity = number as u16;
            Scale::Velocity
        }
        Part::AccelerationScaling => {
            scaling.acceleration = number as u16;
            Scale::Acceleration
        }
        Part::PositionScaling => {
            scaling.position = number as u32;
            Scale::Position
        }
        Part::PeakCurrent => {
            scaling.peak_current = number;
            Scale::Current
        }
        Part::SingleturnBits => {
            scaling.singleturn_bits = number as u16;
            Scale::Singleturn
        }
        _ => return None,
    })
}

/// Returns true for a parameter that scales others.
#[must_use]
pub fn is_scaling(tables: &Catalogue, parameter: &Parameter) -> bool {
    let mut parts = tables.parts_at(parameter.pnu, parameter.base);
    parts.any(|part| SCALING.contains(&part))
}
