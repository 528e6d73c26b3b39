//! Known behaviour of an induction motor behind a frequency converter.

use core::f64::consts::TAU;

use proptest::prelude::*;

use super::*;

const NOMINAL: f64 = 3.4;
const TORQUE: f64 = 1500.0 / 1420.0 * RPM;

fn tuning() -> Tuning {
    let endurance = Endurance {
        continuous: NOMINAL,
        peak: 100.0,
        time: 1.0e6,
    };
    Tuning {
        current_positive: 1.6 * NOMINAL,
        current_negative: 1.6 * NOMINAL,
        drive_endurance: endurance,
        motor_endurance: endurance,
        ..Tuning::default()
    }
}

fn to(target: f64, slope: f64) -> Command {
    Command::Speed {
        target,
        ramp: Some(Ramps {
            acceleration: slope,
            deceleration: slope,
        }),
        hold: false,
    }
}

fn run(axis: &mut Axis, seconds: f64, command: Command, tuning: &Tuning) {
    for _ in 0..(seconds / 0.001).round() as usize {
        axis.step(0.001, command, tuning);
    }
}

fn motor() -> Axis {
    Axis::new(Plant::INDUCTION)
}

fn ideal() -> Axis {
    Axis::new(Plant {
        coulomb_friction: 0.0,
        viscous_friction: 0.0,
        ..Plant::INDUCTION
    })
}

fn near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected}");
}

#[test]
fn without_load_it_turns_at_the_synchronous_speed() {
    let mut axis = ideal();
    run(&mut axis, 5.0, to(1500.0, 500.0), &tuning());
    near(axis.speed(), 1500.0, 0.01);
    let output = axis.motor_output();
    near(output.frequency, 50.0, 1e-6);
    near(output.voltage, 400.0, 1e-6);
    near(output.current, 1.8, 0.001);
    near(axis.electrical().bus_voltage(), 565.7, 5.0);
    // Half the frequency, half the voltage, the same current; backwards, too.
    run(&mut axis, 8.0, to(-750.0, 500.0), &tuning());
    let output = axis.motor_output();
    near(output.frequency, -25.0, 1e-6);
    near(output.voltage, 200.0, 1e-6);
    near(output.current, 1.8, 0.001);
    near(axis.speed(), -750.0, 0.01);
}

#[test]
fn nominal_load_gives_nominal_slip_current_and_power() {
    let mut axis = ideal();
    run(&mut axis, 5.0, to(1500.0, 500.0), &tuning());
    axis.set_load(TORQUE);
    run(&mut axis, 2.0, to(1500.0, 500.0), &tuning());
    near(axis.speed(), 1420.0, 0.1);
    let output = axis.motor_output();
    near(output.current, NOMINAL, 0.01);
    near(output.torque, TORQUE, 0.001);
    near(output.torque * axis.speed() / RPM, 1500.0, 0.2);
    near(output.power, 1500.0 * 1500.0 / 1420.0, 0.2);
    assert!(!output.limited);
    // Driven by the load it turns faster than the field, by the same slip.
    axis.set_load(-TORQUE);
    axis.set_regen(true);
    run(&mut axis, 0.05, to(1500.0, 500.0), &tuning());
    run(&mut axis, 0.2, to(1500.0, 500.0), &tuning());
    near(axis.speed(), 1580.0, 0.1);
    assert!(axis.motor_output().power < 0.0);
}

#[test]
fn slip_compensation_brings_the_speed_back() {
    let tuning = Tuning {
        inverter: InverterTuning {
            slip_compensation: 1.0,
            ..InverterTuning::default()
        },
        ..tuning()
    };
    let mut axis = ideal();
    run(&mut axis, 5.0, to(1000.0, 500.0), &tuning);
    axis.set_load(TORQUE);
    run(&mut axis, 3.0, to(1000.0, 500.0), &tuning);
    near(axis.speed(), 1000.0, 0.5);
    near(axis.speed_command(), 1000.0, 1e-9);
    near(axis.motor_output().frequency, 1080.0 / 30.0, 0.05);
}

