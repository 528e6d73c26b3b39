//! The mechanics and the loops: a servo motor with a load, its current limit, velocity loop and ramp generator.
//!
//! Deterministic: the same steps give the same numbers on every machine of the same kind. No allocation.

mod plant;
mod ramp;

pub use plant::{Electrical, Plant};
pub use ramp::Ramp;

use core::f64::consts::TAU;

/// Rotations per minute of one radian per second.
const RPM: f64 = 60.0 / TAU;

/// Position counts of one revolution inside the axis.
const REVOLUTION: f64 = 4_294_967_296.0;

/// Longest step of the integration; longer times are cut into equal steps not longer than this.
const LONGEST_STEP: f64 = 0.001;

/// Most steps done in one call: half a second, the longest update time of PROFINET. More time than that is skipped.
const MOST_STEPS: usize = 512;

/// What the power stage does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Pulses off: the axis coasts.
    Off,
    /// Velocity loop closed, target through the ramp generator.
    Speed {
        /// Wanted speed in rpm.
        target: f64,
        /// Ramps in rpm/s, or none: the target applies at once, as fast as the current limit allows.
        ramp: Option<Ramps>,
        /// The ramp generator keeps its present output.
        hold: bool,
    },
    /// Current loop only.
    Current {
        /// Wanted current in ampere.
        target: f64,
    },
}

/// Slopes of the ramp generator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramps {
    /// Away from standstill, rpm/s.
    pub acceleration: f64,
    /// Towards standstill, rpm/s.
    pub deceleration: f64,
}

/// Limits and gains that come from parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tuning {
    /// Highest current in positive direction, A.
    pub current_positive: f64,
    /// Highest current in negative direction as a positive number, A.
    pub current_negative: f64,
    /// Highest speed, rpm.
    pub speed_positive: f64,
    /// Highest speed in negative direction as a positive number, rpm.
    pub speed_negative: f64,
    /// Proportional gain of the velocity loop, A/(rad/s).
    pub gain: f64,
    /// Corner frequency of its integral part, Hz.
    pub integral: f64,
}

/// A motor with its load under control.
///
/// ```
/// use virtual_drive::axis::{Axis, Command, Plant, Ramps, Tuning};
/// let mut axis = Axis::new(Plant::default());
/// let ramp = Some(Ramps { acceleration: 3000.0, deceleration: 3000.0 });
/// for _ in 0..100 {
///     axis.step(0.004, Command::Speed { target: 60.0, ramp, hold: false }, &Tuning::default());
/// }
/// assert!((axis.speed() - 60.0).abs() < 0.5);
/// ```
#[derive(Debug, Clone)]
pub struct Axis {
    plant: Plant,
    electrical: Electrical,
    ramp: Ramp,
    /// rad/s
    omega: f64,
    /// Position in 2^-32 revolutions, and what is lost below one count.
    position: i64,
    remainder: f64,
    /// Integral part of the velocity loop, A.
    integral: f64,
    /// Current that flows, A.
    current: f64,
    /// Torque of the load against positive rotation, Nm.
    load: f64,
    /// Speed through a 10 Hz filter, rpm.
    filtered: f64,
    /// Speed as the drive measures it, rpm.
    measured: f64,
    noise: u32,
}

impl Axis {
    /// At rest at position 0.
    #[must_use]
    pub fn new(plant: Plant) -> Self {
        Self {
            plant,
            electrical: Electrical::new(),
            ramp: Ramp::default(),
            omega: 0.0,
            position: 0,
            remainder: 0.0,
            integral: 0.0,
            current: 0.0,
            load: 0.0,
            filtered: 0.0,
            measured: 0.0,
            noise: 0x2545_F491,
        }
    }

    /// Moves on by `seconds`, in equal steps of at most 1 ms.
    pub fn step(&mut self, seconds: f64, command: Command, tuning: &Tuning) {
        if seconds.is_nan() || seconds <= 0.0 {
            return;
        }
        let steps = ((seconds / LONGEST_STEP).ceil() as usize).clamp(1, MOST_STEPS);
        let dt = (seconds / steps as f64).min(LONGEST_STEP);
        for _ in 0..steps {
            self.substep(dt, command, tuning);
        }
    }

