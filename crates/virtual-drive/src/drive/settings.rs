//! Settings of the drive, derived from its parameters once after each change instead of in every cycle.

use profile::catalogue::{Part, Scaling};
use profile::unit::UnitChoice;

use super::faults::Watching;
use super::inverter::Inverter;
use super::position::Setup;
use crate::axis::{Endurance, Ramps, Tuning};
use crate::model::Model;
use crate::store::Values;

/// Control mode of the axis (DRV.OPMODE).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Current (torque).
    Current,
    /// Speed.
    Speed,
    /// Position.
    Position,
}

/// Parameters in the units of the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settings {
    pub scaling: Scaling,
    pub tuning: Tuning,
    pub ramps: Ramps,
    pub quick_stop: f64,
    pub standstill: f64,
    pub jog_speed: [f64; 2],
    pub jog_ramps: Ramps,
    pub watching: Watching,
    pub mode: Mode,
    pub commanded_by_bus: bool,
    pub service_speed: f64,
    pub service_current: f64,
    pub disable_on_ramp: bool,
    pub fault_on_stop: bool,
    /// A brake is fitted and holds the axis while the power stage is off.
    pub holds_when_off: bool,
    pub position: Setup,
    pub inverter: Option<Inverter>,
}

/// Speed below which the axis counts as standing where no parameter defines it, rpm.
const STANDSTILL: f64 = 3.0;

impl Settings {
    pub fn new(model: &Model, values: &Values) -> Self {
        let raw = |part| model.number(part).map(|number| values.get(number));
        let standard = model.catalogue.scaling;
        let mut scaling = Scaling {
            velocity: number(raw(Part::VelocityScaling), standard.velocity),
            acceleration: number(raw(Part::AccelerationScaling), standard.acceleration),
            position: number(raw(Part::PositionScaling), standard.position),
            singleturn_bits: number(raw(Part::SingleturnBits), standard.singleturn_bits),
            unit: UnitChoice {
                linear: raw(Part::MotorType) == Some(1),
                rotary_unit: raw(Part::UnitRotary).unwrap_or(0),
                linear_unit: raw(Part::UnitLinear).unwrap_or(0),
                custom: (
                    raw(Part::UnitNumerator).unwrap_or(0),
                    raw(Part::UnitDenominator).unwrap_or(0),
                ),
                pitch: raw(Part::MotorPitch).unwrap_or(0),
            },
            ..standard
        };
        let inverter = model
            .converter
            .map(|converter| Inverter::new(converter, model, values));
        if let Some(inverter) = &inverter {
            scaling.reference = Some(inverter.reference[1]);
        }
        let value = |part, scaling: &Scaling| {
            let number = model.number(part)?;
            Some(model.numbered(number)?.engineering(values.get(number), scaling))
        };
        if let Some(peak) = value(Part::PeakCurrent, &scaling) {
            scaling.peak_current = peak;
        }
        let kept = scaling.kept();
        let value = |part, otherwise: f64| value(part, &kept).unwrap_or(otherwise);
        let tuning = Tuning::default();
        let peak = scaling.peak_current;
        let ramp = |part| value(part, 3000.0);
        let ramps = Ramps {
            acceleration: ramp(Part::Acceleration),
            deceleration: ramp(Part::Deceleration),
        };
        let [current_positive, current_negative] = [Part::PositiveCurrentLimit, Part::NegativeCurrentLimit]
            .map(|part| value(part, peak).abs().min(peak));
        let [speed_positive, speed_negative] =
            [Part::ForwardLimit, Part::BackwardLimit].map(|part| value(part, 3000.0).abs());
        let mode = match raw(Part::ControlMode) {
            Some(0) => Mode::Current,
            Some(2) => Mode::Position,
            _ => Mode::Speed,
        };
        let milliampere = |part, otherwise: f64| value(part, 1000.0 * otherwise) / 1000.0;
        let settings = Self {
            scaling,
            tuning: Tuning {
                current_positive,
                current_negative,
                speed_positive,
                speed_negative,
                gain: value(Part::VelocityGain, tuning.gain),
                integral: value(Part::VelocityIntegral, tuning.integral),
                position_gain: value(Part::PositionGain, tuning.position_gain),
                speed_forward: value(Part::VelocityFeedforward, tuning.speed_forward),
                drive_endurance: Endurance {
                    continuous: value(Part::DriveContinuousCurrent, tuning.drive_endurance.continuous),
                    peak,
                    ..tuning.drive_endurance
                },
                motor_endurance: Endurance {
                    continuous: milliampere(Part::MotorContinuousCurrent, tuning.motor_endurance.continuous),
                    peak: milliampere(Part::MotorPeakCurrent, tuning.motor_endurance.peak),
                    time: value(Part::MotorPeakTime, tuning.motor_endurance.time),
                },
                ..tuning
            },
            ramps,
            quick_stop: value(Part::QuickStopDeceleration, 10.0 * ramps.deceleration),
            standstill: STANDSTILL,
            jog_speed: [Part::Jog1, Part::Jog2].map(|part| value(part, 0.0)),
            jog_ramps: Ramps {
                acceleration: value(Part::JogAcceleration, ramps.acceleration),
                deceleration: value(Part::JogDeceleration, ramps.deceleration),
            },
            watching: Watching::new(model, mode == Mode::Current, |part| value(part, 0.0)),
            mode,
            commanded_by_bus: raw(Part::CommandSource) != Some(0),
            service_speed: value(Part::ServiceSpeed, 0.0),
            service_current: value(Part::ServiceCurrent, 0.0),
            disable_on_ramp: raw(Part::DisableMode).is_some_and(|mode| mode >= 2),
            holds_when_off: raw(Part::Brake) == Some(1) && raw(Part::BrakeReleased).unwrap_or(0) == 0,
            fault_on_stop: raw(Part::BusOptions).is_some_and(|options| options & 1 == 1),
            position: Setup::new(model, values, &kept, [speed_negative, speed_positive]),
            inverter,
        };
        match inverter {
            Some(inverter) => settings.with(&inverter),
            None => settings,
        }
    }

