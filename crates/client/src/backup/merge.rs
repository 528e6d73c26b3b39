//! Settings of two sources for one drive.

use profile::catalogue::Role;

use super::{Backup, key, rule, selection};
use crate::change::in_size_of;

impl Backup {
    /// Returns the same with the settings of `first` in place of its own. What belongs to the connection (telegram, command
    /// source, way to get an address) is only taken from `first`. Numbers of `first` are converted to the scaling of this one. The
    /// second list has those that do not fit then.
    #[must_use]
    pub fn under(mut self, first: &Self) -> (Self, Vec<profile::value::Reading>) {
        let parameters = self.parameters;
        self.readings.retain(|reading| {
            first.reading(reading.pnu, reading.index).is_none()
                && rule(&parameters, reading.pnu, reading.index).role != Role::Network
        });
        let mut unfit = Vec::new();
        for reading in &first.readings {
            let chosen = selection(&parameters, reading);
            let converted = match (chosen.parameter, reading.raw()) {
                (Some(parameter), Some(raw)) => {
                    let raw = parameters.converted(parameter, raw, &first.parameters.scaling);
                    in_size_of(&parameters, &chosen, reading, raw)
                }
                _ => Ok(reading.clone()),
            };
            match converted {
                Ok(reading) => self.readings.push(reading),
                Err(_) => unfit.push(reading.clone()),
            }
        }
        self.readings.sort_by_key(key);
        (self, unfit)
    }
}
