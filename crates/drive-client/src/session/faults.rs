//! What is wrong with a drive, and what was: fault buffer and warnings, beside any controller.

use profidrive::catalogue::{Cleared, Reaction};
use profidrive::fault::{ConsistentRead, Next, Shape};
use profidrive::notation::{Elements, ParameterReference, Target};

use super::Session;
use crate::parameter::{Reading, Selection};
use crate::{Drive, Error, Refusal, Wire};

/// Fault message counter, fault numbers, their times and values, division of the buffer.
const COUNTER: u16 = 944;
const NUMBERS: u16 = 947;
const TIMES: u16 = 948;
const VALUES: u16 = 949;
const DIVISION: u16 = 950;
/// Status word.
const ZSW1: u16 = 2;
/// Beginning of the names of the parameters that hold warning numbers.
const WARNING: &str = "DRV.WARNING";
/// Reads of a fault buffer that keeps changing.
const ATTEMPTS: u8 = 3;

/// One fault of the buffer.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FaultEntry {
    /// Situation 0 is not acknowledged yet, 1 the last acknowledged.
    pub situation: u8,
    /// Position in the situation, 0 is the fault that came first.
    pub position: u8,
    /// The maker's number.
    pub number: u16,
    /// What it means, where the tables know.
    pub meaning: Option<&'static str>,
    /// What the drive does about it, where the tables know.
    pub reaction: Option<Reaction>,
    /// What to do, where the tables know.
    pub remedy: Option<&'static str>,
    /// How it goes away, where the tables know.
    pub cleared: Option<Cleared>,
    /// When it came, in the drive's own time, where the drive keeps it (PNU 948).
    pub time: Option<i64>,
    /// What else the drive noted (PNU 949).
    pub value: Option<i64>,
}

/// One warning.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WarningEntry {
    /// The maker's number.
    pub number: u32,
    /// What it means, where the tables know.
    pub meaning: Option<&'static str>,
    /// What to do, where the tables know.
    pub remedy: Option<&'static str>,
}

/// Faults and warnings of a drive at one moment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaultReport {
    /// Changes of the fault buffer so far (PNU 944).
    pub counter: u16,
    /// How the buffer is divided.
    pub shape: Shape,
    /// The buffer, newest situation first, of one moment: the counter did not change while it was read.
    pub faults: Vec<FaultEntry>,
    /// The warnings that are present; `None` where the drive has no numbers for them.
    pub warnings: Option<Vec<WarningEntry>>,
    /// The status word, read with the warnings.
    pub zsw1: Option<u16>,
}

impl FaultReport {
    /// The faults that are not acknowledged.
    pub fn present(&self) -> impl Iterator<Item = &FaultEntry> {
        self.faults.iter().filter(|fault| fault.situation == 0)
    }
}

impl<M: Wire> Session<M> {
    /// The fault buffer, newest situation first, read so that all of it belongs together.
    ///
    /// # Errors
    /// When the drive cannot be reached, has no fault buffer, or the buffer keeps changing.
    pub fn faults(&mut self, drive: &mut Drive) -> Result<Vec<FaultEntry>, Error> {
        let shape = self.fault_shape(drive)?;
        Ok(self.fault_buffer(drive, shape)?.1)
    }

    /// Fault buffer and warnings.
    ///
    /// # Errors
    /// When the drive cannot be reached, has no fault buffer, or the buffer keeps changing.
    pub fn fault_report(&mut self, drive: &mut Drive) -> Result<FaultReport, Error> {
        let shape = self.fault_shape(drive)?;
        let (counter, faults) = self.fault_buffer(drive, shape)?;
        let mut selections = select(drive, ZSW1, None).map_or_else(Vec::new, |one| vec![one]);
        let numbers = warning_parameters(drive);
        selections.extend(&numbers);
        let mut readings = self.read(drive, &selections)?.into_iter();
        let zsw1 = readings
            .next()
            .and_then(Result::ok)
            .and_then(|reading| reading.raw());
        let known = drive.model.catalogue;
        let warnings: Vec<WarningEntry> = readings
            .flatten()
            .filter_map(|reading| u32::try_from(reading.raw()?).ok())
            .filter(|number| *number != 0)
            .map(|number| {
                let row = u16::try_from(number)
                    .ok()
                    .and_then(|number| known?.fault(number, true));
                WarningEntry {
                    number,
                    meaning: row.map(|row| row.meaning),
                    remedy: row.map(|row| row.remedy).filter(|remedy| !remedy.is_empty()),
                }
            })
            .collect();
        Ok(FaultReport {
            counter,
            shape,
            faults,
            warnings: (!numbers.is_empty()).then_some(warnings),
            zsw1: zsw1.and_then(|raw| u16::try_from(raw & 0xFFFF).ok()),
        })
    }

