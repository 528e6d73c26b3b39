//! Fault and warning numbers of a model.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

use super::{Catalogue, Parameter, Role};
use crate::notation::{Notation, ParameterReference, Target};
use crate::state::FaultReaction;

/// What a fault or warning number means, what the drive does about it and what a person can do. Source: the vendor's
/// lists, named in [`source`](Self::source).
///
/// ```
/// use profidrive_profile::catalogue::{AKD, Cleared, Reaction};
/// let lost = AKD.fault(702, false).unwrap();
/// assert_eq!((lost.reaction, lost.cleared), (Reaction::QuickStop, Cleared::Acknowledge));
/// assert_eq!(lost.reaction.to_string(), "quick stop");
/// assert_eq!(AKD.fault(107, true).unwrap().reaction, Reaction::None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fault {
    /// The number, as in PNU 947.
    pub number: u16,
    /// True for a warning (`n107`), false for a fault (`F107`).
    pub warning: bool,
    /// Its bit in the alarm words of a VLT (16-90 and 16-91 in one: bits 0 to 31 and 32 to 63), or in the warning
    /// words (16-92 and 16-93) of a warning; none where there is no such word or no bit for it.
    pub bit: Option<u8>,
    /// What happened.
    pub meaning: &'static str,
    /// What the drive does when it happens.
    pub reaction: Reaction,
    /// What a person can do about it.
    pub remedy: &'static str,
    /// How it goes away.
    pub cleared: Cleared,
    /// True where the row is from memory and no source was open when it was written.
    pub recalled: bool,
    /// Names of the columns of a row that no source states, empty when there is none.
    pub assumed: &'static str,
    /// Where this is from.
    pub source: &'static str,
}

/// What the drive does about a fault while its motor is on.
/// Source: the AKD fault card ("disable power stage", "dynamic braking", "controlled stop") in the words of PROFIdrive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Reaction {
    /// Pulses off at once, the axis coasts.
    Coast,
    /// Pulses off at once, the shorted windings brake the motor.
    DynamicBrake,
    /// Quick stop, then pulses off.
    QuickStop,
    /// Ramp stop, then pulses off.
    RampStop,
    /// Nothing: it is a warning.
    None,
}

impl Reaction {
    /// Returns its reaction in the general state machine; `None` for a warning.
    #[must_use]
    pub const fn of_machine(self) -> Option<FaultReaction> {
        match self {
            Self::Coast | Self::DynamicBrake => Some(FaultReaction::Coast),
            Self::QuickStop => Some(FaultReaction::QuickStop),
            Self::RampStop => Some(FaultReaction::RampStop),
            Self::None => None,
        }
    }

    /// In words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Coast => "coast",
            Self::DynamicBrake => "dynamic brake",
            Self::QuickStop => "quick stop",
            Self::RampStop => "ramp stop",
            Self::None => "none",
        }
    }
}

impl core::fmt::Display for Reaction {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(self.text())
    }
}

/// How a fault or warning goes away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Cleared {
    /// On acknowledge, once the cause is gone: STW1 bit 7, DRV.CLRFAULTS or an input with that function.
    Acknowledge,
    /// By itself when its cause is gone: a warning.
    ByItself,
    /// By a restart of the drive only.
    Restart,
}

impl Catalogue {
    /// Returns the way in which a fault or warning of this model is cleared, with the parameter that acknowledges where
    /// the model has one.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, Cleared, VLT};
    /// assert!(AKD.clearing(Cleared::Acknowledge).contains("DRV.CLRFAULTS"));
    /// assert!(!VLT.clearing(Cleared::Acknowledge).contains("DRV."));
    /// ```
    #[must_use]
    pub fn clearing(&self, cleared: Cleared) -> String {
        match cleared {
            Cleared::Acknowledge => {
                let by = self
                    .with_role(Role::ClearFaults)
                    .map_or_else(String::new, |parameter| format!(" or {}", parameter.name));
                format!("acknowledge (STW1 bit 7{by}) once the cause is gone")
            }
            Cleared::ByItself => "by itself once the cause is gone".into(),
            Cleared::Restart => {
                "switch the drive off and on once the cause is gone: no command clears it".into()
            }
        }
    }

    /// Returns the parameters that a text in the words of the vendor names, each once, in the order of the text: names as
    /// `DRV.ACC`, numbers as `4-16` and `ID 704`.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, VACON, VLT};
    /// let names = |found: Vec<&profidrive_profile::catalogue::Parameter>| found.iter().map(|one| one.name).collect::<Vec<_>>();
    /// assert_eq!(names(AKD.mentioned("Check the ramps (DRV.ACC, DRV.DEC) of F439.")), ["DRV.ACC", "DRV.DEC"]);
    /// assert_eq!(VLT.mentioned("raise 4-16, see chapter 4")[0].pnu, 416);
    /// assert_eq!(VACON.mentioned("set ID 704 to 1")[0].base, Some(704));
    /// ```
    #[must_use]
    pub fn mentioned(&self, text: &str) -> Vec<&'static Parameter> {
        let part = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '.' | '-' | '_');
        let mut found: Vec<&'static Parameter> = Vec::new();
        let mut before = "";
        for word in text.split(|letter| !part(letter)) {
            let word = word.trim_matches('.');
            let parameter = match self.notation {
                Notation::Name => self.all_by_name(word).next().filter(|_| word.contains('.')),
                Notation::GroupIndex => match word.parse::<ParameterReference>().map(|one| one.target) {
                    Ok(Target::Number(pnu)) if word.contains('-') => self.by_pnu(pnu),
                    _ => None,
                },
                Notation::Id { pnu } => {
                    let id = word.parse().ok().filter(|_| before == "ID");
                    id.and_then(|id| self.by_address(pnu, Some(id)))
                }
            };
            let is = |one: &&Parameter, other: &Parameter| (one.pnu, one.base) == (other.pnu, other.base);
            if let Some(parameter) = parameter
                && !found.iter().any(|one| is(one, parameter))
            {
                found.push(parameter);
            }
            before = word;
        }
        found
    }
}
