//! Who commands a drive at this moment. Reads only.

use profile::catalogue::Part;
use profile::state::Zsw1;

use super::readings::zsw1_of;
use super::{STANDS, Session};
use crate::{Authority, Drive, Error, LocalControl};

impl Session {
    /// Reads who commands a drive.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn authority(&mut self, drive: &mut Drive) -> Result<Authority, Error> {
        let telegram = self.telegram_now(drive).await?;
        let readings = self
            .ask(
                drive,
                &[Part::ControlWord, Part::StatusWord, Part::ControlProfile],
            )
            .await?;
        let word = zsw1_of(drive, &readings, telegram);
        self.authority_by(drive, word).await
    }

    /// Returns the same, by a status word that was read.
    pub(super) async fn authority_by(
        &mut self,
        drive: &mut Drive,
        word: Option<Zsw1>,
    ) -> Result<Authority, Error> {
        if let Some(word) = word.filter(|word| !word.has(Zsw1::CONTROL_REQUESTED)) {
            return Ok(Authority::Local(self.local_control(drive, word).await?));
        }
        let enabled = match word {
            Some(word) if in_operation(word) => true,
            // stopped by itself, or commanded by what it does without its controller
            Some(word) if power_is_on(word) => {
                let readings = self.ask(drive, &[Part::Speed, Part::SpeedActual]).await?;
                readings.stands(STANDS) == Some(false)
            }
            _ => false,
        };
        // the only master of a line is this one
        let owner = if drive.is_on_line() {
            Some(None)
        } else {
            self.owner(drive).await?
        };
        Ok(match owner {
            Some(Some(controller)) => Authority::Controller(controller),
            Some(None) if enabled => Authority::Ownerless,
            Some(None) => Authority::Free,
            None => Authority::Unknown,
        })
    }

    /// Returns the source of local operation, by the settings of the drive.
    pub(super) async fn local_control(
        &mut self,
        drive: &mut Drive,
        word: Zsw1,
    ) -> Result<LocalControl, Error> {
        let Some(tables) = drive.model.catalogue else {
            return Ok(LocalControl::Panel);
        };
        let readings = self.ask(drive, &[Part::ControlSite]).await?;
        let excluded = readings
            .find(Part::ControlSite)
            .zip(readings.raw(Part::ControlSite))
            .filter(|(_, raw)| tables.part_values(Part::ControlSite).contains(raw));
        if let Some((reading, raw)) = excluded {
            return Ok(LocalControl::Setting {
                parameter: reading.shown().to_string(),
                setting: reading.choice.map_or_else(|| raw.to_string(), str::to_owned),
            });
        }
        let by_parameter = tables.part(Part::Disable).is_some();
        Ok(match (by_parameter, in_operation(word)) {
            (true, true) => LocalControl::ServiceChannel,
            (true, false) => LocalControl::Elsewhere,
            (false, _) => LocalControl::Panel,
        })
    }
}

/// Returns whether the power stage may be on: switched on (S3) it is while the motor is stopped.
pub(crate) const fn power_is_on(word: Zsw1) -> bool {
    word.0 & (Zsw1::READY_TO_OPERATE.0 | Zsw1::OPERATION_ENABLED.0) != 0
}

/// Operation is enabled: S4.
pub(super) const fn in_operation(word: Zsw1) -> bool {
    word.has(Zsw1(Zsw1::READY_TO_OPERATE.0 | Zsw1::OPERATION_ENABLED.0))
}
