//! Every worked exchange that a manual prints, whole: the client writes these octets, the drive reads them out again and
//! answers those octets, the client reads what was printed.

use alloc::vec;
use alloc::vec::Vec;

use super::*;

/// A drive that has just what the exchange is about.
#[derive(Clone)]
struct Printed {
    /// PNU, what it is, its values from subindex 0 (of PNU 10001: at the subindex requested).
    rows: Vec<(u16, Attributes, Vec<u64>)>,
    /// Its error number for any read or write of a row marked as failing.
    refuses: Option<ErrorNumber>,
    written: Vec<(u16, u16, u64)>,
}

impl Printed {
    fn new(rows: &[(u16, Attributes, &[u64])]) -> Self {
        Self {
            rows: rows
                .iter()
                .map(|(pnu, facts, values)| (*pnu, *facts, values.to_vec()))
                .collect(),
            refuses: None,
            written: vec![],
        }
    }

    fn refusing(mut self, number: u16) -> Self {
        self.refuses = Some(ErrorNumber(number));
        self
    }

    fn row(&self, pnu: u16, subindex: u16) -> Option<&(u16, Attributes, Vec<u64>)> {
        let fits = |facts: &Attributes| pnu != 10001 || facts.first == subindex;
        self.rows.iter().find(|row| row.0 == pnu && fits(&row.1))
    }
}

impl ParameterAccess for Printed {
    fn attributes(&self, pnu: u16, subindex: u16) -> Option<Attributes> {
        self.row(pnu, subindex).map(|row| row.1)
    }

    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        let (_, facts, values) = self.row(pnu, subindex).unwrap();
        self.refuses
            .map_or(Ok(values[usize::from(subindex - facts.first)]), Err)
    }

    fn write(&mut self, pnu: u16, subindex: u16, raw: u64, _: Keep) -> Result<(), ErrorNumber> {
        if let Some(number) = self.refuses {
            return Err(number);
        }
        self.written.push((pnu, subindex, raw));
        Ok(())
    }
}

/// What a client requests, or what was written after it.
enum Wish<'a> {
    Read(&'a [ParameterAddress]),
    Change(&'a [NewValue<'a>]),
}

/// One answer as the client has it.
#[derive(Debug, Clone, PartialEq)]
enum Got {
    Numbers(Vec<u64>),
    Written,
    Refused(u16, Option<u16>),
}

#[track_caller]
fn exchange(
    dialect: &Dialect,
    wish: &Wish<'_>,
    request: &str,
    drive: Printed,
    response: &str,
    got: &[Got],
) -> Printed {
    let (octets, answer) = (hex(request), hex(response));
    let mut drive = drive;
    // the client's octets
    let mut out = [0; 240];
    let (id, addresses) = match wish {
        Wish::Read(addresses) => (RequestId::Read, addresses.to_vec()),
        Wish::Change(values) => (
            RequestId::Change,
            values.iter().map(|value| value.address).collect(),
        ),
    };
    let length = match wish {
        Wish::Read(addresses) => encode_read(octets[0], dialect, addresses, &mut out).unwrap(),
        Wish::Change(values) => encode_change(octets[0], dialect, values, &mut out).unwrap(),
    };
    assert_eq!(out[..length], octets, "{request}");
    // read out again
    let parsed = Request::parse(&octets, dialect.code_space).unwrap();
    assert_eq!(
        (parsed.id(), parsed.reference(), parsed.axis()),
        (id, octets[0], dialect.axis)
    );
    assert_eq!(parsed.addresses().collect::<Vec<_>>(), addresses);
    // answered
    let length = serve(&octets, dialect, &mut drive, &mut out).unwrap();
    assert_eq!(
        out[..length],
        answer,
        "answer to {request}: {:02X?}",
        &out[..length]
    );
    // and decoded
    let parsed = Response::parse(&answer, id, octets[0], &addresses, dialect).unwrap();
    let answers: Vec<Got> = parsed
        .answers()
        .map(|answer| match answer {
            Answer::Values(block) => {
                let count = u16::from(block.count);
                Got::Numbers((0..count).map(|at| block.raw(at.into()).unwrap()).collect())
            }
            Answer::Written => Got::Written,
            Answer::Error(error) => Got::Refused(error.number.0, error.info),
        })
        .collect();
    assert_eq!(answers, got);
    drive
}

