//! What is asked of a drive whose axis does not get where it should, while it is still in operation. Reads only.

use profidrive::telegram::signal;

use super::Axis;
use crate::axis::Evidence;
use crate::parameter::Reading;
use crate::{Error, Wire};

/// PNUs of an AKD.
const NEGATIVE_SWITCH: u16 = 2211;
const POSITIVE_SWITCH: u16 = 2212;
const CURRENT: u16 = 2216;
const NEGATIVE_LIMIT: u16 = 2230;
const POSITIVE_LIMIT: u16 = 2231;
const SOFTWARE_LIMITS: u16 = 2387;
const FOLLOWING_ERROR: u16 = signal::kollmorgen::XIST_ERROR;

impl<M: Wire> Axis<'_, M> {
    /// Reads it now, if it has not been read since the motion began.
    pub(super) fn gather(&mut self) {
        if self.evidence.is_some() {
            return;
        }
        let mut drive = self.drive.clone();
        let read = self.session.read_numbers(
            &mut drive,
            &[
                FOLLOWING_ERROR,
                CURRENT,
                POSITIVE_LIMIT,
                NEGATIVE_LIMIT,
                POSITIVE_SWITCH,
                NEGATIVE_SWITCH,
                SOFTWARE_LIMITS,
            ],
        );
        // why it does not move is told beside what went wrong, never in its place
        let Ok(readings) = read else { return };
        let find = |pnu| readings.iter().find(|reading| reading.pnu == pnu);
        let number = |pnu| find(pnu).and_then(Reading::number);
        let set = |pnu| find(pnu).and_then(Reading::raw).is_some_and(|raw| raw != 0);
        let current = number(CURRENT);
        let limit = if current.is_some_and(|current| current < 0.0) {
            NEGATIVE_LIMIT
        } else {
            POSITIVE_LIMIT
        };
        self.evidence = Some(Evidence {
            following_error: find(FOLLOWING_ERROR)
                .and_then(Reading::raw)
                .map(|raw| f64::from(raw as i32) / drive.counts_per_turn()),
            current,
            current_limit: number(limit).filter(|&limit| limit != 0.0),
            limit_switch: set(POSITIVE_SWITCH) || set(NEGATIVE_SWITCH),
            software_limit: set(SOFTWARE_LIMITS),
        });
    }

    /// What went wrong, with what the drive said about it while it was still in operation.
    pub(super) fn with_evidence(&self, error: Error) -> Error {
        let telling = self.evidence.filter(|evidence| evidence.cause().is_some());
        match (&error, telling) {
            (
                Error::Axis { .. } | Error::NotInTime { .. } | Error::SpeedNotReached { .. },
                Some(evidence),
            ) => Error::Held {
                error: Box::new(error),
                evidence,
            },
            _ => error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use profidrive::catalogue::AKD;

    #[test]
    fn the_numbers_are_those_of_the_tables() {
        for (pnu, name) in [
            (NEGATIVE_SWITCH, "HWLS.NEGSTATE"),
            (POSITIVE_SWITCH, "HWLS.POSSTATE"),
            (CURRENT, "IL.FB"),
            (NEGATIVE_LIMIT, "IL.LIMITN"),
            (POSITIVE_LIMIT, "IL.LIMITP"),
            (SOFTWARE_LIMITS, "SWLS.STATE"),
        ] {
            assert_eq!(AKD.by_name(name).map(|found| found.pnu), Some(pnu), "{name}");
        }
    }
}
