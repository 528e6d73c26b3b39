//! Reads the description of a parameter from the drive on request, as limits depend on other settings.

use profile::catalogue::Parameter;
use profile::parameter::{Description, Identifier, Kind};

use super::Session;
use super::parameters::needs_scaling;
use crate::learn::Values;
use crate::{Drive, Error};
use profile::value::Selection;

/// What a drive reports of one of its parameters: its description (attribute 0x20) and its texts (attribute 0x30).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Described {
    /// Name in the words of the drive, at most 16 characters; empty at a serial line, where it does not travel.
    pub name: String,
    /// Name of the data type, if the drive reports a known one.
    pub data_type: Option<&'static str>,
    /// Unit of the limits.
    pub unit: &'static str,
    /// Lowest and highest value.
    pub limits: ReportedLimits,
    /// Number of elements, 1 for what is not an array.
    pub elements: u16,
    /// It cannot be written.
    pub read_only: bool,
    /// It is not as delivered.
    pub changed: bool,
    /// Texts of its values, in order.
    pub texts: Vec<(i32, String)>,
}

/// Limits in a description.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReportedLimits {
    /// No limits are reported.
    None,
    /// No more than what fits the data type.
    OfType(f64, f64),
    /// Limits of its own.
    Own(f64, f64),
}

impl Session {
    /// Asks the drive to describe a parameter; `None` when it does not. Values that are elements of a collecting number
    /// (the application ids of a Vacon) and halves of a 64-bit value have no description of their own and are not
    /// requested.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn described(
        &mut self,
        drive: &mut Drive,
        selection: &Selection,
    ) -> Result<Option<Described>, Error> {
        let row = selection.parameter;
        if needs_scaling(selection) {
            // the limits are shown in the unit of the tables
            self.read_scaling(drive).await?;
        }
        if row.is_some_and(|row| row.base.is_some() || row.wide) {
            return Ok(None);
        }
        let description = match self.descriptions(drive, &[selection.pnu]).await {
            Ok(mut answers) => answers.pop().flatten(),
            // a drive that supports values only
            Err(Error::Record { .. } | Error::Malformed { .. }) => None,
            Err(error) => return Err(error),
        };
        let Some(description) = description else {
            return Ok(None);
        };
        let identifier = description.identifier;
        let texts = if identifier.has(Identifier::TEXT) && !drive.is_on_line() {
            self.texts(drive, selection.pnu).await?
        } else {
            Vec::new()
        };
        let space = drive.model.dialect.code_space;
        let values = Values::of(&description, space);
        let scaled = row.filter(|_| values.kind != Kind::Float);
        Ok(Some(Described {
            name: description.name().collect(),
            data_type: identifier.format().info(space).map(|info| info.name),
            unit: scaled.map_or(values.unit, |row| row.unit_in(&drive.parameters.scaling)),
            limits: limits(&description, values, scaled, drive),
            elements: if identifier.has(Identifier::ARRAY) {
                description.elements.max(1)
            } else {
                1
            },
            read_only: identifier.has(Identifier::READ_ONLY),
            changed: identifier.has(Identifier::CHANGED),
            texts,
        }))
    }
}

/// In the unit of the tables where there are any: values are shown in it too.
fn limits(
    description: &Description,
    values: Values,
    row: Option<&Parameter>,
    drive: &Drive,
) -> ReportedLimits {
    let Some((low, high)) = values.limits(description) else {
        return ReportedLimits::None;
    };
    if values.kind == Kind::Float {
        return ReportedLimits::Own(low, high);
    }
    // Byte, Word and Double word have a sign that only the tables define
    let signed = row.map_or(values.kind == Kind::Signed, |row| row.signed);
    let Some((first, last)) = description.limits(values.octets, signed) else {
        return ReportedLimits::None;
    };
    let (low, high) = row.map_or((low, high), |row| {
        let shown = |raw| row.engineering(raw, &drive.parameters.scaling);
        (shown(first), shown(last))
    });
    let bits = 8 * values.octets;
    let fits = if signed {
        (-(1_i64 << (bits - 1)), (1_i64 << (bits - 1)) - 1)
    } else {
        (0, (1_i64 << bits) - 1)
    };
    if (first, last) == fits {
        ReportedLimits::OfType(low, high)
    } else {
        ReportedLimits::Own(low, high)
    }
}
