//! What VLT and Vacon do their own way: requests, strings, collected parameters, error numbers.

use alloc::borrow::ToOwned;
use alloc::format;
use alloc::string::String;

use super::converter::{Converter, number, served};
use super::*;

const VLT: &Dialect = &Dialect::VLT;
const VACON: &Dialect = &Dialect::VACON;

/// Request 0x42 is kept, 0x02 is not; the other vendors do not have it.
#[test]
fn a_vlt_saves_values_on_request() {
    let mut drive = Converter::new();
    let change = |id: &str| format!("05 {id} 00 01 10 01 01 55 00 00 07 01 00 00 01 F4");
    for (id, keep) in [("02", Keep::Volatile), ("42", Keep::Permanent)] {
        assert_eq!(drive.ask(VLT, &change(id)).unwrap(), hex("05 02 00 01"));
        assert_eq!(drive.writes.pop(), Some((341, 0, 500, keep)));
    }
    assert_eq!(
        drive
            .ask(VLT, "05 42 00 01 10 01 01 55 00 00 07 01 00 00 00 00")
            .unwrap(),
        hex("05 82 00 01 44 01 00 02")
    );
    assert_eq!(number(&Dialect::AKD, &change("42")), 0x21);
    assert_eq!(drive.writes, []);
    // texts too
    let text = "05 42 00 01 10 01 03 EF 00 00 09 0C 50 55 4D 50 20 31 20 20 20 20 20 20";
    assert_eq!(drive.ask(VLT, text).unwrap(), hex("05 02 00 01"));
    assert!(drive.writes.iter().all(|write| write.3 == Keep::Permanent));
    let written: Vec<u8> = drive.writes.iter().map(|write| write.2 as u8).collect();
    assert_eq!(written, b"PUMP 1      ");
}

/// 0x51: whatever the size, four octets with the sign of the type; strings have none.
#[test]
fn everything_as_a_double_word() {
    let read = |pnu: u16| format!("05 51 00 01 10 01 {:02X} {:02X} 00 00", pnu >> 8, pnu & 0xFF);
    for (pnu, block) in [
        (100, "04 01 FF FF FF FE"),
        (101, "04 01 FF FF FE D4"),
        (303, "04 01 FF FE EE 90"),
        (930, "07 01 00 00 00 01"),
        (967, "07 01 00 00 00 00"),
        (1600, "04 01 FF FF C0 00"),
        (1623, "36 01 01 02 03 04"),
    ] {
        assert_eq!(
            served(VLT, &read(pnu)),
            hex(&format!("05 01 00 01 {block}")),
            "PNU {pnu}"
        );
    }
    assert_eq!(number(VLT, &read(1540)), 0x05);
    assert_eq!(
        served(VLT, "05 51 00 01 10 0A 05 FA 00 00")[..10],
        hex("05 01 00 01 07 0A 00 00 00 07")
    );
    let change = |pnu: u16, value: &str| {
        format!(
            "05 52 00 01 10 01 {:02X} {:02X} 00 00 {value}",
            pnu >> 8,
            pnu & 0xFF
        )
    };
    let mut drive = Converter::new();
    for (pnu, value, number) in [
        (100, "43 01 FF FF FF 9C", -100),
        (101, "04 01 FF FF FF FF", -1),
        (303, "43 01 00 00 00 09", 9),
        (1, "07 01 00 00 00 34", 52),
        (1600, "43 01 FF FF C0 00", -0x4000),
        (967, "43 01 00 00 FF FF", 0xFFFF),
    ] {
        assert_eq!(
            drive.ask(VLT, &change(pnu, value)).unwrap(),
            hex("05 02 00 01"),
            "PNU {pnu}"
        );
        assert_eq!(drive.writes.pop(), Some((pnu, 0, number, Keep::Volatile)));
    }
    // what does not fit the type, and what has not four octets
    for (pnu, value, expected) in [
        (100, "43 01 00 00 00 80", 0x02),
        (1, "43 01 00 00 01 00", 0x02),
        (967, "43 01 00 01 00 00", 0x02),
        (101, "43 01 FF FF 7F FF", 0x02),
        (414, "42 01 00 01", 0x05),
        (1007, "09 0C 20 20 20 20 20 20 20 20 20 20 20 20", 0x05),
    ] {
        let answer = drive.ask(VLT, &change(pnu, value)).unwrap();
        assert_eq!(
            answer,
            hex(&format!("05 82 00 01 44 01 00 {expected:02X}")),
            "PNU {pnu}"
        );
    }
    assert_eq!(drive.writes, []);
}

