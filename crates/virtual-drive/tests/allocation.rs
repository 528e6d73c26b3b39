//! The cyclic path and a parameter read allocate nothing, shown by an allocator that counts.

use std::time::Duration;

use profidrive_virtual_drive::axis::{Axis, Command, Plant, Ramps, Tuning};
use profidrive_virtual_drive::drive::Drive;
use profidrive_virtual_drive::model;
use profinet::Instant;

mod pair;

#[test]
fn ticks_states_faults_and_parameters() {
    let mut drive = Drive::new(&model::AKD);
    drive.connect(1, Duration::from_millis(48)).unwrap();
    let mut now = Instant::ZERO;
    let mut inputs = [0; 4];
    let mut answer = [0; 240];
    let read = [1, 1, 0, 2, 0x10, 1, 0x09, 0x7C, 0, 0, 0x10, 64, 0x03, 0xB3, 0, 0]; // VL.FB_32, 947
    let write = [2, 2, 0, 1, 0x10, 1, 0x08, 0x3C, 0, 0, 0x43, 1, 0, 0x3D, 0x09, 0]; // DRV.ACC
    let run = || {
        for cycle in 0..4000_u32 {
            let control: u16 = match cycle % 400 {
                0..5 => 0x047E,
                300..310 => 0x047E,
                310..320 => 0x04FE,
                _ => 0x047F,
            };
            if cycle % 400 == 250 {
                drive.inject_fault(501, false);
            }
            let [a, b] = control.to_be_bytes();
            now += Duration::from_millis(16);
            drive.tick(now, Some(&[a, b, 0x06, 0x66]), &mut inputs);
            assert!(drive.serve(&read, &mut answer).is_ok());
            assert!(drive.serve(&write, &mut answer).is_ok());
            while drive.poll_event().is_some() {}
        }
    };
    assert_eq!(allocations::made_by(run), 0);
}

#[test]
fn steps_of_an_induction_motor() {
    let mut axis = Axis::new(Plant::INDUCTION);
    let ramp = Some(Ramps {
        acceleration: 1000.0,
        deceleration: 1000.0,
    });
    let run = || {
        for target in [1000.0, -500.0, 0.0] {
            let speed = Command::Speed {
                target,
                ramp,
                hold: false,
            };
            for command in [speed, Command::Off, speed, Command::DcBrake { current: 3.0 }] {
                axis.step(0.5, command, &Tuning::default());
            }
        }
    };
    assert_eq!(allocations::made_by(run), 0);
}

#[test]
fn frame_in_step_frame_out() {
    let mut pair = pair::Pair::new(Duration::from_millis(16));
    pair.send([0x04, 0x7E, 0, 0]);
    for _ in 0..20 {
        pair.cycle(|_, work| work());
    }
    pair.send([0x04, 0x7F, 0x06, 0x66]);
    let mut allocated = 0;
    for _ in 0..2000 {
        pair.cycle(|_, work| allocated += allocations::made_by(work));
    }
    assert!(pair.station.drive().is_enabled());
    assert_eq!(allocated, 0);
}
