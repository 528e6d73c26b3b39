//! Each telegram of the AKD between our controller and the drive: any setpoints, compared with the parameters of the same
//! numbers, and what cannot be changed while a controller is connected.

use profile::catalogue::AKD;
use profile::parameter::ErrorNumber;
use profile::telegram::{KOLLMORGEN, Mapping, Telegram, signal};
use system_tests::bus::Bus;

/// A small generator: the same numbers on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
}

/// Limits of the parameter that a signal sets: HOME.MODE 0 to 15, DRV.ACC and DRV.DEC 1.86 to 50,000,000 rpm/s in steps
/// of 763.
fn in_range(number: u16, value: i64) -> bool {
    match number {
        103 => value <= 15,
        108 | 109 => (1..=65_530).contains(&value),
        _ => true,
    }
}

fn parameter(bus: &mut Bus, number: u16) -> i64 {
    let row = AKD.by_pnu(number).unwrap();
    let raw = bus.read(number, 0);
    match (row.size.octets(), row.signed) {
        (2, true) => i64::from(raw as u16 as i16),
        (4, true) => i64::from(raw.cast_signed()),
        _ => i64::from(raw),
    }
}

#[test]
fn any_setpoints_read_back_as_parameters() {
    for module in AKD.device.telegrams {
        let fixed = Telegram::find(module.telegram, KOLLMORGEN).unwrap();
        // Telegram 400 starts like telegram 9, telegram 0 like the one before it, which is telegram 1 here.
        let source = if module.telegram == 0 {
            Telegram::find(1, KOLLMORGEN).unwrap()
        } else {
            fixed
        };
        let setpoint = Mapping::of(&source.setpoint);
        let mut bus = Bus::new();
        bus.connect(module.telegram);
        let mut random = Random(u64::from(module.telegram) + 0x9E37_79B9_7F4A_7C15);
        let mut kept: Vec<(u16, i64)> = Vec::new();
        for _ in 0..12 {
            let mut data: Vec<u8> = (0..module.outputs).map(|_| random.next() as u8).collect();
            setpoint.set(&mut data, signal::STW1, 0x0400).unwrap();
            for edge in [103, 108, 109] {
                // these are rarely inside their limits by chance
                if setpoint.has(edge) && random.next().is_multiple_of(2) {
                    setpoint
                        .set(&mut data, edge, 1 + (random.next() % 15).cast_signed())
                        .unwrap();
                }
            }
            bus.send(&data, 3);
            for field in setpoint.fields() {
                let number = field.signal.number;
                if AKD.by_pnu(number).is_none() {
                    continue; // STW2
                }
                let sent = field.get(&data).unwrap();
                let before = kept
                    .iter()
                    .find(|(known, _)| *known == number)
                    .map(|(_, value)| *value);
                let read = parameter(&mut bus, number);
                if in_range(number, sent) {
                    assert_eq!(read, sent, "telegram {}: {}", module.telegram, field.signal.name);
                    kept.retain(|(known, _)| *known != number);
                    kept.push((number, sent));
                } else if let Some(before) = before {
                    assert_eq!(
                        read, before,
                        "telegram {}: {}",
                        module.telegram, field.signal.name
                    );
                }
            }
        }
        assert!(!bus.station().drive().is_enabled() && !bus.station().drive().has_fault());
        bus.judged(&format!("telegram-{}", module.telegram));
    }
}

#[test]
fn what_a_controller_uses_is_not_changed_under_it() {
    for module in AKD.device.telegrams {
        let mut bus = Bus::new();
        bus.connect(module.telegram);
        let not_now = Some(ErrorNumber::NOT_NOW.0);
        for (pnu, subindex, value) in [
            (922, 0, 1),
            (922, 0, 400),
            (915, 1, 5),
            (915, 0, 1),
            (916, 1, 6),
            (5, 0, 100),
            (102, 0, 1),
        ] {
            assert_eq!(
                bus.write_word(pnu, subindex, value),
                not_now,
                "telegram {}: {pnu}",
                module.telegram
            );
        }
        let carries = |number| {
            let telegram = Telegram::find(module.telegram, KOLLMORGEN).unwrap();
            telegram.setpoint.field(number).is_some()
        };
        for (pnu, value) in [
            (32, 3),
            (36, 400),
            (37, 500),
            (38, 1),
            (101, 100),
            (103, 7),
            (108, 2),
            (109, 3),
        ] {
            let expected = if carries(pnu) { not_now } else { None };
            assert_eq!(
                bus.write_word(pnu, 0, value),
                expected,
                "telegram {}: {pnu}",
                module.telegram
            );
            if expected.is_none() {
                assert_eq!(parameter(&mut bus, pnu), i64::from(value));
            }
        }
        for pnu in [1, 2, 6, 33, 52, 106, 107, 923] {
            assert_eq!(
                bus.write_word(pnu, 0, 1),
                Some(ErrorNumber::NOT_CHANGEABLE.0),
                "{pnu}"
            );
        }
        assert_eq!(bus.read(922, 0), u32::from(module.telegram));
        bus.judged(&format!("telegram-{}-kept", module.telegram));
    }
}

#[test]
fn the_words_of_915_and_916_and_the_numbers_of_923() {
    for module in AKD.device.telegrams.iter().filter(|module| module.telegram != 0) {
        let telegram = Telegram::find(module.telegram, KOLLMORGEN).unwrap();
        let mut bus = Bus::new();
        bus.connect(module.telegram);
        for (pnu, image) in [(915_u16, &telegram.setpoint), (916, &telegram.actual)] {
            let [a, b] = pnu.to_be_bytes();
            let answer = bus.job(&[9, 1, 0, 1, 0x10, 16, a, b, 0, 0]);
            assert_eq!(answer[..6], [9, 1, 0, 1, 0x42, 16]);
            let words: Vec<u16> = answer[6..]
                .chunks(2)
                .map(|word| u16::from_be_bytes([word[0], word[1]]))
                .collect();
            let expected: Vec<u16> = image.words().chain(std::iter::repeat(0)).take(16).collect();
            assert_eq!(words, expected, "telegram {}", module.telegram);
        }
    }
    let mut bus = Bus::new();
    bus.connect(1);
    let answer = bus.job(&[9, 1, 0, 1, 0x10, 110, 0x03, 0x9B, 0, 0]);
    let words: Vec<u16> = answer[6..]
        .chunks(2)
        .map(|word| u16::from_be_bytes([word[0], word[1]]))
        .collect();
    // Manual 5.6 and 5.8: the signals with a parameter; 107 is reserved.
    let signals = [
        1, 2, 5, 6, 28, 32, 33, 34, 35, 36, 37, 38, 52, 100, 101, 102, 103, 104, 105, 106, 108, 109,
    ];
    for (number, parameter) in (0_u16..).zip(words) {
        assert_eq!(parameter, if signals.contains(&number) { number } else { 0 });
    }
    bus.judged("telegram-numbers");
}
