//! The part of the basic encoding rules that SNMP uses: definite lengths, one-octet tags.
//!
//! Source: ITU-T X.690, RFC 3417 clause 8.

use alloc::vec::Vec;
use core::fmt;

use crate::wire::{DecodeError, Problem, Reader, Writer};

/// Most numbers of an object identifier (RFC 3416).
pub const MAX_NUMBERS: usize = 128;

/// Tags.
pub mod tag {
    /// INTEGER.
    pub const INTEGER: u8 = 0x02;
    /// OCTET STRING.
    pub const OCTETS: u8 = 0x04;
    /// NULL.
    pub const NULL: u8 = 0x05;
    /// OBJECT IDENTIFIER.
    pub const OID: u8 = 0x06;
    /// SEQUENCE.
    pub const SEQUENCE: u8 = 0x30;
    /// IpAddress.
    pub const IP_ADDRESS: u8 = 0x40;
    /// Counter32.
    pub const COUNTER: u8 = 0x41;
    /// Gauge32 and Unsigned32.
    pub const GAUGE: u8 = 0x42;
    /// TimeTicks.
    pub const TICKS: u8 = 0x43;
    /// Opaque.
    pub const OPAQUE: u8 = 0x44;
    /// Counter64.
    pub const COUNTER_64: u8 = 0x46;
    /// noSuchObject.
    pub const NO_SUCH_OBJECT: u8 = 0x80;
    /// noSuchInstance.
    pub const NO_SUCH_INSTANCE: u8 = 0x81;
    /// endOfMibView.
    pub const END_OF_MIB: u8 = 0x82;
}

/// An object identifier; compares as the order of a MIB goes.
///
/// ```
/// use profidrive_profinet::wire::snmp::Oid;
/// let system = Oid::from([1, 3, 6, 1, 2, 1, 1]);
/// assert_eq!(system.to_string(), "1.3.6.1.2.1.1");
/// assert!(system < system.with(&[1, 0]));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Oid(pub Vec<u32>);

impl Oid {
    /// This one with more numbers behind it.
    #[must_use]
    pub fn with(&self, more: &[u32]) -> Self {
        Self([&self.0[..], more].concat())
    }

    /// Returns its numbers behind those of `prefix`, if it begins with them.
    #[must_use]
    pub fn behind(&self, prefix: &[u32]) -> Option<&[u32]> {
        self.0.strip_prefix(prefix)
    }

    /// Reads the content of an OBJECT IDENTIFIER.
    ///
    /// # Errors
    /// When it is empty, too long, a number ends too early or has more than 32 bits.
    pub fn decode(mut r: Reader<'_>) -> Result<Self, DecodeError> {
        const WHAT: &str = "object identifier";
        let mut numbers = Vec::new();
        let mut value = 0u32;
        let mut open = true;
        while !r.is_empty() {
            let octet = r.u8(WHAT)?;
            let high = value.checked_mul(128);
            let Some(high) = high else {
                return Err(r.error(WHAT, 1, Problem::Invalid { found: octet.into() }));
            };
            value = high | u32::from(octet & 0x7F);
            open = octet & 0x80 != 0;
            if open {
                continue;
            }
            if numbers.is_empty() {
                // the first two numbers travel as one
                let first = (value / 40).min(2);
                numbers.extend([first, value - 40 * first]);
            } else {
                numbers.push(value);
            }
            if numbers.len() > MAX_NUMBERS {
                return Err(r.error(WHAT, 1, Problem::TooMany { limit: MAX_NUMBERS }));
            }
            value = 0;
        }
        if open {
            let (needed, available) = (1, 0);
            return Err(r.error(WHAT, 0, Problem::Truncated { needed, available }));
        }
        Ok(Self(numbers))
    }

    /// Writes it with tag and length. Fewer than two numbers become 0.0.
    pub fn encode(&self, out: &mut impl Writer) {
        let (first, second, rest) = match *self.0 {
            [first, second, ref rest @ ..] => (first.min(2), second, rest),
            _ => (0, 0, &[][..]),
        };
        let joined = u64::from(first) * 40 + u64::from(second);
        wrap(out, tag::OID, |out| {
            number(out, joined);
            rest.iter().for_each(|n| number(out, (*n).into()));
        });
    }
}

impl<const N: usize> From<[u32; N]> for Oid {
    fn from(numbers: [u32; N]) -> Self {
        Self(numbers.to_vec())
    }
}

impl fmt::Display for Oid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, number) in self.0.iter().enumerate() {
            if at > 0 {
                f.write_str(".")?;
            }
            write!(f, "{number}")?;
        }
        Ok(())
    }
}

