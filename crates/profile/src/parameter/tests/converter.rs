//! A frequency converter of a few table rows, for the dialects of VLT and Vacon.

use alloc::collections::BTreeMap;
use alloc::vec;
use alloc::vec::Vec;

use super::hex;
use crate::parameter::*;

/// PNU, what it is, lowest and highest number.
const ROWS: &[(u16, Attributes, i64, i64)] = &[
    (1, Attributes::simple(Format::UNSIGNED8, 1, true), 0, 52),
    (100, Attributes::simple(Format::INTEGER8, 1, true), -100, 100),
    (
        101,
        Attributes::simple(Format::INTEGER16, 2, true),
        -20_000,
        20_000,
    ),
    (
        303,
        Attributes::simple(Format::INTEGER32, 4, true),
        -5_000_000,
        5_000_000,
    ),
    (341, Attributes::simple(Format::UNSIGNED32, 4, true), 1, 360_000),
    (414, Attributes::simple(Format::UNSIGNED16, 2, true), 0, 1320),
    (922, Attributes::simple(Format::UNSIGNED16, 2, false), 0, 0xFFFF),
    (924, array(Format::UNSIGNED16, 2, 240, false), 0, 0xFFFF),
    (925, array(Format::UNSIGNED8, 1, 240, false), 0, 0xFF),
    (930, Attributes::simple(Format::UNSIGNED16, 2, true), 1, 2),
    (947, array(Format::UNSIGNED16, 2, 64, false), 0, 0xFFFF),
    (967, Attributes::simple(Format::V2, 2, true), 0, 0xFFFF),
    (1007, Attributes::string(12, true), 0, 0xFF),
    (1530, array(Format::UNSIGNED8, 1, 10, false), 0, 0xFF),
    (1540, Attributes::string(20, false), 0, 0xFF),
    (1553, Attributes::strings(8, 20, true), 0, 0xFF),
    (1600, Attributes::simple(Format::N2, 2, true), -0x8000, 0x7FFF),
    (
        1610,
        Attributes {
            format: Format::OCTET_STRING,
            ..Attributes::string(4, true)
        },
        0,
        0xFF,
    ),
    (
        1623,
        Attributes::simple(Format::TIME_DIFFERENCE, 4, true),
        0,
        0xFFFF_FFFF,
    ),
    (1699, Attributes::simple(Format::UNSIGNED16, 2, false), 0, 0),
    (10001, member(103), 1, 30_000),
    (10001, member(104), 1, 30_000),
    (
        10001,
        Attributes {
            elements: 3,
            ..member(1700)
        },
        0,
        0xFFFF,
    ),
];

const fn array(format: Format, octets: usize, elements: u16, writable: bool) -> Attributes {
    Attributes {
        elements,
        ..Attributes::simple(format, octets, writable)
    }
}

const fn member(first: u16) -> Attributes {
    Attributes {
        first,
        ..Attributes::simple(Format::UNSIGNED16, 2, true)
    }
}

#[derive(Default)]
pub(super) struct Converter {
    /// Numbers by PNU and subindex.
    pub(super) values: BTreeMap<(u16, u16), i64>,
    /// Every change in order: PNU, subindex, number, how it is to last.
    pub(super) writes: Vec<(u16, u16, i64, Keep)>,
}

impl Converter {
    pub(super) fn new() -> Self {
        let mut drive = Self::default();
        for (&place, octet) in [0_u16, 1, 2, 3, 4, 5].iter().zip(*b"FC-302") {
            drive.values.insert((1540, place), octet.into());
        }
        for (string, letter) in (0..8_u16).zip(b'A'..) {
            drive.values.insert((1553, 20 * string), letter.into());
        }
        for (pnu, value) in [
            (922, 1),
            (930, 1),
            (100, -2),
            (101, -300),
            (303, -70_000),
            (341, 300),
            (1600, -0x4000),
            (1623, 0x0102_0304),
        ] {
            drive.values.insert((pnu, 0), value);
        }
        for (place, value) in [(0, 7), (9, 200)] {
            drive.values.insert((1530, place), value);
        }
        drive.values.insert((10001, 103), 300);
        drive.values.insert((10001, 1702), 9);
        drive
    }

    pub(super) fn ask(&mut self, dialect: &Dialect, request: &str) -> Result<Vec<u8>, Refusal> {
        let mut out = [0xA5; 512];
        serve(&hex(request), dialect, self, &mut out).map(|length| out[..length].to_vec())
    }