/// Both sides of the requests of Danfoss. Only the IDs of the profile are documented for the response; a mirrored one is
/// accepted as well.
#[test]
fn requests_of_a_vlt_from_the_client() {
    let one = [ParameterAddress::value(930, 0)];
    let mut out = [0; 240];
    let length = encode_read_as(RequestId::ReadWide, 7, VLT, &one, &mut out).unwrap();
    assert_eq!(out[..length], hex("07 51 00 01 10 01 03 A2 00 00"));
    for id in ["01", "51"] {
        let bytes = hex(&format!("07 {id} 00 01 07 01 00 00 00 01"));
        let response = Response::parse(&bytes, RequestId::ReadWide, 7, &one, VLT).unwrap();
        assert!(matches!(response.answers().next(), Some(Answer::Values(block)) if block.raw(0) == Some(1)));
    }
    for id in ["02", "42"] {
        let bytes = hex(&format!("07 {id} 00 01"));
        let response = Response::parse(&bytes, RequestId::ChangePermanent, 7, &one, VLT).unwrap();
        assert_eq!(response.answers().next(), Some(Answer::Written));
        let bytes = hex(&format!("07 {id} 00 01 44 01 00 11"))
            .iter()
            .enumerate()
            .map(|(at, &octet)| if at == 1 { octet | 0x80 } else { octet })
            .collect::<Vec<_>>();
        let response = Response::parse(&bytes, RequestId::ChangePermanent, 7, &one, VLT).unwrap();
        assert_eq!(
            response.answers().next(),
            Some(Answer::Error(ErrorNumber::NOT_NOW.into()))
        );
    }
    // a drive that does not support the request, with one error for each of two parameters
    let two = [one[0]; 2];
    let unknown = hex("07 81 00 02 44 01 00 66 44 01 00 66");
    let service = ErrorNumber::DANFOSS_UNKNOWN_SERVICE.into();
    assert_eq!(
        Response::parse(&unknown, RequestId::ChangePermanent, 7, &two, VLT),
        Err(ResponseError::Refused(service))
    );
    let wrong = hex("07 52 00 01");
    assert!(matches!(
        Response::parse(&wrong, RequestId::ChangePermanent, 7, &one, VLT),
        Err(ResponseError::Id {
            request: 0x42,
            found: 0x52
        })
    ));
    let value = NewValue {
        address: one[0],
        format: Format::WORD,
        count: 1,
        data: &[0, 1],
    };
    let refused = |id| Err(EncodeError::Request { id });
    for dialect in [&Dialect::AKD, VACON, &Dialect::STANDARD] {
        for id in [RequestId::ChangePermanent, RequestId::ChangeWide, RequestId::Read] {
            assert_eq!(encode_change_as(id, 1, dialect, &[value], &mut out), refused(id));
        }
        assert_eq!(
            encode_read_as(RequestId::ReadWide, 1, dialect, &one, &mut out),
            refused(RequestId::ReadWide)
        );
    }
    assert_eq!(
        Dialect::VACON.change_id(Keep::Permanent),
        Some(RequestId::Change),
        "keeps every change"
    );
    assert_eq!(Dialect::STANDARD.change_id(Keep::Permanent), None);
    let mirrored = hex("07 51 00 01 07 01 00 00 00 01");
    assert!(Response::parse(&mirrored, RequestId::Read, 7, &one, VLT).is_err());
}

/// The data has exactly the size requested (Danfoss MG06G102 5.8), also where it is zeros that are too many.
#[test]
fn data_of_another_size_is_refused() {
    let head = "01 02 00 01 10 01 01 55 00 00";
    for (data, expected) in [
        ("07 01 00 00 01 F4 00 00", 0x18),
        ("07 01 00 00 01 F4 01", 0x18),
        ("07 01 00 00 01", 0x18),
        ("07 01", 0x18),
        ("", 0x18),
        ("07 02 00 00 01 F4 00 00 01 F4", 0x18),
        ("06 01 01 F4", 0x05),
        ("05 01 01", 0x05),
        ("09 04 20 20 20 20", 0x18),
        ("33 01 01 F4", 0x18),
        ("44 01 00 01", 0x17),
        ("40 00", 0x17),
        ("50 01 01 F4", 0x17),
    ] {
        assert_eq!(number(VLT, &format!("{head} {data}")), expected, "{data}");
    }
    // an odd number of octets is padded, with or without the last pad octet
    for data in ["05 01 07 00", "05 01 07", "41 01 07 00"] {
        let request = format!("01 02 00 01 10 01 00 01 00 00 {data}");
        assert_eq!(served(VLT, &request), hex("01 02 00 01"), "{data}");
    }
    // of two values, one with octets too many behind it, none is written
    let two = "01 02 00 02 10 01 00 01 00 00 10 01 01 55 00 00 05 01 07 00 07 01 00 00 01 F4 00 00";
    let mut drive = Converter::new();
    assert_eq!(
        drive.ask(VLT, two).unwrap(),
        hex("01 82 00 02 44 01 00 18 44 01 00 18")
    );
    assert_eq!(drive.writes, []);
}

