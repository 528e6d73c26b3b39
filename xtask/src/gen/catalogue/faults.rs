//! Fault and warning numbers: `faults.csv` of a model.

use crate::Outcome;
use crate::table::{Row, Table};

/// The table as Rust.
pub fn render(faults: &Table) -> Outcome<String> {
    let mut text = String::from(
        "use crate::catalogue::{Cleared, Fault, Reaction};\n\n\
         #[rustfmt::skip]\npub static FAULTS: &[Fault] = &[\n",
    );
    for row in faults.rows() {
        text.push_str(&render_fault(row)?);
    }
    text.push_str("];\n");
    Ok(text)
}

fn render_fault(row: Row<'_>) -> Outcome<String> {
    let place = || row.place();
    let warning = match row.text("kind")? {
        "F" => false,
        "n" => true,
        other => return Err(format!("{}: kind {other:?}", place()).into()),
    };
    let reaction = match row.text("reaction")? {
        "coast" => "Coast",
        "dynamic-brake" => "DynamicBrake",
        "quick-stop" => "QuickStop",
        "ramp-stop" => "RampStop",
        "none" => "None",
        other => return Err(format!("{}: reaction {other:?}", place()).into()),
    };
    if warning != (reaction == "None") {
        return Err(format!("{}: a warning has no reaction, a fault has one", place()).into());
    }
    let cleared = match row.text("cleared")? {
        "acknowledge" => "Acknowledge",
        "by itself" => "ByItself",
        "restart" => "Restart",
        other => return Err(format!("{}: cleared {other:?}", place()).into()),
    };
    let recalled = match row.text("confidence")? {
        "read" => false,
        "recalled" => true,
        other => return Err(format!("{}: confidence {other:?}", place()).into()),
    };
    if row.text("remedy")?.is_empty() {
        return Err(format!("{}: no remedy", place()).into());
    }
    Ok(format!(
        "    Fault {{ number: {}, warning: {warning}, bit: {:?}, meaning: {:?}, reaction: Reaction::{reaction}, remedy: {:?}, \
         cleared: Cleared::{cleared}, recalled: {recalled}, assumed: {:?}, source: {:?} }},\n",
        row.number::<u16>("number")?,
        row.maybe_number::<u8>("bit")?,
        row.text("meaning")?,
        row.text("remedy")?,
        row.text("assumed")?,
        row.text("source")?,
    ))
}
