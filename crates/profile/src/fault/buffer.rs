//! The buffer in the drive.

use super::{Counting, Place, Shape};

/// Most elements a buffer can have.
const CAPACITY: usize = 64;

/// One entry of the buffer; all zeros is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Fault {
    /// Fault number of the vendor, PNU 947.
    pub number: u16,
    /// Fault code, PNU 945.
    pub code: u16,
    /// Fault value, what else is known about it, PNU 949.
    pub value: u32,
    /// Fault time in the drive's unit, mostly milliseconds, PNU 948.
    pub time: u32,
}

impl Fault {
    const NONE: Self = Self {
        number: 0,
        code: 0,
        value: 0,
        time: 0,
    };
}

/// Fault buffer of one axis, at most 64 elements.
/// Source: AKD manual 5.14; the counters as OPTE9 (944) and ABB RETA (952) describe them.
///
/// Element index of PNU 945, 947, 948 and 949 is faults per situation times situation plus position, both from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaultBuffer {
    shape: Shape,
    counting: Counting,
    elements: [Fault; CAPACITY],
    /// Faults in situation 0.
    active: usize,
    counter: u16,
    situations: u16,
}

impl Default for FaultBuffer {
    fn default() -> Self {
        Self::new()
    }
}

impl FaultBuffer {
    /// Creates an empty buffer of eight situations with eight faults.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            shape: Shape::EIGHT_BY_EIGHT,
            counting: Counting::Changes,
            elements: [Fault::NONE; CAPACITY],
            active: 0,
            counter: 0,
            situations: 0,
        }
    }

    /// Returns an empty buffer of another shape; none when it has no element or more than 64.
    #[must_use]
    pub fn with_shape(shape: Shape) -> Option<Self> {
        let possible = (1..=CAPACITY).contains(&usize::from(shape.elements()));
        possible.then(|| Self { shape, ..Self::new() })
    }

    /// Returns the same buffer with another rule of the fault message counter.
    #[must_use]
    pub const fn with_counting(mut self, counting: Counting) -> Self {
        self.counting = counting;
        self
    }

    /// Returns its division into situations and faults, PNU 950.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// Adds a fault. It takes the next place of situation 0; when there is none left it is dropped and the answer is
    /// false (that is our reading, the sources are silent).
    pub fn raise(&mut self, fault: Fault) -> bool {
        if self.active >= usize::from(self.shape.faults) {
            return false;
        }
        let Some(place) = self.elements.get_mut(self.active) else {
            return false;
        };
        *place = fault;
        let new_situation = self.active == 0;
        self.situations = self.situations.saturating_add(new_situation.into());
        self.active += 1;
        self.count(new_situation);
        true
    }

    /// Acknowledges the faults: every situation moves one further, situation 0 is empty. Without a fault nothing
    /// changes and the answer is false.
    pub fn acknowledge(&mut self) -> bool {
        if self.active == 0 {
            return false;
        }
        let one = usize::from(self.shape.faults);
        let used = usize::from(self.shape.elements());
        if let Some(elements) = self.elements.get_mut(..used) {
            elements.rotate_right(one);
            elements
                .iter_mut()
                .take(one)
                .for_each(|fault| *fault = Fault::NONE);
        }
        self.active = 0;
        self.count(false);
        true
    }

    /// Counts a change of the buffer.
    fn count(&mut self, new_situation: bool) {
        if new_situation || self.counting == Counting::Changes {
            self.counter = self.counter.wrapping_add(1);
        }
    }

    /// Writing 0 to PNU 952: removes all acknowledged situations and counts situations from 0 again. Faults that are
    /// not acknowledged stay, so that ZSW1 bit 3 never is without its reason (that is our reading).
    pub fn clear(&mut self) {
        let before = self.elements;
        let one = usize::from(self.shape.faults);
        for fault in self.elements.iter_mut().skip(one) {
            *fault = Fault::NONE;
        }
        if self.elements != before || self.situations != 0 {
            self.count(false);
        }
        self.situations = 0;
    }

    /// Fault message counter, PNU 944: one more with every change of the buffer, or with every situation
    /// ([`Counting`]); 0 follows 65535.
    #[must_use]
    pub const fn counter(&self) -> u16 {
        self.counter
    }

    /// Fault situation counter, PNU 952: situations since the last [`clear`](Self::clear), at most 65535.
    #[must_use]
    pub const fn situations(&self) -> u16 {
        self.situations
    }

    /// Returns the element with this subindex; none past the end.
    #[must_use]
    pub fn element(&self, index: u16) -> Option<&Fault> {
        self.shape.place(index)?;
        self.elements.get(usize::from(index))
    }

    /// Returns the faults that are not acknowledged, first one first.
    #[must_use]
    pub fn active(&self) -> &[Fault] {
        self.elements.get(..self.active).unwrap_or_default()
    }

    /// Returns true when a fault with this number is not acknowledged.
    #[must_use]
    pub fn is_active(&self, number: u16) -> bool {
        self.active().iter().any(|fault| fault.number == number)
    }

    /// Returns all faults with their places, newest situation first.
    pub fn iter(&self) -> impl Iterator<Item = (Place, &Fault)> {
        (0..self.shape.elements())
            .filter_map(|index| Some((self.shape.place(index)?, self.element(index)?)))
            .filter(|(_, fault)| **fault != Fault::NONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    fn fault(number: u16) -> Fault {
        Fault {
            number,
            ..Fault::default()
        }
    }

    fn numbers(buffer: &FaultBuffer) -> Vec<u16> {
        (0..buffer.shape().elements())
            .map(|index| buffer.element(index).unwrap().number)
            .collect()
    }

    #[test]
    fn a_ninth_fault_is_dropped() {
        let mut buffer = FaultBuffer::new();
        for number in 1..=8 {
            assert!(buffer.raise(fault(number)));
        }
        assert!(!buffer.raise(fault(9)));
        assert_eq!((buffer.counter(), buffer.situations()), (8, 1));
        assert_eq!(numbers(&buffer)[..9], [1, 2, 3, 4, 5, 6, 7, 8, 0]);
        assert!(buffer.is_active(8) && !buffer.is_active(9));
    }

    #[test]
    fn the_ninth_situation_pushes_the_first_out() {
        let mut buffer = FaultBuffer::new();
        for number in 1..=9 {
            buffer.raise(fault(number));
            buffer.raise(fault(100 + number));
            assert!(buffer.acknowledge());
        }
        assert!(!buffer.acknowledge()); // nothing there
        assert_eq!((buffer.counter(), buffer.situations()), (27, 9));
        let all = numbers(&buffer);
        assert_eq!(all[..10], [0, 0, 0, 0, 0, 0, 0, 0, 9, 109]);
        assert_eq!(all[56..], [3, 103, 0, 0, 0, 0, 0, 0]);
        let places: Vec<_> = buffer
            .iter()
            .map(|(place, fault)| (place.situation, fault.number))
            .collect();
        assert_eq!(places[..3], [(1, 9), (1, 109), (2, 8)]);
        assert_eq!(places.len(), 14);
    }

    #[test]
    fn situations_can_be_counted_in_the_place_of_changes() {
        let mut buffer = FaultBuffer::new().with_counting(Counting::Situations);
        for situation in 1..=3 {
            for number in 1..=3 {
                buffer.raise(fault(number));
                assert_eq!(buffer.counter(), situation);
            }
            buffer.acknowledge();
            assert_eq!(buffer.counter(), situation);
        }
        buffer.clear();
        assert_eq!((buffer.counter(), buffer.situations()), (3, 0));
    }

    #[test]
    fn the_counter_wraps() {
        let mut buffer = FaultBuffer::new();
        buffer.counter = u16::MAX;
        buffer.raise(fault(1));
        assert_eq!(buffer.counter(), 0);
    }

    #[test]
    fn clear_keeps_what_is_not_acknowledged() {
        let mut buffer = FaultBuffer::new();
        buffer.clear();
        assert_eq!(buffer.counter(), 0); // nothing changed
        buffer.raise(fault(1));
        buffer.acknowledge();
        buffer.raise(fault(2));
        buffer.clear();
        assert_eq!((buffer.counter(), buffer.situations()), (4, 0));
        assert_eq!(buffer.active(), [fault(2)]);
        assert_eq!(buffer.iter().count(), 1);
        buffer.acknowledge();
        buffer.clear();
        assert_eq!(
            buffer,
            FaultBuffer {
                counter: 6,
                ..FaultBuffer::new()
            }
        );
    }

    #[test]
    fn other_shapes() {
        let mut buffer = FaultBuffer::with_shape(Shape::EIGHT_SINGLE).unwrap();
        buffer.raise(fault(1));
        assert!(!buffer.raise(fault(2)));
        buffer.acknowledge();
        buffer.raise(fault(3));
        assert_eq!(numbers(&buffer), [3, 1, 0, 0, 0, 0, 0, 0]);
        assert_eq!(buffer.element(8), None);
        let big = Shape {
            situations: 9,
            faults: 8,
        };
        assert_eq!(FaultBuffer::with_shape(big), None);
    }

    proptest! {
        /// Against a list of lists.
        #[test]
        fn behaves_like_a_list_of_situations(steps in prop::collection::vec(0_u16..12, 0..200)) {
            let mut buffer = FaultBuffer::new();
            let mut model: Vec<Vec<u16>> = alloc::vec![Vec::new()];
            let mut changes = 0_u16;
            for (time, step) in steps.into_iter().enumerate() {
                if step == 0 {
                    if !model[0].is_empty() {
                        model.insert(0, Vec::new());
                        model.truncate(8);
                        changes += 1;
                    }
                    buffer.acknowledge();
                } else {
                    if model[0].len() < 8 {
                        model[0].push(step);
                        changes += 1;
                    }
                    buffer.raise(Fault { number: step, code: step, value: 7, time: time as u32 });
                }
                prop_assert_eq!(buffer.counter(), changes);
                prop_assert_eq!(buffer.active().len(), model[0].len());
            }
            for index in 0..64_u16 {
                let (situation, position) = (usize::from(index / 8), usize::from(index % 8));
                let expected = model.get(situation).and_then(|s| s.get(position)).copied().unwrap_or(0);
                prop_assert_eq!(buffer.element(index).unwrap().number, expected);
            }
        }
    }
}
