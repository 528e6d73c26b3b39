//! Formats of values, of each vendor: which a change takes, and what they mean.

use alloc::format;

use super::converter::{Converter, number};
use super::*;

const VLT: &Dialect = &Dialect::VLT;
const VACON: &Dialect = &Dialect::VACON;

/// The decimal formats of a VLT (2 to 7, 9, 10, 33, 35, 54; Danfoss MG06G102 5.8), read, written and described.
#[test]
fn formats_of_a_vlt_both_ways() {
    for (pnu, octets) in [
        (100, "02 01 FE 00"),
        (101, "03 01 FE D4"),
        (303, "04 01 FF FE EE 90"),
        (1, "05 01 00 00"),
        (930, "06 01 00 01"),
        (341, "07 01 00 00 01 2C"),
        (1007, "09 0C 20 20 20 20 20 20 20 20 20 20 20 20"),
        (1610, "0A 04 20 20 20 20"),
        (1600, "21 01 C0 00"),
        (967, "23 01 00 00"),
        (1623, "36 01 01 02 03 04"),
    ] {
        let mut drive = Converter::new();
        let read = format!("05 01 00 01 10 01 {:02X} {:02X} 00 00", pnu >> 8, pnu & 0xFF);
        let answer = drive.ask(VLT, &read).unwrap();
        assert_eq!(answer, hex(&format!("05 01 00 01 {octets}")), "PNU {pnu}");
        let one = [ParameterAddress::value(pnu, 0)];
        let response = Response::parse(&answer, RequestId::Read, 5, &one, VLT).unwrap();
        let Some(Answer::Values(block)) = response.answers().next() else {
            panic!("PNU {pnu}");
        };
        let value = NewValue {
            address: one[0],
            format: block.format,
            count: block.count,
            data: block.data,
        };
        let mut change = [0; 240];
        let length = encode_change(6, VLT, &[value], &mut change).unwrap();
        let mut out = [0; 240];
        assert_eq!(
            serve(&change[..length], VLT, &mut drive, &mut out),
            Ok(4),
            "PNU {pnu}"
        );
        assert_eq!(out[..4], [6, 2, 0, 1], "PNU {pnu}");
        let describe = format!("05 01 00 01 20 01 {:02X} {:02X} 00 01", pnu >> 8, pnu & 0xFF);
        let identifier = drive.ask(VLT, &describe).unwrap();
        assert_eq!(
            identifier[7], block.format.0,
            "PNU {pnu}: type in the description"
        );
    }
    // the codes of V4 do not exist here
    assert_eq!(number(VLT, "01 02 00 01 10 01 06 40 00 00 71 01 10 00"), 0x17);
}

/// Every format code with every type of data, for each dialect: a change is taken in the type itself, in the substitution
/// code of its length, and for an integer in another integer type of that length. A format of another meaning is refused
/// with 5, a code that is not a format of values with 0x17.
#[test]
fn a_change_in_a_format_of_another_meaning_is_refused() {
    const TYPES: [Format; 13] = [
        Format::INTEGER8,
        Format::INTEGER16,
        Format::INTEGER32,
        Format::UNSIGNED8,
        Format::UNSIGNED16,
        Format::UNSIGNED32,
        Format::FLOAT32,
        Format::VISIBLE_STRING,
        Format::OCTET_STRING,
        Format::N2,
        Format::V2,
        Format::TIME_DIFFERENCE,
        Format::OCTET_STRING2,
    ];
    // names, so that the test does not read the column which it tests
    const INTEGERS: [&str; 15] = [
        "Boolean",
        "Integer8",
        "Integer16",
        "Integer32",
        "Integer64",
        "Unsigned8",
        "Unsigned16",
        "Unsigned32",
        "Unsigned64",
        "BitString8",
        "BitString16",
        "BitString32",
        "BitString64",
        "V2",
        "L2",
    ];
    let name = |format: Format, space| format.info(space).map(|info| info.name);
    let is_integer = |format, space| name(format, space).is_some_and(|name| INTEGERS.contains(&name));
    for dialect in [&Dialect::STANDARD, &Dialect::AKD, VLT, VACON] {
        let space = dialect.code_space;
        for own in TYPES {
            let octets = own.data_len(CodeSpace::V4, 1, 4).unwrap();
            let facts = Attributes::simple(own, octets, true);
            let own = own.in_space(space);
            for format in (0..=u8::MAX).map(Format) {
                let length = format.data_len(space, 1, 4);
                let data = alloc::vec![0; length.unwrap_or(2).next_multiple_of(2)];
                let head = [1, 2, dialect.axis, 1, 0x10, 1, 0, 9, 0, 0, format.0, 1];
                let request = [&head[..], &data].concat();
                let mut out = [0; 240];
                let written = serve(&request, dialect, &mut OneValue(facts), &mut out).unwrap();
                let answer = match &out[..written] {
                    [_, 2, _, 1, ..] => None,
                    [_, 0x82, _, 1, 0x44, _, high, low, ..] => Some(u16::from_be_bytes([*high, *low])),
                    other => panic!("{other:02X?}"),
                };
                let same_meaning = format == own
                    || matches!(format.0, 0x41..=0x43)
                    || is_integer(format, space) && is_integer(own, space);
                let expected = match length {
                    None => Some(0x17),
                    Some(_) if matches!(format.0, 0x00 | 0x40 | 0x44) => Some(0x17),
                    Some(length) if length == octets && same_meaning => None,
                    Some(_) => Some(0x05),
                };
                assert_eq!(
                    answer, expected,
                    "{}: {format} for {own} of {octets}",
                    dialect.name
                );
            }
        }
    }
}

