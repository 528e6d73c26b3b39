//! What one drive costs: `cargo bench -p virtual-drive`.
#![allow(missing_docs, reason = "the macro makes a public function")]

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use profinet::Instant;
use virtual_drive::axis::{Axis, Command, Plant, Ramps, Tuning};
use virtual_drive::drive::Drive;
use virtual_drive::model;

#[path = "../tests/pair/mod.rs"]
mod pair;

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
