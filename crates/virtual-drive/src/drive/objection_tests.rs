//! A drive answers with the error that `profile::parameter::objections` predicts.

use profile::catalogue::Tables;
use profile::parameter::{ErrorNumber, Format, Objection, ValueBlock, objections};
use proptest::collection::vec;
use proptest::prelude::*;

use super::*;
use crate::model::{AKD, VACON, VLT};

fn octets(hex: &str) -> Vec<u8> {
    let octets = hex.split_whitespace();
    octets
        .map(|octet| u8::from_str_radix(octet, 16).unwrap())
        .collect()
}

fn said(model: &Model, request: &[u8]) -> Vec<Objection> {
    let mut tables = Tables(model.catalogue);
    objections(request, model.known.dialect, Some(&mut tables))
}

/// What stands for a record write that is refused.
const REFUSED: u16 = 0xFFFF;

fn number(objection: &Objection) -> u16 {
    objection.answer.map_or(REFUSED, |ErrorNumber(number)| number)
}

/// Returns the error numbers of an answer with the place of their parameters.
fn answered(model: &'static Model, request: &[u8]) -> Vec<(usize, u16)> {
    let mut out = [0; 240];
    let Ok(length) = Drive::new(model).serve(request, &mut out) else {
        return vec![(0, REFUSED)];
    };
    let (head, mut rest) = out[..length].split_at(4);
    let (mut errors, mut place) = (Vec::new(), 0);
    while head[1] >= 0x80 && !rest.is_empty() {
        let (block, used) = ValueBlock::parse(rest, 0, model.known.dialect.code_space).unwrap();
        if block.format == Format::ERROR {
            errors.push((place, u16::from_be_bytes([block.data[0], block.data[1]])));
        }
        (place, rest) = (place + 1, &rest[used..]);
    }
    errors
}

/// Returns the predicted error number and the one of the answer.
fn both(model: &'static Model, hex: &str) -> [Option<u16>; 2] {
    let request = octets(hex);
    let answered = answered(model, &request);
    [
        said(model, &request).first().map(number),
        answered.first().map(|(_, number)| *number),
    ]
}

#[test]
fn forbidden_writes_answer_with_the_documented_error() {
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
        // parameters that are in no table
        (&VACON, "01 01 01 01 10 01 27 11 FF FF", Some(0x6C)),
        (&VACON, "01 01 01 01 10 01 4E 20 00 00", Some(0x00)),
        (&VACON, "01 02 01 01 10 01 27 11 FF FF 42 01 00 01", Some(0x6C)),
        (&VLT, "01 01 00 01 10 01 4E 20 FF FF", Some(0x00)),
        (&VLT, "01 02 00 01 10 01 4E 20 00 00 42 01 00 01", Some(0x00)),
        (&AKD, "01 01 00 01 10 EB 4E 20 00 00", Some(0x00)),
        // descriptions of no parameter, of application ids, and of more elements than one
        (&VACON, "09 01 01 01 20 EA 27 11 13 88", Some(0x09)),
        (&VACON, "09 01 01 01 20 02 27 11 13 88", Some(0x09)),
        (&VACON, "09 01 01 01 20 00 27 11 13 88", Some(0x09)),
        (&VACON, "09 01 01 01 20 EA 4E 20 13 88", Some(0x00)),
        (&VLT, "09 01 00 01 20 EA 4E 20 13 88", Some(0x00)),
        (&VACON, "01 01 01 01 20 00 03 A2 00 00", None),
        (&VACON, "01 01 01 01 20 02 03 A2 00 00", Some(0x16)),
        (&VACON, "01 01 01 01 20 FF 03 A2 00 00", Some(0x16)),
        (&VACON, "01 01 01 01 20 08 03 B3 00 00", None),
        (&VACON, "01 01 01 01 20 00 03 B3 00 00", Some(0x16)),
        (&VACON, "01 01 01 01 20 01 03 B3 00 0D", Some(0x03)),
        // values and addresses that are cut off
        (&AKD, "01 02 00 01 10 01 03 A2 00 00 42 01 00", Some(0x18)),
        (&AKD, "01 02 00 01 10 01 03 A2 00 00", Some(0x18)),
        (&AKD, "01 02 00 01 10 01 03 A2 00 00 99 01 00 02", Some(0x17)),
        (&AKD, "01 02 00 01 10 01 03 A2 00 00 00 01 00 02", Some(0x17)),
        (&VACON, "01 02 01 01 10 01 27 11 00 67 42 03 00 01", Some(0x6B)),
        (&VACON, "01 01 01 02 10 01 27 11 00 67", Some(0x6B)),
        (&AKD, "01 01 00 02 10 01 03 A2 00 00", Some(REFUSED)),
        (&AKD, "01 01 00", Some(REFUSED)),
        // texts that a selection has, and those that it does not have
        (&VLT, "01 01 00 01 30 01 00 01 00 00", None),
        (&VLT, "01 01 00 01 30 01 00 01 FF 00", Some(0x0F)),
        (&VLT, "01 01 00 01 30 01 01 55 00 00", Some(0x0F)),
    ];
    for (model, hex, expected) in cases {
        assert_eq!(both(model, hex), [*expected; 2], "{hex}");
    }
}

