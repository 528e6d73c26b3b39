//! The reference of the position loop: where the axis shall be now, on its way to a target or at a speed.
//!
//! A plan is made when the goal changes, from the state of that moment, and then only followed; so it may change at any
//! time, and following costs little. Positions are on a circle of 2^32 revolutions: the way to a target is the shorter one.

use super::profile::{Bounds, Profile, State};
use super::{Ramps, within};

/// 2^-32 revolutions per second of one rpm.
pub(super) const COUNTS: f64 = 4_294_967_296.0 / 60.0;

const RPM_OF_COUNTS: f64 = 1.0 / COUNTS;

/// Highest speed, rpm, and range of the slopes, rpm/s: what is outside is taken as the nearest.
const FASTEST: f64 = 1.0e6;
const FLATTEST: f64 = 1.0e-3;
const STEEPEST: f64 = 1.0e9;

/// Shortest and longest time in which a smooth acceleration builds up, s.
const QUICKEST: f64 = 1.0e-4;
const SLOWEST: f64 = 100.0;

/// After this time at one speed the numbers start afresh, s.
const FRESH: f64 = 1000.0;

/// What the reference shall do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Goal {
    /// Stand where it is.
    Rest,
    /// Go to a position.
    To {
        target: i64,
        /// rpm
        speed: f64,
        /// Speed at the target, rpm.
        end_speed: f64,
    },
    /// Go on at a speed, rpm; 0 stops.
    At { speed: f64 },
}

/// How it shall do it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Manner {
    pub ramps: Ramps,
    /// Time in which the acceleration builds up, s; none: at once.
    pub smoothing: Option<f64>,
    /// Highest speeds in negative and in positive direction, both as positive numbers, rpm.
    pub limits: [f64; 2],
}

impl Manner {
    fn bounds(&self) -> Bounds {
        let slope = |value: f64| within(value, FLATTEST, STEEPEST) * COUNTS;
        let acceleration = slope(self.ramps.acceleration);
        let deceleration = slope(self.ramps.deceleration);
        Bounds {
            acceleration,
            deceleration,
            jerk: self
                .smoothing
                .map(|time| acceleration.max(deceleration) / within(time, QUICKEST, SLOWEST)),
        }
    }

    /// Speed in 2^-32 rev/s into a direction, for a speed setpoint in rpm.
    fn speed(&self, wanted: f64, positive: bool) -> f64 {
        let [negative_limit, positive_limit] = self.limits;
        let limit = if positive { positive_limit } else { negative_limit };
        within(wanted, 0.0, FASTEST).min(within(limit, 0.0, FASTEST)) * COUNTS
    }
}

/// The reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Trajectory {
    /// Whole part of the reference, 2^-32 rev, and what is left below one, towards zero of the plan.
    position: i64,
    fraction: f64,
    /// 2^-32 rev/s and 2^-32 rev/s^2.
    speed: f64,
    acceleration: f64,
    goal: Goal,
    manner: Option<Manner>,
    profile: Profile,
    /// Where the positions of the plan count from.
    origin: i64,
    piece: usize,
    /// Time in the piece, s.
    time: f64,
    /// The target, when the plan ends there at rest.
    arrival: Option<i64>,
    /// Direction in which the target is passed with an end speed, 0 when it is not.
    passing: f64,
    done: bool,
}

impl Trajectory {
    /// At rest at a position.
    pub fn new(position: i64) -> Self {
        Self {
            position,
            fraction: 0.0,
            speed: 0.0,
            acceleration: 0.0,
            goal: Goal::Rest,
            manner: None,
            profile: Profile::default(),
            origin: position,
            piece: 0,
            time: 0.0,
            arrival: None,
            passing: 0.0,
            done: true,
        }
    }

    /// Takes over where the axis is and how fast, in rpm, it goes, so that the next plan starts there without a jump.
    pub const fn place(&mut self, position: i64, speed: f64) {
        self.position = position;
        self.fraction = 0.0;
        self.speed = speed * COUNTS;
        self.acceleration = 0.0;
        self.goal = Goal::Rest;
        self.manner = None;
        self.done = false;
    }