#[test]
fn put_on_the_mains_at_once_it_draws_several_times_its_current() {
    let free = Tuning {
        current_positive: 100.0,
        current_negative: 100.0,
        ..tuning()
    };
    let at_once = Command::Speed {
        target: 1500.0,
        ramp: None,
        hold: false,
    };
    let mut axis = motor();
    axis.step(0.001, at_once, &free);
    let start = axis.motor_output();
    assert!(
        (4.0..7.0).contains(&(start.current / NOMINAL)),
        "{}",
        start.current / NOMINAL
    );
    // With less torque than at its best, as such motors start.
    assert!(start.torque > TORQUE && start.torque < 2.8 * TORQUE);
    let mut best = 0.0_f64;
    for _ in 0..2000 {
        axis.step(0.001, at_once, &free);
        best = best.max(axis.motor_output().torque);
    }
    assert!(best > 2.6 * TORQUE && best <= 2.8 * TORQUE + 1e-6, "{best}");
    assert!(axis.speed() > 1490.0);
}

#[test]
fn the_ramp_waits_at_the_current_limit() {
    let mut axis = motor();
    let limit = 1.6 * NOMINAL;
    let mut limited = false;
    // 60,000 rpm/s would take eight times the torque.
    for _ in 0..60 {
        axis.step(0.001, to(1500.0, 60_000.0), &tuning());
        assert!(axis.current() <= limit + 1e-9);
        limited |= axis.motor_output().limited;
    }
    assert!(limited && axis.speed_command() < 1500.0);
    // The slip stays where the limit is, at more than the nominal torque.
    let slip = axis.speed_command() - axis.speed();
    assert!((80.0..250.0).contains(&slip), "{slip}");
    assert!(axis.motor_output().torque > 1.4 * TORQUE);
    run(&mut axis, 2.0, to(1500.0, 60_000.0), &tuning());
    assert!(!axis.motor_output().limited);
    near(axis.speed_command(), 1500.0, 1e-9);
    // Too much load: the speed comes down, and the load wins in the end.
    axis.set_load(3.0 * TORQUE);
    run(&mut axis, 0.5, to(1500.0, 60_000.0), &tuning());
    assert!(axis.speed() < 1300.0 && axis.motor_output().limited);
    assert!(axis.current() <= limit + 1e-9);
}

#[test]
fn braking_raises_the_bus_and_a_resistor_keeps_it() {
    let bus = |resistance: f64| {
        let power = PowerStage {
            resistance,
            ..PowerStage::VOLT_400
        };
        let mut axis = Axis::new(Plant {
            power,
            ..Plant::INDUCTION
        });
        run(&mut axis, 4.0, to(1500.0, 500.0), &tuning());
        near(axis.electrical().bus_voltage(), 565.7, 10.0);
        let mut highest = 0.0_f64;
        for _ in 0..500 {
            axis.step(0.001, to(0.0, 3000.0), &tuning());
            highest = highest.max(axis.electrical().bus_voltage());
        }
        highest
    };
    assert!(bus(0.0) > 800.0, "{}", bus(0.0));
    let kept = bus(150.0);
    assert!((770.0..800.0).contains(&kept), "{kept}");
}

#[test]
fn a_coast_runs_out_by_friction_and_the_flying_start_takes_it() {
    let mut axis = motor();
    run(&mut axis, 5.0, to(1500.0, 500.0), &tuning());
    run(&mut axis, 0.5, Command::Off, &tuning());
    let output = axis.motor_output();
    assert_eq!((output.current, output.torque, output.frequency), (0.0, 0.0, 0.0));
    let coasting = axis.speed();
    assert!(coasting > 1300.0 && coasting < 1490.0, "{coasting}");
    let flying = Tuning {
        inverter: InverterTuning {
            flying_start: true,
            ..InverterTuning::default()
        },
        ..tuning()
    };
    let mut taken = axis.clone();
    taken.step(0.001, to(1500.0, 500.0), &flying);
    near(taken.speed_command(), coasting, 1.0);
    assert!(taken.current() < NOMINAL);
    // Without it the inverter starts at 0 and brakes the motor at the current limit.
    let mut braked = axis.clone();
    run(&mut braked, 0.001, to(1500.0, 500.0), &tuning());
    assert!(braked.motor_output().limited && braked.motor_output().power < 0.0);
    run(&mut braked, 0.02, to(1500.0, 500.0), &tuning());
    assert!(braked.speed() < coasting - 50.0, "{}", braked.speed());
    run(&mut axis, 60.0, Command::Off, &tuning());
    assert!(axis.is_at_rest());
}

