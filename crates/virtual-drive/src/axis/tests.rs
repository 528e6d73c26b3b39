//! Physics that a servo engineer would check with a scope.

use super::plant::REVOLUTION;
use super::*;

const RAMPS: Option<Ramps> = Some(Ramps {
    acceleration: 3000.0,
    deceleration: 3000.0,
});

fn speed(target: f64) -> Command {
    Command::Speed {
        target,
        ramp: RAMPS,
        hold: false,
    }
}

fn run(axis: &mut Axis, seconds: f64, command: Command) {
    for _ in 0..(seconds / 0.001).round() as usize {
        axis.step(0.001, command, &Tuning::default());
    }
}

#[test]
fn follows_sixty_rpm_within_a_believable_error() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 0.5, speed(60.0));
    let mut lowest = f64::MAX;
    let mut highest = f64::MIN;
    let mut sum = 0.0;
    for _ in 0..1000 {
        run(&mut axis, 0.001, speed(60.0));
        lowest = lowest.min(axis.measured_speed());
        highest = highest.max(axis.measured_speed());
        sum += axis.measured_speed();
    }
    assert!((sum / 1000.0 - 60.0).abs() < 0.02, "mean {}", sum / 1000.0);
    assert!(lowest > 59.0 && highest < 61.0, "{lowest}..{highest}");
    assert!(highest - lowest > 0.05, "no ripple at all is not believable");
}

#[test]
fn the_ramp_is_followed_while_accelerating() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 0.1, speed(3000.0));
    assert!((axis.speed_command() - 300.0).abs() < 1e-6);
    assert!((axis.speed() - 300.0).abs() < 6.0, "{}", axis.speed());
}

#[test]
fn a_load_step_dips_the_speed_and_it_recovers() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 0.5, speed(500.0));
    let current = axis.current();
    axis.set_load(2.0);
    let mut lowest = f64::MAX;
    for _ in 0..50 {
        run(&mut axis, 0.001, speed(500.0));
        lowest = lowest.min(axis.speed());
    }
    assert!(lowest < 480.0 && lowest > 300.0, "dip to {lowest}");
    run(&mut axis, 1.0, speed(500.0));
    assert!((axis.speed() - 500.0).abs() < 1.0, "{}", axis.speed());
    assert!(
        (axis.current() - current - 2.0 / 0.85).abs() < 0.1,
        "load is carried by current: {}",
        axis.current()
    );
}

#[test]
fn the_current_limit_is_respected_and_stalls_the_axis_under_too_much_load() {
    let mut axis = Axis::new(Plant::default());
    let tuning = Tuning {
        current_positive: 3.0,
        ..Tuning::default()
    };
    let at_once = Command::Speed {
        target: 3000.0,
        ramp: None,
        hold: false,
    };
    for _ in 0..20 {
        axis.step(0.001, at_once, &tuning);
        assert!(axis.current() <= 3.0 && axis.current() >= -9.0);
    }
    // 3 A * 0.85 Nm/A - friction on 3.6e-4 kg m^2 for 20 ms
    let expected = (3.0 * 0.85 - 0.05) / 3.6e-4 * 0.02 * RPM;
    assert!(
        (axis.speed() - expected).abs() < 0.02 * expected,
        "{} {expected}",
        axis.speed()
    );
    axis.set_load(4.0);
    for _ in 0..3000 {
        axis.step(0.001, at_once, &tuning);
        assert!(axis.current() <= 3.0);
    }
    assert!(axis.speed() < 0.0, "the load wins: {}", axis.speed());
}

/// What pulls harder than friction holds turns the shaft up to where its motor brakes it: not without end.
#[test]
fn a_load_that_overhauls_a_motor_is_braked_at_overspeed() {
    for (plant, load, speeds) in [
        // 380 V over sqrt(2/3) * 0.85 Vs: 5228 rpm
        (Plant::SERVO, 9.0, 5228.0..5600.0),
        (Plant::SERVO, 40.0, 5600.0..7000.0),
        (Plant::INDUCTION, 9.0, 3600.0..4000.0),
    ] {
        for sign in [1.0, -1.0] {
            let mut axis = Axis::new(plant);
            axis.set_load(sign * load);
            run(&mut axis, 10.0, Command::Off);
            let speed = -sign * axis.speed();
            assert!(speeds.contains(&speed), "{load} Nm: {speed} rpm");
            let bus = axis.electrical.true_bus();
            let servo = plant.motor == Motor::Servo;
            assert_eq!(bus > plant.power.chopper, servo, "{bus} V");
            run(&mut axis, 1.0, Command::Off);
            let later = -sign * axis.speed();
            assert!((later - speed).abs() < 0.01 * speed, "{speed} then {later} rpm");
            axis.set_load(0.0);
            run(&mut axis, 60.0, Command::Off);
            assert!(axis.speed().abs() < 1.0, "friction ends it: {} rpm", axis.speed());
        }
    }
}

