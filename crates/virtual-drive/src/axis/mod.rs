//! The mechanics and the loops: a servo motor with a load, its current limit, velocity and position loop, ramp generator
//! and trajectory, and what stands along its way; or an induction motor under voltage per frequency in its place.
//!
//! Deterministic: the same steps give the same numbers on every machine of the same kind. No allocation.
//!
//! | file | what it holds |
//! |---|---|
//! | `command` | commands of the axis |
//! | `plant` | motor, load, friction, brake, hard stops |
//! | `inputs` | limit switches, home switch, index pulse |
//! | `electrical` | DC bus, temperatures, current foldback |
//! | `loops` | position and velocity loop |
//! | `induction` | induction motor and what its inverter does |
//! | `ramp` | ramp generator of the velocity mode |
//! | `trajectory`, `profile` | reference of the position loop |

mod command;
mod electrical;
mod induction;
mod inputs;
mod loops;
mod plant;
mod profile;
mod ramp;
mod trajectory;

pub use command::{Command, Ramps, Tuning};
pub use electrical::{Electrical, Endurance, PowerStage};
pub use induction::{Induction, InverterTuning, Motor, MotorOutput};
pub use inputs::{Inputs, Latch};
pub use plant::{Plant, Travel};
pub use ramp::Ramp;

use core::f64::consts::TAU;

use inputs::Sensors;
use loops::{Feedback, Gains, Loops};
use plant::Mechanics;

/// Rotations per minute of one radian per second.
const RPM: f64 = 60.0 / TAU;

/// Longest step of the integration; longer times are cut into equal steps not longer than this.
const LONGEST_STEP: f64 = 0.001;

/// Most steps done in one call: half a second, the longest update time of PROFINET. More time than that is skipped.
const MOST_STEPS: usize = 512;

/// Steps of one length with the same gains and limits, prepared by [`Axis::stride`].
#[derive(Debug, Clone)]
pub struct Stride {
    /// s
    dt: f64,
    gains: Gains,
    tuning: Tuning,
}

/// A motor with its load under control.
///
/// ```
/// use profidrive_virtual_drive::axis::{Axis, Command, Plant, Ramps, Tuning};
/// let mut axis = Axis::new(Plant::default());
/// let ramps = Ramps { acceleration: 3000.0, deceleration: 3000.0 };
/// for _ in 0..100 {
///     axis.step(0.004, Command::Speed { target: 60.0, ramp: Some(ramps), hold: false }, &Tuning::default());
/// }
/// assert!((axis.speed() - 60.0).abs() < 0.5);
///
/// let target = axis.position() + (10 << 32); // ten revolutions on
/// let command = Command::Position { target, speed: 1000.0, ramps, smooth: false, end_speed: 0.0 };
/// while !axis.trajectory_done() {
///     axis.step(0.004, command, &Tuning::default());
/// }
/// assert_eq!(axis.position_command(), target);
/// ```
#[derive(Debug, Clone)]
// What one step writes and the next one reads shall not lie across two cache lines.
#[repr(align(64))]
pub struct Axis {
    mechanics: Mechanics,
    electrical: Electrical,
    sensors: Sensors,
    loops: Loops,
    /// What is added to the feedback to get the position.
    shift: i64,
    /// What the feedback gives, without the shift.
    seen: Feedback,
    /// Bits of the position that the feedback does not resolve.
    unresolved: i64,
    sto: bool,
    feedback_lost: bool,
    /// Current that flows, A.
    current: f64,
    /// Speed through a 10 Hz filter, rpm.
    filtered: f64,
    /// Speed as the drive measures it, rpm.
    measured: f64,
    noise: u32,
    /// What turns it in place of a servo motor.
    induction: Option<Box<induction::Machine>>,
}

