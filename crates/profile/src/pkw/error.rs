//! Error numbers of the PKW channel: the contents of PWE low in a reply with AK 7.

use alloc::format;
use alloc::string::{String, ToString};
use core::fmt;

pub use super::generated_errors::PKW_ERRORS;
use super::generated_errors::{ABB, DANFOSS, SIEMENS};
use crate::parameter::ErrorNumber;

/// Whose numbers apply beside those that mean the same everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum PkwErrorNames {
    /// Only the common numbers.
    #[default]
    Profile,
    /// Danfoss.
    Danfoss,
    /// Siemens.
    Siemens,
    /// ABB.
    Abb,
}

impl PkwErrorNames {
    /// Returns the rows of this vendor alone.
    #[must_use]
    pub const fn rows(self) -> &'static [PkwErrorInfo] {
        match self {
            Self::Profile => &[],
            Self::Danfoss => DANFOSS,
            Self::Siemens => SIEMENS,
            Self::Abb => ABB,
        }
    }
}

/// One row of the table of error numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PkwErrorInfo {
    /// Number in PWE low.
    pub number: u16,
    /// Its text.
    pub meaning: &'static str,
    /// What a person can do about it.
    pub remedy: &'static str,
    /// Where this is from.
    pub source: &'static str,
}

/// Number in PWE low of a reply with AK 7. Source: Danfoss FC parameter block description p. 73 (0 to 5, 17, 130, 131)
/// and the vendors named in the rows.
///
/// ```
/// use profidrive_profile::pkw::{PkwErrorNames, PkwErrorNumber};
/// assert_eq!(PkwErrorNumber::LIMIT.to_string(), "2 value exceeds the limits of the parameter");
/// let factory = PkwErrorNumber(131).info(PkwErrorNames::Danfoss).unwrap();
/// assert_eq!(factory.meaning, "change not possible, the factory setup is selected");
/// assert_eq!(PkwErrorNumber(131).info(PkwErrorNames::Siemens), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PkwErrorNumber(pub u16);

impl PkwErrorNumber {
    /// Danfoss: the factory set-up is the one that is edited.
    pub const FACTORY_SET_UP: Self = Self(131);

    /// Returns meaning and remedy; `None` for an undocumented number or that of another vendor.
    #[must_use]
    pub fn info(self, names: PkwErrorNames) -> Option<&'static PkwErrorInfo> {
        PKW_ERRORS
            .iter()
            .chain(names.rows())
            .find(|row| row.number == self.0)
    }

    /// Returns the number and meaning, with the meanings of a vendor.
    ///
    /// ```
    /// use profidrive_profile::pkw::{PkwErrorNames, PkwErrorNumber};
    /// let number = PkwErrorNumber(130);
    /// assert_eq!(number.words(PkwErrorNames::Danfoss), "130 no bus access to the parameter");
    /// assert_eq!(number.words(PkwErrorNames::Profile), "130 (vendor-specific number)");
    /// ```
    #[must_use]
    pub fn words(self, names: PkwErrorNames) -> String {
        match self.info(names) {
            Some(info) => format!("{} {}", self.0, info.meaning),
            None => self.to_string(),
        }
    }

    /// Returns the number under which a drive that serves both channels refuses here what it refuses acyclically with
    /// `number`. Up to 18 the numbers agree; beyond, each vendor has others, and what has none is 18, other error.
    ///
    /// ```
    /// use profidrive_profile::parameter::ErrorNumber;
    /// use profidrive_profile::pkw::{PkwErrorNames, PkwErrorNumber};
    /// let refused = |names| PkwErrorNumber::from_parameter(ErrorNumber::VALUE, names);
    /// assert_eq!(refused(PkwErrorNames::Danfoss), PkwErrorNumber::LIMIT);
    /// assert_eq!(refused(PkwErrorNames::Siemens), PkwErrorNumber(104));
    /// ```
    #[must_use]
    pub fn from_parameter(number: ErrorNumber, names: PkwErrorNames) -> Self {
        let siemens = names == PkwErrorNames::Siemens;
        let danfoss = names == PkwErrorNames::Danfoss;
        match number.0 {
            same @ (0..=15 | 17 | 18) => Self(same),
            // protected against reading: the 16 of this channel means something else
            0x10 if danfoss => Self(130),
            0x10 => Self::ACCESS_GROUP,
            0x14 if siemens => Self(104),
            0x14 => Self::LIMIT,
            0x15..=0x18 if siemens => Self(number.0),
            0x17 | 0x18 => Self::DATA_TYPE,
            0x20 if siemens => Self(107),
            0x20 => Self::NOT_CHANGEABLE,
            0x21 if siemens => Self(106),
            0x21 if danfoss => Self(253),
            0x21 if names == PkwErrorNames::Abb => Self(102),
            // Danfoss 0x68: the bus has no access to the value
            0x68 if danfoss => Self(130),
            // the vendor's own numbers of the one channel are those of the other
            own if own >= 0x65 && names.rows().iter().any(|row| row.number == own) => Self(own),
            _ => Self::OTHER,
        }
    }
    /// Returns the number of the acyclic channel with the same meaning, for clients that use those numbers. Beyond 18
    /// some vendors have own numbers for what the profile has one for; what has none keeps its number.
    ///
    /// ```
    /// use profidrive_profile::parameter::ErrorNumber;
    /// use profidrive_profile::pkw::{PkwErrorNames, PkwErrorNumber};
    /// assert_eq!(PkwErrorNumber(253).to_parameter(PkwErrorNames::Danfoss), ErrorNumber::SERVICE);
    /// assert_eq!(PkwErrorNumber::LIMIT.to_parameter(PkwErrorNames::Danfoss), ErrorNumber::LIMIT);
    /// ```
    #[must_use]
    pub fn to_parameter(self, names: PkwErrorNames) -> ErrorNumber {
        let siemens = names == PkwErrorNames::Siemens;
        let danfoss = names == PkwErrorNames::Danfoss;
        match self.0 {
            // the 16 of this channel means something else
            16 => ErrorNumber::OTHER,
            130 if danfoss => ErrorNumber(0x68),
            131 if danfoss => ErrorNumber::NOT_NOW,
            253 if danfoss => ErrorNumber::SERVICE,
            254 if danfoss => ErrorNumber::ADDRESS,
            101 if siemens => ErrorNumber::NOT_NOW,
            102 if siemens => ErrorNumber::FORMAT,
            20 | 104 if siemens => ErrorNumber::VALUE,
            105 if siemens => ErrorNumber::SUBINDEX,
            106 if siemens => ErrorNumber::SERVICE,
            107 if siemens => ErrorNumber::TEXT_FIXED,
            108 if siemens => ErrorNumber::VALUE_COUNT,
            200 | 201 if siemens => ErrorNumber::LIMIT,
            204 if siemens => ErrorNumber::PASSWORD,
            other => ErrorNumber(other),
        }
    }
}

