//! The values of a drive that scale other values.

use profile::value::{SCALING, take_scale};

use super::Session;
use crate::{Drive, Error};

impl Session {
    /// Reads the values of the drive that scale other values, once.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn read_scaling(&mut self, drive: &mut Drive) -> Result<(), Error> {
        let Some(tables) = drive.model.catalogue.filter(|_| !drive.scaled) else {
            return Ok(());
        };
        // what is read here scales nothing itself: a second time nothing would be read
        drive.scaled = true;
        // reading looks at the scaling first: the two call each other
        let readings = match Box::pin(self.ask(drive, &SCALING)).await {
            Ok(readings) => readings,
            Err(error) => {
                drive.scaled = false;
                return Err(error);
            }
        };
        drive.scaled = self.unread().is_none();
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
