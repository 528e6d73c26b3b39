//! The motor with its load, and the power stage around it.

use core::f64::consts::TAU;

/// Motor and load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plant {
    /// Inertia of the rotor, kg m^2.
    pub motor_inertia: f64,
    /// Inertia of the load, kg m^2.
    pub load_inertia: f64,
    /// Torque per ampere, Nm/A.
    pub torque_constant: f64,
    /// Friction that grows with speed, Nm/(rad/s).
    pub viscous_friction: f64,
    /// Friction that does not, Nm.
    pub coulomb_friction: f64,
    /// Amplitude of the cogging torque, Nm.
    pub cogging: f64,
    /// Cogging periods per revolution.
    pub cogging_periods: f64,
}

impl Default for Plant {
    /// A small servo motor (MOTOR.INERTIA 1.2 kgcm^2, MOTOR.KT 0.85 Nm/A) with a disc of twice its inertia.
    fn default() -> Self {
        Self {
            motor_inertia: 1.2e-4,
            load_inertia: 2.4e-4,
            torque_constant: 0.85,
            viscous_friction: 1.0e-4,
            coulomb_friction: 0.05,
            cogging: 0.003,
            cogging_periods: 30.0,
        }
    }
}

impl Plant {
    /// Inertia of rotor and load, kg m^2.
    #[must_use]
    pub fn inertia(&self) -> f64 {
        self.motor_inertia + self.load_inertia
    }

    /// Speed in rad/s after `dt` seconds with `torque` Nm from motor and load, at `angle` revolutions.
    pub(super) fn next_speed(&self, omega: f64, torque: f64, angle: f64, dt: f64) -> f64 {
        let inertia = self.inertia();
        let cogging = self.cogging * (angle * self.cogging_periods * TAU).sin();
        if omega == 0.0 {
            // Friction holds the axis until something is stronger.
            if torque.abs() <= self.coulomb_friction {
                return 0.0;
            }
            return (torque - self.coulomb_friction.copysign(torque)) / inertia * dt;
        }
        let friction = self.coulomb_friction.copysign(omega) + self.viscous_friction * omega;
        let next = omega + (torque + cogging - friction) / inertia * dt;
        // Friction can stop the axis, not turn it round.
        let stops = next * omega <= 0.0 && (torque + cogging).abs() <= self.coulomb_friction;
        if stops { 0.0 } else { next }
    }
}

/// DC bus and temperatures, first order each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Electrical {
    bus: f64,
    power_stage: f64,
    motor: f64,
}

/// Rectified 230 V, V.
const BUS: f64 = 325.0;
/// The brake resistor keeps the bus below this, V.
const REGEN: f64 = 400.0;
/// Capacitance of the bus, F.
const CAPACITANCE: f64 = 560e-6;
/// Time in which the mains brings the bus back, s.
const BUS_TIME: f64 = 0.02;
/// Air around the drive, degC.
const AMBIENT: f64 = 25.0;

impl Electrical {
    pub(super) const fn new() -> Self {
        Self {
            bus: BUS,
            power_stage: AMBIENT + 8.0,
            motor: AMBIENT,
        }
    }

    /// `power` W flow from the bus into the shaft, `current` A through the motor.
    pub(super) fn step(&mut self, dt: f64, power: f64, current: f64) {
        let losses = 2.0 * current * current;
        let flow = (BUS - self.bus) / BUS_TIME - (power + losses) / (CAPACITANCE * self.bus);
        self.bus = (self.bus + flow * dt).clamp(0.5 * BUS, REGEN);
        let heat = current * current;
        self.power_stage += (AMBIENT + 8.0 + 0.9 * heat - self.power_stage) * (dt / 120.0);
        self.motor += (AMBIENT + 6.0 * heat - self.motor) * (dt / 900.0);
    }

    /// Voltage of the DC bus, V (VBUS.VALUE).
    #[must_use]
    pub const fn bus_voltage(&self) -> f64 {
        self.bus
    }

    /// Temperature of the power stage, degC (TEMP.POWER).
    #[must_use]
    pub const fn power_stage_temperature(&self) -> f64 {
        self.power_stage
    }

    /// Temperature of the motor winding, degC (MOTOR.TEMPC).
    #[must_use]
    pub const fn motor_temperature(&self) -> f64 {
        self.motor
    }

    /// Temperature of the control board, degC (TEMP.CONTROL).
    #[must_use]
    pub const fn control_temperature(&self) -> f64 {
        AMBIENT + 12.0
    }
}
