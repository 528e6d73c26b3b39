//! Numbers on the wire and what they mean: N2, N4, X2, X4, E2, C4, time constants, and the scalings of drives.
//!
//! Source: profile 6.2 by way of Eaton MN040062EN p. 61, Eaton DS7 p. 202, TR-Electronic encoTRive p. 195 and Danfoss
//! MG33C402 p. 81. The formulas of T2, T4, D2, R2, E2, X2 and X4 are common knowledge, no public table was at hand.
//!
//! A conversion to the wire takes the nearest number, halves away from zero, and reports a value that does not fit: it
//! is never cut without a word. A conversion from the wire is exact as far as `f64` goes, which it does for all types
//! here.
//!
//! ```
//! use profidrive_profile::unit::{Linear, akd};
//! use profidrive_profile::catalogue::Scaling;
//! assert_eq!(Linear::N2.engineering(0x4000), 100.0);
//! assert_eq!(Linear::N2.raw(-100.0).value, -0x4000);
//! let speed = akd::velocity(&Scaling::default());
//! assert_eq!(speed.raw(60.0).value, 164);
//! assert!(speed.raw(12_000.0).saturated); // 32768 does not fit a signed word
//! assert!(speed.raw(12_000.0).checked().is_err());
//! ```

pub mod akd;
mod conversion;
mod position;
mod time;

pub use conversion::{ConversionIndex, PhysicalSize, QUANTITIES, Variable};
pub use position::{PositionUnit, UnitChoice};
pub use time::Reciprocal;

use thiserror::Error;

/// Size and sign of a number on the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Width {
    /// Word, two's complement.
    I16,
    /// Word.
    U16,
    /// Double word, two's complement.
    I32,
    /// Double word.
    U32,
}

impl Width {
    /// Lowest and highest number.
    #[must_use]
    pub const fn range(self) -> (i64, i64) {
        match self {
            Self::I16 => (i16::MIN as i64, i16::MAX as i64),
            Self::U16 => (0, u16::MAX as i64),
            Self::I32 => (i32::MIN as i64, i32::MAX as i64),
            Self::U32 => (0, u32::MAX as i64),
        }
    }
}

/// A number for the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Raw {
    /// The nearest number that fits.
    pub value: i64,
    /// The value requested does not fit (or is not a number at all), `value` is the nearest end of the range.
    pub saturated: bool,
}

/// A value does not fit its type on the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("the value does not fit, the nearest possible number is {nearest}")]
pub struct DoesNotFit {
    /// Nearest number that fits.
    pub nearest: i64,
}

impl Raw {
    /// Returns the number, or an error when it had to be cut.
    ///
    /// # Errors
    /// The value requested does not fit.
    pub const fn checked(self) -> Result<i64, DoesNotFit> {
        if self.saturated {
            Err(DoesNotFit { nearest: self.value })
        } else {
            Ok(self.value)
        }
    }
}

/// A conversion with a constant factor: engineering value = raw number times `multiplier` / `divisor`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    multiplier: f64,
    divisor: f64,
    width: Width,
}

impl Linear {
    /// N2 in percent: 2^14 is 100 %, -200 % to just below 200 %.
    pub const N2: Self = Self::normalised(100.0, 14, Width::I16);
    /// N4 in percent: 2^30 is 100 %.
    pub const N4: Self = Self::normalised(100.0, 30, Width::I32);
    /// E2: steps of 2^-7, -256 to just below 256.
    pub const E2: Self = Self::normalised(1.0, 7, Width::I16);
    /// C4: steps of 0.0001.
    pub const C4: Self = Self::decimal(-4, Width::I32);
    /// Time difference in seconds: 2^32 is one day. Source: Eaton DS7 p. 202, where 100 ms is 4971.
    pub const TIME_DIFFERENCE: Self = Self::normalised(86_400.0, 32, Width::U32);

    /// `reference` is 2^`bit`. Bits above 62 count as 62.
    #[must_use]
    pub const fn normalised(reference: f64, bit: u8, width: Width) -> Self {
        let bit = if bit > 62 { 62 } else { bit };
        Self {
            multiplier: reference,
            divisor: (1_u64 << bit) as f64,
            width,
        }
    }

    /// `value` is the raw number 1.
    #[must_use]
    pub const fn step(value: f64, width: Width) -> Self {
        Self {
            multiplier: value,
            divisor: 1.0,
            width,
        }
    }

