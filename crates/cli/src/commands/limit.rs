//! Speeds above the limit of a drive.

use client::Drive;
use client::axis::MotionFacts;
use profile::catalogue::Part;

use crate::failure::{Exit, Failure};
use crate::render::number;

/// A limit may have been reckoned from a frequency: so much above it is the limit itself.
const ROUNDING: f64 = 1.001;

/// Returns the limit of the drive that a speed is above, and what sets it: it would never be reached.
pub fn above(speed: f64, facts: &MotionFacts) -> Option<(f64, Option<Part>)> {
    facts
        .speed_limit(speed)
        .filter(|(limit, _)| speed.abs() > limit * ROUNDING)
}

/// Returns the only direction in which the drive turns, if the limit of the other one is 0.
fn beyond(speed: f64, limit: f64, by: &str) -> String {
    let asked = number(speed);
    if limit > 0.0 {
        return format!(
            "{asked} rpm is above the limit of the drive, {} rpm{by}",
            number(limit)
        );
    }
    let only = if speed < 0.0 { "forward" } else { "backward" };
    format!("{asked} rpm is in a direction that the drive does not allow: it turns {only} only{by}")
}

/// Returns the refusal of a speed above the limit of the drive.
pub fn too_fast(speed: f64, (limit, part): (f64, Option<Part>), drive: &Drive) -> Failure {
    let named = part.map_or_else(Vec::new, |part| drive.named(&[part]));
    let by = named
        .first()
        .map_or_else(String::new, |name| format!(" ({name})"));
    let message = format!("{}: {}", drive.label(), beyond(speed, limit, &by));
    let failure = Failure::new(Exit::Safety, message);
    match named.first() {
        Some(name) => failure.hint(format!(
            "`profidrive describe {} {}` shows it; ask for a speed within it",
            drive.label(),
            name.replace(' ', "")
        )),
        None => failure,
    }
}

/// Refuses a jog above the limit of the speed. A reference and a direction are not limits of a jog.
pub fn jog(speed: f64, facts: &MotionFacts, drive: &Drive) -> Result<(), Failure> {
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
    fn limits_of_the_drive_are_reported() {
        let facts = MotionFacts {
            forward_limit: Some(1000.0),
            backward_limit: Some(500.0),
            backward_by: Some(Part::BackwardLimit),
            ..MotionFacts::default()
        };
        assert_eq!(above(1000.0, &facts), None);
        assert_eq!(above(-600.0, &facts), Some((500.0, Some(Part::BackwardLimit))));
        assert_eq!(
            beyond(-600.0, 500.0, ""),
            "-600 rpm is above the limit of the drive, 500 rpm"
        );
        assert_eq!(
            beyond(-700.0, 0.0, " (3-00)"),
            "-700 rpm is in a direction that the drive does not allow: it turns forward only (3-00)"
        );
    }
}
