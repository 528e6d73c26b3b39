//! Every mode of homing on an axis with switches, stops and an index pulse.

use profile::telegram::signal;

use super::tests::{Bench, READY, START};
use super::units::REVOLUTION;
use crate::axis::{Plant, Travel};
use crate::model::AKD;

const TURN: i64 = 1 << 32;
const HOME: u16 = READY | 0x0800;

/// Place of the limit switches: 4.1 revolutions.
const SWITCH: i64 = 4 * TURN + TURN / 10;

/// Switches 4.1 revolutions away, hard stops at 5, home switch from 1 to 1.5, index at 0.25 of each turn.
fn plant() -> Plant {
    Plant {
        index: 1 << 30,
        travel: Some(Travel {
            negative_stop: -5 * TURN,
            positive_stop: 5 * TURN,
            negative_switch: -SWITCH,
            positive_switch: SWITCH,
            home_switch: Some((TURN, TURN + TURN / 2)),
        }),
        ..AKD.plant
    }
}

fn bench(mode: i64, positive: bool) -> Bench {
    with(plant(), mode, positive)
}

fn with(plant: Plant, mode: i64, positive: bool) -> Bench {
    let mut bench = Bench::with(9, plant);
    bench.write("HOME.MODE", mode);
    bench.write("HOME.DIR", i64::from(positive));
    bench.write("HOME.V_32", 300_000);
    bench.write("HOME.ACC", 6_000_000);
    bench.write("HOME.DEC", 6_000_000);
    bench.enable();
    bench
}

/// Homes; the place of the reference and where the axis is then, in revolutions of the plant.
fn home(bench: &mut Bench) -> (f64, f64) {
    bench.send(HOME, 1);
    assert_eq!(bench.status() & 0x2C00, 0, "runs");
    bench.until(HOME, 0x2C00, 0x2C00);
    bench.send(HOME, 30);
    assert_eq!(bench.status() & 0x2C80, 0x2C00, "done, no warning");
    assert_eq!(bench.read("DRV.MOTIONSTAT") & 0b11110, 0b00110);
    let axis = bench.drive.axis();
    let there = axis.feedback() as f64 / REVOLUTION;
    let home = bench.read("HOME.P") as f64 / 65_536.0;
    let reference = there - axis.position() as f64 / REVOLUTION + home;
    (reference, there)
}

#[track_caller]
fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 0.003, "{a}, expected {b}");
}

#[test]
fn homing_at_the_present_position_and_at_the_feedback_position() {
    let mut bench = bench(0, true);
    bench.write("HOME.P", 2 * 65_536);
    let (reference, there) = home(&mut bench);
    near(reference, 0.0);
    near(there, 0.0);
    assert_eq!(bench.read("PL.FB"), 2 * 65_536);
    let mut bench = self::bench(13, true);
    near(home(&mut bench).0, 0.0);
}

#[test]
fn to_a_limit_switch_and_on() {
    for (mode, positive, reference) in [
        (1, true, 4.1),
        (1, false, -4.1),
        // Off the switch, then the zero angle or the index behind it.
        (2, true, 4.0),
        (2, false, -4.0),
        (3, true, 3.25),
        (3, false, -3.75),
    ] {
        let mut bench = bench(mode, positive);
        let (found, there) = home(&mut bench);
        near(found, reference);
        near(there, reference);
    }
}

#[test]
fn to_the_home_switch_and_on() {
    for (mode, positive, reference) in [
        (4, true, 1.0),
        (4, false, 1.5), // met after turning round at the limit
        (5, true, 1.0),
        (5, false, 1.0),
        (6, true, 1.25),
        (6, false, 1.25),
    ] {
        let mut bench = bench(mode, positive);
        let (found, there) = home(&mut bench);
        near(found, reference);
        near(there, reference);
    }
}

#[test]
fn standing_on_the_switch_it_is_left_first() {
    let mut travel = plant().travel.unwrap();
    travel.home_switch = Some((-TURN / 2, TURN / 2));
    let on_it = Plant {
        travel: Some(travel),
        ..plant()
    };
    for (positive, reference) in [(true, -0.5), (false, 0.5)] {
        let mut bench = with(on_it, 4, positive);
        near(home(&mut bench).0, reference);
    }
}

