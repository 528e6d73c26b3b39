//! Position mode through process data and parameters, without any field bus.

use core::time::Duration;

use profile::parameter::ErrorNumber;
use profile::state::State;
use profile::telegram::{Mapping, signal};
use profinet::Instant;

use super::units::REVOLUTION;
use crate::axis::Plant;
use crate::drive::{Disconnect, Drive};
use crate::model::AKD;

/// Ready in S4: bits 0 to 5 and 10.
pub(super) const READY: u16 = 0x043F;
/// The same with bit 6.
pub(super) const START: u16 = 0x047F;
/// Without bit 0.
const OFF: u16 = 0x043E;
/// With bit 11.
const HOME: u16 = 0x0C3F;
/// A drive in position mode with a telegram.
pub(super) struct Bench {
    pub drive: Drive,
    pub now: Instant,
    setpoint: Mapping,
    actual: Mapping,
    outputs: Vec<u8>,
    inputs: Vec<u8>,
    pub cycle: Duration,
}

impl Bench {
    pub fn new(telegram: u16) -> Self {
        Self::with(telegram, AKD.plant)
    }

    pub fn with(telegram: u16, plant: Plant) -> Self {
        let mut drive = Drive::new(&AKD);
        drive.axis.set_plant(plant);
        drive.connect(telegram, Duration::from_millis(48)).unwrap();
        let (setpoint, actual) = (*drive.process.setpoints(), *drive.process.actuals());
        let mut bench = Self {
            drive,
            now: Instant::ZERO,
            setpoint,
            actual,
            outputs: vec![0; 32],
            inputs: vec![0; 32],
            cycle: Duration::from_millis(4),
        };
        bench.write("930", 2);
        bench
    }

    pub fn set(&mut self, signal: u16, value: i64) {
        self.setpoint.set(&mut self.outputs, signal, value).unwrap();
    }

    pub fn get(&self, signal: u16) -> i64 {
        self.actual.get(&self.inputs, signal).unwrap()
    }

    pub fn status(&self) -> u16 {
        self.get(signal::ZSW1) as u16
    }

    pub fn tick(&mut self) -> u16 {
        self.now += self.cycle;
        self.drive.tick(self.now, Some(&self.outputs), &mut self.inputs);
        self.status()
    }

    /// A tick without valid outputs, or without any controller.
    pub fn tick_without(&mut self) {
        self.now += self.cycle;
        self.drive.tick(self.now, None, &mut self.inputs);
    }

    pub fn connect_again(&mut self, telegram: u16) {
        self.drive.connect(telegram, Duration::from_millis(48)).unwrap();
    }

    /// Sends a control word for some cycles; the last status word.
    pub fn send(&mut self, control: u16, cycles: usize) -> u16 {
        self.set(signal::STW1, i64::from(control));
        (0..cycles).fold(0, |_, _| self.tick())
    }

    /// Sends a control word until these bits of the status word have this value; how long it took.
    pub fn until(&mut self, control: u16, mask: u16, value: u16) -> Duration {
        self.set(signal::STW1, i64::from(control));
        let begin = self.now;
        while self.tick() & mask != value {
            assert!(
                self.now - begin < Duration::from_secs(60),
                "{:#06x} in {:?}",
                self.status(),
                self.drive.positioning
            );
        }
        self.now - begin
    }

    fn position_of(name: &str) -> usize {
        let pnu = name
            .parse()
            .unwrap_or_else(|_| AKD.catalogue.by_name(name).unwrap().pnu);
        AKD.catalogue.position(pnu).unwrap()
    }

    pub fn read(&self, name: &str) -> i64 {
        self.drive.element(Self::position_of(name), 0).unwrap()
    }

    pub fn try_write(&mut self, name: &str, raw: i64) -> Result<(), ErrorNumber> {
        self.drive.set_element(Self::position_of(name), 0, raw)
    }

    pub fn write(&mut self, name: &str, raw: i64) {
        self.try_write(name, raw)
            .unwrap_or_else(|error| panic!("{name}: {error:?}"));
    }

    /// To S4 with the words of manual 5.9, without bit 6.
    pub fn enable(&mut self) {
        for word in [0x0430, 0x0436, 0x0437, READY] {
            self.send(word, 2);
        }
        assert_eq!(self.drive.state(), State::S4);
    }

