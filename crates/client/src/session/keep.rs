//! Settings that a telegram carries in coarser steps than the drive has them: read before, put back afterwards.

use profile::catalogue::Part;

use super::Session;
use crate::axis::Wiring;
use crate::{Drive, Error};
use profile::value::{Reading, Selection};

/// Setpoint signals, which are parameters too, and the setting that each of them changes.
const CARRIED: [(Part, Part); 2] = [
    (Part::AccelerationSignal, Part::Acceleration),
    (Part::DecelerationSignal, Part::Deceleration),
];

impl Session {
    /// The settings that a telegram is going to change, as they are.
    pub(super) async fn keep(&mut self, drive: &mut Drive, wiring: &Wiring) -> Result<Vec<Reading>, Error> {
        let Some(tables) = drive.model.catalogue else {
            return Ok(Vec::new());
        };
        let carried = CARRIED.iter().filter(|(signal, _)| {
            let signal = tables.part(*signal);
            signal.is_some_and(|signal| wiring.commands(signal.pnu))
        });
        let settings = carried.filter_map(|(_, setting)| tables.part(*setting));
        let notation = drive.parameters.notation();
        let selections: Vec<Selection> = settings.map(|setting| Selection::of(setting, notation)).collect();
        let read = self.read(drive, &selections).await?;
        Ok(read.into_iter().flatten().collect())
    }
}
