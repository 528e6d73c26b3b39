//! Cyclic data of a submodule.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;

use crate::text::TextId;

/// `IOData`: cyclic data of a submodule.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IoData {
    /// From the device to the controller.
    pub input: Option<DataDescription>,
    /// From the controller to the device.
    pub output: Option<DataDescription>,
    /// Octets of the provider status, 1 nearly always.
    pub iops_length: u8,
    /// Octets of the consumer status, 1 nearly always.
    pub iocs_length: u8,
}

impl Default for IoData {
    fn default() -> Self {
        Self {
            input: None,
            output: None,
            iops_length: 1,
            iocs_length: 1,
        }
    }
}

impl IoData {
    /// Octets from the device.
    #[must_use]
    pub fn input_length(&self) -> u32 {
        self.input.as_ref().map_or(0, DataDescription::length)
    }

    /// Octets to the device.
    #[must_use]
    pub fn output_length(&self) -> u32 {
        self.output.as_ref().map_or(0, DataDescription::length)
    }
}

/// `Input` or `Output`: what the octets of one direction are.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct DataDescription {
    /// What belongs together.
    pub consistency: Consistency,
    /// The items in order, without gaps.
    pub items: Vec<DataItem>,
}

impl DataDescription {
    /// Octets of all items.
    #[must_use]
    pub fn length(&self) -> u32 {
        self.items
            .iter()
            .fold(0, |sum, item| sum.saturating_add(item.octets()))
    }
}

/// What a controller must not see half old and half new.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Consistency {
    /// Each item by itself.
    #[default]
    Item,
    /// All items together.
    All,
}

impl Consistency {
    /// As the file writes it.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Item => "Item consistency",
            Self::All => "All items consistency",
        }
    }
}

/// `DataItem`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataItem {
    /// Its type.
    pub data_type: DataType,
    /// Octets of a type without a length of its own.
    pub length: Option<u16>,
    /// Name.
    pub text: Option<TextId>,
    /// Whether tools show the bits.
    pub use_as_bits: bool,
    /// Names of bits.
    pub bits: Vec<BitItem>,
}

impl DataItem {
    /// Creates a plain item of a type with a length of its own.
    #[must_use]
    pub const fn new(data_type: DataType, text: TextId) -> Self {
        Self {
            data_type,
            length: None,
            text: Some(text),
            use_as_bits: false,
            bits: Vec::new(),
        }
    }

    /// Returns its length; 0 when neither the type nor the item defines it.
    #[must_use]
    pub fn octets(&self) -> u32 {
        match self.data_type.octets() {
            Some(octets) => octets,
            None => self.length.map_or(0, u32::from),
        }
    }
}

/// `BitDataItem`: name of a bit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BitItem {
    /// Which bit, 0 is the lowest.
    pub offset: u8,
    /// Its name.
    pub text: Option<TextId>,
}

/// Types of data items: the name in the file and the octets, `None` when the item defines them.
const TYPES: &[(&str, Option<u32>)] = &[
    ("Boolean", Some(1)),
    ("Integer8", Some(1)),
    ("Integer16", Some(2)),
    ("Integer32", Some(4)),
    ("Integer64", Some(8)),
    ("Unsigned8", Some(1)),
    ("Unsigned16", Some(2)),
    ("Unsigned32", Some(4)),
    ("Unsigned64", Some(8)),
    ("Float32", Some(4)),
    ("Float64", Some(8)),
    ("Date", Some(7)),
    ("TimeOfDay with date indication", Some(6)),
    ("TimeOfDay without date indication", Some(4)),
    ("TimeDifference with date indication", Some(6)),
    ("TimeDifference without date indication", Some(4)),
    ("NetworkTime", Some(8)),
    ("NetworkTimeDifference", Some(8)),
    ("Unsigned8+Unsigned8", Some(2)),
    ("Float32+Unsigned8", Some(5)),
    ("Float32+Status8", Some(5)),
    ("F_MessageTrailer4Byte", Some(4)),
    ("F_MessageTrailer5Byte", Some(5)),
    ("VisibleString", None),
    ("OctetString", None),
    ("UnicodeString8", None),
];

/// Type of a data item.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DataType {
    /// A supported type, by its name.
    Known(&'static str),
    /// Another one, as the file writes it; its length stands with the item.
    Other(String),
}

impl DataType {
    /// `Unsigned16`.
    pub const UNSIGNED16: Self = Self::Known("Unsigned16");
    /// `Integer16`.
    pub const INTEGER16: Self = Self::Known("Integer16");
    /// `Unsigned32`.
    pub const UNSIGNED32: Self = Self::Known("Unsigned32");
    /// `Integer32`.
    pub const INTEGER32: Self = Self::Known("Integer32");

    /// Returns the type with this name.
    #[must_use]
    pub fn of(name: &str) -> Self {
        match TYPES.iter().find(|(known, _)| *known == name) {
            Some((known, _)) => Self::Known(known),
            None => Self::Other(name.into()),
        }
    }

    /// As the file writes it.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Known(name) => name,
            Self::Other(name) => name,
        }
    }

    /// Octets; `None` when the item defines them.
    #[must_use]
    pub fn octets(&self) -> Option<u32> {
        TYPES
            .iter()
            .find(|(known, _)| *known == self.name())
            .and_then(|(_, octets)| *octets)
    }
}

impl fmt::Display for DataType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
