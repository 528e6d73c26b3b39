//! Speeds that only the drive has: of its jog setpoints and of homing.

use profile::catalogue::Part;
use profile::notation::{Number, Position, Quantity};
use profile::state::Stw1;

use super::Session;
use crate::axis::{Jog, MotionFacts, Move, MovePlan};
use crate::drive::has_jog;
use crate::{Drive, Error};
use profile::value::{Reading, Selection};

/// The setting that is the speed of a jog setpoint.
#[derive(Debug, Clone, Copy)]
pub struct JogSpeed {
    /// The parameter.
    pub selection: Selection,
    /// Its number as a person types it: an application id of a Vacon.
    pub number: u16,
    /// Where the model has a frequency there: pole pairs of the motor.
    pole_pairs: Option<f64>,
}

/// Parts that show the speed.
const PARTS: [Part; 3] = [Part::MotorFrequency, Part::MotorSpeed, Part::MotorPoles];
/// Seconds in a minute: between Hz and rpm.
const MINUTE: f64 = 60.0;

impl JogSpeed {
    /// Returns the speed that a reading of it means, rpm.
    #[must_use]
    pub fn rpm(&self, reading: &Reading) -> Option<f64> {
        let number = reading.number()?;
        Some(self.pole_pairs.map_or(number, |pairs| number * MINUTE / pairs))
    }

    /// Returns the parameter value for a speed.
    #[must_use]
    pub fn quantity(&self, speed: &Quantity) -> Quantity {
        match (self.pole_pairs, speed.in_unit("rpm")) {
            (Some(pairs), Ok(rpm)) => Quantity {
                number: Number::Decimal(rpm * pairs / MINUTE),
                unit: None,
            },
            _ => speed.clone(),
        }
    }
}

/// The speed with which a drive homes, which only the drive has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HomingSpeed {
    /// It sets the position where the axis stands, or takes that of the feedback: nothing turns.
    None,
    /// In rpm.
    Rpm(f64),
    /// The drive does not report it.
    Unknown,
}

/// HOME.MODE: set the position where the axis stands, take that of the feedback.
const ON_THE_SPOT: [i64; 2] = [0, 13];

impl Session {
    /// Returns the setting that is the speed of a jog setpoint of this drive, by its model and by whose control words
    /// it has now.
    ///
    /// # Errors
    /// When no such setting is known, or the drive cannot be reached.
    pub async fn jog_speed(&mut self, drive: &mut Drive, jog: Jog) -> Result<JogSpeed, Error> {
        let tables = drive.model.catalogue;
        let part = match jog {
            Jog::One => Part::Jog1,
            Jog::Two => Part::Jog2,
        };
        let only = tables.and_then(|tables| tables.part(Part::JogOnly));
        let one = match only {
            Some(_) => !has_jog(self.snapshot(drive, &[]).await?.profile, Stw1::JOG_2),
            None => false,
        };
        let found = only.filter(|_| one).or_else(|| tables?.part(part));
        let parameter = found.ok_or_else(|| Error::UnknownModel {
            drive: drive.label(),
            what: "the parameter that is its jog speed",
            vendor_id: drive.station.vendor_id,
            device_id: drive.station.device_id,
        })?;
        let pole_pairs = match parameter.unit {
            "Hz" => Some(self.ask(drive, &PARTS).await?.pole_pairs()),
            _ => None,
        };
        Ok(JogSpeed {
            selection: Selection::of(parameter, drive.parameters.notation()),
            number: parameter.base.unwrap_or(parameter.pnu),
            pole_pairs,
        })
    }

    /// Returns the speed with which this drive homes as it is set up.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn homing_speed(&mut self, drive: &mut Drive) -> Result<HomingSpeed, Error> {
        let readings = self.ask(drive, &[Part::HomeMode, Part::HomeSpeed]).await?;
        if readings
            .raw(Part::HomeMode)
            .is_some_and(|mode| ON_THE_SPOT.contains(&mode))
        {
            return Ok(HomingSpeed::None);
        }
        let speed = readings.rpm(Part::HomeSpeed);
        Ok(speed.map_or(HomingSpeed::Unknown, HomingSpeed::Rpm))
    }

    /// Checks the speed of real-time jogging and returns it as it will travel. Reads only.
    ///
    /// # Errors
    /// [`Error::Objections`] when the speed is above `speed_limit`, above the limit of the drive in its direction, or
    /// more than MDI_VELOCITY carries; when the model is not known, or the drive cannot be reached.
    pub async fn check_jog(&mut self, drive: &mut Drive, rpm: f64, speed_limit: f64) -> Result<f64, Error> {
        self.read_scaling(drive).await?;
        let plan = self.plan_jog(drive, rpm, [None; 2], speed_limit).await?;
        Ok(plan.speed.copysign(rpm))
    }

    pub(super) async fn plan_jog(
        &mut self,
        drive: &mut Drive,
        rpm: f64,
        [acceleration, deceleration]: [Option<f64>; 2],
        speed_limit: f64,
    ) -> Result<MovePlan, Error> {
        let facts = self.motion_facts(drive).await?;
        let order = Move::by(Position::Counts(0.0), rpm.abs()).with_ramps(acceleration, deceleration);
        // a jog has a direction and no target: of the facts only the limit of that direction counts
        let facts = MotionFacts {
            position: Some(0.0),
            forward_limit: facts.speed_limit(rpm).map(|(limit, _)| limit),
            ..MotionFacts::default()
        };
        let plan = self.plan_with(drive, &order, &facts, speed_limit)?;
        if plan.objections.is_empty() {
            return Ok(plan);
        }
        Err(Error::Objections {
            drive: drive.label(),
            objections: plan.objections,
        })
    }
}