    /// In S4 and homed where it stands.
    pub fn homed(telegram: u16) -> Self {
        let mut bench = Self::new(telegram);
        bench.enable();
        bench.send(HOME, 2);
        bench.until(HOME, 0x0800, 0x0800);
        bench.send(READY, 2);
        bench
    }

    /// Puts a task into the table: revolutions, rpm, rpm/s, control word.
    pub fn task(&mut self, number: i64, turns: f64, speed: f64, ramp: f64, control: i64) {
        self.write("MT.NUM", number);
        self.write("MT.P", (turns * 65_536.0) as i64);
        self.write("MT.V_32", (speed * 1000.0) as i64);
        self.write("MT.ACC", (ramp * 1000.0) as i64);
        self.write("MT.DEC", (ramp * 1000.0) as i64);
        self.write("MT.CNTL", control);
        self.write("MT.SET", 1);
    }

    /// Sets the MDI signals: revolutions, rpm, steps of PN.ACCSCALING, absolute.
    pub fn mdi(&mut self, turns: f64, speed: f64, ramp: i64, absolute: bool) {
        self.set(signal::SATZANW, 0x8000);
        self.set(signal::MDI_TARPOS, (turns * 65_536.0) as i64);
        self.set(signal::MDI_VELOCITY, (speed / 12_000.0 * 4_294_967_296.0) as i64);
        self.set(signal::MDI_ACC, ramp);
        self.set(signal::MDI_DEC, ramp);
        self.set(signal::MDI_MOD, i64::from(absolute));
    }

    pub fn turns(&self) -> f64 {
        self.drive.axis.position() as f64 / REVOLUTION
    }

    /// Speed of the reference, rpm.
    pub fn pace(&self) -> f64 {
        self.drive.axis.trajectory_speed()
    }

    pub fn warned(&self, number: u16) -> bool {
        (0..16).any(|place| self.drive.warning_number(place) == number)
    }
}

#[test]
fn program_mode_of_manual_5_10_1() {
    let mut bench = Bench::homed(7);
    assert_eq!(bench.status(), 0x2F37, "homed, stopped, reached, in range");
    bench.task(5, 3.0, 600.0, 6000.0, 0);
    bench.set(signal::SATZANW, 5);
    bench.send(READY, 3);
    let word = bench.send(START, 1);
    assert_eq!(
        word & 0x7C00,
        0x5800,
        "acknowledged, active, homed, moves: {word:04X}"
    );
    assert_eq!(bench.get(signal::AKTSATZ), 5);
    assert_eq!(bench.send(START, 5) & 0x3000, 0x1000, "bit 13 went to 0");
    // 3 revolutions at 10 rev/s: 0.1 s up, 0.2 s at speed, 0.1 s down
    let took = bench.until(START, 0x0400, 0x0400);
    assert!((took.as_millis() as i64 - 376).abs() <= 12, "{took:?}");
    assert_eq!(bench.status() & 0x7C00, 0x3C00);
    assert_eq!(bench.get(signal::AKTSATZ), 0);
    bench.send(READY, 50);
    assert!((bench.turns() - 3.0).abs() < 0.002, "{}", bench.turns());
    assert_eq!(bench.status(), 0x2F37);
    assert_eq!(bench.read("PL.CMD"), 3 * 65_536);
    bench.send(OFF, 5);
    let reached = bench.read("DRV.MOTIONSTAT") & 1 << 11;
    assert_eq!((bench.status() & 0x0400, reached), (0, 0), "in S4 only");
}

#[test]
fn task_0_is_selected_when_it_was_set_and_not_as_mdi_left_it() {
    let mut bench = Bench::new(9);
    bench.enable();
    bench.task(0, 1.0, 600.0, 6000.0, 0);
    bench.set(signal::SATZANW, 0);
    bench.send(START, 2);
    assert!(bench.warned(160) && !bench.warned(163), "not homed");
    bench.send(READY, 2);
    bench.until(HOME, 0x0800, 0x0800);
    bench.send(READY, 2);
    assert_eq!(bench.send(START, 1) & 0x5000, 0x5000);
    bench.until(START, 0x0400, 0x0400);
    bench.send(READY, 50);
    assert!((bench.turns() - 1.0).abs() < 0.002, "{}", bench.turns());
    bench.mdi(0.5, 300.0, 8, false);
    bench.send(START, 1);
    bench.until(READY, 0x0400, 0x0400);
    bench.send(READY, 50);
    bench.set(signal::SATZANW, 0);
    assert_eq!(bench.send(START, 50) & 0x5000, 0, "not once more");
    assert!(bench.warned(164) && (bench.turns() - 1.5).abs() < 0.01);
}

