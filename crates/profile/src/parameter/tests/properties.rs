//! What holds for every request and every answer, well formed or not.

use proptest::prelude::*;

use super::converter::Converter;
use super::*;

const DIALECTS: [Dialect; 4] = [Dialect::AKD, Dialect::VLT, Dialect::VACON, Dialect::STANDARD];

fn any_dialect() -> impl Strategy<Value = Dialect> {
    (0..DIALECTS.len()).prop_map(|index| DIALECTS[index])
}

fn any_address() -> impl Strategy<Value = ParameterAddress> {
    (any::<u8>(), any::<u8>(), any::<u16>(), any::<u16>()).prop_map(|(attribute, elements, pnu, subindex)| {
        ParameterAddress {
            attribute: Attribute::from_octet(attribute),
            elements,
            pnu,
            subindex,
        }
    })
}

/// Numbers of [`Converter`], and one that is not there.
const PNUS: [u16; 19] = [
    1, 100, 101, 303, 341, 414, 922, 930, 947, 967, 1007, 1530, 1540, 1553, 1600, 1610, 1623, 10001, 5000,
];

proptest! {
    #[test]
    fn read_requests_survive(dialect in any_dialect(), reference in 1_u8.., addresses in prop::collection::vec(any_address(), 1..=37), wide in any::<bool>()) {
        let mut out = [0xA5; 240];
        let id = if wide && dialect.knows(RequestId::ReadWide) { RequestId::ReadWide } else { RequestId::Read };
        let length = encode_read_as(id, reference, &dialect, &addresses, &mut out).unwrap();
        prop_assert_eq!(length, 4 + 6 * addresses.len());
        let request = Request::parse(&out[..length], dialect.code_space).unwrap();
        prop_assert_eq!((request.reference(), request.id(), request.axis()), (reference, id, dialect.axis));
        prop_assert_eq!(request.addresses().collect::<Vec<_>>(), addresses);
        for cut in 0..length {
            prop_assert!(Request::parse(&out[..cut], dialect.code_space).is_err());
        }
    }

    #[test]
    fn change_requests_survive(dialect in any_dialect(), values in prop::collection::vec((any_address(), 0x41_u8..=0x43, prop::collection::vec(any::<u8>(), 1..8)), 1..12)) {
        let sized: Vec<_> = values.iter().map(|(address, code, data)| {
            let width = 1 << (code - 0x41);
            let data: Vec<u8> = data.iter().copied().cycle().take(width * data.len()).collect();
            (*address, Format(*code), data.len() / width, data)
        }).collect();
        let new: Vec<_> = sized.iter().map(|(address, format, count, data)| NewValue { address: *address, format: *format, count: *count as u8, data }).collect();
        let mut out = [0xA5; 240];
        match encode_change(1, &dialect, &new, &mut out) {
            Err(error) => prop_assert!(matches!(error, EncodeError::Length { .. } | EncodeError::ValueCount { .. }), "{error}"),
            Ok(length) => {
                let request = Request::parse(&out[..length], dialect.code_space).unwrap();
                prop_assert_eq!(request.behind(), &[]);
                for (block, value) in request.values().zip(&new) {
                    let block = block.unwrap();
                    prop_assert_eq!((block.format, block.count, block.data), (value.format, value.count, value.data));
                }
            }
        }
    }

    #[test]
    fn any_octets_are_served_or_refused(mut request in prop::collection::vec(any::<u8>(), 0..300), dialect in any_dialect(), tame in any::<bool>()) {
        if tame && request.len() > 4 {
            request[1] = [1, 2, 0x42, 0x51, 0x52][usize::from(request[1] % 5)];
            request[3] = 1 + request[3] % 5;
        }
        let mut out = [0; 512];
        if let Ok(length) = serve(&request, &dialect, &mut Bench::default(), &mut out) {
            prop_assert!((4..=dialect.max_block).contains(&length));
            prop_assert_eq!(out[0], request[0]);
        }
        if let Ok(length) = serve(&request, &dialect, &mut Converter::new(), &mut out) {
            prop_assert!((4..=dialect.max_block).contains(&length));
        }
    }

    /// The client decodes every answer of the manager, and damaged answers cause no panic.
    #[test]
    fn answers_decode_as_encoded(addresses in prop::collection::vec((0..8_usize, 0..4_u8, 0..70_u16), 1..39), flip in any::<(u8, u16)>()) {
        let pnus = [922, 930, 947, 915, 964, 2135, 2004, 5000];
        let addresses: Vec<_> = addresses.iter().map(|&(pnu, count, subindex)| ParameterAddress::values(pnus[pnu], subindex, count)).collect();
        let mut request = [0; 240];
        let length = encode_read(9, &Dialect::AKD, &addresses, &mut request).unwrap();
        let mut out = [0; 240];
        let length = serve(&request[..length], &Dialect::AKD, &mut Bench::default(), &mut out).unwrap();
        let response = Response::parse(&out[..length], RequestId::Read, 9, &addresses, &Dialect::AKD).unwrap();
        prop_assert_eq!(response.answers().count(), addresses.len());
        let failed = response.answers().any(|answer| matches!(answer, Answer::Error(_)));
        prop_assert_eq!(failed, response.is_negative());
        for cut in 0..length {
            let _ = Response::parse(&out[..cut], RequestId::Read, 9, &addresses, &Dialect::AKD).map(|r| r.answers().count());
        }
        out[usize::from(flip.1) % length] ^= 1 << (flip.0 % 8);
        let _ = Response::parse(&out[..length], RequestId::Read, 9, &addresses, &Dialect::AKD).map(|r| r.answers().count());
    }

    /// The same for what converters have: all sizes and types, strings and arrays of them, collected parameters. What was
    /// read is written back and accepted, whatever the dialect.
    #[test]
    fn converter_answers_decode_as_encoded(
        dialect in any_dialect(),
        wide in any::<bool>(),
        permanent in any::<bool>(),
        asked in prop::collection::vec((0..PNUS.len(), 0..6_u8, 0..12_u16), 1..37),
        flip in any::<(u8, u16)>(),
    ) {
        let addresses: Vec<_> = asked.iter().map(|&(pnu, count, subindex)| match PNUS[pnu] {
            10001 => ParameterAddress::values(10001, 100 + subindex, count),
            pnu => ParameterAddress::values(pnu, subindex, count),
        }).collect();
        let read = if wide && dialect.knows(RequestId::ReadWide) { RequestId::ReadWide } else { RequestId::Read };
        let change = match dialect.change_id(if permanent { Keep::Permanent } else { Keep::Volatile }) {
            _ if read == RequestId::ReadWide => RequestId::ChangeWide,
            Some(id) => id,
            None => RequestId::Change,
        };
        let (mut request, mut out) = ([0; 240], [0; 240]);
        let mut drive = Converter::new();
        let length = encode_read_as(read, 9, &dialect, &addresses, &mut request).unwrap();
        let length = serve(&request[..length], &dialect, &mut drive, &mut out).unwrap();
        let response = Response::parse(&out[..length], read, 9, &addresses, &dialect).unwrap();
        prop_assert_eq!(response.answers().count(), addresses.len());
        for (answer, &address) in response.answers().zip(&addresses) {
            let Answer::Values(block) = answer else { continue };
            // a drive may give more at once than a client writes
            if u16::from(block.count) > dialect.max_values {
                continue;
            }
            let value = NewValue { address, format: block.format, count: block.count, data: block.data };
            let length = encode_change_as(change, 10, &dialect, &[value], &mut request).unwrap();
            let mut written = [0; 240];
            let length = serve(&request[..length], &dialect, &mut drive, &mut written).unwrap();
            let response = Response::parse(&written[..length], change, 10, &[address], &dialect).unwrap();
            match response.answers().next() {
                Some(Answer::Written) => {}
                Some(Answer::Error(error)) => prop_assert!([ErrorNumber::NOT_CHANGEABLE, ErrorNumber::LIMIT].contains(&error.number), "{address:?}: {error}"),
                other => prop_assert!(false, "{address:?}: {other:?}"),
            }
        }
        for cut in 0..length {
            let _ = Response::parse(&out[..cut], read, 9, &addresses, &dialect).map(|r| r.answers().count());
        }
        out[usize::from(flip.1) % length] ^= 1 << (flip.0 % 8);
        let _ = Response::parse(&out[..length], read, 9, &addresses, &dialect).map(|r| r.answers().count());
    }

    /// A change that was damaged or cut on the way writes only what a whole one could have written, and is answered.
    #[test]
    fn damaged_changes_do_no_harm(dialect in any_dialect(), cut in any::<u16>(), flip in any::<(u8, u16)>()) {
        let values = [
            NewValue { address: ParameterAddress::value(930, 0), format: Format::WORD, count: 1, data: &[0, 2] },
            NewValue { address: ParameterAddress::value(341, 0), format: Format::DOUBLE_WORD, count: 1, data: &[0, 0, 1, 0] },
            NewValue { address: ParameterAddress::value(1007, 0), format: Format::VISIBLE_STRING, count: 12, data: b"PUMP 1      " },
            NewValue { address: ParameterAddress::value(1, 0), format: Format::BYTE, count: 1, data: &[3] },
        ];
        let (mut request, mut out) = ([0; 240], [0; 240]);
        let length = encode_change(9, &dialect, &values, &mut request).unwrap();
        let cut = usize::from(cut) % length;
        let mut drive = Converter::new();
        if let Ok(answered) = serve(&request[..cut], &dialect, &mut drive, &mut out) {
            // the last pad octet may be missing
            prop_assert!(answered <= 240 && (out[1] & 0x80 != 0 || cut + 1 == length));
        }
        request[usize::from(flip.1) % length] ^= 1 << (flip.0 % 8);
        let _ = serve(&request[..length], &dialect, &mut Converter::new(), &mut out);
    }

    #[test]
    fn descriptions_survive(octets in prop::collection::vec(any::<u8>(), 46)) {
        let mut octets = octets;
        octets[10..14].fill(0);
        octets[38..40].fill(0);
        // not-a-number factors keep their bits but are not equal to themselves
        octets[4] &= 0x3F;
        let description = Description::decode(&octets).unwrap();
        prop_assert_eq!(&description.encode()[..], &octets[..]);
    }
}