    /// Gives the same place another number: targets that are already set stay where they are.
    pub const fn shift(&mut self, by: i64) {
        self.position = self.position.wrapping_add(by);
        self.origin = self.origin.wrapping_add(by);
        if let Goal::To { target, .. } = &mut self.goal {
            *target = target.wrapping_add(by);
        }
        if let Some(target) = &mut self.arrival {
            *target = target.wrapping_add(by);
        }
    }

    /// Sets the goal; makes a plan when the goal or the manner changed.
    pub fn aim(&mut self, goal: Goal, manner: Manner) {
        if self.goal == goal && self.manner == Some(manner) {
            return;
        }
        // A target that was passed stays passed while it is the same one.
        let passed = self.done
            && self.passing != 0.0
            && matches!((self.goal, goal),
                (Goal::To { target: before, .. }, Goal::To { target, end_speed, .. })
                    if before == target && end_speed > 0.0);
        let bounds = manner.bounds();
        self.acceleration = self.acceleration_for(&bounds);
        let relaxing = self.relaxing(&bounds);
        self.goal = goal;
        self.manner = Some(manner);
        self.restart();
        if let Some(jerk) = relaxing {
            self.profile.relax(jerk);
        }
        self.done = passed;
        match goal {
            Goal::Rest => self.profile.change(0.0, &bounds),
            Goal::At { speed } => {
                let size = manner.speed(speed.abs(), speed > 0.0);
                self.go_on_at(size.copysign(speed), &bounds);
            }
            Goal::To { end_speed, .. } if passed => {
                let size = manner.speed(end_speed, self.passing > 0.0);
                self.go_on_at(size.copysign(self.passing), &bounds);
            }
            Goal::To {
                target,
                speed,
                end_speed,
            } => {
                self.passing = 0.0;
                self.plan(target, speed, end_speed, &bounds);
            }
        }
        self.judge();
    }

    /// Acceleration that a plan with these bounds starts with: what was not smooth goes on from none, and what was steeper
    /// from the steepest that is allowed now.
    fn acceleration_for(&self, bounds: &Bounds) -> f64 {
        let was_smooth = self.manner.is_some_and(|manner| manner.smoothing.is_some());
        if bounds.jerk.is_none() || !was_smooth {
            return 0.0;
        }
        let most = if self.acceleration * self.speed < 0.0 {
            bounds.deceleration
        } else {
            bounds.acceleration
        };
        self.acceleration.clamp(-most, most)
    }

    /// Returns the jerk with which speeding up ends before a plan with these bounds begins, when it began with more
    /// jerk than the plan has: ended more gently, the speed would go beyond what was requested before and is requested
    /// now.
    fn relaxing(&self, bounds: &Bounds) -> Option<f64> {
        let before = self.manner?.bounds().jerk?;
        let speeds_up = self.acceleration * self.speed > 0.0;
        (speeds_up && before > bounds.jerk?).then_some(before)
    }

    /// Returns the position where it would stand if it braked from now on.
    pub fn stopping_position(&self, manner: &Manner) -> i64 {
        let bounds = manner.bounds();
        let mut brake = Profile::new(State {
            position: self.fraction,
            speed: self.speed,
            acceleration: self.acceleration_for(&bounds),
        });
        if let Some(jerk) = self.relaxing(&bounds) {
            brake.relax(jerk);
        }
        brake.change(0.0, &bounds);
        self.position.wrapping_add(brake.end().position as i64)
    }

    /// An empty plan from the present state.
    const fn restart(&mut self) {
        self.origin = self.position;
        self.piece = 0;
        self.time = 0.0;
        self.arrival = None;
        self.profile.restart(State {
            position: self.fraction,
            speed: self.speed,
            acceleration: self.acceleration,
        });
    }

