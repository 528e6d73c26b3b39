//! An induction motor behind an inverter that puts voltage per frequency on it: no feedback, no velocity loop.
//!
//! The output of the ramp generator is the synchronous speed; the rotor falls behind by the slip that its load needs.
//! Torque by slip after Kloss, rotor current by the same circle, magnetising current beside it. The numbers come from the
//! name plate. What a current limit takes away, it takes from the frequency, so that the slip stays where the limit is.
//!
//! Steady state in each step, no electrical transients: those last a few milliseconds, too short to be read over a bus.

use core::f64::consts::TAU;

use super::{RPM, within as sane};

/// Kind of motor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Motor {
    /// A servo motor with feedback, under current, velocity and position loop.
    #[default]
    Servo,
    /// An induction motor under voltage per frequency. It supports [`Command::Speed`](super::Command::Speed),
    /// [`Command::Travel`](super::Command::Travel) and [`Command::DcBrake`](super::Command::DcBrake); with any other
    /// command no current flows.
    Induction(Induction),
}

/// Name plate of an induction motor. What cannot be is taken as the nearest that can.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Induction {
    /// Nominal power at the shaft, W.
    pub power: f64,
    /// Nominal voltage between two lines, V.
    pub voltage: f64,
    /// Nominal frequency, Hz.
    pub frequency: f64,
    /// Nominal current, A.
    pub current: f64,
    /// Nominal speed, rpm.
    pub speed: f64,
    /// Pairs of poles.
    pub pole_pairs: u16,
    /// Current without load, A.
    pub magnetising_current: f64,
    /// Highest torque over nominal torque.
    pub breakdown: f64,
}

impl Induction {
    /// 1.5 kW, 400 V, 50 Hz, 3.4 A, 1420 rpm.
    pub const KW_1_5: Self = Self {
        power: 1500.0,
        voltage: 400.0,
        frequency: 50.0,
        current: 3.4,
        speed: 1420.0,
        pole_pairs: 2,
        magnetising_current: 1.8,
        breakdown: 2.8,
    };

    /// Creates a motor known by its nameplate only: the number of pole pairs follows from the speed, the no-load
    /// current is taken as half the nominal one, the maximum torque as 2.8 times the nominal one.
    #[must_use]
    pub fn from_plate(power: f64, voltage: f64, frequency: f64, current: f64, speed: f64) -> Self {
        let pairs = (60.0 * frequency / speed).floor();
        Self {
            power,
            voltage,
            frequency,
            current,
            speed,
            pole_pairs: if pairs >= 1.0 { pairs.min(100.0) as u16 } else { 1 },
            magnetising_current: 0.5 * current,
            breakdown: 2.8,
        }
    }

    /// Synchronous speed at nominal frequency, rpm.
    #[must_use]
    pub fn synchronous_speed(&self) -> f64 {
        60.0 * self.frequency / f64::from(self.pole_pairs.max(1))
    }

    /// Nominal torque, Nm.
    #[must_use]
    pub fn torque(&self) -> f64 {
        self.power / self.speed * RPM
    }
}

/// How the inverter treats an induction motor, from parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverterTuning {
    /// Part of the slip that is added to the frequency, 0 to 5 (VLT 1-62: 1 is 100 %).
    pub slip_compensation: f64,
    /// Time in which it does so, s (VLT 1-63).
    pub slip_time: f64,
    /// Starts a motor that turns at the speed it has (VLT 1-73); otherwise it starts at 0.
    pub flying_start: bool,
    /// Time constant of the calculated motor temperature, s (ETR).
    pub thermal_time: f64,
}

impl Default for InverterTuning {
    fn default() -> Self {
        Self {
            slip_compensation: 0.0,
            slip_time: 0.1,
            flying_start: false,
            thermal_time: 300.0,
        }
    }
}

/// What goes to the motor now, whatever its kind.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotorOutput {
    /// Output frequency, Hz, with sign; 0 for a servo.
    pub frequency: f64,
    /// Output voltage between two lines, V; 0 for a servo.
    pub voltage: f64,
    /// Current in the motor without sign, A.
    pub current: f64,
    /// Torque, Nm.
    pub torque: f64,
    /// Power that crosses the air gap, W; negative while braking.
    pub power: f64,
    /// Calculated thermal load of the motor, 1 is what it takes for ever (ETR).
    pub thermal_load: f64,
    /// The current limit holds the ramp.
    pub limited: bool,
}

