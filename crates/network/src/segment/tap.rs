//! Monitor ports of a segment.

use std::io;
use std::sync::{Arc, Mutex, PoisonError};

use profinet::Instant;

/// A monitor port: receives every frame once, when it reaches the switch.
///
/// [`pcap::Writer`](crate::pcap::Writer) is one. To keep access to it, add an `Arc<Mutex<_>>` of it.
pub trait Tap: Send {
    /// One frame, with the virtual time at which it was sent.
    fn frame(&mut self, at: Instant, frame: &[u8]);

    /// Flushes at the end and returns the first failure.
    ///
    /// # Errors
    /// When the frames could not be written.
    fn finish(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Ends all taps and returns the first failure.
pub(crate) fn finish_all(taps: &mut Vec<Box<dyn Tap>>) -> io::Result<()> {
    let mut result = Ok(());
    for mut tap in taps.drain(..) {
        result = result.and(tap.finish());
    }
    result
}

impl<T: Tap> Tap for Arc<Mutex<T>> {
    fn frame(&mut self, at: Instant, frame: &[u8]) {
        let mut tap = self.lock().unwrap_or_else(PoisonError::into_inner);
        tap.frame(at, frame);
    }

    fn finish(&mut self) -> io::Result<()> {
        let mut tap = self.lock().unwrap_or_else(PoisonError::into_inner);
        tap.finish()
    }
}

/// The simplest tap: keeps everything.
impl Tap for Vec<(Instant, Vec<u8>)> {
    fn frame(&mut self, at: Instant, frame: &[u8]) {
        self.push((at, frame.to_vec()));
    }
}