/// A number of the other sign is refused as a value out of limits; single bits and the substitution codes have no sign.
#[test]
fn an_integer_of_the_other_sign_is_refused() {
    const SIGNED: [Format; 3] = [Format::INTEGER8, Format::INTEGER16, Format::INTEGER32];
    const UNSIGNED: [Format; 3] = [Format::UNSIGNED8, Format::UNSIGNED16, Format::UNSIGNED32];
    const PLAIN: [Format; 3] = [Format::BYTE, Format::WORD, Format::DOUBLE_WORD];
    for dialect in [&Dialect::STANDARD, &Dialect::AKD, VLT, VACON] {
        let change = |own: Format, format: Format, octets: usize, first: u8| {
            let data = [&[first][..], &[0xFF; 3]].concat()[..octets.max(2)].to_vec();
            let head = [1, 2, dialect.axis, 1, 0x10, 1, 0, 9, 0, 0];
            let request = [&head[..], &[format.in_space(dialect.code_space).0, 1], &data].concat();
            let mut out = [0; 240];
            let mut drive = OneValue(Attributes::simple(own, octets, true));
            let written = serve(&request, dialect, &mut drive, &mut out).unwrap();
            if out[1] == 2 {
                0
            } else {
                u16::from(out[written - 1])
            }
        };
        for (size, octets) in [1, 2, 4].into_iter().enumerate() {
            let (signed, unsigned, plain) = (SIGNED[size], UNSIGNED[size], PLAIN[size]);
            let name = dialect.name;
            for (own, sent) in [(unsigned, signed), (signed, unsigned)] {
                assert_eq!(change(own, sent, octets, 0xFF), 0x02, "{name}: {sent} for {own}");
                assert_eq!(change(own, sent, octets, 0x7F), 0, "{name}: {sent} for {own}");
                assert_eq!(change(own, own, octets, 0xFF), 0, "{name}: {own}");
                assert_eq!(change(own, plain, octets, 0xFF), 0, "{name}: {plain} for {own}");
            }
        }
        assert_eq!(
            change(Format::V2, Format::INTEGER16, 2, 0xFF),
            0,
            "{}",
            dialect.name
        );
        assert_eq!(
            change(Format::INTEGER16, Format::V2, 2, 0xFF),
            0,
            "{}",
            dialect.name
        );
    }
    // as double words: Unsigned32 4294967295 for 1-01 (Integer16), Integer32 -1 for 3-41 (Unsigned32)
    assert_eq!(
        number(VLT, "05 52 00 01 10 01 00 65 00 00 07 01 FF FF FF FF"),
        0x02
    );
    assert_eq!(
        number(VLT, "05 52 00 01 10 01 01 55 00 00 04 01 FF FF FF FF"),
        0x02
    );
}

/// A parameter, whatever its number.
struct OneValue(Attributes);

impl ParameterAccess for OneValue {
    fn attributes(&self, _: u16, _: u16) -> Option<Attributes> {
        Some(self.0)
    }

    fn read(&mut self, _: u16, _: u16) -> Result<u64, ErrorNumber> {
        Ok(0)
    }

    fn write(&mut self, _: u16, _: u16, _: u64, _: Keep) -> Result<(), ErrorNumber> {
        Ok(())
    }
}
