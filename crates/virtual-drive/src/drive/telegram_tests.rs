//! Telegrams and signals: every setpoint and every actual value, in frames and as parameters.

use super::*;
use crate::model::AKD;
use profile::parameter::{ErrorNumber, Keep, ParameterAccess};
use profile::telegram::{Mapping, Telegram};

mod free;

/// A drive with any telegram.
struct Line {
    drive: Drive,
    now: Instant,
    setpoint: Mapping,
    actual: Mapping,
    outputs: Vec<u8>,
    inputs: Vec<u8>,
}

impl Line {
    fn new(telegram: u16) -> Self {
        Self::with(Drive::new(&AKD), telegram)
    }

    fn with(mut drive: Drive, telegram: u16) -> Self {
        let module = AKD.catalogue.device.telegram(telegram).unwrap();
        drive.connect(telegram, Duration::from_millis(48)).unwrap();
        let (setpoint, actual) = (*drive.process.setpoints(), *drive.process.actuals());
        Self {
            now: drive.last,
            drive,
            setpoint,
            actual,
            outputs: vec![0; module.outputs.into()],
            inputs: vec![0; module.inputs.into()],
        }
    }

    fn set(&mut self, signal: u16, value: i64) {
        self.setpoint.set(&mut self.outputs, signal, value).unwrap();
    }

    fn cycle(&mut self) {
        self.now += Duration::from_millis(16);
        self.drive.tick(self.now, Some(&self.outputs), &mut self.inputs);
    }

    fn cycles(&mut self, count: usize) {
        (0..count).for_each(|_| self.cycle());
    }

    fn get(&self, signal: u16) -> i64 {
        self.actual.get(&self.inputs, signal).unwrap()
    }

    fn read(&self, pnu: u16) -> i64 {
        self.drive.parameter(pnu).unwrap()
    }

    fn write(&mut self, pnu: u16, raw: i64) -> Result<(), ErrorNumber> {
        write(&mut self.drive, pnu, 0, raw)
    }
}

fn write(drive: &mut Drive, pnu: u16, subindex: u16, raw: i64) -> Result<(), ErrorNumber> {
    drive.set_element(AKD.catalogue.position(pnu).unwrap(), subindex, raw)
}

fn words(drive: &Drive, pnu: u16) -> Vec<i64> {
    let position = AKD.catalogue.position(pnu).unwrap();
    (0..16)
        .map(|word| drive.element(position, word).unwrap())
        .collect()
}

/// Returns a value of a setpoint signal that the parameter behind it can take.
fn a_value(signal: u16) -> i64 {
    match signal {
        103 => 7,             // HOME_MODE
        108 => 4,             // DRV_ACC, 3052 rpm/s
        109 => 12,            // DRV_DEC
        38 => 1,              // MDI_MOD
        34 | 100 => -123_456, // MDI_TARPOS, HOME_DIST
        35 => 0xF234_5678,    // MDI_VELOCITY needs all 32 bits
        5 => -300,
        102 => -5,
        other => 1000 + i64::from(other),
    }
}

/// A mapping of a master has no more words than its telegram, and no telegram has more than the drive has places for.
#[test]
fn every_telegram_has_places_for_all_its_fields_and_words() {
    for model in crate::model::ALL {
        for module in model.catalogue.device.telegrams {
            let telegram = Telegram::find(module.telegram, model.catalogue.device.vendor_id).unwrap();
            for half in [&telegram.setpoint, &telegram.actual] {
                let words = telegram.parameter_words(half).count();
                assert!(
                    words <= words::MOST_WORDS,
                    "{} {}",
                    model.catalogue.model,
                    module.telegram
                );
            }
            let mut drive = Drive::new(model);
            drive.plug(module.telegram, 64, 64);
            drive.connect(module.telegram, Duration::from_millis(48)).unwrap();
            let (setpoint, actual) = (drive.process.setpoints(), drive.process.actuals());
            let fields = setpoint.fields().len().max(actual.fields().len());
            assert!(
                fields <= signals::MOST_FIELDS,
                "{} {}",
                model.catalogue.model,
                module.telegram
            );
        }
    }
}

