//! The settings of a drive as text: saved, compared, planned back. Pure; [`Session`](crate::Session) does the reading and
//! writing.
//!
//! ```
//! use profidrive_client::backup::{Backup, compare};
//!
//! let text = "\
//! profidrive backup 1
//! model: AKD
//! vendor: 0x0105
//! device: 0x0001
//!
//! p2108 DRV.ACC = 3000 rpm/s  # what stands behind the mark is for people
//! DRV.DEC = 50 rps/s          # name or number is enough
//! ";
//! let saved = Backup::read(text)?;
//! assert_eq!(saved.readings()[1].number(), Some(3000.0)); // rpm/s
//! // what is printed is one line for each parameter, by number, and reads back as the same
//! assert!(saved.to_string().contains("\np2115 DRV.DEC = 3000 rpm/s "));
//! assert_eq!(Backup::read(saved.to_string())?, saved);
//!
//! let edited = Backup::read(text.replace("50 rps/s", "60 rps/s"))?;
//! let differences = compare(&saved, &edited);
//! assert_eq!(differences[0].name(), Some("DRV.DEC"));
//!
//! let error = Backup::read(text.replace("3000 rpm/s", "3000 A")).unwrap_err();
//! assert!(error.to_string().starts_with("line 6: DRV.ACC (p2108): `A` is a unit of current"));
//! # Ok::<(), profidrive_client::backup::BackupError>(())
//! ```

mod compare;
mod header;
mod merge;
mod nearest;
mod parse;
mod pattern;
mod print;
pub(crate) mod task;
#[cfg(test)]
pub(crate) mod tests;

use std::collections::BTreeMap;

use profile::catalogue::{BackupRule, Role};

pub use compare::{Difference, Side, compare};
pub use header::{Header, IdentityDifference};
pub use parse::BackupError;
pub use pattern::{Pattern, PatternError};
pub(crate) use print::{FORM, value};
pub(crate) use task::Window;
pub use task::{Task, TaskCoverage, TaskDifference, compare_tasks};

use crate::{Drive, Refusal};
use profile::model::Model;
pub use profile::notation::setting::{Cause, Problem};
use profile::parameter::{CodeSpace, Format};
use profile::value::{Interpretation, Parameters, Reading, Selection};

/// The numbers that the profile itself uses: identification, telegram, lists, faults.
const PROFILE: std::ops::RangeInclusive<u16> = 900..=999;

/// Settings of one drive, by number and element.
#[derive(Clone)]
pub struct Backup {
    /// Whose they are.
    pub header: Header,
    parameters: Parameters,
    readings: Vec<Reading>,
    refused: Vec<Refusal>,
    /// Motion tasks by number; the header says what one means that is not here.
    tasks: BTreeMap<u16, Task>,
}

impl std::fmt::Debug for Backup {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // not the tables
        f.debug_struct("Backup")
            .field("header", &self.header)
            .field("readings", &self.readings)
            .field("refused", &self.refused)
            .field("tasks", &self.tasks)
            .finish_non_exhaustive()
    }
}

/// Two backups are equal when they say the same of the same drive: comments and what was refused do not count.
impl PartialEq for Backup {
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&Reading, &Reading)| {
            key(a) == key(b)
                && match (a.raw(), b.raw()) {
                    (Some(a), Some(b)) => a == b,
                    _ => a.octets == b.octets,
                }
        };
        self.header == other.header
            && self.readings.len() == other.readings.len()
            && self.readings.iter().zip(&other.readings).all(same)
            && self.tasks.len() == other.tasks.len()
            && self
                .tasks
                .iter()
                .zip(&other.tasks)
                .all(|(a, b)| a.0 == b.0 && a.1.is_as(b.1))
    }
}

impl Backup {
    /// From what a drive answered.
    #[must_use]
    pub fn new(
        header: Header,
        parameters: Parameters,
        answers: impl IntoIterator<Item = Result<Reading, Refusal>>,
    ) -> Self {
        let (mut readings, mut refused) = (Vec::new(), Vec::new());
        for answer in answers {
            match answer {
                Ok(reading) => readings.push(reading),
                Err(refusal) => refused.push(refusal),
            }
        }
        readings.sort_by_key(key);
        readings.dedup_by_key(|reading| key(reading));
        refused.sort_by_key(|refusal| (refusal.shown.pnu, refusal.shown.index));
        Self {
            header,
            parameters,
            readings,
            refused,
            tasks: BTreeMap::new(),
        }
    }

