//! Lives through many seeds and prints what happened in them: `lives FIRST COUNT`. A seed that breaks something ends it.
//!
//! The memory of a life is measured too: what it takes at most, and that nothing of it is left.

use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use allocations::{Memory, taken_by};
use testbench::life::{Broken, LEFT, MOST_MEMORY, Tally, live};

/// After so many lives a line is printed.
const REPORT: u64 = 10_000;

fn main() -> ExitCode {
    let numbers: Option<Vec<u64>> = std::env::args().skip(1).map(|text| text.parse().ok()).collect();
    let Some(&[first, count]) = numbers.as_deref() else {
        eprintln!("usage: lives FIRST COUNT");
        return ExitCode::from(2);
    };
    let threads = std::thread::available_parallelism().map_or(1, |threads| threads.get() as u64);
    let (next, stop) = (AtomicU64::new(first), AtomicBool::new(false));
    let begun = Instant::now();
    let results = std::thread::scope(|scope| {
        let worker = || {
            let mut tally = Tally::default();
            let mut most = 0;
            loop {
                let seed = next.fetch_add(1, Ordering::Relaxed);
                if seed >= first + count || stop.load(Ordering::Relaxed) {
                    return Ok((tally, most));
                }
                match measured(seed) {
                    Ok((life, memory)) => {
                        tally += life;
                        most = most.max(memory);
                    }
                    Err(broken) => {
                        stop.store(true, Ordering::Relaxed);
                        return Err(broken);
                    }
                }
                let done = seed - first + 1;
                if done.is_multiple_of(REPORT) {
                    println!("{done} seeds in {:.0} s", begun.elapsed().as_secs_f64());
                }
            }
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        let results = workers.into_iter().map(|worker| worker.join().expect("a result"));
        results.collect::<Vec<_>>()
    });
    let (mut tally, mut most) = (Tally::default(), 0);
    for result in results {
        match result {
            Ok((lives, memory)) => {
                tally += lives;
                most = most.max(memory);
            }
            Err(broken) => {
                eprintln!("{broken}");
                return ExitCode::FAILURE;
            }
        }
    }
    println!(
        "{count} seeds from {first}: {tally:#?}\nmemory of a life at most {} kB, {:.0} s",
        most / 1024,
        begun.elapsed().as_secs_f64()
    );
    ExitCode::SUCCESS
}

/// A life, and the most memory that it took, octets.
fn measured(seed: u64) -> Result<(Tally, i64), Broken> {
    let (result, Memory { kept, most }) = taken_by(|| live(seed));
    let tally = result?;
    if most > MOST_MEMORY || kept > LEFT {
        return Err(Broken {
            seed,
            at: profinet::Instant::ZERO + tally.time,
            story: Vec::new(),
            what: format!("{most} octets of memory at most, {kept} left"),
        });
    }
    Ok((tally, most))
}
