//! Words of a telegram that carry a parameter which settings choose (VLT 9-15 and 9-16, Vacon ID 852 to 859), the speed
//! word of vendor-specific telegrams, and the parameter channel in front of both.
//!
//! Source: MCA 101 manual p. 16 and 27, MCA 120 manual p. 27, OPTEA manual p. 103.

use profile::pkw::PkwErrorNumber;
use profile::telegram::{Telegram, signal};

use super::{Drive, WriteChannel};
use crate::model::{Chosen, Live, numbered};

/// Chosen words of one direction at most.
pub(super) const MOST_WORDS: usize = 16;

/// A word with the parameter that is in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ChosenWord {
    /// First octet.
    offset: usize,
    /// Position of the parameter in the catalogue.
    position: usize,
    /// Octets that it takes.
    octets: usize,
    /// What came last; nothing is written again.
    last: Option<i64>,
}

impl Drive {
    /// Speed in rpm of a number in the speed word of the telegram in use.
    pub(super) fn speed_of(&self, value: i64) -> f64 {
        match (&self.settings.inverter, self.own_full_speed()) {
            (Some(inverter), Some(full)) => inverter.own_speed(value, full),
            _ => self.settings.scaling.speed().engineering(value),
        }
    }

    /// Returns the number of the present speed in the speed word of the telegram in use.
    pub(super) fn speed_number(&self) -> i64 {
        self.number_of_speed(self.axis.measured_speed())
    }

    /// Returns the number of a speed in the speed word of the telegram in use.
    pub(super) fn number_of_speed(&self, speed: f64) -> i64 {
        self.speed_in(self.own_full_speed(), speed)
    }

    /// Returns the speed word of a telegram for a speed in rpm: by the reference that the drive has now,
    /// in the steps of that telegram.
    #[must_use]
    pub fn speed_word(&self, telegram: &Telegram, speed: f64) -> i64 {
        self.speed_in(telegram.full_speed, speed)
    }

    fn speed_in(&self, full: Option<u16>, speed: f64) -> i64 {
        match (&self.settings.inverter, full) {
            (Some(inverter), Some(full)) => {
                let number = inverter.own_number(speed, full).round();
                number.clamp(f64::from(i16::MIN), f64::from(i16::MAX)) as i64
            }
            _ => self.settings.scaling.speed().raw(speed).value,
        }
    }

    fn own_full_speed(&self) -> Option<u16> {
        self.process.own_telegram()?.full_speed
    }

    /// Looks up which parameters the chosen words carry: when the telegram or a setting has changed.
    pub(super) fn choose_words(&mut self) {
        let facts = &self.model.process;
        let Some(telegram) = self.process.own_telegram() else {
            self.process.words_in.clear();
            self.process.words_out.clear();
            return;
        };
        for (chosen, half, inward) in [
            (&facts.setpoints, &telegram.setpoint, true),
            (&facts.actuals, &telegram.actual, false),
        ] {
            let mut words = std::mem::take(if inward {
                &mut self.process.words_in
            } else {
                &mut self.process.words_out
            });
            let before: [Option<ChosenWord>; MOST_WORDS] =
                std::array::from_fn(|place| words.get(place).copied());
            words.clear();
            let mut places = telegram.parameter_words(half).enumerate().peekable();
            while let Some((free, (index, offset))) = places.next() {
                let number = self.chosen_number(chosen, index, free);
                let Some(position) = numbered(self.model.catalogue, number).filter(|_| number != 0) else {
                    continue;
                };
                let Some(parameter) = self.model.catalogue.parameters.get(position) else {
                    continue;
                };
                let wide = parameter.size.octets() == 4
                    && places.peek().is_some_and(|(free, (index, _))| {
                        self.chosen_number(chosen, *index, *free) == number
                    });
                if wide {
                    places.next();
                }
                let word = ChosenWord {
                    offset: usize::from(offset),
                    position,
                    octets: if wide { 4 } else { 2 },
                    last: None,
                };
                let same = |known: &&ChosenWord| {
                    ChosenWord {
                        last: None,
                        ..**known
                    } == word
                };
                let known = before.iter().flatten().find(same);
                if words.len() < MOST_WORDS {
                    words.push(known.copied().unwrap_or(word));
                }
            }
            if inward {
                self.process.words_in = words;
            } else {
                self.process.words_out = words;
            }
        }
    }