    fn go_on_at(&mut self, speed: f64, bounds: &Bounds) {
        self.profile.change(speed, bounds);
        if speed != 0.0 {
            self.profile.go_on();
        }
    }

    fn plan(&mut self, target: i64, speed: f64, end_speed: f64, bounds: &Bounds) {
        let size = |speed: f64, way: f64| {
            self.manner
                .map_or(0.0, |manner| manner.speed(speed, way > 0.0))
                .copysign(way)
        };
        let way = target.wrapping_sub(self.origin) as f64;
        let start = self.profile.end();
        let mut brake = self.profile;
        brake.change(0.0, bounds);
        let rest = way - brake.end().position;
        let ahead = way - start.position;
        let (top, end) = (size(speed, rest), size(end_speed.min(speed), ahead));
        let there = rest.abs() <= 2.0 + 1.0e-12 * way.abs();
        if end != 0.0 && !(there && start.speed == 0.0) && ahead * start.speed >= 0.0 {
            // Runs through: the target is ahead, and need not be stopped at.
            self.passing = end.signum();
            self.profile.travel(ahead, size(speed, ahead), end, bounds);
            return self.go_on_at(self.profile.end().speed, bounds);
        }
        if top == 0.0 {
            self.profile = brake;
            return;
        }
        if there {
            self.profile = brake;
        } else {
            if rest * start.speed < 0.0 {
                // The target is behind, or too near to stop before it: stop, then go back.
                self.profile = brake;
            }
            let ahead = way - self.profile.end().position;
            let end = size(end_speed.min(speed), ahead);
            self.profile.travel(ahead, top, end, bounds);
            if end != 0.0 {
                self.passing = end.signum();
                return self.go_on_at(self.profile.end().speed, bounds);
            }
        }
        self.arrival = Some(target);
    }

    /// Moves on by `dt` seconds; the mean speed of this time in 2^-32 rev/s.
    pub fn step(&mut self, dt: f64) -> f64 {
        if self.profile.is_over(self.piece) {
            return 0.0;
        }
        let (position, fraction) = (self.position, self.fraction);
        self.time += dt;
        let state = self.profile.follow(&mut self.piece, &mut self.time);
        self.speed = state.speed;
        self.acceleration = state.acceleration;
        let whole = state.position as i64;
        self.position = self.origin.wrapping_add(whole);
        self.fraction = state.position - whole as f64;
        self.judge();
        if self.time > FRESH && self.profile.is_steady(self.piece) {
            self.restart();
            self.profile.go_on();
        }
        (self.position.wrapping_sub(position) as f64 + (self.fraction - fraction)) / dt
    }

    /// Finds out whether it is there; a plan that ends at the target ends there exactly.
    fn judge(&mut self) {
        let over = self.profile.is_over(self.piece);
        if over {
            self.acceleration = 0.0;
            if let Some(target) = self.arrival {
                self.position = target;
                self.fraction = 0.0;
            }
        }
        self.done = match self.goal {
            Goal::Rest => over,
            Goal::At { .. } => self.profile.is_steady(self.piece),
            Goal::To { target, .. } if self.passing != 0.0 => {
                self.done || target.wrapping_sub(self.position) as f64 * self.passing <= 0.0
            }
            Goal::To { .. } => over && self.arrival.is_some(),
        };
    }

    /// Returns the position of the reference, 2^-32 rev.
    pub const fn position(&self) -> i64 {
        self.position
    }

    /// Returns its speed, rpm.
    pub const fn speed(&self) -> f64 {
        self.speed * RPM_OF_COUNTS
    }

    /// Returns its acceleration, rpm/s.
    pub const fn acceleration(&self) -> f64 {
        self.acceleration * RPM_OF_COUNTS
    }

    /// Returns whether the target is reached or passed, or the speed; or it stands as it shall.
    pub const fn is_done(&self) -> bool {
        self.done
    }
}

#[cfg(test)]
mod tests;
