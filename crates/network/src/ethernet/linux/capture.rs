//! What is on the wire of an interface, both ways.

use std::time::Duration;

use profinet::MAX_FRAME;

use super::packet::PacketSocket;
use crate::ethernet::Captured;
use crate::system::linux::{readable, wait};
use crate::system::{Error, Stop};

/// Receives every frame on an interface, those that this computer sends too. Sends nothing.
///
/// The kernel keeps 4096 frames for a reader that is slow; what did not fit is counted by [`missed`](Self::missed), and
/// by [`Captured::missed`] before the frame that follows.
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use std::time::Duration;
/// use profidrive_network::ethernet::Capture;
/// use profidrive_network::system::Stop;
/// let stop = Stop::on_signals()?;
/// let mut capture = Capture::open("eth0", stop.clone())?;
/// while !stop.is_stopped() {
///     if let Some(captured) = capture.next(Duration::from_secs(1))? {
///         println!("{:?}: {} octets", captured.time, captured.frame.len());
///     }
/// }
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct Capture {
    packet: PacketSocket,
    stop: Stop,
    frame: Box<[u8]>,
}

impl Capture {
    /// Opens an interface in promiscuous mode.
    ///
    /// # Errors
    /// No such interface, interface down, no permission for raw sockets.
    pub fn open(interface: &str, stop: Stop) -> Result<Self, Error> {
        Ok(Self {
            packet: PacketSocket::listen_to_all(interface)?,
            stop,
            frame: vec![0; 2 * MAX_FRAME].into_boxed_slice(),
        })
    }

    /// Returns the next frame; `None` when none comes for so long, or when the stop flag is set. A frame too long for the receive
    /// ring is empty.
    ///
    /// # Errors
    /// The interface is down or gone.
    pub fn next(&mut self, timeout: Duration) -> Result<Option<Captured<'_>>, Error> {
        let Self { packet, stop, frame } = self;
        if packet.peek().is_none() {
            let mut fds = [readable(packet.fd()), readable(stop.event().fd())];
            wait(&mut fds, timeout).map_err(Error::system("cannot wait for frames"))?;
            packet.check(fds[0].revents)?;
        }
        let Some((received, octets)) = packet.peek() else {
            return Ok(None);
        };
        let (time, losing) = (received.time, received.losing);
        let mut tagged = [0; MAX_FRAME + 4];
        let whole = received.on_the_wire(octets, &mut tagged);
        let length = whole.len().min(frame.len());
        let kept = frame.get_mut(..length).unwrap_or_default();
        kept.copy_from_slice(whole.get(..length).unwrap_or_default());
        packet.release();
        let missed = if losing { packet.newly_missed() } else { 0 };
        Ok(Some(Captured {
            time,
            frame: &*kept,
            after_gap: losing,
            missed,
        }))
    }

    /// Frames lost so far because they were not read in time.
    #[must_use]
    pub fn missed(&mut self) -> u64 {
        self.packet.statistics().missed
    }
}
