//! Faults and warnings: causes, reactions, the situation buffer and its acknowledge.

use super::tests::Bench;
use super::*;

/// ZSW1 bits 3 and 7.
const FAULT: u16 = 0x0008;
const WARNING: u16 = 0x0080;

/// Sends OFF, then the acknowledge.
fn acknowledge(bench: &mut Bench) -> u16 {
    bench.send(0x047E, 0, 2);
    bench.send(0x04FE, 0, 2);
    bench.send(0x047E, 0, 2)
}

#[test]
fn the_reaction_is_the_one_of_the_table() {
    for (number, state) in [
        (439, State::S1),      // coast
        (405, State::S1),      // dynamic brake: pulses off too
        (702, State::S5Quick), // controlled stop
        (121, State::S5Ramp),
        (9999, State::S1), // in no table
    ] {
        let mut bench = Bench::new();
        bench.run(4000);
        bench.drive.inject_fault(number, false);
        assert_eq!(bench.send(0x047F, 4000, 1) & FAULT, FAULT, "F{number}");
        assert_eq!(bench.drive.state(), state, "F{number}");
    }
}

#[test]
fn the_strongest_of_several_reactions_counts() {
    let mut bench = Bench::new();
    bench.run(4000);
    bench.drive.inject_fault(702, false);
    bench.drive.inject_fault(121, false);
    bench.send(0x047F, 4000, 1);
    assert_eq!(bench.drive.state(), State::S5Quick);
    bench.drive.inject_fault(501, false);
    bench.send(0x047F, 4000, 1);
    assert_eq!(bench.drive.state(), State::S1);
}

#[test]
fn ten_faults_of_one_situation_are_known_and_eight_are_in_the_buffer() {
    let mut bench = Bench::new();
    bench.send(0x047E, 0, 2);
    for number in 401..=412 {
        bench.drive.inject_fault(number, false);
    }
    let shown: Vec<i64> = (1..=10).map(|n| bench.read(&format!("DRV.FAULT{n}"))).collect();
    assert_eq!(shown, [401, 402, 403, 404, 405, 406, 407, 408, 409, 410]);
    let buffer: Vec<i64> = (0..16).map(|index| bench.element("947", index)).collect();
    assert_eq!(buffer[..8], shown[..8]);
    assert_eq!(buffer[8..], [0; 8]);
    assert_eq!(acknowledge(&mut bench) & FAULT, 0);
    let shown: Vec<i64> = (1..=10).map(|n| bench.read(&format!("DRV.FAULT{n}"))).collect();
    assert_eq!(shown, [0; 10], "acknowledged ones are history");
    assert_eq!(bench.element("947", 8), 401);
}

#[test]
fn a_ninth_fault_has_its_reaction_too() {
    let mut bench = Bench::new();
    bench.run(4000);
    for number in [121, 123, 135, 702, 125, 129, 130, 131] {
        bench.drive.inject_fault(number, false);
    }
    bench.send(0x047F, 4000, 1);
    assert_eq!(bench.drive.state(), State::S5Quick);
    bench.drive.inject_fault(501, false);
    bench.send(0x047F, 4000, 1);
    assert_eq!(bench.drive.state(), State::S1);
}

#[test]
fn clrfaults_brings_back_what_lasts_and_clears_the_rest() {
    let mut bench = Bench::new();
    bench.send(0x047E, 0, 2);
    bench.drive.inject_fault(301, false);
    bench.drive.inject_fault(501, true);
    bench.drive.inject_fault(304, false);
    bench.send(0x047E, 0, 1);
    let counter = bench.read("944");
    assert_eq!(
        acknowledge(&mut bench) & FAULT,
        FAULT,
        "the control word needs all causes gone"
    );
    assert_eq!(bench.read("944"), counter);
    bench.write("DRV.CLRFAULTS", 1).unwrap();
    assert_eq!(bench.send(0x047E, 0, 1) & FAULT, FAULT);
    assert_eq!((bench.read("DRV.FAULT1"), bench.read("DRV.FAULT2")), (501, 0));
    let history: Vec<i64> = (8..12).map(|index| bench.element("947", index)).collect();
    assert_eq!(history, [301, 501, 304, 0]);
    assert_eq!(bench.read("944"), counter + 2);
    bench.write("2112", 1).unwrap(); // the other number of the command
    assert_eq!(
        bench.read("944"),
        counter + 2,
        "nothing to clear: nothing changes"
    );
    bench.drive.remove_cause(501);
    bench.write("DRV.CLRFAULTS", 1).unwrap();
    assert_eq!(bench.send(0x047E, 0, 2) & 0x007F, 0x0031);
}

