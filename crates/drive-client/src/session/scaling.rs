//! The values of a drive that scale other values.

use profidrive::catalogue::{Parameter, Scale, Scaling};

use super::Session;
use crate::parameter::Selection;
use crate::{Drive, Error, Wire};

const VELOCITY: u16 = 3064;
const ACCELERATION: u16 = 3065;
const POSITION: u16 = 3014;
const PEAK_CURRENT: u16 = 2132;
const SINGLETURN: u16 = 1002;
/// The profile's numbers of the first two.
const VELOCITY_MIRROR: u16 = 1009;
const ACCELERATION_MIRROR: u16 = 1008;
const MOTOR_TYPE: u16 = 2260;
const MOTOR_PITCH: u16 = 2251;
const UNIT_ROTARY: u16 = 2393;
const UNIT_LINEAR: u16 = 2391;
const UNIT_NUMERATOR: u16 = 2390;
const UNIT_DENOMINATOR: u16 = 2392;
const SCALING: [u16; 11] = [
    VELOCITY,
    ACCELERATION,
    POSITION,
    PEAK_CURRENT,
    SINGLETURN,
    MOTOR_TYPE,
    MOTOR_PITCH,
    UNIT_ROTARY,
    UNIT_LINEAR,
    UNIT_NUMERATOR,
    UNIT_DENOMINATOR,
];

/// Takes over the value of a parameter that scales others, in its engineering unit, and says which scale it is for;
/// nothing happens for any other one, and by 0 nothing is scaled.
///
/// ```
/// use drive_client::parameter::take_scale;
/// use profidrive::catalogue::{Scale, Scaling};
/// let mut scaling = Scaling::default();
/// assert_eq!(take_scale(&mut scaling, 3064, 200.0), Some(Scale::Velocity)); // PN.VELSCALING
/// assert_eq!(scaling.velocity, 200);
/// assert_eq!(take_scale(&mut scaling, 2108, 200.0), None);
/// ```
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
pub fn take_scale(scaling: &mut Scaling, pnu: u16, number: f64) -> Option<Scale> {
    let unit = &mut scaling.unit;
    Some(match pnu {
        MOTOR_TYPE => {
            unit.linear = number == 1.0;
            Scale::Position
        }
        UNIT_ROTARY => {
            unit.rotary_unit = number as i64;
            Scale::Position
        }
        UNIT_LINEAR => {
            unit.linear_unit = number as i64;
            Scale::Position
        }
        _ if number <= 0.0 => return None,
        MOTOR_PITCH => {
            unit.pitch = number as i64;
            Scale::Position
        }
        UNIT_NUMERATOR => {
            unit.custom.0 = number as i64;
            Scale::Position
        }
        UNIT_DENOMINATOR => {
            unit.custom.1 = number as i64;
            Scale::Position
        }
        VELOCITY | VELOCITY_MIRROR => {
            scaling.velocity = number as u16;
            Scale::Velocity
        }
        ACCELERATION | ACCELERATION_MIRROR => {
            scaling.acceleration = number as u16;
            Scale::Acceleration
        }
        POSITION => {
            scaling.position = number as u32;
            Scale::Position
        }
        PEAK_CURRENT => {
            scaling.peak_current = number;
            Scale::Current
        }
        SINGLETURN => {
            scaling.singleturn_bits = number as u16;
            Scale::Singleturn
        }
        _ => return None,
    })
}

pub(super) fn is_scaling(parameter: &Parameter) -> bool {
    SCALING.contains(&parameter.pnu) || matches!(parameter.pnu, VELOCITY_MIRROR | ACCELERATION_MIRROR)
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
        let wanted: Vec<Selection> = SCALING
            .iter()
            .filter_map(|&pnu| tables.by_pnu(pnu))
            .map(|parameter| Selection::of(parameter, tables.notation))
            .collect();
        for reading in self.read_plain(drive, &wanted)?.into_iter().flatten() {
            if let Some(number) = reading.number() {
                take_scale(&mut drive.parameters.scaling, reading.pnu, number);
            }
        }
        drive.scaled = true;
        Ok(())
    }
}
