//! Header and parameter address: which parameters a request means.

use core::fmt;

use super::access::Keep;

/// Octets of the header of a request or response.
pub(super) const HEADER: usize = 4;
/// Octets of one parameter address.
pub(super) const ADDRESS: usize = 6;
/// Elements of one parameter address at most, 0xEA.
pub const MAX_ELEMENTS: u8 = 234;

/// Attribute that a request addresses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RequestId {
    /// 0x01.
    Read,
    /// 0x02.
    Change,
    /// 0x42, Danfoss: a change that is retained over a power cycle; one with 0x02 is not.
    ChangePermanent,
    /// 0x51, Danfoss: a read that has every value as a double word.
    ReadWide,
    /// 0x52, Danfoss: a change that has every value as a double word.
    ChangeWide,
    /// Anything else.
    Other(u8),
}

impl RequestId {
    /// From the octet on the wire.
    #[must_use]
    pub const fn from_octet(octet: u8) -> Self {
        match octet {
            1 => Self::Read,
            2 => Self::Change,
            0x42 => Self::ChangePermanent,
            0x51 => Self::ReadWide,
            0x52 => Self::ChangeWide,
            other => Self::Other(other),
        }
    }

    /// Returns the octet on the wire.
    #[must_use]
    pub const fn octet(self) -> u8 {
        match self {
            Self::Read => 1,
            Self::Change => 2,
            Self::ChangePermanent => 0x42,
            Self::ReadWide => 0x51,
            Self::ChangeWide => 0x52,
            Self::Other(other) => other,
        }
    }

    /// Returns true for requests that carry values.
    #[must_use]
    pub const fn is_change(self) -> bool {
        matches!(self, Self::Change | Self::ChangePermanent | Self::ChangeWide)
    }

    /// Returns true for the requests that have every value as a double word.
    #[must_use]
    pub const fn is_wide(self) -> bool {
        matches!(self, Self::ReadWide | Self::ChangeWide)
    }

    /// Returns the storage that a change with this ID requests.
    #[must_use]
    pub const fn keep(self) -> Keep {
        match self {
            Self::ChangePermanent => Keep::Permanent,
            _ => Keep::Volatile,
        }
    }

    /// ID of a positive response; 0x80 is added for a negative one. Danfoss lists only 0x01, 0x02, 0x81 and 0x82, also for
    /// its own requests (MCA 101 p. 31); that these are what they are answered with is our reading.
    #[must_use]
    pub const fn response_octet(self) -> u8 {
        match self {
            Self::Read | Self::ReadWide => 1,
            Self::Change | Self::ChangePermanent | Self::ChangeWide => 2,
            Self::Other(other) => other,
        }
    }

    /// Returns true when a response with this ID answers such a request, positively or negatively. Mirrored IDs are
    /// accepted beside those of [`response_octet`](Self::response_octet).
    #[must_use]
    pub const fn is_answered_by(self, response_id: u8) -> bool {
        let id = response_id & 0x7F;
        id == self.response_octet() || id == self.octet()
    }

    /// Returns true when a response with this ID can refuse such a request because the drive does not support it. Every
    /// drive supports the requests of the profile. For the others the response ID is not standardised: a Vacon has
    /// 0x80, others 0x81 or that of the request.
    ///
    /// ```
    /// use profidrive_profile::parameter::RequestId;
    /// assert!(RequestId::Other(3).is_refused_by(0x80) && RequestId::ChangePermanent.is_refused_by(0x81));
    /// assert!(!RequestId::Read.is_refused_by(0x80) && !RequestId::Other(3).is_refused_by(0x01));
    /// ```
    #[must_use]
    pub const fn is_refused_by(self, response_id: u8) -> bool {
        !matches!(self, Self::Read | Self::Change) && response_id & 0x80 != 0
    }
}