    /// Returns the number of the parameter in a word; `index` counts from the control or status word, `free` the chosen
    /// words.
    pub(super) fn chosen_number(&self, chosen: &Chosen, index: u16, free: usize) -> u16 {
        let number = match chosen {
            Chosen::Nothing => 0,
            Chosen::Array(part) => {
                let array = self.model.number(*part);
                array.map_or(0, |array| self.values.element_of(array, index))
            }
            Chosen::Each(numbers) => numbers.get(free).map_or(0, |number| self.values.get(*number)),
            Chosen::Fixed(numbers) => numbers.get(free).map_or(0, |number| i64::from(*number)),
        };
        u16::try_from(number).unwrap_or(0)
    }

    /// Writes the chosen words that have changed into their parameters; what a parameter does not take is passed over.
    pub(super) fn take_words(&mut self, outputs: &[u8]) {
        for place in 0..self.process.words_in.len() {
            let Some(word) = self.process.words_in.get(place).copied() else {
                return;
            };
            let Some(octets) = outputs.get(word.offset..word.offset + word.octets) else {
                continue;
            };
            let raw = octets
                .iter()
                .fold(0_u32, |raw, octet| raw << 8 | u32::from(*octet));
            let Some(parameter) = self.model.catalogue.parameters.get(word.position) else {
                continue;
            };
            let raw = match (word.octets, parameter.signed) {
                (2, true) => i64::from(raw as u16 as i16),
                (4, true) => i64::from(raw as i32),
                _ => i64::from(raw),
            };
            if word.last == Some(raw) {
                continue;
            }
            if let Some(word) = self.process.words_in.get_mut(place) {
                word.last = Some(raw);
            }
            let _ = self.set_element(word.position, 0, raw);
        }
    }

    /// Puts the chosen words into the inputs; of a number that is too large for its word the low octets.
    pub(super) fn give_words(&self, inputs: &mut [u8]) {
        for word in &self.process.words_out {
            let octets = self.element(word.position, 0).unwrap_or(0).to_be_bytes();
            let low = octets.get(octets.len() - word.octets..).unwrap_or_default();
            if let Some(place) = inputs.get_mut(word.offset..word.offset + word.octets) {
                place.copy_from_slice(low);
            }
        }
    }

    /// Refuses every request of the parameter channel in the process data with this number, or none any more.
    pub(crate) const fn refuse_in_channel(&mut self, number: Option<PkwErrorNumber>) {
        if let Some(server) = &mut self.pkw {
            server.refuse_all(number);
        }
    }

    /// Serves the parameter channel in front of the process data, where the telegram has one.
    pub(super) fn serve_channel(&mut self, outputs: Option<&[u8]>, inputs: &mut [u8]) {
        if !self.process.own_telegram().is_some_and(|telegram| telegram.pkw) {
            return;
        }
        let Some(mut server) = self.pkw.take() else {
            return;
        };
        let request = outputs.and_then(|outputs| outputs.first_chunk::<{ Telegram::PKW as usize }>());
        let reply = match request {
            Some(request) => self.written_through(WriteChannel::Pkw, |drive| server.handle(*request, drive)),
            None => {
                server.reset();
                [0; Telegram::PKW as usize]
            }
        };
        if let Some(place) = inputs.first_chunk_mut::<{ Telegram::PKW as usize }>() {
            *place = reply;
        }
        self.pkw = Some(server);
    }

    /// Value of PNU 915 or 916 in a drive whose words are chosen.
    pub(super) fn word_number(&self, actual: bool, position: usize, element: u16) -> i64 {
        let mapping = if actual {
            self.process.actuals()
        } else {
            self.process.setpoints()
        };
        if self.process.own_telegram().is_none() {
            return i64::from(mapping.word(element));
        }
        let fixed = match (actual, element) {
            (false, 0) => signal::STW1,
            (false, 1) => signal::NSOLL_A,
            (true, 0) => signal::ZSW1,
            (true, 1) => signal::NIST_A,
            _ => return self.values.element_at(position, element),
        };
        self.model.number_of_signal(fixed).map_or(0, i64::from)
    }

    /// Returns the index in the catalogue of the PCD word that stands for an element of the wide ones.
    pub(super) fn wide_word(&self, element: usize) -> Option<usize> {
        let number = self.chosen_number(&self.model.process.setpoints, 0, element);
        numbered(self.model.catalogue, number).filter(|_| number != 0)
    }

    /// Returns the word of process data that is shown as a parameter of its own.
    pub(super) fn shown_word(&self, actual: bool, number: u8) -> i64 {
        let facts = &self.model.process;
        let chosen = if actual { &facts.actuals } else { &facts.setpoints };
        let number = self.chosen_number(chosen, 0, number.into());
        let position = numbered(self.model.catalogue, number).filter(|_| number != 0);
        let shown = position.filter(|position| !matches!(self.live.get(*position), Some(Live::Word { .. })));
        shown
            .and_then(|position| self.element(position, 0).ok())
            .unwrap_or(0)
    }
}