    /// The tables of the model and the scaling that the values were read with.
    #[must_use]
    pub const fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The values, by number and element.
    #[must_use]
    pub fn readings(&self) -> &[Reading] {
        &self.readings
    }

    /// Returns the refused reads; they are comments in the text.
    #[must_use]
    pub fn refused(&self) -> &[Refusal] {
        &self.refused
    }

    /// One value.
    #[must_use]
    pub fn reading(&self, pnu: u16, index: Option<u16>) -> Option<&Reading> {
        let at = self.readings.binary_search_by_key(&(pnu, index), key).ok()?;
        self.readings.get(at)
    }

    /// Each parameter that has a value here, to read it from a drive.
    #[must_use]
    pub fn selections(&self) -> Vec<Selection> {
        self.readings
            .iter()
            .map(|reading| selection(&self.parameters, reading))
            .collect()
    }
}

impl Backup {
    /// Returns the settings of a drive as its model is delivered, in the scaling of this drive: those whose delivered value the
    /// tables have. Texts are not among them. Without tables there are none.
    #[must_use]
    pub fn as_delivered(drive: &Drive) -> Self {
        let parameters = drive.parameters;
        let known = everything(&drive.model).into_iter().filter_map(|selection| {
            let parameter = selection.parameter?;
            parameter.default.filter(|_| parameter.length == 0)?;
            Some((selection, parameter))
        });
        let readings = known.flat_map(|(selection, parameter)| {
            let raw = parameter.raw_default(&parameters.scaling).to_be_bytes();
            let octets = raw
                .get(raw.len() - parameter.octets()..)
                .unwrap_or_default()
                .to_vec();
            let format = Format(parameter.size.format_code());
            let interpretation = Interpretation::of(format, CodeSpace::V4);
            (0..selection.count).map(move |offset| {
                Ok(parameters.reading(&selection, offset, format.0, interpretation, &octets))
            })
        });
        Self::new(Header::of(drive, None), parameters, readings)
    }
}

/// By number, then element.
const fn key(reading: &Reading) -> (u16, Option<u16>) {
    (reading.pnu, reading.index)
}

/// The one element that a reading is of.
pub(crate) fn selection(parameters: &Parameters, reading: &Reading) -> Selection {
    parameters.element(reading.pnu, reading.index)
}

/// What a parameter is to a backup: by the table, else by what the profile says of its number.
#[must_use]
pub fn rule(parameters: &Parameters, pnu: u16, index: Option<u16>) -> BackupRule {
    let base = parameters
        .at(pnu, index.unwrap_or(0))
        .and_then(|found| found.base);
    match parameters.catalogue {
        Some(tables) => tables.backup_rule_at(pnu, base),
        None if PROFILE.contains(&pnu) => BackupRule {
            role: Role::Network,
            why: "the profile uses this number",
            ..BackupRule::plain(pnu)
        },
        None => BackupRule::plain(pnu),
    }
}

impl Backup {
    /// How many settings of a model are not in it.
    #[must_use]
    pub fn lacks(&self, model: &Model) -> usize {
        let all = everything(model);
        let missing = all.iter().filter(|selection| {
            let index = selection.indexed.then_some(selection.first);
            self.reading(selection.pnu, index).is_none()
        });
        missing.count()
    }
}

/// Every parameter of a model that belongs into a backup; nothing for a drive without tables.
#[must_use]
pub fn everything(model: &Model) -> Vec<Selection> {
    let Some(tables) = model.catalogue else {
        return Vec::new();
    };
    tables
        .parameters
        .iter()
        .filter(|parameter| {
            let rule = tables.backup_rule_at(parameter.pnu, parameter.base);
            parameter.access == profile::catalogue::Access::ReadWrite
                && matches!(rule.role, Role::Setting | Role::Network)
        })
        .map(|parameter| Selection::of(parameter, tables.notation))
        .collect()
}