#[test]
fn mdi_handshake_of_manual_5_10_2() {
    let mut bench = Bench::homed(9);
    bench.mdi(2.0, 300.0, 8, true);
    assert_eq!(bench.send(READY, 3) & 0x1000, 0);
    assert_eq!(bench.send(START, 1) & 0x5000, 0x5000);
    assert_eq!(bench.get(signal::AKTSATZ), 0x8000);
    bench.mdi(-1.0, 300.0, 8, true); // must not matter before the next edge
    assert_eq!(bench.send(START, 20) & 0x5000, 0x5000);
    assert_eq!(
        bench.send(READY, 1) & 0x5000,
        0x4000,
        "cleared with the bit, still runs"
    );
    bench.until(READY, 0x0400, 0x0400);
    assert!((bench.turns() - 2.0).abs() < 0.01);
    assert_eq!(
        bench.read("XIST_A") as f64 / 65_536.0,
        bench.turns().mul_add(65_536.0, 0.0).floor() / 65_536.0
    );
    // Change on the fly, relative to where the reference is.
    bench.mdi(10.0, 300.0, 8, false);
    bench.send(START, 1);
    bench.send(READY, 60);
    let from = bench.drive.axis.position_command() as f64 / REVOLUTION;
    bench.mdi(0.5, 600.0, 20, false);
    assert_eq!(bench.send(START, 1) & 0x1000, 0x1000);
    bench.until(READY, 0x0400, 0x0400);
    bench.send(READY, 20);
    assert!(
        (bench.turns() - from - 0.5).abs() < 0.01,
        "{} {from}",
        bench.turns()
    );
}

#[test]
fn intermediate_stop_and_reject() {
    let mut bench = Bench::homed(7);
    bench.task(1, 20.0, 600.0, 6000.0, 0);
    bench.set(signal::SATZANW, 1);
    bench.send(START, 100);
    let word = bench.send(0x045F, 1);
    assert_eq!(word & 0x6000, 0x4000, "the task stays");
    bench.send(0x045F, 12);
    assert!(
        (bench.pace() - 600.0 + 0.052 * 6000.0).abs() < 1.0,
        "{}",
        bench.pace()
    );
    let word = bench.send(0x045F, 60);
    assert_eq!(word & 0x7400, 0x7000, "{word:04X}");
    assert_eq!(bench.get(signal::AKTSATZ), 1);
    let stopped = bench.turns();
    bench.send(0x045F, 500);
    assert!((bench.turns() - stopped).abs() < 0.001);
    bench.send(START, 100);
    assert_eq!(bench.pace(), 600.0, "goes on without an edge");
    // Reject: with the steeper one of CS.DEC and the ramp of the task.
    let word = bench.send(0x046F, 1);
    assert_eq!(word & 0x6400, 0, "{word:04X}");
    bench.send(0x046F, 12);
    assert!(
        (bench.pace() - 600.0 + 0.052 * 6000.0).abs() < 1.0,
        "{}",
        bench.pace()
    );
    bench.until(0x046F, 0x2000, 0x2000);
    let there = bench.turns();
    let word = bench.send(START, 200);
    assert_eq!(
        word & 0x7400,
        0x3000,
        "the task is lost, bit 12 follows bit 6: {word:04X}"
    );
    assert!((bench.turns() - there).abs() < 0.001);
    assert_eq!(bench.get(signal::AKTSATZ), 0);
}

