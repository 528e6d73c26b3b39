//! Free telegrams: the mapping out of PNU 915 or 916.

use thiserror::Error;

use super::{Direction, Field, Image, SetError, Signal};

/// Words of a telegram at most: the PNU 915 and 916 of the drives known here have 16.
pub(super) const MOST_WORDS: usize = 32;

/// Numbers of STW1 and ZSW1, whose place is the first word and no other.
const WORD_ONE: [u16; 2] = [1, 2];

/// Half of a free telegram (telegram 0, AKD telegram 400), made out of the signal numbers of PNU 915 or 916.
/// Source: AKD manual 5.8, 5.11.1 and 5.11.10; AKD2G web help (STW1 and ZSW1 come first).
///
/// A signal of more than one word stands in as many words one after the other. Reading and writing does not allocate.
///
/// ```
/// use profidrive_profile::telegram::{Direction, KOLLMORGEN, Mapping, signal};
/// let mapping = Mapping::new(&[2, 6, 28, 28, 0, 0], KOLLMORGEN, Direction::Actual).unwrap();
/// assert_eq!(mapping.get(&[0x02, 0x37, 0, 0, 0, 0, 0, 7, 0, 0, 0, 0], signal::XIST_A), Some(7));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mapping {
    /// In order, without gaps; only the first `count` count.
    fields: [Field; MOST_WORDS],
    count: usize,
    octets: u16,
}

/// Stands in the places of [`Mapping::fields`] that are not in use.
static NOTHING: Signal = Signal {
    number: 0,
    name: "",
    vendor: None,
    bits: 16,
    signed: false,
    direction: Direction::Either,
    meaning: "",
    common: "",
    source: "",
};

/// Why signal numbers are not mapping.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum MappingError {
    /// More words than this crate handles.
    #[error("a telegram of {words} words, {MOST_WORDS} are possible")]
    Long {
        /// Words requested.
        words: usize,
    },
    /// The drive has no such signal.
    #[error("word {word}: no signal {signal}")]
    Unknown {
        /// Position, from 0.
        word: usize,
        /// Signal number.
        signal: u16,
    },
    /// The signal goes the other way.
    #[error("word {word}: {signal} goes the other way")]
    Direction {
        /// Position, from 0.
        word: usize,
        /// Signal name.
        signal: &'static str,
    },
    /// A signal of several words does not stand in all of them.
    #[error("word {word}: {signal} needs {words} words one after the other")]
    Cut {
        /// Position of the first, from 0.
        word: usize,
        /// Signal name.
        signal: &'static str,
        /// Words it needs.
        words: u16,
    },
    /// The first word is not STW1 or ZSW1.
    #[error("the first word is signal {signal}, not STW1 or ZSW1")]
    First {
        /// Signal number there.
        signal: u16,
    },
    /// STW1 or ZSW1 in another word than the first. Source: AKD2G web help, PROFINET signal list.
    #[error("word {word}: {signal} can be the first word only")]
    OnlyFirst {
        /// Position, from 0.
        word: usize,
        /// Signal name.
        signal: &'static str,
    },
}

impl MappingError {
    /// Returns the position of the word that is wrong, from 0; of the first one too many for a mapping that is too
    /// long.
    #[must_use]
    pub const fn word(&self) -> usize {
        match *self {
            Self::Long { .. } => MOST_WORDS,
            Self::First { .. } => 0,
            Self::Unknown { word, .. }
            | Self::Direction { word, .. }
            | Self::Cut { word, .. }
            | Self::OnlyFirst { word, .. } => word,
        }
    }
}

impl Mapping {
    /// No words.
    pub const EMPTY: Self = Self {
        fields: [Field {
            signal: &NOTHING,
            offset: 0,
        }; MOST_WORDS],
        count: 0,
        octets: 0,
    };

    /// Returns the half of a fixed telegram as a mapping.
    #[must_use]
    pub fn of(image: &Image) -> Self {
        let mut mapping = Self {
            octets: image.octets,
            ..Self::EMPTY
        };
        for field in image.fields {
            mapping.push(*field);
        }
        mapping
    }

