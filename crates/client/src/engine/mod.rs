//! What callers and the driver of a network share: the client inside, the callers that wait, and what has still to be done.
//!
//! A call is a future that checks the client, posts its request and waits for the next turn. The driver carries bytes
//! and time: each of its turns handles what came and wakes the calls that this may concern. With hundreds of axes most turns
//! concern one of them.

mod driver;
mod queue;
mod wait;
mod wire;

use std::collections::BTreeMap;
use std::future::Future;
use std::net::SocketAddrV4;
use std::ops::{Deref, DerefMut};
use std::pin::Pin;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, RwLock, RwLockReadGuard, Weak};
use std::task::{Context, Poll, Wake, Waker};
use std::time::Duration;

use profinet::{Endpoint, Instant, IpSuite, MacAddress, Transmit};

use crate::client::News;
use crate::session::Records;
use crate::{Client, Error, Link, WireFailure};

pub use driver::{Driver, World};
pub(crate) use queue::{At, Queues, Turn, at};
pub use wait::{Wait, Waiters};
pub use wire::Wire;

/// How long a driver sleeps when no call waits.
const IDLE: Duration = Duration::from_millis(50);
/// Every event comes before that.
const FAR: Duration = Duration::from_secs(3600);

/// A background operation: an axis that is brought to rest.
type Task = Pin<Box<dyn Future<Output = ()> + Send>>;

/// The client of a network, shared by all who use it; clones are the same one.
///
/// A [`Driver`] carries its bytes: it is an [`Endpoint`] on a network, and has octets for a serial line.
#[derive(Clone)]
pub struct Engine {
    shared: Arc<Shared>,
}

struct Shared {
    client: Mutex<Client>,
    turns: Mutex<Turns>,
    records: Mutex<Records>,
    driver: OnceLock<Weak<dyn Driver>>,
    /// The time of the last turn, in nanoseconds.
    time: AtomicU64,
    /// When the driver wakes at the latest, in nanoseconds.
    wakes: AtomicU64,
    /// All waiting calls must look, whatever the client has to report.
    happened: AtomicBool,
    /// Turns with an event, or in which all had to look.
    events: AtomicU64,
    /// A background operation can go on.
    tasks_wake: Arc<TasksWake>,
    /// The client may have something to send.
    touched: AtomicBool,
    /// Stations are found by DCP.
    discovery: AtomicBool,
    /// Drives can call their controller here.
    calls: AtomicBool,
    /// The drives end with this program.
    simulated: AtomicBool,
    /// Every axis is to be brought to rest.
    closing: RwLock<bool>,
}

/// Wakes the background operations, in the next turn.
#[derive(Default)]
struct TasksWake(AtomicBool);

impl Wake for TasksWake {
    fn wake(self: Arc<Self>) {
        self.0.store(true, Ordering::Release);
    }
}

/// Which turns concern a waiting call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Interest {
    /// Those with an event: an answer, a connection that changed.
    Events,
    /// Also those with inputs of this axis.
    Axis(Link),
    /// Also those with inputs of any axis.
    Anything,
}

impl Interest {
    fn is_met(self, news: &News) -> bool {
        let axes = &news.axes;
        news.everything
            || match self {
                Self::Events => false,
                Self::Axis(link) => axes.contains(&link),
                Self::Anything => !axes.is_empty(),
            }
    }
}

/// Who waits for the next turn, and what happens in each.
#[derive(Default)]
struct Turns {
    number: u64,
    next_key: u64,
    waiting: BTreeMap<u64, Waiting>,
    /// Room for those who are woken, kept from turn to turn.
    woken: Vec<Waker>,
    tasks: Vec<Task>,
    /// Of them, those that the driver looks at now and has therefore taken out.
    under_way: usize,
    /// The last failure of the wire, with its turn: a call that was woken later finds it anyway.
    failure: Option<(u64, WireFailure)>,
    /// There are no more turns.
    ended: bool,
    /// They ended by a panic of whoever took them.
    failed: bool,
}

impl Turns {
    /// Why there are no more turns.
    const fn end(&self) -> Error {
        if self.failed {
            Error::DriverFailed
        } else {
            Error::Closed
        }
    }
}

