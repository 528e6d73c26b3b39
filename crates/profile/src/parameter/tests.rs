//! Byte examples of the manuals, the rules of the parameter manager, and damage.

mod converter;
mod edge;
mod examples;
mod formats;
mod properties;
mod vacon;
mod vendors;

use alloc::borrow::ToOwned;
use alloc::vec;
use alloc::vec::Vec;

use super::*;

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace()
        .map(|octet| u8::from_str_radix(octet, 16).unwrap())
        .collect()
}

/// A drive with a handful of parameters.
struct Bench {
    words: [u16; 64],
    mode: u16,
    speed: u8,
    long: i32,
    rights: bool,
}

impl Default for Bench {
    fn default() -> Self {
        let mut words = [0; 64];
        words[..6].copy_from_slice(&[0x01BA, 2, 100, 2014, 101, 1]);
        Self {
            words,
            mode: 2,
            speed: 7,
            long: -5,
            rights: true,
        }
    }
}

impl ParameterAccess for Bench {
    fn attributes(&self, pnu: u16, _: u16) -> Option<Attributes> {
        let (format, octets, elements, writable) = match pnu {
            922 => (Format::UNSIGNED16, 2, 0, false),
            930 => (Format::UNSIGNED16, 2, 0, true),
            947 => (Format::UNSIGNED16, 2, 64, false),
            915 => (Format::UNSIGNED16, 2, 12, true),
            964 => (Format::UNSIGNED16, 2, 6, false),
            2135 => (Format::UNSIGNED8, 1, 0, true),
            2004 => (Format::INTEGER32, 4, 0, true),
            _ => return None,
        };
        Some(Attributes {
            elements,
            ..Attributes::simple(format, octets, writable)
        })
    }

    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        Ok(match pnu {
            922 => 1,
            930 => self.mode.into(),
            2135 => self.speed.into(),
            2004 => i64::from(self.long).cast_unsigned(),
            947 => 0,
            _ => self.words[usize::from(subindex)].into(),
        })
    }

    fn write(&mut self, pnu: u16, subindex: u16, raw: u64, _: Keep) -> Result<(), ErrorNumber> {
        match pnu {
            930 if raw == 0 || raw > 2 => return Err(ErrorNumber::LIMIT),
            930 => self.mode = raw as u16,
            2135 => self.speed = raw as u8,
            2004 => self.long = raw as i32,
            915 if raw > 1000 => return Err(ErrorNumber::VALUE),
            _ => self.words[usize::from(subindex)] = raw as u16,
        }
        Ok(())
    }

    fn may_change(&self, _: u16) -> bool {
        self.rights
    }

    fn description(&self, pnu: u16) -> Option<Description> {
        (pnu == 922).then(Description::default)
    }
}

fn ask(dialect: &Dialect, request: &str) -> Result<Vec<u8>, Refusal> {
    ask_of(&mut Bench::default(), dialect, request)
}

fn ask_of(drive: &mut Bench, dialect: &Dialect, request: &str) -> Result<Vec<u8>, Refusal> {
    let mut out = [0xA5; 512];
    serve(&hex(request), dialect, drive, &mut out).map(|length| out[..length].to_vec())
}

