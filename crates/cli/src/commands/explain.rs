//! `profidrive explain 0x047F --as stw1`

use profidrive::catalogue::{AKD, Catalogue};
use profinet::wire::status::PnioStatus;
use serde_json::{Map, Value};

use crate::args::{Explain, What};
use crate::failure::Failure;
use crate::fields;
use crate::job;
use crate::output::Output;
use crate::render::{hex16, words};

pub fn run(args: &Explain, output: &Output) -> Result<(), Failure> {
    let (lines, fields) = explain(&args.value, args.kind, tables(args))?;
    if output.json() {
        output.document("explain", fields);
    } else {
        for line in lines {
            output.line(&line);
        }
    }
    Ok(())
}

type Explained = (Vec<String>, Map<String, Value>);

/// The tables of the model that was named; of an AKD where none was.
fn tables(args: &Explain) -> &'static Catalogue {
    args.model.model.and_then(|model| model.catalogue).unwrap_or(&AKD)
}

fn explain(text: &str, kind: What, tables: &Catalogue) -> Result<Explained, Failure> {
    Ok(match kind {
        What::Stw1 => {
            let word = word(text)?;
            let means = words::stw1_meaning(word);
            let mut fields = fields! { "as": "stw1", "meaning": means };
            fields.insert("word".into(), words::word_json(words::stw1_bits(), word));
            (words::word_lines("STW1", words::stw1_bits(), word, means), fields)
        }
        What::Zsw1 => {
            let word = word(text)?;
            let means = words::state(word, None);
            let mut fields = fields! { "as": "zsw1", "meaning": means.as_str() };
            fields.insert("word".into(), words::word_json(words::zsw1_bits(), word));
            (
                words::word_lines("ZSW1", words::zsw1_bits(), word, &means),
                fields,
            )
        }
        What::State => {
            let word = word(text)?;
            let state = words::state(word, None);
            let fields = fields! { "as": "state", "raw": word, "state": words::state_number(word, None), "meaning": state.as_str() };
            (vec![format!("ZSW1 {}: {state}", hex16(word))], fields)
        }
        What::Fault => fault(text, tables)?,
        What::Pnio => pnio(text)?,
        What::Error => {
            let mut lines = Vec::new();
            let fields = job::explain_error(word(text)?, &mut lines);
            (lines, fields)
        }
        What::Format => {
            let code = u8::try_from(word(text)?)
                .map_err(|_| Failure::usage(format!("`{text}`: format codes have one octet")))?;
            let mut lines = Vec::new();
            let fields = job::explain_format(code, &mut lines);
            (lines, fields)
        }
    })
}

fn fault(text: &str, tables: &Catalogue) -> Result<Explained, Failure> {
    let (warning, digits) = match text.as_bytes().first() {
        Some(b'n' | b'N') => (true, text.get(1..).unwrap_or_default()),
        Some(b'f' | b'F') => (false, text.get(1..).unwrap_or_default()),
        _ => (false, text),
    };
    let number = word(digits)?;
    let letter = if warning { 'n' } else { 'F' };
    let known = tables.fault(number, warning);
    let name = tables.model;
    let meaning = known.map_or_else(
        || format!("not in the table of the {name}"),
        |fault| fault.meaning.into(),
    );
    let mut lines = vec![format!("{name} {letter}{number}: {meaning}")];
    let mut fields =
        fields! { "as": "fault", "model": name.to_ascii_lowercase(), "number": number, "warning": warning };
    if let Some(fault) = known {
        fields.insert("meaning".into(), fault.meaning.into());
        fields.insert("reaction".into(), fault.reaction.text().into());
        fields.insert("remedy".into(), fault.remedy.into());
        fields.insert("cleared".into(), fault.cleared.text().into());
        fields.insert("source".into(), fault.source.into());
        fields.insert("recalled".into(), fault.recalled.into());
        lines.push(format!("  reaction {}", fault.reaction));
        lines.push(format!("  do       {}", fault.remedy));
        lines.push(format!("  cleared  {}", fault.cleared));
        let assumed = if fault.assumed.is_empty() {
            String::new()
        } else {
            format!(" (not told there: {})", fault.assumed)
        };
        lines.push(format!("  source   {}{assumed}", fault.source));
    }
    Ok((lines, fields))
}

