//! One parameter that a drive refused.

use std::fmt;

use profidrive::notation::Shown;
use profidrive::parameter::{ErrorNames, ErrorNumber};

/// One parameter that a drive refused to read or write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refusal {
    /// Number and element.
    pub shown: Shown,
    /// Name, where known.
    pub name: Option<&'static str>,
    /// True for a write.
    pub write: bool,
    /// The drive's error number.
    pub number: ErrorNumber,
    /// Whose words its own numbers have.
    pub names: ErrorNames,
    /// Additional information of the drive: often the element at fault.
    pub information: Option<u16>,
    /// What to do about it for this parameter, where the tables of the drive know more than the number says.
    pub advice: Option<&'static str>,
}

impl Refusal {
    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> Option<&'static str> {
        let general = || self.number.info(self.names).map(|info| info.remedy);
        self.advice.or_else(general)
    }

    /// The number with its meaning.
    #[must_use]
    pub fn words(&self) -> String {
        self.number.words(self.names)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verb = if self.write { "writing" } else { "reading" };
        match self.name {
            Some(name) => write!(f, "{verb} {name} ({}) refused: {}", self.shown, self.words())?,
            None => write!(f, "{verb} {} refused: {}", self.shown, self.words())?,
        }
        self.information
            .filter(|&info| info != 0)
            .map_or(Ok(()), |info| write!(f, " (information {info})"))
    }
}