const WORD: Attributes = Attributes::simple(Format::UNSIGNED16, 2, true);
const DOUBLE: Attributes = Attributes::simple(Format::UNSIGNED32, 4, true);

const fn address(pnu: u16) -> ParameterAddress {
    ParameterAddress::value(pnu, 0)
}

const fn new(address: ParameterAddress, format: Format, data: &[u8]) -> NewValue<'_> {
    NewValue {
        address,
        format,
        count: 1,
        data,
    }
}

/// Vacon OPTE9 p. 31-32, and the change of the same ID.
#[test]
fn of_a_vacon() {
    let identification = Attributes {
        elements: 6,
        ..Attributes::simple(Format::UNSIGNED16, 2, false)
    };
    let values = [0x01BA, 2, 100, 0x07DE, 0x65, 1];
    exchange(
        &Dialect::VACON,
        &Wish::Read(&[ParameterAddress::values(964, 0, 6)]),
        "02 01 01 01 10 06 03 C4 00 00",
        Printed::new(&[(964, identification, &values)]),
        "02 01 01 01 42 06 01 BA 00 02 00 64 07 DE 00 65 00 01",
        &[Got::Numbers(values.to_vec())],
    );
    let id103 = Attributes { first: 103, ..WORD };
    let drive = Printed::new(&[(10001, id103, &[50])]);
    let at = ParameterAddress::value(10001, 103);
    exchange(
        &Dialect::VACON,
        &Wish::Read(&[at]),
        "03 01 01 01 10 01 27 11 00 67",
        drive.clone(),
        "03 01 01 01 42 01 00 32",
        &[Got::Numbers(vec![50])],
    );
    let drive = exchange(
        &Dialect::VACON,
        &Wish::Change(&[new(at, Format::WORD, &[0, 50])]),
        "04 02 01 01 10 01 27 11 00 67 42 01 00 32",
        drive,
        "04 02 01 01",
        &[Got::Written],
    );
    assert_eq!(drive.written, [(10001, 103, 50)]);
}

/// AKD manual 3.6.2, with the six octets of its positive answer; a double word and a refusal as Lenze prints them on axis 0.
#[test]
fn on_axis_0() {
    let akd = &Dialect::AKD;
    let drive = exchange(
        akd,
        &Wish::Change(&[new(address(930), Format::WORD, &[0, 2])]),
        "05 02 00 01 10 01 03 A2 00 00 42 01 00 02",
        Printed::new(&[(930, WORD, &[1])]),
        "05 02 00 01 00 00",
        &[Got::Written],
    );
    assert_eq!(drive.written, [(930, 0, 2)]);
    exchange(
        akd,
        &Wish::Read(&[address(930)]),
        "07 01 00 01 10 01 03 A2 00 00",
        Printed::new(&[(930, DOUBLE, &[43])]),
        "07 01 00 01 43 01 00 00 00 2B",
        &[Got::Numbers(vec![43])],
    );
    for number in [0x00, 0x11, 0x20, 0x65] {
        exchange(
            akd,
            &Wish::Read(&[address(930)]),
            "07 01 00 01 10 01 03 A2 00 00",
            Printed::new(&[(930, WORD, &[0])]).refusing(number),
            &alloc::format!("07 81 00 01 44 01 00 {number:02X}"),
            &[Got::Refused(number, None)],
        );
    }
    // two at once, the second not there
    exchange(
        akd,
        &Wish::Read(&[address(930), address(0xFFFE)]),
        "07 01 00 02 10 01 03 A2 00 00 10 01 FF FE 00 00",
        Printed::new(&[(930, WORD, &[2])]),
        "07 81 00 02 42 01 00 02 44 01 00 00",
        &[Got::Numbers(vec![2]), Got::Refused(0, None)],
    );
    // two changes, the second cannot be changed
    let fixed = Attributes::simple(Format::UNSIGNED16, 2, false);
    let both = [
        new(address(930), Format::WORD, &[0, 1]),
        new(address(922), Format::WORD, &[0, 1]),
    ];
    let drive = exchange(
        akd,
        &Wish::Change(&both),
        "08 02 00 02 10 01 03 A2 00 00 10 01 03 9A 00 00 42 01 00 01 42 01 00 01",
        Printed::new(&[(930, WORD, &[2]), (922, fixed, &[1])]),
        "08 82 00 02 40 00 44 01 00 01",
        &[Got::Written, Got::Refused(1, None)],
    );
    assert_eq!(drive.written, [(930, 0, 1)]);
}

