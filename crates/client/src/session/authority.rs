//! Who commands a drive at this moment. Reads only.

use std::fmt;

use profile::catalogue::Part;
use profile::state::Zsw1;

use super::Session;
use super::prepare::zsw1_of;
use super::stop::STANDS;
use crate::{Drive, Error};

/// Who commands a drive.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Authority {
    /// Local operation at the drive itself (ZSW1 bit 9 is 0).
    Local(LocalControl),
    /// The controller of this station name, empty where it has none.
    Controller(String),
    /// No controller, and operation is enabled (S4) or the motor turns in S3: the last control word is still in force,
    /// or the drive follows its setting for a lost controller.
    Ownerless,
    /// No controller, and the drive is not in operation.
    Free,
    /// The device does not report its connections.
    Unknown,
}

/// Who at the drive itself commands it.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum LocalControl {
    /// Its service channel has enabled it: setup software, or a parameter.
    ServiceChannel,
    /// A parameter keeps the field bus from commanding it.
    Setting {
        /// The parameter, as its vendor writes it.
        parameter: String,
        /// Its setting.
        setting: String,
    },
    /// Its panel or its inputs.
    Panel,
    /// It does not request control by the field bus; the commanding site is not reported.
    Elsewhere,
}

impl LocalControl {
    /// Returns the remedy at the drive that gives control to the field bus.
    #[must_use]
    pub fn remedy(&self) -> String {
        match self {
            Self::ServiceChannel => "switch it off where it was enabled, or disable it by parameter".into(),
            Self::Setting { parameter, .. } => {
                format!("stop it at its inputs or its panel; {parameter} must let the field bus command it")
            }
            Self::Panel => {
                "stop it at its panel (OFF), then hand control over to the field bus (AUTO, remote)".into()
            }
            Self::Elsewhere => {
                "hand control over to the field bus in its setup software or by its inputs".into()
            }
        }
    }
}

impl fmt::Display for LocalControl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ServiceChannel => f.write_str("its service channel has enabled it"),
            Self::Setting { parameter, setting } => {
                write!(f, "{parameter} is {setting}, the field bus may not command it")
            }
            Self::Panel => f.write_str("its panel or its inputs command it"),
            Self::Elsewhere => f.write_str("its service channel or its inputs have it"),
        }
    }
}

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
