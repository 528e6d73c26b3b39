//! The name of a device description file.

use alloc::format;
use alloc::string::String;
use core::fmt;
use core::str::FromStr;

use crate::value::{SchemaVersion, shortened};

/// `GSDML-V2.35-vendor-family-20260101.xml`, before `.xml` perhaps `-103000` with a time.
///
/// Engineering tools refuse a file whose name is not made this way, and take the newest of several with the same vendor
/// and family by the date in the name.
///
/// ```
/// use profidrive_gsdml::FileName;
/// let name: FileName = "GSDML-V2.3-LENZE-8440PN200-20141030-010000.xml".parse().unwrap();
/// assert_eq!((name.vendor.as_str(), name.family.as_str()), ("LENZE", "8440PN200"));
/// assert_eq!(name.date, 20141030);
/// assert_eq!(name.to_string(), "GSDML-V2.3-LENZE-8440PN200-20141030-010000.xml");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileName {
    /// Version of the schema.
    pub version: SchemaVersion,
    /// The vendor.
    pub vendor: String,
    /// The device family; may contain hyphens.
    pub family: String,
    /// Date as the number YYYYMMDD.
    pub date: u32,
    /// Time as the number HHMMSS.
    pub time: Option<u32>,
}

/// Reason why a file name violates the naming rule.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FileNameError {
    /// It does not begin as it must.
    #[error("the name begins with `{0}`, not with `GSDML-`")]
    Prefix(String),
    /// It does not end as it must.
    #[error("the name does not end in `.xml`")]
    Ending,
    /// The second part is not a version.
    #[error("`{0}` is not a schema version such as V2.35")]
    Version(String),
    /// Parts are missing.
    #[error("the name is not GSDML-Vx.yy-vendor-family-YYYYMMDD.xml")]
    Parts,
    /// The last part is not a date.
    #[error("`{0}` is not a date as YYYYMMDD")]
    Date(String),
}

impl fmt::Display for FileName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            version,
            vendor,
            family,
            date,
            time,
        } = self;
        write!(f, "GSDML-{version}-{vendor}-{family}-{date:08}")?;
        if let Some(time) = time {
            write!(f, "-{time:06}")?;
        }
        f.write_str(".xml")
    }
}

impl FromStr for FileName {
    type Err = FileNameError;

    /// Case of the ending does not matter, and neither does that of `GSDML`.
    fn from_str(name: &str) -> Result<Self, FileNameError> {
        let cut = name.len().checked_sub(4).filter(|at| name.is_char_boundary(*at));
        let (stem, ending) = name.split_at(cut.ok_or(FileNameError::Ending)?);
        if !ending.eq_ignore_ascii_case(".xml") {
            return Err(FileNameError::Ending);
        }
        let (prefix, rest) = stem.split_once('-').ok_or(FileNameError::Parts)?;
        if !prefix.eq_ignore_ascii_case("GSDML") {
            return Err(FileNameError::Prefix(shortened(prefix)));
        }
        let (version, rest) = rest.split_once('-').ok_or(FileNameError::Parts)?;
        let version = version
            .parse()
            .map_err(|_| FileNameError::Version(shortened(version)))?;
        let (vendor, rest) = rest.split_once('-').ok_or(FileNameError::Parts)?;
        let (rest, last) = rest.rsplit_once('-').ok_or(FileNameError::Parts)?;
        let (family, day, time) = match (rest.rsplit_once('-'), clock(last)) {
            (Some((family, day)), Some(time)) if date(day).is_some() => (family, day, Some(time)),
            _ => (rest, last, None),
        };
        let date = date(day).ok_or_else(|| FileNameError::Date(shortened(last)))?;
        if vendor.is_empty() || family.is_empty() {
            return Err(FileNameError::Parts);
        }
        Ok(Self {
            version,
            vendor: vendor.into(),
            family: family.into(),
            date,
            time,
        })
    }
}

impl FileName {
    /// Returns the name of the picture that belongs to a device: `GSDML-vvvv-dddd-name`, without ending.
    #[must_use]
    pub fn picture(vendor_id: u16, device_id: u16, name: &str) -> String {
        format!("GSDML-{vendor_id:04X}-{device_id:04X}-{name}")
    }
}

fn digits(text: &str, count: usize) -> Option<u32> {
    (text.len() == count && text.bytes().all(|c| c.is_ascii_digit())).then(|| text.parse().ok())?
}

/// Returns a date of the calendar.
fn date(text: &str) -> Option<u32> {
    let number = digits(text, 8)?;
    let (year, month, day) = (number / 10_000, number / 100 % 100, number % 100);
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let last = match month {
        2 if leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => return None,
    };
    (year >= 1900 && (1..=last).contains(&day)).then_some(number)
}

/// Returns a time of the day.
fn clock(text: &str) -> Option<u32> {
    let number = digits(text, 6)?;
    (number / 10_000 < 24 && number / 100 % 100 < 60 && number % 100 < 60).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    #[test]
    fn names_of_vendors() {
        for (name, vendor, family) in [
            ("GSDML-V2.1-KOLLMORGEN-AKD-20140301.XML", "KOLLMORGEN", "AKD"),
            (
                "GSDML-V2.1-BOSCH REXROTH AG-011F-INDRADRIVE_01V01-20110705.xml",
                "BOSCH REXROTH AG",
                "011F-INDRADRIVE_01V01",
            ),
            ("GSDML-V2.41-FESTO-CMMT-AS-20230601.xml", "FESTO", "CMMT-AS"),
            ("GSDML-V2.2-SEW-UCS50B_PN-20151006-104600.xml", "SEW", "UCS50B_PN"),
        ] {
            let parsed: FileName = name.parse().unwrap();
            assert_eq!((parsed.vendor.as_str(), parsed.family.as_str()), (vendor, family));
            assert_eq!(parsed.to_string().to_ascii_lowercase(), name.to_ascii_lowercase());
        }
    }

    #[test]
    fn names_against_the_rule() {
        let error = |name: &str| name.parse::<FileName>().unwrap_err();
        assert_eq!(error("GSDML-V2.3-A-B-20140301.xm"), FileNameError::Ending);
        assert_eq!(error("xml"), FileNameError::Ending);
        assert_eq!(error("ü.xml"), FileNameError::Parts);
        assert_eq!(
            error("GSD-V2.3-A-B-20140301.xml"),
            FileNameError::Prefix("GSD".into())
        );
        assert_eq!(
            error("GSDML-2.3-A-B-20140301.xml"),
            FileNameError::Version("2.3".into())
        );
        for date in [
            "20140230",
            "20141301",
            "20140100",
            "2014031",
            "0",
            "２０１４０３０１",
        ] {
            let name = format!("GSDML-V2.3-A-B-{date}.xml");
            assert_eq!(error(&name), FileNameError::Date(date.into()));
        }
        assert_eq!(error("GSDML-V2.3-A-20140301.xml"), FileNameError::Parts);
        assert_eq!(error("GSDML-V2.3--B-20140301.xml"), FileNameError::Parts);
        // an invalid time matches nothing
        assert!(matches!(
            error("GSDML-V2.3-A-B-20140301-250000.xml"),
            FileNameError::Date(_)
        ));
    }
}
