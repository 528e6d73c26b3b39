//! The virtual FC 302: its control words, references, parameters, alarms and process data.

use profile::parameter::{ErrorNumber, Keep, ParameterAccess};

use super::bench::{Bench, CYCLE, ask};
use super::*;
use crate::model::VLT;

fn profidrive() -> Bench {
    Bench::new(&VLT, 1)
}

/// PPO 3 with the FC profile.
fn fc() -> Bench {
    Bench::new(&VLT, 103)
}

/// Bits 0 to 2 and 4 to 6 of a status word.
fn state(status: u16) -> u16 {
    status & 0x77
}

#[test]
fn start_up_of_the_profidrive_profile() {
    let mut bench = profidrive();
    // no start without edge
    assert_ne!(bench.send(0x047F, 0x2000, 400) & 0x40, 0);
    assert!(!bench.drive.is_enabled());
    assert_eq!(state(bench.send(0x0476, 0, 40)), 0x31);
    assert_eq!(state(bench.send(0x047E, 0, 40)), 0x31);
    let status = bench.send(0x047F, 0x2000, 4000);
    assert_eq!(
        (bench.drive.state(), status & 0x0F00),
        (State::S4, 0x0F00),
        "{status:04X}"
    );
    // ramp stop
    bench.send(0x047E, 0x2000, 100);
    assert_eq!(bench.drive.state(), State::S5Ramp);
    assert_eq!(state(bench.send(0x047E, 0, 4000)), 0x31);
    // inhibit is kept until OFF after a coast stop
    bench.send(0x047F, 0x2000, 2000);
    bench.send(0x047D, 0x2000, 40);
    assert!(!bench.drive.is_enabled());
    assert_ne!(bench.send(0x047F, 0x2000, 8000) & 0x40, 0);
    assert_eq!(state(bench.send(0x047E, 0, 40)), 0x31);
}

#[test]
fn before_the_first_tick_words_follow_the_drive_profile() {
    let mut drive = Drive::new(&VLT);
    let before = drive.status_word();
    drive.tick(Instant::from_millis(4), None, &mut []);
    assert_eq!((before, before.0), (drive.status_word(), 0x0640));
}

#[test]
fn control_by_plc_and_quick_stop() {
    let mut bench = profidrive();
    bench.send(0x047E, 0, 40);
    let before = bench.status();
    assert_eq!(bench.send(0x007F, 0, 200), before);
    bench.send(0x047F, 0x4000, 4000);
    assert_eq!(bench.drive.state(), State::S4);
    bench.send(0x047B, 0x4000, 100);
    assert_eq!(bench.drive.state(), State::S5Quick);
    bench.send(0x047F, 0x4000, 100);
    assert_eq!(bench.drive.state(), State::S5Quick);
    bench.send(0x047F, 0x4000, 8000);
    assert_eq!(bench.drive.state(), State::S1);
}

#[test]
fn the_reference_is_n2_of_the_highest_reference() {
    let mut bench = profidrive();
    bench.write(300, 1).unwrap(); // -Max to +Max
    bench.send(0x047E, 0, 40);
    for (reference, rpm) in [
        (0x4000_i16, 1500.0),
        (0x2000, 750.0),
        (-0x4000, -1500.0),
        (0, 0.0),
    ] {
        bench.send(0x047F, reference, 12_000);
        let speed = bench.drive.axis().speed();
        assert!((speed - rpm).abs() < 15.0, "{reference:04X} {speed}");
        assert!(
            (i32::from(bench.speed()) - i32::from(reference)).abs() < 164,
            "{:04X}",
            bench.speed()
        );
    }
    // twice the highest reference is the highest; 3-03 is the scale
    bench.send(0x047F, 0x7FFF, 8000);
    assert!((bench.drive.axis().speed() - 1500.0).abs() < 15.0);
    bench.write(303, 1_000_000).unwrap();
    bench.send(0x047F, 0x4000, 4000);
    assert!((bench.drive.axis().speed() - 1000.0).abs() < 15.0);
    assert_eq!(bench.drive.scaling().reference, Some(1000.0));
    // and in Hz, of two pole pairs
    bench.write(301, 3).unwrap();
    bench.write(303, 25_000).unwrap();
    bench.send(0x047F, 0x4000, 4000);
    assert!((bench.drive.axis().speed() - 750.0).abs() < 15.0);
}

