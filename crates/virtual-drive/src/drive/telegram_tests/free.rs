//! Telegrams with free mapping: PNU 915 and 916.

use super::*;
use proptest::prelude::*;

fn chosen(telegram: i64) -> Drive {
    let mut drive = Drive::new(&AKD);
    write(&mut drive, 922, 0, telegram).unwrap();
    drive
}

#[test]
fn telegram_400_starts_like_telegram_9() {
    let drive = chosen(400);
    let zeros = |count| vec![0; count];
    let setpoints = [1, 32, 3, 34, 34, 35, 35, 36, 37, 38];
    assert_eq!(words(&drive, 915), [&setpoints[..], &zeros(6)].concat());
    assert_eq!(words(&drive, 916), [&[2, 33, 4, 28, 28][..], &zeros(11)].concat());
    let nine = chosen(9);
    assert_eq!(
        (words(&nine, 915), words(&nine, 916)),
        (words(&drive, 915), words(&drive, 916))
    );
}

#[test]
fn telegram_0_starts_like_the_one_before() {
    let drive = chosen(0);
    assert_eq!(
        (words(&drive, 915)[..3].to_vec(), words(&drive, 916)[..3].to_vec()),
        (vec![1, 5, 0], vec![2, 6, 0])
    );
    let mut drive = chosen(353);
    write(&mut drive, 922, 0, 0).unwrap();
    let twelve = [1, 32, 3, 34, 34, 35, 35, 36, 37, 38, 100, 100];
    assert_eq!(
        words(&drive, 915),
        [&twelve[..], &[0; 4]].concat(),
        "what fits into its module"
    );
    write(&mut drive, 915, 1, 5).unwrap();
    write(&mut drive, 922, 0, 1).unwrap();
    assert_eq!(words(&drive, 915)[..3], [1, 5, 0]);
    write(&mut drive, 922, 0, 0).unwrap();
    assert_eq!(words(&drive, 915)[..3], [1, 5, 3], "its own mapping is back");
}

#[test]
fn each_refusal() {
    let mut drive = chosen(400);
    let before = (words(&drive, 915), words(&drive, 916));
    for (pnu, word, number) in [
        (915, 1, 999), // no such signal
        (915, 1, 7),   // NSOLL_B: of the profile, not of this drive
        (915, 1, 107), // reserved
        (915, 1, 2108),
        (915, 0, 5), // STW1 comes first
        (915, 0, 0),
        (915, 2, 1), // and only first
        (916, 0, 1),
        (916, 0, 6),
        (916, 1, 2),
        (915, 1, 6), // goes the other way
        (916, 1, 5),
        (915, 4, 5), // cuts MDI_TARPOS
        (915, 4, 0),
        (915, 11, 34), // no room for the second word
        (915, 12, 5),  // behind the end
        (916, 15, 6),
    ] {
        assert_eq!(
            write(&mut drive, pnu, word, number),
            Err(ErrorNumber::VALUE),
            "{pnu}[{word}] = {number}"
        );
    }
    assert_eq!(write(&mut drive, 915, 16, 0), Err(ErrorNumber::SUBINDEX));
    assert_eq!(
        write(&mut drive, 915, 15, 0),
        Ok(()),
        "nothing behind the end is nothing wrong"
    );
    assert_eq!((words(&drive, 915), words(&drive, 916)), before);
    // The mapping of a fixed telegram is fixed, and that of a telegram in use too.
    for telegram in [1, 7, 9, 350, 351, 352, 353, 354] {
        let mut drive = chosen(telegram);
        assert_eq!(
            write(&mut drive, 915, 1, 5),
            Err(ErrorNumber::NOT_NOW),
            "{telegram}"
        );
        assert_eq!(
            write(&mut drive, 916, 1, 6),
            Err(ErrorNumber::NOT_NOW),
            "{telegram}"
        );
    }
    let mut drive = Line::with(drive, 400).drive;
    let first = words(&drive, 915)[0];
    for pnu in [915, 916, 922] {
        assert_eq!(
            write(&mut drive, pnu, 0, first),
            Err(ErrorNumber::NOT_NOW),
            "{pnu}"
        );
    }
    drive.disconnect(Disconnect::Lost);
    write(&mut drive, 915, 1, 5).unwrap();
    for unknown in [2, 8, 399, 999, 65_535] {
        assert_eq!(
            write(&mut drive, 922, 0, unknown),
            Err(ErrorNumber::VALUE),
            "{unknown}"
        );
    }
}