    /// Returns a mapping for a drive of this vendor; `direction` selects that of PNU 915 (setpoint) or 916
    /// (actual).
    ///
    /// # Errors
    /// What is wrong, and in which word.
    pub fn new(words: &[u16], vendor: u16, direction: Direction) -> Result<Self, MappingError> {
        if words.len() > MOST_WORDS {
            return Err(MappingError::Long { words: words.len() });
        }
        if let Some(first) = words.first()
            && !matches!(
                (direction, first),
                (Direction::Setpoint, 1) | (Direction::Actual, 2) | (Direction::Either, 1 | 2)
            )
        {
            return Err(MappingError::First { signal: *first });
        }
        let mut mapping = Self::EMPTY;
        let mut covered = 0;
        for (word, number) in words.iter().enumerate() {
            let offset = mapping.octets;
            mapping.octets += 2;
            if word < covered || *number == 0 {
                continue;
            }
            let signal = Signal::find(*number, vendor).ok_or(MappingError::Unknown {
                word,
                signal: *number,
            })?;
            let fits = signal.direction == direction
                || Direction::Either == signal.direction
                || Direction::Either == direction;
            if !fits {
                return Err(MappingError::Direction {
                    word,
                    signal: signal.name,
                });
            }
            if word > 0 && WORD_ONE.contains(number) {
                return Err(MappingError::OnlyFirst {
                    word,
                    signal: signal.name,
                });
            }
            covered = word + usize::from(signal.octets() / 2);
            let repeated = words
                .get(word..covered)
                .is_some_and(|words| words.iter().all(|other| other == number));
            if !repeated {
                return Err(MappingError::Cut {
                    word,
                    signal: signal.name,
                    words: signal.octets() / 2,
                });
            }
            mapping.push(Field { signal, offset });
        }
        Ok(mapping)
    }

    fn push(&mut self, field: Field) {
        if let Some(place) = self.fields.get_mut(self.count) {
            *place = field;
            self.count += 1;
        }
    }

    /// Returns the length of the data.
    #[must_use]
    pub const fn octets(&self) -> u16 {
        self.octets
    }

    /// Returns the signals with their places, in order.
    #[must_use]
    pub fn fields(&self) -> &[Field] {
        self.fields.get(..self.count).unwrap_or_default()
    }

    /// Signal number of each word as in PNU 915 and 916: a longer signal stands in each of its words, 0 is none.
    pub fn words(&self) -> impl Iterator<Item = u16> {
        (0..self.octets / 2).map(|word| self.word(word))
    }

    /// Signal number of one word, counted from 0; 0 where there is none.
    #[must_use]
    pub fn word(&self, word: u16) -> u16 {
        let inside = |field: &&Field| {
            let first = field.offset / 2;
            (first..first + field.signal.octets() / 2).contains(&word)
        };
        self.fields()
            .iter()
            .find(inside)
            .map_or(0, |field| field.signal.number)
    }

    /// Returns true when the signal has a place here.
    #[must_use]
    pub fn has(&self, signal: u16) -> bool {
        self.position_of(signal).is_some()
    }

    /// First octet of the signal with this number.
    #[must_use]
    pub fn position_of(&self, signal: u16) -> Option<usize> {
        let field = self.fields().iter().find(|field| field.signal.number == signal);
        field.map(|field| usize::from(field.offset))
    }

    /// Value of a signal; none when it is not mapped or the data are too short.
    #[must_use]
    pub fn get(&self, data: &[u8], signal: u16) -> Option<i64> {
        self.fields()
            .iter()
            .find(|field| field.signal.number == signal)?
            .get(data)
    }

