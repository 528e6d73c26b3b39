//! Format codes of values: what a value block carries and how long one value is.

use core::fmt;

pub use super::generated_formats::FORMATS;
use super::generated_formats::V3;

/// Which numbers the profile-specific types have.
/// Source: Wireshark (V4, from 0x71); Danfoss MCA 101 and TR encoTRive p. 195 (V2/V3, decimal from 33).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CodeSpace {
    /// PROFIdrive V4: N2 is 0x71.
    #[default]
    V4,
    /// PROFIdrive V2/V3 and Danfoss: N2 is 33 (0x21).
    V3,
}

/// Octets of one value of a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Octets {
    /// Always this many.
    Fixed(u8),
    /// The number of values counts octets (strings, bit strings, arrays of unknown structure).
    Counted,
    /// With or without a date: four, or six octets. Decided by what is left in the block.
    FourOrSix,
}

/// One row of the table of formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FormatInfo {
    /// Code on the wire.
    pub code: u8,
    /// Name of the type.
    pub name: &'static str,
    /// Octets of one value.
    pub octets: Octets,
    /// How the octets are read.
    pub kind: Kind,
    /// Set for whole numbers and single bits, which a change may carry as one another.
    pub integer: Option<Integer>,
    /// False where no public document gives the code or the length.
    pub verified: bool,
    /// Where this is from.
    pub source: &'static str,
}

/// What the octets of an integer type mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Integer {
    /// A whole number, with the sign that [`FormatInfo::kind`] gives.
    Number,
    /// Single bits, without a sign.
    Bits,
}

/// How the octets of a value are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Nothing to read.
    None,
    /// Two's complement.
    Signed,
    /// Unsigned number or bits.
    Unsigned,
    /// IEEE 754.
    Float,
    /// Characters.
    Text,
    /// Octets without a numeric meaning here.
    Octets,
}

/// Format code of a value block.
///
/// ```
/// use profidrive_profile::parameter::{CodeSpace, Format, Octets};
/// let n2 = Format(0x71).info(CodeSpace::V4).unwrap();
/// assert_eq!((n2.name, n2.octets), ("N2", Octets::Fixed(2)));
/// assert_eq!(Format(33).info(CodeSpace::V3).unwrap().name, "N2");
/// assert_eq!(Format(0x50).info(CodeSpace::V4), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Format(pub u8);

impl Format {
    /// Reserved; the AKD writes it into its positive change response (AKD manual 3.6.2).
    pub const RESERVED: Self = Self(0x00);
    /// Signed octet.
    pub const INTEGER8: Self = Self(0x02);
    /// Signed word.
    pub const INTEGER16: Self = Self(0x03);
    /// Signed double word.
    pub const INTEGER32: Self = Self(0x04);
    /// Unsigned octet.
    pub const UNSIGNED8: Self = Self(0x05);
    /// Unsigned word.
    pub const UNSIGNED16: Self = Self(0x06);
    /// Unsigned double word.
    pub const UNSIGNED32: Self = Self(0x07);
    /// IEEE 754 single.
    pub const FLOAT32: Self = Self(0x08);
    /// Characters; the number of values is the number of octets.
    pub const VISIBLE_STRING: Self = Self(0x09);
    /// Octets; the number of values is the number of octets.
    pub const OCTET_STRING: Self = Self(0x0A);
    /// Two octets, 2^14 is 100 %.
    pub const N2: Self = Self(0x71);
    /// Sixteen bits.
    pub const V2: Self = Self(0x73);
    /// Two octets without numeric meaning.
    pub const OCTET_STRING2: Self = Self(0x1F);
    /// Milliseconds without a date.
    pub const TIME_DIFFERENCE: Self = Self(0x36);
    /// Written, no value.
    pub const ZERO: Self = Self(0x40);
    /// Any type of one octet.
    pub const BYTE: Self = Self(0x41);
    /// Any type of two octets.
    pub const WORD: Self = Self(0x42);
    /// Any type of four octets.
    pub const DOUBLE_WORD: Self = Self(0x43);
    /// An error number, perhaps with additional information.
    pub const ERROR: Self = Self(0x44);