/// Danfoss's own numbers (FC 300 PROFIBUS manual p. 50).
#[test]
fn danfoss_error_numbers() {
    assert_eq!(number(VLT, "01 01 01 01 10 01 03 9A 00 00"), 0x65, "axis");
    assert_eq!(
        number(VLT, "01 02 01 01 10 01 03 A2 00 00 06 01 00 01"),
        0x65,
        "axis"
    );
    for id in ["03", "43", "50", "81"] {
        assert_eq!(number(VLT, &format!("01 {id} 00 01 10 01 03 9A 00 00")), 0x66);
    }
    assert_eq!(number(VLT, "01 01 00 01 10 01 06 A3 00 00"), 0x68);
    for (number, meaning) in [
        (0x65, "wrong axis"),
        (0x66, "unknown service"),
        (0x67, "not with multi-parameter access"),
        (0x68, "no bus access to the parameter value"),
    ] {
        let info = ErrorNumber(number).info(ErrorNames::Danfoss).unwrap();
        assert_eq!(info.meaning, meaning);
        assert!(!info.remedy.is_empty());
    }
}

/// 15-40 and its like: 0 and 1 elements are the whole string, others its octets; in an array each string is an element.
#[test]
fn strings() {
    let read = |elements: u8, pnu: u16, subindex: u16| {
        format!(
            "05 01 00 01 10 {elements:02X} {:02X} {:02X} 00 {subindex:02X}",
            pnu >> 8,
            pnu & 0xFF
        )
    };
    let text = |answer: &[u8]| String::from_utf8(answer[6..6 + usize::from(answer[5])].to_vec()).unwrap();
    for elements in [0, 1, 20] {
        let answer = served(VLT, &read(elements, 1540, 0));
        assert_eq!((answer[4], answer[5], answer.len()), (9, 20, 26));
        assert_eq!(text(&answer), "FC-302              ");
    }
    assert_eq!(text(&served(VLT, &read(3, 1540, 3))), "302");
    assert_eq!(text(&served(VLT, &read(1, 1540, 1))), "C");
    assert_eq!(number(VLT, &read(21, 1540, 0)), 0x03);
    assert_eq!(number(VLT, &read(1, 1540, 20)), 0x03);
    assert_eq!(number(VLT, &read(0, 1540, 1)), 0x16);
    assert_eq!(text(&served(VLT, &read(1, 1553, 2))), "C                   ");
    assert_eq!(
        text(&served(VLT, &read(2, 1553, 6))),
        "G                   H                   "
    );
    assert_eq!(number(VLT, &read(1, 1553, 8)), 0x03);
    assert_eq!(number(VLT, &read(3, 1553, 6)), 0x03);
    assert_eq!(number(VLT, &read(0, 1553, 0)), 0x16);
    let mut drive = Converter::new();
    // a part
    let part = "05 02 00 01 10 02 03 EF 00 03 09 02 41 42";
    assert_eq!(drive.ask(VLT, part).unwrap(), hex("05 02 00 01"));
    assert_eq!(
        drive.writes,
        [(1007, 3, 0x41, Keep::Volatile), (1007, 4, 0x42, Keep::Volatile)]
    );
    // one string of an array
    let name = "05 02 00 01 10 01 06 11 00 07 09 14 ".to_owned() + &"5A ".repeat(20);
    assert_eq!(drive.ask(VLT, &name).unwrap(), hex("05 02 00 01"));
    assert_eq!(text(&drive.ask(VLT, &read(1, 1553, 7)).unwrap()), "Z".repeat(20));
    assert_eq!(text(&drive.ask(VLT, &read(1, 1553, 6)).unwrap())[..1], *"G");
    // too short, too long, read-only, no characters
    for request in [
        "10 01 03 EF 00 00 09 0B 41 41 41 41 41 41 41 41 41 41 41",
        "10 01 03 EF 00 00 09 02 41 42",
    ] {
        assert_eq!(number(VLT, &format!("05 02 00 01 {request}")), 0x18);
    }
    assert_eq!(number(VLT, "05 02 00 01 10 01 06 04 00 00 09 02 41 42"), 0x01);
    let octets = "05 02 00 01 10 0C 03 EF 00 00 0A 0C ".to_owned() + &"41 ".repeat(12);
    assert_eq!(number(VLT, &octets), 0x05);
}