#[test]
fn a_fault_of_the_hardware_needs_a_restart() {
    let mut bench = Bench::new();
    bench.drive.inject_fault(203, false);
    assert_eq!(acknowledge(&mut bench) & FAULT, FAULT);
}

#[test]
fn fault_actions_make_a_warning_or_nothing_of_a_fault() {
    let mut bench = Bench::new();
    bench.run(163);
    bench.write("FAULT702.ACTION", 1).unwrap();
    bench.drive.disconnect(Disconnect::Lost);
    assert!(!bench.drive.has_fault());
    bench.drive.connect(1, Duration::from_millis(48)).unwrap();
    bench.write("FAULT702.ACTION", 4).unwrap();
    bench.run(163);
    bench.drive.disconnect(Disconnect::Lost);
    assert!(!bench.drive.has_fault() && bench.drive.has_warning());
    assert_eq!(bench.read("DRV.WARNING1"), 702);
    while let Some(next) = bench.drive.next_tick() {
        bench.now = next;
        bench.drive.tick(next, None, &mut []);
    }
    assert!(!bench.drive.is_enabled(), "it stops all the same");
    bench.drive.connect(1, Duration::from_millis(48)).unwrap();
    assert_eq!(
        bench.send(0x047E, 0, 2) & WARNING,
        0,
        "the next connection ends it"
    );
}

#[test]
fn a_start_up_that_breaks_off_is_no_lost_connection() {
    let mut bench = Bench::new();
    for _ in 0..3 {
        bench.tick(None); // ParameterEnd is over, data has not come
    }
    bench.drive.disconnect(Disconnect::Lost);
    assert!(
        !bench.drive.has_fault()
            && bench
                .events()
                .iter()
                .all(|event| !matches!(event, Event::Fault { .. }))
    );
    // A controller in STOP that has come so far is one.
    bench.drive.connect(1, Duration::from_millis(48)).unwrap();
    bench.drive.data_exchange();
    bench.tick(None);
    bench.drive.disconnect(Disconnect::Lost);
    assert_eq!(bench.element("947", 0), 702);
}

#[test]
fn warnings_have_their_bit_and_their_parameters() {
    let mut bench = Bench::new();
    assert_eq!(bench.send(0x047E, 0, 2) & WARNING, 0);
    for number in [107, 438, 107, 108, 439] {
        bench.drive.warn(number, true);
    }
    let shown = |bench: &Bench| [1, 2, 3].map(|n| bench.read(&format!("DRV.WARNING{n}")));
    assert_eq!(shown(&bench), [107, 438, 108]);
    assert_eq!(bench.send(0x047E, 0, 1) & (WARNING | FAULT), WARNING);
    bench.drive.warn(438, false);
    bench.drive.warn(438, false);
    assert_eq!(shown(&bench), [107, 108, 439]);
    for number in [107, 108, 439] {
        bench.drive.warn(number, false);
    }
    assert_eq!(bench.send(0x047E, 0, 1) & WARNING, 0);
    let warnings: Vec<Event> = bench
        .events()
        .into_iter()
        .filter(|event| matches!(event, Event::Warning { .. }))
        .collect();
    assert_eq!(warnings.len(), 8, "{warnings:?}");
}

#[test]
fn a_disable_that_takes_too_long_is_forced() {
    let mut bench = Bench::new();
    bench.write("DRV.DISMODE", 2).unwrap();
    bench.write("DRV.DISTO", 500).unwrap();
    bench.write("DRV.DEC", 100_000).unwrap(); // 100 rpm/s
    bench.run(1638);
    bench.write("DRV.DIS", 1).unwrap();
    bench.send(0x047F, 1638, 30);
    assert_eq!(bench.drive.state(), State::S5Ramp);
    bench.send(0x047F, 1638, 3);
    assert_eq!(bench.drive.state(), State::S1);
    assert_eq!(bench.element("947", 0), 703);
    assert_eq!(acknowledge(&mut bench) & 0x007F, 0x0031);
}