/// A waiting call.
struct Waiting {
    /// The turn in which it began.
    begun: u64,
    until: Instant,
    interest: Interest,
    /// Its turn has come.
    woken: bool,
    waker: Waker,
}

impl std::fmt::Debug for Engine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Engine").finish_non_exhaustive()
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // what a panic left behind is whole: nothing in here is changed in two steps
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Engine {
    /// Returns the engine around a client.
    #[must_use]
    pub fn new(client: Client) -> Self {
        Self {
            shared: Arc::new(Shared {
                client: Mutex::new(client),
                turns: Mutex::default(),
                records: Mutex::default(),
                driver: OnceLock::new(),
                time: AtomicU64::new(0),
                wakes: AtomicU64::new(0),
                happened: AtomicBool::new(false),
                events: AtomicU64::new(0),
                tasks_wake: Arc::default(),
                touched: AtomicBool::new(false),
                discovery: AtomicBool::new(true),
                calls: AtomicBool::new(true),
                simulated: AtomicBool::new(false),
                closing: RwLock::new(false),
            }),
        }
    }

    /// Names its driver, once.
    pub(crate) fn driven_by(&self, driver: Weak<dyn Driver>) {
        // a second driver is not taken: two of them would tear the time apart
        let _ = self.shared.driver.set(driver);
    }

    fn driver(&self) -> Option<Arc<dyn Driver>> {
        self.shared.driver.get()?.upgrade()
    }

    /// Returns the client inside, to start something; not to be held while waiting.
    pub(crate) fn client(&self) -> Touched<'_> {
        wait::note(self.shared.driver.get());
        Touched {
            client: self.quietly(),
            touched: &self.shared.touched,
        }
    }

    /// Returns the client inside, to take what it has: nothing is sent for that.
    pub(crate) fn quietly(&self) -> MutexGuard<'_, Client> {
        locked(&self.shared.client)
    }

    /// Returns the table of connections for records.
    pub(crate) fn records(&self) -> MutexGuard<'_, Records> {
        wait::note(self.shared.driver.get());
        locked(&self.shared.records)
    }

    /// Returns the present time.
    #[must_use]
    pub fn now(&self) -> Instant {
        wait::note(self.shared.driver.get());
        let last = || Instant::from_nanos(self.shared.time.load(Ordering::Relaxed));
        self.driver().and_then(|driver| driver.now()).unwrap_or_else(last)
    }

    pub(crate) fn discovers(&self) -> bool {
        self.shared.discovery.load(Ordering::Relaxed)
    }

    pub(crate) fn set_discovers(&self, discovers: bool) {
        self.shared.discovery.store(discovers, Ordering::Relaxed);
    }

    pub(crate) fn receives_calls(&self) -> bool {
        self.shared.calls.load(Ordering::Relaxed)
    }

    pub(crate) fn set_hears_calls(&self, hears: bool) {
        self.shared.calls.store(hears, Ordering::Relaxed);
    }

    /// Returns whether the drives exist in the memory of this program only, and end with it.
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        self.shared.simulated.load(Ordering::Relaxed)
    }

    pub(crate) fn set_simulated(&self) {
        self.shared.simulated.store(true, Ordering::Relaxed);
    }

    /// Returns true once every axis is to be brought to rest.
    pub(crate) fn is_closing(&self) -> bool {
        *self.shared.closing.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Registers an operation that must end before the network is left: leaving waits until this guard is dropped.
    ///
    /// # Errors
    /// [`Error::Closed`] when the network is being left.
    pub(crate) fn stay_open(&self) -> Result<RwLockReadGuard<'_, bool>, Error> {
        let closing = self.shared.closing.read().unwrap_or_else(PoisonError::into_inner);
        if *closing { Err(Error::Closed) } else { Ok(closing) }
    }

    pub(crate) fn begin_closing(&self) {
        *self
            .shared
            .closing
            .write()
            .unwrap_or_else(PoisonError::into_inner) = true;
        self.stir();
    }

    /// Wakes all waiting calls and background operations.
    pub fn stir(&self) {
        self.shared.happened.store(true, Ordering::Release);
        self.ring();
    }

    /// Lets the driver look again before the time that it sleeps until.
    fn ring(&self) {
        if let Some(driver) = self.driver() {
            driver.ring();
        }
    }

    /// Waits for the next turn that `interest` is met in, at most until `until`.
    pub(crate) fn next_turn(&self, until: Instant, interest: Interest) -> NextTurn {
        NextTurn {
            engine: self.clone(),
            until,
            interest,
            since: None,
            key: None,
        }
    }

    /// Waits until `done`, which an event or [`stir`](Self::stir) makes true; false once there are no more turns.
    pub(crate) async fn until(&self, done: impl Fn() -> bool) -> bool {
        loop {
            let events = self.events();
            if done() {
                return true;
            }
            let turn = self.next_turn(self.now() + FAR, Interest::Events).since(events);
            if turn.await.is_err_and(|error| error.is_final()) {
                return false;
            }
        }
    }

    /// Returns the number of events so far, to be taken before a look: see [`NextTurn::since`].
    pub(crate) fn events(&self) -> u64 {
        self.shared.events.load(Ordering::Acquire)
    }

    /// Runs an operation in the background until it is done.
    pub(crate) fn spawn(&self, task: impl Future<Output = ()> + Send + 'static) {
        locked(&self.shared.turns).tasks.push(Box::pin(task));
        self.shared.tasks_wake.wake_by_ref();
        self.stir();
    }

    /// Returns true while background operations run.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        let turns = locked(&self.shared.turns);
        turns.under_way > 0 || !turns.tasks.is_empty()
    }

    /// Begins a turn at `now`: what is carried out beside the calls gets on. Returns when the turn is to end at the latest.
    pub fn begin_turn(&self, now: Instant) -> Instant {
        self.shared.time.store(now.as_nanos(), Ordering::Relaxed);
        if self.shared.tasks_wake.0.swap(false, Ordering::Acquire) {
            self.look_at_tasks();
        }
        let turns = locked(&self.shared.turns);
        let due = turns.due().unwrap_or(now + IDLE).min(now + IDLE);
        self.shared.wakes.store(due.as_nanos(), Ordering::Release);
        due
    }

    fn look_at_tasks(&self) {
        // taken out: a task waits for the next turn, which needs the lock
        let mut tasks = {
            let mut turns = locked(&self.shared.turns);
            // in memory several callers may make turns at once: each counts its own
            turns.under_way += turns.tasks.len();
            std::mem::take(&mut turns.tasks)
        };
        let taken = tasks.len();
        let waker = Waker::from(Arc::clone(&self.shared.tasks_wake));
        let mut context = Context::from_waker(&waker);
        tasks.retain_mut(|task| task.as_mut().poll(&mut context).is_pending());
        if tasks.len() < taken {
            // whoever waits for its end looks in this turn
            self.shared.happened.store(true, Ordering::Release);
        }
        let mut turns = locked(&self.shared.turns);
        // what a task has begun meanwhile comes behind
        tasks.append(&mut turns.tasks);
        turns.tasks = tasks;
        turns.under_way -= taken;
    }

    /// Ends a turn: wakes the waiting calls that it concerns, and those whose time is over.
    pub fn end_turn(&self, now: Instant, failure: Option<WireFailure>) {
        self.shared.time.store(now.as_nanos(), Ordering::Relaxed);
        let mut news = {
            let mut client = self.quietly();
            client.end_turn(now, failure.is_some());
            client.take_news()
        };
        news.everything |= self.shared.happened.swap(false, Ordering::Acquire) || failure.is_some();
        let mut woken = {
            let mut turns = locked(&self.shared.turns);
            turns.number += 1;
            let number = turns.number;
            if news.everything {
                self.shared.events.fetch_add(1, Ordering::Release);
            }
            if let Some(failure) = failure {
                turns.failure = Some((number, failure));
            }
            let mut woken = std::mem::take(&mut turns.woken);
            for one in turns.waiting.values_mut().filter(|one| !one.woken) {
                if one.until <= now || one.interest.is_met(&news) {
                    one.woken = true;
                    woken.push(one.waker.clone());
                }
            }
            woken
        };
        // the lock is not held: who is woken may look at once
        woken.drain(..).for_each(Waker::wake);
        locked(&self.shared.turns).woken = woken;
    }

    /// There are no more turns: every call ends with [`Error::Closed`], or with [`Error::DriverFailed`] when the thread that
    /// calls this is panicking.
    pub fn end(&self) {
        let (waiting, tasks) = {
            let mut turns = locked(&self.shared.turns);
            turns.failed |= !turns.ended && std::thread::panicking();
            turns.ended = true;
            (
                std::mem::take(&mut turns.waiting),
                std::mem::take(&mut turns.tasks),
            )
        };
        // a task that waits for a turn needs the lock to leave
        drop(tasks);
        waiting.into_values().for_each(|one| one.waker.wake());
    }

    /// Takes octets that came from the serial line.
    pub fn handle_octets(&mut self, now: Instant, octets: &[u8]) {
        self.quietly().handle_octets(now, octets);
    }

    /// Does what is due on the serial line at `now`.
    pub fn handle_line_timeout(&mut self, now: Instant) {
        self.quietly().handle_line_timeout(now);
    }

    /// Returns the next octets to send on the serial line: their number in `buffer`, which has [`uss::MAX_TELEGRAM`] of
    /// them.
    pub fn poll_octets(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize> {
        self.quietly().poll_octets(now, buffer)
    }

    /// Returns the time when [`handle_line_timeout`](Self::handle_line_timeout) and [`poll_octets`](Self::poll_octets)
    /// are due.
    #[must_use]
    pub fn poll_line_timeout(&self) -> Option<Instant> {
        self.quietly().poll_line_timeout()
    }
}

