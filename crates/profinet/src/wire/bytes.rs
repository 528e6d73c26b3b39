//! Checked reading and writing of octets: every wire format of this crate goes through these.

use alloc::vec::Vec;
use core::fmt;

use super::Trace;

/// Order of the octets of a number on the wire.
///
/// Big everywhere, except that the RPC header of a peer may choose little.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ByteOrder {
    /// Most significant octet first.
    #[default]
    Big,
    /// Least significant octet first.
    Little,
}

/// A decode error of octets from the network: field, offset, expected and found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{what} at octet {offset}: {problem}")]
pub struct DecodeError {
    /// The field or block being read.
    pub what: &'static str,
    /// Offset from the start of the outermost PDU passed to the decoder.
    pub offset: usize,
    /// What is wrong there.
    pub problem: Problem,
}

/// The kind of a [`DecodeError`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Problem {
    /// The data end too early.
    Truncated {
        /// Octets the field needs.
        needed: usize,
        /// Octets left.
        available: usize,
    },
    /// A field holds another value than the only one allowed here.
    Expected {
        /// The allowed value.
        expected: u64,
        /// The value found.
        found: u64,
    },
    /// A value that is not allowed.
    Invalid {
        /// The value found.
        found: u64,
    },
    /// More elements than this implementation accepts.
    TooMany {
        /// The limit.
        limit: usize,
    },
    /// Octets left over behind the end of the content.
    Trailing {
        /// How many.
        count: usize,
    },
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated { needed, available } => {
                write!(f, "needs {needed} octets, {available} are left")
            }
            Self::Expected { expected, found } => {
                write!(f, "expected {expected:#x}, found {found:#x}")
            }
            Self::Invalid { found } => write!(f, "value {found:#x} is not allowed"),
            Self::TooMany { limit } => write!(f, "more than {limit}"),
            Self::Trailing { count } => write!(f, "{count} octets left over"),
        }
    }
}

/// A cursor over received octets that never reads past the end.
///
/// The methods that every field of a frame goes through are always inlined: so a reader without a trace stays in registers.
///
/// ```
/// use profidrive_profinet::wire::Reader;
/// let mut reader = Reader::new(&[0x01, 0x02, 0x03]);
/// assert_eq!(reader.u16("BlockType"), Ok(0x0102));
/// let error = reader.u16("BlockLength").unwrap_err();
/// assert_eq!(error.to_string(), "BlockLength at octet 2: needs 2 octets, 1 are left");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Reader<'a> {
    data: &'a [u8],
    base: usize,
    position: usize,
    trace: Option<&'a Trace<'a>>,
}

impl<'a> Reader<'a> {
    /// Reads `data` from its start.
    #[must_use]
    pub const fn new(data: &'a [u8]) -> Self {
        Self {
            data,
            base: 0,
            position: 0,
            trace: None,
        }
    }

    /// Reads `data`, which starts at `base` of a larger PDU: offsets in errors count from there.
    #[must_use]
    pub const fn with_base(data: &'a [u8], base: usize) -> Self {
        Self {
            data,
            base,
            position: 0,
            trace: None,
        }
    }

    /// Reads on with a note of every field in `trace`.
    #[must_use]
    pub const fn traced(mut self, trace: &'a Trace<'a>) -> Self {
        self.trace = Some(trace);
        self
    }

    /// Offset of the next octet from the start of the outermost PDU.
    #[must_use]
    pub const fn offset(&self) -> usize {
        self.base + self.position
    }

    /// Offset of the next octet from the start of this reader's data.
    #[must_use]
    pub const fn position(&self) -> usize {
        self.position
    }

    /// Octets not read yet.
    #[must_use]
    pub const fn remaining(&self) -> usize {
        self.data.len() - self.position
    }

