//! Values in words.

use drive_client::parameter::{Content, Reading};
use serde_json::Value;

use super::table::clean;
use super::{hex_bytes, number};
use crate::fields;

/// The value without its unit: `3000`, `0.366`, `"akd-1"`, `05 A2`.
pub fn value(reading: &Reading) -> String {
    match &reading.content {
        Content::Number { engineering, .. } if reading.decimals == 0 => number(*engineering),
        Content::Number { engineering, .. } => trimmed(*engineering, reading.decimals),
        Content::Float(value) => number(*value),
        Content::Text(text) => format!("\"{}\"", clean(text)),
        Content::Octets => hex_bytes(&reading.octets),
    }
}

/// Value with unit and, where there are any, words: `1 (velocity)`.
pub fn full(reading: &Reading) -> String {
    let mut text = value(reading);
    if !reading.unit.is_empty() {
        text = format!("{text} {}", reading.unit);
    }
    let words = meaning(reading);
    if words.is_empty() {
        text
    } else {
        format!("{text} ({words})")
    }
}

/// What an enumeration or a bit field says.
pub fn meaning(reading: &Reading) -> String {
    match reading.choice {
        Some(choice) => choice.to_owned(),
        None => reading.bits.join(", "),
    }
}

/// The octets as they came: `0x002DC6C0`.
pub fn raw(reading: &Reading) -> String {
    if matches!(reading.content, Content::Text(_) | Content::Octets) {
        hex_bytes(&reading.octets)
    } else {
        let digits: String = reading
            .octets
            .iter()
            .map(|octet| format!("{octet:02X}"))
            .collect();
        format!("0x{digits}")
    }
}

/// For programs.
pub fn json(reading: &Reading) -> Value {
    let content = match &reading.content {
        Content::Number { engineering, .. } => Value::from(*engineering),
        Content::Float(value) => Value::from(*value),
        Content::Text(text) => Value::from(text.as_str()),
        Content::Octets => Value::from(hex_bytes(&reading.octets)),
    };
    let mut fields = fields! {
        "pnu": reading.pnu, "index": reading.index, "name": reading.name, "value": content,
        "unit": reading.unit, "raw": reading.raw(), "hex": hex_bytes(&reading.octets),
        "format": reading.format, "writable": reading.writable,
    };
    let words = meaning(reading);
    if !words.is_empty() {
        fields.insert("meaning".into(), words.into());
    }
    Value::Object(fields)
}

fn trimmed(value: f64, decimals: u8) -> String {
    let text = format!("{value:.*}", usize::from(decimals));
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" { "0".into() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use drive_client::parameter::{Interpretation, Parameters};
    use profidrive::catalogue::{AKD, Scaling};

    fn read(text: &str, octets: &[u8]) -> Reading {
        let drive = Parameters {
            catalogue: Some(&AKD),
            scaling: Scaling::default(),
        };
        let selection = drive.select(&text.parse().unwrap()).unwrap();
        drive.reading(&selection, 0, 0x43, Interpretation::Plain, octets)
    }

    #[test]
    fn engineering_raw_and_words() {
        let reading = read("DRV.ACC", &[0x00, 0x2D, 0xC6, 0xC0]);
        assert_eq!(
            (full(&reading), raw(&reading)),
            ("3000 rpm/s".into(), "0x002DC6C0".into())
        );
        let reading = read("NSOLL_A", &[0x00, 0xA3]);
        assert_eq!(value(&reading), "59.678");
        let reading = read("DRV.OPMODE", &[1]);
        assert!(full(&reading).starts_with("1 ("), "{}", full(&reading));
        assert_eq!(json(&reading)["pnu"], 2135);
        assert_eq!(json(&reading)["index"], Value::Null);
    }
}