#[test]
fn a_mapping_of_ones_own_is_used_by_the_next_connection() {
    for telegram in [400_u16, 0] {
        let mut drive = chosen(telegram.into());
        for (pnu, map) in [
            (915, [1, 5, 108, 109, 34, 34, 102, 0, 101, 0, 0, 0]),
            (916, [2, 6, 28, 28, 52, 106, 105, 105, 104, 104, 33, 0]),
        ] {
            for (word, number) in (0..).zip(map) {
                write(&mut drive, pnu, word, number).unwrap();
            }
            assert_eq!(words(&drive, pnu)[..12], map);
        }
        // Another telegram in between does not take it away.
        let mut drive = Line::with(drive, 1).drive;
        drive.disconnect(Disconnect::Released);
        let mut line = Line::with(drive, telegram);
        line.outputs.copy_from_slice(&[
            0x04, 0x7E, 0x01, 0x00, 0, 20, 0, 30, 0xFF, 0xFE, 0x80, 0, 0xFF, 0x38, 0x77, 0x77, 0, 100, 0, 0,
            0, 0, 0, 0,
        ]);
        line.cycles(3);
        for (signal, value) in [
            (5, 256),
            (108, 20),
            (109, 30),
            (34, -98_304),
            (102, -200),
            (101, 100),
        ] {
            assert_eq!(
                (line.drive.process.signal(signal), line.read(signal)),
                (value, value),
                "{signal}"
            );
        }
        line.outputs[1] = 0x7F;
        line.cycles(30);
        assert_eq!(line.get(106), 0x40);
        assert!((line.get(6) - 256).abs() < 4, "{}", line.get(6));
        assert_eq!(line.get(28), line.drive.axis.position() >> 16);
        assert_eq!(line.inputs[22..], [0, 0]);
    }
}

/// A feedrate that a controller gave is gone with its telegram, and one that carries it starts with 100 %.
#[test]
fn a_feedrate_does_not_outlive_the_telegram_that_carried_it() {
    let mut drive = chosen(400);
    write(&mut drive, 915, 1, 101).unwrap();
    let mut line = Line::with(drive, 400);
    assert_eq!(line.read(101), 100);
    line.set(1, 0x0400);
    line.cycle();
    assert_eq!(line.read(101), 0, "the controller has sent 0");
    line.drive.disconnect(Disconnect::Released);
    assert_eq!(Line::with(line.drive, 9).read(101), 100);
}

/// Only the length of the modules is outside the drive: its mapping is gone with the restart.
#[test]
fn a_restart_takes_the_mapping_and_leaves_the_length() {
    let mut drive = chosen(0);
    drive.plug(0, 8, 8);
    write(&mut drive, 915, 3, 32).unwrap();
    write(&mut drive, 922, 0, 400).unwrap();
    write(&mut drive, 915, 1, 5).unwrap();
    drive.restart();
    assert_eq!(drive.parameter(922), Some(1));
    write(&mut drive, 922, 0, 400).unwrap();
    assert_eq!(words(&drive, 915)[..2], [1, 32], "as delivered");
    write(&mut drive, 922, 0, 1).unwrap();
    write(&mut drive, 922, 0, 0).unwrap();
    assert_eq!(words(&drive, 915)[..5], [1, 5, 0, 0, 0], "that of telegram 1");
    assert_eq!(
        write(&mut drive, 915, 4, 32),
        Err(ErrorNumber::VALUE),
        "four words"
    );
}

