//! Chains of motion tasks, jogging, limits, modulo axes, units, and the commands of the service channel.

use core::time::Duration;

use profile::parameter::ErrorNumber;
use profile::state::State;
use profile::telegram::signal;

use super::tests::{Bench, READY, START};
use crate::axis::{Plant, Travel};
use crate::model::AKD;

const TURN: i64 = 1 << 32;

/// MT.CNTL: absolute with a following task of this kind (bits 5 to 9).
const fn then(follow: i64) -> i64 {
    0x10 | follow << 5
}

/// Two tasks in a chain: 2 revolutions, then to 5; 600 rpm at 6000 rpm/s, the second one at 300 rpm.
fn chain(follow: i64, dwell: i64) -> Bench {
    let mut bench = Bench::homed(7);
    bench.cycle = Duration::from_millis(1);
    bench.write("MT.MTNEXT", 2);
    bench.write("MT.TNEXT", dwell);
    bench.task(1, 2.0, 600.0, 6000.0, then(follow));
    bench.write("MT.MTNEXT", 0);
    bench.task(2, 5.0, 300.0, 6000.0, 0);
    bench.set(signal::SATZANW, 1);
    bench.send(START, 1);
    bench
}

/// Runs until task 2 has begun: the slowest pace meanwhile behind the first 150 ms, and how long the axis stood.
fn to_the_second(bench: &mut Bench) -> (f64, u32) {
    let (mut slowest, mut stood) = (f64::MAX, 0);
    for cycle in 0.. {
        assert!(cycle < 5000, "{:?}", bench.drive.positioning);
        let word = bench.send(START, 1);
        if cycle > 150 {
            slowest = slowest.min(bench.pace());
            stood += u32::from(bench.pace() == 0.0);
        }
        assert_eq!(
            word & 0x4400,
            0x4000,
            "active all the time, not reached: {word:04X}"
        );
        if bench.get(signal::AKTSATZ) == 2 && bench.pace() > 0.0 && bench.turns() > 2.3 {
            return (slowest, stood);
        }
    }
    unreachable!()
}

fn to_the_end(bench: &mut Bench, turns: f64) {
    bench.until(START, 0x0400, 0x0400);
    bench.send(START, 60);
    assert!((bench.turns() - turns).abs() < 0.002, "{}", bench.turns());
    assert_eq!(bench.get(signal::AKTSATZ), 0);
}

#[test]
fn at_once_with_a_dwell_and_with_an_event() {
    let mut bench = chain(0, 0);
    let (slowest, stood) = to_the_second(&mut bench);
    assert!(slowest == 0.0 && stood <= 2, "{stood}");
    to_the_end(&mut bench, 5.0);

    let mut bench = chain(1, 70);
    let (_, stood) = to_the_second(&mut bench);
    assert!((69..=73).contains(&stood), "MT.TNEXT: {stood}");
    to_the_end(&mut bench, 5.0);

    // 7: dwell or event; 3: both; 2: event only.
    for (follow, dwell, event_at, expected) in [
        (7, 70, 1000, 70),
        (7, 500, 30, 30),
        (3, 70, 10, 70),
        (2, 0, 40, 40),
    ] {
        let mut bench = chain(follow, dwell);
        while bench.pace() == 0.0 || bench.turns() < 1.0 {
            bench.send(START, 1);
        }
        while bench.pace() > 0.0 {
            bench.send(START, 1);
        }
        let mut stood: i64 = 0;
        while bench.pace() == 0.0 {
            if stood == event_at {
                bench.drive.motion_event();
            }
            bench.send(START, 1);
            stood += 1;
            assert!(stood < 2000, "{follow}");
        }
        assert!((stood - expected).abs() <= 4, "{follow}: {stood}");
        to_the_end(&mut bench, 5.0);
    }
}