    fn row(pnu: u16, subindex: u16) -> Option<&'static (u16, Attributes, i64, i64)> {
        let found = |(row, facts, ..): &&(u16, Attributes, i64, i64)| {
            let elements = facts.first..facts.first + facts.elements.max(1);
            *row == pnu && (pnu != 10001 || elements.contains(&subindex))
        };
        ROWS.iter().find(found)
    }
}

impl ParameterAccess for Converter {
    fn attributes(&self, pnu: u16, subindex: u16) -> Option<Attributes> {
        Self::row(pnu, subindex).map(|row| row.1)
    }

    fn exists(&self, pnu: u16) -> bool {
        ROWS.iter().any(|row| row.0 == pnu)
    }

    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        let facts = self.attributes(pnu, subindex).unwrap();
        let place = subindex - facts.first;
        assert!(place < facts.elements.max(1), "PNU {pnu}.{subindex}");
        if pnu == 1699 {
            return Err(ErrorNumber::DANFOSS_NOT_READABLE);
        }
        let none = if facts.is_string() { i64::from(b' ') } else { 0 };
        Ok(self.values.get(&(pnu, subindex)).unwrap_or(&none).cast_unsigned())
    }

    fn write(&mut self, pnu: u16, subindex: u16, raw: u64, keep: Keep) -> Result<(), ErrorNumber> {
        let &(_, facts, low, high) = Self::row(pnu, subindex).unwrap();
        let place = subindex - facts.first;
        assert!(
            facts.writable && place < facts.elements.max(1),
            "PNU {pnu}.{subindex}"
        );
        assert!(raw >> (8 * facts.octets) == 0, "PNU {pnu}: {raw:#x}");
        let value = match (low < 0, facts.octets) {
            (true, 1) => i64::from(raw as i8),
            (true, 2) => i64::from(raw as i16),
            (true, _) => i64::from(raw as i32),
            _ => raw.cast_signed(),
        };
        if !(low..=high).contains(&value) {
            return Err(ErrorNumber::LIMIT);
        }
        self.values.insert((pnu, subindex), value);
        self.writes.push((pnu, subindex, value, keep));
        Ok(())
    }

    fn description(&self, pnu: u16) -> Option<Description> {
        let &(_, facts, low, high) = Self::row(pnu, 0)?;
        let (size_index, conversion_index) = if pnu == 341 { (4, -2) } else { (0, 0) };
        let flags = if pnu == 1 { Identifier::TEXT } else { 0 };
        Some(Description {
            identifier: Identifier(flags | u16::from(facts.format.0)),
            elements: facts.string_octets(),
            size_index,
            conversion_index,
            name: if pnu == 1 {
                *b"Language        "
            } else {
                [b' '; 16]
            },
            minimum: (low as u32).to_be_bytes(),
            maximum: (high as u32).to_be_bytes(),
            normalisation: if pnu == 1600 { 0x800E } else { 0 },
            ..Description::default()
        })
    }

    fn text(&self, pnu: u16, index: u16) -> Option<[u8; 16]> {
        const TEXTS: [[u8; 16]; 6] = [
            *b"English         ",
            *b"Deutsch         ",
            *b"Francais        ",
            *b"Dansk           ",
            *b"Espanol         ",
            *b"Italiano        ",
        ];
        TEXTS.get(usize::from(index)).copied().filter(|_| pnu == 1)
    }
}

pub(super) fn served(dialect: &Dialect, request: &str) -> Vec<u8> {
    Converter::new().ask(dialect, request).unwrap()
}

/// Returns the error number of the only, or last, parameter.
pub(super) fn number(dialect: &Dialect, request: &str) -> u16 {
    let answer = served(dialect, request);
    assert_eq!(answer[1] & 0x80, 0x80, "{request}: {answer:02X?}");
    let addresses = vec![ParameterAddress::value(0, 0); answer[3].into()];
    let last = blocks(&answer, addresses.len(), dialect);
    match last.last() {
        Some((Format::ERROR, data)) => u16::from_be_bytes([data[0], data[1]]),
        other => panic!("{request}: {other:?}"),
    }
}

fn blocks(answer: &[u8], count: usize, dialect: &Dialect) -> Vec<(Format, Vec<u8>)> {
    let mut offset = 4;
    let mut blocks = vec![];
    for _ in 0..count {
        let Ok((block, used)) = ValueBlock::parse(answer, offset, dialect.code_space) else {
            break;
        };
        offset += used;
        blocks.push((block.format, block.data.to_vec()));
    }
    blocks
}
