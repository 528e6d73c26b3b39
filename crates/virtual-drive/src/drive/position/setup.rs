//! What positioning obeys, taken out of the parameters once after each change.

use profile::catalogue::Scaling;

use super::homing::HomeSetup;
use super::limits::Limits;
use super::units::{Direction, Modulo, Units};
use crate::axis::Ramps;
use crate::model::Model;
use crate::store::Values;

/// Parameters in the units of the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drive) struct Setup {
    pub units: Units,
    pub modulo: Option<Modulo>,
    /// As configured; they hold for an axis that is homed.
    pub limits: Limits,
    /// MT.TPOSWND and MT.TVELWND.
    pub target_window: i64,
    pub speed_window: f64,
    /// PL.ERRWTHRESH; none when it is 0.
    pub error_window: Option<i64>,
    pub home: HomeSetup,
    /// Highest speeds in negative and positive direction, rpm.
    pub speed_limits: [f64; 2],
}

impl Setup {
    pub fn new(model: &Model, values: &Values, scaling: &Scaling, speed_limits: [f64; 2]) -> Self {
        let roles = &model.roles.positioning;
        let raw = |pnu: u16| values.get(pnu);
        let value = |pnu: u16| {
            let parameter = model.catalogue.by_pnu(pnu);
            parameter.map_or(0.0, |parameter| parameter.engineering(raw(pnu), scaling))
        };
        let units = Units::new(&scaling.unit);
        let place = |pnu: u16| units.counts(value(pnu));
        let positive = |counts: i64| Some(counts).filter(|counts| *counts > 0);
        let modulo = (raw(roles.modulo) != 0)
            .then(|| {
                let [one, other] = roles.modulo_range.map(place);
                Modulo::new(one, other, Direction::of(raw(roles.modulo_direction)))
            })
            .flatten();
        // An axis that turns round and round has no ends.
        let enabled = if modulo.is_some() {
            0
        } else {
            raw(roles.limits_enabled)
        };
        let [low, high] = roles.limits;
        let limit = |bit: i64, pnu: u16| (enabled & bit != 0).then(|| place(pnu));
        let home = &roles.home;
        let [up, down] = home.ramps;
        Self {
            units,
            modulo,
            limits: Limits::new(limit(1, low), limit(2, high)),
            target_window: place(roles.target_window),
            speed_window: value(roles.speed_window),
            error_window: positive(place(roles.error_window)),
            home: HomeSetup {
                mode: raw(home.mode),
                speed: value(home.speed),
                ramps: Ramps {
                    acceleration: value(up),
                    deceleration: value(down),
                },
                positive: raw(home.direction) != 0,
                // A feedrate of 0 would never arrive.
                feedrate: value(home.feedrate).max(1.0) / 100.0,
                current: Some(value(home.current)).filter(|current| *current > 0.0),
                position: place(home.position),
                distance: place(home.distance),
                stop_error: place(home.stop_error).max(1),
                farthest: positive(place(home.farthest)),
                automatic: raw(home.automatic) != 0,
            },
            speed_limits,
        }
    }

    /// Highest speed in a direction, rpm.
    pub fn fastest(&self, way: i64) -> f64 {
        let [negative, positive] = self.speed_limits;
        match way {
            1.. => positive,
            0 => negative.min(positive),
            _ => negative,
        }
    }
}
