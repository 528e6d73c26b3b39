//! Facts of a drive that matter for a move.

use profile::catalogue::Part;

use super::ModuloRange;

/// Facts of a drive that matter for a move; `None` where it does not report them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotionFacts {
    /// Where the axis is, in turns (XIST_A).
    pub position: Option<f64>,
    /// ZSW1 bit 11: the home position is set.
    pub homed: Option<bool>,
    /// ZSW1 bit 3: a fault waits to be acknowledged.
    pub fault: Option<bool>,
    /// Lower software limit in turns, where it is switched on.
    pub lowest: Option<f64>,
    /// Upper software limit in turns, where it is switched on.
    pub highest: Option<f64>,
    /// The position is reckoned modulo: an absolute target has no end of travel.
    pub modulo: bool,
    /// The range of such an axis, where it is known.
    pub modulo_range: Option<ModuloRange>,
    /// Highest speed in positive direction, rpm.
    pub forward_limit: Option<f64>,
    /// Highest speed in negative direction as a positive number, rpm.
    pub backward_limit: Option<f64>,
    /// What sets the highest speed in positive direction.
    pub forward_by: Option<Part>,
    /// What sets the highest speed in negative direction.
    pub backward_by: Option<Part>,
    /// Share of its speed with which a task runs, in percent; 0 holds it.
    pub feedrate: Option<f64>,
    /// The limit switch at the negative end is hit.
    pub negative_switch: Option<bool>,
    /// The limit switch at the positive end is hit.
    pub positive_switch: Option<bool>,
    /// DRV.ACC in rpm/s.
    pub acceleration: Option<f64>,
    /// DRV.DEC in rpm/s.
    pub deceleration: Option<f64>,
}

impl MotionFacts {
    /// Returns the highest speed in the direction of a speed in rpm, and what sets it.
    #[must_use]
    pub fn speed_limit(&self, speed: f64) -> Option<(f64, Option<Part>)> {
        let (limit, by) = if speed < 0.0 {
            (self.backward_limit, self.backward_by)
        } else {
            (self.forward_limit, self.forward_by)
        };
        limit.map(|limit| (limit, by))
    }

    /// Returns true when the limit switch in the direction of a speed is hit: the drive may not turn.
    ///
    /// ```
    /// use profidrive_client::axis::MotionFacts;
    /// let facts = MotionFacts { positive_switch: Some(true), ..MotionFacts::default() };
    /// assert!(facts.is_at_switch(10.0) && !facts.is_at_switch(-10.0));
    /// ```
    #[must_use]
    pub fn is_at_switch(&self, speed: f64) -> bool {
        let hit = if speed < 0.0 {
            self.negative_switch
        } else {
            self.positive_switch
        };
        hit == Some(true) && speed != 0.0
    }
}