    /// Returns the row of the table, `None` for a code that is reserved or unknown.
    #[must_use]
    pub fn info(self, space: CodeSpace) -> Option<&'static FormatInfo> {
        if space == CodeSpace::V3 {
            match self.0 {
                0x21..=0x2C => return V3.get(usize::from(self.0 - 0x21)),
                0x71..=0x7C => return None,
                _ => {}
            }
        }
        usize::from(INDEX[usize::from(self.0)])
            .checked_sub(1)
            .and_then(|row| FORMATS.get(row))
    }

    /// Returns the code on the wire of a type given as its V4 code: only the profile-specific types differ.
    ///
    /// ```
    /// use profidrive_profile::parameter::{CodeSpace, Format};
    /// assert_eq!(Format::N2.in_space(CodeSpace::V3), Format(33));
    /// assert_eq!(Format::N2.in_space(CodeSpace::V4), Format::N2);
    /// assert_eq!(Format::of_code(33, CodeSpace::V3), Format::N2);
    /// ```
    #[must_use]
    pub const fn in_space(self, space: CodeSpace) -> Self {
        match (space, self.0) {
            (CodeSpace::V3, 0x71..=0x7C) => Self(self.0 - 0x71 + 0x21),
            _ => self,
        }
    }

    /// Returns the type, as its V4 code, of a code on the wire.
    #[must_use]
    pub const fn of_code(code: u8, space: CodeSpace) -> Self {
        match (space, code) {
            (CodeSpace::V3, 0x21..=0x2C) => Self(code - 0x21 + 0x71),
            _ => Self(code),
        }
    }

    /// Returns the substitution code for a value of this many octets: Byte, Word or Double word.
    #[must_use]
    pub const fn for_octets(octets: usize) -> Option<Self> {
        match octets {
            1 => Some(Self::BYTE),
            2 => Some(Self::WORD),
            4 => Some(Self::DOUBLE_WORD),
            _ => None,
        }
    }

    /// Returns true when a change may carry a value of the type `own` in this format, the lengths being equal: the type
    /// itself, Byte, Word and Double word, and another integer type in the place of one. Both are codes of `space`.
    ///
    /// ```
    /// use profidrive_profile::parameter::{CodeSpace, Format};
    /// let carries = |format: Format, own| format.carries(own, CodeSpace::V4);
    /// assert!(carries(Format::DOUBLE_WORD, Format::FLOAT32));
    /// assert!(carries(Format::INTEGER32, Format::UNSIGNED32));
    /// assert!(!carries(Format::FLOAT32, Format::UNSIGNED32));
    /// ```
    #[must_use]
    pub fn carries(self, own: Self, space: CodeSpace) -> bool {
        let is_integer = |format: Self| format.info(space).is_some_and(|info| info.integer.is_some());
        self == own
            || matches!(self, Self::BYTE | Self::WORD | Self::DOUBLE_WORD)
            || is_integer(self) && is_integer(own)
    }

    /// Returns the sign of a whole number: `Some(true)` for a signed type, `Some(false)` for an unsigned one, `None`
    /// for every type that is not a whole number. The substitution codes are not one: their octets mean what the
    /// parameter says.
    ///
    /// ```
    /// use profidrive_profile::parameter::{CodeSpace, Format};
    /// let signed = |format: Format| format.number_is_signed(CodeSpace::V4);
    /// assert_eq!((signed(Format::INTEGER16), signed(Format::UNSIGNED16)), (Some(true), Some(false)));
    /// assert_eq!((signed(Format::V2), signed(Format::WORD), signed(Format::N2)), (None, None, None));
    /// ```
    #[must_use]
    pub fn number_is_signed(self, space: CodeSpace) -> Option<bool> {
        let info = self.info(space)?;
        (info.integer == Some(Integer::Number)).then_some(info.kind == Kind::Signed)
    }

    /// Octets of `count` values without the pad octet; `left` is what remains in the block and determines where a
    /// type has two lengths. `None` for an unknown code.
    #[must_use]
    pub fn data_len(self, space: CodeSpace, count: u8, left: usize) -> Option<usize> {
        let count = usize::from(count);
        match self.0 {
            0x41 => return Some(count),
            0x42 | 0x44 => return Some(2 * count),
            0x43 => return Some(4 * count),
            // a code for no data has no values
            0x00 => return (count == 0).then_some(0),
            _ => {}
        }
        Some(match self.info(space)?.octets {
            Octets::Fixed(octets) => usize::from(octets) * count,
            Octets::Counted => count,
            Octets::FourOrSix if left == 6 * count => 6 * count,
            Octets::FourOrSix => 4 * count,
        })
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.info(CodeSpace::V4) {
            Some(info) => write!(f, "0x{:02X} {}", self.0, info.name),
            None => write!(f, "0x{:02X}", self.0),
        }
    }
}