/// Lets the level at a digital input rise and fall.
fn press(bench: &mut Bench, input: u8) {
    for on in [true, false] {
        bench
            .drive
            .inject(crate::drive::Injection::Input { number: input, on });
    }
}

#[test]
fn a_chain_waits_for_the_edge_of_an_input() {
    let mut bench = chain(2, 0);
    bench.write("DIN5.MODE", 2);
    // While task 1 moves there is nothing to go on with.
    bench.send(START, 20);
    press(&mut bench, 5);
    while bench.pace() > 0.0 || bench.turns() < 1.0 {
        bench.send(START, 1);
    }
    bench.send(START, 1000);
    assert!((bench.turns() - 2.0).abs() < 0.002, "waits: {}", bench.turns());
    assert_eq!(
        bench.status() & 0x4400,
        0x4000,
        "the chain runs, no target reached"
    );
    // An input that does something else is not an event.
    press(&mut bench, 1);
    bench.send(START, 100);
    assert_eq!(bench.pace(), 0.0);
    press(&mut bench, 5);
    bench.send(START, 3);
    assert_eq!(bench.get(signal::AKTSATZ), 2);
    assert!(bench.pace() > 0.0);
    to_the_end(&mut bench, 5.0);
}

#[test]
fn an_input_starts_its_task_and_homing() {
    let mut bench = Bench::homed(7);
    bench.task(7, 1.5, 600.0, 20_000.0, 0);
    bench.write("DIN2.MODE", 2);
    press(&mut bench, 2);
    bench.send(READY, 50);
    assert_eq!(bench.status() & 0x5000, 0, "DIN2.PARAM names no task");
    bench.write("DIN2.PARAM", 7000);
    press(&mut bench, 2);
    bench.until(READY, 0x0400, 0x0400);
    bench.send(READY, 30);
    assert!((bench.turns() - 1.5).abs() < 0.002, "{}", bench.turns());
    // A task that is not there is reported, as by MT.MOVE.
    bench.write("DIN2.PARAM", 9000);
    press(&mut bench, 2);
    bench.send(READY, 2);
    assert!(bench.warned(164));
    bench.write("HOME.P", 65_536 * 3);
    bench.write("DIN6.MODE", 5);
    press(&mut bench, 6);
    bench.send(READY, 5);
    assert!((bench.turns() - 3.0).abs() < 0.002, "{}", bench.turns());
}

#[test]
fn change_on_the_fly_passes_the_target_at_the_one_or_the_other_speed() {
    // At the present speed: 600 rpm at the target, then down to 300.
    let mut bench = chain(0b10000, 0);
    let mut at_target = 0.0;
    while bench.turns() < 2.0 {
        bench.send(START, 1);
        at_target = bench.pace();
    }
    assert!(at_target > 580.0, "{at_target}");
    let (slowest, stood) = to_the_second(&mut bench);
    assert!(stood == 0 && slowest > 299.0, "{slowest}");
    to_the_end(&mut bench, 5.0);
    // At the speed of the next one: 300 rpm at the target already.
    let mut bench = chain(0b11000, 0);
    while bench.turns() < 1.999 {
        bench.send(START, 1);
    }
    assert!((bench.pace() - 300.0).abs() < 7.0, "{}", bench.pace());
    to_the_end(&mut bench, 5.0);
    // A faster next task: its speed is there at the target.
    let mut bench = chain(0b11000, 0);
    bench.write("MT.CLEAR", -1);
    bench.send(0x046F, 300);
    bench.write("HOME.SET", 1);
    bench.write("MT.MTNEXT", 2);
    bench.task(1, 3.0, 300.0, 6000.0, then(0b11000));
    bench.task(2, 9.0, 900.0, 6000.0, 0);
    bench.send(READY, 2);
    bench.send(START, 1);
    while bench.turns() < 2.995 {
        bench.send(START, 1);
    }
    assert!((bench.pace() - 900.0).abs() < 30.0, "{}", bench.pace());
    to_the_end(&mut bench, 9.0);
    // The other way round there is nothing to pass: it stops.
    let mut bench = Bench::homed(7);
    bench.cycle = Duration::from_millis(1);
    bench.write("MT.MTNEXT", 2);
    bench.task(1, 2.0, 600.0, 6000.0, then(0b10000));
    bench.task(2, -1.0, 600.0, 6000.0, 0);
    bench.set(signal::SATZANW, 1);
    bench.send(START, 1);
    let mut farthest: f64 = 0.0;
    while bench.status() & 0x0400 == 0 {
        bench.send(START, 1);
        farthest = farthest.max(bench.drive.axis().position_command() as f64 / TURN as f64);
    }
    assert!((farthest - 2.0).abs() < 1e-6, "{farthest}");
    to_the_end(&mut bench, -1.0);
}

