//! What is wrong with a drive, and what was: fault buffer and warnings, beside any controller.

use std::fmt;

use profile::catalogue::{Catalogue, Cleared, Fault, Parameter, Part, Reaction};
use profile::fault::{ConsistentRead, Counting, Next, Shape};
use profile::notation::{Notation, ParameterReference, Shown};
use profile::parameter::pnu;

use super::Session;
use super::readings::{Readings, zsw1_of};
use crate::{Drive, Error, Refusal};
use profile::value::{Reading, Selection};

/// What is read beside the buffer.
const PARTS: [Part; 11] = [
    Part::ControlWord,
    Part::StatusWord,
    Part::ControlProfile,
    Part::Fault,
    Part::Warning,
    Part::WarningWord,
    Part::AlarmWord,
    Part::FaultLog,
    Part::FaultLogValue,
    Part::FaultLogTime,
    Part::FaultSituations,
];
/// Bits of one alarm or warning word.
const WORD: u8 = 32;
/// Reads of a fault buffer that keeps changing.
const ATTEMPTS: u8 = 3;

/// One fault of the buffer.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FaultEntry {
    /// Situation 0 is not acknowledged yet, 1 the last acknowledged.
    pub situation: u8,
    /// Position in the situation, 0 is the fault that came first.
    pub position: u8,
    /// The vendor's number.
    pub number: u16,
    /// What it means, where the tables have it.
    pub meaning: Option<&'static str>,
    /// What the drive does about it, where the tables have it.
    pub reaction: Option<Reaction>,
    /// What to do, where the tables have it.
    pub remedy: Option<&'static str>,
    /// How it goes away, where the tables have it.
    pub cleared: Option<Cleared>,
    /// The same in words, with the parameters of this vendor.
    pub clearing: Option<String>,
    /// The parameters that the remedy names, by name or number as their vendor writes them.
    pub parameters: Vec<String>,
    /// When it came, in the drive's own time, where the drive keeps it (PNU 948).
    pub time: Option<i64>,
    /// What else the drive noted (PNU 949).
    pub value: Option<i64>,
}

impl FaultEntry {
    /// Creates a fault that is present, with the texts of the tables of its vendor.
    #[must_use]
    pub fn of(number: u16, tables: Option<&Catalogue>) -> Self {
        let row = tables.and_then(|tables| tables.fault(number, false));
        Self {
            number,
            meaning: row.map(|row| row.meaning),
            reaction: row.map(|row| row.reaction),
            remedy: row.map(|row| row.remedy).filter(|remedy| !remedy.is_empty()),
            cleared: row.map(|row| row.cleared),
            parameters: named(tables, row.map_or("", |row| row.remedy)),
            clearing: tables.zip(row).map(|(tables, row)| tables.clearing(row.cleared)),
            ..Self::default()
        }
    }
}

/// `F702 Fieldbus communication lost`
impl fmt::Display for FaultEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "F{} {}", self.number, self.meaning.unwrap_or(UNKNOWN))
    }
}

/// `n107 Positive limit reached: limit switch or software limit`
impl fmt::Display for WarningEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "n{} {}", self.number, self.meaning.unwrap_or(UNKNOWN))
    }
}

/// In the place of a meaning that is not known.
const UNKNOWN: &str = "not in the tables";

/// One warning.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct WarningEntry {
    /// The vendor's number.
    pub number: u32,
    /// What it means, where the tables have it.
    pub meaning: Option<&'static str>,
    /// What to do, where the tables have it.
    pub remedy: Option<&'static str>,
    /// The parameters that the remedy names, by name or number as their vendor writes them.
    pub parameters: Vec<String>,
}

/// Returns the parameters that a remedy names, as their vendor writes them.
fn named(tables: Option<&Catalogue>, remedy: &str) -> Vec<String> {
    let Some(tables) = tables else { return Vec::new() };
    let written = |parameter: &Parameter| match tables.notation {
        Notation::Name => parameter.name.to_owned(),
        notation => Shown {
            pnu: parameter.pnu,
            index: parameter.base,
            writable: None,
            notation,
        }
        .to_string(),
    };
    let found = tables.mentioned(remedy).into_iter();
    found.map(written).collect()
}

/// Faults and warnings of a drive at one moment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaultReport {
    /// Fault message counter (PNU 944): changes of the fault buffer, or fault situations, as
    /// [`counting`](Self::counting) says.
    pub counter: u16,
    /// What that counts.
    pub counting: Counting,
    /// Fault situations that the drive has counted (PNU 952); `None` where it has no such counter.
    pub situations: Option<u16>,
    /// How the buffer is divided.
    pub shape: Shape,
    /// The buffer, newest situation first, of one moment. With it faults
    /// that are present and have no place in it, where the drive has their numbers elsewhere.
    pub faults: Vec<FaultEntry>,
    /// The warnings that are present; `None` where the drive has no numbers for them.
    pub warnings: Option<Vec<WarningEntry>>,
    /// The status word in the bits of the profile, read with the warnings.
    pub zsw1: Option<u16>,
    /// The log that the drive keeps beside the buffer, the newest first; empty where it has none.
    pub log: Vec<LoggedFault>,
}

