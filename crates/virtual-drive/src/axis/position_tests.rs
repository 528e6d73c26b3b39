//! The axis under position control, and what stands in its way.

use super::plant::REVOLUTION;
use super::*;

const REV: i64 = 1 << 32;
const RAMPS: Ramps = Ramps {
    acceleration: 3000.0,
    deceleration: 3000.0,
};

fn to(target: i64, speed: f64) -> Command {
    Command::Position {
        target,
        speed,
        ramps: RAMPS,
        smooth: false,
        end_speed: 0.0,
    }
}

fn travel(speed: f64) -> Command {
    Command::Travel {
        speed,
        ramps: RAMPS,
        smooth: false,
    }
}

fn run(axis: &mut Axis, seconds: f64, command: Command) {
    for _ in 0..(seconds / 0.001).round() as usize {
        axis.step(0.001, command, &Tuning::default());
    }
}

fn revolutions(counts: i64) -> f64 {
    counts as f64 / REVOLUTION
}

#[test]
fn goes_there_with_a_small_following_error_and_stays() {
    for smooth in [false, true] {
        let mut axis = Axis::new(Plant::default());
        let command = Command::Position {
            target: 20 * REV,
            speed: 2000.0,
            ramps: RAMPS,
            smooth,
            end_speed: 0.0,
        };
        let mut worst = 0.0_f64;
        let mut steps = 0;
        while !axis.trajectory_done() {
            run(&mut axis, 0.001, command);
            worst = worst.max(revolutions(axis.following_error()).abs());
            steps += 1;
            assert!(steps < 5000);
        }
        assert!(worst > 1e-6 && worst < 0.002, "{worst}");
        assert_eq!(axis.position_command(), 20 * REV);
        run(&mut axis, 0.2, command);
        let mut furthest = 0.0_f64;
        for _ in 0..2000 {
            run(&mut axis, 0.001, command);
            furthest = furthest.max(revolutions(axis.position() - 20 * REV).abs());
        }
        assert!(furthest < 1e-4, "{furthest}");
    }
}

#[test]
fn without_feed_forward_the_error_is_the_speed_over_the_gain() {
    let mut axis = Axis::new(Plant::default());
    let tuning = Tuning {
        speed_forward: 0.0,
        position_gain: 50.0,
        ..Tuning::default()
    };
    for _ in 0..1000 {
        axis.step(0.001, travel(1200.0), &tuning);
    }
    // 20 rev/s over 50 (rev/s)/rev
    let error = revolutions(axis.following_error());
    assert!((error - 0.4).abs() < 0.002, "{error}");
}

#[test]
fn holds_its_place_against_a_load() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 0.1, travel(0.0));
    axis.set_load(3.0);
    let mut furthest = 0.0_f64;
    for _ in 0..500 {
        run(&mut axis, 0.001, travel(0.0));
        furthest = furthest.max(revolutions(axis.position()).abs());
    }
    assert!(furthest > 0.001 && furthest < 0.05, "{furthest}");
    run(&mut axis, 1.0, travel(0.0));
    assert!(revolutions(axis.position()).abs() < 1e-4);
    assert!((axis.current() - 3.0 / 0.85).abs() < 0.1);
}

#[test]
fn blocked_the_error_grows_and_the_current_goes_to_its_limit() {
    let mut axis = Axis::new(Plant::default());
    axis.set_blocked(true);
    run(&mut axis, 0.5, to(10 * REV, 300.0));
    let place = axis.position();
    // 0.1 s of ramp and 0.4 s at 5 rev/s
    assert!((revolutions(axis.following_error()) - 2.25).abs() < 0.02);
    assert!((axis.current() - 9.0).abs() < 1e-9);
    assert_eq!((axis.speed(), place), (0.0, 0));
    axis.set_blocked(false);
    run(&mut axis, 4.0, to(10 * REV, 300.0));
    assert!(revolutions(axis.following_error()).abs() < 1e-4);
}

#[test]
fn switching_between_the_modes_makes_no_jump() {
    let mut axis = Axis::new(Plant::default());
    let speed = Command::Speed {
        target: 600.0,
        ramp: Some(RAMPS),
        hold: false,
    };
    run(&mut axis, 0.5, speed);
    let commands = [
        travel(600.0),
        speed,
        to(axis.position() + 100 * REV, 600.0),
        speed,
        Command::Off,
        travel(600.0),
    ];
    for command in commands {
        for _ in 0..if command == Command::Off { 10 } else { 100 } {
            run(&mut axis, 0.001, command);
            assert!(axis.current().abs() < 1.5, "{command:?} {}", axis.current());
            if command != Command::Off {
                assert!(
                    (axis.speed() - 600.0).abs() < 60.0,
                    "{command:?} {}",
                    axis.speed()
                );
            }
            assert!(revolutions(axis.following_error()).abs() < 0.05);
        }
    }
}

