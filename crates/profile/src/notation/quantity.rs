//! A value with its unit, as written by a person.

use alloc::string::{String, ToString};
use core::fmt;
use core::str::FromStr;

use super::units::{Dimension, Unit, unit_named, units_of};

/// A number as written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// Hexadecimal (`0x047F`) or binary (`0b1011`): the raw value as it travels, never converted.
    Raw(u64),
    /// Without decimal point.
    Integer(i64),
    /// With decimal point or exponent.
    Decimal(f64),
}

impl Number {
    /// As a float; integers above 2^53 lose their last digits.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "stated in the documentation")]
    pub const fn as_f64(self) -> f64 {
        match self {
            Self::Raw(raw) => raw as f64,
            Self::Integer(integer) => integer as f64,
            Self::Decimal(decimal) => decimal,
        }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Raw(raw) => write!(f, "0x{raw:04X}"),
            Self::Integer(integer) => write!(f, "{integer}"),
            Self::Decimal(decimal) => write!(f, "{decimal}"),
        }
    }
}

/// A number with the unit written behind it, if any.
///
/// ```
/// use profidrive_profile::notation::Quantity;
/// let speed: Quantity = "1.5 rps".parse()?;
/// assert_eq!(speed.in_unit("rpm")?, 90.0);
/// let bare: Quantity = "90".parse()?;
/// assert_eq!(bare.in_unit("rpm")?, 90.0);
/// assert!("2s".parse::<Quantity>()?.in_unit("rpm").is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// The number.
    pub number: Number,
    /// The unit as written, without spaces around it.
    pub unit: Option<String>,
}

/// Why a text is not a value.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum QuantityError {
    /// Nothing there.
    #[error(
        "no value given: write a number, with its unit if you like (50rpm, 2s, 0x047F), or \"\" for an empty text"
    )]
    Empty,
    /// Does not start with a number.
    #[error("`{text}` does not start with a number (50rpm, -1.5A, 0x047F)")]
    NoNumber {
        /// The text as given.
        text: String,
    },
    /// A number that no parameter can hold.
    #[error("`{text}`: the number is too large")]
    TooLarge {
        /// The text as given.
        text: String,
    },
    /// A raw number cannot have a unit.
    #[error("`{text}`: a hexadecimal or binary number is the raw value and takes no unit")]
    RawWithUnit {
        /// The text as given.
        text: String,
    },
}

/// The given unit does not fit the expected one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnitMismatch {
    /// The unit as written.
    pub given: String,
    /// What it measures, if it is a unit at all.
    pub given_dimension: Option<Dimension>,
    /// The expected unit; empty when the value has none.
    pub wanted: String,
}

impl fmt::Display for UnitMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.given_dimension {
            Some(dimension) => write!(f, "`{}` is a unit of {dimension}", self.given)?,
            None => write!(f, "`{}` is not a known unit", self.given)?,
        }
        if self.wanted.is_empty() {
            return f.write_str("; this value has no unit, write the bare number");
        }
        f.write_str("; accepted: ")?;
        match unit_named(&self.wanted) {
            None => write!(f, "{}", self.wanted)?,
            Some(wanted) => {
                for (at, unit) in units_of(wanted.dimension).enumerate() {
                    write!(f, "{}{}", if at == 0 { "" } else { ", " }, unit.symbol)?;
                }
            }
        }
        write!(f, ", or a bare number in {}", self.wanted)
    }
}

impl core::error::Error for UnitMismatch {}

impl Quantity {
    /// Returns the number in `wanted` (empty for a value without unit). A bare number is in `wanted` already.
    ///
    /// # Errors
    /// When the unit written measures something else.
    pub fn in_unit(&self, wanted: &str) -> Result<f64, UnitMismatch> {
        let number = self.number.as_f64();
        let Some(given) = &self.unit else {
            return Ok(number);
        };
        if given == wanted {
            return Ok(number);
        }
        let from = unit_named(given);
        match (from, unit_named(wanted)) {
            (Some(from), Some(to)) if from.dimension == to.dimension => Ok(convert(number, from, to)),
            _ => Err(UnitMismatch {
                given: given.clone(),
                given_dimension: from.map(|unit| unit.dimension),
                wanted: wanted.to_string(),
            }),
        }
    }