#[test]
fn ramps_are_times_to_the_synchronous_speed() {
    let mut bench = profidrive();
    bench.write(341, 500).unwrap(); // 5 s
    bench.send(0x047E, 0, 40);
    bench.send(0x047F, 0x4000, 2500);
    let half = bench.drive.axis().speed_command();
    assert!((half - 750.0).abs() < 10.0, "{half}");
    bench.write(381, 50).unwrap(); // quick stop 0.5 s
    bench.send(0x047F, 0x4000, 4000);
    bench.send(0x046F, 0x4000, 252);
    let half = bench.drive.axis().speed_command();
    assert!((half - 750.0).abs() < 25.0, "{half}");
}

#[test]
fn fc_profile_start_stop_jog_freeze_and_reset() {
    let mut bench = fc();
    // starts by level
    let status = bench.send(0x047C, 0x2000, 6000);
    assert_eq!(status, 0x0F07, "{status:04X}");
    assert!((i32::from(bench.speed()) - 0x2000).abs() < 164);
    // freeze: the reference has no effect
    bench.send(0x045C, 0x4000, 2000);
    assert!((bench.drive.axis().speed_command() - 750.0).abs() < 5.0);
    // preset reference 1 adds to that of the bus
    bench.write(310, 0).unwrap();
    let position = VLT.catalogue.position(310).unwrap();
    bench.drive.set_element(position, 1, 2500).unwrap(); // 25 %
    bench.send(0x047D, 0x2000, 4000);
    assert!((bench.drive.axis().speed_command() - 1125.0).abs() < 5.0);
    // reverse
    bench.send(0x847C, 0x2000, 8000);
    assert!((bench.drive.axis().speed_command() + 750.0).abs() < 5.0);
    // ramp stop
    bench.send(0x043C, 0, 8000);
    assert!(!bench.drive.is_enabled());
    // jog runs with 3-19
    bench.send(0x053C, 0, 4000);
    assert!((bench.drive.axis().speed_command() - 150.0).abs() < 5.0);
    bench.send(0x043C, 0, 4000);
    // coasting, and quick stop
    bench.send(0x047C, 0x4000, 6000);
    bench.send(0x0474, 0x4000, 40);
    assert!(!bench.drive.is_enabled() && bench.drive.axis().speed() > 1000.0);
    bench.send(0x047C, 0x4000, 8000);
    bench.send(0x046C, 0x4000, 40);
    assert_eq!(bench.drive.state(), State::S5Quick);
    bench.send(0x043C, 0, 8000);
    // a trip, and the reset edge
    bench.drive.inject_fault(14, false);
    let status = bench.send(0x047C, 0, 40);
    assert_eq!(status & 0x0008, 0x0008);
    bench.drive.inject(Injection::ClearCause { number: 14 });
    bench.send(0x04BC, 0, 40);
    assert_eq!(bench.send(0x043C, 0, 40) & 0x0008, 0);
}

#[test]
fn eight_ten_chooses_the_words_of_the_ppo_types() {
    let mut bench = fc();
    bench.write(810, 1).unwrap();
    assert_ne!(bench.send(0x047F, 0x2000, 400) & 0x40, 0);
    bench.send(0x047E, 0, 40);
    bench.send(0x047F, 0x2000, 400);
    assert_eq!(bench.drive.state(), State::S4);
}

#[test]
fn the_dc_brake_stops_without_the_ramp() {
    let mut bench = fc();
    bench.write(342, 6000).unwrap(); // a minute
    bench.send(0x047C, 0x4000, 6000);
    bench.send(0x0438, 0x4000, 12_000);
    assert!(
        bench.drive.axis().is_standing(20.0),
        "{}",
        bench.drive.axis().speed()
    );
}

