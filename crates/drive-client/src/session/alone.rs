//! What becomes of a drive whose controller or master is gone.

use profidrive::catalogue::Part;

use super::Session;
use crate::{Drive, Error, Wire};

/// A drive that goes on turning when nobody commands it any more.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GoesOn {
    /// The parameter that says so, as its maker writes it.
    pub parameter: String,
    /// What it is set to.
    pub setting: String,
    /// A value that makes the drive stop.
    pub stops: i64,
    /// What that value is called.
    pub stops_text: Option<&'static str>,
}

impl<M: Wire> Session<M> {
    /// Whether the drive goes on when its controller is gone, by its own setting; `None` where it stops, or where no such
    /// setting is known of its make.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub fn goes_on_alone(&mut self, drive: &mut Drive) -> Result<Option<GoesOn>, Error> {
        let Some(tables) = drive.model.catalogue else {
            return Ok(None);
        };
        let part = Part::LostController;
        let values = tables.part_values(part);
        let (Some(parameter), Some(&stops)) = (tables.part(part), values.last()) else {
            return Ok(None);
        };
        let told = self.ask(drive, &[part])?;
        let (Some(reading), Some(raw)) = (told.find(part), told.raw(part)) else {
            return Ok(None);
        };
        if values.contains(&raw) {
            return Ok(None);
        }
        Ok(Some(GoesOn {
            parameter: reading.shown().to_string(),
            setting: reading.choice.map_or_else(|| raw.to_string(), str::to_owned),
            stops,
            stops_text: parameter.choice(stops),
        }))
    }
}
