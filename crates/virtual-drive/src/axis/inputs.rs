//! Position inputs of the drive: limit switches, home switch, index pulse.

use super::plant::{Plant, Travel};

/// Inputs of the axis, as the drive reads them now.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Inputs {
    /// The negative limit switch is reached.
    pub limit_negative: bool,
    /// The positive limit switch is reached.
    pub limit_positive: bool,
    /// The axis is on the home switch.
    pub home_switch: bool,
    /// Torque is switched off safely.
    pub sto: bool,
    /// The feedback reads nothing new.
    pub feedback_lost: bool,
    /// The holding brake is applied.
    pub brake: bool,
    /// The last index pulse.
    pub index: Latch,
    /// The last time that the home switch came or went.
    pub home_edge: Latch,
    /// The last time that the negative limit switch came or went.
    pub negative_edge: Latch,
    /// The last time that the positive limit switch came or went.
    pub positive_edge: Latch,
}

/// Where something happened last, and how often it did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Latch {
    /// Place in 2^-32 rev, in the numbers of [`Axis::position`](super::Axis::position).
    pub position: i64,
    /// How often it happened since the start; wraps. A change means that `position` is new.
    pub count: u32,
}

impl Latch {
    const fn take(&mut self, position: i64) {
        self.position = position;
        self.count = self.count.wrapping_add(1);
    }
}

/// The switches and latches, in the numbers of the plant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sensors {
    /// Switches are on from their first to their last place, if there is one.
    negative: Switch,
    positive: Switch,
    home: Switch,
    index_angle: u32,
    index: Latch,
    /// Nothing but the index can come.
    free: bool,
}

/// A switch along the way.
#[derive(Debug, Clone, PartialEq)]
struct Switch {
    from: i64,
    to: i64,
    forced: Option<bool>,
    edge: Latch,
}

impl Switch {
    const fn new(from: i64, to: i64) -> Self {
        Self {
            from,
            to,
            forced: None,
            edge: Latch {
                position: 0,
                count: 0,
            },
        }
    }

    fn is_on(&self, position: i64) -> bool {
        self.forced
            .unwrap_or(position >= self.from && position <= self.to)
    }

    /// Keeps the place of the last edge between two positions.
    fn pass(&mut self, before: i64, after: i64) {
        if self.forced.is_some() || self.from > self.to {
            return;
        }
        // It comes at `from` and has gone behind `to`.
        let first = (before < self.from) != (after < self.from);
        let second = (before <= self.to) != (after <= self.to);
        let edges = if after > before {
            [(first, self.from), (second, self.to)]
        } else {
            [(second, self.to), (first, self.from)]
        };
        for (_, place) in edges.into_iter().filter(|(crossed, _)| *crossed) {
            self.edge.take(place);
        }
    }

    fn force(&mut self, on: Option<bool>, position: i64) {
        let before = self.is_on(position);
        self.forced = on;
        if self.is_on(position) != before {
            self.edge.take(position);
        }
    }
}

impl Sensors {
    pub fn new(plant: &Plant) -> Self {
        let mut sensors = Self {
            negative: Switch::new(1, 0),
            positive: Switch::new(1, 0),
            home: Switch::new(1, 0),
            index_angle: 0,
            index: Latch::default(),
            free: true,
        };
        sensors.set_plant(plant);
        sensors
    }

    pub fn set_plant(&mut self, plant: &Plant) {
        let travel = plant.travel.unwrap_or_default();
        let (home_from, home_to) = travel.home_switch.unwrap_or((1, 0));
        // The ends of the numbers are not places: no switch is there.
        let none = (1, 0);
        let range = |there: bool, range: (i64, i64)| if there { range } else { none };
        let negative = range(
            travel.negative_switch != i64::MIN,
            (i64::MIN, travel.negative_switch),
        );
        let positive = range(
            travel.positive_switch != i64::MAX,
            (travel.positive_switch, i64::MAX),
        );
        for (switch, (from, to)) in [
            (&mut self.negative, negative),
            (&mut self.positive, positive),
            (&mut self.home, (home_from, home_to)),
        ] {
            (switch.from, switch.to) = (from, to);
        }
        self.index_angle = plant.index;
        self.free = travel
            == Travel {
                negative_stop: travel.negative_stop,
                positive_stop: travel.positive_stop,
                ..Travel::FREE
            };
    }

    /// The axis went from one place to another, not more than a few revolutions.
    pub fn pass(&mut self, before: i64, after: i64) {
        let angle = i64::from(self.index_angle);
        let turns = |position: i64| position.wrapping_sub(angle) >> 32;
        let (from, to) = (turns(before), turns(after));
        if from != to {
            let turn = from.max(to);
            self.index.take((turn << 32).wrapping_add(angle));
        }
        if !self.free {
            self.negative.pass(before, after);
            self.positive.pass(before, after);
            self.home.pass(before, after);
        }
    }

    /// Returns true when there is no switch, and none reads on.
    pub const fn is_free(&self) -> bool {
        self.free
            && self.negative.forced.is_none()
            && self.positive.forced.is_none()
            && self.home.forced.is_none()
    }

    pub fn force_limit(&mut self, positive: bool, on: Option<bool>, position: i64) {
        let switch = if positive {
            &mut self.positive
        } else {
            &mut self.negative
        };
        switch.force(on, position);
    }

    pub fn force_home(&mut self, on: Option<bool>, position: i64) {
        self.home.force(on, position);
    }

    /// Returns the reading at a place whose number the drive shows `shift` higher.
    pub fn read(&self, position: i64, shift: i64) -> Inputs {
        let shown = |latch: Latch| Latch {
            position: latch.position.wrapping_add(shift),
            ..latch
        };
        Inputs {
            limit_negative: self.negative.is_on(position),
            limit_positive: self.positive.is_on(position),
            home_switch: self.home.is_on(position),
            index: shown(self.index),
            home_edge: shown(self.home.edge),
            negative_edge: shown(self.negative.edge),
            positive_edge: shown(self.positive.edge),
            ..Inputs::default()
        }
    }
}
