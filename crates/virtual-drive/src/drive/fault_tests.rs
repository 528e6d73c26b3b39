//! Faults and warnings: causes, reactions, the situation buffer and its acknowledge.

use super::tests::Bench;
use super::*;

/// ZSW1 bits 3 and 7.
const FAULT: u16 = 0x0008;
const WARNING: u16 = 0x0080;
const IN_RANGE: u16 = 0x0100;

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

/// AKD manual 5.4: bit 7 acknowledges; it takes effect when set together with bit 10, but not when it stays set.
#[test]
fn the_first_words_of_a_connection_acknowledge_by_an_edge() {
    for (words, left) in [(&[0x0000, 0x04FE][..], 0), (&[0x04FE, 0x04FE], FAULT)] {
        let mut bench = Bench::new();
        bench.drive.inject_fault(439, false);
        for _ in 0..3 {
            bench.tick(None);
        }
        for word in words {
            bench.send(*word, 0, 1);
        }
        assert_eq!(bench.status & FAULT, left, "{words:04X?}");
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
fn ten_simultaneous_faults_are_present_and_eight_buffered() {
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
    assert_eq!(bench.read("944"), counter + 1, "a new situation");
    bench.write("2112", 1).unwrap(); // the other number of the command
    assert_eq!(
        bench.read("944"),
        counter + 1,
        "nothing to clear: nothing changes"
    );
    bench.drive.inject(Injection::ClearCause { number: 501 });
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
    bench.now = bench.drive.next_tick().expect("it stops");
    bench.drive.tick(bench.now, None, &mut []);
    assert_eq!(bench.drive.state(), State::S5Ramp, "DRV.DEC, no quick stop");
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
    assert!(!bench.drive.is_enabled(), "it stops anyway");
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
fn warnings_and_lasting_causes_have_a_bounded_number_of_places() {
    let mut bench = Bench::new();
    for number in 1001..=1020 {
        bench.drive.warn(number, true);
    }
    let warnings = |bench: &Bench| -> Vec<u16> {
        let all = (0..20).map(|place| bench.drive.warning_number(place));
        all.take_while(|number| *number != 0).collect()
    };
    assert_eq!(warnings(&bench), (1001..=1016).collect::<Vec<_>>());
    // one that was left out is gone with nothing, and its place is free for the next one
    bench.drive.warn(1020, false);
    bench.drive.warn(1001, false);
    bench.drive.warn(1021, true);
    let expected: Vec<u16> = (1002..=1016).chain([1021]).collect();
    assert_eq!(warnings(&bench), expected);

    for number in 401..=410 {
        bench.drive.inject_fault(number, true);
    }
    let lasting: Vec<u16> = bench.drive.faults.lasting_numbers().collect();
    assert_eq!(lasting, (401..=408).collect::<Vec<_>>());
    for number in 401..=408 {
        assert_eq!(acknowledge(&mut bench) & FAULT, FAULT, "F{number} lasts");
        bench.drive.inject(Injection::ClearCause { number });
    }
    assert_eq!(acknowledge(&mut bench) & FAULT, 0);
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

/// What an injection brings with the power stage on, and whether it lasts: cannot be acknowledged before it ends.
#[test]
fn physical_causes_raise_their_faults_and_keep_them() {
    for (cause, end, fault) in [
        ("sto=on", "sto=off", 602),
        ("feedback=lost", "feedback=ok", 408),
        ("bus=450V", "bus=auto", 501),
        ("bus=60V", "bus=auto", 502),
        ("motor-temperature=160degC", "motor-temperature=auto", 301),
        ("power-temperature=95degC", "power-temperature=auto", 535),
        ("brake=on", "brake=auto", 307),
    ] {
        let mut bench = Bench::new();
        bench.run(163);
        bench.drive.inject(cause.parse().unwrap());
        assert_eq!(bench.send(0x047F, 163, 1) & FAULT, FAULT, "{cause}");
        assert_eq!(bench.element("947", 0), fault, "{cause}");
        assert_eq!(bench.drive.state(), State::S1, "{cause}");
        assert_eq!(acknowledge(&mut bench) & FAULT, FAULT, "{cause} lasts");
        assert_eq!(bench.element("947", 8), 0, "{cause} lasts");
        bench.drive.inject(end.parse().unwrap());
        assert_eq!(acknowledge(&mut bench) & 0x00FF, 0x0031, "{end}");
        assert_eq!(bench.element("947", 8), fault);
        bench.run(163);
    }
}

#[test]
fn safe_torque_off_warns_while_disabled_and_faults_when_enabling_is_tried() {
    let mut bench = Bench::new();
    bench.send(0x047E, 0, 2);
    assert_eq!((bench.read("STO.STATE"), bench.read("DRIVE_INPUTS")), (1, 0x40));
    bench.drive.inject(Injection::Sto(true));
    assert_eq!(bench.send(0x047E, 0, 1) & (WARNING | FAULT), WARNING);
    assert_eq!((bench.read("STO.STATE"), bench.read("DRIVE_INPUTS")), (0, 0));
    assert_eq!(bench.read("DRV.WARNING1"), 602);
    bench.send(0x047F, 163, 1);
    assert_eq!(
        bench.status & (FAULT | 0x0004),
        FAULT,
        "never enabled on the wire"
    );
    assert_eq!(bench.element("947", 0), 602);
    assert_eq!(bench.drive.axis().speed(), 0.0);
    bench.drive.inject(Injection::Sto(false));
    assert_eq!(acknowledge(&mut bench) & 0x00FF, 0x0031);
    assert_eq!(bench.read("DRV.WARNING1"), 0);
}

#[test]
fn limit_switches_warn_and_are_seen() {
    let mut bench = Bench::new();
    bench.drive.inject("limit+=on".parse().unwrap());
    assert_eq!(bench.send(0x047E, 0, 1) & WARNING, WARNING);
    assert_eq!((bench.read("HWLS.POSSTATE"), bench.read("HWLS.NEGSTATE")), (1, 0));
    assert_eq!(
        (bench.read("DRIVE_INPUTS"), bench.read("DRV.WARNING1")),
        (0x48, 107)
    );
    bench.drive.inject("limit-=on".parse().unwrap());
    bench.drive.inject("limit+=auto".parse().unwrap());
    bench.send(0x047E, 0, 1);
    assert_eq!(
        (bench.read("DRIVE_INPUTS"), bench.read("DRV.WARNING1")),
        (0x44, 108)
    );
    bench.drive.inject("limit-=auto".parse().unwrap());
    assert_eq!(bench.send(0x047E, 0, 1) & WARNING, 0);
}

#[test]
fn warning_levels_come_before_the_faults() {
    for (parameter, level, cause, warning) in [
        ("VBUS.OVWTHRESH", 400, "bus=410V", 501),
        ("VBUS.UVWTHRESH", 200, "bus=150V", 502),
        ("MOTOR.TEMPWARN", 1200, "motor-temperature=140degC", 301),
    ] {
        let mut bench = Bench::new();
        bench.run(163);
        bench.drive.inject(cause.parse().unwrap());
        assert_eq!(
            bench.send(0x047F, 163, 2) & (WARNING | FAULT),
            0,
            "0 switches {parameter} off"
        );
        bench.write(parameter, level).unwrap();
        assert_eq!(
            bench.send(0x047F, 163, 2) & (WARNING | FAULT),
            WARNING,
            "{parameter}"
        );
        assert_eq!(bench.read("DRV.WARNING1"), warning);
        assert_eq!(bench.drive.state(), State::S4);
    }
}

#[test]
fn undervoltage_by_mode() {
    let mut bench = Bench::new();
    bench.send(0x047E, 0, 2);
    bench.drive.inject(Injection::Mains(false));
    bench.send(0x047E, 0, 400);
    assert!(bench.read("VBUS.VALUE") < 90, "{}", bench.read("VBUS.VALUE"));
    assert!(
        !bench.drive.has_fault(),
        "VBUS.UVMODE 1: only when enabling is tried"
    );
    bench.send(0x047F, 0, 1);
    assert_eq!(bench.element("947", 0), 502);
    bench.drive.inject(Injection::Mains(true));
    bench.send(0x047E, 0, 40);
    assert_eq!(acknowledge(&mut bench) & FAULT, 0);
    bench.write("VBUS.UVMODE", 0).unwrap();
    bench.drive.inject(Injection::Mains(false));
    bench.send(0x047E, 0, 400);
    assert_eq!(bench.element("947", 0), 502, "VBUS.UVMODE 0: always");
}

#[test]
fn a_drive_without_a_controller_handles_injected_events() {
    let mut drive = Drive::new(&crate::model::AKD);
    assert_eq!(drive.next_tick(), None);
    drive.inject(Injection::Mains(false));
    let mut ticks = 0;
    while let Some(next) = drive.next_tick() {
        drive.tick(next, None, &mut []);
        ticks += 1;
        assert!(ticks < 2000);
    }
    assert!(drive.axis().electrical().bus_voltage() < 300.0);
}

#[test]
fn a_blocked_axis_folds_back_and_faults() {
    let mut bench = Bench::new();
    bench.run(163);
    bench.write("IL.FOLDFTHRESHU", 4000).unwrap();
    bench.write("IL.FOLDWTHRESH", 8000).unwrap();
    assert_eq!(bench.read("IL.FOLDFTHRESH"), 4000);
    bench.drive.inject(Injection::Block(true));
    let mut warned = false;
    for _ in 0..2000 {
        bench.send(0x047F, 4000, 1);
        warned |= bench.status & WARNING != 0;
        if bench.drive.has_fault() {
            break;
        }
    }
    let fault = bench.element("947", 0);
    assert!(warned, "the warning came before F{fault}");
    assert!(fault == 524 || fault == 304, "F{fault}");
}

#[test]
fn hardware_disable_and_controlled_stop_are_inputs() {
    let mut bench = Bench::new();
    bench.run(1638);
    bench.drive.inject(Injection::HardwareDisable(true));
    bench.send(0x047F, 1638, 1);
    assert_eq!(bench.drive.state(), State::S1);
    assert_eq!(
        (bench.read("DRV.DISSOURCES"), bench.read("DRIVE_INPUTS")),
        (5, 0x50)
    );
    assert!(!bench.drive.has_fault());
    bench.drive.inject(Injection::HardwareDisable(false));
    bench.send(0x047F, 1638, 5);
    assert_eq!(bench.drive.state(), State::S1, "needs OFF and ON");
    bench.send(0x047E, 0, 60);
    bench.run(1638);
    bench.drive.inject(Injection::ControlledStop(true));
    bench.send(0x047F, 1638, 1);
    assert_eq!(bench.drive.state(), State::S5Quick);
    bench.send(0x047F, 1638, 60);
    assert_eq!(
        (bench.read("DRV.DISSOURCES"), bench.read("DRIVE_INPUTS")),
        (0x21, 0x60)
    );
}

#[test]
fn a_brake_that_is_fitted_holds_while_off() {
    let mut bench = Bench::new();
    bench.write("MOTOR.BRAKE", 1).unwrap();
    bench.send(0x047E, 0, 2);
    assert!(bench.drive.axis().inputs().brake);
    bench.run(163);
    assert!(!bench.drive.axis().inputs().brake && !bench.drive.has_fault());
    bench.send(0x047D, 0, 2);
    assert!(bench.drive.axis().inputs().brake);
    bench.write("MOTOR.BRAKERLS", 1).unwrap();
    bench.send(0x047D, 0, 2);
    assert!(!bench.drive.axis().inputs().brake);
}

#[test]
fn a_following_error_warns_then_faults() {
    for (mode, faults_after) in [(0, 1), (1, 7)] {
        let mut bench = Bench::new();
        bench.write("DRV.OPMODE", 2).unwrap();
        bench.write("PL.ERRMODE", mode).unwrap();
        bench.write("PL.ERRWTHRESH", 650).unwrap(); // counts, 65,536 of which are a revolution
        bench.write("PL.ERRFTHRESH", 6_500).unwrap();
        bench.send(0x047E, 0, 3);
        bench.send(0x047F, 0, 5);
        assert_eq!(bench.drive.state(), State::S4);
        assert_eq!(bench.status & (WARNING | FAULT | IN_RANGE), IN_RANGE);
        // More than the motor can hold.
        bench.write("IL.LIMITP", 200).unwrap();
        bench.write("IL.LIMITN", -200).unwrap();
        bench.drive.inject("load=0.3Nm".parse().unwrap());
        let (mut warned, mut cycles, mut beyond, mut in_range) = (false, 0, 0, true);
        while !bench.drive.has_fault() {
            bench.send(0x047F, 0, 1);
            warned |= bench.status & WARNING != 0;
            in_range &= bench.status & IN_RANGE != 0;
            beyond += usize::from(bench.read("PL.ERR").abs() > 6_500 || bench.drive.has_fault());
            cycles += 1;
            assert!(cycles < 200, "PL.ERR {}", bench.read("PL.ERR"));
        }
        assert!(!in_range, "bit 8 is 0 while the error is out of its window");
        assert_eq!(bench.element("947", 0), 439);
        assert_eq!(bench.drive.state(), State::S1);
        assert!(beyond >= faults_after, "mode {mode}: {beyond}");
        assert!(
            mode == 1 || (warned && beyond == 1),
            "mode {mode}: {beyond} {warned}"
        );
        bench.drive.inject(Injection::Load(0.0));
        assert_eq!(bench.send(0x047E, 0, 2) & WARNING, 0, "off when disabled");
        assert_eq!(acknowledge(&mut bench) & FAULT, 0);
    }
}

#[test]
fn without_a_controller_the_status_word_follows_at_once() {
    let mut bench = Bench::new();
    bench.drive.disconnect(Disconnect::Released);
    bench.drive.inject_fault(439, false);
    assert!(bench.drive.next_tick().is_some(), "the drive needs further ticks");
    bench.drive.tick(Instant::from_millis(5000), None, &mut []);
    assert_eq!(bench.drive.status_word().0 & FAULT, FAULT);
    bench.write("DRV.CLRFAULTS", 1).unwrap();
    assert_eq!(bench.drive.status_word().0 & FAULT, 0);
    assert!(bench.drive.next_tick().is_some());
}

#[test]
fn no_load_breaks_the_drive_for_good() {
    for torque in [1e99, -1e99, f64::NAN, f64::INFINITY, 9999.0] {
        let mut bench = Bench::new();
        bench.run(4000);
        bench.drive.inject(Injection::Load(torque));
        bench.send(0x047F, 4000, 200);
        assert!(bench.drive.axis().speed().abs() <= 100_001.0, "{torque}");
        bench.drive.inject(Injection::Load(0.0));
        bench.send(0x047E, 0, 4000);
        assert_eq!(acknowledge(&mut bench) & FAULT, 0, "{torque}");
        assert_eq!(bench.drive.axis().speed(), 0.0, "{torque}");
        bench.run(4000);
        assert_eq!(bench.drive.state(), State::S4, "{torque}");
    }
}

#[test]
fn values_have_an_end() {
    for (text, words) in [
        ("load=1e99Nm", "-10000Nm to 10000Nm"),
        ("bus=-1V", "0V to 2000V"),
        ("motor-temperature=5000degC", "to 1000degC"),
    ] {
        let error = text.parse::<Injection>().unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}