#[test]
fn parameter_channel_in_ppo_1_answers_in_every_tick() {
    let mut bench = Bench::new(&VLT, 101);
    // par. 207 of the print is not in this drive: 1-22 is a word, 3-41 a double word
    bench.outputs[..8].copy_from_slice(&[0x10, 0x7A, 0, 0, 0, 0, 0, 0]);
    bench.send(0x047C, 0x2000, 6000);
    assert_eq!(bench.inputs[..8], [0x10, 0x7A, 0, 0, 0, 0, 0x01, 0x90]);
    assert_eq!((bench.status(), bench.inputs.len()), (0x0F07, 12));
    bench.outputs[..8].copy_from_slice(&[0x31, 0x55, 0, 0, 0, 0, 0x03, 0xE8]); // 3-41 := 10.00 s
    bench.ticks(1);
    assert_eq!(bench.inputs[..8], [0x21, 0x55, 0, 0, 0, 0, 0x03, 0xE8]);
    assert_eq!(bench.read(341), 1000);
    // outside the limits: AK 7 and number 2
    bench.outputs[..8].copy_from_slice(&[0x31, 0x55, 0, 0, 0, 0x10, 0, 0]);
    bench.ticks(1);
    assert_eq!((bench.inputs[0] & 0xF0, bench.inputs[7]), (0x70, 2));
    // unknown number: AK 7 and number 0
    bench.outputs[..8].copy_from_slice(&[0x10, 0xCF, 0, 0, 0, 0, 0, 0]);
    bench.ticks(1);
    assert_eq!((bench.inputs[0] & 0xF0, bench.inputs[7]), (0x70, 0));
    // a standing request follows the value
    bench.outputs[..8].copy_from_slice(&[0x16, 0x4D, 0, 0, 0, 0, 0, 0]); // 16-13 frequency
    bench.ticks(1);
    let running = bench.inputs[7];
    assert!((240..=255).contains(&running), "{running}");
    bench.send(0x043C, 0, 8000);
    assert_eq!(bench.inputs[6..8], [0, 0]);
    // no valid data: nothing is answered, and what comes then is new
    let mut inputs = [0xFF; 12];
    bench.drive.tick(bench.now + CYCLE, None, &mut inputs);
    assert_eq!(inputs[..8], [0; 8]);
}

/// In process data a telegram identical to the last one is not a new request, unlike at a serial line: a refused change
/// is tried again only after AK 0.
#[test]
fn a_change_that_stands_in_ppo_1_is_not_tried_again() {
    let mut bench = Bench::new(&VLT, 101);
    let copy = [0x20, 51, 0, 0, 0, 0, 0, 1]; // 0-51, copy to set-up 1: not while that one runs
    bench.send(0x047C, 0x2000, 2000);
    bench.outputs[..8].copy_from_slice(&copy);
    bench.ticks(1);
    assert_eq!((bench.inputs[0] & 0xF0, bench.inputs[7]), (0x70, 17));
    bench.send(0x043C, 0, 8000);
    assert!(!bench.drive.is_enabled());
    assert_eq!(
        (bench.inputs[0] & 0xF0, bench.inputs[7]),
        (0x70, 17),
        "refused still"
    );
    bench.outputs[..8].fill(0);
    bench.ticks(1);
    bench.outputs[..8].copy_from_slice(&copy);
    bench.ticks(1);
    assert_eq!(bench.inputs[0] & 0xF0, 0x10, "{:02X?}", &bench.inputs[..8]);
}

