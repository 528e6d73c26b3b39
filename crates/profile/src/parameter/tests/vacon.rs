//! What a Vacon does its own way: application ids behind one number, its error numbers, how many values in a frame.

use alloc::format;

use super::converter::{Converter, number, served};
use super::*;

const VACON: &Dialect = &Dialect::VACON;

/// Application ids are subindices of PNU 10001 (OPTE9 p. 31-32), always words (checklist 127). The change of ID 103 is
/// the reference's own example.
#[test]
fn drive_parameters_of_a_vacon() {
    let mut drive = Converter::new();
    assert_eq!(
        drive.ask(VACON, "03 01 01 01 10 01 27 11 00 67").unwrap(),
        hex("03 01 01 01 42 01 01 2C")
    );
    let change = hex("04 02 01 01 10 01 27 11 00 67 42 01 00 32");
    let value = NewValue {
        address: ParameterAddress::value(10001, 103),
        format: Format::WORD,
        count: 1,
        data: &[0, 50],
    };
    let mut out = [0; 240];
    let length = encode_change(4, VACON, &[value], &mut out).unwrap();
    assert_eq!(out[..length], change);
    let length = serve(&change, VACON, &mut drive, &mut out).unwrap();
    assert_eq!(out[..length], hex("04 02 01 01"));
    let response = Response::parse(&out[..length], RequestId::Change, 4, &[value.address], VACON).unwrap();
    assert_eq!(response.answers().next(), Some(Answer::Written));
    assert_eq!(drive.values[&(10001, 103)], 50);
    // 0 elements are as good as 1; a plain parameter has no more
    let zero = drive.ask(VACON, "03 01 01 01 10 00 27 11 00 67").unwrap();
    assert_eq!(zero, hex("03 01 01 01 42 01 00 32"));
    assert_eq!(number(VACON, "03 01 01 01 10 02 27 11 00 67"), 0x16);
    assert_eq!(number(VACON, "03 01 01 01 10 01 27 11 00 01"), 0x6C, "no such id");
    assert_eq!(number(VACON, "03 01 01 01 10 01 27 11 00 00"), 0x6C, "no such id");
    assert_eq!(
        number(VACON, "03 01 01 01 10 01 27 12 00 67"),
        0x00,
        "no such PNU"
    );
    assert_eq!(number(VACON, "03 01 01 01 20 01 27 11 00 00"), 0x09);
    assert_eq!(number(VACON, "03 02 01 01 10 01 27 11 00 67 42 01 00 00"), 0x02);
    // an array among them
    assert_eq!(
        served(VACON, "03 01 01 01 10 02 27 11 06 A5"),
        hex("03 01 01 01 42 02 00 00 00 09")
    );
    assert_eq!(
        served(VACON, "03 01 01 01 10 03 27 11 06 A5"),
        hex("03 81 01 01 44 01 00 03")
    );
}

/// Error numbers of a malformed request (OPTEA p. 122-123).
#[test]
fn vacon_error_numbers() {
    let read = "10 01 03 9A 00 00";
    for (head, response, expected) in [
        ("01 03 01 01", 0x80, 0x21),
        ("01 42 01 01", 0x80, 0x21),
        ("01 51 01 01", 0x80, 0x21),
        ("01 00 01 00", 0x80, 0x21),
        ("00 01 01 01", 0x81, 0x65),
        ("01 01 01 00", 0x81, 0x68),
        ("01 01 01 28", 0x81, 0x68),
        ("01 02 01 FF", 0x82, 0x68),
        ("01 01 01 02", 0x81, 0x6B),
        ("01 01 00 01", 0x81, 0x19),
    ] {
        let answer = served(VACON, &format!("{head} {read}"));
        assert_eq!(
            (answer[1], answer[2]),
            (response, hex(head)[2]),
            "{head}: the axis is mirrored"
        );
        assert_eq!(
            usize::from(answer[3]),
            answer[4..].len() / 4,
            "{head}: as many as are there"
        );
        assert_eq!(answer[4..8], [0x44, 1, 0, expected], "{head}");
    }
    for reference in 1..=u8::MAX {
        let answer = served(VACON, &format!("{reference:02X} 01 01 01 {read}"));
        assert_eq!(answer[..2], [reference, 1]);
    }
    for attribute in ["50", "00", "80"] {
        assert_eq!(
            number(VACON, &format!("01 01 01 01 {attribute} 01 03 9A 00 00")),
            0x69
        );
    }
    assert_eq!(
        number(VACON, "01 01 01 01 30 01 03 9A 00 00"),
        0x0F,
        "checklist 52"
    );
    assert_eq!(number(VACON, "01 02 01 01 10 01 03 A2 00 00 42 01 00"), 0x6B);
    assert_eq!(number(VACON, "01 02 01 01 10 01 03 A2 00 00"), 0x6B);
    assert_eq!(
        number(VACON, "01 02 01 01 10 01 03 A2 00 00 42 01 00 01 00 07"),
        0x6D
    );
    assert_eq!(Converter::new().ask(VACON, "01 01 01"), Err(Refusal::Length));
    for number in [0x65, 0x66, 0x68, 0x69, 0x6B, 0x6C, 0x6D, 0x6E] {
        let info = ErrorNumber(number).info(ErrorNames::Vacon).unwrap();
        assert!(!info.meaning.is_empty() && !info.remedy.is_empty(), "{number:#x}");
    }
}

