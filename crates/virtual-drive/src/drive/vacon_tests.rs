//! The virtual Vacon 100: its words, its ids behind PNU 10001, its faults.

use profile::parameter::{ErrorNumber, Keep, ParameterAccess};

use super::bench::{Bench, ask};
use super::*;
use crate::model::VACON;

#[test]
fn the_vendor_words_start_and_stop() {
    let mut bench = Bench::new(&VACON, 148);
    // not without OFF
    bench.send(0x047F, 5000, 200);
    assert!(!bench.drive.is_enabled());
    bench.send(0x047E, 0, 40);
    let status = bench.send(0x047F, 5000, 8000);
    assert_eq!(bench.drive.state(), State::S4);
    // ready 1, ready 2, enabled, no stop 2, no stop 3, reference = actual, fieldbus control, running, ready
    assert_eq!(status, 0x3337, "{status:04X}");
    assert!((bench.drive.axis().speed() - 750.0).abs() < 15.0);
    assert!((4900..=5100).contains(&bench.speed()), "{}", bench.speed());
    // coast
    bench.send(0x047D, 5000, 8);
    assert!(!bench.drive.is_enabled() && bench.drive.axis().speed() > 600.0);
    bench.send(0x047E, 0, 8000);
    // stop 3 is on the ordinary ramp: 5 s from 50 Hz to 0
    bench.send(0x047F, 10_000, 8000);
    bench.send(0x047B, 10_000, 2500);
    let half = bench.drive.axis().speed_command();
    assert!((half - 750.0).abs() < 25.0, "{half}");
}

#[test]
fn the_reference_goes_from_the_lowest_to_the_highest_frequency() {
    let mut bench = Bench::new(&VACON, 149);
    bench.write(101, 1000).unwrap(); // 10 Hz
    bench.write(102, 4000).unwrap(); // 40 Hz
    bench.send(0x047E, 0, 40);
    for (reference, rpm) in [
        (0, 300.0),
        (5000, 750.0),
        (10_000, 1200.0),
        (-10_000, -1200.0),
        (20_000, 1200.0),
    ] {
        bench.send(0x047F, reference, 12_000);
        let speed = bench.drive.axis().speed();
        assert!((speed - rpm).abs() < 15.0, "{reference} {speed}");
    }
    assert!((9900..=10_100).contains(&bench.speed()));
    // telegram 1 is N2 of the highest frequency
    let mut bench = Bench::new(&VACON, 1);
    bench.send(0x047E, 0, 40);
    bench.send(0x047F, 0x4000, 8000);
    assert!((bench.drive.axis().speed() - 1500.0).abs() < 15.0);
    assert!((i32::from(bench.speed()) - 0x4000).abs() < 164);
    assert_eq!(bench.read(2), bench.drive.axis().measured_speed().round() as i64);
    assert!((4990..=5080).contains(&bench.read(1)));
}

#[test]
fn process_data_out_are_chosen_and_process_data_in_are_kept_nowhere() {
    let mut bench = Bench::new(&VACON, 150);
    // as delivered: ids 1, 2, 45, 4 to 7 and 37
    for (number, id) in (852..=859).zip([1, 2, 45, 4, 5, 6, 7, 37]) {
        assert_eq!(bench.read(number), id, "{number}");
    }
    bench.outputs[4..6].copy_from_slice(&0x1234_u16.to_be_bytes());
    bench.send(0x047E, 0, 40);
    bench.send(0x047F, 10_000, 8000);
    assert_eq!((bench.read(2004), bench.read(876)), (0x1234, 0x1234));
    let word = |bench: &Bench, number: usize| {
        i64::from(u16::from_be_bytes([
            bench.inputs[4 + 2 * number],
            bench.inputs[5 + 2 * number],
        ]))
    };
    assert_eq!(word(&bench, 0), bench.read(1));
    assert_eq!(word(&bench, 6), bench.read(7));
    bench.drive.inject_fault(51, false);
    bench.ticks(1);
    assert_eq!((word(&bench, 7), bench.read(2111), bench.read(873)), (51, 51, 51));
    bench.write(852, 113).unwrap();
    bench.ticks(1);
    assert_eq!(word(&bench, 0), 26);
    let saved =
        std::iter::from_fn(|| bench.drive.poll_event()).any(|event| matches!(event, Event::Save { .. }));
    assert!(!saved);
}

