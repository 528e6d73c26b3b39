//! Invariants of the axis under position control for any command.

use proptest::prelude::*;

use super::*;

const REV: i64 = 1 << 32;

fn to(target: i64, speed: f64) -> Command {
    Command::Position {
        target,
        speed,
        ramps: Ramps {
            acceleration: 3000.0,
            deceleration: 3000.0,
        },
        smooth: false,
        end_speed: 0.0,
    }
}

fn run(axis: &mut Axis, seconds: f64, command: Command) {
    for _ in 0..(seconds / 0.001).round() as usize {
        axis.step(0.001, command, &Tuning::default());
    }
}

fn revolutions(counts: i64) -> f64 {
    counts as f64 / plant::REVOLUTION
}

fn odd() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(0.0),
        any::<f64>(),
        -5000.0..5000.0_f64,
        0.0..100.0_f64,
    ]
}

fn commands() -> impl Strategy<Value = Command> {
    let ramps = || {
        (odd(), odd()).prop_map(|(acceleration, deceleration)| Ramps {
            acceleration,
            deceleration,
        })
    };
    prop_oneof![
        Just(Command::Off),
        odd().prop_map(|target| Command::Current { target }),
        (odd(), proptest::option::of(ramps()), any::<bool>())
            .prop_map(|(target, ramp, hold)| Command::Speed { target, ramp, hold }),
        (any::<i64>(), odd(), ramps(), any::<bool>(), odd()).prop_map(
            |(target, speed, ramps, smooth, end_speed)| Command::Position {
                target,
                speed,
                ramps,
                smooth,
                end_speed,
            }
        ),
        (odd(), ramps(), any::<bool>()).prop_map(|(speed, ramps, smooth)| Command::Travel {
            speed,
            ramps,
            smooth
        }),
    ]
}

