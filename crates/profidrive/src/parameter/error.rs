//! Error numbers of the parameter manager.

use core::fmt;

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
}

/// One row of the table of error numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ErrorInfo {
    /// Number on the wire.
    pub number: u16,
    /// What it says.
    pub meaning: &'static str,
    /// What a person can do about it.
    pub remedy: &'static str,
}

/// Number in an error block (format 0x44).
///
/// ```
/// use profidrive::parameter::{ErrorNames, ErrorNumber};
/// assert_eq!(ErrorNumber::NOT_NOW.to_string(), "0x11 not executable in the present operating state");
/// assert_eq!(ErrorNumber(0x68).info(ErrorNames::Vacon).unwrap().meaning, "illegal number of parameters");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ErrorNumber(pub u16);

macro_rules! errors {
    ($($(#[doc = $doc:literal])? $constant:ident = $number:literal, $meaning:literal, $remedy:literal;)*) => {
        impl ErrorNumber {
            $(#[doc = concat!("0x", stringify!($number), ": ", $meaning, ".")]
            pub const $constant: Self = Self($number);)*
        }
        /// Error numbers of the profile, ascending.
        /// Source: profile reference 1.11.
        pub static ERRORS: &[ErrorInfo] = &[
            $(ErrorInfo { number: $number, meaning: $meaning, remedy: $remedy },)*
        ];
    };
}

errors! {
    UNKNOWN_PARAMETER = 0x00, "impermissible parameter number", "the drive has no such PNU: check the number, the model and the firmware";
    NOT_CHANGEABLE = 0x01, "parameter value cannot be changed", "the parameter is read-only";
    LIMIT = 0x02, "lower or upper limit exceeded", "give a value inside the limits that `describe` shows";
    SUBINDEX = 0x03, "faulty subindex", "the array has no such element: give a smaller subindex";
    NO_ARRAY = 0x04, "no array", "the parameter has no elements: leave the subindex away";
    DATA_TYPE = 0x05, "incorrect data type", "send the value in the size of the parameter";
    RESET_ONLY = 0x06, "setting not permitted, only resetting", "only 0 may be written";
    DESCRIPTION_FIXED = 0x07, "description element cannot be changed", "write the value, not the description";
    PPO_WRITE = 0x08, "PPO write not available", "use the acyclic channel";
    NO_DESCRIPTION = 0x09, "no description data", "the drive does not describe this parameter; the tables may";
    ACCESS_GROUP = 0x0A, "wrong access group", "unlock the access level in the drive";
    NO_RIGHTS = 0x0B, "no operation priority", "another interface holds the right to change: release it there, or set PNU 927";
    PASSWORD = 0x0C, "password missing", "enter the password in the drive";
    TEXT_NOT_CYCLIC = 0x0D, "text cannot be read in cyclic transmission", "read the text acyclically";
    NAME_NOT_CYCLIC = 0x0E, "name cannot be read in cyclic transmission", "read the name acyclically";
    NO_TEXT = 0x0F, "no text array available", "the parameter has no texts";
    READ_PROTECTED = 0x10, "no read access", "the parameter is protected in the drive";
    NOT_NOW = 0x11, "not executable in the present operating state", "disable the drive or stop the axis, then try again";
    OTHER = 0x12, "other error", "look at the drive's own display or log";
    VALUE = 0x14, "value impermissible", "the value is inside the limits but not one of the allowed ones";
    TOO_LONG = 0x15, "response too long", "ask for fewer parameters or elements at once";
    ADDRESS = 0x16, "impermissible parameter address", "check attribute, number of elements, PNU and subindex together";
    FORMAT = 0x17, "illegal format", "send Byte, Word, Double word or the true type of the parameter";
    VALUE_COUNT = 0x18, "number of values inconsistent", "send as many values as elements are addressed";
    NO_AXIS = 0x19, "axis or drive object does not exist", "use the axis number of the drive (0 for AKD and VLT, 1 for Vacon)";
    TEXT_FIXED = 0x20, "text element cannot be changed", "texts of this parameter are fixed";
    SERVICE = 0x21, "service not supported", "the drive does not know this kind of request";
    TOO_MANY = 0x22, "too many parameter requests", "send fewer requests at once";
    SINGLE_ONLY = 0x23, "only single parameter access supported", "send one parameter in each request";
}

/// Danfoss VLT. Source: FC 300 Profibus manual.
static DANFOSS: &[ErrorInfo] = &[
    ErrorInfo {
        number: 0x65,
        meaning: "wrong axis",
        remedy: "send axis 0",
    },
    ErrorInfo {
        number: 0x66,
        meaning: "unknown service",
        remedy: "send request ID 1, 2, 0x42, 0x51 or 0x52",
    },
    ErrorInfo {
        number: 0x67,
        meaning: "not with multi-parameter access",
        remedy: "send one parameter in each request",
    },
    ErrorInfo {
        number: 0x68,
        meaning: "parameter value cannot be read from the bus",
        remedy: "read it at the drive's own panel",
    },
];

/// Vacon OPTEA, OPTE9 and OPTCP. Source: OPTEA manual, OPTCP manual.
static VACON: &[ErrorInfo] = &[
    ErrorInfo {
        number: 0x65,
        meaning: "invalid request reference",
        remedy: "send a reference from 1 to 255",
    },
    ErrorInfo {
        number: 0x66,
        meaning: "invalid request ID",
        remedy: "send 1 to read or 2 to change",
    },
    ErrorInfo {
        number: 0x67,
        meaning: "invalid axis",
        remedy: "send axis 1",
    },
    ErrorInfo {
        number: 0x68,
        meaning: "illegal number of parameters",
        remedy: "send 1 to 39 parameters",
    },
    ErrorInfo {
        number: 0x69,
        meaning: "illegal attribute",
        remedy: "send 0x10 (value) or 0x20 (description)",
    },
    ErrorInfo {
        number: 0x6B,
        meaning: "request too short",
        remedy: "send the whole request",
    },
    ErrorInfo {
        number: 0x6C,
        meaning: "parameter not found or not accessible",
        remedy: "check the application ID in the subindex",
    },
    ErrorInfo {
        number: 0x6D,
        meaning: "invalid change request",
        remedy: "check number, format and value",
    },
    ErrorInfo {
        number: 0x6E,
        meaning: "general error",
        remedy: "look at the drive's panel",
    },
];

impl ErrorNumber {
    /// Vacon: request too short.
    pub const VACON_TOO_SHORT: Self = Self(0x6B);

    /// Meaning and remedy, `None` for a reserved number or another maker's.
    #[must_use]
    pub fn info(self, names: ErrorNames) -> Option<&'static ErrorInfo> {
        let special: &'static [ErrorInfo] = match names {
            ErrorNames::Profile => &[],
            ErrorNames::Danfoss => DANFOSS,
            ErrorNames::Vacon => VACON,
        };
        ERRORS.iter().chain(special).find(|row| row.number == self.0)
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
    }
}
