//! What the parameter manager needs of a drive.

use super::description::Description;
use super::error::ErrorNumber;
use super::format::Format;

/// Facts about one parameter that decide which requests for it are legal.
///
/// ```
/// use profidrive_profile::parameter::{Attributes, Format};
/// let word = Attributes { elements: 8, ..Attributes::simple(Format::UNSIGNED16, 2, true) };
/// assert_eq!((word.octets, word.first, word.is_array()), (2, 0, true));
/// let name = Attributes::string(20, false);
/// assert_eq!((name.octets, name.elements, name.is_string()), (1, 20, true));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Attributes {
    /// Type of the value as its V4 code. Answers carry it in the code space of the dialect, or the substitution code of
    /// its size where the dialect has only those.
    pub format: Format,
    /// Octets of one element; 1 for strings, whose elements are octets.
    pub octets: usize,
    /// Elements of an array, 0 for a simple parameter. Octets of a string; of all strings together in an array of them.
    pub elements: u16,
    /// Octets of one string in an array of strings, 0 for everything else.
    pub string: u16,
    /// Subindex of the first element, or of the value of a simple parameter. Other than 0 only where one number collects
    /// parameters that differ: a Vacon has its application ids as subindices of PNU 10001.
    pub first: u16,
    /// False for a parameter that can only be read.
    pub writable: bool,
}

impl Attributes {
    /// Creates a parameter of one value.
    #[must_use]
    pub const fn simple(format: Format, octets: usize, writable: bool) -> Self {
        Self {
            format,
            octets,
            elements: 0,
            string: 0,
            first: 0,
            writable,
        }
    }

    /// Characters, `octets` of them.
    #[must_use]
    pub const fn string(octets: u16, writable: bool) -> Self {
        Self {
            elements: octets,
            ..Self::simple(Format::VISIBLE_STRING, 1, writable)
        }
    }

    /// Creates an array of `count` strings of `octets` characters each.
    #[must_use]
    pub const fn strings(count: u16, octets: u16, writable: bool) -> Self {
        Self {
            elements: count.saturating_mul(octets),
            string: octets,
            ..Self::simple(Format::VISIBLE_STRING, 1, writable)
        }
    }

    /// Returns true for characters, or octets without a numeric meaning, of which the number of values counts octets.
    #[must_use]
    pub const fn is_string(&self) -> bool {
        matches!(self.format, Format::VISIBLE_STRING | Format::OCTET_STRING)
    }

    /// Octets of one string, of which an array has several; 0 for a number.
    #[must_use]
    pub const fn string_octets(&self) -> u16 {
        match (self.is_string(), self.string) {
            (false, _) => 0,
            (true, 0) => self.elements,
            (true, octets) => octets,
        }
    }

    /// Returns true for more than one element, octets of a string among them.
    #[must_use]
    pub const fn is_array(&self) -> bool {
        self.elements > 0
    }
}

/// How a change is meant to last. What a drive does beyond that is its vendor's: an AKD keeps what its command
/// DRV.NVSAVE saves, a Vacon keeps every change, a VLT only changes whose request demands it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Keep {
    /// An ordinary change: request ID 2, AK 2, 3, 7 and 8 of the PKW channel.
    #[default]
    Volatile,
    /// To be retained over a power cycle: Danfoss request ID 0x42, AK 11 to 14 of the PKW channel.
    Permanent,
}

/// Number of a save to non-volatile memory; a later save has a higher number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SaveId(pub u64);

/// What became of a save to non-volatile memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SaveState {
    /// The values are not stored yet; the change is acknowledged later.
    Pending,
    /// The values are stored.
    Stored,
    /// The values are not stored: the memory refused them.
    Failed,
}

/// What the parameter manager needs of a drive. Values pass as plain numbers of one, two, four or eight octets, sign
/// extension is the drive's business. A subindex is the one on the wire, counted from [`Attributes::first`]; that of a
/// string is the place of an octet, through all strings of an array one after the other.
pub trait ParameterAccess {
    /// Facts about the parameter, `None` if there is none at that number. The subindex only matters where one number
    /// collects many parameters ([`Attributes::first`]).
    fn attributes(&self, pnu: u16, subindex: u16) -> Option<Attributes>;

    /// Returns true for a parameter number that exists, also when no parameter is at its subindex 0.
    fn exists(&self, pnu: u16) -> bool {
        self.attributes(pnu, 0).is_some()
    }

    /// Value of one element, in the low octets. Only called for elements that exist.
    ///
    /// # Errors
    /// An error number of the profile when the value cannot be read now.
    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber>;

    /// Changes one element. Only called for elements that exist, with a value of the right size.
    ///
    /// # Errors
    /// An error number of the profile when the value is not accepted.
    fn write(&mut self, pnu: u16, subindex: u16, raw: u64, keep: Keep) -> Result<(), ErrorNumber>;

    /// Changes a whole string that begins at octet `first`; `text` is not longer than the string, blanks fill the rest.
    /// Without another word of the drive the octets are written one by one.
    ///
    /// # Errors
    /// An error number of the profile when an octet is not accepted; those before it are written.
    fn write_text(&mut self, pnu: u16, first: u16, text: &[u8], keep: Keep) -> Result<(), ErrorNumber> {
        let facts = self
            .attributes(pnu, first)
            .ok_or(ErrorNumber::UNKNOWN_PARAMETER)?;
        let octets = text.iter().chain(core::iter::repeat(&b' '));
        (first..first.saturating_add(facts.string_octets()))
            .zip(octets)
            .try_for_each(|(place, &octet)| self.write(pnu, place, octet.into(), keep))
    }

    /// Returns the newest save that changes have started since the last call. `None` when nothing has to be stored, or the
    /// drive does not wait for it. The answer to the change is withheld until [`save_state`](Self::save_state) is no longer
    /// pending.
    fn started_save(&mut self) -> Option<SaveId> {
        None
    }

    /// Returns the result of a save.
    fn save_state(&self, save: SaveId) -> SaveState {
        let _ = save;
        SaveState::Stored
    }

    /// False while another interface holds the right to change parameters (error 0x0B).
    fn may_change(&self, pnu: u16) -> bool {
        let _ = pnu;
        true
    }

    /// Description block of the parameter, `None` if it has none (error 0x09). Its identifier carries the V4 code of the
    /// type.
    fn description(&self, pnu: u16) -> Option<Description> {
        let _ = pnu;
        None
    }

    /// Text number `index` of the parameter, `None` if there is none (error 0x0F).
    fn text(&self, pnu: u16, index: u16) -> Option<[u8; 16]> {
        let _ = (pnu, index);
        None
    }
}