fn pnio(text: &str) -> Result<Explained, Failure> {
    let compact: String = text
        .chars()
        .filter(|c| !c.is_whitespace() && !matches!(c, '_' | ':'))
        .collect();
    let digits = compact
        .strip_prefix("0x")
        .or_else(|| compact.strip_prefix("0X"))
        .unwrap_or(&compact);
    let value = (digits.len() == 8)
        .then(|| u32::from_str_radix(digits, 16).ok())
        .flatten()
        .ok_or_else(|| {
            Failure::usage(format!(
                "`{text}`: a PNIO status has four octets in hexadecimal, for example DE80B500"
            ))
        })?;
    let status = PnioStatus::from_u32(value);
    let lines = vec![
        format!("PNIO status {status}"),
        format!(
            "  ErrorCode 0x{:02X}, ErrorDecode 0x{:02X}, ErrorCode1 0x{:02X}, ErrorCode2 0x{:02X}",
            status.code, status.decode, status.code1, status.code2
        ),
    ];
    let fields = fields! {
        "as": "pnio", "raw": value, "hex": format!("{value:08X}"), "meaning": status.to_string(),
        "error_code": status.code, "error_decode": status.decode,
        "error_code1": status.code1, "error_code2": status.code2,
    };
    Ok((lines, fields))
}

/// A 16-bit number: hexadecimal with 0x, binary with 0b, else decimal.
fn word(text: &str) -> Result<u16, Failure> {
    let compact: String = text.trim().chars().filter(|c| *c != '_' && *c != ' ').collect();
    let lower = compact.to_ascii_lowercase();
    let parsed = if let Some(hex) = lower.strip_prefix("0x") {
        u16::from_str_radix(hex, 16)
    } else if let Some(binary) = lower.strip_prefix("0b") {
        u16::from_str_radix(binary, 2)
    } else {
        lower.parse()
    };
    parsed.map_err(|_| {
        Failure::usage(format!(
            "`{text}` is no 16-bit number: write 0x047F, 1151 or 0b0000_0100_0111_1111"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str, kind: What) -> String {
        explain(text, kind, &AKD).unwrap().0.join("\n")
    }

    #[test]
    fn faults_of_the_make_that_is_named() {
        let told = explain("13", What::Fault, &profidrive::catalogue::VLT).unwrap();
        assert!(told.0[0].starts_with("VLT F13: "), "{:?}", told.0);
        assert_ne!(told.0[0], lines("13", What::Fault).lines().next().unwrap());
    }

    #[test]
    fn control_word_with_names_and_nibbles() {
        let text = lines("0x047F", What::Stw1);
        assert!(text.starts_with("STW1 0x047F   0000 0100 0111 1111\n"), "{text}");
        assert!(
            text.contains("set    ON, EN_OP, EN_RAMP, UNFREEZE, EN_SETPOINT, CTRL_PLC\n"),
            "{text}"
        );
        assert!(
            text.contains("stops  OFF2 not active, OFF3 not active\n"),
            "{text}"
        );
        assert_eq!(lines("1151", What::Stw1), text);
        assert_eq!(lines("0b0000_0100_0111_1111", What::Stw1), text);
    }

    #[test]
    fn faults_states_and_statuses() {
        assert!(lines("F702", What::Fault).starts_with("AKD F702: "));
        assert!(lines("702", What::Fault).starts_with("AKD F702: "));
        let following = lines("n439", What::Fault);
        assert!(
            following.contains("\n  reaction none\n  do       look for"),
            "{following}"
        );
        assert!(following.contains("\n  cleared  by itself"), "{following}");
        assert!(lines("9", What::Fault).contains("not in the table"));
        assert_eq!(lines("0x0237", What::State), "ZSW1 0x0237: S4 operation");
        assert!(lines("DE80B500", What::Pnio).contains("state conflict"));
    }

    #[test]
    fn wrong_numbers_are_usage_errors() {
        for (text, kind) in [
            ("0x10000", What::Stw1),
            ("fast", What::State),
            ("DE80", What::Pnio),
            ("", What::Fault),
        ] {
            assert_eq!(
                explain(text, kind, &AKD).unwrap_err().exit,
                crate::failure::Exit::Usage,
                "{text}"
            );
        }
    }
}