#[test]
fn zero_angles_and_index_without_any_switch() {
    for (mode, positive, reference) in [
        (7, true, 0.0),
        (11, true, 0.25),
        (11, false, -0.75),
        (15, true, 0.0),
    ] {
        let mut bench = bench(mode, positive);
        near(home(&mut bench).0, reference);
    }
    // From 0.7: the nearest zero is 1, the next one in negative direction 0.
    for (mode, positive, reference) in [(7, false, 1.0), (15, true, 1.0), (15, false, 0.0)] {
        let mut bench = bench(0, true);
        home(&mut bench);
        bench.mdi(0.7, 600.0, 20, true);
        bench.send(READY, 1);
        bench.send(READY | 0x40, 1);
        bench.until(READY, 0x0400, 0x0400);
        bench.send(READY, 1);
        bench.write("HOME.MODE", mode);
        bench.write("HOME.DIR", i64::from(positive));
        near(home(&mut bench).0, reference);
    }
}

#[test]
fn to_a_hard_stop_with_little_current() {
    for (mode, positive, reference) in [(8, true, 5.0), (8, false, -5.0), (9, true, 5.0), (10, true, 4.25)] {
        let mut stops = plant().travel.unwrap();
        stops.negative_switch = i64::MIN;
        stops.positive_switch = i64::MAX;
        let mut bench = with(
            Plant {
                travel: Some(stops),
                ..plant()
            },
            mode,
            positive,
        );
        bench.send(HOME, 2);
        let mut most: f64 = 0.0;
        while bench.status() & 0x0800 == 0 {
            bench.send(HOME, 1);
            if bench.drive.positioning.is_gentle() {
                most = most.max(bench.drive.axis().current().abs());
            }
        }
        assert!(most <= 0.9 + 1e-9, "HOME.IPEAK: {most}");
        bench.send(HOME, 20);
        let found = bench.drive.axis().feedback() as f64 / REVOLUTION;
        assert!((found - reference).abs() < 0.03, "{mode} {found}");
        does_not_press(&mut bench, HOME);
        assert_eq!(bench.status() & 0x2F00, 0x2F00, "homed, in range");
    }
}

/// For 15 s the axis lies at the stop without the current of homing.
#[track_caller]
fn does_not_press(bench: &mut Bench, control: u16) {
    let before = bench.turns();
    for cycle in 0..15_000 / 4 {
        let word = bench.send(control, 1);
        let current = bench.drive.axis().current().abs();
        assert!(current < 0.9, "{current} A after {cycle} cycles");
        assert_eq!(word & 0x0008, 0, "fault after {cycle} cycles");
    }
    assert!((bench.turns() - before).abs() < 0.01);
}

#[test]
fn homing_that_ends_at_a_hard_stop_before_its_time_does_not_press_either() {
    let mut stops = plant().travel.unwrap();
    stops.negative_switch = i64::MIN;
    stops.positive_switch = i64::MAX;
    stops.home_switch = None;
    let plant = Plant {
        travel: Some(stops),
        ..plant()
    };
    for positive in [true, false] {
        // no switch between the stops
        let mut bench = with(plant, 12, positive);
        bench.until(HOME, 0x2080, 0x2080);
        assert!(bench.warned(158));
        does_not_press(&mut bench, HOME);
        // aborted while it presses
        let mut bench = with(plant, 8, positive);
        bench.write("HOME.PERRTHRESH", 65_536 / 2);
        bench.send(HOME, 2);
        while bench.drive.axis().following_error().abs() < TURN / 10 {
            bench.send(HOME, 1);
        }
        assert!(bench.drive.axis().current().abs() > 0.8, "it presses");
        bench.until(READY, 0x2000, 0x2000);
        does_not_press(&mut bench, READY);
        // farther than it may: brakes into the stop
        let mut bench = with(plant, 8, positive);
        bench.write("HOME.MAXDIST", 65_536 * 5 - 65_536 / 20);
        bench.until(HOME, 0x2080, 0x2080);
        assert!(bench.warned(161));
        does_not_press(&mut bench, HOME);
    }
}

#[test]
fn between_stops_the_home_switch_is_found() {
    let mut travel = plant().travel.unwrap();
    travel.negative_switch = i64::MIN;
    travel.positive_switch = i64::MAX;
    for (positive, reference) in [(true, 1.0), (false, 1.5)] {
        let mut bench = with(
            Plant {
                travel: Some(travel),
                ..plant()
            },
            12,
            positive,
        );
        near(home(&mut bench).0, reference);
    }
}

#[test]
fn the_home_point_has_its_number_and_an_extra_move() {
    let mut bench = bench(4, true);
    bench.write("HOME.P", -3 * 65_536);
    bench.write("HOME.DIST", 65_536 / 2);
    let (reference, there) = home(&mut bench);
    near(reference, 1.0);
    near(there, 1.5);
    assert!((bench.read("PL.FB") + 3 * 65_536 - 32_768).abs() < 100);
    assert!((bench.read("XIST_A") + 3 * 65_536 - 32_768).abs() < 100);
    // The feedback itself is not moved by it.
    assert!((bench.read("FB1.P") - 98_304).abs() < 100);
}