/// One entry of a log that only grows (VLT 15-30 to 15-32).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LoggedFault {
    /// The vendor's number.
    pub number: u16,
    /// What it means, where the tables have it.
    pub meaning: Option<&'static str>,
    /// What the drive noted with it.
    pub value: Option<i64>,
    /// When it came, with the unit of the drive.
    pub time: Option<i64>,
}

impl FaultReport {
    /// Returns the faults that are not acknowledged.
    pub fn present(&self) -> impl Iterator<Item = &FaultEntry> {
        self.faults.iter().filter(|fault| fault.situation == 0)
    }

    /// Returns true if no command clears the faults that are present: the drive has to be switched off and on.
    #[must_use]
    pub fn needs_restart(&self) -> bool {
        let mut present = self.present().peekable();
        present.peek().is_some() && present.all(|fault| fault.cleared == Some(Cleared::Restart))
    }
}

impl Session {
    /// Returns the fault buffer, newest situation first, read so that all of it belongs together.
    ///
    /// # Errors
    /// When the drive cannot be reached, has no fault buffer, or the buffer keeps changing.
    pub async fn faults(&mut self, drive: &mut Drive) -> Result<Vec<FaultEntry>, Error> {
        let shape = self.fault_shape(drive).await?;
        Ok(self.fault_buffer(drive, shape).await?.1)
    }

    /// Fault buffer and warnings.
    ///
    /// # Errors
    /// When the drive cannot be reached, has no fault buffer, or the buffer keeps changing.
    pub async fn fault_report(&mut self, drive: &mut Drive) -> Result<FaultReport, Error> {
        let shape = self.fault_shape(drive).await?;
        let (counter, faults) = self.fault_buffer(drive, shape).await?;
        let telegram = self.telegram_now(drive).await?;
        let readings = self.ask(drive, &PARTS).await?;
        let mut faults = faults;
        // a drive may report a fault by its bit before the buffer has it
        for (number, _) in by_bits(drive, &readings, false) {
            let known = |fault: &FaultEntry| fault.situation == 0 && fault.number == number;
            if !faults.iter().any(known) {
                faults.insert(0, FaultEntry::of(number, drive.model.catalogue));
            }
        }
        // a situation of the buffer may have fewer places than there are faults
        for number in numbers(&readings, Part::Fault).filter_map(|number| u16::try_from(number).ok()) {
            let place = faults.iter().take_while(|fault| fault.situation == 0).count();
            let present = faults.get(..place).unwrap_or_default();
            if !present.iter().any(|fault| fault.number == number) {
                let position = u8::try_from(place).unwrap_or(u8::MAX);
                let more = FaultEntry {
                    position,
                    ..FaultEntry::of(number, drive.model.catalogue)
                };
                faults.insert(place, more);
            }
        }
        Ok(FaultReport {
            counter,
            counting: drive.model.dialect.fault_counter,
            situations: readings.word(Part::FaultSituations),
            shape,
            faults,
            warnings: warnings(drive, &readings),
            zsw1: zsw1_of(drive, &readings, telegram).map(|word| word.0),
            log: log(drive, &readings),
        })
    }