#[test]
fn telegram_0_is_as_long_as_its_module() {
    let mut drive = chosen(353);
    write(&mut drive, 922, 0, 0).unwrap();
    drive.plug(0, 8, 32);
    assert_eq!(
        words(&drive, 915)[..5],
        [1, 32, 3, 0, 0],
        "MDI_TARPOS would be cut"
    );
    write(&mut drive, 915, 3, 5).unwrap();
    assert_eq!(
        write(&mut drive, 915, 4, 103),
        Err(ErrorNumber::VALUE),
        "behind its end"
    );
    assert_eq!(write(&mut drive, 916, 15, 28), Err(ErrorNumber::VALUE));
    write(&mut drive, 916, 14, 28).unwrap();
    assert_eq!(words(&drive, 916)[13..], [0, 28, 28]);
    drive.plug(0, 8, 30);
    assert_eq!(words(&drive, 916)[13..], [0, 0, 0]);
    drive.plug(353, 2, 2);
    drive.connect(353, Duration::from_millis(48)).unwrap();
    assert_eq!(words(&drive, 915)[12], 103, "the others have their own length");
}

#[test]
fn reset_to_delivery_takes_the_mapping_with_it() {
    let mut drive = chosen(400);
    write(&mut drive, 915, 1, 5).unwrap();
    drive.reset_to_delivery();
    assert_eq!(drive.parameter(922), Some(1));
    write(&mut drive, 922, 0, 400).unwrap();
    assert_eq!(words(&drive, 915)[1], 32);
}

#[test]
fn a_signal_mapped_twice_has_the_value_of_its_first_place() {
    let mut drive = chosen(400);
    for (word, number) in [(1, 5), (2, 5)] {
        write(&mut drive, 915, word, number).unwrap();
    }
    let mut line = Line::with(drive, 400);
    line.outputs[..6].copy_from_slice(&[0x04, 0, 0, 10, 0, 20]);
    line.cycle();
    assert_eq!(line.drive.process.signal(5), 10);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// For every mapping and every setpoint, the frames contain the values of the parameters.
    #[test]
    fn any_mapping_and_any_outputs(
        writes in prop::collection::vec((any::<bool>(), 1..14_u16, prop_oneof![0..40_i64, 95..112_i64, Just(52)]), 0..40),
        frames in prop::collection::vec(prop::collection::vec(any::<u8>(), 24), 1..30),
        mode in 0..3_i64,
    ) {
        let mut drive = chosen(400);
        write(&mut drive, 2135, 0, mode).unwrap();
        for (setpoint, word, number) in writes {
            let pnu = if setpoint { 915 } else { 916 };
            let before = words(&drive, pnu);
            if write(&mut drive, pnu, word, number).is_err() {
                prop_assert_eq!(words(&drive, pnu), before);
            }
        }
        let (setpoints, actuals) = (words(&drive, 915), words(&drive, 916));
        prop_assert_eq!((setpoints[0], actuals[0]), (1, 2));
        let mut line = Line::with(drive, 400);
        for mut frame in frames {
            // Mostly with control by PLC and without OFF2 and OFF3, so that it runs now and then.
            frame[0] = frame[0] & 0x3B | 0x04;
            frame[1] |= 0x06;
            line.outputs.copy_from_slice(&frame);
            line.cycle();
            let setpoint = line.setpoint;
            for field in setpoint.fields() {
                let number = field.signal.number;
                let first = setpoint.position_of(number) == Some(usize::from(field.offset));
                if first && number != 1 {
                    prop_assert_eq!(Some(line.drive.process.signal(number)), field.get(&frame));
                }
            }
            for field in line.actual.fields().to_vec() {
                if let Some(value) = line.drive.parameter(field.signal.number) {
                    prop_assert_eq!(field.get(&line.inputs), Some(value), "{}", field.signal.name);
                }
            }
        }
    }
}
