//! What carries a client: a network, or a serial line.

use std::error::Error;

use profinet::{Instant, Medium};

use super::Engine;

/// Something that carries the bytes of an [`Engine`].
///
/// Every [`Medium`] is one, for drives on a network. A serial line is another one: it brings octets to
/// [`Engine::handle_octets`], sends what [`Engine::poll_octets`] gives and wakes it with [`Engine::handle_line_timeout`].
pub trait Wire {
    /// Why it failed.
    type Error: Error + Send + Sync + 'static;

    /// Returns the present time.
    fn now(&self) -> Instant;

    /// Carries bytes to and from `engine` until at least one input or deadline was handled or `until` is reached,
    /// whichever is first.
    ///
    /// # Errors
    /// When the wire itself fails; never because of received bytes.
    fn step(&mut self, engine: &mut Engine, until: Instant) -> Result<(), Self::Error>;
}

impl<M: Medium> Wire for M
where
    M::Error: Send + Sync + 'static,
{
    type Error = M::Error;

    fn now(&self) -> Instant {
        Medium::now(self)
    }

    fn step(&mut self, engine: &mut Engine, until: Instant) -> Result<(), Self::Error> {
        Medium::step(self, engine, until)
    }
}