    fn substep(&mut self, dt: f64, command: Command, tuning: &Tuning) {
        let wanted = match command {
            Command::Off => {
                self.integral = 0.0;
                self.ramp.follow(self.speed());
                0.0
            }
            Command::Current { target } => {
                self.integral = 0.0;
                self.ramp.follow(self.speed());
                target
            }
            Command::Speed { target, ramp, hold } => {
                let target = target.clamp(-tuning.speed_negative, tuning.speed_positive);
                let reference = self.ramp.step(dt, target, ramp, hold) / RPM;
                let error = reference - self.omega;
                // The gain never makes one step overshoot, whatever a parameter says.
                let gain = tuning.gain.clamp(
                    0.0,
                    0.5 * self.plant.inertia() / (self.plant.torque_constant * dt),
                );
                let forward = self.ramp.slope() / RPM * self.plant.inertia() / self.plant.torque_constant;
                let wanted = gain * error + self.integral + forward;
                let limited = wanted.clamp(-tuning.current_negative, tuning.current_positive);
                // The integral part stands still while the current is limited in its direction.
                if wanted == limited || (wanted > limited) != (error > 0.0) {
                    self.integral += gain * error * (tuning.integral * TAU).min(0.1 / dt) * dt;
                }
                wanted
            }
        };
        self.current = match command {
            Command::Off => 0.0,
            _ => wanted.clamp(-tuning.current_negative, tuning.current_positive),
        };
        let angle = (self.position as u64 & 0xFFFF_FFFF) as f64 / REVOLUTION;
        let drive = self.current * self.plant.torque_constant - self.load;
        let power = self.current * self.plant.torque_constant * self.omega;
        self.omega = self.plant.next_speed(self.omega, drive, angle, dt);
        let counts = self.omega / TAU * dt * REVOLUTION + self.remainder;
        let whole = counts as i64;
        self.remainder = counts - whole as f64;
        self.position = self.position.wrapping_add(whole);
        self.electrical.step(dt, power, self.current);
        self.measure(dt);
    }

    /// The measured speed has a little noise while the axis turns: the last digits of an encoder.
    fn measure(&mut self, dt: f64) {
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 17;
        self.noise ^= self.noise << 5;
        let noise = if self.omega == 0.0 {
            0.0
        } else {
            f64::from(self.noise as i32) / 2_147_483_648.0
        };
        self.measured = self.speed() + 0.06 * noise;
        self.filtered += (self.measured - self.filtered) * (dt * 10.0 * TAU).min(1.0);
        if self.omega == 0.0 && self.filtered.abs() < 0.001 {
            self.filtered = 0.0;
        }
    }

    /// True speed in rpm.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.omega * RPM
    }

    /// Speed as the drive measures it, rpm (VL.FB).
    #[must_use]
    pub const fn measured_speed(&self) -> f64 {
        self.measured
    }

    /// Measured speed through a 10 Hz filter, rpm (VL.FBFILTER).
    #[must_use]
    pub const fn filtered_speed(&self) -> f64 {
        self.filtered
    }

    /// Output of the ramp generator, rpm (VL.CMD).
    #[must_use]
    pub const fn speed_command(&self) -> f64 {
        self.ramp.output()
    }

    /// Torque-producing current, A (IL.FB).
    #[must_use]
    pub const fn current(&self) -> f64 {
        self.current
    }

    /// Position in 2^-32 revolutions since the start.
    #[must_use]
    pub const fn position(&self) -> i64 {
        self.position
    }

    /// Bus voltage and temperatures.
    #[must_use]
    pub const fn electrical(&self) -> &Electrical {
        &self.electrical
    }

    /// Torque that works against positive rotation, in Nm; takes effect with the next step.
    pub const fn set_load(&mut self, torque: f64) {
        self.load = torque;
    }

    /// True when nothing will change without a command or a load.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.omega == 0.0 && self.load.abs() <= self.plant.coulomb_friction
    }

    /// True when the speed is below `threshold` rpm.
    #[must_use]
    pub fn is_standing(&self, threshold: f64) -> bool {
        self.speed().abs() < threshold
    }
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            current_positive: 9.0,
            current_negative: 9.0,
            speed_positive: 3000.0,
            speed_negative: 3000.0,
            gain: 0.2,
            integral: 8.0,
        }
    }
}

#[cfg(test)]
mod tests;
