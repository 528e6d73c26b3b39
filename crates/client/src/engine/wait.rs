//! Waiting for a call without a runtime.

use std::cell::{Cell, RefCell};
use std::future::Future;
use std::pin::{Pin, pin};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::task::{Context, Poll, Wake, Waker};
use std::thread::Thread;
use std::time::{Duration, Instant};

use super::Driver;

thread_local! {
    /// Who carries the calls that this thread looked at.
    static DRIVERS: RefCell<Vec<Weak<dyn Driver>>> = const { RefCell::new(Vec::new()) };
    /// What this thread does.
    static DOES: Cell<Does> = const { Cell::new(Does::Other) };
    /// This thread, as the others see it.
    static OWN: Arc<Sleeper> = Arc::new(Sleeper {
        thread: std::thread::current(),
        looks: AtomicBool::new(true),
        woken: AtomicBool::new(false),
    });
}

/// What a thread does.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Does {
    /// Neither of these.
    Other,
    /// It waits for a call, and turns drivers meanwhile.
    Waits,
    /// It takes a turn for an executor.
    Turns,
}

/// Sets what this thread does, until it is dropped.
struct Doing {
    before: Does,
}

impl Doing {
    fn begin(does: Does) -> Self {
        Self {
            before: DOES.replace(does),
        }
    }
}

impl Drop for Doing {
    fn drop(&mut self) {
        DOES.set(self.before);
    }
}

/// Notes that the call which this thread waits for uses a driver: from its first look at the network on, not from its first wait
/// for a turn. Time that passes in between would be missing to the call.
pub(super) fn note(driver: Option<&Weak<dyn Driver>>) {
    if let Some(driver) = driver.filter(|_| DOES.get() == Does::Waits) {
        DRIVERS.with_borrow_mut(|drivers| {
            if !drivers.iter().any(|known| known.ptr_eq(driver)) {
                drivers.push(driver.clone());
                join(driver);
            }
        });
    }
}

/// Registers the driver of a pending call. Under an executor that is not [`Wait::wait`], nothing else would carry a network in
/// memory: there each look at a pending call is a turn, after which the call is to be looked at again.
pub(super) fn driven_by(driver: Option<&Weak<dyn Driver>>, waker: &Waker) {
    let Some(driver) = driver else { return };
    if DOES.get() == Does::Other {
        let _turning = Doing::begin(Does::Turns);
        let turns = |driver: Arc<dyn Driver>| driver.turn() || driver.waiters().is_some();
        if driver.upgrade().is_some_and(turns) {
            waker.wake_by_ref();
        }
        return;
    }
    note(Some(driver));
}

/// This thread waits for a driver from now on.
fn join(driver: &Weak<dyn Driver>) {
    if let Some(waiters) = driver.upgrade().as_ref().and_then(|driver| driver.waiters()) {
        OWN.with(|own| locked(&waiters.threads).push(Arc::clone(own)));
    }
}

/// It does not any more; another one takes the turns.
fn leave(driver: &Weak<dyn Driver>) {
    if let Some(waiters) = driver.upgrade().as_ref().and_then(|driver| driver.waiters()) {
        let mut threads = locked(&waiters.threads);
        let own = OWN.with(|own| threads.iter().position(|one| Arc::ptr_eq(one, own)));
        own.map(|place| threads.swap_remove(place));
        if let Some(next) = threads.iter().find(|one| !one.looks.load(Ordering::SeqCst)) {
            next.thread.unpark();
        }
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The threads that wait for a network in memory. Its time passes only while all of them have nothing to do: one whose call was
/// answered looks at the answer first, however late the computer runs it. A thread that is not inside of a wait holds nothing up.
#[derive(Debug, Default)]
pub struct Waiters {
    threads: Mutex<Vec<Arc<Sleeper>>>,
}

impl Waiters {
    /// Begins a turn of this thread. False where it is not to take one: it has to look at its call first, or another thread has,
    /// which takes the next turn or leaves it to this one.
    pub(super) fn begin_turn(&self) -> bool {
        OWN.with(|own| {
            let threads = locked(&self.threads);
            own.looks.store(false, Ordering::SeqCst);
            let waits = own.woken.load(Ordering::SeqCst);
            let mut others = threads.iter().filter(|one| !Arc::ptr_eq(one, own));
            let turns = !waits && others.all(|one| !one.looks.load(Ordering::SeqCst));
            if waits || turns {
                own.looks.store(true, Ordering::SeqCst);
            }
            turns
        })
    }
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
    let own = OWN.with(Arc::clone);
    let waker = Waker::from(Arc::clone(&own));
    let mut context = Context::from_waker(&waker);
    let _doing = Doing::begin(Does::Waits);
    let _waiting = Waiting {
        before: DRIVERS.take(),
    };
    let mut asked = Instant::now();
    loop {
        own.looks.store(true, Ordering::SeqCst);
        own.woken.store(false, Ordering::SeqCst);
        if let Poll::Ready(result) = call.as_mut().poll(&mut context) {
            return Some(result);
        }
        // of several calls that are one future only those are looked at that were woken: their drivers stay known
        let drivers = DRIVERS.with_borrow(Clone::clone);
        if asked.elapsed() >= every {
            // what it does may take long, and may wait for another thread
            drivers.iter().for_each(leave);
            let ends = given_up();
            drivers.iter().for_each(join);
            if ends {
                return None;
            }
            asked = Instant::now();
        }
        let mut turned = false;
        for driver in drivers.iter().filter_map(Weak::upgrade) {
            turned |= driver.turn();
        }
        if !turned {
            std::thread::park_timeout(every.saturating_sub(asked.elapsed()));
        }
    }
}

/// A wait of this thread, with the drivers of the one that it is inside of.
struct Waiting {
    before: Vec<Weak<dyn Driver>>,
}

impl Drop for Waiting {
    fn drop(&mut self) {
        DRIVERS.take().iter().for_each(leave);
        if !self.before.is_empty() {
            DRIVERS.set(std::mem::take(&mut self.before));
            // what woke the outer call may have woken this one
            OWN.with(|own| {
                own.woken.store(true, Ordering::SeqCst);
                own.thread.unpark();
            });
        }
    }
}

/// A thread that waits.
#[derive(Debug)]
struct Sleeper {
    thread: Thread,
    /// It looks at its call or takes a turn, or is about to.
    looks: AtomicBool,
    /// Another thread woke it since it began to look.
    woken: AtomicBool,
}

impl Wake for Sleeper {
    fn wake(self: Arc<Self>) {
        self.wake_by_ref();
    }

    fn wake_by_ref(self: &Arc<Self>) {
        // it looks after its own turn anyway
        if !OWN.try_with(|own| Arc::ptr_eq(own, self)).unwrap_or(false) {
            self.woken.store(true, Ordering::SeqCst);
            self.looks.store(true, Ordering::SeqCst);
        }
        self.thread.unpark();
    }
}