/// Toshiba p. 32 and 40, FENA p. 351, G120X p. 258: axis 1, true types, four octets confirm that all is written.
#[test]
fn of_the_profile() {
    let standard = &Dialect::STANDARD;
    let priority = new(address(927), Format::UNSIGNED16, &[0, 0]);
    let request = "01 02 01 01 10 01 03 9F 00 00 06 01 00 00";
    let drive = Printed::new(&[(927, WORD, &[1])]);
    exchange(
        standard,
        &Wish::Change(&[priority]),
        request,
        drive.clone(),
        "01 02 01 01",
        &[Got::Written],
    );
    exchange(
        standard,
        &Wish::Change(&[priority]),
        request,
        drive.refusing(1),
        "01 82 01 01 44 01 00 01",
        &[Got::Refused(1, None)],
    );
    // FENA prints the word under its substitution code
    let words = Dialect {
        substitution_only: true,
        ..Dialect::STANDARD
    };
    exchange(
        &words,
        &Wish::Read(&[address(930)]),
        "0B 01 01 01 10 01 03 A2 00 00",
        Printed::new(&[(930, WORD, &[0x0C05])]),
        "0B 01 01 01 42 01 0C 05",
        &[Got::Numbers(vec![0x0C05])],
    );
    let float = Attributes::simple(Format::FLOAT32, 4, true);
    let drive = exchange(
        standard,
        &Wish::Change(&[new(address(1121), Format::FLOAT32, &12.15_f32.to_be_bytes())]),
        "80 02 01 01 10 01 04 61 00 00 08 01 41 42 66 66",
        Printed::new(&[(1121, float, &[0])]),
        "80 02 01 01",
        &[Got::Written],
    );
    assert_eq!(drive.written, [(1121, 0, 0x4142_6666)]);
}

/// An error block with its additional word, both ways: the element at which a change of an array stopped, and the printed
/// one, whose word is 0.
#[test]
fn with_additional_information() {
    let array = Attributes { elements: 3, ..WORD };
    let addresses = [address(930), ParameterAddress::value(915, 2)];
    let fixed = Attributes {
        writable: false,
        ..array
    };
    let both = [
        new(addresses[0], Format::WORD, &[0, 1]),
        new(addresses[1], Format::WORD, &[0, 1]),
    ];
    exchange(
        &Dialect {
            axis: 0,
            ..Dialect::STANDARD
        },
        &Wish::Change(&both),
        "08 02 00 02 10 01 03 A2 00 00 10 01 03 93 00 02 42 01 00 01 42 01 00 01",
        Printed::new(&[(930, WORD, &[2]), (915, fixed, &[1, 2, 3])]),
        "08 82 00 02 40 00 44 02 00 01 00 02",
        &[Got::Written, Got::Refused(1, Some(2))],
    );
    let printed = hex("08 82 00 02 40 00 44 02 00 01 00 00");
    let parsed = Response::parse(&printed, RequestId::Change, 8, &addresses, &Dialect::AKD).unwrap();
    let answers: Vec<Answer<'_>> = parsed.answers().collect();
    let refused = ParameterError {
        number: ErrorNumber(1),
        info: Some(0),
    };
    assert_eq!(answers, [Answer::Written, Answer::Error(refused)]);
}
