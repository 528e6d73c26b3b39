//! Digital inputs: what each function does at an edge or for as long as it is active.

use profile::state::State;

use super::Drive;
use super::bench::{Bench, CYCLE};
use crate::model::AKD;

fn number(name: &str) -> u16 {
    AKD.catalogue.by_name(name).unwrap().pnu
}

fn write(bench: &mut Bench, name: &str, raw: i64) {
    bench.write(number(name), raw).unwrap();
}

fn read(bench: &Bench, name: &str) -> i64 {
    bench.drive.parameter(number(name)).unwrap()
}

fn inject(drive: &mut Drive, text: &str) {
    drive.inject(text.parse().unwrap());
}

/// In S4 at 600 rpm.
fn running() -> Bench {
    let mut bench = Bench::new(&AKD, 1);
    bench.send(0x047E, 0, 40);
    bench.send(0x047F, 1638, 1000);
    assert_eq!(bench.drive.state(), State::S4);
    assert!((bench.speed() - 1638).abs() < 10);
    bench
}

#[test]
fn each_state_is_the_level_at_its_own_input() {
    let mut bench = Bench::new(&AKD, 1);
    write(&mut bench, "DIN3.INV", 1);
    for input in 1..=7 {
        inject(&mut bench.drive, &format!("input={input}:on"));
        for other in 1..=7 {
            let state = read(&bench, &format!("DIN{other}.STATE"));
            assert_eq!(state, i64::from(other == input), "{input} {other}");
        }
        inject(&mut bench.drive, &format!("input={input}:off"));
    }
    for strange in ["input=8:on", "input=255:on"] {
        inject(&mut bench.drive, strange);
    }
    assert!((1..=7).all(|input| read(&bench, &format!("DIN{input}.STATE")) == 0));
}

#[test]
fn an_external_fault_lasts_as_long_as_its_input_and_mode_one_clears_it() {
    let mut bench = running();
    write(&mut bench, "DIN1.MODE", 10);
    write(&mut bench, "DIN2.MODE", 1);
    inject(&mut bench.drive, "input=1:on");
    bench.ticks(300);
    assert_eq!((read(&bench, "DRV.FAULT1"), bench.speed()), (245, 0));
    // Its cause is there: nothing clears it.
    inject(&mut bench.drive, "input=2:on");
    bench.send(0x04FE, 0, 40);
    assert_eq!(read(&bench, "DRV.FAULT1"), 245);
    inject(&mut bench.drive, "input=1:off");
    inject(&mut bench.drive, "input=2:on");
    bench.ticks(2);
    assert_eq!(read(&bench, "DRV.FAULT1"), 245, "no edge, nothing done");
    inject(&mut bench.drive, "input=2:off");
    bench.ticks(2);
    assert_eq!(read(&bench, "DRV.FAULT1"), 245, "not at the falling one");
    inject(&mut bench.drive, "input=2:on");
    bench.ticks(2);
    assert_eq!(read(&bench, "DRV.FAULT1"), 0);
}

#[test]
fn the_emergency_stop_ramps_down_disables_and_is_reported() {
    let mut bench = running();
    write(&mut bench, "DIN4.MODE", 13);
    inject(&mut bench.drive, "input=4:on");
    bench.ticks(1);
    assert_eq!(bench.drive.state(), State::S5Quick);
    bench.ticks(300);
    assert!(!bench.drive.is_enabled() && bench.speed().abs() < 5);
    assert_eq!(
        (
            read(&bench, "DRV.DISSOURCES") & 0x20,
            read(&bench, "DRIVE_INPUTS")
        ),
        (0x20, 0x60)
    );
    // Active low, it is released by the level that was the stop.
    write(&mut bench, "DIN4.INV", 1);
    assert_eq!(read(&bench, "DRIVE_INPUTS"), 0x40);
    inject(&mut bench.drive, "input=4:off");
    assert_eq!(read(&bench, "DRIVE_INPUTS"), 0x60);
    // Off is off.
    write(&mut bench, "DIN4.MODE", 0);
    assert_eq!(read(&bench, "DRIVE_INPUTS"), 0x40);
}

/// Bit 7 is blank and the bits from 8 on are reserved, whatever the inputs are.
#[test]
fn the_reserved_bits_of_the_drive_inputs_are_zero() {
    let mut bench = running();
    for (mode, low, high) in [
        ("DIN4.MODE", 18, 19),
        ("DIN5.MODE", 19, 18),
        ("DIN6.MODE", 13, 13),
    ] {
        for value in [low, high] {
            write(&mut bench, mode, value);
            for input in ["input=4:on", "input=5:on", "input=6:on", "input=4:off"] {
                inject(&mut bench.drive, input);
                bench.ticks(1);
                assert_eq!(read(&bench, "DRIVE_INPUTS") & 0xFF80, 0);
            }
        }
    }
    assert_ne!(read(&bench, "DRIVE_INPUTS"), 0);
}

#[test]
fn mode_fifteen_stops_like_drv_stop() {
    let mut bench = running();
    write(&mut bench, "DIN7.MODE", 15);
    inject(&mut bench.drive, "input=7:on");
    bench.send(0x047F, 1638, 1000);
    assert!(
        bench.drive.is_enabled() && bench.speed().abs() < 5,
        "{}",
        bench.speed()
    );
}

#[test]
fn a_changed_parameter_is_no_edge_and_a_mode_without_meaning_does_nothing() {
    let mut bench = running();
    inject(&mut bench.drive, "input=1:on");
    write(&mut bench, "DIN1.MODE", 15);
    bench.send(0x047F, 1638, 500);
    for mode in [3, 4, 6, 7, 8, 11, 12, 16, 17, 18, 19, 20] {
        write(&mut bench, "DIN1.MODE", mode);
        inject(&mut bench.drive, "input=1:off");
        inject(&mut bench.drive, "input=1:on");
        bench.ticks(20);
    }
    assert!((bench.speed() - 1638).abs() < 10, "{}", bench.speed());
    assert_eq!(read(&bench, "DRIVE_INPUTS"), 0x40);
}

#[test]
fn an_unticked_drive_still_finds_the_stop() {
    let mut drive = Drive::new(&AKD);
    drive
        .set_element(AKD.catalogue.position(2061).unwrap(), 0, 10)
        .unwrap();
    inject(&mut drive, "input=1:on");
    assert!(drive.next_tick().is_some());
    drive.tick(drive.last + CYCLE, None, &mut []);
    assert_eq!(drive.parameter(number("DRV.FAULT1")), Some(245));
}
