//! The ramp generator.

use super::Ramps;

/// Leads the speed from where it is to where it shall be, in rpm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ramp {
    output: f64,
    /// Slope of the last step in rpm/s, for feed forward; 0 when the target was taken at once.
    slope: f64,
}

impl Ramp {
    /// One step of `dt` seconds towards `target`: acceleration applies away from standstill, deceleration towards it,
    /// and a change of direction goes through standstill.
    pub fn step(&mut self, dt: f64, target: f64, ramps: Option<Ramps>, hold: bool) -> f64 {
        let before = self.output;
        self.slope = 0.0;
        if hold {
            return before;
        }
        let Some(ramps) = ramps else {
            self.output = target;
            return target;
        };
        let mut time = dt;
        // Towards standstill first, when the target lies nearer to it or on its other side.
        let floor = if target * self.output > 0.0 {
            target.abs().min(self.output.abs())
        } else {
            0.0
        };
        let surplus = self.output.abs() - floor;
        if surplus > 0.0 {
            let down = ramps.deceleration.max(0.0) * time;
            if down < surplus {
                self.output -= down.copysign(self.output);
                self.slope = (self.output - before) / dt;
                return self.output;
            }
            self.output = floor.copysign(self.output);
            time -= surplus / ramps.deceleration.max(f64::MIN_POSITIVE);
        }
        let missing = target - self.output;
        let up = ramps.acceleration.max(0.0) * time.max(0.0);
        self.output += missing.clamp(-up, up);
        self.slope = (self.output - before) / dt;
        self.output
    }

    /// Takes over a speed, so that the next step starts there without a jump.
    pub const fn follow(&mut self, speed: f64) {
        self.output = speed;
        self.slope = 0.0;
    }

    /// Present output, rpm.
    #[must_use]
    pub const fn output(&self) -> f64 {
        self.output
    }

    /// Slope of the last step, rpm/s.
    #[must_use]
    pub const fn slope(&self) -> f64 {
        self.slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAMPS: Option<Ramps> = Some(Ramps {
        acceleration: 1000.0,
        deceleration: 500.0,
    });

    #[test]
    fn accelerates_and_decelerates_on_its_own_slopes() {
        let mut ramp = Ramp::default();
        for _ in 0..99 {
            ramp.step(0.001, 100.0, RAMPS, false);
        }
        assert!((ramp.output() - 99.0).abs() < 1e-9);
        assert!((ramp.slope() - 1000.0).abs() < 1e-6);
        ramp.step(0.005, 100.0, RAMPS, false);
        assert_eq!(ramp.output(), 100.0);
        ramp.step(0.1, 20.0, RAMPS, false);
        assert!((ramp.output() - 50.0).abs() < 1e-9);
        ramp.step(1.0, 20.0, RAMPS, false);
        assert_eq!(ramp.output(), 20.0);
    }

    #[test]
    fn a_change_of_direction_brakes_first() {
        let mut ramp = Ramp::default();
        ramp.follow(50.0);
        ramp.step(0.1, -100.0, RAMPS, false);
        assert!(ramp.output().abs() < 1e-9);
        ramp.step(0.05, -100.0, RAMPS, false);
        assert!((ramp.output() + 50.0).abs() < 1e-9);
        ramp.follow(25.0);
        ramp.step(0.1, -100.0, RAMPS, false); // 50 ms down, 50 ms up
        assert!((ramp.output() + 50.0).abs() < 1e-9);
    }

    #[test]
    fn hold_and_zero_slopes_keep_the_output() {
        let mut ramp = Ramp::default();
        ramp.follow(30.0);
        assert_eq!(ramp.step(1.0, 100.0, RAMPS, true), 30.0);
        let none = Some(Ramps {
            acceleration: 0.0,
            deceleration: 0.0,
        });
        assert_eq!(ramp.step(1.0, 100.0, none, false), 30.0);
        assert_eq!(ramp.step(1.0, -100.0, none, false), 30.0);
        assert_eq!(ramp.step(1.0, -100.0, None, false), -100.0);
    }
}
