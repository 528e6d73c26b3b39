//! The description of a parameter, attribute 0x20.

use core::ops::Range;

/// Octets of a whole description.
pub(super) const LENGTH: u8 = 46;

/// Where the twelve elements lie. Source: Danfoss MCA 101 p. 29 and 32, Vacon OPTEA p. 118.
const ELEMENTS: [Range<usize>; 12] = [
    0..2,
    2..4,
    4..8,
    8..10,
    10..14,
    14..30,
    30..34,
    34..38,
    38..40,
    40..42,
    42..44,
    44..46,
];

/// Identifier of a description: data type and flags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Identifier(pub u16);

impl Identifier {
    /// The parameter is an array.
    pub const ARRAY: u16 = 1 << 14;
    /// Only 0 may be written.
    pub const RESET_ONLY: u16 = 1 << 13;
    /// Differs from the factory setting.
    pub const CHANGED: u16 = 1 << 12;
    /// There are texts (attribute 0x30).
    pub const TEXT: u16 = 1 << 10;
    /// Read-only.
    pub const READ_ONLY: u16 = 1 << 9;
    /// Standardisation factor and variable attribute mean nothing.
    pub const NO_SCALE: u16 = 1 << 8;

    /// Returns true when all bits of `flag` are set.
    #[must_use]
    pub const fn has(self, flag: u16) -> bool {
        self.0 & flag == flag
    }

    /// Format code of the value, bits 0 to 7.
    #[must_use]
    pub const fn format(self) -> super::Format {
        super::Format(self.0.to_be_bytes()[1])
    }

    /// Returns the same with the format, given as its V4 code, in another code space.
    #[must_use]
    pub const fn in_space(self, space: super::CodeSpace) -> Self {
        let [flags, _] = self.0.to_be_bytes();
        Self(u16::from_be_bytes([flags, self.format().in_space(space).0]))
    }
}

/// Description of a parameter: type, unit, name and limits in 46 octets.
/// Source: Danfoss MCA 101 p. 29 and 32, Vacon OPTEA p. 118.
///
/// ```
/// use profidrive_profile::parameter::{Description, Identifier};
/// let description = Description { name: *b"Language        ", ..Description::default() };
/// let octets = description.encode();
/// assert_eq!(octets.len(), 46);
/// assert_eq!(Description::decode(&octets), Some(description));
/// assert_eq!(Description::element(6), Some(14..30));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Description {
    /// Data type and flags.
    pub identifier: Identifier,
    /// Elements of an array, length of a string, or 0.
    pub elements: u16,
    /// Standardisation factor; vendors differ in its direction, the variable attribute is safer.
    pub factor: f32,
    /// Physical size (4 time, 11 rotation, 17 temperature, 21 voltage, 22 current, 28 frequency ...).
    pub size_index: u8,
    /// Power of ten for -9 to 9, else a special unit (67 rpm, 70 min, 74 h, 77 d).
    pub conversion_index: i8,
    /// Name, padded with blanks.
    pub name: [u8; 16],
    /// Lower limit, right-aligned.
    pub minimum: [u8; 4],
    /// Upper limit, right-aligned.
    pub maximum: [u8; 4],
    /// Extension of the identifier, 0.
    pub extension: u16,
    /// PNU that holds the 100 % value for cyclic data, or 0.
    pub reference_pnu: u16,
    /// Bit 15: valid; low bits: number of the bit that is 100 % in cyclic data.
    pub normalisation: u16,
}

impl Default for Description {
    fn default() -> Self {
        Self {
            identifier: Identifier::default(),
            elements: 0,
            factor: 1.0,
            size_index: 0,
            conversion_index: 0,
            name: [b' '; 16],
            minimum: [0; 4],
            maximum: [0; 4],
            extension: 0,
            reference_pnu: 0,
            normalisation: 0,
        }
    }
}

impl Description {
    /// Returns the octets that subindex `number` of a description request means: 0 all, 1 to 12 one element.
    #[must_use]
    pub fn element(number: u16) -> Option<Range<usize>> {
        match number {
            0 => Some(0..usize::from(LENGTH)),
            _ => ELEMENTS.get(usize::from(number) - 1).cloned(),
        }
    }

    /// Returns the name without the blanks, `?` for octets that are not ASCII.
    pub fn name(&self) -> impl Iterator<Item = char> + '_ {
        let used = self
            .name
            .iter()
            .rposition(|&octet| octet != b' ' && octet != 0)
            .map_or(0, |last| last + 1);
        self.name.iter().take(used).map(|&octet| match octet {
            0x20..=0x7E => char::from(octet),
            _ => '?',
        })
    }

    /// Returns the lowest and highest number of a value with this many octets, ignoring leading octets. `None` when the
    /// drive reports no limits: both are 0.
    ///
    /// ```
    /// use profidrive_profile::parameter::Description;
    /// let bare = Description { minimum: [0, 0, 0xFF, 0x9C], maximum: [0, 0, 0, 100], ..Description::default() };
    /// assert_eq!(bare.limits(2, true), Some((-100, 100)));
    /// assert_eq!(Description::default().limits(2, true), None);
    /// ```
    #[must_use]
    pub fn limits(&self, octets: usize, signed: bool) -> Option<(i64, i64)> {
        if (self.minimum, self.maximum) == ([0; 4], [0; 4]) {
            return None;
        }
        let unused = 8 * 4_usize.saturating_sub(octets) as u32;
        let number = |limit: [u8; 4]| {
            let high = u32::from_be_bytes(limit).checked_shl(unused).unwrap_or(0);
            if signed {
                i64::from(high.cast_signed() >> unused.min(31))
            } else {
                i64::from(high.checked_shr(unused).unwrap_or(0))
            }
        };
        Some((number(self.minimum), number(self.maximum)))
    }

    /// Returns the 46 octets.
    #[must_use]
    pub fn encode(&self) -> [u8; 46] {
        let mut out = [0; 46];
        let parts: [&[u8]; 11] = [
            &self.identifier.0.to_be_bytes(),
            &self.elements.to_be_bytes(),
            &self.factor.to_be_bytes(),
            &[
                self.size_index,
                self.conversion_index.to_be_bytes()[0],
                0,
                0,
                0,
                0,
            ],
            &self.name,
            &self.minimum,
            &self.maximum,
            &[0, 0],
            &self.extension.to_be_bytes(),
            &self.reference_pnu.to_be_bytes(),
            &self.normalisation.to_be_bytes(),
        ];
        for (octet, value) in out.iter_mut().zip(parts.into_iter().flatten()) {
            *octet = *value;
        }
        out
    }

    /// From the 46 octets; `None` for another length.
    #[must_use]
    pub fn decode(octets: &[u8]) -> Option<Self> {
        let octets: &[u8; 46] = octets.try_into().ok()?;
        let word = |offset: usize| Some(u16::from_be_bytes(*octets.get(offset..)?.first_chunk()?));
        let quad = |offset: usize| octets.get(offset..)?.first_chunk::<4>().copied();
        Some(Self {
            identifier: Identifier(word(0)?),
            elements: word(2)?,
            factor: f32::from_be_bytes(quad(4)?),
            size_index: *octets.get(8)?,
            conversion_index: i8::from_be_bytes([*octets.get(9)?]),
            name: *octets.get(14..)?.first_chunk()?,
            minimum: quad(30)?,
            maximum: quad(34)?,
            extension: word(40)?,
            reference_pnu: word(42)?,
            normalisation: word(44)?,
        })
    }
}
