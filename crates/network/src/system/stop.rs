//! Ending a blocking program: Ctrl-C, or another thread.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::os::Event;

/// A signal again within this time, ms, means the same as the one before: a hasty Ctrl-C, a program that ends its whole
/// group.
pub(super) const SAME_SIGNAL: u64 = 1000;

/// Requests to stop, from any thread: the first one ends what waits and stops an axis along its ramp, the second makes that a
/// quick stop, the third ends the wait for it. Requests within a second count as one. Clones count together.
///
/// ```
/// use profidrive_network::system::StopRequests;
/// let requests = StopRequests::default();
/// requests.request();
/// requests.request(); // a hasty one
/// assert!(requests.is_stopped() && !requests.is_urgent());
/// requests.clear();
/// assert!(!requests.is_stopped());
/// ```
#[derive(Debug, Clone, Default)]
pub struct StopRequests {
    counted: Arc<Mutex<Counted>>,
}

#[derive(Debug, Default)]
struct Counted {
    count: u32,
    last: Option<Instant>,
}

impl StopRequests {
    fn counted(&self) -> MutexGuard<'_, Counted> {
        self.counted.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn count(&self) -> u32 {
        self.counted().count
    }

    /// Requests a stop.
    pub fn request(&self) {
        self.request_at(Instant::now());
    }

    fn request_at(&self, now: Instant) {
        let mut counted = self.counted();
        let again = |last| now.saturating_duration_since(last) <= Duration::from_millis(SAME_SIGNAL);
        if !counted.last.is_some_and(again) {
            counted.count += 1;
            counted.last = Some(now);
        }
    }

    /// Forgets all requests, before something else begins.
    pub fn clear(&self) {
        *self.counted() = Counted::default();
    }

    /// Returns true once a stop is requested.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.count() > 0
    }

    /// Returns true from the second request on: what takes its time is to be cut short.
    #[must_use]
    pub fn is_urgent(&self) -> bool {
        self.count() > 1
    }

    /// Returns true from the third request on: the caller waits no longer.
    #[must_use]
    pub fn is_final(&self) -> bool {
        self.count() > 2
    }
}

/// A stop flag that wakes the runner or medium it was given to. Clones are the same flag.
///
/// ```
/// # fn main() -> std::io::Result<()> {
/// use profidrive_network::system::Stop;
/// let stop = Stop::new()?;
/// let other = stop.clone();
/// std::thread::spawn(move || other.stop()).join().expect("the thread ends");
/// assert!(stop.is_stopped());
/// # Ok(()) }
/// ```
#[derive(Debug, Clone)]
pub struct Stop {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    set: AtomicBool,
    event: Event,
}

impl Inner {
    fn new() -> io::Result<Arc<Self>> {
        Ok(Arc::new(Self {
            set: AtomicBool::new(false),
            event: Event::new()?,
        }))
    }

    fn set(&self) {
        self.set.store(true, Ordering::SeqCst);
        self.event.raise();
    }
}

/// Which signal ends the program at once, as without a handler. Signals within a second count as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForcedExit {
    /// The second one.
    Second,
    /// The third one: the second makes the flag [urgent](Stop::is_urgent), for a program whose end may take long.
    Third,
}

/// Wakes a runner again and again, from another thread that has work for it. Clones are the same bell.
#[derive(Debug, Clone)]
pub struct Bell {
    inner: Arc<Inner>,
}

impl Bell {
    /// Returns a bell that is silent.
    ///
    /// # Errors
    /// When the operating system has no descriptor left.
    pub fn new() -> io::Result<Self> {
        Inner::new().map(|inner| Self { inner })
    }

    /// Ends the present or the next wait.
    pub fn ring(&self) {
        self.inner.set();
    }

    /// Returns true if it has rung since the last look.
    #[must_use]
    pub fn was_rung(&self) -> bool {
        let rung = self.inner.set.swap(false, Ordering::SeqCst);
        if rung {
            self.inner.event.clear();
        }
        rung
    }