#[test]
fn every_setpoint_of_every_telegram_is_kept_and_reads_as_parameter() {
    for module in AKD.catalogue.device.telegrams {
        let mut line = Line::new(module.telegram);
        assert_eq!(line.read(922), i64::from(module.telegram));
        assert_eq!(line.read(2157), i64::from(module.telegram));
        let signals: Vec<u16> = line.setpoint.fields().iter().map(|f| f.signal.number).collect();
        line.set(1, 0x0400);
        for signal in signals.iter().copied().filter(|signal| *signal != 1) {
            line.set(signal, a_value(signal));
        }
        line.cycle();
        for signal in signals.iter().copied().filter(|signal| *signal != 1) {
            assert_eq!(line.drive.process.signal(signal), a_value(signal), "{signal}");
            if let Some(value) = line.drive.parameter(signal) {
                assert_eq!(value, a_value(signal), "{signal}");
                assert_eq!(line.write(signal, 1), Err(ErrorNumber::NOT_NOW), "{signal}");
            }
        }
        // Without control by PLC the setpoints of a frame do not count, the word itself is shown.
        line.set(1, 0x0001);
        for signal in signals.iter().copied().filter(|signal| *signal != 1) {
            line.set(signal, 0);
        }
        line.cycle();
        assert_eq!(line.read(1), 1);
        for signal in signals.into_iter().filter(|signal| *signal != 1) {
            assert_eq!(line.drive.process.signal(signal), a_value(signal), "{signal}");
        }
    }
}

#[test]
fn every_actual_value_of_every_telegram_is_its_parameter() {
    for module in AKD.catalogue.device.telegrams {
        let mut line = Line::new(module.telegram);
        line.set(1, 0x047E);
        line.cycles(3);
        line.set(1, 0x047F);
        if line.setpoint.has(5) {
            line.set(5, 1638);
        }
        for _ in 0..60 {
            line.cycle();
            for field in line.actual.fields().to_vec() {
                if let Some(value) = line.drive.parameter(field.signal.number) {
                    assert_eq!(field.get(&line.inputs), Some(value), "{}", field.signal.name);
                }
            }
        }
        if line.setpoint.has(5) {
            assert!(line.get(6) > 1600, "it turned");
        }
    }
}

#[test]
fn a_setpoint_is_written_as_parameter_while_no_telegram_carries_it() {
    let mut line = Line::new(1);
    for pnu in [32, 34, 35, 36, 37, 38, 100, 101, 103, 108, 109] {
        line.write(pnu, a_value(pnu)).unwrap();
        assert_eq!(line.read(pnu), a_value(pnu), "{pnu}");
    }
    assert_eq!((line.read(2203), line.read(2198)), (7, -123_456));
    assert_eq!((line.read(2108), line.read(2115)), (3_052_000, 9_156_000));
    // What moves the axis without an edge is for the controller's telegram alone.
    line.set(1, 0x0400);
    line.cycle();
    assert_eq!(line.write(5, 100), Err(ErrorNumber::NOT_NOW));
    assert_eq!(line.write(102, 100), Err(ErrorNumber::NOT_NOW));
    assert_eq!(line.write(38, 0x8001), Ok(()), "reserved bits do not count");
    assert_eq!(
        line.write(103, 16),
        Err(ErrorNumber::LIMIT),
        "HOME.MODE ends at 15"
    );
    assert_eq!(
        line.write(108, 0),
        Err(ErrorNumber::LIMIT),
        "DRV.ACC begins at 1.86"
    );
    for pnu in [1, 2, 6, 28, 33, 52, 104, 105, 106, 107] {
        assert_eq!(line.write(pnu, 0), Err(ErrorNumber::NOT_CHANGEABLE), "{pnu}");
    }
    // Without a controller it is stored, and the next controller starts from 0.
    line.drive.disconnect(Disconnect::Released);
    line.write(5, 100).unwrap();
    line.write(102, 100).unwrap();
    assert_eq!((line.read(5), line.read(102)), (100, 100));
    let mut line = Line::with(line.drive, 7);
    assert_eq!((line.read(5), line.read(102), line.read(36)), (0, 0, a_value(36)));
    line.set(1, 0x0400);
    line.cycle();
    assert_eq!(line.write(5, 100), Err(ErrorNumber::NOT_NOW));
    assert_eq!(line.drive.process.speed, 0.0);
}

