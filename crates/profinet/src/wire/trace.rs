//! Where the fields of a frame are: notes of the readers that decode it.

use alloc::vec::Vec;
use core::cell::RefCell;
use core::ops::Range;

use super::Problem;

/// Most fields noted of one frame: the rest is decoded without a note.
pub const MAX_FIELDS: usize = 8192;

/// One field: its name in the standard, its octets, and what is wrong with it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// The name under which it was read. Fields inside of it stand before or behind it in the list.
    pub what: &'static str,
    /// Its octets, from the start of the frame.
    pub octets: Range<usize>,
    /// Its value, where it was read as a number: in the order of octets that its PDU has.
    pub number: Option<u128>,
    /// Why it could not be decoded.
    pub problem: Option<Problem>,
}

/// Notes of the fields of one frame, in the order in which they were read.
///
/// Every [`Reader`](super::Reader) over octets of the frame writes into it, whatever its offsets count from: the same
/// decoder that gives the content gives the places.
///
/// ```
/// use profidrive_profinet::wire::{Reader, Trace};
/// let frame = [0xFF, 0x01, 0x12, 0x00, 0x02];
/// let trace = Trace::new(&frame);
/// let mut reader = Reader::new(&frame[1..]).traced(&trace);
/// assert_eq!(reader.u16("BlockType"), Ok(0x0112));
/// let field = &trace.fields()[0];
/// assert_eq!((field.what, field.octets.clone(), field.number), ("BlockType", 1..3, Some(0x0112)));
/// ```
#[derive(Debug)]
pub struct Trace<'a> {
    /// A part is found in it by its address.
    frame: &'a [u8],
    fields: RefCell<Vec<Field>>,
}

impl<'a> Trace<'a> {
    /// Takes notes of the fields of this frame. Octets outside of it, as of a body put together from several frames, are
    /// not noted.
    #[must_use]
    pub fn new(frame: &'a [u8]) -> Self {
        Self {
            frame,
            fields: RefCell::default(),
        }
    }

    /// Returns the place of octets of the frame.
    #[must_use]
    pub fn place(&self, octets: &[u8]) -> Option<Range<usize>> {
        let start = octets.as_ptr().addr().checked_sub(self.start())?;
        let end = start.checked_add(octets.len())?;
        (end <= self.frame.len()).then_some(start..end)
    }

    /// Ends the notes and returns them.
    #[must_use]
    pub fn fields(self) -> Vec<Field> {
        self.fields.into_inner()
    }

    fn start(&self) -> usize {
        self.frame.as_ptr().addr()
    }

    #[cold]
    #[inline(never)]
    pub(super) fn read(&self, what: &'static str, octets: &[u8]) {
        self.note(what, octets, None);
    }

    /// The field that ends where `rest` begins is this number.
    #[cold]
    #[inline(never)]
    pub(super) fn number(&self, rest: &[u8], value: u128) {
        let end = rest.as_ptr().addr();
        let mut fields = self.fields.borrow_mut();
        if let Some(field) = fields
            .last_mut()
            .filter(|field| self.start() + field.octets.end == end)
        {
            field.number = Some(value);
        }
    }

    /// `rest` begins with the field; it has `length` octets, or is cut off where that is 0.
    #[cold]
    #[inline(never)]
    pub(super) fn failed(&self, what: &'static str, rest: &[u8], length: usize, problem: Problem) {
        let field = rest.get(..length).filter(|field| !field.is_empty());
        self.note(what, field.unwrap_or(rest), Some(problem));
    }

    fn note(&self, what: &'static str, octets: &[u8], problem: Option<Problem>) {
        let mut fields = self.fields.borrow_mut();
        if let Some(place) = self.place(octets)
            && (!place.is_empty() || problem.is_some())
            && fields.len() < MAX_FIELDS
        {
            fields.push(Field {
                what,
                octets: place,
                number: None,
                problem,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Reader;

    #[test]
    fn fields_of_a_frame_are_bounded() {
        let frame = [0; 2 * MAX_FIELDS];
        let trace = Trace::new(&frame);
        let mut reader = Reader::new(&frame).traced(&trace);
        while reader.u8("octet").is_ok() {}
        assert_eq!(trace.fields().len(), MAX_FIELDS);
    }

    #[test]
    fn a_copy_is_not_noted_and_what_is_wrong_has_its_place() {
        let frame = [1, 2, 3, 4, 5];
        let trace = Trace::new(&frame);
        let copy = frame;
        assert_eq!(Reader::new(&copy).traced(&trace).u16("copy"), Ok(0x0102));
        // offsets of errors count from the PDU, places from the frame
        let mut reader = Reader::new(&frame[1..]).traced(&trace);
        let mut part = reader.sub(3, "part").unwrap();
        assert_eq!(part.u16("first"), Ok(0x0203));
        assert!(part.u16("second").is_err());
        let fields = trace.fields();
        let places: Vec<_> = fields
            .iter()
            .map(|field| (field.what, field.octets.clone(), field.problem.is_some()))
            .collect();
        assert_eq!(places, [("first", 1..3, false), ("second", 3..4, true)]);
    }
}
