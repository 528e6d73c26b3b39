//! Signals and telegrams: what is where in the cyclic data.
//!
//! Source: the tables in `data/profile/`, with one source per row: AKD PROFINET manual ed. M 5.8 and 5.11 and manuals
//! of Siemens, Heidenhain and LinMot. Numbers from 100 on are the vendor-specific, so that a search needs the vendor
//! number.
//!
//! ```
//! use profidrive_profile::telegram::{KOLLMORGEN, Telegram, signal};
//! let telegram = Telegram::find(1, KOLLMORGEN).unwrap();
//! let mut frame = [0; 4];
//! telegram.setpoint.set(&mut frame, signal::STW1, 0x047F).unwrap();
//! telegram.setpoint.set(&mut frame, signal::NSOLL_A, -164).unwrap();
//! assert_eq!(frame, [0x04, 0x7F, 0xFF, 0x5C]);
//! assert_eq!(telegram.actual.get(&[0x02, 0x37, 0xFF, 0x62], signal::NIST_A), Some(-158));
//! ```

mod free;
mod generated;
mod mapping;

pub use free::FreeMapping;
pub use generated::{SIGNALS, TELEGRAMS, signal};
pub use mapping::{Mapping, MappingError};

use thiserror::Error;

/// PROFINET vendor number of Kollmorgen.
pub const KOLLMORGEN: u16 = 0x0105;
/// PROFINET vendor number of Siemens.
pub const SIEMENS: u16 = 0x002A;
/// PROFINET vendor number of Danfoss.
pub const DANFOSS: u16 = 0x0080;
/// PROFINET vendor number of Vacon.
pub const VACON: u16 = 0x01BA;

/// Which way a signal goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// From the controller to the drive.
    Setpoint,
    /// From the drive to the controller.
    Actual,
    /// Both.
    Either,
}

/// One signal. Source: profile 6.3.4.3 for numbers below 100, above them the vendor; see `source`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Signal {
    /// Number, as in PNU 915 and 916.
    pub number: u16,
    /// Short name, for example `NSOLL_A`.
    pub name: &'static str,
    /// Vendor number of the vendor whose signal it is, none for the profile's.
    pub vendor: Option<u16>,
    /// Size: 16, 32 or 64.
    pub bits: u8,
    /// True when the number is two's complement.
    pub signed: bool,
    /// Which way it goes.
    pub direction: Direction,
    /// What it is.
    pub meaning: &'static str,
    /// The name that people know it by, whatever the vendor: `speed`; empty for none.
    pub common: &'static str,
    /// Where this is from.
    pub source: &'static str,
}

impl Signal {
    /// Returns the signal with this number on a drive of this vendor.
    #[must_use]
    pub fn find(number: u16, vendor: u16) -> Option<&'static Self> {
        SIGNALS
            .iter()
            .find(|signal| signal.number == number && signal.vendor.is_none_or(|owner| owner == vendor))
    }

    /// Returns the signal with this name on a drive of this vendor; case does not matter.
    #[must_use]
    pub fn by_name(name: &str, vendor: u16) -> Option<&'static Self> {
        SIGNALS.iter().find(|signal| {
            signal.name.eq_ignore_ascii_case(name) && signal.vendor.is_none_or(|owner| owner == vendor)
        })
    }

    /// Octets in the cyclic data.
    #[must_use]
    pub const fn octets(&self) -> u16 {
        self.bits as u16 / 8
    }

    /// Lowest and highest value. Those of an unsigned 64-bit signal travel as two's complement.
    #[must_use]
    pub const fn range(&self) -> (i64, i64) {
        match (self.bits, self.signed) {
            (16, true) => (i16::MIN as i64, i16::MAX as i64),
            (16, false) => (0, u16::MAX as i64),
            (32, true) => (i32::MIN as i64, i32::MAX as i64),
            (32, false) => (0, u32::MAX as i64),
            _ => (i64::MIN, i64::MAX),
        }
    }

    /// Returns the value out of its octets, high octet first; none when they are too few.
    #[must_use]
    pub fn decode(&self, octets: &[u8]) -> Option<i64> {
        let octets = octets.get(..usize::from(self.octets()))?;
        let value = octets
            .iter()
            .fold(0_u64, |value, octet| value << 8 | u64::from(*octet));
        Some(match (self.bits, self.signed) {
            (16, true) => i64::from(value as u16 as i16),
            (32, true) => i64::from(value as u32 as i32),
            _ => value as i64,
        })
    }

    /// Puts a value into its octets.
    ///
    /// # Errors
    /// The value does not fit the signal, or the octets are too few. Nothing is changed then.
    pub fn encode(&self, value: i64, octets: &mut [u8]) -> Result<(), SetError> {
        let (lowest, highest) = self.range();
        if !(lowest..=highest).contains(&value) {
            return Err(SetError::Range {
                signal: self.name,
                value,
                lowest,
                highest,
            });
        }
        let bytes = value.to_be_bytes();
        let size = usize::from(self.octets());
        match (
            octets.get_mut(..size),
            bytes.get(bytes.len().saturating_sub(size)..),
        ) {
            (Some(place), Some(bytes)) => {
                place.copy_from_slice(bytes);
                Ok(())
            }
            _ => Err(SetError::Short { signal: self.name }),
        }
    }
}

