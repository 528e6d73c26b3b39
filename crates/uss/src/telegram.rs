//! The frame: STX, LGE, ADR, data, BCC.

use super::address::Address;

/// First octet of each telegram.
pub const STX: u8 = 0x02;
/// Largest length octet.
pub const MAX_LGE: u8 = 254;
/// Octets of the longest telegram.
pub const MAX_TELEGRAM: usize = MAX_LGE as usize + 2;
/// Octets of the longest data part.
pub const MAX_DATA: usize = MAX_LGE as usize - 2;
/// STX, LGE and ADR in front of the data.
const HEAD: usize = 3;

/// Returns the check octet: all octets before it, STX included, exclusive or.
///
/// ```
/// assert_eq!(profidrive_uss::bcc(&[0x02, 0x06, 0x81, 0x04, 0x7C, 0x20, 0x00]), 0xDD);
/// ```
#[must_use]
pub fn bcc(octets: &[u8]) -> u8 {
    octets.iter().fold(0, |check, octet| check ^ octet)
}

/// Octets that are not telegram.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// Shorter than the shortest telegram.
    #[error("a telegram has 4 octets at least, there are {0}")]
    Short(usize),
    /// The first octet is not STX.
    #[error("the octet at offset 0 is 0x{0:02X}, expected STX 0x02")]
    Stx(u8),
    /// LGE does not fit the number of octets.
    #[error("LGE at offset 1 says {expected} octets in all, there are {found}")]
    Length {
        /// Octets according to LGE.
        expected: usize,
        /// Octets that are there.
        found: usize,
    },
    /// LGE below 2 or above 254.
    #[error("LGE at offset 1 is {0}, 2 to {MAX_LGE} are possible")]
    Lge(u8),
    /// The check octet is wrong.
    #[error("BCC at offset {offset} is 0x{found:02X}, expected 0x{expected:02X}")]
    Bcc {
        /// Where it is.
        offset: usize,
        /// What the octets before give.
        expected: u8,
        /// What is there.
        found: u8,
    },
}

/// A telegram that cannot be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EncodeError {
    /// More data than LGE can count.
    #[error("{0} octets of data, a telegram holds {MAX_DATA}")]
    Data(usize),
    /// The data cannot be divided according to the layout.
    #[error("{0} octets of data do not fit the layout of the telegrams")]
    Layout(usize),
    /// The buffer is too small.
    #[error("the telegram needs {needed} octets, the buffer has {found}")]
    Room {
        /// Octets of the telegram.
        needed: usize,
        /// Octets of the buffer.
        found: usize,
    },
}

/// A telegram in either direction.
/// Source: Danfoss VLT 2800 design guide p. 108, Siemens CU240S p. 178.
///
/// ```
/// use profidrive_uss::{Address, Telegram};
/// let telegram = Telegram { address: Address(0x81), data: &[0x04, 0x7C, 0x20, 0x00] };
/// let mut out = [0; 16];
/// let length = telegram.encode(&mut out).unwrap();
/// assert_eq!(out[..length], [0x02, 0x06, 0x81, 0x04, 0x7C, 0x20, 0x00, 0xDD]);
/// assert_eq!(Telegram::decode(&out[..length]), Ok(telegram));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Telegram<'a> {
    /// Whom it is for, or who answers.
    pub address: Address,
    /// Parameter part and process part.
    pub data: &'a [u8],
}

impl<'a> Telegram<'a> {
    /// Takes a whole telegram apart.
    ///
    /// # Errors
    /// When length or check octet are wrong.
    pub fn decode(octets: &'a [u8]) -> Result<Self, DecodeError> {
        let &[stx, lge, address, .., found] = octets else {
            return Err(DecodeError::Short(octets.len()));
        };
        if stx != STX {
            return Err(DecodeError::Stx(stx));
        }
        let expected = total(lge).ok_or(DecodeError::Lge(lge))?;
        if expected != octets.len() {
            return Err(DecodeError::Length {
                expected,
                found: octets.len(),
            });
        }
        let offset = octets.len() - 1;
        let expected = bcc(octets.get(..offset).unwrap_or_default());
        if found != expected {
            return Err(DecodeError::Bcc {
                offset,
                expected,
                found,
            });
        }
        Ok(Self {
            address: Address(address),
            data: octets.get(HEAD..offset).unwrap_or_default(),
        })
    }

    /// Writes the telegram and gives its length.
    ///
    /// # Errors
    /// When the data or the buffer do not fit.
    pub fn encode(&self, out: &mut [u8]) -> Result<usize, EncodeError> {
        let lge = u8::try_from(self.data.len() + 2)
            .ok()
            .filter(|&lge| lge <= MAX_LGE)
            .ok_or(EncodeError::Data(self.data.len()))?;
        let needed = usize::from(lge) + 2;
        let room = EncodeError::Room {
            needed,
            found: out.len(),
        };
        let (check, octets) = out.get_mut(..needed).ok_or(room)?.split_last_mut().ok_or(room)?;
        let head = [STX, lge, self.address.0];
        for (place, octet) in octets.iter_mut().zip(head.iter().chain(self.data)) {
            *place = *octet;
        }
        *check = bcc(octets);
        Ok(needed)
    }
}

/// Octets of the whole telegram.
pub(crate) const fn total(lge: u8) -> Option<usize> {
    if lge >= 2 && lge <= MAX_LGE {
        Some(lge as usize + 2)
    } else {
        None
    }
}
