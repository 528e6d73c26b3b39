//! Where the signals of an axis are in the cyclic data.

use profile::state::{Profile, Stw1};
use profile::telegram::{Direction, Field, Mapping, MappingError, SetError, Telegram, signal};

use super::command::Command;
use super::seen::Seen;

/// Octets of the longest telegram that a mapping can have.
pub(super) const MOST_OCTETS: usize = 64;

/// Why cyclic data cannot be used for an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WiringError {
    /// The signals of one direction make no telegram.
    #[error("the {direction} of telegram {telegram}: {error}")]
    Mapping {
        /// Its number.
        telegram: u16,
        /// Setpoints or actual values.
        direction: &'static str,
        /// What is wrong.
        error: MappingError,
    },
    /// The module is shorter than its signals.
    #[error("telegram {telegram} has {octets} octets of {direction}, its module carries {module}")]
    Module {
        /// Its number.
        telegram: u16,
        /// Setpoints or actual values.
        direction: &'static str,
        /// Octets of the signals.
        octets: u16,
        /// Octets of the module.
        module: u16,
    },
}

/// The signals of one axis in its telegram, with the values of uncommanded ones.
///
/// ```
/// use profidrive_client::axis::{Command, Wiring};
/// use profile::state::Stw1;
/// use profile::telegram::{KOLLMORGEN, Telegram, signal};
/// let telegram = Telegram::find(1, KOLLMORGEN).unwrap();
/// let mut wiring = Wiring::new(1, telegram.setpoint.words(), telegram.actual.words(), KOLLMORGEN)?;
/// assert!(wiring.commands(signal::NSOLL_A) && !wiring.commands(signal::SATZANW));
/// let command = Command { stw1: Stw1::RUN, nsoll_a: 0xA3, ..Command::default() };
/// assert_eq!(wiring.encode(&command), [0x04, 0x7F, 0x00, 0xA3]);
/// assert_eq!(wiring.decode(&[0x02, 0x37, 0xFF, 0xFE]).unwrap().nist_a, Some(-2));
/// # Ok::<(), profidrive_client::axis::WiringError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wiring {
    telegram: u16,
    setpoint: Mapping,
    actual: Mapping,
    image: Vec<u8>,
    /// Whose bits the words in the places of STW1 and ZSW1 have.
    words: Profile,
    /// Bits of the control word beside STW1 that stand in it as long as control is taken.
    kept: u16,
    /// The control word sent last.
    sent: u16,
    /// Words of the setpoints with a parameter that settings of the drive choose: index behind the parameter channel
    /// and first octet.
    chosen: Vec<(u16, u16)>,
}

impl Wiring {
    /// From the signal number of each word, as in PNU 915 and 916.
    ///
    /// # Errors
    /// When the words are not telegram.
    pub fn new(
        telegram: u16,
        setpoint: impl IntoIterator<Item = u16>,
        actual: impl IntoIterator<Item = u16>,
        vendor: u16,
    ) -> Result<Self, WiringError> {
        let mapping = |words: Vec<u16>, direction, name| {
            Mapping::new(&words, vendor, direction).map_err(|error| WiringError::Mapping {
                telegram,
                direction: name,
                error,
            })
        };
        let setpoint = mapping(setpoint.into_iter().collect(), Direction::Setpoint, "setpoints")?;
        let actual = mapping(actual.into_iter().collect(), Direction::Actual, "actual values")?;
        Ok(Self {
            telegram,
            image: vec![0; usize::from(setpoint.octets()).min(MOST_OCTETS)],
            setpoint,
            actual,
            words: Profile::default(),
            kept: 0,
            sent: 0,
            chosen: Vec::new(),
        })
    }