    /// Returns the number in Hz where it was written with a unit of frequency; `None` for any other and for a bare number.
    ///
    /// ```
    /// use profidrive_profile::notation::Quantity;
    /// assert_eq!("0.025kHz".parse::<Quantity>()?.in_hertz(), Some(25.0));
    /// assert_eq!("25".parse::<Quantity>()?.in_hertz(), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn in_hertz(&self) -> Option<f64> {
        self.unit.as_ref()?;
        self.in_unit("Hz").ok()
    }

    /// Returns the raw number where it was written as such (`0x047F`).
    #[must_use]
    pub const fn raw(&self) -> Option<u64> {
        match self.number {
            Number::Raw(raw) => Some(raw),
            _ => None,
        }
    }
}

/// Multiplies by whole ratios where there is one, so that `2s` is exactly 2000 ms.
fn convert(number: f64, from: &Unit, to: &Unit) -> f64 {
    if from.factor >= to.factor {
        number * whole(from.factor / to.factor)
    } else {
        number / whole(to.factor / from.factor)
    }
}

/// `ratio`, moved to the whole number it misses by a rounding error only.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "ratios of the table are below 1e13"
)]
fn whole(ratio: f64) -> f64 {
    let nearest = (ratio + 0.5) as i64 as f64;
    let miss = if nearest > ratio {
        nearest - ratio
    } else {
        ratio - nearest
    };
    if miss < ratio * 1e-12 { nearest } else { ratio }
}

impl FromStr for Quantity {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let text = text.trim();
        if text.is_empty() {
            return Err(QuantityError::Empty);
        }
        if let Some((digits, radix)) = text
            .strip_prefix("0x")
            .or_else(|| text.strip_prefix("0X"))
            .map(|digits| (digits, 16))
            .or_else(|| text.strip_prefix("0b").map(|digits| (digits, 2)))
        {
            return raw(text, digits, radix);
        }
        let end = number_end(text);
        let (number, unit) = text.split_at(end);
        let no_number = || QuantityError::NoNumber {
            text: text.to_string(),
        };
        if !number.bytes().any(|b| b.is_ascii_digit()) {
            return Err(no_number());
        }
        let parsed = if number
            .bytes()
            .all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-'))
        {
            Number::Integer(number.parse().map_err(|_| QuantityError::TooLarge {
                text: text.to_string(),
            })?)
        } else {
            let decimal: f64 = number.parse().map_err(|_| no_number())?;
            if !decimal.is_finite() {
                return Err(QuantityError::TooLarge {
                    text: text.to_string(),
                });
            }
            Number::Decimal(decimal)
        };
        let unit = unit.trim();
        Ok(Self {
            number: parsed,
            unit: (!unit.is_empty()).then(|| unit.to_string()),
        })
    }
}

fn raw(text: &str, digits: &str, radix: u32) -> Result<Quantity, QuantityError> {
    let end = digits
        .find(|c: char| !(c.is_digit(radix) || c == '_'))
        .unwrap_or(digits.len());
    let (number, rest) = digits.split_at(end);
    if !rest.trim().is_empty() {
        return Err(QuantityError::RawWithUnit {
            text: text.to_string(),
        });
    }
    let compact: String = number.chars().filter(|&c| c != '_').collect();
    if compact.is_empty() {
        return Err(QuantityError::NoNumber {
            text: text.to_string(),
        });
    }
    let raw = u64::from_str_radix(&compact, radix).map_err(|_| QuantityError::TooLarge {
        text: text.to_string(),
    })?;
    Ok(Quantity {
        number: Number::Raw(raw),
        unit: None,
    })
}