    /// Returns the warnings that are present, by number and by bit; `None` where the drive has no numbers for them.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn warnings(&mut self, drive: &Drive) -> Result<Option<Vec<WarningEntry>>, Error> {
        let mut drive = drive.clone();
        let readings = self.ask(&mut drive, &[Part::Warning, Part::WarningWord]).await?;
        Ok(warnings(&drive, &readings))
    }

    /// Returns the shape of the buffer: from the tables, else from the drive if that fits its elements, else eight by
    /// eight, or as many situations of one fault.
    async fn fault_shape(&mut self, drive: &mut Drive) -> Result<Shape, Error> {
        let elements = self
            .extents(drive, &[pnu::FAULT_NUMBERS])
            .await?
            .first()
            .copied()
            .unwrap_or(0);
        if drive.model.learned_or_none().is_none() {
            return Ok(shape_of(elements));
        }
        let division = self.whole(drive, &[pnu::FAULT_DIVISION]).await?;
        let values: Vec<u16> = self
            .read(drive, &division)
            .await?
            .into_iter()
            .flatten()
            .filter_map(|reading| u16::try_from(reading.raw()?).ok())
            .collect();
        let readings = Shape::from_scaling(&values).filter(|shape| shape.elements() == elements);
        Ok(readings.unwrap_or_else(|| shape_of(elements)))
    }

    async fn fault_buffer(
        &mut self,
        drive: &mut Drive,
        shape: Shape,
    ) -> Result<(u16, Vec<FaultEntry>), Error> {
        let counter = drive
            .parameters
            .select(&ParameterReference::number(pnu::FAULT_COUNTER))?;
        let whole = self
            .whole(drive, &[pnu::FAULT_NUMBERS, pnu::FAULT_TIMES, pnu::FAULT_VALUES])
            .await?;
        let part = |number| whole.iter().find(|selection| selection.pnu == number).copied();
        // a drive without fault numbers reports that itself
        let numbers =
            part(pnu::FAULT_NUMBERS).unwrap_or_else(|| Selection::number(pnu::FAULT_NUMBERS, Notation::Name));
        let parts = [Some(numbers), part(pnu::FAULT_TIMES), part(pnu::FAULT_VALUES)];
        let mut order = ConsistentRead::new(ATTEMPTS);
        let mut count = 0;
        let mut buffers: [Vec<Result<Reading, Refusal>>; 3] = Default::default();
        loop {
            match order.next() {
                Next::Counter => {
                    let reading = self.read_one(drive, &counter).await?;
                    count = reading.raw().and_then(|raw| u16::try_from(raw).ok()).unwrap_or(0);
                    order.counter(count);
                }
                Next::Buffer => {
                    for (buffer, selection) in buffers.iter_mut().zip(parts) {
                        *buffer = match selection {
                            Some(selection) => self.read(drive, &[selection]).await?,
                            None => Vec::new(),
                        };
                    }
                    // a counter of situations does not count an acknowledge between two parts of the buffer
                    let one_answer = parts.iter().flatten().count() == 1;
                    if one_answer || self.read(drive, &[numbers]).await? == buffers[0] {
                        order.buffer();
                    } else {
                        order.torn();
                    }
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
            faults.push(FaultEntry {
                situation: place.situation,
                position: place.position,
                time: beside(&times, at),
                value: beside(&values, at),
                ..FaultEntry::of(number, drive.model.catalogue)
            });
        }
        Ok((count, faults))
    }
}

/// Returns the shape of a buffer with so many elements: eight by eight, or as many situations of one fault.
fn shape_of(elements: u16) -> Shape {
    match u8::try_from(elements) {
        Ok(situations @ 1..64) => Shape {
            situations,
            faults: 1,
        },
        _ => Shape::EIGHT_BY_EIGHT,
    }
}

/// Faults or warnings by the bits of the drive's words.
fn by_bits(drive: &Drive, readings: &Readings, warning: bool) -> Vec<(u16, &'static Fault)> {
    let part = if warning {
        Part::WarningWord
    } else {
        Part::AlarmWord
    };
    let rows = drive.model.catalogue.map_or(&[][..], |tables| tables.faults);
    let mut set = Vec::new();
    for (word, first) in readings.all(part).zip((0..).step_by(WORD.into())) {
        let raw = word.raw().unwrap_or(0);
        let bits = (0..WORD).filter(|bit| raw >> bit & 1 == 1);
        for bit in bits.map(|bit| first + bit) {
            let rows = rows.iter().filter(|row| row.warning == warning);
            set.extend(
                rows.filter(|row| row.bit == Some(bit))
                    .map(|row| (row.number, row)),
            );
        }
    }
    set
}

/// Returns the numbers that are reported one by one.
fn numbers(readings: &Readings, part: Part) -> impl Iterator<Item = u32> {
    let numbers = readings.all(part);
    let numbers = numbers.filter_map(|reading| u32::try_from(reading.raw()?).ok());
    numbers.filter(|number| *number != 0)
}

/// Warnings by number and by bit; `None` where the drive has neither.
fn warnings(drive: &Drive, readings: &Readings) -> Option<Vec<WarningEntry>> {
    let words = readings.find(Part::Warning).or(readings.find(Part::WarningWord));
    words?;
    let tables = drive.model.catalogue;
    let by_number = numbers(readings, Part::Warning).map(|number| {
        let short = u16::try_from(number).ok();
        (number, short.and_then(|number| tables?.fault(number, true)))
    });
    let by_bit = by_bits(drive, readings, true)
        .into_iter()
        .map(|(number, row)| (u32::from(number), Some(row)));
    Some(
        by_number
            .chain(by_bit)
            .map(|(number, row)| WarningEntry {
                number,
                meaning: row.map(|row| row.meaning),
                remedy: row.map(|row| row.remedy).filter(|remedy| !remedy.is_empty()),
                parameters: named(tables, row.map_or("", |row| row.remedy)),
            })
            .collect(),
    )
}

fn log(drive: &Drive, readings: &Readings) -> Vec<LoggedFault> {
    let beside = |part, index| {
        let mut all = readings.all(part);
        all.find(|reading| reading.index == index).and_then(Reading::raw)
    };
    let codes = readings.all(Part::FaultLog);
    let entries = codes.filter_map(|reading| {
        let number = u16::try_from(reading.raw()?).ok().filter(|number| *number != 0)?;
        let row = drive
            .model
            .catalogue
            .and_then(|tables| tables.fault(number, false));
        Some(LoggedFault {
            number,
            meaning: row.map(|row| row.meaning),
            value: beside(Part::FaultLogValue, reading.index),
            time: beside(Part::FaultLogTime, reading.index),
        })
    });
    entries.collect()
}