    /// Returns the same with control and status words of this profile: what goes in and comes out here is STW1 and
    /// ZSW1.
    ///
    /// ```
    /// use profidrive_client::axis::{Command, Wiring};
    /// use profile::state::{Profile, State, Stw1};
    /// use profile::telegram::{DANFOSS, Telegram};
    /// let telegram = Telegram::find(1, DANFOSS).unwrap();
    /// let mut wiring = Wiring::of(telegram, DANFOSS)?.with_words(Profile::DanfossFc);
    /// let run = Command { stw1: Stw1::RUN, nsoll_a: 0x2000, ..Command::default() };
    /// assert_eq!(wiring.encode(&run), [0x04, 0x7C, 0x20, 0x00]);
    /// let seen = wiring.decode(&[0x0F, 0x07, 0x20, 0x00]).unwrap();
    /// assert_eq!(seen.zsw1.state(Stw1::RUN), Some(State::S4));
    /// # Ok::<(), profidrive_client::axis::WiringError>(())
    /// ```
    #[must_use]
    pub fn with_words(mut self, words: Profile) -> Self {
        self.words = words;
        self
    }

    /// Returns whose bits the control and status words have.
    #[must_use]
    pub const fn words(&self) -> Profile {
        self.words
    }

    /// Keeps the bits of this control word that STW1 has no bit for ([`Profile::beside`]) as long as control is taken: a
    /// drive that turns by that word is not to change its direction, ramp or set-up.
    pub fn keep_bits(&mut self, word: u16) {
        self.kept = self.words.beside(word);
    }

    /// Returns a telegram whose signals are fixed, or the default of a free one.
    ///
    /// # Errors
    /// When it does not start with STW1 and ZSW1: no telegram of an axis.
    pub fn of(telegram: &Telegram, vendor: u16) -> Result<Self, WiringError> {
        if telegram.pkw || telegram.parameters {
            return Ok(Self::of_parameters(telegram));
        }
        Self::new(
            telegram.number,
            telegram.setpoint.words(),
            telegram.actual.words(),
            vendor,
        )
    }

    /// Creates a telegram with parameter channel, or with words that settings choose.
    fn of_parameters(telegram: &Telegram) -> Self {
        Self {
            telegram: telegram.number,
            setpoint: Mapping::of(&telegram.setpoint),
            actual: Mapping::of(&telegram.actual),
            image: vec![0; usize::from(telegram.setpoint.octets).min(MOST_OCTETS)],
            words: Profile::default(),
            kept: 0,
            sent: 0,
            chosen: telegram.parameter_words(&telegram.setpoint).collect(),
        }
    }

    /// Words of the setpoints that carry a parameter which settings of the drive choose (VLT 9-15), by their index there.
    pub fn chosen_words(&self) -> impl Iterator<Item = u16> {
        self.chosen.iter().map(|(index, _)| *index)
    }

    /// What stands in such a word as long as the connection lasts.
    pub fn preset_chosen(&mut self, index: u16, value: u16) {
        let place = self.chosen.iter().find(|(known, _)| *known == index);
        let octets =
            place.and_then(|(_, offset)| self.image.get_mut(usize::from(*offset)..)?.first_chunk_mut());
        if let Some(octets) = octets {
            *octets = value.to_be_bytes();
        }
    }

    /// Returns the same in a module of this length: what is behind the signals stays 0.
    ///
    /// # Errors
    /// When the module is too short.
    pub fn in_module(mut self, outputs: u16, inputs: u16) -> Result<Self, WiringError> {
        for (direction, octets, module) in [
            ("setpoints", self.setpoint.octets(), outputs),
            ("actual values", self.actual.octets(), inputs),
        ] {
            if octets > module {
                let telegram = self.telegram;
                return Err(WiringError::Module {
                    telegram,
                    direction,
                    octets,
                    module,
                });
            }
        }
        self.image.resize(usize::from(outputs), 0);
        Ok(self)
    }

    /// Returns the number of the telegram.
    #[must_use]
    pub const fn telegram(&self) -> u16 {
        self.telegram
    }

    /// Returns the setpoints as they are sent.
    #[must_use]
    pub fn image(&self) -> &[u8] {
        &self.image
    }

    /// Returns the setpoints of the telegram with their places.
    #[must_use]
    pub fn setpoints(&self) -> &[Field] {
        self.setpoint.fields()
    }

    /// Returns the actual values of the telegram with their places.
    #[must_use]
    pub fn actuals(&self) -> &[Field] {
        self.actual.fields()
    }

    /// Returns true when the drive is sent this signal.
    #[must_use]
    pub fn commands(&self, signal: u16) -> bool {
        self.setpoint.position_of(signal).is_some()
    }

