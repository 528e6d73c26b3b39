//! Value blocks: format, number of values, values, pad octet.

use super::address::{DecodeError, Wrong};
use super::format::{CodeSpace, Format, Kind, Octets};

/// One value in its format.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value<'a> {
    /// Two's complement types.
    Signed(i64),
    /// Unsigned numbers, bits, and the types Byte, Word and Double word whose sign is only given by a table.
    Unsigned(u64),
    /// IEEE 754.
    Float(f64),
    /// Characters as sent.
    Text(&'a [u8]),
    /// Anything else.
    Octets(&'a [u8]),
}

/// A view over one value block.
///
/// ```
/// use profidrive_profile::parameter::{CodeSpace, Format, Value, ValueBlock};
/// let bytes = [0x08, 1, 0x41, 0x42, 0x66, 0x66];
/// let (block, used) = ValueBlock::parse(&bytes, 0, CodeSpace::V4).unwrap();
/// assert_eq!((block.format, block.count, used), (Format::FLOAT32, 1, 6));
/// let Some(Value::Float(value)) = block.value(0, CodeSpace::V4) else { panic!() };
/// assert!((value - 12.15).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ValueBlock<'a> {
    /// Format of each value.
    pub format: Format,
    /// Number of values; of octets for strings.
    pub count: u8,
    /// The values without the pad octet.
    pub data: &'a [u8],
}

impl<'a> ValueBlock<'a> {
    /// Takes the block at `offset` of `bytes`; gives it and the octets it occupies, the pad octet included. A missing
    /// pad octet at the very end is accepted.
    ///
    /// # Errors
    /// When the format is unknown or the values run past the end.
    #[inline]
    pub fn parse(bytes: &'a [u8], offset: usize, space: CodeSpace) -> Result<(Self, usize), DecodeError> {
        let rest = bytes.get(offset..).unwrap_or(&[]);
        let &[format, count, ref data @ ..] = rest else {
            return Err(DecodeError {
                wrong: Wrong::Values,
                offset,
                expected: 2,
                found: rest.len(),
            });
        };
        let format = Format(format);
        let Some(length) = format.data_len(space, count, data.len()) else {
            return Err(DecodeError {
                wrong: Wrong::Format,
                offset,
                expected: 0,
                found: usize::from(format.0),
            });
        };
        let Some(values) = data.get(..length) else {
            return Err(DecodeError {
                wrong: Wrong::Values,
                offset: offset + 2,
                expected: length,
                found: data.len(),
            });
        };
        let padded = (length + (length & 1)).min(data.len());
        Ok((
            Self {
                format,
                count,
                data: values,
            },
            2 + padded,
        ))
    }

    /// Octets of one value; 1 for counted types.
    #[must_use]
    pub fn width(&self) -> usize {
        self.data.len().checked_div(usize::from(self.count)).unwrap_or(0)
    }

    /// Returns the octets of value `index`.
    #[must_use]
    pub fn octets(&self, index: usize) -> Option<&'a [u8]> {
        let width = self.width();
        if width == 0 {
            return None;
        }
        self.data.get(index * width..(index + 1) * width)
    }

    /// Value `index` as an unsigned number, up to eight octets.
    #[must_use]
    pub fn raw(&self, index: usize) -> Option<u64> {
        let octets = self.octets(index)?;
        (octets.len() <= 8).then(|| {
            octets
                .iter()
                .fold(0, |value, &octet| value << 8 | u64::from(octet))
        })
    }

    /// Value `index` in two's complement of its own width, up to eight octets.
    #[must_use]
    pub fn signed(&self, index: usize) -> Option<i64> {
        let unused = 64
            - 8 * u32::try_from(self.width())
                .ok()
                .filter(|width| (1..=8).contains(width))?;
        Some((self.raw(index)? << unused).cast_signed() >> unused)
    }

    /// Value `index` in its format. A string is one value (index 0).
    #[must_use]
    pub fn value(&self, index: usize, space: CodeSpace) -> Option<Value<'a>> {
        let info = self.format.info(space)?;
        if info.octets == Octets::Counted {
            return (index == 0).then_some(match info.kind {
                Kind::Text => Value::Text(self.data),
                _ => Value::Octets(self.data),
            });
        }
        Some(match info.kind {
            Kind::None => return None,
            Kind::Signed => Value::Signed(self.signed(index)?),
            Kind::Unsigned => Value::Unsigned(self.raw(index)?),
            Kind::Text => Value::Text(self.octets(index)?),
            Kind::Octets => Value::Octets(self.octets(index)?),
            Kind::Float => match *self.octets(index)? {
                [a, b, c, d] => Value::Float(f64::from(f32::from_be_bytes([a, b, c, d]))),
                [a, b, c, d, e, f, g, h] => Value::Float(f64::from_be_bytes([a, b, c, d, e, f, g, h])),
                _ => return None,
            },
        })
    }
}

/// Writes value blocks behind one another.
#[derive(Debug)]
pub(super) struct BlockWriter<'a> {
    out: &'a mut [u8],
    position: usize,
}

impl<'a> BlockWriter<'a> {
    pub(super) fn new(out: &'a mut [u8]) -> Self {
        Self { out, position: 0 }
    }

    pub(super) fn position(&self) -> usize {
        self.position
    }

    /// Returns the octets written so far.
    pub(super) fn written(&mut self) -> &mut [u8] {
        self.out.get_mut(..self.position).unwrap_or_default()
    }

    /// Octets that are still free.
    pub(super) fn free(&self) -> usize {
        self.out.len() - self.position
    }

    /// Takes everything from `position` on back.
    pub(super) fn truncate(&mut self, position: usize) {
        self.position = self.position.min(position);
    }

    /// Room for `length` octets, zeroed; `None` when there is none.
    pub(super) fn reserve(&mut self, length: usize) -> Option<&mut [u8]> {
        let end = self.position.checked_add(length)?;
        let room = self.out.get_mut(self.position..end)?;
        room.fill(0);
        self.position = end;
        Some(room)
    }

    pub(super) fn put(&mut self, octets: &[u8]) -> Option<()> {
        self.reserve(octets.len())?.copy_from_slice(octets);
        Some(())
    }
}
