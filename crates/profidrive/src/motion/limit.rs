//! Speeds above a limit: of the caller, of the machine, and of the drive.

use client::axis::{MotionFacts, SpeedUnit};
use client::{Drive, Error, Session};
use profile::catalogue::Part;

use super::Control;
use super::error::MotionError;

/// A limit may have been computed from a frequency: so much above it is the limit itself.
const ROUNDING: f64 = 1.001;

/// Above the limit of the caller, and above that of the machine, nothing is sent at all. A speed in percent is compared with
/// the latter by [`share`].
pub(super) fn within(speed: f64, limit: f64, unit: SpeedUnit, control: &Control) -> Result<(), MotionError> {
    // a limit that is no number is none that anything is within
    if speed.is_nan() || limit.is_nan() || speed.abs() > limit {
        return Err(Error::SpeedLimit {
            wanted: speed,
            limit,
            unit: unit.symbol(),
        }
        .into());
    }
    match control.bound {
        Some(bound) if unit == SpeedUnit::Rpm && speed.abs() > bound.rpm => {
            Err(MotionError::AboveBound { speed, bound })
        }
        _ => Ok(()),
    }
}

/// Compares a speed in percent of the reference with the limit of the machine.
pub(super) fn share(
    percent: f64,
    reference: Option<f64>,
    facts: &MotionFacts,
    control: &Control,
    drive: &Drive,
) -> Result<(), MotionError> {
    let Some(bound) = control.bound else {
        return Ok(());
    };
    let of_drive = facts.speed_limit(percent);
    let reported = of_drive.filter(|(_, part)| *part == Some(Part::Reference));
    match reference.or(reported.map(|(speed, _)| speed)) {
        Some(reference) => {
            let speed = percent / 100.0 * reference;
            within(speed, f64::INFINITY, SpeedUnit::Rpm, control)
        }
        // whatever 100 % is, the drive itself turns no faster
        None if of_drive.is_some_and(|(limit, _)| limit <= bound.rpm) => Ok(()),
        None => Err(MotionError::NotBounded {
            drive: drive.label(),
            what: "a speed in percent",
            bound,
        }),
    }
}

/// Refuses a motion at speeds that only the drive has, unless the drive itself turns no faster than the limit of the machine.
pub(super) async fn of_drive(
    session: &mut Session,
    drive: &mut Drive,
    control: &Control,
    what: &'static str,
) -> Result<(), MotionError> {
    let Some(bound) = control.bound else {
        return Ok(());
    };
    if turns_within(session, drive, bound.rpm).await? {
        return Ok(());
    }
    Err(MotionError::NotBounded {
        drive: drive.label(),
        what,
        bound,
    })
}

/// Returns whether the drive itself turns no faster than this.
async fn turns_within(session: &mut Session, drive: &mut Drive, rpm: f64) -> Result<bool, Error> {
    let facts = session.motion_facts(drive).await?;
    let low = |direction| {
        facts
            .speed_limit(direction)
            .is_some_and(|(limit, _)| limit <= rpm * ROUNDING)
    };
    Ok(low(1.0) && low(-1.0))
}

/// Refuses a motion at a speed that is stored in the drive, where it is above the limit of the caller. A speed that is not known may
/// be above it, unless the drive itself turns no faster.
pub(super) async fn stored(
    session: &mut Session,
    drive: &mut Drive,
    limit: f64,
    what: &'static str,
    speed: Option<f64>,
) -> Result<(), MotionError> {
    let is_within = match speed {
        Some(speed) => speed.abs() <= limit,
        None => limit == f64::INFINITY,
    };
    if is_within || turns_within(session, drive, limit).await? {
        return Ok(());
    }
    Err(MotionError::StoredSpeed {
        drive: drive.label(),
        what,
        speed,
        limit,
    })
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
    use crate::machine::SpeedBound;

    #[test]
    fn nothing_is_within_a_limit_that_is_no_number() {
        let control = Control::default();
        let within = |speed, limit| within(speed, limit, SpeedUnit::Rpm, &control).is_ok();
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
        let control = Control::default();
        let within = |speed| within(speed, 3000.0, SpeedUnit::Rpm, &control);
        assert!(within(f64::NAN).is_err());
        assert!(within(-3000.0).is_ok());
        assert!(within(-3001.0).is_err());
    }

    #[test]
    fn the_limit_of_the_machine_counts_beside_that_of_the_caller() {
        let bound = SpeedBound { rpm: 500.0, line: 7 };
        let control = Control {
            bound: Some(bound),
            ..Control::default()
        };
        let rpm = |speed| within(speed, 3000.0, SpeedUnit::Rpm, &control);
        assert!(rpm(-500.0).is_ok());
        let error = rpm(-501.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the speed -501 rpm is above the limit of 500 rpm in line 7 of the machine file"
        );
        assert_eq!(error.kind(), client::ErrorKind::Safety);
        let drive = Drive::new(profinet::controller::Station::default());
        let share =
            |percent, reference, facts: &MotionFacts| share(percent, reference, facts, &control, &drive);
        let unknown = MotionFacts::default();
        assert!(share(30.0, Some(1500.0), &unknown).is_ok());
        assert!(share(-40.0, Some(1500.0), &unknown).is_err());
        assert!(matches!(
            share(1.0, None, &unknown),
            Err(MotionError::NotBounded { .. })
        ));
        let slow = MotionFacts {
            forward_limit: Some(400.0),
            ..MotionFacts::default()
        };
        assert!(share(100.0, None, &slow).is_ok());
        assert!(share(-100.0, None, &slow).is_err());
    }
}