    /// Returns true when the drive sends this signal.
    #[must_use]
    pub fn reports(&self, signal: u16) -> bool {
        self.actual.position_of(signal).is_some()
    }

    /// Setpoint signals that a [`Command`] does not carry: they keep what [`preset`](Self::preset) puts there.
    pub fn uncommanded(&self) -> impl Iterator<Item = u16> {
        self.setpoint
            .fields()
            .iter()
            .map(|field| field.signal.number)
            .filter(|number| !COMMANDED.contains(number))
    }

    /// Presets the value of a signal until a command sets it.
    ///
    /// # Errors
    /// The telegram does not have it, or the value does not fit.
    pub fn preset(&mut self, signal: u16, value: i64) -> Result<(), SetError> {
        self.setpoint.set(&mut self.image, signal, value)
    }

    /// Returns the control word that stands in the telegram, in the words of the model.
    #[must_use]
    pub const fn sent(&self) -> u16 {
        self.sent
    }

    /// Returns the octets of a command. Does not allocate.
    pub fn encode(&mut self, command: &Command) -> &[u8] {
        let task = &command.traverse;
        let kept = if command.stw1.has(Stw1::CONTROL_BY_PLC) {
            self.kept
        } else {
            0
        };
        self.sent = self.words.control(command.stw1) | kept;
        let values = [
            (signal::STW1, i64::from(self.sent)),
            (signal::NSOLL_A, i64::from(command.nsoll_a)),
            (signal::SATZANW, i64::from(task.satzanw)),
            (signal::MDI_TARPOS, i64::from(task.target)),
            (signal::MDI_VELOCITY, i64::from(task.velocity)),
            (signal::MDI_ACC, i64::from(task.acceleration)),
            (signal::MDI_DEC, i64::from(task.deceleration)),
            (signal::MDI_MOD, i64::from(task.modus)),
        ];
        for (number, value) in values {
            // a telegram has some of them; all fit
            let _ = self.setpoint.set(&mut self.image, number, value);
        }
        &self.image
    }

    /// Returns the decoded inputs; `None` when the data is too short for the status word.
    #[must_use]
    pub fn decode(&self, data: &[u8]) -> Option<Seen> {
        let get = |number| self.actual.get(data, number);
        let word = u16::try_from(get(signal::ZSW1)?).ok()?;
        Some(Seen {
            zsw1: self.words.zsw1(word, self.sent),
            word,
            nist_a: get(signal::NIST_A).and_then(|value| i16::try_from(value).ok()),
            xist_a: get(signal::XIST_A).map(wrapped),
            aktsatz: get(signal::AKTSATZ).and_then(|value| u16::try_from(value).ok()),
            xist_error: get(signal::kollmorgen::XIST_ERROR).map(wrapped),
        })
    }
}

/// The signals that a command carries.
const COMMANDED: [u16; 8] = [
    signal::STW1,
    signal::NSOLL_A,
    signal::SATZANW,
    signal::MDI_TARPOS,
    signal::MDI_VELOCITY,
    signal::MDI_ACC,
    signal::MDI_DEC,
    signal::MDI_MOD,
];