/// Error numbers that depend on the state of the drive or the limits of a parameter, so that no table predicts them.
const OF_THE_STATE: [u16; 3] = [0x02, 0x11, 0x14];

/// Returns a request with at most two parameters, of which anything can be wrong.
fn requests() -> impl Strategy<Value = (&'static Model, Vec<u8>)> {
    let pnu = prop_oneof![
        Just(930_u16),
        Just(947),
        Just(2),
        Just(2108),
        Just(2109),
        Just(1),
        Just(37),
        Just(341),
        Just(10001),
        Just(20000),
    ];
    let attribute = prop_oneof![4 => Just(0x10_u8), 2 => Just(0x20), 1 => Just(0x30), 1 => any::<u8>()];
    let elements = prop_oneof![4 => Just(1_u8), 3 => 0..12_u8, 1 => any::<u8>()];
    let subindex = prop_oneof![4 => Just(0_u16), 2 => 0..110_u16, 1 => any::<u16>()];
    let address = (attribute, elements, pnu, subindex).prop_map(|(attribute, elements, pnu, subindex)| {
        let ([a, b], [c, d]) = (pnu.to_be_bytes(), subindex.to_be_bytes());
        vec![attribute, elements, a, b, c, d]
    });
    let format = prop_oneof![2 => Just(0x42_u8), 1 => Just(0x43), 1 => 0..0x0B_u8, 1 => any::<u8>()];
    let block = (format, 0..4_u8, vec(any::<u8>(), 0..8)).prop_map(|(format, count, mut data)| {
        data.splice(..0, [format, count]);
        data
    });
    let head = (
        prop_oneof![Just(1_u8), Just(0)],
        prop_oneof![4 => 1..3_u8, 1 => any::<u8>(), 1 => Just(0x52)],
        prop_oneof![2 => Just(0_u8), 2 => Just(1), 1 => any::<u8>()],
        prop_oneof![4 => Just(None), 1 => any::<u8>().prop_map(Some)],
    );
    let model = prop_oneof![Just(&AKD), Just(&VLT), Just(&VACON)];
    (model, head, vec(address, 0..3), vec(block, 0..3)).prop_map(
        |(model, (reference, id, axis, count), addresses, blocks)| {
            let count = count.unwrap_or(addresses.len() as u8);
            let mut request = vec![reference, id, axis, count];
            request.extend(addresses.concat());
            request.extend(blocks.concat());
            (model, request)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Predicted errors are answered and answered errors were predicted, unless they depend on the state of the drive.
    #[test]
    fn every_request_answers_as_documented((model, request) in requests()) {
        let (said, answered) = (said(model, &request), answered(model, &request));
        let whole = said.iter().find(|one| one.parameter.is_none());
        if let Some(whole) = whole {
            prop_assert_eq!(answered.first().map(|(_, found)| *found), Some(number(whole)), "{:02X?}", request);
        } else {
            let said: Vec<_> = said.iter().map(|one| (one.parameter.unwrap(), number(one))).collect();
            for one in &said {
                prop_assert!(answered.contains(one), "{:02X?}: {one:X?} of {said:X?}, not {answered:X?}", request);
            }
            for one in &answered {
                let fits = said.contains(one) || OF_THE_STATE.contains(&one.1);
                prop_assert!(fits, "{:02X?}: {one:X?} of {answered:X?}, not {said:X?}", request);
            }
        }
    }
}