/// One number of an object identifier: seven bits an octet, the last one without the top bit.
fn number(out: &mut impl Writer, value: u64) {
    for group in (1..10).rev() {
        if value >> (7 * group) != 0 {
            out.u8((value >> (7 * group)) as u8 & 0x7F | 0x80);
        }
    }
    out.u8(value as u8 & 0x7F);
}

/// Reads tag and content of the next element.
///
/// # Errors
/// When the tag has more than one octet, the length is indefinite or of more than four octets, or the content runs past the end.
pub fn element<'a>(r: &mut Reader<'a>, what: &'static str) -> Result<(u8, Reader<'a>), DecodeError> {
    let found = r.u8(what)?;
    if found & 0x1F == 0x1F {
        return Err(r.error(what, 1, Problem::Invalid { found: found.into() }));
    }
    let first = r.u8(what)?;
    let length = match first {
        0..=0x7F => usize::from(first),
        0x81..=0x84 => {
            let octets = r.bytes(usize::from(first & 0x7F), what)?;
            octets
                .iter()
                .fold(0usize, |length, octet| length << 8 | usize::from(*octet))
        }
        _ => return Err(r.error(what, 1, Problem::Invalid { found: first.into() })),
    };
    Ok((found, r.sub(length, what)?))
}

/// Reads an element that must have this tag.
///
/// # Errors
/// As [`element`], and when it has another tag.
pub fn expect<'a>(r: &mut Reader<'a>, wanted: u8, what: &'static str) -> Result<Reader<'a>, DecodeError> {
    let start = *r;
    let (found, content) = element(r, what)?;
    if found == wanted {
        Ok(content)
    } else {
        let (expected, found) = (wanted.into(), found.into());
        Err(start.error(what, 0, Problem::Expected { expected, found }))
    }
}

/// Reads the content of a signed number of at most 32 bits; more octets than needed are taken.
///
/// # Errors
/// When it is empty or does not fit.
pub fn signed(mut r: Reader<'_>, what: &'static str) -> Result<i32, DecodeError> {
    let start = r;
    let octets = r.rest("octets");
    let wrong = || {
        start.error(
            what,
            0,
            Problem::Invalid {
                found: octets.len() as u64,
            },
        )
    };
    if octets.is_empty() || octets.len() > 8 {
        return Err(wrong());
    }
    let negative = octets.first().is_some_and(|octet| octet & 0x80 != 0);
    let value = octets
        .iter()
        .fold(if negative { -1i64 } else { 0 }, |value, octet| {
            value << 8 | i64::from(*octet)
        });
    i32::try_from(value).map_err(|_| wrong())
}

/// Reads the content of an unsigned number of at most 64 bits.
///
/// # Errors
/// When it is empty or does not fit.
pub fn unsigned(mut r: Reader<'_>, what: &'static str) -> Result<u64, DecodeError> {
    let start = r;
    let octets = r.rest("octets");
    let spare = octets.iter().take_while(|octet| **octet == 0).count();
    if octets.is_empty() || octets.len() - spare > 8 {
        return Err(start.error(
            what,
            0,
            Problem::Invalid {
                found: octets.len() as u64,
            },
        ));
    }
    Ok(octets
        .iter()
        .fold(0, |value, octet| value << 8 | u64::from(*octet)))
}

/// Writes an element around what `content` writes. Its length always takes three octets, which the rules allow: so it
/// need not be known beforehand.
pub fn wrap<W: Writer>(out: &mut W, tag: u8, content: impl FnOnce(&mut W)) {
    out.bytes(&[tag, 0x82, 0, 0]);
    let start = out.position();
    content(out);
    let length = u16::try_from(out.position() - start).unwrap_or(u16::MAX);
    out.patch(start - 2, &length.to_be_bytes());
}

/// Writes a short element whose content is at hand.
pub fn short(out: &mut impl Writer, tag: u8, content: &[u8]) {
    match u8::try_from(content.len()) {
        Ok(length) if length < 0x80 => {
            out.bytes(&[tag, length]);
            out.bytes(content);
        }
        _ => wrap(out, tag, |out| out.bytes(content)),
    }
}

/// Writes a signed number in as few octets as it needs.
pub fn write_signed(out: &mut impl Writer, tag: u8, value: i32) {
    let octets = value.to_be_bytes();
    let spare = (0..3)
        .take_while(|at| {
            let sign = octets.get(at + 1).is_some_and(|next| next & 0x80 != 0);
            octets.get(*at) == Some(if sign { &0xFF } else { &0 })
        })
        .count();
    short(out, tag, octets.get(spare..).unwrap_or_default());
}