/// Requests out of the manuals (AKD 3.6.2, OPTE9 p. 32, Toshiba p. 32, G120X p. 258): the bytes, what they mean, and the same bytes written again.
#[test]
fn worked_requests() {
    let read = |bytes: &str, dialect: Dialect, address: ParameterAddress| {
        let bytes = hex(bytes);
        let request = Request::parse(&bytes, dialect.code_space).unwrap();
        assert_eq!((request.id(), request.axis()), (RequestId::Read, dialect.axis));
        assert_eq!(request.addresses().collect::<Vec<_>>(), [address]);
        let mut out = [0; 240];
        let length = encode_read(request.reference(), &dialect, &[address], &mut out).unwrap();
        assert_eq!(out[..length], bytes);
    };
    read(
        "02 01 01 01 10 06 03 C4 00 00",
        Dialect::VACON,
        ParameterAddress::values(964, 0, 6),
    );
    read(
        "03 01 01 01 10 01 27 11 00 67",
        Dialect::VACON,
        ParameterAddress::value(10001, 103),
    );

    let change = |bytes: &str, dialect: Dialect, pnu, format, data: &[u8]| {
        let bytes = hex(bytes);
        let request = Request::parse(&bytes, dialect.code_space).unwrap();
        assert_eq!(request.id(), RequestId::Change);
        let address = ParameterAddress::value(pnu, 0);
        assert_eq!(request.addresses().collect::<Vec<_>>(), [address]);
        let block = request.values().next().unwrap().unwrap();
        assert_eq!((block.format, block.count, block.data), (format, 1, data));
        let mut out = [0; 240];
        let value = NewValue {
            address,
            format,
            count: 1,
            data,
        };
        let length = encode_change(request.reference(), &dialect, &[value], &mut out).unwrap();
        assert_eq!(out[..length], bytes);
    };
    change(
        "05 02 00 01 10 01 03 A2 00 00 42 01 00 02",
        Dialect::AKD,
        930,
        Format::WORD,
        &[0, 2],
    );
    change(
        "01 02 01 01 10 01 03 9F 00 00 06 01 00 00",
        Dialect::STANDARD,
        927,
        Format::UNSIGNED16,
        &[0, 0],
    );
    let float = "80 02 01 01 10 01 04 61 00 00 08 01 41 42 66 66";
    change(
        float,
        Dialect::STANDARD,
        1121,
        Format::FLOAT32,
        &[0x41, 0x42, 0x66, 0x66],
    );
}

/// Responses out of the manuals (OPTE9 p. 32, FENA p. 351, Lenze p. 52, Toshiba, AKD 3.6.2 and its byte description).
#[test]
fn worked_responses() {
    let parse = |bytes: &str, id, reference, addresses: &[ParameterAddress], dialect| {
        let bytes = hex(bytes);
        let response = Response::parse(&bytes, id, reference, addresses, &dialect).unwrap();
        response
            .answers()
            .map(|answer| match answer {
                Answer::Values(block) => Ok((0..block.count.into())
                    .map(|index| block.raw(index).unwrap())
                    .collect::<Vec<_>>()),
                Answer::Written => Ok(vec![]),
                Answer::Error(error) => Err((error.number.0, error.info)),
            })
            .collect::<Vec<_>>()
    };
    let (read, change) = (RequestId::Read, RequestId::Change);
    let one = [ParameterAddress::value(930, 0)];
    let two = [one[0], ParameterAddress::value(65534, 0)];
    let id964 = [ParameterAddress::values(964, 0, 6)];
    let words = "02 01 01 01 42 06 01 BA 00 02 00 64 07 DE 00 65 00 01";
    assert_eq!(
        parse(words, read, 2, &id964, Dialect::VACON),
        [Ok(vec![0x01BA, 2, 100, 2014, 101, 1])]
    );
    assert_eq!(
        parse("0B 01 01 01 42 01 0C 05", read, 11, &one, Dialect::STANDARD),
        [Ok(vec![0x0C05])]
    );
    assert_eq!(
        parse("07 01 00 01 43 01 00 00 00 2B", read, 7, &one, Dialect::AKD),
        [Ok(vec![43])]
    );
    assert_eq!(
        parse("07 81 00 01 44 01 00 11", read, 7, &one, Dialect::AKD),
        [Err((0x11, None))]
    );
    assert_eq!(
        parse("01 02 01 01", change, 1, &one, Dialect::STANDARD),
        [Ok(vec![])]
    );
    assert_eq!(
        parse("01 82 01 01 44 01 00 01", change, 1, &one, Dialect::STANDARD),
        [Err((1, None))]
    );
    assert_eq!(
        parse("05 02 00 01 00 00", change, 5, &one, Dialect::AKD),
        [Ok(vec![])]
    );
    let mixed = parse("07 81 00 02 42 01 00 02 44 01 00 00", read, 7, &two, Dialect::AKD);
    assert_eq!(mixed, [Ok(vec![2]), Err((0, None))]);
    let mixed = parse(
        "08 82 00 02 40 00 44 02 00 01 00 00",
        change,
        8,
        &two,
        Dialect::AKD,
    );
    assert_eq!(mixed, [Ok(vec![]), Err((1, Some(0)))]);
    // the parameter access note repeats the address before the value
    let repeated = parse(
        "09 01 00 01 10 01 03 A2 00 00 42 01 00 02",
        read,
        9,
        &one,
        Dialect::AKD,
    );
    assert_eq!(repeated, [Ok(vec![2])]);
    // the note prints the same columns for a change; zeros may come once for all, once each, or as format 0x40
    let addressed = parse(
        "09 02 00 01 10 01 03 A2 00 00 00 00",
        change,
        9,
        &one,
        Dialect::AKD,
    );
    assert_eq!(addressed, [Ok(vec![])]);
    for blocks in ["", "00 00", "00 00 00 00", "40 00 40 00"] {
        let bytes = hex(&alloc::format!("08 02 00 02 {blocks}"));
        let response = Response::parse(&bytes, change, 8, &two, &Dialect::AKD).unwrap();
        let answers: Vec<_> = response.answers().collect();
        assert_eq!(answers, [Answer::Written, Answer::Written], "{blocks}");
    }
    // no pad octet at the end
    assert_eq!(
        parse("09 01 00 01 41 01 07", read, 9, &one, Dialect::AKD),
        [Ok(vec![7])]
    );
}

