//! Limits of a parameter, and whose they are: of the drive, of the tables, or only of the data type.

use client::{Described, ReportedLimits};
use profile::catalogue::Parameter;
use profile::value::Parameters;

/// What is known of the limits of one parameter, in its unit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Limits {
    /// Lowest and highest value in the tables.
    pub tables: (Option<f64>, Option<f64>),
    /// Limits that the drive reports, where they are more than those of the data type.
    pub reported: Option<(f64, f64)>,
    /// What fits the data type.
    pub of_type: Option<(f64, f64)>,
}

impl Limits {
    /// Returns the limits of a parameter in the tables, combined with the description of the drive.
    #[must_use]
    pub fn of(drive: &Parameters, parameter: &Parameter, described: Option<&Described>) -> Self {
        let (low, high) = drive.limits(parameter);
        let range = parameter.range();
        let shown = |raw: i64| parameter.engineering(raw, &drive.scaling);
        let of_type = (shown(*range.start()), shown(*range.end()));
        let known = (parameter.minimum.map(|_| low), parameter.maximum.map(|_| high));
        // the rows of a drive without tables are its own descriptions, and may have no more than the type
        let tables = if known == (Some(of_type.0), Some(of_type.1)) && !parameter.wide {
            (None, None)
        } else {
            known
        };
        Self {
            tables,
            reported: described.and_then(reported),
            of_type: Some(of_type),
        }
    }

    /// Limits of a parameter that is in no table, from the description of the drive.
    #[must_use]
    pub fn of_description(described: &Described) -> Self {
        let of_type = match described.limits {
            ReportedLimits::OfType(low, high) => Some((low, high)),
            _ => None,
        };
        Self {
            tables: (None, None),
            reported: reported(described),
            of_type,
        }
    }
}

const fn reported(described: &Described) -> Option<(f64, f64)> {
    match described.limits {
        ReportedLimits::Own(low, high) => Some((low, high)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use profile::model::Model;

    use super::*;

    #[test]
    fn limits_of_the_type_are_not_limits_of_the_tables() {
        let drive = Parameters::of(&Model::by_name("vlt").unwrap());
        let row = *drive.catalogue.unwrap().by_pnu(341).unwrap();
        let tables = |minimum, maximum| {
            let row = Parameter {
                minimum,
                maximum,
                ..row
            };
            let limits = Limits::of(&drive, &row, None);
            assert_eq!(limits.of_type, Some((0.0, 42_949_672.95)));
            limits.tables
        };
        assert_eq!(tables(Some(0.01), Some(3600.0)), (Some(0.01), Some(3600.0)));
        assert_eq!(tables(None, Some(60.0)), (None, Some(60.0)));
        // learned from a drive that reported suitable values
        assert_eq!(tables(Some(0.0), Some(42_949_672.95)), (None, None));
    }
}
