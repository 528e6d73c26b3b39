//! A free telegram while it is being changed, word by word.

use super::mapping::MOST_WORDS;
use super::{Direction, Mapping, MappingError, Signal};

/// The words of PNU 915 or 916 of a free telegram. Whatever is written, what stands here is a mapping: each word alone
/// is accepted or refused. Source: AKD manual 5.8, 5.11.1 and 5.11.10. How a drive takes a signal of two words that is
/// written word by word no source states; here its number written into one word fills the next one too, and to write it
/// there again changes nothing. So both ways to write an array work: all at once, and one subindex after the other.
///
/// ```
/// use profidrive_profile::telegram::{Direction, FreeMapping, KOLLMORGEN};
/// let mut words = FreeMapping::new(&[1, 5], 6, KOLLMORGEN, Direction::Setpoint).unwrap();
/// words.set(2, 34).unwrap(); // MDI_TARPOS has two words
/// words.set(3, 34).unwrap();
/// assert_eq!(words.words(), [1, 5, 34, 34, 0, 0]);
/// assert!(words.set(3, 36).is_err()); // would cut it
/// words.set(2, 36).unwrap();
/// assert_eq!(words.words(), [1, 5, 36, 0, 0, 0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeMapping {
    words: [u16; MOST_WORDS],
    length: usize,
    vendor: u16,
    direction: Direction,
}

impl FreeMapping {
    /// Starts with these words in a telegram of `length` words; fewer words are filled up with 0, and of more words
    /// only whole signals are taken over.
    ///
    /// # Errors
    /// The words are not mapping.
    pub fn new(
        words: &[u16],
        length: usize,
        vendor: u16,
        direction: Direction,
    ) -> Result<Self, MappingError> {
        let mapping = Mapping::new(words, vendor, direction)?;
        if length > MOST_WORDS {
            return Err(MappingError::Long { words: length });
        }
        let mut free = Self {
            words: [0; MOST_WORDS],
            length,
            vendor,
            direction,
        };
        for field in mapping.fields() {
            let first = usize::from(field.offset / 2);
            let place = first..first + usize::from(field.signal.octets() / 2);
            if place.end <= length {
                free.fill(place, field.signal.number);
            }
        }
        Ok(free)
    }

    /// Returns the words, as PNU 915 or 916 shows them.
    #[must_use]
    pub fn words(&self) -> &[u16] {
        self.words.get(..self.length).unwrap_or_default()
    }

    /// Writes one word. A signal of several words takes all of them; what stood there is taken out as a whole.
    ///
    /// # Errors
    /// What is wrong; nothing is changed then. What does not fit before the end is refused as a signal that is cut.
    pub fn set(&mut self, word: usize, number: u16) -> Result<(), MappingError> {
        let end = word.saturating_add(self.size(number));
        let cut = MappingError::Cut {
            word,
            signal: Signal::find(number, self.vendor).map_or("", |signal| signal.name),
            words: u16::try_from(self.size(number)).unwrap_or(u16::MAX),
        };
        if end > self.length {
            return Err(cut);
        }
        if self.head(word) < word {
            // A further word of a signal: only that signal itself may be written there.
            let same = number != 0 && self.words.get(word) == Some(&number);
            return if same { Ok(()) } else { Err(cut) };
        }
        let mut changed = *self;
        for place in word..end {
            let head = changed.head(place);
            let size = changed.size(changed.words.get(head).copied().unwrap_or(0));
            changed.fill(head..(head + size).min(self.length), 0);
        }
        changed.fill(word..end, number);
        Mapping::new(changed.words(), self.vendor, self.direction)?;
        *self = changed;
        Ok(())
    }

    /// Returns the places of the signals.
    ///
    /// # Errors
    /// Never for what [`new`](Self::new) and [`set`](Self::set) have accepted.
    pub fn mapping(&self) -> Result<Mapping, MappingError> {
        Mapping::new(self.words(), self.vendor, self.direction)
    }

    fn fill(&mut self, place: core::ops::Range<usize>, number: u16) {
        if let Some(words) = self.words.get_mut(place) {
            words.fill(number);
        }
    }

    /// First word of the signal that has this word.
    fn head(&self, word: usize) -> usize {
        let mut at = 0;
        while let Some(number) = self.words().get(at) {
            let next = at + self.size(*number);
            if next > word {
                return at;
            }
            at = next;
        }
        word
    }

    /// Words that a signal needs, 1 where there is no such signal.
    fn size(&self, number: u16) -> usize {
        Signal::find(number, self.vendor).map_or(1, |signal| usize::from(signal.octets() / 2))
    }
}

