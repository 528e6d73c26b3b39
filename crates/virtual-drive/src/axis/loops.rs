//! Position and velocity loop: from a command to the current setpoint.

use core::f64::consts::TAU;

use super::command::{Command, Ramps, Tuning};
use super::plant::REVOLUTION;
use super::ramp::Ramp;
use super::trajectory::{Goal, Manner, Trajectory};
use super::{RPM, within};

/// Radian per second of one rpm.
const RADIANS: f64 = TAU / 60.0;

/// Radian of one position count.
const RADIAN: f64 = TAU / REVOLUTION;

/// Speed that no ramp without loops exceeds, rpm.
const FASTEST: f64 = 100_000.0;

/// What the loops read from the feedback.
#[derive(Debug, Clone, Copy)]
pub(super) struct Feedback {
    /// 2^-32 rev
    pub position: i64,
    /// rad/s
    pub omega: f64,
}

/// Gains and limits in the units of the loops, for steps of one length.
#[derive(Debug, Clone)]
pub(super) struct Gains {
    dt: f64,
    /// Steps in a second.
    rate: f64,
    /// A/(rad/s)
    speed: f64,
    /// Part of the error that the integral takes in one step.
    speed_integral: f64,
    /// 1/s
    position: f64,
    /// 1/s
    position_integral: f64,
    forward: f64,
    /// A/(rad/s^2)
    inertia: f64,
    /// A and rad/s, as positive numbers.
    negative_current: f64,
    positive_current: f64,
    /// Current that the foldback allows now, A.
    pub limit: f64,
    negative_speed: f64,
    positive_speed: f64,
}

impl Gains {
    /// `authority` is the acceleration of the axis per current, `reluctance` the current per acceleration.
    pub fn new(dt: f64, tuning: &Tuning, authority: f64, reluctance: f64) -> Self {
        // The gain never makes one step overshoot, whatever the value of the parameter.
        let rate = 1.0 / dt;
        let speed = within(tuning.gain, 0.0, 0.5 * reluctance * rate);
        let position = within(tuning.position_gain, 0.0, speed * authority * (1.0 / 3.0));
        Self {
            dt,
            rate,
            speed,
            speed_integral: within(tuning.integral * TAU, 0.0, 0.1 * rate) * dt,
            position,
            position_integral: within(tuning.position_integral * TAU, 0.0, 0.1 * position),
            forward: within(tuning.speed_forward, 0.0, 2.0),
            inertia: reluctance,
            negative_current: tuning.current_negative.max(0.0),
            positive_current: tuning.current_positive.max(0.0),
            limit: f64::MAX,
            negative_speed: tuning.speed_negative.max(0.0) * RADIANS,
            positive_speed: tuning.speed_positive.max(0.0) * RADIANS,
        }
    }

    fn limit_current(&self, current: f64) -> f64 {
        within(
            current,
            -self.negative_current.min(self.limit),
            self.positive_current.min(self.limit),
        )
    }

    fn limit_speed(&self, speed: f64) -> f64 {
        within(speed, -self.negative_speed, self.positive_speed)
    }
}

/// The loops with their memory.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Loops {
    pub ramp: Ramp,
    pub trajectory: Trajectory,
    /// Integral part of the velocity loop, A.
    integral: f64,
    /// Integral part of the position loop, rad/s.
    position_integral: f64,
    /// Reference speed of the step before, 2^-32 rev/s; none while the position loop is open.
    before: Option<f64>,
    /// What the velocity loop is reported, rpm.
    speed_command: f64,
    /// The current was limited.
    limited: bool,
}

impl Loops {
    pub fn new() -> Self {
        Self {
            ramp: Ramp::default(),
            trajectory: Trajectory::new(0),
            integral: 0.0,
            position_integral: 0.0,
            before: None,
            speed_command: 0.0,
            limited: false,
        }
    }

    /// Returns true while the position loop is closed.
    pub const fn holds_position(&self) -> bool {
        self.before.is_some()
    }

    /// Returns the command of the velocity loop, rpm.
    pub const fn speed_command(&self) -> f64 {
        self.speed_command
    }

    /// Sets the goal of the trajectory, where the command has one.
    pub fn aim(&mut self, command: &Command, tuning: &Tuning) {
        let (goal, ramps, smooth) = match *command {
            Command::Position {
                target,
                speed,
                ramps,
                smooth,
                end_speed,
            } => {
                let goal = Goal::To {
                    target,
                    speed,
                    end_speed,
                };
                (goal, ramps, smooth)
            }
            Command::Travel { speed, ramps, smooth } => (Goal::At { speed }, ramps, smooth),
            _ => return,
        };
        self.trajectory.aim(goal, manner(ramps, smooth, tuning));
    }