    /// Returns the raw number times 10^`index`, as defined by the conversion index of Danfoss; at most 22 either way.
    #[must_use]
    pub const fn decimal(index: i8, width: Width) -> Self {
        let mut power = 1.0;
        let mut left = if index.unsigned_abs() > 22 {
            22
        } else {
            index.unsigned_abs()
        };
        while left > 0 {
            power *= 10.0;
            left -= 1;
        }
        let (multiplier, divisor) = if index < 0 { (1.0, power) } else { (power, 1.0) };
        Self {
            multiplier,
            divisor,
            width,
        }
    }

    /// X2 in percent: 2^`bit` is 100 %. The bit stands in element 12 of the parameter description.
    #[must_use]
    pub const fn x2(bit: u8) -> Self {
        Self::normalised(100.0, bit, Width::I16)
    }

    /// X4 in percent: 2^`bit` is 100 %.
    #[must_use]
    pub const fn x4(bit: u8) -> Self {
        Self::normalised(100.0, bit, Width::I32)
    }

    /// T2: a multiple of the sampling time (PNU 962), in the unit of that.
    #[must_use]
    pub const fn t2(sampling: f64) -> Self {
        Self::step(sampling, Width::U16)
    }

    /// T4: as T2 in a double word.
    #[must_use]
    pub const fn t4(sampling: f64) -> Self {
        Self::step(sampling, Width::U32)
    }

    /// D2: a fraction of the sampling time (PNU 962), 2^14 is all of it.
    #[must_use]
    pub const fn d2(sampling: f64) -> Self {
        Self::normalised(sampling, 14, Width::U16)
    }

    /// Size and sign on the wire.
    #[must_use]
    pub const fn width(&self) -> Width {
        self.width
    }

    /// Returns the engineering value of a number from the wire.
    #[must_use]
    pub const fn engineering(&self, raw: i64) -> f64 {
        raw as f64 * self.multiplier / self.divisor
    }

    /// Returns the number for the wire: nearest, halves away from zero. Not-a-number gives 0, marked as saturated.
    #[must_use]
    pub const fn raw(&self, engineering: f64) -> Raw {
        nearest(self.exact(engineering), self.width.range())
    }

    /// Returns the number for the wire before it is rounded and cut.
    pub(crate) const fn exact(&self, engineering: f64) -> f64 {
        engineering * self.divisor / self.multiplier
    }

    /// Lowest and highest engineering value that the wire can carry.
    #[must_use]
    pub const fn range(&self) -> (f64, f64) {
        let (lowest, highest) = self.width.range();
        (self.engineering(lowest), self.engineering(highest))
    }
}

/// Nearest whole number from `lowest` to `highest`, halves away from zero.
pub(crate) const fn nearest(exact: f64, (lowest, highest): (i64, i64)) -> Raw {
    let whole = exact as i64; // towards zero, ends of the range at overflow, 0 for not-a-number
    let rest = exact - whole as f64;
    let rounded = if rest >= 0.5 {
        whole.saturating_add(1)
    } else if rest <= -0.5 {
        whole.saturating_sub(1)
    } else {
        whole
    };
    let value = if rounded < lowest {
        lowest
    } else if rounded > highest {
        highest
    } else {
        rounded
    };
    Raw {
        value,
        saturated: value != rounded || exact.is_nan(),
    }
}