    /// Returns true when everything is read.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.remaining() == 0
    }

    /// Returns the octets not read yet, without reading them.
    #[must_use]
    #[inline]
    pub fn peek_rest(&self) -> &'a [u8] {
        self.data.get(self.position..).unwrap_or(&[])
    }

    /// Reads all octets that are left.
    pub fn rest(&mut self, what: &'static str) -> &'a [u8] {
        let rest = self.peek_rest();
        self.position = self.data.len();
        if let Some(trace) = self.trace {
            trace.read(what, rest);
        }
        rest
    }

    /// Reads `length` octets.
    ///
    /// # Errors
    /// When fewer are left; nothing is consumed then.
    #[inline(always)]
    pub fn bytes(&mut self, length: usize, what: &'static str) -> Result<&'a [u8], DecodeError> {
        let bytes = self.take(length, what)?;
        if let Some(trace) = self.trace {
            trace.read(what, bytes);
        }
        Ok(bytes)
    }

    #[inline(always)]
    fn take(&mut self, length: usize, what: &'static str) -> Result<&'a [u8], DecodeError> {
        let end = self.position.checked_add(length);
        match end.and_then(|end| self.data.get(self.position..end)) {
            Some(bytes) => {
                self.position += length;
                Ok(bytes)
            }
            None => {
                let available = self.remaining();
                let problem = Problem::Truncated {
                    needed: length,
                    available,
                };
                Err(self.error(what, 0, problem))
            }
        }
    }

    /// Reads `N` octets as an array.
    ///
    /// # Errors
    /// When fewer are left.
    #[inline(always)]
    pub fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], DecodeError> {
        let mut array = [0; N];
        array.copy_from_slice(self.bytes(N, what)?);
        Ok(array)
    }

    /// Skips `length` octets.
    ///
    /// # Errors
    /// When fewer are left.
    pub fn skip(&mut self, length: usize, what: &'static str) -> Result<(), DecodeError> {
        self.bytes(length, what).map(|_| ())
    }

    /// Reads the next `length` octets through a reader of their own, whose errors keep counting from the same start.
    ///
    /// # Errors
    /// When fewer are left.
    #[inline]
    pub fn sub(&mut self, length: usize, what: &'static str) -> Result<Reader<'a>, DecodeError> {
        let base = self.offset();
        Ok(Reader {
            trace: self.trace,
            ..Reader::with_base(self.take(length, what)?, base)
        })
    }

    /// Reads one octet.
    ///
    /// # Errors
    /// At the end of the data.
    #[inline(always)]
    pub fn u8(&mut self, what: &'static str) -> Result<u8, DecodeError> {
        let [value] = self.array(what)?;
        Ok(self.number(value))
    }

    /// Reads a 16-bit number, big-endian.
    ///
    /// # Errors
    /// At the end of the data.
    #[inline(always)]
    pub fn u16(&mut self, what: &'static str) -> Result<u16, DecodeError> {
        let value = u16::from_be_bytes(self.array(what)?);
        Ok(self.number(value))
    }

    /// Reads a 32-bit number, big-endian.
    ///
    /// # Errors
    /// At the end of the data.
    #[inline(always)]
    pub fn u32(&mut self, what: &'static str) -> Result<u32, DecodeError> {
        let value = u32::from_be_bytes(self.array(what)?);
        Ok(self.number(value))
    }

    /// Reads a 64-bit number, big-endian.
    ///
    /// # Errors
    /// At the end of the data.
    #[inline]
    pub fn u64(&mut self, what: &'static str) -> Result<u64, DecodeError> {
        let value = u64::from_be_bytes(self.array(what)?);
        Ok(self.number(value))
    }

    /// Reads a 16-bit number in the given order.
    ///
    /// # Errors
    /// At the end of the data.
    #[inline(always)]
    pub fn u16_in(&mut self, order: ByteOrder, what: &'static str) -> Result<u16, DecodeError> {
        let array = self.array(what)?;
        Ok(self.number(match order {
            ByteOrder::Big => u16::from_be_bytes(array),
            ByteOrder::Little => u16::from_le_bytes(array),
        }))
    }

    /// Reads a 32-bit number in the given order.
    ///
    /// # Errors
    /// At the end of the data.
    #[inline(always)]
    pub fn u32_in(&mut self, order: ByteOrder, what: &'static str) -> Result<u32, DecodeError> {
        let array = self.array(what)?;
        Ok(self.number(match order {
            ByteOrder::Big => u32::from_be_bytes(array),
            ByteOrder::Little => u32::from_le_bytes(array),
        }))
    }

    /// Returns an error about the field that starts `back` octets before the cursor.
    #[must_use]
    #[inline]
    pub fn error(&self, what: &'static str, back: usize, problem: Problem) -> DecodeError {
        let field = self.data.get(self.position.saturating_sub(back)..self.data.len());
        if let (Some(trace), Some(rest)) = (self.trace, field) {
            trace.failed(what, rest, back, problem);
        }
        DecodeError {
            what,
            offset: self.offset().saturating_sub(back),
            problem,
        }
    }

    /// Notes what was read since `start`, an earlier [`position`](Self::position), as one part of this name.
    #[inline]
    pub fn enclose(&self, what: &'static str, start: usize) {
        if let (Some(trace), Some(octets)) = (self.trace, self.data.get(start..self.position)) {
            trace.read(what, octets);
        }
    }

    /// Notes the number of the field that was read last.
    #[inline]
    pub(super) fn number<N: Copy + Into<u128>>(&self, value: N) -> N {
        if let Some(trace) = self.trace {
            trace.number(self.peek_rest(), value.into());
        }
        value
    }

    /// Refuses octets left over.
    ///
    /// # Errors
    /// When octets are left.
    pub fn finish(&self, what: &'static str) -> Result<(), DecodeError> {
        match self.remaining() {
            0 => Ok(()),
            count => Err(self.error(what, 0, Problem::Trailing { count })),
        }
    }
}

/// Where encoders write: a growing `Vec<u8>`, or a [`SliceWriter`] over a fixed buffer.
pub trait Writer {
    /// Appends octets.
    fn bytes(&mut self, bytes: &[u8]);

    /// Octets written so far (those that did not fit a fixed buffer included).
    fn position(&self) -> usize;

    /// Overwrites octets already written, for example a length known only afterwards.
    /// Does nothing outside what was written.
    fn patch(&mut self, at: usize, bytes: &[u8]);

    /// Appends one octet.
    fn u8(&mut self, value: u8) {
        self.bytes(&[value]);
    }

    /// Appends a 16-bit number, big-endian.
    fn u16(&mut self, value: u16) {
        self.bytes(&value.to_be_bytes());
    }

    /// Appends a 32-bit number, big-endian.
    fn u32(&mut self, value: u32) {
        self.bytes(&value.to_be_bytes());
    }

    /// Appends a 64-bit number, big-endian.
    fn u64(&mut self, value: u64) {
        self.bytes(&value.to_be_bytes());
    }

    /// Appends a 16-bit number in the given order.
    fn u16_in(&mut self, order: ByteOrder, value: u16) {
        match order {
            ByteOrder::Big => self.bytes(&value.to_be_bytes()),
            ByteOrder::Little => self.bytes(&value.to_le_bytes()),
        }
    }

    /// Appends a 32-bit number in the given order.
    fn u32_in(&mut self, order: ByteOrder, value: u32) {
        match order {
            ByteOrder::Big => self.bytes(&value.to_be_bytes()),
            ByteOrder::Little => self.bytes(&value.to_le_bytes()),
        }
    }

    /// Appends zero octets.
    fn zeros(&mut self, mut count: usize) {
        const ZEROS: [u8; 32] = [0; 32];
        while count > 0 {
            let step = count.min(ZEROS.len());
            self.bytes(&ZEROS[..step]);
            count -= step;
        }
    }

    /// Appends zero octets until the number of octets since `start` is a multiple of `multiple`.
    fn align(&mut self, start: usize, multiple: usize) {
        let used = self.position().saturating_sub(start);
        let over = used.checked_rem(multiple).unwrap_or(0);
        if over > 0 {
            self.zeros(multiple - over);
        }
    }
}

impl Writer for Vec<u8> {
    fn bytes(&mut self, bytes: &[u8]) {
        self.extend_from_slice(bytes);
    }

    fn position(&self) -> usize {
        self.len()
    }

    fn patch(&mut self, at: usize, bytes: &[u8]) {
        if let Some(place) = self.get_mut(at..at.saturating_add(bytes.len())) {
            place.copy_from_slice(bytes);
        }
    }
}

/// What was written did not fit the buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{needed} octets do not fit a buffer of {capacity}")]
pub struct BufferTooSmall {
    /// Octets that were written.
    pub needed: usize,
    /// Octets the buffer has.
    pub capacity: usize,
}

/// Writes into a fixed buffer; too much is counted, not written.
///
/// ```
/// use profidrive_profinet::wire::{SliceWriter, Writer};
/// let mut buffer = [0; 4];
/// let mut out = SliceWriter::new(&mut buffer);
/// out.u16(0x8892);
/// assert_eq!(out.finish(), Ok(2));
/// assert_eq!(buffer, [0x88, 0x92, 0, 0]);
/// ```
#[derive(Debug)]
pub struct SliceWriter<'a> {
    buffer: &'a mut [u8],
    position: usize,
}

impl<'a> SliceWriter<'a> {
    /// Writes from the start of `buffer`.
    #[must_use]
    pub const fn new(buffer: &'a mut [u8]) -> Self {
        Self { buffer, position: 0 }
    }

    /// Returns the number of octets written.
    ///
    /// # Errors
    /// When they did not all fit; the buffer then holds the first ones.
    pub fn finish(self) -> Result<usize, BufferTooSmall> {
        if self.position <= self.buffer.len() {
            Ok(self.position)
        } else {
            Err(BufferTooSmall {
                needed: self.position,
                capacity: self.buffer.len(),
            })
        }
    }
}

impl Writer for SliceWriter<'_> {
    fn bytes(&mut self, bytes: &[u8]) {
        let start = self.position.min(self.buffer.len());
        if let Some(free) = self.buffer.get_mut(start..) {
            for (place, byte) in free.iter_mut().zip(bytes) {
                *place = *byte;
            }
        }
        self.position = self.position.saturating_add(bytes.len());
    }

    fn position(&self) -> usize {
        self.position
    }

    fn patch(&mut self, at: usize, bytes: &[u8]) {
        if let Some(place) = self.buffer.get_mut(at..at.saturating_add(bytes.len())) {
            place.copy_from_slice(bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use proptest::prelude::*;

    #[test]
    fn errors_count_from_the_outermost_start() {
        let data = [1, 2, 3, 4, 5];
        let mut reader = Reader::new(&data);
        reader.skip(2, "head").unwrap();
        let mut sub = reader.sub(3, "body").unwrap();
        assert_eq!(sub.u16("a"), Ok(0x0304));
        let error = sub.u32("b").unwrap_err();
        assert_eq!(error.offset, 4);
        assert_eq!(
            error.problem,
            Problem::Truncated {
                needed: 4,
                available: 1
            }
        );
        assert!(reader.is_empty());
    }

    #[test]
    fn a_slice_writer_never_writes_past_its_end() {
        let mut buffer = [0xA5; 3];
        let mut out = SliceWriter::new(&mut buffer);
        out.u32(0x0102_0304);
        out.u8(9);
        assert_eq!(
            out.finish(),
            Err(BufferTooSmall {
                needed: 5,
                capacity: 3
            })
        );
        assert_eq!(buffer, [1, 2, 3]);
    }

    #[test]
    fn align_counts_from_its_start() {
        let mut out = vec![0xFF];
        out.u8(1);
        out.align(1, 4);
        assert_eq!(out, [0xFF, 1, 0, 0, 0]);
        out.align(1, 4);
        assert_eq!(out.len(), 5);
    }

    proptest! {
        #[test]
        fn numbers_survive_both_orders(a: u16, b: u32, little: bool) {
            let order = if little { ByteOrder::Little } else { ByteOrder::Big };
            let mut out = vec![];
            out.u16_in(order, a);
            out.u32_in(order, b);
            let mut reader = Reader::new(&out);
            prop_assert_eq!(reader.u16_in(order, "a"), Ok(a));
            prop_assert_eq!(reader.u32_in(order, "b"), Ok(b));
            prop_assert!(reader.finish("end").is_ok());
        }
    }
}
