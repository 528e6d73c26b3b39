//! A thread that runs before those of other programs, as long as it does not need most of a processor.

use std::time::Duration;

use profinet::Instant;

use super::{Rank, os};

/// How long a thread is watched before it gives its rank up, and before it takes it again. The connections of hundreds of drives
/// begin with some tenths of a second of work: a thread that shared the processor then waits for others longer than a drive
/// waits for its controller.
const BEFORE_UP: Duration = Duration::from_millis(500);
const BEFORE_AGAIN: Duration = Duration::from_millis(100);
/// The share of a processor above which a thread gives its rank up, and that below which it takes it again, in percent.
const ABOVE: u32 = 75;
const BELOW: u32 = 50;

/// The rank of the calling thread, where the system permits one (root, `CAP_SYS_NICE`, or a limit for real-time priorities).
///
/// A thread that needs most of a processor shares it with all others instead: before them it would hold up what the kernel does
/// with its own frames. To be used by one thread, which calls [`First::turn`] again and again. Threads that it starts share.
#[derive(Debug)]
pub struct First {
    rank: Rank,
    /// Nothing where the system does not permit it, or does not report the time of threads.
    watch: Option<Watch>,
}

#[derive(Debug)]
struct Watch {
    since: Instant,
    ran: Duration,
    first: bool,
}

impl First {
    /// Gives the calling thread a rank before all threads that have none.
    #[must_use]
    pub fn new(rank: Rank) -> Self {
        let watch = os::thread_ran()
            .filter(|_| os::run_first(Some(rank)))
            .map(|ran| Watch {
                since: os::now(),
                ran,
                first: true,
            });
        Self { rank, watch }
    }

    /// Decides the rank anew where the time has come. It costs some nanoseconds otherwise.
    pub fn turn(&mut self, now: Instant) {
        let Some(watch) = &mut self.watch else {
            return;
        };
        let passed = now.saturating_since(watch.since);
        if passed < if watch.first { BEFORE_UP } else { BEFORE_AGAIN } {
            return;
        }
        let Some(ran) = os::thread_ran() else {
            return;
        };
        let first = stays_first(watch.first, ran.saturating_sub(watch.ran), passed);
        if first != watch.first {
            os::run_first(first.then_some(self.rank));
        }
        *watch = Watch {
            since: now,
            ran,
            first,
        };
    }
}

/// Returns whether a thread that ran for a part of some time is first from then on.
fn stays_first(is: bool, ran: Duration, passed: Duration) -> bool {
    let most = if is { ABOVE } else { BELOW };
    ran * 100 <= passed * most
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_that_needs_much_shares_until_it_needs_little() {
        let of = |is, percent| stays_first(is, BEFORE_AGAIN * percent / 100, BEFORE_AGAIN);
        assert!(of(true, 75));
        assert!(!of(true, 76));
        assert!(!of(false, 51));
        assert!(of(false, 50));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_thread_that_computes_is_not_first_for_long() {
        let policy = || {
            let text = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
            // the name may have blanks; the policy is field 41
            let after = text.rsplit_once(") ").unwrap().1;
            after.split(' ').nth(38).unwrap().parse::<u32>().unwrap()
        };
        let first = std::thread::spawn(move || {
            let mut first = First::new(Rank::Frames);
            let permitted = first.watch.is_some();
            let before = policy();
            let end = std::time::Instant::now() + Duration::from_secs(20);
            while policy() != 0 && std::time::Instant::now() < end {
                first.turn(os::now());
            }
            (permitted, before, policy())
        });
        let (permitted, before, after) = first.join().unwrap();
        // SCHED_RR is 2, SCHED_OTHER 0
        assert_eq!(before, if permitted { 2 } else { 0 });
        assert_eq!(after, 0);
    }
}