/// Texts of a selection, 16 octets each (Danfoss MCA 101 p. 32; 0-01 Language).
#[test]
fn texts_of_a_vlt() {
    let answer = served(VLT, "05 01 00 01 30 02 00 01 00 01");
    assert_eq!(answer[..6], [5, 1, 0, 1, 9, 32]);
    assert_eq!(&answer[6..], b"Deutsch         Francais        ");
    for (request, expected) in [
        ("30 01 00 01 00 06", 0x0F),
        ("30 07 00 01 00 00", 0x0F),
        ("30 01 03 9A 00 00", 0x0F),
        ("30 01 FF FE 00 00", 0x00),
        ("30 0F 00 01 00 00", 0x15),
    ] {
        assert_eq!(
            number(VLT, &format!("05 01 00 01 {request}")),
            expected,
            "{request}"
        );
    }
    assert_eq!(number(VLT, "05 02 00 01 30 01 00 01 00 00 09 01 41 00"), 0x20);
}

/// The description of 0-01 and of an N2: twelve elements, types in decimal V3 codes, limits that hold.
#[test]
fn descriptions_of_a_vlt() {
    let element = |pnu: u16, sub: u16| {
        let answer = served(
            VLT,
            &format!(
                "05 01 00 01 20 01 {:02X} {:02X} 00 {sub:02X}",
                pnu >> 8,
                pnu & 0xFF
            ),
        );
        assert_eq!(answer[4], 0x0A);
        answer[6..6 + usize::from(answer[5])].to_vec()
    };
    assert_eq!(element(1, 1), hex("04 05"), "FC design guide: 0405");
    assert_eq!(element(341, 4), hex("04 FE"), "seconds, two decimals");
    assert_eq!(element(1, 6), b"Language        ");
    assert_eq!(element(1600, 1), hex("00 21"), "N2 is 33 here");
    assert_eq!(element(1600, 12), hex("80 0E"));
    assert_eq!(element(1540, 2), hex("00 14"), "length of the string");
    let whole: Vec<u8> = (1..=12).flat_map(|sub| element(101, sub)).collect();
    assert_eq!(element(101, 0), whole);
    assert_eq!(whole.len(), 46);
    // checklist 49
    let limits = [element(414, 7), element(414, 8)];
    assert_eq!(limits, [hex("00 00 00 00"), hex("00 00 05 28")]);
    for (value, positive) in [("00 00", true), ("05 28", true), ("05 29", false)] {
        let answer = served(VLT, &format!("05 02 00 01 10 01 01 9E 00 00 06 01 {value}"));
        assert_eq!(answer[1], if positive { 0x02 } else { 0x82 }, "{value}");
        assert!(positive || answer[4..] == hex("44 01 00 02"));
    }
    assert_eq!(number(VLT, "05 01 00 01 20 01 00 01 00 0D"), 0x03);
    assert_eq!(number(VLT, "05 01 00 01 20 02 00 01 00 05"), 0x16);
    assert_eq!(number(VLT, "05 01 00 01 20 01 FF FE 00 00"), 0x00);
}