#[test]
fn a_hard_stop_holds_and_switches_and_index_are_seen() {
    let plant = Plant {
        travel: Some(Travel {
            negative_stop: -3 * REV,
            positive_stop: 3 * REV,
            negative_switch: -2 * REV,
            positive_switch: 2 * REV,
            home_switch: Some((REV / 4, REV / 2)),
        }),
        index: 1 << 30,
        ..Plant::default()
    };
    let mut axis = Axis::new(plant);
    assert_eq!(axis.inputs(), Inputs::default());
    run(&mut axis, 2.0, travel(300.0));
    let inputs = axis.inputs();
    assert!(inputs.limit_positive && !inputs.limit_negative && !inputs.home_switch);
    assert_eq!(axis.position(), 3 * REV);
    assert_eq!(axis.speed(), 0.0);
    assert!(revolutions(axis.following_error()) > 3.0);
    assert_eq!(
        (inputs.index.position, inputs.index.count),
        (2 * REV + REV / 4, 3)
    );
    assert_eq!((inputs.home_edge.position, inputs.home_edge.count), (REV / 2, 2));
    assert_eq!(
        (inputs.positive_edge.position, inputs.positive_edge.count),
        (2 * REV, 1)
    );
    // Leaving it: the error of the reference must be cleared first, as when the power stage goes off.
    run(&mut axis, 0.01, Command::Off);
    run(&mut axis, 3.0, travel(-300.0));
    let inputs = axis.inputs();
    assert!(inputs.limit_negative && !inputs.limit_positive);
    assert_eq!(axis.position(), -3 * REV);
    assert_eq!(inputs.index.position, -3 * REV + REV / 4);
    assert_eq!(inputs.negative_edge.position, -2 * REV);
    // Homing on the switch: its edge gets the number 1000.
    axis.shift_position(1000 - inputs.negative_edge.position);
    assert_eq!(axis.inputs().negative_edge.position, 1000);
    assert_eq!(axis.position(), 1000 - REV);
    assert_eq!(axis.feedback(), -3 * REV);
}

#[test]
fn set_position_moves_nothing() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 1.0, to(REV, 300.0));
    let (error, feedback) = (axis.following_error(), axis.feedback());
    axis.set_position(i64::MIN + 7);
    assert_eq!(axis.position(), i64::MIN + 7);
    assert_eq!((axis.following_error(), axis.feedback()), (error, feedback));
    let target = axis.position_command();
    assert!(axis.trajectory_done());
    run(&mut axis, 0.5, to(target, 300.0));
    assert!(revolutions(axis.feedback() - feedback).abs() < 1e-4);
}

#[test]
fn forced_switches_read_the_forced_state() {
    let mut axis = Axis::new(Plant::default());
    axis.set_limit_switch(true, Some(true));
    axis.set_home_switch(Some(true));
    let inputs = axis.inputs();
    assert!(inputs.limit_positive && inputs.home_switch && !inputs.limit_negative);
    assert_eq!((inputs.positive_edge.count, inputs.home_edge.count), (1, 1));
    axis.set_limit_switch(true, None);
    axis.set_home_switch(None);
    let inputs = axis.inputs();
    assert!(!inputs.limit_positive && !inputs.home_switch);
}

#[test]
fn the_brake_holds_what_would_fall() {
    let mut axis = Axis::new(Plant::default());
    axis.set_brake(true);
    axis.set_load(3.0);
    run(&mut axis, 1.0, Command::Off);
    assert_eq!(axis.position(), 0);
    assert!(axis.is_at_rest() && axis.inputs().brake);
    axis.set_brake(false);
    assert!(!axis.is_at_rest());
    run(&mut axis, 0.1, Command::Off);
    assert!(axis.speed() < -100.0);
    axis.set_brake(true);
    run(&mut axis, 1.0, Command::Off);
    assert!(axis.is_at_rest());
}

