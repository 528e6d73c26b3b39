//! Error numbers of the parameter manager.

use alloc::format;
use alloc::string::{String, ToString};
use core::fmt;

pub use super::generated_errors::ERRORS;
use super::generated_errors::{DANFOSS, SIEMENS, VACON};

/// Whose manufacturer-specific numbers (from 0x65) apply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ErrorNames {
    /// Only the numbers of the profile.
    #[default]
    Profile,
    /// Danfoss VLT.
    Danfoss,
    /// Vacon OPTEA, OPTE9 and OPTCP.
    Vacon,
    /// Siemens SINAMICS.
    Siemens,
}

/// One row of the table of error numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ErrorInfo {
    /// Number on the wire.
    pub number: u16,
    /// Its text.
    pub meaning: &'static str,
    /// What a person can do about it.
    pub remedy: &'static str,
    /// True when the additional information is the subindex of the first element that failed.
    pub subindex: bool,
    /// Where this is from.
    pub source: &'static str,
}

/// Number in an error block (format 0x44).
///
/// ```
/// use profidrive_profile::parameter::{ErrorNames, ErrorNumber};
/// assert_eq!(ErrorNumber::NOT_NOW.to_string(), "0x11 not executable in the present operating state");
/// assert_eq!(ErrorNumber(0x68).info(ErrorNames::Vacon).unwrap().meaning, "illegal number of parameters");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ErrorNumber(pub u16);

impl ErrorNumber {
    /// From here on the numbers are the vendor's.
    pub const FIRST_OWN: u16 = 0x65;
    /// Danfoss: wrong axis.
    pub const DANFOSS_WRONG_AXIS: Self = Self(0x65);
    /// Danfoss: unknown service.
    pub const DANFOSS_UNKNOWN_SERVICE: Self = Self(0x66);
    /// Danfoss: not with multi-parameter access.
    pub const DANFOSS_SINGLE_ONLY: Self = Self(0x67);
    /// Danfoss: the bus has no access to the value.
    pub const DANFOSS_NOT_READABLE: Self = Self(0x68);
    /// Vacon: invalid request reference.
    pub const VACON_REFERENCE: Self = Self(0x65);
    /// Vacon: illegal number of parameters.
    pub const VACON_PARAMETERS: Self = Self(0x68);
    /// Vacon: illegal attribute.
    pub const VACON_ATTRIBUTE: Self = Self(0x69);
    /// Vacon: request too short.
    pub const VACON_TOO_SHORT: Self = Self(0x6B);
    /// Vacon: parameter not found or not accessible.
    pub const VACON_NOT_FOUND: Self = Self(0x6C);
    /// Vacon: invalid change request.
    pub const VACON_INVALID_CHANGE: Self = Self(0x6D);
    /// Vacon: general error.
    pub const VACON_GENERAL: Self = Self(0x6E);

    /// Meaning and remedy, `None` for a reserved number or another vendor's.
    #[must_use]
    pub fn info(self, names: ErrorNames) -> Option<&'static ErrorInfo> {
        let special: &'static [ErrorInfo] = match names {
            ErrorNames::Profile => &[],
            ErrorNames::Danfoss => DANFOSS,
            ErrorNames::Vacon => VACON,
            ErrorNames::Siemens => SIEMENS,
        };
        special.iter().chain(ERRORS).find(|row| row.number == self.0)
    }

    /// Returns the number and meaning, with the words of a model.
    ///
    /// ```
    /// use profidrive_profile::parameter::{ErrorNames, ErrorNumber};
    /// assert_eq!(ErrorNumber(0x65).words(ErrorNames::Danfoss), "0x65 wrong axis");
    /// assert_eq!(ErrorNumber(0x65).words(ErrorNames::Profile), "0x65 manufacturer specific");
    /// ```
    #[must_use]
    pub fn words(self, names: ErrorNames) -> String {
        match self.info(names) {
            Some(info) => format!("0x{:02X} {}", self.0, info.meaning),
            None => self.to_string(),
        }
    }
}

impl fmt::Display for ErrorNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self.info(ErrorNames::Profile) {
            Some(info) => info.meaning,
            None if self.0 >= 0x65 => "manufacturer specific",
            None => "reserved",
        };
        write!(f, "0x{:02X} {text}", self.0)
    }
}

/// Why a drive refused one parameter of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
pub struct ParameterError {
    /// What.
    pub number: ErrorNumber,
    /// Additional information if the drive sent some: for most numbers the first subindex at which it failed.
    pub info: Option<u16>,
}

impl From<ErrorNumber> for ParameterError {
    fn from(number: ErrorNumber) -> Self {
        Self { number, info: None }
    }
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.number.fmt(f)?;
        match self.info {
            Some(info) if info != 0 => write!(f, " (at {info})"),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_ascending_and_worded() {
        assert!(ERRORS.windows(2).all(|pair| pair[0].number < pair[1].number));
        assert!(
            ERRORS
                .iter()
                .all(|row| !row.meaning.is_empty() && !row.remedy.is_empty())
        );
        assert_eq!(ErrorNumber(0x13).info(ErrorNames::Vacon), None);
        assert_eq!(ErrorNumber(0x65).info(ErrorNames::Profile), None);
        assert_eq!(
            ErrorNumber(0x65).info(ErrorNames::Danfoss).map(|i| i.meaning),
            Some("wrong axis")
        );
        // a number of the profile for which a model has a more precise text
        let remedy = |names| ErrorNumber::NOT_NOW.info(names).map_or("", |info| info.remedy);
        assert!(remedy(ErrorNames::Danfoss).contains("0-11"));
        assert!(!remedy(ErrorNames::Profile).contains("0-11"));
        let own = ErrorNumber::DANFOSS_NOT_READABLE
            .info(ErrorNames::Danfoss)
            .unwrap();
        assert!(own.remedy.contains("read or set"), "{own:?}");
    }
}
