//! One parameter of a model, and how its number on the wire becomes an engineering value.

use core::ops::RangeInclusive;

use crate::unit;
pub use crate::unit::akd::{Scale, Scaling};

/// How many octets a value has on the wire.
/// Source: AKD PROFINET manual 5.6, supported formats 0x41 to 0x43.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Size {
    /// One octet, format 0x41.
    Byte,
    /// Two octets, format 0x42.
    Word,
    /// Four octets, format 0x43.
    Dword,
    /// Has no value: writing anything executes it. Reads as the word 0.
    Command,
}

impl Size {
    /// Octets of one value; a command is written and read as a word.
    #[must_use]
    pub const fn octets(self) -> usize {
        match self {
            Self::Byte => 1,
            Self::Word | Self::Command => 2,
            Self::Dword => 4,
        }
    }

    /// Format code that carries the value: 0x41 byte, 0x42 word, 0x43 double word.
    #[must_use]
    pub const fn format_code(self) -> u8 {
        match self {
            Self::Byte => 0x41,
            Self::Word | Self::Command => 0x42,
            Self::Dword => 0x43,
        }
    }

    /// Numbers that fit.
    #[must_use]
    pub const fn range(self, signed: bool) -> RangeInclusive<i64> {
        let bits = 8 * self.octets() as u32;
        if signed {
            -(1 << (bits - 1))..=(1 << (bits - 1)) - 1
        } else {
            0..=(1 << bits) - 1
        }
    }
}

/// What may be done with a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Access {
    /// Can be read only; a write gets error 0x01.
    ReadOnly,
    /// Can be read and written.
    ReadWrite,
    /// A command: a write executes it.
    WriteOnly,
}

/// Text of one value of an enumeration, or of one bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Meaning {
    /// The value, or the number of the bit.
    pub value: i32,
    /// What it means.
    pub text: &'static str,
}

/// One parameter of a drive model.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Parameter number.
    pub pnu: u16,
    /// The maker's name, for example `DRV.ACC`; the profile's for numbers below 2000.
    pub name: &'static str,
    /// Size of one value.
    pub size: Size,
    /// Number of elements, 1 for a parameter that is no array.
    pub elements: u16,
    /// True when the number is two's complement.
    pub signed: bool,
    /// What may be done with it.
    pub access: Access,
    /// True when DRV.NVSAVE stores it.
    pub saved: bool,
    /// True when the next number is left free behind a double word: a 64-bit value cut to its low half.
    pub wide: bool,
    /// Unit of the engineering value, empty for a bare number.
    pub unit: &'static str,
    /// How the number on the wire is made.
    pub scale: Scale,
    /// Lowest engineering value where known.
    pub minimum: Option<f64>,
    /// Highest engineering value where known.
    pub maximum: Option<f64>,
    /// Engineering value as delivered where known.
    pub default: Option<f64>,
    /// Texts of the values of an enumeration, empty for other parameters.
    pub choices: &'static [Meaning],
    /// Texts of the bits of a bit field, empty for other parameters.
    pub bits: &'static [Meaning],
    /// What it is, in our words.
    pub description: &'static str,
    /// Where these facts are from.
    pub source: &'static str,
}

impl Parameter {
    /// True when it has more than one element.
    #[must_use]
    pub const fn is_array(&self) -> bool {
        self.elements > 1
    }

    /// The engineering value of a number from the wire.
    #[must_use]
    pub fn engineering(&self, raw: i64, scaling: &Scaling) -> f64 {
        scaling.linear(self.scale).engineering(raw)
    }

    /// The number on the wire for an engineering value: nearest, halves away from zero, cut to what fits the size.
    #[must_use]
    pub fn raw(&self, engineering: f64, scaling: &Scaling) -> i64 {
        let exact = scaling.linear(self.scale).exact(engineering);
        unit::nearest(exact, self.size.range(self.signed).into_inner()).value
    }

