//! Tables of a drive without a built-in catalogue, made from the descriptions of its parameters.
//!
//! They are made once for each kind of drive and stay in memory until the program ends, as the built-in ones do: so one type
//! serves for both. What is read is owned until there is room for it, so [`MOST_ROWS`] bounds that memory whatever drives send
//! and wherever reading them ends.

use std::sync::{Mutex, PoisonError};

use profile::catalogue::{
    Access, Catalogue, DescriptionFacts, Device, Layout, Meaning, Parameter, ParameterPoint, Scale, Scaling,
    Size, TelegramModule, Words,
};
use profile::notation::Notation;
use profile::parameter::{CodeSpace, Description, Dialect, Format, Identifier, Kind, Octets};
use profile::unit::{ConversionIndex, Variable};
use profinet::controller::Station;

use crate::modules::UNKNOWN;
use profile::model::Model;

/// Most parameters of all kinds of drives together: several hundred kinds of the usual size, about 40 MB.
pub const MOST_ROWS: usize = 131_072;
/// Parameters of one kind.
pub const MOST_PARAMETERS: usize = 4096;
/// Octets of a string in an array of strings, where the description has only their number.
const STRING: u16 = 16;

/// Where these facts are from.
const SOURCE: &str = "description that the drive gives of itself";

/// Dialects tried on an unknown drive: both axis numbers of the vendors, both numberings of the formats. The limits are
/// the lowest of all vendors.
pub static DIALECTS: [Dialect; 4] = [
    dialect(1, CodeSpace::V4),
    dialect(0, CodeSpace::V4),
    dialect(1, CodeSpace::V3),
    dialect(0, CodeSpace::V3),
];

const fn dialect(axis: u8, code_space: CodeSpace) -> Dialect {
    Dialect {
        axis,
        code_space,
        max_parameters: 37,
        max_values: 39,
        ..Dialect::STANDARD
    }
}

/// The same dialect with the other numbering of the formats.
pub fn in_space(dialect: &'static Dialect, space: CodeSpace) -> &'static Dialect {
    let mut known = DIALECTS.iter();
    known
        .find(|one| (one.axis, one.code_space) == (dialect.axis, space))
        .unwrap_or(dialect)
}

/// Formats that only the decimal numbering has.
pub const DECIMAL: std::ops::RangeInclusive<u8> = 0x21..=0x2C;

/// The numbering that the formats of descriptions are in: V3 where one is in its range, as no number of V4 is used there.
pub fn space_of(descriptions: &[(u16, Description)]) -> CodeSpace {
    let codes = || descriptions.iter().map(|(_, one)| one.identifier.format().0);
    if codes().any(|code| (0x71..=0x7C).contains(&code)) {
        CodeSpace::V4
    } else if codes().any(|code| DECIMAL.contains(&code)) {
        CodeSpace::V3
    } else {
        CodeSpace::V4
    }
}

/// What makes drives one kind: vendor, device, and PNU 964.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KindOfDrive {
    pub vendor_id: u16,
    pub device_id: u16,
    /// PNU 964 index 1, if the drive reports it.
    pub unit_type: Option<i64>,
    pub unit: Vec<u8>,
}

/// A kind and its tables.
type Known = (KindOfDrive, &'static Catalogue, &'static Dialect);

static KNOWN: Registry = Registry::new();

/// Returns the tables of a kind if they were made before.
pub fn known(kind: &KindOfDrive) -> Option<(&'static Catalogue, &'static Dialect)> {
    KNOWN.find(kind)
}

/// Makes the tables of a kind out of what its drive reports and stores them; `None` when there is no room for them.
pub fn keep(
    kind: &KindOfDrive,
    dialect: &'static Dialect,
    station: &Station,
    rows: Vec<Row>,
) -> Option<&'static Catalogue> {
    KNOWN.keep(kind, dialect, rows.len(), || {
        let space = dialect.code_space;
        tables(
            station,
            rows.into_iter().map(|row| parameter(row, space)).collect(),
        )
    })
}

/// The tables of all kinds of drives that this program has met.
#[derive(Debug)]
struct Registry(Mutex<Vec<Known>>);

impl Registry {
    const fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    fn find(&self, kind: &KindOfDrive) -> Option<(&'static Catalogue, &'static Dialect)> {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known.iter().find(|(one, ..)| one == kind);
        found.map(|(_, tables, dialect)| (*tables, *dialect))
    }

    fn keep(
        &self,
        kind: &KindOfDrive,
        dialect: &'static Dialect,
        rows: usize,
        tables: impl FnOnce() -> Catalogue,
    ) -> Option<&'static Catalogue> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, tables, _)) = known.iter().find(|(one, ..)| one == kind) {
            return Some(tables);
        }
        // a kind without parameters takes memory too
        let stored: usize = known
            .iter()
            .map(|(_, tables, _)| tables.parameters.len() + 1)
            .sum();
        if stored + rows + 1 > MOST_ROWS {
            return None;
        }
        let tables: &'static Catalogue = Box::leak(Box::new(tables()));
        known.push((kind.clone(), tables, dialect));
        Some(tables)
    }
}

