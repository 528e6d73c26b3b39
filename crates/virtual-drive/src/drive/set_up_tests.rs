//! Set-ups of the virtual FC 302, and the telegram that outlives the power.

use profile::parameter::{ErrorNumber, Keep, ParameterAccess};

use super::bench::{Bench, ask};
use super::*;
use crate::model::VLT;

/// 0-10, 0-11, 0-51, 3-41, 3-03.
const ACTIVE: u16 = 10;
const EDIT: u16 = 11;
const COPY: u16 = 51;
const RAMP: u16 = 341;
const HIGHEST: u16 = 303;

/// Returns the last text that the drive emits for saving.
fn saved(drive: &mut Drive) -> String {
    let events = std::iter::from_fn(|| drive.poll_event());
    let texts = events.filter_map(|event| match event {
        Event::Save { text, .. } => Some(text),
        _ => None,
    });
    texts.last().unwrap()
}

#[test]
fn each_set_up_has_its_own_motor_ramps_and_references_and_nothing_else() {
    let mut bench = Bench::new(&VLT, 1);
    bench.write(EDIT, 2).unwrap();
    for (number, raw) in [(RAMP, 700), (HIGHEST, 750_000), (831, 7)] {
        bench.write(number, raw).unwrap();
        assert_eq!(bench.read(number), raw);
    }
    bench.write(EDIT, 1).unwrap();
    assert_eq!((bench.read(RAMP), bench.read(HIGHEST)), (300, 1_500_000));
    assert_eq!(bench.read(831), 7, "one for all set-ups");
    assert_eq!(
        (bench.drive.set_up(), bench.drive.scaling().reference),
        (1, Some(1500.0))
    );
    // the active one is in force, whichever is edited
    bench.write(ACTIVE, 2).unwrap();
    assert_eq!(
        (bench.drive.set_up(), bench.drive.scaling().reference),
        (2, Some(750.0))
    );
    assert_eq!(bench.read(RAMP), 300);
    bench.write(EDIT, 9).unwrap();
    assert_eq!(bench.read(RAMP), 700);
    bench.write(RAMP, 800).unwrap();
    bench.write(ACTIVE, 3).unwrap();
    assert_eq!(bench.read(RAMP), 300);
    bench.write(ACTIVE, 2).unwrap();
    assert_eq!(bench.read(RAMP), 800);
    // elements of an array too
    let presets = VLT.catalogue.position(310).unwrap();
    bench.drive.set_element(presets, 3, 4000).unwrap();
    bench.write(ACTIVE, 1).unwrap();
    assert_eq!(bench.drive.element(presets, 3), Ok(0));
}

#[test]
fn the_factory_set_up_is_read_and_never_written() {
    let mut drive = Drive::new(&VLT);
    drive.write(RAMP, 0, 700, Keep::Volatile).unwrap();
    drive.write(EDIT, 0, 0, Keep::Volatile).unwrap();
    assert_eq!(drive.read(RAMP, 0), Ok(300));
    // by the parameter channel 131, acyclically not now
    assert_eq!(drive.write(RAMP, 0, 800, Keep::Volatile), Err(ErrorNumber(131)));
    let change = [1, 2, 0, 1, 0x10, 1, 0x01, 0x55, 0, 0, 7, 1, 0, 0, 3, 0x20];
    assert_eq!(ask(&mut drive, &change)[..8], [1, 0x82, 0, 1, 0x44, 1, 0, 0x11]);
    let mut bench = Bench::new(&VLT, 101);
    bench.write(EDIT, 0).unwrap();
    bench.outputs[..8].copy_from_slice(&[0x31, 0x55, 0, 0, 0, 0, 0x03, 0x20]);
    bench.ticks(1);
    assert_eq!(bench.inputs[..8], [0x71, 0x55, 0, 0, 0, 0, 0, 131]);
    // whatever the value is: 0 s is below the limit of 3-41
    bench.outputs[7] = 0;
    bench.outputs[6] = 0;
    bench.ticks(1);
    assert_eq!(bench.inputs[..8], [0x71, 0x55, 0, 0, 0, 0, 0, 131]);
    // groups 1 to 4: 1-20, 2-01, 3-41 and 4-14, and nothing of the other groups
    for (number, expected) in [
        (120, Err(ErrorNumber(131))),
        (201, Err(ErrorNumber(131))),
        (341, Err(ErrorNumber(131))),
        (414, Err(ErrorNumber(131))),
        (1, Ok(())),
        (1420, Ok(())),
    ] {
        let raw = bench.read(number);
        assert_eq!(bench.write(number, raw), expected, "PNU {number}");
    }
    // what belongs to no set-up can be written
    assert_eq!(bench.write(831, 7), Ok(()));
}