#[test]
fn a_stop_in_front_of_a_target_that_is_passed_loses_nothing() {
    for stop_at in [1.7, 1.9, 1.97, 1.99] {
        let mut bench = chain(0b10000, 0);
        while bench.turns() < stop_at {
            bench.send(START, 1);
        }
        bench.until(START & !0x20, 0x2000, 0x2000);
        assert_eq!(bench.status() & 0x4000, 0x4000);
        let stopped = bench.turns();
        let mut lowest = stopped;
        bench.send(START, 1);
        while bench.status() & 0x0400 == 0 {
            bench.send(START, 1);
            lowest = lowest.min(bench.turns());
        }
        assert!(lowest > stopped - 0.01, "goes on, not back: {lowest} {stopped}");
        to_the_end(&mut bench, 5.0);
    }
}

#[test]
fn a_broken_chain_is_reported() {
    let mut bench = chain(0, 0);
    bench.until(START, 0x2000, 0);
    let mut broken = Bench::homed(7);
    broken.write("MT.MTNEXT", 9);
    broken.task(1, 1.0, 600.0, 6000.0, then(0));
    broken.set(signal::SATZANW, 1);
    broken.send(START, 1);
    broken.until(START, 0x0480, 0x0480);
    assert!(broken.warned(154));
    // The table may change while a chain runs: what began is what runs.
    bench.write("MT.CLEAR", 2);
    to_the_end(&mut bench, 5.0);
}

#[test]
fn tasks_are_relative_to_their_reference() {
    let mut bench = Bench::homed(7);
    let go = |bench: &mut Bench, control: i64, turns: f64| {
        bench.task(1, turns, 600.0, 20_000.0, control);
        bench.set(signal::SATZANW, 1);
        bench.send(READY, 2);
        bench.send(START, 1);
        bench.until(START, 0x0400, 0x0400);
        bench.send(START, 30);
        bench.turns()
    };
    assert!((go(&mut bench, 1, 1.5) - 1.5).abs() < 0.002);
    assert!((go(&mut bench, 3, 1.0) - 2.5).abs() < 0.002);
    assert!((go(&mut bench, 7, -0.5) - 2.0).abs() < 0.003);
    assert!((go(&mut bench, 0, -0.5) + 0.5).abs() < 0.002);
    // From the target of the one before, though that was interrupted.
    bench.task(2, 10.0, 600.0, 20_000.0, 0);
    bench.set(signal::SATZANW, 2);
    bench.send(READY, 2);
    bench.send(START, 40);
    bench.task(1, 1.0, 600.0, 20_000.0, 3);
    bench.set(signal::SATZANW, 1);
    bench.send(READY, 2);
    bench.send(START, 1);
    bench.until(START, 0x0400, 0x0400);
    bench.send(START, 30);
    assert!((bench.turns() - 11.0).abs() < 0.002, "{}", bench.turns());
    // A task that accepts no other one.
    bench.task(3, 0.0, 600.0, 20_000.0, 0x2000);
    bench.set(signal::SATZANW, 3);
    bench.send(READY, 2);
    bench.send(START, 20);
    bench.set(signal::SATZANW, 1);
    bench.send(READY, 2);
    assert_eq!(bench.send(START, 2) & 0x1000, 0);
    assert!(bench.warned(160));
    bench.until(READY, 0x0400, 0x0400);
    bench.send(READY, 30);
    assert!(bench.turns().abs() < 0.002);
}

