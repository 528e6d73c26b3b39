//! Unit, limits, scaling, choices and values of one parameter.

use client::change::SavedBy;
use client::{Described, Drive, Refusal, Session};
use profile::catalogue::{Catalogue, Parameter};
use profile::notation::ParameterReference;
use profile::value::{Reading, Selection};

use super::{Limits, ParameterError, name_bits};
use crate::report::{DescribeReport, ParameterDescription, ReportedDescription, Wording, parameter};

/// What is known of one parameter.
#[derive(Debug, Clone)]
pub struct Description {
    /// The parameter as it was selected.
    pub selection: Selection,
    /// The tables of the model with their row; none where it is in no table.
    pub row: Option<(&'static Catalogue, &'static Parameter)>,
    /// The description that the drive gives of it.
    pub described: Option<Described>,
    /// Its present values, where it is in a table.
    pub readings: Vec<Result<Reading, Refusal>>,
}

impl Description {
    /// What is known of its limits.
    #[must_use]
    pub fn limits(&self, drive: &Drive) -> Limits {
        match (self.row, &self.described) {
            (Some((_, row)), described) => Limits::of(&drive.parameters, row, described.as_ref()),
            (None, Some(described)) => Limits::of_description(described),
            (None, None) => Limits::default(),
        }
    }

    /// What lets the drive save its value; `None` for what is in no table.
    #[must_use]
    pub fn saved_by(&self, drive: &Drive) -> Option<SavedBy> {
        self.row.map(|(_, row)| drive.saved_by(row))
    }

    /// The texts that the drive reports for values without a text in the tables.
    pub fn other_texts(&self) -> impl Iterator<Item = (i32, &str)> {
        let choices = self.row.map_or(&[][..], |(_, row)| row.choices);
        let texts = self.described.iter().flat_map(|described| &described.texts);
        texts
            .filter(move |(value, _)| choices.iter().all(|choice| choice.value != *value))
            .map(|(value, text)| (*value, text.as_str()))
    }

    /// Returns it as a report.
    #[must_use]
    pub fn report(&self, drive: &Drive, wording: &dyn Wording) -> DescribeReport {
        let row = self.row;
        DescribeReport {
            drive: drive.label(),
            model: drive.model.name,
            parameter: row.map(|(tables, row)| ParameterDescription::new(tables, row, &drive.parameters)),
            saved_by: self.saved_by(drive).map(SavedBy::name),
            scaling: row.map(|(_, row)| row.rule(&drive.parameters.scaling)),
            reported: self.described.as_ref().map(ReportedDescription::from),
            values: self
                .readings
                .iter()
                .map(|reading| parameter(reading, wording))
                .collect(),
        }
    }
}

/// Returns what the tables and the drive itself know of a parameter, and its present values.
///
/// # Errors
/// [`ParameterError::HighHalf`] for the second number of a 64-bit parameter, [`ParameterError::Undescribed`], and when the
/// drive cannot be reached.
pub async fn describe(
    session: &mut Session,
    drive: &mut Drive,
    reference: &ParameterReference,
) -> Result<Description, ParameterError> {
    let selection = drive.parameters.select(reference).map_err(client::Error::from)?;
    let tables = drive.model.catalogue;
    if selection.parameter.is_none()
        && let Some(whole) = tables.and_then(|tables| tables.by_high(selection.pnu))
    {
        return Err(ParameterError::HighHalf {
            parameter: selection.label(),
            whole: whole.name,
        });
    }
    let described = session.described(drive, &selection).await?;
    let row = tables.zip(selection.parameter);
    let mut readings = Vec::new();
    if row.is_some() {
        readings = session.read(drive, &[selection]).await?;
        name_bits(session, drive, &mut readings).await?;
    } else if described.is_none() {
        return Err(ParameterError::Undescribed {
            parameter: selection.label(),
            model: drive.model.name,
        });
    }
    Ok(Description {
        selection,
        row,
        described,
        readings,
    })
}