/// Writes an unsigned number in as few octets as it needs.
pub fn write_unsigned(out: &mut impl Writer, tag: u8, value: u64) {
    let [a, b, c, d, e, f, g, h] = value.to_be_bytes();
    // a top bit would be a sign
    let octets = [0, a, b, c, d, e, f, g, h];
    let spare = (0..8)
        .take_while(|at| {
            octets.get(*at) == Some(&0) && octets.get(at + 1).is_some_and(|next| next & 0x80 == 0)
        })
        .count();
    short(out, tag, octets.get(spare..).unwrap_or_default());
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use proptest::prelude::*;

    fn content(octets: &[u8], wanted: u8) -> Reader<'_> {
        expect(&mut Reader::new(octets), wanted, "test").unwrap()
    }

    #[test]
    fn numbers_have_the_octets_of_the_standard() {
        let signed = |value| {
            let mut out = Vec::new();
            write_signed(&mut out, 2, value);
            out
        };
        assert_eq!(signed(0), [2, 1, 0]);
        assert_eq!(signed(127), [2, 1, 0x7F]);
        assert_eq!(signed(128), [2, 2, 0, 0x80]);
        assert_eq!(signed(-128), [2, 1, 0x80]);
        assert_eq!(signed(-129), [2, 2, 0xFF, 0x7F]);
        assert_eq!(signed(i32::MIN), [2, 4, 0x80, 0, 0, 0]);
        let mut out = Vec::new();
        write_unsigned(&mut out, tag::COUNTER, 0xFFFF_FFFF);
        assert_eq!(out, [0x41, 5, 0, 0xFF, 0xFF, 0xFF, 0xFF]);
        out.clear();
        Oid::from([1, 3, 6, 1, 4, 1, 24686]).encode(&mut out);
        assert_eq!(out, [6, 0x82, 0, 8, 0x2B, 6, 1, 4, 1, 0x81, 0xC0, 0x6E]);
    }

    #[test]
    fn what_is_not_allowed_is_refused() {
        for wrong in [
            &[0x1F, 1, 0][..],
            &[0x30, 0x80, 0, 0],
            &[0x30, 0x85, 0, 0, 0, 0, 1, 0],
            &[0x30, 0x84, 0xFF, 0xFF, 0xFF, 0xFF],
            &[0x30, 2, 0],
            &[0x30],
            &[],
        ] {
            assert!(element(&mut Reader::new(wrong), "test").is_err(), "{wrong:02x?}");
        }
        for wrong in [&[][..], &[0x81], &[0x2B, 0x90, 0x80, 0x80, 0x80, 0x00], &[1; 200]] {
            assert!(Oid::decode(Reader::new(wrong)).is_err(), "{wrong:02x?}");
        }
        assert!(signed(Reader::new(&[]), "test").is_err());
        assert!(signed(Reader::new(&[1, 0, 0, 0, 0]), "test").is_err());
        assert!(unsigned(Reader::new(&[1; 9]), "test").is_err());
    }

    #[test]
    fn long_lengths_are_accepted() {
        let long = [&[0x04, 0x83, 0, 0, 3][..], b"abc"].concat();
        assert_eq!(content(&long, tag::OCTETS).rest("octets"), b"abc");
        assert_eq!(
            signed(Reader::new(&[0xFF, 0xFF, 0xFF, 0xFF, 0xFE]), "test"),
            Ok(-2)
        );
    }

    proptest! {
        #[test]
        fn numbers_come_back(s: i32, u: u64) {
            let mut out = vec![];
            write_signed(&mut out, tag::INTEGER, s);
            prop_assert_eq!(signed(content(&out, tag::INTEGER), "test"), Ok(s));
            out.clear();
            write_unsigned(&mut out, tag::COUNTER_64, u);
            prop_assert_eq!(unsigned(content(&out, tag::COUNTER_64), "test"), Ok(u));
        }

        #[test]
        fn identifiers_come_back(first in 0u32..3, second in 0u32..40, rest in proptest::collection::vec(any::<u32>(), 0..126)) {
            let oid = Oid([&[first, second][..], &rest].concat());
            let mut out = vec![];
            oid.encode(&mut out);
            prop_assert_eq!(Oid::decode(content(&out, tag::OID)), Ok(oid));
        }

        #[test]
        fn any_octets_are_survived(octets in proptest::collection::vec(any::<u8>(), 0..40)) {
            let _ = Oid::decode(Reader::new(&octets));
            let _ = signed(Reader::new(&octets), "test");
            let _ = unsigned(Reader::new(&octets), "test");
            let mut r = Reader::new(&octets);
            while let Ok((_, inner)) = element(&mut r, "test") {
                prop_assert!(inner.remaining() <= octets.len());
            }
        }
    }
}
