//! Tables of the profile: signals and telegrams.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use serde::Deserialize;

use super::Generated;
use crate::Outcome;

/// Returns the generated files of the profile.
pub fn files(root: &Path) -> Outcome<Vec<Generated>> {
    let signals: SignalFile = read(root, "data/profile/signals.toml")?;
    let telegrams: TelegramFile = read(root, "data/profile/telegrams.toml")?;
    Ok(vec![Generated {
        path: "crates/profile/src/telegram/generated.rs".into(),
        from: "data/profile/".into(),
        text: render(&signals, &telegrams)?,
    }])
}

fn read<T: for<'a> Deserialize<'a>>(root: &Path, file: &str) -> Outcome<T> {
    let text = std::fs::read_to_string(root.join(file)).map_err(|error| format!("{file}: {error}"))?;
    toml::from_str(&text).map_err(|error| format!("{file}: {error}").into())
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SignalFile {
    vendor: BTreeMap<String, u16>,
    signal: Vec<Signal>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Signal {
    number: u16,
    name: String,
    vendor: Option<String>,
    bits: u8,
    signed: bool,
    direction: String,
    meaning: String,
    #[serde(default)]
    common: String,
    #[serde(default)]
    assumed: Vec<String>,
    source: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TelegramFile {
    telegram: Vec<Telegram>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Telegram {
    number: u16,
    vendor: Option<String>,
    #[serde(default)]
    free: bool,
    #[serde(default)]
    pkw: bool,
    #[serde(default)]
    parameters: bool,
    #[serde(default)]
    own_words: bool,
    full_speed: Option<u16>,
    setpoint: Vec<String>,
    actual: Vec<String>,
    words: [u16; 2],
    #[serde(default)]
    assumed: Vec<String>,
    source: String,
}

fn render(signals: &SignalFile, telegrams: &TelegramFile) -> Outcome<String> {
    let vendor = |name: &Option<String>| -> Outcome<String> {
        let Some(name) = name else {
            return Ok("None".to_owned());
        };
        let number = signals
            .vendor
            .get(name)
            .ok_or_else(|| format!("no vendor {name}"))?;
        Ok(format!("Some({number:#06x})"))
    };
    let mut text = String::from("use super::{Direction::*, Field, Image, Signal, Telegram};\n\n");
    let mut seen = Vec::new();
    let mut rows = String::new();
    for signal in &signals.signal {
        let place = format!("signal {} {}", signal.number, signal.name);
        if seen.contains(&(signal.number, &signal.vendor)) {
            return Err(format!("{place}: twice").into());
        }
        seen.push((signal.number, &signal.vendor));
        if (signal.number >= 100) != signal.vendor.is_some() || signal.number == 0 {
            return Err(format!("{place}: numbers from 100 on are a vendor's").into());
        }
        if !matches!(signal.bits, 16 | 32 | 64) {
            return Err(format!("{place}: {} bits", signal.bits).into());
        }
        known(&place, &signal.assumed, &["number", "signed"])?;
        let direction = match signal.direction.as_str() {
            "setpoint" => "Setpoint",
            "actual" => "Actual",
            "either" => "Either",
            other => return Err(format!("{place}: direction {other}").into()),
        };
        writeln!(
            rows,
            "    Signal {{ number: {}, name: {:?}, vendor: {}, bits: {}, signed: {}, direction: {direction}, \
             meaning: {:?}, common: {:?}, source: {:?} }},",
            signal.number,
            signal.name,
            vendor(&signal.vendor)?,
            signal.bits,
            signal.signed,
            signal.meaning,
            signal.common,
            signal.source,
        )?;
    }
    writeln!(
        text,
        "/// All signals.\n#[rustfmt::skip]\npub static SIGNALS: [Signal; {}] = [\n{rows}];\n",
        signals.signal.len()
    )?;

    writeln!(
        text,
        "/// All telegrams.\n#[rustfmt::skip]\npub static TELEGRAMS: [Telegram; {}] = [",
        telegrams.telegram.len()
    )?;
    let mut seen = Vec::new();
    for telegram in &telegrams.telegram {
        let place = format!("telegram {} {:?}", telegram.number, telegram.vendor);
        if seen.contains(&(telegram.number, &telegram.vendor)) {
            return Err(format!("{place}: twice").into());
        }
        seen.push((telegram.number, &telegram.vendor));
        known(&place, &telegram.assumed, &["setpoint", "actual"])?;
        let image = |names: &[String], words: u16, direction: &str| {
            image(&signals.signal, telegram, names, words, direction)
                .map_err(|error| format!("{place}: {error}"))
        };
        writeln!(
            text,
            "    Telegram {{\n        number: {}, vendor: {}, free: {}, pkw: {}, parameters: {}, own_words: {}, \
             full_speed: {:?},\n        setpoint: {},\n        \
             actual: {},\n        source: {:?},\n    }},",
            telegram.number,
            vendor(&telegram.vendor)?,
            telegram.free,
            telegram.pkw,
            telegram.parameters,
            telegram.own_words,
            telegram.full_speed,
            image(&telegram.setpoint, telegram.words[0], "setpoint")?,
            image(&telegram.actual, telegram.words[1], "actual")?,
            telegram.source,
        )?;
    }
    text.push_str("];\n\n");
    text.push_str(&render_numbers(&signals.signal)?);
    Ok(text)
}

fn known(place: &str, words: &[String], allowed: &[&str]) -> Outcome<()> {
    match words.iter().find(|word| !allowed.contains(&word.as_str())) {
        Some(word) => Err(format!("{place}: assumed {word}").into()),
        None => Ok(()),
    }
}

/// Octets of the parameter channel in front.
const PKW_OCTETS: u16 = 8;

/// Returns the half of a telegram in one direction: each signal with its offset.
fn image(
    signals: &[Signal],
    telegram: &Telegram,
    names: &[String],
    words: u16,
    direction: &str,
) -> Outcome<String> {
    let mut fields = Vec::new();
    let mut offset = if telegram.pkw { PKW_OCTETS } else { 0 };
    for name in names {
        if name == "-" {
            offset += 2;
            continue;
        }
        let find = |vendor: &Option<String>| {
            signals
                .iter()
                .position(|signal| signal.name == *name && signal.vendor == *vendor)
        };
        let position = find(&telegram.vendor)
            .or_else(|| find(&None))
            .ok_or_else(|| format!("no signal {name}"))?;
        let signal = &signals[position];
        if signal.direction != direction && signal.direction != "either" {
            return Err(format!("{name} is no {direction}").into());
        }
        fields.push(format!(
            "            Field {{ signal: &SIGNALS[{position}], offset: {offset} }}, // {name}\n"
        ));
        offset += u16::from(signal.bits / 8);
    }
    if offset != 2 * words {
        return Err(format!("{direction} has {} words, not {words}", offset / 2).into());
    }
    let fields = if fields.is_empty() {
        String::new()
    } else {
        format!("\n{}        ", fields.concat())
    };
    Ok(format!("Image {{ fields: &[{fields}], octets: {offset} }}"))
}

/// Constants for the numbers, those of a vendor in a module of their own.
fn render_numbers(signals: &[Signal]) -> Outcome<String> {
    let mut groups: BTreeMap<Option<&str>, String> = BTreeMap::new();
    for signal in signals {
        let group = groups.entry(signal.vendor.as_deref()).or_default();
        writeln!(
            group,
            "/// {}.\npub const {}: u16 = {};",
            signal.meaning, signal.name, signal.number
        )?;
    }
    let mut text = String::from("/// Signal numbers by name.\npub mod signal {\n");
    for (vendor, constants) in groups {
        match vendor {
            None => text.push_str(&constants),
            Some(vendor) => writeln!(
                text,
                "/// Signal numbers of this vendor.\npub mod {vendor} {{\n{constants}}}"
            )?,
        }
    }
    text.push_str("}\n");
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(telegram: &str) -> Outcome<String> {
        let signals = toml::from_str(
            "[vendor]\nx = 0x1234\n\
             [[signal]]\nnumber = 1\nname = \"A\"\nbits = 16\nsigned = false\ndirection = \"setpoint\"\nmeaning = \"a\"\n\
             source = \"s\"\n\
             [[signal]]\nnumber = 2\nname = \"B\"\nbits = 32\nsigned = true\ndirection = \"either\"\nmeaning = \"b\"\n\
             source = \"s\"\n",
        )?;
        render(&signals, &toml::from_str(telegram)?)
    }

    #[test]
    fn offsets_and_gaps() {
        let text = file(
            "[[telegram]]\nnumber = 7\nvendor = \"x\"\nsetpoint = [\"A\", \"-\", \"B\"]\nactual = [\"B\"]\nwords = [4, 2]\n\
             source = \"s\"\n",
        )
        .unwrap();
        assert!(text.contains("signal: &SIGNALS[1], offset: 4"), "{text}");
        assert!(text.contains("octets: 8"), "{text}");
        assert!(text.contains("vendor: Some(0x1234)"), "{text}");
    }

    #[test]
    fn the_parameter_channel_comes_first() {
        let text = file(
            "[[telegram]]\nnumber = 7\nvendor = \"x\"\npkw = true\nsetpoint = [\"A\", \"-\"]\nactual = []\n\
             words = [6, 4]\nsource = \"s\"\n",
        )
        .unwrap();
        assert!(text.contains("signal: &SIGNALS[0], offset: 8"), "{text}");
        assert!(text.contains("pkw: true"), "{text}");
    }

    #[test]
    fn lengths_directions_and_names_are_checked() {
        let telegram = |setpoint: &str, actual: &str, words: &str| {
            file(&format!(
                "[[telegram]]\nnumber = 7\nsetpoint = [{setpoint}]\nactual = [{actual}]\nwords = {words}\nsource = \"s\"\n"
            ))
            .map_err(|error| error.to_string())
        };
        assert!(
            telegram("\"A\"", "", "[2, 0]")
                .unwrap_err()
                .contains("has 1 words")
        );
        assert!(
            telegram("", "\"A\"", "[0, 1]")
                .unwrap_err()
                .contains("A is no actual")
        );
        assert!(
            telegram("\"C\"", "", "[1, 0]")
                .unwrap_err()
                .contains("no signal C")
        );
        assert!(telegram("\"A\"", "\"B\"", "[1, 2]").is_ok());
    }
}
