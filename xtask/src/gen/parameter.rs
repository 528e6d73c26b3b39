//! Tables of the parameter channels: format codes and error numbers.

use std::fmt::Write as _;
use std::path::Path;

use serde::Deserialize;

use super::Generated;
use crate::Outcome;

const FORMATS: &str = "data/profile/formats.toml";
const ERRORS: &str = "data/profile/parameter-errors.toml";
const PKW_ERRORS: &str = "data/profile/pkw-errors.toml";

/// Returns the generated files of the parameter channel.
pub fn files(root: &Path) -> Outcome<Vec<Generated>> {
    Ok(vec![
        Generated {
            path: "crates/profile/src/parameter/generated_formats.rs".into(),
            from: FORMATS.into(),
            text: formats(&read(root, FORMATS)?)?,
        },
        Generated {
            path: "crates/profile/src/parameter/generated_errors.rs".into(),
            from: ERRORS.into(),
            text: errors(&read(root, ERRORS)?)?,
        },
        Generated {
            path: "crates/profile/src/pkw/generated_errors.rs".into(),
            from: PKW_ERRORS.into(),
            text: pkw_errors(&read(root, PKW_ERRORS)?)?,
        },
    ])
}

fn read<T: for<'a> Deserialize<'a>>(root: &Path, file: &str) -> Outcome<T> {
    let text = std::fs::read_to_string(root.join(file)).map_err(|error| format!("{file}: {error}"))?;
    toml::from_str(&text).map_err(|error| format!("{file}: {error}").into())
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FormatFile {
    v4: Vec<FormatRow>,
    v3: Vec<FormatRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FormatRow {
    code: u8,
    name: String,
    octets: Octets,
    kind: String,
    integer: Option<String>,
    verified: bool,
    source: String,
}

/// The types of V4, for tables that name them.
pub struct Formats(FormatFile);

/// One type.
#[derive(Debug, Clone, Copy)]
pub struct Format<'a> {
    /// Name.
    pub name: &'a str,
    /// V4 code.
    pub code: u8,
    /// Octets of one value, none where the number of values counts octets.
    pub octets: Option<u8>,
    /// Two's complement.
    pub signed: bool,
    /// Characters.
    pub text: bool,
}

impl Formats {
    /// Reads the table.
    pub fn read(root: &Path) -> Outcome<Self> {
        read(root, FORMATS).map(Self)
    }

    /// Returns the type with this name.
    pub fn named(&self, name: &str) -> Outcome<Format<'_>> {
        let row = self.0.v4.iter().find(|row| row.name == name);
        let row = row.ok_or_else(|| format!("{FORMATS} has no type {name:?}"))?;
        let octets = match &row.octets {
            Octets::Fixed(octets) => Some(*octets),
            Octets::Word(_) => None,
        };
        Ok(Format {
            name: &row.name,
            code: row.code,
            octets,
            signed: row.kind == "signed",
            text: row.kind == "text",
        })
    }
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Octets {
    Fixed(u8),
    Word(String),
}

fn formats(file: &FormatFile) -> Outcome<String> {
    let mut text = String::from("use super::format::{FormatInfo, Integer, Kind, Octets};\n\n");
    ascending(FORMATS, file.v4.iter().map(|row| row.code.into()))?;
    // The code space V3 is indexed by code minus 0x21.
    if !file.v3.iter().map(|row| row.code).eq(0x21..=0x2C) {
        return Err(format!("{FORMATS}: v3 has to have the codes 0x21 to 0x2C in order").into());
    }
    for (label, meaning, rows) in [
        (
            "FORMATS",
            "All format codes of PROFIdrive V4, ascending.",
            &file.v4,
        ),
        (
            "V3",
            "The codes 33 to 44 of PROFIdrive V2 and V3, in order.",
            &file.v3,
        ),
    ] {
        writeln!(
            text,
            "/// {meaning}\n#[rustfmt::skip]\npub static {label}: &[FormatInfo] = &["
        )?;
        for row in rows {
            writeln!(
                text,
                "    FormatInfo {{ code: {:#04x}, name: {:?}, octets: {}, kind: {}, integer: {}, verified: {}, source: {:?} }},",
                row.code,
                row.name,
                octets(row)?,
                kind(row)?,
                integer(row)?,
                row.verified,
                row.source
            )?;
        }
        text.push_str("];\n\n");
    }
    Ok(text)
}

fn integer(row: &FormatRow) -> Outcome<&'static str> {
    match row.integer.as_deref() {
        None => Ok("None"),
        Some("number") => Ok("Some(Integer::Number)"),
        Some("bits") => Ok("Some(Integer::Bits)"),
        Some(word) => Err(format!("{FORMATS}: {}: integer {word:?}", row.name).into()),
    }
}

