//! A network with the one who carries it.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use profinet::controller::ControllerConfig;

use crate::engine::{Driver, World};
use crate::{Client, Engine, LineConfig, Session, Wait, Wire};

/// The drives of a network, or of a serial line, with the driver that carries the bytes to them.
///
/// Leaving it by any way, an error or a panic included, brings every axis under control to rest and closes the
/// connections at the drives.
#[derive(Debug)]
pub struct Network {
    session: Session,
    driver: Ended,
}

/// A driver, until it is ended.
struct Ended(Arc<dyn Driver>);

impl std::fmt::Debug for Ended {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Driver")
    }
}

impl Network {
    /// Returns a controller on a wire that is carried by the thread that waits.
    #[must_use]
    pub fn on<W: Wire + Send + 'static>(wire: W, config: ControllerConfig) -> (Self, Arc<World<W>>) {
        Self::in_world(wire, Client::new(config))
    }

    /// Returns the master of a serial line: its drives are named by [`LineAddress`](crate::LineAddress).
    ///
    /// Parameters travel one at a time, so many of them take long. Until a client takes an axis the process data sent
    /// along carry no control (bit 10 of the control word is 0): drives ignore them.
    #[must_use]
    pub fn on_line<W: Wire + Send + 'static>(wire: W, config: LineConfig) -> (Self, Arc<World<W>>) {
        Self::in_world(wire, Client::on_line(config))
    }

    fn in_world<W: Wire + Send + 'static>(wire: W, client: Client) -> (Self, Arc<World<W>>) {
        let engine = Engine::new(client);
        let world = World::new(&engine, wire);
        let driver: Arc<dyn Driver> = world.clone();
        let network = Self {
            session: Session::new(engine),
            driver: Ended(driver),
        };
        (network, world)
    }

    /// Returns the network of a client whose bytes this driver carries, made by `driver` from its engine.
    ///
    /// # Errors
    /// What `driver` returns.
    pub fn driven<D: Driver + 'static, E>(
        client: Client,
        driver: impl FnOnce(Engine) -> Result<Arc<D>, E>,
    ) -> Result<Self, E> {
        let engine = Engine::new(client);
        let driver: Arc<dyn Driver> = driver(engine.clone())?;
        engine.driven_by(Arc::downgrade(&driver));
        Ok(Self {
            session: Session::new(engine),
            driver: Ended(driver),
        })
    }

    /// Returns the same on a medium that carries UDP only: drives go by IP address, nothing cyclic.
    #[must_use]
    pub fn without_discovery(self) -> Self {
        self.session.engine().set_discovers(false);
        self
    }

    /// Returns the same with drives that exist in the memory of this program only: what a motion changes for its time need
    /// not be noted for the next program.
    #[must_use]
    pub fn simulated(self) -> Self {
        self.session.engine().set_simulated();
        self
    }

    /// Returns the same on a medium on which drives cannot call their controller, as another program has UDP port
    /// 34964: no connection as IO controller can be made.
    #[must_use]
    pub fn without_calls(self) -> Self {
        self.session.engine().set_hears_calls(false);
        self
    }
}

impl Deref for Network {
    type Target = Session;

    fn deref(&self) -> &Session {
        &self.session
    }
}

impl DerefMut for Network {
    fn deref_mut(&mut self) -> &mut Session {
        &mut self.session
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        // no caller is left to receive the failure of the wire
        let _ = self.session.leave().wait();
        self.session.engine().end();
        self.driver.0.end();
    }
}
