//! How a number is printed for people.

use alloc::format;
use alloc::string::String;

/// Digits that people get of a number with a fraction; whole numbers have all of theirs.
const DIGITS: usize = 7;
/// 2^53: from here on not all digits of a whole number are known.
const HUGE: f64 = 9_007_199_254_740_992.0;
/// Below this the digits behind the point are mostly zeros.
const TINY: f64 = 1e-4;

/// Returns a number for people: seven digits at most, no tail of zeros, no dirt of binary fractions. Very large and
/// very small ones are written with a power of ten. Programs are given the number itself.
///
/// ```
/// use profidrive_profile::notation::figures;
/// assert_eq!(figures(60.0), "60");
/// assert_eq!(figures(60.043931007385254), "60.04393");
/// assert_eq!(figures(-11997.0703125), "-11997.07");
/// assert_eq!(figures(0.366), "0.366");
/// assert_eq!(figures(50_000_000.0), "50000000");
/// assert_eq!(figures(-9.223372036854776e18), "-9.223372e18");
/// ```
#[must_use]
pub fn figures(value: f64) -> String {
    let size = if value < 0.0 { -value } else { value };
    if value == 0.0 {
        return String::from("0");
    }
    if !(TINY..HUGE).contains(&size) {
        return if value.is_finite() {
            scientific(value)
        } else {
            format!("{value}")
        };
    }
    let mut decimals = DIGITS - 1;
    let mut step = 10.0;
    while decimals > 0 && size >= step {
        decimals -= 1;
        step *= 10.0;
    }
    let text = format!("{value:.decimals$}");
    let text = tail_cut(&text);
    String::from(if text == "-0" { "0" } else { text })
}

/// Returns a number with so many digits behind the point. Zero has no sign, also where the number is rounded to it. Where not all
/// digits of a number are known it is written with a power of ten.
///
/// ```
/// use profidrive_profile::notation::fixed;
/// assert_eq!(fixed(-1.25, 1), "-1.2");
/// assert_eq!(fixed(-0.0004, 3), "0.000");
/// assert_eq!(fixed(1e308, 1), "1e308");
/// ```
#[must_use]
pub fn fixed(value: f64, decimals: usize) -> String {
    if !(-HUGE..HUGE).contains(&value) {
        return figures(value);
    }
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(size) if size.trim_matches(['0', '.']).is_empty() => String::from(size),
        _ => text,
    }
}

/// `-9.223372e18`, `1e300`.
fn scientific(value: f64) -> String {
    let text = format!("{value:.*e}", DIGITS - 1);
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}e{power}", tail_cut(mantissa))
}

fn tail_cut(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_as_people_read_them() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (59.695_25, "59.69525"),
            (-0.5, "-0.5"),
            (1.86, "1.86"),
            (0.000_061_035_156_25, "6.103516e-5"),
            (0.001_234_567_89, "0.001235"),
            (9.999_999_99, "10"),
            (1e300, "1e300"),
            (-9_007_199_254_740_991.0, "-9007199254740991"),
            (12_345_678.9, "12345679"),
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(figures(value), text, "{value:?}");
        }
    }

    #[test]
    fn zero_has_no_sign() {
        for (value, decimals, text) in [
            (-0.0, 2, "0.00"),
            (-0.0004, 3, "0.000"),
            (-0.0006, 3, "-0.001"),
            (-0.4, 0, "0"),
            (-10.0, 0, "-10"),
            (f64::NEG_INFINITY, 1, "-inf"),
        ] {
            assert_eq!(fixed(value, decimals), text, "{value:?}");
        }
    }

    proptest! {
        #[test]
        fn what_is_printed_is_nearly_the_number(value in proptest::num::f64::NORMAL) {
            let back: f64 = figures(value).parse().unwrap();
            let miss = (back - value).abs();
            prop_assert!(miss <= value.abs() * 1e-6 + if value.abs() < 1.0 { 5e-7 } else { 0.0 }, "{value:?} {back:?}");
            prop_assert!(figures(value).len() <= 17, "{}", figures(value));
        }
    }
}