impl Axis {
    /// At rest at position 0.
    #[must_use]
    pub fn new(plant: Plant) -> Self {
        Self {
            mechanics: Mechanics::new(plant),
            electrical: Electrical::new(&plant.power),
            sensors: Sensors::new(&plant),
            loops: Loops::new(),
            shift: 0,
            seen: Feedback {
                position: 0,
                omega: 0.0,
            },
            unresolved: unresolved(&plant),
            sto: false,
            feedback_lost: false,
            current: 0.0,
            filtered: 0.0,
            measured: 0.0,
            noise: 0x2545_F491,
            induction: match &plant.motor {
                Motor::Servo => None,
                Motor::Induction(plate) => Some(Box::new(induction::Machine::new(plate))),
            },
        }
    }

    /// Moves on by `seconds`, in equal steps of at most 1 ms.
    pub fn step(&mut self, seconds: f64, command: Command, tuning: &Tuning) {
        if seconds.is_nan() || seconds <= 0.0 {
            return;
        }
        let steps = ((seconds / LONGEST_STEP).ceil() as usize).clamp(1, MOST_STEPS);
        let mut stride = self.stride(seconds / steps as f64, tuning);
        self.steps_by(&mut stride, command, steps, false);
    }

    /// Prepares steps of `seconds`, at most 1 ms, with these gains and limits: for an axis that gets another command before
    /// each of them.
    #[must_use]
    pub fn stride(&self, seconds: f64, tuning: &Tuning) -> Stride {
        let dt = within(seconds, 0.0, LONGEST_STEP);
        Stride {
            dt,
            gains: Gains::new(
                dt,
                tuning,
                self.mechanics.authority(),
                self.mechanics.reluctance(),
            ),
            tuning: *tuning,
        }
    }

    /// Moves on by up to `most` prepared steps with one command. Returns how many: with `until_done` it ends with the step in
    /// which the reference arrives.
    pub fn steps_by(
        &mut self,
        stride: &mut Stride,
        command: Command,
        most: usize,
        until_done: bool,
    ) -> usize {
        if stride.dt <= 0.0 || most == 0 {
            return most;
        }
        let command = self.aim(command, &stride.tuning);
        // what depends on heat changes over seconds: once for all of these steps is enough
        stride.gains.limit = self.electrical.foldback_limit();
        let mut heat = 0.0;
        let mut done = 0;
        while done < most {
            self.substep(&command, stride);
            heat += self.current * self.current;
            done += 1;
            if until_done && self.trajectory_done() {
                break;
            }
        }
        let (count, tuning) = (done as f64, &stride.tuning);
        self.electrical.warm(
            count * stride.dt,
            heat / count,
            &tuning.drive_endurance,
            &tuning.motor_endurance,
        );
        done
    }

    /// Returns true when no limit switch can change what the axis does: there is none, and none is forced.
    #[must_use]
    pub const fn is_without_switches(&self) -> bool {
        self.sensors.is_free()
    }

    /// Gives the command to the trajectory; returns the one that is in force.
    fn aim(&mut self, command: Command, tuning: &Tuning) -> Command {
        let command = if self.sto { Command::Off } else { command };
        self.loops.aim(&command, tuning);
        command
    }

    fn substep(&mut self, command: &Command, stride: &Stride) {
        let Stride { dt, gains, tuning } = stride;
        let dt = *dt;
        let seen = Feedback {
            position: self.seen.position.wrapping_add(self.shift),
            ..self.seen
        };
        let before = self.mechanics.position;
        let power = if self.induction.is_some() {
            self.turn_induction(dt, command, tuning, gains, seen)
        } else {
            let wanted = self.loops.step(command, gains, seen);
            self.current = if self.electrical.can_drive() { wanted } else { 0.0 };
            let power = self.current * self.mechanics.plant().torque_constant * self.mechanics.omega;
            self.mechanics.step(dt, self.current);
            power - self.mechanics.fed()
        };
        self.sensors.pass(before, self.mechanics.position);
        self.electrical.step(dt, power, self.current * self.current);
        if !self.feedback_lost {
            self.measure(dt);
        }
    }

