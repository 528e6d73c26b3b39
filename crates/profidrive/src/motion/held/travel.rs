//! How far an axis may go that its caller holds.

use client::axis::{Move as Order, Travel};
use profile::notation::figures;

use super::HeldAxis;
use crate::motion::MotionError;

impl HeldAxis {
    pub(super) fn not_watched(&self, why: &'static str) -> MotionError {
        MotionError::TravelNotWatched {
            drive: self.drive().label(),
            why,
        }
    }

    /// Refuses a motion that would leave the travel of the session.
    fn within_travel(&self, what: &str, is_within: impl FnOnce(&Travel) -> bool) -> Result<(), MotionError> {
        match self.taken.axis.travel() {
            Some(travel) if !is_within(&travel) => Err(MotionError::BeyondTravel {
                drive: self.drive().label(),
                what: what.to_owned(),
                limit: travel.limit,
                way: travel.way(),
            }),
            _ => Ok(()),
        }
    }

    /// Refuses a speed from which the axis would not be halted within the travel of the session.
    pub(super) fn permit_way(&self, speed: f64) -> Result<(), MotionError> {
        self.within_travel(&format!("{} rpm", figures(speed)), |travel| travel.permits(speed))
    }

    /// Refuses a target outside of the travel of the session.
    pub(super) fn permit_target(&self, order: &Order) -> Result<(), MotionError> {
        if self.taken.axis.travel().is_none() {
            return Ok(());
        }
        let turns = order.target.turns(self.drive().counts_per_turn());
        let from_here = match order.relative {
            true => turns,
            false => {
                let position = self.status().and_then(|status| status.position);
                let position = position.ok_or_else(|| self.not_watched("the axis reports no position"))?;
                turns - position
            }
        };
        self.within_travel(&format!("a move by {from_here:.3} rev"), |travel| {
            travel.reaches(from_here)
        })
    }
}