#[test]
fn process_data_words_carry_chosen_parameters() {
    let mut bench = Bench::new(&VLT, 104);
    let choose = |bench: &mut Bench, array: u16, element: u16, number: u16| {
        let position = VLT.catalogue.position(array).unwrap();
        bench.drive.set_element(position, element, number.into())
    };
    assert_eq!(choose(&mut bench, 915, 0, 341), Err(ErrorNumber::NOT_CHANGEABLE));
    assert_eq!(choose(&mut bench, 915, 2, 1613), Err(ErrorNumber::VALUE));
    assert_eq!(choose(&mut bench, 916, 2, 4999), Err(ErrorNumber::VALUE));
    for (element, number) in [(2, 341), (3, 341), (4, 311)] {
        choose(&mut bench, 915, element, number).unwrap();
    }
    for (element, number) in [(2, 1613), (3, 1614), (4, 1614), (5, 1630)] {
        choose(&mut bench, 916, element, number).unwrap();
    }
    bench.outputs[4..8].copy_from_slice(&500_u32.to_be_bytes());
    bench.outputs[8..10].copy_from_slice(&77_u16.to_be_bytes());
    bench.send(0x047C, 0x4000, 8000);
    assert_eq!((bench.read(341), bench.read(311)), (500, 77));
    let word = |bench: &Bench, at: usize| u16::from_be_bytes([bench.inputs[at], bench.inputs[at + 1]]);
    assert!((495..=520).contains(&word(&bench, 4)), "{}", word(&bench, 4)); // 50 Hz
    assert!(word(&bench, 6) == 0 && word(&bench, 8) > 50); // A in hundredths, a double word
    assert!((500..600).contains(&word(&bench, 10)));
    // shown as numbers of parameters; in telegram 1 as signals
    assert_eq!(
        bench.ask(&[1, 1, 0, 1, 0x10, 3, 3, 0x93, 0, 0]),
        [1, 1, 0, 1, 6, 3, 6, 0x90, 6, 0x92, 1, 0x55]
    );
    let mut plain = profidrive();
    assert_eq!(
        plain.ask(&[1, 1, 0, 1, 0x10, 2, 3, 0x93, 0, 0]),
        [1, 1, 0, 1, 6, 2, 0, 1, 0, 5]
    );
    assert_eq!(
        plain.ask(&[1, 1, 0, 1, 0x10, 2, 3, 0x94, 0, 0]),
        [1, 1, 0, 1, 6, 2, 0, 2, 0, 6]
    );
}

#[test]
fn a_power_cycle_keeps_what_was_to_be_kept() {
    let mut drive = Drive::new(&VLT);
    // 3-41 := 7 s in the working memory, 3-42 := 8 s for good, 3-10[2] := 30 % for good
    let change = |id: u8, pnu: u16, subindex: u8, format: u8, value: &[u8]| {
        let [high, low] = pnu.to_be_bytes();
        let mut request = vec![1, id, 0, 1, 0x10, 1, high, low, 0, subindex, format, 1];
        request.extend_from_slice(value);
        request
    };
    assert_eq!(
        ask(&mut drive, &change(2, 341, 0, 7, &700_u32.to_be_bytes())),
        [1, 2, 0, 1]
    );
    assert_eq!(
        ask(&mut drive, &change(0x42, 342, 0, 7, &800_u32.to_be_bytes()))[1] & 0x80,
        0
    );
    assert_eq!(
        ask(&mut drive, &change(0x42, 310, 2, 3, &3000_u16.to_be_bytes()))[1] & 0x80,
        0
    );
    let mut saved = None;
    while let Some(event) = drive.poll_event() {
        if let Event::Save { text, .. } = event {
            saved = Some(text);
        }
    }
    let saved = saved.unwrap();
    assert!(
        saved.contains("\n3-42 = 8\n") && saved.contains("\n3-10[2] = 30"),
        "{saved}"
    );
    let mut again = Drive::new(&VLT);
    assert_eq!(again.start_with(saved.as_bytes()), Ok(0));
    assert_eq!(again.parameter(341), Some(300));
    assert_eq!(again.parameter(342), Some(800));
    assert_eq!(again.values.element_of(310, 2), 3000);
    // 9-71 keeps everything
    assert_eq!(ask(&mut drive, &change(2, 971, 0, 5, &[1, 0])), [1, 2, 0, 1]);
    let text = std::iter::from_fn(|| drive.poll_event()).find_map(|event| match event {
        Event::Save { text, .. } => Some(text),
        _ => None,
    });
    again.start_with(text.unwrap().as_bytes()).unwrap();
    assert_eq!(again.parameter(341), Some(700));
    assert_eq!(again.parameter(971), Some(0));
}