/// Returns a position of 32 bits, whether the table calls it signed or not.
#[expect(clippy::cast_possible_truncation, reason = "keeps the 32 bits that travelled")]
pub(super) const fn wrapped(value: i64) -> i32 {
    value as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Traverse;
    use profile::state::Zsw1;
    use profile::telegram::{DANFOSS, KOLLMORGEN};

    fn akd(number: u16) -> Wiring {
        Wiring::of(Telegram::find(number, KOLLMORGEN).unwrap(), KOLLMORGEN).unwrap()
    }

    #[test]
    fn telegram_9_as_the_manual_lays_it_out() {
        let mut wiring = akd(9);
        let command = Command {
            stw1: Stw1(0x043F),
            nsoll_a: 7,
            traverse: Traverse::absolute(-2).with_speed(0x0147_AE14, 3, 4),
        };
        assert_eq!(
            wiring.encode(&command),
            [
                0x04, 0x3F, 0x80, 0x00, 0, 0, 0xFF, 0xFF, 0xFF, 0xFE, 0x01, 0x47, 0xAE, 0x14, 0, 3, 0, 4, 0,
                1
            ]
        );
        let seen = wiring
            .decode(&[0x2E, 0x37, 0x00, 0x05, 0, 0, 0xFF, 0xFF, 0xFF, 0xFE])
            .unwrap();
        assert_eq!(
            (seen.zsw1, seen.aktsatz, seen.xist_a, seen.nist_a),
            (Zsw1(0x2E37), Some(5), Some(-2), None)
        );
        assert_eq!(wiring.uncommanded().collect::<Vec<_>>(), [signal::STW2]);
    }

    #[test]
    fn signals_that_no_command_carries_keep_what_was_preset() {
        let mut wiring = akd(353);
        assert_eq!(
            wiring.uncommanded().collect::<Vec<_>>(),
            [
                signal::STW2,
                signal::kollmorgen::HOME_DIST,
                signal::kollmorgen::HOME_MODE
            ]
        );
        wiring.preset(signal::kollmorgen::HOME_MODE, 7).unwrap();
        wiring.preset(signal::kollmorgen::HOME_DIST, -1).unwrap();
        assert_eq!(
            wiring.encode(&Command::default())[20..],
            [0xFF, 0xFF, 0xFF, 0xFF, 0, 7]
        );
        assert!(wiring.preset(signal::NSOLL_A, 1).is_err());
    }

    #[test]
    fn each_telegram_of_an_akd_commands_what_it_carries() {
        for (number, speed, task, mdi) in [
            (1, true, false, false),
            (7, false, true, false),
            (9, false, true, true),
            (350, true, false, false),
            (351, true, false, false),
            (352, false, true, true),
            (353, false, true, true),
            (354, true, false, false),
        ] {
            let wiring = akd(number);
            let carries = [signal::NSOLL_A, signal::SATZANW, signal::MDI_TARPOS];
            assert_eq!(
                carries.map(|signal| wiring.commands(signal)),
                [speed, task, mdi],
                "{number}"
            );
        }
    }

    #[test]
    fn a_telegram_with_a_parameter_channel_leaves_its_words_unchanged() {
        let ppo_2 = Telegram::find(102, DANFOSS).unwrap();
        let mut wiring = Wiring::of(ppo_2, DANFOSS).unwrap().with_words(Profile::DanfossFc);
        assert_eq!(wiring.chosen_words().collect::<Vec<_>>(), [2, 3, 4, 5]);
        wiring.preset_chosen(3, 0x0102);
        wiring.preset_chosen(9, 0xFFFF);
        let run = Command {
            stw1: Stw1::RUN,
            nsoll_a: 0x2000,
            ..Command::default()
        };
        let mut octets = vec![0; 8];
        octets.extend([0x04, 0x7C, 0x20, 0, 0, 0, 0x01, 0x02, 0, 0, 0, 0]);
        assert_eq!(wiring.encode(&run), octets);
        let mut back = vec![0xFF; 8];
        back.extend([0x0F, 0x07, 0x1F, 0xFF, 0, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(wiring.decode(&back).unwrap().nist_a, Some(0x1FFF));
        assert_eq!(wiring.decode(&back[..9]), None);
    }

    #[test]
    fn a_mapped_telegram_in_its_module() {
        let words = || [signal::STW1, signal::MDI_TARPOS, signal::MDI_TARPOS];
        let actual = || [signal::ZSW1, signal::XIST_A, signal::XIST_A, 104, 104];
        let wiring = Wiring::new(0, words(), actual(), KOLLMORGEN).unwrap();
        assert!(matches!(
            wiring.clone().in_module(4, 24),
            Err(WiringError::Module {
                octets: 6,
                module: 4,
                ..
            })
        ));
        let mut wiring = wiring.in_module(24, 24).unwrap();
        assert_eq!(wiring.encode(&Command::default()).len(), 24);
        let mut data = [0; 24];
        data[..10].copy_from_slice(&[2, 0x37, 0, 0, 0, 9, 0xFF, 0xFF, 0xFF, 0xFD]);
        let seen = wiring.decode(&data).unwrap();
        assert_eq!((seen.xist_a, seen.xist_error), (Some(9), Some(-3)));
        assert!(Wiring::new(0, [5], [2], KOLLMORGEN).is_err());
        for length in 0..2 {
            assert_eq!(wiring.decode(&data[..length]), None);
        }
    }
}
