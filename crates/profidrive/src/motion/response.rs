//! How an axis answers a step of its speed, in figures.

use serde::Serialize;

/// What was commanded and what the axis did at one moment. Times are in seconds, speeds in one unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepPoint {
    /// Time.
    pub time: f64,
    /// Speed that was commanded.
    pub set: f64,
    /// Speed of the motor.
    pub actual: f64,
}

/// The answer of an axis to a step of its speed. Times are in seconds from the step. What was not reached is null.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Response {
    /// From 10 % to 90 % of the step.
    pub rise_time: Option<f64>,
    /// How far the speed went beyond the new one, in percent of the step.
    pub overshoot: f64,
    /// From when on the speed stayed within the band around the new one.
    pub settling_time: Option<f64>,
    /// The band, in percent of the step to either side.
    pub band: f64,
    /// Greatest difference between commanded speed and speed after the step.
    pub following_error: f64,
    /// Mean difference between commanded speed and speed in the last fifth of the time.
    pub steady_error: f64,
}

impl Response {
    /// Returns the figures of a step from one speed to another. `points` begin with the step and are in the order of time;
    /// `band` is a share of the step, 0.02 for 2 %. Between two points the speed is taken as a straight line. `None` where there
    /// is no step or no point.
    ///
    /// ```
    /// use profidrive::motion::{Response, StepPoint};
    /// let point = |time: f64| StepPoint { time, set: 100.0, actual: 100.0 * (1.0 - (-time / 0.1).exp()) };
    /// let points: Vec<_> = (0..1000).map(|at| point(f64::from(at) * 0.001)).collect();
    /// let response = Response::of(&points, 0.0, 100.0, 0.02).unwrap();
    /// // ln 9 and ln 50 time constants
    /// assert!((response.rise_time.unwrap() - 0.2197).abs() < 0.001);
    /// assert!((response.settling_time.unwrap() - 0.3912).abs() < 0.002);
    /// assert_eq!(response.overshoot, 0.0);
    /// ```
    #[must_use]
    pub fn of(points: &[StepPoint], from: f64, to: f64, band: f64) -> Option<Self> {
        let first = points.first()?;
        let height = to - from;
        if height == 0.0 || !height.is_finite() {
            return None;
        }
        let share = |point: &StepPoint| (point.actual - from) / height;
        let crossing = |level: f64| {
            if share(first) >= level {
                return Some(first.time);
            }
            let pair = points
                .windows(2)
                .find(|pair| pair.iter().any(|point| share(point) >= level))?;
            let [before, after] = pair else { return None };
            let part = (level - share(before)) / (share(after) - share(before));
            Some(before.time + part * (after.time - before.time))
        };
        let rise_time = crossing(0.1).zip(crossing(0.9)).map(|(low, high)| high - low);
        let highest = points.iter().map(share).fold(f64::MIN, f64::max);
        let outside = |point: &StepPoint| (share(point) - 1.0).abs() > band;
        let settled = match points.iter().rposition(outside) {
            None => Some(first.time),
            Some(last) => points.get(last + 1).map(|point| point.time),
        };
        let error = |point: &StepPoint| point.set - point.actual;
        let last = points
            .get(points.len() - points.len().div_ceil(5)..)
            .unwrap_or_default();
        #[expect(clippy::cast_precision_loss, reason = "a number of points")]
        let count = last.len().max(1) as f64;
        Some(Self {
            rise_time,
            overshoot: ((highest - 1.0) * 100.0).max(0.0),
            settling_time: settled.map(|time| time - first.time),
            band: band * 100.0,
            following_error: points.iter().map(|point| error(point).abs()).fold(0.0, f64::max),
            steady_error: last.iter().map(error).sum::<f64>() / count,
        })
    }
}

/// Returns where a step begins among points: where the commanded speed changes for the last time.
#[must_use]
pub fn step_in(points: &[StepPoint]) -> Option<usize> {
    let to = points.last()?.set;
    let before = points.iter().rposition(|point| (point.set - to).abs() > 1e-9)?;
    Some(before + 1)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn points(end: f64, to: f64, from: f64, answer: impl Fn(f64) -> f64) -> Vec<StepPoint> {
        let count = 20_000;
        (0..count)
            .map(|at| {
                let time = end * f64::from(at) / f64::from(count);
                let actual = from + (to - from) * answer(time);
                StepPoint {
                    time,
                    set: to,
                    actual,
                }
            })
            .collect()
    }

    proptest! {
        /// A first-order lag: no overshoot, ln 9 time constants from 10 % to 90 %.
        #[test]
        fn first_order(tau in 0.001..10.0_f64, from in -3000.0..3000.0_f64, height in 1.0..3000.0_f64, down: bool) {
            let to = if down { from - height } else { from + height };
            let points = points(tau * 10.0, to, from, |time| 1.0 - (-time / tau).exp());
            let response = Response::of(&points, from, to, 0.02).unwrap();
            prop_assert!((response.rise_time.unwrap() / tau - 9.0_f64.ln()).abs() < 0.01);
            prop_assert!((response.settling_time.unwrap() / tau - 50.0_f64.ln()).abs() < 0.01);
            prop_assert!(response.overshoot < 1e-6);
            prop_assert!((response.following_error / height - 1.0).abs() < 1e-9);
            prop_assert!(response.steady_error.abs() / height < 0.001);
        }

        /// A damped oscillation: the overshoot follows from the damping alone.
        #[test]
        fn second_order(damping in 0.1..0.9_f64, omega in 1.0..1000.0_f64, height in -3000.0..-1.0_f64) {
            let root = (1.0 - damping * damping).sqrt();
            let answer = |time: f64| {
                let phase = omega * root * time;
                1.0 - (-damping * omega * time).exp() * (phase.cos() + damping / root * phase.sin())
            };
            let points = points(20.0 / (damping * omega), height, 0.0, answer);
            let response = Response::of(&points, 0.0, height, 0.05).unwrap();
            let overshoot = 100.0 * (-std::f64::consts::PI * damping / root).exp();
            prop_assert!((response.overshoot - overshoot).abs() < 0.1, "{response:?} {overshoot}");
            // the envelope bounds the settling time
            let envelope = (0.05 * root).ln() / (-damping * omega);
            prop_assert!(response.settling_time.unwrap() <= envelope * 1.01);
        }

        /// Any numbers: figures or none, and no panic.
        #[test]
        fn any_points(values in proptest::collection::vec((any::<f64>(), any::<f64>(), any::<f64>()), 0..20), to: f64) {
            let points: Vec<_> = values.iter().map(|&(time, set, actual)| StepPoint { time, set, actual }).collect();
            let _ = Response::of(&points, 0.0, to, 0.02);
            let _ = step_in(&points);
        }
    }

    #[test]
    fn what_is_not_reached_has_no_time() {
        let points = points(1.0, 100.0, 0.0, |_| 0.5);
        let response = Response::of(&points, 0.0, 100.0, 0.02).unwrap();
        assert_eq!((response.rise_time, response.settling_time), (None, None));
        assert_eq!(response.steady_error, 50.0);
        assert_eq!(Response::of(&points, 100.0, 100.0, 0.02), None);
    }

    #[test]
    fn the_last_change_is_the_step() {
        let set = |set| StepPoint {
            time: 0.0,
            set,
            actual: 0.0,
        };
        assert_eq!(
            step_in(&[set(0.0), set(50.0), set(0.0), set(60.0), set(60.0)]),
            Some(3)
        );
        assert_eq!(step_in(&[set(0.0), set(0.0)]), None);
    }
}