    /// Ends the wait for its event after it has ended one: its flag may have been taken before the event was raised, and an event that
    /// stays raised would end each wait until it rings again. A flag that is set stays so.
    #[cfg(target_os = "linux")]
    pub(crate) fn quiet(&self) {
        self.inner.event.clear();
    }

    /// Raised once it has rung.
    #[cfg(target_os = "linux")]
    pub(crate) fn event(&self) -> &Event {
        &self.inner.event
    }
}

/// Who may end a wait early.
#[derive(Debug, Clone, Default)]
pub struct Calls {
    /// Once.
    pub stop: Option<Stop>,
    /// Whenever it rings.
    pub bell: Option<Bell>,
}

impl Calls {
    /// Returns the flag. A flag that is set already does not wake, as its owner may have things to bring to an end.
    pub(super) fn stop(&self) -> Option<&Stop> {
        self.stop.as_ref().filter(|stop| !stop.is_stopped())
    }

    /// Returns true if the bell has rung since the last look.
    pub(crate) fn was_rung(&self) -> bool {
        self.bell.as_ref().is_some_and(Bell::was_rung)
    }
}

impl Stop {
    /// Returns a flag that only the program sets.
    ///
    /// # Errors
    /// When the operating system has no descriptor left.
    pub fn new() -> io::Result<Self> {
        Inner::new().map(|inner| Self { inner })
    }

    /// Returns a flag that Ctrl-C (SIGINT), Ctrl-\ (SIGQUIT), SIGTERM and a terminal that goes away (SIGHUP, unless
    /// ignored as by `nohup`) set; on other systems than Linux what ends a program there. Signals within a second count
    /// as one; a later one ends the program at once, as without this.
    ///
    /// # Errors
    /// When the operating system has no descriptor left or refuses the handler.
    pub fn on_signals() -> io::Result<Self> {
        Self::on_signals_with(ForcedExit::Second)
    }

    /// Returns the same, and `forced_exit` states which signal ends the program at once.
    ///
    /// # Errors
    /// When the operating system has no descriptor left or refuses the handler.
    pub fn on_signals_with(forced_exit: ForcedExit) -> io::Result<Self> {
        let stop = Self::new()?;
        // The event must stay as long as a signal may come: for ever.
        std::mem::forget(stop.clone());
        stop.inner.event.on_signals(match forced_exit {
            ForcedExit::Second => 2,
            ForcedExit::Third => 3,
        })?;
        Ok(stop)
    }

    /// Sets the flag and wakes all waiting threads.
    pub fn stop(&self) {
        self.inner.set();
    }

    /// Returns true once the flag is set.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.inner.event.signals() > 0 || self.inner.set.load(Ordering::SeqCst)
    }

    /// Returns true once a second signal came, more than a second after the first: what takes its time is to be cut
    /// short.
    #[must_use]
    pub fn is_urgent(&self) -> bool {
        self.inner.event.signals() > 1
    }

    /// Raised once the flag is set.
    #[cfg(target_os = "linux")]
    pub(crate) fn event(&self) -> &Event {
        &self.inner.event
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_within_a_second_count_as_one() {
        let requests = StopRequests::default();
        let begin = Instant::now();
        let mut counted = Vec::new();
        for millis in [0, 900, 1100, 2000, 2200] {
            requests.clone().request_at(begin + Duration::from_millis(millis));
            counted.push((requests.is_stopped(), requests.is_urgent(), requests.is_final()));
        }
        let (one, two, three) = ((true, false, false), (true, true, false), (true, true, true));
        assert_eq!(counted, [one, one, two, two, three]);
    }

    #[test]
    fn a_bell_wakes_once_for_any_number_of_rings() {
        let bell = Bell::new().unwrap();
        assert!(!bell.was_rung());
        bell.clone().ring();
        bell.ring();
        assert!(bell.was_rung());
        assert!(!bell.was_rung());
        bell.ring();
        assert!(bell.was_rung());
    }
}
