//! Drives, network and clients through accidents by seeds. `make lives` goes through more of them.

use allocations::taken_by;
use testbench::life::{LEFT, MOST_MEMORY, Tally, live};

/// Seeds of each run.
const SEEDS: u64 = 100;

#[test]
fn whatever_happens_the_drives_and_what_is_said_of_them_agree() {
    let mut all = Tally::default();
    for seed in 0..SEEDS {
        let (life, memory) = taken_by(|| live(seed));
        match life {
            Ok(tally) => all += tally,
            Err(broken) => panic!("{broken}"),
        }
        assert!(
            memory.most <= MOST_MEMORY && memory.kept <= LEFT,
            "seed {seed}: {memory:?}"
        );
    }
    // they were lives
    assert!(all.answered > 10 * SEEDS, "{all:?}");
    assert!(
        all.motions > SEEDS / 4 && all.saves > SEEDS && all.connections > SEEDS / 4,
        "{all:?}"
    );
    assert!(all.kills > SEEDS / 10 && all.power_cuts > SEEDS / 10, "{all:?}");
}