#[test]
fn a_blocked_rotor_stalls_at_the_limit_and_heats() {
    let mut axis = motor();
    axis.set_blocked(true);
    let cold = axis.electrical().motor_temperature();
    run(&mut axis, 30.0, to(1500.0, 1000.0), &tuning());
    let output = axis.motor_output();
    assert_eq!(axis.speed(), 0.0);
    assert!(output.limited);
    near(output.current, 1.6 * NOMINAL, 1e-6);
    assert!(output.torque > TORQUE && output.frequency < 10.0);
    // 30 s of 2.56 times the heat, badly cooled.
    assert!(
        output.thermal_load > 0.4 && output.thermal_load < 1.0,
        "{}",
        output.thermal_load
    );
    assert!(axis.electrical().motor_temperature() > cold + 4.0);
    run(&mut axis, 40.0, to(1500.0, 1000.0), &tuning());
    assert!(axis.motor_output().thermal_load > 1.0);
    // Free again it starts.
    axis.set_blocked(false);
    run(&mut axis, 3.0, to(1500.0, 1000.0), &tuning());
    assert!(axis.speed() > 1480.0);
    // Rest cools it.
    run(&mut axis, 100.0, Command::Off, &tuning());
    assert!(axis.is_at_rest());
    axis.rest(3000.0, &tuning());
    assert!(axis.motor_output().thermal_load < 0.01);
}

#[test]
fn nominal_current_for_ever_is_just_right_for_the_thermal_model() {
    let mut axis = ideal();
    run(&mut axis, 5.0, to(1500.0, 500.0), &tuning());
    axis.set_load(TORQUE);
    run(&mut axis, 3000.0, to(1500.0, 500.0), &tuning());
    near(axis.motor_output().thermal_load, 1.0, 0.01);
}

#[test]
fn the_dc_brake_stops_without_lifting_the_bus() {
    let mut axis = motor();
    run(&mut axis, 4.0, to(1500.0, 500.0), &tuning());
    let mut coasting = axis.clone();
    let brake = Command::DcBrake { current: NOMINAL };
    run(&mut axis, 0.001, brake, &tuning());
    let output = axis.motor_output();
    assert_eq!((output.frequency, output.power), (0.0, 0.0));
    near(output.current, NOMINAL, 1e-9);
    assert!(output.torque < 0.0);
    let mut time = 0.0;
    while axis.speed() > 1.0 {
        run(&mut axis, 0.01, brake, &tuning());
        time += 0.01;
        assert!(time < 30.0 && axis.electrical().bus_voltage() < 570.0);
    }
    run(&mut coasting, time, Command::Off, &tuning());
    assert!(coasting.speed() > 100.0, "{time} s, {}", coasting.speed());
}

#[test]
fn above_the_nominal_frequency_the_field_is_weak() {
    let fast = Tuning {
        speed_positive: 4000.0,
        ..tuning()
    };
    let mut axis = ideal();
    run(&mut axis, 8.0, to(3000.0, 500.0), &fast);
    let output = axis.motor_output();
    near(output.voltage, 400.0, 0.01);
    near(output.current, 0.9, 0.01);
    axis.set_load(0.5 * TORQUE);
    run(&mut axis, 2.0, to(3000.0, 500.0), &fast);
    // A quarter of the torque for the same slip.
    assert!(axis.speed() < 3000.0 - 150.0, "{}", axis.speed());
    // A low mains weakens it, too.
    let mut axis = ideal();
    run(&mut axis, 4.0, to(1500.0, 500.0), &tuning());
    axis.set_mains(Some(300.0));
    run(&mut axis, 2.0, to(1500.0, 500.0), &tuning());
    near(axis.motor_output().voltage, 300.0 * 1.414 / 1.35, 2.0);
    assert!(axis.motor_output().current < 1.5);
}