/// What a drive reports of one parameter.
#[derive(Debug)]
pub struct Row {
    pub pnu: u16,
    pub description: Description,
    /// Its texts by their values.
    pub texts: Vec<(i32, String)>,
}

/// The tables out of their rows.
fn tables(station: &Station, parameters: Vec<Parameter>) -> Catalogue {
    let station_type = station.station_type.trim();
    // a drive with the name of a known model must not be mistaken for it
    let model = if station_type.is_empty() || Model::by_name(station_type).is_some() {
        format!("drive 0x{:04X}/0x{:04X}", station.vendor_id, station.device_id)
    } else {
        station_type.to_owned()
    };
    Catalogue::assemble(
        model.leak(),
        Notation::Name,
        Scaling::DELIVERED,
        device_of(station),
        parameters,
    )
}

/// Shortest update time that a drive without a description is asked for, in steps of 31.25 us: 16 ms.
const SLOW: u16 = 512;

/// Returns the assumed device of a drive without a description: telegram 1 in a module of slot 1, one port.
pub fn device_of(station: &Station) -> Device {
    Device {
        vendor_id: station.vendor_id,
        device_id: station.device_id,
        vendor: "",
        station_type: "",
        order_id: "",
        hardware_revision: 0,
        software_revision: [0; 3],
        api: 0x3A00,
        drive_unit_type: 0,
        firmware_year: 0,
        firmware_day_month: 0,
        access_point_module: 1,
        access_point_submodule: 1,
        interface_submodule: 2,
        port_submodule: 3,
        ports: 1,
        layout: Layout {
            telegram: 1,
            parameters: ParameterPoint {
                subslot: 1,
                submodule: None,
            },
            records: &[],
        },
        min_device_interval: SLOW,
        telegrams: &STANDARD,
        description: DescriptionFacts::default(),
    }
}

/// Telegram 1, whose ident numbers are those of the module that is plugged.
const STANDARD: [TelegramModule; 1] = [TelegramModule {
    telegram: 1,
    module: UNKNOWN,
    submodule: UNKNOWN,
    outputs: 4,
    inputs: 4,
    words: Words {
        english: "Standard telegram 1",
        german: "Standardtelegramm 1",
    },
}];

/// What the values of a described parameter are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Values {
    /// As a V4 code.
    pub format: Format,
    pub kind: Kind,
    /// Of one value; 0 where the format does not define it.
    pub octets: usize,
    pub scale: Scale,
    pub unit: &'static str,
}

impl Values {
    /// By type, physical size and conversion index.
    pub fn of(description: &Description, space: CodeSpace) -> Self {
        let wire = description.identifier.format();
        let info = wire.info(space);
        let kind = info.map_or(Kind::Unsigned, |info| info.kind);
        let format = Format::of_code(wire.0, space);
        let (unit, exponent) = if description.identifier.has(Identifier::NO_SCALE) {
            ("", 0)
        } else {
            variable(description).unit()
        };
        let scale = match format {
            Format::N2 => Scale::Percent,
            _ if kind == Kind::Float => Scale::Raw,
            _ => Scale::decimal(exponent),
        };
        Self {
            format,
            kind,
            octets: match info.map(|info| info.octets) {
                Some(Octets::Fixed(octets)) => octets.into(),
                _ => 0,
            },
            scale,
            unit: if scale == Scale::Percent { "%" } else { unit },
        }
    }

    /// Returns the lowest and highest value reported by the drive; none for texts and octets.
    pub fn limits(&self, description: &Description) -> Option<(f64, f64)> {
        if !matches!(self.octets, 1 | 2 | 4) || matches!(self.kind, Kind::Text | Kind::Octets) {
            return None;
        }
        let (low, high) = description.limits(self.octets, self.kind == Kind::Signed)?;
        if self.kind == Kind::Float {
            let float = |octets| f64::from(f32::from_be_bytes(octets));
            return Some((float(description.minimum), float(description.maximum)));
        }
        let rule = Scaling::DELIVERED.linear(self.scale);
        Some((rule.engineering(low), rule.engineering(high)))
    }
}

