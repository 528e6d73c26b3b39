//! Worked telegrams of the FC protocol, both directions, and every damage to them.

use proptest::prelude::*;

use super::*;

/// Address, parameter part, process part, the whole telegram.
const EXAMPLES: [(u8, &str, &str, &str); 7] = [
    // process block: control word 047C, reference 2000
    (0x81, "", "04 7C 20 00", "02 06 81 04 7C 20 00 DD"),
    // read 15-30 index 1, addresses 1 to 126
    (
        0x81,
        "15 FA 00 01 00 00 00 00",
        "00 00 00 00",
        "02 0E 81 15 FA 00 01 00 00 00 00 00 00 00 00 63",
    ),
    // the same in the short form of the address
    (
        0x01,
        "15 FA 00 01 00 00 00 00",
        "00 00 00 00",
        "02 0E 01 15 FA 00 01 00 00 00 00 00 00 00 00 E3",
    ),
    // 4-14 := 1000 in RAM and EEPROM
    (
        0x81,
        "E1 9E 00 00 00 00 03 E8",
        "00 00 00 00",
        "02 0E 81 E1 9E 00 00 00 00 03 E8 00 00 00 00 19",
    ),
    // rejected, status word 0603
    (
        0x81,
        "75 FA 00 01 00 00 00 00",
        "06 03 00 00",
        "02 0E 81 75 FA 00 01 00 00 00 00 06 03 00 00 06",
    ),
    // read the text 15-40, and its six characters: LGE is 10 + 6
    (
        0x81,
        "F6 04 04 00",
        "04 7C 00 00",
        "02 0A 81 F6 04 04 00 04 7C 00 00 07",
    ),
    (
        0x81,
        "F6 04 04 00 46 43 2D 33 30 32",
        "06 03 00 00",
        "02 10 81 F6 04 04 00 46 43 2D 33 30 32 06 03 00 00 79",
    ),
];

#[test]
fn telegrams_of_the_fc_protocol() {
    for (address, pkw, pzd, octets) in EXAMPLES {
        let (pkw, pzd, octets) = (hex(pkw), hex(pzd), hex(octets));
        let mut data = [0; MAX_DATA];
        let parts = Parts { pkw: &pkw, pzd: &pzd };
        let length = Layout::FC.join(parts, &mut data).unwrap();
        assert_eq!(telegram(Address(address), &data[..length]), octets);
        let decoded = Telegram::decode(&octets).unwrap();
        assert_eq!(decoded.address, Address(address));
        assert_eq!(Layout::FC.split(decoded.data), Some(parts));
        // LGE: what follows it
        assert_eq!(usize::from(octets[1]), octets.len() - 2);
    }
}

#[test]
fn flipped_bits_and_truncated_telegrams_are_rejected() {
    for (.., octets) in EXAMPLES {
        let octets = hex(octets);
        for bit in 0..8 * octets.len() {
            let mut damaged = octets.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(Telegram::decode(&damaged).is_err(), "bit {bit} of {octets:02X?}");
        }
        for cut in 0..octets.len() {
            assert!(Telegram::decode(&octets[..cut]).is_err());
        }
        let longer: Vec<u8> = octets.iter().copied().chain([0]).collect();
        assert!(Telegram::decode(&longer).is_err());
    }
}

#[test]
fn errors_say_what_and_where() {
    let error = |octets: &str| alloc::format!("{}", Telegram::decode(&hex(octets)).unwrap_err());
    assert_eq!(error("02 02 01"), "a telegram has 4 octets at least, there are 3");
    assert_eq!(
        error("03 02 01 01"),
        "the octet at offset 0 is 0x03, expected STX 0x02"
    );
    assert_eq!(
        error("02 01 01 01"),
        "LGE at offset 1 is 1, 2 to 254 are possible"
    );
    assert_eq!(
        error("02 06 81 04"),
        "LGE at offset 1 says 8 octets in all, there are 4"
    );
    assert_eq!(
        error("02 06 81 04 7C 20 00 DC"),
        "BCC at offset 7 is 0xDC, expected 0xDD"
    );
    let long = Telegram {
        address: Address(1),
        data: &[0; MAX_DATA + 1],
    };
    assert_eq!(long.encode(&mut [0; 300]), Err(EncodeError::Data(253)));
    let whole = Telegram {
        address: Address(1),
        data: &[0; MAX_DATA],
    };
    assert_eq!(
        whole.encode(&mut [0; 255]),
        Err(EncodeError::Room {
            needed: 256,
            found: 255
        })
    );
}

proptest! {
    #[test]
    fn telegrams_survive(address in any::<u8>(), data in prop::collection::vec(any::<u8>(), 0..=MAX_DATA)) {
        let octets = telegram(Address(address), &data);
        prop_assert_eq!(octets.len(), data.len() + 4);
        prop_assert_eq!(Telegram::decode(&octets), Ok(Telegram { address: Address(address), data: &data }));
    }

    #[test]
    fn any_octets_are_accepted_or_rejected(octets in prop::collection::vec(any::<u8>(), 0..300)) {
        if let Ok(telegram) = Telegram::decode(&octets) {
            prop_assert_eq!(super::telegram(telegram.address, telegram.data), octets);
        }
    }
}
