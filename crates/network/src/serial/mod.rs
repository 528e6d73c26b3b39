//! A serial line: a port of the computer, opened exclusively, and what carries octets between it and an engine.
//!
//! | wish | type |
//! |---|---|
//! | a port | [`Port`], opened with [`Settings`] |
//! | an engine at it, asleep until something happens | [`Line`] and [`Talker`] |
//! | an end of a line that is not a port: a pseudo-terminal | [`Port::pair`] |

mod error;
#[cfg(target_os = "linux")]
mod opening;
mod port;

pub use error::{Error, Holder};
pub use port::{Parity, Port, Settings};

#[cfg(target_os = "linux")]
use opening::opening;
use profinet::Instant;

use crate::system::{Bell, Calls, Stop, now};

/// Octets read at once.
const CHUNK: usize = 512;
/// Most chunks that are read before the engine gets its turn.
const MOST_CHUNKS: usize = 16;
/// Longest telegram of an engine.
const TELEGRAM: usize = 512;
/// Most telegrams sent in one step.
const MOST_TELEGRAMS: usize = 16;

/// Returns the system's reason why a port cannot be opened.
#[cfg(not(target_os = "linux"))]
fn opening(name: &str, error: serialport::Error) -> Error {
    Error::System {
        port: name.to_owned(),
        source: error.into(),
    }
}

/// A sans-IO engine on a serial line. Rule: feed, drain, sleep until the deadline.
pub trait Talker {
    /// Takes octets that came.
    fn handle_octets(&mut self, now: Instant, octets: &[u8]);
    /// Does what is due at `now`.
    fn handle_timeout(&mut self, now: Instant);
    /// Writes the next octets to send into `buffer` and gives their number.
    fn poll_transmit(&mut self, now: Instant, buffer: &mut [u8]) -> Option<usize>;
    /// Returns the time when [`handle_timeout`](Self::handle_timeout) or [`poll_transmit`](Self::poll_transmit) is due.
    fn poll_timeout(&self) -> Option<Instant>;
}

/// A port with an engine at it.
///
#[cfg_attr(unix, doc = "```")]
#[cfg_attr(not(unix), doc = "```ignore")] // no pseudo-terminals there
/// use std::time::Duration;
/// use profidrive_network::system::now;
/// use profidrive_network::serial::{Line, Port, Settings, Talker};
/// use profinet::Instant;
///
/// /// Sends back what it receives.
/// #[derive(Default)]
/// struct Echo(Vec<u8>);
/// impl Talker for Echo {
///     fn handle_octets(&mut self, _: Instant, octets: &[u8]) {
///         self.0.extend_from_slice(octets);
///     }
///     fn handle_timeout(&mut self, _: Instant) {}
///     fn poll_transmit(&mut self, _: Instant, buffer: &mut [u8]) -> Option<usize> {
///         let length = self.0.len().min(buffer.len());
///         buffer[..length].copy_from_slice(&self.0[..length]);
///         self.0.clear();
///         (length > 0).then_some(length)
///     }
///     fn poll_timeout(&self) -> Option<Instant> {
///         None
///     }
/// }
///
/// let (mut far, name) = Port::pair().unwrap();
/// let mut line = Line::new(Port::open(&name, Settings::new(9600)).unwrap());
/// far.write(b"hello").unwrap();
/// let mut echo = Echo::default();
/// line.step(&mut echo, now() + Duration::from_secs(5)).unwrap();
/// let mut answer = [0; 8];
/// assert_eq!(far.read(&mut answer).unwrap(), 5);
/// ```
#[derive(Debug)]
pub struct Line {
    port: Port,
    calls: Calls,
}

impl Line {
    /// Creates a line at an open port.
    #[must_use]
    pub fn new(port: Port) -> Self {
        Self {
            port,
            calls: Calls::default(),
        }
    }

    /// Lets this flag end a step early.
    pub fn set_stop(&mut self, stop: Stop) {
        self.calls.stop = Some(stop);
    }

    /// Lets this bell end a step early whenever it rings.
    pub fn set_bell(&mut self, bell: Bell) {
        self.calls.bell = Some(bell);
    }

    /// Returns the port.
    #[must_use]
    pub const fn port(&self) -> &Port {
        &self.port
    }

    /// Carries octets to and from the engine until at least one input or deadline was handled or `until` is reached,
    /// whichever is first.
    ///
    /// # Errors
    /// When the port is gone or fails.
    pub fn step(&mut self, talker: &mut dyn Talker, until: Instant) -> Result<(), Error> {
        self.drain(talker)?;
        let due = talker.poll_timeout().map_or(until, |due| due.min(until));
        let mut received = false;
        for _ in 0..MOST_CHUNKS {
            // what waits already is taken before anything is called late
            let wait = if received { Instant::ZERO } else { due };
            self.port.wait(wait, &self.calls)?;
            // this step ends soon: what the bell has rung for comes with the next one
            self.calls.was_rung();
            let mut buffer = [0; CHUNK];
            match self.port.read(&mut buffer)? {
                0 => break,
                length => {
                    talker.handle_octets(now(), buffer.get(..length).unwrap_or_default());
                    received = true;
                }
            }
        }
        talker.handle_timeout(now());
        self.drain(talker)
    }

    fn drain(&mut self, talker: &mut dyn Talker) -> Result<(), Error> {
        let mut buffer = [0; TELEGRAM];
        for _ in 0..MOST_TELEGRAMS {
            let Some(length) = talker.poll_transmit(now(), &mut buffer) else {
                break;
            };
            self.port.write(buffer.get(..length).unwrap_or_default())?;
        }
        Ok(())
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// Always has an octet to send, and counts what it is given.
    #[derive(Default)]
    struct Chatter {
        sent: usize,
        received: Vec<usize>,
    }

    impl Talker for Chatter {
        fn handle_octets(&mut self, _: Instant, octets: &[u8]) {
            self.received.push(octets.len());
        }
        fn handle_timeout(&mut self, _: Instant) {}
        fn poll_transmit(&mut self, _: Instant, buffer: &mut [u8]) -> Option<usize> {
            self.sent += 1;
            buffer[0] = 7;
            Some(1)
        }
        fn poll_timeout(&self) -> Option<Instant> {
            None
        }
    }

    #[test]
    fn a_step_reads_and_sends_a_bounded_part() {
        let (mut far, name) = Port::pair().unwrap();
        let mut line = Line::new(Port::open(&name, Settings::new(9600)).unwrap());
        far.write(&[5; 3000]).unwrap();
        let mut talker = Chatter::default();
        while talker.received.iter().sum::<usize>() < 3000 {
            talker.sent = 0;
            line.step(&mut talker, now() + std::time::Duration::from_secs(5))
                .unwrap();
            assert_eq!(talker.sent, 16 + 16, "before and after what came");
            let mut sent = [0; 64];
            let _ = far.read(&mut sent).unwrap();
        }
        assert_eq!(talker.received.iter().max(), Some(&512));
    }
}
