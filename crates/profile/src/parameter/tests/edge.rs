//! The last subindex there is.

use super::hex;
use crate::parameter::*;

/// One number whose values end at subindex 65535.
struct Edge;

impl ParameterAccess for Edge {
    fn attributes(&self, _: u16, _: u16) -> Option<Attributes> {
        Some(Attributes {
            first: 0xFFF9,
            elements: 7,
            ..Attributes::simple(Format::UNSIGNED16, 2, true)
        })
    }

    fn exists(&self, _: u16) -> bool {
        true
    }

    fn read(&mut self, _: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        Ok(subindex.into())
    }

    fn write(&mut self, _: u16, subindex: u16, raw: u64, _: Keep) -> Result<(), ErrorNumber> {
        assert_eq!((subindex, raw), (0xFFFF, 2));
        Ok(())
    }

    fn description(&self, _: u16) -> Option<Description> {
        None
    }

    fn text(&self, _: u16, _: u16) -> Option<[u8; 16]> {
        None
    }
}

#[test]
fn the_last_subindex_is_read_and_written_without_counting_beyond_it() {
    let mut out = [0; 240];
    for (request, answer) in [
        ("08 01 00 01 10 01 03 17 FF FF", "08 01 00 01 06 01 FF FF"),
        ("08 02 00 01 10 01 03 17 FF FF 42 01 00 02", "08 02 00 01"),
    ] {
        let length = serve(&hex(request), &Dialect::STANDARD, &mut Edge, &mut out).unwrap();
        assert_eq!(out[..length], hex(answer)[..], "{request}");
    }
}