    /// How the buffer is divided: as the tables say, else as the drive says, else eight by eight.
    fn fault_shape(&mut self, drive: &mut Drive) -> Result<Shape, Error> {
        if drive.model.catalogue.is_some() {
            return Ok(Shape::EIGHT_BY_EIGHT);
        }
        let Some(selection) = select(drive, DIVISION, Some(2)) else {
            return Ok(Shape::EIGHT_BY_EIGHT);
        };
        let values: Vec<u16> = self
            .read(drive, &[selection])?
            .into_iter()
            .flatten()
            .filter_map(|reading| u16::try_from(reading.raw()?).ok())
            .collect();
        Ok(Shape::from_scaling(&values).unwrap_or(Shape::EIGHT_BY_EIGHT))
    }

    fn fault_buffer(&mut self, drive: &mut Drive, shape: Shape) -> Result<(u16, Vec<FaultEntry>), Error> {
        let counter = drive.parameters.select(&ParameterReference::number(COUNTER))?;
        let parts = [NUMBERS, TIMES, VALUES].map(|pnu| select(drive, pnu, Some(shape.elements())));
        let mut order = ConsistentRead::new(ATTEMPTS);
        let mut count = 0;
        let mut buffers: [Vec<Result<Reading, Refusal>>; 3] = Default::default();
        loop {
            match order.next() {
                Next::Counter => {
                    let reading = self.read_one(drive, &counter)?;
                    count = reading.raw().and_then(|raw| u16::try_from(raw).ok()).unwrap_or(0);
                    order.counter(count);
                }
                Next::Buffer => {
                    for (buffer, selection) in buffers.iter_mut().zip(parts) {
                        *buffer = match selection {
                            Some(selection) => self.read(drive, &[selection])?,
                            None => Vec::new(),
                        };
                    }
                    order.buffer();
                }
                Next::Done => break,
                Next::GiveUp => {
                    return Err(Error::Changing {
                        drive: drive.label(),
                        attempts: ATTEMPTS,
                    });
                }
            }
        }
        let [numbers, times, values] = buffers;
        let beside = |list: &[Result<Reading, Refusal>], at: u16| -> Option<i64> {
            list.iter()
                .flatten()
                .find(|reading| reading.index.unwrap_or(0) == at)?
                .raw()
        };
        let mut faults = Vec::new();
        for reading in numbers {
            let reading = reading.map_err(|refusal| Error::Refused {
                drive: drive.label(),
                refusal,
            })?;
            let number = reading.raw().and_then(|raw| u16::try_from(raw).ok()).unwrap_or(0);
            let at = reading.index.unwrap_or(0);
            let Some(place) = shape.place(at).filter(|_| number != 0) else {
                continue;
            };
            let row = drive
                .model
                .catalogue
                .and_then(|tables| tables.fault(number, false));
            faults.push(FaultEntry {
                situation: place.situation,
                position: place.position,
                number,
                meaning: row.map(|row| row.meaning),
                reaction: row.map(|row| row.reaction),
                remedy: row.map(|row| row.remedy).filter(|remedy| !remedy.is_empty()),
                cleared: row.map(|row| row.cleared),
                time: beside(&times, at),
                value: beside(&values, at),
            });
        }
        Ok((count, faults))
    }
}

/// A parameter of the buffer: where there are tables only if they have it, with as many elements as they say.
fn select(drive: &Drive, pnu: u16, elements: Option<u16>) -> Option<Selection> {
    let known = drive.model.catalogue;
    if known.is_some_and(|tables| tables.by_pnu(pnu).is_none()) {
        return None;
    }
    let elements = elements.filter(|_| known.is_none());
    let reference = ParameterReference {
        target: Target::Number(pnu),
        elements: elements.map(|count| Elements { first: 0, count }),
        prefix: None,
    };
    drive.parameters.select(&reference).ok()
}

/// The parameters that hold the numbers of warnings.
fn warning_parameters(drive: &Drive) -> Vec<Selection> {
    let Some(tables) = drive.model.catalogue else {
        return Vec::new();
    };
    tables
        .parameters
        .iter()
        .filter(|parameter| parameter.name.starts_with(WARNING))
        .filter_map(|parameter| {
            drive
                .parameters
                .select(&ParameterReference::number(parameter.pnu))
                .ok()
        })
        .collect()
}