#[test]
fn alarms_and_warnings_have_their_words_and_their_log() {
    let mut bench = profidrive();
    bench.send(0x047E, 0, 40);
    bench.send(0x047F, 0x2000, 2000);
    bench.drive.inject(Injection::BusVoltage(Some(900.0)));
    bench.ticks(2);
    assert!(!bench.drive.is_enabled());
    assert_eq!(bench.drive.fault_number(0), 7);
    assert_eq!((bench.read(1690), bench.read(1692)), (1 << 11, 1 << 13));
    assert_eq!(bench.status() & 0x88, 0x88);
    // the cause is there: no acknowledge
    bench.send(0x04FE, 0, 40);
    assert!(bench.drive.has_fault());
    bench.send(0x047E, 0, 40);
    bench.drive.inject(Injection::BusVoltage(None));
    bench.send(0x04FE, 0, 40);
    bench.send(0x047E, 0, 40);
    assert!(!bench.drive.has_fault());
    assert_eq!((bench.read(1690), bench.drive.fault_number(8)), (0, 7));
    // 15-30: the newest first, one octet each, ten of them
    bench.drive.inject_fault(14, false);
    let log = [1, 1, 0, 1, 0x10, 2, 0x05, 0xFA, 0, 0];
    assert_eq!(bench.ask(&log), [1, 1, 0, 1, 5, 2, 14, 7]);
    assert_eq!(
        bench.ask(&[1, 1, 0, 1, 0x10, 1, 0x05, 0xFA, 0, 10])[1..8],
        [0x81, 0, 1, 0x44, 2, 0, 3]
    );
    // earth fault is a trip lock: only a restart clears it
    assert_eq!(bench.send(0x047E, 0, 40) & 8, 8);
    bench.send(0x04FE, 0, 40);
    assert!(bench.drive.has_fault());
}

#[test]
fn a_lost_controller_is_what_eight_three_and_eight_four_say() {
    // value of 8-04, speed that it ends with, fault, warning of the control word
    let rows = [
        (0, 750.0, false, false),
        (1, 750.0, false, true),
        (2, 0.0, false, true),
        (3, 100.0, false, true),
        (4, 1800.0, false, true),
        (5, 0.0, true, false),
    ];
    for (function, speed, trips, warns) in rows {
        let mut bench = profidrive();
        bench.write(804, function).unwrap();
        bench.write(803, 20).unwrap(); // 2 s
        bench.write(319, 100).unwrap();
        bench.send(0x047E, 0, 40);
        bench.send(0x047F, 0x2000, 6000);
        bench.drive.disconnect(Disconnect::Lost);
        let wait = |bench: &mut Bench, milliseconds: u64| {
            let end = bench.now + Duration::from_millis(milliseconds);
            while bench.now < end {
                bench.now += CYCLE;
                bench.drive.tick(bench.now, None, &mut []);
            }
        };
        // until its time is over the last word counts, whatever comes then
        wait(&mut bench, 1800);
        assert!(bench.drive.is_enabled() && !bench.drive.has_fault(), "{function}");
        assert!((bench.drive.axis().speed() - 750.0).abs() < 30.0, "{function}");
        assert_eq!(bench.drive.warning_number(0), 34);
        wait(&mut bench, 15_000);
        let turns = bench.drive.axis().speed();
        assert!((turns - speed).abs() < 40.0, "{function}: {turns} rpm");
        assert_eq!(bench.drive.has_fault(), trips, "{function}");
        let warned = (0..4).any(|place| bench.drive.warning_number(place) == 17);
        assert_eq!(warned, warns, "{function}");
        // a controller that comes back has it again
        bench.drive.connect(1, CYCLE * 3).unwrap();
        bench.send(0x047E, 0, 20_000);
        bench.send(0x04FE, 0, 40);
        bench.send(0x047E, 0, 40);
        assert_eq!(bench.drive.warning_number(0), 0, "{function}");
        assert!(
            bench.drive.axis().is_at_rest() && !bench.drive.has_fault(),
            "{function}"
        );
    }
}

