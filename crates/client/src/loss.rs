//! What a drive does when its controller is lost.

use std::fmt;
use std::time::Duration;

use crate::{Action, Advice};

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
    pub remedy: Option<Remedy>,
}

/// A setting with which a drive stops when its controller is lost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remedy {
    /// Writes the setting.
    pub action: Action,
    /// Name of the setting, where it has one.
    pub meaning: Option<&'static str>,
}

impl Remedy {
    /// The setting with what it is for, as a sentence.
    #[must_use]
    pub fn sentence(&self) -> Advice {
        let name = self
            .meaning
            .map_or_else(String::new, |meaning| format!(" ({meaning})"));
        Advice::from(self.action.clone()).and(format!(" makes it stop when its controller is lost{name}"))
    }
}

impl LossReaction {
    /// Nothing is known.
    pub(crate) const UNKNOWN: Self = Self {
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

    /// Returns the setting that decides: `8-04 is Off`; empty where no parameter decides.
    #[must_use]
    pub fn named(&self) -> String {
        let named = self.parameter.as_ref().zip(self.setting.as_ref());
        named.map_or_else(String::new, |(parameter, setting)| {
            format!("{parameter} is {setting}")
        })
    }

    /// Whether the loss of a controller that commanded nothing may begin or keep up a motion, by a setting of the drive: it jogs,
    /// goes to its highest speed, or does what is not known.
    #[must_use]
    pub const fn may_command_motion(&self) -> bool {
        self.runs_on() && !self.leaves_alone()
    }

    /// Whether the drive goes on as it is when its controller is lost, by a setting. A motor that something else commands keeps
    /// turning.
    #[must_use]
    pub const fn leaves_alone(&self) -> bool {
        matches!(self.action, LossAction::KeepsTurning) && !self.commands
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
        match self.named() {
            named if named.is_empty() => Ok(()),
            named => write!(f, " ({named})"),
        }
    }
}
