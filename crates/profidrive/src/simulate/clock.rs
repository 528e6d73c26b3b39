//! A plant in memory that goes on by the clock.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant as Clock};

use client::{Driver, Engine};
use profinet::{Endpoint, Instant, Medium};

/// What the plant may be behind the clock, after a computer that slept: it does not make up for more.
const MOST_BEHIND: Duration = Duration::from_secs(1);

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A plant that is carried, looked at and changed by turns. Clones are the same plant.
#[derive(Debug, Clone)]
pub(super) struct Shared {
    world: Arc<Mutex<plant::World>>,
    /// Its time in nanoseconds, to be read at any moment.
    time: Arc<AtomicU64>,
}

impl Shared {
    pub fn new(world: plant::World) -> Self {
        Self {
            time: Arc::new(AtomicU64::new(world.now().as_nanos())),
            world: Arc::new(Mutex::new(world)),
        }
    }

    /// Calls `work` with the plant, which may also let it go on.
    pub fn with<T>(&self, work: impl FnOnce(&mut plant::World) -> T) -> T {
        let mut world = locked(&self.world);
        let result = work(&mut world);
        self.time.store(world.now().as_nanos(), Ordering::Release);
        result
    }
}

impl Medium for Shared {
    type Error = std::convert::Infallible;

    fn now(&self) -> Instant {
        Instant::from_nanos(self.time.load(Ordering::Acquire))
    }

    fn step(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> Result<(), Self::Error> {
        self.with(|world| world.step(endpoint, until))
    }
}

/// What callers and the thread of a plant share.
#[derive(Debug, Default)]
struct Waker {
    rung: Mutex<bool>,
    bell: Condvar,
    ended: AtomicBool,
}

impl Waker {
    fn ring(&self) {
        *locked(&self.rung) = true;
        self.bell.notify_one();
    }

    /// Sleeps until a caller rings, at most for `limit`.
    fn sleep(&self, limit: Duration) {
        let rung = locked(&self.rung);
        let waited = self.bell.wait_timeout_while(rung, limit, |rung| !*rung);
        *waited.unwrap_or_else(PoisonError::into_inner).0 = false;
    }
}

/// Lets a plant go on by the clock of this computer in a thread of its own, whether calls wait or not.
#[derive(Debug)]
pub(super) struct ByTheClock {
    waker: Arc<Waker>,
    plant: Shared,
    thread: Mutex<Option<JoinHandle<()>>>,
}

impl ByTheClock {
    pub fn start(engine: Engine, plant: Shared) -> std::io::Result<Arc<Self>> {
        let waker = Arc::new(Waker::default());
        let (carried, woken) = (plant.clone(), Arc::clone(&waker));
        let thread = thread::Builder::new()
            .name("profidrive-plant".into())
            .spawn(move || carry(&engine, carried, &woken))?;
        Ok(Arc::new(Self {
            waker,
            plant,
            thread: Mutex::new(Some(thread)),
        }))
    }
}

/// Ends every call when the thread ends, by a panic too.
struct End<'e>(&'e Engine);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.end();
    }
}

fn carry(engine: &Engine, mut plant: Shared, waker: &Waker) {
    let _end = End(engine);
    let (mut begin, mut origin) = (Clock::now(), plant.now());
    while !waker.ended.load(Ordering::Acquire) {
        let due = engine.begin_turn(plant.now());
        let clock = origin + begin.elapsed();
        let Ok(()) = plant.step(&mut engine.clone(), due.min(clock));
        let now = plant.now();
        engine.end_turn(now, None);
        if clock - now > MOST_BEHIND {
            (begin, origin) = (Clock::now(), now);
        }
        if now >= due.min(clock) {
            let next = engine.poll_timeout().map_or(due, |own| own.min(due));
            let next = next.min(plant.with(|world| world.next_event()));
            waker.sleep(next - (origin + begin.elapsed()));
        }
    }
}

impl Driver for ByTheClock {
    fn now(&self) -> Option<Instant> {
        Some(self.plant.now())
    }

    fn turn(&self) -> bool {
        false
    }

    fn ring(&self) {
        self.waker.ring();
    }

    fn end(&self) {
        self.waker.ended.store(true, Ordering::Release);
        self.waker.ring();
        let thread = locked(&self.thread).take();
        if let Some(thread) = thread {
            // a panic in there has ended every call already
            let _ = thread.join();
        }
    }
}
