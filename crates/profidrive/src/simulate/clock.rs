//! A plant in memory that goes on by the clock.

use std::net::SocketAddrV4;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant as Clock};

use client::{Driver, Engine};
use profinet::{Endpoint, Instant, IpSuite, MacAddress, Medium, Traffic, Transmit};

/// What the plant may be behind the clock, after a computer that slept: it does not make up for more.
pub const MOST_BEHIND: Duration = Duration::from_secs(1);
/// Time between two looks at whether a plant whose time stands still goes on.
const PAUSE: Duration = Duration::from_millis(20);

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A plant that is carried, looked at and changed by turns. Clones are the same plant.
#[derive(Debug, Clone)]
pub(super) struct Shared {
    world: Arc<Mutex<Present>>,
    /// The time of its users in nanoseconds, to be read at any moment.
    time: Arc<AtomicU64>,
    /// Whether time stands still for those who go by the clock.
    paused: Arc<AtomicBool>,
}

/// The plant as it was started last.
#[derive(Debug)]
struct Present {
    world: plant::World,
    /// The time of its users when it was started: theirs never goes back.
    base: Duration,
}

impl Present {
    fn now(&self) -> Instant {
        self.world.now() + self.base
    }
}

/// An endpoint whose time began before that of the plant.
struct Earlier<'e> {
    endpoint: &'e mut dyn Endpoint,
    base: Duration,
}

impl Endpoint for Earlier<'_> {
    fn mac(&self) -> MacAddress {
        self.endpoint.mac()
    }

    fn ip(&self) -> IpSuite {
        self.endpoint.ip()
    }

    fn name(&self) -> Option<&str> {
        self.endpoint.name()
    }

    fn acquires_address(&self) -> bool {
        self.endpoint.acquires_address()
    }

    fn take_address(&mut self, now: Instant, suite: IpSuite) {
        self.endpoint.take_address(now + self.base, suite);
    }

    fn serves(&self, port: u16) -> bool {
        self.endpoint.serves(port)
    }

    fn note_traffic(&mut self, traffic: Traffic, frame: &[u8]) {
        self.endpoint.note_traffic(traffic, frame);
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        self.endpoint.handle_frame(now + self.base, frame);
    }

    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]) {
        self.endpoint
            .handle_datagram(now + self.base, source, local_port, payload);
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.endpoint.handle_timeout(now + self.base);
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        self.endpoint.poll_transmit(now + self.base, buffer)
    }

    fn poll_timeout(&self) -> Option<Instant> {
        let due = self.endpoint.poll_timeout()?;
        // what was due before the plant began is due at its begin
        Some(before(due, self.base))
    }
}

/// A time of the users as that of a plant which began at `base`.
fn before(time: Instant, base: Duration) -> Instant {
    Instant::ZERO + time.saturating_since(Instant::ZERO + base)
}

impl Shared {
    pub fn new(world: plant::World) -> Self {
        Self {
            time: Arc::new(AtomicU64::new(world.now().as_nanos())),
            world: Arc::new(Mutex::new(Present {
                world,
                base: Duration::ZERO,
            })),
            paused: Arc::default(),
        }
    }

    /// Puts another plant in the place of this one. It begins now; returns when that is, by the time of its users.
    pub fn replace(&self, make: impl FnOnce(Duration) -> plant::World) {
        let mut present = locked(&self.world);
        let base = present.now().saturating_since(Instant::ZERO);
        *present = Present {
            world: make(base),
            base,
        };
    }

    /// Lets time stand still, or go on.
    pub fn pause(&self, paused: bool) {
        self.paused.store(paused, Ordering::Release);
    }

    pub fn is_paused(&self) -> bool {
        self.paused.load(Ordering::Acquire)
    }

    /// Calls `work` with the plant, which may also let it go on.
    pub fn with<T>(&self, work: impl FnOnce(&mut plant::World) -> T) -> T {
        let mut present = locked(&self.world);
        let result = work(&mut present.world);
        self.time.store(present.now().as_nanos(), Ordering::Release);
        result
    }

    /// Returns when something happens next, by the time of its users.
    fn next_event(&self) -> Instant {
        let present = locked(&self.world);
        let next = present.world.next_event();
        if next == Instant::MAX {
            next
        } else {
            next + present.base
        }
    }
}

impl Medium for Shared {
    type Error = std::convert::Infallible;

    fn now(&self) -> Instant {
        Instant::from_nanos(self.time.load(Ordering::Acquire))
    }

    fn step(&mut self, endpoint: &mut dyn Endpoint, until: Instant) -> Result<(), Self::Error> {
        let mut present = locked(&self.world);
        let base = present.base;
        let mut earlier = Earlier { endpoint, base };
        let stepped = present.world.step(&mut earlier, before(until, base));
        self.time.store(present.now().as_nanos(), Ordering::Release);
        stepped
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
        if plant.is_paused() {
            waker.sleep(PAUSE);
            (begin, origin) = (Clock::now(), plant.now());
            continue;
        }
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
            let next = next.min(plant.next_event());
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