/// 39 parameters; of an array what fits a block (1 to 234 elements, OPTEA p. 119), and a client requests 39 values at a
/// time (p. 120).
#[test]
fn a_vacon_fills_a_block_and_accepts_39_values() {
    let many = |count: u8| format!("01 01 01 {count:02X} ") + &"10 01 27 11 00 67 ".repeat(count.into());
    assert_eq!(served(VACON, &many(39)).len(), 4 + 39 * 4);
    assert_eq!(number(VACON, &many(40)), 0x68);
    let array = |elements: u8| format!("01 01 01 01 10 {elements:02X} 03 B3 00 00");
    assert_eq!(served(VACON, &array(39)).len(), 6 + 78);
    assert_eq!(served(VACON, &array(40)).len(), 6 + 80);
    assert_eq!(
        served(VACON, "01 01 01 02 10 26 03 B3 00 00 10 02 03 B3 00 00").len(),
        4 + 2 + 76 + 2 + 4
    );
    // 1 to 234 elements are possible requests; a block of 240 octets has room for 234 octets of values
    let read = |pnu: &str, elements: u8| format!("01 01 01 01 10 {elements:02X} {pnu} 00 00");
    let (words, octets) = ("03 9C", "03 9D");
    assert_eq!(served(VACON, &read(words, 117)).len(), 240);
    assert_eq!(number(VACON, &read(words, 118)), 0x15);
    assert_eq!(number(VACON, &read(words, 234)), 0x15);
    assert_eq!(served(VACON, &read(octets, 234)).len(), 240);
    for (pnu, elements) in [(words, 235), (octets, 235), (octets, 0), (words, 0), (words, 255)] {
        assert_eq!(number(VACON, &read(pnu, elements)), 0x16, "{pnu}: {elements}");
    }
    assert_eq!(
        number(VACON, "01 01 01 01 10 EB 03 B3 00 00"),
        0x16,
        "235 elements are never possible"
    );
    let reads: Vec<_> = (1..=100)
        .map(|id| (ParameterAddress::value(10001, id), Some(2)))
        .collect();
    assert_eq!(plan_reads(&reads, VACON), [0..39, 39..78, 78..100]);
    let reads = [20, 19, 1].map(|elements| (ParameterAddress::values(947, 0, elements), Some(2)));
    assert_eq!(plan_reads(&reads, VACON), [0..2, 2..3]);
    assert_eq!(plan_reads(&reads, &Dialect::STANDARD).len(), 1);
    let parts: Vec<_> = split_array(923, 0, 100, 2, VACON)
        .iter()
        .map(|part| (part.subindex, part.elements))
        .collect();
    assert_eq!(parts, [(0, 39), (39, 39), (78, 22)]);
    assert!(
        plan_changes(&[2; 100], VACON)
            .iter()
            .all(|group| group.len() <= 23)
    );
    let value = NewValue {
        address: ParameterAddress::values(923, 0, 40),
        format: Format::WORD,
        count: 40,
        data: &[0; 80],
    };
    let mut out = [0; 240];
    assert_eq!(
        encode_change(1, VACON, &[value], &mut out),
        Err(EncodeError::ValueCount {
            found: 40,
            allowed: 39
        })
    );
    assert!(encode_change(1, &Dialect::STANDARD, &[value], &mut out).is_ok());
    assert_eq!(
        encode_read(1, &Dialect::VLT, &[ParameterAddress::value(1, 0); 38], &mut out),
        Err(EncodeError::Parameters {
            found: 38,
            allowed: 37
        })
    );
    assert_eq!(
        plan_reads(&[(ParameterAddress::value(1, 0), Some(1)); 40], &Dialect::VLT),
        [0..37, 37..40]
    );
}