proptest! {
    /// The predicted stop position is reached.
    #[test]
    fn it_stops_at_the_planned_position(
        speed in -2900.0..2900.0_f64,
        acceleration in 100.0..30_000.0_f64,
        deceleration in 100.0..30_000.0_f64,
        began_smooth in any::<bool>(),
        smooth in any::<bool>(),
        steps in 0_usize..400,
        closed in any::<bool>(),
    ) {
        let mut axis = Axis::new(Plant::default());
        let ramps = Ramps { acceleration, deceleration };
        let tuning = Tuning::default();
        for _ in 0..steps {
            if closed {
                axis.step(0.001, Command::Travel { speed, ramps, smooth: began_smooth }, &tuning);
            } else {
                axis.step(0.001, Command::Speed { target: speed, ramp: Some(ramps), hold: false }, &tuning);
            }
        }
        let expected = axis.stopping_position(ramps, smooth, &tuning);
        // A reference that begins with the next step begins where the axis is then.
        let slack = if closed { 4 } else { REV / 10 };
        for _ in 0..40_000 {
            axis.step(0.001, Command::Travel { speed: 0.0, ramps, smooth }, &tuning);
            if axis.trajectory_done() {
                break;
            }
        }
        prop_assert!(axis.trajectory_done());
        prop_assert!((axis.position_command() - expected).abs() <= slack, "{}", axis.position_command() - expected);
    }

    /// What the axis does, and not only its reference: speeds a little above what was set at most, no lasting error,
    /// the same way every time.
    #[test]
    fn the_axis_does_as_the_reference(
        tasks in proptest::collection::vec(
            (-30 * REV..30 * REV, 1.0..2900.0_f64, 10.0..20_000.0_f64, 10.0..20_000.0_f64, any::<bool>(), 1_usize..600),
            1..8,
        ),
        load in -2.0..2.0_f64,
    ) {
        let mut axis = Axis::new(Plant::default());
        axis.set_load(load);
        run(&mut axis, 0.5, to(0, 10.0));
        let mut twin = axis.clone();
        let mut top = 0.0_f64;
        for (target, speed, acceleration, deceleration, smooth, steps) in tasks {
            let ramps = Ramps { acceleration, deceleration };
            let command = Command::Position { target, speed, ramps, smooth, end_speed: 0.0 };
            top = top.max(speed);
            for _ in 0..steps {
                axis.step(0.001, command, &Tuning::default());
                twin.step(0.001, command, &Tuning::default());
                // Ramps up to 20,000 rpm/s take 0.9 A of the 9 A, so it can follow.
                // A jerk limit lets the speed grow while the acceleration ends: 0.05 s of 20,000 rpm/s, halved.
                let grows = if smooth { 500.0 } else { 0.0 };
                prop_assert!(axis.speed().abs() < top + grows + 20.0, "{} of {}", axis.speed(), top);
                top = top.max(axis.trajectory_speed().abs());
                prop_assert!(revolutions(axis.following_error()).abs() < 0.01);
            }
        }
        prop_assert_eq!(axis.position(), twin.position());
        let last = axis.position_command();
        run(&mut axis, 1.0, to(last, 0.0));
        run(&mut axis, 6.0, to(last, 2900.0));
        prop_assert!(revolutions(axis.position() - last).abs() < 1e-4);
    }

    /// Whatever the gains are, the loops are stable: after a move and a load step the axis calms down where it shall be.
    #[test]
    fn all_gains_are_stable(
        gain in 0.02..50.0_f64,
        integral in 0.5..500.0_f64,
        position_gain in 5.0..10_000.0_f64,
        position_integral in prop_oneof![Just(0.0), 0.1..100.0_f64],
        speed_forward in 0.0..2.0_f64,
        inertia in 0.5e-4..50.0e-4_f64,
        seconds in 0.0005..0.016_f64,
    ) {
        let mut axis = Axis::new(Plant { load_inertia: inertia, ..Plant::default() });
        let tuning = Tuning {
            gain, integral, position_gain, position_integral, speed_forward,
            ..Tuning::default()
        };
        axis.set_load(0.5);
        let mut time = 0.0;
        while time < 20.0 {
            axis.step(seconds, to(3 * REV, 300.0), &tuning);
            time += seconds;
        }
        for _ in 0..100 {
            axis.step(seconds, to(3 * REV, 300.0), &tuning);
            prop_assert!(revolutions(axis.following_error()).abs() < 0.003, "{}", revolutions(axis.following_error()));
            prop_assert!(axis.speed().abs() < 20.0, "{}", axis.speed());
        }
    }

    /// No input makes it panic or puts something that is not a number into it, and the current keeps its limits.
    #[test]
    fn nothing_breaks_it(
        steps in proptest::collection::vec((commands(), odd(), any::<i64>(), odd()), 1..20),
        gains in (odd(), odd(), odd(), odd(), odd(), odd()),
    ) {
        let mut axis = Axis::new(Plant::default());
        let tuning = Tuning {
            gain: gains.0,
            integral: gains.1,
            position_gain: gains.2,
            position_integral: gains.3,
            speed_forward: gains.4,
            smoothing: gains.5,
            ..Tuning::default()
        };
        for (command, load, position, knob) in steps {
            axis.set_load(load.clamp(-10.0, 10.0));
            axis.set_mains(Some(knob));
            for seconds in [0.0007, 0.016, knob] {
                axis.step(seconds.min(0.05), command, &tuning);
                prop_assert!(axis.current().abs() <= 9.0, "{}", axis.current());
                prop_assert!(axis.speed().is_finite() && axis.speed_command().is_finite());
                prop_assert!(axis.electrical().bus_voltage().is_finite());
                prop_assert!(axis.trajectory_speed().is_finite());
            }
            axis.set_position(position);
        }
        // It still follows commands.
        axis.set_load(0.0);
        axis.set_mains(None);
        axis.rest(1000.0, &Tuning::default());
        for _ in 0..40_000 {
            axis.step(0.001, Command::Off, &Tuning::default());
            if axis.is_at_rest() {
                break;
            }
        }
        prop_assert!(axis.is_at_rest(), "{}", axis.speed());
        let target = axis.position().wrapping_add(REV);
        run(&mut axis, 2.0, to(target, 600.0));
        prop_assert!(axis.trajectory_done());
        prop_assert!(revolutions(axis.following_error()).abs() < 1e-3);
    }
}