fn octets(row: &FormatRow) -> Outcome<String> {
    match &row.octets {
        Octets::Fixed(octets) => Ok(format!("Octets::Fixed({octets})")),
        Octets::Word(word) => match word.as_str() {
            "counted" => Ok("Octets::Counted".into()),
            "four-or-six" => Ok("Octets::FourOrSix".into()),
            _ => Err(format!("{FORMATS}: {}: octets {word:?}", row.name).into()),
        },
    }
}

fn kind(row: &FormatRow) -> Outcome<&'static str> {
    Ok(match row.kind.as_str() {
        "none" => "Kind::None",
        "signed" => "Kind::Signed",
        "unsigned" => "Kind::Unsigned",
        "float" => "Kind::Float",
        "text" => "Kind::Text",
        "octets" => "Kind::Octets",
        other => return Err(format!("{FORMATS}: {}: kind {other:?}", row.name).into()),
    })
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ErrorFile {
    profile: Vec<ErrorRow>,
    danfoss: Vec<ErrorRow>,
    vacon: Vec<ErrorRow>,
    siemens: Vec<ErrorRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ErrorRow {
    number: u16,
    /// Name of the constant in code; rows of vendors have none.
    constant: Option<String>,
    meaning: String,
    remedy: String,
    #[serde(default)]
    subindex: bool,
    source: String,
}

fn errors(file: &ErrorFile) -> Outcome<String> {
    let mut text = String::from("use super::error::{ErrorInfo, ErrorNumber};\n\nimpl ErrorNumber {\n");
    for row in &file.profile {
        if let Some(constant) = &row.constant {
            writeln!(
                text,
                "    /// {:#04x}: {}.\n    pub const {constant}: Self = Self({:#04x});",
                row.number, row.meaning, row.number
            )?;
        }
    }
    text.push_str("}\n\n");
    for (label, meaning, rows) in [
        (
            "ERRORS",
            "Error numbers of the profile, ascending.",
            &file.profile,
        ),
        ("DANFOSS", "Danfoss VLT.", &file.danfoss),
        ("VACON", "Vacon.", &file.vacon),
        ("SIEMENS", "Siemens SINAMICS.", &file.siemens),
    ] {
        ascending(ERRORS, rows.iter().map(|row| row.number))?;
        writeln!(
            text,
            "/// {meaning}\n#[rustfmt::skip]\npub static {label}: &[ErrorInfo] = &["
        )?;
        for row in rows {
            writeln!(
                text,
                "    ErrorInfo {{ number: {:#04x}, meaning: {:?}, remedy: {:?}, subindex: {}, source: {:?} }},",
                row.number, row.meaning, row.remedy, row.subindex, row.source
            )?;
        }
        text.push_str("];\n\n");
    }
    Ok(text)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PkwErrorFile {
    profile: Vec<PkwErrorRow>,
    danfoss: Vec<PkwErrorRow>,
    siemens: Vec<PkwErrorRow>,
    abb: Vec<PkwErrorRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PkwErrorRow {
    number: u16,
    /// Name of the constant in code; rows of vendors have none.
    constant: Option<String>,
    meaning: String,
    remedy: String,
    source: String,
}

fn pkw_errors(file: &PkwErrorFile) -> Outcome<String> {
    let mut text =
        String::from("use super::error::{PkwErrorInfo, PkwErrorNumber};\n\nimpl PkwErrorNumber {\n");
    for row in &file.profile {
        if let Some(constant) = &row.constant {
            writeln!(
                text,
                "    /// {}: {}.\n    pub const {constant}: Self = Self({});",
                row.number, row.meaning, row.number
            )?;
        }
    }
    text.push_str("}\n\n");
    for (label, meaning, rows) in [
        (
            "PKW_ERRORS",
            "Error numbers that mean the same for every vendor, ascending.",
            &file.profile,
        ),
        ("DANFOSS", "Danfoss.", &file.danfoss),
        ("SIEMENS", "Siemens.", &file.siemens),
        ("ABB", "ABB.", &file.abb),
    ] {
        ascending(PKW_ERRORS, rows.iter().map(|row| row.number))?;
        writeln!(
            text,
            "/// {meaning}\n#[rustfmt::skip]\npub static {label}: &[PkwErrorInfo] = &["
        )?;
        for row in rows {
            writeln!(
                text,
                "    PkwErrorInfo {{ number: {}, meaning: {:?}, remedy: {:?}, source: {:?} }},",
                row.number, row.meaning, row.remedy, row.source
            )?;
        }
        text.push_str("];\n\n");
    }
    Ok(text)
}

fn ascending(file: &str, numbers: impl Iterator<Item = u16>) -> Outcome<()> {
    let numbers: Vec<u16> = numbers.collect();
    match numbers.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => Err(format!("{file}: {:#04x} stands before {:#04x}", pair[0], pair[1]).into()),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_out_of_order_is_refused() {
        assert!(ascending("t", [1, 2, 9].into_iter()).is_ok());
        assert!(ascending("t", [2, 2].into_iter()).is_err());
    }
}