#[test]
fn an_s_curve_takes_longer_and_arrives() {
    let time = |control| {
        let mut bench = Bench::homed(7);
        bench.cycle = Duration::from_millis(1);
        bench.task(1, 3.0, 600.0, 6000.0, control);
        bench.set(signal::SATZANW, 1);
        bench.send(START, 1);
        let took = bench.until(START, 0x0400, 0x0400);
        bench.send(START, 50);
        assert!((bench.turns() - 3.0).abs() < 0.002);
        took
    };
    let (trapezoid, smooth) = (time(0), time(0x400));
    assert!(
        smooth > trapezoid + Duration::from_millis(30),
        "{trapezoid:?} {smooth:?}"
    );
}

#[test]
fn jog_one_and_two_and_their_limits() {
    let mut bench = Bench::new(9);
    bench.write("Jog v1", 819); // 300 rpm
    bench.write("Jog v2", -819);
    bench.write("Jog Acc", 4);
    bench.write("Jog Dec", 8);
    bench.enable();
    // Not homed: jogs, and no limit holds.
    bench.write("SWLS.LIMIT1", 65_536);
    bench.write("SWLS.EN", 2);
    bench.send(0x040F, 4);
    bench.send(0x050F, 12); // the first tick in S4 counts too
    assert!((bench.pace() - 0.048 * 3052.0).abs() < 13.0, "{}", bench.pace());
    bench.send(0x050F, 200);
    assert!((bench.pace() - 299.8).abs() < 0.5, "{}", bench.pace());
    assert_eq!(bench.read("DRV.MOTIONSTAT") & 0x200, 0x200);
    assert_eq!(bench.status() & 0x7000, 0);
    let before = bench.pace();
    bench.send(0x040F, 5);
    assert!((before - bench.pace() - 0.020 * 6104.0).abs() < 7.0);
    bench.until(0x040F, 0x2000, 0x2000);
    bench.until(0x060F, 0x2000, 0);
    bench.send(0x060F, 100);
    assert!((bench.pace() + 299.8).abs() < 0.5);
    bench.until(0x040F, 0x2000, 0x2000);
    // Homed: the limit is where it ends, with a warning; the other way is free.
    bench.write("HOME.SET", 1);
    bench.until(0x050F, 0x2000, 0);
    bench.until(0x050F, 0x2000, 0x2000);
    bench.send(0x050F, 50);
    assert!((bench.turns() - 1.0).abs() < 0.001, "{}", bench.turns());
    assert!(bench.warned(107) && bench.status() & 0x80 != 0);
    assert_eq!(bench.read("SWLS.STATE"), 2);
    bench.send(0x040F, 3);
    bench.send(0x050F, 50);
    assert!((bench.turns() - 1.0).abs() < 0.001);
    bench.send(0x040F, 3);
    bench.send(0x060F, 100);
    assert!(bench.turns() < 0.9 && !bench.warned(107));
}

#[test]
fn real_time_jogging_follows_the_mdi_signals() {
    let mut bench = Bench::homed(9);
    bench.mdi(0.0, 240.0, 4, false);
    bench.send(READY | 0x1000, 60);
    assert!((bench.pace() - 240.0).abs() < 0.01, "{}", bench.pace());
    bench.mdi(0.0, 480.0, 4, false);
    bench.send(READY | 0x1000, 60);
    assert!((bench.pace() - 480.0).abs() < 0.01);
    // Bit 13 turns round, through standstill on the ramps.
    bench.send(READY | 0x3000, 1);
    assert!(bench.pace() > 460.0);
    bench.send(READY | 0x3000, 120);
    assert!((bench.pace() + 480.0).abs() < 0.01);
    // A task waits until it is over.
    bench.send(READY | 0x3040, 2);
    assert_eq!(bench.status() & 0x5000, 0);
    bench.send(READY, 1);
    bench.until(READY, 0x2000, 0x2000);
    assert_eq!(bench.status() & 0x0400, 0, "no target any more");
}

