//! Fault and warning numbers: `faults.csv` of a model.

use std::collections::BTreeMap;

use crate::Outcome;
use crate::table::{Row, Table};

/// Returns the table as Rust.
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

/// The numbers of the warnings.
pub fn warnings(faults: &Table) -> Outcome<Vec<u16>> {
    let mut numbers = Vec::new();
    for row in faults.rows() {
        if row.text("kind")? == "n" {
            numbers.push(row.number("number")?);
        }
    }
    Ok(numbers)
}

/// The faults, or warnings, of one word of 32 bits: bit and text. Several that share a bit are one text.
pub fn bits(faults: &Table, warnings: bool, first: u8) -> Outcome<Vec<(u8, String)>> {
    let mut found: BTreeMap<u8, Vec<(u16, &str)>> = BTreeMap::new();
    for row in faults.rows() {
        let bit = row
            .maybe_number::<u8>("bit")?
            .and_then(|bit| bit.checked_sub(first));
        let Some(bit) = bit.filter(|bit| *bit < 32) else {
            continue;
        };
        if (row.text("kind")? == "n") == warnings {
            let fault = (row.number("number")?, row.text("meaning")?);
            found.entry(bit).or_default().push(fault);
        }
    }
    let text = |faults: &[(u16, &str)]| match faults {
        [(number, meaning)] => format!("{meaning} ({number})"),
        several => {
            let numbers: Vec<String> = several.iter().map(|(number, _)| number.to_string()).collect();
            format!("one of {}", numbers.join(", "))
        }
    };
    Ok(found.iter().map(|(bit, faults)| (*bit, text(faults))).collect())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_of_alarm_and_warning_words() {
        let rows = "number,kind,bit,meaning\n4,F,14,a\n4,n,14,b\n50,F,15,c\n51,F,15,d\n70,F,33,e\n71,F,,f\n";
        let table = Table::parse("f", rows).unwrap();
        let of = |warnings, first| bits(&table, warnings, first).unwrap();
        assert_eq!(
            of(false, 0),
            [(14, "a (4)".to_owned()), (15, "one of 50, 51".to_owned())]
        );
        assert_eq!(of(true, 0), [(14, "b (4)".to_owned())]);
        assert_eq!(of(false, 32), [(1, "e (70)".to_owned())]);
    }
}
