//! The parameter channel, one parameter in each request, with everything around the answer checked.

use virtual_drive::drive::Drive;
use virtual_drive::model;

use super::rows::Row;

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    Values(u8, Vec<u8>),
    Written,
    Error(u16),
}

pub struct Channel {
    drive: Drive,
    reference: u8,
}

impl Channel {
    pub fn new() -> Self {
        Self {
            drive: Drive::new(&model::AKD),
            reference: 0,
        }
    }

    /// Several parameters in one request, as they are in the request: the response.
    pub fn ask_many(&mut self, id: u8, addresses: &[u16], value_blocks: &[u8]) -> Vec<u8> {
        let mut request = vec![0x77, id, 0, u8::try_from(addresses.len()).unwrap()];
        for pnu in addresses {
            request.extend([0x10, 1]);
            request.extend(pnu.to_be_bytes());
            request.extend([0, 0]);
        }
        request.extend(value_blocks);
        let mut out = [0xEE; 240];
        let length = self.drive.serve(&request, &mut out).unwrap();
        out[..length].to_vec()
    }

    /// One parameter in one request; the answer, with everything around it checked.
    pub fn ask(
        &mut self,
        id: u8,
        attribute: u8,
        elements: u8,
        pnu: u16,
        subindex: u16,
        value_block: &[u8],
    ) -> Answer {
        self.reference = self.reference % 0xFF + 1;
        let [a, b] = pnu.to_be_bytes();
        let [c, d] = subindex.to_be_bytes();
        let mut request = vec![self.reference, id, 0, 1, attribute, elements, a, b, c, d];
        request.extend(value_block);
        let mut out = [0xEE; 240];
        let length = self.drive.serve(&request, &mut out).unwrap();
        let answer = &out[..length];
        assert_eq!(
            (answer[0], answer[2], answer[3]),
            (self.reference, 0, 1),
            "{request:02X?}"
        );
        match (answer[1], &answer[4..]) {
            (1, [format, count, values @ ..]) if id == 1 => {
                let width = match format {
                    0x41 | 0x0A => 1,
                    0x42 => 2,
                    0x43 => 4,
                    other => panic!("format {other:02X}"),
                };
                let octets = width * usize::from(*count);
                assert_eq!(values.len(), octets.next_multiple_of(2), "{request:02X?}");
                assert!(values[octets..].iter().all(|pad| *pad == 0));
                Answer::Values(*format, values[..octets].to_vec())
            }
            (2, [0, 0]) if id == 2 => Answer::Written,
            (negative, [0x44, count, high, low, info @ ..]) if negative == id | 0x80 => {
                match (count, info) {
                    (1, []) => {}
                    // the subindex of the first element that failed
                    (2, [high, low]) => {
                        let at = u16::from_be_bytes([*high, *low]);
                        assert!(
                            (subindex..=subindex + u16::from(elements)).contains(&at),
                            "{answer:02X?}"
                        );
                    }
                    other => panic!("{other:?}"),
                }
                Answer::Error(u16::from_be_bytes([*high, *low]))
            }
            other => panic!("{request:02X?}: {other:02X?}"),
        }
    }

    pub fn read(&mut self, row: &Row) -> i64 {
        match self.ask(1, 0x10, 1, row.pnu, 0, &[]) {
            Answer::Values(format, octets) => {
                assert_eq!(format, row.format(), "{row:?}");
                number(row, &octets)
            }
            other => panic!("{row:?}: {other:?}"),
        }
    }

    /// Returns the whole number, of a 64-bit value out of both halves.
    pub fn read_whole(&mut self, row: &Row) -> i64 {
        let low = self.read(row);
        if !row.wide {
            return low;
        }
        let half = Row {
            pnu: row.pnu + 1,
            signed: false,
            ..row.clone()
        };
        self.read(&half) << 32 | low & 0xFFFF_FFFF
    }

    /// Writes both halves of a 64-bit value, the high one first; the answer to the low one.
    pub fn write_whole(&mut self, row: &Row, raw: i64) -> Answer {
        let half = Row {
            pnu: row.pnu + 1,
            signed: false,
            ..row.clone()
        };
        assert_eq!(
            self.write(&half, raw >> 32 & 0xFFFF_FFFF),
            Answer::Written,
            "{row:?}"
        );
        self.ask(2, 0x10, 1, row.pnu, 0, &block(row, 0x43, &[raw & 0xFFFF_FFFF]))
    }

    pub fn write(&mut self, row: &Row, raw: i64) -> Answer {
        self.ask(2, 0x10, 1, row.pnu, 0, &block(row, row.format(), &[raw]))
    }
}

pub fn number(row: &Row, octets: &[u8]) -> i64 {
    assert_eq!(octets.len(), row.octets(), "{row:?}");
    let unsigned = octets
        .iter()
        .fold(0, |value, octet| value << 8 | i64::from(*octet));
    let bits = 8 * row.octets();
    if row.signed && unsigned >> (bits - 1) == 1 {
        unsigned - (1 << bits)
    } else {
        unsigned
    }
}

/// Returns a value block with the octets of the row's size, padded.
pub fn block(row: &Row, format: u8, values: &[i64]) -> Vec<u8> {
    let mut block = vec![format, u8::try_from(values.len()).unwrap()];
    for value in values {
        block.extend(&value.to_be_bytes()[8 - row.octets()..]);
    }
    block.resize(block.len().next_multiple_of(2), 0);
    block
}