#[test]
fn a_limit_switch_ends_what_leads_into_it() {
    let plant = Plant {
        travel: Some(Travel {
            positive_switch: 3 * TURN,
            ..Travel::FREE
        }),
        ..AKD.plant
    };
    let mut bench = Bench::with(9, plant);
    bench.enable();
    bench.write("HOME.SET", 1);
    bench.mdi(20.0, 600.0, 20, true);
    bench.send(START, 1);
    bench.until(START, 0x6000, 0x2000);
    assert_eq!(bench.status() & 0x0400, 0, "not reached");
    assert_eq!(
        bench.read("DRV.MOTIONSTAT") & 0x2000,
        0x2000,
        "and that is reported"
    );
    // 600 rpm at 15260 rpm/s takes 0.2 revolutions.
    assert!((bench.turns() - 3.2).abs() < 0.02, "{}", bench.turns());
    assert_eq!(
        (bench.read("HWLS.POSSTATE"), bench.read("DRIVE_INPUTS") & 8),
        (1, 8)
    );
    // Farther in: refused. Out: fine.
    bench.send(READY, 2);
    assert_eq!(bench.send(START, 2) & 0x1000, 0);
    bench.mdi(1.0, 600.0, 20, true);
    bench.send(READY, 2);
    assert_eq!(bench.send(START, 2) & 0x1000, 0x1000);
    bench.until(READY, 0x0400, 0x0400);
}

#[test]
fn a_change_that_could_not_brake_in_front_of_the_limit_is_refused() {
    let mut bench = Bench::homed(9);
    bench.write("SWLS.LIMIT1", 10 * 65_536);
    bench.write("SWLS.EN", 2);
    bench.mdi(10.0, 1500.0, 60, true);
    bench.send(START, 1);
    while bench.turns() < 8.0 {
        bench.send(READY, 1);
    }
    bench.mdi(9.0, 1500.0, 1, true);
    assert_eq!(bench.send(START, 2) & 0x5000, 0x4000, "the one that runs goes on");
    assert!(bench.warned(169));
    bench.until(READY, 0x0400, 0x0400);
    assert!((bench.turns() - 10.0).abs() < 0.01);
    // With a ramp that can: it passes the new target, comes back, and reports it.
    bench.mdi(0.0, 1500.0, 60, true);
    bench.send(START, 1);
    while bench.turns() > 5.0 {
        bench.send(READY, 1);
    }
    bench.mdi(4.8, 1500.0, 20, true);
    assert_eq!(bench.send(START, 1) & 0x1000, 0x1000);
    assert_eq!(bench.read("DRV.MOTIONSTAT") & 0x4000, 0x4000);
    bench.until(READY, 0x0400, 0x0400);
    bench.send(READY, 20);
    assert!((bench.turns() - 4.8).abs() < 0.01);
}