#[test]
fn the_control_word_chooses_while_zero_ten_lets_it() {
    let mut bench = Bench::new(&VLT, 103);
    for (edited, ramp) in [(1, 100), (2, 200), (3, 300), (4, 400)] {
        bench.write(EDIT, edited).unwrap();
        bench.write(RAMP, ramp).unwrap();
    }
    bench.write(EDIT, 9).unwrap();
    // not requested: 0-10 is 1
    bench.send(0x643C, 0, 8);
    assert_eq!((bench.drive.set_up(), bench.read(RAMP)), (1, 100));
    bench.write(ACTIVE, 9).unwrap();
    for (word, set_up) in [(0x243C, 2), (0x443C, 3), (0x643C, 4), (0x043C, 1)] {
        bench.send(word, 0, 8);
        assert_eq!(bench.drive.set_up(), set_up, "{word:04X}");
        assert_eq!(bench.read(RAMP), i64::from(set_up) * 100, "{word:04X}");
    }
    // 8-55: digital input, and bus AND input, with inputs that are off
    for select in [0, 2] {
        bench.write(855, select).unwrap();
        bench.send(0x643C, 0, 8);
        assert_eq!(bench.drive.set_up(), 1, "{select}");
    }
    bench.write(855, 1).unwrap();
    bench.send(0x643C, 0, 8);
    assert_eq!(bench.drive.set_up(), 4);
    // a word without control changes nothing
    bench.send(0x003C, 0, 8);
    assert_eq!(bench.drive.set_up(), 4);
    // the words of the PROFIdrive profile have the same bits
    let mut bench = Bench::new(&VLT, 1);
    bench.write(ACTIVE, 9).unwrap();
    bench.send(0x447E, 0, 8);
    assert_eq!(bench.drive.set_up(), 3);
}

#[test]
fn a_running_motor_changes_ramps_and_references_but_not_the_motor() {
    let mut bench = Bench::new(&VLT, 103);
    bench.write(EDIT, 2).unwrap();
    bench.write(HIGHEST, 750_000).unwrap();
    bench.write(EDIT, 3).unwrap();
    bench.write(124, 250).unwrap(); // another motor current
    bench.write(ACTIVE, 9).unwrap();
    bench.send(0x047C, 0x4000, 6000);
    assert!((bench.drive.axis().speed_command() - 1500.0).abs() < 1.0);
    bench.send(0x247C, 0x4000, 6000);
    assert!((bench.drive.axis().speed_command() - 750.0).abs() < 1.0);
    bench.send(0x447C, 0x4000, 400);
    assert_eq!(bench.drive.set_up(), 2, "the motor runs");
    bench.send(0x443C, 0x4000, 8000);
    assert_eq!(bench.drive.set_up(), 3);
}

#[test]
fn set_ups_are_copied() {
    let mut bench = Bench::new(&VLT, 1);
    bench.write(RAMP, 700).unwrap();
    bench.write(COPY, 3).unwrap();
    let ramp_of = |bench: &mut Bench, number| {
        bench.write(EDIT, number).unwrap();
        bench.read(RAMP)
    };
    assert_eq!(
        [1, 2, 3, 4].map(|number| ramp_of(&mut bench, number)),
        [700, 300, 700, 300]
    );
    // the factory set-up to all
    bench.write(EDIT, 0).unwrap();
    bench.write(COPY, 9).unwrap();
    assert_eq!([1, 2, 3, 4].map(|number| ramp_of(&mut bench, number)), [300; 4]);
    assert_eq!(bench.read(COPY), 0);
    // not into the one that runs
    bench.write(EDIT, 2).unwrap();
    bench.send(0x047E, 0, 40);
    bench.send(0x047F, 0x1000, 400);
    assert_eq!(bench.write(COPY, 1), Err(ErrorNumber::NOT_NOW));
    assert_eq!(bench.write(COPY, 4), Ok(()));
    // 0-14: a digit for each of four channels
    assert_eq!(bench.read(14) as u32, 0xAAAA_2222);
}

