//! Byte examples of the manuals, the rules of the channel, damage, and both sides in virtual time.

mod client;
mod golden;
mod properties;
mod server;
mod simulation;

use alloc::vec::Vec;

use super::*;
use crate::parameter::{Attributes, Description, ErrorNumber, Format, Identifier, Keep, ParameterAccess};

fn block(text: &str) -> Vec<u8> {
    text.split_whitespace()
        .map(|octet| u8::from_str_radix(octet, 16).unwrap())
        .collect()
}

fn words(text: &str) -> [u8; 8] {
    block(text).try_into().unwrap()
}

/// A drive with a handful of parameters that notes each write.
struct Bench {
    long: u32,
    mode: u32,
    speed: u16,
    log: [u8; 10],
    small: i8,
    word: i16,
    unit: [u8; 20],
    label: [u8; 12],
    rights: bool,
    running: bool,
    /// PNU, subindex, value, true when it shall last.
    writes: Vec<(u16, u16, u64, bool)>,
}

impl Default for Bench {
    fn default() -> Self {
        Self {
            long: 1000,
            mode: 1,
            speed: 1500,
            log: [0, 14, 2, 3, 4, 5, 6, 7, 8, 9],
            small: -5,
            word: -2,
            unit: *b"FC-302              ",
            label: *b"pump        ",
            rights: true,
            running: false,
            writes: Vec::new(),
        }
    }
}

impl Bench {
    fn put(&mut self, pnu: u16, subindex: u16, raw: u64, kept: bool) -> Result<(), ErrorNumber> {
        match pnu {
            930 if self.running => return Err(ErrorNumber::NOT_NOW),
            930 => self.mode = raw as u32,
            207 => self.long = raw as u32,
            414 if raw > 1320 => return Err(ErrorNumber::LIMIT),
            414 => self.speed = raw as u16,
            100 => self.small = raw as u8 as i8,
            101 => self.word = raw as u16 as i16,
            1530 => self.log[usize::from(subindex)] = raw as u8,
            1007 => self.label[usize::from(subindex)] = raw as u8,
            _ => return Err(ErrorNumber::UNKNOWN_PARAMETER),
        }
        self.writes.push((pnu, subindex, raw, kept));
        Ok(())
    }
}

impl ParameterAccess for Bench {
    fn attributes(&self, pnu: u16, _: u16) -> Option<Attributes> {
        if pnu == 1560 {
            return Some(Attributes::strings(8, 30, false));
        }
        let (format, octets, elements, writable) = match pnu {
            1 => (Format::UNSIGNED8, 1, 0, true),
            100 => (Format::INTEGER8, 1, 0, true),
            101 => (Format::INTEGER16, 2, 0, true),
            207 | 930 => (Format::UNSIGNED32, 4, 0, true),
            414 | 2500 => (Format::UNSIGNED16, 2, 0, true),
            1530 => (Format::UNSIGNED8, 1, 10, true),
            1007 => (Format::VISIBLE_STRING, 1, 12, true),
            1540 => (Format::VISIBLE_STRING, 1, 20, false),
            1612 => (Format::UNSIGNED16, 2, 0, false),
            2000 => (Format(0x0D), 8, 0, false),
            _ => return None,
        };
        Some(Attributes {
            elements,
            ..Attributes::simple(format, octets, writable)
        })
    }

    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        let place = usize::from(subindex);
        Ok(match pnu {
            1 => 0,
            100 => self.small as u8 as u64,
            101 => self.word as u16 as u64,
            207 => self.long.into(),
            930 => self.mode.into(),
            414 | 2500 => self.speed.into(),
            1530 => self.log[place].into(),
            1007 => self.label[place].into(),
            1540 => self.unit[place].into(),
            1612 if self.running => 230,
            1612 => return Err(ErrorNumber::NOT_NOW),
            _ => 0,
        })
    }

    fn write(&mut self, pnu: u16, subindex: u16, raw: u64, keep: Keep) -> Result<(), ErrorNumber> {
        self.put(pnu, subindex, raw, keep == Keep::Permanent)
    }

    fn may_change(&self, _: u16) -> bool {
        self.rights
    }

    fn description(&self, pnu: u16) -> Option<Description> {
        (pnu == 1).then(|| Description {
            identifier: Identifier(Identifier::TEXT | 5),
            name: *b"Language        ",
            maximum: [0, 0, 0, 52],
            ..Description::default()
        })
    }
}