    /// Returns the position where the reference would stand if it braked from now on.
    pub fn stopping_position(&self, ramps: Ramps, smooth: bool, tuning: &Tuning) -> i64 {
        self.trajectory.stopping_position(&manner(ramps, smooth, tuning))
    }

    /// Computes one step; returns the current setpoint, A.
    pub fn step(&mut self, command: &Command, gains: &Gains, seen: Feedback) -> f64 {
        match *command {
            Command::Off | Command::DcBrake { .. } => {
                self.follow(seen);
                0.0
            }
            Command::Current { target } => {
                self.follow(seen);
                gains.limit_current(or_nothing(target))
            }
            Command::Speed { target, ramp, hold } => {
                let target = gains.limit_speed(or_nothing(target) / RPM) * RPM;
                let reference = self.ramp.step(gains.dt, target, ramp, hold);
                self.before = None;
                self.trajectory.place(seen.position, reference);
                self.speed_command = reference;
                let reference = reference / RPM;
                let slope = self.ramp.slope() / RPM;
                self.velocity(gains, reference - seen.omega, slope)
            }
            Command::Position { .. } | Command::Travel { .. } => self.position(gains, seen),
        }
    }

    /// One step of the ramp alone, for a motor without loops: the reference in rad/s.
    pub fn lead(
        &mut self,
        gains: &Gains,
        (target, ramp, hold): (f64, Option<Ramps>, bool),
        seen: Feedback,
    ) -> f64 {
        let target = gains.limit_speed(or_nothing(target) / RPM) * RPM;
        let target = within(target, -FASTEST, FASTEST);
        let reference = self.ramp.step(gains.dt, target, ramp, hold);
        self.before = None;
        self.trajectory.place(seen.position, reference);
        self.speed_command = reference;
        reference / RPM
    }

    /// Puts the ramp back to what could be done, rad/s.
    pub fn hold_back(&mut self, reference: f64) {
        self.ramp.follow(reference * RPM);
        self.speed_command = reference * RPM;
    }

    /// Highest current, A.
    pub fn highest_current(&self, gains: &Gains) -> f64 {
        gains.limit_current(f64::MAX)
    }

    /// The loops are open: all references follow the axis.
    pub fn follow(&mut self, seen: Feedback) {
        let speed = seen.omega * RPM;
        self.integral = 0.0;
        self.before = None;
        self.ramp.follow(speed);
        self.trajectory.place(seen.position, speed);
        self.speed_command = speed;
    }

    fn position(&mut self, gains: &Gains, seen: Feedback) -> f64 {
        let error = self.trajectory.position().wrapping_sub(seen.position) as f64 * RADIAN;
        let before = match self.before {
            Some(before) => before,
            None => {
                self.position_integral = 0.0;
                self.trajectory.speed() / RPM / RADIAN
            }
        };
        let reference = self.trajectory.step(gains.dt);
        self.before = Some(reference);
        let forward = gains.forward * RADIAN;
        let slope = (reference - before) * forward * gains.rate;
        let correction = gains.position * error;
        let wanted = before * forward + correction + self.position_integral;
        let command = gains.limit_speed(wanted);
        if gains.position_integral > 0.0 && command == wanted && !self.limited {
            self.position_integral =
                gains.limit_speed(self.position_integral + correction * gains.position_integral * gains.dt);
        }
        self.ramp.follow(self.trajectory.speed());
        self.speed_command = command * RPM;
        self.velocity(gains, command - seen.omega, slope)
    }

    /// Velocity loop with feed forward of the slope, rad/s^2.
    fn velocity(&mut self, gains: &Gains, error: f64, slope: f64) -> f64 {
        let wanted = gains.speed * error + self.integral + slope * gains.inertia;
        let current = gains.limit_current(wanted);
        self.limited = wanted != current;
        // The integral part stands still while the current is limited in its direction.
        if !self.limited || (wanted > current) != (error > 0.0) {
            self.integral += gains.speed * error * gains.speed_integral;
        }
        current
    }
}

fn manner(ramps: Ramps, smooth: bool, tuning: &Tuning) -> Manner {
    Manner {
        ramps,
        smoothing: smooth.then_some(tuning.smoothing),
        limits: [tuning.speed_negative, tuning.speed_positive],
    }
}

/// Replaces a value that is not a number by 0.
const fn or_nothing(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value }
}
