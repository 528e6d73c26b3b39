//! R2, the one type without a constant factor.

use super::{Raw, Width, nearest};

/// R2: a time as the reciprocal of its fraction of the sampling time, t = 2^14 times sampling time / raw number.
/// Source: common knowledge of the profile, 6.2; no public table was available.
///
/// ```
/// use profidrive_profile::unit::Reciprocal;
/// let r2 = Reciprocal::new(4.0); // sampling time 4 ms
/// assert_eq!(r2.engineering(16_384), Some(4.0));
/// assert_eq!(r2.raw(16.0).value, 4096);
/// assert_eq!(r2.engineering(0), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reciprocal {
    sampling: f64,
}

impl Reciprocal {
    /// For this sampling time (PNU 962); values have its unit.
    #[must_use]
    pub const fn new(sampling: f64) -> Self {
        Self { sampling }
    }

    /// Returns the time of a number from the wire; none for 0.
    #[must_use]
    pub const fn engineering(&self, raw: u16) -> Option<f64> {
        if raw == 0 {
            None
        } else {
            Some(16_384.0 * self.sampling / raw as f64)
        }
    }

    /// Returns the number for the wire: nearest, halves away from zero. A time so long that 0 would be nearest gives 1,
    /// marked as saturated, since 0 is not time.
    #[must_use]
    pub const fn raw(&self, engineering: f64) -> Raw {
        let raw = nearest(16_384.0 * self.sampling / engineering, Width::U16.range());
        if raw.value == 0 {
            Raw {
                value: 1,
                saturated: true,
            }
        } else {
            raw
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_but_zero_comes_back() {
        let r2 = Reciprocal::new(0.25);
        for raw in 1..=u16::MAX {
            let time = r2.engineering(raw).unwrap();
            assert_eq!(r2.raw(time).checked(), Ok(i64::from(raw)));
        }
    }

    #[test]
    fn ends() {
        let r2 = Reciprocal::new(1.0);
        assert_eq!(r2.raw(0.0).checked().unwrap_err().nearest, 65_535);
        assert_eq!(r2.raw(f64::INFINITY).checked().unwrap_err().nearest, 1);
        assert_eq!(r2.raw(-1.0).checked().unwrap_err().nearest, 1);
        assert!(r2.raw(f64::NAN).saturated);
    }
}