/// Returns the step that a limit allows: a limit between two steps is the one inside, so upwards for a lowest and
/// downwards for a highest value. What differs from a step by the arithmetic only is that step.
pub(crate) const fn inside(exact: f64, upwards: bool, range: (i64, i64)) -> i64 {
    const NEAR: f64 = 1e-6;
    let step = nearest(exact, range).value;
    let over = exact - step as f64;
    let (lowest, highest) = range;
    if upwards && over > NEAR && step < highest {
        step + 1
    } else if !upwards && over < -NEAR && step > lowest {
        step - 1
    } else {
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn n2_examples() {
        for (raw, percent) in [
            (0x4000, 100.0),
            (-0x4000, -100.0),
            (0x7FFF, 199.993_896_484_375),
            (-0x8000, -200.0),
            (1, 0.006_103_515_625),
        ] {
            assert_eq!(Linear::N2.engineering(raw), percent);
            assert_eq!(
                Linear::N2.raw(percent),
                Raw {
                    value: raw,
                    saturated: false
                }
            );
        }
        assert_eq!(
            Linear::N2.raw(200.0).checked(),
            Err(DoesNotFit { nearest: 0x7FFF })
        );
        assert_eq!(Linear::N2.range().0, -200.0);
    }

    #[test]
    fn other_types() {
        assert_eq!(Linear::N4.raw(100.0).value, 0x4000_0000);
        assert_eq!(Linear::x2(12).raw(100.0).value, 0x1000);
        assert_eq!(Linear::x4(28).engineering(0x0800_0000), 50.0);
        assert_eq!(Linear::E2.engineering(192), 1.5);
        assert_eq!(Linear::E2.range(), (-256.0, 256.0 - 0.007_812_5));
        assert_eq!(Linear::C4.engineering(1_234_567), 123.4567);
        assert_eq!(Linear::C4.raw(123.4567).value, 1_234_567);
        assert_eq!(Linear::t2(0.001).engineering(100), 0.1);
        assert_eq!(Linear::t4(1.0).raw(70_000.0).value, 70_000);
        assert_eq!(Linear::d2(4.0).engineering(16_384), 4.0);
        assert_eq!(Linear::TIME_DIFFERENCE.raw(0.1).value, 4971);
        assert_eq!(Linear::decimal(2, Width::U16).engineering(15), 1500.0);
        assert_eq!(Linear::decimal(-2, Width::U16).raw(50.0).value, 0x1388); // Vacon 50.00 Hz
        assert_eq!(Linear::C4.raw(50.0).value, 0x0007_A120); // Vacon 100 50.0000 Hz
    }

    #[test]
    fn halves_go_away_from_zero_and_nothing_else_does() {
        let one = Linear::step(1.0, Width::I16);
        for (value, raw) in [
            (0.5, 1),
            (-0.5, -1),
            (1.5, 2),
            (2.5, 3),
            (-2.5, -3),
            (0.499_999_999_999_999_94, 0),
        ] {
            assert_eq!(one.raw(value).value, raw, "{value}");
        }
        assert_eq!(one.raw(32_767.499).checked(), Ok(32_767));
        assert_eq!(one.raw(32_767.5).checked(), Err(DoesNotFit { nearest: 32_767 }));
        assert_eq!(one.raw(-32_768.5).checked(), Err(DoesNotFit { nearest: -32_768 }));
    }

    #[test]
    fn limits_lie_inside() {
        let range = (-100, 100);
        for (exact, lowest, highest) in [
            (0.265, 1, 0),
            (0.999_999_9, 1, 1),
            (1.000_000_1, 1, 1),
            (-0.5, 0, -1),
            (-7.25, -7, -8),
            (7.0, 7, 7),
            (100.5, 100, 100),
            (1e30, 100, 100),
            (-1e30, -100, -100),
        ] {
            assert_eq!(
                (inside(exact, true, range), inside(exact, false, range)),
                (lowest, highest),
                "{exact}"
            );
        }
    }

    #[test]
    fn text_that_is_not_a_number_is_rejected() {
        let (low, high) = (Linear::N4.raw(f64::NEG_INFINITY), Linear::N4.raw(f64::INFINITY));
        assert!(low.saturated && high.saturated);
        assert_eq!((low.value, high.value), Width::I32.range());
        let nan = Linear::N2.raw(f64::NAN);
        assert_eq!((nan.value, nan.saturated), (0, true));
    }

    #[test]
    fn every_word_comes_back() {
        for raw in i64::from(i16::MIN)..=i64::from(i16::MAX) {
            for scale in [
                Linear::N2,
                Linear::E2,
                Linear::x2(15),
                Linear::decimal(-3, Width::I16),
            ] {
                let back = scale.raw(scale.engineering(raw));
                assert_eq!((back.value, back.saturated), (raw, false), "{scale:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn every_double_word_comes_back(raw: i32) {
            for scale in [Linear::N4, Linear::C4, Linear::x4(31)] {
                prop_assert_eq!(scale.raw(scale.engineering(raw.into())).checked(), Ok(i64::from(raw)));
            }
            let time = raw as u32;
            let scale = Linear::TIME_DIFFERENCE;
            prop_assert_eq!(scale.raw(scale.engineering(time.into())).checked(), Ok(i64::from(time)));
        }

        /// Against whole-number arithmetic: thousandths of a percent into N2.
        #[test]
        fn n2_rounds_like_fractions(thousandths in -199_990_i64..199_990) {
            // raw = thousandths * 2^14 / 100000, halves away from zero
            let (numerator, denominator) = (thousandths * 16_384, 100_000);
            let expected = (2 * numerator.abs() + denominator) / (2 * denominator) * numerator.signum();
            prop_assert_eq!(Linear::N2.raw(thousandths as f64 / 1000.0).checked(), Ok(expected));
        }

        #[test]
        fn never_further_than_half_a_step(percent in -200.0..199.99_f64) {
            let raw = Linear::N2.raw(percent);
            prop_assert!(!raw.saturated);
            let error = Linear::N2.engineering(raw.value) - percent;
            prop_assert!(error.abs() <= 100.0 / 32_768.0);
        }
    }
}
