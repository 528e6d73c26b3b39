//! Local operation: the panel and the settings that keep the bus off.

use super::bench::Bench;
use super::*;
use crate::model::{AKD, VACON, VLT};

/// Control requested.
const BIT_9: u16 = 0x0200;

fn inject(bench: &mut Bench, text: &str) {
    bench.drive.inject(text.parse().unwrap());
}

#[test]
fn the_panel_stops_a_running_drive_and_the_bus_is_without_effect() {
    // telegram 1 of each model, and the words of the vendors
    for (model, telegram, speed) in [
        (&AKD, 1, 0x0199),
        (&VLT, 1, 0x2000),
        (&VACON, 1, 0x2000),
        (&VACON, 148, 5000),
    ] {
        let name = model.catalogue.model;
        let mut bench = Bench::new(model, telegram);
        bench.send(0x047E, 0, 40);
        let status = bench.send(0x047F, speed, 6000);
        assert_eq!(
            (bench.drive.state(), status & BIT_9),
            (State::S4, BIT_9),
            "{name}"
        );
        inject(&mut bench, "local=on");
        assert_eq!(bench.send(0x047F, speed, 8) & BIT_9, 0, "{name}");
        bench.send(0x047F, speed, 8000);
        assert!(
            !bench.drive.is_enabled() && bench.drive.axis().is_at_rest(),
            "{name}"
        );
        for word in [0x047E, 0x047F, 0x04FF, 0x047F] {
            let status = bench.send(word, speed, 40);
            assert_eq!((bench.drive.is_enabled(), status & BIT_9), (false, 0), "{name}");
        }
        // back on the bus: the ON that stands there does not start, OFF and ON do
        inject(&mut bench, "local=off");
        let status = bench.send(0x047F, speed, 40);
        assert_eq!(
            (bench.drive.is_enabled(), status & BIT_9),
            (false, BIT_9),
            "{name}"
        );
        bench.send(0x047E, 0, 40);
        bench.send(0x047F, speed, 40);
        assert_eq!(bench.drive.state(), State::S4, "{name}");
    }
}

#[test]
fn the_level_of_the_fc_profile_starts_again_when_the_bus_is_back() {
    let mut bench = Bench::new(&VLT, 103);
    bench.send(0x047C, 0x2000, 4000);
    inject(&mut bench, "local=on");
    assert_eq!(bench.send(0x047C, 0x2000, 6000) & BIT_9, 0);
    assert!(!bench.drive.is_enabled());
    inject(&mut bench, "local=off");
    assert_eq!(bench.send(0x047C, 0x2000, 400) & BIT_9, BIT_9);
    assert_eq!(bench.drive.state(), State::S4);
}

#[test]
fn by_hand_the_motor_runs_with_the_speed_of_the_panel() {
    let mut bench = Bench::new(&VLT, 1);
    bench.send(0x047E, 0, 40);
    inject(&mut bench, "local-speed=600rpm");
    let status = bench.send(0x047E, 0x4000, 6000);
    assert_eq!(status & BIT_9, 0, "{status:04X}");
    assert!((bench.drive.axis().speed_command() - 600.0).abs() < 1.0);
    inject(&mut bench, "local-speed=-300rpm");
    bench.send(0x047E, 0, 6000);
    assert!((bench.drive.axis().speed_command() + 300.0).abs() < 1.0);
    // after a fault it goes on once that is acknowledged at the drive
    bench.drive.inject_fault(9, false);
    bench.send(0x047E, 0, 4000);
    assert!(!bench.drive.is_enabled());
    bench.drive.clear_faults();
    bench.send(0x047E, 0, 4000);
    assert!((bench.drive.axis().speed_command() + 300.0).abs() < 1.0);
    inject(&mut bench, "local-speed=auto");
    assert_eq!(bench.send(0x047E, 0, 6000) & BIT_9, 0);
    assert!(!bench.drive.is_enabled() && bench.drive.axis().is_at_rest());
}

#[test]
fn keys_of_the_panel_can_be_switched_off() {
    let mut bench = Bench::new(&VLT, 1);
    for (key, text) in [(40, "local-speed=300rpm"), (41, "local=on")] {
        bench.write(key, 0).unwrap();
        inject(&mut bench, text);
        assert_eq!(bench.send(0x047E, 0, 40) & BIT_9, BIT_9, "{text}");
        bench.write(key, 1).unwrap();
        inject(&mut bench, text);
        assert_eq!(bench.send(0x047E, 0, 40) & BIT_9, 0, "{text}");
        bench.write(42, 0).unwrap();
        inject(&mut bench, "local=off");
        assert_eq!(bench.send(0x047E, 0, 40) & BIT_9, 0, "{text}");
        bench.write(42, 1).unwrap();
        inject(&mut bench, "local=off");
        assert_eq!(bench.send(0x047E, 0, 40) & BIT_9, BIT_9, "{text}");
    }
}

#[test]
fn settings_keep_the_bus_off() {
    for (model, parameter, [off, on]) in [(&VLT, 801, [1, 0]), (&VACON, 172, [0, 1])] {
        let mut bench = Bench::new(model, 1);
        bench.write(parameter, off).unwrap();
        bench.send(0x047E, 0, 40);
        let status = bench.send(0x047F, 0x2000, 400);
        assert_eq!((bench.drive.is_enabled(), status & BIT_9), (false, 0));
        bench.write(parameter, on).unwrap();
        bench.send(0x047E, 0, 40);
        let status = bench.send(0x047F, 0x2000, 400);
        assert_eq!((bench.drive.state(), status & BIT_9), (State::S4, BIT_9));
    }
}

#[test]
fn stop_and_disable_by_parameter_reach_a_drive_in_local_operation() {
    let mut bench = Bench::new(&AKD, 1);
    inject(&mut bench, "local-speed=300rpm");
    bench.send(0x047E, 0, 2000);
    assert!((bench.drive.axis().speed_command() - 300.0).abs() < 1.0);
    // DRV.STOP: it stands, still enabled
    bench.write(2137, 1).unwrap();
    bench.send(0x047E, 0, 2000);
    assert!(bench.drive.is_enabled() && bench.drive.axis().speed_command().abs() < 1.0);
    // DRV.DIS: off, until the local panel starts it again
    bench.write(2118, 1).unwrap();
    bench.send(0x047E, 0, 2000);
    assert!(!bench.drive.is_enabled());
    inject(&mut bench, "local-speed=300rpm");
    bench.send(0x047E, 0, 2000);
    assert!((bench.drive.axis().speed_command() - 300.0).abs() < 1.0);
}