    /// Lowest and highest number on the wire: the limits where known, else what fits the size.
    #[must_use]
    pub fn raw_limits(&self, scaling: &Scaling) -> (i64, i64) {
        let range = self.size.range(self.signed);
        (
            self.minimum
                .map_or(*range.start(), |limit| self.raw(limit, scaling)),
            self.maximum
                .map_or(*range.end(), |limit| self.raw(limit, scaling)),
        )
    }

    /// The number on the wire as delivered; 0, or the nearest that the limits allow, where no default is known.
    #[must_use]
    pub fn raw_default(&self, scaling: &Scaling) -> i64 {
        let (low, high) = self.raw_limits(scaling);
        match self.default {
            Some(value) => self.raw(value, scaling),
            None => 0.clamp(low, high.max(low)),
        }
    }

    /// Text of a value of an enumeration.
    #[must_use]
    pub fn choice(&self, value: i64) -> Option<&'static str> {
        text(self.choices, value)
    }

    /// Text of a bit of a bit field.
    #[must_use]
    pub fn bit(&self, number: u8) -> Option<&'static str> {
        text(self.bits, i64::from(number))
    }

    /// Decimals that show every step of the value, at most six.
    #[must_use]
    pub const fn decimals(&self) -> u8 {
        match self.scale {
            Scale::Raw | Scale::Acceleration | Scale::Position => 0,
            Scale::Milli => 3,
            Scale::Velocity | Scale::Current => 3,
            Scale::Singleturn | Scale::MdiVelocity => 6,
        }
    }
}

fn text(meanings: &'static [Meaning], value: i64) -> Option<&'static str> {
    meanings
        .iter()
        .find(|meaning| i64::from(meaning.value) == value)
        .map(|meaning| meaning.text)
}

#[cfg(test)]
mod tests {
    use super::super::AKD;
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(Size::Byte.range(false), 0..=255);
        assert_eq!(Size::Word.range(true), -32768..=32767);
        assert_eq!(Size::Dword.range(false), 0..=4_294_967_295);
        assert_eq!((Size::Command.octets(), Size::Command.format_code()), (2, 0x42));
    }

    #[test]
    fn scales() {
        let scaling = Scaling::default();
        let value = |name: &str, raw| AKD.by_name(name).unwrap().engineering(raw, &scaling);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-3;
        assert!(near(value("NSOLL_A", 163), 59.678)); // manual 6.5
        assert!(near(value("ITIST_GLATT", -182), -0.09998)); // manual 5.12.4
        assert!(near(value("VL.FB_32", 59_678), 59.678));
        assert!(near(value("Jog Acc", 4), 3052.0));
        assert!(near(value("MDI_TARPOS", 98_304), 1.5)); // manual 5.12.2
        assert!(near(value("MDI_VELOCITY", 21_474_836), 60.0)); // manual 5.12.1
        assert!(near(value("PL.FB", 65_536), 65_536.0));
        let fine = Scaling {
            position: 1,
            ..scaling
        };
        assert!(near(
            AKD.by_name("PL.FB").unwrap().engineering(65_536, &fine),
            65.536
        ));
    }

    #[test]
    fn raw_numbers_round_and_stay_inside_the_size() {
        let scaling = Scaling::default();
        let raw = |name: &str, value| AKD.by_name(name).unwrap().raw(value, &scaling);
        assert_eq!(raw("NSOLL_A", 60.0), 164);
        assert_eq!(raw("NSOLL_A", -60.0), -164);
        assert_eq!(raw("NSOLL_A", 12_000.0), 32767);
        assert_eq!(raw("DRV.ACC", 1.86), 1860);
        assert_eq!(raw("DRV.ACC", 50e6), i64::from(u32::MAX));
        assert_eq!(raw("DRV.ACC", f64::NAN), 0);
        assert_eq!(raw("REGEN.TYPE", -1.0), -1);
    }
}
