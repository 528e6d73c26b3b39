//! What `profile::parameter::objections` says of a request is what a drive answers.

use profile::parameter::{ErrorNumber, ParameterAddress, Request, objections};

use super::*;
use crate::model::{AKD, VACON, VLT};

fn octets(hex: &str) -> Vec<u8> {
    let octets = hex.split_whitespace();
    octets
        .map(|octet| u8::from_str_radix(octet, 16).unwrap())
        .collect()
}

/// The error number that is said beforehand and the one that is answered.
fn both(model: &'static Model, hex: &str) -> [Option<u16>; 2] {
    let (request, mut out) = (octets(hex), [0; 240]);
    let dialect = model.known.dialect;
    let parsed = Request::parse(&request, dialect.code_space).unwrap();
    let facts = |address: ParameterAddress| {
        let parameter = model.catalogue.at(address.pnu, address.subindex);
        parameter.map(profile::catalogue::Parameter::attributes)
    };
    let found = objections(&parsed, dialect, facts);
    let said = found
        .first()
        .map(|one| one.answer.map_or(0xFFFF, |ErrorNumber(number)| number));
    let answered = match Drive::new(model).serve(&request, &mut out) {
        Err(_) => Some(0xFFFF),
        Ok(_) if out[1] < 0x80 => None,
        Ok(_) => Some(u16::from_be_bytes([out[6], out[7]])),
    };
    [said, answered]
}

#[test]
fn what_is_forbidden_is_answered_with_the_number_that_is_said() {
    let cases: &[(&'static Model, &str, Option<u16>)] = &[
        (&AKD, "01 02 00 01 10 01 03 A2 00 00 42 01 00 02", None),
        // no format, and none that a value has
        (&AKD, "01 02 00 01 10 01 03 A2 00 00 00 00", Some(0x17)),
        (&AKD, "01 02 00 01 10 01 03 A2 00 00 44 01 00 02", Some(0x17)),
        (
            &AKD,
            "01 02 00 01 10 01 03 A2 00 00 43 01 00 00 00 02",
            Some(0x05),
        ),
        (
            &AKD,
            "01 02 00 01 10 01 03 A2 00 00 42 02 00 02 00 02",
            Some(0x18),
        ),
        // read-only comes before the number of values
        (
            &AKD,
            "01 02 00 01 10 01 00 02 00 00 42 02 00 02 00 02",
            Some(0x01),
        ),
        (&VACON, "01 02 01 01 10 01 03 9A 00 00 00 00", Some(0x01)),
        // the address comes before the number of values
        (&VACON, "01 02 01 01 10 02 27 11 00 67 42 01 00 02", Some(0x16)),
        (&AKD, "01 01 00 01 10 02 03 A2 00 00", Some(0x16)),
        (&AKD, "01 01 00 01 10 01 03 A2 00 05", Some(0x04)),
        // 234 elements are allowed, but no array has so many
        (&AKD, "01 01 00 01 10 EA 03 B3 00 00", Some(0x03)),
        (&AKD, "01 01 00 01 10 EB 03 B3 00 00", Some(0x16)),
        (&AKD, "01 01 00 01 10 00 03 B3 00 00", Some(0x16)),
        // descriptions and texts
        (&AKD, "01 01 00 01 20 01 03 A2 00 00", None),
        (&AKD, "01 02 00 01 20 01 03 A2 00 00 42 01 00 02", Some(0x07)),
        (&AKD, "01 01 00 01 30 01 03 A2 00 00", Some(0x0F)),
        (&AKD, "01 02 00 01 30 01 03 A2 00 00 42 01 00 02", Some(0x20)),
        (&AKD, "01 01 00 01 40 01 03 A2 00 00", Some(0x16)),
        (&VACON, "01 01 01 01 20 01 27 11 00 67", Some(0x09)),
        (&VACON, "01 01 01 01 40 01 03 9A 00 00", Some(0x69)),
        // the request as a whole comes before its parameters
        (&AKD, "01 01 01 01 30 01 03 A2 00 00", Some(0x19)),
        (&AKD, "01 03 01 01 10 01 03 A2 00 00", Some(0x21)),
        (&AKD, "01 01 00 01 10 01 03 A2 00 00 AA", Some(0xFFFF)),
        (&VACON, "00 07 01 01 50 01 03 9A 00 00", Some(0x21)),
        (
            &VLT,
            "01 02 00 01 10 01 01 55 00 00 07 01 00 00 01 F4 00 00",
            Some(0x18),
        ),
        (&VLT, "01 02 00 01 10 01 01 55 00 00 41 01 05 00", Some(0x05)),
    ];
    for (model, hex, expected) in cases {
        assert_eq!(both(model, hex), [*expected; 2], "{hex}");
    }
}
