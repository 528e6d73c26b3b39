//! Recordings of steps to compare with, which other programs may have written.

use profidrive::recording::EarlierStep;

/// A step that was recorded before: what is read has a step and figures without a panic, whatever its numbers are.
pub fn earlier_step(data: &[u8]) {
    let Ok(step) = EarlierStep::parse("step.csv", data) else {
        return;
    };
    assert!(step.points().len() > 1);
    for point in step.points() {
        assert!(point.time.is_finite() && point.set.is_finite() && point.actual.is_finite());
    }
    let _ = step.response(0.02);
}