    /// Returns the settings with those that a frequency converter has in place of a servo drive's.
    fn with(self, inverter: &Inverter) -> Self {
        Self {
            tuning: inverter.tuning(self.tuning),
            ramps: inverter.ramps[0],
            quick_stop: inverter.quick_stop,
            jog_speed: inverter.jogs,
            jog_ramps: inverter.jog_ramps,
            ..self
        }
    }
}

fn number<T: TryFrom<i64>>(raw: Option<i64>, otherwise: T) -> T {
    raw.and_then(|raw| T::try_from(raw).ok()).unwrap_or(otherwise)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::AKD;

    #[test]
    fn as_delivered() {
        let settings = Settings::new(&AKD, &Values::new(AKD.catalogue));
        assert_eq!(settings.scaling, Scaling::default());
        assert_eq!(
            settings.ramps,
            Ramps {
                acceleration: 3000.0,
                deceleration: 3000.0
            }
        );
        assert_eq!(settings.quick_stop, 3000.0);
        assert_eq!(settings.tuning.current_positive, 9.0);
        assert_eq!(settings.tuning.current_negative, 9.0);
        assert_eq!(settings.tuning.speed_negative, 3000.0);
        assert_eq!(settings.tuning, Tuning::default());
        assert_eq!(settings.mode, Mode::Speed);
        assert_eq!(settings.jog_ramps.acceleration, 3052.0);
        assert!((settings.jog_speed[1] + 60.06).abs() < 0.01);
        assert!(settings.commanded_by_bus && !settings.disable_on_ramp && !settings.fault_on_stop);
    }

    #[test]
    fn a_current_limit_above_the_drives_peak_changes_nothing() {
        let mut values = Values::new(AKD.catalogue);
        values.set(2231, 50_000);
        values.set(2230, -2_000);
        let settings = Settings::new(&AKD, &values);
        assert_eq!(
            (settings.tuning.current_positive, settings.tuning.current_negative),
            (9.0, 2.0)
        );
    }
}