/// Returns the end of the decimal number at the start of `text`. An `e` belongs to it only when digits follow.
fn number_end(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let sign = |at: usize| at + usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let mut end = digits(sign(0));
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let start = sign(end + 1);
        let exponent = digits(start);
        if exponent > start {
            end = exponent;
        }
    }
    end
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.number.fmt(f)?;
        self.unit.as_ref().map_or(Ok(()), |unit| write!(f, " {unit}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Quantity {
        text.parse().unwrap()
    }

    #[test]
    fn numbers_and_units() {
        assert_eq!(
            read("50rpm"),
            Quantity {
                number: Number::Integer(50),
                unit: Some("rpm".into())
            }
        );
        assert_eq!(
            read(" 10000 rpm/s "),
            Quantity {
                number: Number::Integer(10000),
                unit: Some("rpm/s".into())
            }
        );
        assert_eq!(read("1.5A").number, Number::Decimal(1.5));
        assert_eq!(read("-.5").number, Number::Decimal(-0.5));
        assert_eq!(
            read("0x047F"),
            Quantity {
                number: Number::Raw(0x47F),
                unit: None
            }
        );
        assert_eq!(read("0b0000_0100_0111_1111").number, Number::Raw(0x47F));
        assert_eq!(read("1e3").number, Number::Decimal(1000.0));
        assert_eq!(read("3e").unit.as_deref(), Some("e"));
        assert_eq!(read("-20°C").unit.as_deref(), Some("°C"));
    }

    #[test]
    fn conversion_within_a_dimension() {
        for (text, unit, value) in [
            ("2s", "ms", 2000.0),
            ("16ms", "s", 0.016),
            ("1rps", "rpm", 60.0),
            ("360deg/s", "rpm", 60.0),
            ("100 rps/s", "rpm/s", 6000.0),
            ("1500mA", "A", 1.5),
            ("7kHz", "Hz", 7000.0),
            ("0.5", "A", 0.5),
            ("3counts/V", "counts/V", 3.0),
        ] {
            assert_eq!(read(text).in_unit(unit), Ok(value), "{text}");
        }
        let rad = read("6.283185307179586rad/s").in_unit("rpm").unwrap();
        assert!((rad - 60.0).abs() < 1e-9, "{rad}");
    }

    #[test]
    fn wrong_unit_names_the_right_ones() {
        let error = read("5A").in_unit("rpm/s").unwrap_err().to_string();
        assert_eq!(
            error,
            "`A` is a unit of current; accepted: rpm/s, rps/s, rad/s^2, deg/s^2, or a bare number in rpm/s"
        );
        let error = read("5parsec").in_unit("").unwrap_err().to_string();
        assert_eq!(
            error,
            "`parsec` is not a known unit; this value has no unit, write the bare number"
        );
        let error = read("5A").in_unit("counts/V").unwrap_err().to_string();
        assert_eq!(
            error,
            "`A` is a unit of current; accepted: counts/V, or a bare number in counts/V"
        );
    }

    #[test]
    fn mistakes_are_explained() {
        for (text, words) in [
            ("", "no value"),
            ("fast", "does not start with a number"),
            ("-", "does not start with a number"),
            ("0x", "does not start with a number"),
            ("0x10rpm", "takes no unit"),
            ("0x1FFFFFFFFFFFFFFFF", "too large"),
            ("99999999999999999999", "too large"),
            ("1e999", "too large"),
        ] {
            let error = text.parse::<Quantity>().unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    proptest! {
        #[test]
        fn printed_form_reads_back(integer: i64, decimal in -1e12f64..1e12) {
            for number in [Number::Integer(integer), Number::Decimal(decimal + 0.5)] {
                let quantity = Quantity { number, unit: Some("rpm".into()) };
                prop_assert_eq!(read(&quantity.to_string()).number.as_f64(), quantity.number.as_f64());
            }
        }

        #[test]
        fn any_text_gives_an_answer(text in ".{0,24}") {
            let _ = text.parse::<Quantity>();
        }
    }
}
