//! One parameter that a drive refused, or that the channel to it cannot carry.

use crate::Advice;
use std::fmt;

use profile::notation::Shown;
use profile::parameter::{ErrorNames, ErrorNumber};
use profile::pkw::{PkwErrorNames, PkwErrorNumber};
use uss::Protocol;

/// One parameter that was not read or written: the drive refused, or nothing was sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refusal {
    /// Number and element.
    pub shown: Shown,
    /// Name, where known.
    pub name: Option<&'static str>,
    /// True for a write.
    pub write: bool,
    /// The drive's error number. At a serial line, the number of records that is next to what came.
    pub number: ErrorNumber,
    /// Whose words its own numbers have.
    pub names: ErrorNames,
    /// Additional information of the drive: often the element at fault.
    pub information: Option<u16>,
    /// What to do about it for this parameter, where the tables of the drive have more than the meaning of the number.
    pub advice: Option<&'static str>,
    /// What came of it in the parameter channel of a serial line; `None` for records.
    pub channel: Option<ChannelRefusal>,
}

/// Why the parameter channel (PKW) of a serial line has no value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChannelRefusal {
    /// Protocol of the line.
    pub protocol: Protocol,
    /// What happened.
    pub cause: ChannelCause,
}

/// What happened in the parameter channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChannelCause {
    /// The drive refused with an error number: AK 7.
    Number {
        /// The number as received.
        number: PkwErrorNumber,
        /// Whose words the vendor's own numbers have.
        names: PkwErrorNames,
    },
    /// The drive refused because another interface has the right to change: AK 8.
    NoRights,
    /// Nothing was sent.
    NotCarried(NotCarried),
}

/// Why the parameter channel cannot carry a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotCarried {
    /// The parameter number does not fit PKE and IND.
    #[error("it has no room for parameter number {0}")]
    Number(u16),
    /// The element does not fit IND.
    #[error("it has no room for element {0}")]
    Element(u16),
    /// The parameter is one of those that one number collects, which are not array.
    #[error("it has no request for the parameters that number {0} collects")]
    Member(u16),
    /// The value does not fit PWE.
    #[error("it has no room for values of {0} octets")]
    Size(usize),
    /// The channel has no request for text.
    #[error("it has no request for text")]
    Text,
    /// The text is too long for a telegram.
    #[error("it has no room for a text of {0} characters")]
    TextLength(usize),
    /// The channel has no such request.
    #[error("it has no such request")]
    Request,
}

impl NotCarried {
    /// Returns the number of records that is next to it, for those who look at numbers only.
    pub(crate) const fn number(self) -> ErrorNumber {
        match self {
            Self::Number(_) | Self::Member(_) => ErrorNumber::UNKNOWN_PARAMETER,
            Self::Element(_) => ErrorNumber::SUBINDEX,
            Self::Size(_) => ErrorNumber::FORMAT,
            Self::Text | Self::Request => ErrorNumber::SERVICE,
            Self::TextLength(_) => ErrorNumber::VALUE_COUNT,
        }
    }
}

impl Refusal {
    fn cause(&self) -> Option<ChannelCause> {
        self.channel.map(|channel| channel.cause)
    }

    /// Returns the reason why nothing was sent; `None` where the drive refused.
    #[must_use]
    pub fn not_carried(&self) -> Option<NotCarried> {
        match self.cause()? {
            ChannelCause::NotCarried(why) => Some(why),
            ChannelCause::Number { .. } | ChannelCause::NoRights => None,
        }
    }

    /// Returns true where nothing was sent.
    #[must_use]
    pub fn is_unsent(&self) -> bool {
        self.not_carried().is_some()
    }

    /// Returns the error number that was received; `None` where there was none.
    #[must_use]
    pub fn received(&self) -> Option<u16> {
        match self.cause() {
            None => Some(self.number.0),
            Some(ChannelCause::Number { number, .. }) => Some(number.0),
            Some(ChannelCause::NoRights | ChannelCause::NotCarried(_)) => None,
        }
    }

