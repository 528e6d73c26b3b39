//! What the drive obeys, taken out of its parameters once after each change instead of in every cycle.

use profile::catalogue::Scaling;
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

/// Speed below which the axis counts as standing where no parameter says it, rpm.
const STANDSTILL: f64 = 3.0;

impl Settings {
    pub fn new(model: &Model, values: &Values) -> Self {
        let roles = &model.roles;
        let raw = |pnu: Option<u16>| pnu.map(|pnu| values.get(pnu));
        let standard = model.catalogue.scaling;
        let mut scaling = Scaling {
            velocity: number(raw(roles.velocity_scaling), standard.velocity),
            acceleration: number(raw(roles.acceleration_scaling), standard.acceleration),
            position: number(raw(roles.position_scaling), standard.position),
            singleturn_bits: number(raw(roles.singleturn_bits), standard.singleturn_bits),
            unit: {
                let unit = &roles.positioning.unit;
                UnitChoice {
                    linear: values.get(unit.motor) == 1,
                    rotary_unit: values.get(unit.unit[0]),
                    linear_unit: values.get(unit.unit[1]),
                    custom: (values.get(unit.custom[0]), values.get(unit.custom[1])),
                    pitch: values.get(unit.pitch),
                }
            },
            ..standard
        };
        let inverter = roles.inverter.map(|roles| Inverter::new(roles, model, values));
        if let Some(inverter) = &inverter {
            scaling.reference = Some(inverter.reference[1]);
        }
        let value = |pnu: Option<u16>, scaling: &Scaling| {
            let parameter = model.numbered(pnu?)?;
            Some(parameter.engineering(values.get(pnu?), scaling))
        };
        if let Some(peak) = value(roles.peak_current, &scaling) {
            scaling.peak_current = peak;
        }
        let kept = scaling.kept();
        let value = |pnu: Option<u16>, otherwise: f64| value(pnu, &kept).unwrap_or(otherwise);
        let tuning = Tuning::default();
        let peak = scaling.peak_current;
        let ramp = |pnu: Option<u16>| value(pnu, 3000.0);
        let ramps = Ramps {
            acceleration: ramp(roles.acceleration),
            deceleration: ramp(roles.deceleration),
        };
        let [current_positive, current_negative] =
            roles.current_limit.map(|pnu| value(pnu, peak).abs().min(peak));
        let [speed_positive, speed_negative] = roles.speed_limit.map(|pnu| value(pnu, 3000.0).abs());
        let [up, down] = roles.jog_ramp;
        let mode = match raw(roles.mode) {
            Some(0) => Mode::Current,
            Some(2) => Mode::Position,
            _ => Mode::Speed,
        };
        let [drive_continuous, motor_continuous] = roles.continuous_current;
        let milliampere = |pnu: Option<u16>, otherwise: f64| value(pnu, 1000.0 * otherwise) / 1000.0;
        let settings = Self {
            scaling,
            tuning: Tuning {
                current_positive,
                current_negative,
                speed_positive,
                speed_negative,
                gain: value(roles.gain, tuning.gain),
                integral: value(roles.integral, tuning.integral),
                position_gain: value(roles.position_gain, tuning.position_gain),
                speed_forward: value(roles.speed_forward, tuning.speed_forward),
                drive_endurance: Endurance {
                    continuous: value(drive_continuous, tuning.drive_endurance.continuous),
                    peak,
                    ..tuning.drive_endurance
                },
                motor_endurance: Endurance {
                    continuous: milliampere(motor_continuous, tuning.motor_endurance.continuous),
                    peak: milliampere(roles.motor_peak_current, tuning.motor_endurance.peak),
                    time: value(roles.motor_peak_time, tuning.motor_endurance.time),
                },
                ..tuning
            },
            ramps,
            quick_stop: value(roles.quick_stop, 10.0 * ramps.deceleration),
            standstill: value(roles.standstill, STANDSTILL),
            jog_speed: roles.jog_speed.map(|pnu| value(pnu, 0.0)),
            jog_ramps: Ramps {
                acceleration: value(up, ramps.acceleration),
                deceleration: value(down, ramps.deceleration),
            },
            watching: Watching::new(model, mode == Mode::Current, |pnu| value(Some(pnu), 0.0)),
            mode,
            commanded_by_bus: raw(roles.command_source) != Some(0),
            service_speed: value(roles.service_speed, 0.0),
            service_current: value(roles.service_current, 0.0),
            disable_on_ramp: raw(roles.disable_mode).is_some_and(|mode| mode >= 2),
            holds_when_off: matches!(roles.brake.map(raw), [Some(1), None | Some(0)]),
            fault_on_stop: raw(roles.bus_options).is_some_and(|options| options & 1 == 1),
            position: Setup::new(model, values, &kept, [speed_negative, speed_positive]),
            inverter,
        };
        match inverter {
            Some(inverter) => settings.with(&inverter),
            None => settings,
        }
    }

    /// Returns what a frequency converter has in the place of the parameters of a servo drive.
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
