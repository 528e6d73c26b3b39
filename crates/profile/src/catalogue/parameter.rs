//! One parameter of a model, and how its number on the wire becomes an engineering value.

use alloc::format;
use alloc::string::String;
use core::ops::RangeInclusive;

use crate::notation::{Position, Quantity, UnitMismatch};
use crate::parameter::{Attributes, Dialect, Format};
use crate::unit;
use crate::unit::Variable;
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
    /// Subindex of a parameter that is one element of a collecting parameter number: a Vacon has all its application
    /// ids as elements of PNU 10001. None for a parameter with a number of its own.
    pub base: Option<u16>,
    /// The vendor's name, for example `DRV.ACC`; the profile's where the vendor has none.
    pub name: &'static str,
    /// Size of one value; that of a string is [`length`](Self::length).
    pub size: Size,
    /// True type of one value, as a V4 code. A drive that answers with Byte, Word and Double word only shows the size of
    /// it; [`Format::in_space`] gives the code of drives with the older numbers.
    pub format: Format,
    /// Octets of a string (VisibleString, OctetString), 0 for a number.
    pub length: u16,
    /// Number of elements, 1 for a parameter that is not an array.
    pub elements: u16,
    /// True when the number is two's complement.
    pub signed: bool,
    /// What may be done with it.
    pub access: Access,
    /// True when the drive can keep it over a power cycle; how it is commanded to is a fact of the model.
    pub saved: bool,
    /// True for a 64-bit value: this number is its low half, the next number its high half. That the manual leaves the
    /// next number free is all that is known of it; which half is which is our reading.
    pub wide: bool,
    /// Unit of the engineering value, empty for a bare number; of a drive as delivered where [`user_unit`](Self::user_unit)
    /// is set.
    pub unit: &'static str,
    /// True for a position in the unit that the user chose with UNIT.PROTARY or UNIT.PLINEAR.
    pub user_unit: bool,
    /// How the number on the wire is made.
    pub scale: Scale,
    /// Physical size and conversion index as the drive describes them, [`Variable::NONE`] where it does not.
    pub variable: Variable,
    /// Lowest engineering value where known.
    pub minimum: Option<f64>,
    /// Highest engineering value where known.
    pub maximum: Option<f64>,
    /// Engineering value as delivered where known.
    pub default: Option<f64>,
    /// Text of a VisibleString as delivered, empty for other parameters.
    pub text: &'static str,
    /// Texts of the values of an enumeration, empty for other parameters.
    pub choices: &'static [Meaning],
    /// Texts of the bits of a bit field, empty for other parameters.
    pub bits: &'static [Meaning],
    /// What it is, in our words.
    pub description: &'static str,
    /// True where the row is from memory and no source was open when it was written: a lead, nothing to rely on octet by
    /// octet.
    pub recalled: bool,
    /// Where these facts are from.
    pub source: &'static str,
}

impl Parameter {
    /// Returns the format that its values are written in: its true type where drives of this dialect accept that, else
    /// its size.
    #[must_use]
    pub const fn format_in(&self, dialect: &Dialect) -> Format {
        if dialect.substitution_only {
            Format(self.size.format_code())
        } else {
            self.format.in_space(dialect.code_space)
        }
    }

