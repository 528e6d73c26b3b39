//! Which profile the control and status words of a vendor have.

use super::Profile;
use crate::telegram::Telegram;

/// Which bits the control and status words of a vendor have.
///
/// Which parameter chooses, where one does, is in the tables of the model
/// ([`Part::ControlProfile`](crate::catalogue::Part::ControlProfile)).
///
/// ```
/// use profidrive_profile::state::{ControlWords, Profile};
/// use profidrive_profile::telegram::{DANFOSS, Telegram};
/// let (standard, ppo) = (Telegram::find(1, DANFOSS), Telegram::find(104, DANFOSS));
/// assert_eq!(ControlWords::VLT.of(standard, Some(0)), Profile::DanfossProfidrive);
/// assert_eq!(ControlWords::VLT.of(ppo, Some(0)), Profile::DanfossFc);
/// assert_eq!(ControlWords::VLT.of(ppo, Some(1)), Profile::DanfossProfidrive);
/// assert_eq!(ControlWords::PROFIDRIVE.of(ppo, None), Profile::Profidrive);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControlWords {
    /// In telegrams of the profile.
    pub standard: Profile,
    /// In telegrams of the vendor ([`Telegram::own_words`]).
    pub own: Profile,
    /// The latter where a parameter chooses it, by its value; any other value means `own`.
    pub chosen: &'static [(i64, Profile)],
}

impl ControlWords {
    /// STW1 and ZSW1.
    pub const PROFIDRIVE: Self = Self {
        standard: Profile::Profidrive,
        own: Profile::Profidrive,
        chosen: &[],
    };
    /// VLT: its PROFIdrive words in telegram 1, in the PPO types as set by 8-10. Source: MCA 120 manual 6.5 and 6.6;
    /// that 8-10 does not count for telegram 1 is our reading.
    pub const VLT: Self = Self {
        standard: Profile::DanfossProfidrive,
        own: Profile::DanfossFc,
        chosen: &[(0, Profile::DanfossFc), (1, Profile::DanfossProfidrive)],
    };
    /// Vacon: own words in telegrams 148 to 150. Source: OPTEA manual p. 103 and 104.
    pub const VACON: Self = Self {
        standard: Profile::Profidrive,
        own: Profile::VaconPpo,
        chosen: &[],
    };

    /// Those of a telegram; of the profile's where none is known. `choice` is the value of the drive's parameter.
    #[must_use]
    pub fn of(&self, telegram: Option<&Telegram>, choice: Option<i64>) -> Profile {
        if telegram.is_some_and(|telegram| telegram.own_words) {
            self.vendor_profile(choice)
        } else {
            self.standard
        }
    }

    /// The profile where there is only one.
    #[must_use]
    pub fn only(&self) -> Option<Profile> {
        let one = self.standard == self.own && self.chosen.iter().all(|(_, profile)| *profile == self.own);
        one.then_some(self.own)
    }

    /// Those of the vendor's telegrams.
    #[must_use]
    pub fn vendor_profile(&self, choice: Option<i64>) -> Profile {
        choice.and_then(|value| self.by(value)).unwrap_or(self.own)
    }

    /// What a value of the parameter chooses; `None` for one that chooses nothing.
    #[must_use]
    pub fn by(&self, value: i64) -> Option<Profile> {
        let row = self.chosen.iter().find(|(known, _)| *known == value);
        row.map(|(_, profile)| *profile)
    }
}