#[test]
fn energy_is_neither_made_nor_lost() {
    // From the air gap into the shaft and the heat of the rotor, over a start, a load and a stop.
    let mut axis = motor();
    let plant = *axis.plant();
    let (mut taken, mut load, mut friction, mut rotor) = (0.0, 0.0, 0.0, 0.0);
    let dt = 0.0001;
    for step in 0..60_000 {
        let target = if step < 40_000 { 1500.0 } else { 0.0 };
        let torque = if (10_000..40_000).contains(&step) {
            TORQUE
        } else {
            0.0
        };
        axis.set_load(torque);
        let before = axis.speed() / RPM;
        axis.step(dt, to(target, 1500.0), &tuning());
        let omega = 0.5 * (before + axis.speed() / RPM);
        let output = axis.motor_output();
        let field = output.frequency * TAU / 2.0;
        taken += output.power * dt;
        load += torque * omega * dt;
        friction += (plant.coulomb_friction + plant.viscous_friction * omega) * omega * dt;
        rotor += output.torque * (field - omega) * dt;
    }
    let kinetic = 0.5 * plant.inertia() * (axis.speed() / RPM).powi(2);
    let given = load + friction + rotor + kinetic;
    assert!(taken > 3000.0 && rotor > 0.0);
    near(given / taken, 1.0, 0.01);
}

#[test]
fn commands_of_a_servo_give_no_current() {
    let mut axis = motor();
    let ramps = Ramps {
        acceleration: 500.0,
        deceleration: 500.0,
    };
    let position = Command::Position {
        target: 1 << 34,
        speed: 500.0,
        ramps,
        smooth: false,
        end_speed: 0.0,
    };
    for command in [Command::Current { target: 3.0 }, position] {
        run(&mut axis, 0.2, command, &tuning());
        assert_eq!((axis.current(), axis.speed()), (0.0, 0.0));
    }
    let travel = Command::Travel {
        speed: 500.0,
        ramps,
        smooth: false,
    };
    run(&mut axis, 2.0, travel, &tuning());
    assert!(axis.speed() > 490.0);
    // A servo that is reported to brake by direct current has none.
    let mut servo = Axis::new(Plant::SERVO);
    run(&mut servo, 0.1, Command::DcBrake { current: 3.0 }, &tuning());
    assert_eq!((servo.current(), servo.speed()), (0.0, 0.0));
}

#[test]
fn a_nameplate_gives_the_poles_and_may_change_while_running() {
    let plate = Induction::from_plate(1500.0, 400.0, 50.0, 3.4, 1420.0);
    assert_eq!(plate.pole_pairs, 2);
    near(plate.synchronous_speed(), 1500.0, 1e-9);
    near(plate.torque(), TORQUE, 1e-9);
    for (speed, pairs) in [(2850.0, 1), (950.0, 3), (f64::NAN, 1), (0.0, 100), (3000.0, 1)] {
        let plate = Induction::from_plate(1500.0, 400.0, 50.0, 3.4, speed);
        assert_eq!(plate.pole_pairs, pairs, "{speed}");
    }
    let mut axis = motor();
    run(&mut axis, 4.0, to(900.0, 500.0), &tuning());
    let six_poles = Induction::from_plate(1500.0, 400.0, 50.0, 3.9, 940.0);
    axis.set_plant(Plant {
        motor: Motor::Induction(six_poles),
        ..Plant::INDUCTION
    });
    run(&mut axis, 1.0, to(900.0, 500.0), &tuning());
    near(axis.motor_output().frequency, 45.0, 1e-6);
    axis.set_plant(Plant::SERVO);
    run(&mut axis, 1.0, to(900.0, 5000.0), &Tuning::default());
    near(axis.speed(), 900.0, 5.0);
}

