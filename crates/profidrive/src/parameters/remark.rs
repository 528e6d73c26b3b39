//! What a person is to know of a value on its way to the drive.

use client::change::Change;
use dissect::{number, value};
use profile::value::{Assignment, Content};

use crate::Remark;

/// Returns what becomes of a value; `None` where the drive gets it as it was written.
pub(super) fn of_value(assignment: &Assignment, change: &Change) -> Option<Remark> {
    raw(assignment, change)
        .or_else(|| rounded(assignment, change))
        .or_else(|| blanks_lost(assignment, change))
        .map(Remark::news)
}

/// A number in hexadecimal is the one on the wire: what that is in the unit of the parameter.
fn raw(assignment: &Assignment, change: &Change) -> Option<String> {
    let raw = assignment.value.raw()?;
    let unit = change.rounding?.unit;
    (!unit.is_empty()).then(|| {
        let (label, value) = (change.label(), value::value(&change.new));
        format!("{label}: 0x{raw:04X} is the raw value, that is {value} {unit}")
    })
}

/// A text is written without the blanks in front of it, and how to write them.
fn blanks_lost(assignment: &Assignment, change: &Change) -> Option<String> {
    let Content::Text(text) = &change.new.content else {
        return None;
    };
    assignment.value.has_lost_blanks().then(|| {
        let label = change.label();
        format!(
            "{label}: blanks before the text are left out; to write them use quotation marks: \" {text}\""
        )
    })
}

/// What becomes of a value between two that the drive can hold.
fn rounded(assignment: &Assignment, change: &Change) -> Option<String> {
    let value = change.rounding?;
    let asked = assignment.value.number()?;
    let unit = asked.unit.as_deref().unwrap_or(value.unit);
    let (asked, written) = (number(asked.number.as_f64()), value::value(&change.new));
    let shown = unit != value.unit || asked != written;
    (value.is_rounded() && shown).then(|| {
        let label = change.label();
        let line = format!("{label}: {asked} {unit} -> {written} {}", value.unit);
        format!("{}, rounded to the nearest representable value", line.trim_end())
    })
}
