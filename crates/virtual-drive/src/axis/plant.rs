//! The motor with its load: what turns, and what stands in its way.

use core::f64::consts::TAU;

use super::electrical::PowerStage;
use super::induction::{Induction, Motor};

/// Position counts of one revolution inside the axis.
pub(super) const REVOLUTION: f64 = 4_294_967_296.0;

/// What no shaft exceeds, whatever pulls at it, rad/s: 100,000 rpm.
const FASTEST: f64 = 100_000.0 / 60.0 * TAU;

/// Highest voltage between two lines over the torque constant (Nm per ampere, effective) and the speed of a synchronous motor:
/// sqrt(2/3).
const LINE_VOLTAGE: f64 = 0.816_496_580_927_726;

/// Highest safe speed of a cage motor over its synchronous speed: 3600 rpm with four poles at 50 Hz, 2400 rpm with six, as IEC
/// 60034-1 has them for small ones.
const SAFE: f64 = 2.4;

/// What brakes a shaft that a load turns faster than its motor is made for, whether the power stage is on or off.
///
/// A servo motor induces more voltage then than the DC link has: the diodes of the power stage rectify it, and the brake resistor
/// takes the power. A cage motor induces nothing without current; its fan and its bearings brake it, with the nominal torque at
/// 10 % above its highest safe speed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Overspeed {
    /// Where it begins, rad/s.
    from: f64,
    /// What it grows by, Nm/(rad/s).
    slope: f64,
    /// Whether the power goes to the DC link.
    generates: bool,
}

impl Overspeed {
    fn of(plant: &Plant) -> Self {
        match &plant.motor {
            Motor::Servo => {
                let torque_constant = positive(plant.torque_constant, 1.0e-6);
                Self {
                    from: plant.power.chopper.max(0.0) / (LINE_VOLTAGE * torque_constant),
                    slope: torque_constant * torque_constant / positive(plant.power.loss, 1.0e-3),
                    generates: true,
                }
            }
            Motor::Induction(plate) => {
                let synchronous = TAU * plate.frequency.max(0.0) / f64::from(plate.pole_pairs.max(1));
                let nominal = plate.power.max(0.0) / positive(plate.speed / 60.0 * TAU, 1.0);
                let from = SAFE * synchronous;
                Self {
                    from,
                    slope: nominal / positive(0.1 * from, 1.0),
                    generates: false,
                }
            }
        }
    }
}

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
    pub cogging_periods: u32,
    /// Torque that the holding brake adds to the friction, Nm.
    pub brake_torque: f64,
    /// Bits in which the feedback resolves one revolution, at most 32.
    pub feedback_bits: u8,
    /// Angle of the index pulse, 2^-32 rev.
    pub index: u32,
    /// What limits the way; none: it turns without end.
    pub travel: Option<Travel>,
    /// Kind of motor. For an induction motor `torque_constant` does not count.
    pub motor: Motor,
    /// What feeds it.
    pub power: PowerStage,
}

/// The places along the way, in 2^-32 rev from where the axis stands when the drive is made. Homing does not move them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Travel {
    /// Nothing gets below.
    pub negative_stop: i64,
    /// Nothing gets above.
    pub positive_stop: i64,
    /// The negative limit switch is on at this place and below.
    pub negative_switch: i64,
    /// The positive limit switch is on at this place and above.
    pub positive_switch: i64,
    /// The home switch is on from the first to the second place.
    pub home_switch: Option<(i64, i64)>,
}

impl Travel {
    /// No stop and no switch: what a travel starts with that has only some of them.
    pub const FREE: Self = Self {
        negative_stop: i64::MIN,
        positive_stop: i64::MAX,
        negative_switch: i64::MIN,
        positive_switch: i64::MAX,
        home_switch: None,
    };
}

impl Default for Travel {
    fn default() -> Self {
        Self::FREE
    }
}

impl Default for Plant {
    fn default() -> Self {
        Self::SERVO
    }
}

