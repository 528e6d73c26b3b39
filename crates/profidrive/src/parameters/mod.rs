//! Parameters as people name them: read, listed, described and written.
//!
//! ```
//! # #[cfg(feature = "simulate")] {
//! use profidrive::Wait;
//! use profidrive::parameters::read;
//!
//! let plant = "[[drive]]\nname = \"akd-1\"\nip = \"192.168.0.11/24\"";
//! let mut network = profidrive::open_plan(plant.parse()?)?;
//! let mut drive = network.find(&"akd-1".parse()?).wait()?;
//! let wanted = ["DRV.ACC".parse()?, "NO.SUCH".parse()?];
//! let values = read(&mut network, &mut drive, &wanted).wait()?;
//! let acceleration = values.readings[0].as_ref().expect("readable");
//! assert_eq!((acceleration.number(), acceleration.unit), (Some(3000.0), "rpm/s"));
//! assert_eq!(values.problems("akd-1").len(), 1);
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod describe;
mod error;
mod layout;
mod limits;
mod list;
mod remark;
mod write;

use client::{Drive, Error, Refusal, Session};
use profile::catalogue::Part;
use profile::notation::ParameterReference;
use profile::parameter::pnu;
use profile::state::Mode;
use profile::telegram::Telegram;
use profile::value::{ParameterProblem, Reading, Selection};

use crate::report::{ParametersReport, Wording, parameter};

pub use describe::{Description, describe};
pub use error::ParameterError;
pub use layout::layout;
pub use limits::Limits;
pub use list::{List, list, matching};
pub use write::{Write, Written, carry_out, carry_out_agreed, objections, plan, undo, write};

/// Values that were read, in the order of the request.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// Every element of every parameter that the drive has, or its refusal.
    pub readings: Vec<Result<Reading, Refusal>>,
    /// The references that name no parameter of the drive.
    pub unknown: Vec<ParameterProblem>,
}

impl Values {
    /// Returns the values as a report.
    #[must_use]
    pub fn report(&self, drive: &Drive, wording: &dyn Wording) -> ParametersReport {
        ParametersReport {
            drive: drive.label(),
            parameters: self
                .readings
                .iter()
                .map(|reading| parameter(reading, wording))
                .collect(),
        }
    }

    /// Returns why values are missing: references that name nothing, then refusals.
    #[must_use]
    pub fn problems(&self, drive: &str) -> Vec<Error> {
        let refused = self.readings.iter().filter_map(|reading| reading.as_ref().err());
        let refused = refused.map(|refusal| Error::Refused {
            drive: drive.to_owned(),
            refusal: *refusal,
        });
        self.unknown
            .iter()
            .cloned()
            .map(Error::from)
            .chain(refused)
            .collect()
    }
}

/// Reads parameters. A name that is not known or a refusal does not disturb the others.
///
/// # Errors
/// When the drive cannot be reached, or its answer makes no sense.
pub async fn read(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &[ParameterReference],
) -> Result<Values, Error> {
    let (selections, unknown) = selected(drive, wanted);
    let mut readings = session.read(drive, &selections).await?;
    name_bits(session, drive, &mut readings).await?;
    Ok(Values { readings, unknown })
}

/// The same for what a drive may have: what it refuses is left out. What it has reported not to have is not read again for ten
/// minutes.
///
/// # Errors
/// When the drive cannot be reached, or its answer makes no sense.
pub async fn read_present(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &[ParameterReference],
) -> Result<Values, Error> {
    let (selections, unknown) = selected(drive, wanted);
    let present = session.read_present(drive, &selections).await?;
    let mut readings: Vec<_> = present.into_iter().map(Ok).collect();
    name_bits(session, drive, &mut readings).await?;
    Ok(Values { readings, unknown })
}

/// Returns what is meant by these references, and why some mean nothing.
fn selected(drive: &Drive, wanted: &[ParameterReference]) -> (Vec<Selection>, Vec<ParameterProblem>) {
    let (mut selections, mut unknown) = (Vec::new(), Vec::new());
    for reference in wanted {
        match drive.parameters.select(reference) {
            Ok(selection) => selections.push(selection),
            Err(problem) => unknown.push(problem),
        }
    }
    (selections, unknown)
}

/// Names the bits of control and status words: what they are called depends on telegram, profile and mode, which only the
/// drive reports.
///
/// # Errors
/// When the drive cannot be reached.
async fn name_bits(
    session: &mut Session,
    drive: &mut Drive,
    readings: &mut [Result<Reading, Refusal>],
) -> Result<(), Error> {
    let depends = |reading: &Reading| drive.parameters.is_word_of_state(reading);
    if !readings.iter().flatten().any(depends) {
        return Ok(());
    }
    let chooser = drive
        .model
        .catalogue
        .and_then(|tables| tables.part(Part::ControlProfile));
    let chooser = chooser.map(|parameter| parameter.pnu);
    let asked = [Some(pnu::OPERATING_MODE), Some(pnu::TELEGRAM), chooser];
    let selections: Vec<_> = asked
        .into_iter()
        .flatten()
        .map(|pnu| Selection::number(pnu, drive.parameters.notation()))
        .collect();
    let answers = session.read_present(drive, &selections).await?;
    let raw = |pnu: u16| {
        let found = answers.iter().find(|reading| reading.pnu == pnu);
        found.and_then(Reading::raw)
    };
    let telegram = raw(pnu::TELEGRAM).and_then(|number| u16::try_from(number).ok());
    let telegram = telegram.and_then(|number| Telegram::find(number, drive.station.vendor_id));
    let profile = drive.model.words.of(telegram, chooser.and_then(raw));
    let mode = Mode::of(raw(pnu::OPERATING_MODE), telegram);
    for reading in readings.iter_mut().flatten() {
        *reading = drive.parameters.in_words(reading.clone(), Some(profile), mode);
    }
    Ok(())
}