/// Why a value was not put into a telegram: misuse by the caller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum SetError {
    /// The telegram does not have the signal.
    #[error("the telegram has no signal {signal}")]
    NoSignal {
        /// Its number.
        signal: u16,
    },
    /// The value does not fit the signal.
    #[error("{value} does not fit {signal}: {lowest} to {highest}")]
    Range {
        /// Its name.
        signal: &'static str,
        /// The value.
        value: i64,
        /// Lowest possible value.
        lowest: i64,
        /// Highest possible value.
        highest: i64,
    },
    /// The data end before the signal does.
    #[error("the cyclic data end before {signal}")]
    Short {
        /// Its name.
        signal: &'static str,
    },
}

/// Place of one signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    /// The signal.
    pub signal: &'static Signal,
    /// First octet.
    pub offset: u16,
}

impl Field {
    /// Returns the value in this data; none when they are too short.
    #[must_use]
    pub fn get(&self, data: &[u8]) -> Option<i64> {
        self.signal.decode(data.get(usize::from(self.offset)..)?)
    }

    /// Puts a value into this data.
    ///
    /// # Errors
    /// As [`Signal::encode`].
    pub fn set(&self, data: &mut [u8], value: i64) -> Result<(), SetError> {
        let octets = data.get_mut(usize::from(self.offset)..);
        let name = self.signal.name;
        self.signal
            .encode(value, octets.ok_or(SetError::Short { signal: name })?)
    }
}

/// The half of a telegram that goes one way. Reads and writes in place, nothing is allocated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Image {
    /// The signals with their places, in order. Words without signal have no field.
    pub fields: &'static [Field],
    /// Length.
    pub octets: u16,
}

impl Image {
    /// Place of the signal with this number.
    #[must_use]
    pub fn field(&self, signal: u16) -> Option<&'static Field> {
        self.fields.iter().find(|field| field.signal.number == signal)
    }

    /// First octet of the signal with this number.
    #[must_use]
    pub fn position_of(&self, signal: u16) -> Option<usize> {
        self.field(signal).map(|field| usize::from(field.offset))
    }

    /// Value of a signal; none when the telegram does not have it or the data are too short.
    #[must_use]
    pub fn get(&self, data: &[u8], signal: u16) -> Option<i64> {
        self.field(signal)?.get(data)
    }

    /// Sets a signal.
    ///
    /// # Errors
    /// The telegram does not have it, the value does not fit, or the data are too short. Nothing is changed then.
    pub fn set(&self, data: &mut [u8], signal: u16, value: i64) -> Result<(), SetError> {
        self.field(signal)
            .ok_or(SetError::NoSignal { signal })?
            .set(data, value)
    }

    /// Signal number of each word as in PNU 915 and 916: a longer signal stands in each of its words, 0 is none. That
    /// rule of repetition is confirmed by Danfoss for its own maps only.
    pub fn words(&self) -> impl Iterator<Item = u16> + use<> {
        let fields = self.fields;
        (0..self.octets).step_by(2).map(move |offset| {
            let inside =
                |field: &&Field| (field.offset..field.offset + field.signal.octets()).contains(&offset);
            fields.iter().find(inside).map_or(0, |field| field.signal.number)
        })
    }
}

/// One telegram. Source: profile 6.3.4.3; vendors' telegrams as in `source`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Telegram {
    /// Number, PNU 922.
    pub number: u16,
    /// Vendor number of the vendor whose telegram it is, none for the profile's.
    pub vendor: Option<u16>,
    /// The mapping can be changed, `setpoint` and `actual` are the default; see [`Mapping`].
    pub free: bool,
    /// The first [`PKW`](Self::PKW) octets each way are the parameter channel: PKE, IND and PWE. Signals follow behind.
    pub pkw: bool,
    /// Words without a signal carry parameters that settings of the drive choose, see
    /// [`parameter_words`](Self::parameter_words).
    pub parameters: bool,
    /// The words in the places of STW1 and ZSW1 have the bits of the vendor's own profile (VLT: as set by 8-10), see
    /// [`Profile`](crate::state::Profile).
    pub own_words: bool,
    /// The number of NSOLL_A and NIST_A that is 100 % where the telegram has a scale of its own; none: that of the drive.
    pub full_speed: Option<u16>,
    /// From the controller to the drive.
    pub setpoint: Image,
    /// From the drive to the controller.
    pub actual: Image,
    /// Where this is from.
    pub source: &'static str,
}