#[test]
fn the_motor_and_the_profile_are_changed_at_standstill_only() {
    let mut bench = fc();
    bench.send(0x047C, 0x2000, 6000);
    assert!(bench.drive.is_enabled());
    for (number, raw) in [(120, 150), (139, 6), (810, 1), (410, 1)] {
        assert_eq!(bench.write(number, raw), Err(ErrorNumber::NOT_NOW), "{number}");
    }
    assert_eq!(bench.write(341, 500), Ok(()));
    bench.send(0x043C, 0, 8000);
    for (number, raw) in [(120, 150), (139, 6), (810, 1), (410, 1)] {
        assert_eq!(bench.write(number, raw), Ok(()), "{number}");
    }
}

#[test]
fn strings_texts_and_descriptions() {
    let mut drive = Drive::new(&VLT);
    let answer = ask(&mut drive, &[1, 1, 0, 1, 0x10, 0, 0x06, 0x04, 0, 0]); // 15-40
    assert_eq!(answer, [&[1, 1, 0, 1, 9, 6][..], b"FC-302"].concat());
    assert_eq!(
        ask(&mut drive, &[1, 1, 0, 1, 0x10, 0, 0x03, 0xC5, 0, 0]),
        [1, 1, 0, 1, 10, 2, 3, 0x29]
    );
    // text of 8-10 = 1
    let answer = ask(&mut drive, &[1, 1, 0, 1, 0x30, 1, 0x03, 0x2A, 0, 1]);
    assert_eq!(answer, [&[1, 1, 0, 1, 9, 16][..], b"PROFIdrive profi"].concat());
    assert_eq!(
        ask(&mut drive, &[1, 1, 0, 1, 0x30, 1, 0x03, 0x2A, 0, 2])[6..8],
        [0, 0x0F]
    );
    let description = drive.description(341).unwrap();
    assert_eq!((description.size_index, description.conversion_index), (4, -2));
    assert_eq!((description.identifier.0, description.factor), (0x0007, 100.0));
    assert_eq!(drive.description(1).unwrap().identifier.0, 0x0405); // 0-01 Language
    assert_eq!(&description.name, b"Ramp 1 Ramp up T");
    assert_eq!(description.minimum, 1_u32.to_be_bytes());
    assert_eq!(description.maximum, 360_000_u32.to_be_bytes());
    let reference = drive.description(1682).unwrap();
    assert_eq!((reference.reference_pnu, reference.normalisation), (303, 0x800E));
    // min and max accepted, one more is not
    for (raw, result) in [
        (1, Ok(())),
        (360_000, Ok(())),
        (360_001, Err(ErrorNumber::LIMIT)),
        (0, Err(ErrorNumber::LIMIT)),
    ] {
        assert_eq!(drive.write(341, 0, raw, Keep::Volatile), result);
    }
}

#[test]
fn nine_twenty_seven_takes_the_right_to_change() {
    let mut drive = Drive::new(&VLT);
    let change = [1, 2, 0, 1, 0x10, 1, 0x03, 0x9F, 0, 0, 6, 1, 0, 0];
    assert_eq!(ask(&mut drive, &change), [1, 2, 0, 1]);
    let ramp = [1, 2, 0, 1, 0x10, 1, 0x01, 0x55, 0, 0, 7, 1, 0, 0, 1, 0];
    assert_eq!(ask(&mut drive, &ramp)[..8], [1, 0x82, 0, 1, 0x44, 1, 0, 0x0B]);
    let mut back = change;
    back[13] = 1;
    assert_eq!(ask(&mut drive, &back), [1, 2, 0, 1]);
    assert_eq!(ask(&mut drive, &ramp), [1, 2, 0, 1]);
}

#[test]
fn the_lists_name_every_number_and_what_was_changed() {
    let mut drive = Drive::new(&VLT);
    let mut all = Vec::new();
    for list in 980..=983 {
        for element in 0..117 {
            match drive.read(list, element).unwrap() {
                0 => break,
                number => all.push(number as u16),
            }
        }
    }
    let expected: Vec<u16> = VLT
        .catalogue
        .numbers()
        .filter(|pnu| !(980..=989).contains(pnu))
        .collect();
    assert_eq!(all, expected);
    assert_eq!(drive.read(990, 0), Ok(0));
    drive.write(341, 0, 777, Keep::Volatile).unwrap();
    assert_eq!((drive.read(990, 0), drive.read(990, 1)), (Ok(341), Ok(0)));
}

