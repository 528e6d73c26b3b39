//! The operating mode of a drive (PNU 930), and a mode for one piece of work: what that changes is put back.

use profile::parameter::pnu;
use profile::state::Mode;

use super::Session;
use super::temporary::{Before, PutBack, TemporaryChange};
use crate::axis::ReportedTelegram;
use crate::error::mode_words;
use crate::{Drive, Error, WriteMode};
use profile::value::Reading;

/// A mode for one piece of work: see [`Session::enter_mode`]. Dropping it puts back what the work has changed.
#[derive(Debug)]
pub struct ModeChange {
    /// Mode before; `None` if it was neither speed control nor positioning.
    pub before: Option<Mode>,
    /// The mode is another one now.
    pub changed: bool,
    settings: TemporaryChange,
}

impl ModeChange {
    /// Puts mode, telegram and mapping back: see [`TemporaryChange::put_back`].
    ///
    /// # Errors
    /// When what the drive has now cannot be read; a value that is refused is reported in the list.
    pub async fn put_back(self) -> Result<Vec<PutBack>, Error> {
        self.settings.put_back().await
    }
}

impl Session {
    /// Returns the mode of a drive (PNU 930): `None` for one that is neither speed control nor positioning, or that
    /// does not report it.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn operating_mode(&mut self, drive: &mut Drive) -> Result<Option<Mode>, Error> {
        let readings = self.read_numbers(drive, &[pnu::OPERATING_MODE]).await?;
        Ok(readings
            .first()
            .and_then(|reading| reading.raw())
            .and_then(mode_of))
    }

    /// Returns whether a drive is in the required mode; for one that does not report it the caller's value counts.
    ///
    /// # Errors
    /// When it is in another one, or cannot be reached.
    pub async fn check_mode(&mut self, drive: &mut Drive, needed: Mode) -> Result<(), Error> {
        drive.check_able(Some(needed))?;
        match self.operating_mode(drive).await? {
            Some(present) if present != needed => Err(Error::WrongMode {
                drive: drive.label(),
                needed,
                present: mode_words(present).to_owned(),
            }),
            _ => Ok(()),
        }
    }

    /// Puts a drive into a mode (PNU 930) and reads back.
    ///
    /// # Errors
    /// When the drive refuses, which it does while it is in operation, or cannot be reached.
    pub async fn set_operating_mode(&mut self, drive: &mut Drive, mode: Mode) -> Result<(), Error> {
        let assignment = format!("{}={}", pnu::OPERATING_MODE, mode_number(mode)).parse()?;
        let set = self.write(drive, &[assignment], WriteMode::Write).await?;
        set.accepted()?;
        if set.is_done() {
            return Ok(());
        }
        Err(Error::WrongMode {
            drive: drive.label(),
            needed: mode,
            present: "the mode as before, though it took the change".into(),
        })
    }

    /// Puts a drive into the mode that a piece of work needs. When what this returns goes, the engine puts back what this and
    /// the work have changed, whatever became of the work: the mode, the telegram (PNU 922) and the mapping of a free one
    /// (PNU 915, 916).
    ///
    /// # Errors
    /// In local operation, as [`set_operating_mode`](Self::set_operating_mode), and when it cannot be reached.
    pub async fn enter_mode(&mut self, drive: &mut Drive, needed: Mode) -> Result<ModeChange, Error> {
        self.check_control(drive).await?;
        self.ended(drive).await?;
        let values = self.mode_values(drive).await?;
        let of = |numbers: &[u16]| -> Vec<Reading> {
            let own = values.iter().filter(|value| numbers.contains(&value.pnu));
            own.cloned().collect()
        };
        let before = number_of(&values, pnu::OPERATING_MODE).and_then(|number| mode_of(number.into()));
        let changed = before != Some(needed);
        // a mode that is neither of the two is not put back
        let mode = of(&[pnu::OPERATING_MODE]);
        let mode = mode.into_iter().filter(|_| changed && before.is_some());
        let mode = mode.map(|value| (value, Vec::new()));
        // the telegram brings its own mapping with it, unless it is a free one
        let mapping = of(&[pnu::SETPOINT_SIGNALS, pnu::ACTUAL_SIGNALS]);
        let telegram = of(&[pnu::TELEGRAM]).into_iter();
        let telegram = telegram.map(|value| (value, mapping.clone()));
        let settings = mode.chain(telegram).map(|(value, with)| Before { value, with });
        let settings = self.change_for_work(drive, settings.collect())?;
        if changed {
            self.set_operating_mode(drive, needed).await?;
        }
        Ok(ModeChange {
            before,
            changed,
            settings,
        })
    }

    /// The number in PNU 930 and what the drive reports about its telegram.
    pub(super) async fn mode_and_telegram(
        &mut self,
        drive: &mut Drive,
    ) -> Result<(Option<u16>, ReportedTelegram), Error> {
        let values = self.mode_values(drive).await?;
        let reported = ReportedTelegram {
            number: number_of(&values, pnu::TELEGRAM),
            setpoint: trimmed(numbers(&values, pnu::SETPOINT_SIGNALS).collect()),
            actual: trimmed(numbers(&values, pnu::ACTUAL_SIGNALS).collect()),
        };
        Ok((number_of(&values, pnu::OPERATING_MODE), reported))
    }

    /// Mode, telegram and mapping.
    async fn mode_values(&mut self, drive: &mut Drive) -> Result<Vec<Reading>, Error> {
        let wanted = [
            pnu::TELEGRAM,
            pnu::OPERATING_MODE,
            pnu::SETPOINT_SIGNALS,
            pnu::ACTUAL_SIGNALS,
        ];
        self.read_numbers(drive, &wanted).await
    }
}

/// The words of one parameter.
fn numbers(values: &[Reading], pnu: u16) -> impl Iterator<Item = u16> {
    let own = values.iter().filter(move |value| value.pnu == pnu);
    own.filter_map(|value| u16::try_from(value.raw()? & 0xFFFF).ok())
}

fn number_of(values: &[Reading], pnu: u16) -> Option<u16> {
    numbers(values, pnu).next()
}

/// Returns the number of a mode in PNU 930.
const fn mode_number(mode: Mode) -> u16 {
    match mode {
        Mode::Velocity => 1,
        Mode::Position => 2,
    }
}

/// PNU 930: 1 speed control, 2 positioning.
pub(super) const fn mode_of(number: i64) -> Option<Mode> {
    match number {
        1 => Some(Mode::Velocity),
        2 => Some(Mode::Position),
        _ => None,
    }
}

/// Without the empty words behind the last signal.
fn trimmed(mut words: Vec<u16>) -> Vec<u16> {
    while words.last() == Some(&0) {
        words.pop();
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_words_at_the_end_are_no_signals() {
        assert_eq!(trimmed(vec![1, 0, 5, 0, 0]), [1, 0, 5]);
        assert_eq!(trimmed(vec![0; 4]), [0; 0]);
    }
}