#[test]
fn a_signal_that_stands_for_a_parameter_keeps_its_limits_and_follows_it() {
    let mut line = Line::new(353);
    line.set(1, 0x0400);
    line.set(103, 99);
    line.set(100, 65_536);
    line.cycle();
    assert_eq!((line.read(2203), line.read(103)), (0, 0), "no such homing mode");
    assert_eq!((line.read(2198), line.read(100)), (65_536, 65_536));
    line.set(103, 11);
    line.cycle();
    assert_eq!((line.read(2203), line.read(103)), (11, 11));
    // The controller has the last word, in the next cycle.
    line.write(2203, 3).unwrap();
    assert_eq!(line.read(103), 3);
    line.cycle();
    assert_eq!((line.read(2203), line.read(103)), (11, 11));
    // One revolution in 20 bits is finer than the position counts: the signal stays what it was.
    line.drive.disconnect(Disconnect::Released);
    line.write(1002, 20).unwrap();
    line.write(100, 1_048_577).unwrap();
    assert_eq!((line.read(2198), line.read(100)), (65_536, 1_048_577));
    line.write(2198, 131_072).unwrap();
    assert_eq!(line.read(100), 2 << 20);
}

#[test]
fn drv_acc_and_drv_dec_are_steps_of_acc_scaling() {
    for scaling in [1, 20, 763, 14_648] {
        let mut line = Line::new(354);
        line.write(3065, scaling).unwrap();
        line.set(1, 0x0400);
        line.set(108, 50);
        line.set(109, 3);
        line.cycle();
        assert_eq!(line.read(2108), 50 * 1000 * scaling);
        assert_eq!(line.read(2115), 3000 * scaling);
        assert_eq!(line.drive.settings.ramps.acceleration, (50 * scaling) as f64);
        // 0 rpm/s is below the limit of DRV.ACC, and 65,535 steps of 763 rpm/s or more above it: the last ones stay, and
        // the numbers of the signals are those in force.
        let highest: &[i64] = if scaling < 763 { &[0] } else { &[0, 0xFFFF] };
        let ignored = |line: &mut Line| {
            let events = core::iter::from_fn(|| line.drive.poll_event());
            events
                .filter(|event| matches!(event, Event::Ignored { .. }))
                .collect::<Vec<_>>()
        };
        assert_eq!(ignored(&mut line), []);
        for external in highest {
            line.set(108, 50);
            line.set(109, 3);
            line.cycle();
            line.set(108, *external);
            line.set(109, *external);
            line.cycles(3);
            let expected = [109, 108].map(|pnu| Event::Ignored { pnu, raw: *external });
            assert_eq!(ignored(&mut line), expected, "each once");
            assert_eq!(
                (line.read(2108), line.read(2115)),
                (50_000 * scaling, 3000 * scaling)
            );
            assert_eq!((line.read(108), line.read(109)), (50, 3));
            assert_eq!(line.drive.process.signal(108), *external);
        }
        line.drive.disconnect(Disconnect::Released);
        for external in highest {
            assert_eq!(line.write(108, *external), Err(ErrorNumber::LIMIT));
        }
    }
}

/// AKD manual 6.3 and 6.6: the words, before a controller has sent one.
#[test]
fn the_words_before_a_controller_has_sent_one() {
    let drive = Drive::new(&AKD);
    assert_eq!((drive.parameter(1), drive.parameter(2)), (Some(0), Some(0x0240)));
    let mut line = Line::with(drive, 1);
    line.set(1, 0x0406);
    line.cycle();
    assert_eq!((line.read(1), line.read(2)), (0x0406, 0x0231));
    line.drive.disconnect(Disconnect::Released);
    line.drive.tick(line.now, None, &mut []);
    let after = [1, 2].map(|pnu| line.drive.parameter(pnu));
    assert_eq!(after, [Some(0x0406), Some(0x0240)]);
}

/// The drive is only ticked at its own deadlines, as without a controller on the network.
fn idle(drive: &mut Drive) {
    while let Some(next) = drive.next_tick() {
        drive.tick(next, None, &mut []);
    }
}

/// 6.6: after a restart the word is that of the saved mode.
#[test]
fn the_status_word_after_a_restart_is_that_of_the_saved_mode() {
    let mut drive = Drive::new(&AKD);
    write(&mut drive, 930, 0, 2).unwrap();
    write(&mut drive, 2469, 0, 1).unwrap(); // DRV.NVSAVE
    idle(&mut drive);
    drive.restart();
    idle(&mut drive);
    assert_eq!(
        (drive.parameter(930), drive.parameter(2)),
        (Some(2), Some(0x2340))
    );
}

