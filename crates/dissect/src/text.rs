//! Octets and words as text.

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number;

    #[test]
    fn words_and_numbers() {
        assert_eq!(hex16(0x47F), "0x047F");
        assert_eq!(nibbles(0x47F), "0000 0100 0111 1111");
        assert_eq!(hex_bytes(&[5, 0xA2]), "05 A2");
        assert_eq!(number(60.0), "60");
        assert_eq!(number(59.695_25), "59.69525");
        assert_eq!(number(-0.5), "-0.5");
        assert_eq!(number(-9_223_372_036_854_775_808.0), "-9.223372e18");
        assert_eq!(number(1e300), "1e300");
    }
}
