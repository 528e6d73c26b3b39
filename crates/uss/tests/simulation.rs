//! The parameter channel on a bad line, in virtual time: a master with a client for each drive, octets that are lost,
//! flipped or strange, an adapter that hands replies over late, drives that are switched off and on, masters that stop
//! and start again.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)] // the helpers of a test report by panicking

mod bad_line;

use std::time::Duration;

use bad_line::{Line, Run, Tally};
use profidrive_uss::Protocol;
use profile::pkw::ClientTiming;
use proptest::prelude::*;

/// Longer than any telegram of this line can be under way, its repetitions included.
const TIMING: ClientTiming = ClientTiming {
    reply: Duration::from_millis(1500),
    round_trip: Duration::from_millis(300),
};

fn run(run: Run) -> Tally {
    Line::new(run).run()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// No job gets another's value or one from before it was asked, each ends in its time, nothing is written twice, and
    /// when the line is well all drives answer again. A failure prints its seed.
    #[test]
    fn every_client_gets_its_own_value_and_no_call_hangs(seed in any::<u64>(), uss in any::<bool>(), damage in 0..30_u64,
                                                    late in 0..30_u64, stops in any::<bool>(), echo in any::<bool>()) {
        let protocol = if uss { Protocol::Uss } else { Protocol::Fc };
        let result = run(Run { seed, protocol, damage, late, stops, echo, timing: TIMING });
        prop_assert_eq!((result.wrong, result.old, result.late, result.twice), (0, 0, 0, 0), "{:?}", result);
        prop_assert!(result.at_the_end.iter().all(|answers| *answers > 0), "{:?}", result);
    }
}

/// A line that is well fails nothing.
#[test]
fn a_good_line_answers_everything() {
    for (seed, protocol) in [(1, Protocol::Fc), (2, Protocol::Uss)] {
        for echo in [false, true] {
            let result = run(Run {
                seed,
                protocol,
                damage: 0,
                late: 0,
                stops: false,
                echo,
                timing: TIMING,
            });
            assert_eq!((result.failed, result.wrong, result.old), (0, 0, 0), "{result:?}");
            assert!(result.answered > 40 && result.refused > 2, "{result:?}");
            assert_eq!(result.texts > 2, protocol == Protocol::Fc, "{result:?}");
        }
    }
}

/// The line is bad enough to show what a client does that does not let the channel rest.
#[test]
fn without_the_gap_old_values_are_accepted() {
    let mut wrong = 0;
    for seed in 0..200 {
        let result = run(Run {
            seed,
            protocol: if seed % 2 == 0 {
                Protocol::Fc
            } else {
                Protocol::Uss
            },
            damage: 10,
            late: 60,
            stops: true,
            echo: false,
            timing: ClientTiming {
                reply: Duration::from_millis(60),
                round_trip: Duration::ZERO,
            },
        });
        wrong += result.wrong + result.old;
    }
    assert!(wrong > 0);
}
