//! Tables, words and live views. Knows how things look, nothing of where they come from.

pub mod live;
pub mod table;
pub mod value;
pub mod words;

/// `0x047F` for a 16-bit word.
pub fn hex16(word: u16) -> String {
    format!("0x{word:04X}")
}

/// Octets as `05 02 00`.
pub fn hex_bytes(bytes: &[u8]) -> String {
    bytes
        .iter()
        .map(|b| format!("{b:02X}"))
        .collect::<Vec<_>>()
        .join(" ")
}

/// `0000 0100 0111 1111`.
pub fn nibbles(word: u16) -> String {
    (0..4)
        .rev()
        .map(|at| format!("{:04b}", (word >> (4 * at)) & 0xF))
        .collect::<Vec<_>>()
        .join(" ")
}

/// From here on the digits of a number are not all known, and too many to read.
const HUGE: f64 = 1e17;

/// A number without a tail of zeros or rounding dirt: `60`, `0.366`, `1234.5`.
pub fn number(value: f64) -> String {
    if value.abs() >= HUGE {
        return format!("{value:e}");
    }
    if value.fract() == 0.0 {
        return format!("{value}");
    }
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_numbers() {
        assert_eq!(hex16(0x47F), "0x047F");
        assert_eq!(nibbles(0x47F), "0000 0100 0111 1111");
        assert_eq!(hex_bytes(&[5, 0xA2]), "05 A2");
        assert_eq!(number(60.0), "60");
        assert_eq!(number(59.695_25), "59.69525");
        assert_eq!(number(-0.5), "-0.5");
        assert_eq!(number(-9_223_372_036_854_775_808.0), "-9.223372036854776e18");
        assert_eq!(number(9_007_199_254_740_991.0), "9007199254740991");
        assert_eq!(number(1e300), "1e300");
    }
}