impl fmt::Display for PkwErrorNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.info(PkwErrorNames::Profile) {
            Some(info) => write!(f, "{} {}", self.0, info.meaning),
            None => write!(f, "{} (vendor-specific number)", self.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seed of the Danfoss parameter block: these and no other words of it.
    #[test]
    fn the_numbers_of_the_danfoss_parameter_block() {
        let all = [
            (0, "does not exist"),
            (1, "no write access"),
            (2, "exceeds the limits"),
            (3, "subindex does not exist"),
            (4, "not an array"),
            (5, "data type does not match"),
            (17, "present mode"),
            (130, "no bus access"),
            (131, "factory setup"),
        ];
        for (number, words) in all {
            let info = PkwErrorNumber(number).info(PkwErrorNames::Danfoss).unwrap();
            assert!(info.meaning.contains(words), "{number}: {}", info.meaning);
            assert_eq!(info.source, "Danfoss FC parameter block description p.73");
        }
    }

    #[test]
    fn rows_have_texts_and_no_vendor_repeats_a_common_number() {
        for names in [
            PkwErrorNames::Profile,
            PkwErrorNames::Danfoss,
            PkwErrorNames::Siemens,
            PkwErrorNames::Abb,
        ] {
            for row in PKW_ERRORS.iter().chain(names.rows()) {
                assert!(!row.meaning.is_empty() && !row.remedy.is_empty() && !row.source.is_empty());
            }
            assert!(names.rows().iter().all(|row| row.number > 18));
        }
    }

    #[test]
    fn acyclic_refusals_map_to_numbers_of_the_vendor() {
        for names in [
            PkwErrorNames::Profile,
            PkwErrorNames::Danfoss,
            PkwErrorNames::Siemens,
            PkwErrorNames::Abb,
        ] {
            for number in 0..=0xFF {
                let mapped = PkwErrorNumber::from_parameter(ErrorNumber(number), names);
                assert!(mapped.info(names).is_some(), "{names:?} {number:#x}: {mapped}");
            }
        }
        let danfoss = |number| PkwErrorNumber::from_parameter(number, PkwErrorNames::Danfoss).0;
        assert_eq!(danfoss(ErrorNumber::UNKNOWN_PARAMETER), 0);
        assert_eq!(danfoss(ErrorNumber::NOT_NOW), 17);
        assert_eq!(danfoss(ErrorNumber(0x68)), 130);
        // 101 is the wrong axis acyclically and nothing here
        assert_eq!(danfoss(ErrorNumber(0x65)), 18);
    }
}