impl Plant {
    /// A small servo motor (MOTOR.INERTIA 1.2 kgcm^2, MOTOR.KT 0.85 Nm/A) with a disc of twice its inertia.
    pub const SERVO: Self = Self {
        motor_inertia: 1.2e-4,
        load_inertia: 2.4e-4,
        torque_constant: 0.85,
        viscous_friction: 1.0e-4,
        coulomb_friction: 0.05,
        cogging: 0.003,
        cogging_periods: 30,
        brake_torque: 5.0,
        feedback_bits: 24,
        index: 0,
        travel: None,
        motor: Motor::Servo,
        power: PowerStage::SERVO,
    };

    /// An induction motor of 1.5 kW on 400 V with a load of three times its inertia, as a small pump has.
    pub const INDUCTION: Self = Self {
        motor_inertia: 3.4e-3,
        load_inertia: 1.0e-2,
        torque_constant: 3.0,
        viscous_friction: 5.0e-4,
        coulomb_friction: 0.1,
        cogging: 0.0,
        cogging_periods: 0,
        brake_torque: 20.0,
        feedback_bits: 24,
        index: 0,
        travel: None,
        motor: Motor::Induction(Induction::KW_1_5),
        power: PowerStage::VOLT_400,
    };

    /// Inertia of rotor and load, kg m^2; never nothing.
    #[must_use]
    pub fn inertia(&self) -> f64 {
        positive(self.motor_inertia + self.load_inertia, 1.0e-9)
    }
}

/// Returns the number, or what is taken when it is none or too small to divide by.
fn positive(value: f64, smallest: f64) -> f64 {
    if value.is_finite() {
        value.max(smallest)
    } else {
        smallest
    }
}

/// The plant in motion.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mechanics {
    plant: Plant,
    travel: Travel,
    /// 1 / inertia; rad/s^2 per ampere, and the other way round.
    mobility: f64,
    authority: f64,
    reluctance: f64,
    /// rad/s
    pub omega: f64,
    /// True position in 2^-32 rev, and what is lost below one count.
    pub position: i64,
    remainder: f64,
    /// Torque of the load against positive rotation, Nm.
    load: f64,
    blocked: bool,
    braked: bool,
    overspeed: Overspeed,
    /// Power that overspeed feeds into the DC link, W.
    fed: f64,
}

impl Mechanics {
    pub fn new(plant: Plant) -> Self {
        let mut mechanics = Self {
            plant,
            travel: Travel::FREE,
            mobility: 0.0,
            authority: 0.0,
            reluctance: 0.0,
            omega: 0.0,
            position: 0,
            remainder: 0.0,
            load: 0.0,
            blocked: false,
            braked: false,
            overspeed: Overspeed::of(&plant),
            fed: 0.0,
        };
        mechanics.set_plant(plant);
        mechanics
    }

    pub const fn plant(&self) -> &Plant {
        &self.plant
    }

    pub fn set_plant(&mut self, plant: Plant) {
        self.mobility = 1.0 / plant.inertia();
        self.authority = positive(plant.torque_constant, 1.0e-6) * self.mobility;
        self.reluctance = 1.0 / self.authority;
        self.travel = plant.travel.unwrap_or_default();
        self.overspeed = Overspeed::of(&plant);
        self.plant = plant;
    }

    /// Acceleration per current, rad/s^2/A.
    pub const fn authority(&self) -> f64 {
        self.authority
    }

    /// Current per acceleration, A/(rad/s^2).
    pub const fn reluctance(&self) -> f64 {
        self.reluctance
    }

    pub const fn set_load(&mut self, torque: f64) {
        self.load = if torque.is_finite() { torque } else { 0.0 };
    }

    pub const fn load(&self) -> f64 {
        self.load
    }

    pub const fn set_blocked(&mut self, blocked: bool) {
        self.blocked = blocked;
    }

    pub const fn is_blocked(&self) -> bool {
        self.blocked
    }

    pub const fn set_brake(&mut self, applied: bool) {
        self.braked = applied;
    }

    pub const fn is_braked(&self) -> bool {
        self.braked
    }

    /// Friction that does not depend on the speed, Nm.
    fn dry_friction(&self) -> f64 {
        if self.braked {
            self.plant.coulomb_friction + self.plant.brake_torque
        } else {
            self.plant.coulomb_friction
        }
    }