impl Endpoint for Engine {
    fn mac(&self) -> MacAddress {
        self.quietly().mac()
    }

    fn ip(&self) -> IpSuite {
        self.quietly().ip()
    }

    fn handle_frame(&mut self, now: Instant, frame: &[u8]) {
        self.quietly().handle_frame(now, frame);
    }

    fn handle_datagram(&mut self, now: Instant, source: SocketAddrV4, local_port: u16, payload: &[u8]) {
        self.quietly().handle_datagram(now, source, local_port, payload);
    }

    fn handle_timeout(&mut self, now: Instant) {
        self.quietly().handle_timeout(now);
    }

    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        self.quietly().poll_transmit(now, buffer)
    }

    fn poll_timeout(&self) -> Option<Instant> {
        self.quietly().poll_timeout()
    }

    fn may_wait(&self) -> Duration {
        self.quietly().may_wait()
    }
}

/// A client that may have something to send once it was changed.
pub(crate) struct Touched<'e> {
    client: MutexGuard<'e, Client>,
    touched: &'e AtomicBool,
}

impl Deref for Touched<'_> {
    type Target = Client;

    fn deref(&self) -> &Client {
        &self.client
    }
}

impl DerefMut for Touched<'_> {
    fn deref_mut(&mut self) -> &mut Client {
        self.touched.store(true, Ordering::Release);
        &mut self.client
    }
}

