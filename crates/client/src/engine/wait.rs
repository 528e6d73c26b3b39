//! Waiting for a call without a runtime.

use std::cell::{Cell, RefCell};
use std::future::Future;
use std::pin::{Pin, pin};
use std::sync::{Arc, Weak};
use std::task::{Context, Poll, Wake, Waker};
use std::thread::Thread;
use std::time::Duration;

use super::Driver;

thread_local! {
    /// Who carries the calls that this thread looked at.
    static DRIVERS: RefCell<Vec<Weak<dyn Driver>>> = const { RefCell::new(Vec::new()) };
    /// This thread turns drivers itself: it waits, or takes a turn for an executor.
    static TURNS: Cell<bool> = const { Cell::new(false) };
}

/// Sets that this thread turns drivers, until it is dropped.
struct Turning {
    before: bool,
}

impl Turning {
    fn begin() -> Self {
        Self {
            before: TURNS.replace(true),
        }
    }
}

impl Drop for Turning {
    fn drop(&mut self) {
        TURNS.set(self.before);
    }
}

/// Registers the driver of a pending call. Under an executor that is not [`Wait::wait`], nothing else would carry a network in
/// memory: there each look at a pending call is a turn, after which the call is to be looked at again.
pub(super) fn driven_by(driver: Option<&Weak<dyn Driver>>, waker: &Waker) {
    let Some(driver) = driver else { return };
    if !TURNS.get() {
        let _turning = Turning::begin();
        if driver.upgrade().is_some_and(|driver| driver.turn()) {
            waker.wake_by_ref();
        }
        return;
    }
    DRIVERS.with_borrow_mut(|drivers| {
        if !drivers.iter().any(|known| known.ptr_eq(driver)) {
            drivers.push(driver.clone());
        }
    });
}

/// Waits for calls; every future has it.
///
/// Where a thread of its own carries the bytes of a network, the caller sleeps meanwhile. Otherwise the caller carries
/// them itself: a network in memory advances only while a call waits, or while an executor looks at one. Several calls at once are one future:
/// `futures::future::join_all(calls).wait()`.
pub trait Wait: Future + Sized {
    /// Waits for the result.
    fn wait(self) -> Self::Output {
        let mut call = pin!(self);
        loop {
            if let Some(result) = until(call.as_mut(), FOREVER, || false) {
                return result;
            }
        }
    }

    /// Waits for the result unless it is given up, and asks that at least every so often, in this thread: there it can look at
    /// signals, for example. A call that is given up is dropped, which is safe as for every future here: an axis is brought to
    /// rest without it.
    fn wait_unless(self, every: Duration, given_up: impl FnMut() -> bool) -> Option<Self::Output> {
        until(pin!(self), every, given_up)
    }
}

impl<F: Future> Wait for F {}

/// Longer than any wait.
const FOREVER: Duration = Duration::from_secs(365 * 24 * 3600);

fn until<F: Future>(
    mut call: Pin<&mut F>,
    every: Duration,
    mut given_up: impl FnMut() -> bool,
) -> Option<F::Output> {
    let waker = Waker::from(Arc::new(Sleeper(std::thread::current())));
    let mut context = Context::from_waker(&waker);
    let _turning = Turning::begin();
    let before = DRIVERS.take();
    let result = loop {
        if let Poll::Ready(result) = call.as_mut().poll(&mut context) {
            break Some(result);
        }
        if given_up() {
            break None;
        }
        // of several calls that are one future only those are looked at that were woken: their drivers stay known
        let drivers = DRIVERS.with_borrow(Clone::clone);
        let mut turned = false;
        for driver in drivers.iter().filter_map(Weak::upgrade) {
            turned |= driver.turn();
        }
        if !turned {
            std::thread::park_timeout(every);
        }
    };
    DRIVERS.set(before);
    result
}

/// A thread that waits.
struct Sleeper(Thread);

impl Wake for Sleeper {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}