    /// Returns the unit of the engineering value of a drive with this scaling.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, Scaling};
    /// use profidrive_profile::unit::UnitChoice;
    /// let degrees = UnitChoice { rotary_unit: 2, ..UnitChoice::DELIVERED };
    /// let scaling = Scaling { unit: degrees, ..Scaling::default() };
    /// assert_eq!(AKD.by_name("PL.FB").unwrap().unit_in(&scaling), "deg");
    /// assert_eq!(AKD.by_name("DRV.ACC").unwrap().unit_in(&scaling), "rpm/s");
    /// ```
    #[must_use]
    pub fn unit_in(&self, scaling: &Scaling) -> &'static str {
        if self.user_unit {
            scaling.unit.unit().symbol
        } else {
            self.unit
        }
    }

    /// Returns a value with whatever unit a person wrote in the unit that it has in a drive with this scaling: a
    /// position may be written in revolutions and angles too.
    ///
    /// # Errors
    /// When the unit written measures something else.
    pub fn quantity(&self, quantity: &Quantity, scaling: &Scaling) -> Result<f64, UnitMismatch> {
        let wanted = self.unit_in(scaling);
        let direct = quantity.in_unit(wanted);
        let unit = scaling.unit.unit();
        match (&direct, quantity.position()) {
            (Err(_), Ok(Position::Turns(turns))) if self.user_unit && unit.turns => {
                Ok(turns * unit.per_revolution)
            }
            _ => direct,
        }
    }

    /// Returns the facts that decide which requests for it are legal.
    #[must_use]
    pub fn attributes(&self) -> Attributes {
        let writable = self.access != Access::ReadOnly;
        let attributes = match (self.length, self.is_array()) {
            (0, array) => Attributes {
                elements: if array { self.elements } else { 0 },
                ..Attributes::simple(self.format, self.size.octets(), writable)
            },
            (length, false) => Attributes::string(length, writable),
            (length, true) => Attributes::strings(self.elements, length, writable),
        };
        Attributes {
            format: self.format,
            first: self.base.unwrap_or(0),
            ..attributes
        }
    }

    /// Returns true when its value is characters.
    #[must_use]
    pub const fn is_text(&self) -> bool {
        self.format.0 == Format::VISIBLE_STRING.0
    }

    /// Returns the subindex of an element on the wire.
    #[must_use]
    pub const fn subindex(&self, element: u16) -> u16 {
        match self.base {
            Some(base) => base.saturating_add(element),
            None => element,
        }
    }

    /// Returns true when it has more than one element.
    #[must_use]
    pub const fn is_array(&self) -> bool {
        self.elements > 1
    }

    /// Returns the number of the high half of a 64-bit value.
    #[must_use]
    pub const fn high(&self) -> Option<u16> {
        if self.wide { self.pnu.checked_add(1) } else { None }
    }

    /// Octets of the whole value: eight for a 64-bit value, its length for a string.
    #[must_use]
    pub const fn octets(&self) -> usize {
        match (self.wide, self.length) {
            (true, _) => 8,
            (false, 0) => self.size.octets(),
            (false, length) => length as usize,
        }
    }

    /// Numbers that fit: those of the size, or of both halves of a 64-bit value (without sign up to 2^63 - 1).
    #[must_use]
    pub const fn range(&self) -> RangeInclusive<i64> {
        match (self.wide, self.signed) {
            (false, signed) => self.size.range(signed),
            (true, true) => i64::MIN..=i64::MAX,
            (true, false) => 0..=i64::MAX,
        }
    }

    /// Returns the whole number of a 64-bit value out of its halves.
    #[must_use]
    pub const fn whole(&self, high: u32, low: u32) -> i64 {
        let whole = ((high as u64) << 32 | low as u64).cast_signed();
        // Without sign the upper half of the numbers is not used.
        if whole < 0 && !self.signed {
            i64::MAX
        } else {
            whole
        }
    }

    /// Returns the value of the low half of a 64-bit value, with the sign of the parameter.
    #[must_use]
    pub const fn low_word(&self, low: u32) -> i64 {
        if self.signed {
            low.cast_signed() as i64
        } else {
            low as i64
        }
    }

    /// Returns the engineering value of a number from the wire.
    #[must_use]
    pub fn engineering(&self, raw: i64, scaling: &Scaling) -> f64 {
        scaling.linear(self.scale).engineering(raw)
    }

    /// Returns the number on the wire for an engineering value: nearest, halves away from zero, cut to what fits.
    #[must_use]
    pub fn raw(&self, engineering: f64, scaling: &Scaling) -> i64 {
        let exact = scaling.linear(self.scale).exact(engineering);
        unit::nearest(exact, self.range().into_inner()).value
    }

    /// Lowest and highest engineering value where known, in the unit of a drive with this scaling.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, Scaling};
    /// use profidrive_profile::unit::UnitChoice;
    /// let limit = AKD.by_name("SWLS.LIMIT1").unwrap();
    /// let degrees = UnitChoice { rotary_unit: 2, ..UnitChoice::DELIVERED };
    /// let scaling = Scaling { unit: degrees, ..Scaling::default() };
    /// assert_eq!(limit.limits_in(&scaling).1, limit.maximum.map(|counts| counts / 65_536.0 * 360.0));
    /// assert_eq!(limit.limits_in(&Scaling::default()).1, limit.maximum);
    /// ```
    #[must_use]
    pub fn limits_in(&self, scaling: &Scaling) -> (Option<f64>, Option<f64>) {
        let factor = self.per_delivered(scaling);
        (
            self.minimum.map(|limit| limit * factor),
            self.maximum.map(|limit| limit * factor),
        )
    }

    /// Returns the engineering value as delivered, in the unit of a drive with this scaling.
    #[must_use]
    pub fn default_in(&self, scaling: &Scaling) -> Option<f64> {
        self.default.map(|value| value * self.per_delivered(scaling))
    }

    /// Returns the factor from the unit of the tables to the unit in force.
    fn per_delivered(&self, scaling: &Scaling) -> f64 {
        if self.user_unit {
            scaling.unit.unit().per_revolution / unit::UnitChoice::DELIVERED.unit().per_revolution
        } else {
            1.0
        }
    }

    /// Lowest and highest number on the wire: the limits where known, else what fits. A limit between two numbers is the
    /// one inside.
    #[must_use]
    pub fn raw_limits(&self, scaling: &Scaling) -> (i64, i64) {
        let range = self.range();
        let of = |limit: Option<f64>, otherwise: i64, upwards: bool| match limit {
            Some(limit) => self.raw_limit(limit, upwards, scaling),
            None => otherwise,
        };
        let (minimum, maximum) = self.limits_in(scaling);
        (
            of(minimum, *range.start(), true),
            of(maximum, *range.end(), false),
        )
    }

    /// Returns the number on the wire of a limit: the next one inside, `upwards` for a lowest value; cut to what fits.
    #[must_use]
    pub fn raw_limit(&self, engineering: f64, upwards: bool, scaling: &Scaling) -> i64 {
        let exact = scaling.linear(self.scale).exact(engineering);
        unit::inside(exact, upwards, self.range().into_inner())
    }

    /// Returns the number on the wire as delivered; 0, or the nearest that the limits allow, where no default is known.
    #[must_use]
    pub fn raw_default(&self, scaling: &Scaling) -> i64 {
        let (low, high) = self.raw_limits(scaling);
        match self.default {
            Some(value) => self.raw(value, scaling),
            None => 0.clamp(low, high.max(low)),
        }
    }

    /// Returns the rule by which the number on the wire is made, for people: `raw 1000 = 1 rpm/s`.
    ///
    /// One rule for each parameter: positions by PN.POSSCALE, signals as the manual has them, other floats 1000:1, whole
    /// numbers as they are. Where a value of the drive takes part in the rule, its name stands behind.
    #[must_use]
    pub fn rule(&self, scaling: &Scaling) -> String {
        let bits = scaling.singleturn_bits.min(32);
        let (steps, by) = match self.scale {
            Scale::Raw => (1, String::new()),
            Scale::Milli => (1000, String::new()),
            Scale::Position => (
                if scaling.position < 1000 { 1000 } else { 1 },
                format!(", PN.POSSCALE {}", scaling.position),
            ),
            Scale::Velocity => match scaling.reference {
                Some(_) => (1 << 14, String::from(", which is the reference")),
                None => (1, format!(", PN.VELSCALING {}", scaling.velocity)),
            },
            Scale::Acceleration => (1, format!(", PN.ACCSCALING {}", scaling.acceleration)),
            Scale::Current => (1 << 14, String::from(", which is DRV.IPEAK")),
            Scale::Singleturn => (1_i64 << bits, format!(", PNU 1002 {bits}")),
            Scale::MdiVelocity => (1_i64 << 32, String::new()),
            Scale::NominalVelocity => (1, String::new()),
            Scale::Decimal(exponent) => (
                10_i64.pow(exponent.min(0).unsigned_abs().min(18).into()),
                String::new(),
            ),
            Scale::Percent => (1 << 14, String::new()),
        };
        let value = format!("{:.6}", self.engineering(steps, scaling));
        let value = value.trim_end_matches('0').trim_end_matches('.');
        let symbol = self.unit_in(scaling);
        let unit = if symbol.is_empty() { "" } else { " " };
        format!("raw {steps} = {value}{unit}{symbol}{by}")
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
            Scale::Raw | Scale::Acceleration | Scale::Position | Scale::Decimal(0..) => 0,
            Scale::Decimal(..-5) => 6,
            Scale::Decimal(exponent) => exponent.unsigned_abs(),
            Scale::Milli => 3,
            Scale::Velocity | Scale::NominalVelocity | Scale::Current | Scale::Percent => 3,
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

    /// Manual 6.2; a position without a printed type is taken as its sibling.
    #[test]
    fn which_positions_of_an_akd_are_scaled() {
        for (names, scale) in [
            (
                &["HOME.DIST", "HOME.MAXDIST", "HOME.P", "PL.FB"][..],
                Scale::Position,
            ),
            (&["FB1.POFFSET", "FB2.POFFSET", "FB3.POFFSET"], Scale::Raw),
            (&["PLS.P1", "PLS.WIDTH1", "PLS.P8", "PLS.WIDTH8"], Scale::Raw),
        ] {
            for name in names {
                assert_eq!(AKD.by_name(name).unwrap().scale, scale, "{name}");
            }
        }
    }

    #[test]
    fn sizes() {
        assert_eq!(Size::Byte.range(false), 0..=255);
        assert_eq!(Size::Word.range(true), -32768..=32767);
        assert_eq!(Size::Dword.range(false), 0..=4_294_967_295);
        assert_eq!((Size::Command.octets(), Size::Command.format_code()), (2, 0x42));
    }

    #[test]
    fn wide_values_have_two_numbers() {
        let limit = AKD.by_name("SWLS.LIMIT1").unwrap();
        assert_eq!((limit.high(), limit.range()), (Some(2386), i64::MIN..=i64::MAX));
        assert_eq!(limit.raw_default(&Scaling::default()), 1 << 36);
        assert_eq!((limit.whole(0x10, 0), limit.low_word(0xFFFF_FFFF)), (1 << 36, -1));
        let stop = AKD.by_name("CS.DEC").unwrap();
        assert_eq!((stop.wide, stop.signed), (true, false));
        assert_eq!(
            (stop.whole(u32::MAX, 0), stop.low_word(u32::MAX)),
            (i64::MAX, 0xFFFF_FFFF)
        );
        assert_eq!(AKD.by_name("DRV.OPMODE").unwrap().high(), None);
    }

    #[test]
    fn limits_between_two_numbers_lie_inside() {
        let limits = |name: &str| AKD.by_name(name).unwrap().raw_limits(&Scaling::default());
        assert_eq!(limits("MOTOR.CTF0"), (1, 16_000)); // 0.265 in whole numbers
        assert_eq!(limits("DRV.DEC"), (1860, 50_000_000_000));
        for parameter in AKD.parameters {
            let (low, high) = parameter.raw_limits(&Scaling::default());
            let value = |raw| parameter.engineering(raw, &Scaling::default());
            assert!(
                parameter.minimum.is_none_or(|limit| value(low) >= limit - 1e-9),
                "{parameter:?}"
            );
            let fits = |limit: f64| value(high) <= limit + 1e-9 * limit.abs();
            assert!(parameter.maximum.is_none_or(fits), "{parameter:?}");
        }
    }

    #[test]
    fn every_rule_is_described() {
        let fine = Scaling {
            position: 1,
            ..Scaling::default()
        };
        for (name, rule) in [
            ("DRV.ACC", "raw 1000 = 1 rpm/s"),
            ("DRV.OPMODE", "raw 1 = 1"),
            ("VBUS.VALUE", "raw 1 = 1 V"),
            ("PL.FB", "raw 1000 = 1 counts, PN.POSSCALE 1"),
            ("NSOLL_A", "raw 1 = 0.366122 rpm, PN.VELSCALING 1638"),
            ("MDI_ACC", "raw 1 = 763 rpm/s, PN.ACCSCALING 763"),
            ("ITIST_GLATT", "raw 16384 = 9 A, which is DRV.IPEAK"),
            ("MDI_TARPOS", "raw 65536 = 1 rev, PNU 1002 16"),
            ("MDI_VELOCITY", "raw 4294967296 = 12000 rpm"),
        ] {
            assert_eq!(AKD.by_name(name).unwrap().rule(&fine), rule);
        }
        let parameter = AKD.by_name("PL.FB").unwrap();
        assert_eq!(
            parameter.rule(&Scaling::default()),
            "raw 1 = 1 counts, PN.POSSCALE 1000"
        );
        // The rule and the conversion are one: the conversion has to follow the rule.
        for parameter in AKD.parameters {
            let rule = parameter.rule(&fine);
            let words: alloc::vec::Vec<&str> = rule.split([' ', ',']).collect();
            let (raw, value): (i64, f64) = (words[1].parse().unwrap(), words[3].parse().unwrap());
            assert!((parameter.engineering(raw, &fine) - value).abs() < 1e-6, "{rule}");
        }
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
        assert_eq!(raw("DRV.ACC", 50e6), 50_000_000_000); // two numbers
        assert_eq!(raw("DRV.IPEAK", 50e6), i64::from(i32::MAX));
        assert_eq!(raw("DRV.ACC", f64::NAN), 0);
        assert_eq!(raw("REGEN.TYPE", -1.0), -1);
    }
}
