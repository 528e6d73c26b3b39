//! Whether a beat is as fresh as it says.

use std::time::Duration;

/// A beat may be this much later than the fastest one.
const LATE: Duration = Duration::from_millis(100);
/// The clocks of a page and of this server may drift apart by this share.
const DRIFT: f64 = 500e-6;

/// Compares the times of beats by two clocks. A beat that waited somewhere, as in a burst after a stall of the network, comes later
/// than the fastest one did, and says nothing about the button now.
#[derive(Debug, Default)]
pub(crate) struct Freshness {
    /// The smallest difference between arrival and page time, and when that was.
    fastest: Option<(f64, Duration)>,
}

impl Freshness {
    /// Returns whether a beat is fresh that arrives at a time of this server and was sent at a time of its page.
    pub fn is_fresh(&mut self, arrival: Duration, page: f64) -> bool {
        let delay = arrival.as_secs_f64() - page / 1000.0;
        if !delay.is_finite() {
            return false;
        }
        let fastest = match self.fastest {
            Some((before, then)) => {
                // a clock that goes slower than this one must not make each beat a late one
                let drifted = before + DRIFT * arrival.saturating_sub(then).as_secs_f64();
                drifted.min(delay)
            }
            None => delay,
        };
        self.fastest = Some((fastest, arrival));
        delay - fastest <= LATE.as_secs_f64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(count: u64) -> Duration {
        Duration::from_millis(count)
    }

    #[test]
    fn a_burst_after_a_stall_is_not_fresh() {
        let mut freshness = Freshness::default();
        for beat in 0..20_u32 {
            assert!(freshness.is_fresh(ms(1000 + 50 * u64::from(beat) + 7), f64::from(50 * beat)));
        }
        // ten beats come at once, 500 ms late
        let fresh: Vec<bool> = (20..30_u32)
            .map(|beat| freshness.is_fresh(ms(2507), f64::from(50 * beat)))
            .collect();
        assert_eq!(fresh.iter().filter(|fresh| **fresh).count(), 2, "{fresh:?}");
        assert!(!fresh[0] && fresh[9]);
        // one that lies about its time makes all later ones late: its page loses control, and nothing moves
        assert!(freshness.is_fresh(ms(2550), 1e9));
        assert!(!freshness.is_fresh(ms(2600), 1600.0));
        assert!(!freshness.is_fresh(ms(2600), f64::NAN));
    }

    #[test]
    fn clocks_may_drift_for_hours() {
        let mut freshness = Freshness::default();
        for second in 0..40_000_u32 {
            // the page is slower by 100 parts in a million: 4 s in that time
            let page = f64::from(second) * 999.9;
            assert!(
                freshness.is_fresh(Duration::from_secs(second.into()), page),
                "{second}"
            );
        }
    }
}