#[test]
fn read_outs_of_a_running_motor() {
    let mut bench = profidrive();
    bench.send(0x047E, 0, 40);
    bench.send(0x047F, 0x4000, 8000);
    let (frequency, speed) = (bench.read(1613), bench.read(1617));
    assert!((500..=515).contains(&frequency), "{frequency}");
    assert!((1490..=1510).contains(&speed), "{speed}");
    assert!((3900..=4010).contains(&bench.read(1612))); // V in tenths
    assert!((50..=190).contains(&bench.read(1614)), "{}", bench.read(1614));
    assert!((500..=600).contains(&bench.read(1630)));
    assert_eq!((bench.read(1601), bench.read(1602)), (1_500_000, 1000));
    assert!((20..60).contains(&bench.read(1634)));
    // half of the nominal torque
    bench.drive.inject(Injection::Load(2.5));
    bench.ticks(2000);
    assert!((25..=60).contains(&bench.read(1610)), "{}", bench.read(1610)); // kW in hundredths
    assert!((20..=35).contains(&bench.read(1616)), "{}", bench.read(1616)); // Nm in tenths
    assert_eq!(bench.read(1694) & 0b101, 0b100);
    bench.ticks(1_000_000 / 4 * 4);
    assert_eq!((bench.read(1500), bench.read(1501)), (1, 1));
}

#[test]
fn a_blocked_shaft_warns_and_a_protected_motor_trips() {
    let mut bench = profidrive();
    bench.write(190, 4).unwrap(); // ETR trip
    bench.send(0x047E, 0, 40);
    bench.drive.inject(Injection::Block(true));
    bench.send(0x047F, 0x4000, 4000);
    assert_eq!(bench.drive.warning_number(0), 59);
    assert_eq!(bench.status() & 0x4000, 0x4000);
    for _ in 0..500 {
        if bench.drive.has_fault() {
            break;
        }
        bench.ticks(1000);
    }
    assert!(
        matches!(bench.drive.fault_number(0), 9 | 10),
        "{}",
        bench.drive.fault_number(0)
    );
}

/// 0-37, a string of 25 characters: in RAM by request 2, saved by request 0x42, and back with the power.
#[test]
fn a_string_is_written_saved_and_starts_with_the_drive() {
    let change = |id: u8, text: &str| {
        let mut request = vec![7, id, 0, 1, 0x10, 1, 0, 37, 0, 0, 9, 25];
        request.extend(format!("{text:25}").into_bytes());
        request.push(0);
        request
    };
    let read = |drive: &mut Drive| {
        let mut out = [0; 240];
        let length = drive
            .serve(&[7, 1, 0, 1, 0x10, 1, 0, 37, 0, 0], &mut out)
            .unwrap();
        String::from_utf8(out[6..length.min(31)].to_vec()).unwrap()
    };
    let saved = |drive: &mut Drive| {
        std::iter::from_fn(|| drive.poll_event()).find_map(|event| match event {
            Event::Save {
                text, asked: true, ..
            } => Some(text),
            _ => None,
        })
    };
    let mut drive = Drive::new(&VLT);
    assert_eq!(read(&mut drive), " ".repeat(25));
    drive.serve(&change(2, "IN RAM"), &mut [0; 240]).unwrap();
    assert_eq!(read(&mut drive), format!("{:25}", "IN RAM"));
    assert_eq!(saved(&mut drive), None);
    drive
        .serve(&change(0x42, "PUMP #3 = NORTH"), &mut [0; 240])
        .unwrap();
    let text = saved(&mut drive).expect("saved");
    assert!(text.contains("\n0-37 = PUMP%20%233%20%3D%20NORTH\n"), "{text}");
    let mut again = Drive::new(&VLT);
    assert_eq!(again.start_with(text.as_bytes()), Ok(0));
    assert_eq!(read(&mut again), format!("{:25}", "PUMP #3 = NORTH"));
    again.reset_to_delivery();
    assert_eq!(read(&mut again), " ".repeat(25));
}