#[test]
fn ids_are_subindices_of_10001_and_every_write_lasts() {
    let mut drive = Drive::new(&VACON);
    // the worked examples: identification, ID 103, its change to 5.0 s
    assert_eq!(
        ask(&mut drive, &[2, 1, 1, 1, 0x10, 6, 3, 0xC4, 0, 0]),
        [
            2, 1, 1, 1, 0x42, 6, 0x01, 0xBA, 0, 2, 0, 100, 0x07, 0xDE, 0, 0x65, 0, 1
        ]
    );
    assert_eq!(
        ask(&mut drive, &[3, 1, 1, 1, 0x10, 1, 0x27, 0x11, 0, 0x67]),
        [3, 1, 1, 1, 0x42, 1, 0, 50]
    );
    let change = [4, 2, 1, 1, 0x10, 1, 0x27, 0x11, 0, 0x67, 0x42, 1, 0, 0x46];
    assert_eq!(ask(&mut drive, &change), [4, 2, 1, 1]);
    let text = std::iter::from_fn(|| drive.poll_event()).find_map(|event| match event {
        Event::Save { text, .. } => Some(text),
        _ => None,
    });
    let text = text.unwrap();
    assert!(text.contains("\nID 103 = 7 # s\n"), "{text}");
    let mut again = Drive::new(&VACON);
    assert_eq!(again.start_with(text.as_bytes()), Ok(0));
    assert_eq!(again.parameter(103), Some(70));
    // drive parameters are words, always
    for parameter in VACON.catalogue.parameters {
        if let Some(id) = parameter.base {
            let [high, low] = id.to_be_bytes();
            let answer = ask(&mut drive, &[5, 1, 1, 1, 0x10, 1, 0x27, 0x11, high, low]);
            assert_eq!((answer[1], answer[4], answer.len()), (1, 0x42, 8), "{id}");
        }
    }
    assert_eq!(
        drive.write(10_001, 1, 3, Keep::Volatile),
        Err(ErrorNumber::NOT_CHANGEABLE)
    );
}

#[test]
fn the_fault_history_has_eight_entries() {
    let mut drive = Drive::new(&VACON);
    let history = |drive: &mut Drive| -> Vec<u64> { (0..8).map(|at| drive.read(947, at).unwrap()).collect() };
    let before = drive.read(944, 0).unwrap();
    drive.inject_fault(51, false);
    // a second fault of the same situation has no place
    drive.inject_fault(52, false);
    assert_eq!(history(&mut drive), [51, 0, 0, 0, 0, 0, 0, 0]);
    assert!(drive.read(944, 0).unwrap() > before);
    drive.tick(Instant::from_millis(4), None, &mut []);
    drive.execute(crate::model::Action::ClearFaults).unwrap();
    assert_eq!(history(&mut drive), [0, 51, 0, 0, 0, 0, 0, 0]);
    assert_eq!(ask(&mut drive, &[1, 1, 1, 1, 0x10, 1, 3, 0xB3, 0, 8])[1], 0x81);
}

#[test]
fn fieldbus_loss_follows_id_733() {
    for (response, trips, goes_on) in [
        (0, false, true),
        (1, false, true),
        (2, true, false),
        (3, true, false),
    ] {
        let mut bench = Bench::new(&VACON, 148);
        bench.write(733, response).unwrap();
        bench.send(0x047E, 0, 40);
        bench.send(0x047F, 5000, 8000);
        let before = bench.drive.axis().speed();
        bench.drive.disconnect(Disconnect::Lost);
        assert_eq!(
            (bench.drive.has_fault(), bench.drive.has_warning()),
            (trips, !trips)
        );
        assert_eq!(bench.read(37), if trips { 53 } else { 0 });
        bench.without_controller(500);
        let kept = bench.drive.axis().speed() > before * 0.95;
        assert_eq!(
            kept,
            goes_on,
            "{response}: {} of {before}",
            bench.drive.axis().speed()
        );
        // a fault with 3 takes the power stage off at once, with 2 it ends a ramp
        assert_eq!(bench.drive.is_enabled(), response != 3, "{response}");
    }
}