/// A row of the tables. Its texts stay in memory until the program ends.
fn parameter(row: Row, space: CodeSpace) -> Parameter {
    let Row {
        pnu,
        description,
        texts,
    } = row;
    let description = &description;
    let identifier = description.identifier;
    let values = Values::of(description, space);
    let Values {
        format,
        kind,
        octets,
        scale,
        unit,
    } = values;
    let counted = matches!(kind, Kind::Text | Kind::Octets) || !matches!(octets, 1 | 2 | 4);
    let array = identifier.has(Identifier::ARRAY);
    let limits = values.limits(description);
    let leaked = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
    let choices: Vec<Meaning> = texts
        .into_iter()
        .map(|(value, text)| Meaning {
            value,
            text: leaked(text),
        })
        .collect();
    Parameter {
        pnu,
        base: None,
        name: leaked(description.name().collect()),
        size: match octets {
            1 => Size::Byte,
            2 => Size::Word,
            _ => Size::Dword,
        },
        format,
        length: match (counted, array) {
            (false, _) => 0,
            (true, true) => STRING,
            (true, false) => description.elements.max(1),
        },
        elements: if array { description.elements.max(1) } else { 1 },
        signed: kind == Kind::Signed,
        access: if identifier.has(Identifier::READ_ONLY) {
            Access::ReadOnly
        } else {
            Access::ReadWrite
        },
        saved: !identifier.has(Identifier::READ_ONLY),
        wide: false,
        unit,
        user_unit: false,
        scale,
        variable: variable(description),
        minimum: limits.map(|(low, _)| low),
        maximum: limits.map(|(_, high)| high),
        default: None,
        text: "",
        choices: choices.leak(),
        bits: &[],
        description: "",
        recalled: false,
        source: SOURCE,
    }
}

const fn variable(description: &Description) -> Variable {
    Variable {
        size: description.size_index,
        conversion: ConversionIndex(description.conversion_index),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn described(format: u8, flags: u16) -> Description {
        Description {
            identifier: Identifier(flags | u16::from(format)),
            name: *b"Ramp up time    ",
            size_index: 4,
            conversion_index: -2,
            minimum: 1_u32.to_be_bytes(),
            maximum: 360_000_u32.to_be_bytes(),
            ..Description::default()
        }
    }

    fn made(pnu: u16, description: Description, texts: Vec<(i32, String)>) -> Parameter {
        let row = Row {
            pnu,
            description,
            texts,
        };
        parameter(row, CodeSpace::V3)
    }

    #[test]
    fn a_description_becomes_a_row() {
        let row = made(341, described(7, 0), Vec::new());
        assert_eq!(
            (row.name, row.unit, row.scale),
            ("Ramp up time", "s", Scale::Decimal(-2))
        );
        assert_eq!((row.minimum, row.maximum), (Some(0.01), Some(3600.0)));
        assert_eq!((row.format, row.access), (Format::UNSIGNED32, Access::ReadWrite));
        let row = made(341, described(33, Identifier::READ_ONLY), Vec::new());
        assert_eq!(
            (row.format, row.unit, row.access),
            (Format::N2, "%", Access::ReadOnly)
        );
        let name = Description {
            elements: 20,
            ..described(9, Identifier::NO_SCALE)
        };
        let row = made(1541, name, vec![(1, "one".into())]);
        assert_eq!((row.length, row.elements, row.unit), (20, 1, ""));
        assert_eq!((row.minimum, row.choice(1)), (None, Some("one")));
    }

    #[test]
    fn the_registry_returns_its_tables_and_bounds_their_memory() {
        let kind = |unit: u16| KindOfDrive {
            vendor_id: 0xFFFE,
            device_id: 1,
            unit_type: Some(i64::from(unit)),
            unit: Vec::new(),
        };
        let rows = |count: u16| -> Vec<Parameter> {
            let row = |pnu| made(pnu, described(7, 0), Vec::new());
            (1..=count).map(row).collect()
        };
        let registry = Registry::new();
        let keep = |unit, count: u16| {
            registry.keep(&kind(unit), &DIALECTS[0], count.into(), || {
                tables(&Station::default(), rows(count))
            })
        };
        let first = keep(0, 10).unwrap();
        assert!(std::ptr::eq(first, keep(0, 10).unwrap()));
        assert!(std::ptr::eq(first, registry.find(&kind(0)).unwrap().0));
        let largest = u16::try_from(MOST_PARAMETERS).unwrap();
        let kept = (1..100).filter(|&unit| keep(unit, largest).is_some()).count();
        assert!((31..=32).contains(&kept), "{kept} of the largest size");
        assert!(registry.find(&kind(99)).is_none());
        let no_room = registry.keep(&kind(99), &DIALECTS[0], MOST_PARAMETERS, || {
            panic!("made without room")
        });
        assert!(no_room.is_none());
        let known = registry.keep(&kind(0), &DIALECTS[0], 10, || panic!("made twice"));
        assert!(known.is_some_and(|tables| std::ptr::eq(tables, first)));
        assert!(keep(100, 10).is_some(), "a small kind has room beside them");
    }

    #[test]
    fn the_numbering_of_the_formats_shows_in_them() {
        let of = |format| space_of(&[(1, described(6, 0)), (2, described(format, 0))]);
        assert_eq!(
            (of(33), of(0x71), of(5)),
            (CodeSpace::V3, CodeSpace::V4, CodeSpace::V4)
        );
    }
}
