//! Settings of positioning, derived from the parameters once after each change.

use profile::catalogue::{Part, Scaling};

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
        let raw = |part| model.number(part).map_or(0, |number| values.get(number));
        let value = |part| {
            let parameter = model.number(part).and_then(|number| model.numbered(number));
            parameter.map_or(0.0, |parameter| parameter.engineering(raw(part), scaling))
        };
        let units = Units::new(&scaling.unit);
        let place = |part| units.counts(value(part));
        let positive = |counts: i64| Some(counts).filter(|counts| *counts > 0);
        let modulo = (raw(Part::Modulo) != 0)
            .then(|| {
                let [one, other] = [Part::ModuloEnd1, Part::ModuloEnd2].map(place);
                Modulo::new(one, other, Direction::of(raw(Part::ModuloWay)))
            })
            .flatten();
        // An axis that turns round and round has no ends.
        let enabled = if modulo.is_some() {
            0
        } else {
            raw(Part::SoftwareLimitsOn)
        };
        let limit = |bit: i64, part| (enabled & bit != 0).then(|| place(part));
        Self {
            units,
            modulo,
            limits: Limits::new(limit(1, Part::SoftwareLimit0), limit(2, Part::SoftwareLimit1)),
            target_window: place(Part::TargetWindow),
            speed_window: value(Part::TargetSpeedWindow),
            error_window: positive(place(Part::FollowingErrorWarning)),
            home: HomeSetup {
                mode: raw(Part::HomeMode),
                speed: value(Part::HomeSpeed),
                ramps: Ramps {
                    acceleration: value(Part::HomeAcceleration),
                    deceleration: value(Part::HomeDeceleration),
                },
                positive: raw(Part::HomeDirection) != 0,
                // A feedrate of 0 would never arrive.
                feedrate: value(Part::HomeFeedrate).max(1.0) / 100.0,
                current: Some(value(Part::HomeCurrent)).filter(|current| *current > 0.0),
                position: place(Part::HomePosition),
                distance: place(Part::HomeDistance),
                stop_error: place(Part::HomeStopError).max(1),
                farthest: positive(place(Part::HomeFarthest)),
                automatic: raw(Part::HomeAutomatic) != 0,
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