impl Telegram {
    /// Octets of the parameter channel.
    pub const PKW: u16 = 8;

    /// Returns the process data of a serial line: control word and setpoint there, status word and actual value back.
    /// That is the telegram of the vendor with these two words alone, in the vendor's own words (PPO 3 of a VLT), else
    /// telegram 1.
    ///
    /// ```
    /// use profidrive_profile::telegram::{DANFOSS, KOLLMORGEN, Telegram};
    /// let number = |vendor| Telegram::of_line(vendor).map(|telegram| telegram.number);
    /// assert_eq!((number(DANFOSS), number(KOLLMORGEN)), (Some(103), Some(1)));
    /// ```
    #[must_use]
    pub fn of_line(vendor: u16) -> Option<&'static Self> {
        let two = |telegram: &&Self| {
            telegram.own_words
                && !telegram.pkw
                && telegram.vendor == Some(vendor)
                && telegram.setpoint.octets == 4
                && telegram.actual.octets == 4
        };
        TELEGRAMS.iter().find(two).or_else(|| Self::find(1, vendor))
    }

    /// Returns the words of one half that carry a parameter chosen by settings of the drive: index of the word behind
    /// the parameter channel (that of VLT 9-15 and 9-16) and first octet.
    ///
    /// ```
    /// use profidrive_profile::telegram::{DANFOSS, Telegram};
    /// let ppo_2 = Telegram::find(102, DANFOSS).unwrap();
    /// let words: Vec<(u16, u16)> = ppo_2.parameter_words(&ppo_2.setpoint).collect();
    /// assert_eq!(words, [(2, 12), (3, 14), (4, 16), (5, 18)]);
    /// ```
    pub fn parameter_words(&self, half: &Image) -> impl Iterator<Item = (u16, u16)> + use<> {
        let first = if self.pkw { Self::PKW } else { 0 };
        let end = if self.parameters { half.octets } else { first };
        let fields = half.fields;
        let taken = move |offset: u16| {
            let mut fields = fields.iter();
            fields.any(|field| (field.offset..field.offset + field.signal.octets()).contains(&offset))
        };
        (first..end)
            .step_by(2)
            .enumerate()
            .filter(move |(_, offset)| !taken(*offset))
            .filter_map(|(index, offset)| Some((u16::try_from(index).ok()?, offset)))
    }

    /// Returns true for a telegram that selects traversing tasks (SATZANW): telegrams 7, 9, 352, 353 and, as delivered,
    /// 400 of an AKD.
    #[must_use]
    pub fn positions(&self) -> bool {
        self.setpoint.field(signal::SATZANW).is_some()
    }

    /// Returns the telegram with this number on a drive of this vendor.
    #[must_use]
    pub fn find(number: u16, vendor: u16) -> Option<&'static Self> {
        TELEGRAMS
            .iter()
            .find(|telegram| telegram.number == number && telegram.vendor.is_none_or(|owner| owner == vendor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::AKD;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    fn akd(number: u16) -> &'static Telegram {
        Telegram::find(number, KOLLMORGEN).unwrap()
    }

    #[test]
    fn the_modules_of_the_akd_have_the_lengths_of_their_telegrams() {
        for module in AKD.device.telegrams {
            let telegram = akd(module.telegram);
            if telegram.number == 0 {
                continue; // as long as its module
            }
            assert_eq!(
                (telegram.setpoint.octets, telegram.actual.octets),
                (module.outputs, module.inputs),
                "{}",
                telegram.number
            );
        }
    }

    #[test]
    fn the_modules_of_the_converters_have_the_lengths_of_their_telegrams() {
        for catalogue in [&crate::catalogue::VLT, &crate::catalogue::VACON] {
            let device = &catalogue.device;
            for module in device.telegrams {
                let telegram = Telegram::find(module.telegram, device.vendor_id).unwrap();
                let lengths = (telegram.setpoint.octets, telegram.actual.octets);
                assert_eq!(lengths, (module.outputs, module.inputs), "{}", telegram.number);
                // telegram 1 is the profile's
                let own = telegram.number != 1;
                assert_eq!((telegram.own_words, telegram.parameters), (own, own));
                assert_eq!(telegram.full_speed.is_some(), own);
            }
        }
        for telegram in TELEGRAMS
            .iter()
            .filter(|telegram| telegram.vendor != Some(DANFOSS))
        {
            assert!(!telegram.pkw, "{}", telegram.number);
            let words = telegram.parameter_words(&telegram.actual).count();
            assert_eq!(words > 0, matches!(telegram.number, 149 | 150));
        }
    }

    /// Places of a PPO with parameter channel: PKE 1, IND 3, PVA 5, CTW 9, MRV 11, further words from 13 on (from 1).
    #[test]
    fn ppo_types_word_by_word() {
        let ppo = |kind: u16| Telegram::find(100 + kind, DANFOSS).unwrap();
        for (kind, octets, pkw) in [
            (1, 12, true),
            (2, 20, true),
            (3, 4, false),
            (4, 12, false),
            (5, 28, true),
            (6, 20, false),
            (7, 24, true),
            (8, 16, false),
        ] {
            let telegram = ppo(kind);
            assert_eq!(
                (telegram.setpoint.octets, telegram.actual.octets),
                (octets, octets)
            );
            assert_eq!(telegram.pkw, pkw);
            let first = if pkw { 8 } else { 0 };
            assert_eq!(telegram.setpoint.position_of(signal::STW1), Some(first));
            assert_eq!(telegram.actual.position_of(signal::NIST_A), Some(first + 2));
            let words: Vec<(u16, u16)> = telegram.parameter_words(&telegram.actual).collect();
            assert_eq!(words.len(), (usize::from(octets) - first) / 2 - 2);
            assert!(
                words
                    .iter()
                    .all(|(index, offset)| usize::from(*offset) == first + 2 * usize::from(*index))
            );
        }
        // FCM 300 p. 29: a positive reply of a double word in PPO 1, STW 0F07, MAV 50 %
        let reply = [0x20, 0xCF, 0, 0, 0, 0, 0x03, 0xE8, 0x0F, 0x07, 0x20, 0x00];
        let actual = &ppo(1).actual;
        assert_eq!(actual.get(&reply, signal::ZSW1), Some(0x0F07));
        assert_eq!(actual.get(&reply, signal::NIST_A), Some(0x2000));
        // the other way, and the printed rejection with the same process words
        for pkw in [[0x20, 0xCF, 0, 0, 0, 0, 0x03, 0xE8], [0x70, 0, 0, 0, 0, 0, 0, 2]] {
            let mut built = [0; 12];
            built[..8].copy_from_slice(&pkw);
            actual.set(&mut built, signal::ZSW1, 0x0F07).unwrap();
            actual.set(&mut built, signal::NIST_A, 0x2000).unwrap();
            assert_eq!(built[..8], pkw);
            assert_eq!(built[8..], reply[8..]);
        }
        let mut vendor = [0; 4];
        let telegram = Telegram::find(148, VACON).unwrap();
        telegram
            .setpoint
            .set(&mut vendor, signal::NSOLL_A, -10_000)
            .unwrap();
        assert_eq!((vendor, telegram.full_speed), ([0, 0, 0xD8, 0xF0], Some(10_000)));
        assert_eq!(Telegram::find(148, DANFOSS), None);
    }

    #[test]
    fn akd_signals_agree_with_the_parameters_of_the_same_number() {
        for signal in SIGNALS
            .iter()
            .filter(|signal| signal.vendor.is_none_or(|v| v == KOLLMORGEN))
        {
            if let Some(parameter) = AKD.by_pnu(signal.number) {
                assert_eq!(
                    parameter.size.octets(),
                    usize::from(signal.octets()),
                    "{}",
                    signal.name
                );
                assert_eq!(parameter.signed, signal.signed, "{}", signal.name);
                assert!(
                    parameter.name == signal.name || signal.number == 107,
                    "{}",
                    signal.name
                );
            }
        }
        let own = SIGNALS
            .iter()
            .filter(|signal| signal.vendor == Some(KOLLMORGEN))
            .count();
        assert_eq!(own, 10);
    }

    #[test]
    fn one_number_of_two_vendors() {
        assert_eq!(akd(352).setpoint.octets, 24);
        assert_eq!(Telegram::find(352, SIEMENS).unwrap().setpoint.octets, 12);
        assert_eq!(Telegram::find(354, SIEMENS), None);
        assert_eq!(Signal::find(102, KOLLMORGEN).unwrap().name, "IL_CMD_FIELDBUS");
        assert_eq!(Signal::find(102, SIEMENS).unwrap().name, "MELDW");
        assert_eq!(Signal::find(102, 0x01BA), None);
        assert_eq!(Signal::by_name("nsoll_a", 0).unwrap().number, signal::NSOLL_A);
    }

    #[test]
    fn word_maps() {
        let words = |image: &Image| image.words().collect::<Vec<_>>();
        assert_eq!(words(&akd(1).setpoint), [1, 5]);
        assert_eq!(words(&akd(9).setpoint), [1, 32, 3, 34, 34, 35, 35, 36, 37, 38]);
        assert_eq!(words(&akd(351).actual), [2, 6, 52, 28, 28]);
        assert_eq!(words(&akd(400).actual), [2, 33, 4, 28, 28, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(words(&akd(0).actual), []);
    }

    #[test]
    fn telegram_353_word_by_word() {
        let telegram = akd(353);
        let mut data = [0; 26];
        let values: [(u16, i64); 10] = [
            (signal::STW1, 0x043F),
            (signal::SATZANW, 0x8000),
            (signal::STW2, 0),
            (signal::MDI_TARPOS, -98_304),
            (signal::MDI_VELOCITY, 0xFFFF_FFFF),
            (signal::MDI_ACC, 65_535),
            (signal::MDI_DEC, 2),
            (signal::MDI_MOD, 1),
            (signal::kollmorgen::HOME_DIST, -1),
            (signal::kollmorgen::HOME_MODE, 7),
        ];
        for (signal, value) in values {
            telegram.setpoint.set(&mut data, signal, value).unwrap();
            assert_eq!(telegram.setpoint.get(&data, signal), Some(value));
        }
        assert_eq!(
            data,
            [
                0x04, 0x3F, 0x80, 0, 0, 0, 0xFF, 0xFE, 0x80, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0, 2, 0,
                1, 0xFF, 0xFF, 0xFF, 0xFF, 0, 7
            ]
        );
        assert_eq!(
            telegram.setpoint.position_of(signal::kollmorgen::HOME_MODE),
            Some(24)
        );
    }

    #[test]
    fn misuse_is_reported_and_changes_nothing() {
        let image = &akd(1).setpoint;
        let mut data = [0x55; 4];
        assert_eq!(
            image.set(&mut data, signal::NIST_A, 0),
            Err(SetError::NoSignal { signal: 6 })
        );
        assert_eq!(
            image.set(&mut data, signal::NSOLL_A, 32768),
            Err(SetError::Range {
                signal: "NSOLL_A",
                value: 32768,
                lowest: -32768,
                highest: 32767
            })
        );
        for length in 0..4 {
            let short = Err(SetError::Short { signal: "NSOLL_A" });
            assert_eq!(image.set(&mut data[..length], signal::NSOLL_A, 1), short);
            assert_eq!(image.get(&data[..length], signal::NSOLL_A), None);
        }
        assert_eq!(data, [0x55; 4]);
    }

    #[test]
    fn fields_follow_each_other_inside_the_length() {
        for telegram in &TELEGRAMS {
            for image in [&telegram.setpoint, &telegram.actual] {
                let mut end = 0;
                for field in image.fields {
                    assert!(field.offset >= end, "{}", telegram.number);
                    end = field.offset + field.signal.octets();
                }
                assert!(end <= image.octets);
            }
        }
    }

    proptest! {
        #[test]
        fn what_is_set_comes_back_and_nothing_else_changes(
            telegram in 0..TELEGRAMS.len(), setpoint: bool, field: prop::sample::Index, value: i64, fill: u8,
        ) {
            let telegram = &TELEGRAMS[telegram];
            let image = if setpoint { &telegram.setpoint } else { &telegram.actual };
            prop_assume!(!image.fields.is_empty());
            let field = &image.fields[field.index(image.fields.len())];
            let before = alloc::vec![fill; usize::from(image.octets)];
            let mut data = before.clone();
            let (lowest, highest) = field.signal.range();
            let fits = (lowest..=highest).contains(&value);
            prop_assert_eq!(image.set(&mut data, field.signal.number, value).is_ok(), fits);
            let place = usize::from(field.offset)..usize::from(field.offset + field.signal.octets());
            if fits {
                prop_assert_eq!(image.get(&data, field.signal.number), Some(value));
            }
            for (index, octet) in data.iter().enumerate() {
                prop_assert!(*octet == before[index] || (fits && place.contains(&index)));
            }
        }
    }
}
