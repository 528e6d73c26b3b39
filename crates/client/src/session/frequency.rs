//! Speeds of frequency converters as output frequencies.

use profile::catalogue::Part;

use super::Session;
use crate::{Drive, Error};

/// Seconds in a minute: between Hz and rpm.
const MINUTE: f64 = 60.0;
/// What the pole pairs of a motor are found by.
const PARTS: [Part; 3] = [Part::MotorFrequency, Part::MotorSpeed, Part::MotorPoles];

impl Session {
    /// Reads the pole pairs of the motor of a frequency converter: from its own parameter, else from nominal frequency and
    /// nominal speed.
    ///
    /// # Errors
    /// [`Error::NoFrequency`] when the drive is no frequency converter or its motor data are not valid; when the drive cannot be
    /// reached.
    pub async fn pole_pairs(&mut self, drive: &mut Drive) -> Result<f64, Error> {
        let tables = drive.model.catalogue;
        let converter = tables.is_some_and(|tables| tables.part(Part::MotorFrequency).is_some());
        let known = match converter {
            true => self.ask(drive, &PARTS).await?.known_pole_pairs(),
            false => None,
        };
        known.ok_or_else(|| Error::NoFrequency {
            drive: drive.label(),
            converter,
        })
    }
}

/// Returns the synchronous speed of a motor at an output frequency, rpm. The rotor of an induction motor is slower by its slip.
///
/// ```
/// assert_eq!(profidrive_client::synchronous_speed(25.0, 2.0), 750.0);
/// ```
#[must_use]
pub fn synchronous_speed(hertz: f64, pole_pairs: f64) -> f64 {
    hertz * MINUTE / pole_pairs
}
