//! How the data of a telegram are divided.

use super::telegram::{EncodeError, MAX_DATA};

/// Length of the parameter part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PkwPart {
    /// No parameter part.
    None,
    /// Three words: PKE, IND and one word of value.
    Three,
    /// Four words, the usual.
    Four,
    /// Length given by the telegram, two words at least (the setting 127 of USS, text blocks of the FC protocol).
    Variable,
}

/// What the telegrams of a line look like; both sides have to agree.
/// Source: Siemens CU240S p. 179 (0, 3, 4 or 127 words of parameter part, 0 to 16 of process part), Danfoss FC design guides.
///
/// ```
/// use profidrive_uss::Layout;
/// let data = [0x15, 0xFA, 0, 1, 0, 0, 0, 0, 0x04, 0x7C, 0x20, 0x00];
/// for layout in [Layout::FC, Layout::USS] {
///     let parts = layout.split(&data).unwrap();
///     assert_eq!(parts.pkw, [0x15, 0xFA, 0, 1, 0, 0, 0, 0]);
///     assert_eq!(parts.pzd, [0x04, 0x7C, 0x20, 0x00]);
/// }
/// assert!(Layout::USS.split(&data[8..]).is_none());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Layout {
    /// Parameter part.
    pub pkw: PkwPart,
    /// Words of the process part, 0 to 16.
    pub pzd: u8,
    /// True where a telegram may leave the parameter part away.
    pub process_only: bool,
}

/// The two parts of the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts<'a> {
    /// Parameter part: PKE, IND and value or text; empty when left away.
    pub pkw: &'a [u8],
    /// Process part: control word and setpoints, or status word and actual values.
    pub pzd: &'a [u8],
}

impl Layout {
    /// Danfoss FC: process block of 4 octets, parameter block of 12, text block.
    pub const FC: Self = Self {
        pkw: PkwPart::Variable,
        pzd: 2,
        process_only: true,
    };
    /// The usual USS telegram: four words of parameter part, two of process part.
    pub const USS: Self = Self {
        pkw: PkwPart::Four,
        pzd: 2,
        process_only: false,
    };

    /// Returns true when data of this length can be divided.
    #[must_use]
    pub const fn accepts(&self, data: usize) -> bool {
        let Some(pkw) = data.checked_sub(2 * self.pzd as usize) else {
            return false;
        };
        if data > MAX_DATA {
            return false;
        }
        if pkw == 0 && self.process_only {
            return true;
        }
        match self.pkw {
            PkwPart::None => pkw == 0,
            PkwPart::Three => pkw == 6,
            PkwPart::Four => pkw == 8,
            PkwPart::Variable => pkw >= 4,
        }
    }

    /// Divides the data of a telegram; `None` when their length cannot be.
    #[must_use]
    pub fn split<'a>(&self, data: &'a [u8]) -> Option<Parts<'a>> {
        if !self.accepts(data.len()) {
            return None;
        }
        let at = data.len().checked_sub(2 * usize::from(self.pzd))?;
        let (pkw, pzd) = data.split_at_checked(at)?;
        Some(Parts { pkw, pzd })
    }

    /// Puts the two parts into `out` and gives their length.
    ///
    /// # Errors
    /// When they do not fit the layout or the buffer.
    ///
    /// ```
    /// use profidrive_uss::{Layout, Parts};
    /// let mut out = [0; 12];
    /// let parts = Parts { pkw: &[0xF6, 0x04, 0x04, 0], pzd: &[0; 4] };
    /// assert_eq!(Layout::FC.join(parts, &mut out), Ok(8));
    /// assert_eq!(Layout::FC.split(&out[..8]), Some(parts));
    /// ```
    pub fn join(&self, parts: Parts<'_>, out: &mut [u8]) -> Result<usize, EncodeError> {
        let needed = parts.pkw.len() + parts.pzd.len();
        if parts.pzd.len() != 2 * usize::from(self.pzd) || !self.accepts(needed) {
            return Err(EncodeError::Layout(needed));
        }
        let found = out.len();
        let room = out.get_mut(..needed).ok_or(EncodeError::Room { needed, found })?;
        for (place, octet) in room.iter_mut().zip(parts.pkw.iter().chain(parts.pzd)) {
            *place = *octet;
        }
        Ok(needed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_of_the_blocks() {
        let lengths = |layout: Layout| (0..=300).filter(move |&data| layout.accepts(data));
        assert!(lengths(Layout::USS).eq([12]));
        // process block, text without characters, then everything longer
        assert!(lengths(Layout::FC).eq([4].into_iter().chain(8..=252)));
        for pzd in 0..=16 {
            for (pkw, octets) in [(PkwPart::None, 0), (PkwPart::Three, 6), (PkwPart::Four, 8)] {
                let layout = Layout {
                    pkw,
                    pzd,
                    process_only: false,
                };
                assert!(lengths(layout).eq([octets + 2 * usize::from(pzd)]));
            }
        }
    }
}