#[test]
fn a_modulo_axis_moves_in_the_commanded_direction() {
    let mut bench = Bench::homed(9);
    bench.write("UNIT.PROTARY", 2); // degrees
    bench.write("PL.MODP1", 0);
    bench.write("PL.MODP2", 360);
    bench.write("PL.MODPEN", 1);
    let go = |bench: &mut Bench, direction: i64, degrees: f64| {
        bench.write("PL.MODPDIR", direction);
        bench.mdi(degrees / 360.0, 600.0, 30, true);
        bench.send(READY, 2);
        bench.send(START, 1);
        bench.until(READY, 0x0400, 0x0400);
        bench.send(READY, 40);
        (bench.turns() * 360.0, bench.read("PL.FB"))
    };
    for (direction, degrees, linear) in [
        (1, 350.0, 350.0),
        (1, 10.0, 370.0),
        (3, 350.0, 350.0),
        (2, 355.0, -5.0),
        (3, 5.0, 5.0),
        (0, 350.0, 350.0),
        (0, 0.0, 0.0),
    ] {
        let (turned, shown) = go(&mut bench, direction, degrees);
        assert!((turned - linear).abs() < 0.6, "{direction} {degrees}: {turned}");
        let off = (shown as f64 - degrees).rem_euclid(360.0);
        assert!(!(1.1..=358.9).contains(&off), "shown {shown} for {degrees}");
        assert!((0..=360).contains(&shown));
    }
    // Outside the range there is nothing to go to.
    bench.mdi(400.0 / 360.0, 600.0, 30, true);
    bench.send(READY, 2);
    assert_eq!(bench.send(START, 2) & 0x1000, 0);
    assert!(bench.warned(165));
}

#[test]
fn positions_in_the_unit_and_the_scale_that_were_chosen() {
    let mut bench = Bench::homed(9);
    bench.mdi(1.5, 600.0, 30, true);
    bench.send(START, 1);
    bench.until(READY, 0x0400, 0x0400);
    bench.send(READY, 60);
    let near = |bench: &Bench, name: &str, value: i64, tolerance: i64| {
        let read = bench.read(name);
        assert!(
            (read - value).abs() <= tolerance,
            "{name}: {read}, expected {value}"
        );
    };
    near(&bench, "PL.CMD", 98_304, 0);
    near(&bench, "PL.FB", 98_304, 80);
    near(&bench, "XIST_A", 98_304, 80);
    bench.write("PN.POSSCALE", 1);
    near(&bench, "PL.CMD", 98_304_000, 0);
    bench.write("UNIT.PROTARY", 2);
    near(&bench, "PL.CMD", 540_000, 0);
    bench.write("UNIT.PROTARY", 1);
    near(&bench, "PL.CMD", 9_425, 0);
    bench.write("UNIT.PROTARY", 3);
    bench.write("UNIT.PIN", 50);
    bench.write("UNIT.POUT", 10);
    near(&bench, "PL.CMD", 7_500, 0);
    bench.write("1002", 10);
    near(&bench, "XIST_A", 1536, 2);
    bench.set(signal::MDI_TARPOS, -512);
    bench.send(START, 1);
    bench.until(READY, 0x0400, 0x0400);
    assert_eq!(bench.drive.axis().position_command(), -TURN / 2, "PNU 1002");
}

#[test]
fn set_load_clear_and_move() {
    let mut bench = Bench::homed(7);
    bench.write("MT.MTNEXT", 7);
    bench.write("MT.TNEXT", 250);
    bench.task(128, -2.5, 60.0, 1000.0, 0x11);
    bench.task(1, 1.0, 600.0, 20_000.0, 0);
    bench.write("MT.NUM", 128);
    bench.write("MT.LOAD", 1);
    for (name, value) in [
        ("MT.P", -163_840),
        ("MT.V_32", 60_000),
        ("MT.ACC", 1_000_000),
        ("MT.DEC", 1_000_000),
        ("MT.CNTL", 0x11),
        ("MT.MTNEXT", 7),
        ("MT.TNEXT", 250),
    ] {
        assert_eq!(bench.read(name), value, "{name}");
    }
    assert_eq!(bench.try_write("MT.NUM", 129), Err(ErrorNumber::LIMIT));
    assert_eq!(bench.try_write("MT.CLEAR", 129), Err(ErrorNumber::LIMIT));
    assert_eq!(bench.try_write("MT.MOVE", 129), Err(ErrorNumber::LIMIT));
    assert_eq!(bench.try_write("MT.MOVE", 5), Err(ErrorNumber::NOT_NOW), "empty");
    assert_eq!(bench.try_write("MT.CONTINUE", 1), Err(ErrorNumber::NOT_NOW));
    bench.write("MT.MOVE", 1);
    bench.send(READY, 10);
    assert_eq!(
        bench.status() & 0x5000,
        0x4000,
        "no acknowledge without a request"
    );
    bench.write("DRV.STOP", 1);
    bench.until(READY, 0x2000, 0x2000);
    assert_eq!(bench.status() & 0x4400, 0x4000);
    bench.send(READY & !0x20, 5);
    bench.send(READY, 50);
    assert_eq!(bench.status() & 0x2000, 0x2000, "waits for its own command");
    bench.write("MT.CONTINUE", 1);
    bench.until(READY, 0x0400, 0x0400);
    bench.write("MT.CLEAR", -1);
    bench.write("MT.LOAD", 1);
    assert_eq!((bench.read("MT.P"), bench.read("MT.CNTL")), (0, 0));
    bench.send(0x0430, 3);
    assert_eq!(
        bench.try_write("MT.MOVE", 1),
        Err(ErrorNumber::NOT_NOW),
        "not in S4"
    );
    assert_eq!(bench.drive.state(), State::S1);
}

