//! Looking at a drive beside its controller: reads only.

use profidrive::notation::ParameterReference;

use super::Session;
use crate::parameter::{Reading, Selection};
use crate::{Drive, Error, Refusal, Wire};

/// Control word, status word, speed setpoint and speed as the drive shows them as parameters.
const STW1: u16 = 1;
const ZSW1: u16 = 2;
const NSOLL_A: u16 = 5;
const NIST_A: u16 = 6;
/// Fault message counter.
const FAULT_COUNTER: u16 = 944;

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

impl<M: Wire> Session<M> {
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
}