#[test]
fn every_set_up_survives_the_power() {
    let mut drive = Drive::new(&VLT);
    for (edited, ramp) in [(1_u64, 100), (2, 200), (4, 400)] {
        drive.write(EDIT, 0, edited, Keep::Volatile).unwrap();
        drive.write(RAMP, 0, ramp, Keep::Volatile).unwrap();
    }
    drive.write(ACTIVE, 0, 2, Keep::Volatile).unwrap();
    drive.write(971, 0, 1, Keep::Volatile).unwrap();
    let text = saved(&mut drive);
    assert!(
        text.contains("\n3-41 = 1 # s\n") && text.contains("\nset-up 2 3-41 = 2 # s\n"),
        "{text}"
    );
    // one value for good, of a set-up that is not active
    drive.write(EDIT, 0, 3, Keep::Volatile).unwrap();
    drive.write(RAMP, 0, 300, Keep::Permanent).unwrap();
    let text = saved(&mut drive);
    let mut again = Drive::new(&VLT);
    assert_eq!(again.start_with(text.as_bytes()), Ok(0));
    assert_eq!(again.set_up(), 2);
    for edited in 1..=4_u64 {
        again.write(EDIT, 0, edited, Keep::Volatile).unwrap();
        assert_eq!(again.read(RAMP, 0), Ok(100 * edited));
    }
    // initialisation
    again.write(1422, 0, 2, Keep::Volatile).unwrap();
    assert_eq!((again.set_up(), again.read(RAMP, 0)), (1, Ok(300)));
    // lines that mean nothing are left out and counted
    let mut image = crate::store::Image::new("VLT");
    for name in ["set-up 2 3-99", "set-up 7 3-41", "set-up x", "set-up 2 8-31"] {
        image.push_text(name, "1");
    }
    assert_eq!(again.start_with(image.encode().as_bytes()), Ok(4));
}

#[test]
fn nine_twenty_two_outlives_the_power() {
    let mut drive = Drive::new(&VLT);
    assert_eq!(drive.read(922, 0), Ok(1));
    let change = [1, 0x42, 0, 1, 0x10, 1, 0x03, 0x9A, 0, 0, 6, 1, 0, 104];
    assert_eq!(ask(&mut drive, &change)[1] & 0x80, 0);
    let text = saved(&mut drive);
    let mut again = Drive::new(&VLT);
    again.start_with(text.as_bytes()).unwrap();
    assert_eq!(again.read(922, 0), Ok(104));
    // its control word has the words of 8-10 then, and 9-15 numbers of parameters
    assert_eq!(again.read(915, 0), Ok(1680));
    // no such telegram; and while a controller has one, no other
    assert_eq!(again.write(922, 0, 200, Keep::Volatile), Err(ErrorNumber::VALUE));
    assert_eq!(again.write(922, 0, 7, Keep::Volatile), Err(ErrorNumber::VALUE));
    again.connect(1, Duration::from_secs(1)).unwrap();
    assert_eq!(again.read(922, 0), Ok(1));
    assert_eq!(
        again.write(922, 0, 104, Keep::Volatile),
        Err(ErrorNumber::NOT_NOW)
    );
    // a text that names none that there is leaves the one in use
    let mut image = crate::store::Image::new("VLT");
    image.push_text("9-22", "77");
    let mut odd = Drive::new(&VLT);
    odd.start_with(image.encode().as_bytes()).unwrap();
    assert_eq!(odd.read(922, 0), Ok(1));
}