impl Turns {
    /// Returns the time when the first of those is to be woken who wait.
    fn due(&self) -> Option<Instant> {
        let waiting = self.waiting.values().filter(|one| !one.woken);
        waiting.map(|one| one.until).min()
    }
}

/// The next turn of an engine.
pub(crate) struct NextTurn {
    engine: Engine,
    until: Instant,
    interest: Interest,
    /// Events at the last look.
    since: Option<u64>,
    /// Its place among those who wait.
    key: Option<u64>,
}

impl NextTurn {
    /// Does not wait where an event came after so many: another thread may bring one between a look and the wait.
    pub(crate) const fn since(self, events: u64) -> Self {
        let mut waits = self;
        waits.since = Some(events);
        waits
    }
}

impl Future for NextTurn {
    type Output = Result<(), Error>;

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Self::Output> {
        let answer = self.look(context.waker());
        if answer.is_pending() {
            // no lock is held: this may take a turn
            wait::driven_by(self.engine.shared.driver.get(), context.waker());
        }
        answer
    }
}

impl NextTurn {
    /// Takes a place among those who wait, or returns what a turn has brought.
    fn look(&mut self, waker: &Waker) -> Poll<Result<(), Error>> {
        let engine = self.engine.clone();
        let mut turns = locked(&engine.shared.turns);
        if turns.ended {
            return Poll::Ready(Err(turns.end()));
        }
        if let Some(key) = self.key {
            let begun = match turns.waiting.get_mut(&key) {
                Some(one) if !one.woken => {
                    one.waker.clone_from(waker);
                    return Poll::Pending;
                }
                Some(one) => one.begun,
                None => u64::MAX,
            };
            let failure = turns.failure.as_ref().filter(|(turn, _)| *turn > begun);
            return Poll::Ready(failure.map_or(Ok(()), |(_, why)| Err(Error::Medium(why.clone()))));
        }
        if self.since.is_some_and(|since| since != engine.events()) {
            return Poll::Ready(Ok(()));
        }
        let key = turns.next_key;
        turns.next_key += 1;
        let one = Waiting {
            begun: turns.number,
            until: self.until,
            interest: self.interest,
            woken: false,
            waker: waker.clone(),
        };
        turns.waiting.insert(key, one);
        self.key = Some(key);
        drop(turns);
        let touched = engine.shared.touched.swap(false, Ordering::AcqRel);
        if touched || self.until.as_nanos() < engine.shared.wakes.load(Ordering::Acquire) {
            engine.ring();
        }
        Poll::Pending
    }
}

