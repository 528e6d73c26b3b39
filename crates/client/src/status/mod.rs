//! How a drive is, and in one sentence why it does not run.

mod advice;
mod facts;
mod generated;
mod notes;
mod rules;
mod vendors;

use std::fmt;

use profile::state::{Mode, Profile, State, Stw1, Zsw1};

use crate::session::power_is_on;
use crate::{Action, Advice, FaultEntry, LocalControl, LossReaction, WarningEntry};

pub use advice::moved_advice;
pub use generated::Cause;
pub use notes::Note;

/// All values that decide whether an axis runs; `None` where the drive does not report them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DriveStatus {
    /// The drive, for the commands in the advice.
    pub drive: String,
    /// Name of its model.
    pub model: &'static str,
    /// Whose bits its control and status word have; [`stw1`](Self::stw1) and [`zsw1`](Self::zsw1) say the same in those
    /// of the profile.
    pub profile: Profile,
    /// The control word as it came.
    pub control_word: Option<u16>,
    /// The status word as it is sent.
    pub status_word: Option<u16>,
    /// Mode that decides over the bits of both words, from PNU 930 and the telegram.
    pub word_mode: Mode,
    /// Name of the controller that has the cyclic connection: `Some(None)` without one.
    pub controller: Option<Option<String>>,
    /// Control word the drive was sent last.
    pub stw1: Option<Stw1>,
    /// Status word.
    pub zsw1: Option<Zsw1>,
    /// Who at the drive itself commands it, while ZSW1 bit 9 is 0.
    pub local: Option<LocalControl>,
    /// PNU 922.
    pub telegram: Option<u16>,
    /// True when the telegram carries a speed setpoint.
    pub carries_speed: Option<bool>,
    /// True when the telegram carries traversing tasks.
    pub carries_tasks: Option<bool>,
    /// PNU 930: 1 speed control, 2 positioning.
    pub mode: Option<u16>,
    /// What moves its axis in this mode, of what the drive can do.
    pub motions: Vec<Action>,
    /// DRV.CMDSOURCE: 1 is the field bus.
    pub command_source: Option<u16>,
    /// What DRV.CMDSOURCE is called.
    pub command_source_text: Option<&'static str>,
    /// DRV.DISSOURCES.
    pub disable_sources: Option<u16>,
    /// DRV.MOTIONDISSOURCES.
    pub motion_disable_sources: Option<u16>,
    /// Share of its speed with which a motion task runs, in percent.
    pub feedrate: Option<f64>,
    /// DRV.MOTIONSTAT.
    pub motion: Option<u32>,
    /// Torque is allowed (STO.STATE is 1).
    pub torque_allowed: Option<bool>,
    /// The limit switch at the negative end is hit.
    pub negative_switch: Option<bool>,
    /// The limit switch at the positive end is hit.
    pub positive_switch: Option<bool>,
    /// SWLS.STATE: bits 0 and 1 for the two software limits.
    pub software_limits: Option<u16>,
    /// Voltage of the DC bus, V.
    pub bus_voltage: Option<f64>,
    /// The voltage below which the drive does not run, V.
    pub bus_lowest: Option<f64>,
    /// Current of the motor, A.
    pub current: Option<f64>,
    /// Torque of the motor, Nm.
    pub torque: Option<f64>,
    /// Torque of the motor in percent of its nominal torque.
    pub torque_percent: Option<f64>,
    /// Temperature of the power stage, at the hottest of its sensors, in degrees Celsius.
    pub temperature: Option<f64>,
    /// Temperature of the motor, in degrees Celsius.
    pub motor_temperature: Option<f64>,
    /// A holding brake is fitted, and applied while the power stage is off.
    pub brake_fitted: Option<bool>,
    /// The brake is released by hand.
    pub brake_released: Option<bool>,
    /// Faults that wait to be acknowledged, first one first.
    pub faults: Vec<FaultEntry>,
    /// Warnings that are present.
    pub warnings: Vec<WarningEntry>,
    /// Speed setpoint in rpm.
    pub speed_set: Option<f64>,
    /// Speed in rpm.
    pub speed_actual: Option<f64>,
    /// Speed in percent of the reference, where that is not known in rpm.
    pub speed_percent: Option<f64>,
    /// What the drive does when its controller is lost.
    pub loss: Option<LossReaction>,
    /// Position in turns.
    pub position: Option<f64>,
    /// Position command minus position, in turns.
    pub following_error: Option<f64>,
}

