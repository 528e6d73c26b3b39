//! What a drive does when its controller is lost, by its own settings.

use std::fmt;
use std::time::Duration;

use profile::catalogue::{Catalogue, Part};

use super::Session;
use super::readings::Readings;
use crate::{Action, Drive, Error};

/// What an axis does when the controller of its drive is lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LossAction {
    /// It stops along the ramp of the drive.
    Ramp,
    /// It stops with the quick stop of the drive.
    QuickStop,
    /// The drive switches its power stage off, the axis coasts.
    Coast,
    /// It stops. No source says how.
    Stop,
    /// It keeps turning.
    KeepsTurning,
    /// Not known.
    Unknown,
}

impl LossAction {
    /// Stable name for programs.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Ramp => "ramp",
            Self::QuickStop => "quick-stop",
            Self::Coast => "coast",
            Self::Stop => "stop",
            Self::KeepsTurning => "keeps-turning",
            Self::Unknown => "unknown",
        }
    }

    /// True when the axis stops without a command.
    #[must_use]
    pub const fn stops(self) -> bool {
        !matches!(self, Self::KeepsTurning | Self::Unknown)
    }
}

/// What a drive does when its controller or master is lost, with the setting that says so.
#[derive(Debug, Clone, PartialEq)]
pub struct LossReaction {
    /// What the axis does.
    pub action: LossAction,
    /// The parameter that decides, as its vendor writes it. `None` where no parameter decides.
    pub parameter: Option<String>,
    /// The setting of that parameter.
    pub setting: Option<String>,
    /// Time from the last control word until the drive reacts, where a parameter sets it.
    pub after: Option<Duration>,
    /// The last control word is not in force from then on: this reaction commands the axis.
    pub commands: bool,
    /// A setting with which the drive stops, for a drive that does not stop or may not.
    pub remedy: Option<Action>,
}

impl LossReaction {
    /// Nothing is known.
    pub(super) const UNKNOWN: Self = Self {
        action: LossAction::Unknown,
        parameter: None,
        setting: None,
        after: None,
        commands: false,
        remedy: None,
    };

    /// Whether the axis may run on after the loss of its controller by a setting of the drive. False where nothing is known
    /// of the drive: no setting could be named that changes it.
    #[must_use]
    pub const fn runs_on(&self) -> bool {
        !self.action.stops() && self.parameter.is_some()
    }

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

impl fmt::Display for LossReaction {
    /// `the drive keeps turning (8-04 is Off)`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.action {
            LossAction::Ramp => "the drive stops along its ramp",
            LossAction::QuickStop => "the drive stops with a quick stop",
            LossAction::Coast => "the drive switches its power stage off and coasts",
            LossAction::Stop => "the drive stops",
            LossAction::KeepsTurning => "the drive keeps turning",
            LossAction::Unknown => "it is not known whether the drive stops",
        })?;
        if let Some(after) = self.after.filter(|_| self.action.stops()) {
            write!(f, " after {} s", after.as_secs_f64())?;
        }
        match (&self.parameter, &self.setting) {
            (Some(parameter), Some(setting)) => write!(f, " ({parameter} is {setting})"),
            _ => Ok(()),
        }
    }
}

/// The parts that say what a value of the deciding parameter means.
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
    /// ID 506, FAULT702.ACTION of the AKD). What no table says is [`LossAction::Unknown`].
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub async fn loss_reaction(&mut self, drive: &mut Drive) -> Result<LossReaction, Error> {
        let Some(tables) = drive.model.catalogue else {
            return Ok(LossReaction::UNKNOWN);
        };
        let readings = match self.ask(drive, &PARTS).await {
            Ok(readings) => readings,
            Err(Error::Refused { .. } | Error::Record { .. } | Error::Channel { .. }) => {
                return Ok(LossReaction::UNKNOWN);
            }
            Err(error) => return Err(error),
        };
        Ok(reaction(tables, drive.is_on_line(), &readings))
    }
}

/// What the values of [`PARTS`] come down to.
pub(super) fn reaction(tables: &Catalogue, on_line: bool, readings: &Readings) -> LossReaction {
    // without a time of its own the reaction belongs to the watchdog of the network; a serial line has none
    if on_line && tables.part(Part::LossTime).is_none() {
        return LossReaction::UNKNOWN;
    }
    let (Some(reading), Some(raw)) = (
        readings.find(Part::LostController),
        readings.raw(Part::LostController),
    ) else {
        return LossReaction::UNKNOWN;
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
    let stops = tables.part_values(Part::LostController).last();
    let remedy = stops.filter(|_| !action.stops()).map(|&value| Action::Write {
        parameter: parameter.clone(),
        value,
        meaning: tables
            .part(Part::LostController)
            .and_then(|parameter| parameter.choice(value)),
    });
    LossReaction {
        action,
        setting: Some(reading.choice.map_or_else(|| raw.to_string(), str::to_owned)),
        after: readings
            .number(Part::LossTime)
            .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
        parameter: Some(parameter),
        commands: row.is_some() && !means(Part::LossNone, raw),
        remedy,
    }
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
    }
}