/// Byte examples served: AKD manual 3.6.2, OPTE9 p. 32.
#[test]
fn worked_answers() {
    let (akd, vacon) = (Dialect::AKD, Dialect::VACON);
    let served = |dialect, request| ask(dialect, request).unwrap();
    assert_eq!(
        served(&akd, "05 02 00 01 10 01 03 A2 00 00 42 01 00 02"),
        hex("05 02 00 01 00 00")
    );
    let standard = served(&Dialect::STANDARD, "05 02 01 01 10 01 03 A2 00 00 06 01 00 02");
    assert_eq!(standard, hex("05 02 01 01"));
    let words = hex("02 01 01 01 42 06 01 BA 00 02 00 64 07 DE 00 65 00 01");
    assert_eq!(served(&vacon, "02 01 01 01 10 06 03 C4 00 00"), words);
    let mixed = served(&akd, "07 01 00 02 10 01 03 A2 00 00 10 01 FF FE 00 00");
    assert_eq!(mixed, hex("07 81 00 02 42 01 00 02 44 01 00 00"));
    let mixed = "08 02 00 02 10 01 03 A2 00 00 10 01 03 9A 00 00 42 01 00 01 42 01 00 01";
    assert_eq!(served(&akd, mixed), hex("08 82 00 02 40 00 44 01 00 01"));
    assert_eq!(
        served(&akd, "09 01 00 01 10 01 08 57 00 00"),
        hex("09 01 00 01 41 01 07 00")
    );
    assert_eq!(
        served(&akd, "09 01 00 01 10 01 07 D4 00 00"),
        hex("09 01 00 01 43 01 FF FF FF FB")
    );
    // odd value with its pad octet (checklist 31), and without
    for request in [
        "1F 02 00 01 10 01 08 57 00 00 41 01 02 00",
        "1F 02 00 01 10 01 08 57 00 00 41 01 02",
    ] {
        let mut drive = Bench::default();
        assert_eq!(
            ask_of(&mut drive, &akd, request).unwrap(),
            hex("1F 02 00 01 00 00")
        );
        assert_eq!(drive.speed, 2);
    }
}