#[test]
fn at_rest_nothing_flows_and_nothing_is_wanted() {
    let mut axis = Axis::new(Plant::default());
    axis.set_blocked(true);
    run(&mut axis, 0.2, to(REV, 300.0));
    assert!(axis.current() > 1.0 && axis.following_error() > REV / 4);
    axis.rest(0.001, &Tuning::default());
    assert_eq!((axis.current(), axis.following_error()), (0.0, 0));
    assert_eq!(
        (axis.measured_speed(), axis.filtered_speed(), axis.speed_command()),
        (0.0, 0.0, 0.0)
    );
    assert!(!axis.trajectory_done());
    axis.set_blocked(false);
    run(&mut axis, 0.5, travel(0.0));
    assert!(
        revolutions(axis.position()).abs() < 1e-4,
        "it does not jump to an old target"
    );
}

#[test]
fn sto_takes_the_torque() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 0.5, travel(600.0));
    axis.set_sto(true);
    run(&mut axis, 0.1, travel(600.0));
    assert_eq!((axis.current(), axis.inputs().sto), (0.0, true));
    assert!(axis.speed() < 590.0 && !axis.trajectory_done());
    axis.set_sto(false);
    run(&mut axis, 0.5, travel(600.0));
    assert!((axis.speed() - 600.0).abs() < 2.0);
}

#[test]
fn lost_feedback_reads_the_same_for_ever_and_the_axis_runs_away() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 0.5, travel(600.0));
    axis.set_feedback_lost(true);
    let (position, measured) = (axis.position(), axis.measured_speed());
    run(&mut axis, 0.1, travel(600.0));
    assert_eq!((axis.position(), axis.measured_speed()), (position, measured));
    assert!(axis.following_error() > REV / 2 && axis.inputs().feedback_lost);
    assert!((axis.speed() - 600.0).abs() > 100.0, "{}", axis.speed());
    axis.set_feedback_lost(false);
    run(&mut axis, 0.001, Command::Off);
    assert!(axis.position() > position);
}

#[test]
fn the_feedback_resolves_its_bits() {
    let mut axis = Axis::new(Plant {
        feedback_bits: 10,
        ..Plant::default()
    });
    for _ in 0..500 {
        run(&mut axis, 0.001, to(5 * REV + REV / 3, 600.0));
        assert_eq!(axis.position() & (REV / 1024 - 1), 0);
    }
    run(&mut axis, 2.0, to(5 * REV + REV / 3, 600.0));
    assert!(revolutions(axis.following_error()).abs() < 2.0 / 1024.0);
}

#[test]
fn foldback_brings_peak_current_down_to_continuous_and_recovers() {
    let mut axis = Axis::new(Plant::default());
    let push = Command::Current { target: 9.0 };
    axis.set_blocked(true);
    run(&mut axis, 4.5, push);
    assert_eq!(axis.current(), 9.0);
    assert!(!axis.electrical().is_folding_back());
    run(&mut axis, 25.0, push);
    assert!(axis.electrical().is_folding_back());
    assert!((axis.current() - 3.0).abs() < 0.01, "{}", axis.current());
    let electrical = *axis.electrical();
    assert!(electrical.drive_load() > 0.95 && electrical.drive_load() <= 1.0);
    assert!((electrical.foldback_limit() - electrical.drive_foldback_limit()).abs() < 1e-9);
    assert!(electrical.motor_load() > 0.25 && electrical.motor_load() < 0.5);
    assert_eq!(electrical.motor_foldback_limit(), 11.2);
    // The motor endures a little less than the drive, and longer.
    run(&mut axis, 800.0, push);
    assert!((axis.current() - 2.79).abs() < 0.02, "{}", axis.current());
    axis.rest(10.0, &Tuning::default());
    assert!(axis.electrical().drive_load() < 0.8);
    axis.rest(200.0, &Tuning::default());
    assert_eq!(
        (axis.electrical().motor_load(), axis.electrical().drive_load()),
        (0.0, 0.0)
    );
    run(&mut axis, 1.0, push);
    assert_eq!(axis.current(), 9.0);
}

