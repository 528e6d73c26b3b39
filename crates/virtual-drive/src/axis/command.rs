//! Inputs of the axis: commands, and the limits and gains that come from parameters.

use super::electrical::Endurance;
use super::induction::InverterTuning;

/// What the power stage does. A command may change in every step; nothing jumps but what the command lets jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Pulses off: the axis coasts.
    Off,
    /// Velocity loop closed, target through the ramp generator.
    Speed {
        /// Speed setpoint in rpm.
        target: f64,
        /// Ramps in rpm/s, or none: the target applies at once, as fast as the current limit allows.
        ramp: Option<Ramps>,
        /// The ramp generator keeps its present output.
        hold: bool,
    },
    /// Current loop only.
    Current {
        /// Current setpoint in ampere.
        target: f64,
    },
    /// Position loop closed: goes to a position and stays there. The way is planned from the present position, speed and
    /// acceleration of the reference, so target, speed and ramps may change on the fly; a target that is too near to stop
    /// before it is passed and come back to. Speed 0 is an intermediate stop: brakes on the ramp and stays.
    Position {
        /// Where to, in 2^-32 rev. Positions are on a circle of 2^32 revolutions; the way is the shorter one.
        target: i64,
        /// Highest speed, rpm, without sign.
        speed: f64,
        /// Ramps in rpm/s.
        ramps: Ramps,
        /// Jerk-limited: accelerations build up and end within [`Tuning::smoothing`].
        smooth: bool,
        /// Speed in rpm that it has when it passes the target, and keeps behind it until the next target comes; 0 stops
        /// there. Taken as not above `speed`.
        end_speed: f64,
    },
    /// Position loop closed: the reference goes on at a speed, for jogging and searching. Speed 0 brakes on the ramp and
    /// stays, also when a load pulls.
    Travel {
        /// Speed setpoint in rpm, with sign.
        speed: f64,
        /// Ramps in rpm/s.
        ramps: Ramps,
        /// Jerk-limited, as in [`Command::Position`].
        smooth: bool,
    },
    /// Direct current through the motor: brakes an induction motor, of a servo it takes the current away.
    DcBrake {
        /// Current setpoint in ampere.
        current: f64,
    },
}

/// Slopes of the ramp generator and of the trajectory.
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
    /// Proportional gain of the velocity loop, A/(rad/s) (VL.KP).
    pub gain: f64,
    /// Corner frequency of its integral part, Hz (VL.KI).
    pub integral: f64,
    /// Proportional gain of the position loop, (rev/s)/rev (PL.KP). Works up to a third of the bandwidth of the velocity
    /// loop; more is taken as that, so that the loops stay stable.
    pub position_gain: f64,
    /// Corner frequency of its integral part, Hz (PL.KI); works up to a tenth of the bandwidth of the position loop.
    pub position_integral: f64,
    /// Part of the reference speed that goes to the velocity loop past the position loop, 0 to 2 (VL.KVFF).
    pub speed_forward: f64,
    /// Time in which the higher one of acceleration and deceleration builds up in a smooth movement, s: the jerk is that
    /// slope over this time.
    pub smoothing: f64,
    /// What the drive endures (DRV.ICONT, DRV.IPEAK).
    pub drive_endurance: Endurance,
    /// What the motor endures (MOTOR.ICONT, MOTOR.IPEAK, IL.MFOLDD).
    pub motor_endurance: Endurance,
    /// How an induction motor is treated.
    pub inverter: InverterTuning,
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
            position_gain: 100.0,
            position_integral: 0.0,
            speed_forward: 1.0,
            smoothing: 0.05,
            drive_endurance: Endurance {
                continuous: 3.0,
                peak: 9.0,
                time: 5.0,
            },
            motor_endurance: Endurance {
                continuous: 2.79,
                peak: 11.2,
                time: 10.0,
            },
            inverter: InverterTuning::default(),
        }
    }
}