/// What is refused, and how. Numbers of the conformance checklist where it has them.
#[test]
fn refusals() {
    let number = |dialect: &Dialect, request: &str| {
        let answer = ask(dialect, request).unwrap();
        assert_eq!(answer[1] & 0x80, 0x80, "{request}");
        assert_eq!(answer[4], 0x44);
        u16::from_be_bytes([answer[6], answer[7]])
    };
    let akd = &Dialect::AKD;
    assert_eq!(number(akd, "07 01 00 01 10 01 03 9A 00 05"), 0x04, "checklist 7");
    assert_eq!(number(akd, "0A 01 00 01 50 01 03 9A 00 00"), 0x16, "checklist 10");
    assert_eq!(
        number(&Dialect::VACON, "0A 01 01 01 50 01 03 9A 00 00"),
        0x69,
        "checklist 10"
    );
    assert_eq!(number(akd, "0A 01 00 01 10 02 03 9A 00 00"), 0x16);
    assert_eq!(number(akd, "0A 01 00 01 10 01 03 B3 00 40"), 0x03);
    assert_eq!(number(akd, "0A 01 00 01 10 02 03 B3 00 3F"), 0x03);
    assert_eq!(number(akd, "0A 01 00 01 10 00 03 B3 00 00"), 0x16);
    assert_eq!(number(akd, "0A 01 00 01 10 EB 03 B3 00 00"), 0x16);
    assert_eq!(number(akd, "0A 01 01 01 10 01 03 9A 00 00"), 0x19);
    assert_eq!(number(akd, "34 01 00 01 30 01 03 9A 00 00"), 0x0F, "checklist 52");
    assert_eq!(number(akd, "34 01 00 01 30 02 03 9A FF FF"), 0x0F);
    assert_eq!(number(akd, "34 01 00 01 20 01 03 A2 00 00"), 0x09);
    assert_eq!(number(akd, "0A 07 00 01 10 01 03 9A 00 00"), 0x21);
    assert_eq!(
        ask(&Dialect::VACON, "0A 07 01 01 10 01 03 9A 00 00").unwrap()[1],
        0x80
    );
    assert_eq!(
        number(&Dialect::VACON, "00 01 01 01 10 01 03 9A 00 00"),
        0x65,
        "checklist 37"
    );
    assert_eq!(number(akd, "01 02 00 01 10 01 03 9A 00 00 42 01 00 01"), 0x01);
    assert_eq!(number(akd, "01 02 00 01 10 01 03 A2 00 00 42 01 00 09"), 0x02);
    assert_eq!(
        number(akd, "01 02 00 01 10 01 03 A2 00 00 50 01 00 01"),
        0x17,
        "checklist 25"
    );
    assert_eq!(number(akd, "01 02 00 01 10 01 03 A2 00 00 40 00"), 0x17);
    assert_eq!(
        number(akd, "01 02 00 01 10 01 03 A2 00 00 42 02 00 01 00 01"),
        0x18
    );
    assert_eq!(
        number(akd, "01 02 00 01 10 01 03 A2 00 00 43 01 00 00 00 01"),
        0x05
    );
    assert_eq!(number(akd, "01 02 00 01 10 01 03 A2 00 00 42 01 00"), 0x18);
    assert_eq!(
        number(&Dialect::VACON, "01 02 01 01 10 01 03 A2 00 00 42 01 00"),
        0x6B
    );
    assert_eq!(number(akd, "01 02 00 01 20 01 03 A2 00 00 42 01 00 01"), 0x07);
    assert_eq!(number(akd, "01 02 00 01 30 01 03 A2 00 00 42 01 00 01"), 0x20);
    let mut locked = Bench {
        rights: false,
        ..Bench::default()
    };
    let answer = ask_of(&mut locked, akd, "01 02 00 01 10 01 03 A2 00 00 42 01 00 01").unwrap();
    assert_eq!(answer, hex("01 82 00 01 44 01 00 0B"));
    // both the type and its substitution are taken (checklist 28)
    for format in ["06", "42"] {
        let request = alloc::format!("01 02 00 01 10 01 03 A2 00 00 {format} 01 00 01");
        assert_eq!(ask(akd, &request).unwrap()[1], 2);
    }
    // the error of an array reports the element, those before it are written
    let mut drive = Bench::default();
    let request = "01 02 00 01 10 03 03 93 00 02 42 03 00 05 FF FF 00 06";
    assert_eq!(
        ask_of(&mut drive, akd, request).unwrap(),
        hex("01 82 00 01 44 02 00 14 00 03")
    );
    assert_eq!(drive.words[2..5], [5, 2014, 101]);
}

#[test]
fn impossible_numbers_of_parameters() {
    let head =
        |count: u8| alloc::format!("01 01 00 {count:02X} ") + &"10 01 03 9A 00 00 ".repeat(count.into());
    assert_eq!(
        ask(&Dialect::AKD, &head(40)),
        Err(Refusal::Parameters {
            found: 40,
            allowed: 39
        }),
        "checklist 13"
    );
    assert_eq!(
        ask(&Dialect::AKD, &head(0)),
        Err(Refusal::Parameters {
            found: 0,
            allowed: 39
        })
    );
    assert_eq!(
        ask(&Dialect::VLT, &head(38)),
        Err(Refusal::Parameters {
            found: 38,
            allowed: 37
        })
    );
    assert_eq!(
        ask(&Dialect::VACON, &head(40)).unwrap(),
        hex(&("01 81 00 28".to_owned() + &" 44 01 00 68".repeat(40))),
        "as many answers as the header says"
    );
    assert_eq!(
        ask(&Dialect::VACON, &head(60)).unwrap(),
        hex("01 81 00 01 44 01 00 68"),
        "no room for so many, and the header says so"
    );
    assert_eq!(ask(&Dialect::AKD, "01 01 00"), Err(Refusal::Length));
    assert_eq!(
        ask(&Dialect::AKD, "01 01 00 02 10 01 03 9A 00 00"),
        Err(Refusal::Length)
    );
    assert_eq!(
        ask(&Dialect::AKD, "01 01 00 01 10 01 03 9A 00 00 01"),
        Err(Refusal::Length)
    );
    assert!(
        ask(&Dialect::AKD, "01 01 00 01 10 01 03 9A 00 00 00 00").is_ok(),
        "zeros behind a read request"
    );
    assert_eq!(ask(&Dialect::AKD, &head(39)).unwrap().len(), 4 + 39 * 4);
}