/// The block-level lines of the checklist for both vendors, each against its dialect.
#[test]
fn checklist() {
    for (dialect, axis, word) in [(VLT, "00", 0x06_u8), (VACON, "01", 0x42)] {
        let name = dialect.name;
        let asked = |request: &str| served(dialect, &request.replace("DD", axis));
        let refused = |request: &str| number(dialect, &request.replace("DD", axis));
        let one = asked("01 01 DD 01 10 01 03 9A 00 00");
        assert_eq!(one, [1, 1, hex(axis)[0], 1, word, 1, 0, 1], "{name}: 1 and 4");
        assert_eq!(refused("07 01 DD 01 10 01 03 9A 00 05"), 0x04, "{name}: 7");
        let attribute = if dialect.axis == 1 { 0x69 } else { 0x16 };
        assert_eq!(refused("0A 01 DD 01 50 01 03 9A 00 00"), attribute, "{name}: 10");
        let mixed = asked("10 01 DD 02 10 01 03 9A 00 00 10 01 FF FE 00 00");
        let axis_octet = hex(axis)[0];
        assert_eq!(
            mixed,
            [0x10, 0x81, axis_octet, 2, word, 1, 0, 1, 0x44, 1, 0, 0],
            "{name}: 16"
        );
        assert_eq!(
            asked("11 02 DD 01 10 01 03 A2 00 00 42 01 00 02"),
            [0x11, 2, axis_octet, 1],
            "{name}: 22"
        );
        assert_eq!(
            refused("11 02 DD 01 10 01 03 A2 00 00 50 01 00 02"),
            0x17,
            "{name}: 25"
        );
        assert_eq!(
            asked("11 02 DD 01 10 01 03 A2 00 00 06 01 00 02")[1],
            2,
            "{name}: 28"
        );
        let interleaved = refused("01 02 DD 02 10 01 03 A2 00 00 42 01 00 01 10 01 00 01 00 00 41 01 02 00");
        assert!(
            [0x16, 0x17, 0x18, 0x69].contains(&interleaved),
            "{name}: 34, {interleaved:#x}"
        );
        let mut drive = Converter::new();
        let text =
            "01 02 DD 02 10 01 03 A2 00 00 42 01 00 01 10 01 00 01 00 00 41 01 02 00".replace("DD", axis);
        drive.ask(dialect, &text).unwrap();
        assert_eq!(drive.writes, [], "{name}: 34");
        let description = asked("2E 01 DD 01 20 01 03 9A 00 00");
        assert_eq!(
            (description.len(), description[4], description[5]),
            (52, 0x0A, 46),
            "{name}: 46"
        );
        assert_eq!(refused("34 01 DD 01 30 01 03 9A 00 00"), 0x0F, "{name}: 52");
    }
    // 19: 37 parameters are what a VLT takes
    let long = String::from("01 01 00 25 ") + &"10 08 03 B3 00 00 ".repeat(37);
    let answer = served(VLT, &long);
    assert!(answer.len() <= 240);
    assert_eq!(number(VLT, &long), 0x15);
    // 130
    assert_eq!(
        served(VLT, "01 01 00 01 10 01 05 FA 00 00"),
        hex("01 01 00 01 05 01 07 00")
    );
    assert_eq!(
        served(VLT, "01 01 00 01 10 01 05 FA 00 09"),
        hex("01 01 00 01 05 01 C8 00")
    );
    assert_eq!(
        served(VLT, "01 01 00 01 10 01 05 FA 00 0A"),
        hex("01 81 00 01 44 02 00 03 00 0A")
    );
}

/// Danfoss MG06G102 5.5 to 5.8: the number of parameters has no printed limit, data blocks belong to changes only, and the
/// words of each parameter follow those of the one before.
#[test]
fn parameters_and_data_blocks_of_a_vlt_request() {
    let mut drive = Converter::new();
    let mut read = |count: u8| {
        let addresses = "10 01 03 A2 00 00 ".repeat(count.into());
        drive.ask(VLT, &format!("05 01 00 {count:02X} {addresses}"))
    };
    for found in [0, 38, 39, 255] {
        assert_eq!(read(found), Err(Refusal::Parameters { found, allowed: 37 }));
    }
    assert_eq!(read(37).unwrap()[..8], hex("05 01 00 25 06 01 00 01"));
    let one = "05 01 00 01 10 01 03 A2 00 00";
    let answer = drive.ask(VLT, one);
    assert_eq!(
        drive.ask(VLT, &format!("{one} 06 01 00 02")),
        Err(Refusal::Length)
    );
    assert_eq!(drive.ask(VLT, &format!("{one} 00 00 00 00")), answer);
    let change = "05 02 00 02 10 01 00 01 00 00 10 01 01 55 00 00 05 01 02 00 07 01 00 00 01 F4";
    assert_eq!(drive.ask(VLT, change).unwrap(), hex("05 02 00 02"));
    let written = [(1, 0, 2, Keep::Volatile), (341, 0, 500, Keep::Volatile)];
    assert_eq!(drive.writes, written);
}
