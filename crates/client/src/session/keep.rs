//! Settings that a telegram carries in coarser steps than the drive has them: read before, put back afterwards.

use profile::telegram::signal::kollmorgen;

use super::Session;
use crate::axis::Wiring;
use crate::{Drive, Error, WriteMode};
use profile::value::{Assignment, Reading};

/// Setpoint signals of an AKD and the setting that each of them changes.
/// Source: AKD manual 5.6, signals 108 and 109 of telegram 354.
const CARRIED: [(u16, &str); 2] = [(kollmorgen::DRV_ACC, "DRV.ACC"), (kollmorgen::DRV_DEC, "DRV.DEC")];

/// Settings by name, as they were.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Kept(Vec<(&'static str, f64)>);

impl Session {
    /// The settings that a telegram is going to change, as they are.
    pub(super) async fn keep(&mut self, drive: &mut Drive, wiring: &Wiring) -> Result<Kept, Error> {
        let mut kept = Vec::new();
        for (signal, name) in CARRIED {
            if !wiring.commands(signal) {
                continue;
            }
            if let Some(value) = self.setting(drive, name).await? {
                kept.push((name, value));
            }
        }
        Ok(Kept(kept))
    }

    /// Writes those that are not any more what they were.
    pub(super) async fn give_back(&mut self, drive: &mut Drive, kept: &Kept) -> Result<(), Error> {
        for &(name, before) in &kept.0 {
            if self.setting(drive, name).await? == Some(before) {
                continue;
            }
            let assignment: Assignment = format!("{name}={before}").parse()?;
            let outcomes = self.write(drive, &[assignment], WriteMode::Write).await?;
            if let Some(Err(refusal)) = outcomes.into_iter().find_map(|outcome| outcome.written) {
                return Err(Error::Refused {
                    drive: drive.label(),
                    refusal,
                });
            }
        }
        Ok(())
    }

    async fn setting(&mut self, drive: &mut Drive, name: &str) -> Result<Option<f64>, Error> {
        let Ok(selection) = drive.select(name) else {
            return Ok(None);
        };
        let readings = self.read(drive, &[selection]).await?;
        Ok(readings
            .into_iter()
            .flatten()
            .next()
            .as_ref()
            .and_then(Reading::number))
    }
}
