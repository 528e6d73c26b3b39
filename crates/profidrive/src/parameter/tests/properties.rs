//! What holds for every request and every answer, well formed or not.

use proptest::prelude::*;

use super::*;

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

proptest! {
    #[test]
    fn read_requests_survive(reference in 1_u8.., addresses in prop::collection::vec(any_address(), 1..=39)) {
        let mut out = [0xA5; 240];
        let length = encode_read(reference, &Dialect::AKD, &addresses, &mut out).unwrap();
        prop_assert_eq!(length, 4 + 6 * addresses.len());
        let request = Request::parse(&out[..length], CodeSpace::V4).unwrap();
        prop_assert_eq!(request.reference(), reference);
        prop_assert_eq!(request.addresses().collect::<Vec<_>>(), addresses);
        for cut in 0..length {
            prop_assert!(Request::parse(&out[..cut], CodeSpace::V4).is_err());
        }
    }

    #[test]
    fn change_requests_survive(values in prop::collection::vec((any_address(), 0x41_u8..=0x43, prop::collection::vec(any::<u8>(), 1..8)), 1..12)) {
        let sized: Vec<_> = values.iter().map(|(address, code, data)| {
            let width = 1 << (code - 0x41);
            let data: Vec<u8> = data.iter().copied().cycle().take(width * data.len()).collect();
            (*address, Format(*code), data.len() / width, data)
        }).collect();
        let new: Vec<_> = sized.iter().map(|(address, format, count, data)| NewValue { address: *address, format: *format, count: *count as u8, data }).collect();
        let mut out = [0xA5; 240];
        match encode_change(1, &Dialect::AKD, &new, &mut out) {
            Err(error) => prop_assert!(matches!(error, EncodeError::Length { .. }), "{error}"),
            Ok(length) => {
                let request = Request::parse(&out[..length], CodeSpace::V4).unwrap();
                for (block, value) in request.values().zip(&new) {
                    let block = block.unwrap();
                    prop_assert_eq!((block.format, block.count, block.data), (value.format, value.count, value.data));
                }
            }
        }
    }

    #[test]
    fn any_octets_are_served_or_refused(mut request in prop::collection::vec(any::<u8>(), 0..300), dialect in 0..4_usize, tame in any::<bool>()) {
        if tame && request.len() > 4 {
            request[1] = 1 + request[1] % 2;
            request[3] = 1 + request[3] % 5;
        }
        let dialect = [Dialect::AKD, Dialect::VLT, Dialect::VACON, Dialect::STANDARD][dialect];
        let mut out = [0; 512];
        if let Ok(length) = serve(&request, &dialect, &mut Bench::default(), &mut out) {
            prop_assert!((4..=dialect.max_block).contains(&length));
            prop_assert_eq!(out[0], request[0]);
        }
    }

    /// What the manager answers, the client understands; what is damaged on the way does not hurt it.
    #[test]
    fn answers_are_understood(addresses in prop::collection::vec((0..8_usize, 0..4_u8, 0..70_u16), 1..39), flip in any::<(u8, u16)>()) {
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
