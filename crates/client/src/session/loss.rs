//! Reads what a drive does when its controller is lost, by its own settings.

use std::time::Duration;

use profile::catalogue::{Catalogue, Part};
use profinet::controller::ServiceError;

use super::Session;
use super::readings::Readings;
use crate::{Action, Drive, Error, LossAction, LossReaction, Remedy};

impl LossReaction {
    /// Refuses to enable an axis that runs on without consent.
    ///
    /// # Errors
    /// [`Error::RunsOn`].
    pub fn permit(&self, drive: &Drive, may_run_on: bool) -> Result<(), Error> {
        if may_run_on || !self.runs_on() {
            return Ok(());
        }
        Err(Error::RunsOn {
            drive: drive.label(),
            reaction: Box::new(self.clone()),
        })
    }
}

/// The parts that define what a value of the deciding parameter means.
const REACTIONS: [(Part, LossAction); 6] = [
    (Part::LossKeepsTurning, LossAction::KeepsTurning),
    (Part::LossRamp, LossAction::Ramp),
    (Part::LossQuickStop, LossAction::QuickStop),
    (Part::LossCoast, LossAction::Coast),
    (Part::LossStop, LossAction::Stop),
    (Part::LossStopFunction, LossAction::Stop),
];

/// What has to be read.
pub(super) const PARTS: [Part; 3] = [Part::LostController, Part::LossTime, Part::StopFunction];

impl Session {
    /// Reads what the drive does when its controller is lost. Reads only.
    ///
    /// Sources: `loss-` and `lost-controller` rows of the tables of each model (VLT 8-03 and 8-04, Vacon ID 733 and
    /// ID 506, FAULT702.ACTION of the AKD). What no table contains is [`LossAction::Unknown`], as is a setting that the drive does
    /// not report.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn loss_reaction(&mut self, drive: &mut Drive) -> Result<LossReaction, Error> {
        let Some(tables) = drive.model.catalogue else {
            return Ok(LossReaction::UNKNOWN);
        };
        let readings = match self.ask(drive, &PARTS).await {
            Ok(readings) => readings,
            // a request that got lost says nothing about the drive
            Err(
                Error::Refused { .. }
                | Error::Channel { .. }
                | Error::Record {
                    error: ServiceError::Refused { .. },
                    ..
                },
            ) => return Ok(unread(tables, drive)),
            Err(error) => return Err(error),
        };
        Ok(reaction(tables, drive, &readings))
    }
}

/// What the values of [`PARTS`] come down to.
pub(super) fn reaction(tables: &Catalogue, drive: &Drive, readings: &Readings) -> LossReaction {
    if !decides(tables, drive) {
        return LossReaction::UNKNOWN;
    }
    let (Some(reading), Some(raw)) = (
        readings.find(Part::LostController),
        readings.raw(Part::LostController),
    ) else {
        return unread(tables, drive);
    };
    let means = |part: Part, raw: i64| tables.part_values(part).contains(&raw);
    let row = REACTIONS.iter().find(|(part, _)| means(*part, raw));
    let action = match row {
        Some((Part::LossStopFunction, action)) => match readings.raw(Part::StopFunction) {
            Some(function) if means(Part::StopFunction, function) => LossAction::Ramp,
            Some(_) => LossAction::Coast,
            None => *action,
        },
        Some((_, action)) => *action,
        None => LossAction::Unknown,
    };
    let parameter = reading.shown().to_string();
    LossReaction {
        remedy: match action.stops() {
            true => None,
            false => remedy(tables, &parameter),
        },
        action,
        setting: Some(reading.choice.map_or_else(|| raw.to_string(), str::to_owned)),
        after: readings
            .number(Part::LossTime)
            .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
        parameter: Some(parameter),
        commands: row.is_some() && !means(Part::LossNone, raw),
    }
}

/// Whether the drive has a setting for its reaction. Without a time of its own the reaction belongs to the watchdog of the network;
/// a serial line has none.
fn decides(tables: &Catalogue, drive: &Drive) -> bool {
    !drive.is_on_line() || tables.part(Part::LossTime).is_some()
}

/// The drive does not report the setting that decides: whatever it is, it may be one with which the axis runs on.
fn unread(tables: &Catalogue, drive: &Drive) -> LossReaction {
    let deciding = drive.named(&[Part::LostController]).into_iter().next();
    let Some(parameter) = deciding.filter(|_| decides(tables, drive)) else {
        return LossReaction::UNKNOWN;
    };
    LossReaction {
        remedy: remedy(tables, &parameter),
        parameter: Some(parameter),
        ..LossReaction::UNKNOWN
    }
}

/// The setting of the deciding parameter with which the drive stops.
fn remedy(tables: &Catalogue, parameter: &str) -> Option<Remedy> {
    let value = *tables.part_values(Part::LostController).last()?;
    Some(Remedy {
        action: Action::Write {
            parameter: parameter.to_owned(),
            value: value.to_string(),
        },
        meaning: tables
            .part(Part::LostController)
            .and_then(|parameter| parameter.choice(value)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reaction_names_the_setting_that_decides() {
        let off = LossReaction {
            action: LossAction::KeepsTurning,
            parameter: Some("8-04".into()),
            setting: Some("Off".into()),
            after: Some(Duration::from_secs(1)),
            commands: false,
            remedy: None,
        };
        assert_eq!(off.to_string(), "the drive keeps turning (8-04 is Off)");
        let stop = LossReaction {
            action: LossAction::Ramp,
            setting: Some("Stop".into()),
            ..off
        };
        assert_eq!(
            stop.to_string(),
            "the drive stops along its ramp after 1 s (8-04 is Stop)"
        );
        assert_eq!(
            LossReaction::UNKNOWN.to_string(),
            "it is not known whether the drive stops"
        );
        let unread = LossReaction {
            parameter: Some("8-04".into()),
            ..LossReaction::UNKNOWN
        };
        assert!(unread.runs_on() && !LossReaction::UNKNOWN.runs_on());
        assert_eq!(
            unread.to_string(),
            "it is not known whether the drive stops (8-04 cannot be read)"
        );
    }
}