#[cfg(test)]
mod tests {
    use super::super::KOLLMORGEN;
    use super::*;
    use alloc::{vec, vec::Vec};
    use proptest::prelude::*;

    fn setpoints(words: &[u16], length: usize) -> FreeMapping {
        FreeMapping::new(words, length, KOLLMORGEN, Direction::Setpoint).unwrap()
    }

    #[test]
    fn what_is_too_long_is_left_out_as_a_whole() {
        assert_eq!(setpoints(&[1, 34, 34, 35, 35], 4).words(), [1, 34, 34, 0]);
        assert_eq!(setpoints(&[1, 5], 3).words(), [1, 5, 0]);
        let longer = FreeMapping::new(&[1], 33, KOLLMORGEN, Direction::Setpoint);
        assert_eq!(longer, Err(MappingError::Long { words: 33 }));
    }

    #[test]
    fn what_is_refused_changes_nothing() {
        let before = setpoints(&[1, 34, 34, 5], 5);
        let mut words = before;
        let cut = |word, signal, words| MappingError::Cut { word, signal, words };
        let direction = |signal| MappingError::Direction { word: 3, signal };
        for (word, number, error) in [
            (0, 5, MappingError::First { signal: 5 }),
            (0, 0, MappingError::First { signal: 0 }),
            (2, 5, cut(2, "NSOLL_A", 1)),
            (2, 0, cut(2, "", 1)),
            (2, 35, cut(2, "MDI_VELOCITY", 2)),
            (4, 35, cut(4, "MDI_VELOCITY", 2)), // no room for its second word
            (5, 5, cut(5, "NSOLL_A", 1)),
            (usize::MAX, 5, cut(usize::MAX, "NSOLL_A", 1)),
            (3, 6, direction("NIST_A")),
            (3, 28, direction("XIST_A")),
            (
                3,
                1,
                MappingError::OnlyFirst {
                    word: 3,
                    signal: "STW1",
                },
            ),
            (3, 999, MappingError::Unknown { word: 3, signal: 999 }),
        ] {
            assert_eq!(words.set(word, number), Err(error), "{word} {number}");
            assert_eq!(words, before);
        }
        let mut actual = FreeMapping::new(&[2, 6], 2, KOLLMORGEN, Direction::Actual).unwrap();
        assert!(actual.set(0, 1).is_err() && actual.set(1, 5).is_err());
        assert!(actual.set(0, 2).is_ok() && actual.set(1, 52).is_ok());
    }

    #[test]
    fn a_signal_that_is_overwritten_goes_as_a_whole() {
        let mut words = setpoints(&[1, 34, 34, 35, 35], 6);
        words.set(1, 5).unwrap();
        assert_eq!(words.words(), [1, 5, 0, 35, 35, 0]);
        words.set(2, 100).unwrap();
        assert_eq!(words.words(), [1, 5, 100, 100, 0, 0]);
        words.set(2, 0).unwrap();
        assert_eq!(words.words(), [1, 5, 0, 0, 0, 0]);
        assert_eq!(words.mapping().unwrap().octets(), 12);
    }

    proptest! {
        /// From any mapping to any other by writing the words in order, one by one.
        #[test]
        fn word_by_word_leads_from_each_mapping_to_each_other(
            from in prop::collection::vec(prop::sample::select(vec![0_u16, 5, 32, 34, 35, 36, 100, 103]), 0..11),
            to in prop::collection::vec(prop::sample::select(vec![0_u16, 5, 32, 34, 35, 36, 100, 103]), 0..11),
        ) {
            let spread = |signals: Vec<u16>| {
                let mut words: Vec<u16> = vec![1];
                for signal in signals {
                    words.extend(core::iter::repeat_n(signal, if [34, 35, 100].contains(&signal) { 2 } else { 1 }));
                }
                words
            };
            let (from, to) = (spread(from), spread(to));
            let mut words = setpoints(&from, 22);
            for (word, number) in to.iter().copied().chain(core::iter::repeat(0)).take(22).enumerate() {
                prop_assert_eq!(words.set(word, number), Ok(()));
                prop_assert!(words.mapping().is_ok());
            }
            prop_assert_eq!(words, setpoints(&to, 22));
        }

        #[test]
        fn whatever_is_written_it_stays_a_mapping(writes in prop::collection::vec((0..14_usize, 0..120_u16), 0..60)) {
            let mut words = setpoints(&[1], 12);
            for (word, number) in writes {
                let before = words;
                match words.set(word, number) {
                    Ok(()) => prop_assert_eq!(words.words()[word], number),
                    Err(_) => prop_assert_eq!(words, before),
                }
                prop_assert!(words.mapping().is_ok());
            }
        }
    }
}
