//! A parameter that was written to a drive, for the trace.

use std::fmt;

use profile::catalogue::Catalogue;
use profile::notation::{Shown, figures};
use serde::Serialize;
use virtual_drive::drive::{WriteChannel, Written, WrittenValue};

/// A parameter as its drive reports it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterReading {
    /// Name of the vendor; empty where it has none.
    pub name: String,
    /// As its vendor writes its number: `p2108`, `3-41`, `ID 103`.
    pub parameter: String,
    /// Parameter number.
    pub pnu: u16,
    /// Subindex on the wire; of a string the place of its first octet.
    pub index: u16,
    /// A number in `unit`, or a text.
    pub value: ReadingValue,
    /// Unit of the number, empty for none.
    pub unit: &'static str,
    /// The number as on the wire, sign included; null for a text.
    pub raw: Option<i64>,
    /// Text of the value of an enumeration.
    pub text: Option<&'static str>,
}

/// Value of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ReadingValue {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}

/// How a change of a parameter reached the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum WrittenBy {
    /// A record of a connection: a parameter job, or a record that is a parameter itself.
    Record,
    /// The parameter channel (PKW), cyclic or at a serial line.
    Pkw,
    /// Anything else: the owner of the simulation.
    Other,
}

impl ParameterReading {
    pub(crate) fn of(written: &Written, catalogue: &Catalogue) -> Self {
        let Written {
            pnu, subindex: index, ..
        } = *written;
        let found = catalogue.at(pnu, index);
        let element = found.is_some_and(|parameter| parameter.is_array() || parameter.base.is_some());
        let shown = Shown {
            pnu,
            index: element.then_some(index),
            writable: Some(true),
            notation: catalogue.notation,
        };
        let (value, raw) = match &written.value {
            WrittenValue::Number { raw, value } => (ReadingValue::Number(*value), Some(*raw)),
            WrittenValue::Text(text) => (ReadingValue::Text(text.clone()), None),
        };
        Self {
            name: found.map_or("", |parameter| parameter.name).to_owned(),
            parameter: shown.to_string(),
            pnu,
            index,
            value,
            unit: found.map_or("", |parameter| parameter.unit),
            raw,
            text: raw.and_then(|raw| found?.choice(raw)),
        }
    }
}

impl From<WriteChannel> for WrittenBy {
    fn from(channel: WriteChannel) -> Self {
        match channel {
            WriteChannel::Record => Self::Record,
            WriteChannel::Pkw => Self::Pkw,
            WriteChannel::Other => Self::Other,
        }
    }
}

impl fmt::Display for WrittenBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Record => "a record",
            Self::Pkw => "the parameter channel",
            Self::Other => "the simulation",
        })
    }
}

impl fmt::Display for ParameterReading {
    /// `p2108 DRV.ACC = 5000 rpm/s`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // a name of the vendor that is no number stands beside it where people write the number
        f.write_str(&self.parameter)?;
        if !self.name.is_empty() && self.name != self.parameter {
            write!(f, " {}", self.name)?;
        }
        match &self.value {
            ReadingValue::Text(text) => write!(f, " = \"{}\"", text.escape_debug()),
            ReadingValue::Number(value) => {
                write!(f, " = {}", figures(*value))?;
                if !self.unit.is_empty() {
                    write!(f, " {}", self.unit)?;
                }
                self.text.map_or(Ok(()), |text| write!(f, " ({text})"))
            }
        }
    }
}
