//! How often one source may change a device by DCP.

use core::time::Duration;

use crate::{Instant, MacAddress};

/// Changes that one source may request at once, more than any engineering tool does.
const BURST: u32 = 100;
/// Time after which one more is allowed.
const REFILL: Duration = Duration::from_millis(40);
/// The same as a time: so far ahead of the clock a source may be.
const WINDOW: Duration = Duration::from_millis(40 * 100);
/// So far behind its allowance a flood gets at most: the time of silence after which it is served again. Longer than
/// one client is held, so that others are served while the flood goes on.
const LOCK: Duration = Duration::from_secs(4);
/// Number of stored sources; a further one replaces the one whose last request is oldest.
const SOURCES: usize = 8;

const _: () = assert!(WINDOW.as_millis() == REFILL.as_millis() * BURST as u128);

/// Whether a request is served.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Allowance {
    /// It is served.
    Granted,
    /// It is ignored, the first of this flood.
    Exceeded,
    /// It is ignored like those before it.
    StillExceeded,
}

#[derive(Debug, Clone, Copy, Default)]
struct Source {
    mac: MacAddress,
    /// When everything it requested is within its allowance.
    paid: Instant,
    /// Its flood was reported.
    reported: bool,
}

/// The sources that requested changes lately, the newest last.
#[derive(Debug, Default)]
pub(super) struct SourceLimit {
    sources: [Source; SOURCES],
}

impl SourceLimit {
    /// Counts a request of `mac`, whether it is served or not.
    pub(super) fn count(&mut self, now: Instant, mac: MacAddress) -> Allowance {
        let known = self.sources.iter().position(|source| source.mac == mac);
        if let Some(moved) = self.sources.get_mut(known.unwrap_or(0)..) {
            moved.rotate_left(1);
        }
        let [.., source] = &mut self.sources;
        if known.is_none() || source.paid <= now {
            *source = Source {
                mac,
                paid: now,
                reported: false,
            };
        }
        source.paid = (source.paid + REFILL).min(now + WINDOW + LOCK);
        if source.paid <= now + WINDOW {
            Allowance::Granted
        } else if core::mem::replace(&mut source.reported, true) {
            Allowance::StillExceeded
        } else {
            Allowance::Exceeded
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOD: MacAddress = MacAddress([2, 0, 0, 0, 0, 7]);
    const ENGINEER: MacAddress = MacAddress([2, 0, 0, 0, 0, 8]);

    fn at(millis: u64) -> Instant {
        Instant::ZERO + Duration::from_millis(millis)
    }

    #[test]
    fn a_flood_is_served_once_and_then_only_after_silence() {
        let mut limit = SourceLimit::default();
        let mut granted = 0;
        let mut reported = 0;
        for request in 0..90_000_u64 {
            match limit.count(Instant::ZERO + Duration::from_micros(request * 111), FLOOD) {
                Allowance::Granted => granted += 1,
                Allowance::Exceeded => reported += 1,
                Allowance::StillExceeded => {}
            }
        }
        assert_eq!((granted, reported), (100, 1));
        assert_eq!(limit.count(at(10_000), ENGINEER), Allowance::Granted);
        assert_eq!(limit.count(at(13_000), FLOOD), Allowance::StillExceeded);
        assert_eq!(limit.count(at(13_000 + 4_100), FLOOD), Allowance::Granted);
    }

    #[test]
    fn a_tool_that_sets_twenty_values_a_second_for_hours_is_not_hindered() {
        let mut limit = SourceLimit::default();
        for request in 0..20 * 3600 * 2 {
            assert_eq!(limit.count(at(request * 50), ENGINEER), Allowance::Granted);
        }
    }

    #[test]
    fn a_tool_that_was_too_fast_and_repeats_every_second_is_served_again() {
        let mut limit = SourceLimit::default();
        while limit.count(at(0), ENGINEER) == Allowance::Granted {}
        assert_eq!(limit.count(at(1000), ENGINEER), Allowance::Granted);
    }

    #[test]
    fn the_table_is_bounded_and_remembers_the_newest_sources() {
        let mut limit = SourceLimit::default();
        while limit.count(at(0), FLOOD) == Allowance::Granted {}
        for source in 0..7 {
            limit.count(at(1), MacAddress([2, 1, 0, 0, 0, source]));
        }
        assert_eq!(limit.count(at(2), FLOOD), Allowance::StillExceeded);
        for source in 0..8 {
            limit.count(at(3), MacAddress([2, 1, 0, 0, 1, source]));
        }
        assert_eq!(limit.count(at(4), FLOOD), Allowance::Granted);
    }
}