/// The formats 2 and 54 of MG06G102 5.8: an Integer8 and a time difference without date.
#[test]
fn an_integer8_and_a_time_difference_have_their_formats() {
    let mut drive = Drive::new(&VLT);
    let mut ask = |request: &[u8]| {
        let mut out = [0; 240];
        let length = drive.serve(request, &mut out).unwrap();
        out[..length].to_vec()
    };
    assert_eq!(
        ask(&[7, 2, 0, 1, 0x10, 1, 0x07, 0x6C, 0, 0, 2, 1, 0x9C, 0]),
        [7, 2, 0, 1]
    );
    assert_eq!(
        ask(&[7, 1, 0, 1, 0x10, 1, 0x07, 0x6C, 0, 0]),
        [7, 1, 0, 1, 2, 1, 0x9C, 0],
        "19-00 is -100"
    );
    assert_eq!(
        ask(&[7, 2, 0, 1, 0x10, 1, 0x05, 0x28, 0, 1, 54, 1, 0, 0, 0x05, 0xDC]),
        [7, 2, 0, 1]
    );
    assert_eq!(
        ask(&[7, 1, 0, 1, 0x10, 3, 0x05, 0x28, 0, 0]),
        [7, 1, 0, 1, 54, 3, 0, 0, 0, 0, 0, 0, 0x05, 0xDC, 0, 0, 0, 0],
        "13-20[1] is 1.5 s"
    );
}

/// 8-04 is off: until the next controller takes control, connecting changes nothing.
#[test]
fn a_new_connection_leaves_the_last_word_and_setpoint_in_force() {
    for (control, speed) in [(0x047F, 0x2000), (0x047F, -0x1000), (0x057F & !0x10, 0)] {
        let mut bench = profidrive();
        bench.write(300, 1).unwrap();
        bench.write(410, 2).unwrap();
        bench.send(0x047E, 0, 40);
        bench.send(control, speed, 8000);
        let before = bench.drive.axis().speed();
        assert!(before.abs() > 100.0, "{before}");
        bench.drive.disconnect(Disconnect::Lost);
        bench.without_controller(2000);
        bench.drive.connect(1, 3 * CYCLE).unwrap();
        // start-up takes its time, then data come that take no control
        bench.without_controller(500);
        bench.send(0, 0, 500);
        let after = bench.drive.axis().speed();
        assert!((after - before).abs() < 2.0, "{control:04X}: {before} -> {after}");
        bench.send(0x047E, 0, 8000);
        assert!(!bench.drive.is_enabled() && bench.drive.axis().is_at_rest());
    }
}

/// MG06G102 5.8: the octet that fills up an odd value may have any content, and may be missing behind the last value.
#[test]
fn the_octet_that_fills_up_an_odd_value_does_not_count() {
    let mut drive = Drive::new(&VLT);
    for (end, value) in [(&[0xFE][..], 0xFE), (&[5, 0x77], 5), (&[0x9C, 0], 0x9C)] {
        let request = [&[7, 2, 0, 1, 0x10, 1, 0x07, 0x6C, 0, 0, 2, 1][..], end].concat();
        assert_eq!(ask(&mut drive, &request), [7, 2, 0, 1], "{end:02X?}");
        let answer = ask(&mut drive, &[7, 1, 0, 1, 0x10, 1, 0x07, 0x6C, 0, 0]);
        assert_eq!(answer, [7, 1, 0, 1, 2, 1, value, 0]);
    }
}

/// The parameter bytes: AK 2 and 14 write a word, which is PWE LOW.
#[test]
fn a_change_of_a_word_takes_pwe_low_alone() {
    let mut drive = Drive::new(&VLT);
    let mut server = pkw::Server::new(pkw::PkwDialect::DANFOSS_FC);
    for ak in [0x20, 0xE0] {
        let request = [ak, 0x01, 0, 0, 0, 1, 0, 1]; // 0-01 = 1, PWE HIGH is 1
        let answer = server.handle(request, &mut drive);
        assert!(answer[0] >> 4 <= 1, "{answer:02X?}");
        assert_eq!(drive.parameter(1), Some(1));
        drive.write(1, 0, 0, Keep::Volatile).unwrap();
    }
}