impl Drop for NextTurn {
    fn drop(&mut self) {
        if let Some(key) = self.key {
            locked(&self.engine.shared.turns).waiting.remove(&key);
        }
    }
}

#[cfg(test)]
mod tests {
    use profinet::controller::ControllerConfig;

    use super::*;

    fn engine() -> Engine {
        let mac = MacAddress([2, 0, 0, 0, 0, 1]);
        Engine::new(Client::new(ControllerConfig::new(mac, IpSuite::NONE, "tool", 1)))
    }

    /// Whoever leaves the network from another thread may look at any moment.
    #[test]
    fn a_task_that_is_being_looked_at_keeps_the_engine_busy() {
        let engine = engine();
        let busy = Arc::new(AtomicBool::new(false));
        let (inside, seen) = (engine.clone(), Arc::clone(&busy));
        engine.spawn(async move { seen.store(inside.is_busy(), Ordering::Relaxed) });
        engine.begin_turn(Instant::ZERO);
        assert!(busy.load(Ordering::Relaxed));
        assert!(!engine.is_busy());
    }

    /// In memory another caller may make a turn meanwhile.
    #[test]
    fn a_turn_of_another_caller_does_not_end_the_turn_of_a_task() {
        let engine = engine();
        let busy = Arc::new(AtomicBool::new(false));
        let (inside, seen) = (engine.clone(), Arc::clone(&busy));
        engine.spawn(async move {
            inside.begin_turn(Instant::ZERO);
            seen.store(inside.is_busy(), Ordering::Relaxed);
        });
        engine.begin_turn(Instant::ZERO);
        assert!(busy.load(Ordering::Relaxed));
        assert!(!engine.is_busy());
    }

    #[test]
    fn the_end_drops_a_task_that_waits_for_a_turn() {
        let engine = engine();
        let inside = engine.clone();
        engine.spawn(async move {
            let _ = inside.next_turn(Instant::ZERO + IDLE, Interest::Events).await;
        });
        engine.begin_turn(Instant::ZERO);
        assert!(engine.is_busy());
        engine.end();
        assert!(!engine.is_busy());
    }

    /// A program that carries on would wait for ever, or take the failure for one of the network.
    #[test]
    fn calls_end_with_the_failure_of_the_thread_that_carries() {
        struct End(Engine);
        impl Drop for End {
            fn drop(&mut self) {
                self.0.end();
            }
        }
        let engine = engine();
        let carrying = engine.clone();
        let carrier = std::thread::spawn(move || {
            let _end = End(carrying);
            panic!("an error in a carrier");
        });
        assert!(carrier.join().is_err());
        let mut next = std::pin::pin!(engine.next_turn(Instant::ZERO + IDLE, Interest::Events));
        let answer = next.as_mut().poll(&mut Context::from_waker(Waker::noop()));
        let Poll::Ready(Err(error)) = answer else {
            panic!("it waits");
        };
        assert!(matches!(error, Error::DriverFailed), "{error}");
        assert_eq!(error.kind().id(), "internal");
    }
}
