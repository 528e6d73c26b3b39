//! Descriptions of parameters (attribute 0x20) and their texts (attribute 0x30) in words.

use profile::parameter::{CodeSpace, Description, Identifier, Kind};
use profile::unit::{ConversionIndex, Variable};

use crate::number;

/// What the elements of a description are, 1 to 12.
const ELEMENTS: [&str; 12] = [
    "identifier",
    "number of elements",
    "standardisation factor",
    "variable attribute",
    "reserved",
    "name",
    "lower limit",
    "upper limit",
    "reserved",
    "extension of the identifier",
    "reference parameter",
    "normalisation",
];
/// Octets of a text.
const TEXT: usize = 16;

/// Returns the name of an element of a description; 0 is all of it.
pub fn element(number: u16) -> String {
    let name = usize::from(number)
        .checked_sub(1)
        .and_then(|place| ELEMENTS.get(place));
    match (number, name) {
        (0, _) => "description".into(),
        (_, Some(name)) => format!("description element {number} ({name})"),
        (_, None) => format!("description element {number}"),
    }
}

/// Returns a whole description: name, type, limits and unit, what may be done.
pub fn words(description: &Description, space: CodeSpace) -> String {
    let name: String = description.name().collect();
    let mut text = format!("\"{}\"", name.trim_end());
    for part in [
        identifier(description.identifier, space),
        elements(description),
        limits(description, space),
        variable(description),
    ] {
        if !part.is_empty() {
            text = format!("{text}, {part}");
        }
    }
    text
}

/// Type and flags.
pub fn identifier(identifier: Identifier, space: CodeSpace) -> String {
    let format = identifier.format();
    let mut text = format
        .info(space)
        .map_or_else(|| format!("format 0x{:02X}", format.0), |row| row.name.to_owned());
    for (flag, words) in [
        (Identifier::READ_ONLY, "read-only"),
        (Identifier::RESET_ONLY, "only 0 can be written"),
        (Identifier::CHANGED, "not as delivered"),
        (Identifier::TEXT, "has texts"),
    ] {
        if identifier.has(flag) {
            text = format!("{text}, {words}");
        }
    }
    text
}

fn elements(description: &Description) -> String {
    if description.identifier.has(Identifier::ARRAY) {
        format!("array of {}", description.elements)
    } else {
        String::new()
    }
}

fn scaled(description: &Description) -> Option<(&'static str, i8)> {
    let variable = Variable {
        size: description.size_index,
        conversion: ConversionIndex(description.conversion_index),
    };
    (!description.identifier.has(Identifier::NO_SCALE)).then(|| variable.unit())
}

fn limits(description: &Description, space: CodeSpace) -> String {
    let kind = description.identifier.format().info(space).map(|row| row.kind);
    let (unit, power) = scaled(description).unwrap_or(("", 0));
    let value = |octets: [u8; 4]| {
        let engineering = match kind {
            Some(Kind::Signed) => f64::from(i32::from_be_bytes(octets)),
            Some(Kind::Unsigned) => f64::from(u32::from_be_bytes(octets)),
            Some(Kind::Float) => return Some(f64::from(f32::from_be_bytes(octets))),
            _ => return None,
        };
        Some(engineering * 10_f64.powi(power.into()))
    };
    match (value(description.minimum), value(description.maximum)) {
        (Some(low), Some(high)) => format!("{} to {} {unit}", number(low), number(high))
            .trim_end()
            .to_owned(),
        _ => String::new(),
    }
}

fn variable(description: &Description) -> String {
    match scaled(description) {
        Some(_) => format!(
            "physical size {}, conversion index {}",
            description.size_index, description.conversion_index
        ),
        None => String::new(),
    }
}

/// Texts of 16 octets each.
pub fn texts(octets: &[u8]) -> Option<String> {
    if octets.is_empty() || !octets.len().is_multiple_of(TEXT) {
        return None;
    }
    let text = |octets: &[u8]| {
        let text = String::from_utf8_lossy(octets);
        format!("\"{}\"", text.trim_end_matches(['\0', ' ']))
    };
    Some(octets.chunks_exact(TEXT).map(text).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::parameter::Format;

    #[test]
    fn a_description_has_type_limits_and_unit() {
        let description = Description {
            identifier: Identifier(Identifier::TEXT | u16::from(Format(6).0)),
            size_index: 28,
            conversion_index: -1,
            name: *b"Motor Speed High",
            minimum: 0_u32.to_be_bytes(),
            maximum: 1320_u32.to_be_bytes(),
            ..Description::default()
        };
        assert_eq!(
            words(&description, CodeSpace::V3),
            "\"Motor Speed High\", Unsigned16, has texts, 0 to 132 Hz, physical size 28, conversion index -1"
        );
        let read_only = Description {
            identifier: Identifier(Identifier::READ_ONLY | Identifier::ARRAY | Identifier::NO_SCALE | 9),
            elements: 10,
            ..Description::default()
        };
        assert_eq!(
            words(&read_only, CodeSpace::V3),
            "\"\", VisibleString, read-only, array of 10"
        );
    }

    #[test]
    fn texts_stand_in_sixteen_octets() {
        assert_eq!(
            texts(b"Speed open loop Torque          ").as_deref(),
            Some("\"Speed open loop\", \"Torque\"")
        );
        assert_eq!(texts(b"short"), None);
    }

    #[test]
    fn elements_by_name() {
        assert_eq!(element(1), "description element 1 (identifier)");
        assert_eq!(
            (element(0).as_str(), element(13).as_str()),
            ("description", "description element 13")
        );
    }
}
