//! Values in words.

use profile::value::{Content, Reading};
use serde_json::Value;

use crate::report::Parameter;
use crate::{hex_bytes, number, words};

/// Returns the value without its unit: `3000`, `0.366`, `"akd-1"`, `05 A2`. A measured signal at the end of its numbers
/// is reported as `> 11996.704`.
pub fn value(reading: &Reading) -> String {
    match reading.beyond() {
        Some(end) => format!("{} {}", end.sign(), plain(reading)),
        None => plain(reading),
    }
}

fn plain(reading: &Reading) -> String {
    match &reading.content {
        Content::Number { .. } if reading.word.is_some() => words::hex(&reading.octets),
        #[expect(
            clippy::cast_precision_loss,
            reason = "only to see whether the number has a scale"
        )]
        Content::Number { raw, engineering } if *engineering == *raw as f64 => raw.to_string(),
        Content::Number { engineering, .. } if reading.decimals == 0 => number(*engineering),
        Content::Number { engineering, .. } => trimmed(*engineering, reading.decimals),
        Content::Float(value) => number(*value),
        Content::Text(text) => format!("\"{}\"", text),
        Content::Octets => hex_bytes(&reading.octets),
    }
}

/// Two values beside each other, and the unit of both; where they have two, each value has its own and none is left.
pub fn pair(left: Option<&Reading>, right: Option<&Reading>) -> ([String; 2], String) {
    let units = [left, right].map(|one| one.map(|reading| reading.unit));
    let text = |one: Option<&Reading>| one.map_or_else(String::new, value);
    match units {
        [Some(a), Some(b)] if a != b => {
            let both = [left, right].map(|one| {
                let unit = one.map_or("", |reading| reading.unit);
                format!("{} {unit}", text(one)).trim_end().to_owned()
            });
            (both, String::new())
        }
        [one, other] => {
            let unit = one.or(other).unwrap_or_default();
            ([text(left), text(right)], unit.to_owned())
        }
    }
}

/// Value with unit and, where there are any, words: `1 (velocity)`, `0x0231 [READY_ON, CTRL_REQ]`.
pub fn full(reading: &Reading) -> String {
    let mut text = value(reading);
    if !reading.unit.is_empty() {
        text = format!("{text} {}", reading.unit);
    }
    let meaning = meaning(reading);
    match (&reading.word, meaning.is_empty()) {
        (Some(bits), _) => format!("{text} {}", words::bracketed(bits)),
        (None, true) => text,
        (None, false) => format!("{text} ({meaning})"),
    }
}

/// Returns the text of an enumeration or a word, or the whole that the number is a part of.
pub fn meaning(reading: &Reading) -> String {
    match (reading.choice, &reading.word, reading.high_half_of) {
        (Some(choice), ..) => choice.to_owned(),
        (None, Some(bits), _) => words::joined(bits),
        (None, None, Some(whole)) => format!("high half of {whole}"),
        (None, None, None) => String::new(),
    }
}

/// Returns the octets as they came: `0x002DC6C0`.
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
    serde_json::to_value(Parameter::from(reading)).unwrap_or_default()
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
    use profile::catalogue::{AKD, Scaling};
    use profile::value::{Interpretation, Parameters};

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
        let fast = read("NIST_A", &[0x7F, 0xFF]);
        assert_eq!(full(&fast), "> 11996.704 rpm");
        assert_eq!(json(&fast)["beyond"], ">");
        assert_eq!(full(&read("NIST_A", &[0x80, 0x00])), "< -11997.07 rpm");
        assert!(!full(&read("NIST_A", &[0x7F, 0xFE])).contains('>'));
        assert!(
            !full(&read("NSOLL_A", &[0x7F, 0xFF])).contains('>'),
            "a setpoint is what it is"
        );
        let reading = read("DRV.OPMODE", &[1]);
        assert!(full(&reading).starts_with("1 ("), "{}", full(&reading));
        assert_eq!(json(&reading)["pnu"], 2135);
        assert_eq!(json(&reading)["index"], Value::Null);
    }

    #[test]
    fn a_number_from_2_to_the_63rd_on_is_shown_as_it_is() {
        let reading = read("9999", &0xFFFF_FFFF_FFFC_FFFD_u64.to_be_bytes());
        assert_eq!(value(&reading), "18446744073709355005");
        assert_eq!(json(&reading)["raw"], 18_446_744_073_709_355_005_u64);
    }

    #[test]
    fn two_units_beside_each_other_stand_with_their_values() {
        let acceleration = read("DRV.ACC", &[0x00, 0x2D, 0xC6, 0xC0]);
        let mode = read("DRV.OPMODE", &[1]);
        let texts = |a: &str, b: &str, unit: &str| ([a.to_owned(), b.to_owned()], unit.to_owned());
        let same = pair(Some(&acceleration), Some(&acceleration));
        assert_eq!(same, texts("3000", "3000", "rpm/s"));
        assert_eq!(pair(Some(&acceleration), None), texts("3000", "", "rpm/s"));
        assert_eq!(
            pair(Some(&acceleration), Some(&mode)),
            texts("3000 rpm/s", "1", "")
        );
    }

    #[test]
    fn words_are_hexadecimal_with_the_names_of_their_bits() {
        let reading = read("ZSW1", &[0x02, 0x40]);
        assert_eq!(value(&reading), "0x0240");
        assert!(meaning(&reading).starts_with("OFF2"), "{}", meaning(&reading));
        let reading = read("ZSW1", &[0x02, 0x70]);
        assert_eq!(full(&reading), "0x0270 [INHIBIT, CTRL_REQ]");
        let document = json(&reading);
        assert_eq!(
            (&document["value"], &document["word"]["hex"]),
            (&624.0.into(), &"0x0270".into())
        );
        assert_eq!(
            document["word"]["bits"],
            serde_json::json!(["INHIBIT", "CTRL_REQ"])
        );
        let reading = read("DRV.MOTIONSTAT", &[0, 0, 0, 6]);
        assert_eq!(value(&reading), "0x0006");
        let reading = read("DRV.DISSOURCES", &[0, 0]);
        assert_eq!(full(&reading), "0x0000 [no bit set]");
        let reading = read("MT.CNTL", &[0, 1, 0, 0]);
        assert!(
            full(&reading).starts_with("0x10000 [Task type: Absolute target MT.P, "),
            "{}",
            full(&reading)
        );
        let reading = read("2109", &[0, 0, 0, 0]);
        assert_eq!(meaning(&reading), "high half of DRV.ACC");
    }
}
