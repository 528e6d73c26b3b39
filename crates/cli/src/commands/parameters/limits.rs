//! Limits of a parameter in words, and whose they are: of the drive, of the tables, or only of the data type.

use client::{Described, ReportedLimits};
use profile::catalogue::Parameter;
use profile::value::Parameters;

use crate::render::number;

/// What is known of the limits of one parameter.
#[derive(Debug, Clone, Copy)]
pub struct Limits<'a> {
    /// Limits from the tables or the description of the drive.
    tables: (Option<f64>, Option<f64>),
    /// What fits the data type.
    size: Option<(f64, f64)>,
    description: Option<&'a Described>,
}

impl<'a> Limits<'a> {
    /// Returns the limits of a parameter in the tables, combined with the description of the drive.
    pub fn of(drive: &Parameters, parameter: &Parameter, description: Option<&'a Described>) -> Self {
        let (low, high) = drive.limits(parameter);
        let range = parameter.range();
        let shown = |raw: i64| parameter.engineering(raw, &drive.scaling);
        let size = (shown(*range.start()), shown(*range.end()));
        let known = (parameter.minimum.map(|_| low), parameter.maximum.map(|_| high));
        Self {
            // a drive without tables was queried before, and may have reported only the type
            tables: if known == (Some(size.0), Some(size.1)) && !parameter.wide {
                (None, None)
            } else {
                known
            },
            size: Some(size),
            description,
        }
    }

    /// Limits of a parameter that is in no table, from the description of the drive.
    pub const fn description(description: &'a Described) -> Self {
        Self {
            tables: (None, None),
            size: match description.limits {
                ReportedLimits::OfType(low, high) => Some((low, high)),
                _ => None,
            },
            description: Some(description),
        }
    }

    /// Returns the limits with their unit, and whose they are.
    pub fn words(&self, unit: &str) -> String {
        let shown = |value: f64| format!("{} {unit}", number(value)).trim_end().to_owned();
        let span = |low: f64, high: f64| format!("{} to {}", shown(low), shown(high));
        let of_type = self
            .size
            .map(|(low, high)| format!("limits of the type: {}", span(low, high)));
        if let Some(ReportedLimits::Own(low, high)) = self.description.map(|description| description.limits) {
            let own = span(low, high);
            return match self.tables {
                (Some(first), Some(last)) if span(first, last) != own => {
                    format!("{own}, reported by the drive (tables: {})", span(first, last))
                }
                _ => format!("{own}, reported by the drive"),
            };
        }
        let of_type = of_type.unwrap_or_else(|| "the type has none".to_owned());
        match self.tables {
            (Some(low), Some(high)) => span(low, high),
            (Some(low), None) => format!("at least {}; {of_type}", shown(low)),
            (None, Some(high)) => format!("at most {}; {of_type}", shown(high)),
            (None, None) => format!("none known; {of_type}"),
        }
    }

    /// Returns the texts reported by the drive for values without a text in the tables.
    pub fn other_texts(&self, parameter: &'a Parameter) -> impl Iterator<Item = (i32, &'a str)> {
        let texts = self
            .description
            .into_iter()
            .flat_map(|description| &description.texts);
        texts
            .filter(|(value, _)| parameter.choices.iter().all(|choice| choice.value != *value))
            .map(|(value, text)| (*value, text.as_str()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::model::Model;

    fn drive() -> Parameters {
        Parameters::of(&Model::by_name("vlt").unwrap())
    }

    #[test]
    fn limits_of_the_type_are_not_shown_as_limits() {
        let drive = drive();
        let tables = drive.catalogue.unwrap();
        let row = *tables.by_pnu(341).unwrap();
        let words = |minimum, maximum| {
            let row = Parameter {
                minimum,
                maximum,
                ..row
            };
            Limits::of(&drive, &row, None).words("s")
        };
        let size = "limits of the type: 0 s to 42949673 s";
        assert_eq!(words(Some(0.01), Some(3600.0)), "0.01 s to 3600 s");
        let none = format!("none known; {size}");
        assert_eq!(words(None, None), none);
        assert_eq!(words(Some(0.01), None), format!("at least 0.01 s; {size}"));
        assert_eq!(words(None, Some(60.0)), format!("at most 60 s; {size}"));
        // learned from a drive that reported suitable values
        assert_eq!(words(Some(0.0), Some(42_949_672.95)), none);
    }
}