/// Checklist 19: 39 times eight elements do not fit; every answer is there, none is cut.
#[test]
fn responses_never_exceed_the_block() {
    let request = alloc::string::String::from("01 01 00 27 ") + &"10 08 03 B3 00 00 ".repeat(39);
    let answer = ask(&Dialect::AKD, &request).unwrap();
    assert!(answer.len() <= 240, "{}", answer.len());
    let addresses = [ParameterAddress::values(947, 0, 8); 39];
    let response = Response::parse(&answer, RequestId::Read, 1, &addresses, &Dialect::AKD).unwrap();
    let answers: Vec<_> = response.answers().collect();
    assert_eq!(answers.len(), 39);
    assert!(matches!(answers[0], Answer::Values(block) if block.count == 8));
    assert!(matches!(answers[38], Answer::Error(error) if error.number == ErrorNumber::TOO_LONG));
    // one array of 117 words just fits, 118 do not
    assert_eq!(
        ask(&Dialect::AKD, "01 01 00 01 10 40 03 B3 00 00").unwrap().len(),
        4 + 2 + 128
    );
}

/// A request that is wrong as a whole gets as many answers as its header indicates.
#[test]
fn whole_requests_are_refused_parameter_by_parameter() {
    let two = "10 01 03 9A 00 00 10 01 03 A2 00 00";
    let served = |dialect, head: &str| ask(dialect, &alloc::format!("{head} {two}")).unwrap();
    let akd = hex("0A 81 00 02 44 01 00 21 44 01 00 21");
    assert_eq!(served(&Dialect::AKD, "0A 07 00 02"), akd);
    let vacon = hex("0A 80 01 02 44 01 00 21 44 01 00 21");
    assert_eq!(served(&Dialect::VACON, "0A 07 01 02"), vacon);
    let reference = hex("00 81 01 02 44 01 00 65 44 01 00 65");
    assert_eq!(served(&Dialect::VACON, "00 01 01 02"), reference);
    let asked = [ParameterAddress::value(922, 0), ParameterAddress::value(930, 0)];
    let parse =
        |bytes: &[u8], dialect| Response::parse(bytes, RequestId::Read, 10, &asked, dialect).map(|_| ());
    let refused = |number: u16| {
        Err(ResponseError::Refused(ParameterError {
            number: ErrorNumber(number),
            info: None,
        }))
    };
    assert_eq!(parse(&vacon, &Dialect::VACON), refused(0x21));
    assert_eq!(
        parse(&hex("0A 81 01 28 44 01 00 68"), &Dialect::VACON),
        refused(0x68)
    );
    // as many errors as parameters are answers to the parameters
    assert_eq!(parse(&akd, &Dialect::AKD), Ok(()));
    // not the answer to a read, whatever it carries
    assert!(matches!(
        parse(&hex("0A 82 00 02 44 01 00 01 44 01 00 01"), &Dialect::AKD),
        Err(ResponseError::Id { .. })
    ));
}

/// What stands behind the values: zeros of a buffer of fixed length are nothing, anything else is not a request, and
/// then nothing is written.
#[test]
fn octets_behind_a_change() {
    let change = "05 02 00 01 10 01 03 A2 00 00 42 01 00 01";
    let mut drive = Bench::default();
    let request = alloc::format!("{change} 00 01");
    assert_eq!(ask_of(&mut drive, &Dialect::AKD, &request), Err(Refusal::Length));
    assert_eq!(drive.mode, 2, "nothing is written");
    let request = alloc::format!("{change} 00 00 00");
    assert_eq!(
        ask_of(&mut drive, &Dialect::AKD, &request).unwrap(),
        hex("05 02 00 01 00 00")
    );
    assert_eq!(drive.mode, 1);
}