#[test]
fn a_task_that_cannot_run_is_rejected_with_a_cause() {
    let mut bench = Bench::new(9);
    bench.enable();
    bench.mdi(1.0, 100.0, 4, true);
    let try_it = |bench: &mut Bench, number: u16| {
        bench.send(READY, 2);
        let word = bench.send(START, 3);
        assert_eq!(word & 0x5000, 0, "{word:04X} {number}");
        assert!(word & 0x80 != 0 && bench.warned(number), "{number}");
        assert_eq!(bench.read("DRV.MOTIONSTAT") & 0x400, 0x400);
        assert!(bench.turns().abs() < 0.01);
    };
    try_it(&mut bench, 160); // not homed
    bench.write("HOME.SET", 1);
    bench.mdi(1.0, 0.0, 4, true);
    try_it(&mut bench, 159);
    bench.mdi(1.0, 100.0, 0, true);
    try_it(&mut bench, 159);
    bench.write("SWLS.LIMIT1", 65_536);
    bench.write("SWLS.EN", 2);
    bench.mdi(1.5, 100.0, 4, true);
    try_it(&mut bench, 165);
    bench.set(signal::SATZANW, 3);
    try_it(&mut bench, 164);
    bench.set(signal::SATZANW, 200);
    try_it(&mut bench, 163);
    bench.task(4, 0.5, 100.0, 1000.0, 0x2);
    bench.set(signal::SATZANW, 4);
    try_it(&mut bench, 168);
    bench.task(4, 0.5, 100.0, 1000.0, 0x4000);
    try_it(&mut bench, 169);
    // One that can run takes all of it back.
    bench.mdi(1.0, 100.0, 4, true);
    bench.send(READY, 2);
    let word = bench.send(START, 2);
    assert_eq!(word & 0x5080, 0x5000, "{word:04X}");
    assert_eq!(bench.read("DRV.MOTIONSTAT") & 0x400, 0);
    bench.until(READY, 0x0400, 0x0400);
}

#[test]
fn another_mode_and_another_telegram_do_nothing() {
    let mut bench = Bench::new(1);
    bench.enable();
    bench.write("HOME.SET", 1);
    bench.set(signal::NSOLL_A, 3000);
    let word = bench.send(START, 100);
    assert_eq!(word & 0x50FF, 0x0037, "no warning, no task: {word:04X}");
    assert!(bench.turns().abs() < 1e-6);
    assert_eq!(bench.read("DRV.CMDSOURCE"), 1);
    let mut bench = Bench::homed(9);
    assert_eq!(bench.read("DRV.CMDSOURCE"), 0);
    bench.send(0x0430, 2);
    bench.write("930", 1);
    bench.mdi(1.0, 100.0, 4, true);
    bench.enable();
    let word = bench.send(START, 100);
    assert_eq!(word & 0x7000, 0, "velocity mode has no such bits: {word:04X}");
    assert!(bench.turns().abs() < 1e-6);
}

/// 5.10.2 names telegram 9 for MDI: with another one the signals are those that were written as parameters.
#[test]
fn telegram_7_with_bit_15_moves_by_what_was_written_as_parameters() {
    let mut bench = Bench::homed(7);
    for (signal, value) in [
        ("34", 2 * 65_536),
        ("35", 0x0AAA_AAAA),
        ("36", 20),
        ("37", 20),
        ("38", 1),
    ] {
        bench.write(signal, value);
    }
    bench.set(signal::SATZANW, 0x8000);
    bench.send(START, 1);
    bench.until(START, 0x6000, 0x2000);
    assert!((bench.turns() - 2.0).abs() < 0.002, "{}", bench.turns());
}

/// 3.1 sets a limit speed for position control, by the commutation: the virtual drive has that of MDI_VELOCITY alone.
#[test]
fn positions_are_controlled_above_the_limit_speeds_of_3_1() {
    for speed in [7600.0, 11_990.0] {
        let mut bench = Bench::homed(9);
        bench.write("VL.LIMITP_32", 12_000_000);
        bench.write("VL.THRESH_32", 12_000_000);
        bench.mdi(300.0, speed, 20, true);
        bench.send(START, 300);
        assert!(
            (bench.pace() - speed).abs() < 0.01,
            "{} {:04X}",
            bench.pace(),
            bench.status()
        );
        bench.until(START, 0x6000, 0x2000);
        assert!((bench.turns() - 300.0).abs() < 0.002, "{}", bench.turns());
    }
}

#[test]
fn bits_outside_s4_start_nothing_later() {
    let mut bench = Bench::homed(9);
    bench.mdi(1.0, 100.0, 4, true);
    bench.send(0x0436, 3);
    for word in [0x0437, 0x0477, 0x047F] {
        bench.send(word, 3);
    }
    assert_eq!(bench.drive.state(), State::S4);
    assert_eq!(bench.send(START, 50) & 0x5000, 0);
    assert!(bench.turns().abs() < 0.001);
}

