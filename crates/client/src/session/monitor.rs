//! Looking at a drive beside its controller: reads only.

use profile::catalogue::Part;
use profile::parameter::pnu;
use profile::state::{Mode, Profile};

use super::Session;
use crate::{Drive, Error, Refusal};
use profile::value::{Reading, Selection};

const PARTS: [Part; 7] = [
    Part::ControlWord,
    Part::StatusWord,
    Part::ControlProfile,
    Part::SpeedSetpoint,
    Part::SpeedActual,
    Part::Speed,
    Part::Position,
];

/// A drive at a moment, from one parameter job.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Whose bits the two words have.
    pub profile: Profile,
    /// Mode that decides over the bits of both words, from PNU 930 and the telegram.
    pub mode: Mode,
    /// Control word the drive acts on.
    pub stw1: Option<u16>,
    /// Status word and speed.
    pub zsw1: Option<u16>,
    /// Speed requested, in the unit of the reading.
    pub speed_set: Option<Reading>,
    /// Speed.
    pub speed_actual: Option<Reading>,
    /// Position of the axis, in position mode.
    pub position: Option<Reading>,
    /// Changes of the fault buffer so far.
    pub fault_counter: Option<u16>,
    /// What else was requested.
    pub readings: Vec<Result<Reading, Refusal>>,
}

impl Session {
    /// State words, speeds and `more`, read in as few jobs as possible.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn snapshot(&mut self, drive: &mut Drive, more: &[Selection]) -> Result<Snapshot, Error> {
        let readings = self.ask(drive, &PARTS).await?;
        let numbers = self
            .read_numbers(drive, &[pnu::FAULT_COUNTER, pnu::TELEGRAM, pnu::OPERATING_MODE])
            .await?;
        let word = |pnu| {
            let found = numbers.iter().find(|reading| reading.pnu == pnu);
            let raw = found.and_then(Reading::raw);
            raw.and_then(|raw| u16::try_from(raw & 0xFFFF).ok())
        };
        let (control, status) = (readings.word(Part::ControlWord), readings.word(Part::StatusWord));
        let telegram = drive.telegram_in_use(word(pnu::TELEGRAM));
        let mode = drive.word_mode(word(pnu::OPERATING_MODE).map(i64::from), telegram);
        let position = readings.find(Part::Position).filter(|_| mode == Mode::Position);
        Ok(Snapshot {
            profile: readings.profile(drive, telegram),
            mode,
            stw1: control,
            zsw1: status,
            speed_set: readings.speed(Part::SpeedSetpoint),
            speed_actual: readings
                .speed(Part::SpeedActual)
                .or_else(|| readings.speed(Part::Speed)),
            position: position.cloned(),
            fault_counter: word(pnu::FAULT_COUNTER),
            readings: self.read(drive, more).await?,
        })
    }
}