    /// One step of the induction motor; the power that it takes from the bus without the losses of its stator, W.
    fn turn_induction(
        &mut self,
        dt: f64,
        command: &Command,
        tuning: &Tuning,
        gains: &Gains,
        seen: Feedback,
    ) -> f64 {
        let Some(motor) = self.induction.as_deref_mut() else {
            return 0.0;
        };
        let (dry, resistance) = self.mechanics.resistance();
        let around = induction::Around {
            omega: self.mechanics.omega,
            mobility: self.mechanics.mobility(),
            resistance,
            dry,
            bus: self.electrical.true_bus(),
            limit: self.loops.highest_current(gains),
        };
        let on = self.electrical.can_drive();
        let lead = match *command {
            Command::Speed { target, ramp, hold } => Some((target, ramp, hold)),
            Command::Travel { speed, ramps, .. } => Some((speed, Some(ramps), false)),
            _ => None,
        };
        let torque = match (*command, lead) {
            (_, Some(lead)) if on => {
                if !motor.is_driving() && !tuning.inverter.flying_start {
                    self.loops.hold_back(0.0);
                }
                let reference = self.loops.lead(gains, lead, seen);
                let torque = motor.drive(dt, reference, &around, &tuning.inverter);
                if motor.output().limited {
                    self.loops.hold_back(motor.reference());
                }
                torque
            }
            (Command::DcBrake { current }, _) if on => {
                self.loops.hold_back(0.0);
                motor.brake(dt, current, &around, &tuning.inverter)
            }
            _ => {
                self.loops.follow(seen);
                motor.off(dt, &tuning.inverter);
                0.0
            }
        };
        let output = motor.output();
        let power = output.power;
        self.current = output.current;
        self.mechanics.turn(dt, torque);
        power
    }

    /// A time of any length in which the axis is [at rest](Self::is_at_rest) without command: no current flows, the
    /// references are where the axis is, heat goes, the bus settles.
    pub fn rest(&mut self, seconds: f64, tuning: &Tuning) {
        self.current = 0.0;
        if let Some(motor) = self.induction.as_deref_mut() {
            motor.off(seconds.max(0.0), &tuning.inverter);
        }
        if !self.feedback_lost {
            self.seen = Feedback {
                position: self.mechanics.position & !self.unresolved,
                omega: 0.0,
            };
            self.measured = 0.0;
            self.filtered = 0.0;
        }
        self.loops.follow(Feedback {
            position: self.position(),
            omega: 0.0,
        });
        if seconds > 0.0 {
            self.electrical
                .rest(seconds, &tuning.drive_endurance, &tuning.motor_endurance);
        }
    }

    /// The measured speed has a little noise while the axis turns: the last digits of an encoder.
    fn measure(&mut self, dt: f64) {
        self.seen = Feedback {
            position: self.mechanics.position & !self.unresolved,
            omega: self.mechanics.omega,
        };
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 17;
        self.noise ^= self.noise << 5;
        let noise = if self.mechanics.omega == 0.0 {
            0.0
        } else {
            f64::from(self.noise as i32) / 2_147_483_648.0
        };
        self.measured = self.speed() + 0.06 * noise;
        self.filtered += (self.measured - self.filtered) * (dt * 10.0 * TAU).min(1.0);
        if self.mechanics.omega == 0.0 && self.filtered.abs() < 0.001 {
            self.filtered = 0.0;
        }
    }

    /// Returns true speed in rpm.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.mechanics.omega * RPM
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

    /// Returns the command of the velocity loop, rpm (VL.CMD): output of the ramp generator or of the position loop.
    #[must_use]
    pub const fn speed_command(&self) -> f64 {
        self.loops.speed_command()
    }

    /// Returns the quantities at the motor: frequency, voltage, current, torque, power, thermal load.
    #[must_use]
    pub fn motor_output(&self) -> MotorOutput {
        if let Some(motor) = self.induction.as_deref() {
            return *motor.output();
        }
        let torque = self.current * self.plant().torque_constant;
        MotorOutput {
            current: self.current.abs(),
            torque,
            power: torque * self.mechanics.omega,
            thermal_load: self.electrical.motor_load(),
            ..MotorOutput::default()
        }
    }

    /// Torque-producing current, A (IL.FB); of an induction motor the whole one, without sign.
    #[must_use]
    pub const fn current(&self) -> f64 {
        self.current
    }