    /// Nothing moves it while there is no torque from the motor.
    pub fn is_at_rest(&self) -> bool {
        self.omega == 0.0
            && (self.load.abs() <= self.dry_friction()
                || self.blocked
                || (self.load < 0.0 && self.position >= self.travel.positive_stop)
                || (self.load > 0.0 && self.position <= self.travel.negative_stop))
    }

    /// 1 / inertia; 0 while the shaft is blocked.
    pub const fn mobility(&self) -> f64 {
        if self.blocked { 0.0 } else { self.mobility }
    }

    /// Friction that holds a standing axis, Nm, and the torque that load and friction put against the motion.
    pub fn resistance(&self) -> (f64, f64) {
        let dry = self.dry_friction();
        let against = if self.omega == 0.0 {
            self.load
        } else {
            self.load + dry.copysign(self.omega) + self.plant.viscous_friction * self.omega
        };
        (dry, against)
    }

    /// One step with this current, A.
    pub fn step(&mut self, dt: f64, current: f64) {
        self.turn(dt, current * self.plant.torque_constant);
    }

    /// One step with this torque of the motor, Nm.
    pub fn turn(&mut self, dt: f64, torque: f64) {
        self.fed = 0.0;
        if self.blocked {
            self.omega = 0.0;
            return;
        }
        let torque = torque - self.load;
        let next = self.next_speed(torque, dt);
        self.omega = self.slowed(next, dt).clamp(-FASTEST, FASTEST);
        let counts = self.omega * (dt * (REVOLUTION / TAU)) + self.remainder;
        let whole = counts as i64;
        self.remainder = counts - whole as f64;
        let next = self.position.wrapping_add(whole);
        // A hard stop takes all speed.
        let stop = if self.omega > 0.0 {
            (next > self.travel.positive_stop).then(|| self.travel.positive_stop.max(self.position))
        } else {
            (next < self.travel.negative_stop).then(|| self.travel.negative_stop.min(self.position))
        };
        self.position = next;
        if let Some(stop) = stop {
            self.position = stop;
            self.remainder = 0.0;
            self.omega = 0.0;
        }
    }

    /// Nothing brakes the shaft at overspeed.
    #[cfg(test)]
    pub const fn forget_overspeed(&mut self) {
        self.overspeed.from = f64::INFINITY;
    }

    /// Power that a shaft at overspeed feeds into the DC link, W.
    pub const fn fed(&self) -> f64 {
        self.fed
    }

    /// Speed in rad/s after what brakes a shaft at [`Overspeed`] for `dt` seconds.
    fn slowed(&mut self, omega: f64, dt: f64) -> f64 {
        let Overspeed {
            from,
            slope,
            generates,
        } = self.overspeed;
        let excess = omega.abs() - from;
        if excess <= 0.0 {
            return omega;
        }
        // by the speed at the end of the step: it never brakes below where it begins
        let left = excess / (1.0 + slope * self.mobility * dt);
        if generates {
            self.fed = slope * left * from;
        }
        (from + left).copysign(omega)
    }

    /// Speed in rad/s after `dt` seconds with `torque` Nm from motor and load.
    fn next_speed(&self, torque: f64, dt: f64) -> f64 {
        let dry = self.dry_friction();
        if self.omega == 0.0 {
            // Friction holds the axis until something is stronger.
            if torque.abs() <= dry {
                return 0.0;
            }
            return (torque - dry.copysign(torque)) * self.mobility * dt;
        }
        let torque = torque + self.plant.cogging * self.cogging();
        let friction = dry.copysign(self.omega) + self.plant.viscous_friction * self.omega;
        let next = self.omega + (torque - friction) * self.mobility * dt;
        // Friction can stop the axis, not turn it round.
        let stops = next * self.omega <= 0.0 && torque.abs() <= dry;
        if stops { 0.0 } else { next }
    }

    /// Returns a wave of amplitude 1 that repeats `cogging_periods` times in a revolution: two parabolas, as good as a
    /// sine here.
    fn cogging(&self) -> f64 {
        let phase = (self.position as u32).wrapping_mul(self.plant.cogging_periods) as i32;
        let phase = f64::from(phase) * (1.0 / 2_147_483_648.0);
        4.0 * phase * (1.0 - phase.abs())
    }
}
