//! Looking at a drive beside its controller: reads only.

use profidrive::fault::{ConsistentRead, Next};
use profidrive::notation::{Elements, ParameterReference, Target};
use profinet::Medium;

use super::Session;
use crate::parameter::{Reading, Selection};
use crate::{Drive, Error, Refusal};

/// Control word, status word, speed setpoint and speed as the drive shows them as parameters.
const STW1: u16 = 1;
const ZSW1: u16 = 2;
const NSOLL_A: u16 = 5;
const NIST_A: u16 = 6;
/// Fault message counter and fault numbers.
const FAULT_COUNTER: u16 = 944;
const FAULT_NUMBERS: u16 = 947;
/// Reads of a fault buffer that keeps changing.
const ATTEMPTS: u8 = 3;

/// A drive at a moment, from one parameter job.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Control word the drive acts on.
    pub stw1: Option<u16>,
    /// Status word and speed.
    pub zsw1: Option<u16>,
    /// Speed asked for, in the unit of the reading.
    pub speed_set: Option<Reading>,
    /// Speed.
    pub speed_actual: Option<Reading>,
    /// Changes of the fault buffer so far.
    pub fault_counter: Option<u16>,
    /// What else was asked for.
    pub readings: Vec<Result<Reading, Refusal>>,
}

/// One fault of the buffer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaultEntry {
    /// Situation 0 is not acknowledged yet, 1 the last acknowledged.
    pub situation: u8,
    /// Position in the situation.
    pub position: u8,
    /// The maker's number.
    pub number: u16,
    /// What it means, where the tables know.
    pub meaning: Option<&'static str>,
    /// What to do, where the tables know.
    pub remedy: Option<&'static str>,
}

impl<M: Medium> Session<M>
where
    M::Error: Send + Sync + 'static,
{
    /// State words, speeds and `more`, read in as few jobs as possible.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub fn snapshot(&mut self, drive: &mut Drive, more: &[Selection]) -> Result<Snapshot, Error> {
        let mut selections: Vec<Selection> = [STW1, ZSW1, NSOLL_A, NIST_A, FAULT_COUNTER]
            .iter()
            .filter_map(|&pnu| drive.parameters.select(&ParameterReference::number(pnu)).ok())
            .collect();
        selections.extend_from_slice(more);
        let mut readings = self.read(drive, &selections)?.into_iter();
        let mut next = || readings.next().and_then(Result::ok);
        let word = |reading: Option<Reading>| reading?.raw().and_then(|raw| u16::try_from(raw & 0xFFFF).ok());
        Ok(Snapshot {
            stw1: word(next()),
            zsw1: word(next()),
            speed_set: next(),
            speed_actual: next(),
            fault_counter: word(next()),
            readings: readings.collect(),
        })
    }

    /// The fault buffer, newest situation first, read so that all of it belongs together.
    ///
    /// # Errors
    /// When the drive cannot be reached, has no fault buffer, or the buffer keeps changing.
    pub fn faults(&mut self, drive: &mut Drive) -> Result<Vec<FaultEntry>, Error> {
        let counter = drive
            .parameters
            .select(&ParameterReference::number(FAULT_COUNTER))?;
        let buffer = self.fault_selection(drive)?;
        let mut order = ConsistentRead::new(ATTEMPTS);
        let mut numbers = Vec::new();
        loop {
            match order.next() {
                Next::Counter => {
                    let reading = self.read_one(drive, &counter)?;
                    order.counter(reading.raw().and_then(|raw| u16::try_from(raw).ok()).unwrap_or(0));
                }
                Next::Buffer => {
                    numbers = self.read(drive, &[buffer])?;
                    order.buffer();
                }
                Next::Done => break,
                Next::GiveUp => {
                    let what = "reading the fault buffer, which kept changing;";
                    let limit = std::time::Duration::from_millis(0);
                    return Err(Error::Timeout {
                        drive: drive.label(),
                        what,
                        limit,
                    });
                }
            }
        }
        let mut faults = Vec::new();
        for (at, reading) in numbers.into_iter().enumerate() {
            let reading = reading.map_err(|refusal| Error::Refused {
                drive: drive.label(),
                refusal,
            })?;
            let number = reading.raw().and_then(|raw| u16::try_from(raw).ok()).unwrap_or(0);
            if number == 0 {
                continue;
            }
            let text = drive
                .model
                .catalogue
                .and_then(|tables| tables.fault(number, false));
            let at = u8::try_from(at).unwrap_or(u8::MAX);
            faults.push(FaultEntry {
                situation: at / 8,
                position: at % 8,
                number,
                meaning: text.map(|text| text.meaning),
                remedy: text.map(|text| text.remedy).filter(|remedy| !remedy.is_empty()),
            });
        }
        Ok(faults)
    }

    /// The whole buffer: as long as the tables say, 64 where there are none.
    fn fault_selection(&self, drive: &Drive) -> Result<Selection, Error> {
        let known = drive.model.catalogue.is_some();
        let elements = (!known).then_some(Elements { first: 0, count: 64 });
        let reference = ParameterReference {
            target: Target::Number(FAULT_NUMBERS),
            elements,
            prefix: None,
        };
        Ok(drive.parameters.select(&reference)?)
    }
}