#[test]
fn saved_tasks_survive_and_others_do_not() {
    let mut bench = Bench::homed(7);
    bench.task(5, 2.5, 60.0, 1000.0, 0x11);
    bench.write("DRV.NVSAVE", 1);
    bench.task(6, 1.0, 60.0, 1000.0, 0);
    bench.send(0x0430, 3);
    bench.write("DRV.NVLOAD", 1);
    bench.write("MT.NUM", 6);
    bench.write("MT.LOAD", 1);
    assert_eq!(bench.read("MT.P"), 0);
    bench.write("MT.NUM", 5);
    bench.write("MT.LOAD", 1);
    assert_eq!((bench.read("MT.P"), bench.read("MT.CNTL")), (163_840, 0x11));
    bench.write("DRV.RSTVAR", 1);
    bench.write("MT.NUM", 5);
    bench.write("MT.LOAD", 1);
    assert_eq!(bench.read("MT.P"), 0);
}

#[test]
fn the_feedrate_applies_to_tasks_only() {
    let mut bench = Bench::homed(9);
    bench.write("MT_FEEDRATE", 50);
    bench.mdi(0.0, 240.0, 4, false);
    bench.send(READY | 0x1000, 60);
    // it takes its three signals
    assert!((bench.pace() - 240.0).abs() < 0.01, "{}", bench.pace());
}

#[test]
fn the_feedrate_slows_down_what_runs() {
    let mut bench = Bench::homed(7);
    assert_eq!(bench.read("MT_FEEDRATE"), 100, "what acts as delivered");
    bench.task(1, 50.0, 600.0, 20_000.0, 0);
    bench.set(signal::SATZANW, 1);
    bench.send(START, 60);
    assert_eq!(bench.pace(), 600.0);
    bench.write("MT_FEEDRATE", 50);
    bench.send(START, 60);
    assert_eq!(bench.pace(), 300.0);
    bench.write("MT_FEEDRATE", 200);
    bench.send(START, 60);
    assert_eq!(bench.pace(), 600.0, "never faster than the task");
    bench.write("MT_FEEDRATE", 0);
    bench.send(START, 60);
    assert_eq!(bench.pace(), 0.0, "held");
    assert_eq!(bench.status() & 0x4000, 0x4000, "and still active");
    bench.write("MT_FEEDRATE", 100);
    // Faster than the drive may: slower, and it reports this.
    bench.task(2, -50.0, 5000.0, 50_000.0, 0);
    bench.set(signal::SATZANW, 2);
    bench.send(READY, 2);
    bench.send(START, 100);
    assert_eq!(bench.pace(), -3000.0);
    assert!(bench.warned(153));
}