/// What kind of answer a diagnosis is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It runs, or stands on command.
    Runs,
    /// No problem; it was not commanded to run.
    Waits,
    /// Something keeps it from running.
    Held,
}

impl Verdict {
    /// Stable name for programs.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Runs => "runs",
            Self::Waits => "waits",
            Self::Held => "held",
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

/// Why a drive does not run, or that it does.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Diagnosis {
    /// What it comes down to.
    pub cause: Cause,
    /// What kind of answer it is.
    pub verdict: Verdict,
    /// One sentence, with the bit or parameter that shows it.
    pub sentence: String,
    /// What to do next, where something is to be done. Its actions are in the order in which they help.
    pub next: Option<Advice>,
    /// What else stands in the way, or is about to.
    pub notes: Vec<Note>,
}

/// The one cause that matters most.
///
/// ```
/// use profidrive_client::status::{Cause, DriveStatus, diagnose};
/// use profile::state::{Stw1, Zsw1};
/// let status = DriveStatus {
///     drive: "akd-1".into(),
///     controller: Some(Some("plc".into())),
///     stw1: Some(Stw1(0x047E)),
///     zsw1: Some(Zsw1(0x0231)),
///     ..DriveStatus::default()
/// };
/// let found = diagnose(&status);
/// assert_eq!(found.cause, Cause::Off);
/// assert_eq!(
///     found.sentence,
///     "ready for switching on (S2), but controller \"plc\" does not send ON (STW1 bit 0 is 0)"
/// );
/// ```
#[must_use]
pub fn diagnose(status: &DriveStatus) -> Diagnosis {
    rules::first(status)
}

/// Why a drive has left operation though its controller commanded it, as far as its parameters alone show: nothing
/// at its inputs, no fault, no warning is left that would. `None` where something else is known.
///
/// Read after the axis was released: what the drive reports of its power stage then is the effect of the release.
#[must_use]
pub fn switched_off_beside(status: &DriveStatus) -> Option<Note> {
    notes::switched_off_beside(status)
}

impl DriveStatus {
    /// State of the drive, read with the control word it was sent.
    #[must_use]
    pub fn state(&self) -> Option<State> {
        self.zsw1?.state(self.stw1.unwrap_or_default())
    }

    /// `controller "plc"`, or `no controller`, or `the controller`.
    fn owner(&self) -> String {
        match &self.controller {
            Some(Some(name)) if !name.is_empty() => format!("controller \"{name}\""),
            Some(None) => "no controller".into(),
            _ => "the controller".into(),
        }
    }

    /// The power stage is off, by the status word.
    fn unpowered(&self) -> bool {
        self.zsw1.is_some_and(|word| !power_is_on(word))
    }

    /// ` (STW1 bit 1 is 0)`; where the words have other bits, the word itself and whose it is.
    fn bit_is_0(&self, bit: u8) -> String {
        match self.control_word {
            Some(word) if self.profile != Profile::Profidrive => {
                format!("(control word 0x{word:04X}, {})", self.profile.name())
            }
            _ => format!("(STW1 bit {bit} is 0)"),
        }
    }

    /// ` (STW1 bit 0 is 1)`, likewise.
    fn bit_is_1(&self, bit: u8) -> String {
        self.bit_is_0(bit).replace(" is 0)", " is 1)")
    }

    fn has(&self, bit: Zsw1) -> bool {
        self.zsw1.is_some_and(|word| word.has(bit))
    }

    /// True when a bit of the control word is known to be 0.
    fn lacks(&self, bit: Stw1) -> bool {
        self.stw1.is_some_and(|word| !word.has(bit))
    }

    fn sent(&self, bit: Stw1) -> bool {
        self.stw1.is_some_and(|word| word.has(bit))
    }
}

#[cfg(test)]
mod tests;
