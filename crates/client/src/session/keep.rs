//! Settings that a telegram carries in coarser steps than the drive has them: read before, put back afterwards.

use profile::telegram::signal::kollmorgen;

use super::Session;
use crate::axis::Wiring;
use crate::{Drive, Error};
use profile::value::{Reading, Selection};

/// Setpoint signals of an AKD and the setting that each of them changes.
/// Source: AKD manual 5.6, signals 108 and 109 of telegram 354.
const CARRIED: [(u16, &str); 2] = [(kollmorgen::DRV_ACC, "DRV.ACC"), (kollmorgen::DRV_DEC, "DRV.DEC")];

impl Session {
    /// The settings that a telegram is going to change, as they are.
    pub(super) async fn keep(&mut self, drive: &mut Drive, wiring: &Wiring) -> Result<Vec<Reading>, Error> {
        let carried = CARRIED.iter().filter(|(signal, _)| wiring.commands(*signal));
        let selections: Vec<Selection> = carried.filter_map(|(_, name)| drive.select(name).ok()).collect();
        let read = self.read(drive, &selections).await?;
        Ok(read.into_iter().flatten().collect())
    }
}
