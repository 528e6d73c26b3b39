//! Sections A to E and H: parameter channel, profile parameters, state machine, dialects.

use std::time::Duration;

use profinet::Medium;
use virtual_drive::drive::Injection;

use super::bench::Vendor::{self, Akd, Vacon, Vlt};
use super::bench::{Bench, CYCLES};

/// One line of the checklist: its number, for whom it is, and how it is checked.
pub struct Line {
    pub number: u16,
    pub vendors: &'static [Vendor],
    pub check: fn(&mut Bench),
}

const fn on(number: u16, vendors: &'static [Vendor], check: fn(&mut Bench)) -> Line {
    Line {
        number,
        vendors,
        check,
    }
}

const fn all(number: u16, check: fn(&mut Bench)) -> Line {
    on(number, &[Akd, Vlt, Vacon], check)
}

/// Answer to line 1: 922 is a word with each; the VLT names its type.
fn telegram_block(bench: &Bench) -> Vec<u8> {
    match bench.dut.vendor {
        Vlt => bench.hex("06 01 00 01"),
        Akd | Vacon => bench.hex("42 01 00 01"),
    }
}

pub static LINES: &[Line] = &[
    // A. Parameter access
    all(1, |bench| {
        let expected = [bench.hex("01 01 DD 01"), telegram_block(bench)].concat();
        assert_eq!(bench.ask("01 01 DD 01 10 01 03 9A 00 00"), expected);
    }),
    all(4, |bench| {
        let answer = bench.ask("01 01 DD 01 10 01 03 9A 00 00");
        assert_eq!(answer[2..4], [bench.dut.axis, 1]);
    }),
    all(7, |bench| {
        assert_eq!(bench.error("07 01 DD 01 10 01 03 9A 00 05"), 4)
    }),
    all(10, |bench| {
        let expected = if bench.dut.vendor == Vacon { 0x69 } else { 0x16 };
        assert_eq!(bench.error("0A 01 DD 01 50 01 03 9A 00 00"), expected);
    }),
    on(13, &[Akd, Vacon], |bench| {
        let mut request = vec![0x0D, 1, bench.dut.axis, 40];
        (0..40).for_each(|_| request.extend([0x10, 1, 0x03, 0x9A, 0, 0]));
        match (bench.dut.vendor, bench.plc.job(bench.dut.records[0], &request)) {
            (Akd, refused) => assert!(refused.is_err(), "{refused:02X?}"),
            (_, answer) => {
                let answer = answer.unwrap();
                assert_eq!(answer[..2], [0x0D, 0x81], "{answer:02X?}");
                assert_eq!(answer[4..], [0x44, 1, 0, 0x68].repeat(40));
            }
        }
    }),
    all(16, |bench| {
        let expected = [
            bench.hex("10 81 DD 02"),
            telegram_block(bench),
            bench.hex("44 01 00 00"),
        ]
        .concat();
        let answer = bench.ask("10 01 DD 02 10 01 03 9A 00 00 10 01 FF FE 00 00");
        assert_eq!(answer, expected);
    }),
    all(19, |bench| {
        let count = bench.dut.model.known.dialect.max_parameters;
        let mut request = vec![0x13, 1, bench.dut.axis, count];
        (0..count).for_each(|_| request.extend([0x10, 8, 0x03, 0xB3, 0, 0]));
        let answer = bench.job(&request);
        assert!(answer.len() <= 240 && answer[1] == 0x81, "{answer:02X?}");
        let too_long = |block: &[u8]| block == [0x44, 1, 0, 0x15];
        assert!(answer.windows(4).any(too_long), "{answer:02X?}");
    }),
    on(22, &[Vlt, Vacon], |bench| {
        let block = bench.dut.block;
        assert_eq!(bench.change(2, block), [0x19, 2, bench.dut.axis, 1]);
    }),
    all(25, |bench| {
        let mut block = bench.dut.block.to_vec();
        block[0] = 0x50;
        let answer = bench.change(2, &block);
        assert_eq!(answer[1], 0x82);
        assert!(matches!(answer[4..], [0x44, _, 0, 0x17 | 5, ..]), "{answer:02X?}");
    }),
    on(28, &[Akd, Vacon], |bench| {
        let block = bench.dut.block;
        assert_eq!(block[0], 0x42);
        assert_eq!(bench.change(2, block)[..2], [0x19, 2]);
        let [a, b, c, d] = bench.dut.writable;
        let (pnu, subindex) = (u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d]));
        assert_eq!(bench.words(pnu, subindex, 1), [u16::from(block[3])]);
    }),
    on(31, &[Akd], |bench| {
        let answer = bench.ask("1F 02 00 01 10 01 08 57 00 00 41 01 02 00");
        assert_eq!(answer[..4], [0x1F, 2, 0, 1]);
    }),
    all(34, |bench| {
        let (address, block) = (bench.dut.writable, bench.dut.block);
        let mut request = vec![0x22, 2, bench.dut.axis, 2];
        for _ in 0..2 {
            request.extend([0x10, 1]);
            request.extend(address);
            request.extend(block);
        }
        match bench.plc.job(bench.dut.records[0], &request) {
            Err(_) => {}
            Ok(answer) => {
                assert_eq!(answer[1], 0x82, "{answer:02X?}");
                let refused = |block: &[u8]| matches!(block, [0x44, 1 | 2, 0, 0x16..=0x18 | 0x65..=0x6D]);
                assert!(answer.windows(4).any(refused), "{answer:02X?}");
            }
        }
    }),
    on(37, &[Vacon], |bench| {
        assert_eq!(bench.error("00 01 DD 01 10 01 03 9A 00 00"), 0x65)
    }),
    // B. Transport
    all(40, |bench| {
        let before = bench.plc.medium.now();
        bench.ask("01 01 DD 01 10 01 03 9A 00 00");
        assert!(bench.plc.medium.now() - before < Duration::from_secs(1));
    }),
    on(43, &[Akd, Vacon], |bench| {
        let request = bench.hex("01 01 DD 01 10 01 03 9A 00 00");
        let [one, other] = bench.dut.records;
        let first = bench.plc.job(one, &request).unwrap();
        assert_eq!(bench.plc.job(other, &request).unwrap(), first);
    }),
    // C. Description and text
    all(46, |bench| {
        let answer = bench.ask("2E 01 DD 01 20 01 03 9A 00 00");
        assert_eq!(answer[1], 1, "{answer:02X?}");
        assert_eq!((answer[4..6].to_vec(), answer.len()), (vec![0x0A, 46], 52));
    }),
    on(49, &[Vlt], |bench| {
        let [a, b, ..] = bench.dut.writable;
        let mut limit = |element| {
            let answer = bench.job(&[0x2F, 1, 0, 1, 0x20, 1, a, b, 0, element]);
            assert_eq!(answer[..6], [0x2F, 1, 0, 1, 0x0A, 4], "{answer:02X?}");
            u32::from_be_bytes(answer[6..10].try_into().unwrap())
        };
        let (low, high) = (limit(7), limit(8));
        let block = |raw: u32| [&[7, 1][..], &raw.to_be_bytes()].concat();
        assert_eq!(bench.change(2, &block(low))[1], 2);
        assert_eq!(bench.change(2, &block(high))[1], 2);
        let answer = bench.change(2, &block(high + 1));
        assert!(matches!(answer[4..], [0x44, _, 0, 2, ..]), "{answer:02X?}");
        bench.change(2, bench.dut.block);
    }),
    on(52, &[Akd, Vacon], |bench| {
        let error = bench.error("34 01 DD 01 30 01 03 9A 00 00");
        assert!(matches!(error, 0x0F | 0x16 | 0x69), "{error:02X}");
    }),
    // D. Profile parameters
    all(55, |bench| {
        let answer = bench.ask("37 01 DD 01 10 02 03 C5 00 00");
        let single = bench.ask("37 01 DD 01 10 01 03 C5 00 00");
        let number = |answer: &[u8]| answer.windows(2).any(|pair| matches!(pair, [3, 0x29 | 0x2A]));
        assert!(
            number(&answer[4..]) || number(&single[4..]),
            "{answer:02X?} {single:02X?}"
        );
    }),
    all(58, |bench| {
        // each list ends with 0 or its last element; the next one goes on where it is not empty
        let mut list = Vec::new();
        for pnu in 980..=989_u16 {
            let [high, low] = pnu.to_be_bytes();
            let answer = bench.job(&[0x3A, 1, bench.dut.axis, 1, 0x20, 1, high, low, 0, 0]);
            if answer[1] != 1 {
                break;
            }
            assert_eq!(answer[4..6], [0x0A, 46], "{pnu}: {answer:02X?}");
            let elements = u16::from_be_bytes([answer[8], answer[9]]).max(1);
            let most = bench.dut.model.known.dialect.max_values.min(100);
            let before = list.len();
            let mut first = 0;
            while first < elements {
                let count = (elements - first).min(most);
                let some = bench.words(pnu, first, count as u8);
                let end = some.iter().position(|number| *number == 0);
                list.extend(&some[..end.unwrap_or(some.len())]);
                first = if end.is_some() { elements } else { first + count };
            }
            if list.len() == before {
                break;
            }
        }
        assert!(list.len() > 8, "{list:?}");
        assert!(list.windows(2).all(|pair| pair[0] < pair[1]), "{list:?}");
        assert!(list.iter().all(|pnu| !(980..=989).contains(pnu)), "{list:?}");
        assert!(list.contains(&922), "{list:?}");
    }),
    all(61, |bench| {
        assert_eq!(bench.words(922, 0, 1), [1]);
        if bench.dut.vendor != Vlt {
            assert_eq!(bench.words(915, 0, 2), [1, 5]);
            assert_eq!(bench.words(916, 0, 2), [2, 6]);
        } else {
            // 9-15 and 9-16 of a VLT hold parameter numbers for the words behind; its 9-23 lists those of the signals
            assert_eq!(bench.words(923, 1, 2), [1680, 1603]);
            assert_eq!(bench.words(923, 5, 2), [1682, 1605]);
        }
    }),
    // of the standard device in the sample; a VLT has 9-27 too
    on(64, &[Vlt], |bench| {
        assert_eq!(bench.ask("40 02 DD 01 10 01 03 9F 00 00 06 01 00 00")[1], 2);
        let answer = bench.change(2, bench.dut.block);
        assert!(matches!(answer[4..], [0x44, _, 0, 0x0B, ..]), "{answer:02X?}");
        assert_eq!(bench.ask("40 02 DD 01 10 01 03 9F 00 00 06 01 00 01")[1], 2);
        assert_eq!(bench.change(2, bench.dut.block)[1], 2);
    }),
    on(67, &[Akd, Vacon], |bench| {
        let before = bench.words(944, 0, 1)[0];
        bench.inject_fault();
        bench.word(0x047E);
        assert_eq!(bench.words(944, 0, 1)[0], before.wrapping_add(1));
        bench.word(0x04FE);
        bench.word(0x047E);
    }),
    on(70, &[Akd], |bench| {
        bench.inject_fault();
        bench.inject(Injection::Fault {
            number: 304,
            lasting: false,
        });
        bench.word(0x047E);
        assert_eq!(bench.words(947, 0, 3), [bench.dut.fault, 304, 0]);
        bench.word(0x04FE);
        bench.word(0x047E);
        assert_eq!(bench.words(947, 0, 8), [0; 8]);
        assert_eq!(bench.words(947, 8, 3), [bench.dut.fault, 304, 0]);
    }),
    on(73, &[Vacon], |bench| {
        let answer = bench.ask("49 01 DD 01 20 01 03 B3 00 02");
        assert!(answer.ends_with(&[0, 8]), "{answer:02X?}");
        bench.inject_fault();
        bench.word(0x047E);
        let active = bench.words(947, 0, 8);
        assert!(active[0] != 0, "{active:?}");
        bench.word(0x04FE);
        bench.word(0x047E);
        let acknowledged = bench.words(947, 0, 8);
        assert_eq!(
            (acknowledged[0], acknowledged[1]),
            (0, active[0]),
            "{acknowledged:?}"
        );
    }),
    // E. State machine
    all(76, |bench| assert_eq!(bench.word(0x047E), 0x0031)),
    all(79, |bench| {
        let mut fresh = Bench::sending(bench.dut, 1, &[0x04, 0x7F, 0, 0]);
        for _ in 0..5 {
            let zsw1 = fresh.word(0x047F);
            assert_eq!(zsw1 & 0x0046, 0x0040, "{zsw1:04X}");
        }
    }),
    all(82, |bench| {
        bench.run();
        let (zsw1, speed) = bench.send(0x047E, 0x0CCD, Duration::from_millis(200));
        assert!(speed > 0x0100, "{speed}");
        assert_eq!(zsw1 & 0x0042, 0x0002, "{zsw1:04X}");
        let (zsw1, speed) = bench.send(0x047E, 0x0CCD, Duration::from_secs(6));
        assert_eq!(
            (zsw1 & 0x0077, speed.abs() < 16),
            (0x0031, true),
            "{zsw1:04X} {speed}"
        );
    }),
    all(85, |bench| {
        bench.run();
        let (_, speed) = bench.send(0x047B, 0x0CCD, Duration::from_millis(48));
        assert!(speed > 0x0100, "{speed}");
        let mut back = false;
        for _ in 0..60 {
            let (zsw1, _) = bench.send(0x047F, 0x0CCD, Duration::from_millis(100));
            back |= zsw1 & 0x0077 == 0x0037;
        }
        let zsw1 = bench.word(0x047F);
        assert_eq!((back, zsw1 & 0x0046), (false, 0x0040), "{zsw1:04X}");
        assert_eq!(bench.word(0x047E), 0x0031);
    }),
    all(88, |bench| {
        bench.run();
        bench.send(0x047D, 0x0CCD, Duration::from_secs(8));
        for _ in 0..5 {
            let (zsw1, _) = bench.send(0x047F, 0, CYCLES);
            assert_eq!(zsw1 & 0x0077, 0x0070, "{zsw1:04X}");
        }
        assert_eq!(bench.word(0x047E), 0x0031);
    }),
    all(91, |bench| {
        assert_eq!(bench.word(0x047E), 0x0031);
        assert_eq!(bench.word(0x007F), 0x0031);
        assert_eq!(bench.word(0x047F), 0x0037);
        bench.word(0x047E);
    }),
    all(94, |bench| {
        bench.run();
        bench.inject_fault();
        let (zsw1, _) = bench.send(0x047E, 0, Duration::from_secs(8));
        assert_eq!(zsw1 & 0x0008, 0x0008, "{zsw1:04X}");
        bench.word(0x04FE);
        let (zsw1, _) = bench.send(0x047E, 0, CYCLES);
        assert_eq!((zsw1 & 0x0008, zsw1 & 0x0077), (0, 0x0031), "{zsw1:04X}");
    }),
    // local operation selected in the drive
    all(97, |bench| {
        bench.run();
        bench.inject(Injection::Local(true));
        let (zsw1, _) = bench.send(0x047F, 0x0CCD, CYCLES);
        assert_eq!(zsw1 & 0x0200, 0, "{zsw1:04X}");
        let (zsw1, speed) = bench.send(0x047F, 0x0CCD, Duration::from_secs(8));
        assert_eq!((zsw1 & 0x0204, speed.abs() < 16), (0, true), "{zsw1:04X} {speed}");
        for word in [0x047E, 0x047F, 0x04FE, 0x047F] {
            let (zsw1, speed) = bench.send(word, 0x0CCD, CYCLES);
            assert_eq!((zsw1 & 0x0204, speed.abs() < 16), (0, true), "{zsw1:04X} {speed}");
        }
        bench.inject(Injection::Local(false));
        let (zsw1, _) = bench.send(0x047E, 0, CYCLES);
        assert_eq!(zsw1 & 0x0277, 0x0231, "{zsw1:04X}");
        bench.run();
    }),
    on(100, &[Vlt, Vacon], |bench| {
        bench.word(0x047E);
        let (zsw1, speed) = bench.send(0x047F, 0x4000, Duration::from_secs(30));
        assert_eq!(zsw1 & 0x0077, 0x0037, "{zsw1:04X}");
        // a motor without speed sensor: its slip is missing in the actual speed
        assert!((0x4000 - speed).abs() <= 0x0380, "{speed:04X}");
        bench.send(0x047E, 0, Duration::from_secs(30));
    }),
    // H. Dialects
    on(133, &[Akd], |bench| {
        for octets in [1, 2, 4] {
            let parameters = bench.dut.model.catalogue.parameters.iter();
            let some = parameters
                .filter(|parameter| parameter.size.octets() == octets)
                .take(20);
            for parameter in some {
                let [high, low] = parameter.pnu.to_be_bytes();
                let answer = bench.job(&[0x85, 1, 0, 1, 0x10, 1, high, low, 0, 0]);
                let code = [0x41, 0x42, 0x43][octets / 2];
                assert_eq!(answer[1..6], [1, 0, 1, code, 1], "{}", parameter.name);
            }
        }
    }),
    on(127, &[Vacon], |bench| {
        for id in [1_u16, 2, 101, 103, 104, 1424] {
            let [high, low] = id.to_be_bytes();
            let answer = bench.job(&[0x7F, 1, 1, 1, 0x10, 1, 0x27, 0x11, high, low]);
            assert!(
                matches!(answer[1..6], [1, 1, 1, 0x42, 1]) || answer[1] == 0x81,
                "ID {id}: {answer:02X?}"
            );
        }
    }),
    on(130, &[Vlt], |bench| {
        let answer = bench.ask("02 01 DD 01 10 01 05 FA 00 00");
        assert_eq!(answer[1], 1, "{answer:02X?}");
        assert_eq!(bench.error("02 01 DD 01 10 01 05 FA 03 E7"), 3);
    }),
];
