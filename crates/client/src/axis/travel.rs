//! How far an axis may go from where it was.

use profinet::Instant;

use super::Seen;

/// Time from an input to the frame that halts the axis and to its first effect, with room, s.
const ANSWER: f64 = 0.05;
/// Turns between two inputs, beside those of its speed, that no axis makes.
const JUMP: f64 = 0.5;

/// The travel of an axis, both ways from where it was first seen: by the position of its telegram, else by its speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Travel {
    /// The farthest, in turns.
    pub limit: f64,
    /// Turns of one increment of XIST_A.
    pub per_count: f64,
    /// Turns a second of one step of NIST_A; `None` where it is not known.
    pub per_step: Option<f64>,
    /// Ramp of the drive, turns/s²; `None` where it is not known.
    pub deceleration: Option<f64>,
    last: Option<(Instant, Option<i32>)>,
    way: f64,
    speed: f64,
}

impl Travel {
    /// A travel of so many turns.
    #[must_use]
    pub const fn new(limit: f64, per_count: f64, per_step: Option<f64>, deceleration: Option<f64>) -> Self {
        Self {
            limit,
            per_count,
            per_step,
            deceleration,
            last: None,
            way: 0.0,
            speed: 0.0,
        }
    }

    /// Takes the next inputs.
    pub fn see(&mut self, now: Instant, seen: Seen) {
        let last = self.last.replace((now, seen.xist_a));
        let reported = seen.nist_a.zip(self.per_step);
        let reported = reported.map(|(speed, per_step)| f64::from(speed) * per_step);
        let Some((before, position)) = last else {
            self.speed = reported.unwrap_or_default();
            return;
        };
        let time = (now - before).as_secs_f64();
        let turned = seen.xist_a.zip(position).map(|(now, before)| {
            // the count goes round
            f64::from(now.wrapping_sub(before)) * self.per_count
        });
        // homing sets the position anew, which is no way
        let farthest = JUMP + 3.0 * self.speed.abs() * time;
        let turned = turned.filter(|turned| turned.abs() <= farthest);
        self.way += turned.unwrap_or_else(|| reported.unwrap_or_default() * time);
        let measured = turned.filter(|_| time > 0.0).map(|turned| turned / time);
        self.speed = reported.or(measured).unwrap_or(self.speed);
    }

    /// Returns where the axis is from where it was, in turns.
    #[must_use]
    pub const fn way(&self) -> f64 {
        self.way
    }

    /// Returns how far the axis goes on from this speed in turns/s when it is halted along its ramp.
    fn braking(&self, speed: f64) -> f64 {
        let ramp = self
            .deceleration
            .filter(|ramp| *ramp > 0.0)
            .map_or(0.0, |ramp| speed * speed / (2.0 * ramp));
        ramp + speed.abs() * ANSWER
    }

    /// Returns whether the axis must be halted now to stay within.
    #[must_use]
    pub fn ends(&self) -> bool {
        let outward = self.way * self.speed.signum();
        self.speed != 0.0 && outward + self.braking(self.speed) > self.limit
    }

    /// Returns whether the axis may set out at this speed in rpm, and still be halted within.
    #[must_use]
    pub fn permits(&self, rpm: f64) -> bool {
        let speed = rpm / 60.0;
        self.way * speed.signum() + self.braking(speed) <= self.limit
    }

    /// Returns whether a place is within, in turns from where the axis is.
    #[must_use]
    pub fn reaches(&self, turns: f64) -> bool {
        (self.way + turns).abs() <= self.limit
    }
}

#[cfg(test)]
mod tests {
    use core::time::Duration;

    use super::*;

    fn seen(nist_a: Option<i16>, xist_a: Option<i32>) -> Seen {
        Seen {
            nist_a,
            xist_a,
            ..Seen::default()
        }
    }

    /// Goes outward at 2 turns/s with a ramp of 4 turns/s², in steps of 10 ms, until it has to be halted.
    fn way_at_the_end(mut travel: Travel, of: impl Fn(u32) -> Seen) -> f64 {
        let mut now = Instant::ZERO;
        for step in 0..1000 {
            travel.see(now, of(step));
            if travel.ends() {
                return travel.way();
            }
            now += Duration::from_millis(10);
        }
        panic!("it is never halted");
    }

    #[test]
    fn an_axis_is_halted_so_early_that_it_rests_within() {
        // 0.5 turns of braking and 0.1 until it begins
        let travel = Travel::new(3.0, 0.001, Some(0.01), Some(4.0));
        let speed = |_| seen(Some(200), None);
        let position = |step: u32| seen(Some(-200), Some(i32::MIN.wrapping_add(-20 * step.cast_signed())));
        for way in [way_at_the_end(travel, speed), -way_at_the_end(travel, position)] {
            assert!((2.38..2.43).contains(&way), "{way}");
        }
        // without a speed in the telegram, from the positions
        let by_position = way_at_the_end(
            Travel {
                per_step: None,
                ..travel
            },
            position,
        );
        assert!((-2.43..-2.38).contains(&by_position), "{by_position}");
    }

    #[test]
    fn an_axis_at_the_end_goes_back_and_not_on() {
        let mut travel = Travel::new(1.0, 0.001, Some(0.01), Some(4.0));
        travel.see(Instant::ZERO, seen(Some(0), Some(0)));
        travel.see(Instant::from_millis(5), seen(Some(0), Some(495)));
        travel.see(Instant::from_millis(10), seen(Some(0), Some(990)));
        assert!(!travel.ends(), "it stands");
        assert!(!travel.permits(20.0) && travel.permits(-20.0));
        assert!(travel.reaches(0.01) && !travel.reaches(0.02) && travel.reaches(-1.9));
        travel.see(Instant::from_millis(20), seen(Some(-50), Some(985)));
        assert!(!travel.ends(), "it goes back");
        // the position is set anew while it turns slowly
        let way = travel.way();
        travel.see(Instant::from_millis(30), seen(Some(0), Some(0)));
        assert!((travel.way() - way).abs() < 1e-9 && !travel.ends());
    }
}