/// Code to row + 1 of [`FORMATS`]; 0 where there is none.
static INDEX: [u8; 256] = {
    let mut index = [0; 256];
    let mut row = 0;
    while row < FORMATS.len() {
        index[FORMATS[row].code as usize] = row as u8 + 1;
        row += 1;
    }
    index
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_found_by_its_code() {
        for row in FORMATS {
            assert_eq!(Format(row.code).info(CodeSpace::V4), Some(row));
        }
        for (code, name) in [
            (33, "N2"),
            (34, "N4"),
            (35, "V2"),
            (39, "T4"),
            (42, "C4"),
            (44, "X4"),
        ] {
            assert_eq!(Format(code).info(CodeSpace::V3).map(|i| i.name), Some(name));
        }
        assert_eq!(
            Format(54).info(CodeSpace::V3).map(|i| i.name),
            Some("TimeDifference without date")
        );
        assert_eq!(Format(0x71).info(CodeSpace::V3), None);
        assert_eq!(FORMATS.len(), 84);
    }

    #[test]
    fn both_spaces_name_the_same_types() {
        for row in FORMATS {
            let (v4, v3) = (Format(row.code), Format(row.code).in_space(CodeSpace::V3));
            assert_eq!(v4.in_space(CodeSpace::V4), v4);
            if let 0x71..=0x7C = row.code {
                assert_eq!(v3.info(CodeSpace::V3).map(|info| info.name), Some(row.name));
                assert_eq!(Format::of_code(v3.0, CodeSpace::V3), v4);
            } else {
                assert_eq!(v3, v4);
            }
        }
    }

    #[test]
    fn reserved_codes_are_unknown() {
        for code in (0x12..=0x14)
            .chain(0x3C..=0x3F)
            .chain(0x45..=0x64)
            .chain(0x7D..=0xFF)
        {
            assert_eq!(Format(code).info(CodeSpace::V4), None, "{code:#x}");
            assert_eq!(Format(code).data_len(CodeSpace::V4, 1, 240), None);
        }
    }

    #[test]
    fn the_short_cut_agrees_with_the_table() {
        assert_eq!(Format::RESERVED.data_len(CodeSpace::V4, 0, 0), Some(0));
        assert_eq!(Format::RESERVED.data_len(CodeSpace::V4, 1, 2), None, "no data");
        for code in 1..=255 {
            for count in [0, 1, 2, 7, 234] {
                let format = Format(code);
                let Some(info) = format.info(CodeSpace::V4) else {
                    continue;
                };
                let expected = match info.octets {
                    Octets::Fixed(n) => usize::from(n) * usize::from(count),
                    Octets::Counted => usize::from(count),
                    Octets::FourOrSix => 4 * usize::from(count),
                };
                assert_eq!(format.data_len(CodeSpace::V4, count, usize::MAX), Some(expected));
            }
        }
    }
}
