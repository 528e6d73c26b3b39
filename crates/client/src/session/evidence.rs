//! What is read from a drive whose axis does not get where it should, while it is still in operation. Reads only.

use profile::catalogue::Part;

use super::{Axis, BESIDE};
use crate::Error;
use crate::axis::Evidence;

const PARTS: [Part; 7] = [
    Part::FollowingError,
    Part::Current,
    Part::PositiveCurrentLimit,
    Part::NegativeCurrentLimit,
    Part::PositiveSwitch,
    Part::NegativeSwitch,
    Part::SoftwareLimitState,
];

impl Axis {
    /// Reads it now, if it has not been read since the motion began.
    pub(super) async fn gather(&mut self) {
        if self.evidence.is_some() {
            return;
        }
        let mut drive = self.drive.clone();
        // why it does not move is reported beside what went wrong, never in its place
        let due = self.session.now() + BESIDE;
        let readings = {
            let _meanwhile = self.session.bound_by(due);
            self.session.ask(&mut drive, &PARTS).await
        };
        let Ok(readings) = readings else {
            // read once: the axis is to be looked at
            self.evidence = Some(Evidence::default());
            return;
        };
        let current = readings.number(Part::Current);
        let limit = if current.is_some_and(|current| current < 0.0) {
            Part::NegativeCurrentLimit
        } else {
            Part::PositiveCurrentLimit
        };
        let set = |part| readings.flag(part) == Some(true);
        self.evidence = Some(Evidence {
            following_error: readings
                .raw(Part::FollowingError)
                .map(|raw| f64::from(raw as i32) / drive.counts_per_turn()),
            current,
            current_limit: readings.number(limit).filter(|&limit| limit != 0.0),
            limit_switch: set(Part::PositiveSwitch) || set(Part::NegativeSwitch),
            software_limit: set(Part::SoftwareLimitState),
        });
    }

    /// Returns the trouble, with the evidence read while the drive was still in operation.
    pub(super) fn with_evidence(&self, error: Error) -> Error {
        let evident = self.evidence.filter(|evidence| evidence.cause().is_some());
        match (&error, evident) {
            (
                Error::Axis { .. }
                | Error::NotInTime { .. }
                | Error::SpeedNotReached { .. }
                | Error::NotMoved { .. }
                | Error::SpeedLost { .. },
                Some(evidence),
            ) => Error::Held {
                error: Box::new(error),
                evidence,
            },
            _ => error,
        }
    }
}