/// ID 2003 and 875 are percent in steps of 0.01, like ID 2103 and 865: also when the telegram counts in N2.
#[test]
fn the_reference_reads_in_percent_whatever_the_telegram_counts_in() {
    for (telegram, raw) in [(1, 6554), (148, 4000), (149, 4000)] {
        let mut bench = Bench::new(&VACON, telegram);
        bench.send(0x047E, 0, 40);
        bench.send(0x047F, raw, 8000);
        assert_eq!((bench.read(2003), bench.read(875)), (4000, 4000), "{telegram}");
        assert!(
            (bench.read(2103) - 4000).abs() < 60,
            "{telegram}: {}",
            bench.read(2103)
        );
        bench.send(0x047F, -raw, 8000);
        assert_eq!(bench.read(2003), -4000, "{telegram}");
        // the controller's own
        assert_eq!(bench.write(2003, 1000), Err(ErrorNumber::NOT_NOW));
    }
    // written without a controller it is the same number
    let mut drive = Drive::new(&VACON);
    drive.write(10_001, 2003, 4000, Keep::Volatile).unwrap();
    assert_eq!(
        (drive.parameter(2003), drive.parameter(875)),
        (Some(4000), Some(4000))
    );
}

/// PNU 923 names parameters that can be read, and the 32-bit process data in are those that came.
#[test]
fn signals_are_parameters_and_wide_process_data_are_what_came() {
    let mut bench = Bench::new(&VACON, 150);
    let signal = |bench: &mut Bench, number: u16| bench.drive.read(923, number).unwrap();
    // application ids: they have no number of their own
    for number in [1, 2, 5, 6] {
        assert_eq!(signal(&mut bench, number), 0, "{number}");
    }
    for number in 0..151 {
        let pnu = signal(&mut bench, number) as u16;
        assert!(
            pnu == 0 || bench.drive.read(pnu, 0).is_ok(),
            "923[{number}] is {pnu}"
        );
    }
    for number in 137..=139 {
        assert_eq!(signal(&mut bench, number), 10_122, "{number}");
    }
    assert_eq!((signal(&mut bench, 3), signal(&mut bench, 136)), (0, 0));
    for (place, octet) in bench.outputs[4..20].chunks_exact_mut(2).zip(0x11..) {
        place.copy_from_slice(&[0, octet]);
    }
    bench.send(0x047E, 0, 40);
    let read = |bench: &mut Bench, at: u16| bench.drive.read(10_122, at).unwrap();
    let wide: Vec<u64> = (0..8).map(|at| read(&mut bench, at)).collect();
    assert_eq!(wide, [0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17, 0x18]);
    // what does not fit a word of the process data is not taken
    let mut drive = Drive::new(&VACON);
    drive.write(10_122, 2, 0x1234, Keep::Volatile).unwrap();
    assert_eq!(
        (drive.parameter(2006), drive.read(10_122, 2)),
        (Some(0x1234), Ok(0x1234))
    );
    assert_eq!(
        drive.write(10_122, 2, 0x1_0000, Keep::Volatile),
        Err(ErrorNumber::LIMIT)
    );
}

/// OPTEA p. 119: attribute 0x20 is allowed; ids share one number, so that none of them has a description.
#[test]
fn an_id_has_no_description_and_a_number_of_the_profile_has_one() {
    let mut bench = Bench::new(&VACON, 1);
    let answer = bench.ask(&[1, 1, 1, 1, 0x20, 1, 0x27, 0x11, 0, 103]);
    assert_eq!(answer, [1, 0x81, 1, 1, 0x44, 1, 0, 0x09]);
    let answer = bench.ask(&[1, 1, 1, 1, 0x20, 1, 0x03, 0xA2, 0, 0]);
    assert_eq!((answer.len(), &answer[..6]), (52, &[1, 1, 1, 1, 0x0A, 46][..]));
}

/// OPTEA p. 119 allows 1 to 234 elements: an array that is shorter ends first.
#[test]
fn more_elements_than_the_fault_buffer_has_are_no_elements() {
    let mut drive = Drive::new(&VACON);
    for (elements, number) in [(9, 3), (117, 3), (118, 3), (234, 3), (235, 0x16)] {
        let answer = ask(&mut drive, &[1, 1, 1, 1, 0x10, elements, 0x03, 0xB3, 0, 0]);
        assert_eq!(answer, [1, 0x81, 1, 1, 0x44, 1, 0, number], "{elements}");
    }
    let answer = ask(&mut drive, &[1, 1, 1, 1, 0x10, 8, 0x03, 0xB3, 0, 0]);
    assert_eq!(answer[..6], [1, 1, 1, 1, 0x42, 8]);
}
