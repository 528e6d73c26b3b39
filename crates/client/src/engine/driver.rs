//! Who carries bytes and time.

use std::sync::{Arc, Mutex, PoisonError, TryLockError};

use profinet::Instant;

use super::{Engine, Waiters, Wire};
use crate::WireFailure;

/// Carries the bytes and the time of an [`Engine`]: a thread of its own on a real network, or the thread that waits.
pub trait Driver: Send + Sync {
    /// Returns the present time, if it is available now; else it is that of the last turn.
    fn now(&self) -> Option<Instant>;

    /// Lets one thing happen. False where that happens without the caller, who then sleeps until it is woken: in a thread of its
    /// own, or in that of another caller.
    fn turn(&self) -> bool;

    /// Returns who waits for it, where they take its turns themselves.
    fn waiters(&self) -> Option<&Waiters> {
        None
    }

    /// Wakes the driver: a caller begins to wait, or has posted work.
    fn ring(&self) {}

    /// There is nothing more to be carried.
    fn end(&self) {}
}

/// A wire that is carried by the threads that wait: nothing happens and no time passes meanwhile. In virtual time one thread
/// gives the same run every time. Several ones take turns, and none while a call of another one can go on: time passes as their
/// calls need it, whichever thread the computer runs. Only the order of what they do at the same time is left to it.
#[derive(Debug)]
pub struct World<W: Wire> {
    engine: Engine,
    wire: Mutex<W>,
    waiters: Waiters,
}

impl<W: Wire + Send + 'static> World<W> {
    pub(crate) fn new(engine: &Engine, wire: W) -> Arc<Self> {
        let world = Arc::new(Self {
            engine: engine.clone(),
            wire: Mutex::new(wire),
            waiters: Waiters::default(),
        });
        let driver: Arc<dyn Driver> = world.clone();
        engine.driven_by(Arc::downgrade(&driver));
        world
    }

    /// Returns the wire, to inspect and to change it: cables and taps of a simulated segment. The driver pauses
    /// meanwhile.
    pub fn wire(&self) -> std::sync::MutexGuard<'_, W> {
        self.wire.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<W: Wire + Send> Driver for World<W> {
    fn now(&self) -> Option<Instant> {
        match self.wire.try_lock() {
            Ok(wire) => Some(wire.now()),
            Err(TryLockError::Poisoned(wire)) => Some(wire.into_inner().now()),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    fn waiters(&self) -> Option<&Waiters> {
        Some(&self.waiters)
    }

    fn turn(&self) -> bool {
        if !self.waiters.begin_turn() {
            return false;
        }
        let now = self.now().unwrap_or_else(|| self.engine.now());
        let until = self.engine.begin_turn(now);
        let mut wire = self.wire.lock().unwrap_or_else(PoisonError::into_inner);
        let failure = wire.step(&mut self.engine.clone(), until).err();
        let now = wire.now();
        drop(wire);
        self.engine
            .end_turn(now, failure.map(|why| Arc::new(why) as WireFailure));
        true
    }
}