#[test]
fn mains_regen_and_overrides() {
    let mut axis = Axis::new(Plant::default());
    let volts = |axis: &Axis| axis.electrical().bus_voltage();
    assert!((volts(&axis) - 325.0).abs() < 1.0);
    axis.set_mains(Some(0.0));
    run(&mut axis, 0.2, Command::Off);
    assert!(volts(&axis) < 320.0 && volts(&axis) > 250.0, "{}", volts(&axis));
    axis.rest(10.0, &Tuning::default());
    assert_eq!(volts(&axis), 0.0);
    run(&mut axis, 0.1, Command::Current { target: 3.0 });
    assert_eq!(axis.current(), 0.0);
    axis.set_mains(Some(260.0));
    run(&mut axis, 0.2, Command::Off);
    assert!((volts(&axis) - 367.0).abs() < 3.0);
    axis.set_mains(None);
    axis.rest(10.0, &Tuning::default());
    assert!((volts(&axis) - 325.0).abs() < 3.0);
    // Braking from full speed stays below the fault level of 420 V with the resistor and exceeds it without.
    let mut highest = [0.0_f64; 2];
    for (highest, regen) in highest.iter_mut().zip([true, false]) {
        axis.set_regen(regen);
        axis.set_plant(Plant {
            load_inertia: 8.0e-4,
            ..Plant::default()
        });
        run(&mut axis, 2.5, travel(3000.0));
        for _ in 0..300 {
            axis.step(
                0.001,
                Command::Speed {
                    target: -3000.0,
                    ramp: None,
                    hold: false,
                },
                &Tuning::default(),
            );
            *highest = highest.max(volts(&axis));
        }
    }
    assert!(highest[0] > 375.0 && highest[0] < 400.0, "{highest:?}");
    assert!(highest[1] > 420.0, "{highest:?}");
    axis.set_bus_voltage(Some(500.0));
    axis.set_motor_temperature(Some(180.0));
    axis.set_power_stage_temperature(Some(99.0));
    assert_eq!(volts(&axis), 500.0);
    assert_eq!(axis.electrical().motor_temperature(), 180.0);
    assert_eq!(axis.electrical().power_stage_temperature(), 99.0);
    axis.set_motor_temperature(None);
    assert!(axis.electrical().motor_temperature() < 60.0);
}

#[test]
fn prepared_steps_are_the_same_steps() {
    let (mut prepared, mut single) = (Axis::new(Plant::default()), Axis::new(Plant::default()));
    let tuning = Tuning::default();
    let mut stride = prepared.stride(0.001, &tuning);
    let targets = [REV, -REV, 2 * REV];
    let mut task = 0;
    for _ in 0..3200 {
        let command = to(targets[task], 600.0);
        prepared.steps_by(&mut stride, command, 1, false);
        single.step(0.001, command, &tuning);
        assert_eq!(prepared.position(), single.position());
        if single.trajectory_done() {
            task = (task + 1).min(targets.len() - 1);
        }
    }
    assert_eq!(task, 2);
    assert_eq!(single.position_command(), 2 * REV);
}

#[test]
fn the_length_of_the_call_changes_nothing() {
    let mut fine = Axis::new(Plant::default());
    let mut coarse = Axis::new(Plant::default());
    let command = Command::Position {
        target: 3 * REV,
        speed: 400.0,
        ramps: RAMPS,
        smooth: true,
        end_speed: 0.0,
    };
    run(&mut fine, 1.6, command);
    for _ in 0..100 {
        coarse.step(0.016, command, &Tuning::default());
    }
    assert_eq!(fine.position(), coarse.position());
    assert_eq!(fine.position_command(), coarse.position_command());
}

#[test]
fn a_blended_movement_keeps_its_speed_over_the_target() {
    let mut axis = Axis::new(Plant::default());
    let blend = Command::Position {
        target: 5 * REV,
        speed: 600.0,
        ramps: RAMPS,
        smooth: false,
        end_speed: 600.0,
    };
    run(&mut axis, 0.25, blend);
    while !axis.trajectory_done() {
        run(&mut axis, 0.001, blend);
        assert!((axis.speed() - 600.0).abs() < 5.0, "{}", axis.speed());
    }
    for _ in 0..300 {
        run(&mut axis, 0.001, to(10 * REV, 600.0));
        assert!((axis.speed() - 600.0).abs() < 5.0, "{}", axis.speed());
    }
    run(&mut axis, 1.0, to(10 * REV, 600.0));
    assert_eq!(axis.position_command(), 10 * REV);
}

#[test]
fn what_is_no_number_moves_nothing() {
    let mut axis = Axis::new(Plant::default());
    let nan = Ramps {
        acceleration: f64::NAN,
        deceleration: f64::NAN,
    };
    for command in [
        Command::Current { target: f64::NAN },
        Command::Speed {
            target: f64::NAN,
            ramp: Some(RAMPS),
            hold: false,
        },
        travel(f64::NAN),
        to(REV, f64::NAN),
        Command::Travel {
            speed: f64::NAN,
            ramps: nan,
            smooth: true,
        },
    ] {
        run(&mut axis, 0.1, command);
        assert_eq!(axis.position(), 0, "{command:?}");
    }
}
