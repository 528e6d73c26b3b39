//! The parameters of a drive, all or those that fit a text.

use client::{Drive, Session};
use profile::catalogue::{Catalogue, Parameter};
use profile::notation::{ParameterReference, Target};
use profile::value::{Parameters, Selection};

use super::{ParameterError, name_bits};
use crate::report::{ListReport, ParameterDescription, Wording, number, parameter};

/// So many parameters are read before progress is reported.
const PART: usize = 64;

/// What is listed.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct List {
    /// A text in names, descriptions and numbers; none for all parameters.
    pub filter: Option<String>,
    /// With the present values instead of the descriptions.
    pub values: bool,
}

/// Lists the parameters of a drive. A drive without tables lists its numbers itself (PNU 980 and following). `progress` gets
/// how many values of how many are read.
///
/// # Errors
/// [`ParameterError::NoMatch`], and when the drive cannot be reached. What it refuses to read is in the report.
pub async fn list(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &List,
    wording: &(dyn Wording + Sync),
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<ListReport, ParameterError> {
    let mut report = ListReport {
        drive: drive.label(),
        model: drive.model.name,
        ..ListReport::default()
    };
    let Some(tables) = drive.model.catalogue else {
        report.numbers = session.numbers(drive).await?;
        return Ok(report);
    };
    let filter = wanted.filter.as_deref();
    let found = filter.map_or_else(
        || tables.parameters.iter().collect(),
        |text| matching(&drive.parameters, tables, text),
    );
    if found.is_empty() {
        return Err(ParameterError::NoMatch {
            model: tables.model,
            filter: filter.unwrap_or_default().to_owned(),
        });
    }
    if !wanted.values {
        let described = found.into_iter();
        report.parameters = described
            .map(|parameter| ParameterDescription::new(tables, parameter, &drive.parameters))
            .collect();
        return Ok(report);
    }
    let selections: Vec<Selection> = found
        .into_iter()
        .map(|parameter| Selection::of(parameter, tables.notation))
        .collect();
    let mut readings = Vec::new();
    for (done, part) in selections.chunks(PART).enumerate() {
        progress(done * PART, selections.len());
        readings.extend(session.read(drive, part).await?);
    }
    progress(selections.len(), selections.len());
    name_bits(session, drive, &mut readings).await?;
    let values = readings.iter().map(|reading| parameter(reading, wording));
    report.values = values.collect();
    Ok(report)
}

/// Returns the parameters with `text` in name or description, the number itself first, numbers with the text in them last.
#[must_use]
pub fn matching(parameters: &Parameters, tables: &'static Catalogue, text: &str) -> Vec<&'static Parameter> {
    let same = |one: &Parameter, other: &Parameter| (one.pnu, one.base) == (other.pnu, other.base);
    let by_number = text
        .parse::<ParameterReference>()
        .ok()
        .filter(|reference| matches!(reference.target, Target::Number(_)))
        .and_then(|reference| parameters.select(&reference).ok()?.parameter);
    let mut found: Vec<_> = tables.filter(text).collect();
    if let Some(exact) = by_number
        && !found.iter().any(|other| same(exact, other))
    {
        found.insert(0, exact);
    }
    let wanted = text.to_ascii_lowercase();
    if wanted.contains(|c: char| c.is_ascii_digit()) {
        for parameter in tables.parameters {
            let written = number(tables, parameter).to_ascii_lowercase();
            if written.contains(&wanted) && !found.iter().any(|other| same(parameter, other)) {
                found.push(parameter);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::{AKD, Scaling, VACON, VLT};

    #[test]
    fn filters_find_names_words_and_numbers() {
        let numbers = |tables: &'static Catalogue, text: &str| -> Vec<String> {
            let known = Parameters {
                catalogue: Some(tables),
                scaling: Scaling::default(),
            };
            let found = matching(&known, tables, text);
            found.iter().map(|parameter| number(tables, parameter)).collect()
        };
        assert!(numbers(&AKD, "drv.acc").contains(&"p2108".into()));
        assert_eq!(numbers(&AKD, "p930")[0], "p0930");
        assert!(numbers(&AKD, "nothing like it").is_empty());
        // the number itself stands first
        assert_eq!(numbers(&VLT, "3-4"), ["3-04", "3-40", "3-41", "3-42"]);
        for (tables, ramp) in [(&AKD, "p2108"), (&VLT, "3-41"), (&VACON, "ID 103")] {
            assert!(numbers(tables, "ramp").contains(&ramp.into()), "{ramp}");
        }
        assert!(numbers(&AKD, "210").contains(&"p2108".into()));
        let found = numbers(&VACON, "id 10");
        assert!(found.contains(&"ID 103".into()), "{found:?}");
    }
}