    /// Returns the position in 2^-32 revolutions as measured by the drive (PL.FB): feedback plus the shift of the
    /// homing. Wraps.
    #[must_use]
    pub const fn position(&self) -> i64 {
        self.seen.position.wrapping_add(self.shift)
    }

    /// Returns the true position of the shaft in 2^-32 revolutions from where it started; no homing moves it. Wraps.
    #[must_use]
    pub const fn true_position(&self) -> i64 {
        self.mechanics.position
    }

    /// Returns the position of the feedback itself in 2^-32 revolutions (FB1.P): not moved by homing; its low half is the
    /// angle.
    #[must_use]
    pub const fn feedback(&self) -> i64 {
        self.seen.position
    }

    /// Returns the present setpoint of the position loop, 2^-32 rev (PL.CMD); the position itself while that loop is
    /// open.
    #[must_use]
    pub const fn position_command(&self) -> i64 {
        if self.loops.holds_position() {
            self.loops.trajectory.position()
        } else {
            self.position()
        }
    }

    /// Command minus position, 2^-32 rev (PL.ERR); 0 while the position loop is open.
    #[must_use]
    pub const fn following_error(&self) -> i64 {
        self.position_command().wrapping_sub(self.position())
    }

    /// Returns whether the reference has arrived: at the target of [`Command::Position`] (or past it, when it has an
    /// end speed), or at the speed of [`Command::Travel`]. Not when it stopped elsewhere. False while the position loop
    /// is open.
    #[must_use]
    pub const fn trajectory_done(&self) -> bool {
        self.loops.holds_position() && self.loops.trajectory.is_done()
    }

    /// Speed of the reference, rpm; 0 while the position loop is open.
    #[must_use]
    pub const fn trajectory_speed(&self) -> f64 {
        if self.loops.holds_position() {
            self.loops.trajectory.speed()
        } else {
            0.0
        }
    }

    /// Acceleration of the reference, rpm/s; 0 while the position loop is open.
    #[must_use]
    pub const fn trajectory_acceleration(&self) -> f64 {
        if self.loops.holds_position() {
            self.loops.trajectory.acceleration()
        } else {
            0.0
        }
    }

    /// Returns the position where the reference would stand, 2^-32 rev, if [`Command::Travel`] with speed 0 stopped it
    /// from now on with these ramps: to see beforehand whether a movement stays within its limits.
    #[must_use]
    pub fn stopping_position(&self, ramps: Ramps, smooth: bool, tuning: &Tuning) -> i64 {
        self.loops.stopping_position(ramps, smooth, tuning)
    }

    /// Redefines the present position. Nothing moves: the reference and a target that is already set keep their place,
    /// too.
    pub const fn set_position(&mut self, position: i64) {
        self.shift_position(position.wrapping_sub(self.position()));
    }

    /// Takes the reference to where the axis is, at its speed: nothing of a following error or of the current against it
    /// is left for the next command.
    pub fn release(&mut self) {
        self.loops.follow(Feedback {
            position: self.position(),
            ..self.seen
        });
    }

    /// Adds to the number of every place, as [`set_position`](Self::set_position) does. To give the place of a latch a
    /// number, shift by the number minus [`Latch::position`].
    pub const fn shift_position(&mut self, by: i64) {
        self.shift = self.shift.wrapping_add(by);
        self.loops.trajectory.shift(by);
    }

    /// Switches, latches and what else the drive reads from outside.
    #[must_use]
    pub fn inputs(&self) -> Inputs {
        Inputs {
            sto: self.sto,
            feedback_lost: self.feedback_lost,
            brake: self.mechanics.is_braked(),
            ..self.sensors.read(self.mechanics.position, self.shift)
        }
    }

    /// Bus voltage, temperatures and foldback.
    #[must_use]
    pub const fn electrical(&self) -> &Electrical {
        &self.electrical
    }

    /// Motor, load and way.
    #[must_use]
    pub const fn plant(&self) -> &Plant {
        self.mechanics.plant()
    }