#[test]
fn a_lost_controller_stops_the_task_on_a_ramp() {
    let mut bench = Bench::homed(9);
    bench.mdi(50.0, 1200.0, 10, true);
    bench.send(START, 100);
    bench.drive.disconnect(Disconnect::Lost);
    while let Some(next) = bench.drive.next_tick() {
        bench.now = next;
        bench.drive.tick(next, None, &mut []);
    }
    assert_eq!(bench.drive.state(), State::S1);
    assert!(bench.drive.axis.is_at_rest());
    assert_eq!(
        bench.drive.position_status().0 & 0x7C00,
        0x2800,
        "stopped, still homed, no task"
    );
}

/// Jogging begins by the level of its bit, but not by one that was 1 while a task ran: the axis would move on unasked.
#[test]
fn a_jog_bit_of_a_task_has_to_be_set_anew() {
    let mut bench = Bench::homed(9);
    bench.mdi(2.0, 600.0, 20, true);
    bench.send(START, 2);
    bench.until(READY | 0x1000, 0x0400, 0x0400);
    bench.send(READY | 0x1000, 60);
    assert!((bench.turns() - 2.0).abs() < 0.01, "{}", bench.turns());
    bench.send(READY, 1);
    bench.send(READY | 0x1000, 60);
    assert!((bench.pace() - 600.0).abs() < 0.01, "{}", bench.pace());
}

/// Nor by one that was 1 while homing ran, or when DRV.STOP stopped the jog.
#[test]
fn a_jog_bit_of_homing_or_of_a_stopped_jog_has_to_be_set_anew() {
    let mut bench = Bench::new(9);
    bench.write("Jog v1", 819); // 300 rpm
    bench.enable();
    bench.write("HOME.MODE", 11);
    bench.send(0x040F, 2);
    bench.send(0x0D0F, 3);
    bench.until(0x0D0F, 0x0800, 0x0800);
    bench.send(0x0D0F, 60);
    assert!(bench.pace().abs() < 0.01, "{}", bench.pace());
    bench.send(0x040F, 1);
    bench.send(0x050F, 60);
    assert!((bench.pace() - 300.0).abs() < 0.1, "{}", bench.pace());
    bench.write("DRV.STOP", 1);
    bench.send(0x050F, 120);
    assert!(bench.pace().abs() < 0.01, "{}", bench.pace());
    bench.send(0x040F, 1);
    bench.send(0x050F, 60);
    assert!((bench.pace() - 300.0).abs() < 0.1, "{}", bench.pace());
}

#[test]
fn a_jog_bit_that_comes_with_the_enable_jogs() {
    let mut bench = Bench::new(9);
    bench.write("Jog v1", 819); // 300 rpm
    for control in [0x0406, 0x0407] {
        bench.send(control, 3);
    }
    bench.send(0x050F, 60);
    assert!((bench.pace() - 300.0).abs() < 0.1, "{}", bench.pace());
}

/// 5.8 has SATZANW as MT.MOVE. MT.MOVE is an action, which reads 0; the signals show the task.
#[test]
fn satzanw_selects_and_mt_move_reads_0() {
    let mut bench = Bench::homed(7);
    bench.task(5, 2.0, 600.0, 6000.0, 0);
    bench.set(signal::SATZANW, 5);
    bench.send(START, 4);
    assert_eq!(bench.status() & 0x5000, 0x5000);
    assert_eq!((bench.read("SATZANW"), bench.read("MT.MOVE")), (5, 0));
    assert_eq!(bench.get(signal::AKTSATZ), 5);
    bench.until(READY, 0x0400, 0x0400);
    bench.write("MT.MOVE", 5);
    assert_eq!(bench.read("MT.MOVE"), 0);
}

/// 5.10.2: bit 15 of SATZANW is MDI whatever the bits below it; AKTSATZ shows bit 15 alone, and 0 when nothing runs.
#[test]
fn bit_15_of_satzanw_is_mdi_whatever_the_number() {
    let mut bench = Bench::homed(9);
    assert_eq!(bench.get(signal::AKTSATZ), 0);
    bench.mdi(1.0, 300.0, 8, true);
    bench.set(signal::SATZANW, 0x8000 | 0x7005);
    assert_eq!(bench.send(START, 1) & 0x5000, 0x5000);
    assert_eq!(bench.get(signal::AKTSATZ), 0x8000);
    bench.until(READY, 0x0400, 0x0400);
    bench.send(READY, 20);
    assert!((bench.turns() - 1.0).abs() < 0.01, "{}", bench.turns());
    assert_eq!(bench.get(signal::AKTSATZ), 0);
}
