//! The thread that carries bytes and time of a real network.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use client::{Driver, Engine, Wire, WireFailure};
use network::system::{Bell, First, Rank, Stop};
use profinet::Instant;

use crate::carrier::Carrier;

/// How long a carrier that failed is left alone: an interface that is down may come up again.
const AFTER_FAILURE: Duration = Duration::from_millis(20);

/// A carrier with a thread of its own. It goes on whatever the rest of the program does: an axis whose owner hangs or
/// has panicked is brought to rest anyway.
pub(crate) struct Threaded {
    bell: Bell,
    ended: Arc<AtomicBool>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

impl Threaded {
    /// Starts the thread.
    pub(crate) fn start(
        engine: Engine,
        mut carrier: Carrier,
        stop: Option<Stop>,
    ) -> std::io::Result<Arc<Self>> {
        let bell = Bell::new()?;
        carrier.set_bell(bell.clone());
        let ended = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&ended);
        let thread = thread::Builder::new()
            .name("profidrive".into())
            .spawn(move || carry(&engine, &mut carrier, stop.as_ref(), &flag))?;
        Ok(Arc::new(Self {
            bell,
            ended,
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

fn carry(engine: &Engine, carrier: &mut Carrier, stop: Option<&Stop>, ended: &AtomicBool) {
    let _end = End(engine);
    // a drive stops its axis when this computer is late, whatever else it has to do
    let mut first = First::new(Rank::Frames);
    let mut stopped = false;
    while !ended.load(Ordering::Acquire) {
        let now = carrier.now();
        first.turn(now);
        let until = engine.begin_turn(now);
        let failure = carrier.step(&mut engine.clone(), until).err();
        if failure.is_some() {
            thread::sleep(AFTER_FAILURE);
        }
        let stops = stop.is_some_and(Stop::is_stopped);
        if stops && !stopped {
            engine.stir();
        }
        stopped = stops;
        engine.end_turn(carrier.now(), failure.map(|why| Arc::new(why) as WireFailure));
    }
}

impl Driver for Threaded {
    fn now(&self) -> Option<Instant> {
        Some(network::system::now())
    }

    fn turn(&self) -> bool {
        false
    }

    fn ring(&self) {
        self.bell.ring();
    }

    fn end(&self) {
        self.ended.store(true, Ordering::Release);
        self.bell.ring();
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(thread) = thread {
            // a panic in there has ended every call already
            let _ = thread.join();
        }
    }
}