#[test]
fn a_home_switch_not_found_is_reported() {
    let nothing = Plant {
        travel: None,
        ..plant()
    };
    let fails = |mut bench: Bench, number: u16| {
        bench.until(HOME, 0x2080, 0x2080);
        assert!(bench.warned(number), "{number}");
        assert_eq!(bench.status() & 0x0800, 0);
        assert_eq!(bench.read("DRV.MOTIONSTAT") & 0b11110, 0b10000);
    };
    // Both limits and no home switch between them.
    let mut travel = plant().travel.unwrap();
    travel.home_switch = None;
    fails(
        with(
            Plant {
                travel: Some(travel),
                ..plant()
            },
            4,
            true,
        ),
        158,
    );
    // Farther than HOME.MAXDIST.
    let mut far = with(nothing, 4, true);
    far.write("HOME.MAXDIST", 2 * 65_536);
    fails(far, 161);
    // A limit switch on the way to the index.
    let mut travel = plant().travel.unwrap();
    travel.positive_switch = TURN / 8;
    fails(
        with(
            Plant {
                travel: Some(travel),
                ..plant()
            },
            11,
            true,
        ),
        161,
    );
    // Nor does the way to a zero angle lead on into a limit switch that is hit already.
    for mode in [7, 15] {
        let mut travel = plant().travel.unwrap();
        travel.positive_switch = -TURN / 8;
        let plant = Plant {
            travel: Some(travel),
            ..plant()
        };
        let mut bench = with(plant, mode, true);
        // away from a zero angle, but nearer to the one ahead
        bench.drive.axis.set_plant(Plant {
            travel: None,
            ..plant
        });
        bench.write("HOME.MODE", 0);
        bench.send(HOME, 2);
        bench.send(READY, 2);
        bench.task(1, 0.75, 600.0, 6000.0, 0);
        bench.set(signal::SATZANW, 1);
        bench.until(START, 0x0400, 0x0400);
        bench.send(READY, 30);
        bench.drive.axis.set_plant(plant);
        bench.write("HOME.MODE", mode);
        let before = bench.turns();
        bench.until(HOME, 0x2080, 0x2080);
        assert!(
            bench.warned(161) && (bench.turns() - before).abs() < 0.01,
            "{before} {}",
            bench.turns()
        );
    }
    // Mode 14 is not known: homing does not begin.
    let mut bench = with(plant(), 14, true);
    bench.send(HOME, 5);
    assert_eq!(bench.status() & 0x2800, 0x2000);
    assert!(bench.warned(161));
    assert!(bench.try_write("HOME.MOVE", 1).is_err());
}

#[test]
fn abort_by_the_bit_and_by_commands() {
    let mut bench = bench(4, false);
    bench.send(HOME, 60);
    assert!(bench.pace() < -200.0);
    bench.send(READY, 5);
    assert!(bench.pace() > -270.0, "brakes on HOME.DEC");
    bench.until(READY, 0x2000, 0x2000);
    assert_eq!(bench.status() & 0x0C00, 0);
    assert_eq!(bench.read("DRV.MOTIONSTAT") & 0b11110, 0);
    bench.send(READY, 1);
    bench.write("HOME.MOVE", 1);
    bench.send(READY, 20);
    assert_eq!(bench.read("DRV.MOTIONSTAT") & 0b01000, 0b01000);
    bench.write("DRV.STOP", 1);
    bench.until(READY, 0x2000, 0x2000);
    assert_eq!(bench.status() & 0x0800, 0);
    // Not while a task runs.
    bench.write("HOME.SET", 1);
    bench.send(READY, 2);
    bench.mdi(1.0, 60.0, 4, true);
    bench.send(READY | 0x40, 20);
    let word = bench.send(HOME | 0x40, 20);
    assert_eq!(word & 0x4800, 0x4800, "{word:04X}");
    assert!(bench.try_write("HOME.SET", 1).is_err() && bench.try_write("HOME.MOVE", 1).is_err());
}

#[test]
fn automatic_homing_when_enabled() {
    let mut bench = Bench::with(9, plant());
    bench.write("HOME.MODE", 4);
    bench.write("HOME.AUTOMOVE", 1);
    bench.enable();
    bench.until(READY, 0x0800, 0x0800);
    bench.send(0x0430, 3);
    bench.enable();
    assert_eq!(bench.status() & 0x0800, 0x0800, "homed already: nothing moves");
    bench.send(READY, 20);
    assert_eq!(bench.status() & 0x2800, 0x2800);
}
