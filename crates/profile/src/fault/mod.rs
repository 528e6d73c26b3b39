//! Fault buffer of an axis: what is wrong now and what was wrong before, PNU 944, 945, 947, 948, 949, 950 and 952.
//!
//! Source: profile 6.3.8 as documented in the AKD PROFINET manual ed. M 5.14, ABB RETA and Siemens V90 p. 109.
//!
//! All faults between one acknowledge and the next are one *situation*. Situation 0 is not acknowledged yet; each
//! acknowledge moves every situation one further, the oldest is lost.
//!
//! ```
//! use profidrive_profile::fault::{Fault, FaultBuffer};
//! let mut buffer = FaultBuffer::new();
//! buffer.raise(Fault { number: 501, ..Fault::default() });
//! buffer.raise(Fault { number: 602, ..Fault::default() });
//! assert_eq!(buffer.active().len(), 2);
//! assert!(buffer.acknowledge());
//! assert_eq!(buffer.element(0).map(|fault| fault.number), Some(0));
//! assert_eq!(buffer.element(9).map(|fault| fault.number), Some(602)); // situation 1, position 1
//! assert_eq!(buffer.counter(), 3); // PNU 944: every change
//! ```

mod buffer;
mod read;

pub use buffer::{Fault, FaultBuffer};
pub use read::{ConsistentRead, Next};

/// What the fault message counter (PNU 944) of a drive counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Counting {
    /// Every change of the buffer: each fault and each acknowledge. Source: profile 6.3.8 by way of OPTE9.
    #[default]
    Changes,
    /// Fault situations: the first fault after an acknowledge, and nothing else. Source: AKD PROFINET manual 5.14.
    Situations,
}

/// How a fault buffer is divided.
/// Source: PNU 950, present when it is not eight by eight; Vacon OPTCP manual p. 37. The order of its two elements is
/// from memory, no public text confirms it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Shape {
    /// Number of situations, PNU 950 index 0.
    pub situations: u8,
    /// Faults of one situation, PNU 950 index 1.
    pub faults: u8,
}

/// Where in a fault buffer something is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Place {
    /// Situation, 0 is the one that is not acknowledged.
    pub situation: u8,
    /// Position inside the situation, 0 is the fault that came first.
    pub position: u8,
}

impl Shape {
    /// Eight situations of eight faults: the profile, AKD.
    pub const EIGHT_BY_EIGHT: Self = Self {
        situations: 8,
        faults: 8,
    };
    /// Eight situations of one fault: Vacon 100.
    pub const EIGHT_SINGLE: Self = Self {
        situations: 8,
        faults: 1,
    };

    /// Returns the shape out of PNU 950; none when there are fewer than two values or one of them cannot be.
    #[must_use]
    pub fn from_scaling(values: &[u16]) -> Option<Self> {
        let [situations, faults, ..] = values else {
            return None;
        };
        let shape = Self {
            situations: u8::try_from(*situations).ok()?,
            faults: u8::try_from(*faults).ok()?,
        };
        (shape.elements() > 0).then_some(shape)
    }

    /// Returns the number of elements of PNU 945, 947, 948 and 949.
    #[must_use]
    pub const fn elements(self) -> u16 {
        self.situations as u16 * self.faults as u16
    }

    /// Returns the place of the element with this subindex; `None` past the end.
    ///
    /// ```
    /// use profidrive_profile::fault::{Place, Shape};
    /// assert_eq!(Shape::EIGHT_BY_EIGHT.place(17), Some(Place { situation: 2, position: 1 }));
    /// ```
    #[must_use]
    pub fn place(self, index: u16) -> Option<Place> {
        if index >= self.elements() {
            return None;
        }
        Some(Place {
            situation: u8::try_from(index / u16::from(self.faults)).ok()?,
            position: u8::try_from(index % u16::from(self.faults)).ok()?,
        })
    }

    /// Returns the subindex of a place; none when it is outside.
    #[must_use]
    pub fn index(self, place: Place) -> Option<u16> {
        (place.situation < self.situations && place.position < self.faults)
            .then(|| u16::from(self.faults) * u16::from(place.situation) + u16::from(place.position))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_indexes_are_each_others_inverse() {
        for shape in [
            Shape::EIGHT_BY_EIGHT,
            Shape::EIGHT_SINGLE,
            Shape {
                situations: 5,
                faults: 8,
            },
        ] {
            for index in 0..shape.elements() {
                assert_eq!(shape.index(shape.place(index).unwrap()), Some(index));
            }
            assert_eq!(shape.place(shape.elements()), None);
        }
        let out_of_range = Place {
            situation: 0,
            position: 8,
        };
        assert_eq!(Shape::EIGHT_BY_EIGHT.index(out_of_range), None);
    }

    #[test]
    fn shape_out_of_pnu_950() {
        assert_eq!(Shape::from_scaling(&[8, 8]), Some(Shape::EIGHT_BY_EIGHT));
        assert_eq!(Shape::from_scaling(&[8]), None);
        assert_eq!(Shape::from_scaling(&[8, 0]), None);
        assert_eq!(Shape::from_scaling(&[300, 1]), None);
    }
}
