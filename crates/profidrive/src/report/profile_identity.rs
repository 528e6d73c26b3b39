//! What a drive says about itself in the identification parameters of the profile: PNU 964, 965 and 975.

use std::fmt;

use profile::value::Reading;
use serde::Serialize;

/// Number of the profile (PNU 965, first octet).
const PROFIDRIVE: u8 = 3;

/// What a drive says about itself, beside its identification records. What it does not have is null.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProfileIdentity {
    /// The drive unit (PNU 964).
    pub drive_unit: Option<Software>,
    /// The profile (PNU 965).
    pub profile: Option<ProfileVersion>,
    /// The drive object (PNU 975).
    pub drive_object: Option<DriveObject>,
}

/// Software of a drive unit or of a drive object: `manufacturer 261 (0x0105), type 100, software 1.15, 2017-10-01`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Software {
    /// Number of the manufacturer.
    pub manufacturer: i64,
    /// Type, a number of the manufacturer.
    pub kind: i64,
    /// Version.
    pub version: String,
    /// Date, YYYY-MM-DD.
    pub date: String,
}

/// The profile of a drive: `3 PROFIdrive, version 4.1`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProfileVersion {
    /// Number of the profile; 3 is PROFIdrive.
    pub number: u8,
    /// Version.
    pub version: String,
}

/// One axis, or another object, of a drive unit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DriveObject {
    /// Its software.
    #[serde(flatten)]
    pub software: Software,
    /// Class: 1 is an axis, 5 an encoder.
    pub class: Option<i64>,
    /// DO-ID.
    pub id: Option<i64>,
}

impl ProfileIdentity {
    pub(super) fn of(readings: &[Reading]) -> Self {
        let unit = numbers(readings, 964);
        let object = numbers(readings, 975);
        Self {
            drive_unit: Software::of(&unit),
            profile: match *octets(readings, 965) {
                [number, version, ..] => Some(ProfileVersion {
                    number,
                    version: format!("{}.{}", version / 10, version % 10),
                }),
                _ => None,
            },
            drive_object: Software::of(&object).map(|software| DriveObject {
                software,
                class: object.get(5).copied(),
                id: object.get(7).copied(),
            }),
        }
    }
}

impl Software {
    fn of(numbers: &[i64]) -> Option<Self> {
        let [manufacturer, kind, version, year, day_month, ..] = *numbers else {
            return None;
        };
        Some(Self {
            manufacturer,
            kind,
            version: format!("{}.{:02}", version / 100, version % 100),
            date: date(year, day_month),
        })
    }
}

impl fmt::Display for Software {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            manufacturer,
            kind,
            version,
            date,
        } = self;
        write!(
            f,
            "manufacturer {manufacturer} (0x{manufacturer:04X}), type {kind}, software {version}, {date}"
        )
    }
}

impl fmt::Display for ProfileVersion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.number {
            PROFIDRIVE => "PROFIdrive",
            _ => "other profile",
        };
        write!(f, "{} {name}, version {}", self.number, self.version)
    }
}

impl fmt::Display for DriveObject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.software.fmt(f)?;
        match self.class {
            Some(1) => f.write_str(", axis")?,
            Some(5) => f.write_str(", encoder")?,
            _ => {}
        }
        self.id.map_or(Ok(()), |id| write!(f, ", DO-ID {id}"))
    }
}

/// Year as YYYY, day and month as DDMM.
fn date(year: i64, day_month: i64) -> String {
    format!("{year:04}-{:02}-{:02}", day_month % 100, day_month / 100)
}

/// The elements of a parameter, in their order.
fn numbers(readings: &[Reading], pnu: u16) -> Vec<i64> {
    elements(readings, pnu).filter_map(Reading::raw).collect()
}

fn octets(readings: &[Reading], pnu: u16) -> Vec<u8> {
    elements(readings, pnu)
        .flat_map(|element| element.octets.iter().copied())
        .collect()
}

fn elements(readings: &[Reading], pnu: u16) -> impl Iterator<Item = &Reading> {
    readings.iter().filter(move |reading| reading.pnu == pnu)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn software_is_written_as_the_profile_counts_it() {
        let unit = Software::of(&[261, 100, 115, 2017, 110]).map(|unit| unit.to_string());
        assert_eq!(
            unit.as_deref(),
            Some("manufacturer 261 (0x0105), type 100, software 1.15, 2017-10-01")
        );
        assert_eq!(Software::of(&[261, 100, 115, 2017]), None);
        assert_eq!(date(2010, 1705), "2010-05-17");
    }
}