    /// Sets a signal.
    ///
    /// # Errors
    /// It is not mapped, the value does not fit, or the data are too short. Nothing is changed then.
    pub fn set(&self, data: &mut [u8], signal: u16, value: i64) -> Result<(), SetError> {
        self.fields()
            .iter()
            .find(|field| field.signal.number == signal)
            .ok_or(SetError::NoSignal { signal })?
            .set(data, value)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{KOLLMORGEN, TELEGRAMS, signal};
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    #[test]
    fn the_words_of_each_fixed_telegram_make_the_same_places() {
        for telegram in &TELEGRAMS {
            if telegram
                .setpoint
                .words()
                .next()
                .is_some_and(|first| first != signal::STW1)
            {
                continue; // encoders
            }
            for (image, direction) in [
                (&telegram.setpoint, Direction::Setpoint),
                (&telegram.actual, Direction::Actual),
            ] {
                let words: Vec<_> = image.words().collect();
                let mapping = Mapping::new(&words, telegram.vendor.unwrap_or(0), direction).unwrap();
                assert_eq!(mapping.octets(), image.octets);
                assert_eq!(mapping.fields(), image.fields, "{}", telegram.number);
                assert_eq!(mapping, Mapping::of(image));
                assert!(mapping.words().eq(words), "{}", telegram.number);
            }
        }
    }

    #[test]
    fn what_is_refused() {
        let new = |words: &[u16]| Mapping::new(words, KOLLMORGEN, Direction::Setpoint);
        let error = |words: &[u16]| new(words).unwrap_err();
        assert_eq!(error(&[5]), MappingError::First { signal: 5 });
        assert_eq!(error(&[1, 999]), MappingError::Unknown { word: 1, signal: 999 });
        let wrong_way = MappingError::Direction {
            word: 1,
            signal: "NIST_A",
        };
        assert_eq!(error(&[1, 6]), wrong_way);
        let cut = MappingError::Cut {
            word: 1,
            signal: "MDI_TARPOS",
            words: 2,
        };
        assert_eq!(error(&[1, 34]), cut);
        assert_eq!(error(&[1, 34, 5]), cut);
        assert_eq!(error(&[1; 33]), MappingError::Long { words: 33 });
        let twice = MappingError::OnlyFirst {
            word: 2,
            signal: "STW1",
        };
        assert_eq!(error(&[1, 5, 1]), twice);
        assert_eq!((twice.word(), cut.word(), error(&[5]).word()), (2, 1, 0));
        assert_eq!(new(&[]).unwrap().octets(), 0);
        assert_eq!(new(&[1, 0, 107]).unwrap().position_of(107), Some(4));
    }

    #[test]
    fn values_in_place() {
        let mapping = Mapping::new(&[1, 34, 34, 5], KOLLMORGEN, Direction::Setpoint).unwrap();
        let mut data = [0; 8];
        mapping.set(&mut data, signal::MDI_TARPOS, -2).unwrap();
        mapping.set(&mut data, signal::NSOLL_A, 3).unwrap();
        assert_eq!(data, [0, 0, 0xFF, 0xFF, 0xFF, 0xFE, 0, 3]);
        let missing = Err(SetError::NoSignal { signal: 35 });
        assert_eq!(mapping.set(&mut data, signal::MDI_VELOCITY, 1), missing);
    }

    proptest! {
        /// Words as a drive could send them in 915, mostly of signals that exist.
        #[test]
        fn any_words_and_any_data(
            words in prop::collection::vec(prop_oneof![0_u16..60, 95_u16..112, any::<u16>()], 0..40),
            repeat: bool,
            data in prop::collection::vec(any::<u8>(), 0..90),
        ) {
            let mut words = words;
            if repeat {
                words = [1].into_iter().chain(words.into_iter().flat_map(|word| [word, word])).collect();
            }
            let Ok(mapping) = Mapping::new(&words, KOLLMORGEN, Direction::Setpoint) else {
                return Ok(());
            };
            prop_assert_eq!(usize::from(mapping.octets()), 2 * words.len());
            for field in mapping.fields() {
                let end = usize::from(field.offset + field.signal.octets());
                prop_assert!(end <= usize::from(mapping.octets()));
                prop_assert_eq!(field.get(&data).is_some(), end <= data.len());
            }
        }
    }
}