fn odd() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(0.0),
        any::<f64>(),
        -5000.0..5000.0_f64,
        0.0..10.0_f64,
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
        1 => Just(Command::Off),
        1 => odd().prop_map(|current| Command::DcBrake { current }),
        4 => (odd(), proptest::option::of(ramps()), any::<bool>())
            .prop_map(|(target, ramp, hold)| Command::Speed { target, ramp, hold }),
        1 => (odd(), ramps()).prop_map(|(speed, ramps)| Command::Travel { speed, ramps, smooth: false }),
    ]
}

fn plates() -> impl Strategy<Value = Induction> {
    (odd(), odd(), odd(), odd(), odd(), any::<u16>(), odd(), odd()).prop_map(
        |(power, voltage, frequency, current, speed, pole_pairs, magnetising_current, breakdown)| Induction {
            power,
            voltage,
            frequency,
            current,
            speed,
            pole_pairs,
            magnetising_current,
            breakdown,
        },
    )
}

fn check(axis: &Axis, limit: f64) {
    let output = axis.motor_output();
    for value in [
        output.frequency,
        output.voltage,
        output.current,
        output.torque,
        output.power,
        output.thermal_load,
        axis.speed(),
        axis.speed_command(),
        axis.electrical().bus_voltage(),
        axis.electrical().motor_temperature(),
    ] {
        assert!(value.is_finite(), "{output:?}");
    }
    assert!(
        output.current >= 0.0 && output.current <= limit * (1.0 + 1e-9),
        "{output:?}"
    );
    assert!(output.thermal_load >= 0.0);
}

proptest! {
    /// Whatever the plate, the parameters, the load and the commands are: numbers stay numbers and within the limits.
    #[test]
    fn nothing_breaks_it(
        plate in plates(),
        steps in proptest::collection::vec((commands(), odd(), odd(), any::<bool>()), 1..20),
        knobs in (odd(), odd(), odd()),
        inertia in odd(),
    ) {
        let mut axis = Axis::new(Plant {
            motor: Motor::Induction(plate),
            load_inertia: inertia,
            ..Plant::INDUCTION
        });
        let tuning = Tuning {
            inverter: InverterTuning {
                slip_compensation: knobs.0,
                slip_time: knobs.1,
                thermal_time: knobs.2,
                flying_start: true,
            },
            ..tuning()
        };
        for (command, load, mains, blocked) in steps {
            axis.set_load(load.clamp(-100.0, 100.0));
            axis.set_mains(Some(mains));
            axis.set_blocked(blocked);
            for seconds in [0.0007, 0.016] {
                axis.step(seconds, command, &tuning);
                check(&axis, 1.6 * NOMINAL);
            }
        }
    }

    /// Light or heavy, it settles at the slip that belongs to its load and stays there.
    #[test]
    fn it_settles(
        inertia in -5.0..0.0_f64,
        load in -1.0..1.0_f64,
        speed in 100.0..1500.0_f64,
        seconds in 0.0002..0.004_f64,
    ) {
        let mut axis = Axis::new(Plant {
            motor_inertia: 10_f64.powf(inertia),
            load_inertia: 0.0,
            coulomb_friction: 0.0,
            viscous_friction: 0.0,
            power: PowerStage { resistance: 100.0, ..PowerStage::VOLT_400 },
            ..Plant::INDUCTION
        });
        let mut time = 0.0;
        while time < 60.0 {
            axis.set_load(if time > 30.0 { load * TORQUE } else { 0.0 });
            axis.step(seconds, to(speed, 300.0), &tuning());
            time += seconds;
        }
        let slip = speed - axis.speed();
        prop_assert!((slip - 80.0 * load).abs() < 3.0, "{slip} for {load}");
        prop_assert!((axis.motor_output().torque - load * TORQUE).abs() < 0.01 * TORQUE);
    }
}