/// Around the motor, in one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around {
    /// Speed of the rotor, rad/s.
    pub omega: f64,
    /// 1 / inertia; 0 while the shaft is blocked.
    pub mobility: f64,
    /// Torque of load and friction against the motion, Nm; of a standing axis the load alone.
    pub resistance: f64,
    /// Friction that holds a standing axis, Nm.
    pub dry: f64,
    /// Bus voltage, V.
    pub bus: f64,
    /// Highest current, A.
    pub limit: f64,
}

/// The motor with what its inverter does.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Machine {
    /// Synchronous speed at nominal frequency, rad/s.
    nominal: f64,
    /// Hz per rad/s
    frequency: f64,
    /// V per rad/s
    volts: f64,
    voltage: f64,
    /// Slip of the highest torque, rad/s, and 1 over it.
    breakdown: f64,
    per_breakdown: f64,
    /// Twice the highest torque, Nm.
    torque: f64,
    /// Rotor current at infinite slip, A: radius of the circle.
    rotor: f64,
    magnetising: f64,
    /// Square of the total current over the circle.
    span: f64,
    per_square: f64,
    /// Slip of the highest torque under direct current, and what times the square of the current is twice that torque.
    brake_slip: f64,
    brake_torque: f64,

    driving: bool,
    /// Synchronous speed now, rad/s.
    synchronous: f64,
    /// Slip compensation now, rad/s.
    compensation: f64,
    thermal_load: f64,
    output: MotorOutput,
}

/// A synchronous speed that no inverter exceeds, rad/s.
const FASTEST: f64 = 10_000.0;

/// Output voltage per bus voltage: a drive gives its mains voltage at nominal load, where the bus has 1.35 times that.
const OUTPUT: f64 = 1.0 / 1.35;

/// A current below this is none, A.
const NO_CURRENT: f64 = 1.0e-6;

impl Machine {
    pub fn new(plate: &Induction) -> Self {
        let mut machine = Self {
            nominal: 0.0,
            frequency: 0.0,
            volts: 0.0,
            voltage: 0.0,
            breakdown: 0.0,
            per_breakdown: 0.0,
            torque: 0.0,
            rotor: 0.0,
            magnetising: 0.0,
            span: 0.0,
            per_square: 0.0,
            brake_slip: 0.0,
            brake_torque: 0.0,
            driving: false,
            synchronous: 0.0,
            compensation: 0.0,
            thermal_load: 0.0,
            output: MotorOutput::default(),
        };
        machine.set_plate(plate);
        machine
    }

    /// Another motor, in the middle of what it does.
    pub fn set_plate(&mut self, plate: &Induction) {
        let pairs = f64::from(plate.pole_pairs.max(1));
        let frequency = sane(plate.frequency, 1.0, 1000.0);
        let current = sane(plate.current, 1.0e-3, 1.0e5);
        self.nominal = TAU * frequency / pairs;
        self.frequency = pairs / TAU;
        self.voltage = sane(plate.voltage, 1.0, 1.0e5);
        self.volts = self.voltage / self.nominal;
        // A slip between 0.1 and 50 percent.
        let speed = sane(plate.speed / RPM, 0.5 * self.nominal, 0.999 * self.nominal);
        let ratio = sane(plate.breakdown, 1.05, 20.0);
        let torque = sane(plate.power, 1.0e-3, 1.0e8) / speed;
        let x = ratio - (ratio * ratio - 1.0).sqrt();
        self.breakdown = (self.nominal - speed) / x;
        self.per_breakdown = 1.0 / self.breakdown;
        self.torque = 2.0 * ratio * torque;
        // The circle through the nominal current: (rotor^2 + 2 rotor magnetising) y + magnetising^2 = current^2.
        self.magnetising = sane(plate.magnetising_current, 0.01 * current, 0.95 * current);
        let y = x * x / (1.0 + x * x);
        self.span = (current * current - self.magnetising * self.magnetising) / y;
        self.rotor = (self.magnetising * self.magnetising + self.span).sqrt() - self.magnetising;
        self.per_square = 1.0 / (current * current);
        // Fed by a current, the field of the rotor is in the way at a much smaller slip.
        let coupling = self.magnetising / (self.rotor + self.magnetising);
        self.brake_slip = self.breakdown * coupling;
        self.brake_torque = self.torque * coupling / (self.magnetising * self.magnetising);
    }

    pub const fn output(&self) -> &MotorOutput {
        &self.output
    }

    /// Returns true when the motor was driven in the last step.
    pub const fn is_driving(&self) -> bool {
        self.driving
    }

    /// Speed that belongs to the frequency without the slip compensation, rad/s.
    pub fn reference(&self) -> f64 {
        self.synchronous - self.compensation
    }

