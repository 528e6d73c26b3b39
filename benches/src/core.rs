//! What one request and one cycle cost without a kernel: the engines alone, each beside its limit.

use std::hint::black_box;
use std::time::{Duration, Instant};

use profile::parameter::{Dialect, Request, serve};

use crate::table::Row;

#[path = "../../crates/profile/benches/one_word/mod.rs"]
mod one_word;
#[path = "../../crates/virtual-drive/tests/pair/mod.rs"]
mod pair;

use one_word::OneWord;

/// Rounds of a measurement, of which the least counts: what else a machine does only adds.
const ROUNDS: u32 = 20;
const REPETITIONS: u32 = 20_000;

/// Returns the least time of one `work`.
fn least(mut work: impl FnMut()) -> Duration {
    let mut round = || {
        let start = Instant::now();
        (0..REPETITIONS).for_each(|_| work());
        start.elapsed() / REPETITIONS
    };
    (0..ROUNDS).map(|_| round()).min().unwrap_or_default()
}

/// Parses a request, answers it, and takes a frame, steps the drive and gives a frame.
pub fn compare() -> Vec<Row> {
    let read = [5, 1, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0];
    let change = [5, 2, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x42, 1, 0, 2];
    let parse = least(|| {
        let request = Request::parse(black_box(&change), Dialect::AKD.code_space).unwrap();
        let value = request.values().next().unwrap().unwrap().raw(0);
        black_box((request.id(), request.addresses().next(), value));
    });
    let (mut drive, mut out) = (OneWord(1), [0; 240]);
    let answer = least(|| {
        let _ = black_box(serve(black_box(&read), &Dialect::AKD, &mut drive, &mut out));
    });
    let written = least(|| {
        let _ = black_box(serve(black_box(&change), &Dialect::AKD, &mut drive, &mut out));
    });
    let row = |what: &str, time: Duration, limit: Duration| {
        Row::new(what, format!("{} ns", time.as_nanos()))
            .limit(format!("{} ns", limit.as_nanos()), time < limit)
    };
    vec![
        row("parse a change of one parameter", parse, Duration::from_nanos(20)),
        row(
            "parse a read and build its answer",
            answer,
            Duration::from_nanos(50),
        ),
        row(
            "parse a change, write, build its answer",
            written,
            Duration::from_nanos(50),
        ),
        row(
            "frame in, step of 1 ms, frame out",
            cycle(Duration::from_millis(1), 1),
            Duration::from_micros(1),
        ),
        row(
            "frame in, step of 16 ms, frame out",
            cycle(Duration::from_millis(16), 1),
            Duration::from_micros(2),
        ),
        row(
            "the same in one of 2,000 drives",
            cycle(Duration::from_millis(16), 2_000),
            Duration::from_micros(3),
        ),
    ]
}

/// Returns the time of one cycle of virtual drives at speed with telegram 1, without the kernel. One after the other has its
/// cycle: of many drives, each finds the caches full of the others.
fn cycle(interval: Duration, drives: usize) -> Duration {
    let mut pairs: Vec<pair::Pair> = (0..drives).map(|_| pair::Pair::new(interval)).collect();
    for pair in &mut pairs {
        pair.send([0x04, 0x7E, 0, 0]);
        (0..20).for_each(|_| pair.cycle(|_, work| work()));
        pair.send([0x04, 0x7F, 6, 0x66]);
    }
    let cycles = (REPETITIONS as usize / 10).div_ceil(drives) * drives;
    let mut round = || {
        let mut spent = Duration::ZERO;
        for at in 0..cycles {
            pairs[at % drives].cycle(|_, work| {
                let start = Instant::now();
                work();
                spent += start.elapsed();
            });
        }
        spent / cycles as u32
    };
    (0..ROUNDS).map(|_| round()).min().unwrap_or_default()
}
