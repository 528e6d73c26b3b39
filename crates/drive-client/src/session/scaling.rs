//! The values of a drive that scale other values.

use profidrive::catalogue::{Catalogue, Parameter, Part, Scale, Scaling};

use super::Session;
use crate::{Drive, Error, Wire};

/// Every part that scales something.
const SCALING: [Part; 16] = [
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

/// Takes over the value of a parameter that scales others, in its engineering unit, and says which scale it is for;
/// nothing happens for any other one, and by 0 nothing is scaled. The reference of a converter depends on several
/// parameters and is not taken here.
///
/// ```
/// use drive_client::parameter::take_scale;
/// use profidrive::catalogue::{AKD, Scale, Scaling};
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

pub(super) fn is_scaling(tables: &Catalogue, parameter: &Parameter) -> bool {
    let mut parts = tables.parts_at(parameter.pnu, parameter.base);
    parts.any(|part| SCALING.contains(&part))
}

impl<M: Wire> Session<M> {
    /// Reads the values of the drive that scale other values, once.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub fn read_scaling(&mut self, drive: &mut Drive) -> Result<(), Error> {
        let Some(tables) = drive.model.catalogue.filter(|_| !drive.scaled) else {
            return Ok(());
        };
        // what is read here scales nothing itself: asked again, nothing would be read
        drive.scaled = true;
        let told = match self.ask(drive, &SCALING) {
            Ok(told) => told,
            Err(error) => {
                drive.scaled = false;
                return Err(error);
            }
        };
        drive.scaled = self.unread().is_none();
        for part in SCALING {
            // of several parameters with one value the first counts
            if let Some((reading, number)) = told.find(part).and_then(|one| Some((one, one.number()?))) {
                let at = (reading.pnu, reading.index);
                take_scale(tables, &mut drive.parameters.scaling, at, number);
            }
        }
        if let Some(reference) = told.reference() {
            drive.parameters.scaling.reference = Some(reference);
        }
        Ok(())
    }
}
