//! What one drive costs: `cargo bench -p profidrive-virtual-drive`.
#![allow(missing_docs, reason = "the macro makes a public function")]

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use profidrive_virtual_drive::axis::{Axis, Command, Plant, Ramps, Tuning};
use profidrive_virtual_drive::drive::Drive;
use profidrive_virtual_drive::model;
use profinet::Instant;

#[path = "../tests/pair/mod.rs"]
mod pair;

/// A drive that a controller sends to and fro with telegram 9, ten revolutions at 600 rpm.
struct Positioning {
    drive: Drive,
    now: Instant,
    cycle: Duration,
    outputs: [u8; 20],
    inputs: [u8; 10],
    tasks: u32,
}

impl Positioning {
    /// In S4 and homed where it stands.
    fn new(cycle: Duration) -> Self {
        let mut drive = Drive::new(&model::AKD);
        let mut answer = [0; 240];
        let position_mode = [1, 2, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x42, 1, 0, 2];
        drive
            .serve(&position_mode, &mut answer)
            .expect("PNU 930 can be written");
        drive
            .connect(9, Duration::from_millis(48))
            .expect("the AKD has telegram 9");
        let mut outputs = [0; 20];
        outputs[2] = 0x80; // SATZANW: MDI
        outputs[10..14].copy_from_slice(&0x0CCC_CCCD_u32.to_be_bytes()); // MDI_VELOCITY
        outputs[14..18].copy_from_slice(&[0, 50, 0, 50]); // MDI_ACC, MDI_DEC
        outputs[19] = 1; // MDI_MOD: absolute
        let mut new = Self {
            drive,
            now: Instant::ZERO,
            cycle,
            outputs,
            inputs: [0; 10],
            tasks: 0,
        };
        for control in [0x0430, 0x0436, 0x0437, 0x043F, 0x0C3F, 0x043F] {
            (0..20).for_each(|_| new.step(control));
        }
        new
    }

    fn step(&mut self, control: u16) {
        self.now += self.cycle;
        self.outputs[..2].copy_from_slice(&control.to_be_bytes());
        self.drive.tick(self.now, Some(&self.outputs), &mut self.inputs);
    }

    fn status(&self) -> u16 {
        u16::from_be_bytes([self.inputs[0], self.inputs[1]])
    }

    /// One tick: the next task when the target is reached and the last one was taken.
    fn tick(&mut self) {
        let status = self.status();
        let start = status & 0x1400 == 0x0400;
        if start {
            self.tasks += 1;
            let target = if self.tasks % 2 == 1 { 10 << 16 } else { 0_i32 };
            self.outputs[6..10].copy_from_slice(&target.to_be_bytes());
        }
        self.step(if start { 0x047F } else { 0x043F });
    }
}

fn costs(criterion: &mut Criterion) {
    let ramp = Some(Ramps {
        acceleration: 3000.0,
        deceleration: 3000.0,
    });
    let mut axis = Axis::new(Plant::default());
    criterion.bench_function("axis, one step of 1 ms", |bencher| {
        bencher.iter(|| {
            axis.step(
                0.001,
                Command::Speed {
                    target: black_box(600.0),
                    ramp,
                    hold: false,
                },
                &Tuning::default(),
            );
        });
    });
    let mut motor = Axis::new(Plant::INDUCTION);
    criterion.bench_function("axis, one step of 1 ms, induction motor", |bencher| {
        bencher.iter(|| {
            motor.step(
                0.001,
                Command::Speed {
                    target: black_box(1400.0),
                    ramp,
                    hold: false,
                },
                &Tuning::default(),
            );
        });
    });
    for (name, smooth) in [
        ("axis, one step of 1 ms, positioning", false),
        ("axis, one step of 1 ms, positioning with limited jerk", true),
    ] {
        let mut axis = Axis::new(Plant::default());
        let mut target: i64 = 10 << 32;
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| {
                // To and fro for ever, 10 revolutions each.
                if axis.trajectory_done() {
                    target = (10 << 32) - target;
                }
                axis.step(
                    0.001,
                    Command::Position {
                        target: black_box(target),
                        speed: 600.0,
                        ramps: Ramps {
                            acceleration: 3000.0,
                            deceleration: 3000.0,
                        },
                        smooth,
                        end_speed: 0.0,
                    },
                    &Tuning::default(),
                );
            });
        });
    }
    for (name, cycle) in [("tick of 1 ms", 1), ("tick of 16 ms", 16)] {
        let mut drive = Drive::new(&model::AKD);
        let mut inputs = [0; 4];
        let mut now = Instant::ZERO;
        let _ = drive.connect(1, Duration::from_millis(48));
        for outputs in [[0x04, 0x7E, 0, 0], [0x04, 0x7F, 6, 0x66]] {
            now += Duration::from_millis(cycle);
            drive.tick(now, Some(&outputs), &mut inputs);
        }
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| {
                now += Duration::from_millis(cycle);
                drive.tick(now, Some(black_box(&[0x04, 0x7F, 6, 0x66])), &mut inputs);
                black_box(inputs)
            });
        });
    }
    for (name, cycle) in [
        ("tick of 1 ms, positioning by MDI", 1),
        ("tick of 16 ms, positioning by MDI", 16),
    ] {
        let mut positioning = Positioning::new(Duration::from_millis(cycle));
        criterion.bench_function(name, |bencher| bencher.iter(|| positioning.tick()));
        assert!(
            positioning.tasks > 1,
            "nothing moved: {:#06x}",
            positioning.status()
        );
    }
    // The watch itself costs some 25 ns for each of the calls of a cycle.
    let mut pair = pair::Pair::new(Duration::from_millis(1));
    pair.send([0x04, 0x7E, 0, 0]);
    (0..20).for_each(|_| pair.cycle(|_, work| work()));
    pair.send([0x04, 0x7F, 6, 0x66]);
    criterion.bench_function("station, frame in, step of 1 ms, frame out", |bencher| {
        bencher.iter_custom(|cycles| {
            let mut spent = Duration::ZERO;
            for _ in 0..cycles {
                pair.cycle(|_, work| {
                    let start = std::time::Instant::now();
                    work();
                    spent += start.elapsed();
                });
            }
            spent
        });
    });
    let mut drive = Drive::new(&model::AKD);
    let mut answer = [0; 240];
    criterion.bench_function("parameter request answered", |bencher| {
        bencher.iter(|| drive.serve(black_box(&[1, 1, 0, 1, 0x10, 1, 0x08, 0x3C, 0, 0]), &mut answer));
    });
}

criterion_group!(benches, costs);
criterion_main!(benches);