    /// Returns the hint.
    #[must_use]
    pub fn remedy(&self) -> Option<Advice> {
        let general = || match self.cause() {
            None => self.number.info(self.names).map(|info| info.remedy),
            Some(ChannelCause::Number { number, names }) => number.info(names).map(|info| info.remedy),
            Some(ChannelCause::NoRights) => PkwErrorNumber::NO_RIGHTS
                .info(PkwErrorNames::Profile)
                .map(|info| info.remedy),
            Some(ChannelCause::NotCarried(_)) => {
                Some("use a channel that carries it: records over PROFINET, or the panel of the drive")
            }
        };
        self.advice.or_else(general).map(Advice::from)
    }

    /// Returns the answer: the number as received with its meaning, or why nothing was sent.
    #[must_use]
    pub fn words(&self) -> String {
        match self.cause() {
            None => self.number.words(self.names),
            Some(ChannelCause::Number { number, names }) => number.words(names),
            Some(ChannelCause::NoRights) => "no change rights for the parameter channel".into(),
            Some(ChannelCause::NotCarried(why)) => format!("cannot be carried by this channel: {why}"),
        }
    }

    /// Returns the same with the word for what happened: `refused: 0x11 ..`.
    #[must_use]
    pub fn outcome(&self) -> String {
        if self.is_unsent() {
            self.words()
        } else {
            format!("refused: {}", self.words())
        }
    }

    /// In a word or two, for a table.
    #[must_use]
    pub fn short(&self) -> String {
        match (self.cause(), self.received()) {
            (None, Some(number)) => format!("refused 0x{number:02X}"),
            (_, Some(number)) => format!("refused {number}"),
            (Some(ChannelCause::NotCarried(_)), None) => "not carried".into(),
            (_, None) => "refused".into(),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verb = if self.write { "writing" } else { "reading" };
        match self.name {
            Some(name) => write!(f, "{verb} {name} ({}) {}", self.shown, self.outcome())?,
            None => write!(f, "{verb} {} {}", self.shown, self.outcome())?,
        }
        self.information
            .filter(|&info| info != 0 && !self.is_unsent())
            .map_or(Ok(()), |info| write!(f, " (information {info})"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::notation::Notation;

    fn refusal(cause: Option<ChannelCause>) -> Refusal {
        let protocol = Protocol::Fc;
        Refusal {
            shown: Shown {
                pnu: 341,
                index: None,
                writable: None,
                notation: Notation::GroupIndex,
            },
            name: None,
            write: true,
            number: ErrorNumber::NOT_NOW,
            names: ErrorNames::Danfoss,
            information: Some(3),
            advice: None,
            channel: cause.map(|cause| ChannelRefusal { protocol, cause }),
        }
    }

    #[test]
    fn each_channel_has_its_own_number_and_words() {
        let names = PkwErrorNames::Danfoss;
        let number = |number| ChannelCause::Number {
            number: PkwErrorNumber(number),
            names,
        };
        for (cause, received, short, words) in [
            (None, Some(0x11), "refused 0x11", "refused: 0x11 not executable"),
            (
                Some(number(131)),
                Some(131),
                "refused 131",
                "refused: 131 change not possible, the factory setup is selected (information 3)",
            ),
            (Some(number(999)), Some(999), "refused 999", "refused: 999 ("),
            (
                Some(ChannelCause::NoRights),
                None,
                "refused",
                "refused: no change rights",
            ),
            (
                Some(ChannelCause::NotCarried(NotCarried::Number(10_001))),
                None,
                "not carried",
                "writing 3-41 cannot be carried by this channel: it has no room for parameter number 10001",
            ),
        ] {
            let refusal = refusal(cause);
            assert_eq!(refusal.received(), received);
            assert_eq!(refusal.short(), short);
            let shown = refusal.to_string();
            assert!(shown.contains(words), "{shown}");
            assert_eq!(shown.contains("(information 3)"), !refusal.is_unsent(), "{shown}");
            assert_eq!(refusal.remedy().is_some(), received != Some(999), "{shown}");
        }
    }
}
