//! Speeds above a limit: of the caller, and of the drive.

use client::axis::{MotionFacts, SpeedUnit};
use client::{Drive, Error};
use profile::catalogue::Part;

use super::error::MotionError;

/// A limit may have been computed from a frequency: so much above it is the limit itself.
const ROUNDING: f64 = 1.001;

/// Above the limit of the caller nothing is sent at all.
pub(super) fn within(speed: f64, limit: f64, unit: SpeedUnit) -> Result<(), Error> {
    // a limit that is no number is none that anything is within
    if speed.is_nan() || limit.is_nan() || speed.abs() > limit {
        return Err(Error::SpeedLimit {
            wanted: speed,
            limit,
            unit: unit.symbol(),
        });
    }
    Ok(())
}

/// The limit of the drive that a speed is above, and what sets it: it would never be reached.
pub(super) fn above(speed: f64, facts: &MotionFacts) -> Option<(f64, Option<Part>)> {
    facts
        .speed_limit(speed)
        .filter(|(limit, _)| speed.abs() > limit * ROUNDING)
}

/// The refusal of a speed above the limit of the drive.
pub(super) fn too_fast(speed: f64, (limit, part): (f64, Option<Part>), drive: &Drive) -> MotionError {
    MotionError::AboveLimit {
        drive: drive.label(),
        speed,
        limit,
        by: part.and_then(|part| drive.named(&[part]).into_iter().next()),
    }
}

/// Refuses a jog above the limit of the speed. A reference and a direction do not limit a jog.
pub(super) fn jog(speed: f64, facts: &MotionFacts, drive: &Drive) -> Result<(), MotionError> {
    let limits = [Some(Part::ForwardLimit), Some(Part::BackwardLimit)];
    match above(speed, facts).filter(|(_, part)| limits.contains(part)) {
        Some(limit) => Err(too_fast(speed, limit, drive)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_within_a_limit_that_is_no_number() {
        let within = |speed, limit| within(speed, limit, SpeedUnit::Rpm).is_ok();
        assert!(within(60.0, 60.0) && within(-60.0, 60.0) && within(60.0, f64::INFINITY));
        assert!(!within(60.1, 60.0) && !within(-60.1, 60.0));
        assert!(!within(f64::NAN, 60.0) && !within(60.0, f64::NAN) && !within(0.0, f64::NAN));
    }

    #[test]
    fn limits_of_the_drive_are_found() {
        let facts = MotionFacts {
            forward_limit: Some(1000.0),
            backward_limit: Some(500.0),
            backward_by: Some(Part::BackwardLimit),
            ..MotionFacts::default()
        };
        assert_eq!(above(1000.0, &facts), None);
        assert_eq!(above(-600.0, &facts), Some((500.0, Some(Part::BackwardLimit))));
    }

    #[test]
    fn a_speed_that_is_no_number_is_within_no_limit() {
        assert!(within(f64::NAN, 3000.0, SpeedUnit::Rpm).is_err());
        assert!(within(-3000.0, 3000.0, SpeedUnit::Rpm).is_ok());
        assert!(within(-3001.0, 3000.0, SpeedUnit::Rpm).is_err());
    }
}