    /// Drives at a synchronous speed of `reference` rad/s; the torque, Nm.
    pub fn drive(&mut self, dt: f64, reference: f64, around: &Around, tuning: &InverterTuning) -> f64 {
        let flux = self.flux(around);
        if flux.is_nan() || flux * self.magnetising <= NO_CURRENT {
            self.off(dt, tuning);
            return 0.0;
        }
        self.driving = true;
        let wanted = (reference + self.compensation).clamp(-FASTEST, FASTEST);
        let mut x = (wanted - around.omega) * self.per_breakdown;
        let highest = around.limit / flux;
        let room = (highest * highest - self.magnetising * self.magnetising) / self.span;
        let mut square = x * x;
        let limited = square > room * (1.0 + square);
        if limited {
            let room = room.max(0.0);
            square = room / (1.0 - room);
            x = square.sqrt().copysign(x);
            self.synchronous = around.omega + x * self.breakdown;
        } else {
            self.synchronous = wanted;
        }
        let inverse = 1.0 / (1.0 + square);
        let full = flux * flux * self.torque;
        let mut torque = full * x * inverse;
        if !limited {
            let slope = full * self.per_breakdown * (1.0 - square) * inverse * inverse;
            torque = settle(torque, slope, dt, around);
            let slip = if around.mobility > 0.0 {
                x * self.breakdown
            } else {
                0.0
            };
            let most = 0.2 * self.nominal;
            let share = sane(tuning.slip_compensation, 0.0, 5.0) * slip.clamp(-most, most);
            self.compensation += (share - self.compensation) * part(dt, tuning.slip_time);
        }
        let current = flux * (self.span * square * inverse + self.magnetising * self.magnetising).sqrt();
        self.output = MotorOutput {
            frequency: self.synchronous * self.frequency,
            voltage: flux * self.volts * self.synchronous.abs(),
            current,
            torque,
            power: torque * self.synchronous,
            thermal_load: 0.0,
            limited,
        };
        self.heat(dt, current, tuning);
        torque
    }

    /// Brakes with direct current of so many ampere; the torque, Nm.
    pub fn brake(&mut self, dt: f64, current: f64, around: &Around, tuning: &InverterTuning) -> f64 {
        let current = current.max(0.0).min(around.limit);
        if current.is_nan() || current <= NO_CURRENT {
            self.off(dt, tuning);
            return 0.0;
        }
        self.driving = true;
        self.synchronous = 0.0;
        self.compensation = 0.0;
        let x = -around.omega / self.brake_slip;
        let inverse = 1.0 / (1.0 + x * x);
        let full = self.brake_torque * current * current;
        let slope = full / self.brake_slip * (1.0 - x * x) * inverse * inverse;
        let torque = settle(full * x * inverse, slope, dt, around);
        self.output = MotorOutput {
            current,
            torque,
            ..MotorOutput::default()
        };
        self.heat(dt, current, tuning);
        torque
    }

    /// No current, for a time of any length.
    pub fn off(&mut self, seconds: f64, tuning: &InverterTuning) {
        self.driving = false;
        self.synchronous = 0.0;
        self.compensation = 0.0;
        self.output = MotorOutput::default();
        self.heat(seconds, 0.0, tuning);
    }

    /// Part of the nominal field that the voltage of this frequency makes, and the current limit allows.
    fn flux(&self, around: &Around) -> f64 {
        let needed = self.volts * self.synchronous.abs();
        let there = self.voltage.min(around.bus * OUTPUT);
        let flux = if needed > there { there / needed } else { 1.0 };
        flux.min(around.limit / self.magnetising)
    }

    /// The motor has its own fan: below half its nominal speed it is cooled worse, down to 40 % at standstill.
    fn heat(&mut self, seconds: f64, current: f64, tuning: &InverterTuning) {
        let lack = (0.5 - self.synchronous.abs() / self.nominal).max(0.0);
        let wanted = current * current * self.per_square * (1.0 + 3.0 * lack);
        self.thermal_load += (wanted - self.thermal_load) * part(seconds, tuning.thermal_time);
        self.output.thermal_load = self.thermal_load;
    }
}

/// Returns the torque at the end of the step: the slip changes while the speed does, however steep the motor and light
/// the load.
fn settle(torque: f64, slope: f64, dt: f64, around: &Around) -> f64 {
    let mut resistance = around.resistance;
    if around.omega == 0.0 {
        let surplus = torque - resistance;
        if surplus.abs() <= around.dry {
            return torque;
        }
        resistance += around.dry.copysign(surplus);
    }
    let stiffness = slope.max(0.0) * dt * around.mobility;
    (torque + stiffness * resistance) / (1.0 + stiffness)
}

/// Part of the way that a first order goes in this time.
fn part(seconds: f64, time: f64) -> f64 {
    if time > seconds { seconds / time } else { 1.0 }
}
