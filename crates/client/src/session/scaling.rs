//! The values of a drive that scale other values.

use std::time::Duration;

use profile::value::{SCALING, take_scale};

use profinet::Instant;

use super::Session;
use crate::{Drive, Error};

/// How long the scale of a drive is taken for granted, while an axis runs as well.
pub(super) const SCALE_AGE: Duration = Duration::from_millis(500);

impl Session {
    /// Reads the values of the drive that scale other values, unless it was done less than 500 ms ago: another client, or
    /// another copy of this [`Drive`], may have changed them since.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn read_scaling(&mut self, drive: &mut Drive) -> Result<(), Error> {
        let now = self.now();
        let fresh = drive.scaled_at.is_some_and(|at| now - at < SCALE_AGE);
        let Some(tables) = drive.model.catalogue.filter(|_| !fresh) else {
            return Ok(());
        };
        // what is read here scales nothing itself: a second time nothing would be read
        drive.scaled_at = Some(Instant::MAX);
        // reading looks at the scaling first: the two call each other
        let readings = match Box::pin(self.ask(drive, &SCALING)).await {
            Ok(readings) => readings,
            Err(error) => {
                drive.scaled_at = None;
                return Err(error);
            }
        };
        drive.scaled_at = self.unread().is_none().then(|| self.now());
        for part in SCALING {
            // of several parameters with one value the first counts
            if let Some((reading, number)) = readings.find(part).and_then(|one| Some((one, one.number()?))) {
                let at = (reading.pnu, reading.index);
                take_scale(tables, &mut drive.parameters.scaling, at, number);
            }
        }
        if let Some(reference) = readings.reference() {
            drive.parameters.scaling.reference = Some(reference);
        }
        Ok(())
    }
}