/// Checklist 34: values between the addresses are not taken for a request.
#[test]
fn interleaved_blocks_are_refused() {
    let request = "01 02 00 02 10 01 03 A2 00 00 42 01 00 01 10 01 08 57 00 00 41 01 02 00";
    let mut drive = Bench::default();
    let answer = ask_of(&mut drive, &Dialect::AKD, request).unwrap();
    assert_eq!(answer[1], 0x82);
    assert_eq!((drive.mode, drive.speed), (2, 7), "nothing may be written");
}

#[test]
fn description_elements() {
    let whole = ask(&Dialect::AKD, "2E 01 00 01 20 01 03 9A 00 00").unwrap();
    assert_eq!((whole.len(), whole[4], whole[5]), (52, 0x0A, 46), "checklist 46");
    let name = ask(&Dialect::AKD, "2E 01 00 01 20 01 03 9A 00 06").unwrap();
    assert_eq!((name.len(), name[5]), (22, 16));
    assert_eq!(
        ask(&Dialect::AKD, "2E 01 00 01 20 01 03 9A 00 0D").unwrap(),
        hex("2E 81 00 01 44 02 00 03 00 0D")
    );
}

#[test]
fn wrong_responses_are_distinguished() {
    let one = [ParameterAddress::value(930, 0)];
    let parse = |bytes: &str| {
        let bytes = hex(bytes);
        Response::parse(&bytes, RequestId::Read, 9, &one, &Dialect::AKD).map(|_| ())
    };
    assert_eq!(
        parse("08 01 00 01 42 01 00 02"),
        Err(ResponseError::Reference {
            expected: 9,
            found: 8
        })
    );
    assert_eq!(
        parse("09 02 00 01 42 01 00 02"),
        Err(ResponseError::Id { request: 1, found: 2 })
    );
    assert_eq!(
        parse("09 01 01 01 42 01 00 02"),
        Err(ResponseError::Axis {
            expected: 0,
            found: 1
        })
    );
    assert_eq!(
        parse("09 01 00 02 42 01 00 02"),
        Err(ResponseError::Parameters {
            expected: 1,
            found: 2
        })
    );
    assert!(matches!(
        parse("09 01 00 01 42 01 00"),
        Err(ResponseError::Malformed(_))
    ));
    assert!(matches!(
        parse("09 01 00 01 42 01 00 02 00 00"),
        Err(ResponseError::Malformed(_))
    ));
    // as many values as elements; "written" is not an answer to a read
    for (bytes, found) in [
        ("09 01 00 01 42 02 00 02 00 03", 2),
        ("09 01 00 01 42 00", 0),
        ("09 01 00 01 40 00", 0),
    ] {
        let (pnu, expected) = (930, 1);
        assert_eq!(parse(bytes), Err(ResponseError::Values { pnu, expected, found }));
    }
    assert_eq!(
        parse("09 01 00 01 09 03 41 4B 44 00"),
        Ok(()),
        "a string has its own length"
    );
    let refused = ParameterError {
        number: ErrorNumber(0x21),
        info: None,
    };
    assert_eq!(
        parse("09 80 00 01 44 01 00 21"),
        Err(ResponseError::Refused(refused))
    );
}

#[test]
fn arrays_are_split_and_changes_packed() {
    let parts = split_array(980, 0, 300, 2, &Dialect::AKD);
    assert_eq!(
        parts
            .iter()
            .map(|part| (part.subindex, part.elements))
            .collect::<Vec<_>>(),
        [(0, 117), (117, 117), (234, 66)]
    );
    assert_eq!(plan_changes(&[4; 40], &Dialect::AKD), [0..19, 19..38, 38..40]);
    assert_eq!(plan_changes(&[2; 24], &Dialect::AKD), [0..23, 23..24]);
    assert!(plan_changes(&[], &Dialect::AKD).is_empty());
    // a single item that is too long still gets a request of its own; the drive refuses it
    assert_eq!(plan_changes(&[500, 2], &Dialect::AKD), [0..1, 1..2]);
}
