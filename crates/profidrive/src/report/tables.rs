//! What the verbs report that describe parameters.

use client::{Described, ReportedLimits};
use profile::catalogue::{Access, Catalogue, Meaning};
use profile::notation::Shown;
use profile::value::Parameters;
use serde::Serialize;

use super::Parameter;

/// The parameters of a drive.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ListReport {
    /// The drive.
    pub drive: String,
    /// Name of its model.
    pub model: &'static str,
    /// The parameters as the tables have them.
    pub parameters: Vec<ParameterDescription>,
    /// Their numbers alone, for a drive without tables.
    pub numbers: Vec<u16>,
    /// Their values instead, where they were requested.
    pub values: Vec<Parameter>,
}

/// A parameter as the tables of a model have it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterDescription {
    /// Parameter number.
    pub pnu: u16,
    /// Element of a number that collects parameters.
    pub index: Option<u16>,
    /// The number as the vendor writes it: `p2108`, `1-20`, `ID 103`.
    pub number: String,
    /// The vendor's name.
    pub name: &'static str,
    /// Names that mean the same on the drives of every vendor: `ramp-up`.
    pub common_names: Vec<&'static str>,
    /// What it is.
    pub description: &'static str,
    /// Unit of the value, empty for none.
    pub unit: &'static str,
    /// `read`, `read, write` or `command`.
    pub access: &'static str,
    /// Number of elements.
    pub elements: u16,
    /// Octets of one element.
    pub octets: usize,
    /// Whether the number has a sign.
    pub signed: bool,
    /// Parameter number of the high half of a 64-bit value.
    pub high: Option<u16>,
    /// Whether the drive can keep the value over a power cycle.
    pub saved: bool,
    /// Lowest value; null where only the data type limits it.
    pub minimum: Option<f64>,
    /// Highest value; null where only the data type limits it.
    pub maximum: Option<f64>,
    /// Value as delivered.
    pub default: Option<f64>,
    /// The values of a list.
    pub choices: Vec<ValueText>,
    /// The bits of a word.
    pub bits: Vec<ValueText>,
    /// Where this is from: manual and section.
    pub source: &'static str,
}

/// Where signals and parameters stand in the telegram of a drive.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TelegramLayout {
    /// The drive.
    pub drive: String,
    /// Number of the telegram (PNU 922); null where the drive does not report it.
    pub telegram: Option<u16>,
    /// What is where, setpoints first; empty for a telegram that is not known.
    pub places: Vec<TelegramPlace>,
}

/// A place in a telegram.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TelegramPlace {
    /// `setpoint`, from the controller, or `actual`, from the drive.
    pub direction: &'static str,
    /// First octet in the data of this direction, from 0.
    pub octet: u16,
    /// Number of octets.
    pub octets: u16,
    /// The signal: `NIST_A`; null for a word whose parameter settings of the drive choose.
    pub signal: Option<&'static str>,
    /// What the signal is.
    pub meaning: &'static str,
    /// The parameters with the same value, each as its vendor writes the number.
    pub parameters: Vec<String>,
}

/// A value, or a bit, and what it means.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ValueText {
    /// The value, or the number of the bit.
    pub value: i32,
    /// What it means.
    pub text: String,
}

fn texts(rows: &[Meaning]) -> Vec<ValueText> {
    rows.iter()
        .map(|row| ValueText {
            value: row.value,
            text: row.text.to_owned(),
        })
        .collect()
}

/// Returns the name of the access to a parameter.
#[must_use]
pub const fn access(access: Access) -> &'static str {
    match access {
        Access::ReadOnly => "read",
        Access::ReadWrite => "read, write",
        Access::WriteOnly => "command",
    }
}

/// Returns the number of a parameter as its vendor writes it.
#[must_use]
pub fn number(tables: &Catalogue, parameter: &profile::catalogue::Parameter) -> String {
    Shown {
        pnu: parameter.pnu,
        index: parameter.base,
        writable: Some(parameter.access != Access::ReadOnly),
        notation: tables.notation,
    }
    .to_string()
}

impl ParameterDescription {
    /// Returns a parameter as the tables have it, with the scaling of `drive`.
    #[must_use]
    pub fn new(
        tables: &Catalogue,
        parameter: &'static profile::catalogue::Parameter,
        drive: &Parameters,
    ) -> Self {
        let (low, high) = drive.limits(parameter);
        Self {
            pnu: parameter.pnu,
            index: parameter.base,
            number: number(tables, parameter),
            name: parameter.name,
            common_names: tables.common_names(parameter).map(|common| common.name).collect(),
            description: parameter.description,
            unit: parameter.unit_in(&drive.scaling),
            access: access(parameter.access),
            elements: parameter.elements,
            octets: parameter.size.octets(),
            signed: parameter.signed,
            high: parameter.high(),
            saved: tables.is_kept(parameter),
            minimum: parameter.minimum.map(|_| low),
            maximum: parameter.maximum.map(|_| high),
            default: parameter.default_in(&drive.scaling),
            choices: texts(parameter.choices),
            bits: texts(parameter.bits),
            source: parameter.source,
        }
    }
}

/// One parameter in full.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DescribeReport {
    /// The drive.
    pub drive: String,
    /// Name of its model.
    pub model: &'static str,
    /// The parameter as the tables have it; null where they do not.
    pub parameter: Option<ParameterDescription>,
    /// What lets the drive save the value over a power cycle: `nothing`, `every-write`, `request` (a write that requests it) or
    /// `command` (for all values at once); null where it is in no table.
    pub saved_by: Option<&'static str>,
    /// How the number that travels becomes a value: `raw 1000 = 1 rpm/s`.
    pub scaling: Option<String>,
    /// How the drive describes it; null where it does not.
    pub reported: Option<ReportedDescription>,
    /// Its values now.
    pub values: Vec<Parameter>,
}

/// A parameter as a drive describes it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReportedDescription {
    /// Name in the words of the drive.
    pub name: Option<String>,
    /// Name of the data type.
    pub data_type: Option<&'static str>,
    /// Unit of the limits.
    pub unit: &'static str,
    /// Lowest value; null where only the data type limits it.
    pub minimum: Option<f64>,
    /// Highest value; null where only the data type limits it.
    pub maximum: Option<f64>,
    /// Number of elements.
    pub elements: u16,
    /// Whether it cannot be written.
    pub read_only: bool,
    /// Whether it differs from the value as delivered.
    pub changed: bool,
    /// Texts of its values.
    pub texts: Vec<ValueText>,
}

impl From<&Described> for ReportedDescription {
    fn from(described: &Described) -> Self {
        let (minimum, maximum) = match described.limits {
            ReportedLimits::Own(low, high) => (Some(low), Some(high)),
            _ => (None, None),
        };
        let texts = described.texts.iter().map(|(value, text)| ValueText {
            value: *value,
            text: text.clone(),
        });
        Self {
            name: Some(described.name.clone()).filter(|name| !name.is_empty()),
            data_type: described.data_type,
            unit: described.unit,
            minimum,
            maximum,
            elements: described.elements,
            read_only: described.read_only,
            changed: described.changed,
            texts: texts.collect(),
        }
    }
}
