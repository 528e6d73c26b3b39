//! What a test looks at and changes while a client has it too.

// helpers of tests fail by panicking, like the tests themselves
#![allow(clippy::panic)]

use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};

use client::{Network, Session, Wait, Wire, World};

/// Something that several have, with the calls of a `RefCell`; it may change threads.
#[derive(Debug, Default)]
pub struct Shared<T>(Arc<Mutex<T>>);

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Shared<T> {
    /// Shares a value.
    pub fn new(value: T) -> Self {
        Self(Arc::new(Mutex::new(value)))
    }

    /// Locks it.
    ///
    /// # Panics
    /// When it is locked already.
    pub fn borrow(&self) -> MutexGuard<'_, T> {
        self.borrow_mut()
    }

    /// Locks it to change it.
    ///
    /// # Panics
    /// When it is locked already.
    pub fn borrow_mut(&self) -> MutexGuard<'_, T> {
        match self.0.try_lock() {
            Ok(value) => value,
            Err(TryLockError::Poisoned(value)) => value.into_inner(),
            Err(TryLockError::WouldBlock) => panic!("borrowed already"),
        }
    }

    /// A copy of the value.
    pub fn get(&self) -> T
    where
        T: Copy,
    {
        *self.borrow()
    }

    /// Replaces the value.
    pub fn set(&self, value: T) {
        *self.borrow_mut() = value;
    }
}

/// A network with the wire that it is on.
pub struct On<W: Wire> {
    network: Network,
    world: Arc<World<W>>,
}

impl<W: Wire + Send + 'static> On<W> {
    /// From the two halves that `client::Network::on` returns.
    pub fn new((network, world): (Network, Arc<World<W>>)) -> Self {
        Self { network, world }
    }

    /// Returns the wire, to look at and to change.
    pub fn medium(&self) -> impl DerefMut<Target = W> + '_ {
        self.world.wire()
    }

    /// Lets what was begun come to its end: an axis that was dropped is at rest afterwards.
    pub fn settle(&mut self) {
        // what cannot be carried any more is at its end too
        let _ = self.network.settled().wait();
    }

    /// Returns the same without discovery.
    #[must_use]
    pub fn without_discovery(mut self) -> Self {
        self.network = self.network.without_discovery();
        self
    }

    /// Returns the same where drives cannot call.
    #[must_use]
    pub fn without_calls(mut self) -> Self {
        self.network = self.network.without_calls();
        self
    }

    /// Returns the wire alone, for what goes on beside a caller that has the network.
    pub fn world(&self) -> Arc<World<W>> {
        Arc::clone(&self.world)
    }
}

impl<W: Wire> Deref for On<W> {
    type Target = Session;

    fn deref(&self) -> &Session {
        &self.network
    }
}

impl<W: Wire> DerefMut for On<W> {
    fn deref_mut(&mut self) -> &mut Session {
        &mut self.network
    }
}
