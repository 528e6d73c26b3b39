//! Waiting for a call without a runtime.

use std::cell::RefCell;
use std::future::Future;
use std::pin::pin;
use std::sync::{Arc, Weak};
use std::task::{Context, Poll, Wake, Waker};
use std::thread::Thread;

use super::Driver;

thread_local! {
    /// Who carries the calls that this thread looked at.
    static DRIVERS: RefCell<Vec<Weak<dyn Driver>>> = const { RefCell::new(Vec::new()) };
}

/// Registers the driver of a waiting call.
pub(super) fn driven_by(driver: Option<&Weak<dyn Driver>>) {
    let Some(driver) = driver else { return };
    DRIVERS.with_borrow_mut(|drivers| {
        if !drivers.iter().any(|known| known.ptr_eq(driver)) {
            drivers.push(driver.clone());
        }
    });
}

/// Waits for calls; every future has it.
///
/// Where a thread of its own carries the bytes of a network, the caller sleeps meanwhile. Otherwise the caller carries
/// them itself: a network in memory advances only while a call waits. Several calls at once are one future:
/// `futures::future::join_all(calls).wait()`.
pub trait Wait: Future + Sized {
    /// Waits for the result.
    fn wait(self) -> Self::Output {
        let mut call = pin!(self);
        let waker = Waker::from(Arc::new(Sleeper(std::thread::current())));
        let mut context = Context::from_waker(&waker);
        let before = DRIVERS.take();
        let result = loop {
            if let Poll::Ready(result) = call.as_mut().poll(&mut context) {
                break result;
            }
            // of several calls that are one future only those are looked at that were woken: their drivers stay known
            let drivers = DRIVERS.with_borrow(Clone::clone);
            let mut turned = false;
            for driver in drivers.iter().filter_map(Weak::upgrade) {
                turned |= driver.turn();
            }
            if !turned {
                std::thread::park();
            }
        };
        DRIVERS.set(before);
        result
    }
}

impl<F: Future> Wait for F {}

/// A thread that waits.
struct Sleeper(Thread);

impl Wake for Sleeper {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}