/// 6.6: the word shows each write at once, also where no frame and no tick comes in between.
#[test]
fn the_status_word_follows_each_write_without_a_tick() {
    let mut drive = Drive::new(&AKD);
    for (pnu, raw, word) in [
        (930, 2, 0x2340),
        (2209, 1, 0x2B40),   // HOME.SET
        (2398, 300, 0x2BC0), // VBUS.OVWTHRESH, below the voltage of the bus
        (930, 1, 0x02C0),
        (2398, 0, 0x0240),
        (2402, 900, 0x02C0), // VBUS.UVWTHRESH
        (2402, 0, 0x0240),
        (2258, 1, 0x0248), // MOTOR.TEMPFAULT, a fault
        (2258, 0, 0x0248),
        (2111, 1, 0x0240), // DRV.CLRFAULTS
        (2113, 0, 0x0240), // DRV.CMDSOURCE
        (2127, 1, 0x0537), // DRV.EN: the service channel has the axis, so that no control is requested
        (2118, 1, 0x0240), // DRV.DIS: no word is in force any more, as before DRV.EN
    ] {
        drive.write(pnu, 0, raw, Keep::Volatile).unwrap();
        assert_eq!(
            drive.parameter(2),
            Some(word),
            "{pnu} = {raw}: {:#06x}",
            drive.process.status
        );
    }
}

#[test]
fn the_telegram_sets_the_command_source() {
    let mut drive = Drive::new(&AKD);
    for (telegram, source) in [
        (7, 0),
        (1, 1),
        (9, 0),
        (354, 1),
        (353, 0),
        (350, 1),
        (352, 0),
        (351, 1),
        (400, 0),
    ] {
        drive.connect(telegram, Duration::from_millis(48)).unwrap();
        assert_eq!(drive.parameter(2113), Some(source), "{telegram}");
        assert_eq!(drive.settings.commanded_by_bus, source == 1);
        drive.disconnect(Disconnect::Released);
    }
    write(&mut drive, 915, 1, 102).unwrap();
    assert_eq!(
        drive.parameter(2113),
        Some(1),
        "telegram 400 with a current setpoint"
    );
}

#[test]
fn the_drive_lives_while_the_controller_does() {
    let mut line = Line::new(9);
    line.set(1, 0x0400);
    line.cycles(3);
    assert_eq!(line.get(4), 0, "the controller does not count");
    line.set(3, 0x7000);
    let seen: Vec<i64> = (0..17)
        .map(|_| {
            line.cycle();
            line.get(4) >> 12
        })
        .collect();
    assert_eq!(
        seen,
        (1..=15).chain(1..=2).collect::<Vec<_>>(),
        "1 to 15, never 0"
    );
    line.set(3, 0x0FFF);
    line.cycle();
    assert_eq!(line.get(4), 0);
}

#[test]
fn the_bits_of_drive_inputs() {
    let mut drive = Drive::new(&AKD);
    assert_eq!(
        drive.parameter(106),
        Some(0x40),
        "torque is allowed, nothing else"
    );
    for (event, end, bit) in [
        ("limit-=on", "limit-=auto", 2),
        ("limit+=on", "limit+=auto", 3),
        ("hardware-disable=on", "hardware-disable=off", 4),
        ("controlled-stop=on", "controlled-stop=off", 5),
    ] {
        drive.inject(event.parse().unwrap());
        assert_eq!(drive.parameter(106), Some(0x40 | 1 << bit), "{event}");
        drive.inject(end.parse().unwrap());
    }
    // An axis at 0 between limits that are both 0 touches both.
    for (pnu, value) in [(2382, 3), (2385, 0), (2209, 1)] {
        write(&mut drive, pnu, 0, value).unwrap();
    }
    assert_eq!(
        (drive.parameter(106), drive.parameter(2387)),
        (Some(0x43), Some(3))
    );
    write(&mut drive, 2382, 0, 0).unwrap();
    drive.inject("sto=on".parse().unwrap());
    assert_eq!(drive.parameter(106), Some(0));
}