    /// Puts the axis, where it is and as it turns, on another motor, load and way.
    pub fn set_plant(&mut self, plant: Plant) {
        self.mechanics.set_plant(plant);
        self.sensors.set_plant(&plant);
        self.electrical.set_stage(&plant.power);
        self.unresolved = unresolved(&plant);
        match (&plant.motor, self.induction.as_deref_mut()) {
            (Motor::Servo, _) => self.induction = None,
            (Motor::Induction(plate), Some(motor)) => motor.set_plate(plate),
            (Motor::Induction(plate), None) => {
                self.induction = Some(Box::new(induction::Machine::new(plate)));
            }
        }
    }

    /// Torque that works against positive rotation, in Nm; takes effect with the next step.
    pub const fn set_load(&mut self, torque: f64) {
        self.mechanics.set_load(torque);
    }

    /// Returns the torque that works against positive rotation, in Nm.
    #[must_use]
    pub const fn load(&self) -> f64 {
        self.mechanics.load()
    }

    /// Holds the shaft fast, or lets it go.
    pub const fn set_blocked(&mut self, blocked: bool) {
        self.mechanics.set_blocked(blocked);
    }

    /// Returns true while something holds the shaft fast.
    #[must_use]
    pub const fn is_blocked(&self) -> bool {
        self.mechanics.is_blocked()
    }

    /// Applies or releases the holding brake; a motor without one has it released.
    pub const fn set_brake(&mut self, applied: bool) {
        self.mechanics.set_brake(applied);
    }

    /// Safe torque off: no current, whatever the command.
    pub const fn set_sto(&mut self, active: bool) {
        self.sto = active;
    }

    /// Removes the feedback (the drive keeps the last value) or restores it.
    pub const fn set_feedback_lost(&mut self, lost: bool) {
        self.feedback_lost = lost;
    }

    /// Makes a limit switch read on or off wherever the axis is; `None` lets it read the way again.
    pub fn set_limit_switch(&mut self, positive: bool, on: Option<bool>) {
        self.sensors.force_limit(positive, on, self.mechanics.position);
    }

    /// Makes the home switch read on or off wherever the axis is; `None` lets it read the way again.
    pub fn set_home_switch(&mut self, on: Option<bool>) {
        self.sensors.force_home(on, self.mechanics.position);
    }

    /// Mains voltage, V: 0 is off, `None` is nominal. The bus follows.
    pub fn set_mains(&mut self, voltage: Option<f64>) {
        self.electrical.set_mains(voltage);
    }

    /// Connects or disconnects the brake resistor: without it braking lifts the bus without limit.
    pub const fn set_regen(&mut self, connected: bool) {
        self.electrical.set_regen(connected);
    }

    /// Makes the drive measure this bus voltage, V; `None` lets it measure the real one.
    pub fn set_bus_voltage(&mut self, voltage: Option<f64>) {
        self.electrical.override_bus(voltage);
    }

    /// Makes the drive measure this motor temperature, degC; `None` lets it measure the real one.
    pub fn set_motor_temperature(&mut self, temperature: Option<f64>) {
        self.electrical.override_motor(temperature);
    }

    /// Makes the drive measure this temperature of the power stage, degC; `None` lets it measure the real one.
    pub fn set_power_stage_temperature(&mut self, temperature: Option<f64>) {
        self.electrical.override_power_stage(temperature);
    }

    /// Returns true when nothing will turn without a command, a load or the release of what holds it.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.mechanics.is_at_rest()
    }

    /// Returns true when the speed is below `threshold` rpm.
    #[must_use]
    pub fn is_standing(&self, threshold: f64) -> bool {
        self.speed().abs() < threshold
    }
}

/// Returns the nearest number in a range; what is not a number is the lowest.
fn within(value: f64, lowest: f64, highest: f64) -> f64 {
    value.max(lowest).min(highest)
}

/// Bits of a position below the resolution of the feedback.
const fn unresolved(plant: &Plant) -> i64 {
    match plant.feedback_bits {
        bits @ 0..32 => (1 << (32 - bits as u32)) - 1,
        _ => 0,
    }
}

#[cfg(test)]
mod induction_tests;
#[cfg(test)]
mod position_tests;
#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