/// Which side of a parameter is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Attribute {
    /// 0x10.
    Value,
    /// 0x20, see [`Description`](super::Description).
    Description,
    /// 0x30, texts of 16 octets.
    Text,
    /// Anything else; from 0x80 the vendor's own.
    Other(u8),
}

impl Attribute {
    /// From the octet on the wire.
    #[must_use]
    pub const fn from_octet(octet: u8) -> Self {
        match octet {
            0x10 => Self::Value,
            0x20 => Self::Description,
            0x30 => Self::Text,
            other => Self::Other(other),
        }
    }

    /// Returns the octet on the wire.
    #[must_use]
    pub const fn octet(self) -> u8 {
        match self {
            Self::Value => 0x10,
            Self::Description => 0x20,
            Self::Text => 0x30,
            Self::Other(other) => other,
        }
    }
}

/// One parameter of a request: six octets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ParameterAddress {
    /// Value, description or text.
    pub attribute: Attribute,
    /// Elements from the subindex on; 0 or 1 for a parameter that is not an array.
    pub elements: u8,
    /// Parameter number.
    pub pnu: u16,
    /// First element.
    pub subindex: u16,
}

impl ParameterAddress {
    /// One value.
    #[must_use]
    pub const fn value(pnu: u16, subindex: u16) -> Self {
        Self {
            attribute: Attribute::Value,
            elements: 1,
            pnu,
            subindex,
        }
    }

    /// `elements` values from `subindex` on.
    #[must_use]
    pub const fn values(pnu: u16, subindex: u16, elements: u8) -> Self {
        Self {
            attribute: Attribute::Value,
            elements,
            pnu,
            subindex,
        }
    }

    /// Returns the whole description, 46 octets.
    #[must_use]
    pub const fn description(pnu: u16) -> Self {
        Self {
            attribute: Attribute::Description,
            elements: 1,
            pnu,
            subindex: 0,
        }
    }

    /// Returns the six octets.
    #[must_use]
    pub const fn to_octets(self) -> [u8; ADDRESS] {
        let [pnu_high, pnu_low] = self.pnu.to_be_bytes();
        let [sub_high, sub_low] = self.subindex.to_be_bytes();
        [
            self.attribute.octet(),
            self.elements,
            pnu_high,
            pnu_low,
            sub_high,
            sub_low,
        ]
    }

    /// From six octets.
    #[must_use]
    pub const fn from_octets(octets: [u8; ADDRESS]) -> Self {
        let [attribute, elements, pnu_high, pnu_low, sub_high, sub_low] = octets;
        Self {
            attribute: Attribute::from_octet(attribute),
            elements,
            pnu: u16::from_be_bytes([pnu_high, pnu_low]),
            subindex: u16::from_be_bytes([sub_high, sub_low]),
        }
    }
}

/// What was wrong in a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrong {
    /// The block ends before the header does.
    Header,
    /// The block ends before all parameter addresses are there.
    Addresses,
    /// A format code that is reserved or unknown in the code space of the dialect.
    Format,
    /// The block ends before all values are there.
    Values,
    /// Octets behind the last block.
    Trailing,
}

/// A block that cannot be taken apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub struct DecodeError {
    /// What was wrong.
    pub wrong: Wrong,
    /// Where.
    pub offset: usize,
    /// Octets that should have been there, or the number allowed.
    pub expected: usize,
    /// Octets that were there, or the number found.
    pub found: usize,
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            wrong,
            offset,
            expected,
            found,
        } = self;
        match wrong {
            Wrong::Header => write!(f, "the header needs {expected} octets, the block has {found}"),
            Wrong::Addresses => {
                write!(
                    f,
                    "the parameter addresses need {expected} octets from offset {offset}, there are {found}"
                )
            }
            Wrong::Format => write!(f, "unknown format 0x{found:02X} at offset {offset}"),
            Wrong::Values => write!(
                f,
                "the values at offset {offset} need {expected} octets, there are {found}"
            ),
            Wrong::Trailing => write!(f, "{found} octets behind the last block at offset {offset}"),
        }
    }
}