#[test]
fn stops_on_the_ramp_in_the_right_time() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 1.0, speed(600.0));
    let mut time = 0;
    while !axis.is_standing(3.0) {
        run(&mut axis, 0.001, speed(0.0));
        time += 1;
        assert!(time < 1000);
    }
    assert!((190..=230).contains(&time), "{time} ms for 600 rpm at 3000 rpm/s");
}

#[test]
fn without_pulses_it_coasts_to_a_true_rest() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 0.5, speed(600.0));
    assert!(!axis.is_at_rest());
    run(&mut axis, 0.1, Command::Off);
    assert_eq!(axis.current(), 0.0);
    assert!(axis.speed() > 400.0 && axis.speed() < 600.0, "{}", axis.speed());
    run(&mut axis, 2.0, Command::Off);
    assert!(axis.is_at_rest());
    let position = axis.position();
    run(&mut axis, 1.0, Command::Off);
    assert_eq!(axis.position(), position);
}

#[test]
fn the_position_is_the_integral_of_the_speed() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 0.5, speed(60.0));
    let start = axis.position();
    run(&mut axis, 10.0, speed(60.0));
    let revolutions = (axis.position() - start) as f64 / REVOLUTION;
    assert!((revolutions - 10.0).abs() < 0.01, "{revolutions}");
}

#[test]
fn a_wild_gain_does_not_blow_up() {
    let mut axis = Axis::new(Plant::default());
    let tuning = Tuning {
        gain: 2_000_000.0,
        integral: 2_000_000.0,
        ..Tuning::default()
    };
    for _ in 0..2000 {
        axis.step(0.001, speed(60.0), &tuning);
        assert!(axis.speed().abs() < 500.0);
    }
}

#[test]
fn the_bus_rises_while_braking_and_the_drive_warms_up() {
    let mut axis = Axis::new(Plant::default());
    run(&mut axis, 1.2, speed(3000.0));
    let at_once = Command::Speed {
        target: 0.0,
        ramp: None,
        hold: false,
    };
    run(&mut axis, 0.005, at_once);
    let braking = axis.electrical().bus_voltage();
    assert!(braking > 330.0 && braking <= 400.0, "{braking}");
    axis.set_load(3.0);
    let cold = axis.electrical().motor_temperature();
    run(&mut axis, 60.0, speed(100.0));
    assert!(axis.electrical().motor_temperature() > cold + 1.0);
    assert!((axis.electrical().bus_voltage() - 325.0).abs() < 20.0);
}

#[test]
fn the_length_of_the_call_changes_little_and_time_is_bounded() {
    let mut fine = Axis::new(Plant::default());
    let mut coarse = Axis::new(Plant::default());
    for _ in 0..160 {
        fine.step(0.001, speed(300.0), &Tuning::default());
    }
    for _ in 0..10 {
        coarse.step(0.016, speed(300.0), &Tuning::default());
    }
    assert_eq!(
        fine.position(),
        coarse.position(),
        "the same steps give the same numbers"
    );
    coarse.step(3600.0, speed(300.0), &Tuning::default());
    coarse.step(f64::NAN, speed(300.0), &Tuning::default());
    coarse.step(-1.0, speed(300.0), &Tuning::default());
    assert!((coarse.speed() - 300.0).abs() < 1.0);
}

/// Every bit of a servo's way through all commands. It changes only when the servo itself is changed. On its way its load turns it
/// beyond overspeed while it is off: without what brakes it there, it moves as before there was that.
#[test]
fn the_servo_moves_as_ever() {
    let mut free = Axis::new(Plant::default());
    free.mechanics.forget_overspeed();
    let hash = way(free);
    assert_eq!(hash, 0x2915_69e3_8da4_3646, "{hash:#018x}");
    let hash = way(Axis::new(Plant::default()));
    assert_eq!(hash, 0x156f_5265_53dc_9f3f, "{hash:#018x}");
}

/// Returns a number that stands for each bit of the way of an axis through all commands.
fn way(mut axis: Axis) -> u64 {
    let ramps = RAMPS.unwrap();
    let turn = |target| Command::Position {
        target,
        speed: 1500.0,
        ramps,
        smooth: true,
        end_speed: 0.0,
    };
    let travel = Command::Travel {
        speed: -700.0,
        ramps,
        smooth: false,
    };
    let at_once = Command::Speed {
        target: -2500.0,
        ramp: None,
        hold: false,
    };
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    let commands = [speed(900.0), turn(40 << 32), travel, at_once, Command::Off];
    for (number, command) in commands
        .into_iter()
        .chain([Command::Current { target: 2.0 }])
        .enumerate()
    {
        axis.set_load([0.0, 1.5, -0.7][number % 3]);
        for _ in 0..700 {
            axis.step(0.0013, command, &Tuning::default());
            let electrical = axis.electrical();
            let values = [
                axis.position() as u64,
                axis.measured_speed().to_bits(),
                axis.current().to_bits(),
                electrical.bus_voltage().to_bits(),
                electrical.motor_temperature().to_bits(),
                electrical.power_stage_temperature().to_bits(),
            ];
            for value in values {
                hash = (hash ^ value).wrapping_mul(0x0100_0000_01B3);
            }
        }
        axis.set_mains((number == 3).then_some(180.0));
    }
    hash
}
